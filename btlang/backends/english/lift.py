"""Lifting: a tree becomes an AST, each node in the most natural form that means just it, and by its id if none does."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from btlang.backends.english.candidate import (
    Candidate,
    Checked,
    can_say,
    propose_assignments,
    propose_choices,
    propose_comparisons,
    propose_measurements,
    texts_of,
)
from btlang.backends.english.code import Computed, Loop, read_computed
from btlang.backends.english.comments import Comments
from btlang.backends.english.inverse_rules import INVERSE_RULES, propose_held
from btlang.backends.english.names import SpokenNames
from btlang.backends.english.type_inference import KnownTypes
from btlang.passes.scope import Lowered, LoweringScope
from btlang.printer.exact import is_one_piece, order_ports
from btlang.printer.phrase import leaf_words
from btlang.printer.printer import Printer
from btlang.printer.sentence import PRINTERS
from btlang.support.record import Record
from btlang.text.source import NOWHERE, Source
from btlang.text.words import split
from btlang.tree import ast
from btlang.tree.catalogue import CATALOGUE, SUBTREE
from btlang.tree.node import Node, Tree
from btlang.tree.visit import fold
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.trie import longest

_MOST_WORDS = 160  # characters of a phrase besides its longest value: it can't go on in another line, as ports can
_ASKING = frozenset((
    "Sequence", "Fallback", "ReactiveSequence", "ReactiveFallback", "IfThenElse", "WhileDoElse", "Whenever", "Inverter",
))  # fmt: skip
"""Nodes whose first child is a condition as a rule."""
_NAMED_EXACTLY = frozenset(("Sequence", "Fallback", "Whenever", "KeepRunningUntilFailure"))
"""Nodes whose names stand before what says them by their ids."""
_QUESTION = re.compile(
    r"(?:[Ii]s|[Hh]as|[Cc]an|[Aa]re|[Ww]as|[Ww]ere|[Dd]oes|[Dd]id|[Ss]hould|[Ww]ould|[Cc]heck)(?=[A-Z0-9_ ])"
)


class _TreePlace(Record):
    """A node, and what is known at its place."""

    node: Node
    around: KnownTypes


class Lifter:
    """A lifter of the nodes of one tree to English. `known` are its names and loops.

    With `natural` False every node is said by its id. `comments` are those of the file that
    the tree was read from, `refused` the bodies of loops that turned out to be none.
    """

    def __init__(
        self, tree: Tree, vocabulary: Lexicon, known: SpokenNames, comments: Comments, *, natural: bool
    ) -> None:
        self._vocabulary = vocabulary
        self._natural = natural
        self._known = known
        self.refused: set[str] = set()
        bodies = {loop.name for loop in known.loops.values()}
        names = [name for name, _ in tree.subtrees if name not in bodies]
        heads = [ast.Definition(name, known.parameters(name), ast.Nothing(NOWHERE), NOWHERE, NOWHERE,
                                name not in known.names) for name in names]  # fmt: skip
        self.printer = Printer(PRINTERS, vocabulary, heads, "clear", known.around("").outside)
        self._node_kinds = {model.id: model.kind for model in tree.models}
        for node_id in _find_asked(tree):
            if vocabulary.entry(node_id) is None:
                self._node_kinds.setdefault(node_id, "Condition")
        self._outputs = _outputs(tree)
        self._comments = comments
        self._conditions: set[str] = set()  # the names that stand for conditions
        self._loops: dict[str, Candidate] = {}
        self._leaves: dict[tuple[str, tuple[tuple[str, str], ...], Lexicon], str] = {}
        self._checked = Checked(LoweringScope(names, vocabulary.types), known.around(""))

    def definition(self, name: str, root: Node) -> ast.Definition:
        """Lift a named subtree; those that it uses have been lifted before."""
        lift = self.lift(root, name)
        is_natural = name in self._known.names
        body = lift.body
        if is_natural and lift.is_condition and lift.condition is not None:
            body = lift.condition
            self._conditions.add(name)
        made = ast.Definition(name, self._known.parameters(name), body, NOWHERE, NOWHERE, not is_natural)
        self.printer.note(made, self._comments.trees.get(name, ()))
        if is_natural:
            lowered = self._checked.lowered(body)
            self._checked.scope.define(made, lowered.can_skip, lowered.endless)
        return made

    def main(self, root: Node) -> ast.Ast:
        """Lift the commands of the mission; the subtrees have been lifted before."""
        body = self.lift(root).body
        self.printer.note(_first_line(body), self._comments.trees.get("", ()))
        return body

    def lift(self, root: Node, name: str = "") -> Candidate:
        """Lift a tree; `name` is that of a subtree."""
        return fold(_TreePlace(root, self._known.around(name)), self._parts, self._raise)

    def _parts(self, place: _TreePlace) -> list[_TreePlace]:
        """Return the places below one. The body of a loop stands where the loop does."""
        loop = self._known.loops.get(id(place.node))
        if loop is not None:
            return [_TreePlace(loop.body, self._known.inside(place.around, loop))]
        return [_TreePlace(child, place.around) for child in place.node.children]

    def _raise(self, place: _TreePlace, children: list[Candidate]) -> Candidate:
        node, parts = place.node, tuple(children)
        self._checked.around = place.around
        loop = self._known.loops.get(id(node))
        if loop is not None:
            return self._loop(node, loop, parts[0])
        ways = [(Computed(node, {}), parts)]
        made = read_computed(node) if self._natural and not node.name else None
        if made is not None:
            ways.insert(0, (made, parts[-1].children))
        condition = self._condition(node, ways)
        held = self._held(node, ways) if condition is None else None
        exact = self._exact(node, parts, condition)
        is_condition = condition is not None and self._is_condition(made.node if made is not None else node, parts)
        natural, inner = self._natural_form(node, ways, condition if is_condition else None)
        is_condition = is_condition and not isinstance(natural, ast.Remember)
        is_statement = natural is not None and (node.id == "Whenever" or isinstance(natural, ast.Named))
        in_lines = any(part.in_lines for part in inner) or is_statement or (natural is None and bool(parts))
        self._note([node] if inner is parts else [node, *node.children], natural or exact, condition)
        if natural is None:
            return Candidate(node, exact, exact, condition, is_condition, in_lines, parts, held)
        is_chain = isinstance(natural, ast.Chain) and natural.operator == "sequence"
        command = exact if in_lines and is_chain else natural  # no line can hold lines that are a sequence
        return Candidate(node, command, natural, condition, is_condition, in_lines, parts, held)

    def _note(self, nodes: Iterable[Node], said: ast.Ast, condition: ast.Ast | None = None) -> None:
        """Keep the comments of nodes that are said as one; those of a sequence stand before its first line."""
        lines = tuple(line for node in nodes for line in self._comments.nodes.get(id(node), ()))
        if not lines:
            return
        if condition is not None:
            self.printer.note(condition, lines)
        if not isinstance(said, ast.Check):
            self.printer.note(_first_line(said), lines)

    def _exact(self, node: Node, children: tuple[Candidate, ...], condition: ast.Ast | None) -> ast.Ast:
        """Say a node by its id. A condition is said as one: without a keyword entry, only its words show its kind."""
        if isinstance(condition, ast.Exact) and self._kind(node.id) == "Condition":
            made: ast.Ast = ast.Check(condition, NOWHERE)
        else:
            items = tuple(child.command for child in children)
            ports = order_ports(node.ports, self._vocabulary)
            made = ast.Exact(node.id, ports, node.name, items, False, NOWHERE, self._find_given(node, ports))
        assert self._checked.says(made, node)
        return made

    def _loop(self, node: Node, loop: Loop, body: Candidate) -> Candidate:
        """Lift a loop. One that doesn't mean the node is refused; then all is said again. One may stand twice
        (ast.Apart).
        """
        if loop.name in self._loops:
            return self._loops[loop.name]
        kind = self._known.kind(loop.name, loop.key)
        values: list[str] = []
        for one in loop.rounds:
            self._checked.texts = one.texts
            text = self._checked.text(one.node.port(loop.key))
            if text is not None and kind is not None and can_say(text, kind, self._checked):
                values.append(text)
        made: ast.Ast = ast.ForEach(loop.key, kind or "", tuple(values), body.part, NOWHERE)
        if len(values) < len(loop.rounds) or not self._checked.says(made, node):
            self.refused.add(loop.name)
            made = ast.Nothing(NOWHERE)
            self._checked.assume(made, Lowered(node))
            return Candidate(node, made, made)
        self.printer.note(_first_line(body.part), self._comments.trees.get(loop.name, ()))
        self._note([node, *node.children], made)
        self._loops[loop.name] = Candidate(node, made, made, in_lines=body.in_lines)
        return self._loops[loop.name]

    def _natural_form(
        self, node: Node, ways: list[tuple[Computed, tuple[Candidate, ...]]], condition: ast.Ast | None
    ) -> tuple[ast.Ast | None, tuple[Candidate, ...]]:
        """Return the form and the parts that are said in it; None if no form means just this node."""
        children = ways[-1][1]
        if not self._natural:
            return None, children
        for way, inner in ways:
            self._checked.texts = way.texts
            for made in self._forms(way.node, inner, condition):
                if self._checked.says(made, node):
                    return made, inner
        return None, children

    def _forms(self, node: Node, children: tuple[Candidate, ...], condition: ast.Ast | None) -> Iterator[ast.Ast]:
        """Propose the commands that may say a node, the most natural first. Only a phrase takes a name itself."""
        if node.name and (children or node.id not in self._vocabulary.entries):
            yield from self._named(node, children, condition)
            return
        form = INVERSE_RULES.get(node.id)
        if form is not None:
            yield from form(node, children, self._checked)
        if children and not isinstance(condition, ast.Not | ast.AtLeast):
            return
        if node.id == "Script":
            yield from propose_assignments(node, self._checked)
        if node.id == "Choose":
            yield from propose_choices(node, self._checked)
        yield from propose_measurements(node, self._vocabulary.entries.get(node.id, ()), self._checked)
        if condition is not None:
            if not isinstance(condition, ast.Exact):
                yield ast.Check(condition, NOWHERE)
        elif node.id == SUBTREE:
            yield from self._name(node)
        elif not children:
            yield from self._phrase(node, "action")

    def _named(self, node: Node, children: tuple[Candidate, ...], condition: ast.Ast | None) -> Iterator[ast.Ast]:
        """Propose forms behind the name of a node, unless it has one of its own that takes the name."""
        if is_one_piece(node.name) and node.id not in _NAMED_EXACTLY:
            for made in self._forms(node.replace(name=""), children, condition):
                yield ast.Named(node.name, made, NOWHERE)

    def _condition(self, node: Node, ways: list[tuple[Computed, tuple[Candidate, ...]]]) -> ast.Ast | None:
        if self._natural and not (node.name and node.children):
            for way, inner in ways:
                self._checked.texts = way.texts
                for made in self._condition_forms(way.node, inner):
                    if self._checked.says(made, node):
                        return made
        return self._exact_condition(node) if not node.children else None

    def _held(self, node: Node, ways: list[tuple[Computed, tuple[Candidate, ...]]]) -> ast.Ast | None:
        for way, inner in ways if self._natural and not node.name else ():
            self._checked.texts = way.texts
            for made in propose_held(way.node, inner, self._checked):
                if self._checked.says(made, node):
                    return made
        return None

    def _condition_forms(self, node: Node, children: tuple[Candidate, ...]) -> Iterator[ast.Ast]:
        inner = [child.condition for child in children if child.condition is not None]
        if len(inner) < len(children):
            return
        if node.id == "Inverter" and len(inner) == 1:
            yield ast.Not(inner[0], NOWHERE)
        elif node.id in ("Sequence", "Fallback") and len(inner) > 1:
            yield ast.Chain("all" if node.id == "Sequence" else "any", tuple(inner), True, NOWHERE)
        elif node.id == "Parallel" and len(inner) > 1:
            number = node.port("success_count")
            if number.isdecimal() and 1 <= int(number) <= len(inner):
                yield ast.AtLeast(int(number), tuple(inner), NOWHERE)
        elif node.id == "ScriptCondition":
            yield from propose_comparisons(node, self._checked)
        elif node.port("ID") in self._conditions:
            yield from self._name(node)
        elif not children:
            yield from self._phrase(node, "condition")

    def _exact_condition(self, node: Node) -> ast.Ast | None:
        """Return a condition, None for a node that isn't known to be one: read again it would be one everywhere."""
        if self._kind(node.id) != "Condition" and not _asks(node):
            return None
        ports = order_ports(node.ports, self._vocabulary)
        made = ast.Exact(node.id, ports, node.name, (), True, NOWHERE, self._find_given(node, ports))
        assert self._checked.says(made, node)
        return made

    def _find_given(self, node: Node, ports: tuple[tuple[str, str], ...]) -> tuple[str, ...]:
        """Return the ports of a leaf, of these, that its model says it gives values to."""
        outputs = self._outputs.get(node.id, ()) if not node.children else ()
        return tuple(name for name, _ in ports if name in outputs)

    def _is_condition(self, node: Node, children: tuple[Candidate, ...]) -> bool:
        if node.children:
            return all(child.is_condition for child in children)
        if node.id == SUBTREE:
            return True
        return self._kind(node.id) == "Condition" or _asks(node)

    def _kind(self, node_id: str) -> str:
        """Return the kind of a node by the tree or a keyword entry, "" for one of the language itself."""
        if node_id in self._vocabulary.nodes:
            return ""
        entry = self._vocabulary.entry(node_id)
        return self._node_kinds.get(node_id) or (entry.sort.title() if entry is not None else "")

    def _name(self, node: Node) -> Iterator[ast.Ast]:
        """Propose a defined name. What else its ports hold are values that it needs."""
        name = node.port("ID")
        kinds = dict(self._known.parameters(name))
        ports = dict(node.ports)
        if name in self._known.names and kinds.keys() <= ports.keys():
            said = texts_of([(key, ports[key]) for key in kinds], self._checked)
            if said is not None and all(can_say(text, kinds[key], self._checked) for key, text in said):
                yield ast.Name(name, said, NOWHERE)

    def _phrase(self, node: Node, sort: str) -> Iterator[ast.Ast]:
        """Propose the phrases that are read back as this leaf."""
        for entry in self._vocabulary.entries.get(node.id, ()):
            defaults = {slot.name: slot.default for slot in entry.slots}
            spoken = [port for port in node.ports if port[0] in defaults and defaults[port[0]] != port[1]]
            ports = order_ports((port for port in node.ports if port not in spoken), self._vocabulary)
            said = texts_of(spoken, self._checked) if entry.sort == sort else None
            words = self._words(node.id, said) if said is not None else ""
            if len(words) - max((len(text) for _, text in said or ()), default=0) > _MOST_WORDS:
                continue
            if words and (not (node.name or ports) or self._ends(words)):
                yield ast.Phrase(entry, said or (), NOWHERE, node.name, ports, self._find_given(node, ports))

    def _words(self, node_id: str, texts: tuple[tuple[str, str], ...]) -> str:
        vocabulary = self._checked.around.vocabulary
        key = node_id, texts, vocabulary
        if key not in self._leaves:
            self._leaves[key] = leaf_words(node_id, dict(texts), vocabulary, self.printer.names, exactly=True)
        return self._leaves[key]

    def _ends(self, words: str) -> bool:
        """Whether a phrase ends where `called` or `with` stands behind it."""
        vocabulary = self._checked.around.vocabulary
        last = len(split(Source(words), vocabulary.orthography).words) - 2
        for role in ("called", "with", "giving"):
            text = split(Source(f"{words} {vocabulary.word(role)}"), vocabulary.orthography)
            for trie in (vocabulary.trie, self.printer.names):
                match = longest(trie, text, 0, vocabulary.context) if trie else None
                if match is not None and match.last > last:
                    return False
        return True


def _first_line(said: ast.Ast) -> ast.Ast:
    """Return the statement that stands first if all of it are lines."""
    is_chain = isinstance(said, ast.Chain) and said.operator == "sequence"
    return ast.parts(said)[0] if is_chain else said


def _find_asked(tree: Tree) -> Iterator[str]:
    """Yield the leaves that stand where a condition does and have the name of one: `IsDoorOpen`."""
    for node in tree.walk():
        if node.id not in _ASKING:
            continue
        guards = node.children[: max(len(node.children) - 1, 1) if CATALOGUE[node.id].goes_on else 1]
        for child in guards:
            if not child.children and child.id not in CATALOGUE and _QUESTION.match(child.id):
                yield child.id


def _outputs(tree: Tree) -> dict[str, set[str]]:
    found: dict[str, set[str]] = {}
    for model in tree.models:
        found.setdefault(model.id, set()).update(port.name for port in model.ports if port.direction == "output")
    return found


def _asks(node: Node) -> bool:
    kind = CATALOGUE.get(node.id)
    return kind is not None and kind.kind == "Condition"
