"""ROS 2: the only folder that imports rclpy, and only when it is asked for."""
