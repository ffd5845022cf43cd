"""Lints on trees: nodes that never run (BT052, BT237), loops that do nothing (BT053), actions that are cut off (BT054).

What never lets the mission come to a command keeps it from running, and so does a loop of no rounds. A busy loop has
no end, and its rounds take no time, so it goes round at every tick. An action that shouldn't be halted half-way
isn't reported under a standing rule, since what that halts starts again, nor in a parallel, which halts a part only
if another one fails.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.passes.lint.endings import FAILURE, NEVER, SKIPPED, SUCCESS, Ends, continuing_ends, find_ends
from btlang.support.record import Record
from btlang.text.source import Span
from btlang.tree.catalogue import CATALOGUE, ON_FAILURE, ON_SUCCESS, SUBTREE, NodeKind
from btlang.tree.node import Node
from btlang.vocabulary.entry import Entry
from btlang.vocabulary.lexicon import Lexicon

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

UNDECLARED = "BT248"
"""The code of the warning about nodes that nothing declares."""
ASKS, INSTANT, TAKES_TIME = range(3)
"""What the leaves below a node are at most: conditions, things that end in the tick they start, others."""
Found: TypeAlias = "Exposed | None"
_JOINTS = " ,.;\n"
_APART = "To do both, give each a mission and a schedule of its own: btc task schedule MISSION --every RULE"
_TIME = "when the time is over"
_USUAL_END = "6 pm"
_WHEN = {ON_SUCCESS: "as soon as the condition is false", ON_FAILURE: "as soon as the condition is true"}


def find_unreachable(compilation: Compilation) -> list[Diagnostic]:
    """Report the first unreachable command of each node whose children follow in order, and rounds without a next."""
    found: list[Diagnostic] = []
    inside: dict[int, Node] = {}  # rounds that never end, by the command whose last part they are

    def combine(node: Node, children: Sequence[Ends], named: dict[str, Ends]) -> Ends:
        kind = CATALOGUE.get(node.id)
        if kind is not None and kind.goes_on and not kind.rotates:
            wanted = continuing_ends(kind)
            for at in range(len(children) - 1):
                if not children[at] & wanted:
                    found.extend(_warnings(kind, node.children[at], children[at], node.children[at + 1], compilation))
                    break
            if kind.goes_on == ON_SUCCESS and len(children) > 1 and children[-1] & (NEVER | SUCCESS) == NEVER:
                if _is_endless(node.children[-1]) and _stand_apart(*node.children[-2:]):
                    inside[id(node)] = node.children[-1]
        if inside and _is_endless(node) and id(node.children[0]) in inside:
            warning = _only_round(node, inside[id(node.children[0])], compilation)
            found.extend([warning] if warning is not None else [])
        return find_ends(node, children, named)

    compilation.fold(combine)
    return found


def _only_round(outer: Node, rounds: Node, compilation: Compilation) -> Diagnostic | None:
    """Make a warning of rounds that never end at the end of others: `every day at 9 am, wave. Then every hour, nod`."""
    if outer.span is None or rounds.span is None:
        return None
    said = outer.span.source.text[outer.span.start : rounds.span.start].rstrip(_JOINTS)
    words = (compilation.vocabulary.word(role) for role in ("then", "and"))
    said = next((said[: -len(word)].rstrip(_JOINTS) for word in words if said.lower().endswith(word)), said)
    held = _held(rounds, compilation)
    may_meet = not _held(outer, compilation, but=rounds).isdisjoint(held)
    advice = _APART if may_meet or not said else _both(said, rounds.span.text, compilation.vocabulary)
    return diagnostic("BT078", rounds.span, words=rounds.span.text, advice=advice)


def _is_endless(node: Node) -> bool:
    return node.port("num_cycles") == "-1"


def _stand_apart(first: Node, second: Node) -> bool:
    return first.span is not None and second.span is not None and not _overlap(first.span, second.span)


def _held(node: Node, compilation: Compilation, but: Node | None = None) -> set[str]:
    """Return the resources of the robot that some commands use; those of another tree aren't looked at."""
    if node is but:
        return set()
    entries = compilation.vocabulary.entries.get(node.id, ())
    own = {each for entry in entries for each in entry.resources}
    return own.union(*(_held(child, compilation, but) for child in node.children))


