"""Entries of blackboards: those that nothing sets (BT241), and constants that a tree can't read (BT233)."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.engine.instance import blackboard_key
from btlang.engine.script.assignments import CHANGES, TEXT, assignments
from btlang.engine.script.tokens import READS, SETS, ScriptError, find_script_names
from btlang.frontends.btcpp.spelling import AUTOREMAP, TRUE
from btlang.projects.ports import attribute_value, describe_type, place_of
from btlang.support.record import Record
from btlang.text.source import Span
from btlang.text.spelling import misspelt
from btlang.tree.catalogue import CATALOGUE, SCRIPT, SUBTREE, port_content
from btlang.tree.node import Node, PortModel, Tree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    PortsOf: TypeAlias = Callable[[Node], Mapping[str, PortModel]]

_ENUM = re.compile(r"[A-Z][A-Z0-9_]+")
_MOST_PLACES = 3
_ENUM_HELP = "If it is an enum, register it in C++, and check the folder with that source, too."
_ISOLATED = "Give it to the SubTree, or set it in this tree, which sees no other entries."


class EntryUse(Record):
    """An entry that a port or script of a node names: what it may do with it, and its type, "" if that isn't known.

    For a value that the node sets, the type is NUMBER or TEXT, and `constant` is that value if the node says it. It
    `makes` no entry if it is in a script that only changes what is there.
    """

    node: Node
    port: str
    key: str
    reads: bool = True
    sets: bool = True
    type: str = ""
    constant: str | None = None
    makes: bool = True

    @property
    def may_be_enum(self) -> bool:
        """Return whether a script reads what may be the name of an enum, such as RED."""
        may_be = self.key.isupper() and not self.sets and _ENUM.fullmatch(self.key) is not None
        return may_be and port_content(self.node.id, self.port) == SCRIPT


class TreeEntries(Record):
    """The entries that a tree names, in the order in which its nodes are made, and its SubTree nodes.

    `given` are those in ports of SubTree nodes: what becomes of them, their trees decide. `steps` are the uses, the
    values that are set and the SubTree nodes, in this order. If it `is_older`, it is of version 3, where outputs may
    name an entry without braces: `named`.
    """

    uses: tuple[EntryUse, ...]
    given: tuple[EntryUse, ...]
    subtrees: tuple[Node, ...]
    steps: tuple[EntryUse | Node, ...]
    named: frozenset[str]
    is_older: bool

    @property
    def shares(self) -> bool:
        """Return whether another tree sees its entries by their own names."""
        return any(node.port(AUTOREMAP) in TRUE for node in self.subtrees)


def entries_of(root: Node, ports_of: PortsOf, is_older: bool) -> TreeEntries:
    """Return what a tree says of its blackboard; a port of which nothing is known may read and set an entry."""
    uses: list[EntryUse] = []
    given: list[EntryUse] = []
    subtrees: list[Node] = []
    steps: list[EntryUse | Node] = []
    named: set[str] = set()
    for node in Tree(root).walk():
        done = len(uses)
        if node.id == SUBTREE:
            subtrees.append(node)
            steps.append(node)
        is_built_in = node.id in CATALOGUE
        ports: Mapping[str, PortModel] = {}
        if not is_built_in and (is_older or any("{" in text for _, text in node.ports)):
            ports = ports_of(node)
        for port, text in node.ports:
            may_hold = is_built_in or port[:1] == "_"
            if not (may_hold or is_older or "{" in text):
                continue
            holds = port_content(node.id, port) if may_hold else ""
            if holds == SCRIPT:
                uses += _script_uses(node, port, text)
                steps += _script_values(node, port, text)
            elif "{" in text:
                key = blackboard_key(port, text)
                if key is not None and key[:1] != "@":
                    (given if node.id == SUBTREE else uses).append(_port_use(node, port, key, _described(port, ports)))
            elif holds:
                uses.append(EntryUse(node, port, text, reads=False))
                steps += _set_value(node, port, text)
            elif is_older and not is_built_in and (port not in ports or ports[port].direction != "input"):
                named.add(text)
        steps += uses[done:]
    return TreeEntries(tuple(uses), tuple(given), tuple(subtrees), tuple(steps), frozenset(named), is_older)


def _script_uses(node: Node, port: str, code: str) -> list[EntryUse]:
    """Yield the uses of a script.

    Nothing of what is no script, which is reported elsewhere, or is in an entry itself.
    """
    try:
        uses = {} if blackboard_key(port, code) is not None else find_script_names(code)
    except ScriptError:
        return []
    made = {each.key for each in assignments(code) if each.sign == ":="}
    return [EntryUse(node, port, name, READS in how, SETS in how, makes=name in made)
            for name, how in uses.items() if name[:1] != "@"]  # fmt: skip


def _script_values(node: Node, port: str, code: str) -> Iterator[EntryUse]:
    for made in assignments(code) if blackboard_key(port, code) is None else ():
        if made.kind:
            yield EntryUse(node, port, made.key, made.sign in CHANGES, True, made.kind, made.constant)


def _set_value(node: Node, port: str, key: str) -> Iterator[EntryUse]:
    """Yield what is set beside the port that names an entry, if it is a constant: a text, whatever it looks like."""
    constant = node.port("value")
    if "{" not in constant:
        yield EntryUse(node, port, key, False, True, TEXT, constant)


def _described(port: str, ports: Mapping[str, PortModel]) -> PortModel | None:
    """Return what is said of a port, or of the one of which it is a misspelling."""
    if port in ports or not ports:
        return ports.get(port)
    near = misspelt(port, ports)
    return ports[near[0]] if near else None


def _port_use(node: Node, port: str, key: str, described: PortModel | None) -> EntryUse:
    kind = CATALOGUE.get(node.id)
    if kind is not None and port in kind.ports:
        known = kind.ports[port]
        return EntryUse(node, port, key, not known.holds, known.holds != "" or known.direction != "input", known.type)
    if described is None:
        return EntryUse(node, port, key)
    direction = described.direction
    return EntryUse(node, port, key, direction != "output", direction != "input", described.type)


class EntryFlow:
    """What each tree may read and set of the entries that it names, also through its SubTree nodes."""

    def __init__(self, entries: Mapping[str, TreeEntries]) -> None:
        self._entries = entries
        self.sets = self._closure(lambda each: {use.key for use in each.uses if use.sets} | each.named)
        self.reads = self._closure(lambda each: {use.key for use in each.uses if use.reads and not use.may_be_enum})

    def is_read(self, use: EntryUse) -> bool:
        """Return whether a use reads its entry; that of a SubTree node does if its tree reads the port."""
        return use.reads if use.node.id != SUBTREE else self._has(self.reads, use.node, use.port)

    def _closure(self, own: Callable[[TreeEntries], Iterable[str]]) -> dict[str, set[str]]:
        """Return the keys of each tree: its `own`, those of ports whose tree has them, and what remapping shares."""
        found = {name: set(own(each)) for name, each in self._entries.items()}
        users: dict[str, set[str]] = {}
        for name, each in self._entries.items():
            for node in each.subtrees:
                users.setdefault(node.port("ID"), set()).add(name)
        waiting = dict.fromkeys(self._entries)
        while waiting:
            name, _ = waiting.popitem()
            more = {use.key for use in self._entries[name].given if self._has(found, use.node, use.port)}
            for node in self._entries[name].subtrees:
                if node.port(AUTOREMAP) in TRUE:
                    more |= found.get(node.port("ID"), set())
            if not more <= found[name]:
                found[name] |= more
                waiting.update(dict.fromkeys(users.get(name, ())))
        return found

    @staticmethod
    def _has(found: Mapping[str, set[str]], node: Node, port: str) -> bool:
        tree = node.port("ID")
        return tree not in found or port in found[tree]  # nothing is known of a tree that isn't there


def unset_entries(entries: Mapping[str, TreeEntries], flow: EntryFlow) -> Iterator[Diagnostic]:
    """Report BT241 for what a tree with a blackboard of its own reads, if neither it nor a SubTree node sets that.

    A tree whose blackboard isn't its own, or that isn't used, may be given anything; there it is only reported if an
    entry with a similar name is set and not read.
    """
    users: dict[str, list[Node]] = {}
    for each in entries.values():
        for node in each.subtrees:
            users.setdefault(node.port("ID"), []).append(node)
    for name, each in entries.items():
        isolated = [node for node in users.get(name, ()) if node.port(AUTOREMAP) not in TRUE]
        yield from _unset(name, each, flow, isolated)


def _unset(name: str, entries: TreeEntries, flow: EntryFlow, users: Sequence[Node]) -> Iterator[Diagnostic]:
    done = set(flow.sets[name])
    in_vain = sorted(flow.sets[name] - flow.reads[name])
    for use in (*entries.uses, *entries.given):
        if use.key in done or use.may_be_enum or not flow.is_read(use):
            continue
        done.add(use.key)
        lacking = [node for node in users if all(port != use.key for port, _ in node.ports)]
        if lacking:
            notes = tuple((place_of(node), "this SubTree doesn't give it") for node in lacking[:_MOST_PLACES])
            yield _nothing_sets(use, _ISOLATED, notes)
        elif not users and (near := misspelt(use.key, in_vain)):
            yield _nothing_sets(use, f"Similar: {', '.join(near)}")


def unmade_entries(entries: Mapping[str, TreeEntries], flow: EntryFlow) -> Iterator[Diagnostic]:
    """Report BT241 for what scripts of BehaviorTree.CPP 4 set with `=`, as if it were there, and nothing makes.

    A program may make the entries of a main tree: there only for what nothing else in the tree names.
    """
    given: dict[str, set[str]] = {}
    for each in entries.values():
        for node in each.subtrees:
            given.setdefault(node.port("ID"), set()).update(port for port, _ in node.ports)
    for name, each in entries.items():
        around = given.get(name, set())
        if each.is_older or AUTOREMAP in around:
            continue
        uses = [*each.uses, *each.given]
        made = {use.key for use in uses if use.makes} | around
        for inner in (node.port("ID") for node in each.subtrees if node.port(AUTOREMAP) in TRUE):
            made |= flow.sets.get(inner, set()) | flow.reads.get(inner, set())
        for use in uses:
            if use.key in made or not use.sets or use.reads:
                continue
            made.add(use.key)
            if around or all(other.key != use.key or other is use for other in uses):
                yield _nothing_sets(use, f"`=` only changes an entry. To make it: {use.key} := ...")


def unset_enums(entries: Mapping[str, TreeEntries], enums: Collection[str], are_all: bool) -> Iterator[Diagnostic]:
    """Report BT241 for names such as RED in scripts, unless an entry has that name or it is one of `enums`.

    If these may not be all, only for misspelt ones.
    """
    known = {
        *enums,
        *(use.key for each in entries.values() for use in (*each.uses, *each.given) if not use.may_be_enum),
    }
    for each in entries.values():
        known.update(each.named, (port for node in each.subtrees for port, _ in node.ports))
    for use in (use for each in entries.values() for use in each.uses):
        if use.may_be_enum and use.key not in known:
            near = misspelt(use.key, enums)
            if near or are_all:
                yield _nothing_sets(use, f"Similar: {', '.join(near)}" if near else _ENUM_HELP)


def _nothing_sets(use: EntryUse, help: str, notes: tuple[tuple[Span, str], ...] = ()) -> Diagnostic:
    place, id = attribute_value(use.node, use.port), _named(use.node)
    return diagnostic("BT241", place, notes, None, key=use.key, port=use.port, id=id, help=help)


def _named(node: Node) -> str:
    return attribute_value(node, "ID").text if node.id == SUBTREE else node.id


def wrong_constants(entries: Mapping[str, TreeEntries], flow: EntryFlow) -> Iterator[Diagnostic]:
    """Report BT233 for constants of SubTree nodes that a port in their tree can't read. Version 3 has none."""
    for each in entries.values():
        for node in each.subtrees if not each.is_older else ():
            for port, text in node.ports:
                if port == "ID" or port[:1] == "_" or "{" in text or not text.strip():
                    continue
                for use in _readers(entries, flow, node.port("ID"), port):
                    if wanted := describe_type(text.strip(), use.type):
                        notes = ((attribute_value(use.node, use.port), "here it is read"),)
                        place = attribute_value(node, port)
                        yield diagnostic(
                            "BT233", place, notes, None, text=text, port=port, id=_named(node), wanted=wanted
                        )
                        break


def _readers(entries: Mapping[str, TreeEntries], flow: EntryFlow, tree: str, key: str) -> Iterator[EntryUse]:
    """Yield the ports that read an entry of a tree, which nothing sets there, also in the trees that it gives it to."""
    waiting, done = [(tree, key)], set[tuple[str, str]]()
    while waiting:
        place = waiting.pop()
        tree, key = place
        if place in done or tree not in entries or key in flow.sets[tree]:
            continue
        done.add(place)
        yield from (use for use in entries[tree].uses if use.key == key)
        waiting += [(use.node.port("ID"), use.port) for use in entries[tree].given if use.key == key]
