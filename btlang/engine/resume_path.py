"""Resume paths: shortcuts to what is RUNNING, without asking all nodes above it.

A node that waits, such as a Sequence, does nothing while its child is RUNNING but ask that child. Such nodes below each
other form a path: the node at its top asks the child that was RUNNING below the lowest of them, and only when that
completes goes down the long way, where the child gives the status that it has already returned.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from btlang.engine.status import RUNNING

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.instance import Compiled, EngineState, NodeInstance, Tick


class ResumePath:
    """A path of nodes that only wait. `top` is the number of the highest, `resumed` the tick of the RUNNING child."""

    __slots__ = ("answer", "answers", "resumed", "state", "top", "used")

    def __init__(self, top: int, state: EngineState) -> None:
        self.top = top
        self.state = state
        self.used = False  # whether there is a child for which it is worth the effort
        self.resumed: Tick | None = None
        self.answer: int | None = None  # what that child has returned in this tick
        self.answers = True  # whether that is an answer, see NodeInstance.cannot_know


def find_resume_paths(
    instances: Sequence[NodeInstance], waits: Callable[[NodeInstance], bool]
) -> list[ResumePath | None]:
    """Return for each node the path that it is a part of, None for a node that does more than wait."""
    found: list[ResumePath | None] = []
    for instance in instances:
        if not waits(instance):
            found.append(None)
            continue
        around = None if instance.above is None else found[instance.above.index]
        found.append(ResumePath(instance.index, instance.state) if around is None else around)
    return found


def mark_resumable(path: ResumePath, compiled: Compiled) -> Compiled:
    """Wrap a node below the path that may be RUNNING for more than a tick."""
    tick, halt = compiled
    path.used = True

    def tick_resumable() -> int:
        status = path.answer
        if status is None:
            status = tick()
        elif not path.answers:
            path.state.unknowns += 1  # again, for the nodes on the way down, which begin to count only now
        path.answer = None
        path.resumed = tick if status == RUNNING else None
        return status

    def halt_resumable(keep: bool) -> None:
        path.answer = path.resumed = None
        halt(keep)

    return tick_resumable, halt_resumable


def resume_at_top(path: ResumePath, compiled: Compiled) -> Compiled:
    """Wrap the highest node of the path."""
    tick, halt = compiled
    state = path.state

    def resume() -> int:
        if path.resumed is not None:
            unknowns = state.unknowns
            status = path.resumed()
            if status == RUNNING:
                return RUNNING
            path.answer, path.answers = status, state.unknowns == unknowns
        return tick()

    return resume, halt
