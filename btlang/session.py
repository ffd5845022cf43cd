"""Sessions: a robot that runs missions one after the other; and runs: one execution of a mission."""

from __future__ import annotations

import math
import os
import threading
from collections.abc import AsyncIterator, Callable, Collection, Generator, Iterable, Iterator, Mapping
from functools import cache, partial
from importlib import import_module

from btlang.backends.engine import bind_leaf, find_awaited
from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic
from btlang.engine.blackboard import Blackboard
from btlang.engine.clock import Clock, LeafTimer
from btlang.engine.engine import Engine, EngineError
from btlang.engine.leaves.leaf import ActionFailed
from btlang.engine.saving import SaveError
from btlang.robots.command_gate import RobotProxy
from btlang.robots.registry import connector
from btlang.robots.spoken_commands import SpokenCommands, choices
from btlang.robots.worlds.world import Place
from btlang.robots.worlds.world_file import read_world
from btlang.run.bus import Bus
from btlang.run.connection import RunChoices
from btlang.run.controls import Controls, disable
from btlang.run.failure_history import FailureHistory, failure_report
from btlang.run.follower import RunFollower
from btlang.run.limits import RATES, SLOWEST
from btlang.run.outcome import Outcome
from btlang.run.recent import RecentEvents
from btlang.run.runner import Runner, trace_engine
from btlang.run.snapshot import Snapshot
from btlang.run.statuses import Status
from btlang.text.formatting import RED
from btlang.text.source import NOWHERE, Source
from btlang.vocabulary.references import key_of
from btlang.vocabulary.shipped import DEFAULT_WORLD

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import TracebackType
    from typing import Any, Protocol, TypeAlias, overload

    from btlang.engine.instance import Hooks
    from btlang.pictures.terminal_map import TerminalMap
    from btlang.robots.bodies.body import Body
    from btlang.robots.registry import Connect
    from btlang.run.connection import Connection
    from btlang.run.events import Event, Sink
    from btlang.tree.ast import Fact
    from btlang.tree.node import Node, Tree
    from btlang.vocabulary.lexicon import Lexicon
    from btlang.vocabulary.load import Keywords

    class Runnable(Protocol):
        """A mission as a session needs it; see btlang.api.Mission."""

        @property
        def tree(self) -> Tree: ...

        @property
        def vocabulary(self) -> Lexicon: ...

        @property
        def facts(self) -> Sequence[Fact]: ...

        @property
        def says_ids(self) -> bool: ...

        def label(self, node: Node) -> str: ...

    class Compilable(Protocol):
        """A thing that a mission can be made from; see btlang.behavior.Behavior."""

        def mission(self, *, keywords: Keywords = ..., world: str | Source | None = ...) -> Runnable: ...

    Given: TypeAlias = Runnable | Compilable | Tree | Node | str | Source | os.PathLike[str]


_MISSION_OF = "btlang.api", "mission_of"


def _words_of(body: Body | None) -> list[str]:
    """Return the keyword files of a body."""
    if body is None or not (body.components or body.gestures):
        return []
    from btlang.components.words import words_of  # most robots have none

    return words_of(body)


