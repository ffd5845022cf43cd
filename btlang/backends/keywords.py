"""Keyword entries for leaves that the vocabulary doesn't know: drafts for a person to continue."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import chain

from btlang.backends.wording import SpokenPorts, asks, id_words, phrases
from btlang.support.record import Record
from btlang.text.toml import toml_key, toml_value
from btlang.tree.catalogue import CATALOGUE
from btlang.tree.node import Node, NodeModel, PortModel, Tree
from btlang.vocabulary.entry import Entry, Meaning, SlotSpec
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.pattern import PatternError, forms
from btlang.vocabulary.trie import TrieNode, add, collisions
from btlang.vocabulary.value_type import TEXT, ValueType, format_number

MODULE = "my_robot.leaves"
"""Stands for the user's module in what is drafted."""

_MOST_REQUIRED = 12  # of what people would say
_MOST_OPTIONAL = 5  # each doubles the ways to say a phrase
_WITH_DEFAULTS = ("server_name", "server_timeout", "service_name")  # in C++, though no model says so
_WHOLE = re.compile(r"(?:std::)?(?:u?int(?:8|16|32|64)?(?:_t)?|unsigned(?: int)?|size_t|u?long)")
_DECIMAL = re.compile(r"float|double|(?:std::)?float(?:32|64)_t")
_CHOICE = re.compile(r"\w+(?:\|\w+)+")
NUMBER = "number"
_BOOLEANS = ValueType("boolean", "names", names=("true", "false"))
_WHOLE_NUMBERS = ValueType("whole_number", NUMBER, whole=True)


class Leaf(Record):
    """The facts about a kind of leaf: its model and its uses in trees."""

    model: NodeModel
    uses: tuple[Node, ...] = ()


class Draft(Record):
    """An entry for a leaf with the types that it brings, and the names of ports that have no slot.

    Its phrase is that of no other entry.
    """

    entry: Entry
    types: tuple[ValueType, ...] = ()
    left_out: tuple[str, ...] = ()

    def text(self, module: str = MODULE) -> str:
        """Return the entry in a keyword file, with a function of a module to call, or none for ""."""
        entry = self.entry
        said: dict[str, object] = {"phrase": entry.phrases[0], "id": entry.id}
        if module:
            said["call"] = f"{module}:{'_'.join(id_words(entry.id))}"
        if entry.help:
            said["help"] = entry.help
        if entry.slots:
            said["slots"] = {slot.name: slot.type for slot in entry.slots}
        if entry.outputs:
            said["outputs"] = list(entry.outputs)
        lines = [f"[[{entry.sort}]]", *(f"{key} = {toml_value(value)}" for key, value in said.items())]
        if self.left_out:
            lines.append(f"# Ports that aren't in the phrase: {', '.join(map(toml_key, self.left_out))}")
        return "\n".join(lines)


def find_unknown_leaves(tree: Tree, vocabulary: Lexicon) -> dict[str, list[Node]]:
    """Find the leaves whose id is that of no entry and no node of the engine, by id, in the order of Tree.walk."""
    found: dict[str, list[Node]] = {}
    for node in tree.walk():
        if not node.children and is_unknown(node.id, vocabulary):
            found.setdefault(node.id, []).append(node)
    return found


def is_unknown(node_id: str, vocabulary: Lexicon) -> bool:
    """Whether an id is that of no entry and no node of the engine."""
    return node_id not in CATALOGUE and node_id not in vocabulary.entries


def drafts(tree: Tree, vocabulary: Lexicon) -> dict[str, Draft | None]:
    """Draft entries as `draft_entries` does, for the unknown leaves of a tree."""
    models = {model.id: model for model in tree.models}
    found = find_unknown_leaves(tree, vocabulary).items()
    return draft_entries([Leaf(models.get(id) or NodeModel("", id), tuple(nodes)) for id, nodes in found], vocabulary)


