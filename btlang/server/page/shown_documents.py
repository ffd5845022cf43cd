"""Documents as pages have them already, so that only what has changed of a long one is sent behind each key."""

from __future__ import annotations

import secrets
from collections.abc import Sequence

from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_MOST = 16  # documents of all pages together; who comes back later gets the whole
_LISTS = ("nodes", "outline")
_PLACES = ("start", "end", "of")


class Change(Record):
    """The change between two texts: the units from `start` to `end` became `longer` units more."""

    start: int
    end: int
    longer: int

    def moved(self, place: Any) -> Any:
        """Return where a place of the old text is in the new one; -1 where it may be anywhere."""
        if isinstance(place, list | tuple):
            return [self.moved(each) for each in place]
        if place is None or place <= self.start:
            return place
        return place + self.longer if place >= self.end else -1


class ShownDocuments:
    """What pages were sent last, by the names that they got with it."""

    def __init__(self) -> None:
        self._shown: dict[str, tuple[bytes, dict[str, Any]]] = {}

    def shorten(self, answer: dict[str, Any], text: str, shown: str) -> dict[str, Any]:
        """Return an answer with its name, `shown`, and with what a page that has the one called `shown` lacks of it.

        If that is known here, `change` is what to do with its places, [start, end, longer], and each list is an object:
        `head` and `tail` are the numbers of entries that are as before but for their places, `items` those between
        them. Nodes that are as before have the same level in the tree, which gives their parents.
        """
        if "nodes" not in answer:
            return answer
        lists = {"nodes": _with_levels(answer), "outline": answer["outline"]}
        units = text.encode("utf-16-le", "surrogatepass")
        before = self._shown.pop(shown, None)
        name = secrets.token_hex(8)
        self._shown[name] = units, lists
        while len(self._shown) > _MOST:
            del self._shown[next(iter(self._shown))]
        if before is None:
            return {**answer, "shown": name}
        change = find_change(before[0], units)
        parts = {}
        for part in _LISTS:
            head, tail = _find_difference(before[1][part], lists[part], change)
            items = answer[part][head : len(lists[part]) - tail]
            parts[part] = {"head": head, "tail": tail, "items": list(items)}
        return {
            **answer,
            **_with_own_kinds(parts, answer["kinds"]),
            "shown": name,
            "change": [change.start, change.end, change.longer],
        }


def find_change(before: bytes, after: bytes) -> Change:
    """Return the change between two texts in UTF-16."""
    most = min(len(before), len(after)) // 2
    start = _largest(most, lambda count: before[: 2 * count] == after[: 2 * count])
    tail = _largest(most - start, lambda count: before[len(before) - 2 * count :] == after[len(after) - 2 * count :])
    return Change(start, len(before) // 2 - tail, (len(after) - len(before)) // 2)


def _largest(most: int, holds: Any) -> int:
    """Return the largest number for which something holds that holds for all smaller ones."""
    least = 0
    while least < most:
        middle = (least + most + 1) // 2
        least, most = (middle, most) if holds(middle) else (least, middle - 1)
    return least


def _with_own_kinds(parts: dict[str, Any], kinds: list[Any]) -> dict[str, Any]:
    """Return the parts with the kinds of their nodes alone: of a long text there are many, one for each phrase."""
    nodes = parts["nodes"]
    used = sorted({node["kind"] for node in nodes["items"] if "kind" in node})
    numbers = {kind: number for number, kind in enumerate(used)}
    items = [{**node, "kind": numbers[node["kind"]]} if "kind" in node else node for node in nodes["items"]]
    return {**parts, "nodes": {**nodes, "items": items}, "kinds": [kinds[kind] for kind in used]}


def _with_levels(answer: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the nodes with what is the same wherever they are: their level, and what their kind stands for."""
    found: list[dict[str, Any]] = []
    for node in answer["nodes"]:
        parent = node["parent"]
        level = found[parent]["parent"] + 1 if parent >= 0 else 0
        found.append({**node, "parent": level, "kind": answer["kinds"][node["kind"]] if "kind" in node else None})
    return found


def _find_difference(
    before: Sequence[dict[str, Any]], after: Sequence[dict[str, Any]], change: Change
) -> tuple[int, int]:
    """Return how many entries from the beginning, and how many from the end, are the same."""
    most = min(len(before), len(after))
    head = next((at for at in range(most) if not _is_same(before[at], after[at], change)), most)
    tail = 0
    while tail < most - head and _is_same(before[-1 - tail], after[-1 - tail], change):
        tail += 1
    return head, tail


def _is_same(before: dict[str, Any], after: dict[str, Any], change: Change) -> bool:
    """Whether an entry is the same but for its places."""
    if before.keys() != after.keys():
        return False
    for name, value in before.items():
        if name not in _PLACES:
            if after[name] != value:
                return False
            continue
        wanted = change.moved(value)
        given = list(after[name]) if isinstance(after[name], list | tuple) else after[name]
        if wanted != given or wanted == -1 or (isinstance(wanted, list) and -1 in wanted):
            return False
    return True
