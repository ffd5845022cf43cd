"""Parts of a file that are no tree, as they were written: elements with their texts and comments."""

from __future__ import annotations

from btlang.frontends.btcpp.origin import Element, Markup
from btlang.frontends.btcpp.scan import Document, Note

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    Items: TypeAlias = list[Element | Markup | str]


IN_TEXTS = str.maketrans({"&": "&amp;", "<": "&lt;", ">": "&gt;", "\r": "&#13;"})
_NODES = 2  # elements around nodes: <root> and <BehaviorTree>


class Notes:
    """The notes of a document by where they stand."""

    def __init__(self, document: Document) -> None:
        self._document = document
        self._before: dict[int, list[Note]] = {}
        self._inside: dict[int, list[Note]] = {}
        self._heading: dict[int, list[Note]] = {}
        self._behind: dict[int, list[Note]] = {}
        self.texts: list[tuple[Note, int]] = []
        """Texts, each with the element that it stands in, in the order of the file."""
        if document.notes:
            self._place()

    def __bool__(self) -> bool:
        return bool(self._document.notes)

    def before(self, index: int) -> list[Note]:
        """Those right before an element, which may be one behind the last."""
        return self._before.get(index, [])

    def inside(self, index: int) -> list[Note]:
        """Those behind the last element inside an element; -1 stands for the whole file."""
        return self._inside.get(index, [])

    def heading(self, index: int) -> list[Note]:
        """Those behind the start tag of a node, on its line."""
        return self._heading.get(index, [])

    def behind(self, index: int) -> list[Note]:
        """Those behind a node that has ended, on its line."""
        return self._behind.get(index, [])

    def among(self, first: int, end: int) -> tuple[dict[int, tuple[str, ...]], ...]:
        """Those of some elements, which are numbered from 0: before each, inside it, and on the line of its start tag
        and of its end.
        """
        return tuple(
            {at - first: as_written(found[at]) for at in range(first, end) if at in found} if found else {}
            for found in (self._before, self._inside, self._heading, self._behind)
        )

    def _place(self) -> None:
        """In the order of the file; `opened` are the elements around the present place."""
        elements, depths = self._document.elements, self._document.depths
        opened: list[int] = []
        started = 0
        last: tuple[int, int] = (0, 0)
        owner: list[Note] | None = None  # that of the note before this one, if it stands on the line of a tag
        for note in self._document.notes:
            while started < note.before:
                del opened[depths[started] :]
                opened.append(started)
                started += 1
            closed = opened[note.before - note.ended :][:1]
            del opened[note.before - note.ended :]
            around = opened[-1] if opened else -1
            if note.is_text:
                self.texts.append((note, around))
                owner = None
            elif self._is_on_line(note):
                if last != (note.before, note.ended):
                    kind, at = (self._behind, closed[0]) if closed else (self._heading, around)
                    owner = kind.setdefault(at, []) if at >= 0 and depths[at] >= _NODES else None
            else:
                owner = None
            last = note.before, note.ended
            if owner is not None:
                owner.append(note)
            elif note.before < len(elements) and elements[note.before][3] == note.ended:
                self._before.setdefault(note.before, []).append(note)
            else:
                self._inside.setdefault(around, []).append(note)

    def _is_on_line(self, note: Note) -> bool:
        """Whether something ends on its line."""
        text, at = self._document.text, note.start - 1
        while at >= 0 and text[at] in " \t":
            at -= 1
        return at >= 0 and text[at] == ">"


def as_items(notes: list[Note]) -> Items:
    """Texts and comments."""
    return [note.text if note.is_text else Markup(note.text) for note in notes]


def as_written(notes: list[Note]) -> tuple[str, ...]:
    """Comments as they are written, and texts as they can be."""
    if len(notes) == 1 and not notes[0].is_text:
        return (notes[0].text,)  # nearly always
    return tuple(note.text.strip().translate(IN_TEXTS) if note.is_text else note.text for note in notes)


def fragment(document: Document, notes: Notes, index: int) -> Element:
    """An element with all that is in it."""
    levels: list[Items] = []
    for at in range(document.end(index) - 1, index - 1, -1):
        depth = document.depths[at] - document.depths[index]
        while len(levels) < depth + 2:
            levels.append([])
        inner = levels[depth + 1][::-1] + as_items(notes.inside(at))
        levels[depth + 1] = []
        element = Element(document.elements[at][0], tuple(document.attributes(at).items()), tuple(inner))
        levels[depth].append(element)
        if at != index:
            levels[depth] += as_items(notes.before(at))[::-1]
    [made] = levels[0]
    assert isinstance(made, Element)
    return made
