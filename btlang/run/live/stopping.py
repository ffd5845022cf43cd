"""Ctrl-Z: a process that is stopped gives the terminal back first, and takes it again when it goes on."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def stoppable(leave: Callable[[], object], come_back: Callable[[], object]) -> Iterator[None]:
    """Call `leave` before the process is stopped and `come_back` when it goes on, from the main thread.

    In another thread, or where there are no such signals, it does nothing.
    """
    if not hasattr(signal, "SIGTSTP") or threading.current_thread() is not threading.main_thread():
        yield
        return

    def stop(*_: object) -> None:
        leave()
        os.kill(os.getpid(), signal.SIGSTOP)

    def go_on(*_: object) -> None:
        come_back()

    before = {signal.SIGTSTP: signal.signal(signal.SIGTSTP, stop), signal.SIGCONT: signal.signal(signal.SIGCONT, go_on)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
