"""Dynamixel servos of the X series: Protocol 2.0 over a serial port."""
