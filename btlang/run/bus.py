"""Hands the events of a run to all who watch it, without letting them delay a tick."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable

from btlang.engine.clock import Clock
from btlang.run.events import ROBOT_EVENTS, Event, RobotEvent, StatusesChanged
from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any

    from btlang.run.events import Sink

INLINE = "inline"
"""A policy: called in the thread of the run, for sinks that only keep what they get."""
BLOCK = "block"
"""A policy: gets every event, in a thread of its own; the run waits where it is MOST_WAITING events behind."""
DROP_OLDEST = "drop oldest"
"""A policy: in a thread of its own; what is more than MOST_WAITING events behind is lost."""
NEWEST = "newest"
"""A policy: in a thread of its own; gets the latest event whenever it is ready for one."""
MOST_WAITING = 10_000
_PATIENCE = 2.0  # seconds that a sink which may lose events gets at the end


class SlowSink(Record):
    """A sink that kept the run waiting for `seconds`, or lost events."""

    sink: Sink
    seconds: float
    lost: int


class Bus:
    """The stream of one run, with its id and clock. Unless it is `queued` all sinks are called in the thread of the
    run: for runs that keep step with nothing, as with `speed="max"`.

    A sink that raises is dropped and its exception kept in `errors`: what watches a mission must not stop it.
    `before` is called before an event of another class than StatusesChanged, to publish those that came earlier.
    """

    def __init__(self, run: str = "", clock: Clock | None = None, *, queued: bool = False) -> None:
        self.run = run
        self.clock = Clock() if clock is None else clock
        self.errors: list[Exception] = []
        self.slow: list[SlowSink] = []
        """The sinks that were slow, known after `close`."""
        self.closed = False
        self.before: Callable[[], object] | None = None
        self._number = 0
        self._numbering = threading.Lock()
        self._queued = queued
        self._sinks: list[Sink] = []
        self._queues: list[_Queue] = []

    def add(self, sink: Sink) -> None:
        """Add a sink, which gets the events from now on.

        Its attribute `policy` is INLINE, BLOCK, which is usual, DROP_OLDEST or NEWEST.
        """
        policy = getattr(sink, "policy", BLOCK)
        if policy != INLINE and self._queued:
            queue = _Queue(sink, policy, self.errors.append)
            self._queues.append(queue)
            sink = queue.put
        self._sinks.append(sink)

    def emit(self, kind: type[Event], /, *data: Any, **more: Any) -> None:
        """Make an event of a class and hand it to all sinks."""
        if self.before is not None and kind is not StatusesChanged:
            self.before()
        with self._numbering:  # for no longer: an emergency stop reports from a thread of its own
            event = kind.stamp(self.clock.now, self.run, self._number, *data, **more)
            self._number += event.count
        for sink in tuple(self._sinks):
            try:
                sink(event)
            except Exception as problem:
                self._sinks.remove(sink)
                self.errors.append(problem)

    def emit_robot(self, kind: str, data: Mapping[str, Any]) -> None:
        """Emit what a robot reports with its `on_event`, as `emit` does."""
        event = ROBOT_EVENTS.get(kind)
        if event is not None:
            self.emit(event, **data)
        else:
            self.emit(RobotEvent, kind, data)

    def close(self) -> None:
        """Wait until the sinks have had what they are to get."""
        self.closed = True
        for queue in self._queues:
            queue.close()
        self.slow = [slow for queue in self._queues if (slow := queue.slow()) is not None]


class _Queue:
    """A queue that hands events to one sink in a thread of its own."""

    def __init__(self, sink: Sink, policy: str, failed: Callable[[Exception], object]) -> None:
        self._sink, self._policy, self._failed = sink, policy, failed
        most = {BLOCK: None, DROP_OLDEST: MOST_WAITING, NEWEST: 1}[policy]
        self._events: deque[Event] = deque(maxlen=most)
        self._lock = threading.RLock()  # taken by itself: a Condition may keep it where a signal interrupts
        self._changed = threading.Condition(self._lock)
        self._over = self._broken = False
        self._waited, self._lost = 0.0, 0
        self._thread = threading.Thread(target=self._hand_on, name="btlang events", daemon=True)
        self._thread.start()

    def put(self, event: Event) -> None:
        with self._lock:
            if self._broken:
                return
            if self._policy == BLOCK and len(self._events) >= MOST_WAITING:
                began = time.monotonic()
                self._changed.wait_for(lambda: len(self._events) < MOST_WAITING or self._broken)
                self._waited += time.monotonic() - began
            self._lost += len(self._events) == self._events.maxlen and self._policy == DROP_OLDEST
            self._events.append(event)
            self._changed.notify_all()

    def close(self) -> None:
        with self._lock:
            self._over = True
            self._changed.notify_all()
        self._thread.join(None if self._policy == BLOCK else _PATIENCE)

    def slow(self) -> SlowSink | None:
        return SlowSink(self._sink, self._waited, self._lost) if self._waited or self._lost else None

    def _hand_on(self) -> None:
        while True:
            with self._lock:
                self._changed.wait_for(lambda: self._events or self._over)
                if not self._events:
                    return
                event = self._events.popleft()
                self._changed.notify_all()
            try:
                self._sink(event)
            except Exception as problem:
                self._failed(problem)
                with self._lock:
                    self._broken = True
                    self._events.clear()
                    self._changed.notify_all()
                return
