"""Reads the state of all servos in each cycle, so that one that doesn't answer costs the others little."""

from __future__ import annotations

import time
from collections.abc import Mapping

from btlang.devices.dynamixel.client import Client
from btlang.devices.dynamixel.control_table import STATE

_SILENCE = 0.15  # seconds without an answer after which a servo is no longer asked with the others
_BLAMES = 3  # ... if it was the first that didn't answer as often, since those behind it wait for its answer
_LENGTHS = 4  # a question after one that was not answered in full has another length, so late answers don't fit it
_PLAIN = 1.0  # seconds for which each answers with a packet of its own after a common answer was damaged


class _Asked:
    def __init__(self, address: int, fast: bool, now: float) -> None:
        self.address, self.fast, self.answered = address, fast, now
        self.blames = 0


class Polling:
    """Which servos are asked, and how. Servos that can answer with one common packet do; those whose answer is missing
    are asked last, since in a chain of answers each waits for the one before."""

    def __init__(self, client: Client) -> None:
        self._client = client
        self._asked: dict[int, _Asked] = {}
        self._groups: dict[tuple[int, bool], list[int]] | None = None  # None: they have changed
        self._plain_until, self._extra = 0.0, 0

    def add(self, id: int, address: int) -> None:
        """Asks a servo from now on, whose state begins at this address. It is tried whether it knows the fast way."""
        fast = any(self._client.sync_read(address, STATE.size, (id,), fast=True) for _ in range(2))
        self._asked[id] = _Asked(address, fast, time.monotonic())
        self._groups = None

    def remove(self, id: int) -> None:
        """Asks a servo no more."""
        self._asked.pop(id, None)
        self._groups = None

    def read(self) -> Mapping[int, bytes]:
        """One cycle: the states of the servos that answered, and perhaps some bytes more."""
        if self._groups is None or 0 < self._plain_until < time.monotonic():
            self._groups = self._grouped()
        found: dict[int, bytes] = {}
        for (address, fast), ids in self._groups.items():
            found |= self._ask(address, ids, fast)
        return found

    def _grouped(self) -> dict[tuple[int, bool], list[int]]:
        """The servos that are asked together, by the address of their state and whether they answer in one packet."""
        if self._plain_until < time.monotonic():
            self._plain_until = 0.0
        groups: dict[tuple[int, bool], list[int]] = {}
        for id, asked in sorted(self._asked.items(), key=lambda item: item[1].blames):
            groups.setdefault((asked.address, asked.fast and not self._plain_until), []).append(id)
        return groups

    def silent(self) -> list[int]:
        """The servos that have not answered for so long that they only hold up the others."""
        now = time.monotonic()
        return [id for id, asked in self._asked.items() if asked.blames >= _BLAMES and now - asked.answered > _SILENCE]

    def _ask(self, address: int, ids: list[int], fast: bool) -> dict[int, bytes]:
        found = self._client.sync_read(address, STATE.size + self._extra, ids, fast)
        now = time.monotonic()
        missing = [id for id in ids if id not in found]
        for id in found:
            self._asked[id].blames, self._asked[id].answered = 0, now
        if missing:
            self._asked[missing[0]].blames += 1
            self._groups = None
            self._extra = (self._extra + 1) % _LENGTHS
            if fast:
                self._plain_until = now + _PLAIN
        return found
