"""Programs beside a robot's own, which can't delay it: its server (`--serve`), what dials another one (`--join`)."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from importlib.util import find_spec

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.diagnostics.files import os_error_reason
from btlang.task.commands.client import data_folder
from btlang.text.source import NOWHERE

TYPE_CHECKING = False
if TYPE_CHECKING:
    import argparse

_AGAIN = 1.0  # seconds until one that crashed is started again
_PATIENCE = 10.0  # seconds that it has to end
_ENDED = 0, 2, 130, 143
"""The exit codes of a companion that has nothing more to do, or that was refused: trying again wouldn't help."""
_PACKAGES = ("argon2", "cryptography")


def require_server(verb: str = "serve") -> None:
    """Check that the packages of the extra `server` are installed; `verb` is what needs them.

    Raises MissionError (BT200).
    """
    for package in _PACKAGES:
        if find_spec(package) is None:
            raise MissionError([diagnostic("BT200", NOWHERE, verb=verb, package=package)])


class Companion:
    """A module of btlang that runs as a process.

    It ends when its standard input, whose first line is `given`, does: also if this process is killed. `report` gets
    its lines, and a line when it ends. It has the `descriptors` of this process, by the same numbers.
    """

    def __init__(
        self,
        name: str,
        words: Sequence[str],
        given: str,
        report: Callable[[str], object],
        descriptors: Sequence[int] = (),
    ) -> None:
        self._name, self._given, self._report, self._descriptors = name, given, report, descriptors
        self._command = [sys.executable, "-P", "-m", *words]  # -P: a file beside the mission is no module
        self._began, self._closed = threading.Event(), threading.Event()
        self._spoke = False
        self._process = self._begin()
        self._thread = threading.Thread(target=self._keep, daemon=True, name=f"btlang {name}")

    def start(self) -> int:
        """Wait for its first line; return its exit code if it ended without one, else 0."""
        self._thread.start()
        self._began.wait()
        return 0 if self._spoke else self._process.wait()

    def close(self) -> None:
        """End it. May be called twice."""
        self._closed.set()
        self._process.terminate()
        try:
            self._process.wait(_PATIENCE)
        except subprocess.TimeoutExpired:
            self._process.kill()
        if self._thread.ident is not None:
            self._thread.join(_PATIENCE)

    def _begin(self) -> subprocess.Popen[str]:
        process = subprocess.Popen(
            self._command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, pass_fds=self._descriptors
        )
        assert process.stdin is not None
        with suppress(OSError):  # it has ended, and its exit code says why
            process.stdin.write(f"{self._given}\n")
            process.stdin.flush()
        return process

    def _keep(self) -> None:
        while True:
            process = self._process
            assert process.stdin is not None
            assert process.stdout is not None
            with process.stdout, process.stdin:
                for line in process.stdout:
                    self._report(line.rstrip())
                    self._spoke = True
                    self._began.set()
                code = process.wait()
            if self._closed.is_set() or code in _ENDED or not self._spoke:
                self._began.set()
                return
            self._report(f"The {self._name} ended with exit code {code}; it starts again.")
            if self._closed.wait(_AGAIN):
                return
            try:
                self._process = self._begin()
            except OSError as error:
                self._report(f"The {self._name} can't start: {os_error_reason(error)}")
                return


def require_companions(options: argparse.Namespace) -> None:
    """Check that the packages are installed that the options COMPANIONS need. Raises MissionError (BT200)."""
    if options.serve or options.join:
        require_server()


@contextmanager
def companions(options: argparse.Namespace, robot: str, report: Callable[[str], object]) -> Iterator[int]:
    """Start the companions that the options COMPANIONS ask for; give the exit code of one that can't come up, else 0.

    Raises MissionError (BT200).
    """
    require_companions(options)
    started: list[Companion] = []
    try:
        if options.serve:
            words = ["btlang", "serve", "--until-eof", "--host", options.host, "--port", str(options.port)]
            started.append(Companion("server", words, "", report))
        if options.join:
            kept = os.path.join(data_folder(robot), "server.json")
            settings = {"robot": robot, "address": options.join, "code": options.code, "kept": kept}
            started.append(
                Companion("link to the server", ["btlang.server.fleet.dialer"], json.dumps(settings), report)
            )
        yield max([each.start() for each in started], default=0)
    finally:
        for each in started:
            each.close()
