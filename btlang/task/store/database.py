"""What a store needs of a database: transactions on a few connections, errors as diagnostics, and delayed writing."""

from __future__ import annotations

import os
import threading
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext, suppress
from enum import Enum
from functools import partial

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.text.json_text import NestedTooDeep
from btlang.text.source import NOWHERE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, ClassVar, Protocol

    class Execute(Protocol):
        """A function that executes one SQL statement, with a `?` for each value, and gives the rows of its result."""

        def __call__(self, sql: str, values: Sequence[object] = ()) -> list[tuple[Any, ...]]: ...


PATIENCE = 10.0
"""The seconds of waiting for another process, after which a call gives up."""
_MOST_IDLE = 4  # connections
OWNED: set[int] = set()
"""The open files (on a server: the connections) that end an ownership when they are closed."""


class Mode(Enum):
    """The mode of a transaction: it sees one state of the store, or changes it, or is the only one of its mode."""

    READ = 1
    WRITE = 2
    ALONE = 3


class StoreError(MissionError):
    """The error of a store whose database refuses, or can't be reached. What the call had changed is undone.

    Only if the connection is lost while a change is being confirmed, the change may have been kept.
    """


def store_error(place: str, reason: str) -> StoreError:
    """Make the error BT195, for a reason that can stand in a sentence."""
    return StoreError([diagnostic("BT195", NOWHERE, place=place, reason=reason)])


def owned_error(place: str, owner: str) -> MissionError:
    """Make the error BT197: another process has the ownership."""
    return MissionError([diagnostic("BT197", NOWHERE, place=place, owner=owner)])