class Session:
    """A robot for many runs, one after the other. Its world continues from run to run; a mission's own names don't.

    `robot` is "simulated", "ros", "actions", the path of a robot file or the name of one that ships, or a function that
    takes a World and returns a btlang.run.connection.Connection. `over` is what the robot in a file runs on, by default
    what the file says. `world` is the path of a world file, or its text. By default it is that of the robot file, else
    that of the first mission, else the one that ships. `keywords` are further words of the texts that it runs, as for
    `btlang.parse_tree`; those of the robot's components and gestures are known. Raises MissionError if the world or the
    robot can't be read (BT070, BT071) or ROS 2 can't be used (BT100), ValueError for other names.
    """

    def __init__(
        self,
        robot: str | os.PathLike[str] | Connect = "simulated",
        *,
        world: str | os.PathLike[str] | Source | None = None,
        over: str | None = None,
        keywords: Keywords = (),
    ) -> None:
        if not isinstance(robot, str | os.PathLike) and not callable(robot):
            raise TypeError(f"robot is a name, a path or a function of a World, not {robot!r}")
        connect = robot if callable(robot) else connector(os.fspath(robot), over)
        given = os.fspath(world) if isinstance(world, os.PathLike) else world
        body = getattr(connect, "body", None)
        chosen = given or getattr(body, "world", "") or None
        self._keywords, self._chosen = [*_words_of(body), *keywords], chosen
        self._connect, self._is_used = connect, chosen is not None
        self._takes_robot = robot == "simulated" and over is None
        self.world = read_world(chosen, body)
        self._connection: Connection = connect(self.world)
        self._is_simulated = getattr(connect, "over", "") == "simulated"
        self.current: Run | None = None
        """The latest run."""

    def __repr__(self) -> str:
        return f"<Session on {type(self.robot).__name__}{f', {self.current!r}' if self.current is not None else ''}>"

    def map(self, unicode: bool) -> TerminalMap | None:
        """Return the map of the world for a terminal; None for a real robot, whose room the world may not describe."""
        if not self._is_simulated:
            return None
        from btlang.pictures.terminal_map import TerminalMap

        return TerminalMap(self.world, unicode)

    @property
    def connection(self) -> Connection:
        """What connects to the robot. From now on the world stays."""
        self._is_used = True
        return self._connection

    @property
    def robot(self) -> Any:
        """See btlang.robots.robot.Robot. During a run, only for the thread of the run."""
        return self.connection.robot

    def prepare(
        self,
        mission: Given,
        *,
        speed: float | str = "real",
        rate: float = 20.0,
        time_limit: float | None = None,
        sinks: Iterable[Sink] = (),
        values: Blackboard | Mapping[str, object] | None = None,
        controls: Controls | None = None,
        seed: int | None = None,
        hooks: Hooks | None = None,
    ) -> Run:
        """Make a run that hasn't started yet: for `Run.execute` and `Run.tick`.

        `mission` is a btlang.Mission, the text of one, the path of a file (pathlib.Path), a tree or a behavior. Texts
        are read with the world and `keywords` of this session.

        `speed` is "real", "max" or a factor of real time. `rate` is in ticks per second of mission time, and the
        mission ends after `time_limit` seconds. `sinks` get events (see btlang.run.events) according to their policy
        (see btlang.run.bus). `values` are initial blackboard entries, or values by their names in the mission.
        `controls` may be created before the run. Chance follows from `seed`, by default that of the world, or another
        one for each run. `hooks` are those of an engine.

        Raises MissionError if the text has mistakes, a command can't run (BT080) or the robot lacks something it needs
        (BT101), ValueError or TypeError for another speed, rate or mission, RuntimeError during another run.
        """
        found = self._mission_of(mission)
        if self.current is not None and self.current.is_under_way:
            raise RuntimeError("another run is active; a session has one run at a time")
        factor = {"real": 1.0, "max": math.inf}.get(speed) if isinstance(speed, str) else speed
        if factor is None or not factor >= SLOWEST:
            raise ValueError(f'speed must be "real", "max" or a number from {SLOWEST} on, not {speed!r}')
        for name, number in (("rate", rate), ("time_limit", time_limit)):
            if not isinstance(number, int | float | None):
                raise TypeError(f"{name} is a number, not {number!r}")
        if not RATES[0] <= rate <= RATES[1]:
            raise ValueError(f"rate must be from {RATES[0]:g} to {RATES[1]:g} ticks a second, not {rate!r}")
        chance = self.world.seed if seed is None else seed
        if isinstance(values, Mapping):
            values = Blackboard(values={key_of(name.lower().split()): value for name, value in values.items()})
        if self.current is not None:
            self.current._is_replaced = True
        self.current = Run(found, self.connection, factor, rate, time_limit, sinks, values, controls, chance, hooks)
        return self.current

    def restore(self, mission: Given, saved: Mapping[str, Any], **options: Any) -> Run:
        """Make a run as `prepare` does, which goes on where another one was saved, maybe in another process.

        Positions, counts, timers, values and mission time are as they were; commands that were running start again.
        `saved` comes from `Run.save`. Raises MissionError (BT193) if it isn't from a run of this mission.
        """
        run = self.prepare(mission, **{**options, "seed": int(saved.get("seed", 0))})
        run._restore(saved)
        return run

    def run(self, mission: Given, **options: Any) -> Run:
        """Run a mission to its end, in this thread; what it takes is as for `prepare`. Ctrl-C ends it."""
        run = self.prepare(mission, **options)
        run.execute()
        return run

    def start(self, mission: Given, **options: Any) -> Run:
        """Run a mission as `run` does, but in a separate thread; return at once."""
        run = self.prepare(mission, **options)
        run.start()
        return run

    def _mission_of(self, given: Given) -> Runnable:
        made: Runnable
        if hasattr(given, "says_ids"):
            made = given  # type: ignore[assignment]
        else:
            module, function = _MISSION_OF
            world = self._chosen or (DEFAULT_WORLD if self._is_used else None)
            made = getattr(import_module(module), function)(given, keywords=self._keywords, world=world)
        named = getattr(made, "world", None)
        robot = getattr(made, "robot", "") if self._takes_robot else ""
        if (named is not None or robot) and not self._is_used:
            self._move_to(named, robot)
        return made

    def _move_to(self, world: str | Source | None, robot: str) -> None:
        """Begin again in the world and with the robot of the first mission, as nobody has used another one yet."""
        if robot:
            self._connect = connector(robot)
        made = read_world(world, getattr(self._connect, "body", None))
        self._connection.close()
        self.world, self._connection = made, self._connect(made)
        self._chosen = world

    def emergency_stop(self) -> None:
        """Stop the robot at once, from any thread, and end the current or prepared run before its next tick."""
        if self.current is not None:
            self.current.emergency_stop()
        else:
            disable(self.connection.robot)

    def close(self) -> None:
        """End the current run, bring the robot to rest and disconnect. May be called twice."""
        if self.current is not None and self.current.is_under_way:
            self.current.stop()
            self.current.wait(threading.TIMEOUT_MAX)
        self.connection.close()

    def __enter__(self) -> Session:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


