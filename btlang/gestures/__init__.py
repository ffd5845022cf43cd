"""`btc gesture`: plays, checks, draws and records the gestures of a robot."""
