"""Runs a tree: statuses, clock, blackboard, leaves and compiled nodes. Knows no English and no ROS."""
