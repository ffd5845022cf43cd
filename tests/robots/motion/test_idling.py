"""The guide breathes and looks at who speaks, where nothing else moves its joints."""

from __future__ import annotations

from contextlib import suppress
from functools import cache

import numpy as np
import pytest

from btlang.components.device_robot import connect_devices
from btlang.robots.bodies.body import Body, Breathing, Idle
from btlang.robots.geometry import Pose
from btlang.robots.motion.course import PERIOD, JointLimits
from btlang.robots.platforms import ALL
from btlang.robots.robot import RobotError
from btlang.robots.simulation.robot import SimulatedRobot
from btlang.robots.worlds.world import Person, World
from tests.profiles import amount
from tests.robots.motion.bodies import guide, random_gesture, robot
from tests.robots.motion.test_storms import check_limits

WAIST, HEAD = "waist tilt", "head turn"
WORLD = World(start=Pose(0, 0), people=(Person("Ada", 2.0, 1.0, 0.25),))


def idle(world: World | None = None) -> SimulatedRobot:
    """The guide in a run."""
    made = robot() if world is None else SimulatedRobot(world, body=guide())
    made.enable()
    return made


def passing(moved: SimulatedRobot, seconds: float, name: str = WAIST, dt: float = 0.05) -> list[float]:
    """Where a joint is after each step."""
    found = []
    for _ in range(round(seconds / dt)):
        moved.step(dt)
        found.append(moved.joint(name))
    return found


def test_it_breathes_and_counts_as_standing_still() -> None:
    moved = idle()
    still = []
    moved.on_step = lambda dt: still.append(not moved.moving and moved.joints_at_target(WAIST))
    tilts = np.array(passing(moved, 14.0))
    assert guide().idle.breathing == Breathing(WAIST, 0.8, 4.0)
    assert (tilts.min(), tilts.max()) == pytest.approx((-0.8, 0.8), abs=0.01)
    begins = np.flatnonzero(np.diff(tilts > 0)) * 0.05
    assert np.diff(begins)[1:] == pytest.approx(2.0, abs=0.2)
    assert all(still)
    assert all(moved.joint(joint.name) == joint.rest for joint in guide().joints if joint.name != WAIST)


def test_only_in_a_run() -> None:
    moved = robot()
    assert set(passing(moved, 3.0)) == {0.0}
    moved.enable()
    assert len(set(passing(moved, 3.0))) > 20


def test_nothing_is_planned_in_coarse_steps() -> None:
    assert set(passing(idle(), 10.0, dt=1.0)) == {0.0}


def test_a_gesture_takes_over_and_then_it_breathes_again() -> None:
    moved = idle()
    passing(moved, 2.7)
    assert moved.joint(WAIST) != 0.0
    bow = moved.gesture("bow", stroke_at=moved.time + 1.2)
    assert moved.moving
    tilts = passing(moved, 1.2)
    assert tilts[-1] == pytest.approx(30, abs=1e-3)
    while not bow.done:
        moved.step(0.05)
    assert bow.failure is None
    assert not moved.moving
    tilts = passing(moved, 8.0)
    assert (min(tilts), max(tilts)) == pytest.approx((-0.8, 0.8), abs=0.01)


def test_it_breathes_around_where_the_joint_was_put() -> None:
    moved = idle()
    passing(moved, 1.0)
    moved.move_joints({WAIST: 45.0})  # its limit
    moved.step(2.0)
    assert not moved.moving
    tilts = passing(moved, 8.0)
    assert (min(tilts), max(tilts)) == pytest.approx((43.4, 45.0), abs=0.01)


def test_it_breathes_under_gestures_of_other_joints() -> None:
    moved = idle()
    passing(moved, 2.0)
    moved.gesture("point")
    assert len(set(passing(moved, 2.0))) > 20


