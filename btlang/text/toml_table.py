"""Typed reading of TOML tables. A missing, unknown or mistyped key becomes a Problem with its position."""

from __future__ import annotations

import re
from functools import partial

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any, TypeVar

    from btlang.text.toml import Path

    T = TypeVar("T")


_MOST = 1_000_000
_NUMBER = re.compile(r"-?\d+(\.\d+)?")
_MOST_PROBLEMS = 100  # that are reported; who reads more of them at once?


def is_coordinate(value: object) -> bool:
    """Whether it's a finite number, at most a million."""
    return isinstance(value, int | float) and not isinstance(value, bool) and -_MOST <= value <= _MOST


class Problem(Exception):
    """A problem at a path of the file. `more` are others of the same file."""

    def __init__(self, message: str, *path: str | int) -> None:
        super().__init__(message)
        self.message = message
        self.path = path
        self.more: tuple[Problem, ...] = ()


class Problems:
    """The problems of a file, gathered so that all can be reported at once."""

    def __init__(self) -> None:
        self.found: list[Problem] = []

    def part(self, make: Callable[[], T], usual: T) -> T:
        """Return what `make` returns; the usual value if it raises a Problem, which is kept."""
        try:
            return make()
        except Problem as problem:
            self.found.append(problem)
            return usual

    def rows(self, top: Table, key: str, make: Callable[[Table], T]) -> list[T | None]:
        """Return what `make` makes of each table of a list, None for wrong ones; until there are too many."""
        tables: list[Table] = self.part(lambda: top.tables(key), [])
        return [self.part(partial(make, table), None) for table in tables if len(self.found) < _MOST_PROBLEMS]

    def end(self) -> None:
        """Raise the first Problem with the others, at most a hundred in all, if there is one."""
        if self.found:
            first, *more = self.found[:_MOST_PROBLEMS]
            first.more = tuple(more)
            raise first


