"""Checks of trees: port values (BT014), size (BT042), resources of the robot (BT041) and closed goals (BT162).

Each port text must be a value of its declared type. Names inside names can make a short mission grow beyond all
measure. Two parts of a parallel must not hold the same resource, not even through named subtrees. A journey must not
lead to a place that a constraint of the same statement closes meanwhile.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.printer.phrase import is_sentence
from btlang.text.source import NOWHERE, Span
from btlang.tree.catalogue import CATALOGUE, CONSTRAINTS, MOST_NODES, SEQUENCE, SUBTREE, Port, zone_names
from btlang.tree.node import Node
from btlang.vocabulary.capabilities import MOVES
from btlang.vocabulary.entry import Entry
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.value_type import PLACE

Holders = Mapping[str, Node]
"""Resource -> a leaf (or name) that holds it."""
_JOINS = re.compile(r'[^\n;."()]*')
_NO_HOLDERS: Holders = {}  # one for all
_KEEP_OUT, _ENTER, _OPEN = CONSTRAINTS["keep out"], "EnterZone", "OpenZone"
Goals = Mapping[str, Node]
"""The names of places and zones to which a part of the tree drives, or through which; each with a leaf that does."""
_NO_GOALS: Goals = {}  # one for all


def check_types(compilation: Compilation) -> Iterator[Diagnostic]:
    """Report whole numbers, such as times and numbers of rounds, that a tree can't hold (BT014)."""
    for _, nodes in compilation.nodes:
        wrong = {id(node): wanted for node in nodes if node.ports and (wanted := _out_of_range(node))}
        for node, span in _with_spans(nodes[-1]) if wrong else ():
            if span is not None and id(node) in wrong:
                yield diagnostic("BT014", span, words=node.replace(span=span).source_text, wanted=wrong[id(node)])


def _with_spans(root: Node) -> Iterator[tuple[Node, Span | None]]:
    """Yield every node with its words, or those around it: the timer of `for` has no words of its own."""
    stack = [(root, root.span)]
    while stack:
        node, span = stack.pop()
        span = node.span or span
        yield node, span
        stack.extend((child, span) for child in node.children)


def _out_of_range(node: Node) -> str:
    """Return what would be in range, "" if all is."""
    kind = CATALOGUE.get(node.id)
    if kind is None:
        return ""
    for name, text in node.ports:
        port = kind.ports.get(name)
        if port is None or port.least is None or port.most is None or not text or "{" in text:
            continue  # not given, which is another mistake, or only known when it runs
        try:
            number = int(text)
        except ValueError:
            return f"{name} is a whole number, not {text!r}"
        if kind.interrupts and number == 0:
            return "a time limit is at least 0.001 s"  # 0 would mean no limit
        if not port.least <= number <= port.most:
            return _describe_range(port, name, number)
    return ""


def _describe_range(port: Port, name: str, number: int) -> str:
    if port.unit == "ms":
        return "a time is not negative" if number < 0 else "a time is at most 49 days"
    if port.unit == "rounds" and number > 0:
        return f"a number of rounds is at most {port.most:,}"
    return f"{name} is a whole number from {port.least} to {port.most}"


def check_size(compilation: Compilation) -> list[Diagnostic]:
    """Report a tree of more than a million nodes once its names are filled in (BT042)."""
    sizes: dict[str, int] = {}
    for name, nodes in compilation.nodes:
        used = (sizes.get(node.port("ID"), 0) for node in nodes if node.id == SUBTREE)
        sizes[name] = len(nodes) + sum(used)
    if sizes[""] <= MOST_NODES:
        return []
    return [diagnostic("BT042", compilation.tree.root.span or NOWHERE, limit=f"{MOST_NODES:,}")]


def check_resources(compilation: Compilation) -> list[Diagnostic]:
    """Report each parallel and resource that two of its children need, once (BT041)."""
    vocabulary = compilation.vocabulary
    known = {id: vocabulary.entries[id] for id in compilation.ids if id in vocabulary.entries}
    needs = {id: dict.fromkeys(each for entry in known[id] for each in entry.resources) for id in known}
    at_once = {id for id in compilation.ids if id in CATALOGUE and CATALOGUE[id].at_once}
    problems: list[Diagnostic] = []

    def combine(node: Node, children: Sequence[Holders], named: dict[str, Holders]) -> Holders:
        if children:
            if node.id in at_once:
                problems.extend(_conflicts(children, vocabulary))
            return _join_holders(children)
        resources = named.get(node.port("ID"), ()) if node.id == SUBTREE else needs.get(node.id)
        return dict.fromkeys(resources, node) if resources else _NO_HOLDERS

    if at_once:
        compilation.fold(combine)
    return problems


def _join_holders(holders: Sequence[Holders]) -> Holders:
    """Return what all of them hold; the first holder of each resource."""
    some = [held for held in holders if held]
    if len(some) < 2:
        return some[0] if some else _NO_HOLDERS
    joined: dict[str, Node] = {}
    for held in reversed(some):
        joined.update(held)
    return joined


