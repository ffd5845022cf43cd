"""Runs an engine: rate, time limit, stop; the event stream and its sinks."""
