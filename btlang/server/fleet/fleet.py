"""Robots of other computers that may join a server: invited by a code that is good once, then known by a key."""

from __future__ import annotations

import base64
import secrets
import time
from collections.abc import Callable

from btlang.server.accounts.accounts import hash_secret
from btlang.support.record import Record
from btlang.task.commands.checks import refusal_error
from btlang.task.store.database import Mode
from btlang.task.store.rows import columns_of, from_row, insert

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.task.store.sqlite import Sqlite

VALID = 3600.0
"""The seconds for which a code is good."""
_BEGIN, _SECRET, _PIN = "btr_", 16, 32  # of a code; the bytes in it


class FleetRobot(Record):
    """A robot of another computer.

    `code` and `key` are hashes of what it sends, `key` is "" until it joins. Times are in seconds since 1970.
    """

    name: str
    code: str
    invited: float
    key: str = ""
    seen: float | None = None


class Fleet:
    """The robots that may join, in the database of the accounts.

    Usable from any thread and several processes; methods raise StoreError (BT195).
    """

    def __init__(self, database: Sqlite, clock: Callable[[], float] = time.time) -> None:
        self._database, self._clock = database, clock

    def robots(self) -> list[FleetRobot]:
        """Return all robots that were invited, by name."""
        return self._find("1 = 1 ORDER BY name")

    def invite(self, name: str, pin: bytes) -> str:
        """Make a code for a robot; `pin` is the server's (accounts/certificate.py). Raises MissionError (BT187)."""
        secret = secrets.token_bytes(_SECRET)
        code = _BEGIN + base64.urlsafe_b64encode(secret + pin).decode()
        invited = FleetRobot(name, hash_secret(code), self._clock())
        with self._database.transaction(Mode.ALONE) as execute:
            execute("DELETE FROM robot WHERE name = ? AND key = ''", (name,))  # a code that nobody used
            if execute("SELECT 1 FROM robot WHERE name = ?", (name,)):
                raise refusal_error(f"The robot '{name}'", "has joined already; revoke it first")
            insert(execute, "robot", invited)
        return code

    def revoke(self, name: str) -> None:
        """Revoke the key of a robot. Raises MissionError (BT187)."""
        with self._database.transaction() as execute:
            if not execute("DELETE FROM robot WHERE name = ? RETURNING name", (name,)):
                raise refusal_error(f"The robot '{name}'", "isn't known")

    def admit(self, key: str, code: str) -> FleetRobot | None:
        """Return the robot whose key it is, None for nobody's; that of a good code becomes known.

        The same again is no second use, since the first answer may have been lost.
        """
        known = self._find("key = ?", hash_secret(key))
        if known:
            return known[0]
        with self._database.transaction() as execute:
            execute(
                "UPDATE robot SET key = ? WHERE code = ? AND key = '' AND invited > ?",
                (hash_secret(key), hash_secret(code), self._clock() - VALID),
            )
        joined = self._find("key = ?", hash_secret(key))
        return joined[0] if joined else None

    def saw(self, name: str) -> None:
        """Note that a robot is here now."""
        with self._database.transaction() as execute:
            execute("UPDATE robot SET seen = ? WHERE name = ?", (self._clock(), name))

    def _find(self, condition: str, *values: object) -> list[FleetRobot]:
        with self._database.transaction(Mode.READ) as execute:
            rows = execute(f"SELECT {columns_of(FleetRobot)} FROM robot WHERE {condition}", values)
        return [from_row(FleetRobot, row) for row in rows]


def pin_in(code: str) -> bytes:
    """Return the pin of the server which made a code. Raises ValueError if it isn't one."""
    data = base64.b64decode(code.removeprefix(_BEGIN), altchars=b"-_", validate=True)
    if len(data) != _SECRET + _PIN:
        raise ValueError("a code is longer, or shorter")
    return data[_SECRET:]