def _both(rounds: str, others: str, vocabulary: Lexicon) -> str:
    """Say how rounds without end go on beside others."""
    beside = f"{others[:1].lower()}{others[1:]}"
    return f"To do both, write: {rounds}. {vocabulary.word('meanwhile').capitalize()}, {beside}"


def _warnings(parent: NodeKind, before: Node, ends: Ends, behind: Node, compilation: Compilation) -> list[Diagnostic]:
    """Make a warning, none if both stand for the same words: then a form has put one of them there."""
    if before.span is None or behind.span is None or _overlap(before.span, behind.span):
        return []
    if ends & NEVER:
        how = "fails" if parent.goes_on == ON_SUCCESS else "succeeds"
        reason = "never ends" if ends == NEVER else f"continues until it {how}"
    else:
        reason = "always fails" if parent.goes_on == ON_SUCCESS else "always succeeds"
    found = diagnostic("BT052", behind.span, ((before.span, f"this {reason}"),), reason=reason)
    if before.port("num_cycles") and compilation.is_text and "\n" not in before.span.text + behind.span.text:
        may_end = not any(part.port("time") for part in before.children[0].children)  # but `every day at 9 am, wave`
        may_meet = not _held(before, compilation).isdisjoint(_held(behind, compilation))
        ways = _ways_out(before.span.text, behind.span.text, may_end, may_meet, compilation.vocabulary)
        found = found.advising(ways) if ways else found
    return [found]


def _ways_out(rounds: str, behind: str, may_end: bool, may_meet: bool, vocabulary: Lexicon) -> str:
    """Say how to come to what stands behind rounds without end, and how to do it in each of them.

    Rounds that need the same resources of the robot, and so `may_meet`, can't go on beside one another.
    """
    until = vocabulary.first("until_time").replace("{time_of_day}", _USUAL_END)
    may_end = may_end and rounds.split()[-1].lower() not in vocabulary.counts  # but `wave forever`
    ways = [f"To do it in the end, say when that comes, for example: {rounds} {until}"] if may_end else []
    paces = vocabulary.firsts["every"] | vocabulary.firsts["every_day"] | vocabulary.firsts["weekly"]
    has_pace = [said.split()[0].lower() in paces for said in (rounds, behind)]
    if all(has_pace):
        ways.append(_APART if may_meet else _both(rounds, behind, vocabulary))
    elif has_pace[0]:
        behind = f"{behind[:1].lower()}{behind[1:]}"
        ways.append(f"To do it in each round, write: {rounds}, {vocabulary.word('then')} {behind}")
    return "\n".join(ways)


def _overlap(first: Span, second: Span) -> bool:
    return first.source is second.source and first.start < second.end and second.start < first.end


def find_empty_loops(compilation: Compilation) -> Iterator[Diagnostic]:
    """Report loops with a number of rounds that is 0. A number of retries may be 0: the first try is none."""
    loops = {id: CATALOGUE[id].rounds for id in compilation.ids if id in CATALOGUE and CATALOGUE[id].rounds}
    ports = {id: port for id, port in loops.items() if CATALOGUE[id].ports[port].unit == "rounds"}
    for _, nodes in compilation.nodes if ports else ():
        for node in nodes:
            port = ports.get(node.id)
            if port is not None and node.port(port) == "0" and node.span is not None:
                yield diagnostic("BT237", node.span, id=node.id, port=port)


