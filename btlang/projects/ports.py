"""The ports of nodes by their models: unknown and missing ones, values of another type, and outdated names."""

from __future__ import annotations

import re
from collections.abc import Container, Iterable, Iterator, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.engine.instance import blackboard_key
from btlang.engine.script.tokens import find_name_uses
from btlang.frontends.btcpp.spelling import AUTOREMAP, TRUE
from btlang.support.record import Record
from btlang.text.source import NOWHERE, Span
from btlang.text.spelling import is_misspelling, nearest
from btlang.tree.catalogue import CATALOGUE, KEY, SCRIPT, SUBTREE, port_content
from btlang.tree.node import Node, NodeModel, PortModel

_ATTRIBUTE = re.compile(r"""([^\s"'=<>/]+)\s*=\s*("[^"]*"|'[^']*')""")


def place_of(node: Node) -> Span:
    """Return the start tag of a node."""
    return node.span or NOWHERE


def attribute_name(node: Node, port: str) -> Span:
    """Return the name of an attribute; the start tag where it has no such attribute."""
    return _find(node, port, 1)


def attribute_value(node: Node, port: str) -> Span:
    """Return the text of an attribute, without its quotes; the start tag where it has no such attribute."""
    return _find(node, port, 2)


def id_place(node: Node) -> Span:
    """Return what names its id: the tag, or the attribute ID behind a tag of its kind."""
    span = place_of(node)
    tag = re.match(r"<([^\s/>]+)", span.text)
    if tag is not None and tag[1] == node.id:
        return Span(span.source, span.start + 1, span.start + 1 + len(node.id))
    return attribute_value(node, "ID")


def _find(node: Node, port: str, group: int) -> Span:
    span = place_of(node)
    for match in _ATTRIBUTE.finditer(span.text):
        if match[1] == port:
            inner = group - 1  # the quotes
            return Span(span.source, span.start + match.start(group) + inner, span.start + match.end(group) - inner)
    return span


_INTEGER = re.compile(r"(?:std::)?(?P<unsigned>u|unsigned )?(?:int|long|short|long long|int(?P<bits>8|16|32|64)_t)")
_ALONE = {"unsigned": (0, 2**32 - 1), "size_t": (0, 2**64 - 1), "std::size_t": (0, 2**64 - 1)}
_BITS = {"short": 16, "long": 64, "long long": 64}
_DECIMAL = ("double", "float")
_TEXTS = ("", "std::string", "string")
_NUMBER = re.compile(r"[+-]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|inf|nan)", re.IGNORECASE)
_BOOL = frozenset(("0", "1", "true", "True", "TRUE", "false", "False", "FALSE"))
_ENUM = re.compile(r"(?:enum\b[\w ]*)?[({\[]?\s*(\w+(?:\s*[|,;]\s*\w+)+)\s*[)}\]]?")


def describe_type(text: str, type: str, listed: str = "") -> str:
    """Say what a value of the type is, where the text is none; "" where it is one, or nothing is known of the type.

    `listed` is the description of a port, which may list the texts that it takes, such as `left|right`.
    """
    if text[:5] == "json:":
        return ""
    bounds = _bounds(type)
    if bounds is not None:
        least, most = bounds
        is_whole = re.fullmatch(r"[+-]?\d{1,30}", text) is not None
        return "" if is_whole and least <= int(text) <= most else f"a whole number from {least:,} to {most:,}"
    if type in _DECIMAL:
        return "" if _NUMBER.fullmatch(text) else "a number"
    if type == "bool":
        return "" if text in _BOOL else "true or false"
    names = enum_names(type) or (enum_names(listed) if "|" in listed and type in _TEXTS else [])
    return "" if not names or text in names or text.isdecimal() else f"one of {', '.join(names)}"


def enum_names(type: str) -> list[str]:
    """Return the names of an enum whose type lists them, such as `LEFT|RIGHT`; none for any other type."""
    listed = _ENUM.fullmatch(type.strip())
    return re.split(r"\s*[|,;]\s*", listed[1]) if listed else []


def _bounds(type: str) -> tuple[int, int] | None:
    """Return the least and the greatest value of a type of whole numbers."""
    if type in _ALONE:
        return _ALONE[type]
    match = _INTEGER.fullmatch(type)
    if match is None:
        return None
    name = type.removeprefix("unsigned ")
    bits = int(match["bits"] or 0) or _BITS.get(name, 32)
    return (0, 2**bits - 1) if match["unsigned"] else (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)


_SEVERAL = 2


class DescribedUses(Record):
    """The nodes that one model describes. `others` are what else describes them, each with its place."""

    model: NodeModel
    place: Span
    nodes: tuple[Node, ...]
    others: tuple[tuple[NodeModel, Span], ...] = ()