def _conflicts(parts: Sequence[Holders], vocabulary: Lexicon) -> list[Diagnostic]:
    """Yield each resource that two of the parts hold, once."""
    held: dict[str, Node] = {}
    found: list[Diagnostic] = []
    reported: set[str] = set()
    for part in parts:
        both = sorted(held.keys() & part.keys() - reported)
        found += [_conflict(resource, held[resource], part[resource], vocabulary) for resource in both]
        reported.update(both)
        held = {**part, **held}
    return found


def _conflict(resource: str, first: Node, second: Node, vocabulary: Lexicon) -> Diagnostic:
    one, other = first.source_text, second.source_text
    notes = ((first.span, f"this needs the {resource} too"),) if first.span is not None else ()
    fixed = f"{one} {vocabulary.word('then')} {other}"
    fix = None
    if one[:1] == "<":
        fixed = f"<Sequence> {one} {other} </Sequence>"
    elif first.span is None or not is_sentence(first.span):
        fixed = f"{first.id} and {second.id} as children of a Sequence"
    elif second.span is not None and is_sentence(second.span):
        fix = _one_after_the_other(first.span, second.span, vocabulary)
        fixed = _sentence_with(*fix) if fix is not None else fixed
    problem = diagnostic(
        "BT041", second.span or NOWHERE, notes, fix, resource=resource, first=one, second=other, fixed=fixed
    )
    return problem.replace(readings=() if fix is None else (fix,))  # type: ignore[no-any-return]


def _one_after_the_other(first: Span, second: Span, vocabulary: Lexicon) -> tuple[Span, str] | None:
    """Return the word `and` that joins them, possibly behind a later part of the list, as `then`. The words behind the
    list that mean at the same time are removed.
    """
    source, text = first.source, first.source.text
    if second.source is not source or not _JOINS.fullmatch(text[first.end : second.start]):
        return None
    joint = re.compile(rf"[^\n;.\"]*?\b({re.escape(vocabulary.word('and'))})\b", re.IGNORECASE).match(text, first.end)
    if joint is None:
        return None
    then, (start, end) = vocabulary.word("then"), joint.span(1)
    together = "|".join(re.escape(phrase) for phrase in vocabulary.roles["in_parallel"])
    behind = re.compile(rf"([^\n;.\"()]*?)\s+(?:{together})\b", re.IGNORECASE).match(text, end)
    return (Span(source, start, behind.end()), then + behind[1]) if behind else (Span(source, start, end), then)


def _sentence_with(span: Span, words: str) -> str:
    text = span.source.text
    start = max(text.rfind("\n", 0, span.start), text.rfind(". ", 0, span.start), text.rfind(";", 0, span.start)) + 1
    end = min((at for at in (text.find(mark, span.end) for mark in "\n.;") if at >= 0), default=len(text))
    return f"{text[start : span.start]}{words}{text[span.end : end]}".strip()


def check_goals(compilation: Compilation) -> list[Diagnostic]:
    """Check below each KeepOut, and behind each command that closes a zone until the mission ends."""
    entries = compilation.vocabulary.entries
    known = {id: entries[id][0] for id in compilation.ids if id in entries}
    closing = {id for id, entry in known.items() if entry.constrains == "keep out"} if _OPEN not in known else set()
    problems: list[Diagnostic] = []

    def report(closed: Iterable[str], goals: Goals) -> None:
        for zone in closed if goals else ():
            node = goals.get(zone.lower())
            if node is not None and node.span is not None:
                problems.append(diagnostic("BT162", node.span, words=node.source_text, zone=zone))

    def combine(node: Node, children: Sequence[Goals], named: dict[str, Goals]) -> Goals:
        if not children:
            if node.id == SUBTREE:
                return named.get(node.port("ID"), _NO_GOALS)
            return _goals(node, known[node.id]) if node.id in known else _NO_GOALS
        if node.id == _KEEP_OUT:
            report(zone_names(node.port("zones")), children[0])
        elif node.id == SEQUENCE:
            closed: dict[str, None] = {}
            for child, goals in zip(node.children, children, strict=True):
                report(closed, goals)
                if child.id in closing:
                    closed.update(dict.fromkeys(text for _, text in child.ports))
        return {name: leaf for goals in children for name, leaf in goals.items()}

    if _KEEP_OUT in compilation.ids or closing:
        compilation.fold(combine)
    return problems


def _goals(node: Node, entry: Entry) -> Goals:
    if MOVES not in entry.resources or entry.constrains:
        return _NO_GOALS
    names = [slot.name for slot in entry.slots if slot.type == PLACE or entry.id == _ENTER]
    texts = [text for name, text in node.ports if name in names]
    return {name.lower(): node for text in texts for name in zone_names(text)}
