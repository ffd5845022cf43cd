"""Runs one test on the simulated robot, as fast as it goes."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial

from btlang.api import Mission
from btlang.engine.blackboard import Blackboard
from btlang.robots.registry import Connector, body_of
from btlang.robots.world import World
from btlang.run.controls import Controls
from btlang.run.outcome import Outcome
from btlang.session import Run, Session
from btlang.support.record import Record
from btlang.testing.chaos import Chaos
from btlang.testing.commands import Command, find_command
from btlang.testing.coverage import statuses_seen
from btlang.testing.fakes import Fakes, faked
from btlang.testing.observations import Observations
from btlang.testing.script import Broken, Script
from btlang.testing.test import MissionTest
from btlang.text.source import Span
from btlang.vocabulary.lexicon import Lexicon

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.engine.leaves.leaf import LeafBinding
    from btlang.robots.body import Body
    from btlang.run.connection import Connection
    from btlang.run.events import Sink
    from btlang.vocabulary.entry import Entry


class Result(Record):
    """How a test ended: `problem` is "" where it passed, else what did not hold; `place` is its file:line.

    `seconds` are those of the mission; with `is_cut` the test took too long. `seen` are the statuses that each node of
    the mission had; see btlang.testing.coverage. `troubles` are what chaos made of the world. `line` is what did not
    hold, `at` what the mission was doing then, or what of it failed.
    """

    name: str
    place: str
    seed: int
    seconds: float
    problem: str = ""
    is_cut: bool = False
    seen: tuple[int, ...] = ()
    troubles: tuple[str, ...] = ()
    line: Span | None = None
    at: Span | None = None

    @property
    def passed(self) -> bool:
        """Whether all that the test says did hold."""
        return not self.problem


class _Connect(Record):
    """Connects to the simulated robot of a test; fakes stand in for some of its words."""

    body: Body
    fakes: Fakes

    def __call__(self, world: World) -> Connection:
        connection: Any = Connector(self.body, "simulated")(world)
        bind, fakes = connection.bind, self.fakes

        def bound(entry: Entry, vocabulary: Lexicon) -> LeafBinding | None:
            own: LeafBinding | None = bind(entry, vocabulary)
            return faked(own, entry, vocabulary, fakes, connection.bus.clock) if fakes.has(entry.id) else own

        connection.bind = bound
        return connection  # type: ignore[no-any-return]


def _connect(test: MissionTest, fakes: Fakes) -> _Connect:
    return _Connect(body_of(test.robot or "simulated"), fakes)


def run_test(
    test: MissionTest,
    seed: int = 0,
    mission: Mission | None = None,
    sinks: Iterable[Sink] = (),
    controls: Controls | None = None,
) -> Result:
    """Runs the mission of a test, or another one in its place; `controls` may end it. Raises MissionError where it
    can't run at all.
    """
    mission, controls = mission or test.mission, controls or Controls()
    observed, values, fakes = Observations(_commands(test)), Blackboard(), Fakes(test.fakes)
    outcome: Outcome | None = None
    with Session(_connect(test, fakes), world=mission.world) as session:
        run = session.prepare(
            mission, speed="max", time_limit=test.limit, seed=seed, controls=controls, values=values,
            sinks=[observed, *sinks],
        )  # fmt: skip
        script = Script(test, observed, session.robot, controls, values)
        if script.broken is None:
            run.bus.add(script)
            outcome = _executed(run, controls)
    seconds, is_cut = 0.0, False
    if outcome is not None:
        observed.outcome, observed.is_over, seconds = outcome, True, outcome.seconds
        is_cut = outcome.stopped == "time limit" and test.is_cut
        if not is_cut:
            script.end(seconds)
    result = partial(Result, test.name, test.place, seed, seconds, seen=statuses_seen(mission.tree, observed))
    if script.broken is not None:
        return result(
            _problem(script.broken, mission, outcome), line=script.broken.step.span, at=_at(script.broken, outcome)
        )
    if is_cut:
        return result(f"cut after {brief_time(test.limit)}: the mission was not over", is_cut=True)
    return result()


def run_chaos(test: MissionTest, seed: int, sinks: Iterable[Sink] = ()) -> Result:
    """Runs the mission of a test while the world goes wrong, and watches the rules of safety (see Chaos).

    What the test expects doesn't count, but its events at the start and its fakes do. Raises MissionError.
    """
    observed, controls, fakes = Observations({}), Controls(), Fakes(test.fakes)
    with Session(_connect(test, fakes), world=test.mission.world) as session:
        run = session.prepare(
            test.mission, speed="max", time_limit=test.limit, seed=seed, controls=controls, sinks=[observed, *sinks]
        )
        Script(test.replace(steps=()), observed, session.robot, controls, Blackboard())  # for its setup
        chaos = Chaos(seed, test.limit, observed, session.robot, controls, test.mission.vocabulary)
        run.bus.add(chaos)
        outcome = _executed(run, controls)
        chaos.end()
    seen = statuses_seen(test.mission.tree, observed)
    problem = "\n".join((chaos.broken, *(f"  {line}" for line in chaos.troubles))) if chaos.broken else ""
    return Result(test.name, test.place, seed, outcome.seconds, problem, seen=seen, troubles=tuple(chaos.troubles))


def _executed(run: Run, controls: Controls) -> Outcome:
    """Raises KeyboardInterrupt at Ctrl-C, which ends all tests and not only this one."""
    outcome = run.execute()
    if outcome.stopped == "interrupted" and not controls.stopped:
        raise KeyboardInterrupt
    return outcome


def _commands(test: MissionTest) -> dict[str, Command]:
    found = ((text, find_command(text, test.mission)) for text in test.texts)
    return {text: command for text, command in found if command is not None}


def _problem(broken: Broken, mission: Mission, outcome: Outcome | None) -> str:
    """The line that did not hold, when and why, and what the mission did."""
    span = broken.step.span
    lines = [f"{span.place.rpartition(':')[0]}: {span.text}", f"  after {brief_time(broken.seconds)}: {broken.reason}"]
    doing = sorted({mission.label(node) for node in broken.doing})
    if doing:
        lines.append(f"  the mission was at: {', '.join(doing)}")
    if outcome is not None and outcome.failure is not None:
        failed = outcome.failure
        lines.append(f"  the mission failed: {mission.label(failed.node)}: {failed.reason}")
    return "\n".join(lines)


def _at(broken: Broken, outcome: Outcome | None) -> Span | None:
    if outcome is not None and outcome.failure is not None:
        return outcome.failure.span
    return next((node.span for node in broken.doing if node.span is not None), None)


def brief_time(seconds: float) -> str:
    """`2 min 5.0 s`."""
    minutes, rest = divmod(round(seconds, 1), 60)
    return f"{minutes:.0f} min {rest:.1f} s" if minutes else f"{rest:.1f} s"