def port_problems(uses: DescribedUses) -> Iterator[Diagnostic]:
    """Report BT232 for ports that the model doesn't have, BT233 for values of another type, BT234 for missing ports.

    BT239 where the model is wrong, and not the nodes.
    """
    model = uses.model
    ports = {port.name: port for port in model.ports}
    others = [port for other, _ in uses.others for port in other.ports]
    given = [dict(node.ports) for node in uses.nodes]
    lacking = _find_lacking(uses, others)
    optional = {port.name for port in model.ports if _may_be_left_out(port, others, given)}
    for node in uses.nodes:
        own = dict(node.ports)
        missing = [port for port in ports if port not in own and port not in optional]
        for name in own:
            if name in ports or name in lacking or is_no_port(name):
                continue
            near = _near(name, own, ports)
            fix = suggest_name(attribute_name(node, name), near)
            missing = [port for port in missing if near != [port]]
            help = f"Similar: {', '.join(near)}" if near else f"It has {', '.join(ports) or 'none'}."
            yield diagnostic("BT232", attribute_name(node, name), (), fix, port=name, id=node.id, help=help)
        for name in missing:
            yield diagnostic("BT234", place_of(node), id=node.id, port=name)
        yield from _wrong_values(node, [*ports.values(), *others])
    if lacking:
        yield _stale(uses, lacking)


def misspelt_ports(uses: DescribedUses) -> Iterator[Diagnostic]:
    """Report BT232 for ports that are surely misspelt, where the model may not list all ports."""
    for problem in port_problems(uses):
        if problem.code == "BT232" and problem.fix is not None:
            yield problem


_KIND_TAG = re.compile(r"<(Action|Condition|Decorator|Control)\b")
_CHILDREN = {"Action": (0, 0), "Condition": (0, 0), "Decorator": (1, 1)}


def wrong_children(node: Node, model: NodeModel | None) -> Iterator[Diagnostic]:
    """Report BT132 for a leaf with children and a decorator with several, as its tag or its model says what it is."""
    tag = _KIND_TAG.match(place_of(node).text)
    kind = tag[1] if tag is not None else model.kind if model is not None else ""
    has, (least, most) = len(node.children), _CHILDREN.get(kind, (0, len(node.children)))
    if least <= has <= most:
        return
    reason = f"it is {'an' if kind == 'Action' else 'a'} {kind}, and has {has} {'child' if has == 1 else 'children'}"
    yield diagnostic("BT132", place_of(node), id=node.id, reason=f"{reason} instead of {least}")


_BRACES = re.compile(r"[{}]")
_INSIDE = re.compile(r"\$?\{(\w+)\}")


def broken_references(nodes: Sequence[Node], known: Container[str]) -> Iterator[Diagnostic]:
    """Report BT233 for `{key` without its other brace, and BT245 for the `{key}` of an entry inside a text.

    That only for nodes that are `known`: others may fill in their texts themselves.
    """
    named: set[str] = set()
    inside: list[tuple[Node, str, str]] = []
    for node in nodes:
        for port, text in node.ports:
            holds, key = port_content(node.id, port), blackboard_key(port, text)
            if holds == SCRIPT:
                named.update(find_name_uses(text))
            elif key is not None or holds == KEY:
                named.add(key or text)
            elif not _BRACES.search(text):
                pass
            elif len(_BRACES.findall(text)) == 1 and (text.strip()[:1] == "{" or text.strip()[-1:] == "}"):
                wanted = "an entry such as {key}"
                place = attribute_value(node, port)
                yield diagnostic("BT233", place, text=text, port=port, id=node.id, wanted=wanted)
            elif node.id in known and (match := _INSIDE.search(text)) is not None:
                inside.append((node, port, match[1]))
    for node, port, key in inside:
        if key in named:
            node_id = node.port("ID") if node.id == SUBTREE else node.id
            yield diagnostic("BT245", attribute_value(node, port), key=key, port=port, id=node_id)


def is_no_port(name: str) -> bool:
    """Return whether an attribute is none of the ports that a model lists."""
    return name[:1] == "_" or name == "ID"


def _near(name: str, given: Iterable[str], ports: Iterable[str]) -> list[str]:
    return nearest(name.lower(), [port for port in ports if port not in given])


