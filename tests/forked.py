"""Commands of btlang in processes of their own, forked from one that has imported the package.

Most of the time of a short command is the import of its modules. What a test starts here is a process like any other,
with an environment, a folder, streams, a group, signals and an exit code of its own.
"""

from __future__ import annotations

import gc
import json
import os
import select
import signal
import socket
import subprocess
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from runpy import run_module
from typing import IO, Any
from warnings import simplefilter

ROOT = Path(__file__).parent.parent
_PRELOADED = (
    "btlang.cli.robots", "btlang.cli.run", "btlang.lsp.features", "btlang.server.http.app", "btlang.task.layer",
    "numpy", "uvicorn",
)  # fmt: skip
_PRELOADED_FOR_ROS = (
    *_PRELOADED, "btlang.ros.mission.node", "btlang.ros.robot.robot", "btlang.ros.serving.server",
    "btlang.ros.simulator.simulator", "btlang.ros.words.binding", "rclpy.action", "rclpy.executors",
)  # fmt: skip
_MESSAGES = ("action_msgs", "geometry_msgs", "nav_msgs", "rcl_interfaces", "sensor_msgs", "std_msgs", "std_srvs")
_MOST = 1 << 20  # bytes of a request


class ForkedProcess:
    """What `subprocess.Popen` is for a process that was forked."""

    def __init__(self, pid: int, status: socket.socket, stdin: IO[Any] | None, stdout: IO[Any] | None) -> None:
        self.pid, self.stdin, self.stdout, self.stderr = pid, stdin, stdout, None
        self.returncode: int | None = None
        self._status = status

    def poll(self) -> int | None:
        return self._wait_for_status(0.0)

    def wait(self, timeout: float | None = None) -> int:
        code = self._wait_for_status(timeout)
        if code is None:
            raise subprocess.TimeoutExpired("btc", timeout or 0.0)
        return code

    def communicate(self, input: Any = None, timeout: float | None = None) -> tuple[Any, None]:
        """Only what it prints, which ends with it."""
        assert not input
        if self.stdin is not None:
            self.stdin.close()
        printed = self.stdout.read() if self.stdout is not None else None
        self.wait(timeout)
        return printed, None

    def send_signal(self, number: int) -> None:
        if self.poll() is None:
            with suppress(ProcessLookupError):
                os.kill(self.pid, number)

    def terminate(self) -> None:
        self.send_signal(signal.SIGTERM)

    def kill(self) -> None:
        self.send_signal(signal.SIGKILL)

    def __enter__(self) -> ForkedProcess:
        return self

    def __exit__(self, *_: object) -> None:
        for stream in (self.stdin, self.stdout):
            if stream is not None:
                stream.close()
        self.wait()

    def _wait_for_status(self, timeout: float | None) -> int | None:
        if self.returncode is None and select.select([self._status], [], [], timeout)[0]:
            told = self._status.recv(16)
            self._status.close()
            self.returncode = os.waitstatus_to_exitcode(int(told)) if told else -signal.SIGKILL
        return self.returncode


Process = ForkedProcess | subprocess.Popen[Any]


def popen(
    command: Sequence[Any],
    *,
    env: Mapping[str, str] | None = None,
    cwd: object = None,
    stdin: Any = None,
    stdout: Any = None,
    stderr: Any = None,
    text: bool = False,
    start_new_session: bool = False,
    for_ros: bool = False,
) -> Process:
    """A `subprocess.Popen`, or a ForkedProcess for a command of btlang that any folder has the modules of.

    With `for_ros` it is forked from a process that has imported rclpy.
    """
    words, environment = [*map(str, command)], dict(os.environ if env is None else env)
    paths = "", str(ROOT), os.environ.get("PYTHONPATH", "")
    if stderr == subprocess.PIPE or not _can_be_forked(words) or environment.get("PYTHONPATH", "") not in paths:
        options = {"stdin": stdin, "stdout": stdout, "stderr": stderr, "text": text, "cwd": cwd, "env": env}
        return subprocess.Popen(words, start_new_session=start_new_session, **options)
    mode = ("w", "r") if text else ("wb", "rb")
    given, taken = _pipe(stdin, 0) if stdin == subprocess.PIPE else (None, _descriptor(stdin, os.O_RDONLY, 0))
    read, printing = _pipe(stdout, 1) if stdout == subprocess.PIPE else (None, _descriptor(stdout, os.O_WRONLY, 1))
    complaining = os.dup(printing) if stderr == subprocess.STDOUT else _descriptor(stderr, os.O_WRONLY, 2)
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_STREAM)
    request = {
        "words": words[1:], "environment": environment, "folder": os.fspath(cwd or os.getcwd()),  # type: ignore[call-overload]
        "session": start_new_session, "niceness": os.getpriority(os.PRIO_PROCESS, 0),
    }  # fmt: skip
    descriptors = [taken, printing, complaining, theirs.fileno()]
    try:
        socket.send_fds(_server(for_ros)[0], [json.dumps(request).encode()], descriptors)
        pid = int(ours.recv(16))
    finally:
        theirs.close()
        for descriptor in descriptors[:3]:
            os.close(descriptor)
    streams = [None if end is None else os.fdopen(end, how) for end, how in ((given, mode[0]), (read, mode[1]))]
    return ForkedProcess(pid, ours, *streams)


def _can_be_forked(words: Sequence[str]) -> bool:
    """Whether a command runs a module of btlang, or a program of the tests."""
    module = words[words.index("-m") + 1] if "-m" in words[:4] else ""
    return words[0] == sys.executable and sys.platform == "linux" and module.split(".")[0] in ("btlang", "tests")


