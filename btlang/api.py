"""The library: text to a tree that runs."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from functools import cache, partial

from btlang.backends.data import data_mark, read_tree
from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic
from btlang.frontends.mission import DEFAULT_PARSER, read_mission
from btlang.garbage import no_collection
from btlang.passes import compile_mission, errors_of, lower_mission, run_passes
from btlang.passes.compilation import Compilation
from btlang.text.output import show
from btlang.text.source import NOWHERE, Source, Span
from btlang.tree.ast import Fact, Mission, all_facts, exact_nodes
from btlang.tree.node import Node, Tree
from btlang.vocabulary.cache import kept
from btlang.vocabulary.entry import Entry
from btlang.vocabulary.load import load_vocabulary
from btlang.vocabulary.shipped import DEFAULT_WORLD
from btlang.vocabulary.vocabulary import Vocabulary

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.engine.blackboard import Blackboard
    from btlang.engine.engine import EngineError
    from btlang.robots.simulation import Simulation
    from btlang.robots.stages import MakeStage
    from btlang.robots.world import World
    from btlang.run.controls import Controls
    from btlang.run.events import Sink
    from btlang.run.runner import Outcome, Runner
    from btlang.run.stage import Stage
    from btlang.run.story import Story

SLOWEST = 0.001  # seconds of the mission per second; slower than that is a mistake
RATES = (1.0, 1000.0)  # ticks a second; below, a robot drives blind for too long between two


def parse_tree(
    text: str | Source,
    *,
    parser: str = DEFAULT_PARSER,
    keywords: Sequence[str | Entry | Callable[..., Any]] = (),
    world: str | None = None,
    main: str = "",
) -> RunnableTree:
    """Compiles a mission in English, or a tree: a text that begins with `<` is XML of BehaviorTree.CPP, with `{` JSON.

    `parser` is "shunting-yard" or "lark" (both read the same); `keywords` are paths of keyword files, names of
    installed packs, or functions made words by `action` or `condition`; `world` is the path of a world file, by
    default the world that ships; `main` is the ID of the tree to run, where XML or JSON has several. Raises
    MissionError, which holds every diagnostic.
    """
    source = Source(text) if isinstance(text, str) else text
    with no_collection:
        vocabulary = world_vocabulary(keywords, world)
        if data_mark(source):
            compilation = run_passes(Compilation(vocabulary, tree=read_tree(source, main)))
            return RunnableTree(compilation.tree, vocabulary, world, compilation.warnings)
        if main:
            place = Span(source, 0, 0)
            raise MissionError([diagnostic("BT126", place, name=main, help="A mission in English is one tree.")])
        reading = read_mission(source, vocabulary, parser, errors_of=errors_of)
        compilation = run_passes(Compilation(vocabulary, reading.mission, warnings=reading.warnings))
    return RunnableTree(compilation.tree, vocabulary, world, compilation.warnings, mission=reading.mission)


def format_mission(
    text: str | Source,
    *,
    parser: str = DEFAULT_PARSER,
    keywords: Sequence[str | Entry | Callable[..., Any]] = (),
    world: str | None = None,
) -> str:
    """The text in the canonical layout: its words, comments and lines stay, and so does its tree.

    A text that only defines names has a layout too. Raises MissionError where something is wrong with the mission.
    """
    from btlang.english.layout import laid_out

    source = Source(text) if isinstance(text, str) else text
    if data_mark(source):
        raise MissionError([diagnostic("BT001", Span(source, 0, 1), file=source.name, reason="this is no English")])
    with no_collection:
        vocabulary = world_vocabulary(keywords, world)
        mission = read_mission(source, vocabulary, parser, errors_of=errors_of).mission
        compile_mission(mission, vocabulary, needs_command=False)
    return laid_out(source, vocabulary.articles)


def world_vocabulary(keywords: Sequence[str | Entry | Callable[..., Any]] = (), world: str | None = None) -> Vocabulary:
    """The words of the keyword files and the names of a world. Raises MissionError."""
    file = DEFAULT_WORLD if world is None else world
    return load_vocabulary(keywords, kept("world", [file], partial(_names_by_type, world)))


def _names_by_type(world: str | None) -> dict[str, tuple[str, ...]]:
    from btlang.robots.world_file import WorldError, world_names

    try:
        names = world_names(world)
    except WorldError as error:
        from btlang.robots.world_problem import world_problem

        raise world_problem(error) from None
    return {"place": names.places, "person": names.people, "object": names.objects}


def load_simulation(world: str | None = None) -> Simulation:
    """The simulated robot in the world of a file, by default the world that ships. Raises MissionError (BT070)."""
    from btlang.robots.simulation import Simulation

    return Simulation(read_world(world))


def read_world(world: str | None = None) -> World:
    """The world in a file, by default the world that ships. Raises MissionError (BT070)."""
    from btlang.robots.world_file import WorldError, load_world
    from btlang.robots.world_problem import world_problem

    try:
        return load_world(world)
    except WorldError as error:
        raise world_problem(error) from None


class RunnableTree:
    """A compiled mission, with the words and the world that it was compiled with.

    `tree` is the tree itself; `warnings` are diagnostics that do not keep it from running; `mission` is the syntax tree
    that it was compiled from, where there is one. Each run takes place in a fresh world, or on the `stage` where one is
    given, which goes on from run to run; so does a `blackboard` with the values of the mission.
    """

    def __init__(
        self,
        tree: Tree,
        vocabulary: Vocabulary,
        world: str | None = None,
        warnings: Sequence[Diagnostic] = (),
        stage: Stage | None = None,
        mission: Mission | None = None,
        blackboard: Blackboard | None = None,
    ) -> None:
        self.tree = tree
        self.mission = mission
        self.vocabulary = vocabulary
        self.world = world
        self.warnings = tuple(warnings)
        self.stage = stage
        self._blackboard = blackboard
        self.facts: Sequence[Fact] = all_facts(mission) if mission is not None else ()
        """Places of this mission, beside those of the world."""
        self.sink_errors: list[Exception] = []
        """What sinks of the latest run raised; such a sink gets no more events, and the mission goes on."""
        self._controls: Controls | None = None
        self._runner: Runner | None = None
        self._story: Story | None = None
        self._latest: Stage | None = None

    def __str__(self) -> str:
        from btlang.tree.dump import outline

        return outline(self.tree, self._described)

    def print(self) -> None:
        """Prints the tree with its branches drawn."""
        show(str(self))

    def explain(self, width: int = 100) -> str:
        """Each statement as written, in English whose brackets show how it was read, and as a tree.

        Of a tree that was no mission, its statements are those of its English. Lines are at most `width` columns long.
        Raises MissionError (BT142) where English cannot say it.
        """
        from btlang.backends.explain import explain_mission

        mission, tree = self.mission, self.tree
        if mission is None:
            mission = read_mission(Source(str(self.to("english"))), self.vocabulary).mission
            tree = lower_mission(mission, self.vocabulary)
        return explain_mission(mission, tree, self.vocabulary, self._described, width)

    def check(self) -> None:
        """Raises MissionError with all that would keep it from running, as far as that is known without the robot.

        A tree that was compiled from a mission has nothing of the kind, unless it says nodes by their ids.
        """
        if self.mission is not None and not exact_nodes(self.mission):
            return
        from btlang.backends.checking import misnamed, tree_problems

        named = self.vocabulary.with_places(tuple(fact.name for fact in self.facts))
        problems = [*tree_problems(self.tree, self.vocabulary), *misnamed(self.tree, named)]
        if problems:
            raise MissionError(problems)

    def to(self, target: str, **options: Any) -> str | bytes:
        """The tree as "xml", "english", "json" or another target of btlang.backends.targets.

        Raises ValueError for a target or an option that is not known, MissionError where the tree cannot be told so.
        """
        from btlang.backends.targets import compiled

        return compiled(self.tree, self.vocabulary, target, given={"world": self.world, "facts": self.facts}, **options)

    def label(self, node: Node) -> str:
        """The English of a leaf, `Id port=value` of any other node."""
        from btlang.english.phrase import phrase_of

        return node.name or phrase_of(node, self.vocabulary)

    def is_action(self, node: Node) -> bool:
        """Whether the node is a command of a keyword file."""
        entry = self.vocabulary.entry(node.id)
        return entry is not None and entry.sort == "action"

    @property
    def robot(self) -> Any:
        """The robot of the latest run or tick; where there was none, a simulated one."""
        if self._latest is None:
            self._start(self._stage())
        assert self._latest is not None
        return self._latest.robot

    @property
    def controls(self) -> Controls:
        """Pause, resume, single step and the stops, from any thread: of the run under way, else of the next one."""
        from btlang.run.controls import Controls

        if self._controls is None:
            stage = self._latest or self.stage
            self._controls = Controls(stage.robot if stage is not None else None)
        return self._controls

    def tick(self) -> int:
        """Ticks once and moves the simulated world on by 1/20 s; returns the status (see btlang.engine.status)."""
        runner = self._runner or self._start(self._stage())
        return runner.tick()

    def why(self, *, colour: bool = False) -> str:
        """Why the latest run or tick failed, as `btc run` tells it; "" where it did not fail.

        Tells the sentence, with `colour` underlined in red, the leaf and its reason, and what had been tried before.
        """
        from btlang.run.report import failure_report
        from btlang.text.output import RED

        failure = self._story.engine.failure if self._story is not None else None
        if failure is None or self._story is None:
            return ""
        return failure_report(failure, self._story, self.label, RED if colour else "")

    def halt(self) -> None:
        """Halts every running leaf and stops the robot; the next tick starts anew."""
        if self._runner is not None:
            self._runner.halt()

    def stop(self) -> None:
        """Ends the run under way, else the next one before its first tick; for another thread or a signal handler."""
        self.controls.stop()

    def emergency_stop(self) -> None:
        """Stops the robot at once, from any thread, without waiting for the tick under way; then the run ends.

        A leaf that hangs does not delay it, and what a leaf still commands in that tick is ignored. Where no run is
        under way the robot is stopped all the same, and the next run ends before its first tick. So does a tick of
        `tick`: it halts the tree and returns IDLE.
        """
        self.controls.emergency_stop()

    def pause(self) -> None:
        """The robot of the run under way comes to rest, and the time of the mission stands still."""
        self.controls.pause()

    def resume(self) -> None:
        """The run goes on; the commands that the pause interrupted start anew."""
        self.controls.resume()

    def step(self) -> None:
        """The run makes one more tick, then pauses."""
        self.controls.step()

    def run(
        self,
        *,
        speed: float | str = "real",
        rate: float = 20.0,
        time_limit: float | None = None,
        sinks: Iterable[Sink] = (),
        robot: str | MakeStage = "simulated",
    ) -> Outcome:
        """Runs the mission from its start until it ends, `time_limit` seconds are over, or Ctrl-C.

        `speed` is "real", "max" or a factor of real time; `rate` is in ticks a second of the mission; `sinks` get every
        event (see btlang.run.events). `robot` is "simulated", "ros", "actions", or a function that makes the stage of
        this run in the world of the mission (see btlang.run.stage); a tree that was given a stage runs on that.

        Raises MissionError where a command cannot run (BT080), or the robot lacks what it needs (BT100, BT101).
        """
        factor = {"real": 1.0, "max": math.inf}.get(speed) if isinstance(speed, str) else speed
        if factor is None or not factor >= SLOWEST:
            raise ValueError(f'speed is "real", "max" or a number from {SLOWEST} on: {speed!r}')
        if not RATES[0] <= rate <= RATES[1]:
            raise ValueError(f"rate is from {RATES[0]:g} to {RATES[1]:g} ticks a second: {rate!r}")
        stage = self._stage(robot)
        try:
            runner = self._start(stage, rate, factor, time_limit, sinks)
            try:
                return runner.run()
            finally:
                self._controls = None  # what is asked for from now on is for what comes next, a run or a tick
                runner.controls = self.controls
        finally:
            if stage is not self.stage:
                stage.close()

    def _stage(self, robot: str | MakeStage = "simulated") -> Stage:
        from btlang.robots.stages import stage_maker

        return stage_maker(robot)(read_world(self.world)) if self.stage is None else self.stage

    def _start(
        self,
        stage: Stage,
        rate: float = 20.0,
        speed: float = 1.0,
        time_limit: float | None = None,
        sinks: Iterable[Sink] = (),
    ) -> Runner:
        """A new engine on the stage."""
        from btlang.backends.engine import bind_leaf
        from btlang.engine.engine import EngineError
        from btlang.engine.timing import Stopwatch
        from btlang.robots.proxy import RobotProxy
        from btlang.robots.world import Place
        from btlang.run.runner import Runner, traced_engine
        from btlang.run.story import Story

        stage.robot.name_places(Place(fact.name, fact.x, fact.y, fact.facing) for fact in self.facts)
        stage.check(self.tree, self.vocabulary)
        stage.begin(sinks)
        try:
            engine = traced_engine(
                self.tree,
                cache(lambda id: bind_leaf(id, self.vocabulary, stage.bind)),
                clock=stage.clock,
                events=stage.events,
                services={"robot": stage.robot},
                proxies={"robot": RobotProxy},
                blackboard=self._blackboard,
                stopwatch=Stopwatch() if speed < math.inf else None,
            )
        except EngineError as error:
            raise MissionError(self._refused(error, stage)) from None
        self._story = Story(engine)
        stage.events.add(self._story)
        self.sink_errors = stage.events.errors
        self._latest = stage
        self._runner = Runner(
            engine,
            clock=stage.clock,
            robot=stage.robot,
            rate=rate,
            speed=speed,
            time_limit=time_limit,
            events=stage.events,
            controls=self.controls,
            pace=stage.pace,
        )
        return self._runner

    def _refused(self, error: EngineError, stage: Stage) -> list[Diagnostic]:
        """What to say of a tree that no engine runs: all that is wrong with it where it says nodes by their ids."""
        span = error.node.span or NOWHERE
        told = diagnostic("BT080", span, id=error.node.id, reason=error.message)
        if self.mission is not None and not exact_nodes(self.mission):
            return [told]
        from btlang.backends.checking import tree_problems
        from btlang.backends.engine import bind_leaf

        bind = cache(lambda id: bind_leaf(id, self.vocabulary, stage.bind))
        return tree_problems(self.tree, self.vocabulary, bind, {"robot": stage.robot}) or [told]

    def _described(self, node: Node) -> str:
        from btlang.tree.dump import described

        if node.children or node.id not in self.vocabulary.entries:
            return described(node)
        return f"{node.id}: {self.label(node)}"
