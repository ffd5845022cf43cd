"""Candidates: what a node may be said as, and the check that lowering it gives just that node back.

Also the candidates of nodes that set, compare and measure values of the mission.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping

from btlang.backends.english.code import read_comparison, read_given
from btlang.backends.english.type_inference import KnownTypes, readable
from btlang.passes.lower import lower_one
from btlang.passes.scope import Lowered, LoweringScope
from btlang.support.record import Record
from btlang.text.source import NOWHERE
from btlang.tree import ast
from btlang.tree.node import Node
from btlang.vocabulary.entry import MEASURED, Entry
from btlang.vocabulary.pattern import Form, Slot, forms
from btlang.vocabulary.references import choice_by, keys_in, plain
from btlang.vocabulary.value_type import WORLD

REFERENCE = re.compile(r"\{[^{}]+\}")


class Candidate(Record):
    """A way to say a node: `command` in one statement, `body` as all that stands in a block, where rules have their
    place.

    `condition` says it as a condition, None where it cannot be one; `is_condition` where it is meant as one. `held` is
    the condition that has to hold for some time, for forms that wait.
    With `in_lines` what is said needs lines of its own (see btlang/printer/mission.py), so that only forms with blocks
    can hold it.
    """

    node: Node
    command: ast.Ast
    body: ast.Ast
    condition: ast.Ast | None = None
    is_condition: bool = False
    in_lines: bool = False
    children: tuple[Candidate, ...] = ()
    held: ast.Ast | None = None

    @property
    def awaited(self) -> ast.Ast | None:
        """What it is said as behind words that wait for a condition."""
        return self.condition if self.condition is not None else self.held

    @property
    def part(self) -> ast.Ast:
        """What it is said as in a form that has blocks."""
        return self.body if self.in_lines else self.command


class Checked:
    """The nodes that each piece of syntax is lowered to, for the nodes that were lifted so far.

    `around` is what is known where the node stands that is being raised, `texts` what is computed for it. The scope
    makes the keys that reading makes, as nodes are raised in the order in which they are read.
    """

    def __init__(self, scope: LoweringScope, around: KnownTypes) -> None:
        self.scope = scope
        self.around = around
        self.texts: Mapping[str, str] = {}
        self._lowered: dict[int, tuple[ast.Ast, Lowered]] = {}  # with its syntax, so that no other one gets its id

    def lowered(self, item: ast.Ast) -> Lowered:
        """Lower a piece of syntax. Only few forms around known pieces are lowered."""
        if id(item) in self._lowered:
            return self._lowered[id(item)][1]
        return lower_one(item, [self.lowered(part) for part in ast.parts(item)], self.scope)

    def says(self, item: ast.Ast, node: Node) -> bool:
        """Whether a piece of syntax means just this node, which is then noted."""
        made = self.scope.made
        lowered = self.lowered(item)
        if not _same(lowered.node, node):
            self.scope.made = made
            return False
        self.assume(item, lowered.replace(node=node))
        return True

    def assume(self, item: ast.Ast, lowered: Lowered) -> None:
        """Take a piece of syntax for what it may not mean."""
        self._lowered[id(item)] = item, lowered

    def text(self, port: str) -> str | None:
        """Return the English of a port text, with values of the mission in braces; None if one has no name."""
        text = self.texts.get(port[1:-1]) if port[:1] == "{" else None
        if text is None:
            text = port if REFERENCE.fullmatch(port) else plain(port)
        return text if all(key in self.around.kinds for key in keys_in(text)) else None

    def can_skip(self, item: ast.Ast) -> bool:
        """Whether it can end SKIPPED, as lowering sees it."""
        return self.lowered(item).can_skip


def _same(made: Node, wanted: Node) -> bool:
    """Whether two nodes are equal up to the order of ports. Parts that are the same object aren't looked into."""
    pairs = [(made, wanted)]
    while pairs:
        one, other = pairs.pop()
        if one is other:
            continue
        if one.id != other.id or one.name != other.name or len(one.children) != len(other.children):
            return False
        if one.ports != other.ports and sorted(one.ports) != sorted(other.ports):
            return False
        pairs += zip(one.children, other.children, strict=True)
    return True


def propose_assignments(node: Node, checked: Checked) -> Iterator[ast.Ast]:
    """Propose `set`, `increase` and `decrease` for a Script."""
    given = read_given(node.port("code"), checked.texts)
    is_set = given is not None and given.operation == "set" and given.key not in checked.around.outside
    if given is not None and (is_set or given.operation in ("increase", "decrease")):
        kind = checked.around.kinds.get(given.key)
        if kind is not None and can_say(given.text, kind, checked):
            yield ast.Assign(given.key, given.operation, kind, given.text, NOWHERE)


def propose_choices(node: Node, checked: Checked) -> Iterator[ast.Ast]:
    """Propose a name that is chosen for a key of the mission's own."""
    key, kind = node.port("output")[1:-1], node.port("type")
    if key in checked.around.kinds and key not in checked.around.outside and kind in WORLD:
        choice = choice_by(dict(node.ports)).replace(key=checked.around.vocabulary.context.keys[kind])
        yield ast.Assign(key, "set", kind, choice.text, NOWHERE)


def propose_comparisons(node: Node, checked: Checked) -> Iterator[ast.Ast]:
    """Propose a comparison for a ScriptCondition."""
    found = read_comparison(node.port("code"), checked.texts)
    kind = checked.around.kinds.get(found.key) if found is not None else None
    if found is None or kind is None or not all(can_say(text, kind, checked) for _, text in found.arguments):
        return
    ways = checked.around.vocabulary.comparing_forms(kind)
    if _first(ways, found.arguments) == [way for way, _ in found.arguments]:
        yield ast.Compared(found.key, kind, found.arguments, NOWHERE)


def propose_measurements(node: Node, entries: Iterable[Entry], checked: Checked) -> Iterator[ast.Ast]:
    """Propose a quantity that is measured for a key."""
    key = node.port(MEASURED)[1:-1]
    if key not in checked.around.kinds or key in checked.around.outside or node.port(MEASURED) != f"{{{key}}}":
        return
    arguments = texts_of([port for port in node.ports if port[0] != MEASURED], checked)
    for entry in entries:
        ways = (form for pattern in entry.quantity for form in reversed(forms(pattern)))
        types = {slot.name: slot.type for slot in entry.slots}
        if arguments is not None and entry.measures and _first(ways, arguments) is not None:
            if all(can_say(text, types[name], checked) for name, text in arguments):
                yield ast.Remember(key, entry, arguments, NOWHERE)


def texts_of(ports: Iterable[tuple[str, str]], checked: Checked) -> tuple[tuple[str, str], ...] | None:
    """Return ports as arguments of syntax, None if one can't be said."""
    found = [(name, checked.text(text)) for name, text in ports]
    said = tuple((name, text) for name, text in found if text is not None)
    return said if len(said) == len(found) else None


def can_say(text: str, kind: str, checked: Checked) -> bool:
    """Whether a port text is read back as a value of a type."""
    around = checked.around
    return all(key in around.kinds for key in keys_in(text)) and readable(text, kind, around.vocabulary)


def _first(ways: Iterable[Form], arguments: tuple[tuple[str, str], ...]) -> list[str] | None:
    """Return the slots of the first form that has just these."""
    names = {name for name, _ in arguments}
    for form in ways:
        slots = [part.name for part in form if isinstance(part, Slot)]
        if set(slots) == names:
            return slots
    return None