def draft_entries(
    leaves: Iterable[Leaf], vocabulary: Lexicon, refused: Mapping[str, Sequence[str]] = {}
) -> dict[str, Draft | None]:
    """Draft an entry for each leaf by its id, None if none can be made (`why_none`). Phrases that are `refused` aren't
    used again.
    """
    taken: TrieNode = {}
    types = SlotTypes(vocabulary.types)
    made: dict[str, Draft | None] = {}
    for leaf in leaves:
        id = leaf.model.id
        made[id] = _draft(leaf, vocabulary, taken, types, refused.get(id, ())) if _is_id(id) else None
    return made


def why_none(node_id: str) -> str:
    """Return why a leaf has no draft."""
    return "its words mean something else already" if _is_id(node_id) else "an id is one word of letters, digits and _"


def to_keywords(tree: Tree, vocabulary: Lexicon) -> str:
    """Return the text of a keyword file with an entry for each unknown leaf; it loads as it is."""
    found = drafts(tree, vocabulary)
    if not found:
        return "# Every leaf of this tree has a keyword entry.\n"
    head = (
        "# Words for the leaves that have none yet. Change each phrase to what you want to say, and each call to your",
        "# function (docs/keywords.md).",
    )
    return keyword_text(head, found)


def keyword_text(head: Iterable[str], found: Mapping[str, Draft | None], module: str = MODULE) -> str:
    """Return a keyword file with these drafts, and comments above them."""
    lines = [*head]
    types = {type.name: type for draft in found.values() if draft is not None for type in draft.types}
    for type in types.values():
        lines += ["", *_type_lines(type)]
    for id, draft in found.items():
        if draft is None:
            lines += ["", f"# No entry for the id {json.dumps(id)}: {why_none(id)}."]
        else:
            lines += ["", draft.text(module)]
    return "\n".join(lines) + "\n"


def _type_lines(type: ValueType) -> Iterator[str]:
    yield from ("[[type]]", f"name = {toml_value(type.name)}")
    if type.names:
        yield f"values = {toml_value(list(type.names))}"
    elif type.whole:
        yield "whole = true"


def _is_id(node_id: str) -> bool:
    return re.fullmatch(r"[A-Za-z]\w*", node_id) is not None


def _draft(leaf: Leaf, vocabulary: Lexicon, taken: TrieNode, types: SlotTypes, refused: Sequence[str]) -> Draft | None:
    model = leaf.model
    found, left_out = _spoken(leaf)
    typed = {port.name: types.of(model.id, port, leaf.uses) for port in chain(*found)}
    texts = frozenset(name for name, type in typed.items() if type.name == TEXT)
    required, optional, outputs = (tuple(port.name for port in ports) for ports in found)
    said = SpokenPorts(required, optional, outputs, texts)
    slots = tuple(SlotSpec(name, type.name) for name, type in typed.items())
    is_condition = model.kind == "Condition" or (not model.kind and asks(model.id))
    sort = "condition" if is_condition else "action"
    for phrase in phrases(model.id, said, vocabulary.articles, is_condition=is_condition):
        entry = Entry(sort, model.id, (phrase,), slots=slots, help=_help(model), outputs=outputs)
        if phrase not in refused and _is_free(entry, vocabulary, typed, taken):
            own = tuple(type for type in typed.values() if type.name not in vocabulary.types)
            return Draft(entry, own, left_out)
    return None


def _spoken(leaf: Leaf) -> tuple[tuple[list[PortModel], ...], tuple[str, ...]]:
    """Return the ports that must be said, may be said and are given values to, and the names of all others.

    Those that trees use are said before others.
    """
    ports = {port.name: port for port in leaf.model.ports}
    used = {name: None for node in leaf.uses for name, _ in node.ports if name[:1] != "_"}
    ports |= {name: PortModel(name) for name in used if name not in ports}
    always = [name for name in ports if all(name in dict(node.ports) for node in leaf.uses)]
    required, optional, outputs = list[PortModel](), list[PortModel](), list[PortModel]()
    left_out = []
    for port in sorted(ports.values(), key=lambda port: port.name not in used):
        needed = port.default is None and port.name in always and (leaf.uses or port.name not in _WITH_DEFAULTS)
        group = outputs if port.direction == "output" else required if needed else optional
        most = _MOST_REQUIRED - len(required) if group is required else _MOST_OPTIONAL - len(optional) - len(outputs)
        if port.name.isidentifier() and port.name[:1] != "_" and most > 0:
            group.append(port)
        else:
            left_out.append(port.name)
    return (required, optional, outputs), tuple(left_out)


