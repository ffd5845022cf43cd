"""Passwords as argon2id hashes, made and compared in few threads: each takes 20 MB and some hundredths of a second."""

from __future__ import annotations

import asyncio
import secrets
from concurrent.futures import ThreadPoolExecutor
from functools import cache

TYPE_CHECKING = False
if TYPE_CHECKING:
    from argon2 import PasswordHasher

SHORTEST, LONGEST = 8, 4096
"""Characters; the first is that of NIST SP 800-63B."""
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
    return hashed(random_password())


def hashed(password: str) -> str:
    """The hash to keep. Takes some hundredths of a second."""
    return _hasher().hash(password.encode("utf-8", "surrogatepass"))


def fits(password: str, kept: str) -> bool:
    """Whether it is the password of a hash."""
    from argon2.exceptions import InvalidHashError, VerificationError

    try:
        return _hasher().verify(kept, password.encode("utf-8", "surrogatepass"))
    except (VerificationError, InvalidHashError):
        return False


def problem(password: str, name: str) -> str:
    """Why it can't be the password of a user, "" if it can."""
    if not SHORTEST <= len(password) <= LONGEST:
        return f"it must have from {SHORTEST} to {LONGEST} characters"
    return "it must not be the name" if password.casefold() == name.casefold() else ""


def random_password() -> str:
    """One that nobody guesses, for people to type."""
    letters = "abcdefghijkmnpqrstuvwxyz23456789"  # none that look alike
    return "-".join("".join(secrets.choice(letters) for _ in range(5)) for _ in range(4))


class BusyError(Exception):
    """Too many people log in at once."""


class Verifier:
    """Compares passwords for an event loop. An unknown user takes as long as a known one."""

    def __init__(self) -> None:
        self._threads = ThreadPoolExecutor(_AT_ONCE, "btlang passwords")
        self._waiting = 0

    async def fits(self, password: str, kept: str | None) -> bool:
        """Whether it is the password of a hash; None for a user who isn't there. Raises BusyError."""
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
        """Ends its threads."""
        self._threads.shutdown(cancel_futures=True)
