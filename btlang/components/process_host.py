"""A component in its own process, which contains crashes, leaks and endless loops."""

from __future__ import annotations

import math
import os
import signal
import socket
import struct
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from hashlib import sha256
from multiprocessing.connection import Connection

from btlang.components.calls import pack, pack_error, unpack
from btlang.components.component import ACTIVE, SHARED, UNCONFIGURED, ComponentError
from btlang.components.remote_leaf import RemoteLeaf, WorkerRequest
from btlang.devices.driver import DeviceError
from btlang.engine.leaves.leaf import ActionFailed, NotThere, Unknown, describe_exception
from btlang.robots.files import socket_folder

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.robots.bodies.body import ComponentPart

_BEAT = 0.1  # seconds between two looks at it
_ANSWER = 0.2  # seconds that a tick waits for a condition: late is better than not known
_SEND = struct.pack("ll", 0, 300_000)  # seconds and microseconds after which a process that reads nothing is given up
_ERRORS = 2  # where it writes what it prints: standard output is for what people asked for
_LOADING = 60.0  # seconds that a process gets to start, and to import what its class needs, on a busy computer
_LONGEST = 64 << 20  # bytes of a message: a picture of a camera has room
_END = 0.5  # seconds that a process gets to end by itself


class ProcessHost:
    """A host in another process. `changed` is called, from any thread, when there is something to look at."""

    def __init__(
        self,
        part: ComponentPart,
        file: str,
        devices: Mapping[str, Any],
        changed: Callable[[], object],
        report: Callable[[str, Mapping[str, Any]], object],
    ) -> None:
        self._part, self._file, self._devices = part, file, devices
        self._changed, self._report = changed, report
        self._process: subprocess.Popen[bytes] | None = None
        self._connection: Connection | None = None
        self._sending, self._numbering = threading.Lock(), threading.Lock()
        self._requests: dict[int, WorkerRequest] = {}
        self._numbers = 0
        self._lost: str | None = None
        self._heard = math.inf  # until it says something first
        self._beaten = 0.0
        self._reader: threading.Thread | None = None
        self._peer: int | None = None
        self._hangs = False
        self.state = UNCONFIGURED
        self.problem = ""

    @property
    def process(self) -> int | None:
        """The number of its process, while there is one."""
        if self._part.shared:
            return self._peer
        return self._process.pid if self._process is not None and self._process.poll() is None else None

    def _connect_own(self) -> socket.socket:
        """Return a socket to a new process of its own."""
        ours, its = socket.socketpair()
        with its:
            words = [str(its.fileno()), str(os.getpid())]
            self._process = _begin(words, pass_fds=[its.fileno()])
        return ours

    def _connect_shared(self) -> socket.socket:
        """Return a socket to the process that other robots of this user share; start it if there is none."""
        path = os.path.join(socket_folder(), f"component-{sha256(self._part.shared.encode()).hexdigest()[:16]}.sock")
        link, until = socket.socket(socket.AF_UNIX), time.monotonic() + _LOADING
        while True:
            try:
                link.connect(path)
                break
            except OSError as problem:
                if time.monotonic() > until:
                    link.close()
                    raise ComponentError(f"can't be reached: {problem}") from None
            with _begin([SHARED, path]) as process:
                process.wait()
            time.sleep(_BEAT / 2)
        self._peer = int(struct.unpack("3i", link.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, 12))[0])
        return link

    def load(self) -> Mapping[str, Any]:
        link = self._connect_own() if not self._part.shared else self._connect_shared()
        link.setsockopt(socket.SOL_SOCKET, socket.SO_SNDTIMEO, _SEND)
        self._connection = Connection(link.detach())
        self._reader = threading.Thread(target=self._read, name="btlang component", daemon=True)
        self._reader.start()
        part = self._part
        value = self._wait(
            self._request(
                "load", place=part.place, folder=os.path.dirname(self._file), file=self._file, name=part.name,
                devices=list(self._devices), parameters=dict(part.parameters),
            ),
            "load",
            _LOADING,
        )  # fmt: skip
        return dict(value)

    def transition(self, name: str) -> None:
        self._wait(self._request(name), name, self._part.limit)

    def look(self) -> str | None:
        """Implement Host; call this every 0.1 s. It asks for the state each time: a slow answer alone is no failure."""
        if self._lost is None and self._connection is not None:
            now = time.monotonic()
            if now - self._heard > self._part.silence:
                self._hangs = True
                self._disconnect(f"hasn't answered for {now - self._heard:.1f} s")
            elif now - self._beaten >= _BEAT:
                self._beaten = now
                done = [number for number, request in tuple(self._requests.items()) if request.done.is_set()]
                self._send({"beat": done})
        return self._lost or (self.problem or None)

    def leaf(
        self, method: str, outputs: tuple[str, ...], robot: Any, wake: Callable[[], object], beside: set[object]
    ) -> RemoteLeaf:
        return RemoteLeaf(self, method, outputs, robot, wake, beside)

    def ask(self, method: str, ports: Mapping[str, Any], robot: Any) -> Any:
        """Implement Host. Questions to the robot are answered at once in the meantime."""
        news = threading.Event()
        leaf = RemoteLeaf(self, method, (), robot, news.set, set())
        leaf.start(**ports)
        until = time.monotonic() + _ANSWER
        while not leaf.poll():
            if not news.wait(until - time.monotonic()):
                leaf.halt()
                raise Unknown(f"the {self._part.name} hasn't answered")
            news.clear()
        return leaf.result()

    def begin(self, method: str, arguments: dict[str, Any], wake: Callable[[], object]) -> WorkerRequest:
        """Call a method. Raises ActionFailed if it can't be called now."""
        if self._lost is not None or self.state != ACTIVE:
            raise ActionFailed(NotThere(f"the {self._part.name} {self._lost or f'is {self.state}'}"))
        return self._request("call", wake, method=method, arguments=arguments)

    def halt(self, request: WorkerRequest) -> None:
        """Cancel a request."""
        self._send({"halt": request.number})
        request.end({"problem": "it was halted"})

    def answer(self, request: WorkerRequest, asked: dict[str, Any], answer: dict[str, Any]) -> None:
        """Answer a question of a call."""
        message = {"answer": asked["ask"], "call": request.number, **answer}
        try:
            pack(message)
        except TypeError as problem:
            message = {"answer": asked["ask"], "call": request.number, "problem": str(problem)}
        if asked["ask"] == request.latest:
            request.answer = message
        self._send(message)

    def close(self) -> None:
        """Implement Host. The process ends with the socket; if it doesn't, it is killed with everything that it has
        started.
        """
        patience = 0.0 if self._lost is not None else _END
        self._disconnect("is being shut down")
        connection, self._connection = self._connection, None
        process = self._process
        if connection is not None:
            with suppress(OSError), socket.socket(fileno=os.dup(connection.fileno())) as again:
                again.shutdown(socket.SHUT_RDWR)  # wakes the reader
            if self._reader is not None:
                self._reader.join()
            connection.close()
        if self._part.shared:
            if self._hangs and self._peer is not None:
                with suppress(ProcessLookupError):
                    os.killpg(self._peer, signal.SIGKILL)
            return
        if process is None:
            return
        try:
            process.wait(patience)
        except subprocess.TimeoutExpired:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()

    def _request(self, do: str, wake: Callable[[], object] = lambda: None, **data: Any) -> WorkerRequest:
        with self._numbering:  # so that they come in their order
            self._numbers += 1
            message = {"id": self._numbers, "do": do, **data}
            request = self._requests[self._numbers] = WorkerRequest(self._numbers, message, wake)
            try:
                self._send(message)
            except ActionFailed:
                del self._requests[self._numbers]  # nobody may send it again
                raise
        if self._lost is not None:
            request.end({"problem": f"the {self._part.name} {self._lost}"})
        return request

    def _wait(self, request: WorkerRequest, what: str, limit: float) -> Any:
        until = time.monotonic() + limit
        while not request.done.wait(_BEAT):
            self.look()
            if time.monotonic() > until:
                self._disconnect(f"did not {what} within {limit:g} s")
        if self._lost is not None:
            raise ComponentError(self._lost)
        try:
            return request.value
        except ActionFailed as problem:
            raise ComponentError(f"can't {what}: {problem}") from None

    def _send(self, message: dict[str, Any]) -> None:
        try:
            data = pack(message)
        except TypeError as problem:
            raise ActionFailed(str(problem)) from None
        connection = self._connection
        if connection is not None:
            try:
                with self._sending:
                    connection.send_bytes(data)
            except BlockingIOError:
                self._hangs = True
                self._disconnect("doesn't read its messages")
            except (OSError, ValueError):
                pass  # it is gone, which the reader notices too

    def _read(self) -> None:
        connection = self._connection
        while connection is not None:
            try:
                self._take(unpack(connection.recv_bytes(_LONGEST)))
            except (EOFError, OSError) as problem:
                if "bad message length" in str(problem):
                    self._disconnect(f"says what can't be understood: a message of more than {_LONGEST >> 20} MB")
                break
            except Exception as problem:  # whatever it says, and whoever hears it
                self._disconnect(f"says what can't be understood: {describe_exception(problem)}")
                break
        self._disconnect(self._ending())

    def _take(self, message: dict[str, Any]) -> None:
        self._heard = time.monotonic()
        if "ended" in message:
            self.state, self.problem = message["state"], message["problem"]
            for number, outcome in message["ended"].items():
                request = self._requests.get(int(number))
                if request is not None:
                    request.end(outcome if isinstance(outcome, dict) else {"problem": "its outcome makes no sense"})
            self._forget_ended({*message["known"], *map(int, message["ended"])})
            if self.problem:
                self._changed()
        elif "ask" in message:
            self._asked(message)
        elif "write" in message:
            device = self._devices.get(message["write"])
            if device is not None and self.state == ACTIVE:
                with suppress(DeviceError):  # it is repeated as long as it counts
                    device.write(message["write"], message["command"])
        elif "tell" in message:
            self._report(str(message["tell"]), dict(message["data"]))

    def _asked(self, message: dict[str, Any]) -> None:
        number = message["call"]
        if not number:
            self._send({"answer": message["ask"], "call": 0, **self._reading(message["device"])})
            return
        request = self._requests.get(number)
        if request is None or request.done.is_set():
            return
        if message["ask"] > request.latest:
            request.ask(message)
        elif message["ask"] == request.latest and request.answer is not None:
            self._send(request.answer)

    def _reading(self, name: str) -> dict[str, Any]:
        try:
            return {"value": self._devices[name].read(name)}
        except ActionFailed as problem:
            return {**pack_error(problem), "unknown": True}

    def _forget_ended(self, known: set[int]) -> None:
        """Forget requests that are over on both sides; send again what the component doesn't know."""
        now = time.monotonic()
        for number, request in tuple(self._requests.items()):
            if number in known:
                continue
            if request.done.is_set():
                self._requests.pop(number, None)
            elif now - request.sent > _BEAT:
                request.sent = now
                self._send({**request.message, "again": True})

    def _disconnect(self, reason: str) -> None:
        """Close the link; everything that waits for an answer fails with this reason."""
        if self._lost is None:
            self._lost = reason
            for request in tuple(self._requests.values()):
                request.end({"problem": f"the {self._part.name} {reason}"})
            self._changed()

    def _ending(self) -> str:
        process = None if self._part.shared else self._process
        try:
            code = process.wait(_END) if process is not None else None
        except subprocess.TimeoutExpired:
            return "has let go of the robot"
        if code is None:
            return "has ended"
        return f"was killed by signal {-code}" if code < 0 else f"ended with exit code {code}"


def _begin(words: Sequence[str], pass_fds: Sequence[int] = ()) -> subprocess.Popen[bytes]:
    # -B: a compiled file can't distinguish two versions that were written within a second
    command = [sys.executable, "-B", "-m", "btlang.components.worker", *words]
    return subprocess.Popen(
        command, pass_fds=pass_fds, start_new_session=True, stdin=subprocess.DEVNULL, stdout=_ERRORS
    )
