"""What a server signs, so it need not keep it: sessions while the disk is full, and devices with an earlier log-in."""

from __future__ import annotations

import secrets

from itsdangerous import BadData, URLSafeSerializer, URLSafeTimedSerializer

from btlang.server.accounts.accounts import IDLE, Accounts, Identity, User, hash_secret

_SESSION = "bts_"
_MOST_NAMES = 8  # users of one device


class SignedSessions:
    """Sessions whose secret is a signed text, for a disk that takes no more. They end with the user's generation."""

    def __init__(self, key: str) -> None:
        self._signer = URLSafeTimedSerializer(key, salt="session")

    def begin(self, user: User) -> str:
        """Begin a session; return what its cookie has."""
        signed = self._signer.dumps([user.name, user.generation, secrets.token_hex(8)])
        return _SESSION + signed.decode() if isinstance(signed, bytes) else _SESSION + signed

    def identity(self, secret: str, accounts: Accounts) -> Identity | None:
        """Return who brings the secret of a session; None for nobody, and for a session that is stored."""
        if not secret.startswith(_SESSION):
            return None
        try:
            name, generation, _ = self._signer.loads(secret.removeprefix(_SESSION), max_age=int(IDLE))
        except (BadData, ValueError, TypeError):
            return None
        user = accounts.user(name)
        if user is None or user.generation != generation:
            return None
        return Identity(user.name, user.role, hash_secret(secret), True, generation, is_stored=False)


class Devices:
    """Browsers in which users have logged in, each with a cookie that says so."""

    def __init__(self, key: str) -> None:
        self._signer = URLSafeSerializer(key, salt="device")

    def number(self, cookie: str, user: str) -> str:
        """Return the number of the device if the user has logged in there before, else ""."""
        number, *names = self._read(cookie)
        return number if user in names else ""

    def add(self, cookie: str, user: str) -> str:
        """Return the cookie of a device once the user has logged in there."""
        number, *names = self._read(cookie)
        kept = [name for name in names if name != user][-(_MOST_NAMES - 1) :]
        signed = self._signer.dumps([number or secrets.token_hex(8), *kept, user])
        return signed.decode() if isinstance(signed, bytes) else signed

    def _read(self, cookie: str) -> list[str]:
        try:
            read = self._signer.loads(cookie)
        except BadData:
            return [""]
        return [str(each) for each in read] if isinstance(read, list) and read else [""]
