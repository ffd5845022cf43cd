"""Follows the lines of a test while its mission runs: makes happen what they say, and looks whether they hold."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from btlang.backends.engine import bind_leaf
from btlang.engine.blackboard import Blackboard
from btlang.engine.clock import Clock
from btlang.engine.engine import Engine, EngineError
from btlang.engine.status import SUCCESS
from btlang.run.bus import INLINE
from btlang.run.controls import Controls
from btlang.run.events import Event, PeriodPassed
from btlang.support.record import Record
from btlang.testing.observations import Observations
from btlang.testing.test import ALWAYS, BEFORE, EVENT, FINALLY, FOR, HOLDS, NEVER, MissionTest, Step
from btlang.tree.node import Node, Tree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_EXACT = 1e-9  # seconds


class Broken(Record):
    """A line that did not hold, when, and why, and the commands that were under way."""

    step: Step
    seconds: float
    reason: str
    doing: tuple[Node, ...] = ()


class Script:
    """A sink for one run, behind that of its observations; ends the run when nothing is left to wait for.

    Conditions are asked once in each period, with the values of the mission.
    """

    policy = INLINE

    def __init__(
        self, test: MissionTest, observed: Observations, robot: Any, controls: Controls, values: Blackboard
    ) -> None:
        self.broken: Broken | None = None
        """The first line that did not hold."""
        self._observed, self._controls = observed, controls
        services = {"robot": robot, "observed": observed, "controls": controls}
        self._ask: Callable[[Tree], str] = _Questions(test, services, values).ask
        self._steps = [step for step in test.steps if step.kind not in (ALWAYS, NEVER, FINALLY)]
        self._watches = [step for step in test.steps if step.kind in (ALWAYS, NEVER)]
        self._begins = [_before(step, test.steps) for step in self._watches]
        self._finals = [step for step in test.steps if step.kind == FINALLY]
        self._at = 0
        self._since = 0.0
        self._unmet = ""  # why the line that is waited for does not hold
        for tree in test.setup:
            self._happen(Step(EVENT, test.span, event=tree), 0.0)

    @property
    def is_done(self) -> bool:
        """Whether there is nothing left to wait for."""
        return self._at >= len(self._steps)

    def __call__(self, event: Event) -> None:
        if isinstance(event, PeriodPassed) and self.broken is None:
            self._follow(event.t)
            self._watch(event.t)
            if self.broken is not None or (self.is_done and not self._watches and not self._finals):
                self._controls.stop()

    def end(self, seconds: float) -> None:
        """The mission is over, and its outcome is known."""
        if self.broken is None:
            self._follow(seconds)
            self._watch(seconds)
        if self.broken is None and not self.is_done:
            reason = f"{self._unmet}, and the mission was over" if self._unmet else "the mission was over"
            self._break(self._steps[self._at], seconds, reason)
        for step in self._finals if self.broken is None else ():
            self._expect(step, seconds)

    def _follow(self, now: float) -> None:
        """Deals with all lines whose time has come."""
        while self._at < len(self._steps) and self.broken is None and self._deal(self._steps[self._at], now):
            self._at += 1

    def _deal(self, step: Step, now: float) -> bool:
        """Whether the line is over, and the next one begins."""
        passed = now - self._since
        due = passed >= step.seconds - _EXACT
        if step.kind in (EVENT, HOLDS):
            if not due or (step.kind == EVENT and step.condition is not None and self._ask(step.condition)):
                return False
            self._since = self._since + step.seconds if step.condition is None or step.kind == HOLDS else now
            if step.kind == EVENT:
                self._happen(step, now)
            else:
                self._expect(step, now)
            return True
        assert step.condition is not None
        reason = self._ask(step.condition)
        self._unmet = reason
        if step.kind == FOR:
            if reason:
                self._break(step, now, reason)
        elif step.kind == BEFORE:
            if reason and step.other is not None and not self._ask(step.other):
                self._break(step, now, reason)
        elif reason and due:
            self._break(step, now, reason)
        is_over = due if step.kind == FOR else not reason
        if is_over:
            self._since, self._unmet = now, ""
        return is_over

    def _watch(self, now: float) -> None:
        for step, begins in zip(self._watches, self._begins, strict=True):
            if self._at >= begins and self.broken is None:
                self._expect(step, now)

    def _expect(self, step: Step, now: float) -> None:
        assert step.condition is not None
        reason = self._ask(step.condition)
        if reason:
            self._break(step, now, reason)

    def _happen(self, step: Step, now: float) -> None:
        assert step.event is not None
        reason = self._ask(step.event)
        if reason:
            self._break(step, now, reason)

    def _break(self, step: Step, now: float, reason: str) -> None:
        self.broken = Broken(step, now, reason, tuple(self._observed.running.values()))


def _before(watch: Step, steps: tuple[Step, ...]) -> int:
    """How many lines of the script a line that always holds stands behind."""
    before = steps[: next(at for at, step in enumerate(steps) if step is watch)]
    return sum(step.kind not in (ALWAYS, NEVER, FINALLY) for step in before)


class _Questions:
    """Asks conditions, and makes happen what trees of events say; each has an engine that lasts."""

    def __init__(self, test: MissionTest, services: Mapping[str, Any], values: Blackboard) -> None:
        self._vocabulary, self._services, self._values = test.vocabulary, services, values
        self._engines: dict[int, Engine] = {}

    def ask(self, tree: Tree) -> str:
        """ "" where it is true, or done; else why not."""
        engine = self._engines.get(id(tree))
        if engine is None:
            try:
                engine = self._engines[id(tree)] = self._engine(tree)
            except EngineError as error:
                return error.message
        if engine.tick() == SUCCESS:
            return ""
        failure = engine.failure
        if failure is None:
            return "it can't be known at once"
        words = failure.span.text if failure.span is not None and tree.root.children else ""
        return f"'{words}': {failure.reason}" if words else failure.reason

    def _engine(self, tree: Tree) -> Engine:
        return Engine(
            tree, lambda node_id: bind_leaf(node_id, self._vocabulary), clock=Clock(), services=self._services,
            blackboard=self._values,
        )  # fmt: skip
