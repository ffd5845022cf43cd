r"""Ctrl-\ at the keyboard: an emergency stop of what runs. And signals to end, which end the process in any case."""

from __future__ import annotations

import math
import os
import select
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from btlang.text.output import show

_TO_END = ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT")


@contextmanager
def emergency_signal(stop: Callable[[], object], patience: float | None = None) -> Iterator[None]:
    r"""For as long as it lasts, the signal of Ctrl-\ (SIGQUIT) calls `stop`, in a thread of its own.

    This works even if the main thread is busy in code that isn't Python's, where no handler of a signal runs. It does
    nothing where there is no such signal, where another thread than the main one asks, or where the signal is taken.

    With `patience` a signal to end, this one or another, ends the process so many seconds of real time later, if that
    is still here: after `stop`, with the exit code 128 and the number of the signal.
    """
    number = getattr(signal, "SIGQUIT", None)
    main = threading.current_thread() is threading.main_thread()
    if number is not None and (not main or signal.getsignal(number) != signal.SIG_DFL):
        number = None
    if number is None and (patience is None or not main):
        yield
        return
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    to_end = {int(getattr(signal, name)) for name in _TO_END if hasattr(signal, name)}

    def listen() -> None:
        until, code = math.inf, 0
        while True:
            left = until - time.monotonic()
            if not select.select([reading], [], [], None if left == math.inf else max(0.0, left))[0]:
                _end(stop, code)
            numbers = os.read(reading, 64)
            if not numbers:
                return
            if number is not None and number in numbers:
                stop()
            ending = to_end.intersection(numbers)
            if patience is not None and ending and until == math.inf:
                until, code = time.monotonic() + patience, 128 + min(ending)

    listener = threading.Thread(target=listen, name="btlang emergency stop", daemon=True)
    listener.start()
    before = signal.set_wakeup_fd(writing, warn_on_full_buffer=False)
    if number is not None:
        signal.signal(number, lambda *_: None)  # only a signal with a handler is written to the pipe
    try:
        yield
    finally:
        if number is not None:
            signal.signal(number, signal.SIG_DFL)
        signal.set_wakeup_fd(before)
        os.close(writing)  # which ends the listener
        listener.join()
        os.close(reading)


def _end(stop: Callable[[], object], code: int) -> None:
    """Ends the process, whatever its other threads do."""
    try:
        stop()
        show("The mission didn't end when it was asked to: the robot was stopped.", sys.stderr)
    finally:
        os._exit(code)
