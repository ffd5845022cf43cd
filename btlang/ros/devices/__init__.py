"""Devices over ROS 2: topics that are devices of a robot, and devices that are shown as topics. docs/ros_devices.md."""
