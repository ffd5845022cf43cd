"""The latest message and its age, on a clock that the test moves."""

from __future__ import annotations

import time
from types import SimpleNamespace
from typing import Any

import pytest

from btlang.engine.leaves.leaf import ActionFailed
from btlang.ros.clocks import AwakeClock
from btlang.ros.subscriptions import Latest, NodeClock


class Node:
    """A node whose clock says what it is told."""

    said = 100.0

    def get_clock(self) -> Any:
        return SimpleNamespace(now=lambda: SimpleNamespace(nanoseconds=int(self.said * 1e9)))


@pytest.fixture(autouse=True)
def awake(monkeypatch: pytest.MonkeyPatch) -> None:
    """In a process that never was asleep, as one may have been that other tests held up."""
    monkeypatch.setattr("btlang.ros.subscriptions.AWAKE", AwakeClock())


def test_a_message_grows_old() -> None:
    node = Node()
    latest = Latest("/scan", NodeClock(node).now, lambda: "")
    with pytest.raises(ActionFailed, match="nothing has arrived on /scan yet"):
        latest.take(1.0)
    latest.store("message")
    node.said += 0.9
    assert latest.take(1.0) == "message"
    node.said += 0.3
    with pytest.raises(ActionFailed, match=r"nothing has arrived on /scan for 1\.2 s"):
        latest.take(1.0)
    assert latest.take(None) == "message"


def test_where_simulated_time_begins_anew_silence_still_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    real = [50.0]
    monkeypatch.setattr(time, "monotonic", lambda: real[0])
    node = Node()
    clock = NodeClock(node)
    latest = Latest("/odom", clock.now)
    latest.store("message")
    real[0] += 5.0  # 4 of them count
    assert clock.now() == 104.0
    node.said = 0.0  # another simulator
    assert clock.now() == 104.0
    node.said = 1.2
    assert clock.now() == pytest.approx(105.2)
    with pytest.raises(ActionFailed, match=r"nothing has arrived on /odom for 5\.2 s"):
        latest.take(5.0)


def test_a_clock_that_stands_still_goes_on_in_real_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """The clock of a simulation that has died says nothing any more, and nothing may wait for it for ever."""
    real = [50.0]
    monkeypatch.setattr(time, "monotonic", lambda: real[0])
    clock = NodeClock(Node())
    assert clock.now() == 100.0
    real[0] += 0.9
    assert clock.now() == 100.0
    real[0] += 10
    assert clock.now() == pytest.approx(109.9)