def _help(model: NodeModel) -> str:
    texts = [model.text, *(f"{port.name}: {port.text}" for port in model.ports if port.text)]
    return "; ".join(" ".join(text.split()).rstrip(".;") for text in texts if text.strip())


def _is_free(entry: Entry, vocabulary: Lexicon, typed: Mapping[str, ValueType], taken: TrieNode) -> bool:
    """Whether no other phrase matches the same words; then this one is `taken`."""
    [phrase] = entry.phrases
    types = {name: _like(type, vocabulary) for name, type in typed.items()}
    meaning = Meaning("command" if entry.sort == "action" else "condition", entry)
    try:
        ways = list(forms(phrase, vocabulary.articles))
    except PatternError:  # nothing but articles
        return False
    if entry.sort == "condition":
        ways += [way for form in ways for way in vocabulary.negated(form)]
    own: TrieNode = {}
    for way in ways:
        add(own, way, types, meaning)
    for trie in (vocabulary.trie, taken):
        for _ in collisions(own, vocabulary.values, trie):
            return False
    for way in ways:
        add(taken, way, types, meaning)
    return True


def _like(type: ValueType, vocabulary: Lexicon) -> str:
    """Return the name of a known type that takes whatever this one takes."""
    if type.name in vocabulary.types:
        return type.name
    return TEXT if type.kind == "names" else NUMBER


class SlotTypes:
    """The types that a keyword file needs beside those that are `known`; each has a name of its own."""

    def __init__(self, known: Mapping[str, ValueType]) -> None:
        self._known = known
        self._own: dict[str, ValueType] = {}

    def of(self, node_id: str, port: PortModel, uses: Iterable[Node]) -> ValueType:
        """Return the type of a slot. It is text if a tree has a text that another type wouldn't return as it is."""
        texts = [text for node in uses for name, text in node.ports if name == port.name and "{" not in text]
        if port.direction != "output":
            names = _choices(port)
            if port.type == "bool" and set(texts) <= set(_BOOLEANS.names):
                return self._name_type(_BOOLEANS, node_id)
            if names and set(texts) <= set(names):
                return self._name_type(ValueType(port.name, "names", names=names), node_id)
            if _WHOLE.fullmatch(port.type) and all(map(_is_whole, texts)):
                return self._name_type(_WHOLE_NUMBERS, node_id)
            if (_DECIMAL.fullmatch(port.type) or (not port.type and texts)) and all(map(_is_number, texts)):
                return self._known[NUMBER]
        return self._known[TEXT]

    def _name_type(self, type: ValueType, node_id: str) -> ValueType:
        """Return the type under its name, or under one with that of the node if something else has it."""
        for name in (type.name, f"{node_id}_{type.name}"):
            made: ValueType = type.replace(name=name)
            if self._known.get(name, made) == made and self._own.setdefault(name, made) == made:
                return made
        return self._known[TEXT]


def _choices(port: PortModel) -> tuple[str, ...]:
    """Return the values of a port whose type or description lists them: `top|side|front`."""
    found = _CHOICE.fullmatch(port.type) or _CHOICE.search(port.text)
    return tuple(dict.fromkeys(found[0].split("|"))) if found else ()


def _is_number(text: str) -> bool:
    return _reads_as(text, float)


def _is_whole(text: str) -> bool:
    return _reads_as(text, int)


def _reads_as(text: str, number: Callable[[str], float]) -> bool:
    try:
        return text.isascii() and format_number(number(text)) == text and "e" not in text
    except (ValueError, OverflowError):
        return False
