"""What the motion of a body costs: `python -m tests.benchmarks.motion`, in time of the processor.

Random gestures of the guide are planned from wherever its body is, and checked on their whole way and on every way to
rest from it; then its joints are stepped by the ticks of their timeline, and asked where they are.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from btlang.robots.motion.course import PERIOD, JointLimits
from btlang.robots.motion.kinematics import Collisions, Kinematics
from btlang.robots.motion.smooth_joints import SmoothJoints
from btlang.robots.robot import RobotError
from tests.robots.motion.bodies import guide, random_gesture

_GESTURES = 300
_CONFIGURATIONS = 1024
_ROUNDS = 50


def main() -> None:
    """Prints the figures."""
    body, random = guide(), np.random.default_rng(1)
    limits = JointLimits.of(body.joints)
    many = random.uniform(limits.low, limits.high, (_CONFIGURATIONS, len(body.joints)))
    kinematics = Kinematics(body)
    collisions = Collisions(body, kinematics)
    each = _ROUNDS * _CONFIGURATIONS
    print(f"all links of a configuration     {1e6 * _taken(lambda: kinematics.frames(many)) / each:7.2f} us")
    print(f"and what is near of all pairs    {1e6 * _taken(lambda: collisions.distances(many, 0.01)) / each:7.2f} us")
    joints, plans, steps, ticks = SmoothJoints(body), list[float](), 0.0, 0
    for _ in range(_GESTURES):
        began = time.process_time()
        try:
            joints.play(random_gesture(body, random), None)
        except RobotError:
            continue
        finally:
            plans.append(1e3 * (time.process_time() - began))
        began = time.process_time()
        for _ in range(50):
            joints.step(PERIOD)
            _ = joints.timeline.state
        steps, ticks = steps + time.process_time() - began, ticks + 50
    print(f"a gesture is planned in          {np.median(plans):7.2f} ms, p95 {np.percentile(plans, 95):.1f} ms")
    print(f"a tick of the timeline           {1e6 * steps / ticks:7.2f} us")


def _taken(act: Callable[[], object]) -> float:
    began = time.process_time()
    for _ in range(_ROUNDS):
        act()
    return time.process_time() - began


if __name__ == "__main__":
    main()
