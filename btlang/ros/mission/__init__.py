"""A mission as a ROS 2 node."""
