"""Other readings: the places where a sentence can be read in another way, each with both readings as syntax trees."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from functools import cached_property, partial
from itertools import pairwise

from btlang.support.record import Record
from btlang.text.source import Span
from btlang.tree import ast
from btlang.tree.ast import Ast
from btlang.vocabulary.lexicon import Lexicon

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


_LINE_END = re.compile(r"[\n;]|[.!?](?!\w)")
_STOP = re.compile(r"[.!?](?!\w)")
_WORD = re.compile(r"\w")
_QUOTED = re.compile(r'"[^"\n]*"')
MIXED, POSTFIX, LIST, NEGATED, AFTER = "mixed", "postfix", "list", "negated", "after"


class Gaps:
    """The gaps of one chain, whose parts are given in the order of the text."""

    def __init__(self, items: Sequence[Ast], vocabulary: Lexicon) -> None:
        self.items = items
        self._clauses = vocabulary.roles["otherwise"]
        self._openers = tuple(f" {word}" for role in ("either", "both") for word in vocabulary.roles[role])

    def text(self, at: int) -> str:
        """Return the text between a part and the one behind it."""
        left, right = self.items[at].span, self.items[at + 1].span
        return left.source.text[left.end : right.start]

    def is_open(self, at: int) -> bool:
        """Whether only a connective is in a gap: no comma, line end, or word that begins a clause or list."""
        gap = self.text(at)
        return "," not in gap and not self._ends(gap) and not gap.rstrip().lower().endswith(self._openers)

    def is_alone(self, at: int) -> bool:
        """Whether a part is a separate statement."""
        before, behind = (
            at == 0 or self._ends(self.text(at - 1)),
            at == len(self.items) - 1 or self._ends(self.text(at)),
        )
        return before and behind

    def run(self, at: int) -> tuple[int, int]:
        """Return the first and the last part that hang together around a gap. A comma in a list doesn't separate
        them.
        """
        first, last = at, at + 1
        while first > 0 and not self._parts(first - 1):
            first -= 1
        while last + 1 < len(self.items) and not self._parts(last):
            last += 1
        return first, last

    def comma(self, at: int) -> Span:
        """Return the place, without any character, for a comma before the connective."""
        gap, left = self.text(at), self.items[at].span
        word = _WORD.search(gap)
        place = left.end + len(gap[: word.start() if word else None].rstrip())
        return Span(left.source, place, place)

    def _ends(self, gap: str) -> bool:
        words = " ".join(gap.strip(" ,()").lower().split())
        return bool(_LINE_END.search(gap)) or any(
            words == clause or words.startswith(clause + " ") for clause in self._clauses
        )

    def _parts(self, at: int) -> bool:
        """Whether a comma beside a connective separates the parts; not the last comma of a list: `A, B, and C`."""
        gap = self.text(at)
        if self._ends(gap) or "," not in gap or not _WORD.search(gap):
            return self._ends(gap)
        return at == 0 or "," not in self.text(at - 1) or bool(_WORD.search(self.text(at - 1)))


def balance_brackets(span: Span) -> Span:
    """Widen the span to the brackets around its ends that are opened or closed in it."""
    text, start, end = span.source.text, span.start, span.end
    depth = lowest = 0
    for bracket in re.findall(r"[()]", _QUOTED.sub("", text[start:end])):
        depth += 1 if bracket == "(" else -1
        lowest = min(lowest, depth)
    for _ in range(-lowest):
        start = text.rindex("(", 0, start)
    for _ in range(depth - lowest):
        end = text.index(")", end) + 1
    return Span(span.source, start, end)


class Readings(Record):
    """Two readings. `span` is what they are about; `fix` is a change of the text, if one is short enough, that leaves
    only the one that was taken.
    """

    taken: ast.Ast
    other: ast.Ast
    span: Span
    fix: tuple[Span, str] | None


class Attachment(Record):
    """A place with two readings. They are made when they are asked for: most are never reported."""

    kind: str
    start: int
    readings: Callable[[], Readings]


def find_in_chain(
    chain: ast.Chain, items: Sequence[ast.Ast], is_part: bool, vocabulary: Lexicon
) -> Iterator[Attachment]:
    """Find places between the parts of a chain; `is_part`: it is itself a part of another one, without brackets.

    The chain is no list of values; `items` are its parts in the order of the text.

    Only neighbours that could be read otherwise are looked at, so that a long chain of plain commands costs little.
    """
    if chain.operator == "any" and _negates_first(items):
        yield Attachment(NEGATED, items[0].span.start, partial(_negate, chain))
    gaps: Gaps | None = None
    if items is not chain.items:
        yield from _behind_after(chain, items, is_part, vocabulary)
    for at, (left, right) in enumerate(pairwise(items)):
        if not left.parts and not right.parts:
            continue  # two plain commands, as nearly always
        wrapped = _after_its_body(right)
        lists = chain.operator == "parallel" and (_is_sequence(left) or _is_sequence(right))
        if not (wrapped or lists or _is_open(left) or _is_open(right)):
            continue
        gaps = gaps or Gaps(items, vocabulary)
        if not gaps.is_open(at):
            continue
        place, start, gap = _GapPlace(chain, gaps, at, is_part), left.span.start, gaps.text(at)
        if _is_open(right) and not _names_its_command(right):
            yield Attachment(MIXED, start, partial(place.mixed_right, right))
        elif _is_open(left):
            yield Attachment(MIXED, start, partial(place.mixed_left, left))
        goes_along = chain.operator == "parallel" and _is_task(left) and isinstance(right, ast.Every)
        if wrapped and "(" not in gap and not goes_along:
            yield Attachment(POSTFIX, start, partial(place.postfix, right, wrapped))
        if lists and _is_sequence(left) and ")" not in gap:
            yield Attachment(LIST, start, partial(place.list_left, left))
        elif lists and _is_sequence(right) and "(" not in gap:
            yield Attachment(LIST, start, partial(place.list_right, right))


def _is_task(node: ast.Ast) -> bool:
    """Whether a node is a command that ends, as does then what goes along with it: `go to the lab and A on the way`."""
    return isinstance(node, ast.Phrase) and not node.entry.accompaniment


def _names_its_command(item: ast.Ast) -> bool:
    """Whether `B` in `A and find the cup. If you can't find it, B` is about one of the commands before the stop."""
    source, parts = item.span.source.text, sorted(ast.parts(item), key=lambda part: part.span.start)
    if len(parts) < 2:
        return False
    before = _QUOTED.sub("", source[parts[0].span.start : parts[1].span.start])  # `... . If not within 5 s, B`
    return _STOP.search(before) is not None


def _behind_after(
    chain: ast.Chain, items: Sequence[ast.Ast], is_part: bool, vocabulary: Lexicon
) -> Iterator[Attachment]:
    """Find `A then B after C`, in which C could come before both."""
    spoken = {id(item): at for at, item in enumerate(chain.items)}
    gaps = Gaps(items, vocabulary)
    for at, (before, left, right) in enumerate(zip(items, items[1:], items[2:], strict=False)):
        is_after = spoken[id(before)] < spoken[id(right)] < spoken[id(left)]
        if is_after and gaps.is_open(at) and gaps.is_open(at + 1) and "\n" not in right.span.text:
            place = _GapPlace(chain, gaps, at, is_part)
            yield Attachment(AFTER, before.span.start, partial(place.after, right))


def _negates_first(items: Sequence[ast.Ast]) -> bool:
    """Whether it is `not C or D`, without a second `not` that would make it clear."""
    first = items[0]
    is_prefix = isinstance(first, ast.Not) and first.span.start < first.condition.span.start
    return is_prefix and not is_in_brackets(first.span) and not any(isinstance(item, ast.Not) for item in items[1:])


def _negate(chain: ast.Chain) -> Readings:
    """Read `not C or D` as: not (C or D)."""
    first: Any = chain.items[0]
    inner = ast.Chain("any", (first.condition, *chain.items[1:]), True, chain.span)
    return Readings(chain, ast.Not(inner, chain.span), chain.span, add_brackets(first.span))


class _GapPlace:
    """A gap in a chain, in the run of parts around it."""

    def __init__(self, chain: ast.Chain, gaps: Gaps, at: int, is_part: bool) -> None:
        self.chain, self.gaps, self.at, self.is_part = chain, gaps, at, is_part
        self.items = gaps.items

    @cached_property
    def first(self) -> int:
        """The first part of what hangs together."""
        return self.gaps.run(self.at)[0]

    @cached_property
    def last(self) -> int:
        """The last one."""
        return self.gaps.run(self.at)[1]

    def mixed_right(self, right: Any) -> Readings:
        """Read `A then B and C` as (A then B) and C."""
        first = sort_by_place(right.items)[0]
        group = self._join(self.first, self.at + 1, {self.at + 1: first})
        return self._readings(self.first, self.at + 1, replace_part(right, first, group), self.at + 1)

    def mixed_left(self, left: Any) -> Readings:
        """Read `A and B then C` as A and (B then C)."""
        last = sort_by_place(left.items)[-1]
        group = self._join(self.at, self.last, {self.at: last})
        return self._readings(self.at, self.last, replace_part(left, last, group), self.at)

    def postfix(self, right: Any, wrapped: Sequence[Any]) -> Readings:
        """Read `A then B 3 times` as (A then B) 3 times."""
        group: ast.Ast = self._join(self.first, self.at + 1, {self.at + 1: wrapped[-1].body})
        for form in reversed(wrapped):
            group = form.replace(body=group)
        return self._readings(self.first, self.at + 1, group, self.at + 1)

    def list_left(self, left: Any) -> Readings:
        """Read `go to A and B and wave` as: go to A, and then go to B and wave."""
        group = self._join(self.at, self.last, {self.at: left.items[-1]})
        other = left.replace(items=(*left.items[:-1], group))
        return self._readings(self.at, self.last, other, self.at)

    def list_right(self, right: Any) -> Readings:
        """Read `wave and go to A and B` as: wave and go to A, and then go to B."""
        group = self._join(self.first, self.at + 1, {self.at + 1: right.items[0]})
        other = right.replace(items=(group, *right.items[1:]))
        return self._readings(self.first, self.at + 1, other, self.at + 1)

    def after(self, right: ast.Ast) -> Readings:
        """Read `A then B after C` as (A then B) after C."""
        last = self.at + 1
        group, gone = self._join(self.first, last, {}), {id(item) for item in self.items[self.first : last + 1]}
        whole = self._join(self.first, self.last, {})
        behind = [[item, group] if item is right else [item] for item in ast.parts(whole) if id(item) not in gone]
        items = tuple(item for pair in behind for item in pair)
        span = Span(right.span.source, self.items[self.first].span.start, self.items[self.last].span.end)
        other = ast.Chain("sequence", items, True, span)
        return Readings(whole, other, balance_brackets(span), (self.gaps.comma(self.at), ","))

    def _join(self, first: int, last: int, changed: dict[int, ast.Ast]) -> ast.Ast:
        """Join these parts as a separate chain, some of them changed."""
        spoken: Sequence[int] = range(first, last + 1)
        if self.items is not self.chain.items:
            order = {id(self.items[at]): at for at in spoken}
            spoken = [order[id(item)] for item in self.chain.items if id(item) in order]
        items = tuple(changed.get(at, self.items[at]) for at in spoken)
        return ast.Chain(self.chain.operator, items, True, self.chain.span) if len(items) > 1 else items[0]

    def _readings(self, first: int, last: int, other: ast.Ast, place: int) -> Readings:
        """Make readings in which `other` takes the place of one part, with those from `first` to `last` in it."""
        part = self.items[place].span
        whole = self._join(self.first, self.last, {})
        gone = {id(self.items[at]) for at in range(first, last + 1) if at != place}
        items = [other if item is self.items[place] else item for item in ast.parts(whole) if id(item) not in gone]
        changed = ast.Chain(self.chain.operator, tuple(items), True, self.chain.span) if len(items) > 1 else other
        commas = self.chain.operator == "sequence" or not self.is_part
        fix = (self.gaps.comma(self.at), ",") if commas else add_brackets(part)
        span = Span(part.source, self.items[self.first].span.start, self.items[self.last].span.end)
        return Readings(whole, changed, balance_brackets(span), fix)


def _is_sequence(node: ast.Ast) -> bool:
    return ast.is_list(node) and getattr(node, "operator", "") == "sequence"


def _is_open(node: ast.Ast) -> bool:
    return isinstance(node, ast.Chain) and not node.bracketed


def _after_its_body(node: ast.Ast) -> list[Any]:
    """List the forms that stand behind one command, the outermost first; none if brackets decide what they are
    about.

    A form without words of its own, such as a round, isn't one of them.
    """
    forms: list[Any] = []
    body: Any = getattr(node, "body", None)
    while body is not None and body.span.start == node.span.start and body.span.end < node.span.end:
        forms.append(node)
        node, body = body, getattr(body, "body", None)
    return [] if isinstance(node, ast.Chain) and node.bracketed and not ast.is_list(node) else forms


def sort_by_place(items: Sequence[ast.Ast]) -> Sequence[ast.Ast]:
    """Sort parts by the order of the text: `A after B` holds its parts the other way round."""
    starts = [item.span.start for item in items]
    return items if starts == sorted(starts) else sorted(items, key=lambda item: item.span.start)


def is_in_brackets(span: Span) -> bool:
    text, start, end = span.source.text, span.start, span.end
    while text[start - 1 : start] in (" ", "\t"):
        start -= 1
    while text[end : end + 1] in (" ", "\t"):
        end += 1
    return text[start - 1 : start] == "(" and text[end : end + 1] == ")"


def add_brackets(span: Span) -> tuple[Span, str]:
    return span, f"({span.text})"


def replace_part(outer: Any, part: ast.Ast, changed: ast.Ast) -> ast.Ast:
    """Return a node with one of its parts replaced."""
    if isinstance(outer, ast.Chain):
        made: ast.Ast = outer.replace(items=tuple(changed if item is part else item for item in outer.items))
    else:
        made = outer.replace(body=changed)
    return made
