"""What actions talk to: the robot interface, the simulated robot and its worlds."""
