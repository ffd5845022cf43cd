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
from contextlib import contextmanager, suppress

from btlang.text.output import show

PATIENCE = 20.0
"""Real seconds that a process gets to end: for halting, the robot's way to rest and the end of its connection."""
_STOPS_AFTER = 1.0  # real seconds of these after which the robot is stopped from here
_TO_END = ("SIGINT", "SIGTERM", "SIGHUP")


@contextmanager
def emergency_signal(
    stop: Callable[[], object], disable: Callable[[], object], patience: float = PATIENCE, quits: bool = False
) -> Iterator[None]:
    r"""For as long as it lasts, the signal of Ctrl-\ (SIGQUIT) calls `stop`, in a thread of its own.

    This works even if the main thread is busy in code that isn't Python's, where no handler of a signal runs. It does
    nothing where there is no such signal, where another thread than the main one asks, or where the signal is taken.

    A signal to end (with `quits` this one too) calls `disable` after a second of real time. After `patience` seconds it
    ends the process if that is still here: after `stop`, with the exit code 128 and the number of the signal.
    """
    number = getattr(signal, "SIGQUIT", None)
    main = threading.current_thread() is threading.main_thread()
    if number is not None and (not main or signal.getsignal(number) != signal.SIG_DFL):
        number = None
    if not main:
        yield
        return
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    to_end = {int(getattr(signal, name)) for name in _TO_END if hasattr(signal, name)}
    if quits and number is not None:
        to_end.add(number)

    def listen() -> None:
        stops, ends, code = math.inf, math.inf, 0
        while True:
            until = min(stops, ends)
            left = None if until == math.inf else max(0.0, until - time.monotonic())
            if not select.select([reading], [], [], left)[0]:
                if until == ends:
                    _end(stop, code)
                stops = math.inf
                with suppress(Exception):  # the run itself reports what is wrong with the robot
                    disable()
                continue
            numbers = os.read(reading, 64)
            if not numbers:
                return
            if number is not None and number in numbers:
                stop()
            ending = to_end.intersection(numbers)
            if ending and ends == math.inf:
                now = time.monotonic()
                stops, ends, code = now + min(_STOPS_AFTER, patience / 2), now + patience, 128 + min(ending)

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
