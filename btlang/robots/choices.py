"""Which of several names a robot chooses: the nearest, or any by a seed, so that a run can be repeated."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from btlang.robots.robot import OnEvent, RobotError

TYPE_CHECKING = False
if TYPE_CHECKING:
    from random import Random


class Choices:
    """The choices of one run after the other; each begins with a seed of its own."""

    def __init__(self) -> None:
        self.seed = 0
        self._random: Random | None = None

    def begin(self, seed: int) -> None:
        """A new run."""
        self.seed, self._random = seed, None

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
        if self._random is None:
            from random import Random  # most missions need none

            self._random = Random(self.seed)
        return self._random.choice(names)
