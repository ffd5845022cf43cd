"""Which of several names a robot chooses: the nearest, or any by a seed, so that a run can be repeated."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence

from btlang.robots.likeness import unseen
from btlang.robots.relations import related_words
from btlang.robots.robot import OnEvent, RobotError
from btlang.text.enumeration import nth
from btlang.vocabulary.references import ordinal

PICKY = ("seen", "largest", "smallest")
"""The ways to choose that look at what something is like."""
_AHEAD = 90.0  # degrees to either side


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
        self,
        kind: str,
        how: str,
        names: Sequence[str],
        parts: Mapping[str, str],
        on_event: OnEvent | None,
        distance: Callable[[str], float],
        size: Callable[[str], float],
        bearing: Callable[[str], float],
        by_name: bool = False,
    ) -> str:
        """The nearest of the names, a random one and so on. Raises RobotError where nothing has these parts.

        A number counts them from the nearest one on, or `by_name`.
        """
        if not names:
            raise RobotError(
                unseen(kind, parts, related_words(parts)) if parts or how == "seen" else f"there's no {kind} to choose"
            )
        if how in ("nearest", "seen"):
            data: dict[str, str | int] = {"type": kind, "how": "nearest", "name": min(names, key=distance)}
        elif how == "furthest":
            data = {"type": kind, "how": how, "name": max(names, key=distance)}
        elif how in ("leftmost", "rightmost"):
            ahead = [name for name in names if abs(bearing(name)) <= _AHEAD] or names
            chosen = max(ahead, key=bearing) if how == "leftmost" else min(ahead, key=bearing)
            data = {"type": kind, "how": how, "name": chosen}
        elif number := ordinal(how):
            line = sorted(sorted(names, key=_natural), key=lambda name: 0.0 if by_name else distance(name))
            if abs(number) > len(line):
                raise RobotError(f"number {abs(number)} is asked for, but there's only {', '.join(line)}")
            data = {"type": kind, "how": nth(number), "name": line[number - 1 if number > 0 else number]}
        elif how in ("largest", "smallest"):
            chosen = max(names, key=size) if how == "largest" else min(names, key=size)
            data = {"type": kind, "how": how, "name": chosen}
        elif how == "random":
            data = {"type": kind, "how": how, "name": self._any(names), "seed": self.seed}
        else:
            raise RobotError(f"it can choose the nearest or a random {kind}, not by '{how}'")
        if on_event is not None:
            on_event("choose", data)
        return str(data["name"])

    def _any(self, names: Sequence[str]) -> str:
        from random import Random  # most missions need none

        self._made += 1
        return Random(f"{self.seed} {self._made}").choice(names)


def _natural(name: str) -> tuple[tuple[int, str], ...]:
    """A key that sorts `room 2` before `room 10`."""
    return tuple((int(part), "") if part.isdecimal() else (0, part) for part in re.split(r"(\d+)", name.lower()))
