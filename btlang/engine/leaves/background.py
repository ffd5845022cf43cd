"""Leaves that run concurrently with ticks: plain functions in threads, and `async def` functions on an event loop.

To the rest of the engine such a leaf is a class leaf whose `tick` looks whether its work is over. The end of the work
wakes the run. A halt asks the work to end and does not wait: until it has, the leaf is RUNNING when it is ticked and
starts nothing. Threads are daemons: one that does not end does not keep the process from ending.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from threading import Thread
from typing import cast

from btlang.engine.instance import EngineState, Fault, NodeInstance
from btlang.engine.leaves.leaf import ActionFailed, describe_exception
from btlang.engine.leaves.work import Work

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.engine.leaves.event_loop import EventLoop

HALTED = "halted"
"""The parameter by which the function of a thread gets the event that is set when it is halted."""
_CLOSING = 0.5  # seconds that an event loop gets to end when nothing works on it


class Background:
    """The background leaves of one engine. Only `over` may be called by other threads than the one that ticks."""

    def __init__(self, shared: EngineState) -> None:
        self._wake: Callable[[], object] = shared.services["wake"]
        self._proxies = shared.proxies
        self._loop: EventLoop | None = None
        self._halted: list[tuple[int, Work]] = []  # with the index of its leaf
        self._going: set[Work] = set()

    def work(self, services: Mapping[str, Any]) -> Work:
        """Make the work that is about to begin, with proxies of the services that have one."""
        work, made = Work(self._wake), self._proxies
        self._going.add(work)
        work.proxies = {name: made[name](service, work.in_tick) for name, service in services.items()}
        return work

    def start_thread(self, work: Work, call: Callable[[], object]) -> None:
        """Call a function in a separate thread."""

        def run() -> None:
            try:
                work.result = call()
            except BaseException as problem:
                work.problem = problem
            self.over(work)

        Thread(target=run, name="btlang leaf", daemon=True).start()

    def start_async(self, work: Work, call: Callable[[], Any]) -> None:
        """Await the coroutine of an `async def` function on the event loop of this engine."""
        from btlang.engine.leaves.event_loop import EventLoop

        if self._loop is None:
            self._loop = EventLoop()
        self._loop.start(call, work, self.over)

    def over(self, work: Work) -> None:
        """Note that the work has ended. Any thread may call it."""
        work.ended.set()
        self._going.discard(work)
        work.refuse()
        self._wake()

    @property
    def is_working(self) -> bool:
        """Whether anything works that was not halted."""
        return any(not work.halted.is_set() for work in tuple(self._going))

    def halt(self, index: int, work: Work) -> None:
        """Ask the work of a leaf to end, and end the calls that it has made with its services."""
        self._halted.append((index, work))
        work.cancel()
        work.refuse()
        work.let_go()

    def take_faults(self) -> list[Fault]:
        """Return what halted works have raised since the last call, but for ActionFailed, which is a way to end."""
        faults, going = [], []
        for index, work in self._halted:
            if not work.ended.is_set():
                going.append((index, work))
            elif work.problem is not None and not isinstance(work.problem, ActionFailed):
                faults.append(Fault(index, describe_exception(work.problem), work.problem))
        self._halted = going
        return faults

    def close(self, patience: float) -> list[int]:
        """End the event loop. First wait at most so many real seconds for works that were halted.

        Returns the leaves whose work goes on.
        """
        until = time.monotonic() + patience
        left = [index for index, work in self._halted if not work.ended.wait(max(0.0, until - time.monotonic()))]
        if self._loop is not None:
            self._loop.close(0.0 if left else _CLOSING)
            self._loop = None
        return left


class BackgroundLeaf:
    """A class leaf that does the work of a background leaf. `launch` begins it with the values of the ports."""

    def __init__(self, index: int, background: Background, launch: Callable[[dict[str, Any]], Work]) -> None:
        self._index = index
        self._background = background
        self._launch = launch
        self._values: dict[str, Any] = {}
        self._work: Work | None = None

    def start(self, **values: Any) -> object:
        """Begin the work, once that of a former run is over."""
        self._values = values
        return self.tick()

    def tick(self) -> object:
        """Return None while it works, then what it returned; or raise what it raised."""
        work = self._work
        if work is None or (work.halted.is_set() and work.ended.is_set()):
            self._work = self._launch(self._values)
            return None
        if work.halted.is_set():
            return None
        if not work.ended.is_set():
            work.serve()
            return None
        self._work = None
        if work.problem is not None:
            work.let_go()
            raise work.problem
        return True if work.result is None else work.result

    def halt(self) -> None:
        """Ask the work to end."""
        if self._work is not None and not self._work.halted.is_set():
            self._background.halt(self._index, self._work)


def background_leaf(
    instance: NodeInstance, call: Callable[..., Any], in_thread: bool, takes_halted: bool, services: Mapping[str, Any]
) -> BackgroundLeaf:
    """Make the leaf. `call` gets the values of the ports that are read at each start, the event `halted` if it asks for
    it, and proxies of the services.
    """
    background = cast("Background | None", instance.state.background)
    if background is None:
        background = instance.state.background = Background(instance.state)

    def launch(values: dict[str, Any]) -> Work:
        work = background.work(services)
        given = {**values, **work.proxies, **({HALTED: work.halted} if takes_halted else {})}
        (background.start_thread if in_thread else background.start_async)(work, lambda: call(**given))
        return work

    return BackgroundLeaf(instance.index, background, launch)
