"""A run of one test on the simulated robot, as fast as it goes, which follows the lines of the test."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial

from btlang.api import Mission
from btlang.backends.engine import bind_leaf
from btlang.engine.blackboard import Blackboard
from btlang.engine.clock import Clock
from btlang.engine.engine import Engine, EngineError
from btlang.engine.status import SUCCESS
from btlang.robots.registry import Connector, body_of
from btlang.robots.worlds.world import World
from btlang.run.bus import INLINE
from btlang.run.controls import Controls
from btlang.run.events import Event, PeriodPassed
from btlang.run.outcome import Outcome
from btlang.session import Run, Session
from btlang.support.record import Record
from btlang.testing.chaos import Chaos
from btlang.testing.gauges import Gauges
from btlang.testing.observations import Observations, statuses_seen
from btlang.testing.test import (
    ALWAYS,
    BEFORE,
    EVENT,
    FINALLY,
    FOR,
    HOLDS,
    NEVER,
    Fakes,
    MissionTest,
    NamedCommand,
    ScriptStep,
    find_command,
    make_fake,
)
from btlang.text.source import Span
from btlang.tree.node import Node, Tree
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.shipped import DEFAULT_WORLD

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.engine.leaves.leaf import LeafBinding
    from btlang.robots.bodies.body import Body
    from btlang.run.connection import Connection
    from btlang.run.events import Sink
    from btlang.vocabulary.entry import Entry


_EXACT = 1e-9  # seconds


class Broken(Record):
    """A line that did not hold, when, and why, and the commands that were under way."""

    step: ScriptStep
    seconds: float
    reason: str
    doing: tuple[Node, ...] = ()


class Script:
    """A sink for one run, behind that of its observations; ends the run when nothing is left to wait for.

    Conditions are asked once in each period, with the values of the mission. `gauges` bind them as the robot does.
    """

    policy = INLINE

    def __init__(
        self,
        test: MissionTest,
        observed: Observations,
        robot: Any,
        controls: Controls,
        values: Blackboard,
        gauges: Gauges | None = None,
    ) -> None:
        self.broken: Broken | None = None
        """The first line that did not hold."""
        self._observed, self._controls = observed, controls
        gauges = Gauges() if gauges is None else gauges
        services = {"robot": robot, "observed": observed, "controls": controls, "gauges": gauges}
        self._ask: Callable[[Tree], str] = _Questions(test, services, values, gauges.bind).ask
        self._steps = [step for step in test.steps if step.kind not in (ALWAYS, NEVER, FINALLY)]
        self._watches = [step for step in test.steps if step.kind in (ALWAYS, NEVER)]
        self._begins = [_before(step, test.steps) for step in self._watches]
        self._finals = [step for step in test.steps if step.kind == FINALLY]
        self._at = 0
        self._since = 0.0
        self._unmet = ""  # why the line that is waited for does not hold
        for tree in test.setup:
            self._happen(ScriptStep(EVENT, test.span, event=tree), 0.0)

    @property
    def is_done(self) -> bool:
        """Return whether there is nothing left to wait for."""
        return self._at >= len(self._steps)

    def __call__(self, event: Event) -> None:
        if isinstance(event, PeriodPassed) and self.broken is None:
            self._follow(event.t)
            self._watch(event.t)
            if self.broken is not None or (self.is_done and not self._watches and not self._finals):
                self._controls.stop()

    def end(self, seconds: float) -> None:
        """Deal with the end of the mission, whose outcome is known."""
        if self.broken is None:
            self._follow(seconds)
            self._watch(seconds)
        if self.broken is None and not self.is_done:
            reason = f"{self._unmet}, and the mission was over" if self._unmet else "the mission was over"
            self._break(self._steps[self._at], seconds, reason)
        for step in self._finals if self.broken is None else ():
            self._expect(step, seconds)

    def _follow(self, now: float) -> None:
        """Deal with all lines whose time has come."""
        while self._at < len(self._steps) and self.broken is None and self._deal(self._steps[self._at], now):
            self._at += 1

    def _deal(self, step: ScriptStep, now: float) -> bool:
        """Return whether the line is over, and the next one begins."""
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

    def _expect(self, step: ScriptStep, now: float) -> None:
        assert step.condition is not None
        reason = self._ask(step.condition)
        if reason:
            self._break(step, now, reason)

    def _happen(self, step: ScriptStep, now: float) -> None:
        assert step.event is not None
        reason = self._ask(step.event)
        if reason:
            self._break(step, now, reason)

    def _break(self, step: ScriptStep, now: float, reason: str) -> None:
        self.broken = Broken(step, now, reason, tuple(self._observed.running.values()))


def _before(watch: ScriptStep, steps: tuple[ScriptStep, ...]) -> int:
    """Return how many lines of the script a line that always holds stands behind."""
    before = steps[: next(at for at, step in enumerate(steps) if step is watch)]
    return sum(step.kind not in (ALWAYS, NEVER, FINALLY) for step in before)


class _Questions:
    """The conditions of a test, and what trees of events make happen; each has an engine that lasts."""

    def __init__(
        self,
        test: MissionTest,
        services: Mapping[str, Any],
        values: Blackboard,
        bind: Callable[[Entry, Lexicon], LeafBinding | None],
    ) -> None:
        self._vocabulary, self._services, self._values, self._bind = test.vocabulary, services, values, bind
        self._engines: dict[int, Engine] = {}

    def ask(self, tree: Tree) -> str:
        """Ask a condition; return "" where it is true, or done, else why not."""
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
            tree, lambda node_id: bind_leaf(node_id, self._vocabulary, self._bind), clock=Clock(),
            services=self._services, blackboard=self._values,
        )  # fmt: skip


class Result(Record):
    """The result of a test: `problem` is "" where it passed, else what did not hold; `place` is its file:line.

    `seconds` are those of the mission; with `is_cut` the test took too long. `seen` are the statuses that each node of
    the mission had; see observations.py. `troubles` are what chaos made of the world. `line` is what did not hold, `at`
    what the mission was doing then, or what of it failed.
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
        """Return whether all that the test says did hold."""
        return not self.problem


