"""Walks over trees as loops, because trees may be 10,000 deep."""

from __future__ import annotations

from collections.abc import Callable, Sequence

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeVar

    Item = TypeVar("Item")
    Result = TypeVar("Result")


def fold(
    root: Item, parts: Callable[[Item], Sequence[Item]], combine: Callable[[Item, list[Result]], Result]
) -> Result:
    """Combines each item with the results of its parts, parts first."""
    results: list[Result] = []
    stack: list[tuple[Item, int]] = [(root, -1)]  # -1: its parts are still to be done
    while stack:
        item, count = stack.pop()
        if count < 0:
            inner = parts(item)
            stack.append((item, len(inner)))
            stack.extend((part, -1) for part in reversed(inner))
        else:
            done = results[len(results) - count :]
            del results[len(results) - count :]
            results.append(combine(item, done))
    return results[0]
