"""Conjunctions: `and` between commands means at the same time for what can go together, else one after the other.

Both parsers make a chain of the operator "and". When all names and included missions are known, `resolve` makes each
of them a "parallel" or a "sequence"; only then do equal chains melt into one.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic, two_readings
from btlang.support.record import Record
from btlang.text.source import Span
from btlang.tree import ast
from btlang.tree.catalogue import SUBTREE, never_ends
from btlang.tree.visit import fold
from btlang.vocabulary.capabilities import MOVES, SPEAKS
from btlang.vocabulary.lexicon import Lexicon


class Traits(Record):
    """The traits of a command that matter to those beside it.

    `accompanies`: it can go along with others. `holds` are the resources that it needs for itself. `endless`: it runs
    until it fails or is stopped.
    """

    accompanies: bool
    holds: frozenset[str] = frozenset()
    endless: bool = False


_TASK = Traits(False)


def resolve(mission: ast.Program, vocabulary: Lexicon) -> tuple[ast.Program, list[Diagnostic]]:
    """Return the mission with a meaning for each `and`, and messages about them (BT050, BT174)."""
    if not _has_conjunction(mission):
        return mission, []
    definitions = {definition.name: definition.body for definition in ast.all_definitions(mission)}
    resolver = Conjunctions(definitions, vocabulary)
    return resolver.program(mission), resolver.problems


def _has_conjunction(mission: ast.Program) -> bool:
    return any(_is_conjunction(node) for body in ast.bodies(mission) for node in ast.parents_first(body))


def _is_conjunction(node: ast.Ast) -> bool:
    return type(node) is ast.Chain and node.operator == "and"


class Conjunctions:
    """The conjunctions of one mission, and of those that it includes. `problems` are messages about them."""

    def __init__(self, definitions: Mapping[str, ast.Ast], vocabulary: Lexicon) -> None:
        self.problems: list[Diagnostic] = []
        self._definitions = definitions
        self._vocabulary = vocabulary
        self._named: dict[str, Traits] = {}
        self._noted: dict[int, tuple[ast.Ast, Traits]] = {}  # with its node, which keeps the identity

    def program(self, mission: ast.Program) -> ast.Program:
        """Resolve a text with those that it includes."""
        return ast.with_bodies(mission, self._body, self.program)

    def _body(self, body: ast.Ast) -> ast.Ast:
        """Resolve a body. Statements without `and` stay as they are and aren't looked into."""
        if type(body) is not ast.Chain or body.operator != "sequence":
            return self._resolve(body)[0] if any(map(_is_conjunction, ast.parents_first(body))) else body
        items = [
            self._resolve(item)[0] if item.parts and any(map(_is_conjunction, ast.parents_first(item))) else item
            for item in body.items
        ]
        return _flatten(body.replace(items=tuple(items)))

    def _resolve(self, root: ast.Ast) -> tuple[ast.Ast, Traits]:
        return fold(root, ast.parts, self._one)

    def _one(self, node: ast.Ast, done: list[tuple[ast.Ast, Traits]]) -> tuple[ast.Ast, Traits]:
        if not node.parts:
            return node, self._leaf(node)
        if type(node) is ast.Chain:
            return self._chain(node, [each for each, _ in done], [traits for _, traits in done])
        condition = getattr(node, "condition", None)
        pairs = zip(ast.parts(node), done, strict=True)
        of_commands = [traits for part, (_, traits) in pairs if part is not condition]
        node = ast.with_parts(node, [each for each, _ in done])
        return node, self._form(node, of_commands)

    def _chain(self, chain: ast.Chain, items: Sequence[ast.Ast], traits: Sequence[Traits]) -> tuple[ast.Ast, Traits]:
        operator = chain.operator
        if operator == "and":
            operator = self._choose_meaning(chain, traits)
        made: ast.Ast = chain
        first = items[0]
        if operator == "sequence" and traits[-1].accompanies and len(items) == 2 and isinstance(first, ast.Chain):
            *before, lasting = first.items
            if first.operator == "sequence" and chain.operator == "and" and _is_within(lasting, items[1]):
                both = ast.Chain("parallel", (lasting, items[1]), True, chain.span)
                items = [*before, both]
        if operator != chain.operator or any(new is not old for new, old in zip(items, chain.items, strict=True)):
            made = _flatten(ast.Chain(operator, tuple(items), chain.bracketed, chain.span))
        endless = [each.endless for each in traits]
        never = any(endless) if operator == "sequence" else all(endless)
        return made, Traits(all(each.accompanies for each in traits), _union(traits), never)

    def _choose_meaning(self, chain: ast.Chain, traits: Sequence[Traits]) -> str:
        """Whether the parts run at the same time."""
        if any(each.endless for each in traits[:-1]):
            return "parallel"  # it lasts as long as what stands behind it
        if traits[-1].accompanies and _is_within(*chain.items[-2:]):
            return "parallel"
        if not all(each.accompanies for each in traits):
            if traits[-1].endless:
                self._report_endless(chain)
            return "sequence"
        shared = _find_shared(traits)
        if shared is not None:
            resource, first, second = shared
            self._report_shared(chain, resource, chain.items[first], chain.items[second])
            return "sequence"
        return "sequence" if _speaks_first(traits) else "parallel"

    def are_simultaneous(self, items: Iterable[ast.Ast]) -> bool:
        """Whether `and` between such commands means that they all run at the same time."""
        traits = [self._traits(item) for item in items]
        return all(each.accompanies for each in traits) and not (_find_shared(traits) or _speaks_first(traits))

    def _traits(self, root: ast.Ast) -> Traits:
        """Return the traits of a command in which each `and` has its meaning. They are kept, as every depth asks for
        them.
        """

        def parts(node: ast.Ast) -> Sequence[ast.Ast]:
            return () if id(node) in self._noted else ast.parts(node)

        def one(node: ast.Ast, done: list[tuple[ast.Ast, Traits]]) -> tuple[ast.Ast, Traits]:
            if id(node) not in self._noted:
                self._noted[id(node)] = node, self._one(node, done)[1]
            return self._noted[id(node)]

        return fold(root, parts, one)[1]

    def _report_shared(self, chain: ast.Chain, resource: str, first: ast.Ast, second: ast.Ast) -> None:
        """Report commands that could go along with each other, but need the same part of the robot (BT174)."""
        joint = self._vocabulary.word("and")
        self.problems.append(
            diagnostic(
                "BT174", chain.span, joint=joint, resource=resource, first=first.span.text, second=second.span.text,
                then=self._vocabulary.word("then"),
            )
        )  # fmt: skip

    def _report_endless(self, chain: ast.Chain) -> None:
        """Report a last part that never ends: it may be meant to go along with the ones before it (BT050)."""
        joint = next(_connectives(chain, self._vocabulary.word("and")), None)
        if joint is None:
            return
        text, span = chain.span.text, chain.span
        said = []
        for role in ("then", "meanwhile"):
            at = joint.start - span.start
            said.append(f"{text[:at].rstrip(' ,')} {self._vocabulary.word(role)}{text[at + len(joint.text) :]}")
        self.problems.append(two_readings(span, *said))

    def _leaf(self, node: ast.Ast) -> Traits:
        if isinstance(node, ast.Phrase):
            return self._of_id(node.entry.id)
        if isinstance(node, ast.Name):
            return self._name(node.name)
        if isinstance(node, ast.Exact):
            return self._name(dict(node.ports).get("ID", "")) if node.id == SUBTREE else self._of_id(node.id)
        return _TASK

    def _of_id(self, node_id: str) -> Traits:
        entries = self._vocabulary.entries.get(node_id, ())
        holds = frozenset(resource for entry in entries for resource in entry.resources)
        return Traits(any(entry.accompaniment for entry in entries), holds)

    def _name(self, name: str) -> Traits:
        """Return the traits of a defined name; one that reaches itself is a task."""
        if name not in self._named:
            self._named[name] = _TASK
            if name in self._definitions:
                problems, self.problems = self.problems, []  # they are reported where the name is defined
                self._named[name] = self._resolve(self._definitions[name])[1]
                self.problems = problems
        return self._named[name]

    def _form(self, node: ast.Ast, commands: Sequence[Traits]) -> Traits:
        """Return the traits of a form, which has the kind of its commands."""
        if isinstance(node, ast.Check | ast.WaitUntil) or not commands:
            return _TASK
        return Traits(all(each.accompanies for each in commands), _union(commands), _is_endless(node, commands))


