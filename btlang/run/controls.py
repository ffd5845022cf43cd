"""Controls of a run for any thread: pause, resume, step, stop; and the emergency stop at the keyboard."""

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

from btlang.support.waker import Waker
from btlang.text.output import show

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Protocol

    class Stoppable(Protocol):
        """A robot, as far as an emergency stop needs it."""

        def stop(self) -> object: ...


def disable(robot: Stoppable) -> None:
    """Stop a robot, which then takes no command until it is enabled; one that cannot be disabled is just stopped."""
    getattr(robot, "disable", robot.stop)()


class Controls:
    """The controls of a run.

    They may be used from any thread, from keys and from signal handlers; the run takes notice before its next tick.

    `robot` is what an emergency stop stops.
    """

    def __init__(self, robot: Stoppable | None = None) -> None:
        self.robot = robot
        self._waker = Waker()
        self._steps = 0
        self.paused = False
        """Whether the run stands still, or will before its next tick."""
        self.stopped = False
        """Whether the run was asked to end."""
        self.emergency = False
        """Whether that was an emergency stop."""
        self.suspends = False
        """Whether it is to end where it can go on later."""

    def pause(self) -> None:
        """Bring the robot to rest, and stop the time of the mission."""
        self.paused = True
        self.wake()

    def resume(self) -> None:
        """Go on where the pause began: the commands that it interrupted start again."""
        self.paused = False
        self._steps = 0
        self.wake()

    def toggle(self) -> None:
        """Pause, or resume."""
        if self.paused:
            self.resume()
        else:
            self.pause()

    def step(self) -> None:
        """Run one more tick, then pause."""
        self._steps += 1
        self.pause()

    def stop(self) -> None:
        """End the run."""
        self.stopped = True
        self.wake()

    def suspend(self) -> None:
        """End the run, and keep where it was."""
        self.suspends = True
        self.stop()

    def emergency_stop(self) -> None:
        """Stop the robot at once, in this thread, whatever a leaf is doing; then ends the run.

        The robot takes no command until the next run begins, and the tree is not ticked again.
        """
        self.emergency = self.stopped = True  # first, so that no tick begins once the robot is disabled
        try:
            self.disable()
        finally:
            self.wake()

    def disable(self) -> None:
        """Stop the robot, which takes no command until the next run begins, and asks for nothing else."""
        if self.robot is not None:
            disable(self.robot)

    def take_emergency(self) -> bool:
        """Return whether there was an emergency stop that has not been seen to; who asks has to halt the tree."""
        found = self.emergency
        if found:
            self.emergency = self.stopped = False
        return found

    def take_step(self) -> bool:
        """Return whether a single step was asked for that has not been made; the run then makes it."""
        if self._steps <= 0:
            return False
        self._steps -= 1
        return True

    def wait(self, seconds: float | None) -> None:
        """Sleep so many seconds (None: without end), or until something is asked for."""
        self._waker.sleep(seconds)

    def wake(self) -> None:
        """End the sleep of `wait`, or the next one."""
        self._waker.wake()


PATIENCE = 20.0
"""The real seconds that a process gets to end: for halting, the robot's way to rest and the end of its connection."""
_STOPS_AFTER = 1.0  # real seconds of these after which the robot is stopped from here
_TO_END = ("SIGINT", "SIGTERM", "SIGHUP")


@contextmanager
def emergency_signal(
    stop: Callable[[], object], disable: Callable[[], object], patience: float = PATIENCE, quits: bool = False
) -> Iterator[None]:
    r"""Let, for as long as the block lasts, the signal of Ctrl-\ (SIGQUIT) calls `stop`, in a thread of its own.

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
    """End the process, whatever its other threads do."""
    try:
        stop()
        show("The mission didn't end when it was asked to: the robot was stopped.", sys.stderr)
    finally:
        os._exit(code)
