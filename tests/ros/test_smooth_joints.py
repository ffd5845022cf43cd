"""Planned movements over ROS 2 with a clock driven by hand: what is sent, and how the simulated robot plays it."""

from __future__ import annotations

from collections.abc import Callable
from math import inf, nan, radians
from types import SimpleNamespace
from typing import Any

import pytest
from numpy.random import default_rng
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory

from btlang.robots.motion.smooth_joints import SmoothJoints
from btlang.robots.robot import RobotError, SensorSilent
from btlang.ros.messages import JointRange, duration, motion, seconds_of, stamp
from btlang.ros.robot.smooth_joints import RosSmoothJoints
from btlang.ros.simulator import joint_player
from btlang.ros.simulator.joint_player import JointPlayer
from btlang.ros.subscriptions import LatestJoints
from tests.profiles import amount
from tests.robots.motion.bodies import guide, random_gesture

STEP = 0.01
TICK = 5  # steps
LAST_REST = 0.3  # seconds in which any joint can halt
REACH = JointRange(-1.0, 1.0, 2.0)


class Wire:
    """Both ends, and all that was sent; it is also the node, and the subscription to the joint states."""

    def __init__(self, late: int = 1) -> None:
        self.now, self.sent, self._late = 100.0, list[JointTrajectory](), late
        self._arriving: list[tuple[int, JointTrajectory]] = []
        self._steps = 0
        self._renew: list[Callable[[], None]] = []
        self.plugged, self.silent = True, False
        self.real = SmoothJoints(guide())
        self.player = JointPlayer(guide(), self.real, lambda: [self.real.timeline.seconds + 100.0])
        self.joints = RosSmoothJoints(self, self, guide())  # type: ignore[arg-type]
        self.joints.step()

    def get_clock(self) -> Any:
        return SimpleNamespace(now=lambda: SimpleNamespace(nanoseconds=round(self.now * 1e9)))

    def create_publisher(self, *_: object) -> Any:
        return SimpleNamespace(publish=self._publish)

    def create_timer(self, seconds: float, renew: Callable[[], None], **_: object) -> None:
        self._renew.append(renew)

    def listen(self, *_: object) -> None:
        """The joint states are there whenever they are asked for."""

    def latest_joints(self, _: str) -> LatestJoints:
        latest = LatestJoints("/joint_states", lambda: self.now)
        latest.store(self.get())
        return latest

    def get(self, *_: object) -> JointState:
        if self.silent:
            raise SensorSilent("no joint states for 2 s")
        states = JointState(name=[name.replace(" ", "_") for name in self.real.angles])
        states.position = [radians(angle) for angle in self.real.angles.values()]
        states.header.stamp = stamp(self.now)
        return states

    def _publish(self, message: JointTrajectory) -> None:
        self.sent.append(message)
        if self.plugged:
            self._arriving.append((self._steps + self._late, message))

    def run(self, seconds: float, then: Callable[[], object] = lambda: None) -> None:
        """Time passes, with a tick each 0.05 s; `then` is called after each step."""
        for _ in range(round(seconds / STEP)):
            self._steps += 1
            for due, message in [*self._arriving]:
                if due <= self._steps:
                    self._arriving.remove((due, message))
                    self.player.play(message)
            self.player.watch()
            self.real.step(STEP)
            self.now += STEP
            if self._steps % TICK == 0:
                self.joints.step()
            if self._steps % (4 * TICK) == 0 and self.plugged:
                self._renew[0]()
            then()


def until_rest(wire: Wire) -> float:
    """Seconds in which the joints came to rest."""
    rested = [wire.now]
    before = dict(wire.real.angles)

    def look() -> None:
        nonlocal before
        if (angles := dict(wire.real.angles)) != before:
            rested[0] = wire.now
        before = angles

    began = wire.now
    wire.run(1.0, look)
    return rested[0] - began


@pytest.fixture(autouse=True)
def _no_real_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(joint_player, "monotonic", lambda: inf)


@pytest.mark.parametrize("late", [1, 3])
@pytest.mark.parametrize("room", [1.0, 1.237, 2.0])
def test_the_stroke_is_at_its_second(room: float, late: int) -> None:
    wire = Wire(late)
    wire.run(0.05)
    strokes: list[float] = []
    began = wire.now
    played, _ = wire.joints.play(guide().gestures["bow"], room)
    assert len(wire.sent) == 1  # the whole is one message
    wire.run(room + 2.0, lambda: strokes.append(wire.now) if wire.real.angle("waist tilt") > 29.9 else None)
    assert strokes[0] == pytest.approx(
        began + room - 0.2, abs=0.06
    )  # the key frame of a bow is 0.2 s before its stroke
    assert (played.done, played.failure) == (True, None)
    assert not wire.joints.moving


