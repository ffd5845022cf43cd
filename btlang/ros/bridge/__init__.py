"""The program `python -m btlang.ros.bridge`: the ROS 2 graph for a server that imports no ROS itself.

It reads a JSON object a line: an operation of the rosbridge protocol with the number of a `client`, or `leave` for one
that is gone. It writes two JSON texts a line, with a tab between: the client with the topic, and what the client
gets. It ends when its standard input does.
"""
