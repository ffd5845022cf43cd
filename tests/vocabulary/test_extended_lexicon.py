"""A lexicon that further words extend: the same as one that is made of all files, in a tenth of the time."""

from __future__ import annotations

from copy import deepcopy
from pathlib import Path

import pytest

from btlang.diagnostics.diagnostic import MissionError
from btlang.text.source import Source
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.load import load_vocabulary, vocabulary_with

TESTS = Path(__file__).parents[1]
FILES = [TESTS / "backends" / "packs" / "nav2_to_pose_with_recovery.toml", TESTS / "ros" / "words" / "senses.toml"]
NOT_BASED_ON_OTHERS = ("_own_nodes", "_with_names", "context", "values")


def made_of_all(text: str, patch: pytest.MonkeyPatch) -> Lexicon:
    """The lexicon without the short way."""
    with patch.context() as without:
        without.setattr(Lexicon, "extended", lambda *_: None)
        return vocabulary_with(Source(text, "own.toml"))


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_it_is_the_same(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = path.read_text(encoding="utf-8")
    whole, extended = made_of_all(text, monkeypatch), vocabulary_with(Source(text, "own.toml"))
    for name, value in vars(whole).items():
        assert name in NOT_BASED_ON_OTHERS or vars(extended)[name] == value, name
    assert [*extended.entries] == [*whole.entries]


def test_the_words_that_ship_stay_as_they_are() -> None:
    before = deepcopy(load_vocabulary().trie)
    text = '[[action]]\nid = "Hover"\nphrase = "go up [to {place}] [{length}]"\n'
    assert "Hover" in vocabulary_with(Source(text, "own.toml")).entries
    assert "Hover" not in load_vocabulary().entries
    assert load_vocabulary().trie == before


@pytest.mark.parametrize(
    "text",
    [
        '[[action]]\nid = "Flee"\nphrase = "wave"\n',  # a phrase that is known
        '[[action]]\nid = "Flee"\nphrase = "flee from {dragon}"\n',  # no such type
        '[phrases]\nNoSuchId = ["flee"]\n',
    ],
)
def test_what_is_wrong_is_what_is_wrong_with_all_files(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(MissionError) as whole:
        made_of_all(text, monkeypatch)
    with pytest.raises(MissionError) as short:
        vocabulary_with(Source(text, "own.toml"))
    assert str(short.value) == str(whole.value)


@pytest.mark.parametrize(
    "text",
    [
        '[[action]]\nid = "Hover"\nphrase = "hover near {spot}"\n[[type]]\nname = "spot"\n'
        'values = [{ name = "ledge" }]\n',
        '[[quantity]]\nid = "Height"\nphrase = "height"\ntype = "length"\n',
        'replaces = ["Wave"]\n[[action]]\nid = "Wave"\nphrase = "brandish"\ncall = "btlang.actions.speech:say"\n',
        '[[action]]\nid = "Hover"\nphrase = "dévier"\n',
        '[roles]\nthen = { add = ["whereupon"] }\n',
        '[[condition]]\nid = "Sunny"\nphrase = "battery is not low"\n',
        'shipped = false\n[[action]]\nid = "Hover"\nphrase = "hover"\n',
    ],
    ids=["type", "quantity", "replaces", "accents", "role", "other way", "alone"],
)
def test_what_changes_other_words_makes_it_of_all_files(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    class Made(Exception):
        """It is made, which takes a second and is tested elsewhere."""

    def make(*_: object) -> None:
        raise Made

    monkeypatch.setattr(Lexicon, "__init__", make)
    with pytest.raises(Made):
        vocabulary_with(Source(text, "own.toml"))
