"""Rewriting of an XML file with other nodes in it. What isn't touched stays as it is, byte by byte."""

from __future__ import annotations

import re
from bisect import bisect_left
from collections import Counter
from collections.abc import Callable, Sequence

from btlang.backends.btcpp.markup import Markers
from btlang.frontends.btcpp.fragments import Notes
from btlang.frontends.btcpp.layout import Layout
from btlang.frontends.btcpp.scan import Document, Note
from btlang.support.record import Record
from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    from btlang.frontends.btcpp.spelling import Pairs, Spelling

    Work: TypeAlias = "str | _Slice | _Element"
    Shift: TypeAlias = tuple[str, str]
    """The margin of a line, and the one that it gets."""

_MARGIN = re.compile(r"\n([ \t]*)")
_IN_TAG = re.compile(r"""("[^"]*"|'[^']*')|\n([ \t]*)""")
_USUAL = "  "
STAYS = ("", "")


class _Slice(Record):
    """Characters of the file."""

    start: int
    end: int
    shift: Shift
    in_tag: bool = False


class _Element(Record):
    """A node to be written at a margin. `lead` is what stands before it, if that isn't what the file has there, and
    `bare` whether its comments are written already.
    """

    node: Node
    shift: Shift
    margin: str
    lead: str | None = None
    bare: bool = False


