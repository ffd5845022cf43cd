"""What decorators share that ask something before their child starts, and not while it is RUNNING."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from btlang.engine.status import IDLE, RUNNING

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.instance import Compiled


def start_guarded(children: Sequence[Compiled], ask: Callable[[], int]) -> Compiled:
    """The one child, where `ask` gives IDLE when it is to start; else the status that `ask` gives."""
    [(child, halt_child)] = children
    running = False  # whether the child was RUNNING at the last tick

    def tick() -> int:
        nonlocal running
        if not running:
            status = ask()
            if status != IDLE:
                return status
        status = child()
        running = status == RUNNING
        return status

    def halt(keep: bool) -> None:
        nonlocal running
        halt_child(keep)
        if not keep:
            running = False

    return tick, halt
