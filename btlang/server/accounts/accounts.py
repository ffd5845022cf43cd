"""Accounts: users with their roles, sessions and tokens, and the trail of what they did, in one SQLite file."""

from __future__ import annotations

import hashlib
import os
import secrets
import time
from collections.abc import Callable
from contextlib import suppress
from enum import StrEnum

from btlang.support.record import Record
from btlang.task import messages
from btlang.task.commands.checks import refusal_error
from btlang.task.messages import Command
from btlang.task.store.backup import fill_from_backup, write_backup
from btlang.task.store.database import Mode, StoreError, store_error
from btlang.task.store.migrations import migrate
from btlang.task.store.rows import columns_of, from_row, insert
from btlang.task.store.sqlite import Sqlite

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeVar

    R = TypeVar("R", bound=Record)


class UserRole(StrEnum):
    """A role of a user. Each may do what those before it may."""

    VIEWER = "viewer"
    OPERATOR = "operator"
    EDITOR = "editor"
    ADMINISTRATOR = "administrator"

    def covers(self, other: UserRole) -> bool:
        """Return whether it may do what the other one may."""
        order = list(UserRole)
        return order.index(self) >= order.index(other)


_VIEWER = (
    messages.List, messages.Show, messages.Schedules, messages.Library, messages.Status, messages.Report,
    messages.EmergencyStop, messages.Components, messages.Picture, messages.Voice,
    messages.Urdf,
)  # fmt: skip
_OPERATOR = (
    messages.Submit, messages.Cancel, messages.Kill, messages.Interrupt, messages.Resume, messages.Skip,
    messages.Reorder, messages.Again, messages.AddSchedule, messages.RemoveSchedule, messages.Pause, messages.Step,
    messages.Release, messages.Say, messages.Trail, messages.AnswerQuestion, messages.Talk,
    messages.InviteVisitor,
)  # fmt: skip
_EDITOR = (messages.Put, messages.Delete)
_ADMINISTRATOR = (messages.Down, messages.ChangeComponent)

NEEDED: dict[type[Command], UserRole] = {
    **dict.fromkeys(_VIEWER, UserRole.VIEWER),
    **dict.fromkeys(_OPERATOR, UserRole.OPERATOR),
    **dict.fromkeys(_EDITOR, UserRole.EDITOR),
    **dict.fromkeys(_ADMINISTRATOR, UserRole.ADMINISTRATOR),
}
"""The least role for each command. Everybody who is logged in may stop the robot; to let it move is another act."""


IDLE, LONGEST = 8 * 3600.0, 7 * 86_400.0
"""The seconds after which a session ends that nobody uses, and after which every one does."""
_NOTED = 60.0  # seconds between two notes that a session or token is used
_TOKEN = "btl_"
_MOST_IDENTITIES = 10_000
_NEXT = "generation = generation + 1"
MOST_ENTRIES = 100_000
"""The limit of the trail."""
_MOST_WORDS = 8  # by which the trail is filtered
_NOT_COPIED = ("session",)  # else a restore would bring back one that was logged out
_STEPS = [
    (
        "CREATE TABLE version (number BIGINT NOT NULL)",
        "INSERT INTO version (number) VALUES (0)",
        """CREATE TABLE user (
            name TEXT PRIMARY KEY, role TEXT NOT NULL, password TEXT NOT NULL, created DOUBLE PRECISION NOT NULL
        )""",
        """CREATE TABLE session (
            id TEXT PRIMARY KEY, user TEXT NOT NULL, address TEXT NOT NULL, created DOUBLE PRECISION NOT NULL,
            used DOUBLE PRECISION NOT NULL
        )""",
        """CREATE TABLE token (
            id TEXT PRIMARY KEY, name TEXT NOT NULL, user TEXT NOT NULL, created DOUBLE PRECISION NOT NULL,
            used DOUBLE PRECISION
        )""",
        """CREATE TABLE entry (
            number INTEGER PRIMARY KEY, time DOUBLE PRECISION NOT NULL, user TEXT NOT NULL, address TEXT NOT NULL,
            what TEXT NOT NULL, outcome TEXT NOT NULL
        )""",
    ),
    (
        """CREATE TABLE robot (
            name TEXT PRIMARY KEY, code TEXT NOT NULL, invited DOUBLE PRECISION NOT NULL, key TEXT NOT NULL,
            seen DOUBLE PRECISION
        )""",
    ),
    ("ALTER TABLE user ADD COLUMN generation BIGINT NOT NULL DEFAULT 0",),
]


