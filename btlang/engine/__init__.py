"""The engine, which runs trees: statuses, clock, blackboard, leaves and compiled nodes. It knows no English and no
ROS.
"""
