"""Programs with plain rclpy that tests start in a process of their own, as other people's nodes would be."""
