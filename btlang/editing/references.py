"""References: which words of a text name something that is said elsewhere, and where that is."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping
from functools import lru_cache

from btlang.api import Mission
from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.files import included_path, read_source
from btlang.editing.reading import TextReading
from btlang.frontends.mission.symbols.needs import find_needs
from btlang.frontends.mission.token import Called, Listed, Token, texts_of
from btlang.support.record import Record
from btlang.text.source import Source, Span
from btlang.text.toml import find_positions, parse_toml
from btlang.text.words import split
from btlang.tree import ast
from btlang.tree.catalogue import SUBTREE
from btlang.vocabulary.shipped import DEFAULT_WORLD
from btlang.vocabulary.value_type import WORLD

_QUOTED = re.compile(r"[\"'“”„«»’‘]([^\"'“”„«»’‘\n]+)[\"'“”„«»’‘]")  # noqa: RUF001


class Reference(Record):
    """Characters of a text that name something, and where that is: its words, or a file as a whole.

    A definition refers to itself.
    """

    start: int
    end: int
    target: Span


class NameUse(Record):
    """A use of a definition: by its words, or quoted in a node that is said by its id."""

    span: Span
    is_exact: bool


def uses_of(mission: Mission, name: str) -> Iterator[NameUse]:
    """Yield the uses of a definition in the order of the bodies."""
    assert mission.syntax is not None
    for body in ast.bodies(mission.syntax):
        for part in ast.parents_first(body):
            if isinstance(part, ast.Name) and part.name == name:
                yield NameUse(part.span, False)
            elif isinstance(part, ast.Exact) and part.id == SUBTREE and dict(part.ports).get("ID") == name:
                yield NameUse(part.span, True)


def references(read: TextReading) -> list[Reference]:
    """Return the references of a mission in English: to definitions, files, names of the world, and words in keyword
    files.

    Raises MissionError for words that can't be used.
    """
    source, lexer = read.source, read.lexer
    found = list(_files(read))
    world = {fact.name: fact.span for fact in lexer.names.facts}
    world = {**_names_in_world(read), **world}
    for token in lexer.tokens:
        said = token.value
        if not isinstance(said, Called | Listed) or said.entry.sort == "name":
            continue
        if said.entry.span is not None:
            found.append(Reference(token.start, token.end, said.entry.span))
        found += _names_in(source, token, said, world)
    if read.mission is not None and read.mission.syntax is not None:
        for definition in ast.all_definitions(read.mission.syntax):
            places = (definition.name_span, *(use.span for use in uses_of(read.mission, definition.name)))
            own = {(place.start, place.end) for place in places if place.source is source}
            found += (Reference(start, end, definition.name_span) for start, end in sorted(own))
    return found


def quoted_files(source: Source) -> Iterator[Reference]:
    """Yield the texts in quotes that are paths of files, in any notation. A text without a file names none."""
    for quoted in _QUOTED.finditer(source.text) if source.roots else ():
        where, real = included_path(quoted[1], source)
        if os.path.isfile(real):
            yield Reference(quoted.start(1), quoted.end(1), Span(Source("", where), 0, 0))


def _files(read: TextReading) -> Iterator[Reference]:
    """Yield the files that the text names: missions that it includes, its world, its robot and its keyword files."""
    source, lexer = read.source, read.lexer
    needs = find_needs(split(source, lexer.vocabulary.orthography), lexer.vocabulary).found
    named = [(need.path, need.span) for need in needs]
    named += ((include.path, include.span) for include in lexer.names.includes)
    for path, span in named:
        quoted = _QUOTED.search(span.text)
        if quoted is not None:
            where = included_path(path, source)[0]
            yield Reference(span.start + quoted.start(1), span.start + quoted.end(1), Span(Source("", where), 0, 0))


def _names_in(source: Source, token: Token, said: Called | Listed, world: Mapping[str, Span]) -> Iterator[Reference]:
    """Yield the names of the world that a phrase says."""
    if not any(slot.type in WORLD for slot in said.entry.slots):
        return
    words = source.text[token.start : token.end]
    for name in dict.fromkeys(texts_of(said)):
        if name in world:
            spelt = r"\s+".join(map(re.escape, name.split()))
            for place in re.finditer(rf"(?<!\w){spelt}(?!\w)", words, re.IGNORECASE):
                yield Reference(token.start + place.start(), token.start + place.end(), world[name])


def _names_in_world(read: TextReading) -> Mapping[str, Span]:
    """Return the names of the world of a mission, each with its place in the world file."""
    world = read.mission.world if read.mission is not None else read.words.world
    if isinstance(world, Source):
        return {}
    path = os.fspath(world or DEFAULT_WORLD)
    try:
        return _world_names(path, os.stat(path).st_mtime_ns)
    except (OSError, MissionError, ValueError):  # which the messages of the mission say
        return {}


@lru_cache(maxsize=8)
def _world_names(path: str, _time: int) -> Mapping[str, Span]:
    source = read_source(path)
    places = find_positions(source.text)
    found: dict[str, Span] = {}
    for key, rows in parse_toml(source.text).items():
        for number, row in enumerate(rows if isinstance(rows, list) else ()):
            name = row.get("name") if isinstance(row, dict) else None
            at = places.get((key, number, "name"))
            if isinstance(name, str) and at is not None:
                start = source.text.find(name, at)
                found[name] = Span(source, start, start + len(name)) if start >= 0 else Span(source, at, at)
        if isinstance(rows, dict) and (key,) in places:  # such as the dock, which is called so
            found.setdefault(rows.get("name", key), Span(source, places[(key,)], places[(key,)] + len(key)))
    return found
