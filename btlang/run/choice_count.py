"""How many random choices the robot has made, for a run that goes on in another process."""

from __future__ import annotations

from btlang.run.bus import INLINE
from btlang.run.events import Chosen, Event


class ChoiceCount:
    """A sink that counts the random choices of a run."""

    policy = INLINE

    def __init__(self) -> None:
        self.made = 0

    def __call__(self, event: Event) -> None:
        """An event of the run."""
        if isinstance(event, Chosen) and event.how == "random":
            self.made += 1
