"""Phrases that are looked up before the lexer are those that it reads: sharing them changes no token."""

from __future__ import annotations

import pytest

from btlang.frontends.mission.symbols.names import Names
from btlang.frontends.mission.symbols.phrases import Phrases
from btlang.frontends.mission.tokens import lexer as lexing
from btlang.frontends.mission.tokens.lexer import Lexer
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.text.source import Source
from btlang.text.words import split

TEXTS = [
    "go to the kitchen. if you are at the kitchen, wave",
    "go to the lab, then if you are near it, wave",
    "if Bob is near him, wave at him",
    "go to the lab, the hall and the dock is here",
    "the dock is wave\ngo to the lab, the hall and the dock",
    "the dock and nod is wave\ngo to the lab and the dock and nod",
    "set place to the lab\nif you are at place, wave",
    "for each place in the lab, the hall: if you are at place, wave",
    "greet {someone} is wave at {someone}\nif the path is clear, greet Bob",
    "pick up the cup. if the robot is holding it, put it down",
    "if there is a wall in front, turn left, if there is none, wave",
]


def tokens(text: str) -> list[tuple[object, ...]]:
    read = Lexer(Source(text), world_vocabulary()).tokens
    return [(token.kind, token.start, token.end, token.role, token.value) for token in read]


@pytest.mark.parametrize("text", TEXTS)
def test_tokens_are_those_of_a_lexer_that_looks_all_up_itself(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    shared = tokens(text)

    class Alone(Names):
        def __init__(self, *arguments: object) -> None:
            super().__init__(*arguments)  # type: ignore[arg-type]
            self.phrases = Phrases(self.phrases.text, self.phrases.vocabulary)

    monkeypatch.setattr(lexing, "Names", Alone)
    assert tokens(text) == shared


def test_a_phrase_with_a_pronoun_is_not_shared() -> None:
    vocabulary = world_vocabulary()
    text = split(Source("wave at him"), vocabulary.orthography)
    phrases = Phrases(text, vocabulary)
    phrases.at(0)
    assert not phrases.fixed
    assert phrases.at(0) is phrases.at(0)


def test_a_phrase_is_looked_up_once() -> None:
    vocabulary = world_vocabulary()
    phrases = Phrases(split(Source("go to the lab"), vocabulary.orthography), vocabulary)
    assert phrases.at(0) is phrases.at(0) is phrases.fixed[0]
