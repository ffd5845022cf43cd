"""Palettes: the phrases, forms and names that can be put into a mission, by topic, each as a whole text.

Forms, in which commands and conditions can be wrapped, go by the names that editors use for them.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from functools import lru_cache

from btlang.diagnostics.diagnostic import MissionError
from btlang.editing.syntax import Unplaced
from btlang.editing.words import RobotWords
from btlang.frontends.mission.reader import lexed, read_mission
from btlang.frontends.table import frontend_of
from btlang.passes import compile_mission
from btlang.printer.exact import quote
from btlang.support.record import Record
from btlang.text.source import Source
from btlang.tree import ast
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


def palette(source: Source, words: RobotWords) -> dict[str, Any]:
    """Return what can be put in, and put round what is there.

    `topics`: each with its `topic` and its `items`, the names of the mission first.

    An item has its `words`, `help`, `example`, `sort` ("action", "condition", "form" or "name") and what to `insert`: a
    whole command or condition, with examples in its slots.

    `forms`: what nodes can be wrapped in (btlang.editing.palette): `name`, `sort` of what it is round ("command" or
    "condition"), what it `needs` and an `example` of that. Raises MissionError for words that can't be used.
    """
    vocabulary = words.vocabulary(source)
    own = [*_names(source, vocabulary)] if frontend_of(source) == "english" else []
    topics = [{"topic": _OWN, "items": own}] if own else []
    return {"topics": [*topics, *_list_shipped(vocabulary)], "forms": [*_forms(vocabulary)]}


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
            insert = _fill(name_form(header.name), types, vocabulary)
            if header.is_quoted:
                insert = f"{vocabulary.word('do')} {quote(header.name, vocabulary)}"
            yield {"words": header.name, "help": "", "example": "", "sort": "name", "insert": insert}


@lru_cache(maxsize=4)
def _list_shipped(vocabulary: Lexicon) -> list[dict[str, Any]]:
    topics: dict[str, list[dict[str, str]]] = {}
    for item in items(vocabulary):
        insert = _insert(item, vocabulary)
        if insert:
            topics.setdefault(item.topic, []).append(
                {
                    "words": item.ways[0], "help": item.help, "example": item.example, "sort": _SORTS[item.sort],
                    "insert": insert,
                }
            )  # fmt: skip
    return [{"topic": topic, "items": found} for topic, found in topics.items()]


def _insert(item: Item, vocabulary: Lexicon) -> str:
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
            yield _fill(form, types, vocabulary)


def _fill(form: Form, types: dict[str, str], vocabulary: Lexicon) -> str:
    return " ".join(
        _value(vocabulary.types[types.get(part.name, "text")], vocabulary) if isinstance(part, Slot) else part
        for part in form
    )


def _value(kind: ValueType, vocabulary: Lexicon) -> str:
    listed = vocabulary.values.listed(kind.name)
    return listed[0] if listed else kind.example


def _is_whole(text: str, vocabulary: Lexicon) -> bool:
    if any(token.kind == "unknown" for token in lexed(Source(text), vocabulary).tokens):
        return False  # as most that are tried; to explain what is wrong with them takes long
    try:
        compile_mission(read_mission(Source(text), vocabulary).mission, vocabulary)
    except MissionError:
        return False
    return True


class EditorForm(Record):
    """A form of the language.

    `needs` is "condition", the type of an amount, or "". `make` makes it of a body and of what it needs; one with an
    `operator` is a chain of two or more instead. One of `of_conditions` is round conditions, any other one round
    commands.
    """

    needs: str = ""
    make: Callable[[ast.Ast, Any], ast.Ast] | None = None
    operator: str = ""
    of_conditions: bool = False

    def made(self, body: ast.Ast, what: object) -> ast.Ast:
        """Make a form, but only one without an operator."""
        assert self.make is not None
        return self.make(body, what)


FORMS: Mapping[str, EditorForm] = {
    "repeat": EditorForm("count", lambda body, rounds: ast.Repeat(rounds, body, body.span)),
    "forever": EditorForm("", lambda body, _: ast.Repeat("-1", body, body.span)),
    "retry": EditorForm("count", lambda body, attempts: ast.Retry(attempts, body, "", body.span)),
    "try": EditorForm("", lambda body, _: ast.Try(body, None, body.span)),
    "within": EditorForm("duration", lambda body, seconds: ast.Within(seconds, body, body.span)),
    "for": EditorForm("duration", lambda body, seconds: ast.For(seconds, body, body.span)),
    "up to": EditorForm("duration", lambda body, seconds: ast.UpTo(seconds, body, body.span)),
    "every": EditorForm("duration", lambda body, seconds: ast.Every(seconds, body, "", body.span)),
    "after": EditorForm("duration", lambda body, seconds: ast.Delay(seconds, body, body.span)),
    "until time": EditorForm("time_of_day", lambda body, time: ast.UntilTime(time, body, body.span)),
    "by time": EditorForm("time_of_day", lambda body, time: ast.ByTime(time, body, body.span)),
    "if": EditorForm("condition", lambda body, condition: ast.If(False, condition, body, None, body.span)),
    "unless": EditorForm("condition", lambda body, condition: ast.If(True, condition, body, None, body.span)),
    "while": EditorForm("condition", lambda body, condition: ast.While(False, condition, body, None, body.span)),
    "until": EditorForm("condition", lambda body, condition: ast.While(True, condition, body, None, body.span)),
    "provided": EditorForm("condition", lambda body, condition: ast.Provided(condition, body, body.span)),
    "stop when": EditorForm("condition", lambda body, condition: ast.StopWhen(condition, body, body.span)),
    "whenever": EditorForm("condition", lambda body, condition: ast.Whenever(condition, body, False, body.span)),
    "in sequence": EditorForm(operator="sequence"),
    "in parallel": EditorForm(operator="parallel"),
    "in order": EditorForm(operator="fallback"),
    "not": EditorForm("", lambda body, _: ast.Not(body, body.span), of_conditions=True),
    "all of": EditorForm(operator="all", of_conditions=True),
    "any of": EditorForm(operator="any", of_conditions=True),
}


def amount_of(kind: str, words: str, vocabulary: Lexicon) -> str:
    """Return the port text of an amount. Raises Unplaced."""
    if not kind:
        return ""
    found = vocabulary.value(kind, words)
    if found is None:
        example = vocabulary.types[kind].example
        raise Unplaced(f"'{words}' is no {kind.replace('_', ' ')}, such as {example}")
    return found