def _pipe(_: object, of: int) -> tuple[int, int]:
    """The end of this process, and that of the other one, which writes to it unless it is its input."""
    read, write = os.pipe()
    return (write, read) if of == 0 else (read, write)


def _descriptor(given: Any, flags: int, usual: int) -> int:
    if given == subprocess.DEVNULL:
        return os.open(os.devnull, flags)
    return os.dup(usual if given is None else given if isinstance(given, int) else given.fileno())


_servers: list[tuple[socket.socket, subprocess.Popen[bytes]]] = []


@cache
def _server(for_ros: bool) -> tuple[socket.socket, subprocess.Popen[bytes]]:
    """The process from which others are forked, and the connection to it, with which it ends."""
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    ours.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, _MOST)
    process = subprocess.Popen(
        [sys.executable, "-m", "tests.forked", str(theirs.fileno()), *(["ros"] if for_ros else [])], cwd=ROOT,
        pass_fds=[theirs.fileno()], stdin=subprocess.DEVNULL, start_new_session=True,
    )  # fmt: skip
    theirs.close()
    _servers.append((ours, process))
    return ours, process


def end() -> None:
    """Ends the processes from which others are forked."""
    for connection, process in _servers:
        connection.close()
        process.wait()


def _serve(server: socket.socket) -> list[str]:
    """Forks until the tests are done; in a process that was forked, its command."""
    woken, waking = os.pipe()
    os.set_blocking(waking, False)
    signal.signal(signal.SIGCHLD, lambda *_: None)
    signal.set_wakeup_fd(waking, warn_on_full_buffer=False)
    running: dict[int, int] = {}
    while True:
        ready, _, _ = select.select([server.fileno(), woken], [], [])
        if woken in ready:
            os.read(woken, 4096)
            _tell_ends(running)
        if server.fileno() not in ready:
            continue
        data, descriptors, _, _ = socket.recv_fds(server, _MOST, 4)
        if not data:
            sys.exit()
        pid = os.fork()
        if pid == 0:
            signal.set_wakeup_fd(-1)
            for descriptor in (server.fileno(), woken, waking, descriptors[3], *running.values()):
                os.close(descriptor)
            server.detach()
            return _become(json.loads(data), descriptors[:3])
        os.write(descriptors[3], f"{pid:<16}".encode())
        running[pid] = descriptors[3]
        for descriptor in descriptors[:3]:
            os.close(descriptor)


def _tell_ends(running: dict[int, int]) -> None:
    for pid, descriptor in [*running.items()]:
        done, status = os.waitpid(pid, os.WNOHANG)
        if done:
            with suppress(BrokenPipeError):
                os.write(descriptor, str(status).encode())
            os.close(running.pop(pid))


def _become(request: dict[str, Any], streams: list[int]) -> list[str]:
    """Makes of this process what the request asks for."""
    if request["session"]:
        os.setsid()
    for number, descriptor in enumerate(streams):
        os.dup2(descriptor, number)
    for descriptor in streams:
        os.close(descriptor)
    with suppress(PermissionError):
        os.setpriority(os.PRIO_PROCESS, 0, request["niceness"])
    os.environ.clear()
    os.environ.update(request["environment"])
    os.chdir(request["folder"])
    sys.path[:1] = [request["folder"], *filter(None, os.environ.get("PYTHONPATH", "").split(os.pathsep))]
    unbuffered = bool(os.environ.get("PYTHONUNBUFFERED"))
    sys.stdin = open(0, closefd=False)  # noqa: SIM115
    setattr(sys, "__stdin__", sys.stdin)  # noqa: B010
    for name, number in (("stdout", 1), ("stderr", 2)):
        stream = open(number, "w", buffering=1, closefd=False)  # noqa: SIM115
        stream.reconfigure(line_buffering=unbuffered or number == 2 or stream.isatty(), write_through=unbuffered)
        setattr(sys, name, stream)
        setattr(sys, f"__{name}__", stream)
    for number, usual in ((signal.SIGINT, signal.default_int_handler), (signal.SIGCHLD, signal.SIG_DFL)):
        signal.signal(number, usual)
    return [str(word) for word in request["words"]]


def _load_messages() -> None:
    """Loads what rclpy needs of each type of message and service, which it else does as a node first uses one."""
    with suppress(ImportError):
        for package in _MESSAGES:
            for kind in ("msg", "srv"):
                if find_spec(f"{package}.{kind}") is not None:
                    module = import_module(f"{package}.{kind}")
                    for found in [*vars(module).values()]:
                        if isinstance(found, type):
                            type(found).__import_type_support__()  # type: ignore[attr-defined]


def _main() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C in a terminal is for the tests
    for_ros = sys.argv[2:] == ["ros"]
    for name in _PRELOADED_FOR_ROS if for_ros else _PRELOADED:
        with suppress(ImportError):
            import_module(name)
    if for_ros:
        _load_messages()
    from btlang.robots.mission_vocabulary import world_vocabulary

    world_vocabulary()
    gc.collect()
    gc.freeze()
    words = _serve(socket.socket(fileno=int(sys.argv[1])))
    if words[0] == "-P":
        del words[0], sys.path[0]  # the folder
    while words[0] != "-m":
        assert words[:2] == ["-W", "ignore"], words
        simplefilter("ignore")
        del words[:2]
    sys.argv = words[1:]
    run_module(words[1], run_name="__main__", alter_sys=True)


if __name__ == "__main__":
    _main()
