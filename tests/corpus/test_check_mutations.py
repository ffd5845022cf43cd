"""Mutated files of the corpus: `btc check` says something of each, soon, and never falls over."""

from __future__ import annotations

import random
import time
from pathlib import Path

import pytest

from btlang.diagnostics.diagnostic import Diagnostic, render
from btlang.diagnostics.files import read_source
from btlang.frontends.btcpp.files import XmlFiles
from btlang.frontends.btcpp.project import read_project
from btlang.projects.checking import project_problems
from btlang.projects.cpp_ports import CppSources
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.text.source import Source
from tests.corpus.test_mutations import mutated
from tests.profiles import amount

CORPUS = Path(__file__).parent
FILES = sorted(path for folder in ("team", "good", "lenient") for path in (CORPUS / folder).glob("*.xml"))
_MOST_SECONDS = 1.0
_TAGS = ("Sequence", "SubTree", "TreeNodesModel", "BehaviorTree", "root", "Action", "input_port", "Repeat", "include")


def tag_mutated(text: str, draw: random.Random) -> str:
    """With another name in place of one that is there, or a tag that is taken away or put in."""
    places = [at for at, letter in enumerate(text) if letter == "<"]
    if not places:
        return text
    at = draw.choice(places)
    end = text.find(">", at) + 1 or len(text)
    kind = draw.randrange(4)
    if kind == 0:
        return text[:at] + text[end:]
    if kind == 1:
        return text[:at] + text[at:end] * 2 + text[end:]
    if kind == 2:
        return (
            text[:at] + draw.choice(("<{}/>", "<{}>", "</{}>", '<{} ID="A"/>')).format(draw.choice(_TAGS)) + text[at:]
        )
    return text.replace(draw.choice(_TAGS), draw.choice(_TAGS), draw.choice((1, -1)))


def checked(source: Source) -> list[Diagnostic]:
    """What `btc check` says of one file."""
    files = XmlFiles([source])
    files.add(source)
    return project_problems(read_project(files, XmlFiles()), world_vocabulary(), CppSources())


@pytest.mark.long
def test_no_mutation_is_too_much() -> None:
    draw = random.Random(24)
    sources = [read_source(str(path)) for path in FILES]
    for source in sources:
        checked(source)
    slow: list[tuple[float, str]] = []
    for _ in range(amount(30, 10_000)):
        original = draw.choice(sources)
        text = original.text
        for _ in range(draw.choice((1, 1, 2, 4))):
            text = draw.choice((mutated, tag_mutated))(text or "<", draw)
        start = time.process_time()
        for problem in checked(original.with_text(text)):
            render(problem)
        spent = time.process_time() - start
        if spent > _MOST_SECONDS:
            slow.append((spent, text))
    assert slow == []
