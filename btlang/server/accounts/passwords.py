"""Passwords as argon2id hashes, made in few threads, and delays after wrong ones, by account and by address."""

from __future__ import annotations

import asyncio
import secrets
import time
from collections import OrderedDict
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from math import inf

TYPE_CHECKING = False
if TYPE_CHECKING:
    from argon2 import PasswordHasher


SHORTEST, LONGEST = 8, 4096
"""The least and the most characters; the first is that of NIST SP 800-63B."""
_AT_ONCE = 2
_MOST_WAITING = 32


@cache
def _hasher() -> PasswordHasher:
    """Return the hasher, with the parameters of OWASP's Password Storage Cheat Sheet."""
    from argon2 import PasswordHasher  # pages without a log-in need no passwords

    return PasswordHasher(time_cost=2, memory_cost=19 * 1024, parallelism=1)


@cache
def _nobody() -> str:
    """Return the hash of a password that nobody knows."""
    return hash_password(random_password())


def hash_password(password: str) -> str:
    """Return the hash to keep. Takes some hundredths of a second."""
    return _hasher().hash(password.encode("utf-8", "surrogatepass"))


def fits(password: str, kept: str) -> bool:
    """Return whether it is the password of a hash."""
    from argon2.exceptions import InvalidHashError, VerificationError

    try:
        return _hasher().verify(kept, password.encode("utf-8", "surrogatepass"))
    except (VerificationError, InvalidHashError):
        return False


def problem(password: str, name: str) -> str:
    """Return why it can't be the password of a user, "" if it can."""
    if not SHORTEST <= len(password) <= LONGEST:
        return f"a password must have {SHORTEST} to {LONGEST} characters"
    return "a password must not be the name" if password.casefold() == name.casefold() else ""


def random_password() -> str:
    """Make a password that nobody guesses, for people to type."""
    letters = "abcdefghijkmnpqrstuvwxyz23456789"  # none that look alike
    return "-".join("".join(secrets.choice(letters) for _ in range(5)) for _ in range(4))


class BusyError(Exception):
    """The error that too many people log in at once."""


class Verifier:
    """A verifier of passwords for an event loop, some at once. An unknown user takes as long as a known one."""

    def __init__(self, at_once: int = _AT_ONCE) -> None:
        self._threads = ThreadPoolExecutor(at_once, "btlang passwords")
        self._waiting = 0

    async def fits(self, password: str, kept: str | None) -> bool:
        """Return whether it is the password of a hash; None for a user who isn't there. Raises BusyError."""
        if self._waiting >= _MOST_WAITING:
            raise BusyError
        self._waiting += 1
        try:
            loop = asyncio.get_running_loop()
            nobody = await loop.run_in_executor(self._threads, _nobody)
            same = await loop.run_in_executor(self._threads, fits, password[: LONGEST + 1], kept or nobody)
        finally:
            self._waiting -= 1
        return same and kept is not None and len(password) <= LONGEST

    def close(self) -> None:
        """End its threads."""
        self._threads.shutdown(cancel_futures=True)


FREE = 5
"""The number of wrong passwords that cost nothing: people mistype."""
_FIRST, _LONGEST = 1.0, 60.0  # seconds
_FORGOTTEN = 900.0  # seconds after which a wrong password counts no more
_MOST_KNOWN = 10_000


class Throttle:
    """A counter of wrong passwords in a row, for one kind of thing.

    Each one after the first few doubles the time to wait.

    It forgets who was wrong least recently when too many are known. `clock` gives seconds, `free` is how many wrong
    ones cost nothing.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic, free: int = FREE) -> None:
        self._clock, self._free = clock, free
        self._wrong: OrderedDict[str, tuple[int, float]] = OrderedDict()  # how many, and when the last one was

    def wait(self, key: str) -> float:
        """Return the seconds until somebody may try again, 0 if at once."""
        count, last = self._known(key)
        if count < self._free:
            return 0.0
        pause = min(_FIRST * 2.0 ** min(count - self._free, 16), _LONGEST)
        return max(0.0, last + pause - self._clock())

    def wrong(self, key: str) -> None:
        """Count that somebody was wrong."""
        count, _ = self._known(key)
        self._wrong[key] = (count + 1, self._clock())
        self._wrong.move_to_end(key)
        while len(self._wrong) > _MOST_KNOWN:
            self._wrong.popitem(last=False)

    def right(self, key: str) -> int:
        """Count from zero again, as somebody was right. Returns how many were wrong."""
        count, _ = self._known(key)
        self._wrong.pop(key, None)
        return count

    def forgive(self, key: str, count: int) -> None:
        """Let so many wrong ones count no more."""
        if key in self._wrong:
            known, last = self._wrong[key]
            self._wrong[key] = (max(0, known - count), last)

    def _known(self, key: str) -> tuple[int, float]:
        count, last = self._wrong.get(key, (0, -inf))
        return (count, last) if self._clock() - last < _FORGOTTEN else (0, last)
