"""The vocabulary of a mission: the words of its language and keyword files, with the names of its world."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from importlib import import_module

from btlang.diagnostics.diagnostic import Diagnostic, MissionError
from btlang.frontends.table import XML_ENDINGS
from btlang.text.source import Source, Span
from btlang.text.words import split
from btlang.vocabulary.cache import cached, recent, stamp
from btlang.vocabulary.entry import Entry
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.load import load_vocabulary, vocabulary_with
from btlang.vocabulary.nouns import Features
from btlang.vocabulary.shipped import DEFAULT_WORLD, ENGLISH

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias, TypeVar

    from btlang.vocabulary.load import Keywords

    Path: TypeAlias = str | os.PathLike[str]
    World = TypeVar("World", bound=Path | Source | None)


def mission_vocabulary(
    source: Source,
    keywords: Keywords,
    world: World,
    language: str = ENGLISH,
    *,
    has_robot: bool = False,
) -> tuple[Lexicon, World | str]:
    """Make the words of a text and its world, with the files that its first lines name.

    A given `world` wins over the text's own; `keywords` are added to its own. The robot that it names has words and a
    world, too, unless one is chosen already (`has_robot`), or the text isn't of a file that the user named: that text
    is for the robot that runs it. Raises MissionError.
    """
    keywords = _words_of(keywords)
    first = _FIRST_LINE.match(source.text)
    if first is None or _QUOTES.isdisjoint(first[1]):
        return world_vocabulary(keywords, world, language), world
    from btlang.diagnostics.files import OUTSIDE, included_path, is_within
    from btlang.frontends.mission.symbols.needs import ROBOT, WORDS, WORLD, find_needs, unusable

    vocabulary = load_vocabulary([word for word in keywords if not _is_xml(word)], None, language)
    files: dict[str, str] = {}
    lines: dict[str, Span] = {}
    problems: list[Diagnostic] = []
    for need in find_needs(split(source, vocabulary.orthography), vocabulary).found:
        if (need.role == WORLD and world is not None) or (need.role == ROBOT and (has_robot or not source.may_load)):
            continue
        path, real = included_path(need.path, source)
        if not source.may_load:
            problems.append(unusable(need, "only a mission that you name yourself can load files"))
        elif not is_within(real, source):
            problems.append(unusable(need, OUTSIDE))
        elif os.path.exists(real) and not os.path.isfile(real):
            problems.append(unusable(need, "it isn't a regular file"))
        files[path], lines[path] = need.role, need.span
    if problems:
        raise MissionError(problems)
    own = [path for path, role in files.items() if role == WORDS and path not in keywords]
    chosen: World | str = next((path for path, role in files.items() if role == WORLD), world)
    try:
        for robot in [path for path, role in files.items() if role == ROBOT]:
            body = import_module("btlang.robots.registry").body_of(robot)
            brought = import_module("btlang.components.words").words_of(body)  # which most missions don't need
            own += [word for word in brought if word not in own and word not in keywords]
            chosen = chosen or body.world or world
        return world_vocabulary([*own, *keywords], chosen, language), chosen
    except MissionError as error:
        raise MissionError([_at_line(problem, lines) for problem in error.diagnostics]) from None


_QUOTES = frozenset("\"'“”„«»’‘")  # noqa: RUF001
_FIRST_LINE = re.compile(r"(?:#[^\n]*\n|[\s\ufeff])*([^\n]*)")


def _at_line(problem: Diagnostic, lines: Mapping[str, Span]) -> Diagnostic:
    """Add the line that names a file to a problem with that file."""
    line = lines.get(problem.span.source.name)
    if line is None:
        return problem
    if not problem.span.source.text:
        return problem.replace(span=line)  # type: ignore[no-any-return]
    return problem.replace(notes=(*problem.notes, (line, "The mission needs this file.")))  # type: ignore[no-any-return]


def world_vocabulary(
    keywords: Keywords = (),
    world: Path | Source | None = None,
    language: str = ENGLISH,
) -> Lexicon:
    """Make the words of a language, of keyword files and of a world's names; `keywords` as for `parse_tree`.

    Nodes of XML files get words that all others leave free, as `btc words --from` makes them. Raises MissionError.
    """
    keywords, world = _words_of(keywords), world_of(world)
    find = partial(_names_by_type, world)
    if isinstance(world, Source):
        by_type, features = recent(_names, world.text, find)
    else:
        by_type, features = cached("world", [DEFAULT_WORLD if world is None else world], find)
    others = [word for word in keywords if not _is_xml(word)]
    vocabulary = load_vocabulary(others, by_type, language, features)
    models = [str(word) for word in keywords if _is_xml(word)]
    if not models:
        return vocabulary

    def make() -> Lexicon:
        from btlang.backends.keyword_pack import vocabulary_of_models  # most missions have only other words

        return vocabulary_of_models(models, vocabulary, partial(vocabulary_with, keywords=others, language=language))

    try:
        key = (id(vocabulary), *map(stamp, models))
    except OSError:
        return make().with_names(by_type, features)
    return recent(_with_models, key, lambda: (vocabulary, make()))[1].with_names(by_type, features)


def _words_of(keywords: Keywords) -> Sequence[str | Entry | Callable[..., Any]]:
    if isinstance(keywords, str | os.PathLike) or callable(keywords):
        raise TypeError(f"keywords is a list of files, packs and functions, not {described(keywords)}")
    return [os.fspath(word) if isinstance(word, os.PathLike) else word for word in keywords]


_with_models: dict[tuple[object, ...], tuple[Lexicon, Lexicon]] = {}  # the first stays, so that no id is used again


def _is_xml(word: object) -> bool:
    return isinstance(word, str) and word.endswith(XML_ENDINGS)


_names: dict[str, tuple[dict[str, tuple[str, ...]], Features]] = {}  # by the text of the world


def _names_by_type(world: str | Source | None) -> tuple[dict[str, tuple[str, ...]], Features]:
    from btlang.robots.worlds.world_file import WorldError, world_names

    try:
        names = world_names(world)
    except WorldError as error:
        from btlang.robots.files import as_mission_error

        raise as_mission_error(error) from None
    return names.by_type, names.features


def described(value: object) -> str:
    """Say what a value of a wrong type is, for the message of a TypeError: `a list`, `None`."""
    name = type(value).__name__
    return "None" if value is None else f"{'an' if name[0].lower() in 'aeiou' else 'a'} {name}"


def world_of(world: Path | Source | None) -> str | Source | None:
    """Return the world as a path or a Source. Raises TypeError for anything else."""
    if world is None or isinstance(world, str | Source):
        return world
    if isinstance(world, os.PathLike):
        return os.fspath(world)
    raise TypeError(f"world is the path of a world file, or its text as a Source, not {described(world)}")
