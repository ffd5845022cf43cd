"""The hardware layer: kinds of devices, and a driver for each make."""
