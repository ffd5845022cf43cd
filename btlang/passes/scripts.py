"""Scripts in trees: texts that refer to values of the mission, as ports and as Script nodes that compute them.

A port that is one reference stays one (`{level}`). A text with references in it is put together by a Script just before
the node that needs it, as a BehaviorTree.CPP port holds either a text or one reference.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from btlang.passes.scope import LoweringScope
from btlang.tree.catalogue import SEQUENCE
from btlang.tree.node import Node
from btlang.vocabulary.entry import FOUND
from btlang.vocabulary.references import NEAREST, SEEN, SOUGHT, Choice, Reference, choice_of, pieces
from btlang.vocabulary.value_type import OBJECT, PERSON

OPERATORS = {"below": "<", "above": ">", "at_least": ">=", "at_most": "<=", "equal": "=="}
"""What a script writes for each comparison."""
_CHOSEN = ("type", "how", "output")
Ports = tuple[tuple[str, str], ...]


def make_script(code: str) -> Node:
    """Make a Script without a sentence, so that no log reports it as a command."""
    return Node("Script", (), (("code", code),))


def make_choice(choice: Choice, key: str) -> Node:
    """Make the node that chooses a name for a key, without a sentence."""
    return Node("Choose", (), (("type", choice.type), ("how", choice.how), ("output", f"{{{key}}}"), *choice.parts))


def seek(choices: Sequence[Node], ports: Ports) -> tuple[list[Node], Ports]:
    """Return the choices before a search, which it is to find by what they describe, and its ports with the output."""
    things = {("type", PERSON), ("type", OBJECT)}
    sought = [each.replace(ports=_sought(each.ports)) if things & {*each.ports} else each for each in choices]
    keys = [each.port("output") for each in sought if each.port("how") == SOUGHT]
    return sought, (*ports, *((FOUND, key) for key in keys[:1]))


def _sought(ports: Ports) -> Ports:
    is_plain = dict(ports).get("how") in (NEAREST, SEEN) and len(ports) > len(_CHOSEN)
    return tuple((name, SOUGHT if name == "how" and is_plain else text) for name, text in ports)


def run_before(scripts: Sequence[Node], node: Node) -> Node:
    """Return the node after the scripts that compute its ports."""
    return Node(SEQUENCE, (*scripts, node), span=node.span) if scripts else node


def is_prepared(node: Node) -> bool:
    """Whether `run_before` made a node: all its children but the last only compute values for that one."""
    *scripts, last = node.children or (node,)
    unsaid = all(child.span is None for child in scripts)
    return bool(scripts) and unsaid and node.id == SEQUENCE and node.span is not None and node.span is last.span


def prepare_ports(
    arguments: Iterable[tuple[str, str]], scope: LoweringScope, kinds: Mapping[str, str] = {}
) -> tuple[list[Node], Ports]:
    """Return the ports of a node, and the scripts before it. `kinds` are the types of those of a SubTree."""
    scripts: list[Node] = []
    ports: list[tuple[str, str]] = []
    for name, text in arguments:
        if "{" in text or "}" in text:
            before, text = _port(text, scope)
            scripts += before
        elif name in kinds and not scope.is_number(kinds[name]) and _would_change(text):
            before, text = _own_key(text, scope)
            scripts += before
        ports.append((name, text))
    return scripts, tuple(ports)


def _would_change(text: str) -> bool:
    """Whether a text such as 007 or 2.50 would be another one as the number that it is in a port of a SubTree."""
    try:
        return str(int(text)) != text
    except ValueError:
        pass
    try:
        return float(text) is not None
    except ValueError:
        return False


def _port(text: str, scope: LoweringScope) -> tuple[list[Node], str]:
    choice = choice_of(text)
    if choice is not None:
        return [make_choice(choice, choice.key)], f"{{{choice.key}}}"
    parts = pieces(text)
    if len(parts) == 1:
        [part] = parts
        if isinstance(part, Reference):
            return [], f"{{{part.key}}}"
        if not (part.startswith("{") and part.endswith("}")):
            return [], part
    return _own_key(text, scope)


def _own_key(text: str, scope: LoweringScope) -> tuple[list[Node], str]:
    scripts, value = concatenate(text, scope)
    key = scope.new_key()
    return [*scripts, make_script(f"{key} := {value}")], f"{{{key}}}"


def compile_assignment(key: str, operation: str, text: str, kind: str, scope: LoweringScope) -> tuple[list[Node], str]:
    """Compile the code that sets, increases or decreases the value of a key, and what it needs before it."""
    if not scope.is_number(kind):
        scripts, value = concatenate(text, scope)
        return scripts, f"{key} := {value}"
    value = _plain_or_key(text)
    if operation == "set":
        return [], f"{key} := {value}"
    sign = "+=" if operation == "increase" else "-="
    return [], f"{key} {sign} {value}"


def compile_comparison(
    key: str, arguments: Iterable[tuple[str, str]], kind: str, scope: LoweringScope
) -> tuple[list[Node], str]:
    """Compile the code of a condition on a key, and what it needs before it."""
    scripts: list[Node] = []
    values: list[tuple[str, str]] = []
    for way, text in arguments:
        needed, value = ([], _plain_or_key(text)) if scope.is_number(kind) else concatenate(text, scope)
        scripts += needed
        values.append((way, value))
    return scripts, " && ".join(f"{key} {OPERATORS[way]} {value}" for way, value in values)


def _plain_or_key(text: str) -> str:
    """Return the number that a port text is, or the key that it refers to."""
    [piece] = pieces(text)
    return piece.key if isinstance(piece, Reference) else piece


def concatenate(text: str, scope: LoweringScope) -> tuple[list[Node], str]:
    """Compile the expression of a text, and what it needs before it: a string of a script holds no single quote."""
    scripts: list[Node] = []
    quote = ""
    terms: list[str] = []
    for part in pieces(text):
        if isinstance(part, Reference):
            terms.append(part.key)
            continue
        for i, plain in enumerate(part.split("'")):
            if i:
                if not quote:
                    quote = scope.new_key()
                    scripts.append(Node("SetBlackboard", (), (("value", "'"), ("output_key", quote))))
                terms.append(quote)
            if plain:
                terms.append(f"'{plain}'")
    if len(terms) > 1 and not any(term[0] == "'" for term in terms[:2]):
        terms.insert(0, "''")  # two numbers make no text
    return scripts, " .. ".join(terms) or "''"
