"""A process that works for an event loop, one piece of work at a time; what takes too long ends it."""

from __future__ import annotations

import asyncio
import multiprocessing
import os
import threading
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import TypeVar

    T = TypeVar("T")


class WorkerEnded(Exception):
    """The error that a piece of work took too long, or ended its process."""


class Worker:
    """A process that does pieces of work, each a function of a module and its arguments. The next one starts another.

    The caller sees to it that one piece of work waits for the other.
    """

    def __init__(self) -> None:
        self._process: ProcessPoolExecutor | None = None

    async def do(self, patience: float, work: Callable[..., T], *given: object) -> T:
        """Return the result of the work. Raises WorkerEnded if that takes more than so many seconds."""
        if self._process is None:
            self._process = ProcessPoolExecutor(1, multiprocessing.get_context("spawn"), _end_with_parent)
        loop = asyncio.get_running_loop()
        try:
            async with asyncio.timeout(patience):
                return await loop.run_in_executor(self._process, work, *given)
        except (TimeoutError, BrokenProcessPool):
            self.close()
            raise WorkerEnded from None

    def close(self) -> None:
        """End the process, whatever it does."""
        ended, self._process = self._process, None
        if ended is not None:
            for process in tuple((ended._processes or {}).values()):
                process.kill()
            ended.shutdown(wait=False, cancel_futures=True)


def _end_with_parent() -> None:
    """End the process of a worker with the one that it works for, which it would otherwise outlive."""
    threading.Thread(target=_wait_for_end, daemon=True).start()


def _wait_for_end() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
