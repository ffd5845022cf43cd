"""What can be put into a mission, by topic, each as a text that is whole: phrases, forms, the mission's own names."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import lru_cache

from btlang.diagnostics.diagnostic import MissionError
from btlang.editing.forms import FORMS
from btlang.editing.words import Words
from btlang.frontends.mission.reader import lexed, read_mission
from btlang.frontends.table import frontend_of
from btlang.passes import compile_mission
from btlang.printer.exact import quoted
from btlang.text.source import Source
from btlang.vocabulary.entry import Entry
from btlang.vocabulary.items import Item, items
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.pattern import Form, Slot, forms, name_form
from btlang.vocabulary.value_type import ValueType

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_SORTS = {"command": "action", "condition": "condition", "word": "form"}
_OWN = "this mission"


def palette(source: Source, words: Words) -> dict[str, Any]:
    """Return what can be put in, and put round what is there.

    `topics`: each with its `topic` and its `items`, the names of the mission first.

    An item has its `words`, `help`, `example`, `sort` ("action", "condition", "form" or "name") and what to `insert`: a
    whole command or condition, with examples in its slots.

    `forms`: what nodes can be wrapped in (btlang.editing.forms): `name`, `sort` of what it is round ("command" or
    "condition"), what it `needs` and an `example` of that. Raises MissionError for words that can't be used.
    """
    vocabulary = words.vocabulary(source)
    own = [*_names(source, vocabulary)] if frontend_of(source) == "english" else []
    topics = [{"topic": _OWN, "items": own}] if own else []
    return {"topics": [*topics, *_shipped(vocabulary)], "forms": [*_forms(vocabulary)]}


def _forms(vocabulary: Lexicon) -> Iterator[dict[str, str]]:
    for name, form in FORMS.items():
        example = vocabulary.types[form.needs].example if form.needs in vocabulary.types else ""
        sort = "condition" if form.of_conditions else "command"
        yield {"name": name, "sort": sort, "needs": form.needs, "example": example}


def _names(source: Source, vocabulary: Lexicon) -> Iterator[dict[str, str]]:
    definitions = lexed(source, vocabulary).names.definitions
    for header in definitions.headers.values():
        if header.name:
            types = dict(definitions.types.get(header.body, ()))
            insert = _filled(name_form(header.name), types, vocabulary)
            if header.is_quoted:
                insert = f"{vocabulary.word('do')} {quoted(header.name, vocabulary)}"
            yield {"words": header.name, "help": "", "example": "", "sort": "name", "insert": insert}


@lru_cache(maxsize=4)
def _shipped(vocabulary: Lexicon) -> list[dict[str, Any]]:
    topics: dict[str, list[dict[str, str]]] = {}
    for item in items(vocabulary):
        insert = _inserted(item, vocabulary)
        if insert:
            topics.setdefault(item.topic, []).append(
                {
                    "words": item.ways[0], "help": item.help, "example": item.example, "sort": _SORTS[item.sort],
                    "insert": insert,
                }
            )  # fmt: skip
    return [{"topic": topic, "items": found} for topic, found in topics.items()]


def _inserted(item: Item, vocabulary: Lexicon) -> str:
    """Return the example where it is whole in this world and says the item; else the phrase with other values."""
    if item.sort == "value":
        return ""
    own = vocabulary.entries.get(item.names[0], ())
    entry = next((entry for entry in own if entry.phrases and entry.help.split() == item.help.split()), None)
    if item.sort == "word":
        return item.example if _says(item, vocabulary) and _is_whole(item.example, vocabulary) else ""
    ways = [item.example, *(_example(entry, vocabulary) if entry is not None else ())]
    before = f"{vocabulary.word('check')} " if item.sort == "condition" else ""
    return next((way for way in ways if way and _is_whole(before + way, vocabulary)), "")


def _says(item: Item, vocabulary: Lexicon) -> bool:
    """Return whether its example has its words: that of a word about other files has not, since it runs without
    them.
    """
    example = vocabulary.orthography.words(re.sub(r"[,:.]", " ", item.example.lower()))
    plain = (tuple(part for part in form if isinstance(part, str)) for way in item.ways for form in forms(way))
    return any(set(form) <= set(example) for form in plain)


def _example(entry: Entry, vocabulary: Lexicon) -> Iterator[str]:
    """Return a phrase with examples of values."""
    types = {slot.name: slot.type for slot in entry.slots}
    for phrase in entry.phrases:
        for form in reversed(forms(phrase)):
            yield _filled(form, types, vocabulary)


def _filled(form: Form, types: dict[str, str], vocabulary: Lexicon) -> str:
    return " ".join(
        _value(vocabulary.types[types.get(part.name, "text")], vocabulary) if isinstance(part, Slot) else part
        for part in form
    )


def _value(kind: ValueType, vocabulary: Lexicon) -> str:
    listed = vocabulary.values.listed(kind.name)
    return listed[0] if listed else kind.example


def _is_whole(text: str, vocabulary: Lexicon) -> bool:
    try:
        compile_mission(read_mission(Source(text), vocabulary).mission, vocabulary)
    except MissionError:
        return False
    return True
