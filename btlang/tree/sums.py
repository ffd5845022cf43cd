"""Sums: `count the people in the lab and the hall, then say the number` says how many there are in total.

Where somebody asks for the number behind several counts of one command, these are summed in a value of the mission.
"""

from __future__ import annotations

from collections.abc import Container, Iterator, Sequence
from functools import partial

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.tree import ast
from btlang.tree.visit import fold
from btlang.vocabulary.entry import COUNT, Entry
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.value_type import number_type

COUNTING = frozenset(("CountPeople", "CountObjects", "CountKind"))
"""The ids of commands that count."""
COUNTED_NAMES = "CountedNames"
"""The id of the quantity that is the names of what was counted last."""
COMPARED = "Counted"
"""The id of the condition about what was counted last."""
_IN_TURN = ("sequence", "and")
"""Operators of chains whose commands run one after another: one that counts goes with nothing else."""
_Made = tuple[ast.Ast, bool]
"""A node, and whether it counts."""
_LOST = "only the names of the place that was counted last are known by then; say them in each place"
_TOTAL, _LAST = "counted_in_all", "counted_there"


def with_sums(mission: ast.Program, vocabulary: Lexicon) -> tuple[ast.Program, list[Diagnostic]]:
    """Return the mission with the sums that it asks for, and what is wrong with it.

    That is names that are asked for behind several counts, of which only the last ones are kept (BT049).
    """
    count, number = vocabulary.entry(COUNT), number_type(vocabulary.types)
    if count is None or number is None:
        return mission, []
    sums, problems = _Sums(count, number), list[Diagnostic]()

    def body(root: ast.Ast) -> ast.Ast:
        nodes = ast.parents_first(root)
        if any(map(_is_names, nodes)):
            lost = (each for node in nodes if isinstance(node, ast.Chain) for each in _lost_names(node))
            problems.extend(diagnostic("BT049", each.span, words=each.span.text, reason=_LOST) for each in lost)
        return fold(root, ast.parts, sums.add_sum)[0] if any(map(asks_for_number, nodes)) else root

    def program(part: ast.Program) -> ast.Program:
        return ast.with_bodies(part, body, program)

    return program(mission), problems


def _lost_names(chain: ast.Chain) -> Iterator[ast.Ast]:
    """Yield what asks for names behind a command of a sequence that counts in each place of a list or set."""
    counts_several = False
    for item in chain.items if chain.operator in _IN_TURN else ():
        if counts_several:
            yield from (node for node in ast.parents_first(item) if _is_names(node))
        if _counts(item):
            counts_several = _last_count(item)[1] is not None


class _Sums:
    """The sums of a mission, in numbers of a type, with the quantity that was counted last."""

    def __init__(self, count: Entry, number: str) -> None:
        self._count, self._number = count, number

    def add_sum(self, node: ast.Ast, done: Sequence[_Made]) -> _Made:
        """Return a node with its parts, and whether it counts.

        In a sequence each command that counts several times is summed, if what follows asks for the number.
        """
        whole = ast.with_parts(node, [part for part, _ in done])
        counts = _is_count(node) or any(counting for _, counting in done)
        if not counts or not isinstance(whole, ast.Chain) or whole.operator not in _IN_TURN:
            return whole, counts
        made: list[ast.Ast] = []
        sums = False
        for at, (item, counting) in enumerate(done):
            if not counting:
                made.append(fold(item, ast.parts, self._ask_sum) if sums else item)
                continue
            chains, last = _last_count(item)
            sums = last is not None and any(map(_is_of_sum, ast.parents_first(last)))
            if last is not None and not sums and _is_asked(done, at + 1, _keys(last)):
                made += self._sum(chains, last)
                sums = True
            else:
                made.append(item)
        return ast.Chain(whole.operator, tuple(made), whole.bracketed, whole.span), True

    def _sum(self, chains: Sequence[ast.Chain], counting: ast.Ast) -> list[ast.Ast]:
        """Return the outermost of some chains. The innermost gets the commands that begin the sum and use it."""
        begun = ast.Assign(_TOTAL, "set", self._number, "0", counting.span)
        keys = sorted(_keys(counting))
        told = [ast.Assign(key, "set", self._number, f"{{{_TOTAL}}}", counting.span) for key in keys]
        made: list[ast.Ast] = [begun, fold(counting, ast.parts, partial(self._add_up, keys)), *told]
        for chain, part in zip(reversed(chains), reversed([*chains, counting][1:]), strict=True):
            at = next(at for at, item in enumerate(chain.items) if item is part)
            behind = (fold(item, ast.parts, self._ask_sum) for item in chain.items[at + 1 :])
            items = (*chain.items[:at], *made, *behind)
            made = [ast.Chain(chain.operator, items, chain.bracketed, chain.span)]
        return made

    def _add_up(self, told: Container[str], node: ast.Ast, done: Sequence[ast.Ast]) -> ast.Ast:
        """Return a command that counts, with the number that it adds. A sum that is used later isn't kept in each
        place.
        """
        if isinstance(node, ast.Chain) and node.operator in _IN_TURN:
            kept = (item for item in done if not (isinstance(item, ast.Remember) and item.key in told))
            items = tuple(part for item in kept for part in _splice(item))
            return items[0] if len(items) == 1 else ast.Chain(node.operator, items, node.bracketed, node.span)
        if not _is_count(node):
            return ast.with_parts(node, done)
        number = ast.Remember(_LAST, self._count, (), node.span)
        more = ast.Assign(_TOTAL, "increase", self._number, f"{{{_LAST}}}", node.span)
        return ast.Chain("sequence", (node, number, more), False, node.span)

    def _ask_sum(self, node: ast.Ast, done: Sequence[ast.Ast]) -> ast.Ast:
        if isinstance(node, ast.Remember) and _is_number(node):
            return ast.Assign(node.key, "set", self._number, f"{{{_TOTAL}}}", node.span)
        if isinstance(node, ast.Phrase) and node.entry.id == COMPARED:
            return ast.Compared(_TOTAL, self._number, node.arguments, node.span)
        return ast.with_parts(node, done)


