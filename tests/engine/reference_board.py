"""The blackboard of the reference interpreter: the boards of subtrees know how their keys are called above."""

from __future__ import annotations

from collections import Counter
from typing import Any


class Board:
    """The entries of one tree; scripts take it for a blackboard. `names` are keys of the board above by keys here."""

    def __init__(self, above: Board | None = None) -> None:
        self.above = above
        self.values: dict[str, Any] = {}
        self.names: dict[str, str] = {}
        self.shares = False
        self.counts: Counter[str] = Counter()

    def of_subtree(self, ports: tuple[tuple[str, str], ...]) -> Board:
        board = Board(self)
        for port, text in ports:
            if port == "_autoremap":
                board.shares = text == "true"
            elif text.startswith("{"):
                board.names[port] = text.strip("{}")
            elif port != "ID" and not port.startswith("_"):
                board.values[port] = int(text) if text.isdigit() else text
                board.counts[port] = 1
        return board

    def place(self, key: str) -> tuple[Board, str]:
        """The board that holds the entry which a key means here, and the key of the entry there."""
        if key in self.values or self.above is None:
            return self, key.removeprefix("@")
        if key.startswith("@"):
            return self.above.place(key)
        if key in self.names:
            return self.above.place(self.names[key])
        if self.shares and not key.startswith("_"):
            return self.above.place(key)
        return self, key

    def get(self, key: str) -> Any:
        board, name = self.place(key)
        return board.values[name]

    def set(self, key: str, value: Any) -> None:
        board, name = self.place(key)
        board.values[name] = value
        board.counts[name] += 1

    def unset(self, key: str) -> None:
        board, name = self.place(key)
        board.values.pop(name, None)

    def writes(self, key: str) -> int:
        board, name = self.place(key)
        return board.counts[name]

    def __contains__(self, key: str) -> bool:
        board, name = self.place(key)
        return name in board.values
