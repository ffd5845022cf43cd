"""Finds keyword files and packs and loads a vocabulary from them."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.diagnostics.reading import read_source
from btlang.text.source import Source, Span
from btlang.vocabulary.cache import cached, recent, stamp
from btlang.vocabulary.entry import Entry
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.shipped import keyword_files

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

ENTRY_POINTS = "btlang.keywords"


def load_vocabulary(
    keywords: Sequence[str | Entry | Callable[..., Any]] = (), names: Mapping[str, Sequence[str]] | None = None
) -> Lexicon:
    """The shipped words and those of `keywords`: paths of keyword files, names of installed packs, entries, or
    functions that carry one (see `btlang.action`). `names` adds values of types, such as the places of a world.

    A pack is an entry point of the group `btlang.keywords` whose value is a module beside which, or a function that
    returns the path at which, its keyword file lies. Raises MissionError (BT001, BT002, BT060 to BT063).
    """
    paths = [_path(item) for item in keywords if isinstance(item, str)]
    entries = [_entry(item) for item in keywords if not isinstance(item, str)]
    vocabulary = _words([*keyword_files(), *paths], entries)
    return vocabulary.with_names(names) if names else vocabulary


_own: dict[tuple[object, ...], tuple[Sequence[Entry], Lexicon]] = {}  # the entries stay, so that no id is used again


def _words(files: Sequence[str], entries: Sequence[Entry]) -> Lexicon:
    """Made once in a process for the same files and entries."""
    if not entries:
        return cached("words", files, lambda: _made(files, ()))
    try:
        key = (*map(stamp, files), *map(id, entries))
    except OSError:
        return _made(files, entries)
    return recent(_own, key, lambda: (entries, _made(files, entries)))[1]


def _made(paths: Sequence[str], entries: Iterable[Entry]) -> Lexicon:
    """The vocabulary of keyword files, the shipped ones among them, and of entries."""
    from btlang.vocabulary.keyword_file import KeywordFile, read_keyword_file  # not where the cache has it

    shown = {path: "keywords/" + os.path.basename(path) for path in keyword_files()}
    files: list[KeywordFile] = []
    problems = []
    for path in paths:
        try:
            files.append(read_keyword_file(Source(read_source(path).text, shown.get(path, path))))
        except MissionError as error:
            problems += error.diagnostics
    if problems:
        raise MissionError(problems)
    return Lexicon(files, entries)


def _entry(word: Entry | Callable[..., Any]) -> Entry:
    entry = word if isinstance(word, Entry) else getattr(word, "btlang_entry", None)
    if not isinstance(entry, Entry):
        raise TypeError(f"{word!r} isn't a word: decorate it with btlang.action or btlang.condition")
    return entry


def _path(name: str) -> str:
    if os.path.exists(name) or name.endswith(".toml"):
        return name
    from importlib.metadata import entry_points  # costs more than a whole check: only for named packs

    for entry_point in entry_points(group=ENTRY_POINTS, name=name):
        pack = entry_point.load()
        return str(pack() if callable(pack) else os.path.join(os.path.dirname(pack.__file__), f"{name}.toml"))
    raise MissionError([diagnostic("BT063", Span(Source("", name), 0, 0), name=name)])
