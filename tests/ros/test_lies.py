"""Lies over ROS 2: see tests/lies."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest
from std_msgs.msg import String

import btlang
from btlang.diagnostics.diagnostic import MissionError
from tests.lies.lies import ROS, Lie
from tests.lies.scene import Result
from tests.lies.test_lies import judge, judge_both, mission, pairs, scene, scene_of_both, some
from tests.profiles import amount
from tests.ros.client import Client
from tests.ros.declared import Peer
from tests.ros.domains import free_domain
from tests.ros.processes import Command, wait_until


class LyingRobot:
    """The form of the liar that is a node, in a process of its own."""

    def __init__(self, peer: Peer, client: Client, domain: int) -> None:
        self._peer, self._asks, self.domain = peer, client.publisher(String, "/lie"), domain

    def run(self, text: str, names: list[str], limit: float = 20.0, **scene: float) -> Result:
        """A mission while these lies are told."""
        self.begin(names, **scene)
        with btlang.Session("ros") as session:
            try:
                outcome = session.run(btlang.parse_tree(text), time_limit=limit).outcome
            except MissionError as refused:  # it lies from the start
                return replace(self.result, reason=str(refused))
        time.sleep(0.3)  # until it stands
        result = self.result
        assert outcome is not None
        result.reason = ("" if outcome.failure is None else str(outcome.failure.reason)) or outcome.stopped
        return result

    def begin(self, names: list[str], **scene: float) -> None:
        """It stands at the origin and will tell these lies."""
        self._ask({"lies": names, **scene})
        self._peer.expect("scene")

    @property
    def result(self) -> Result:
        """What has come of it."""
        self._ask({})
        return Result(**json.loads(self._peer.expect("result").partition(" ")[2]))

    def _ask(self, data: dict[str, object]) -> None:
        self._asks.publish(String(data=json.dumps(data)))


@pytest.fixture(scope="module")
def robot() -> Iterator[LyingRobot]:
    with free_domain() as domain, pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DOMAIN_ID", str(domain))
        peer = Peer("liar", domain=domain)
        try:
            peer.expect("ready")
            with closing(Client(domain)) as client:
                yield LyingRobot(peer, client, domain)
        finally:
            peer.close()


USUAL = ("beams only behind",)


@pytest.mark.long
@pytest.mark.parametrize("lie", some(ROS, USUAL), ids=lambda lie: lie.name)
def test_a_node(robot: LyingRobot, lie: Lie) -> None:
    judge(lie, robot.run(mission(lie), [lie.name], **scene(lie)), 0.3)


@pytest.mark.long
def test_two_lies_at_once(robot: LyingRobot) -> None:
    for lies in pairs(ROS, amount(0, 50)):
        found = robot.run("move forward 5 m", [lie.name for lie in lies], **scene_of_both(lies))
        judge_both(lies, found, 0.3)


@pytest.mark.long
@pytest.mark.parametrize(
    "truth", [{"rate": 5.0, "latency": 0.3, "skew": 5.0, "acceleration": 0.6, "grip": 0.9}][amount(1, 0) :]
)
def test_who_says_the_truth_is_not_stopped(robot: LyingRobot, truth: dict[str, float]) -> None:
    """Slow odometry, late, by the clock of another computer, of a robot that slips and is slow."""
    result = robot.run("move forward 1 m", [], wall=4.0, **truth)
    assert (result.reason, result.touched) == ("", False), result


ENDED = ["nine tenths of the way", "silent odometry", "a frozen pose", "frozen ranges"]


@pytest.mark.long
@pytest.mark.parametrize("name", ENDED[: amount(1, len(ENDED))])
def test_ctrl_c_ends_it_within_two_seconds(robot: LyingRobot, name: str, tmp_path: Path) -> None:
    robot.begin([name], wall=6.0)
    command = Command(tmp_path, robot.domain, "run", "--robot", "ros", "-c", "repeat: try to move forward 5 m")
    wait_until(lambda: robot.result.driven > 0.4, "it drives")
    began = time.monotonic()
    assert command.end() == 130
    assert time.monotonic() - began < 2.0
    assert not robot.result.moved_on
