"""TOML files for editors: keyword files, worlds and robots. What one is, its tables say."""

from __future__ import annotations

import re

from btlang.diagnostics.diagnostic import Diagnostic, MissionError
from btlang.lsp.documents import Snapshot
from btlang.robots.bodies.body import Body
from btlang.robots.bodies.body_file import load_body
from btlang.robots.files import DataFileError, as_mission_error
from btlang.robots.worlds.world_file import NAMED, load_world
from btlang.text.source import Source
from btlang.text.toml import find_positions
from btlang.vocabulary.capabilities import CAPABILITIES
from btlang.vocabulary.keyword_file import keys_of
from btlang.vocabulary.load import vocabulary_with

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

KEYWORDS, WORLD, ROBOT = "keywords", "world", "robot"
_KEYS = {KEYWORDS: keys_of(""), WORLD: ["start", "walls", "boxes", "clock", *NAMED], ROBOT: list(Body.fields)}
_TOP_KEY = re.compile(r"^(?:\[\[?\s*)?([A-Za-z_]\w*)\s*(?:[=.\]])", re.MULTILINE)
_HEADER = re.compile(r"^\[\[?\s*([\w.]+)\s*\]", re.MULTILINE)
_NEEDS = re.compile(r"needs\s*=\s*\[[^\]]*\"([^\"\]]*)$")
_WORD = re.compile(r"[\w]*\Z")


def kind_of_tables(text: str) -> str:
    """Return what most of the keys of a file belong to."""
    found = _TOP_KEY.findall(text)
    return max(_KEYS, key=lambda kind: sum(key in _KEYS[kind] for key in found))


def table_problems(source: Source, snapshot: Snapshot) -> list[Diagnostic]:
    """Return what is wrong with a file. No code that it names is run."""
    kind = kind_of_tables(source.text)
    try:
        if kind == KEYWORDS:
            vocabulary_with(source, language=snapshot.words.language)
        elif kind == WORLD:
            load_world(source)
        else:
            load_body(source)
    except MissionError as error:
        return list(error.diagnostics)
    except DataFileError as error:
        return list(as_mission_error(error).diagnostics)
    return []


def analyse_tables(source: Source, _: Snapshot) -> dict[str, Any]:
    """Return the `outline` of a file: its tables, each up to the next one, by the names in them."""
    places = sorted((at, path) for path, at in find_positions(source.text).items() if len(path) == 1 or path[1:2] != ())
    found: list[dict[str, Any]] = []
    named = {path[:2]: at for at, path in places if len(path) == 3 and path[2] in ("name", "id")}
    tables = [(at, path) for at, path in places if len(path) == 1 or (len(path) == 2 and isinstance(path[1], int))]
    for number, (at, path) in enumerate(tables):
        if len(path) == 1 and number + 1 < len(tables) and tables[number + 1][0] == at:
            continue  # the first of a list says it
        following = (other for other, _ in tables[number + 1 :] if other > at)
        end = at + len(source.text[at : next(following, len(source.text))].rstrip())
        name = str(path[0])
        if path in named:
            value = source.text[named[path] :].partition("=")[2].partition("\n")[0]
            name = f"{name} {value.split(',')[0].strip(' {}')}"
        first = source.text[at:end].partition("\n")[0]
        found.append({"name": name, "start": at, "end": at + len(first), "of": (at, end), "kind": "fact"})
    return {"outline": found}


def complete_tables(text: str, at: int) -> dict[str, Any]:
    """List the keys that may follow at a character, and capabilities in `needs`, as btlang.editing.help.complete
    does.
    """
    before = text[:at]
    line = before.rpartition("\n")[2]
    needs = _NEEDS.search(line)
    if needs is not None:
        return {"completions": [_option(each, at - len(needs[1]), "value") for each in CAPABILITIES]}
    if not re.fullmatch(r"[\s\[]*\w*", line):
        return {"completions": []}
    headers = _HEADER.findall(before)
    kind = kind_of_tables(text)
    start = at - len(_WORD.search(before)[0])  # type: ignore[index]
    is_entry = kind == KEYWORDS and headers and "[" not in line
    keys = keys_of(headers[-1]) if is_entry else _KEYS[kind]
    return {"completions": [_option(key, start, "name") for key in keys]}


def _option(text: str, start: int, kind: str) -> dict[str, Any]:
    return {"text": text, "start": start, "kind": kind, "help": "", "spelling": False}
