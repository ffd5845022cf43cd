"""Sensors that lie: one table of lies, told by a simulated robot, a device driver, a serial board and a ROS 2 node."""
