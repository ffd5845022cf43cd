"""What may be asked of a run while it goes on: pause, resume, a single step, stop, emergency stop."""

from __future__ import annotations

from contextlib import suppress
from threading import Lock

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Protocol

    class Stoppable(Protocol):
        """A robot, as far as an emergency stop needs it."""

        def stop(self) -> object: ...


def disable(robot: Stoppable) -> None:
    """Stops a robot, which then takes no command until it is enabled; one that cannot be disabled is just stopped."""
    getattr(robot, "disable", robot.stop)()


class Controls:
    """May be used from any thread, from keys and from signal handlers; the run takes notice before its next tick.

    `robot` is what an emergency stop stops.
    """

    def __init__(self, robot: Stoppable | None = None) -> None:
        self.robot = robot
        self._asleep = Lock()  # held but for a moment; unlike an Event it may be released within a signal handler
        self._asleep.acquire()
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
        """The robot comes to rest and the time of the mission stands still."""
        self.paused = True
        self.wake()

    def resume(self) -> None:
        """Goes on where the pause began: the commands that it interrupted start again."""
        self.paused = False
        self._steps = 0
        self.wake()

    def toggle(self) -> None:
        """Pauses, or resumes."""
        if self.paused:
            self.resume()
        else:
            self.pause()

    def step(self) -> None:
        """One more tick, then a pause."""
        self._steps += 1
        self.pause()

    def stop(self) -> None:
        """Ends the run."""
        self.stopped = True
        self.wake()

    def suspend(self) -> None:
        """Ends the run, and keeps where it was."""
        self.suspends = True
        self.stop()

    def emergency_stop(self) -> None:
        """Stops the robot at once, in this thread, whatever a leaf is doing; then ends the run.

        The robot takes no command until the next run begins, and the tree is not ticked again.
        """
        self.emergency = self.stopped = True  # first, so that no tick begins once the robot is disabled
        try:
            self.disable()
        finally:
            self.wake()

    def disable(self) -> None:
        """Stops the robot, which takes no command until the next run begins, and asks for nothing else."""
        if self.robot is not None:
            disable(self.robot)

    def take_emergency(self) -> bool:
        """Whether there was an emergency stop that has not been seen to; who asks has to halt the tree."""
        found = self.emergency
        if found:
            self.emergency = self.stopped = False
        return found

    def take_step(self) -> bool:
        """Whether a single step was asked for that has not been made; the run then makes it."""
        if self._steps <= 0:
            return False
        self._steps -= 1
        return True

    def wait(self, seconds: float | None) -> None:
        """Sleeps so many seconds (None: without end), or until something is asked for."""
        self._asleep.acquire(timeout=-1 if seconds is None else max(0.0, seconds))

    def wake(self) -> None:
        """Ends the sleep of `wait`, or the next one."""
        with suppress(RuntimeError):  # it is released already
            self._asleep.release()
