"""The voice, which takes its time, and the screen."""

from __future__ import annotations

from btlang.robots.body import Body


class Voice:
    """Speaks one text at a time, for as long as the body says."""

    def __init__(self, body: Body) -> None:
        self._voice = body.voice
        self._left = 0.0

    @property
    def speaking(self) -> bool:
        """True while it speaks."""
        return self._left > 1e-9

    def say(self, text: str) -> None:
        """Starts to speak, in place of what it is saying."""
        if self._voice is not None:
            self._left = self._voice.text + self._voice.character * len(text)

    def silence(self) -> None:
        """Ends speech at once."""
        self._left = 0.0

    def print(self, text: str) -> None:
        """The screen shows it at once."""

    def step(self, dt: float) -> None:
        """Moves on by `dt` seconds."""
        self._left = max(0.0, self._left - dt)
