r"""Ctrl-\ at the keyboard: an emergency stop of what runs."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def emergency_signal(stop: Callable[[], object]) -> Iterator[None]:
    r"""For as long as it lasts, the signal of Ctrl-\ (SIGQUIT) calls `stop`, in a thread of its own.

    This works even if the main thread is busy in code that isn't Python's, where no handler of a signal runs. It does
    nothing where there is no such signal, where another thread than the main one asks, or where the signal is taken.
    """
    number = getattr(signal, "SIGQUIT", None)
    main = threading.current_thread() is threading.main_thread()
    if number is None or not main or signal.getsignal(number) != signal.SIG_DFL:
        yield
        return
    reading, writing = os.pipe()
    os.set_blocking(writing, False)

    def listen() -> None:
        while numbers := os.read(reading, 64):
            if number in numbers:
                stop()

    listener = threading.Thread(target=listen, name="btlang emergency stop", daemon=True)
    listener.start()
    before = signal.set_wakeup_fd(writing, warn_on_full_buffer=False)
    signal.signal(number, lambda *_: None)  # only a signal with a handler is written to the pipe
    try:
        yield
    finally:
        signal.signal(number, signal.SIG_DFL)
        signal.set_wakeup_fd(before)
        os.close(writing)  # which ends the listener
        listener.join()
        os.close(reading)
