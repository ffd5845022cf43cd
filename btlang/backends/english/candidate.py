"""What a node is said as, and the check that it is just that node: lowering it must give the node back.

So the forms in forms.py are only proposals, and `btlang/passes/lower.py` alone knows what each form means.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

from btlang.backends.english.type_inference import Around
from btlang.passes.lower import lower_one
from btlang.passes.scope import Lowered, Scope
from btlang.support.record import Record
from btlang.tree import ast
from btlang.tree.node import Node
from btlang.vocabulary.references import keys_in, plain

REFERENCE = re.compile(r"\{[^{}]+\}")


class Candidate(Record):
    """`command` says the node in one statement; `body` as all that stands in a block, where rules have their place.

    `condition` says it as a condition, None where it cannot be one; `is_condition` where it is meant as one.
    With `in_lines` what is said needs lines of its own (see btlang/printer/blocks.py), so that only forms with blocks
    can hold it.
    """

    node: Node
    command: ast.Ast
    body: ast.Ast
    condition: ast.Ast | None = None
    is_condition: bool = False
    in_lines: bool = False
    children: tuple[Candidate, ...] = ()

    @property
    def part(self) -> ast.Ast:
        """What it is said as in a form that has blocks."""
        return self.body if self.in_lines else self.command


class Checked:
    """What each piece of syntax is lowered to, for the nodes that were raised so far.

    `around` is what is known where the node stands that is being raised, `texts` what is computed for it. The scope
    makes the keys that reading makes, as nodes are raised in the order in which they are read.
    """

    def __init__(self, scope: Scope, around: Around) -> None:
        self.scope = scope
        self.around = around
        self.texts: Mapping[str, str] = {}
        self._lowered: dict[int, tuple[ast.Ast, Lowered]] = {}  # with its syntax, so that no other one gets its id

    def lowered(self, item: ast.Ast) -> Lowered:
        """What a piece of syntax means. Few are around pieces that are known."""
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
        """Takes a piece of syntax for what it may not mean."""
        self._lowered[id(item)] = item, lowered

    def text(self, port: str) -> str | None:
        """What the text of a port is said as, with values of the mission in braces; None where one has no name."""
        text = self.texts.get(port[1:-1]) if port[:1] == "{" else None
        if text is None:
            text = port if REFERENCE.fullmatch(port) else plain(port)
        return text if all(key in self.around.kinds for key in keys_in(text)) else None

    def can_skip(self, item: ast.Ast) -> bool:
        """Whether it can end SKIPPED, as lowering sees it."""
        return self.lowered(item).can_skip


def _same(made: Node, wanted: Node) -> bool:
    """Equality up to the order of ports. Parts that are the same object are not looked into."""
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
