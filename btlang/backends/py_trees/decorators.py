"""Decorators and waiting leaves that py_trees doesn't have, or that do something else there; see node.py."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import ClassVar, Protocol

from btlang.backends.py_trees.node import FAILURE, RUNNING, SKIPPED, SUCCESS, UNKNOWN, Asking, Behaviour, Node, halt


class Around(Node):
    """A node of one child, with another status."""

    becomes: ClassVar[dict[object, object]] = {}

    def run(self) -> Asking:
        status = yield from self.ask(self.children[0])
        return self.becomes.get(status, status)  # type: ignore[return-value]


class SubTree(Around):
    """The tree of a subtree, under its name."""


class Inverter(Around):
    """A node that turns SUCCESS into FAILURE and the other way round; what isn't known stays a FAILURE."""

    becomes: ClassVar = {SUCCESS: FAILURE, FAILURE: SUCCESS, UNKNOWN: FAILURE}

    def run(self) -> Asking:
        status = yield from self.answer(self.children[0])
        return self.becomes.get(status, status)  # type: ignore[return-value]


class ForceSuccess(Around):
    """A node that returns SUCCESS for FAILURE."""

    becomes: ClassVar = {FAILURE: SUCCESS}


class ForceFailure(Around):
    """A node that returns FAILURE for SUCCESS."""

    becomes: ClassVar = {SUCCESS: FAILURE}


class KeepRunningUntilFailure(Around):
    """A node that is RUNNING until its child fails."""

    becomes: ClassVar = {SUCCESS: RUNNING, SKIPPED: RUNNING}


class HeldZones(Protocol):
    """Zones that the robot keeps out of, or stays in, from `begin` to `end`; not if `begin` raises an exception."""

    def begin(self) -> None: ...
    def end(self) -> None: ...


class RestrictableZones(Protocol):
    """The zones of a robot. Several of what these return may hold at the same time, also for the same names."""

    def keep_out(self, *names: str) -> HeldZones: ...
    def keep_in(self, *names: str) -> HeldZones: ...


class KeepOut(Node):
    """A node whose robot keeps out of zones until the child ends or is halted, even while it is suspended."""

    keeps_in = False
    held: HeldZones | None = None

    def __init__(
        self, name: str, children: Sequence[Behaviour], names: Sequence[str], zones: RestrictableZones | None
    ) -> None:
        self.names, self.zones = names, zones
        super().__init__(name, children)

    def begin(self) -> str:
        """Make the zones hold, unless they do. Returns the reason if that fails, else ""."""
        if self.held is not None:
            return ""
        if self.zones is None:
            return "this robot has no zones"
        if not self.names:
            return "it names no zone"
        try:
            held = (self.zones.keep_in if self.keeps_in else self.zones.keep_out)(*self.names)
            held.begin()
        except Exception as problem:  # such as an unknown zone
            return str(problem) or repr(problem)
        self.held = held
        return ""

    def end(self) -> None:
        """End the restriction."""
        held, self.held = self.held, None
        if held is not None:
            held.end()

    def halt(self, keep: bool) -> None:
        super().halt(keep)
        if not keep:
            self.end()

    def shutdown(self) -> None:
        """End the restriction where py_trees gives up the tree."""
        self.end()

    def run(self) -> Asking:
        self.feedback_message = self.begin()
        if self.feedback_message:
            return FAILURE
        try:
            status = yield from self.ask(self.children[0])
        except Exception:  # nodes of py_trees don't stop a child whose first tick raised one
            self.end()
            raise
        if status != RUNNING:
            self.end()
        return status


class KeepIn(KeepOut):
    """A node whose robot stays in zones while the child runs."""

    keeps_in = True