@pytest.mark.parametrize("how", ["stop", "disable"])
def test_a_halt_stops_it(how: str) -> None:
    moved = idle(WORLD)
    passing(moved, 3.0)
    moved.hear("hello", "Ada")
    passing(moved, 0.3, HEAD)
    assert 0.0 < moved.joint(HEAD) < 20.0
    getattr(moved, how)()
    moved.step(0.3)
    assert not moved.moving
    at = moved.joint(WAIST), moved.joint(HEAD)
    passing(moved, 3.0)
    assert (moved.joint(WAIST), moved.joint(HEAD)) == at
    moved.enable()
    assert len(set(passing(moved, 6.0))) > 20
    assert moved.joint(HEAD) == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("why", ["hear", "ask", "guide"])
def test_it_looks_at_who_speaks_and_back(why: str) -> None:
    moved = idle(WORLD)
    passing(moved, 1.0)
    if why == "hear":
        moved.hear("hello", "Ada")
    elif why == "ask":
        moved.ask("Who are you?", "Ada")
    else:
        moved.guide("Ada", True)
    passing(moved, 2.0)
    place = moved.pose.bearing_to(moved.locate("Ada"))  # she walks after it
    assert moved.joint(HEAD) == pytest.approx(place, abs=10.0 if why == "guide" else 0.1)
    assert not moved.moving
    passing(moved, 4.0)
    assert moved.joint(HEAD) == pytest.approx(0.0, abs=1e-6)


def test_the_head_is_not_taken_from_what_moves_it() -> None:
    moved = idle(WORLD)
    moved.move_joints({HEAD: -60.0})
    moved.hear("hello", "Ada")
    passing(moved, 0.3, HEAD)
    assert moved.joint(HEAD) < -5.0
    passing(moved, 2.5)
    assert moved.joint(HEAD) == pytest.approx(26.6, abs=0.1)
    moved.move_joints({HEAD: -30.0})
    passing(moved, 6.0)
    assert moved.joint(HEAD) in (pytest.approx(-30.0), pytest.approx(26.6, abs=0.1))


def test_strangers_and_who_is_behind_it_are_not_looked_at() -> None:
    moved = idle(WORLD.replace(start=Pose(0, 0, 180)))
    for who in ("Ada", "Nobody", ""):
        moved.hear("hello", who)
        assert set(passing(moved, 1.0, HEAD)) == {0.0}


def test_over_servos() -> None:
    connection = connect_devices(WORLD, body=guide(), simulate=[ALL])
    moved = connection.robot
    moved.enable()
    passing(moved, 3.0)
    tilts = passing(moved, 5.0)
    assert (min(tilts), max(tilts)) == pytest.approx((-0.8, 0.8), abs=0.1)
    moved.hear("hello", "Ada")
    passing(moved, 2.0)
    assert moved.joint(HEAD) == pytest.approx(26.6, abs=0.5)
    assert not moved.moving
    moved.disable()
    passing(moved, 0.5)
    assert not moved.moving
    assert len({round(tilt, 3) for tilt in passing(moved, 2.0)}) == 1
    connection.close()


@cache
def restless() -> Body:
    """It breathes deeply, with an arm."""
    breathing = Breathing("left shoulder spread", 8.0, 3.0)
    made: Body = guide().replace(idle=Idle(breathing, True))
    return made


@pytest.mark.long
@pytest.mark.parametrize("seed", range(amount(1, 100)))
def test_storms_over_idle_joints(seed: int) -> None:
    pytest.importorskip("pinocchio")
    from tests.robots.motion.pinocchio_oracle import Pinocchio

    body, random = restless(), np.random.default_rng(seed)
    oracle, positions = Pinocchio(body), []
    moved = SimulatedRobot(WORLD, body=body)
    moved.enable()
    for _ in range(30):
        what, halted = random.random(), False
        if what < 0.5:
            with suppress(RobotError):  # the body would touch itself
                moved._joints.play(random_gesture(body, random), None)  # type: ignore[attr-defined]
        elif what < 0.8:
            moved.hear("hello", "Ada")
        else:
            moved.stop()
            halted = True
        for _ in range(int(random.exponential(100.0))):
            moved.step(PERIOD)
            positions.append([moved.joint(joint.name) for joint in body.joints])
            if halted:
                moved.enable()
    check_limits(np.array(positions), JointLimits.of(body.joints), seed)
    for position in positions[::2]:
        assert not oracle.collides(np.array(position)), (seed, position)
