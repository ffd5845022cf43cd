"""Keyword entries for the leaves of a tree that the vocabulary does not know: a draft for a person to go on from."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator

from btlang.record import Record
from btlang.tree.catalogue import CATALOGUE
from btlang.tree.model import NodeModel, PortModel
from btlang.tree.node import Node, Tree
from btlang.vocabulary.entry import Entry, Meaning, SlotSpec
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.pattern import PatternError, forms
from btlang.vocabulary.trie import TrieNode, add, collisions

MODULE = "my_robot.leaves"
"""Stands for the user's module in what is drafted."""

_NUMBERS = re.compile(r"(?:std::)?(?:u?int(?:8|16|32|64)?(?:_t)?|unsigned(?: int)?|size_t|long|float|double)")
_ASKING = ("Is", "Has", "Are", "Can")
_MOST_REQUIRED = 12  # of what people would say
_MOST_OPTIONAL = 7  # each doubles the ways to say a phrase
_PREFIXES = ("", "do ", "run node ")  # where an id makes words that mean something already


class Draft(Record):
    """An entry for a leaf, and the names of ports that no slot can have. Its phrase is that of no other entry."""

    entry: Entry
    left_out: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """The entry in a keyword file."""
        entry = self.entry
        call = f"{MODULE}:{'_'.join(_words(entry.id))}"
        lines = [f"[[{entry.sort}]]", f"phrase = {_text(entry.phrases[0])}", f"id = {_text(entry.id)}"]
        lines.append(f"call = {_text(call)}")
        if entry.help:
            lines.append(f"help = {_text(entry.help)}")
        if entry.slots:
            lines.append("slots = { " + ", ".join(f"{slot.name} = {_slot(slot)}" for slot in entry.slots) + " }")
        if self.left_out:
            lines.append(f"# Ports that aren't in the phrase: {', '.join(self.left_out)}")
        return "\n".join(lines)


def unknown_leaves(tree: Tree, vocabulary: Lexicon) -> dict[str, list[Node]]:
    """The leaves whose id is that of no entry and no node of the engine, by id, in the order of Tree.walk."""
    found: dict[str, list[Node]] = {}
    for node in tree.walk():
        if not node.children and node.id not in CATALOGUE:
            if node.id not in vocabulary.entries:
                found.setdefault(node.id, []).append(node)
    return found


def drafts(tree: Tree, vocabulary: Lexicon) -> dict[str, Draft | None]:
    """A draft for each of these ids, None where no keyword entry can have such an id: it is no word."""
    models = {model.id: model for model in tree.models}
    taken: TrieNode = {}
    made: dict[str, Draft | None] = {}
    for id, nodes in unknown_leaves(tree, vocabulary).items():
        made[id] = None
        if re.fullmatch(r"[A-Za-z]\w*", id):
            made[id] = _draft(nodes, models.get(id) or NodeModel("", id), vocabulary, taken)
    return made


def to_keywords(tree: Tree, vocabulary: Lexicon) -> str:
    """The text of a keyword file with an entry for each unknown leaf; it loads as it is."""
    found = drafts(tree, vocabulary)
    lines = [
        "# Words for the leaves that have none yet. Change each phrase to what you want to say, and each call to your",
        "# function (docs/keywords.md).",
    ]
    if not found:
        lines = ["# Every leaf of this tree has a keyword entry."]
    for id, draft in found.items():
        if draft is None:
            lines += ["", f"# No entry can have the id {json.dumps(id)}: an id is one word of letters and digits."]
        else:
            lines += ["", draft.text]
    return "\n".join(lines) + "\n"


def _draft(nodes: list[Node], model: NodeModel, vocabulary: Lexicon, taken: TrieNode) -> Draft:
    ports = {port.name: port for port in model.ports}
    for node in nodes:
        ports |= {name: PortModel(name) for name, _ in node.ports if name not in ports and name[:1] != "_"}
    required: list[SlotSpec] = []
    optional: list[SlotSpec] = []
    left_out: list[str] = []
    for port in ports.values():
        needed = port.default is None and all(port.name in dict(node.ports) for node in nodes)
        if not port.name.isidentifier() or len(required if needed else optional) == (
            _MOST_REQUIRED if needed else _MOST_OPTIONAL
        ):
            left_out.append(" ".join(port.name.split()))
        else:
            (required if needed else optional).append(_spec(port, nodes))
    sort = model.kind.lower() or ("condition" if re.match(rf"(?:{'|'.join(_ASKING)})[A-Z]", model.id) else "action")
    sort = sort if sort == "condition" else "action"
    if len(required) == 1:
        said = f" {{{required[0].name}}}"
    else:
        said = "".join(f" {_port_words(slot, vocabulary)} {{{slot.name}}}" for slot in required)
    said += "".join(f" [{_port_words(slot, vocabulary)} {{{slot.name}}}]" for slot in optional)
    slots = (*required, *optional)
    for phrase in _phrases(" ".join(_words(model.id)), said):
        entry = Entry(sort, model.id, (phrase,), slots=slots, help=" ".join(model.text.split()))
        if _is_free(entry, vocabulary, taken):
            break
    return Draft(entry, tuple(left_out))


def _phrases(words: str, said: str) -> Iterator[str]:
    yield from (f"{prefix}{words}{said}" for prefix in _PREFIXES)
    yield from (f"{_PREFIXES[-1]}{number} {words}{said}" for number in range(2, 1000))


def _is_free(entry: Entry, vocabulary: Lexicon, taken: TrieNode) -> bool:
    """Whether no other phrase matches the same words; then this one is `taken`."""
    [phrase] = entry.phrases
    types = {slot.name: slot.type for slot in entry.slots}
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


def _spec(port: PortModel, nodes: list[Node]) -> SlotSpec:
    """A number where that is its type in C++, or where every text is one; else a text."""
    texts = [text for node in nodes for name, text in node.ports if name == port.name and "{" not in text]
    default = port.default if port.default is not None and "{" not in port.default else None
    numeric = _NUMBERS.fullmatch(port.type) is not None or (not port.type and texts != [])
    numeric = numeric and all(map(_is_number, texts)) and (default is None or _is_number(default))
    return SlotSpec(port.name, "number" if numeric else "text", default)


def _is_number(text: str) -> bool:
    return re.fullmatch(r"-?\d+(\.\d+)?", text) is not None


def _words(name: str) -> list[str]:
    """`GoToPose2` -> go, to, pose, 2."""
    return [word.lower() for word in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[^\WA-Z\d_]+|\d+", name)]


def _port_words(slot: SlotSpec, vocabulary: Lexicon) -> str:
    words = _words(slot.name)
    return " ".join(words) if any(word not in vocabulary.articles for word in words) else " ".join(["with", *words])


def _slot(slot: SlotSpec) -> str:
    if slot.default is None:
        return _text(slot.type)
    return f"{{ type = {_text(slot.type)}, default = {_text(slot.default)} }}"


def _text(text: str) -> str:
    """A string of TOML; JSON's are, but for one character."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
