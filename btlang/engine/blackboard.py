"""The blackboard: values that leaves share within one mission."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from btlang.engine.leaves.leaf import ActionFailed

MOST_TEXT = 1_000_000
"""Characters of the longest text that is kept: a script that doubles one would fill the memory."""

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class Blackboard:
    """A scope of named values, as blackboard.cpp of BehaviorTree.CPP 4.10 has it.

    A subtree has its own scope and sees of its parent's only the keys remapped to it. With `shares`, each key is also
    the parent's, except those that the scope has its own values for, and private ones, which begin with `_`.
    A key `@name` is the key `name` of the outermost scope, whatever is remapped.

    One difference: a subtree that unsets a key of its parent's unsets it there. In C++ it only forgets it itself.
    """

    __slots__ = ("_outermost", "_remapped", "_state", "_values", "_writes")

    def __init__(
        self,
        remapped: Mapping[str, tuple[Blackboard, str]] | None = None,
        parent: Blackboard | None = None,
        *,
        shares: bool = False,
        values: Mapping[str, Any] | None = None,
    ) -> None:
        self._values = dict(values or {})
        self._remapped = dict(remapped or {})
        self._outermost: Blackboard = self if parent is None else parent._outermost
        self._state = parent if shares else None
        self._writes: dict[str, int] = {}  # only of keys that somebody has asked for

    @property
    def shared(self) -> Blackboard:
        """The scope to which all its keys but private ones belong: itself, or one around it."""
        scope = self
        while scope._state is not None and not scope._remapped and not scope._values:
            scope = scope._state
        return scope

    def _owner(self, key: str) -> tuple[Blackboard, str]:
        scope = self
        while True:
            if key in scope._values:
                return scope, key
            if key[:1] == "@":
                scope, key = scope._outermost, key[1:]
            elif key in scope._remapped:
                scope, key = scope._remapped[key]
            elif scope._state is not None and key[:1] != "_":
                scope = scope._state
            else:
                return scope, key

    def get(self, key: str) -> Any:
        """Return the value of a key. Raises KeyError if nothing was set."""
        if key in self._values:  # most keys are, and this is the quickest way to them
            return self._values[key]
        scope, key = self._owner(key)
        return scope._values[key]

    def own_values(self) -> dict[str, Any]:
        """Return a copy of the values in this scope itself."""
        return dict(self._values)

    def argument(self, key: str) -> Any:
        """Return what a subtree was given for a key, None for a key of the outermost scope."""
        scope, key = self._owner(key)
        return scope._values.get(key) if scope is not self._outermost else None

    def set(self, key: str, value: Any) -> None:
        """Set the value in the scope that owns the key. Raises ActionFailed for a text longer than MOST_TEXT."""
        if value.__class__ is str:
            check_length(value)
        scope, key = self._owner(key)
        scope._values[key] = value
        if key in scope._writes:
            scope._writes[key] += 1

    def unset(self, key: str) -> None:
        """Remove the value from the scope that owns the key."""
        scope, key = self._owner(key)
        scope._values.pop(key, None)

    def writes(self, key: str) -> int:
        """Count how often the key was set, to whatever value, since this was first asked of it."""
        scope, key = self._owner(key)
        return scope._writes.setdefault(key, 0)

    def dump(self, keep: Callable[[Any], Any]) -> dict[str, Any]:
        """Return the values of this scope itself, each made into JSON by `keep`, and how often its keys were set."""
        return {"values": {key: keep(value) for key, value in self._values.items()}, "writes": dict(self._writes)}

    def load(self, saved: Mapping[str, Any], unkeep: Callable[[Any], Any]) -> None:
        """Replace the values of this scope by those that `dump` returned."""
        self._values = {key: unkeep(value) for key, value in saved["values"].items()}
        self._writes = dict(saved["writes"])

    def __contains__(self, key: str) -> bool:
        scope, key = self._owner(key)
        return key in scope._values

    def keys(self) -> list[str]:
        """List the keys that can be read here: own ones, then the parent's that have a value."""
        found = dict.fromkeys(self._values)
        scope: Blackboard | None = self
        while scope is not None:  # a loop: subtrees that share their keys may be nested deeply
            found.update(dict.fromkeys(key for key in scope._remapped if key in self))
            scope = scope._state
            if scope is not None:
                found.update(dict.fromkeys(key for key in scope._values if key[:1] != "_"))
        return list(found)


def check_length(text: str) -> str:
    """Return the text. Raises ActionFailed if it is longer than MOST_TEXT."""
    if len(text) > MOST_TEXT:
        raise ActionFailed(f"a text of more than {MOST_TEXT:,} characters is too long for a value")
    return text
