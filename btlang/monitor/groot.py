"""A server for Groot2: answers its questions about a run from a thread of its own, over ZeroMQ."""

from __future__ import annotations

import json
import os
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import partial

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.engine.status import IDLE, RUNNING
from btlang.monitor import groot_protocol as protocol
from btlang.monitor.breakpoints import Breakpoints
from btlang.monitor.groot_protocol import GrootTree, models_of
from btlang.run.bus import INLINE
from btlang.run.controls import Controls
from btlang.run.events import Event, Sampled, StatusesChanged
from btlang.run.follower import RunFollower
from btlang.run.snapshot import HALTED
from btlang.text.source import NOWHERE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.api import Mission
    from btlang.run.snapshot import RunState, WatchedNodes
    from btlang.session import Run


_HEARTBEAT = 5.0  # seconds without a question after which breakpoints are off
_PATIENCE = 50  # milliseconds between two looks whether the run is over, or a breakpoint was reached
_MOST_FRAME = 100_000  # bytes; a question is short
_MOST_DEEP = 10  # brackets in each other in one


class GrootServer:
    """A sink for one run, which `watch` begins. Answers Groot2 on a port, and publishes on the next one.

    `tree` makes the tree when the first client asks, which takes time; `values` gives the blackboard of a node by its
    index. Raises MissionError if the packages are missing (BT085) or a port is taken (BT086). A client that is slow, or
    silent, or sends garbage, never delays a tick.
    """

    policy = INLINE

    def __init__(self, port: int, controls: Controls) -> None:
        try:
            import msgpack
            import zmq
        except ImportError:
            raise MissionError([diagnostic("BT085", NOWHERE)]) from None
        self._pack: Callable[[Any], bytes] = lambda values: msgpack.packb(values, default=str)
        self._zmq = zmq
        self._context = zmq.Context()
        self._server, self._publisher = self._context.socket(zmq.REP), self._context.socket(zmq.PUB)
        for socket, at in ((self._server, port), (self._publisher, port + 1)):
            socket.setsockopt(zmq.LINGER, 0)
            socket.setsockopt(zmq.MAXMSGSIZE, _MOST_FRAME)
            try:
                socket.bind(f"tcp://127.0.0.1:{at}")
            except zmq.ZMQError as error:
                self._context.destroy()
                reason = os.strerror(error.errno or 0).lower()
                raise MissionError([diagnostic("BT086", NOWHERE, port=str(at), reason=reason)]) from None
        self.breakpoints = Breakpoints(controls.pause, controls.resume, self._reached)
        """The hooks of the engine of the run; see btlang.engine.engine.Engine."""
        self._tree_id = os.urandom(16)
        self._tree: GrootTree | None = None
        self._make: Callable[[], GrootTree] | None = None
        self._follower: RunFollower | None = None
        self._values: Callable[[int], Mapping[str, Any]] = lambda index: {}
        self._reached_nodes: deque[int] = deque()
        self._recording = False
        self._began = 0.0
        self._changes: deque[tuple[float, int, int]] = deque(maxlen=protocol.MOST_TRANSITIONS)
        self._over = False
        self._heard = time.monotonic()
        self._thread = threading.Thread(target=self._serve, name="btlang groot", daemon=True)
        self._thread.start()

    def watch(
        self, follower: RunFollower, tree: Callable[[], GrootTree], values: Callable[[int], Mapping[str, Any]]
    ) -> None:
        """Answer about a run that begins; `follower` knows its statuses."""
        self._follower, self._make, self._values = follower, tree, values

    def __call__(self, event: Event) -> None:
        """Keep what a client that records will ask for. In the thread of the run."""
        if self._recording and isinstance(event, StatusesChanged):
            for index, status, _, _ in event.changes:
                self._changes.append((event.wall, index, status))

    def close(self) -> None:
        """End the server. May be called twice."""
        self._over = True
        self._thread.join(2.0)
        if not self._context.closed:
            self._context.destroy(linger=0)

    def _reached(self, index: int) -> None:
        """Note that a breakpoint was reached. In the thread of the run, which uses no socket."""
        self._reached_nodes.append(index)

    def _serve(self) -> None:
        while not self._over:
            while self._reached_nodes:
                uid = str(self._reached_nodes.popleft() + 1)
                number = int.from_bytes(os.urandom(4), "little")
                self._publisher.send_multipart([protocol.head(protocol.BREAKPOINT_REACHED, number), uid.encode()])
            self.breakpoints.enable(time.monotonic() < self._heard + _HEARTBEAT)
            if not self._server.poll(_PATIENCE):
                continue
            frames = self._server.recv_multipart()
            self._heard = time.monotonic()
            try:
                reply = self._answer(frames)
            except Exception as problem:  # whatever a question brings, the next one is answered
                reply = [b"error", (str(problem) or "this can't be read").encode("utf-8", "replace")]
            self._server.send_multipart(reply)

    def _answer(self, frames: list[bytes]) -> list[bytes]:
        """Raise ValueError and its like for what is no question."""
        request = protocol.read_request(frames[0])
        answer = _ANSWERS.get(request.letter)
        if answer is None:
            raise ValueError("Request not recognized")
        needs_content = request.letter in _WITH_CONTENT
        if needs_content != (len(frames) == 2) and (needs_content or len(frames) > 2):
            raise ValueError("must be 2 parts message")
        payload = answer(self, frames[1] if len(frames) > 1 else b"")
        head = protocol.head(request.letter, request.number, self._tree_id)
        return [head] if payload is None else [head, payload]

    @property
    def _known(self) -> GrootTree:
        if self._tree is None:
            if self._make is None:
                raise ValueError("the run hasn't begun")
            self._tree = self._make()
        return self._tree

    def _full_tree(self, _: bytes) -> bytes:
        return self._known.to_xml().encode("utf-8", "replace")

    def _status(self, _: bytes) -> bytes:
        codes = self._follower.codes() if self._follower is not None else b""
        size = self._known.size
        return protocol.statuses(bytes(_CODES[code] for code in codes[:size]) if codes else bytes(size))

    def _blackboards(self, content: bytes) -> bytes:
        roots = self._known.blackboards
        names = content.decode("utf-8", "replace").split(";")
        return self._pack({name: _plain(self._values(roots[name])) for name in names if name in roots})

    def _insert(self, content: bytes) -> None:
        hooks = _hooks(content)
        for hook in hooks if isinstance(hooks, list) else [hooks]:
            self.breakpoints.insert(hook, self._known.size)

    def _remove(self, content: bytes) -> None:
        self.breakpoints.remove(_hooks(content))

    def _unlock(self, content: bytes) -> None:
        self.breakpoints.unlock(_hooks(content))

    def _remove_all(self, _: bytes) -> None:
        self.breakpoints.remove_all()

    def _disable_all(self, _: bytes) -> None:
        self.breakpoints.disable_all()

    def _dump(self, _: bytes) -> bytes:
        return json.dumps(self.breakpoints.data()).encode()

    def _record(self, content: bytes) -> bytes | None:
        if content == b"start":
            self._changes.clear()
            self._began, self._recording = time.time(), True
            return str(int(self._began * 1e6)).encode()
        self._recording = False
        return None

    def _transitions(self, _: bytes) -> bytes:
        found: list[bytes] = []
        while self._changes:
            wall, index, status = self._changes.popleft()
            if index < self._known.size:
                microseconds = max(0, int((wall - self._began) * 1e6))
                found.append(protocol.transition(microseconds, index + 1, protocol.CODES[status]))
        return b"".join(found)


