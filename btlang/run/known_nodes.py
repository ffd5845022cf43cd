"""What a page knows of the nodes of a run: so that only what is new has to be sent; and where the text says them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from btlang.engine.status import IDLE
from btlang.run.snapshot import HALTED, SUSPENDED

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Protocol

    from btlang.text.source import Span
    from btlang.tree.node import Node

    class Spans(Protocol):
        """The nodes of a run by their numbers: a btlang.engine.engine.Engine, or those of a recording."""

        @property
        def size(self) -> int: ...

        def span(self, index: int) -> Span | None: ...


_SHOWN = bytes.maketrans(bytes([HALTED, SUSPENDED]), bytes([IDLE, IDLE]))


class KnownNodes:
    """The statuses and the words of `count` nodes, as somebody has got them so far. In the beginning all are IDLE."""

    def __init__(self, count: int) -> None:
        self._codes = bytes([IDLE]) * count
        self._valued: dict[int, Node] = {}

    def new_statuses(self, codes: bytes) -> list[tuple[int, int]]:
        """Return number and status of each node that has another status by now; HALTED and SUSPENDED are IDLE."""
        before, self._codes = self._codes, codes.translate(_SHOWN)
        return [(index, self._codes[index]) for index in _differing(before, self._codes)]

    def new_words(self, valued: Mapping[int, Node], label: Callable[[Node], str]) -> list[tuple[int, str]]:
        """Return number and words of each node whose keys have other values by now."""
        found = []
        for index, node in valued.items():
            known = self._valued.get(index)
            if known is not node:
                self._valued[index] = node
                if known is None or known.ports != node.ports:
                    found.append((index, label(node)))
        return found


def text_and_places(syntax: Any, nodes: Spans) -> tuple[str, list[tuple[int, int] | None]]:
    """Return the text that a mission was read from, and the characters of it that say each node.

    `syntax` is that of a btlang.api.Mission, None for one without a text. A node that another file says has no place.
    """
    source = None if syntax is None else syntax.span.source
    spans = [nodes.span(index) for index in range(nodes.size)]
    places = [(span.start, span.end) if span is not None and span.source is source else None for span in spans]
    return "" if source is None else source.text, places


def _differing(before: bytes, after: bytes) -> Iterator[int]:
    """Yield the positions that differ, found by halves: few nodes of a large tree change at a time."""
    spans = [(0, len(after))]
    while spans:
        start, end = spans.pop()
        if before[start:end] == after[start:end]:
            continue
        if end - start == 1:
            yield start
        else:
            middle = (start + end) // 2
            spans += (middle, end), (start, middle)
