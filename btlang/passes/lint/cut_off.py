"""BT054: actions that say that they should not be halted half-way, in a form that will halt them.

A standing rule isn't reported, since what it halts starts again; nor is a parallel, which halts a part only if
another one fails.
"""

from __future__ import annotations

from collections.abc import Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.passes.lint.endings import SKIPPED, SUCCESS, Ends, ends_of
from btlang.support.record import Record
from btlang.tree.catalogue import CATALOGUE, ON_FAILURE, ON_SUCCESS, SUBTREE
from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias


class Exposed(Record):
    """An action that isn't reported for a form yet, and the leaf or name that stands for it in this tree."""

    leaf: Node
    place: Node


Found: TypeAlias = "Exposed | None"


def cut_off(compilation: Compilation) -> list[Diagnostic]:
    """The first such action of each form; each action for its innermost form only."""
    entries = compilation.vocabulary.entries
    found: list[Diagnostic] = []
    ends: dict[int, Ends] = {}

    def end(node: Node, children: Sequence[Ends], named: dict[str, Ends]) -> Ends:
        ends[id(node)] = ends_of(node, children, named)
        return ends[id(node)]

    whole = {id for id in compilation.ids if any(entry.uninterruptible for entry in entries.get(id, ()))}

    def combine(node: Node, children: Sequence[Found], named: dict[str, Found]) -> Found:
        if node.id in whole:
            return Exposed(node, node)
        if not children:
            inner = named.get(node.port("ID")) if node.id == SUBTREE else None
            return inner and Exposed(inner.leaf, node)
        exposed = next(filter(None, children), None)
        when = _when(node) if exposed is not None else ""
        if (
            when == _TIME and exposed is not None and len(children) > 1
        ):  # only if another part can succeed: `A, meanwhile B every 5 s` can't
            if not ends:
                compilation.fold(end)
            others = (other for other, own in zip(node.children, children, strict=True) if own is not exposed)
            if not any(ends[id(other)] & (SUCCESS | SKIPPED) for other in others):
                return exposed
        if exposed is None or not when:
            return exposed
        found.extend(_warnings(exposed, when, compilation))
        return None

    if whole:
        compilation.fold(combine)
    return found


def _when(node: Node) -> str:
    """When a node halts what is in it, "" where it does not."""
    kind = CATALOGUE.get(node.id)
    if kind is None or not (kind.interrupts or kind.enough):
        return ""
    if kind.enough:
        return _TIME if node.port(kind.enough) == "1" else ""
    if kind.asks_first:
        return "as soon as the condition changes"
    return _WHEN.get(kind.goes_on, _TIME)


_TIME = "when the time is over"
_WHEN = {ON_SUCCESS: "as soon as the condition is false", ON_FAILURE: "as soon as the condition is true"}


def _warnings(exposed: Exposed, when: str, compilation: Compilation) -> list[Diagnostic]:
    leaf, place = exposed.leaf.span, exposed.place.span
    if leaf is None or place is None:
        return []
    notes = () if exposed.leaf is exposed.place else ((leaf, f"'{leaf.text}' is here"),)
    advice = "Move it out, before or after this node."
    if compilation.is_text:
        then = compilation.vocabulary.word("then")
        advice = f"Move it out, before or after the form, with '{then}'."
    return [diagnostic("BT054", place, notes, words=leaf.text, when=when, advice=advice)]