class Run:
    """One execution of a mission, made by a Session. All methods except `execute`, `tick` and `halt` are thread-safe.

    It ends once. After that, only its results are available. `async for event in run` gives the events, and
    `await run` the outcome; both start a run that hasn't started yet, in a thread of its own, but not one that `tick`
    has begun.
    """

    def __init__(
        self,
        mission: Runnable,
        connection: Connection,
        speed: float,
        rate: float,
        time_limit: float | None,
        sinks: Iterable[Sink],
        values: Blackboard | None,
        controls: Controls | None,
        seed: int | None = None,
        hooks: Hooks | None = None,
    ) -> None:
        self.id = os.urandom(16).hex()  # what `uuid` does, whose import takes 4 ms
        self.seed = int.from_bytes(os.urandom(4), "big") if seed is None else seed
        """Of the random choices of the robot."""
        self.mission = mission
        self.controls = Controls() if controls is None else controls
        """Pause, resume, single step and the stops, from any thread."""
        self.controls.robot = self._robot = connection.robot
        self.outcome: Outcome | None = None
        """How it ended; None until then."""
        self.bus = Bus(self.id, Clock(), queued=speed < math.inf)
        self._thread: threading.Thread | None = None
        self._error: BaseException | None = None
        self._under_way = self._is_ticked = False
        self._is_replaced = False
        self._engine = self._bound(connection, sinks, values, hooks, timed=speed < math.inf)
        self._story = FailureHistory(self._engine)
        self.follower = RunFollower(self._engine)
        """The statuses of all nodes, for any thread."""
        self._recent = RecentEvents()
        self._choices = RunChoices()
        for own in (self._story, self.follower, self._recent, self._choices):
            self.bus.add(own)
        self._runner = Runner(
            self._engine, bus=self.bus, robot=connection.robot, rate=rate, speed=speed, time_limit=time_limit,
            controls=self.controls, pace=connection.pace,
        )  # fmt: skip

    def __repr__(self) -> str:
        if self.outcome is not None:
            return f"<Run {self.id[:8]}, ended: {self.outcome.status.name} after {self.outcome.seconds:.1f} s>"
        return f"<Run {self.id[:8]}, {'under way' if self._under_way else 'not started'}, {self.seconds:.1f} s>"

    def __str__(self) -> str:
        return repr(self) if self.outcome is None else str(self.outcome)

    @property
    def nodes(self) -> Engine:
        """The nodes of the tree by their numbers, after expansion of subtrees."""
        return self._engine

    @property
    def seconds(self) -> float:
        """The mission time."""
        return self.bus.clock.now

    @property
    def succeeded(self) -> bool:
        """Return whether it has ended in SUCCESS."""
        return self.outcome is not None and self.outcome.succeeded

    @property
    def is_under_way(self) -> bool:
        """Return whether it has started and hasn't ended."""
        return self._under_way

    def execute(self) -> Outcome:
        """Run to the end, in this thread, and bring the robot to rest. Once for each run.

        Raises RuntimeError if its session has prepared another run since.
        """
        self._check_is_latest()
        self._under_way = True
        try:
            self.outcome = outcome = self._explained(self._runner.run())
            return outcome
        finally:
            self._runner.end_requests()
            self.bus.close()
            self._under_way = False
            self._recent.close()

    def start(self) -> None:
        """Run as `execute` does, but in a separate thread; return at once."""
        self._check_is_latest()
        self._under_way = True
        self._thread = threading.Thread(target=self._work, name="btlang run", daemon=True)
        self._thread.start()

    if TYPE_CHECKING:

        @overload
        def wait(self, seconds: None = None) -> Outcome: ...

        @overload
        def wait(self, seconds: float) -> Outcome | None: ...

    def wait(self, seconds: float | None = None) -> Outcome | None:
        """Wait for the outcome, or return None after that many seconds. Raises what ended the run, and RuntimeError
        without `seconds` if `start` wasn't called.
        """
        if self._thread is not None:
            self._thread.join(seconds)
        if self._error is not None:
            raise self._error
        if seconds is None and self.outcome is None:
            raise RuntimeError("only a run that was started can be waited for")
        return self.outcome

    def tick(self, seconds: float | None = None) -> Status:
        """Tick once, in a loop of your own, and return the status; then that much mission time passes.

        By default it is one period of the rate. Mission time, and so a simulated world, only goes on by that: pass the
        time since the last tick on a robot that moves by itself. Once the tree completes there is an `outcome`; another
        tick starts it again. Raises ValueError for a time that isn't positive, and RuntimeError if the session has
        prepared another run since.
        """
        self._check_is_latest()
        self._is_ticked = True
        self._recent.open()
        status = Status(self._runner.tick(seconds))
        is_over = status not in (Status.RUNNING, Status.IDLE)
        self.outcome = self._explained(self._runner.completed(status)) if is_over else None
        if status != Status.RUNNING:
            self._recent.close()
        return status

    def halt(self) -> None:
        """Halt every running leaf and stop the robot; the next tick starts over."""
        self._runner.halt()
        if self._is_ticked:
            self._recent.close()

    def pause(self) -> None:
        """Bring the robot to rest, and stop the mission time."""
        self.controls.pause()

    def resume(self) -> None:
        """Continue; the commands that the pause interrupted start over."""
        self.controls.resume()

    def step(self) -> None:
        """Make one more tick, then pause."""
        self.controls.step()

    def stop(self) -> None:
        """End the run; if it hasn't started, before its first tick."""
        self.controls.stop()

    def suspend(self) -> None:
        """End the run with the outcome "suspended". `Session.restore` continues it from what `save` returns then."""
        self.controls.suspend()

    def save(self) -> dict[str, Any]:
        """Return all that `Session.restore` needs, as JSON. Waits for the moment between two ticks.

        Raises MissionError (BT192) if a value of the mission can't be saved.
        """
        try:
            saved = self._runner.between_ticks(self._engine.save)
        except SaveError as error:
            raise MissionError([diagnostic("BT192", NOWHERE, reason=str(error))]) from None
        return {**saved, **self._choices.save(), "seed": self.seed}

    def call(self, call: Callable[[], Any]) -> Any:
        """Return or raise what `call` does, in the thread of the run, between two ticks; wait until then."""
        return self._runner.between_ticks(call)

    def after_ticks(self, call: Callable[[], object]) -> None:
        """Call a function after each tick, in the thread of the run; what it raises ends the run."""
        self._runner.after_tick = call

    def _check_is_latest(self) -> None:
        if self._is_replaced:
            raise RuntimeError("its session has prepared another run since; prepare this one again")

    def _restore(self, saved: Mapping[str, Any]) -> None:
        try:
            self._engine.restore(saved)
            self._choices.restore(saved, self._robot, self.seed)
        except (SaveError, ActionFailed, KeyError, TypeError, ValueError) as error:
            raise MissionError([diagnostic("BT193", NOWHERE, reason=str(error))]) from None

    def emergency_stop(self) -> None:
        """Stop the robot at once without waiting for the current tick, then end the run.

        A hanging leaf doesn't delay it, and further commands in that tick are ignored. A `tick` halts the tree and
        returns IDLE.
        """
        self.controls.emergency_stop()

    def why(self, *, colour: bool = False) -> str:
        """Return why it failed, as in `btc run`; "" if it didn't fail.

        Shows the sentence (with `colour` underlined in red), the leaf and its reason, and the earlier failures.
        """
        failure = self._engine.failure
        if failure is None:
            return ""
        return failure_report(failure, self._story, self.mission.label, RED if colour else "")

    def events(self) -> Iterator[Event]:
        """Yield the latest events (up to btlang.run.recent.MOST_EVENTS), then new ones until the run is over."""
        return self._recent.events()

    def __aiter__(self) -> AsyncIterator[Event]:
        if not (self._under_way or self._is_ticked) and self.outcome is None:
            self.start()
        return self._recent.events_async()

    def __await__(self) -> Generator[Any, None, Outcome]:
        async def ended() -> Outcome:
            async for _ in self:
                pass
            return self.wait()  # the thread is at its end

        return ended().__await__()

    def snapshot(self) -> Snapshot:
        """Return the statuses of all nodes and the state of the robot, after the event with the number in it."""
        return self.follower.snapshot(self.mission.label)

    def statuses(self) -> dict[str, Status]:
        """Return the current or last status of each node, by its words; nodes with equal words share the latest.

        IDLE nodes were not reached, or were reset when a node above them ended.
        """
        return self.follower.statuses(self.mission.label)

    @property
    def sink_errors(self) -> list[Exception]:
        """Exceptions from sinks. Such a sink gets no more events, and the mission continues."""
        return self.bus.errors

    def _explained(self, outcome: Outcome) -> Outcome:
        return outcome.replace(why=self.why, statuses=self.statuses)  # type: ignore[no-any-return]

    def _work(self) -> None:
        try:
            self.execute()
        except BaseException as error:  # for who waits
            self._error = error

    def _bound(
        self, connection: Connection, sinks: Iterable[Sink], values: Blackboard | None, hooks: Hooks | None, timed: bool
    ) -> Engine:
        mission = self.mission
        connection.robot.name_places(Place(fact.name, fact.x, fact.y, fact.facing) for fact in mission.facts)
        if hasattr(connection.robot, "seed_choices"):
            connection.robot.seed_choices(self.seed)
        connection.check(mission.tree, mission.vocabulary)
        body: Body | None = getattr(connection.robot, "body", None)
        if body is not None and body.ears is not None:
            connection.robot.ears.choices = choices(mission.tree, mission.vocabulary)
            connection.robot.ears.commands = SpokenCommands(mission.vocabulary, body)
        for sink in sinks:
            self.bus.add(sink)
        connection.begin(self.bus)
        bind = cache(partial(_bind, mission.vocabulary, connection, find_awaited(mission.tree)))
        try:
            return trace_engine(
                mission.tree, bind, bus=self.bus, services={"robot": connection.robot}, proxies={"robot": RobotProxy},
                blackboard=values, stopwatch=LeafTimer() if timed else None, hooks=hooks,
            )  # fmt: skip
        except EngineError as error:
            raise MissionError(self._refused(error, connection)) from None

    def _refused(self, error: EngineError, connection: Connection) -> list[Diagnostic]:
        """Return the error for a tree that no engine runs: all its problems, if it names nodes by their ids."""
        mission = self.mission
        span = error.node.span or NOWHERE
        refused = diagnostic("BT080", span, id=error.node.id, reason=error.message)
        if not mission.says_ids:
            return [refused]
        from btlang.backends.checking import tree_problems  # most trees are sound

        bind = cache(partial(_bind, mission.vocabulary, connection, ()))
        return tree_problems(mission.tree, mission.vocabulary, bind, {"robot": connection.robot}) or [refused]


def _bind(vocabulary: Lexicon, connection: Connection, waits_for: Collection[str], node_id: str) -> Any:
    return bind_leaf(node_id, vocabulary, connection.bind, waits_for)