def _is_endless(node: ast.Ast, commands: Sequence[Traits]) -> bool:
    """Whether a form never ends by itself, as `lower.py` has it for nodes."""
    last = commands[-1].endless
    if isinstance(node, ast.Repeat):
        return node.rounds == "-1" or last
    if isinstance(node, ast.Every):
        return node.rounds in ("", "-1")
    if isinstance(node, ast.Apart):
        return node.rounds == "-1" or last
    if isinstance(node, ast.Delay | ast.Provided | ast.ForEach | ast.Constrained | ast.Named):
        return last
    if isinstance(node, ast.Whenever):
        return True
    if isinstance(node, ast.Exact):
        return never_ends(node.id, node.ports, [each.endless for each in commands])
    return False


def _is_within(lasting: ast.Ast, later: ast.Ast) -> bool:
    """Whether a part is done while another one lasts: `follow Alice for 3 min, and after 2 min, say "One more"`."""
    while isinstance(lasting, ast.Constrained):
        lasting = lasting.body
    if not isinstance(lasting, ast.For | ast.UpTo | ast.Wait) or not isinstance(later, ast.Delay):
        return False
    return later.seconds[:1] != "{" != lasting.seconds[:1] and float(later.seconds) < float(lasting.seconds)


def _flatten(chain: ast.Chain) -> ast.Ast:
    """Return the chain with the items of equal chains in it that have no brackets."""
    items: list[ast.Ast] = []
    for item in chain.items:
        is_equal = type(item) is ast.Chain and item.operator == chain.operator and not item.bracketed
        items += item.items if is_equal else (item,)  # type: ignore[attr-defined]
    return chain.replace(items=tuple(items)) if len(items) != len(chain.items) else chain


