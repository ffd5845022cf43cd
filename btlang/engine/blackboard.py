"""Values that leaves share within one mission."""

from __future__ import annotations

from collections.abc import Mapping

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class Blackboard:
    """One scope of named values. A subtree has its own scope and sees of its parent's only the keys remapped to it.

    A key `@name` is the key `name` of the outermost scope, whatever is remapped, as in BehaviorTree.CPP.
    """

    __slots__ = ("_outermost", "_remapped", "_values")

    def __init__(
        self, remapped: Mapping[str, tuple[Blackboard, str]] | None = None, parent: Blackboard | None = None
    ) -> None:
        self._values: dict[str, Any] = {}
        self._remapped = dict(remapped or {})
        self._outermost: Blackboard = self if parent is None else parent._outermost

    def _owner(self, key: str) -> tuple[Blackboard, str]:
        scope = self
        while True:
            if key[:1] == "@":
                scope, key = scope._outermost, key[1:]
            elif key in scope._remapped:
                scope, key = scope._remapped[key]
            else:
                return scope, key

    def get(self, key: str) -> Any:
        """Raises KeyError where nothing was set."""
        scope, key = self._owner(key)
        return scope._values[key]

    def set(self, key: str, value: Any) -> None:
        """Sets the value in the scope that owns the key."""
        scope, key = self._owner(key)
        scope._values[key] = value

    def unset(self, key: str) -> None:
        """Nothing is set any more in the scope that owns the key."""
        scope, key = self._owner(key)
        scope._values.pop(key, None)

    def __contains__(self, key: str) -> bool:
        scope, key = self._owner(key)
        return key in scope._values

    def keys(self) -> list[str]:
        """The keys that can be read here: own ones, then remapped ones that have a value."""
        return [*self._values, *(key for key in self._remapped if key in self)]
