"""A robot that speaks ROS 2: what actions see of it, and its connection."""
