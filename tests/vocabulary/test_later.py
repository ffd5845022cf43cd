"""Phrases that are read from the cache when something first asks for their first word."""

from __future__ import annotations

import pickle

from btlang.vocabulary.later import LaterTree, packed, unpacked
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.load import load_vocabulary
from btlang.vocabulary.word_tree import END, words_of


def unread(lexicon: Lexicon) -> set[str]:
    return {word for word, node in lexicon.trie.items() if isinstance(node, LaterTree)}


def test_a_vocabulary_from_the_cache_has_the_same_phrases() -> None:
    made = load_vocabulary()
    loaded = pickle.loads(pickle.dumps(made, 5))
    assert len(unread(loaded)) > 300
    again = pickle.loads(pickle.dumps(loaded, 5))  # also where nothing has been read
    for each in (loaded, again):
        assert words_of(each.trie) == words_of(made.trie)
        assert {**each.trie} == {**made.trie}
        assert not unread(each)


def test_only_what_is_asked_for_is_read() -> None:
    loaded: Lexicon = pickle.loads(pickle.dumps(load_vocabulary(), 5))
    every = unread(loaded)
    wave = loaded.trie["wave"]
    assert wave[END].entry is loaded.entry("Wave")  # and not another one that is equal
    assert unread(loaded) == every - {"wave"}
    assert type(loaded.trie["wave"]) is dict
    assert wave == loaded.trie["wave"]


def test_whatever_asks_first_reads() -> None:
    tree = {"a": {"b": {}, "c": {}}}

    def later() -> LaterTree:
        node = unpacked(*packed(tree, ()), now=())["a"]
        assert isinstance(node, LaterTree)
        return node

    assert "b" in later()
    assert later()["c"] == {}
    assert later().get("b") == {}
    assert len(later()) == 2
    assert [*later()] == [*later().keys()] == ["b", "c"]
    assert {**later()} == dict(later()) == later() == later().copy() == tree["a"]
    assert later() != {}
    assert later().setdefault("b", {"other": {}}) == {}
    assert [*later().items()] == [("b", {}), ("c", {})]
    assert [*later().values()] == [{}, {}]
    assert repr(later()) == repr(tree["a"])
