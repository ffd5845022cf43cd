"""Where a component lives, as its manager sees it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Protocol

SHARED = "--shared"
"""The option of a process that several robots share, before the path of its socket."""


class Host(Protocol):
    """One component, from its start to its end. The methods are for the thread of its keeper; `leaf` and `ask` are for
    the one that ticks."""

    def load(self) -> Mapping[str, Any]:
        """Starts what it lives in and makes it; what `describe` says of it. Raises ComponentError."""

    def transition(self, name: str) -> None:
        """Does one of TRANSITIONS. Raises ComponentError where it fails, and where it doesn't end within its limit."""

    @property
    def state(self) -> str:
        """The latest that is known: one of STATES."""

    def look(self) -> str | None:
        """Why it can't be used any more (it died, hangs, or failed by itself); None where it works."""

    def leaf(
        self, method: str, outputs: tuple[str, ...], robot: Any, wake: Callable[[], object], beside: set[object]
    ) -> Any:
        """One use of a method by a command: an object with start, tick and halt, see btlang.engine.leaves.leaf.

        The values of ports in `outputs` are functions that take what the method writes there.
        """

    def ask(self, method: str, ports: Mapping[str, Any], robot: Any) -> Any:
        """What a method says to a condition, within the tick. Raises Unknown where it doesn't answer in time."""

    def close(self) -> None:
        """Lets go of it at once, whatever it does. May be called twice."""
