"""Signals that come while Python runs a callback of its own, which drops whatever is raised in it."""

from __future__ import annotations

import os
import signal
import time
import weakref

import pytest

from btlang.run.terminal import interrupted_by_signals


class Thing:
    """Something whose end is noticed."""


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_in_a_callback_of_python_interrupts_all_the_same(number: int) -> None:
    things = [Thing()]

    def end(_: object) -> None:
        os.kill(os.getpid(), number)
        time.sleep(0.01)  # in which the handler runs

    def lose() -> None:
        things.clear()
        time.sleep(5.0)

    watched = weakref.ref(things[0], end)
    with interrupted_by_signals(), pytest.raises(KeyboardInterrupt):
        lose()
    assert watched() is None
