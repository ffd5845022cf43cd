"""How often the words of leaves are looked up: once for each value, whatever forms and scopes there are."""

from __future__ import annotations

import pytest

from btlang.printer.phrase import leaf_words
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.vocabulary import node_words
from btlang.vocabulary.lexicon import Lexicon


def test_a_value_is_read_once_for_all_forms_of_a_phrase(monkeypatch: pytest.MonkeyPatch) -> None:
    vocabulary, read = world_vocabulary(), list[str]()
    original = Lexicon.value

    def counted(self: Lexicon, kind: str, written: str) -> str | None:
        read.append(written)
        return original(self, kind, written)

    monkeypatch.setattr(Lexicon, "value", counted)
    assert leaf_words("GoTo", {"place": "kitchen"}, vocabulary, exactly=True)
    assert len(read) == len(set(read))
    read.clear()
    assert leaf_words("GoTo", {"place": "room 7"}, vocabulary, exactly=True) == ""
    assert read == []


def test_equal_phrases_of_lexicons_are_one_object() -> None:
    vocabulary = world_vocabulary()
    known = node_words._phrases(vocabulary)
    other = node_words._phrases(vocabulary.with_places(("attic",)))
    assert all(one is another for one, another in zip(known, other, strict=True))
