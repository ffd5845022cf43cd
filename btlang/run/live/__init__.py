"""The live view of a run in a terminal: the tree with its statuses, the robot, and keys that pause, step and stop.

`view` is the sink. It notes events on the `board`, and a few times a second draws what that says: `state` follows the
run, `selection` chooses the nodes that fit the terminal, `frame` words them and `screen` writes them below the lines of
what happened. `keys` reads the keyboard, `stopping` and `capture` keep others from spoiling the screen.
"""