_ANSWERS: dict[bytes, Callable[[GrootServer, bytes], bytes | None]] = {
    protocol.FULL_TREE: GrootServer._full_tree,
    protocol.STATUS: GrootServer._status,
    protocol.BLACKBOARDS: GrootServer._blackboards,
    protocol.HOOK_INSERT: GrootServer._insert,
    protocol.HOOK_REMOVE: GrootServer._remove,
    protocol.BREAKPOINT_UNLOCK: GrootServer._unlock,
    protocol.REMOVE_ALL_HOOKS: GrootServer._remove_all,
    protocol.DISABLE_ALL_HOOKS: GrootServer._disable_all,
    protocol.HOOKS_DUMP: GrootServer._dump,
    protocol.TOGGLE_RECORDING: GrootServer._record,
    protocol.TRANSITIONS: GrootServer._transitions,
}
_WITH_CONTENT = frozenset((
    protocol.BLACKBOARDS, protocol.HOOK_INSERT, protocol.HOOK_REMOVE, protocol.BREAKPOINT_UNLOCK,
    protocol.TOGGLE_RECORDING,
))  # fmt: skip
_CODES = {
    code: protocol.CODES.get(code, protocol.CODES[RUNNING] + protocol.RESET if code >= HALTED else protocol.CODES[IDLE])
    for code in range(HALTED + 2)
}
"""The codes of Groot2 for those of btlang.run.snapshot.RunState."""


