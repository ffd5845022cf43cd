"""The simulated robot as a ROS 2 node: what `btc sim-ros` starts. docs/ros.md lists its topics.

One thread steps the simulation, reads the robot and publishes. The callbacks of topics, services and actions run in the
thread of the executor and hand their work to that one through an `CallQueue`.
"""
