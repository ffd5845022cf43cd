"""A lexicon is frozen: all missions of a process share it."""

from __future__ import annotations

import pytest

from btlang.robots.mission_vocabulary import world_vocabulary


def test_nothing_can_be_set() -> None:
    vocabulary = world_vocabulary()
    for one in (vocabulary, vocabulary.with_places(("bay",)), vocabulary.with_references()):
        with pytest.raises(AttributeError, match="frozen"):
            one.articles = frozenset()
    assert "the" in vocabulary.articles
