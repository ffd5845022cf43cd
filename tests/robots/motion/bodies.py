"""The guide, with gestures that are made for tests, and random ones."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from numpy.random import Generator

from btlang.robots.bodies.body import Body
from btlang.robots.bodies.body_file import load_body
from btlang.robots.bodies.gesture import Gesture, KeyFrame
from btlang.robots.geometry import Pose
from btlang.robots.simulation.robot import SimulatedRobot
from btlang.robots.worlds.world import World

GUIDE = Path(__file__).parents[3] / "examples/guide/robot.toml"
_BACK = {"right shoulder lift": 0, "right shoulder spread": 0, "right arm turn": 0, "right elbow": 0}
BOW = Gesture(
    "bow",
    (KeyFrame(0.8, {"waist tilt": 30, "head tilt": -10}, 0.4), KeyFrame(2.0, {"waist tilt": 0, "head tilt": 0})),
    1.0,
)
POINT = Gesture(
    "point",
    (KeyFrame(0.8, {"right shoulder lift": 80, "right elbow": 5}, 0.8), KeyFrame(2.4, _BACK)),
    0.8,
    aim="right arm",
)
HURRIED = Gesture("hurry", (KeyFrame(0.2, {"left elbow": 120}), KeyFrame(0.4, {"left elbow": 0})), 0.2)
CHEST = Gesture(
    "beat the chest", (KeyFrame(1.0, {"right shoulder lift": 40, "right arm turn": 90, "right elbow": 130}),), 1.0
)


@cache
def guide() -> Body:
    """The body of the guide with the gestures of this module."""
    gestures = {gesture.name: gesture for gesture in (BOW, POINT, HURRIED, CHEST)}
    found: Body = load_body(str(GUIDE)).replace(gestures=gestures)
    return found


def robot(on_event: object = None, body: Body | None = None) -> SimulatedRobot:
    """The guide alone in a world."""
    return SimulatedRobot(World(start=Pose(0, 0)), on_event, body or guide())  # type: ignore[arg-type]


def random_gesture(body: Body, random: Generator) -> Gesture:
    """Key frames of some joints, many of which can't be reached in time, or at all."""
    frames, at = [], 0.0
    joints = [body.joints[k] for k in random.choice(len(body.joints), random.integers(1, 8), replace=False)]
    wide = random.uniform(0.1, 1.0)
    for _ in range(random.integers(1, 5)):
        at += random.uniform(0.1, 1.2)
        named = [joint for joint in joints if random.random() < 0.8] or joints
        angles = {
            joint.name: min(joint.high, max(joint.low, joint.rest + wide * random.uniform(joint.low, joint.high)))
            for joint in named
        }
        hold = float(random.choice([0.0, random.uniform(0.0, 0.5)]))
        frames.append(KeyFrame(at, angles, hold))
        at += hold
    return Gesture("any", tuple(frames), float(random.uniform(0.0, at)))
