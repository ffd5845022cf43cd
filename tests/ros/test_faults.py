"""A robot without a watchdog whose sensors lie: each mission ends for a reason, and no nonsense goes out."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from math import isfinite
from pathlib import Path
from typing import Any

import pytest
from sensor_msgs.msg import JointState
from std_msgs.msg import String

import btlang
from btlang.run.events import Warned
from tests.profiles import cases
from tests.ros.client import Client
from tests.ros.declared import Peer, words
from tests.ros.domains import free_domain


class Lab:
    """One such robot, and one session for all missions on it."""

    def __init__(self, folder: Path, peer: Peer, session: btlang.Session, client: Client) -> None:
        self._folder, self.peer, self._session = folder, peer, session
        self._faults = client.publisher(String, "/misbehave")
        self.joints = client.hear(JointState, "/joint_states")
        self.warnings: list[str] = []

    def misbehave(self, faults: str = "") -> None:
        self._faults.publish(String(data=faults))
        self.peer.expect(f"faults {faults}".rstrip())
        for _ in range(15):  # what was sent before has arrived behind these, too
            self.joints.next()

    def run(self, mission: str, keywords: str = "", limit: float = 20.0, stopped: str = "") -> str:
        """Why it failed, "" where it did not. It ended, with a zero, and the robot heard nothing but numbers."""
        self.warnings.clear()
        self.peer.told.clear()
        file = self._folder / "words.toml"
        file.write_text(keywords, encoding="utf-8")
        made = btlang.parse_tree(mission, keywords=[str(file)] if keywords else [])
        outcome = self._session.prepare(made, time_limit=limit, sinks=[self._hear]).execute()
        assert outcome.stopped == stopped
        assert outcome.failure is None or outcome.failure.exception is None
        drives = [line for line in self.peer.told if line.startswith("drive")]
        if self.peer.has_told("drive") or drives:
            while not self.peer.told[-1].startswith("drive 0.000 0.000"):
                self.peer.expect("drive 0.000 0.000")
        assert not self.peer.has_told("not finite")
        return "" if outcome.failure is None else outcome.failure.reason

    def _hear(self, event: Any) -> None:
        if isinstance(event, Warned):
            self.warnings.append(event.text)


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lab]:
    with free_domain() as domain, pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DOMAIN_ID", str(domain))
        peer = Peer("faulty_robot", domain=domain)
        try:
            peer.expect("ready")
            with closing(Client(domain)) as client, btlang.Session("ros") as session:
                yield Lab(tmp_path_factory.mktemp("lab"), peer, session, client)
        finally:
            peer.close()


NOT_FINITE = "no odometry for 2 s: /odom sends numbers that are not finite"


@cases(
    ("mission", "fault", "reason"),
    [
        ("move forward 2 m", "nan", NOT_FINITE),
        ("move forward 2 m", "zero", "no odometry for 2 s: /odom sends an invalid quaternion"),
        ("move forward 2 m", "far", "no odometry for 2 s: /odom says that the robot is 1e+09 m away"),
        ("move forward 2 m", "frozen", "stuck after 0.00 m"),
        ("move forward 2 m", "silent", "no odometry for 2 s: /odom is silent"),
        ("turn left", "inf", NOT_FINITE),
        ("turn left", "frozen", "stuck after 0 degrees"),
    ],
    3,
)
def test_a_drive_ends_whatever_the_odometry_says(lab: Lab, mission: str, fault: str, reason: str) -> None:
    lab.misbehave(f"odom={fault}@moving")
    assert lab.run(mission).startswith(reason)


def test_a_drive_that_went_much_too_far_ends(lab: Lab) -> None:
    lab.misbehave("odom=jump@moving")
    assert lab.run("move forward 2 m").startswith("the robot went too far: 5")


def test_a_turn_that_goes_round_and_round_ends(lab: Lab) -> None:
    lab.misbehave("odom=spin@moving")
    assert lab.run("turn right 30 degrees").startswith("the robot turned too far: ")


TABLE = words("drive").replace("patience = 1.0", "patience = 2.5")  # longer than odometry may be silent


@pytest.mark.parametrize(
    ("fault", "reason"),
    [
        ("nan", "/odom sends numbers that are not finite"),
        ("frozen", "the robot makes no progress: 0.00 of 0.60 m done"),
        ("jump", "the robot went too far: 5"),
    ],
)
def test_so_does_that_of_a_table(lab: Lab, fault: str, reason: str) -> None:
    lab.misbehave(f"odom={fault}@moving")
    assert lab.run("move forward 0.6 m", TABLE).startswith(reason)


def test_no_table_tells_a_robot_to_drive_faster_than_any(lab: Lab) -> None:
    lab.misbehave()
    assert lab.run("move forward 900 m at 99 m/s", TABLE) == (
        "a velocity of 99 m/s and 0 rad/s is beyond the limits of the robot"
    )


def test_stop_ends_where_the_odometry_says_that_it_goes_on(lab: Lab) -> None:
    lab.misbehave("odom=frozen")
    assert lab.run("stop") == "the robot doesn't stop: it is moving at 0.50 m/s and 0 degrees/s"


def test_bad_odometry_is_missing_before_the_run(lab: Lab) -> None:
    lab.misbehave("odom=nan")
    with pytest.raises(btlang.MissionError, match="needs the topic /odom, but /odom sends numbers that are not finite"):
        lab.run("move forward 2 m")


def test_a_command_that_arrives_late_makes_nobody_stuck(lab: Lab) -> None:
    lab.misbehave("late=0.5")
    assert lab.run("move forward 2 m", limit=2.5, stopped="time limit") == ""


def test_where_the_odometry_shows_no_motion_for_long_it_stops(lab: Lab) -> None:
    """The command may be late, or what the odometry says: the robot may be driving already."""
    lab.misbehave("late=2")
    assert lab.run("move forward 2 m") == "stuck after 0.00 m: /odom shows that the robot doesn't move"


def test_joints_without_positions(lab: Lab) -> None:
    lab.misbehave("joint=nan")
    reason = '/joint_states doesn\'t report the joint "head_turn"'
    assert lab.run("look left") == reason
    lab.misbehave()
    lab.joints.wait(lambda state: all(map(isfinite, state.position)))  # one that was sent before may be the latest
    assert lab.run("wait 0.3 s then look left then look ahead") == ""


ARM = """
[[action]]
phrase = "raise left arm"
id = "RaiseLeftArm"
ros.joints = "trajectory_msgs/msg/JointTrajectory"
ros.name = "/joint_trajectory"
ros.positions.left_arm_lift = 1.2
ros.positions.head_turn = 0.3
ros.duration = 0.5
"""


def test_joints_in_several_messages(lab: Lab) -> None:
    """One publisher for each limb is usual."""
    lab.misbehave("joint=split")
    lab.joints.wait(lambda state: len(state.name) == 1)
    assert lab.run("look left then raise the left arm then look ahead") == ""
    assert lab.run("raise left arm", ARM) == ""
    lab.misbehave("joint=half")
    assert lab.run("wait 3 s then raise the left arm then look left") == (
        '/joint_states hasn\'t reported the joint "head_turn" for 2 s'
    )


def test_one_sample_empties_no_battery(lab: Lab) -> None:
    lab.misbehave("battery=blip@moving")
    assert lab.run("whenever the battery is below 20%, fail. move forward 1 m") == ""
    lab.misbehave("battery=empty@moving")
    assert lab.run("move forward 9 m").startswith("the battery is empty")
    lab.misbehave()
    assert lab.run("wait 1.5 s") == ""


@pytest.mark.parametrize(
    ("fault", "reason"),
    [
        ("volatile", "/docked is published as volatile, but btlang asks for transient local"),
        ("best", "/docked is published as best effort and volatile, but btlang asks for reliable and transient local"),
    ],
)
def test_quality_of_service_that_does_not_match_is_named(lab: Lab, fault: str, reason: str) -> None:
    lab.misbehave(f"docked={fault}")
    with pytest.raises(btlang.MissionError, match=f"{reason}: the quality of service doesn't match\\."):
        lab.run("check the robot is docked")


def test_a_topic_that_is_silent_is_named_in_a_whole_sentence(lab: Lab) -> None:
    lab.misbehave("docked=silent")
    with pytest.raises(btlang.MissionError, match=r"nothing has arrived on /docked yet\."):
        lab.run("check the robot is docked")


@pytest.mark.parametrize(
    ("fault", "reason"),
    [("nan", "/scan has no valid beam"), ("flat", "/scan doesn't say where its beams point")],
)
def test_a_scan_that_says_nothing_is_no_free_way(lab: Lab, fault: str, reason: str) -> None:
    """The robot goes blind while it drives."""
    lab.misbehave(f"scan={fault}@moving")
    assert lab.run("move forward 9 m until there is a wall in front") == ""
    assert lab.warnings == [f"no laser scan for 2 s: {reason}"]


@pytest.mark.parametrize(("fault", "wall"), [("close", True), ("free", False), ("", False)])
def test_what_is_too_close_is_a_wall_and_what_is_too_far_is_none(lab: Lab, fault: str, wall: bool) -> None:
    lab.misbehave(f"scan={fault}" if fault else "")
    assert (lab.run("wait 0.3 s then check there is a wall in front") == "") == wall


BATTERY = "no battery state for 2 s: /battery_state gives no percentage from 0 to 1, but nan"
NEITHER = (
    "move forward 1 m at 0.4 m/s. try check the battery is below 20%, otherwise check the battery is at least 20%, "
    "otherwise check not the battery is below 20%, otherwise if the battery is below 20%, nod, otherwise look left"
)


def test_a_battery_without_a_number_is_neither_low_nor_full(lab: Lab) -> None:
    lab.misbehave("battery=nan@moving")
    assert lab.run(NEITHER) == BATTERY
    assert len(lab.warnings) == 4


def test_a_standing_rule_tells_of_it_once(lab: Lab) -> None:
    lab.misbehave("battery=nan@moving")
    assert lab.run("whenever the battery is below 20%, stop. move forward 1.5 m at 0.4 m/s.") == ""
    assert lab.warnings == [f"'battery is below 20%' is not known: {BATTERY}"]


@pytest.mark.parametrize("fault", ["nan", "high"])
def test_the_preflight_tells_of_it(lab: Lab, fault: str) -> None:
    lab.misbehave(f"battery={fault}")
    with pytest.raises(btlang.MissionError, match="but /battery_state gives no percentage from 0 to 1"):
        lab.run("check the battery is below 20%")
