"""What robots send and receive while clients are connected, over WebSockets."""