def test_points_rise_and_begin_in_a_moment() -> None:
    wire = Wire()
    wire.joints.play(guide().gestures["bow"], None)
    [message] = wire.sent
    times = [seconds_of(point.time_from_start) for point in message.points]
    assert times[:3] == pytest.approx([0.0, 0.02, 0.04])
    assert times == sorted(set(times))
    assert 0.0 <= seconds_of(message.header.stamp) - wire.now <= 0.06
    assert set(message.joint_names) == {"waist_tilt", "head_tilt"}
    assert list(message.points[-1].velocities) == [0.0, 0.0]


def test_the_lead_is_what_the_stroke_needs() -> None:
    wire = Wire()
    wire.run(0.5)
    lead = wire.joints.lead(guide().gestures["bow"])
    began, strokes = wire.now, list[float]()
    wire.joints.play(guide().gestures["bow"], 0.0)
    wire.run(2.0, lambda: strokes.append(wire.now) if wire.real.angle("waist tilt") > 29.9 else None)
    assert strokes[0] + 0.2 * 0.7 == pytest.approx(began + lead, abs=0.1)


@pytest.mark.parametrize("how", ["cancel", "freeze", "emergency"])
@pytest.mark.parametrize("after", [0.3, 0.45, 0.62])
def test_halted_it_rests_at_once(how: str, after: float) -> None:
    wire = Wire()
    played, _ = wire.joints.play(guide().gestures["bow"], None)
    wire.run(after)
    count = len(wire.sent)
    halts = {
        "cancel": played.cancel,
        "freeze": lambda: wire.joints.freeze(("waist tilt", "head tilt")),
        "emergency": wire.joints.freeze,
    }
    halts[how]()
    assert len(wire.sent) == count + 1  # without waiting for a tick
    assert until_rest(wire) <= LAST_REST + 0.06
    assert wire.real.angle("waist tilt") < 30.0
    assert not wire.joints.moving
    assert played.done
    wire.joints.play(guide().gestures["bow"], None)
    wire.run(3.0)
    assert wire.real.angle("waist tilt") == pytest.approx(0.0, abs=0.01)


def test_a_new_movement_replaces_the_rest_of_the_old_one() -> None:
    wire = Wire()
    bow, _ = wire.joints.play(guide().gestures["bow"], None)
    wire.run(0.4)
    wire.joints.move({"waist tilt": 5.0, "left elbow": 30.0})
    wire.run(2.5)
    assert bow.done
    assert wire.real.angle("waist tilt") == pytest.approx(5.0, abs=0.01)
    assert wire.real.angle("head tilt") == pytest.approx(0.0, abs=0.01)  # goes on with the bow
    assert wire.joints.at_target(("left elbow", "waist tilt"))


def test_a_joint_that_does_not_follow_ends_the_gesture() -> None:
    wire = Wire()
    wire.plugged = False
    played, _ = wire.joints.play(guide().gestures["point"], None)
    wire.run(1.5)
    assert played.failure == "the right shoulder lift doesn't follow: it is 80 degrees from where it should be"
    lift = list(wire.sent[-1].joint_names).index("right_shoulder_lift")
    assert wire.sent[-1].points[-1].positions[lift] == pytest.approx(0.0)
    assert until_rest(wire) == 0.0


def test_a_joint_that_stops_short_is_reported() -> None:
    wire = Wire()
    wire.plugged = False
    wire.joints.move({"left elbow": 10.0})
    wire.run(2.0)
    assert not wire.joints.at_target(("left elbow",))
    wire.run(guide().patience - 1.0)
    with pytest.raises(RobotError, match="the left elbow doesn't move: it is 10 degrees from where it should be"):
        wire.joints.at_target(("left elbow",))


def test_to_move_nothing_changes_nothing() -> None:
    wire = Wire()
    wire.joints.move({"head tilt": -20.0})
    while wire.joints.moving:
        wire.run(STEP)
    sent = len(wire.sent)
    wire.joints.move({})
    wire.run(1.0)  # in which what was sent is compared with where the joints are
    assert len(wire.sent) == sent
    assert wire.joints.angle("head tilt") == pytest.approx(-20.0, abs=0.5)