def _is_count(node: ast.Ast) -> bool:
    """Whether a node counts."""
    return isinstance(node, ast.Phrase) and node.entry.id in COUNTING


def _is_names(node: ast.Ast) -> bool:
    """Whether a node keeps the names of what was counted last."""
    return isinstance(node, ast.Remember) and node.entry.id == COUNTED_NAMES


def _is_number(node: ast.Ast) -> bool:
    """Whether a node keeps the number that was counted last."""
    return isinstance(node, ast.Remember) and node.entry.id == COUNT


def _splice(node: ast.Ast) -> tuple[ast.Ast, ...]:
    """Return the commands of a node that counts and adds to the sum, or the node itself."""
    last = node.items[-1] if isinstance(node, ast.Chain) else None
    return (
        node.items if isinstance(node, ast.Chain) and isinstance(last, ast.Assign) and last.key == _TOTAL else (node,)
    )


def _counts(node: ast.Ast) -> bool:
    return any(map(_is_count, ast.parents_first(node)))


def _last_count(node: ast.Ast) -> tuple[list[ast.Chain], ast.Ast | None]:
    """Return what counts last in a command, if it counts in each place of a list or set, with the chains around it."""
    chains: list[ast.Chain] = []
    while not _counts_several(node):
        if not isinstance(node, ast.Chain) or node.operator not in _IN_TURN:
            return [], None
        chains.append(node)
        node = next(item for item in reversed(node.items) if _counts(item))
    return chains, node


def asks_for_number(node: ast.Ast) -> bool:
    """Whether a node asks for the number that was counted last."""
    return _is_number(node) or (isinstance(node, ast.Phrase) and node.entry.id == COMPARED)


def _counts_several(node: ast.Ast) -> bool:
    """Whether a command counts in each place of a list or set: no `for each`, and no commands with verbs of their own.

    Those are said of trees as they are, so that they mean the same when they are read back.
    """
    if isinstance(node, ast.ForEach):
        return node.body.span.start <= node.span.start
    if not isinstance(node, ast.Chain) or node.operator not in _IN_TURN:
        return False
    items = [each for each in node.items if not _is_of_sum(each)]
    if len(items) < 2 or not all(map(_is_count, items)):
        return False
    verbs = [each.span.text.split(maxsplit=1)[:1] for each in items]
    return len({each.span.start for each in items}) == 1 or verbs[0] not in verbs[1:]  # `in A and in B`


def _is_of_sum(node: ast.Ast) -> bool:
    """Whether a node keeps what is added to the sum, or adds it."""
    return isinstance(node, ast.Remember | ast.Assign) and node.key in (_TOTAL, _LAST)


def _keys(node: ast.Ast) -> set[str]:
    """Return the values in which a command keeps numbers for what stands behind it, and doesn't use them itself."""
    nodes = ast.parents_first(node)
    used = {key for each in nodes if not isinstance(each, ast.Remember) for key in ast.keys_of(each)}
    return {each.key for each in nodes if isinstance(each, ast.Remember) and _is_number(each)} - used


def _is_asked(made: Sequence[_Made], first: int, keys: set[str]) -> bool:
    """Whether commands from one on, up to the next that counts, ask for the number or use one of these values."""
    for at in range(first, len(made)):
        item, counting = made[at]
        if counting:
            return False
        for node in ast.parents_first(item):
            if asks_for_number(node) or not keys.isdisjoint(ast.keys_of(node)):
                return True
    return False
