"""Which of several names a robot chooses: the nearest, or any by a seed, so that a run can be repeated."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from btlang.robots.robot import OnEvent, RobotError


class Choices:
    """The choices of one run after the other; each begins with a seed of its own.

    What is chosen depends on the seed and on how many random choices came before: so a run can go on elsewhere.
    """

    def __init__(self) -> None:
        self.seed = self._made = 0

    def begin(self, seed: int, made: int = 0) -> None:
        """A run with so many random choices behind it."""
        self.seed, self._made = seed, made

    def choose(
        self, kind: str, how: str, names: Sequence[str], distance: Callable[[str], float], tell: OnEvent | None
    ) -> str:
        """The nearest of the names, or a random one. Raises RobotError where there is none."""
        if not names:
            raise RobotError(f"there's no {kind} to choose")
        if how == "nearest":
            data: dict[str, str | int] = {"type": kind, "how": how, "name": min(names, key=distance)}
        elif how == "random":
            data = {"type": kind, "how": how, "name": self._any(names), "seed": self.seed}
        else:
            raise RobotError(f"it can choose the nearest or a random {kind}, not by '{how}'")
        if tell is not None:
            tell("choose", data)
        return str(data["name"])

    def _any(self, names: Sequence[str]) -> str:
        from random import Random  # most missions need none

        self._made += 1
        return Random(f"{self.seed} {self._made}").choice(names)
