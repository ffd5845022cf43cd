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

from btlang.api import world_vocabulary
from btlang.diagnostics.reading import read_source
from btlang.english.sentence import english
from btlang.frontends.mission import read_mission
from btlang.passes import compile_mission
from btlang.robots.world_file import world_names
from btlang.text.source import Source
from btlang.tree.node import Tree
from btlang.vocabulary.entry import Entry, SlotSpec
from btlang.vocabulary.keyword_file import KeywordFile, read_keyword_file
from btlang.vocabulary.language_tables import WORD_LISTS
from btlang.vocabulary.shipped import keyword_files
from btlang.vocabulary.values import Unit, ValueType
from btlang.vocabulary.vocabulary import Vocabulary

SAMPLES = sorted((Path(__file__).parents[1] / "samples" / "good").glob("*.txt"))


def invented(text: str) -> str:
    """Each letter becomes another one; twice gives the text back."""
    return codecs.encode(text, "rot13")


def _pattern(text: str) -> str:
    """The names of slots stay."""
    return re.sub(r"\{\w+\}|[^{]+", lambda part: part[0] if part[0][0] == "{" else invented(part[0]), text)


def _entry(entry: Entry) -> Entry:
    slots = tuple(SlotSpec(s.name, s.type, s.default and invented(s.default)) for s in entry.slots)
    phrases, quantity = (tuple(map(_pattern, patterns)) for patterns in (entry.phrases, entry.quantity))
    return entry.replace(phrases=phrases, quantity=quantity, slots=slots)  # type: ignore[no-any-return]


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
        elif key == "negations":
            made[key] = {invented(word): list(map(invented, words)) for word, words in value.items()}
        elif key in ("counts", "numbers", "multipliers", "fractions", "pronouns", "meanings"):
            made[key] = {invented(word): meaning for word, meaning in value.items()}
        else:
            made[key] = value
    return made


@cache
def invented_vocabulary() -> Vocabulary:
    files = []
    for path in keyword_files():
        file = read_keyword_file(read_source(path))
        names = tuple((kind, invented(words), invented(name)) for kind, words, name in file.names)
        made = KeywordFile(
            file.source,
            tuple(map(_entry, file.entries)),
            tuple(map(_type, file.types)),
            names,
            _language(file.language),
        )
        files.append(made)
    vocabulary = Vocabulary(files)
    names_of_world = world_names(None)
    for kind, listed in (
        ("place", names_of_world.places), ("person", names_of_world.people), ("object", names_of_world.objects)
    ):  # fmt: skip
        vocabulary.add_names(kind, map(invented, listed))
    return vocabulary


_PORTS = {
    "ID", "msec", "delay_msec", "num_cycles", "num_attempts", "success_count", "failure_count", "code", "value",
    "_skipIf", "output_key",
}  # fmt: skip


@pytest.mark.parametrize("sample", SAMPLES, ids=[s.stem for s in SAMPLES])
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
    slots = {slot.name for entries in world_vocabulary().entries.values() for e in entries for slot in e.slots}

    def text_of(name: str, text: str) -> str:
        if name == "_skipIf":
            return text
        return change(text).replace(change("each_"), "each_")  # type: ignore[no-any-return]

    return [
        (
            node.id,
            len(node.children),
            sorted(
                (name if name in _PORTS | slots else change(name), text_of(name, text)) for name, text in node.ports
            ),
        )
        for node in tree.walk()
    ]
