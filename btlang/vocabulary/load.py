"""Finds keyword files and packs and loads a vocabulary from them."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.diagnostics.files import read_source
from btlang.support.gc_pause import gc_paused
from btlang.text.source import Source, Span
from btlang.vocabulary.cache import cached, recent, stamp
from btlang.vocabulary.entry import Entry
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.nouns import Features
from btlang.vocabulary.shipped import ENGLISH, keyword_files, language_folder, languages, shipped, shown_name

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    from btlang.vocabulary.keyword_file import KeywordFile

    Keywords: TypeAlias = Sequence[str | os.PathLike[str] | Entry | Callable[..., Any]]
    """Paths of keyword files, names of installed packs, entries, and functions that carry one."""

ENTRY_POINTS = "btlang.keywords"


def load_vocabulary(
    keywords: Sequence[str | Entry | Callable[..., Any]] = (),
    names: Mapping[str, Sequence[str]] | None = None,
    language: str = ENGLISH,
    features: Features | None = None,
) -> Lexicon:
    """The words of a language and those of `keywords`: paths of keyword files, names of installed packs, entries, or
    functions that carry one (see `btlang.action`). `names` adds values of types, such as the places of a world, and
    `features` says what they are like.

    A pack is an entry point of the group `btlang.keywords`: a module with its keyword file beside it, or a function
    that returns the path of that file. `language` is one that ships or the path of a folder like theirs.
    Raises MissionError (BT001, BT002, BT060 to BT065).
    """
    vocabulary = _words(_folder(language), *_items(keywords))
    return vocabulary.with_names(names, features) if names else vocabulary


def vocabulary_with(
    file: Source | KeywordFile, keywords: Sequence[str | Entry | Callable[..., Any]] = (), language: str = ENGLISH
) -> Lexicon:
    """The same with a further keyword file, its text or what it declares. Raises MissionError (BT001, BT002, BT060 to
    BT065).
    """
    folder = _folder(language)
    paths, entries = _items(keywords)
    return _made(paths, entries, folder, [file])


def _folder(language: str) -> str:
    folder = language_folder(language)
    if folder is None:
        known = ", ".join(languages())
        raise MissionError([diagnostic("BT065", Span(Source("", "--language"), 0, 0), name=language, known=known)])
    return folder


def _items(keywords: Sequence[str | Entry | Callable[..., Any]]) -> tuple[list[str], list[Entry]]:
    """The paths of keyword files, and the entries."""
    paths = [keyword_path(item) for item in keywords if isinstance(item, str)]
    return paths, [_entry(item) for item in keywords if not isinstance(item, str)]


_own: dict[tuple[object, ...], tuple[Sequence[Entry], Lexicon]] = {}  # the entries stay, so that no id is used again


def _words(folder: str, paths: Sequence[str], entries: Sequence[Entry]) -> Lexicon:
    """Made once in a process for the same files and entries."""
    if not paths and not entries:
        return _kept(folder, ())
    try:
        key = (*map(stamp, [*_files(folder), *paths]), *map(id, entries))
    except OSError:
        return _made(paths, entries, folder)
    return recent(_own, key, lambda: (entries, _made(paths, entries, folder)))[1]


def _files(folder: str) -> list[str]:
    """The keyword files of a language; those of English are parts of another one."""
    english = shipped("keywords", ENGLISH)
    return [*(() if folder == english else keyword_files(english)), *keyword_files(folder)]


def _kept(folder: str, paths: Sequence[str]) -> Lexicon:
    """The vocabulary of files alone, from the cache if it has it."""
    kind = "words" if paths else "language"
    return cached(kind, [*_files(folder), *paths], lambda: _made_of_all(folder, _read_all(paths, _kept_file), ()))


def _made(
    paths: Sequence[str], entries: Sequence[Entry], folder: str, further: Sequence[Source | KeywordFile] = ()
) -> Lexicon:
    """The vocabulary of a language, of keyword files, those at paths and further ones, and of entries."""
    try:
        own = _read_all(paths, _kept_file)
    except MissionError:
        _read_all([*keyword_files(folder), *paths], _read_file)  # what is wrong with any of them, all at once
        raise
    own += (_read(file) if isinstance(file, Source) else file for file in further)
    if all(file.shipped and not (file.types or file.names or file.language or file.nouns) for file in own):
        added = [*(entry for file in _after_yielding(own, entries) for entry in file.entries), *entries]
        made = _kept(folder, ()).extended(added)
        if made is not None:
            return made
    return _made_of_all(folder, own, entries) if entries or further else _kept(folder, paths)


def _made_of_all(folder: str, own: Sequence[KeywordFile], entries: Sequence[Entry]) -> Lexicon:
    files = _read_all(keyword_files(folder), _read_file)
    if not all(file.shipped for file in (*files, *own)):  # what no phrase says is a part of the language
        files = [
            file.replace(entries=tuple(e for e in file.entries if not (e.phrases or e.quantity or e.verbs)), nouns=())
            for file in files
        ]
    english = shipped("keywords", ENGLISH)
    known = None if folder == english else _kept(english, ())
    with gc_paused:  # a vocabulary is a hundred thousand objects, none of them garbage
        return Lexicon(_after_yielding([*files, *own], entries), entries, known, folder)


def _read_all(paths: Iterable[str], read: Callable[[str], KeywordFile]) -> list[KeywordFile]:
    """The keyword files at paths. Raises MissionError with what is wrong with all of them."""
    files: list[KeywordFile] = []
    problems = []
    for path in paths:
        try:
            files.append(read(path))
        except MissionError as error:
            problems += error.diagnostics
    if problems:
        raise MissionError(problems)
    return files


def _kept_file(path: str) -> KeywordFile:
    """A file of users, from the cache if it has it; what ships is kept as one vocabulary."""
    return cached("file", [path], lambda: _read_file(path))


def _read_file(path: str) -> KeywordFile:
    return _read(Source(read_source(path).text, shown_name(path)))


def _read(source: Source) -> KeywordFile:
    from btlang.vocabulary import keyword_file  # not where the cache has it

    return keyword_file.read_keyword_file(source)


def _after_yielding(files: Sequence[KeywordFile], entries: Iterable[Entry]) -> list[KeywordFile]:
    """The files without the entries that yield to another one with their id and a function."""
    given = [*(entry for file in files for entry in file.entries), *entries]
    taken = {entry.id for entry in given if entry.call and not entry.yields}
    marked = {entry.id for entry in given if entry.accompaniment and entry.yields} & taken

    def kept(entry: Entry) -> Entry:
        return entry.replace(accompaniment=True) if entry.id in marked else entry

    return [
        file.replace(
            entries=tuple(
                kept(entry) for entry in file.entries if not (entry.call and entry.yields and entry.id in taken)
            )
        )
        for file in files
    ]


def _entry(word: Entry | Callable[..., Any]) -> Entry:
    entry = word if isinstance(word, Entry) else getattr(word, "btlang_entry", None)
    if not isinstance(entry, Entry):
        raise TypeError(f"{word!r} isn't a word: decorate it with btlang.action or btlang.condition")
    return entry


def keyword_path(name: str) -> str:
    """The file of a keyword file or of an installed pack. Raises MissionError (BT063)."""
    if os.path.exists(name) or name.endswith(".toml"):
        return name
    from importlib.metadata import entry_points  # costs more than a whole check: only for named packs

    for entry_point in entry_points(group=ENTRY_POINTS, name=name):
        pack = entry_point.load()
        return str(pack() if callable(pack) else os.path.join(os.path.dirname(pack.__file__), f"{name}.toml"))
    raise MissionError([diagnostic("BT063", Span(Source("", name), 0, 0), name=name)])
