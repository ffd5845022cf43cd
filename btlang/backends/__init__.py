"""Back ends: a tree becomes something that runs, or another notation."""
