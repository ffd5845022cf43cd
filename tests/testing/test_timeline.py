"""The lines of a test over time, against formulas over random histories of their conditions."""

from __future__ import annotations

from collections.abc import Sequence

from hypothesis import given
from hypothesis import strategies as st

from btlang.run.controls import Controls
from btlang.run.events import PeriodPassed
from btlang.testing.observations import Observations
from btlang.testing.runner import Script
from btlang.testing.test import ALWAYS, BEFORE, FINALLY, FOR, HOLDS, WITHIN, ScriptStep
from btlang.tree.node import Node, Tree
from tests.profiles import searches
from tests.testing.files import mission_test

PERIOD = 0.5
SPAN = mission_test("wave").span
FIRST, SECOND = Tree(Node("First")), Tree(Node("Second"))


class Told(Script):
    """A script whose conditions are true as two lists say, a value for each period."""

    def __init__(self, steps: Sequence[ScriptStep], first: Sequence[bool], second: Sequence[bool]) -> None:
        test = mission_test("wave").replace(steps=tuple(steps))
        super().__init__(test, Observations({}), None, Controls(), None)  # type: ignore[arg-type]
        self.histories = {id(FIRST): first, id(SECOND): second}
        self.period = 0
        self._ask = lambda tree: "" if self.histories[id(tree)][self.period] else "no"

    def play(self) -> bool:
        """Whether all held, where the mission ends with the histories."""
        count = len(self.histories[id(FIRST)])
        for self.period in range(count):
            self(PeriodPassed(self.period * PERIOD, "", 0, 0.0, 0, 0, None, None))
        self.end((count - 1) * PERIOD)
        return self.broken is None


def expected(step: ScriptStep, since: int, first: Sequence[bool], second: Sequence[bool]) -> int | None:
    """The period in which a line is over that begins in one, None where it does not hold."""
    last = len(first) - 1
    due = since + round(step.seconds / PERIOD)
    if step.kind == HOLDS:
        return due if due <= last and first[due] else None
    if step.kind == WITHIN:
        return next((at for at in range(since, min(due, last) + 1) if first[at]), None)
    if step.kind == FOR:
        return due if due <= last and all(first[since : due + 1]) else None
    found = next((at for at in range(since, last + 1) if first[at] or second[at]), None)
    return found if found is not None and first[found] else None


bools = st.lists(st.booleans(), min_size=12, max_size=12)
kinds = st.sampled_from([HOLDS, WITHIN, FOR, BEFORE])
lines = st.builds(
    lambda kind, periods: ScriptStep(kind, SPAN, FIRST, periods * PERIOD, SECOND), kinds, st.integers(0, 5)
)


@searches(100, 20000)
@given(st.lists(lines, min_size=1, max_size=4), bools, bools)
def test_lines_hold_as_the_formulas_say(steps: list[ScriptStep], first: list[bool], second: list[bool]) -> None:
    at: int | None = 0
    for step in steps:
        seconds = 0.0 if step.kind == BEFORE else step.seconds
        at = expected(step.replace(seconds=seconds), at, first, second)
        if at is None:
            break
    taken = [step.replace(seconds=0.0) if step.kind == BEFORE else step for step in steps]
    assert Told(taken, first, second).play() == (at is not None)


@searches(40, 5000)
@given(lines, bools, bools)
def test_what_holds_throughout(step: ScriptStep, first: list[bool], second: list[bool]) -> None:
    always, final = ScriptStep(ALWAYS, SPAN, SECOND), ScriptStep(FINALLY, SPAN, SECOND)
    assert Told([always], first, second).play() == all(second)
    assert Told([final], first, second).play() == second[-1]
    step = step.replace(seconds=0.0) if step.kind == BEFORE else step
    begins = expected(step, 0, first, second)
    holds = begins is not None and all(second[begins:])
    assert Told([step, always], first, second).play() == holds
