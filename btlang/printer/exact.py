"""Nodes with ports that no phrase says: `go to the lab with speed 2`, `do open gripper called "first" with width 0.05`.

What is said is read back as it stands, by btlang/frontends/mission/symbols/nodes.py.
"""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Iterable, Iterator, Mapping

from btlang.printer.fragments import COLON, LEAF, Fragment, Fragments, mark
from btlang.printer.printer import WHOLE, Doc, Printer
from btlang.text.source import Source
from btlang.text.words import split
from btlang.tree import ast
from btlang.tree.catalogue import SEQUENCE, SUBTREE, only_port, takes_one_child
from btlang.vocabulary.language_tables import CHANGING
from btlang.vocabulary.lexicon import DEFINING, Lexicon
from btlang.vocabulary.node_forms import is_negative, node_details, node_forms, opposite_script
from btlang.vocabulary.node_words import id_of_name, is_port, is_said_bare, is_tree_name, said_id, subtree_named
from btlang.vocabulary.trie import longest

_BARE = re.compile(r"-?\d+(\.\d+)?|\{[A-Za-z_][A-Za-z0-9_]*\}")
_KEY = re.compile(r"\{[A-Za-z_][A-Za-z0-9_]*\}")
_IDENTIFIER = re.compile(r"(?=\w*_|\w+[A-Z])[A-Za-z_]\w*", re.ASCII)
_ODD_WORDS = re.compile(r"\d[A-Z](?![a-z])")  # `GetMasks3D` would be `get masks3 d`
_WORDS = re.compile(r"[a-z][a-z0-9]*(_[a-z][a-z0-9]*)*")
# A text as pieces: what double quotes can hold, marks that would end it, and what no quotes can hold.
_PIECE = re.compile(r'(?P<plain>[^"“”„«»\x00-\x1f\x7f\ufeff]+)|(?P<marks>["“”„«»]+)|(?P<odd>.)', re.DOTALL)


def exact(node: ast.Exact, _parts: list[Doc], printer: Printer) -> Doc:
    """Print a node said by its id. Without children it is a command; with children it needs lines."""
    head = mark(node_head(node, printer))
    if not node.items:
        return Doc((head,), WHOLE)
    return Doc((head, mark(COLON)), WHOLE, in_lines=True)


def exact_block(node: ast.Exact, printer: Printer) -> Iterator[tuple[Fragments, Iterator[tuple[ast.Ast, str]]]]:
    """Yield its words, and its children as the lines below it."""
    if node.items:
        steps = _steps(node.items[0]) if takes_one_child(node.id) and len(node.items) == 1 else []
        items = steps if len(steps) > 1 else node.items
        yield (mark(node_head(node, printer)),), ((item, "children") for item in items)


def _steps(item: ast.Ast) -> list[ast.Ast]:
    """Return the items of a sequence that is said without words of its own, as the lines below a decorator are."""
    is_chain = isinstance(item, ast.Chain) and item.operator == "sequence"
    is_plain = isinstance(item, ast.Exact) and item.id == SEQUENCE and not item.ports and not item.name
    return ast.parts(item) if is_chain or is_plain else []


def node_head(node: ast.Exact, printer: Printer) -> str:
    """Print the node with its name and its ports, without its children."""
    ports = dict(node.ports)
    said = (_form(node, ports, printer) if node.items else "") or _head(node, ports, printer)
    if node.items and is_one_piece(node.name):
        label = quote(node.name, printer.vocabulary)
        is_alone = node.id == SEQUENCE and not ports
        return label if is_alone else f"{label}, {said}" + _details(node.replace(name=""), ports, printer)
    return said + _details(node, ports, printer)


def with_condition_first(node: ast.Ast, printer: Printer) -> str:
    """Print a leaf said by its id with its last condition first, `while "x < 3", do push cart`; "" if it has none."""
    if not isinstance(node, ast.Exact) or node.items or node.is_condition or not node.ports:
        return ""
    said = _detail(*node.ports[-1], printer.vocabulary)
    rest = node_head(node.replace(ports=node.ports[:-1]), printer) if said.endswith('"') else ""
    return f"{said.strip()}, {rest}" if rest else ""


def split_label(node: ast.Ast) -> tuple[str, ast.Ast]:
    """Return the name that stands before a statement, "" if none does, and the statement without it."""
    if isinstance(node, ast.Named):
        return node.name, node.body
    leaf = node.condition if isinstance(node, ast.Check) else node
    if not isinstance(leaf, ast.Exact | ast.Phrase) or not is_one_piece(leaf.name) or ast.parts(leaf):
        return "", node
    bare: ast.Ast = leaf.replace(name="")
    return leaf.name, node.replace(condition=bare) if leaf is not node else bare


