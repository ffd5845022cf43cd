"""A terminal for tests: a tmux session in which a command runs, with keys to press and a screen to read."""

from __future__ import annotations

import itertools
import os
import shlex
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from pathlib import Path

REPOSITORY = Path(__file__).parent.parent.parent
BTC = (sys.executable, "-m", "btlang")

_numbers = itertools.count(1)
_LOOK_AGAIN = 0.05
_PATIENCE = 30.0


class Terminal:
    """One window of a tmux server of its own, which sees none of the user's settings, files and environment.

    `command` runs in `folder`; without one a shell waits for commands. When the command ends the screen stays, with
    `[status N]` below it. `environment` adds variables; `HOME` is an empty folder. Close it, or use it in a `with`
    statement.
    """

    def __init__(
        self,
        *command: str,
        width: int = 80,
        height: int = 24,
        folder: Path = REPOSITORY,
        environment: Mapping[str, str] | None = None,
    ) -> None:
        self._socket = f"btlang-{os.getpid()}-{next(_numbers)}"
        self._home = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        clean = {
            "PATH": os.environ["PATH"],
            "HOME": self._home.name,
            "LANG": "C.UTF-8",
            "PS1": "$ ",
            "SHELL": "/bin/sh",
        }
        clean |= {"PYTHONPATH": str(REPOSITORY), "TERM": "screen-256color"} | dict(environment or {})
        assigned = [f"{name}={value}" for name, value in clean.items()]
        shell = (
            f"trap : INT QUIT; {shlex.join(command)}; printf '[status %s]\\n' $?; exec sleep 1000"
            if command
            else "exec sh"
        )
        program = shlex.join(["env", "-i", *assigned, "sh", "-c", shell])
        self._tmux(
            "-f", os.devnull, "new-session", "-d", "-x", str(width), "-y", str(height), "-c", str(folder), program
        )

    def __enter__(self) -> Terminal:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Ends the session and all that runs in it."""
        self._run("kill-server")
        self._home.cleanup()

    # What the user does

    def press(self, *keys: str) -> None:
        """Presses keys by their tmux names: `Space`, `q`, `C-c`, `Up`, `Enter`, `Tab`."""
        self._tmux("send-keys", *keys)

    def type(self, text: str, enter: bool = True) -> None:
        """Types a text as it is, then Enter."""
        self._tmux("send-keys", "-l", text)
        if enter:
            self.press("Enter")

    def resize(self, width: int, height: int) -> None:
        """Makes the window another size."""
        self._tmux("resize-window", "-x", str(width), "-y", str(height))

    # What the user sees

    def screen(self, styles: bool = False) -> str:
        """The lines on the screen without blanks at their ends; with `styles` also the escape sequences of colours."""
        return self._captured(*["-e"] * styles)

    def history(self) -> str:
        """What a user sees who scrolls up, and the screen. Lines that were wrapped are one line."""
        return self._captured("-S", "-", "-J")

    @property
    def cursor_shown(self) -> bool:
        """Whether the cursor is visible."""
        return self._tmux("display-message", "-p", "#{cursor_flag}").strip() == "1"

    def wait_for(self, text: str, seconds: float = _PATIENCE) -> str:
        """The screen, once the text is on it. Fails after some seconds."""
        return self.wait_until(lambda screen: text in screen, f"the text {text!r}", seconds)

    def wait_until(self, holds: Callable[[str], bool], what: str = "it", seconds: float = _PATIENCE) -> str:
        """The screen, once a condition holds for it. Fails after some seconds, and shows what was on it."""
        end = time.monotonic() + seconds
        while True:
            screen = self.screen()
            if holds(screen):
                return screen
            if time.monotonic() > end:
                raise AssertionError(f"waited in vain for {what}; the screen is:\n{screen}")
            time.sleep(_LOOK_AGAIN)

    def wait_for_end(self, seconds: float = _PATIENCE) -> int:
        """The exit status of the command that the terminal was opened with, once it has ended."""
        screen = self.wait_for("[status ", seconds)
        return int(screen.rsplit("[status ", 1)[1].split("]")[0])

    def _captured(self, *options: str) -> str:
        lines = [line.rstrip() for line in self._tmux("capture-pane", "-p", *options).splitlines()]
        return "\n".join(lines).rstrip("\n") + "\n"

    def _tmux(self, *arguments: str) -> str:
        done = self._run(*arguments)
        assert done.returncode == 0, f"tmux {shlex.join(arguments)}: {done.stderr}"
        return done.stdout

    def _run(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        environment = {**os.environ, "TMUX_TMPDIR": self._home.name}  # tmux does not always remove its socket
        command = ["tmux", "-L", self._socket, *arguments]
        return subprocess.run(command, env=environment, capture_output=True, text=True, encoding="utf-8", check=False)
