"""Components of a robot that are ROS 2 nodes."""