def _form(node: ast.Exact, ports: dict[str, str], printer: Printer) -> str:
    """Print the form that says a node with the children below it, "" if it has none; its ports are taken out."""
    for form in node_forms(printer.vocabulary):
        said = [each.name for each in form.ports if each.value is None]
        fixed = {each.name: each.value for each in form.ports if each.value is not None}
        if form.id == node.id and ports.keys() >= {*said} and fixed.items() <= ports.items():
            for name in fixed:
                del ports[name]
            return form.say([_value(ports.pop(name), printer.vocabulary) for name in said])
    return ""


def phrase(node: ast.Phrase, _parts: list[Doc], printer: Printer) -> Doc:
    """Print words of a keyword entry, and behind them what they don't say of the node."""
    words = Fragment(printer.phrase(node.entry.id, node.arguments) or node.span.text, LEAF)
    details = _details(node, dict(node.ports), printer)
    return Doc((words, mark(details.lstrip())) if details else (words,), WHOLE)


def _details(node: ast.Exact | ast.Phrase, ports: dict[str, str], printer: Printer) -> str:
    """Print ` called "first" with width 0.05 giving {path}`, "" if nothing of that is to be said."""
    vocabulary, head = printer.vocabulary, ""
    if node.name:
        head += f" {vocabulary.word('called')} {quote(node.name, vocabulary)}"
    behind = ""
    while ports and (said := _detail(*next(reversed(ports.items())), vocabulary)):
        behind = said + behind
        ports.popitem()
    gives = {key: ports.pop(key) for key in node.outputs if _KEY.fullmatch(ports.get(key, ""))}
    is_command = isinstance(node, ast.Phrase)
    return head + _ports("with", ports, printer, is_command) + _ports("giving", gives, printer) + behind


def order_ports(ports: Iterable[tuple[str, str]], vocabulary: Lexicon) -> tuple[tuple[str, str], ...]:
    """Return ports in the order in which they are said best: those with words of their own last, scripts behind all."""

    def place(port: tuple[str, str]) -> int:
        said = _detail(*port, vocabulary)
        return 0 if not said else 2 if said.endswith('"') else 1

    return tuple(sorted(ports, key=place))


def _detail(port: str, text: str, vocabulary: Lexicon) -> str:
    """Print a port that all nodes may have in words of its own, "" if it has none."""
    opposite = opposite_script(text) if is_negative(text) else None
    for details in node_details(vocabulary).values():
        for detail in details:
            said = opposite if detail.opposite else text
            if detail.port == port and said is not None and detail.value in (None, text):
                return f" {detail.said}" + (f" {quote(said, vocabulary)}" if detail.value is None else "")
    return ""


def _head(node: ast.Exact, ports: dict[str, str], printer: Printer) -> str:
    """Print `do` and what names the node; the port that names a subtree is taken out of its ports."""
    vocabulary, subtrees = printer.vocabulary, printer.subtrees
    role = "test" if node.is_condition else "do"
    word, words = vocabulary.word(role), vocabulary.nodes.get(node.id)
    name = ports.get("ID", "") if node.id == SUBTREE else ""
    is_known = name in subtrees or (is_tree_name(name, vocabulary) and not node.items)
    if name and (is_known or words is not None):
        del ports["ID"]
        said = _in_words(id_of_name(name), name, role, printer) if name in subtrees else ""
        if name in subtrees:
            said = said or _bare(name, role, printer)
        return f"{word} {said or quote(name, vocabulary)}" if is_known else f"{word} {words} {quote(name, vocabulary)}"
    if words is not None and node.id != SUBTREE:
        port = "" if node.items else only_port(node.id)
        text = f" {quote(ports.pop(port), vocabulary)}" if not _BARE.fullmatch(ports.get(port, "0")) else ""
        return f"{word} {words}{text}"
    said = _in_words(node.id, "", role, printer)
    if not said and (node.is_condition or node.id not in subtrees):
        said = _bare(node.id, role, printer)
    if said:
        return f"{word} {said}"
    if not node.is_condition and (node.id in subtrees or is_tree_name(node.id, vocabulary)):
        return f"{word} {vocabulary.word('node')} {quote(node.id, vocabulary)}"
    return f"{word} {quote(node.id, vocabulary)}"


