"""Rounds over sets: `take every cube from the table and put it in the box` is one round for each cube.

A phrase says a set as one argument, a choice of all names that are described. Its round takes in what comes behind it
in the statement up to the last command that speaks of its thing, and behind a set of places or people what is joined
by `and` or a comma and neither travels nor names a place.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence, Set
from itertools import pairwise

from btlang.support.record import Record
from btlang.text.source import Source
from btlang.text.words import split
from btlang.tree import ast
from btlang.tree.answers import ABOUT_ANSWERS, ANSWER, ASK, asks
from btlang.tree.round_parts import gathered, is_journey, set_of, with_argument, with_each_carried
from btlang.tree.sums import COMPARED, COUNTING
from btlang.tree.visit import fold
from btlang.vocabulary.capabilities import TRAVELS
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.references import ALL, Choice, choice_of
from btlang.vocabulary.trie import longest
from btlang.vocabulary.value_type import PERSON, PLACE, TEXT

DAYTIME = "TimeOfDay"
"""The id of the condition that the time of day is within bounds."""
ONE_FAILS = "if_one_fails"
"""The role of words for what is done for each thing of a round that fails."""


def with_rounds(mission: ast.Program, vocabulary: Lexicon) -> ast.Program:
    """Return the mission with a loop for each set that a command of it speaks of."""
    nodes = [node for body in _own_bodies(mission) for node in ast.parents_first(body)]
    tries = (
        isinstance(node, ast.Retry) or (isinstance(node, ast.Chain) and node.operator == "fallback") for node in nodes
    )
    if not any(map(_choice_of, nodes)) and not any(tries):
        return mission
    if mission.facts:
        vocabulary = vocabulary.with_places(tuple(fact.name for fact in ast.all_facts(mission)))
    return ast.with_bodies(
        mission, lambda body: _with_loops(body, vocabulary), lambda included: with_rounds(included, vocabulary)
    )


def _own_bodies(mission: ast.Program) -> list[ast.Ast]:
    included = [body for each in mission.includes for body in _own_bodies(each.mission)]
    return [*included, *(each.body for each in mission.definitions), *([mission.body] if mission.body else [])]


class _Round(Record):
    """A set, and the parts `first` to `last` of a chain that are in its round; no chain if the `whole` of a command is.

    That is more than the command itself where a condition behind it is about its thing: `wave at all if they are near`.
    """

    choice: Choice
    whole: ast.Ast
    chain: ast.Chain | None = None
    first: int = 0
    last: int = 0


def _with_loops(root: ast.Ast, vocabulary: Lexicon) -> ast.Ast:
    if any(map(_choice_of, ast.parents_first(root))):
        root = _chosen_anew(with_each_carried(root))
    if any(map(set_of, ast.parents_first(root))):
        root = _add_loops(root, vocabulary)
    return fold(root, ast.parts, lambda node, done: _with_each_tried(node, done, vocabulary))


def _chosen_anew(root: ast.Ast) -> ast.Ast:
    """Return a mission in which what speaks of a thing chooses it where it isn't chosen by then.

    - A time of day ends a round: `tell everyone "Lunch", and at 1 pm tell them "Work"`;
    - the other branch hasn't chosen: `if C, take a cup to the lab, otherwise take it to the hall`.
    """
    renewed = dict[int, Choice]()
    known, over = dict[str, Choice](), set[str]()
    for node in ast.parents_first(root):
        own = _choice_of(node)
        if isinstance(node, ast.WaitTime):
            over |= {key for key, choice in known.items() if choice.how == ALL}
        elif own is not None:
            known[own.key] = own
            over.discard(own.key)
        elif isinstance(node, ast.Phrase | ast.Name) and (
            again := next(iter(over.intersection(ast.keys_of(node))), "")
        ):
            renewed[id(node)] = known[again]
            over.discard(again)
        if isinstance(node, ast.If | ast.IfWorks) and node.otherwise is not None:
            _renew_otherwise(node.body, node.otherwise, known.keys(), renewed)
    if not renewed:
        return root

    def renew(node: ast.Ast, done: Sequence[ast.Ast]) -> ast.Ast:
        choice = renewed.get(id(node))
        if choice is not None and isinstance(node, ast.Phrase | ast.Name):
            return with_argument(node, f"{{{choice.key}}}", choice.text)
        return ast.with_parts(node, done)

    return fold(root, ast.parts, renew)


def _renew_otherwise(body: ast.Ast, otherwise: ast.Ast, known: Set[str], renewed: dict[int, Choice]) -> None:
    """Find the first commands of a branch that speak of what only the other one has chosen."""
    choices = (own for node in ast.parents_first(body) if (own := _choice_of(node)) is not None)
    missing = {own.key: own for own in choices if own.key not in known}
    for node in ast.parents_first(otherwise) if missing else ():
        own = _choice_of(node)
        if own is not None:
            missing.pop(own.key, None)
        for key in set(missing).intersection(ast.keys_of(node)):
            renewed[id(node)] = missing.pop(key)


def _choice_of(node: ast.Ast) -> Choice | None:
    """Return what the robot chooses for a command."""
    if not isinstance(node, ast.Phrase | ast.Name):
        return None
    choices = (choice_of(text) for _, text in node.arguments if text[:1] == "{")
    return next((choice for choice in choices if choice is not None), None)


def _add_loops(root: ast.Ast, vocabulary: Lexicon) -> ast.Ast:
    root = gathered(root)
    nodes = ast.parents_first(root)
    sets = [(at, choice) for at, node in enumerate(nodes) if (choice := set_of(node)) is not None]
    parents = {id(part): node for node in nodes for part in ast.parts(node)}
    of_chain: dict[int, list[_Round]] = {}
    alone: dict[int, Choice] = {}
    for at, choice in sets:
        found = _round(nodes, at, choice, parents, vocabulary)
        if found.chain is None:
            alone[id(found.whole)] = choice
        else:
            of_chain.setdefault(id(found.chain), []).append(found)

    def combine(node: ast.Ast, done: list[ast.Ast]) -> ast.Ast:
        choice, own = set_of(node), alone.get(id(node))
        if choice is not None and isinstance(node, ast.Phrase | ast.Name):
            made: ast.Ast = with_argument(node, choice.text, f"{{{choice.key}}}")
        else:
            made = ast.with_parts(node, done)
        if own is not None:
            return _loop(own, made, vocabulary)
        for each in sorted(of_chain.get(id(node), ()), key=lambda found: -found.first):
            made = _wrap(made, each, vocabulary)
        return made

    return fold(root, ast.parts, combine)


def _with_each_tried(node: ast.Ast, done: Sequence[ast.Ast], vocabulary: Lexicon) -> ast.Ast:
    """Put `If one is missing, B` into the round before it: B, or a new attempt, for each thing for which that fails."""
    made = ast.with_parts(node, done)
    if isinstance(made, ast.Retry):
        if _asks_about_one(made.body, made.span.end, vocabulary):
            return _in_each(made.body, lambda part: ast.Retry(made.attempts, part, made.pause, made.span)) or made
    elif isinstance(made, ast.Chain) and made.operator == "fallback":
        tried, *others = made.items
        if _asks_about_one(tried, others[0].span.start, vocabulary):
            return _in_each(tried, lambda part: ast.Chain("fallback", (part, *others), True, made.span)) or made
    return made


def _asks_about_one(tried: ast.Ast, end: int, vocabulary: Lexicon) -> bool:
    """Whether the words behind a command, up to a place, say what is done for each thing for which it fails."""
    gap = split(Source(tried.span.source.text[tried.span.end : end]), vocabulary.orthography)
    found = (longest(vocabulary.trie, gap, at, vocabulary.context, lists=False) for at in range(len(gap.words)))
    return any(match is not None and match.meaning.role == ONE_FAILS for match in found)


def _says_one_verb(chain: ast.Chain) -> bool:
    """Whether a chain is one command for several things: `take the cup to the lab and the book to the hall`."""
    entries = {item.entry.id if isinstance(item, ast.Phrase) else "" for item in chain.items}
    return chain.operator in ("and", "sequence") and len(entries) == 1 and "" not in entries


def _in_each(node: ast.Ast, change: Callable[[ast.Ast], ast.Ast]) -> ast.Ast | None:
    """Return a command whose rounds, or parts for single things, are changed; None if it has none."""
    if isinstance(node, ast.ForEach):
        return node.replace(body=change(node.body))  # type: ignore[no-any-return]
    if isinstance(node, ast.Chain) and (ast.is_list(node) or _says_one_verb(node)):
        items = tuple(map(change, node.items))
        return node.replace(items=items, span=items[0].span)  # type: ignore[no-any-return]
    parts = ast.parts(node)
    changed = [_in_each(part, change) for part in parts]
    if all(part is None for part in changed):
        return None
    return ast.with_parts(node, [new or old for new, old in zip(changed, parts, strict=True)])


def _round(
    nodes: Sequence[ast.Ast], at: int, choice: Choice, parents: dict[int, ast.Ast], vocabulary: Lexicon
) -> _Round:
    """Return how far the round of a set reaches."""
    key, node = choice.key, nodes[at]
    last = at
    for later in range(at + 1, len(nodes)):
        own = set_of(nodes[later])
        if (own is not None and own.key == key) or key in ast.chosen_keys(nodes[later]):
            break
        if key in ast.keys_of(nodes[later]):
            last = later
    path = _path(node, parents)
    if last > at:
        others = {id(each) for each in _path(nodes[last], parents)}
        common = next((up for up in path if id(up) in others), None)
        if isinstance(common, ast.Chain):
            first, end = (_index(common, _path(one, parents)) for one in (node, nodes[last]))
            return _Round(choice, node, common, first, _goes_along(common, first, end, choice, vocabulary))
    chain = path[1] if len(path) > 1 else None
    if isinstance(chain, ast.If) and _asks_about(chain, node, key):
        return _Round(choice, chain)
    if isinstance(chain, ast.Chain):
        first = _index(chain, path)
        end = _goes_along(chain, first, first, choice, vocabulary)
        if end > first:
            return _Round(choice, node, chain, first, end)
    return _Round(choice, node)


def _asks_about(form: ast.If, node: ast.Ast, key: str) -> bool:
    """Whether a command depends on a condition behind it that speaks of its thing."""
    is_behind = form.body is node and form.condition.span.start >= node.span.end
    return is_behind and any(key in ast.keys_of(each) for each in ast.parents_first(form.condition))


def _path(node: ast.Ast, parents: dict[int, ast.Ast]) -> list[ast.Ast]:
    """List the node and what it is in, the innermost first."""
    found = [node]
    while id(node) in parents:
        node = parents[id(node)]
        found.append(node)
    return found


def _index(chain: ast.Chain, path: Sequence[ast.Ast]) -> int:
    """Return the part of a chain in which a path begins."""
    within = {id(each) for each in path}
    return next(at for at, item in enumerate(chain.items) if id(item) in within)


def _goes_along(chain: ast.Chain, first: int, last: int, choice: Choice, vocabulary: Lexicon) -> int:
    """Return the last part that is in the round of a set of places or people without a word about them.

    What is said to be done in each place is in it wherever it leads: `in every room, greet somebody`.
    """
    node = chain.items[first]
    goes = is_journey(node) or (isinstance(node, ast.Phrase) and _counts_answers(chain, first))
    if choice.type in (PLACE, PERSON) and goes:
        tells = isinstance(node, ast.Phrase) and any(slot.type == TEXT for slot in node.entry.slots)
        if last == first < len(chain.items) - 1 and _says_where(chain, first, vocabulary):
            last += 1
        while last + 1 < len(chain.items) and _is_joined(chain, last) and _goes_with(chain, last):
            if tells and isinstance(chain.items[last + 1], ast.Wait):
                break  # `tell everyone "Bye", wait 1 min and dock`
            last += 1
        told = chain.items[last]
        if isinstance(told, ast.Remember) and told.entry.id == ANSWER and last + 1 < len(chain.items):
            last += 1  # `ask each of them what they want and tell Bob`: each answer
    return last


def _says_where(chain: ast.Chain, at: int, vocabulary: Lexicon) -> bool:
    """Whether a part, or what is said between it and the next one, says where that is done: `in every room, wave`."""
    left, right = chain.items[at].span, chain.items[at + 1].span
    front, gap = left.text.lower().split()[:2], left.source.text[left.end : right.start].lower().split()
    every = {words.split()[0] for words in vocabulary.roles.get("all_names", ())}
    if any(one in vocabulary.asking["located"] and two in every for one, two in (*pairwise(front), *pairwise(gap))):
        return True
    form = chain.items[at + 1]
    asked = form.condition.span.text.lower().split() if isinstance(form, ast.If) else []
    return asked[-1:] != [] and PLACE in vocabulary.values.pronouns.get(asked[-1], ())  # `if somebody is there, A`


def _counts_answers(chain: ast.Chain, at: int) -> bool:
    """Whether a question stands there, and behind it what counts the answers."""
    asked, *behind = chain.items[at : at + 2]
    counts = isinstance(behind[0].body, ast.Assign) if behind and isinstance(behind[0], ast.If) else False
    return counts and isinstance(asked, ast.Phrase) and asked.entry.id == ASK


def _goes_with(chain: ast.Chain, at: int) -> bool:
    """Whether the part behind one leads nowhere, or depends on what is counted, or answered, in that one."""
    before, item = chain.items[at : at + 2]
    depending = (((COMPARED,), COUNTING), (ABOUT_ANSWERS, (ASK,)))
    if isinstance(item, ast.If) and any(asks(item.condition, ids) and asks(before, by) for ids, by in depending):
        return True
    return not _travels(item)


def _is_joined(chain: ast.Chain, at: int) -> bool:
    """Whether `and` or a bare comma stands behind a part: `go to every room, wave, then dock`."""
    left, right = chain.items[at].span, chain.items[at + 1].span
    return chain.operator == "and" or left.source.text[left.end : right.start].strip() == ","


def _travels(node: ast.Ast) -> bool:
    """Whether it goes somewhere by itself, or says a place."""
    for item in ast.parents_first(node):
        if isinstance(item, ast.Phrase):
            leads = TRAVELS in item.entry.needs and all(slot.type != PLACE for slot in item.entry.slots)
            if item.entry.given(PLACE, item.arguments) or (leads and not meets_somebody(item)):
                return True
        elif isinstance(item, ast.Name | ast.Exact):
            return True
    return False


def meets_somebody(phrase: ast.Phrase) -> bool:
    """Whether a command is for somebody whom the robot chooses where it is by then: `greet someone`."""
    choices = map(choice_of, phrase.entry.given(PERSON, phrase.arguments))
    return any(choice is not None and choice.how != ALL for choice in choices)


def _wrap(chain: ast.Ast, found: _Round, vocabulary: Lexicon) -> ast.Ast:
    assert isinstance(chain, ast.Chain)
    items = chain.items[found.first : found.last + 1]
    body: ast.Ast = items[0] if len(items) == 1 else chain.replace(items=items, bracketed=False)
    loop = _loop(found.choice, body, vocabulary)
    rest = (*chain.items[: found.first], loop, *chain.items[found.last + 1 :])
    return loop if len(rest) == 1 else chain.replace(items=rest)


def _loop(choice: Choice, body: ast.Ast, vocabulary: Lexicon) -> ast.Ast:
    """Make one round for each name; of a single command with known names the list of all."""
    names = vocabulary.values.likenesses.members(choice)
    if names and isinstance(body, ast.Phrase | ast.Name):
        each = tuple(with_argument(body, f"{{{choice.key}}}", name) for name in names)
        is_search = isinstance(body, ast.Phrase) and body.entry.first and choice.type == PLACE
        operator = "fallback" if is_search else "sequence"
        return each[0] if len(each) == 1 else ast.Chain(operator, each, True, body.span)
    return ast.ForEach(choice.key, choice.type, names or (choice.text,), body, body.span)
