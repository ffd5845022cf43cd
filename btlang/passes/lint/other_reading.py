"""The places where a sentence can be read in another way, each with both readings as syntax trees.

The other reading is the one that brackets in the text would give. It is made of the parts of the tree, not by reading
the text once more: parts keep what their names and pronouns mean, and a long mission stays quick.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import cached_property, partial
from itertools import pairwise

from btlang.passes.lint.gaps import Gaps, balanced
from btlang.support.record import Record
from btlang.text.source import Span
from btlang.tree import ast
from btlang.vocabulary.lexicon import Lexicon

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

MIXED, POSTFIX, LIST, NEGATED, AFTER = "mixed", "postfix", "list", "negated", "after"


class Readings(Record):
    """`span` is what both readings are about; `fix` is a change of the text that leaves only the one that was taken."""

    taken: ast.Ast
    other: ast.Ast
    span: Span
    fix: tuple[Span, str]


class Attachment(Record):
    """A place of one of the kinds above. Its readings are made when they are asked for: most are never reported."""

    kind: str
    start: int
    readings: Callable[[], Readings]


def in_chain(chain: ast.Chain, items: Sequence[ast.Ast], is_part: bool, vocabulary: Lexicon) -> Iterator[Attachment]:
    """Those between the parts of a chain; `is_part`: it is itself a part of another one, without brackets.

    The chain is no list of values; `items` are its parts in the order of the text.

    Only neighbours that could be read otherwise are looked at, so that a long chain of plain commands costs little.
    """
    if chain.operator == "any" and _negates_first(items):
        yield Attachment(NEGATED, items[0].span.start, partial(_negated, chain))
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
        place, start, gap = _Place(chain, gaps, at, is_part), left.span.start, gaps.text(at)
        if _is_open(right) and not _names_its_command(right):
            yield Attachment(MIXED, start, partial(place.mixed_right, right))
        elif _is_open(left):
            yield Attachment(MIXED, start, partial(place.mixed_left, left))
        if wrapped and "(" not in gap:
            yield Attachment(POSTFIX, start, partial(place.postfix, right, wrapped))
        if lists and _is_sequence(left) and ")" not in gap:
            yield Attachment(LIST, start, partial(place.list_left, left))
        elif lists and _is_sequence(right) and "(" not in gap:
            yield Attachment(LIST, start, partial(place.list_right, right))


def _names_its_command(item: ast.Ast) -> bool:
    """`A and find the cup. If you can't find it, B`: of all that stands before the stop B is about one command."""
    source, parts = item.span.source.text, sorted(ast.parts(item), key=lambda part: part.span.start)
    return len(parts) > 1 and "." in source[parts[0].span.end : parts[1].span.start]


def _behind_after(
    chain: ast.Chain, items: Sequence[ast.Ast], is_part: bool, vocabulary: Lexicon
) -> Iterator[Attachment]:
    """`A then B after C`, where C might come before both."""
    spoken = {id(item): at for at, item in enumerate(chain.items)}
    gaps = Gaps(items, vocabulary)
    for at, (before, left, right) in enumerate(zip(items, items[1:], items[2:], strict=False)):
        is_after = spoken[id(before)] < spoken[id(right)] < spoken[id(left)]
        if is_after and gaps.is_open(at) and gaps.is_open(at + 1) and "\n" not in right.span.text:
            place = _Place(chain, gaps, at, is_part)
            yield Attachment(AFTER, before.span.start, partial(place.after, right))


def _negates_first(items: Sequence[ast.Ast]) -> bool:
    """`not C or D`, without a second `not` that would make it clear."""
    first = items[0]
    is_prefix = isinstance(first, ast.Not) and first.span.start < first.condition.span.start
    return is_prefix and not is_in_brackets(first.span) and not any(isinstance(item, ast.Not) for item in items[1:])


def _negated(chain: ast.Chain) -> Readings:
    """`not C or D`: not (C or D)."""
    first: Any = chain.items[0]
    inner = ast.Chain("any", (first.condition, *chain.items[1:]), True, chain.span)
    return Readings(chain, ast.Not(inner, chain.span), chain.span, bracketed(first.span))


class _Place:
    """A gap in a chain, in what hangs together around it."""

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
        """`A then B and C`: (A then B) and C."""
        first = in_order(right.items)[0]
        group = self._joined(self.first, self.at + 1, {self.at + 1: first})
        return self._readings(self.first, self.at + 1, with_part(right, first, group), self.at + 1)

    def mixed_left(self, left: Any) -> Readings:
        """`A and B then C`: A and (B then C)."""
        last = in_order(left.items)[-1]
        group = self._joined(self.at, self.last, {self.at: last})
        return self._readings(self.at, self.last, with_part(left, last, group), self.at)

    def postfix(self, right: Any, wrapped: Sequence[Any]) -> Readings:
        """`A then B 3 times`: (A then B) 3 times."""
        group: ast.Ast = self._joined(self.first, self.at + 1, {self.at + 1: wrapped[-1].body})
        for form in reversed(wrapped):
            group = form.replace(body=group)
        return self._readings(self.first, self.at + 1, group, self.at + 1)

    def list_left(self, left: Any) -> Readings:
        """`go to A and B and wave`: go to A, and then go to B and wave."""
        group = self._joined(self.at, self.last, {self.at: left.items[-1]})
        other = left.replace(items=(*left.items[:-1], group))
        return self._readings(self.at, self.last, other, self.at)

    def list_right(self, right: Any) -> Readings:
        """`wave and go to A and B`: wave and go to A, and then go to B."""
        group = self._joined(self.first, self.at + 1, {self.at + 1: right.items[0]})
        other = right.replace(items=(group, *right.items[1:]))
        return self._readings(self.first, self.at + 1, other, self.at + 1)

    def after(self, right: ast.Ast) -> Readings:
        """`A then B after C`: (A then B) after C."""
        last = self.at + 1
        group, gone = self._joined(self.first, last, {}), {id(item) for item in self.items[self.first : last + 1]}
        whole = self._joined(self.first, self.last, {})
        behind = [[item, group] if item is right else [item] for item in ast.parts(whole) if id(item) not in gone]
        items = tuple(item for pair in behind for item in pair)
        span = Span(right.span.source, self.items[self.first].span.start, self.items[self.last].span.end)
        other = ast.Chain("sequence", items, True, span)
        return Readings(whole, other, balanced(span), (self.gaps.comma(self.at), ","))

    def _joined(self, first: int, last: int, changed: dict[int, ast.Ast]) -> ast.Ast:
        """These parts as a chain of their own, some of them changed."""
        spoken: Sequence[int] = range(first, last + 1)
        if self.items is not self.chain.items:
            order = {id(self.items[at]): at for at in spoken}
            spoken = [order[id(item)] for item in self.chain.items if id(item) in order]
        items = tuple(changed.get(at, self.items[at]) for at in spoken)
        return ast.Chain(self.chain.operator, items, True, self.chain.span) if len(items) > 1 else items[0]

    def _readings(self, first: int, last: int, other: ast.Ast, place: int) -> Readings:
        """`other` takes the place of one part, and those from `first` to `last` are in it."""
        part = self.items[place].span
        whole = self._joined(self.first, self.last, {})
        gone = {id(self.items[at]) for at in range(first, last + 1) if at != place}
        items = [other if item is self.items[place] else item for item in ast.parts(whole) if id(item) not in gone]
        changed = ast.Chain(self.chain.operator, tuple(items), True, self.chain.span) if len(items) > 1 else other
        commas = self.chain.operator == "sequence" or not self.is_part
        fix = (self.gaps.comma(self.at), ",") if commas else bracketed(part)
        span = Span(part.source, self.items[self.first].span.start, self.items[self.last].span.end)
        return Readings(whole, changed, balanced(span), fix)


def is_list(node: ast.Ast) -> bool:
    """Whether it is a list of values in one phrase, whose parts all stand for the same words."""
    if not isinstance(node, ast.Chain):
        return False
    start, end = node.span.start, node.span.end
    return all(item.span.start == start and item.span.end == end for item in node.items)


def _is_sequence(node: ast.Ast) -> bool:
    return is_list(node) and getattr(node, "operator", "") == "sequence"


def _is_open(node: ast.Ast) -> bool:
    return isinstance(node, ast.Chain) and not node.bracketed


def _after_its_body(node: ast.Ast) -> list[Any]:
    """The forms that stand behind one command, the outermost first; none where brackets decide what they are about.

    A form without words of its own, such as a round, isn't one of them.
    """
    forms: list[Any] = []
    body: Any = getattr(node, "body", None)
    while body is not None and body.span.start == node.span.start and body.span.end < node.span.end:
        forms.append(node)
        node, body = body, getattr(body, "body", None)
    return [] if isinstance(node, ast.Chain) and node.bracketed and not is_list(node) else forms


def in_order(items: Sequence[ast.Ast]) -> Sequence[ast.Ast]:
    """In the order of the text: `A after B` holds its parts the other way round."""
    starts = [item.span.start for item in items]
    return items if starts == sorted(starts) else sorted(items, key=lambda item: item.span.start)


def is_in_brackets(span: Span) -> bool:
    text, start, end = span.source.text, span.start, span.end
    while text[start - 1 : start] in (" ", "\t"):
        start -= 1
    while text[end : end + 1] in (" ", "\t"):
        end += 1
    return text[start - 1 : start] == "(" and text[end : end + 1] == ")"


def bracketed(span: Span) -> tuple[Span, str]:
    return span, f"({span.text})"


def with_part(outer: Any, part: ast.Ast, changed: ast.Ast) -> ast.Ast:
    """A node with another part in the place of one."""
    if isinstance(outer, ast.Chain):
        made: ast.Ast = outer.replace(items=tuple(changed if item is part else item for item in outer.items))
    else:
        made = outer.replace(body=changed)
    return made
