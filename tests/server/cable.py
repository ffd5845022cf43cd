"""A connection over TCP that a test can hold up in each direction, or cut."""

from __future__ import annotations

import socket
import threading
from contextlib import suppress


class Cable:
    """Listens at `port`, and hands on to another port of this computer what comes, while that direction is open."""

    def __init__(self, to: int) -> None:
        self._to = to
        self.in_open, self.out_open = threading.Event(), threading.Event()
        self._ends: list[tuple[socket.socket, socket.socket]] = []
        self._listening = socket.create_server(("127.0.0.1", 0))
        self.port = int(self._listening.getsockname()[1])
        self.mend()
        threading.Thread(target=self._accept, daemon=True).start()

    def mend(self) -> None:
        """From now on everything flows."""
        self.in_open.set()
        self.out_open.set()

    def cut(self) -> None:
        """Ends the connections there are; what was held up is lost."""
        ends, self._ends = self._ends, []
        for end in (end for both in ends for end in both):
            with suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)
            end.close()
        self.mend()

    def held_up(self) -> int:
        """The bytes that wait until they may go out."""
        held = 0
        for _, inner in self._ends:
            with suppress(BlockingIOError):
                held += len(inner.recv(65_536, socket.MSG_PEEK | socket.MSG_DONTWAIT))
        return held

    def close(self) -> None:
        """Nothing comes through any more."""
        self._listening.close()
        self.cut()

    def _accept(self) -> None:
        with suppress(OSError):
            while True:
                outer, _ = self._listening.accept()
                inner = socket.create_connection(("127.0.0.1", self._to))
                self._ends.append((outer, inner))
                for source, target, flows in ((outer, inner, self.in_open), (inner, outer, self.out_open)):
                    threading.Thread(target=_hand_on, args=(source, target, flows), daemon=True).start()


def _hand_on(source: socket.socket, target: socket.socket, flows: threading.Event) -> None:
    with suppress(OSError):
        while source.recv(1, socket.MSG_PEEK):  # what is held up can be counted
            flows.wait()
            target.sendall(source.recv(65_536))
    for end in (source, target):
        with suppress(OSError):
            end.shutdown(socket.SHUT_RDWR)
