"""Ctrl-C while something must not be broken off."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Iterator

import pytest

from btlang.support.interrupts import interrupts_later


@pytest.fixture(autouse=True)
def _as_in_a_program() -> Iterator[None]:
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def test_it_counts_at_the_end() -> None:
    done = False
    with pytest.raises(KeyboardInterrupt), interrupts_later():  # noqa: PT012
        os.kill(os.getpid(), signal.SIGINT)
        done = True
    assert done
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_nothing_came_and_what_went_wrong_comes_through() -> None:
    with interrupts_later():
        pass
    with pytest.raises(ValueError, match="wrong"), interrupts_later():
        raise ValueError("wrong")
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_another_thread_and_ignored_signals_are_left_alone() -> None:
    seen: list[object] = []

    def look() -> None:
        with interrupts_later():
            seen.append(signal.getsignal(signal.SIGINT))

    thread = threading.Thread(target=look)
    thread.start()
    thread.join()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    look()
    assert seen == [signal.default_int_handler, signal.SIG_IGN]