class Table:
    """A table of the file, called `name` in messages; `finish` reports keys that nobody asked for."""

    __slots__ = ("_name", "_path", "_read", "_values")

    def __init__(self, name: str, values: dict[str, Any], path: Path = ()) -> None:
        self._name = name
        self._path = path
        self._values = values
        self._read: list[str] = []

    @property
    def path(self) -> Path:
        """Where it is in the file."""
        return self._path

    def keys(self) -> list[str]:
        """List all keys, for a table whose keys are names that the file gives."""
        return list(self._values)

    def is_list(self, key: str) -> bool:
        """Whether a list is given."""
        return self.has(key) and isinstance(self._values[key], list)

    def is_text(self, key: str) -> bool:
        """Whether a text is given."""
        return self.has(key) and isinstance(self._values[key], str)

    def has(self, key: str) -> bool:
        """Whether the key is given; it then counts as known."""
        self._read.append(key)
        return key in self._values

    def number(
        self, key: str, default: float | None = None, low: float | None = None, high: float | None = None
    ) -> float:
        """Return a finite number within the bounds, by default a million. Raises Problem."""
        if not self.has(key) and default is not None:
            return default
        value = self._require(key, "a number")
        if type(value) not in (int, float) or value != value:
            raise self.problem(key, f'"{key}" must be a number; write {key} = {_number_in(value)}')
        if not is_coordinate(value):
            raise self.problem(key, f'"{key}" must be a number from {-_MOST:,} to {_MOST:,}')
        if (low is not None and value < low) or (high is not None and value > high):
            bounds = f"at least {low:g}" if high is None else f"from {low:g} to {high:g}"
            raise self.problem(key, f'"{key}" must be {bounds}, not {value:g}')
        return float(value)

    def text(self, key: str) -> str:
        """Return a text that isn't blank. Raises Problem."""
        value = self._require(key, "a text")
        if not isinstance(value, str) or not value.strip():
            raise self.problem(key, f'"{key}" must be text in quotes; write {key} = "kitchen"')
        return " ".join(value.split())

    def flag(self, key: str, default: bool = False) -> bool:
        """Return true or false. Raises Problem."""
        value = self._values[key] if self.has(key) else default
        if not isinstance(value, bool):
            raise self.problem(key, f'"{key}" must be true or false')
        return value

    def choice(self, key: str, values: tuple[str, ...], default: str | None = None, hint: str = "") -> str:
        """Return one of the values. Raises Problem, which ends with the hint."""
        if not self.has(key) and default is not None:
            return default
        value = self._require(key, "a text")
        if value not in values:
            listed = ", ".join(f'"{known}"' for known in values) or "nothing, because there is none"
            raise self.problem(key, f'"{key}" must be one of {listed}{hint and f"; {hint}"}')
        return str(value)

    def texts(self, key: str) -> tuple[str, ...]:
        """Return a list of texts that aren't blank, empty if it is missing. Raises Problem."""
        for index, item in enumerate(self.items(key)):
            if not isinstance(item, str) or not item.strip():
                raise Problem(f'"{key}" must be a list of texts; write {key} = ["voice"]', *self._path, key, index)
        return tuple(self.items(key))

    def values(self, key: str) -> dict[str, Any]:
        """Return a table of numbers, texts, flags and lists of them by any names, empty if it is missing.

        Raises Problem.
        """
        value = self._values[key] if self.has(key) else {}
        if not isinstance(value, dict):
            raise self.problem(key, f'"{key}" must be a table; write {key} = {{ id = 1 }}')
        for name, item in value.items():
            items = item if isinstance(item, list) else [item]
            if any(not isinstance(each, int | float | str) or each != each for each in items):
                raise Problem(f'"{name}" must be a number, a text, true or false', *self._path, key, name)
        return dict(value)

    def table(self, key: str) -> Table:
        """Return the table under the key. Raises Problem."""
        value = self._require(key, "a table")
        if not isinstance(value, dict):
            raise self.problem(key, f'"{key}" must be a table; write {key} = {{ x = 1, y = 1 }}')
        return Table(key, value, (*self._path, key))

    def items(self, key: str) -> list[Any]:
        """Return the list under the key, empty if it is missing. Raises Problem."""
        value = self._values[key] if self.has(key) else []
        if not isinstance(value, list):
            raise self.problem(key, f'"{key}" must be a list; write {key} = [ ... ]')
        return value

    def tables(self, key: str) -> list[Table]:
        """Return the list of tables under the key, empty if it is missing. Raises Problem."""
        items = self.items(key)
        for index, item in enumerate(items):
            if not isinstance(item, dict):
                raise Problem(f'"{key}" must be a list of tables; write [[{key}]] above each', *self._path, key, index)
        return [Table(key, item, (*self._path, key, index)) for index, item in enumerate(items)]

    def finish(self, result: T) -> T:
        """Return the result when every key was asked for. Raises Problem for an unknown one."""
        for key in self._values:
            if key not in self._read:
                known = ", ".join(dict.fromkeys(self._read))
                raise self.problem(key, f'unknown key "{key}" in {self._name}; the keys are {known}')
        return result

    def problem(self, key: str, message: str) -> Problem:
        """Make a Problem at this key."""
        return Problem(message, *self._path, key)

    def _require(self, key: str, kind: str) -> Any:
        if self.has(key):
            return self._values[key]
        from btlang.text.spelling import misspelt

        near = misspelt(key, [each for each in self._values if each not in self._read])
        if near:
            self._read.append(near[0])  # which is said once
            raise self.problem(near[0], f'unknown key "{near[0]}" in {self._name}; it needs {kind} "{key}"')
        raise self.problem(key, f'{self._name} needs {kind} "{key}"')


def _number_in(value: object) -> str:
    """Return the number that a text says, or an example."""
    return value.strip() if isinstance(value, str) and _NUMBER.fullmatch(value.strip()) else "1.5"
