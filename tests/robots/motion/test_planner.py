"""The ways that the planner offers."""

from __future__ import annotations

import numpy as np
import pytest

from btlang.robots.bodies.gesture import Gesture, KeyFrame
from btlang.robots.motion.course import JointLimits, MotionState, samples
from btlang.robots.motion.movements import KeyFrames, Movement, Steps, frames_of
from btlang.robots.motion.timeline import MotionPlanner
from tests.robots.motion.bodies import guide

BODY_LIMITS = JointLimits.of(guide().joints)
NAMES = ("waist tilt", "head tilt")
JOINTS = [[joint.name for joint in guide().joints].index(name) for name in NAMES]
LIMITS = BODY_LIMITS.some(JOINTS)
GOAL = np.array([20.0, 10.0])
ON = Gesture("on", (KeyFrame(0.8, {"waist tilt": 10}), KeyFrame(1.6, {"waist tilt": 20})), 0.8)  # flows through 10
SPEED = np.where(np.isin(np.arange(len(guide().joints)), JOINTS), 5.0, 0.0)
MOVING = MotionState(BODY_LIMITS.rest, SPEED, 0.0 * SPEED)


@pytest.mark.parametrize(
    ("movement", "ways"),
    [(KeyFrames(JOINTS, frames_of(ON, NAMES, 0.0 * GOAL), ON, LIMITS), 4), (Steps(JOINTS, [GOAL], LIMITS), 3)],
)
def test_no_way_is_offered_twice(movement: Movement, ways: int) -> None:
    courses = list(MotionPlanner(BODY_LIMITS).courses(movement, lambda ticks: MOVING))
    different = {samples(course.pieces).position.round(6).tobytes() for course in courses}
    assert (len(courses), len(different)) == (ways, ways)