def find_busy_loops(compilation: Compilation) -> list[Diagnostic]:
    """Report loops with no leaf that takes time, but not `wait until C`, which is meant to ask again and again."""
    busy: list[Node] = []
    entries = compilation.vocabulary.entries

    def combine(node: Node, children: Sequence[int], named: dict[str, int]) -> int:
        kind = CATALOGUE.get(node.id)
        if not children:
            if node.id == SUBTREE:
                return named.get(node.port("ID"), TAKES_TIME)
            if kind is not None:
                return TAKES_TIME if kind.takes_time else ASKS if kind.kind == "Condition" else INSTANT
            return _leaf(entries[node.id][0]) if node.id in entries else TAKES_TIME
        if kind is not None and kind.enough and node.port(kind.enough) == "1":
            while busy and any(child is busy[-1] for child in node.children):
                busy.pop()  # the loop of `for 5 s` has an end
            return TAKES_TIME
        if kind is not None and kind.roles[-1:] == ("work",):
            children = children[:2]  # what it does is to watch
            while busy and busy[-1] is node.children[2]:
                busy.pop()
        most = max(children)
        if kind is None or most == TAKES_TIME or not kind.again or not kind.is_endless(node.ports):
            return TAKES_TIME if kind is None or kind.takes_time else most
        if most == ASKS and (kind.again == ON_FAILURE or not kind.rounds):
            return TAKES_TIME  # it waits for a condition to become true, or false
        if kind.rounds or any(child.children or child.ports for child in node.children):
            busy.append(node)  # else it waits for ever, as it says
        return most

    if any(id in CATALOGUE and CATALOGUE[id].again for id in compilation.ids):
        compilation.fold(combine)
    word = compilation.vocabulary.word
    advice = f"To wait for a condition, say '{word('wait_until')} ...'; otherwise add a '{word('wait')}' to the loop."
    if not compilation.is_text:
        advice = "Add something that takes time, such as a Sleep node."
    return [diagnostic("BT053", node.span, advice=advice) for node in busy if node.span is not None]


def _leaf(entry: Entry) -> int:
    if entry.outputs and entry.instant and not entry.phrases:
        return ASKS  # it chooses what a condition is about
    if entry.instant:
        return INSTANT
    return TAKES_TIME if entry.sort == "action" else ASKS


class Exposed(Record):
    """An action that isn't reported for a form yet, and the leaf or name that stands for it in this tree."""

    leaf: Node
    place: Node


def find_undeclared(compilation: Compilation) -> Iterator[Diagnostic]:
    """Report the nodes that a mission says by an id that no keyword entry has (BT248), each id once."""
    unknown = set(compilation.ids.difference(CATALOGUE, compilation.vocabulary.entries))
    for node in compilation.tree.walk() if unknown else ():
        if node.id in unknown and node.span is not None:
            unknown.discard(node.id)
            yield diagnostic(UNDECLARED, node.span, id=node.id)


def find_cut_off(compilation: Compilation) -> list[Diagnostic]:
    """Report the first such action of each form; each action for its innermost form only."""
    entries = compilation.vocabulary.entries
    found: list[Diagnostic] = []
    ends: dict[int, Ends] = {}

    def end(node: Node, children: Sequence[Ends], named: dict[str, Ends]) -> Ends:
        ends[id(node)] = find_ends(node, children, named)
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
            if not any(ends[id(other)] & (SUCCESS | SKIPPED) or ends[id(other)] == FAILURE for other in others):
                return exposed
        if exposed is None or not when:
            return exposed
        found.extend(_cut_off_warnings(exposed, when, compilation))
        return None

    if whole:
        compilation.fold(combine)
    return found


def _when(node: Node) -> str:
    """Return when a node halts what is in it, "" if it doesn't."""
    kind = CATALOGUE.get(node.id)
    if kind is None or not (kind.interrupts or kind.enough):
        return ""
    if kind.enough:
        return _TIME if node.port(kind.enough) == "1" else ""
    if kind.asks_first:
        return "as soon as the condition changes"
    return _WHEN.get(kind.goes_on, _TIME)


def _cut_off_warnings(exposed: Exposed, when: str, compilation: Compilation) -> list[Diagnostic]:
    leaf, place = exposed.leaf.span, exposed.place.span
    if leaf is None or place is None:
        return []
    notes = () if exposed.leaf is exposed.place else ((leaf, f"'{leaf.text}' is here"),)
    advice = "Move it out, before or after this node."
    if compilation.is_text:
        then = compilation.vocabulary.word("then")
        advice = f"Move it out, before or after the form, with '{then}'."
    return [diagnostic("BT054", place, notes, words=leaf.text, when=when, advice=advice)]
