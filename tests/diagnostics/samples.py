"""The diagnostics of every bad sample that `btc check` reads, for tests of what is made of them."""

from __future__ import annotations

import os
from functools import cache
from pathlib import Path

from btlang.diagnostics.diagnostic import Diagnostic, MissionError
from btlang.diagnostics.files import read_source
from btlang.frontends.btcpp.reader import read_xml
from btlang.frontends.mission.reader import DEFAULT_PARSER, read_mission
from btlang.passes import errors_of, run_passes
from btlang.passes.compilation import Compilation
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.testing.test_file import check_tests
from btlang.text.source import Source
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.shipped import ENGLISH

BAD = Path(__file__).parent.parent / "samples" / "bad"


def told(source: Source, command: str = "") -> list[Diagnostic]:
    """Errors and warnings of a mission, with the options `--keywords`, `--world` and `--language` of a command line."""
    words = command.split()
    if words[2:3] == ["test"]:
        return problems_of_tests(source)
    options = {word: words[at + 1] for at, word in enumerate(words) if word.startswith("--") and at + 1 < len(words)}
    try:
        vocabulary = words_of(options.get("--keywords"), options.get("--world"), options.get("--language", ENGLISH))
        if source.text.startswith("<"):
            compilation = Compilation(vocabulary, tree=read_xml(source))
        else:
            reading = read_mission(source, vocabulary, DEFAULT_PARSER, errors_of=errors_of)
            compilation = Compilation(vocabulary, reading.mission, warnings=reading.warnings)
        return run_passes(compilation).warnings
    except MissionError as error:
        return error.diagnostics


def problems_of_tests(source: Source) -> list[Diagnostic]:
    """What is wrong with a file of tests."""
    try:
        return check_tests(source)
    except MissionError as error:
        return error.diagnostics


@cache
def words_of(keywords: str | None, world: str | None, language: str) -> Lexicon:
    """The words of a language and a keyword file, and the names of a world."""
    return world_vocabulary([keywords] if keywords else [], world, language)


@cache
def sample_diagnostics() -> tuple[Diagnostic, ...]:
    """Of all samples, in their order; the names of files in them are those in the folder of the samples."""
    before = Path.cwd()
    found: list[Diagnostic] = []
    os.chdir(BAD)
    try:
        for path in sorted(BAD.glob("*.txt")):
            first = path.read_text(encoding="latin-1").partition("\n")[0]
            try:
                found += told(read_source(path.name), first if first.startswith("# btc ") else "")
            except MissionError as error:
                found += error.diagnostics
    finally:
        os.chdir(before)
    return tuple(found)
