"""Where the parts of an XML file stand in its text, so that one part can be changed and all others stay as they are."""

from __future__ import annotations

import re
from collections.abc import Iterator

from btlang.frontends.btcpp.scan import Document
from btlang.support.record import Record

_MARKUP = re.compile(r"(?P<note><!--.*?-->|<\?.*?\?>)|<!\[CDATA\[.*?\]\]>|<!.*?>|(?P<tag></?)[^>]*>", re.DOTALL)
_ATTRIBUTE = re.compile(r"""\s*([^\s"'=<>/]+)\s*=\s*("[^"]*"|'[^']*')""")
_TAG = re.compile(r"</?([^\s/>]+)")


class Place(Record):
    """The characters of an element: its start tag from `start` to `head`, its end tag from `foot` to `end`.

    An element without an end tag has `head`, `foot` and `end` in one place.
    """

    start: int
    head: int
    foot: int
    end: int


class Attribute(Record):
    """One attribute with the blanks before it, and its value in quotes."""

    name: str
    start: int
    value: int
    end: int


class Layout:
    """The places of a document's elements, and of its comments and processing instructions, by their numbers."""

    def __init__(self, document: Document) -> None:
        self.text = document.text
        self.places: list[Place] = []
        self.notes: list[tuple[int, int]] = []
        opened: list[tuple[int, int, int]] = []
        found: dict[int, Place] = {}
        count = 0
        for match in _MARKUP.finditer(self.text):
            start, end = match.span()
            if match["note"] is not None:
                self.notes.append((start, end))
            elif match["tag"] == "</":
                number, first, head = opened.pop()
                found[number] = Place(first, head, start, end)
            elif match["tag"] == "<":
                if self.text[end - 2] == "/":
                    found[count] = Place(start, end, end, end)
                else:
                    opened.append((count, start, end))
                count += 1
        self.places = [found[number] for number in range(count)]
        if document.declaration:
            del self.notes[0]  # it looks like an instruction, and is none

    def attributes(self, number: int) -> Iterator[Attribute]:
        """The attributes of an element, as they are written."""
        place = self.places[number]
        at = self.tag(number)[1]
        while match := _ATTRIBUTE.match(self.text, at, place.head):
            yield Attribute(match[1], match.start(), match.start(2), match.end())
            at = match.end()

    def tag(self, number: int) -> tuple[int, int]:
        """The characters of the name in the start tag of an element."""
        match = _TAG.match(self.text, self.places[number].start)
        assert match is not None
        return match.span(1)
