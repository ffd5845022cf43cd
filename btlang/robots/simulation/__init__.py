"""The simulated robot in its simulated world."""