class Repeat(Node):
    """A node that runs its child `most` times (-1: for ever) or until it fails; after a round of one tick it is
    RUNNING.
    """

    again = SUCCESS
    count = 0
    waiting = False

    def __init__(self, name: str, children: Sequence[Behaviour], most: int) -> None:
        self.most = most
        super().__init__(name, children)

    def halt(self, keep: bool) -> None:
        super().halt(keep)
        if not keep:
            self.count, self.waiting = 0, False

    def run(self) -> Asking:
        resumed, self.waiting = self.waiting, False
        while self.count < self.most or self.most == -1:
            status = yield from self.ask(self.children[0])
            if status == RUNNING:
                self.waiting = True
                return RUNNING
            if status == SKIPPED:
                halt(self.children[0])
                return SKIPPED
            if status != self.again:
                self.count = 0
                return status
            self.count += 1
            if not resumed and (self.count < self.most or self.most == -1):
                return RUNNING
            resumed = False
        self.count = 0
        return self.again


class Retry(Repeat):
    """A node that runs its child until it succeeds, at most so many times (-1: for ever)."""

    again = FAILURE


class RunOnce(Node):
    """A node that runs its child until it completes, once; from then on it is skipped, or has the status of that
    run.
    """

    result = RUNNING

    def __init__(self, name: str, children: Sequence[Behaviour], then_skip: bool = True) -> None:
        self.then_skip = then_skip
        super().__init__(name, children)

    def run(self) -> Asking:
        if self.result == RUNNING:
            status = yield from self.ask(self.children[0])
            if status in (SUCCESS, FAILURE):
                self.result = status
            return status
        return SKIPPED if self.then_skip else self.result


class Timed(Node):
    """A node that measures time from its first tick; `now` returns the time in seconds."""

    def __init__(
        self,
        name: str,
        children: Sequence[Behaviour] = (),
        seconds: float = 0.0,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self.seconds, self.now = seconds, now
        self.kept = 0.0
        self.since: float | None = None
        super().__init__(name, children)

    def reached(self) -> bool:
        """Whether the time is over."""
        if self.since is None:
            self.since = self.now()
        return self.kept + self.now() - self.since >= self.seconds - 1e-9

    def pause(self, keep: bool) -> None:
        """Stop the watch; reset it if nothing is kept."""
        if not keep:
            self.kept = 0.0
        elif self.since is not None:
            self.kept += self.now() - self.since
        self.since = None

    def halt(self, keep: bool) -> None:
        super().halt(keep)
        self.pause(keep)


class Sleep(Timed):
    """A leaf that is RUNNING until the time is over."""

    def run(self) -> Asking:
        if not self.reached():
            return RUNNING
        self.pause(False)
        return SUCCESS
        yield self


class Delay(Timed):
    """A node that is RUNNING until the time is over, then ticks its child."""

    def run(self) -> Asking:
        if not self.reached():
            return RUNNING
        status = yield from self.ask(self.children[0])
        if status not in (RUNNING, SKIPPED):
            self.pause(False)
        return status


class Timeout(Timed):
    """A node whose child is halted and fails if it is RUNNING when the time is over. 0 is no limit."""

    def run(self) -> Asking:
        if self.seconds and self.reached():
            self.halt(False)
            return FAILURE
        status = yield from self.ask(self.children[0])
        if status != RUNNING:
            self.pause(False)
        return status


class RateController(Timed):
    """A node that ticks its child at the start, while it is RUNNING, and when the time is over since its last
    success.
    """

    fresh, runs = True, False

    def halt(self, keep: bool) -> None:
        super().halt(keep)
        if not keep:
            self.fresh, self.runs = True, False

    def run(self) -> Asking:
        due = self.reached()
        if not (self.fresh or self.runs or due):
            return RUNNING
        self.fresh = False
        status = yield from self.ask(self.children[0])
        self.runs = status == RUNNING
        if status == SUCCESS:
            self.pause(False)
            self.reached()
        if type(self.parent).__name__ != "PipelineSequence":  # which lets it wait
            if status in (SUCCESS, FAILURE):
                self.fresh, self.runs = True, False
                self.pause(False)
        return status