def _in_words(node_id: str, subtree: str, role: str, printer: Printer) -> str:
    """Return the words of an id, "" if they are read as anything else than it, or than this subtree."""
    said = said_id(node_id, role, printer.vocabulary)
    if not said or _ODD_WORDS.search(node_id):
        return ""
    if role == "do" and subtree_named(node_id, printer.subtrees, in_words=True) != subtree:
        return ""
    return "" if _is_claimed(said, role, printer) else said


def _bare(node_id: str, role: str, printer: Printer) -> str:
    """Return an id as it stands, "" if it needs quotes."""
    is_bare = is_said_bare(node_id, role, printer.vocabulary)
    return node_id if is_bare and not _is_claimed(node_id, role, printer) else ""


def _is_claimed(said: str, role: str, printer: Printer) -> bool:
    """Whether a defined name begins where an id does, or where the word before it does."""
    names, context = printer.names, printer.vocabulary.context
    if not names:
        return False
    text = split(Source(f"{printer.vocabulary.word(role)} {said}"), printer.vocabulary.orthography)
    places = (0, len(text.words) - 2 - len(said.split()))
    return any(longest(names, text, at, context) is not None for at in places)


def _ports(role: str, ports: Mapping[str, str], printer: Printer, is_command: bool = False) -> str:
    """Print `with width 0.05, {path}`; the word again if a name behind a comma would be read as a command.

    `go to the lab with {person}` may be a command of its own, so a command's first port has its name.
    """
    vocabulary, said = printer.vocabulary, ""
    for name, text in ports.items():
        key, value = _key(name, vocabulary), _value(text, vocabulary)
        is_short = value == f"{{{name}}}" and (said != "" or not is_command)  # said without its name
        ways = (key, name) if _IDENTIFIER.fullmatch(name) else (key,)  # behind a comma, `stop_dist` is no command
        free = next((way for way in ways if is_short or _is_free(way, value, printer)), None) if said else None
        port = value if is_short else f"{free or key} {value}"
        said += f", {port}" if free else f" {vocabulary.word(role)} {port}"
    return said


def _value(text: str, vocabulary: Lexicon) -> str:
    is_bare = _BARE.fullmatch(text) and text[1:-1] not in _claiming_words(vocabulary)
    return text if is_bare else quote(text, vocabulary)


def _is_free(key: str, value: str, printer: Printer) -> bool:
    """Whether a port behind a comma is read as one."""
    begin = split(Source(f"{key} {value}"), printer.vocabulary.orthography)
    return is_port(begin, 0, bisect_left(begin.starts, len(key)), printer.vocabulary, printer.names)


def _key(name: str, vocabulary: Lexicon) -> str:
    """Print the name of a port, as words if they are read back as it."""
    if _is_words(name, vocabulary):
        return name.replace("_", " ")
    return name if _IDENTIFIER.fullmatch(name) else quote(name, vocabulary)


def quote(text: str, vocabulary: Lexicon) -> str:
    """Print a text as pieces in quotes, `newline` and `character 9`."""
    return " ".join(_pieces(text, vocabulary)) or '""'


def is_one_piece(text: str) -> bool:
    """Whether one pair of quotes can hold a text, as those around names of subtrees and of ports must."""
    return len(list(_PIECE.finditer(text))) == 1 and _PIECE.match(text).lastgroup != "odd"  # type: ignore[union-attr]


def _pieces(text: str, vocabulary: Lexicon) -> Iterator[str]:
    for piece in _PIECE.finditer(text):
        if piece.lastgroup == "plain":
            yield f'"{piece.group()}"'
        elif piece.lastgroup == "marks":
            yield f"'{piece.group()}'"
        elif piece.group() == "\n":
            yield vocabulary.word("newline")
        else:
            yield f"{vocabulary.word('character')} {ord(piece.group())}"


def _is_words(name: str, vocabulary: Lexicon) -> bool:
    """Whether its words are read back as this name, and not as a text, as `with` or as part of another name."""
    if not _WORDS.fullmatch(name):
        return False
    first, *rest = name.split("_")
    if any(first == phrase.split()[0] for phrase in vocabulary.roles["with"]):
        return False
    others = {phrase.split()[0] for role in ("newline", "character") for phrase in vocabulary.roles[role]}
    others |= {*vocabulary.articles, *_claiming_words(vocabulary)}
    return others.isdisjoint((first, *rest))


def _claiming_words(vocabulary: Lexicon) -> set[str]:
    """Return the words that make names or values of the words beside them."""
    return {word for role in (*DEFINING, *CHANGING) for word in vocabulary.roles[role]}
