"""Stand-ins for compiled packages where none can be installed: what btlang uses of them, in plain Python."""