class Rewriter:
    """A rewriter of the text. `known` returns the number of the element that a node is already, `spell` how a node is
    written. Changes of single places (`change`) come first, then `write`.
    """

    def __init__(
        self, document: Document, notes: Notes, known: Callable[[Node], int | None], spell: Callable[[Node], Spelling]
    ) -> None:
        self._text = document.source.text
        self._document = document
        self._notes = notes
        self._layout = Layout(document)
        self._known, self._spell = known, spell
        self._markers = Markers()
        self._changes: list[tuple[int, int, str]] = []
        self._leads: dict[int, list[str]] = {}  # comments to come before nodes
        self._removed: set[int] = set()  # comments, by their `id()`
        comments = [note for note in document.notes if not note.is_text]
        self._spans = {id(note): span for note, span in zip(comments, self._layout.notes, strict=True)}
        self._parents: list[int] = []
        self._before: list[int] = []  # the element before each inside the same one, -1 for none
        self._children: list[list[int]] = [[] for _ in document.elements]
        self._find_children()
        self.line_end = "\r\n" if "\r\n" in self._text else "\n"
        self._unit = self._usual_unit()

    # -- what stands where

    def _find_children(self) -> None:
        opened: list[int] = []
        for number, depth in enumerate(self._document.depths):
            del opened[depth:]
            self._parents.append(opened[-1] if opened else -1)
            siblings = self._children[opened[-1]] if opened else []
            self._before.append(siblings[-1] if siblings else -1)
            siblings.append(number)
            opened.append(number)

    def span_of(self, note: Note) -> tuple[int, int]:
        """Return the characters of a comment."""
        return self._spans[id(note)]

    def _margin(self, number: int) -> str | None:
        """Return the blanks before an element, None if it isn't first on its line."""
        start = self._layout.places[number].start
        line = self._text.rfind("\n", 0, start) + 1
        return self._text[line:start] if self._text[line:start].isspace() or line == start else None

    def _usual_unit(self) -> str:
        """Return the indentation of the file."""
        steps: Counter[str] = Counter()
        for number, parent in enumerate(self._parents):
            inner, outer = self._margin(number), self._margin(parent) if parent >= 0 else None
            if inner is not None and outer is not None and inner.startswith(outer) and inner != outer:
                steps[inner[len(outer) :]] += 1
        return steps.most_common(1)[0][0] if steps else _USUAL

    def _open(self, number: int) -> int:
        """Return where the start tag of an element ends, with the comments on its line."""
        return max([self._layout.places[number].head, *(self.span_of(note)[1] for note in self._notes.heading(number))])

    def _end(self, number: int) -> int:
        """Return where an element ends, with the comments on its line."""
        return max([self._layout.places[number].end, *(self.span_of(note)[1] for note in self._notes.behind(number))])

    def _lead(self, number: int) -> int:
        """Return where the blanks and comments before an element begin."""
        before = self._before[number]
        return self._end(before) if before >= 0 else self._open(self._parents[number])

    def _is_in_line(self, number: int) -> bool:
        """Whether the elements inside one stand on its line."""
        inner = self._children[number]
        return bool(inner) and not any("\n" in self._lead_text(at) for at in inner)

    def _lead_text(self, number: int) -> str:
        return self._text[self._lead(number) : self._layout.places[number].start]

    # -- changes

    def change(self, start: int, end: int, text: str) -> None:
        """Put a text in place of some characters, which no other change touches."""
        self._changes.append((start, end, text))

    def add_comments(self, node: Node, comments: list[str]) -> None:
        """Add comments on separate lines before a node."""
        self._leads.setdefault(id(node), []).extend(comments)

    def add_around(self, comments: list[str], *, at_end: bool) -> None:
        """Add comments on separate lines before the outermost element, or at the end of what is in it."""
        root = self._layout.places[0]
        if not at_end:
            self.change(root.start, root.start, "".join(f"{text}{self.line_end}" for text in comments))
            return
        line = self._text.rfind("\n", 0, root.foot) + 1
        at = line if self._text[line : root.foot].strip() == "" else root.foot
        self.change(at, at, "".join(f"{self._unit}{text}{self.line_end}" for text in comments))

    def remove_comment(self, note: Note) -> None:
        """Remove a comment, with its line if nothing else stands there."""
        self._removed.add(id(note))
        start, end = self.span_of(note)
        line = self._text.rfind("\n", 0, start) + 1
        after = re.compile(r"[ \t]*(\r?\n|\Z)").match(self._text, end)
        if self._text[line:start].strip() == "" and line and after is not None:
            start = line - (2 if self._text[line - 2 : line] == "\r\n" else 1)
        elif after is not None:
            start = len(self._text[:start].rstrip(" \t"))
        self.change(start, end, "")

    def attributes(self, number: int, before: Pairs, after: Pairs) -> None:
        """Change the attributes of an element from those of one node to those of another one."""
        there = {each.name: each for each in self._layout.attributes(number)}
        old, new = dict(before), dict(after)
        touched = [key for key in old if old[key] != new.get(key)]
        place = self._layout.places[number]
        if any(key not in there for key in touched):  # the file says it in another way
            end = place.head - (2 if place.head == place.end and self._text[place.head - 2] == "/" else 1)
            self.change(self._layout.tag(number)[1], end, self._markers.attributes(after))
            return
        last = max(there.values(), key=lambda each: each.end, default=None)
        space = " "
        if last is not None and len(there) > 1 and "\n" in self._text[last.start : last.value]:
            space = re.match(r"\s*", self._text[last.start : last.end])[0]  # type: ignore[index]
        behind = last.end if last is not None else self._layout.tag(number)[1]
        for key in touched:
            spot = there[key]
            if key in new:
                self.change(spot.value, spot.end, self._quote(new[key], self._text[spot.value]))
            else:
                self.change(spot.start, spot.end, "")
        added = "".join(
            space + self._markers.attributes(((key, text),)).strip() for key, text in after if key not in old
        )
        if added:
            self.change(behind, behind, added)

    def _quote(self, text: str, mark: str) -> str:
        written = self._markers.attributes((("v", text),)).partition("=")[2]
        return written if mark == '"' else f"'{written[1:-1].replace(chr(39), '&apos;').replace('&quot;', chr(34))}'"

    def rename(self, number: int, tag: str) -> None:
        """Give an element another tag."""
        self.change(*self._layout.tag(number), tag)
        place = self._layout.places[number]
        if place.foot < place.end:
            end = self._text.index(">", place.foot)
            self.change(place.foot + 2, end, tag)

    # -- writing

    def write(self, trees: dict[int, Node | None], added: list[tuple[Pairs, Node]]) -> str:
        """Return the whole text. `trees` are the roots by the number of their BehaviorTree, None for one that is gone;
        `added` are further ones with the attributes of their BehaviorTree. Raises MissionError if XML can't hold a
        text.
        """
        self._changes.sort(key=lambda change: change[:2])
        parts = self._children[0]
        work: list[Work] = [_Slice(0, self._open(0), STAYS)]
        behind = max((part for part in parts if part in trees), default=-1)
        for part in parts:
            if part not in trees:
                work.append(_Slice(self._lead(part), self._end(part), STAYS))
            elif (root := trees[part]) is not None:
                work += self._tree(part, root)
            if part == behind:
                for attributes, node in added:
                    work += self._new_tree(part, attributes, node)
        work.append(_Slice(self._end(parts[-1]), len(self._text), STAYS))
        made = self._write_text(work)
        self._markers.finish()
        return made

    def _tree(self, part: int, root: Node) -> list[Work]:
        place, [inner] = self._layout.places[part], self._children[part]
        margin = self._margin(inner)
        lead = None if self._known(root) == inner else self._lead_text(inner)
        if lead is not None and self._notes.before(inner):  # these go with what was there
            lead = "" if margin is None else self.line_end + margin
        return [
            _Slice(self._lead(part), self._open(part), STAYS),
            _Element(root, STAYS, self._unit * 2 if margin is None else margin, lead),
            _Slice(self._end(inner), place.end, STAYS),
        ]  # fmt: skip

    def _new_tree(self, beside: int, attributes: Pairs, root: Node) -> list[Work]:
        lead = self._lead_text(beside)
        margin = self._margin(beside)
        outer = self._unit if margin is None else margin
        gap = lead if not lead.strip() and self._children[0][0] != beside else self.line_end + outer
        inner = outer + self._unit
        return [
            f"{gap}<BehaviorTree{self._markers.attributes(attributes)}>",
            _Element(root, STAYS, inner, self.line_end + inner),
            f"{self.line_end}{outer}</BehaviorTree>",
        ]

    def _write_text(self, work: list[Work]) -> str:
        out: list[str] = []
        work.reverse()
        while work:
            item = work.pop()
            if isinstance(item, str):
                out.append(item)
            elif isinstance(item, _Slice):
                out.append(self._change_text(item))
            else:
                number = self._known(item.node)
                work += reversed(self._new(item) if number is None else self._again(item, number))
        return "".join(out)

    def _change_text(self, piece: _Slice) -> str:
        """Return characters of the file with their changes."""
        made: list[str] = []
        at = piece.start
        index = bisect_left(self._changes, (piece.start, -1, ""))
        while index < len(self._changes) and self._changes[index][1] <= piece.end:
            start, end, text = self._changes[index]
            if start >= at:
                made += (self._text[at:start], text)
                at = end
            index += 1
        made.append(self._text[at : piece.end])
        return _shift("".join(made), piece.shift, piece.in_tag)

    def _again(self, item: _Element, number: int) -> list[Work]:
        """Write a node that is in the file already."""
        place, shift = self._layout.places[number], item.shift
        work: list[Work] = [_Slice(self._lead(number), place.start, shift) if item.lead is None else item.lead]
        margin = self._margin(number)
        own = shift if margin is None else (margin, item.margin) if margin != item.margin else STAYS
        notes = self._own_notes(number, item) if item.lead is not None and not item.bare else []
        work += self._comments(item, self._lead_text(number) if item.lead is None else item.lead, notes)
        children = item.node.children
        inner = self._inner_margin(number, own)
        if place.head == place.end:  # no end tag
            if not children:
                return [*work, _Slice(place.start, self._end(number), own, True)]
            tag = self._text[slice(*self._layout.tag(number))]
            work += (_Slice(place.start, place.head - 2, own, True), ">")
            work += self._inner(children, number, own, inner)
            return [*work, f"{self.line_end}{item.margin}</{tag}>", _Slice(place.end, self._end(number), own)]
        work += (_Slice(place.start, place.head, own, True), _Slice(place.head, self._open(number), own))
        work += self._inner(children, number, own, inner)
        last = self._children[number][-1:]
        begin = self._end(last[0]) if last else self._open(number)
        return [*work, _Slice(begin, place.end, own), _Slice(place.end, self._end(number), own)]

    def _own_notes(self, number: int, item: _Element) -> list[Work]:
        """Write the comments before a node, which goes elsewhere."""
        left = [note for note in self._notes.before(number) if id(note) not in self._removed]
        return [part for note in left for part in (_Slice(*self.span_of(note), STAYS), self.line_end + item.margin)]

    def _inner(self, children: tuple[Node, ...], parent: int, shift: Shift, margin: str) -> list[Work]:
        """Write the inside of a node that is in the file already."""
        work: list[Work] = []
        before: int | None = -1
        for child in children:
            work.append(self._child(child, parent, shift, margin, before))
            before = self._known(child)
        return work

    def _child(self, child: Node, parent: int, shift: Shift, margin: str, before: int | None) -> _Element:
        """Write one of the children; `before` is the one before it, -1 for none, None if that is new."""
        number = self._known(child)
        in_line = self._is_in_line(parent)
        if number is not None and self._parents[number] == parent:
            own = self._margin(number)
            if self._before[number] != before and "\n" not in self._lead_text(number) and not in_line:
                return _Element(child, STAYS, margin, self.line_end + margin)
            return _Element(child, shift, margin if own is None else _move(own, shift))
        if number is not None and not in_line and (own := self._margin(number)) is not None:
            return _Element(child, (own, margin), margin)
        return _Element(child, STAYS, margin, "" if in_line else self.line_end + margin)

    def _inner_margin(self, number: int, shift: Shift) -> str:
        """Return where what is inside an element begins."""
        margins = (self._margin(child) for child in self._children[number])
        found = next((margin for margin in margins if margin is not None), None)
        if found is None:
            found = (self._margin(number) or "") + self._unit
        return _move(found, shift)

    def _new(self, item: _Element) -> list[Work]:
        """Write a node that isn't in the file yet. What stood before the first one in it stands before it now."""
        tag, pairs = self._spell(item.node)
        head = f"<{tag}{self._markers.attributes(pairs)}"
        children = item.node.children
        lead: Work = self.line_end + item.margin if item.lead is None else item.lead
        first = self._known(children[0]) if children else None
        inner = item.margin + self._unit
        work: list[Work] = []
        for at, child in enumerate(children):
            number = self._known(child)
            own = self._margin(number) if number is not None else None
            if own is None or (at == 0 and item.lead is not None):
                work.append(_Element(child, STAYS, inner, self.line_end + inner))
            else:
                work.append(_Element(child, (own, inner), inner))
        if first is not None and (margin := self._margin(first)) is not None and "\n" in str(lead):
            lead = _Slice(self._lead(first), self._layout.places[first].start, (margin, item.margin))
            work[0] = _Element(children[0], STAYS, inner, self.line_end + inner, bare=True)
        comments = self._comments(item, str(lead) if item.lead is None else item.lead)
        if not children:
            return [lead, *comments, f"{head}/>"]
        return [lead, *comments, f"{head}>", *work, f"{self.line_end}{item.margin}</{tag}>"]

    def _comments(self, item: _Element, lead: str, notes: Sequence[Work] = ()) -> list[Work]:
        """Write comments before a node on separate lines: behind something else on a line they'd belong to that."""
        margin = self.line_end + item.margin
        texts = [*notes, *(f"{text}{margin}" for text in self._leads.get(id(item.node), ()))]
        return [margin, *texts] if texts and "\n" not in lead else texts


def _move(margin: str, shift: Shift) -> str:
    before, after = shift
    return after + margin[len(before) :] if margin.startswith(before) else margin


def _shift(text: str, shift: Shift, in_tag: bool) -> str:
    """Return the text with its lines moved; lines inside a value stay."""
    if shift[0] == shift[1]:
        return text
    if in_tag:
        return _IN_TAG.sub(lambda match: match[0] if match[1] else "\n" + _move(match[2], shift), text)
    return _MARGIN.sub(lambda match: "\n" + _move(match[1], shift), text)
