"""Tree to AST: each node in the most natural form that means just it, and by its id where there is none."""

from __future__ import annotations

from collections.abc import Iterable

from btlang.backends.english.comments import comments_of
from btlang.backends.english.forms import FORMS
from btlang.backends.english.raised import NOWHERE, Checked, Raised
from btlang.english.phrase import leaf_words
from btlang.english.speaker import Speaker
from btlang.passes.scope import Scope
from btlang.tree import ast
from btlang.tree.node import Node, Tree
from btlang.tree.visit import fold
from btlang.vocabulary.entry import Entry
from btlang.vocabulary.vocabulary import Vocabulary

_CONDITIONS = frozenset(("ScriptCondition", "WasEntryUpdated"))


class Raiser:
    """Raises the nodes of one tree, with `names` for those of its subtrees that are said as phrases.

    With `natural` False every node is said by its id.
    """

    def __init__(self, tree: Tree, vocabulary: Vocabulary, names: Iterable[str], *, natural: bool) -> None:
        self._vocabulary = vocabulary
        self._natural = natural
        self.names = frozenset(names)
        self.speaker = Speaker(vocabulary, sorted(self.names))
        self._kinds = {model.id: model.kind for model in tree.models}
        self._comments = comments_of(tree)
        self._conditions: set[str] = set()  # the names that stand for conditions
        self._checked = Checked(Scope((name for name, _ in tree.subtrees), vocabulary.types))

    def definition(self, name: str, root: Node) -> ast.Definition:
        """A named subtree; those that it uses have been raised before."""
        raised = self.raised(root)
        is_natural = name in self.names
        body = raised.body
        if is_natural and raised.is_condition and raised.condition is not None:
            body = raised.condition
            self._conditions.add(name)
        made = ast.Definition(name, (), body, NOWHERE, NOWHERE, not is_natural)
        self.speaker.note(made, self._comments.trees.get(name, ()))
        if is_natural:
            self._checked.scope.define(made, self._checked.can_skip(body))
        return made

    def main(self, root: Node) -> ast.Ast:
        """The commands of the mission; the subtrees have been raised before."""
        body = self.raised(root).body
        self.speaker.note(_first_line(body), self._comments.trees.get("", ()))
        return body

    def raised(self, root: Node) -> Raised:
        """What a tree is said as."""
        return fold(root, lambda node: node.children, self._raise)

    def _raise(self, node: Node, children: list[Raised]) -> Raised:
        parts = tuple(children)
        exact = self._exact(node, parts)
        condition = self._condition(node, parts)
        is_condition = condition is not None and self._is_condition(node, parts)
        natural = self._natural_form(node, parts, condition if is_condition else None)
        is_rule = natural is not None and node.id == "Whenever"
        in_lines = any(part.in_lines for part in parts) or is_rule or (natural is None and bool(parts))
        self._note(node, natural or exact, condition)
        if natural is None:
            return Raised(node, exact, exact, condition, is_condition, in_lines, parts)
        is_chain = isinstance(natural, ast.Chain) and natural.operator == "sequence"
        command = exact if in_lines and is_chain else natural  # no line can hold lines that are a sequence
        return Raised(node, command, natural, condition, is_condition, in_lines, parts)

    def _note(self, node: Node, said: ast.Ast, condition: ast.Ast | None) -> None:
        """The comments of a node; those of a sequence stand before its first line."""
        lines = self._comments.nodes.get(id(node), ())
        if not lines:
            return
        if condition is not None:
            self.speaker.note(condition, lines)
        if not isinstance(said, ast.Check):
            self.speaker.note(_first_line(said), lines)

    def _exact(self, node: Node, children: tuple[Raised, ...]) -> ast.Ast:
        items = tuple(child.command for child in children)
        made = ast.Exact(node.id, node.ports, node.name, items, False, NOWHERE)
        assert self._checked.says(made, node)
        return made

    def _natural_form(self, node: Node, children: tuple[Raised, ...], condition: ast.Ast | None) -> ast.Ast | None:
        """None where no form means just this node."""
        if not self._natural or node.name:
            return None
        if children or node.id in FORMS:
            forms = FORMS.get(node.id)
            for made in forms(node, children, self._checked) if forms is not None else ():
                if self._checked.says(made, node):
                    return made
        said: ast.Ast | None
        if isinstance(condition, ast.Not) or (condition is not None and not children):
            said = ast.Check(condition, NOWHERE) if not isinstance(condition, ast.Exact) else None
        elif node.id == "SubTree":
            said = self._name(node)
        else:
            said = self._phrase(node, "action")
        return said if said is not None and self._checked.says(said, node) else None

    def _condition(self, node: Node, children: tuple[Raised, ...]) -> ast.Ast | None:
        made: ast.Ast | None = None
        if self._natural and not node.name:
            inner = [child.condition for child in children if child.condition is not None]
            if len(inner) == len(children):
                if node.id == "Inverter" and len(inner) == 1:
                    made = ast.Not(inner[0], NOWHERE)
                elif node.id in ("Sequence", "Fallback") and len(inner) > 1:
                    operator = "all" if node.id == "Sequence" else "any"
                    made = ast.Chain(operator, tuple(inner), True, NOWHERE)
            if made is None and not children:
                made = self._name(node) if node.port("ID") in self._conditions else self._phrase(node, "condition")
        if made is None or not self._checked.says(made, node):
            made = self._exact_condition(node) if not children else None
        return made

    def _exact_condition(self, node: Node) -> ast.Ast | None:
        """None for what is no condition: an action would be asked, and a subtree done."""
        entry = self._vocabulary.entry(node.id)
        known = self._kinds.get(node.id) or (entry.sort.title() if entry is not None else "")
        if known not in ("", "Condition") or node.id == "SubTree" or node.id in FORMS:
            return None
        if not known and node.id in self._vocabulary.nodes and node.id not in _CONDITIONS:
            return None
        made = ast.Exact(node.id, node.ports, node.name, (), True, NOWHERE)
        assert self._checked.says(made, node)
        return made

    def _is_condition(self, node: Node, children: tuple[Raised, ...]) -> bool:
        if children:
            return all(child.is_condition for child in children)
        if node.id == "SubTree":
            return True
        entry = self._vocabulary.entry(node.id)
        is_known = self._kinds.get(node.id) == "Condition" or (entry is not None and entry.sort == "condition")
        return is_known or node.id in _CONDITIONS

    def _name(self, node: Node) -> ast.Ast | None:
        return ast.Name(node.port("ID"), (), NOWHERE) if node.port("ID") in self.names else None

    def _phrase(self, node: Node, sort: str) -> ast.Ast | None:
        """None where no phrase is read back as this leaf. A text in braces is left to the exact form."""
        if any("{" in text or "}" in text for _, text in node.ports):
            return None
        for entry in self._vocabulary.entries.get(node.id, ()):
            if entry.sort == sort and self._words(node, entry):
                return ast.Phrase(entry, node.ports, NOWHERE)
        return None

    def _words(self, node: Node, entry: Entry) -> str:
        slots = {slot.name for slot in entry.slots}
        if not all(name in slots for name, _ in node.ports):
            return ""
        return leaf_words(node.id, dict(node.ports), self._vocabulary, self.speaker.names, exactly=True)


def _first_line(said: ast.Ast) -> ast.Ast:
    """The statement that stands first where all of it are lines."""
    is_chain = isinstance(said, ast.Chain) and said.operator == "sequence"
    return ast.parts(said)[0] if is_chain else said
