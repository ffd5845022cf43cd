"""The pause of the garbage collector: over when the last user is done, and only where it was running."""

from __future__ import annotations

import gc
import weakref
from collections.abc import Iterator

import pytest

import btlang
from btlang.frontends.mission.tokens.lexer import Lexer
from btlang.support.gc_pause import gc_paused
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


@pytest.fixture
def thawed() -> Iterator[None]:
    """Nothing is frozen, as the tests have it."""
    gc.unfreeze()
    yield
    gc.freeze()


@pytest.mark.usefixtures("thawed")
def test_what_was_made_is_not_looked_through_behind_it() -> None:
    with gc_paused:
        made = [[number] for number in range(60_000)]
    young = {id(each) for generation in (0, 1) for each in gc.get_objects(generation)}
    assert not young & {id(each) for each in made}


@pytest.mark.usefixtures("thawed")
def test_garbage_that_was_made_in_pauses_goes(monkeypatch: pytest.MonkeyPatch) -> None:
    class Node:
        def __init__(self) -> None:
            self.itself = self

    monkeypatch.setattr("btlang.support.gc_pause._MANY", 100)
    monkeypatch.setattr("btlang.support.gc_pause._LOOK_AFTER", 20_000)
    made = weakref.WeakSet[Node]()
    for _ in range(10):
        with gc_paused:
            made.update(Node() for _ in range(3_000))
    assert len(made) < 20_000


def test_what_somebody_froze_stays_frozen(monkeypatch: pytest.MonkeyPatch) -> None:
    """And the collector works as it would without btlang."""
    monkeypatch.setattr("btlang.support.gc_pause._MANY", -1)
    monkeypatch.setattr("btlang.support.gc_pause._LOOK_AFTER", 0)
    monkeypatch.setattr(gc, "collect", lambda: pytest.fail("it looks through everything"))
    gc.freeze()
    before = gc.get_freeze_count()
    with gc_paused:
        pass
    assert gc.get_freeze_count() > before - 1000  # what nobody needs any more goes
