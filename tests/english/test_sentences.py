"""What becomes of sentences that people give robots, in worlds with their nouns: `read.out` has a line for each.

A line has the tree of a sentence that is read, else the codes of its message. Both parsers agree on each, the printed
English means the same again, and more of them are read as the language grows.
"""

from __future__ import annotations

import csv
from functools import cache

import pytest

import btlang
from btlang.text.source import Source
from btlang.tree.dump import plain
from tests.conftest import matches_golden

from .worlds import FOLDER, world_of

PARSERS = ("shunting-yard", "lark")
LEAST = 92
"""So many of the 200 are read; it only grows."""


@cache
def sentences() -> tuple[tuple[str, str], ...]:
    """The domain and the words of each."""
    with (FOLDER / "sentences.tsv").open(encoding="utf-8", newline="") as file:
        rows = csv.DictReader(file, delimiter="\t", quoting=csv.QUOTE_NONE)
        return tuple((row["domain"], row["sentence"]) for row in rows)


@cache
def outcome(domain: str, sentence: str, parser: str) -> str:
    try:
        mission = btlang.parse_tree(sentence, world=Source(world_of(domain), f"{domain}.toml"), parser=parser)
    except btlang.MissionError as error:
        return " ".join(sorted({problem.code for problem in error.diagnostics if problem.is_error}))
    return plain(mission.tree)


def is_read(told: str) -> bool:
    return not told.startswith("BT")


def test_what_becomes_of_each() -> None:
    told = [f"{domain}: {said}\n{outcome(domain, said, PARSERS[0]).strip()}\n" for domain, said in sentences()]
    matches_golden("\n".join(told), FOLDER / "read.out")


def test_so_many_are_read() -> None:
    assert sum(is_read(outcome(*each, PARSERS[0])) for each in sentences()) >= LEAST


@pytest.mark.parametrize("domain", sorted({domain for domain, _ in sentences()}))
def test_both_parsers_and_the_printed_english_agree(domain: str) -> None:
    for of, said in sentences():
        told = outcome(of, said, PARSERS[0]) if of == domain else ""
        if not told:
            continue
        assert outcome(of, said, PARSERS[1]) == told, said
        if is_read(told):
            world = Source(world_of(domain), f"{domain}.toml")
            english = str(btlang.parse_tree(said, world=world).to("english"))
            assert plain(btlang.parse_tree(english, world=world).tree) == told, english
