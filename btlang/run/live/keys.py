"""Single keys of a terminal, read in a thread of their own, and Ctrl-Z, which gives the terminal back first."""

from __future__ import annotations

import os
import re
import select
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

try:
    import termios
    import tty
except ImportError:  # Windows: the view then has no keys
    termios = tty = None  # type: ignore[assignment]

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

GONE = ""
"""A value in place of a key: the terminal is gone."""
LEFT, RIGHT = "left", "right"
"""The arrow keys that are handed on."""
_KEY = re.compile(r"\x1b(?:[\[O][0-?]*[ -/]*[@-~]?|.)?|.", re.DOTALL)  # one, or an arrow key or the like
_ARROWS = {"\x1b[C": RIGHT, "\x1bOC": RIGHT, "\x1b[D": LEFT, "\x1bOD": LEFT}
_PATIENCE = 0.2  # seconds until a process in the background looks again


class Keys:
    """A thread that calls `pressed` with each key between `begin` and `end`; those of Ctrl-C and Ctrl-Z stay signals.

    Raises OSError where the terminal cannot be read key by key.
    """

    def __init__(self, descriptor: int, pressed: Callable[[str], object]) -> None:
        if termios is None:
            raise OSError("single keys can't be read here")
        try:
            self._modes: list[Any] = termios.tcgetattr(descriptor)
        except termios.error as error:
            raise OSError(str(error)) from error
        self._descriptor = descriptor
        self._pressed = pressed
        self._woken, self._wake = os.pipe()
        self._ended = False
        self._thread = threading.Thread(target=self._read, name="btlang keys", daemon=True)

    def begin(self) -> None:
        """Let keys come at once without being shown. May be called again, after a stop of the process."""
        if self.in_front and not self._ended:
            with suppress(termios.error):  # the terminal is gone
                tty.setcbreak(self._descriptor, termios.TCSANOW)
        if not self._thread.is_alive():
            self._thread.start()

    def restore(self) -> None:
        """Restore the modes of the terminal."""
        if self.in_front:
            with suppress(termios.error):
                termios.tcsetattr(self._descriptor, termios.TCSANOW, self._modes)

    def end(self) -> None:
        """Restore the terminal, and read no further key."""
        self._ended = True
        try:
            self.restore()
        finally:
            os.write(self._wake, b".")
            if self._thread.is_alive():
                self._thread.join()
            os.close(self._woken)
            os.close(self._wake)

    @property
    def in_front(self) -> bool:
        """Return whether this process may use the terminal; one in the background would be stopped."""
        try:
            return os.tcgetpgrp(self._descriptor) == os.getpgrp()
        except OSError:  # not the terminal that controls this process, so nothing would stop it
            return True

    def _read(self) -> None:
        while not self._ended:
            ready, _, _ = select.select([self._descriptor, self._woken], [], [])
            if self._woken in ready:
                return
            if not self.in_front:
                select.select([self._woken], [], [], _PATIENCE)
                continue
            try:
                text = os.read(self._descriptor, 1024).decode(errors="ignore")
            except OSError:
                text = ""
            if not text:  # the terminal is gone, and nobody could end a pause
                self._pressed(GONE)
                return
            for key in _KEY.findall(text):
                if not key.startswith("\x1b"):
                    self._pressed(key)
                elif key in _ARROWS:
                    self._pressed(_ARROWS[key])


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