def _plain(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return what msgpack can hold; whole numbers of more than 64 bits and all else become texts."""
    return {key: value if _fits(value) else str(value) for key, value in values.items()}


def _fits(value: Any) -> bool:
    if isinstance(value, bool | float | str) or value is None:
        return True
    return isinstance(value, int) and -(2**63) <= value < 2**64


def _hooks(content: bytes) -> Any:
    """Read hooks from JSON that isn't deep: an engine of deep trees lets Python recurse further than a thread's stack
    reaches.
    """
    depth = 0
    for byte in content:
        depth += (byte in b"[{") - (byte in b"]}")
        if depth > _MOST_DEEP:
            raise ValueError("too many brackets")
    return json.loads(content)


class GrootMonitor:
    """A monitor that shows a run to Groot2; see btlang.run.terminal.run_mission."""

    def __init__(self, server: GrootServer) -> None:
        self.server = server
        self.hooks = server.breakpoints

    def watch_run(self, run: Run, mission: Mission) -> None:
        """Answer about this run from now on."""
        nodes = run.nodes
        self.server.watch(run.follower, partial(groot_tree, nodes, mission), nodes.values)
        run.bus.add(self.server)


@contextmanager
def groot_monitor(port: int, controls: Controls) -> Iterator[GrootMonitor]:
    """Show runs to Groot2 until the end of the block. Raises MissionError (BT085, BT086)."""
    server = GrootServer(port, controls)
    try:
        yield GrootMonitor(server)
    finally:
        server.close()


class ReplayMonitor:
    """A sink that shows a recorded run to Groot2 while it is played."""

    def __init__(self, server: GrootServer, nodes: WatchedNodes, mission: Mission) -> None:
        self._server = server
        self._values: dict[str, Any] = {}
        self._follower = RunFollower(nodes)
        server.watch(self._follower, partial(groot_tree, nodes, mission), self._values_of)

    def __call__(self, event: Event) -> None:
        """Take an event of the recording."""
        if isinstance(event, Sampled):
            self._values = {**self._values, **event.values}
            return
        self._follower(event)
        self._server(event)

    def jump(self, state: RunState) -> None:
        """Go on from another place of the recording."""
        self._follower.jump(state)

    def _values_of(self, index: int) -> dict[str, Any]:
        """Return the values of the whole mission: no others are recorded."""
        return self._values if index == 0 else {}


def groot_tree(nodes: WatchedNodes, mission: Mission) -> GrootTree:
    """Make the tree of a run of a mission."""
    return GrootTree(nodes, nodes.parent, mission.label, models_of(lambda: str(mission.to("xml"))))
