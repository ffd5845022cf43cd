"""Leaves that work beside the tick, in threads and on the event loop: both behave the same."""

from __future__ import annotations

import asyncio
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import pytest

from btlang.engine.engine import Engine
from btlang.engine.instance import EngineError
from btlang.engine.leaves.leaf import ActionFailed, Failed, describe_exception
from btlang.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS
from btlang.tree.node import Node

from .scripted import World, n

PATIENCE = 20.0  # seconds of real time, for what takes a few milliseconds
LOOK_AGAIN = 0.001


class Job:
    """A leaf that works until `released` is set or it is halted, and then returns or raises `result`.

    A stubborn one goes on when it is halted.
    """

    def __init__(self, kind: str, result: object = None, stubborn: bool = False) -> None:
        self.kind = kind
        self.result = result
        self.stubborn = stubborn
        self.released = threading.Event()
        self.log: list[str] = []
        self.working = self.most = 0

    def bind(self, world: World, id: str = "A") -> Node:
        call = self.in_thread if self.kind == "thread" else self.awaited
        return world.bind(id, call, thread=self.kind == "thread")

    def in_thread(self, halted: threading.Event) -> object:
        with self._work():
            while not self.released.wait(LOOK_AGAIN):
                if halted.is_set() and not self.stubborn:
                    self.log.append("halted")
                    return self._ended()
            return self._ended()

    async def awaited(self) -> object:
        with self._work():
            while not self.released.is_set():
                try:
                    await asyncio.sleep(LOOK_AGAIN)
                except asyncio.CancelledError:
                    if not self.stubborn:
                        self.log.append("halted")
                        if self.result is None:
                            raise
                        return self._ended()
            return self._ended()

    @contextmanager
    def _work(self) -> Iterator[None]:
        self.log.append("begins")
        self.working += 1
        self.most = max(self.most, self.working)
        try:
            yield
        finally:
            self.working -= 1
            self.log.append("ends")

    def _ended(self) -> object:
        if isinstance(self.result, BaseException):
            raise self.result
        return self.result


def wait_for(holds: Callable[[], bool]) -> None:
    """Waits for what another thread does."""
    until = time.monotonic() + PATIENCE
    while not holds():
        assert time.monotonic() < until, "waited in vain"
        time.sleep(LOOK_AGAIN)


def tick_to_end(engine: Engine) -> int:
    """Ticks only when it is woken, until the tree completes."""
    woken = threading.Event()
    engine.on_wake = woken.set
    while (status := engine.tick()) == RUNNING:
        assert woken.wait(PATIENCE)
        woken.clear()
    return status


@pytest.fixture(params=["thread", "async"])
def kind(request: pytest.FixtureRequest) -> Iterator[str]:
    yield request.param
    wait_for(lambda: all(thread.name != "btlang event loop" for thread in threading.enumerate()))


@pytest.fixture
def world() -> World:
    return World()


@pytest.mark.parametrize(
    ("result", "status", "reason"),
    [
        (None, SUCCESS, ""),
        (True, SUCCESS, ""),
        (SUCCESS, SUCCESS, ""),
        (SKIPPED, SKIPPED, ""),
        (False, FAILURE, "it returned False"),
        (Failed("it is dark"), FAILURE, "it is dark"),
        ("yes", FAILURE, "it returned 'yes', which is neither True, False, None nor a status"),
        (ActionFailed("nothing within reach"), FAILURE, "nothing within reach"),
        (ValueError("seven"), FAILURE, "ValueError: seven"),
        (asyncio.CancelledError(), FAILURE, "CancelledError"),
        (SystemExit(3), FAILURE, "SystemExit: 3"),
        (SystemExit(), FAILURE, "SystemExit"),
        (GeneratorExit(), FAILURE, "GeneratorExit"),
    ],
)
def test_what_it_returns_or_raises(world: World, kind: str, result: object, status: int, reason: str) -> None:
    job = Job(kind, result)
    engine = world.engine(job.bind(world))
    assert engine.tick() == RUNNING
    assert engine.tick() == RUNNING
    job.released.set()
    assert tick_to_end(engine) == status
    if status == FAILURE:
        assert engine.failure is not None
        assert engine.failure.reason == reason
    assert job.log == ["begins", "ends"]
    assert engine.close() == []


def test_an_exception_is_kept_with_its_place(world: World, kind: str) -> None:
    problem = ValueError("seven")
    job = Job(kind, problem)
    job.released.set()
    engine = world.engine(n("Sequence", n("AlwaysSuccess"), job.bind(world)))
    assert tick_to_end(engine) == FAILURE
    assert engine.failure is not None
    assert (engine.failure.path, engine.failure.exception) == ("/1", problem)
    engine.close()


