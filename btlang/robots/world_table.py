"""Typed reading of TOML tables: what is missing, unknown or of another type becomes a Problem with its position."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeVar

    T = TypeVar("T")


_MOST = 1_000_000


class Problem(Exception):
    """What is wrong with one key of the n-th table (from 0) of a section."""

    def __init__(self, message: str, section: str = "", index: int = 0, key: str = "") -> None:
        super().__init__(message)
        self.message = message
        self.section = section
        self.index = index
        self.key = key


class Table:
    """One table of the file; `finish` reports keys that nobody asked for."""

    __slots__ = ("_index", "_read", "_section", "_values")

    def __init__(self, section: str, values: dict[str, Any], index: int = 0) -> None:
        self._section = section
        self._values = values
        self._index = index
        self._read: list[str] = []

    def has(self, key: str) -> bool:
        """Whether the key is given; it then counts as known."""
        self._read.append(key)
        return key in self._values

    def number(
        self, key: str, default: float | None = None, low: float | None = None, high: float | None = None
    ) -> float:
        """A finite number within the bounds, which are a million where there are none. Raises Problem."""
        if not self.has(key) and default is not None:
            return default
        value = self._required(key, "a number")
        if type(value) not in (int, float) or value != value:
            raise self.problem(key, f'"{key}" is a number; write {key} = 1.5')
        if not -_MOST <= value <= _MOST:
            raise self.problem(key, f'"{key}" is a number from {-_MOST:,} to {_MOST:,}')
        if (low is not None and value < low) or (high is not None and value > high):
            bounds = f"at least {low:g}" if high is None else f"from {low:g} to {high:g}"
            raise self.problem(key, f'"{key}" is {bounds}, not {value:g}')
        return float(value)

    def text(self, key: str) -> str:
        """Text that is not blank. Raises Problem."""
        value = self._required(key, "a text")
        if not isinstance(value, str) or not value.strip():
            raise self.problem(key, f'"{key}" is text in quotes; write {key} = "kitchen"')
        return " ".join(value.split())

    def choice(self, key: str, values: tuple[str, ...], default: str | None = None) -> str:
        """One of the values. Raises Problem."""
        if not self.has(key) and default is not None:
            return default
        value = self._required(key, "a text")
        if value not in values:
            listed = ", ".join(f'"{known}"' for known in values) or "nothing: there is none"
            raise self.problem(key, f'"{key}" is one of {listed}')
        return str(value)

    def table(self, key: str) -> Table:
        """The table under the key. Raises Problem."""
        value = self._required(key, "a table")
        if not isinstance(value, dict):
            raise Problem(f'"{key}" is a table; write {key} = {{ x = 1, y = 1 }}', key)
        return Table(key, value)

    def items(self, key: str) -> list[Any]:
        """The list under the key, empty where it is missing. Raises Problem."""
        value = self._values[key] if self.has(key) else []
        if not isinstance(value, list):
            raise Problem(f'"{key}" is a list; write {key} = [ ... ]', key)
        return value

    def tables(self, key: str) -> list[Table]:
        """The list of tables under the key, empty where it is missing. Raises Problem."""
        items = self.items(key)
        for index, item in enumerate(items):
            if not isinstance(item, dict):
                raise Problem(f'"{key}" holds tables; write [[{key}]] above each', key, index)
        return [Table(key, item, index) for index, item in enumerate(items)]

    def finish(self, result: T) -> T:
        """Returns the result when every key was asked for. Raises Problem for an unknown one."""
        for key in self._values:
            if key not in self._read:
                where = f"in {self._section}" if self._section else "in a world"
                known = ", ".join(dict.fromkeys(self._read))
                raise self.problem(key, f'unknown key "{key}" {where}; the keys are {known}')
        return result

    def problem(self, key: str, message: str) -> Problem:
        """A Problem at this key."""
        if not self._section:
            return Problem(message, key)
        return Problem(message, self._section, self._index, key)

    def _required(self, key: str, kind: str) -> Any:
        if not self.has(key):
            where = f"{self._section} needs" if self._section else "a world needs"
            raise self.problem(key, f'{where} {kind} "{key}"')
        return self._values[key]
