"""The one guard for motion: what sensors say comes in as readings, and no command to a base or joint passes it by.

It imports neither ROS nor the simulator. Each platform only turns what its sensors say into readings.
"""
