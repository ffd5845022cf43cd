"""What may be said: whole sentences of phrases and names, and how their words are pronounced."""

from __future__ import annotations

import pytest

from btlang.speech.pocketsphinx import guess_phones, vary_accents
from btlang.speech.recogniser import Expected, Grammar, spoken
from tests.speech.sounds import guide, lines

PLACES = {"place": ("Lobby", "Room 12", "Café Zoë", "§")}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("Go to the LOBBY!", "go to the lobby"), ("I don\u2019t", "i don't"),
        ("room 12, or 45", "room twelve or forty five"),
        ("Café Zoë", "cafe zoe"), ("2026 and 007", "two zero two six and zero zero seven"), ("¿§?", ""), ("", ""),
    ],
)  # fmt: skip
def test_texts_as_they_are_said(text: str, words: str) -> None:
    assert spoken(text) == words


def test_whole_sentences_only() -> None:
    grammar = Grammar(Expected(("go/drive [to] [the] {place}", "stop"), PLACES))
    for text in ("go to the lobby", "Drive to room 12.", "go cafe zoe", "stop"):
        assert grammar.holds(text), text
    for text in ("go to the", "go to", "", "stop stop", "please stop", "go to the lobby stop", "lobby"):
        assert not grammar.holds(text), text


def test_names_are_written_as_they_are() -> None:
    grammar = Grammar(Expected(("go to [the] {place}",), PLACES))
    assert grammar.written("go to room twelve") == "go to Room 12"
    assert grammar.written("go to cafe zoe") == "go to Café Zoë"
    assert grammar.written("go to the lobby") == "go to the Lobby"


def test_what_nobody_can_say_is_left_out() -> None:
    grammar = Grammar(Expected(("go to {place}", "find {thing}", "see [the", "a ] b"), {"place": ("§",), "thing": ()}))
    assert grammar.words == []
    assert not grammar.holds("go to ")


def test_the_grammar_of_the_guide_has_all_its_sentences() -> None:
    grammar = Grammar(guide())
    for part in ("train", "test"):
        assert [line for line in lines(f"{part}/good.txt") if not grammar.holds(line)] == []
        assert [line for line in lines(f"{part}/foreign.txt") if grammar.holds(line)] == []


@pytest.mark.parametrize(
    ("word", "phones"),
    [
        ("bolin", "B OW L IH N"),
        ("schneider", "SH N AY D ER"),
        ("zoe", "Z OW EH"),
        ("yuki", "Y AH K IY"),
        ("mme", "M EH"),
    ],
)
def test_guesses_by_letters(word: str, phones: str) -> None:
    assert guess_phones(word) == phones


def test_every_letter_can_be_guessed() -> None:
    for letter in "abcdefghijklmnopqrstuvwxyz":
        assert guess_phones(letter), letter


def test_no_and_never_in_the_south_of_england() -> None:
    assert vary_accents("N OW") == ["N AH UW"]
    assert vary_accents("N EH V ER") == ["N EH V AH"]
    assert vary_accents("Y EH S") == []
