"""A program that lives as long as its component: it ends with the robot, with everything it has started.

`python -m btlang.components.started_process COMMAND ...` stands between the two: it says the number of the process on
standard output, or why there is none, and kills its group when standard input is closed.
"""

from __future__ import annotations

import os
import select
import signal
import subprocess
import sys
from contextlib import suppress

from btlang.components.component import ComponentError
from btlang.text.output import show

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence

_ERRORS = 2  # where it writes what it prints: standard output is for what people asked for
_WHEELS = "_ROS_WHEELS_BOOTSTRAP_COMPLETE"  # keeps a Python of another environment from finding its own ROS 2


class StartedProcess:
    """A program in its own session. Raises ComponentError if it can't be started."""

    def __init__(self, command: Sequence[str]) -> None:
        words = [sys.executable, "-m", __name__, *command]
        self._between = subprocess.Popen(
            words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, start_new_session=True
        )
        assert self._between.stdout is not None
        said = self._between.stdout.readline().strip()
        if not said.isdecimal():
            self.close(0.0)
            raise ComponentError(f"{command[0]} can't be started: {said or 'it ended at once'}")
        self.number = int(said)
        """The number of its process."""

    @property
    def ending(self) -> str | None:
        """How it has ended, to be read after its name; None while it runs."""
        code = self._between.poll()
        if code is None:
            return None
        return f"was killed by signal {code - 128}" if code > 128 else f"ended with exit code {code}"

    def close(self, patience: float) -> None:
        """Ask it to end, and kill it if it hasn't after so many seconds. May be called twice."""
        between = self._between
        if patience and between.poll() is None:
            with suppress(ProcessLookupError):
                os.killpg(self.number, signal.SIGINT)
            with suppress(subprocess.TimeoutExpired):
                between.wait(patience)
        assert between.stdin is not None
        assert between.stdout is not None
        between.stdin.close()
        between.wait()
        between.stdout.close()


def main(command: Sequence[str]) -> int:
    """Run the program until it or the robot ends; return its exit code, or 128 plus the number of its signal."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: None)  # not ignored: the program would inherit that
    environment = {name: value for name, value in os.environ.items() if name != _WHEELS}
    try:
        process = subprocess.Popen(
            command, start_new_session=True, stdin=subprocess.DEVNULL, stdout=_ERRORS, env=environment
        )
    except OSError as problem:
        show(problem.strerror or str(problem))
        return 1
    try:
        with suppress(BrokenPipeError):  # the robot may have been killed before it knows the number
            show(str(process.pid))
        ended = os.pidfd_open(process.pid)
        select.select([ended, sys.stdin], [], [])
    finally:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
    code = process.wait()
    return code if code >= 0 else 128 - code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