def _find_lacking(uses: DescribedUses, others: Iterable[PortModel]) -> dict[str, list[Node]]:
    """Return the ports that nodes have and the model lacks, with these nodes: another model has them, or several nodes
    do and they aren't misspelt.
    """
    ports, elsewhere = {port.name for port in uses.model.ports}, {port.name for port in others}
    found: dict[str, list[Node]] = {}
    misspelt: set[str] = set()
    for node in uses.nodes:
        unknown = [name for name, _ in node.ports if name not in ports and not is_no_port(name)]
        if not ports and len(unknown) >= _SEVERAL:  # nobody makes up several ports: a palette has the ID alone
            elsewhere.update(unknown)
        for name in unknown:
            found.setdefault(name, []).append(node)
            if _near(name, dict(node.ports), ports):
                misspelt.add(name)
    lacking = {name: nodes for name, nodes in found.items()
               if name in elsewhere or (len(nodes) >= _SEVERAL and name not in misspelt)}  # fmt: skip
    if lacking:  # a model that is out of date may lack others, too
        for name in found.keys() - lacking - misspelt:
            if not any(_near(name, dict(node.ports), lacking) for node in found[name]):
                lacking[name] = found[name]
    return {name: nodes for name, nodes in found.items() if name in lacking}


def _may_be_left_out(port: PortModel, others: Iterable[PortModel], given: Sequence[dict[str, str]]) -> bool:
    """Return whether a port needn't be given: it is an output or has a default, or half of several nodes leave it
    out.
    """
    if port.direction == "output" or port.default is not None:
        return True
    if any(other.name == port.name and other.default is not None for other in others):
        return True
    left_out = sum(port.name not in ports for ports in given)
    return left_out >= _SEVERAL and left_out * 2 >= len(given)


def _wrong_values(node: Node, ports: Sequence[PortModel]) -> Iterator[Diagnostic]:
    """Report BT233 where no model takes a value."""
    for name, text in node.ports:
        described = [port for port in ports if port.name == name]
        if not described or not text.strip() or "{" in text or described[0].direction == "output":
            continue
        if all(expected := [describe_type(text.strip(), port.type, port.text) for port in described]):
            yield diagnostic("BT233", attribute_value(node, name), text=text, port=name, id=node.id, wanted=expected[0])


def _stale(uses: DescribedUses, lacking: dict[str, list[Node]]) -> Diagnostic:
    """Report BT239 at the model, with the first node of each port that it lacks, and the models that have them."""
    notes = [(attribute_name(nodes[0], name), f"'{name}' is given here{_more(nodes)}")
             for name, nodes in lacking.items()]  # fmt: skip
    for model, place in uses.others:
        if place is not NOWHERE and any(port.name in lacking for port in model.ports):
            notes.append((place, "this model has it" if len(lacking) == 1 else "this model has more ports"))
    ports = ", ".join(f"'{name}'" for name in lacking)
    return diagnostic("BT239", uses.place, tuple(notes), None, id=uses.model.id, ports=ports)


def _more(nodes: Sequence[Node]) -> str:
    return f", and {len(nodes) - 1} more times" if len(nodes) > _SEVERAL else " and once more" if len(nodes) > 1 else ""


def suggest_name(span: Span, near: list[str]) -> tuple[Span, str] | None:
    """Return the change of a misspelt name to the one name that is near; None where that isn't certain."""
    certain = [name for name in near if is_misspelling(span.text, name, ())]
    return (span, certain[0]) if len(certain) == 1 else None


def subtree_problems(node: Node, model: NodeModel) -> Iterator[Diagnostic]:
    """Report BT132 for ports that the model of a tree requires, as BehaviorTree.CPP 4 does."""
    if node.port(AUTOREMAP) in TRUE:
        return
    for port in model.ports:
        if not port.default and port.name[:1] != "_" and not any(key == port.name for key, _ in node.ports):
            reason = f"the model of {model.id} requires the port {port.name}"
            yield diagnostic("BT132", place_of(node), id=SUBTREE, reason=reason)


def constant_outputs(node: Node, ports: Iterable[PortModel], is_older: bool) -> Iterator[Diagnostic]:
    """Report BT233 for outputs that name no entry: BehaviorTree.CPP 4 writes them nowhere, but version 3 needs no
    braces around a name.
    """
    outputs = {port.name for port in ports if port.direction == "output"}
    for name, text in node.ports:
        if name in outputs and text.strip() not in ("", "=") and blackboard_key(name, text) is None:
            if is_older and not _NUMBER.fullmatch(text.strip()):
                continue
            place = attribute_value(node, name)
            fix = (place, f"{{{text}}}") if text.isidentifier() else None
            yield diagnostic("BT233", place, (), fix, text=text, port=name, id=node.id, wanted="an entry such as {key}")


def several_alone(node: Node) -> Iterator[Diagnostic]:
    """Report BT132 for a second child of a kind of which BehaviorTree.CPP takes only one there."""
    alone = [child for child in node.children if child.id in CATALOGUE and CATALOGUE[child.id].alone_in == node.id]
    if len(alone) > 1:
        notes = tuple((place_of(child), f"{child.id} is asynchronous") for child in alone)
        reason = f"BehaviorTree.CPP refuses more than one {alone[0].id} in it since 4.7"
        yield diagnostic("BT132", place_of(node), notes, None, id=node.id, reason=reason)
