"""Speech without a robot: engines that speak, and marks in what is said."""