def test_a_task_that_exits_fails_its_leaf_and_the_loop_goes_on(world: World) -> None:
    async def part() -> None:
        sys.exit(3)

    async def whole() -> None:
        await asyncio.gather(part(), asyncio.sleep(0))

    async def other() -> None:
        await asyncio.sleep(LOOK_AGAIN)

    engine = world.engine(n("Sequence", n("ForceSuccess", world.bind("A", whole)), world.bind("B", other)))
    assert tick_to_end(engine) == SUCCESS
    engine.close()


def test_running_as_a_result_means_once_more(world: World, kind: str) -> None:
    job = Job(kind, RUNNING)
    job.released.set()
    engine = world.engine(job.bind(world))
    engine.tick()
    wait_for(lambda: job.log == ["begins", "ends"])
    wait_for(lambda: engine.tick() == RUNNING and len(job.log) >= 4)
    engine.halt()
    engine.close(PATIENCE)


def test_ports_are_read_at_each_start_and_services_are_there(world: World) -> None:
    seen: list[object] = []

    async def leaf(place: str, key: str, clock: object, blackboard: Any, out: Callable[[str], None]) -> None:
        seen.append((place, key, clock))
        out(blackboard.get("x") + "!")

    world.bind("A", leaf, outputs=("out",))
    engine = world.engine(n("A", place="lab", key="{x}", out="{y}"))
    for value in ("one", "two"):
        engine.blackboard.set("x", value)
        assert tick_to_end(engine) == SUCCESS
    assert seen == [("lab", "one", world.clock), ("lab", "two", world.clock)]
    assert engine.blackboard.get("y") == "two!"
    engine.close()


def test_a_halt_asks_it_to_end_and_it_starts_anew(world: World, kind: str) -> None:
    job = Job(kind)
    engine = world.engine(job.bind(world))
    engine.tick()
    wait_for(lambda: job.log == ["begins"])
    engine.halt()
    wait_for(lambda: job.log == ["begins", "halted", "ends"])
    job.released.set()
    assert tick_to_end(engine) == SUCCESS
    assert job.log == ["begins", "halted", "ends", "begins", "ends"]
    assert (engine.close(), engine.take_halt_failures()) == ([], [])


def test_a_halt_before_it_has_begun(world: World, kind: str) -> None:
    job = Job(kind)
    engine = world.engine(job.bind(world))
    for _ in range(20):
        engine.tick()
        engine.halt()
    assert engine.close(PATIENCE) == []
    assert job.most <= 1
    assert job.log.count("begins") == job.log.count("ends")


def test_a_result_that_nobody_asked_for_is_dropped(world: World, kind: str) -> None:
    job = Job(kind, False)
    job.released.set()
    engine = world.engine(job.bind(world))
    engine.tick()
    wait_for(lambda: job.log == ["begins", "ends"])
    engine.halt()
    job.result = True
    assert tick_to_end(engine) == SUCCESS
    assert engine.close(PATIENCE) == []


def test_one_that_ignores_a_halt_is_not_started_twice_and_is_told(world: World, kind: str) -> None:
    job = Job(kind, stubborn=True)
    engine = world.engine(n("Sequence", n("AlwaysSuccess"), job.bind(world)))
    engine.tick()
    wait_for(lambda: job.log == ["begins"])
    began = time.monotonic()
    engine.halt()
    assert time.monotonic() - began < 1.0
    for _ in range(3):
        assert engine.tick() == RUNNING
    assert job.log == ["begins"]
    engine.halt()  # while it waits for the former run
    [failure] = engine.close(0.01)
    assert (failure.path, failure.node.id) == ("/1", "A")
    assert engine.tick() == RUNNING
    job.released.set()
    assert tick_to_end(engine) == SUCCESS
    assert (job.log, job.most) == (["begins", "ends"] * 2, 1)
    assert engine.close(PATIENCE) == []


@pytest.mark.parametrize("problem", [ValueError("stuck"), SystemExit("stuck")])
def test_what_it_raises_when_it_is_halted_is_told(world: World, kind: str, problem: BaseException) -> None:
    job = Job(kind, problem)
    engine = world.engine(n("Sequence", n("AlwaysSuccess"), job.bind(world)))
    engine.tick()
    wait_for(lambda: job.log == ["begins"])
    engine.halt()
    assert engine.close(PATIENCE) == []
    [failure] = engine.take_halt_failures()
    assert (failure.path, failure.reason, failure.exception) == ("/1", describe_exception(problem), problem)
    assert engine.take_halt_failures() == []


def test_to_fail_is_a_way_to_end_after_a_halt(world: World, kind: str) -> None:
    job = Job(kind, ActionFailed("I was halted"))
    engine = world.engine(job.bind(world))
    engine.tick()
    engine.halt()
    assert engine.close(PATIENCE) == []
    assert engine.take_halt_failures() == []


