"""Random gestures, moves, cancels and halts, each cut off by the next: no limit passed, and no link touched."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.random import Generator

from btlang.robots.bodies.body import Body
from btlang.robots.motion.course import PERIOD, JointLimits
from btlang.robots.motion.kinematics import Array
from btlang.robots.motion.smooth_joints import SmoothJoints
from btlang.robots.robot import RobotError
from tests.profiles import amount
from tests.robots.motion.bodies import guide, random_gesture

pytest.importorskip("pinocchio")

from tests.robots.motion.pinocchio_oracle import Pinocchio

_EVENTS = 100
_LOOKS = 2  # samples between two looks of the oracle


@pytest.mark.long
@pytest.mark.parametrize("seed", range(amount(2, 1000)))
def test_no_limit_is_passed_and_nothing_touched(seed: int) -> None:
    body, random = guide(), np.random.default_rng(seed)
    joints, oracle = SmoothJoints(body), Pinocchio(body)
    positions, refused = [joints.timeline.state.position], 0
    for _ in range(_EVENTS):
        refused += _is_refused(joints, body, random)
        for _ in range(int(random.exponential(30.0))):
            joints.step(PERIOD)
            positions.append(joints.timeline.state.position)
    joints.freeze()
    for _ in range(30):
        joints.step(PERIOD)
        positions.append(joints.timeline.state.position)
    assert not joints.moving, seed
    check_limits(np.array(positions), JointLimits.of(body.joints), seed)
    for position in positions[::_LOOKS]:
        assert not oracle.collides(position), (seed, position)
    assert refused < _EVENTS / 2


def _is_refused(joints: SmoothJoints, body: Body, random: Generator) -> bool:
    """Asks for something; that a limit would be passed is no reason."""
    problem = ""
    try:
        _something(joints, body, random)
    except RobotError as error:
        problem = str(error)
    assert not problem or "would touch" in problem
    return bool(problem)


def _something(joints: SmoothJoints, body: Body, random: Generator) -> None:
    what = random.random()
    some = [body.joints[k] for k in random.choice(len(body.joints), random.integers(1, 6), replace=False)]
    if what < 0.7:
        room = None if random.random() < 0.5 else float(random.uniform(0.0, 2.0))
        joints.play(random_gesture(body, random), room)
    elif what < 0.9:
        share = random.uniform(0.1, 1.0)
        joints.move({joint.name: share * random.uniform(joint.low, joint.high) for joint in some})
    elif what < 0.97:
        joints.freeze(tuple(joint.name for joint in some))
    else:
        joints.freeze()


def check_limits(positions: Array, limits: JointLimits, seed: int) -> None:
    """By differences, which are means over a moment, and so within the limits too."""
    assert (positions >= limits.low - 1e-3).all(), seed
    assert (positions <= limits.high + 1e-3).all(), seed
    for order, most in ((1, limits.speed), (2, limits.acceleration), (3, limits.jerk)):
        reached = np.abs(np.diff(positions, order, axis=0)).max(axis=0) / PERIOD**order
        assert (reached <= 1.02 * most).all(), (seed, order, reached / most)
