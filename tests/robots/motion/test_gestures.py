"""What gestures do to the body of the guide, and to bodies whose joints have no acceleration."""

from __future__ import annotations

from typing import Any

import pytest

from btlang.robots.bodies.gesture import Gesture, KeyFrame
from btlang.robots.robot import RobotError
from btlang.robots.simulation.robot import SimulatedRobot
from tests.robots.motion.bodies import guide, robot


def ended(moved: SimulatedRobot, operation: Any, dt: float = 0.05) -> float:
    began = moved.time
    while not operation.done:
        moved.step(dt)
    return moved.time - began


def test_a_gesture_goes_through_its_key_frames() -> None:
    moved = robot()
    bow = moved.gesture("bow")
    moved.step(1.0)
    assert moved.joint("waist tilt") == pytest.approx(30)
    assert moved.joint("head tilt") == pytest.approx(-10)
    assert ended(moved, bow) == pytest.approx(1.0)
    assert bow.failure is None
    assert moved.joint("waist tilt") == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize("seconds", [0.9, 1.0, 1.2345, 3.0])
def test_the_stroke_is_at_its_second(seconds: float) -> None:
    moved = robot()
    moved.step(0.037)
    moved.gesture("point", stroke_at=moved.time + seconds)
    moved.step(seconds - 0.02)
    before = moved.joint("right shoulder lift")
    moved.step(0.02)
    assert moved.joint("right shoulder lift") == pytest.approx(80, abs=1e-3)
    assert before < 80
    moved.step(0.5)
    assert moved.joint("right shoulder lift") == pytest.approx(80, abs=1e-3)  # it holds


def test_the_lead_is_what_the_stroke_needs() -> None:
    moved = robot()
    lead = moved.lead("point")
    assert 0.5 < lead < 0.95
    late = moved.gesture("point", stroke_at=moved.time)  # as soon as it can
    assert late.stroke == pytest.approx(lead, abs=0.02)  # type: ignore[attr-defined]


def test_what_is_too_fast_is_slowed_and_said() -> None:
    events: list[tuple[str, dict[str, Any]]] = []
    moved = robot(lambda kind, data: events.append((kind, dict(data))))
    moved.gesture("bow")
    moved.gesture("hurry")
    (_, bow), (_, hurry) = events
    assert bow == {"name": "bow", "slower": 1.0}
    assert hurry["slower"] > 3


@pytest.mark.parametrize("aim", [(3.0, 0.5), (3.0, -2.0), (0.5, -2.0)])
def test_an_arm_points_at_what_is_there(aim: tuple[float, float]) -> None:
    import numpy as np

    from btlang.robots.motion.kinematics import Kinematics

    moved = robot()
    moved.gesture("point", aim=aim)
    moved.step(1.0)
    frames = Kinematics(guide()).frames(np.array([[moved.joint(joint.name) for joint in guide().joints]]))
    shoulder, tip = frames["right shoulder"].origin[:, 0], frames["right hand"].place((0, 0, -0.14))[:, 0]
    wanted = np.array([*aim, 1.0]) - shoulder
    turned = np.dot(tip - shoulder, wanted) / np.linalg.norm(tip - shoulder) / np.linalg.norm(wanted)
    assert np.degrees(np.arccos(min(1.0, turned))) < 1.5


def test_what_is_out_of_reach_is_refused() -> None:
    moved = robot()
    with pytest.raises(RobotError, match="that is behind the robot; the right arm can't turn that far"):
        moved.gesture("point", aim=(-3.0, 0.0))
    with pytest.raises(RobotError, match="that is behind the robot; the head can't turn that far"):
        moved.gesture("look at", aim=(-3.0, 0.1))
    with pytest.raises(RobotError, match='no gesture "juggle"'):
        moved.gesture("juggle")
    assert not moved.moving


def test_a_body_does_not_touch_itself() -> None:
    moved = robot()
    with pytest.raises(RobotError, match=r"the right (forearm|hand) would touch the chest"):
        moved.gesture("beat the chest")
    with pytest.raises(RobotError, match=r"the right (forearm|hand) would touch the chest"):
        moved.move_joints({"right shoulder lift": 40, "right arm turn": 90, "right elbow": 130})
    assert not moved.moving


@pytest.mark.parametrize("name", [*guide().postures])
def test_every_posture_can_be_taken(name: str) -> None:
    moved = robot()
    assert ended(moved, moved.gesture(name)) < 6.0
    first = guide().postures[name][-1]
    for joint, angle in first.items():
        assert moved.joint(joint) == pytest.approx(0 if isinstance(angle, str) else angle, abs=1e-6)


@pytest.mark.parametrize("after", [0.05, 0.21, 0.4, 0.55, 0.7, 1.9])
def test_halted_in_the_stroke_it_is_at_rest_within_three_tenths(after: float) -> None:
    moved = robot()
    gesture = moved.gesture("wave")
    moved.step(after)
    moved.stop()
    moved.step(0.3)
    assert not moved.moving
    assert (gesture.done, gesture.failure) == (True, "the robot was stopped")
    at = [moved.joint(joint.name) for joint in guide().joints]
    moved.step(0.5)
    assert at == [moved.joint(joint.name) for joint in guide().joints]


def test_a_gesture_that_is_cancelled_lets_others_go_on() -> None:
    moved = robot()
    bow, wave = moved.gesture("bow"), moved.gesture("wave")
    moved.step(0.4)
    wave.cancel()
    moved.step(0.3)
    lift = moved.joint("right shoulder lift")
    ended(moved, bow)
    assert bow.failure is None
    assert moved.joint("right shoulder lift") == lift
    assert moved.joint("waist tilt") == pytest.approx(0, abs=1e-6)


def test_a_new_movement_takes_over_its_joints() -> None:
    moved = robot()
    early, other = moved.gesture("wave"), moved.gesture("nod")
    moved.step(0.1)
    ended(moved, moved.gesture("right arm hanging"))
    assert (early.done, early.failure) == (True, "another movement took over")
    ended(moved, other)
    assert other.failure is None


STEPPED = Gesture("salute", (KeyFrame(1.0, {"right arm lift": 60}, 0.5), KeyFrame(2.0, {"right arm lift": 0})), 1.0)


def test_bodies_without_acceleration_have_gestures_too() -> None:
    from btlang.robots.bodies.body_file import standard_body

    moved = robot(body=standard_body().replace(gestures={"salute": STEPPED}))
    salute = moved.gesture("salute", stroke_at=1.5)
    moved.step(0.4)
    assert moved.joint("right arm lift") == 0
    moved.step(1.1)
    assert moved.joint("right arm lift") == 60
    assert ended(moved, salute) == pytest.approx(1.0, abs=0.11)
    nod = moved.gesture("nod")
    moved.step(0.1)
    moved.stop()
    assert (nod.done, nod.failure) == (True, "the robot was stopped")