def test_a_guard_interrupts_it(world: World, kind: str) -> None:
    job = Job(kind)
    holds = [True]
    world.bind("Guard", lambda: holds[0])
    engine = world.engine(n("ReactiveSequence", n("Guard"), job.bind(world)))
    assert engine.tick() == RUNNING
    wait_for(lambda: job.log == ["begins"])
    holds[0] = False
    assert engine.tick() == FAILURE
    wait_for(lambda: job.log == ["begins", "halted", "ends"])
    engine.close(PATIENCE)


def test_it_interrupts_what_a_reactive_node_ran_before(world: World, kind: str) -> None:
    """The other action is halted before the work begins, as for any leaf that takes time."""
    job = Job(kind)
    holds = [False]
    world.bind("Guard", lambda: holds[0])
    other = world.cls("B", "r")
    engine = world.engine(n("ReactiveFallback", n("Sequence", n("Guard"), job.bind(world)), other))
    engine.tick()
    holds[0] = True
    begin = job._work
    job._work = lambda: (job.log.append(str(world.log)), begin())[1]  # type: ignore[method-assign,func-returns-value]
    engine.tick()
    wait_for(lambda: "begins" in job.log)
    assert job.log == ["['B.start', 'B.halt']", "begins"]
    engine.halt()
    assert engine.close(PATIENCE) == []


def test_a_pause_cancels_it_and_it_starts_anew(world: World, kind: str) -> None:
    job = Job(kind)
    engine = world.engine(n("Sequence", world.fn("Once", "s"), job.bind(world)))
    engine.tick()
    wait_for(lambda: job.log == ["begins"])
    engine.suspend()
    wait_for(lambda: job.log == ["begins", "halted", "ends"])
    job.released.set()
    assert tick_to_end(engine) == SUCCESS
    assert world.log == ["Once"]
    engine.close()


def test_two_side_by_side(world: World, kind: str) -> None:
    jobs = Job(kind), Job(kind)
    engine = world.engine(n("Parallel", jobs[0].bind(world, "A"), jobs[1].bind(world, "B")))
    assert engine.tick() == RUNNING
    wait_for(lambda: jobs[0].log == jobs[1].log == ["begins"])
    jobs[1].released.set()
    wait_for(lambda: jobs[1].working == 0)
    assert engine.tick() == RUNNING
    jobs[0].released.set()
    assert tick_to_end(engine) == SUCCESS
    engine.close()


def test_asyncio_leaves_share_one_loop_which_ends_with_the_run(world: World) -> None:
    loops: list[Any] = []

    async def leaf() -> None:
        loops.append((asyncio.get_running_loop(), threading.current_thread()))
        await asyncio.sleep(LOOK_AGAIN)

    world.bind("A", leaf)
    before = set(threading.enumerate())
    engine = world.engine(n("Parallel", n("A"), n("A")))
    assert set(threading.enumerate()) == before
    assert tick_to_end(engine) == SUCCESS
    assert len(set(loops)) == 1
    loop, thread = loops[0]
    assert (thread in before, thread.daemon) == (False, True)
    engine.close()
    assert loop.is_closed()
    assert not thread.is_alive()


def test_threads_that_a_leaf_waits_for(world: World) -> None:
    def fails() -> None:
        raise ActionFailed(threading.current_thread().name)

    async def leaf() -> None:
        assert await asyncio.to_thread(lambda: threading.current_thread().daemon)
        await asyncio.to_thread(fails)

    engine = world.engine(world.bind("A", leaf))
    assert tick_to_end(engine) == FAILURE
    assert engine.failure is not None
    assert engine.failure.reason == "btlang leaf"
    engine.close()


def test_what_a_leaf_left_on_the_loop_is_one_line(world: World, caplog: pytest.LogCaptureFixture) -> None:
    async def lost() -> None:
        raise ValueError("lost")

    async def leaf() -> None:
        asyncio.get_running_loop().create_task(lost())
        await asyncio.sleep(LOOK_AGAIN)

    engine = world.engine(world.bind("A", leaf))
    assert tick_to_end(engine) == SUCCESS
    engine.close()
    assert caplog.messages == ["Task exception was never retrieved: ValueError('lost')"]
    assert [record.exc_info for record in caplog.records] == [None]


def test_only_a_plain_function_can_be_a_thread(world: World) -> None:
    async def asynchronous() -> None: ...

    def generator() -> Iterator[None]:
        yield

    class Leaf:
        start = tick = halt = lambda self: None

    for call in (asynchronous, generator, Leaf):
        with pytest.raises(EngineError, match="A can't run in a thread: only a plain function can"):
            world.engine(world.bind("A", call, thread=True))


def test_only_a_thread_gets_the_event_of_its_halt(world: World) -> None:
    with pytest.raises(EngineError, match="A needs a value for halted"):
        world.engine(world.bind("A", lambda halted: None))
