"""The pause of the garbage collector: over when the last user is done, and only where it was running."""

from __future__ import annotations

import gc
from collections.abc import Iterator

import pytest

import btlang
from btlang.gc_pause import gc_paused


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
