"""An asyncio event loop in a thread of its own, for the `async def` leaves of one engine."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable
from threading import Event, Thread

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.engine.background import Work


class EventLoop:
    """Runs from when it is made until it is closed."""

    def __init__(self) -> None:
        self._ready = Event()
        self._thread = Thread(target=self._run, name="btlang event loop", daemon=True)
        self._thread.start()
        self._ready.wait()

    def start(self, call: Callable[[], Any], work: Work, over: Callable[[Work], object]) -> None:
        """Awaits what `call` gives, and tells `over` when it has ended. Cancelling the work cancels the task."""
        loop = self._loop
        tasks: list[asyncio.Task[None]] = []

        def begin() -> None:
            task = loop.create_task(_awaited(call, work))
            task.add_done_callback(lambda _: over(work))  # also of a task that is cancelled before it begins
            tasks.append(task)

        def cancel() -> None:
            work.halted.set()
            loop.call_soon_threadsafe(lambda: tasks[0].cancel())

        work.cancel = cancel
        loop.call_soon_threadsafe(begin)

    def close(self, patience: float) -> None:
        """Cancels what is left on the loop, which ends after it; waits for that at most so many seconds."""
        self._loop.call_soon_threadsafe(self._closing.set)
        self._thread.join(patience)

    def _run(self) -> None:
        with asyncio.Runner() as runner:
            runner.run(self._serve())

    async def _serve(self) -> None:
        self._loop = asyncio.get_running_loop()
        self._loop.set_exception_handler(_in_one_line)
        self._closing = asyncio.Event()
        self._ready.set()
        await self._closing.wait()


async def _awaited(call: Callable[[], Any], work: Work) -> None:
    try:
        work.result = await call()
    except BaseException as problem:  # SystemExit would end the loop
        work.problem = problem


def _in_one_line(loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
    """What a task raised that a leaf left to itself, without the traceback that asyncio would print."""
    problem = context.get("exception")
    logging.getLogger("asyncio").error("%s%s", context["message"], f": {problem!r}" if problem is not None else "")
