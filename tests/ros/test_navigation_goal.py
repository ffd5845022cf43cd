"""Journeys that no good server would let happen: they end for a reason. The test moves the clock."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator

import pytest

from btlang.robots.geometry import Pose
from btlang.ros.node import ExecutorThread, SpunNode
from tests.ros.declared import Peer
from tests.ros.processes import wait_until

pytest.importorskip("nav2_msgs", reason="nav2_msgs is not installed")

from btlang.ros.robot.navigation import RosNavigation, ServerGoal


class Trip:
    """A journey of a robot that stands where the test says, on a clock that it moves."""

    def __init__(self, spun: SpunNode, peer: Peer) -> None:
        self.peer = peer
        self.seconds, self.pose = 100.0, Pose(0.0, 0.0)
        self._word = threading.Event()
        self._navigation = RosNavigation(spun.node, ExecutorThread(spun.node), lambda: self.pose, self._now)

    def _now(self) -> float:
        if threading.current_thread() is not threading.main_thread():
            self._word.set()  # the journey looks at the clock when it is accepted
        return self.seconds

    def begin(self, *, is_answered: bool = True) -> ServerGoal:
        """It is accepted."""
        journey = self._navigation.start("kitchen", Pose(4.0, -1.0))
        wait_until(lambda: self.pass_by(0.0) is None and self.peer.has_told("executing"), "the goal")
        if is_answered:
            wait_until(lambda: self.pass_by(0.0) is None and self._word.is_set(), "an answer")
        return journey

    def pass_by(self, seconds: float) -> None:
        self.seconds += seconds
        self._navigation.step()


@pytest.fixture
def trip(domain: int) -> Iterator[Callable[[str], Trip]]:
    """Starts a server with a manner."""
    peers: list[Peer] = []
    with SpunNode("traveller", domain_id=domain) as spun:

        def start(mode: str) -> Trip:
            peers.append(Peer("navigator", mode, domain=domain))
            peers[-1].expect("ready")
            return Trip(spun, peers[-1])

        yield start
    for peer in peers:
        peer.close()


@pytest.mark.parametrize(
    ("mode", "reason"),
    [("blame", "the map is too old"), ("code", "the navigation server reported error 9 on the way to the kitchen")],
)
def test_a_success_with_an_error_code_is_none(trip: Callable[[str], Trip], mode: str, reason: str) -> None:
    way = trip(mode)
    journey = way.begin()
    wait_until(lambda: way.pass_by(0.0) is None and journey.done, "the end")
    assert journey.failure == reason


@pytest.mark.parametrize("x", [3.6, 1.0])
def test_a_success_counts_near_the_goal(trip: Callable[[str], Trip], x: float) -> None:
    way = trip("arrive")
    journey = way.begin()
    way.pose = Pose(x, -1.0)
    wait_until(lambda: way.pass_by(0.0) is None and journey.done, "the end")
    reason = "the navigation server reports success, but the robot is 3.0 m from the goal"
    assert journey.failure == (None if x == 3.6 else reason)


def test_a_server_that_gives_no_word_while_the_robot_stands(trip: Callable[[str], Trip]) -> None:
    way = trip("hang")
    journey = way.begin()
    for _ in range(10):  # it gives no word, but it drives
        way.pose = Pose(way.pose.x + 0.1, 0.0)
        way.pass_by(14.0)
    assert not journey.done
    way.pass_by(16.0)
    assert journey.failure == (
        "the robot has not moved for 15 s on the way to the kitchen, and the navigation server on /navigate_to_pose "
        "sends no feedback"
    )
    way.peer.expect("cancelled")


def test_a_server_that_accepts_what_was_given_up(trip: Callable[[str], Trip], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("btlang.ros.robot.navigation._ANSWER", 0.05)
    way = trip("slow")
    journey = way.begin(is_answered=False)
    assert journey.failure == "the navigation server on /navigate_to_pose does not answer"
    wait_until(lambda: way.peer.has_told("cancelled"), "the cancel")
    assert journey.withdrawn.wait(5)
    assert journey.pending == ""


def test_a_server_whose_answer_gets_lost(trip: Callable[[str], Trip], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("btlang.ros.robot.navigation._ANSWER", 1.0)
    way = trip("lost")
    journey = way.begin(is_answered=False)
    wait_until(lambda: way.pass_by(0.0) is None and journey.done, "the end")
    assert journey.failure == "the navigation server on /navigate_to_pose does not answer"
    wait_until(lambda: way.peer.has_told("cancelled"), "the cancel")
    assert journey.withdrawn.wait(5)
    assert journey.pending == ""


def test_a_server_that_talks_while_the_robot_stands(trip: Callable[[str], Trip]) -> None:
    way = trip("still")
    journey = way.begin()
    wait_until(lambda: journey.heard, "feedback")
    way.pass_by(59.0)
    assert not journey.done
    way.pass_by(2.0)
    assert journey.failure == "the robot has not moved for 60 s on the way to the kitchen"
    way.peer.expect("cancelled")
