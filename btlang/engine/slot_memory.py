"""What nodes of generated regions remember, as the cells of closures are read and written."""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class SlotMemory:
    """What a node of a generated region remembers, in slots one behind the other; see regions.py."""

    __slots__ = ("_first", "_slots", "names")

    def __init__(self, slots: list[Any], first: int, names: tuple[str, ...]) -> None:
        self._slots = slots
        self._first = first
        self.names = names

    def cells(self) -> dict[str, Slot]:
        """Return its slots by their names."""
        return {name: Slot(self._slots, self._first + number) for number, name in enumerate(self.names)}


class Slot:
    """A slot, used as the cell of a closure."""

    __slots__ = ("_at", "_slots")

    def __init__(self, slots: list[Any], at: int) -> None:
        self._slots = slots
        self._at = at

    @property
    def cell_contents(self) -> Any:
        return self._slots[self._at]

    @cell_contents.setter
    def cell_contents(self, value: Any) -> None:
        self._slots[self._at] = value
