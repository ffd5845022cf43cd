"""An asyncio event loop in a separate thread, for the `async def` leaves of one engine."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from threading import Thread

from btlang.engine.leaves.leaf import ActionFailed, describe_exception

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.engine.leaves.work import Work


class EventLoop:
    """An asyncio event loop that runs from when it is made until it is closed."""

    def __init__(self) -> None:
        self._loop = asyncio.new_event_loop()
        self._loop.set_exception_handler(_in_one_line)
        self._loop.set_default_executor(_Daemons())
        self._closing = asyncio.Event()
        self._thread = Thread(target=self._run, name="btlang event loop", daemon=True)
        self._thread.start()

    def start(self, call: Callable[[], Any], work: Work, over: Callable[[Work], object]) -> None:
        """Await what `call` returns, and call `over` when it has ended. Cancelling the work cancels the task."""
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
        """Cancel what is left on the loop, which then ends, and wait for that at most so many seconds."""
        self._loop.call_soon_threadsafe(self._closing.set)
        self._thread.join(patience)

    def _run(self) -> None:
        with suppress(SystemExit), asyncio.Runner(loop_factory=lambda: self._loop) as runner:
            while not self._closing.is_set():
                with suppress(SystemExit):  # of a task that a leaf began: asyncio lets it end the loop
                    runner.run(self._closed())

    async def _closed(self) -> None:
        await self._closing.wait()


class _Daemons(ThreadPoolExecutor):
    """An executor for `asyncio.to_thread` with daemon threads. At its end, Python waits for those of its own
    executors.
    """

    def submit(self, call: Callable[..., Any], /, *args: Any, **named: Any) -> Future[Any]:
        future: Future[Any] = Future()

        def run() -> None:
            if not future.set_running_or_notify_cancel():
                return
            try:
                future.set_result(call(*args, **named))
            except BaseException as problem:
                future.set_exception(problem)

        Thread(target=run, name="btlang leaf", daemon=True).start()
        return future


async def _awaited(call: Callable[[], Any], work: Work) -> None:
    try:
        work.result = await call()
    except asyncio.CancelledError as problem:  # a way to end
        work.problem = ActionFailed(describe_exception(problem))
    except BaseException as problem:
        work.problem = problem


def _in_one_line(loop: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
    """Log what an abandoned task of a leaf raised, without the traceback that asyncio would print."""
    problem = context.get("exception")
    logging.getLogger("asyncio").error("%s%s", context["message"], f": {problem!r}" if problem is not None else "")
