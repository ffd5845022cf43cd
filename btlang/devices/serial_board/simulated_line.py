"""A serial line on a pty with a board at its end, and all that goes wrong on cables."""

from __future__ import annotations

import os
import pty
import select
import threading
import time
import tty
from contextlib import suppress
from random import Random
from types import TracebackType
from typing import Protocol

_TURN = 0.002  # seconds between two turns of the board
_BITS = 10


class BoardModel(Protocol):
    """What is at the end of a line; times are seconds of one clock."""

    def receive(self, data: bytes, now: float) -> bytes:
        """What it answers to bytes."""

    def turn(self, now: float) -> None:
        """Time has passed."""

    def reset(self, now: float) -> None:
        """It is started again."""

    @property
    def speeds(self) -> tuple[float, float]:
        """Metres a second of its wheels."""


class SimulatedLine:
    """A board on a pty at `path`, while it is entered. Its faults can be changed at any time:

    `flipped`: the share of bytes that change on their way; `baud`: bits a second that it carries (0: no limit); `echo`:
    what is sent comes back too; `cut`: the share of answers that are cut in half; `deaf`: nothing reaches the
    board; `noise`: what comes besides, at each turn; `still_since`: when the wheels came to rest, None while they turn.
    """

    def __init__(self, board: BoardModel, seed: int = 0) -> None:
        self.board = board
        self.flipped = self.cut = 0.0
        self.baud = 0
        self.echo = self.deaf = False
        self.noise = b""
        self.still_since: float | None = time.monotonic()
        self.path = ""
        self._master = self._slave = -1
        self._random = Random(seed)
        self._lock = threading.Lock()
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._work, name="btlang simulated line", daemon=True)
        with self._lock:
            self.board.reset(time.monotonic())

    def __enter__(self) -> SimulatedLine:
        self.plug()
        self._thread.start()
        return self

    def __exit__(self, *_: type[BaseException] | BaseException | TracebackType | None) -> None:
        self._over.set()
        self._thread.join()
        self.unplug()
        os.close(self._slave)

    def plug(self) -> None:
        """The cable is connected, and gets another path than before."""
        master, slave = pty.openpty()
        tty.setraw(slave)
        os.set_blocking(master, False)
        with self._lock:
            before, self._slave = self._slave, slave
            self.path, self._master = os.ttyname(slave), master
        if before >= 0:
            os.close(before)

    def unplug(self) -> None:
        """The cable is pulled; the board goes on. No other terminal of this machine gets its path before `plug`."""
        with self._lock:
            master, self._master = self._master, -1
        if master >= 0:
            os.close(master)

    @property
    def plugged(self) -> bool:
        """Whether the cable is connected."""
        return self._master >= 0

    def reset(self) -> None:
        """The board is started again."""
        with self._lock:
            self.board.reset(time.monotonic())

    def _work(self) -> None:
        while not self._over.is_set():
            with self._lock:
                master = self._master
            ready = []
            if master < 0:
                self._over.wait(_TURN)
            else:
                with suppress(OSError, ValueError):  # it was pulled meanwhile
                    ready = select.select([master], [], [], _TURN)[0]
            with self._lock:
                now = time.monotonic()
                self.board.turn(now)
                if 0 <= self._master == master:
                    self._carry(master, bool(ready))
                if any(self.board.speeds):
                    self.still_since = None
                elif self.still_since is None:
                    self.still_since = time.monotonic()

    def _carry(self, master: int, ready: bool) -> None:
        data = b""
        if ready:
            with suppress(OSError):
                data = os.read(master, 4096)
        if data and self.echo:
            self._send(master, data)
        data = self._paced(self._damaged(data))
        answer = b"" if self.deaf else self.board.receive(data, time.monotonic())
        if answer and self._random.random() < self.cut:
            answer = answer[: len(answer) // 2]
        self._send(master, self._paced(self._damaged(answer)) + self.noise)

    def _send(self, master: int, data: bytes) -> None:
        with suppress(OSError):  # nobody reads: a line keeps nothing
            os.write(master, data)

    def _damaged(self, data: bytes) -> bytes:
        if not self.flipped:
            return data
        random, share = self._random, self.flipped
        return bytes(byte ^ random.randint(1, 255) if random.random() < share else byte for byte in data)

    def _paced(self, data: bytes) -> bytes:
        if self.baud and data:
            time.sleep(len(data) * _BITS / self.baud)
        return data
