"""Actions of the vocabulary as action servers of ROS 2."""
