"""What watchers of a robot get, while things happen."""
