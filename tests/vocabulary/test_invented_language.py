"""No word of English stands in code: all words of the keyword files are exchanged for invented ones, letter by letter.

Missions in the invented words must give the same trees, and be said in the invented words again.
"""

from __future__ import annotations

import codecs
import re
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from btlang.diagnostics.files import read_source
from btlang.frontends.mission.reader import read_mission
from btlang.passes import compile_mission
from btlang.printer.mission import english
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.robots.worlds.world_file import world_names
from btlang.text.source import Source
from btlang.tree.node import Node, Tree
from btlang.vocabulary.entry import Entry, Role, SlotSpec
from btlang.vocabulary.keyword_file import KeywordFile, read_keyword_file
from btlang.vocabulary.language_tables import WORD_LISTS
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.shipped import ENGLISH, keyword_files, shipped
from btlang.vocabulary.value_type import Unit, ValueType
from tests.profiles import cases

GOOD = Path(__file__).parents[1] / "samples" / "good"
# What a mission includes is in English; ids and ports of nodes, and the attribute `name`, are so in every language.
_IN_ENGLISH = ("includes", "nodes", "node_forms", "called_name", "given")
SAMPLES = sorted(path for path in GOOD.glob("*.txt") if path.stem not in _IN_ENGLISH)
_TYPES = re.compile(r"(?<![a-z])(cynpr|crefba|bowrpg|grkg|pbhag)(?![a-z])")


def invented(text: str) -> str:
    """Each letter becomes another one. The names of types stay, as they are no words; a parameter may be called so."""
    return _TYPES.sub(lambda name: codecs.encode(name[0], "rot13"), codecs.encode(text, "rot13"))


def _pattern(text: str) -> str:
    """The names of slots stay."""
    return re.sub(r"\{\w+(?:=[^}]*)?\}|[^{]+", lambda part: part[0] if part[0][0] == "{" else invented(part[0]), text)


def _entry(entry: Entry) -> Entry:
    slots = tuple(SlotSpec(s.name, s.type, s.default and invented(s.default)) for s in entry.slots)
    said = entry.phrases, entry.quantity, entry.named
    phrases, quantity, named = (tuple(map(_pattern, patterns)) for patterns in said)
    verbs = tuple((tuple(map(invented, own)), tuple(map(_role, roles))) for own, roles in entry.verbs)
    denied = tuple(map(_pattern, entry.denied))
    return entry.replace(denied=denied, phrases=phrases, quantity=quantity, named=named, slots=slots, verbs=verbs)  # type: ignore[no-any-return]


def _role(role: Role) -> Role:
    words = tuple(tuple(map(invented, phrase)) for phrase in role.words)
    return role.replace(words=words)  # type: ignore[no-any-return]


def _type(kind: ValueType) -> ValueType:
    units = tuple(Unit(tuple(map(invented, u.words)), u.numerator, u.denominator) for u in kind.units)
    return kind.replace(units=units, names=tuple(map(invented, kind.names)))  # type: ignore[no-any-return]


def _language(tables: dict[str, Any]) -> dict[str, Any]:
    made: dict[str, Any] = {}
    for key, value in tables.items():
        if key in WORD_LISTS:
            made[key] = list(map(invented, value))
        elif key in ("roles", "comparisons"):
            made[key] = {name: list(map(_pattern, patterns)) for name, patterns in value.items()}
        elif key in ("nouns", "everyone", "relations", "relations_to_self", "prepositions", "asking"):
            made[key] = {kind: list(map(invented, words)) for kind, words in value.items()}
        elif key == "plural_endings":
            made[key] = {invented(ending): invented(other) for ending, other in value.items()}
        elif key == "contractions":
            made[key] = {invented(word): invented(read) for word, read in value.items()}
        elif key == "node_forms":
            made[key] = {node_id: list(map(_pattern, forms)) for node_id, forms in value.items()}
        elif key in ("nodes", "node_details"):
            made[key] = {node_id: _pattern(words) for node_id, words in value.items()}
        elif key in ("negations", "negative_subjects", "plurals", "doing", "third_person", "synonyms", "direct"):
            made[key] = {invented(word): list(map(invented, words)) for word, words in value.items()}
        elif key in ("counts", "ordinals", "numbers", "multipliers", "fractions", "times", "pronouns", "meanings"):
            made[key] = {invented(word): meaning for word, meaning in value.items()}
        else:
            made[key] = value
    return made


@cache
def invented_vocabulary() -> Lexicon:
    files = []
    for path in keyword_files(shipped("keywords", ENGLISH)):
        file = read_keyword_file(read_source(path))
        names = tuple((kind, invented(words), invented(name)) for kind, words, name in file.names)
        made = KeywordFile(
            file.source,
            tuple(map(_entry, file.entries)),
            tuple(map(_type, file.types)),
            names,
            _language(file.language),
            nouns=tuple(noun.replace(phrase=_pattern(noun.phrase)) for noun in file.nouns),
        )
        files.append(made)
    vocabulary = Lexicon(files)
    names_of_world = world_names(None)
    features = {
        kind: tuple((invented(name), tuple((part, invented(text)) for part, text in parts)) for name, parts in likes)
        for kind, likes in names_of_world.features.items()
    }
    by_type = {kind: tuple(map(invented, listed)) for kind, listed in names_of_world.by_type.items()}
    return vocabulary.with_names(by_type, features)


@cases("sample", SAMPLES, usual=27, ids=lambda sample: sample.stem)
@pytest.mark.parametrize("parser", ["shunting-yard", "lark"])
def test_a_mission_in_invented_words_has_the_same_tree_and_is_said_in_them(sample: Path, parser: str) -> None:
    text = read_source(str(sample)).text
    known = read_mission(Source(text), world_vocabulary()).mission
    strange = read_mission(Source(invented(text)), invented_vocabulary(), parser).mission
    expected = compile_mission(known, world_vocabulary(), needs_command=False)
    found = compile_mission(strange, invented_vocabulary(), needs_command=False)
    assert _plain(found, lambda text: text) == _plain(expected, invented)
    assert english(strange, invented_vocabulary()) == invented(english(known, world_vocabulary()))


def _plain(tree: Tree, change: Any) -> list[object]:
    """Every node with its port texts changed; a leaf keeps the names of its slots."""
    return [
        (node.id, len(node.children), sorted(_port(node, name, text, change) for name, text in node.ports))
        for node in tree.walk()
    ]


def _port(node: Node, name: str, text: str, change: Any) -> tuple[str, str]:
    own = node.id != "SubTree" or name == "ID"
    made = ("each_", "chosen_")
    changed = text if name in ("_skipIf", "once", "how", "type") else change(text)
    for start in made:
        changed = changed.replace(change(start), start)
    return name if own else change(name), changed
