"""Where links are, and how far from each other: against Pinocchio and Coal."""

from __future__ import annotations

import numpy as np
import pytest

from btlang.robots.bodies.body import Capsule
from btlang.robots.motion.course import JointLimits, MotionState, brake
from btlang.robots.motion.kinematics import Collisions, Kinematics
from tests.profiles import amount
from tests.robots.motion.bodies import guide

pytest.importorskip("pinocchio")

from tests.robots.motion.pinocchio_oracle import Pinocchio


@pytest.mark.long
def test_links_are_where_pinocchio_has_them() -> None:
    body, count = guide(), amount(1000, 20_000)
    limits, oracle = JointLimits.of(body.joints), Pinocchio(body)
    configurations = np.random.default_rng(1).uniform(limits.low, limits.high, (count, len(body.joints)))
    frames = Kinematics(body).frames(configurations)
    for index in range(count):
        for link in ("", "chest", "head", "left upper arm", "left hand", "right hand"):
            turned, origin = oracle.origin(link, configurations[index])
            assert np.allclose(frames[link].turned[:, :, index], turned, atol=1e-9)
            assert np.allclose(frames[link].origin[:, index], origin, atol=1e-9)


@pytest.mark.long
def test_links_are_as_far_apart_as_coal_has_them() -> None:
    body, count = guide(), amount(1000, 20_000)
    limits, oracle = JointLimits.of(body.joints), Pinocchio(body)
    configurations = np.random.default_rng(2).uniform(limits.low, limits.high, (count, len(body.joints)))
    collisions = Collisions(body, Kinematics(body))
    ours, touching = collisions.distances(configurations), 0
    for index in range(count):
        for pair, metres in oracle.distances(configurations[index]).items():
            mine = min(ours[row, index] for row, each in enumerate(collisions.pairs) if each == pair)
            touching += mine < 0.0
            if mine > 0.0 or metres > 0.0:  # how deep links are in each other is measured in many ways
                assert mine == pytest.approx(metres, abs=1e-4), (pair, configurations[index])
    assert touching > count / 50


def test_what_is_far_is_left_out_and_what_is_near_is_exact() -> None:
    body = guide()
    limits = JointLimits.of(body.joints)
    configurations = np.random.default_rng(3).uniform(limits.low, limits.high, (500, len(body.joints)))
    collisions = Collisions(body, Kinematics(body))
    exact, near = collisions.distances(configurations), collisions.distances(configurations, 0.01)
    assert np.array_equal(exact[exact <= 0.01], near[exact <= 0.01])
    assert np.isinf(near).mean() > 0.5


def test_points_parallel_lines_and_what_crosses() -> None:
    def apart(start: tuple[float, float, float], end: tuple[float, float, float]) -> float:
        fixed = Capsule("", (0, 0, 0), (1, 0, 0), 0.1)
        shapes = (fixed, Capsule("waist", start, end, 0.2))
        changed = guide().replace(capsules=shapes, forbidden=(("", "waist"),))
        found = Collisions(changed, Kinematics(changed)).distances(np.zeros((1, 14)))
        return float(found[0, 0])

    up = -0.75  # the waist is so high
    assert apart((0, 0, up + 1), (1, 0, up + 1)) == pytest.approx(0.7)
    assert apart((0.5, 0, up + 1), (0.5, 0, up + 1)) == pytest.approx(0.7)
    assert apart((0.5, -1, up + 0.5), (0.5, 1, up + 0.5)) == pytest.approx(0.2)
    assert apart((3, 0, up), (4, 0, up)) == pytest.approx(1.7)
    assert apart((0.5, -1, up), (0.5, 1, up)) == pytest.approx(-0.3)


def test_the_way_to_rest_is_that_of_ruckig() -> None:
    import ruckig

    random, count = np.random.default_rng(4), 500
    limits = JointLimits.of(guide().joints[-1:])
    most, jerk, speed = (float(values[0]) for values in (limits.acceleration, limits.jerk, limits.speed))
    acceleration = random.uniform(-most, most, count)
    velocity = random.uniform(-1.0, 1.0, count) * (speed - acceleration**2 / (2 * jerk))
    ours = brake(MotionState(np.zeros((count, 1)), velocity[:, None], acceleration[:, None]), limits)
    for index in range(count):
        wanted, found = ruckig.InputParameter(1), ruckig.Trajectory(1)
        wanted.control_interface = ruckig.ControlInterface.Velocity
        wanted.current_velocity, wanted.current_acceleration = [velocity[index]], [acceleration[index]]
        wanted.target_velocity, wanted.max_acceleration, wanted.max_jerk = [0.0], [most], [jerk]
        ruckig.Ruckig(1).calculate(wanted, found)
        took = (ours.first + ours.second + ours.third)[index, 0]
        assert took == pytest.approx(found.duration, abs=1e-9)
        assert ours.end.position[index, 0] == pytest.approx(found.at_time(found.duration)[0][0], abs=1e-9)
    assert ours.seconds < 0.3
