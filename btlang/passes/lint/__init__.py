"""Lints: warnings about missions and trees that can run."""
