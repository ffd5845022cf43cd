"""Resources of the robot: two parts of a parallel must not hold the same one, also through named subtrees."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.printer.phrase import is_sentence
from btlang.text.source import NOWHERE, Span
from btlang.tree.catalogue import CATALOGUE, SUBTREE
from btlang.tree.node import Node
from btlang.vocabulary.lexicon import Lexicon

Holders = Mapping[str, Node]
"""Resource -> a leaf (or name) that holds it."""

_JOINS = re.compile(r'[^\n;."()]*')
_NONE: Holders = {}  # one for all


def check_resources(compilation: Compilation) -> list[Diagnostic]:
    """BT041 once for each parallel and resource that two of its children need."""
    vocabulary = compilation.vocabulary
    known = {id: vocabulary.entries[id] for id in compilation.ids if id in vocabulary.entries}
    needs = {id: dict.fromkeys(each for entry in known[id] for each in entry.resources) for id in known}
    at_once = {id for id in compilation.ids if id in CATALOGUE and CATALOGUE[id].at_once}
    problems: list[Diagnostic] = []

    def combine(node: Node, children: Sequence[Holders], named: dict[str, Holders]) -> Holders:
        if children:
            if node.id in at_once:
                problems.extend(_conflicts(children, vocabulary))
            return _joined(children)
        resources = named.get(node.port("ID"), ()) if node.id == SUBTREE else needs.get(node.id)
        return dict.fromkeys(resources, node) if resources else _NONE

    if at_once:
        compilation.fold(combine)
    return problems


def _joined(holders: Sequence[Holders]) -> Holders:
    """What all of them hold; the first holder of each resource."""
    some = [held for held in holders if held]
    if len(some) < 2:
        return some[0] if some else _NONE
    joined: dict[str, Node] = {}
    for held in reversed(some):
        joined.update(held)
    return joined


def _conflicts(parts: Sequence[Holders], vocabulary: Lexicon) -> list[Diagnostic]:
    """Each resource that two of the parts hold, once."""
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
    """The word `and` that joins them, which may stand behind a later part of the list, as `then`; the words behind
    the list that say at the same time go.
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
