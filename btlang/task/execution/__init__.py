"""The execution of tasks: which is next, its run, and the emergency stop."""
