"""A lexicon is frozen: all missions of a process share it."""

from __future__ import annotations

import pytest

from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.vocabulary import node_words
from btlang.vocabulary.node_words import said_id


def test_nothing_can_be_set() -> None:
    vocabulary = world_vocabulary()
    for one in (vocabulary, vocabulary.with_places(("bay",)), vocabulary.with_references()):
        with pytest.raises(AttributeError, match="frozen"):
            one.articles = frozenset()
    assert "the" in vocabulary.articles


def test_what_all_say_is_collected_once(monkeypatch: pytest.MonkeyPatch) -> None:
    vocabulary = world_vocabulary()
    assert said_id("PlanArm", "do", vocabulary) == "plan arm"
    monkeypatch.setattr(node_words, "forms", None)  # what the phrases are collected with
    for place in ("bay", "ring", "pier", "mill", "well"):
        assert said_id("PlanArm", "do", vocabulary.with_places((place,))) == "plan arm"