class Database(ABC):
    """A database at a place, which may be used from any thread. Its connections are opened when they are needed.

    The SQL is what SQLite and PostgreSQL have in common; what they haven't is here.
    """

    begin: ClassVar[Mapping[Mode, Sequence[str]]]
    """The statements that begin a transaction."""
    row_lock: ClassVar[Mapping[Mode, str]]
    """The end of a query for rows that nobody else may change until the end of the transaction: one in the mode WRITE
    leaves out those that others change at this moment, one that is ALONE waits for them.
    """
    is_shared: ClassVar[bool]
    """Whether other programs may have tables beside those of the store."""

    def __init__(self, place: str, errors: tuple[type[Exception], ...]) -> None:
        self.place = place
        """The place for messages: without a password."""
        self._errors: tuple[type[Exception], ...] = (*errors, UnicodeEncodeError, OverflowError, NestedTooDeep)
        self._idle: list[Any] = []
        self._is_closed = False
        self._process = os.getpid()
        self._of_parent: list[Any] = []
        self._lock = threading.Lock()

    @contextmanager
    def transaction(self, mode: Mode = Mode.WRITE) -> Iterator[Execute]:
        """Do all or nothing of what is executed in it. Raises StoreError, also for what the database refuses inside."""
        with self._turn(mode):
            connection = self._begin(mode)
            try:
                yield partial(self._execute, connection)
                self._run(connection, "COMMIT")
            except BaseException as error:
                self._undo(connection)
                if isinstance(error, self._errors):
                    raise self._problem(error) from error
                raise
            self._keep(connection)

    def close(self) -> None:
        """End all connections, and the ownership; those in use end with their transactions. May be called twice."""
        with self._lock:
            self._is_closed = True
            idle, self._idle = self._idle, []
        for connection in idle:
            self._drop(connection)
        self.disown()

    def check(self) -> None:  # noqa: B027 - a server looks after its files itself
        """Raise StoreError if what is stored is damaged."""

    def prepare(self) -> None:  # noqa: B027 - a server needs nothing
        """Do what a store needs before anything is written into it. Raises StoreError."""

    @abstractmethod
    def tables(self, execute: Execute) -> dict[str, list[str]]:
        """Return the columns of each table."""

    @abstractmethod
    def own(self) -> None:
        """Take the ownership, or make sure of it. Raises MissionError (BT197) if another process has it."""

    @abstractmethod
    def disown(self) -> None:
        """Give the ownership up, if this is the owner."""

    @abstractmethod
    def _connect(self) -> Any:
        """Return a new connection, without a transaction."""

    @abstractmethod
    def _run(self, connection: Any, sql: str, values: Sequence[object] = ()) -> list[tuple[Any, ...]]:
        """Return the rows of the result of one statement."""

    @abstractmethod
    def _is_lost(self, connection: Any) -> bool:
        """Return whether a connection broke."""

    @abstractmethod
    def _is_free(self, connection: Any) -> bool:
        """Return whether a connection has no transaction, and didn't break."""

    @abstractmethod
    def _reason(self, error: Exception) -> str:
        """Return why the database refused, in plain words."""

    def _turn(self, mode: Mode) -> AbstractContextManager[object]:
        """Wait before a transaction takes a connection."""
        return nullcontext()

    def _problem(self, error: BaseException) -> StoreError:
        if isinstance(error, UnicodeEncodeError):
            return store_error(self.place, "it can't keep half a character (a lone surrogate)")
        if isinstance(error, OverflowError):
            return store_error(self.place, "it can't keep a number that is so large")
        if isinstance(error, NestedTooDeep):
            return store_error(self.place, "it can't keep values that are nested so deep")
        assert isinstance(error, Exception)
        return store_error(self.place, self._reason(error))

    def _begin(self, mode: Mode) -> Any:
        """Return a connection in a transaction."""
        while True:
            with self._lock:
                if self._is_closed:
                    raise store_error(self.place, "it has been closed")
                if self._process != os.getpid():  # a child process must not use, nor end, what its parent has
                    self._process, self._of_parent, self._idle = os.getpid(), self._idle, []
                used = self._idle.pop() if self._idle else None
            connection = used
            try:
                connection = self._connect() if used is None else used
                for statement in self.begin[mode]:
                    self._run(connection, statement)
                return connection
            except BaseException as error:
                # it may have broken while nobody used it: nothing is lost yet, and a new one may serve
                again = used is not None and isinstance(error, self._errors) and self._is_lost(used)
                if connection is not None:
                    self._drop(connection)
                if again:
                    continue
                if isinstance(error, self._errors):
                    raise self._problem(error) from error
                raise

    def _execute(self, connection: Any, sql: str, values: Sequence[object] = ()) -> list[tuple[Any, ...]]:
        for value in values:
            if isinstance(value, str) and "\0" in value:
                raise store_error(self.place, "it can't keep a text with a NUL character")
            if value != value:
                raise store_error(self.place, "it can't keep NaN, which isn't a number")
        return self._run(connection, sql, values)

    def _keep(self, connection: Any) -> None:
        with self._lock:
            if not self._is_closed and len(self._idle) < _MOST_IDLE:
                self._idle.append(connection)
                return
        self._drop(connection)

    def _undo(self, connection: Any) -> None:
        """Undo its transaction, and keep the connection if it can go on: while a disk is full, no other one may be
        had.
        """
        with suppress(*self._errors):
            self._run(connection, "ROLLBACK")
        if self._is_free(connection):
            self._keep(connection)
        else:
            self._drop(connection)

    def _drop(self, connection: Any) -> None:
        """Undo its transaction, if it has one, and close the connection."""
        with suppress(*self._errors):
            self._run(connection, "ROLLBACK")
        with suppress(*self._errors):
            connection.close()


def _leave_to_parent() -> None:
    """Leave the ownership to the parent: a child process would keep it when its parent dies."""
    nothing = os.open(os.devnull, os.O_RDWR)
    while OWNED:
        os.dup2(nothing, OWNED.pop(), inheritable=False)
    os.close(nothing)


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_leave_to_parent)


class Outbox:
    """A queue of changes for a store that may refuse for a while, for one thread.

    It keeps their order. `trouble` gets why the store refuses, for people. Before each other attempt `make_room` may
    remove what isn't needed, since a full disk is the usual reason.
    """

    def __init__(self, trouble: Callable[[str], object], make_room: Callable[[], object] = lambda: None) -> None:
        self._trouble, self._make_room = trouble, make_room
        self._waiting: list[Callable[[], object]] = []

    def __bool__(self) -> bool:
        return bool(self._waiting)

    def write(self, change: Callable[[], object]) -> None:
        """Make a change now, or as soon as the store takes it: what has happened is not lost."""
        if not self._waiting:
            try:
                change()
                return
            except StoreError as error:
                self._trouble(str(error))
        self._waiting.append(change)

    def flush(self) -> None:
        """Make the changes that wait. Raises StoreError for the first one that is refused again."""
        if self._waiting:
            self._make_room()
        while self._waiting:
            self._waiting[0]()
            self._waiting.pop(0)
