"""The live view of a run in a terminal: the tree with its statuses, the robot, and keys that pause, step and stop.

What happens goes from `view` (the sink) to `state`; a few times a second `selection` chooses the nodes that fit the
terminal, `frame` words them and `screen` draws them below the lines of what happened. `keys` reads the keyboard.
"""