def _union(traits: Iterable[Traits]) -> frozenset[str]:
    return frozenset().union(*(each.holds for each in traits))


def _find_shared(traits: Sequence[Traits]) -> tuple[str, int, int] | None:
    """Return a resource that two of them hold, and which two."""
    holders: dict[str, int] = {}
    for at, each in enumerate(traits):
        for resource in each.holds:
            if resource in holders:
                return resource, holders[resource], at
        holders.update(dict.fromkeys(each.holds, at))
    return None


def _speaks_first(traits: Sequence[Traits]) -> bool:
    """Whether the robot speaks before it moves: what it says may be a warning."""
    speech = next((at for at, each in enumerate(traits) if SPEAKS in each.holds), len(traits))
    return any(MOVES in each.holds for each in traits[speech + 1 :])


def _connectives(chain: ast.Chain, word: str) -> Iterator[Span]:
    """Find the words `and` between the parts, the last first."""
    items = sorted(chain.items, key=lambda item: item.span.start)
    for left, right in reversed(list(pairwise(items))):
        source = left.span.source
        gap = source.text[left.span.end : right.span.start]
        at = gap.lower().find(word)
        if at >= 0 and not gap.lower().replace(word, "", 1).strip(" ,\t()"):
            yield Span(source, left.span.end + at, left.span.end + at + len(word))