class User(Record):
    """A user. `password` is a hash. `created` is in seconds since 1970.

    `generation` is another number after each change of what the user may do: of role, password, sessions or tokens.
    """

    name: str
    role: UserRole
    password: str
    created: float
    generation: int = 0


class Login(Record):
    """A session of a page. `id` is the hash of what its cookie has."""

    id: str
    user: str
    address: str
    created: float
    used: float


class AccessToken(Record):
    """A token that lets a program in. `id` is the hash of what it sends, `used` when it did so last."""

    id: str
    name: str
    user: str
    created: float
    used: float | None = None


class TrailEntry(Record):
    """An entry of the trail: what somebody did or tried."""

    time: float
    user: str
    address: str
    what: str
    outcome: str


class Identity(Record):
    """The identity of who asks, as it was in a `generation` of the user.

    `id` is that of a session or token, which ends when it is revoked. `is_stored` is False for a session that was made
    while the disk was full: it is known by a signature, and ends with the generation.
    """

    user: str
    role: UserRole
    id: str
    is_session: bool
    generation: int = 0
    is_stored: bool = True


class Accounts:
    """The accounts of a server, in a folder.

    They may be used from any thread and by several processes at once; methods raise StoreError (BT195). A server looks
    at the generation of a user before each command, so a change needs no notice.

    `clock` gives seconds since 1970.
    """

    def __init__(self, folder: str, clock: Callable[[], float] = time.time) -> None:
        os.makedirs(folder, mode=0o700, exist_ok=True)
        self.database = Sqlite(os.path.join(folder, "accounts.db"), durable=True)
        self.database.check()
        migrate(self.database, _STEPS)
        self._clock = clock

    def close(self) -> None:
        """End its connections."""
        self.database.close()

    def users(self) -> list[User]:
        """Return all users, by name."""
        return self._all(User, "user", "1 = 1 ORDER BY name")

    def user(self, name: str) -> User | None:
        """Return a user; None if there is no such user."""
        return self._one(User, "user", "name = ?", name)

    def add(self, name: str, role: UserRole, password: str) -> User:
        """Add a user with the hash of a password. Raises MissionError (BT187) if there is one of that name."""
        now = self._clock()
        added = User(name, role, password, now, int(now * 1000))  # not one that a user of that name had before
        with self.database.transaction(Mode.ALONE) as execute:
            if execute("SELECT 1 FROM user WHERE name = ?", (name,)):
                raise refusal_error(f"The user '{name}'", "exists already")
            insert(execute, "user", added)
        return added

    def set_password(self, name: str, password: str) -> None:
        """Set another hash; whoever is logged in with the password before is logged out.

        Raises MissionError (BT187).
        """
        self._change(name, f"UPDATE user SET password = ?, {_NEXT} WHERE name = ? RETURNING name", password)
        self.log_out(name)

    def set_role(self, name: str, role: UserRole) -> None:
        """Set the role of a user. Raises MissionError (BT187), also for the last administrator."""
        sql = f"UPDATE user SET role = ?, {_NEXT} WHERE name = ? RETURNING name"
        self._change(name, sql, role.value, is_needed=role is not UserRole.ADMINISTRATOR)

    def remove(self, name: str) -> None:
        """Remove a user, and end all sessions and tokens.

        Raises MissionError (BT187), also for the last administrator.
        """
        self._change(name, "DELETE FROM user WHERE name = ? RETURNING name", is_needed=True)
        with self.database.transaction() as execute:
            execute("DELETE FROM token WHERE user = ?", (name,))
        self.log_out(name)

    def log_in(self, user: str, address: str) -> str:
        """Begin a session; return what its cookie has."""
        secret, now = secrets.token_urlsafe(32), self._clock()
        with self.database.transaction() as execute:
            execute("DELETE FROM session WHERE used < ? OR created < ?", (now - IDLE, now - LONGEST))
            insert(execute, "session", Login(hash_secret(secret), user, address, now, now))
        return secret

    def log_out(self, user: str, id: str = "") -> None:
        """End a session of a user, or all."""
        with self.database.transaction() as execute:
            execute("DELETE FROM session WHERE user = ? AND (id = ? OR ? = '')", (user, id, id))
            execute(f"UPDATE user SET {_NEXT} WHERE name = ?", (user,))

    def add_token(self, user: str, name: str) -> str:
        """Make a token; return what a program sends. Raises MissionError (BT187): no such user, or a name in use."""
        if self.user(user) is None:
            raise refusal_error(f"The user '{user}'", "isn't known")
        secret = _TOKEN + secrets.token_urlsafe(32)
        with self.database.transaction(Mode.ALONE) as execute:
            if execute("SELECT 1 FROM token WHERE user = ? AND name = ?", (user, name)):
                raise refusal_error(f"The token '{name}' of '{user}'", "exists already")
            insert(execute, "token", AccessToken(hash_secret(secret), name, user, self._clock()))
        return secret

    def tokens(self, user: str) -> list[AccessToken]:
        """Return the tokens of a user, by name."""
        return self._all(AccessToken, "token", "user = ? ORDER BY name", user)

    def revoke(self, user: str, name: str) -> None:
        """End a token. Raises MissionError (BT187)."""
        with self.database.transaction() as execute:
            if not execute("DELETE FROM token WHERE user = ? AND name = ? RETURNING name", (user, name)):
                raise refusal_error(f"The token '{name}' of '{user}'", "isn't known")
            execute(f"UPDATE user SET {_NEXT} WHERE name = ?", (user,))

    def identity(self, secret: str) -> Identity | None:
        """Return who brings a secret, of a cookie or of a program; None for nobody."""
        now, id = self._clock(), hash_secret(secret)
        if secret.startswith(_TOKEN):
            token = self._one(AccessToken, "token", "id = ?", id)
            if token is None:
                return None
            if token.used is None or token.used < now - _NOTED:
                self._note("token", id, now)
            return self._identify(token.user, id, is_session=False)
        login = self._one(Login, "session", "id = ?", id)
        if login is None or login.used < now - IDLE or login.created < now - LONGEST:
            return None
        if login.used < now - _NOTED:
            self._note("session", id, now)
        return self._identify(login.user, id, is_session=True)

    def identities(self) -> list[Identity]:
        """Return all who were let in and not sent away, with a session or a token; of very many, the latest.

        Sessions that are too old by now are among them: a clock that jumps keeps nobody from stopping a robot.
        """
        sql = """SELECT user.name, user.role, access.id, access.is_session, user.generation FROM (
            SELECT id, user, used, 1 AS is_session FROM session
            UNION ALL SELECT id, user, coalesce(used, created), 0 FROM token
        ) AS access JOIN user ON user.name = access.user ORDER BY access.used DESC LIMIT ?"""
        with self.database.transaction(Mode.READ) as execute:
            rows = execute(sql, (_MOST_IDENTITIES,))
        return [Identity(name, UserRole(role), id, bool(kind), number) for name, role, id, kind, number in rows]

    def still(self, identity: Identity) -> Identity | None:
        """Return the same identity as it is now, perhaps with another role; None if it was revoked."""
        user = self.user(identity.user)
        if user is None or user.generation == identity.generation:
            return identity if user is not None else None
        table = "session" if identity.is_session else "token"
        with self.database.transaction(Mode.READ) as execute:
            found = identity.is_stored and execute(f"SELECT 1 FROM {table} WHERE id = ?", (identity.id,))
        return identity.replace(role=user.role, generation=user.generation) if found else None

    def generations(self) -> dict[str, int]:
        """Return the generation of each user."""
        with self.database.transaction(Mode.READ) as execute:
            return {str(name): int(number) for name, number in execute("SELECT name, generation FROM user")}

    def addresses(self) -> list[tuple[str, str]]:
        """Return the users with the addresses at which they have logged in lately."""
        with self.database.transaction(Mode.READ) as execute:
            return [(str(user), str(address)) for user, address in execute("SELECT user, address FROM session")]

    def log(self, user: str, address: str, what: str, outcome: str) -> None:
        """Add to the trail, from which the oldest entries go: who tries again and again can't fill the disk."""
        with self.database.transaction() as execute:
            insert(execute, "entry", TrailEntry(self._clock(), user, address, what, outcome))
            execute("DELETE FROM entry WHERE number <= (SELECT max(number) FROM entry) - ?", (MOST_ENTRIES,))

    def entries(self, limit: int = 100, words: str = "", *, only_failures: bool = False) -> list[TrailEntry]:
        """Return the trail, the newest first: the entries in which all of the `words` are, and `only_failures` if that
        is wanted, which are those that were refused or had a wrong password.
        """
        entry = "lower(user || ' ' || address || ' ' || what || ' ' || outcome)"
        wanted = words.split()[:_MOST_WORDS]
        first = "outcome <> 'ok'" if only_failures else "1 = 1"
        condition = " AND ".join([first, *(f"instr({entry}, lower(?)) > 0" for _ in wanted)])
        return self._all(TrailEntry, "entry", f"{condition} ORDER BY number DESC LIMIT ?", *wanted, limit)

    def backup(self, path: str) -> None:
        """Write all but the sessions into a new SQLite file for its owner alone, as it is at one moment.

        Raises StoreError, also if there's such a file already.
        """
        write_backup(self.database, path, _STEPS, _NOT_COPIED)

    def restore(self, path: str) -> None:
        """Take over what `backup` wrote, also that of an older btlang.

        Raises MissionError (BT196) if it's that of a newer one, and StoreError if there are users here or the file is
        no backup; then nothing is changed.
        """
        fill_from_backup(self.database, path, _STEPS, _NOT_COPIED)

    def _identify(self, name: str, id: str, *, is_session: bool) -> Identity | None:
        user = self.user(name)
        return None if user is None else Identity(user.name, user.role, id, is_session, user.generation)

    def _change(self, name: str, sql: str, *values: object, is_needed: bool = False) -> None:
        """Change a user; where an administrator `is_needed`, not the last one. Raises MissionError (BT187)."""
        with self.database.transaction(Mode.ALONE) as execute:  # else two at once could remove the last two
            if is_needed and execute("SELECT name FROM user WHERE role = ?", (UserRole.ADMINISTRATOR,)) == [(name,)]:
                raise refusal_error(f"The user '{name}'", "is the only administrator")
            if not execute(sql, (*values, name)):
                raise refusal_error(f"The user '{name}'", "isn't known")

    def _note(self, table: str, id: str, now: float) -> None:
        with suppress(StoreError), self.database.transaction() as execute:  # a full disk keeps nobody from the robot
            execute(f"UPDATE {table} SET used = ? WHERE id = ?", (now, id))

    def _one(self, kind: type[R], table: str, condition: str, *values: object) -> R | None:
        found = self._all(kind, table, condition, *values)
        return found[0] if found else None

    def _all(self, kind: type[R], table: str, condition: str, *values: object) -> list[R]:
        with self.database.transaction(Mode.READ) as execute:
            rows = execute(f"SELECT {columns_of(kind)} FROM {table} WHERE {condition}", values)
        try:
            found = [from_row(kind, row) for row in rows]
            return [each.replace(role=UserRole(each.role)) if isinstance(each, User) else each for each in found]
        except (ValueError, TypeError) as error:
            raise store_error(self.database.place, f"it's damaged: a {table} can't be read") from error


def check_account_name(name: str, act: str) -> None:
    """Raise MissionError if a user or a token can't have this name."""
    if not name.strip() or len(name) > 64 or not name.isprintable():
        raise messages.wrong(act, "a name must have up to 64 characters that can be shown")


def hash_secret(secret: str) -> str:
    """Hash a secret fast: nobody guesses 256 random bits."""
    return hashlib.sha256(secret.encode("utf-8", "surrogatepass")).hexdigest()
