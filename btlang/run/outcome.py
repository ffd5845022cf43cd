"""How a run ended, and whether the robot stood still then."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from btlang.engine.engine import Failure
from btlang.engine.leaves.leaf import locate_failure
from btlang.run.statuses import Status
from btlang.support.record import Record
from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class Standstill(Record):
    """How still the robot stood at the end of a run. `moving` is None where nothing reports it; `speed` says how fast.

    `pending` are reasons why the robot may be moved on, such as a goal that its server did not give up. `early`: what
    was measured may be older than the motion of a goal that was given up a moment ago.
    """

    moving: bool | None = False
    speed: str = ""
    pending: tuple[str, ...] = ()
    early: bool = False

    @property
    def still(self) -> bool | None:
        """Return whether it stands still for good; None where that is not known."""
        if self.moving:
            return False
        return None if self.moving is None or self.pending else True

    @property
    def alarming(self) -> bool:
        """Return whether people have to be warned."""
        return bool(self.moving or self.pending)

    def __str__(self) -> str:
        reasons = "; ".join(dict.fromkeys(self.pending))
        if self.moving:
            moving = f"the robot is still moving{f' {self.speed}' if self.speed else ''}"
            return f"{moving}: {reasons}" if reasons else moving
        if self.moving is None:
            unknown = "nothing reports whether the robot moves"
            return f"{unknown}, and {reasons}" if reasons else unknown
        return f"the robot stands still, but {reasons}" if reasons else "the robot stands still"


def standstill_of(robot: Any) -> Standstill:
    """Return the standstill of any robot: its `standstill`, else what its `moving` says."""
    found: Standstill | None = getattr(robot, "standstill", None)
    return Standstill(getattr(robot, "moving", None)) if found is None else found


def describe_caught(raised: Iterable[Failure], failure: Failure | None) -> tuple[str, ...]:
    """Say which exceptions of leaves aren't the failure of the mission, each once."""
    caught = [each for each in raised if failure is None or each.exception is not failure.exception]
    reasons = ((each, locate_failure(each.exception)) for each in caught if each.exception is not None)
    return tuple(dict.fromkeys(f"'{each.node.source_text}' raised an exception: {reason}" for each, reason in reasons))


SUSPENDED, EMERGENCY = "suspended", "emergency stop"


class Outcome(Record, uncompared=("why", "statuses", "exceptions")):
    """The outcome of a run. `print(outcome)` prints the same as `btc run` at its end.

    `why()` explains why the run failed, and is "" if it didn't. `statuses()` returns the final status of each node, by
    its words. `exceptions` has the latest exception of each leaf, except ActionFailed, even if the mission went on.
    `caught` describes those that didn't end it, a sentence each. `unanswered` has a sentence for each rule that did
    nothing, because its condition was never known.

    `stopped` is "" if the tree completed. Otherwise the status is IDLE, and `stopped` is "time limit", "interrupted",
    "suspended" (another run can continue it) or "emergency stop". `seconds` is the mission time, without the time in
    which the robot came to rest. `overruns` counts the ticks that took too long. `worst` is the slowest leaf in one of
    them with its seconds, None if no leaf was to blame or nothing was measured. `standstill` says whether the robot
    came to rest.
    """

    status: Status
    seconds: float
    ticks: int
    failure: Failure | None
    stopped: str = ""
    overruns: int = 0
    worst: tuple[Node, float] | None = None
    standstill: Standstill = Standstill()
    why: Callable[..., str] = str
    statuses: Callable[[], Mapping[str, Status]] = dict
    exceptions: tuple[BaseException, ...] = ()
    caught: tuple[str, ...] = ()
    unanswered: tuple[str, ...] = ()

    def __repr__(self) -> str:
        failure = f": {self.failure.reason}" if self.failure is not None else ""
        count = len(self.caught)
        caught = f", {count} exception{'s' * (count > 1)} caught" if count else ""
        return f"<Outcome {self.stopped or self.status.name} after {self.seconds:.1f} s{failure}{caught}>"

    def __str__(self) -> str:
        summary = self.summary
        return "\n".join((summary, *(text for text in self.caught if text.partition(": ")[2] not in summary)))

    @property
    def summary(self) -> str:
        """How it ended, without exceptions that were caught: a log of the run has these already."""
        return "\n".join((self._ending(), *self.unanswered))

    def _ending(self) -> str:
        if self.failure is not None:
            return self.why() or f"The mission failed after {self.seconds:.1f} s."
        seconds = f"{self.seconds:.1f} s"
        rest = "" if self.standstill.alarming else f"; {self.standstill}"
        if self.stopped == "interrupted":
            return f"Interrupted after {seconds}{rest}."
        if self.stopped == EMERGENCY:
            return f"Emergency stop after {seconds}{rest}."
        if self.stopped:
            return f"Stopped after {seconds}, as asked{rest}."
        if self.status == Status.SKIPPED:
            return f"Nothing to do ({seconds}): every command was skipped."
        return f"The mission succeeded in {seconds}."

    @property
    def succeeded(self) -> bool:
        """Return whether the mission did what it should. One that had nothing to do did, too (status SKIPPED)."""
        return self.status in (Status.SUCCESS, Status.SKIPPED)
