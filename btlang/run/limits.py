"""How fast a mission may run."""

from __future__ import annotations

SLOWEST = 0.001
"""The least speed, in seconds of the mission per second; slower than that is a mistake."""
RATES = (1.0, 1000.0)
"""The least and the most ticks a second; below, a robot drives blind for too long between two."""
