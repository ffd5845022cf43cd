"""What belongs together in a statement before rounds are made: they take in whole parts of a chain.

A value and what says it, and both cases of a condition, are in one round; a journey to several places is in none over
what is taken behind it.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from btlang.text.source import Span
from btlang.tree import ast
from btlang.tree.visit import fold
from btlang.vocabulary.capabilities import TRAVELS
from btlang.vocabulary.descriptions import NAME
from btlang.vocabulary.references import ALL, NAMES, Choice, choice_of
from btlang.vocabulary.value_type import OBJECT, PLACE

PICK_UP = "PickUp"
"""The id of the command that picks something up and keeps it."""
_STOP = re.compile(r"[.!?;\n]")


def gathered(root: ast.Ast) -> ast.Ast:
    """Return a mission in which the chains have as parts what is done in one round, or before it."""
    if any(isinstance(node, ast.Remember) for node in ast.parents_first(root)):
        root = fold(root, ast.parts, lambda node, done: _joined(node, done, _says_it))
    root = fold(root, ast.parts, _with_tours_apart)
    return fold(root, ast.parts, lambda node, done: _joined(node, done, _is_other_case))


def with_each_carried(root: ast.Ast) -> ast.Ast:
    """Return a mission in which each thing of a list is picked up and taken somewhere before the next one.

    `fetch the hammer and the wrench from the shed and lay them both on the table` is a round for each; a full stop ends
    it. A list without `from the shed` is a round by then.
    """
    picked = [node for node in ast.parents_first(root) if isinstance(node, ast.Phrase) and node.entry.id == PICK_UP]
    return fold(root, ast.parts, _carry_each) if len(picked) > 1 else root


def _carry_each(node: ast.Ast, done: Sequence[ast.Ast]) -> ast.Ast:
    if not isinstance(node, ast.Chain) or node.operator not in ("sequence", "and"):
        return ast.with_parts(node, done)
    made: list[ast.Ast] = []
    for item in done:
        picked = _picked(made[-1]) if made else []
        choice = set_of(item) if picked else None
        names = dict(choice.parts).get(NAMES, "").split(";") if choice is not None else []
        gap = item.span.source.text[made[-1].span.end : item.span.start] if made else ""
        if choice is None or [name for _, name in picked] != names or _STOP.search(gap):
            made.append(item)
            continue
        span = Span(item.span.source, made[-1].span.start, item.span.end)
        own = (with_argument(item, choice.text, key) for key, _ in picked)
        rounds = (ast.Chain("sequence", both, True, span) for both in zip(ast.parts(made[-1]), own, strict=True))
        made[-1] = ast.Chain("sequence", tuple(rounds), True, span)
    return made[0] if len(made) == 1 else node.replace(items=tuple(made))


def _picked(node: ast.Ast) -> list[tuple[str, str]]:
    """Return what a list picks up, each with its name; empty for anything else."""
    if not ast.is_list(node) or not isinstance(node, ast.Chain):
        return []
    picked: list[tuple[str, str]] = []
    for each in node.items:
        if not isinstance(each, ast.Phrase) or each.entry.id != PICK_UP:
            return []
        things = each.entry.given(OBJECT, each.arguments)
        if len(things) != 1:
            return []
        choice = choice_of(things[0])
        picked.append(
            (things[0], things[0]) if choice is None else (f"{{{choice.key}}}", dict(choice.parts).get(NAME, ""))
        )
    return picked


def with_argument(node: ast.Ast, old: str, new: str) -> ast.Ast:
    """Return a command with another text in its arguments; anything else as it is."""
    if not isinstance(node, ast.Phrase | ast.Name):
        return node
    arguments = tuple((slot, new if text == old else text) for slot, text in node.arguments)
    return node.replace(arguments=arguments)  # type: ignore[no-any-return]


def set_of(node: ast.Ast) -> Choice | None:
    """Return the set that a command speaks of."""
    if not isinstance(node, ast.Phrase | ast.Name):
        return None
    for _, text in node.arguments:
        choice = choice_of(text) if text[:1] == "{" else None
        if choice is not None and choice.how == ALL:
            return choice
    return None


def _joined(node: ast.Ast, done: Sequence[ast.Ast], goes_on: Callable[[ast.Chain, ast.Ast], bool]) -> ast.Ast:
    """Return a sequence in which what goes on with the commands before it, joined by `and`, is one of these."""
    if not isinstance(node, ast.Chain) or node.operator != "sequence":
        return ast.with_parts(node, done)
    made: list[ast.Ast] = []
    for item in done:
        before = made[-1] if made else None
        both = item if isinstance(item, ast.Chain) and item.operator == "and" and not item.bracketed else None
        more = both.items if both is not None else (item,)  # `say A and B` says A, then measures B
        if isinstance(before, ast.Chain) and before.operator == "and" and goes_on(before, more[0]):
            made[-1] = before.replace(items=(*before.items, *more))
        else:
            made.append(item)
    return made[0] if len(made) == 1 else node.replace(items=tuple(made))


def _says_it(before: ast.Chain, item: ast.Ast) -> bool:
    """Whether a command says the value that is measured before it: `A and say the battery`."""
    last = before.items[-1]
    return isinstance(last, ast.Remember) and last.span.start == item.span.start


def _with_tours_apart(node: ast.Ast, done: Sequence[ast.Ast]) -> ast.Ast:
    """Keep a journey to several places out of the rounds over what is taken behind it.

    `go to the lab and the hall and collect the cups, then bring them to the sink` tours once, not for each cup.
    """
    if not isinstance(node, ast.Chain) or node.operator != "sequence":
        return ast.with_parts(node, done)
    made: list[ast.Ast] = []
    for item in done:
        tour, *rest = item.items if isinstance(item, ast.Chain) and not item.bracketed else (item,)
        if rest and _is_tour(tour) and any(map(set_of, rest)) and isinstance(item, ast.Chain) and not ast.is_list(item):
            made += [tour, rest[0] if len(rest) == 1 else item.replace(items=tuple(rest))]
        else:
            made.append(item)
    return ast.with_parts(node, done) if len(made) == len(done) else node.replace(items=tuple(made))


def _is_other_case(before: ast.Chain, other: ast.Ast) -> bool:
    """Whether a condition of a tour is denied next: `in each room, if nobody is there, wave; if somebody is, nod`.

    Neither case may have an alternative.
    """
    case = before.items[-1]
    if not _is_tour(before.items[0]):
        return False
    if not (isinstance(case, ast.If) and isinstance(other, ast.If)) or case.otherwise or other.otherwise:
        return False
    (asked, is_so), (asked_then, is_so_then) = map(_case, (case, other))
    return asked != "" and asked == asked_then and is_so != is_so_then


def _case(form: ast.If) -> tuple[object, bool]:
    """Return what a form asks, "" for several conditions, and whether that must be true."""
    asked, is_so = form.condition, not form.negated
    if isinstance(asked, ast.Not):
        asked, is_so = asked.condition, not is_so
    return (asked.entry.id, asked.arguments) if isinstance(asked, ast.Phrase) else "", is_so


def _is_tour(node: ast.Ast) -> bool:
    """Whether a command travels to several places."""
    if isinstance(node, ast.Chain):
        return ast.is_list(node) and all(map(is_journey, node.items))
    choice = set_of(node)
    return choice is not None and choice.type == PLACE and is_journey(node)


def is_journey(node: ast.Ast) -> bool:
    return isinstance(node, ast.Phrase) and TRAVELS in node.entry.needs
