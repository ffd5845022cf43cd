"""The pause of the garbage collector: over when the last user is done, and only where it was running."""

from __future__ import annotations

import gc
import weakref
from collections.abc import Iterator

import pytest

import btlang
from btlang.frontends.mission.tokens.lexer import Lexer
from btlang.gc_pause import gc_paused
from btlang.text.source import Source
from btlang.vocabulary.load import load_vocabulary


@pytest.fixture(autouse=True)
def running() -> Iterator[None]:
    was = gc.isenabled()
    gc.enable()
    yield
    (gc.enable if was else gc.disable)()


def test_users_within_users() -> None:
    with gc_paused:
        with gc_paused:
            assert not gc.isenabled()
        assert not gc.isenabled()
    assert gc.isenabled()


def test_errors_end_it() -> None:
    with pytest.raises(btlang.MissionError):
        btlang.parse_tree("wave wave")
    assert gc.isenabled()


def test_what_was_off_stays_off() -> None:
    gc.disable()
    btlang.parse_tree("wave")
    assert not gc.isenabled()


def test_what_read_a_text_is_gone_before_the_search_goes_on() -> None:
    gc.disable()
    lexer = Lexer(Source("go to the lab, then wave while nodding"), load_vocabulary())
    gone = weakref.ref(lexer)
    del lexer
    assert gone() is None  # else the first search behind the pause looks through all tokens
