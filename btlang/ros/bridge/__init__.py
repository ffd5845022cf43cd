"""The program `python -m btlang.ros.bridge`: the ROS 2 graph for a server that imports no ROS itself.

It reads a JSON object a line: an operation of the rosbridge protocol with the number of a `client`, or `leave` for one
that is gone. What it writes are two JSON texts a line, with a tab between: for which client it is and of which topic,
and what he gets. It ends when its standard input does.
"""