class _Connect(Record):
    """A connection to the simulated robot of a test; fakes stand in for some of its words, and gauges are set."""

    body: Body
    fakes: Fakes
    gauges: Gauges

    def __call__(self, world: World) -> Connection:
        connection: Any = Connector(self.body, "simulated")(world)
        fakes, gauges = self.fakes, self.gauges
        devices = getattr(connection, "devices", None)
        gauges.connect(connection.bind, {} if devices is None else devices.readers)

        def bound(entry: Entry, vocabulary: Lexicon) -> LeafBinding | None:
            own = gauges.bind(entry, vocabulary)
            return make_fake(own, entry, vocabulary, fakes, connection.bus.clock) if fakes.has(entry.id) else own

        connection.bind = bound
        return connection  # type: ignore[no-any-return]


def _connect(test: MissionTest, fakes: Fakes, gauges: Gauges) -> _Connect:
    return _Connect(body_of(test.robot or "simulated"), fakes, gauges)


def run_test(
    test: MissionTest,
    seed: int = 0,
    mission: Mission | None = None,
    sinks: Iterable[Sink] = (),
    controls: Controls | None = None,
) -> Result:
    """Run the mission of a test, or another one in its place; `controls` may end it.

    Raises MissionError where it can't run at all.
    """
    mission, controls = mission or test.mission, controls or Controls()
    observed, values, fakes = Observations(_commands(test)), Blackboard(), Fakes(test.fakes)
    outcome: Outcome | None = None
    gauges = Gauges()
    with Session(_connect(test, fakes, gauges), world=mission.world or DEFAULT_WORLD) as session:
        run = session.prepare(
            mission, speed="max", time_limit=test.limit, seed=seed, controls=controls, values=values,
            sinks=[observed, *sinks],
        )  # fmt: skip
        script = Script(test, observed, session.robot, controls, values, gauges)
        if script.broken is None:
            run.bus.add(script)
            outcome = _execute(run, controls)
        seconds, is_cut = 0.0, False
        if outcome is not None:
            observed.outcome, observed.is_over, seconds = outcome, True, outcome.seconds
            is_cut = outcome.stopped == "time limit" and test.is_cut
            if not is_cut:
                script.end(seconds)  # while the robot's components still answer
    result = partial(Result, test.name, test.place, seed, seconds, seen=statuses_seen(mission.tree, observed))
    if script.broken is not None:
        return result(
            _problem(script.broken, mission, outcome), line=script.broken.step.span, at=_at(script.broken, outcome)
        )
    if is_cut:
        return result(f"cut after {brief_time(test.limit)}: the mission was not over", is_cut=True)
    return result()


def run_chaos(test: MissionTest, seed: int, sinks: Iterable[Sink] = ()) -> Result:
    """Run the mission of a test while the world goes wrong, and watch the rules of safety (see Chaos).

    What the test expects doesn't count, but its events at the start and its fakes do. Raises MissionError.
    """
    observed, controls, fakes = Observations({}), Controls(), Fakes(test.fakes)
    gauges = Gauges()
    with Session(_connect(test, fakes, gauges), world=test.mission.world or DEFAULT_WORLD) as session:
        run = session.prepare(
            test.mission, speed="max", time_limit=test.limit, seed=seed, controls=controls, sinks=[observed, *sinks]
        )
        Script(test.replace(steps=()), observed, session.robot, controls, Blackboard(), gauges)  # for its setup
        chaos = Chaos(seed, test.limit, observed, session.robot, controls, test.mission.vocabulary)
        run.bus.add(chaos)
        outcome = _execute(run, controls)
        chaos.end()
    seen = statuses_seen(test.mission.tree, observed)
    problem = "\n".join((chaos.broken, *(f"  {line}" for line in chaos.troubles))) if chaos.broken else ""
    return Result(test.name, test.place, seed, outcome.seconds, problem, seen=seen, troubles=tuple(chaos.troubles))


def _execute(run: Run, controls: Controls) -> Outcome:
    """Raise KeyboardInterrupt at Ctrl-C, which ends all tests and not only this one."""
    outcome = run.execute()
    if outcome.stopped == "interrupted" and not controls.stopped:
        raise KeyboardInterrupt
    return outcome


def _commands(test: MissionTest) -> dict[str, NamedCommand]:
    found = ((text, find_command(text, test.mission)) for text in test.texts)
    return {text: command for text, command in found if command is not None}


def _problem(broken: Broken, mission: Mission, outcome: Outcome | None) -> str:
    """Return the line that did not hold, when and why, and what the mission did."""
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
    """Write a time such as `2 min 5.0 s`."""
    minutes, rest = divmod(round(seconds, 1), 60)
    return f"{minutes:.0f} min {rest:.1f} s" if minutes else f"{rest:.1f} s"