def test_silent_joints_end_the_gesture() -> None:
    wire = Wire()
    played, _ = wire.joints.play(guide().gestures["bow"], None)
    wire.run(0.3)
    wire.silent = True
    wire.run(0.5)
    assert played.failure == "no joint states for 2 s"
    with pytest.raises(SensorSilent):
        wire.joints.move({"left elbow": 10.0})


def test_joints_brake_where_their_sender_dies() -> None:
    wire = Wire()
    wire.joints.play(guide().gestures["bow"], None)
    wire.run(0.1)
    wire.plugged = False
    wire.run(0.3)
    wire.silent = True  # its last words would be braking
    wire.sent.clear()
    wire.run(0.8)
    assert 5.0 < wire.real.angle("waist tilt") < 31.0
    assert until_rest(wire) == 0.0


@pytest.mark.parametrize(
    ("times", "rows", "problem"),
    [
        ([0.0, 0.0], [([0.0], [0.0])] * 2, "don't rise"),
        ([-1.0], [([0.0], [0.0])], "don't rise"),
        ([], [], "don't rise"),
        ([0.0, 1.0], [([0.0], [0.0]), ([1.5], [0.0])], "1.5 isn't a valid position"),
        ([0.0], [([nan], [0.0])], "nan isn't a valid position"),
        ([0.0], [([0.0], [2.5])], "2.5 isn't a valid velocity"),
        ([0.0], [([0.0], [inf])], "inf isn't a valid velocity"),
    ],
)
def test_what_is_beyond_a_joint_is_not_sent(times: list[float], rows: Any, problem: str) -> None:
    with pytest.raises(RobotError, match=problem):
        motion({"elbow": REACH}, times, rows, stamp(1.0))


@pytest.mark.parametrize(
    ("changes", "problem"),
    [
        ({"joint_names": ["tail"]}, "no joint tail"),
        ({"joint_names": ["left_elbow", "left_elbow"]}, "a position and a velocity|twice"),
        ({"stamp": 500.0}, "its stamp is 400 s from now"),
        ({"times": [1.0, 0.5]}, "don't rise"),
        ({"speed": 9.0}, "too fast"),
        ({"speed": nan}, "too fast"),
    ],
)
def test_what_cannot_be_played_is_refused(changes: dict[str, Any], problem: str) -> None:
    wire = Wire()
    speed = changes.get("speed", 0.1)
    message = motion(
        {"left_elbow": REACH}, [0.5, 1.0], [([0.1], [0.1]), ([0.2], [0.0])], stamp(changes.get("stamp", 100.0))
    )
    message.joint_names = changes.get("joint_names", ["left_elbow"])
    for point, time in zip(message.points, changes.get("times", [0.5, 1.0]), strict=True):
        point.time_from_start, point.velocities = duration(time), [speed]
    with pytest.raises(RobotError, match=problem):
        wire.player.play(message)


class Steady:
    """Fails where a joint jumps."""

    def __init__(self, wire: Wire) -> None:
        self._wire, self._before = wire, dict(wire.real.angles)
        self._most = {joint.name: joint.speed * STEP * 1.1 + 1e-6 for joint in guide().joints}

    def __call__(self) -> None:
        angles = dict(self._wire.real.angles)
        for name, angle in angles.items():
            assert abs(angle - self._before[name]) <= self._most[name], name
        self._before = angles


@pytest.mark.long
def test_a_storm_of_movements_and_halts() -> None:
    """Whatever is asked for, nothing that is sent is refused, and no joint jumps."""
    random = default_rng(23)
    for _ in range(amount(2, 100)):
        wire = Wire(int(random.integers(0, 4)))
        steady = Steady(wire)
        for _ in range(10):
            try:
                played, _ = wire.joints.play(
                    random_gesture(guide(), random), random.choice([None, random.uniform(0, 2)])
                )
            except RobotError:
                continue
            wire.run(round(random.uniform(0.0, 1.5), 2), steady)
            match random.integers(4):
                case 0:
                    played.cancel()
                case 1:
                    wire.joints.freeze()
                case 2:
                    wire.joints.freeze(("left elbow", "head turn"))
            wire.run(round(random.uniform(0.0, 0.5), 2), steady)
        while wire.joints.moving:
            assert wire.now < 600.0
            wire.run(1.0, steady)
