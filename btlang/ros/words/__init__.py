"""Leaves that keyword files declare as clients of ROS 2 interfaces."""
