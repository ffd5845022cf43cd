"""The guide with gestures for the commentaries of `samples`, in a room with what they point at."""

from __future__ import annotations

from pathlib import Path

from btlang.robots.bodies.body import Body
from btlang.robots.bodies.body_file import load_body
from btlang.robots.bodies.gesture import Gesture, KeyFrame, Step
from btlang.robots.simulation.robot import SimulatedRobot
from btlang.robots.worlds.world import World
from btlang.robots.worlds.world_file import load_world
from btlang.speech.engine import Settings
from btlang.text.source import Source

SAMPLES = {
    path.stem: path.read_text(encoding="utf-8").strip() for path in (Path(__file__).parent / "samples").glob("*.txt")
}
ROOM = """
start = { x = 2, y = 5 }
walls = [[[0, 0], [10, 0], [10, 10], [0, 10], [0, 0]]]
places = [{ name = "door", x = 8, y = 6 }, { name = "bench", x = 7, y = 3 }]
objects = [{ name = "statue", x = 6, y = 4, size = 0.3 }]
"""


def both(part: str, angle: float) -> dict[str, float]:
    return {f"left {part}": angle, f"right {part}": angle}


def gesture(name: str, *steps: Step, at: float = 0.7, each: float = 0.5, aim: str = "") -> Gesture:
    """Key frames one after the other; the stroke is in the first, and the joints return at the end."""
    back = {joint: 0.0 for step in steps for joint in step}
    frames = [KeyFrame(at + number * each, step) for number, step in enumerate(steps)]
    return Gesture(name, (*frames, KeyFrame(frames[-1].at + 0.9, back)), at, aim=aim)


_ARM = {"right shoulder lift": 45.0, "right elbow": 60.0}
GESTURES = (
    gesture("wave", {**_ARM, "right shoulder spread": 30.0}, {"right elbow": 90.0}, {"right elbow": 60.0}),
    gesture("bow", {"waist tilt": 25.0, "head tilt": -15.0}, at=1.0),
    gesture("nod", {"head tilt": -15.0}, {"head tilt": 5.0}, at=0.3, each=0.3),
    gesture("shake head", {"head turn": 20.0}, {"head turn": -20.0}, at=0.4, each=0.4),
    gesture("open arms", both("shoulder spread", 35.0)),
    gesture("shrug", {**both("shoulder spread", 15.0), **both("elbow", 40.0)}, at=0.5),
    gesture("raise arms", both("shoulder lift", 110.0), at=1.0),
    gesture("count", {"right elbow": 90.0}, {"right elbow": 70.0}, {"right elbow": 90.0}),
    gesture("point left", {"left shoulder spread": 80.0}),
    gesture("point right", {"right shoulder spread": 80.0}),
    gesture("point ahead", {"right shoulder lift": 90.0}),
    gesture("hand to ear", {"right elbow": 110.0, "right shoulder spread": 40.0}),
    gesture("beckon", {"left shoulder lift": 30.0, "left elbow": 80.0}, {"left elbow": 50.0}),
    gesture("point at", {"right shoulder lift": 80.0}, aim="right arm"),
    gesture("look at", {"head turn": 0.0}, at=0.5, aim="head"),
)


def guide(engine: str = "espeak") -> Body:
    """Its body, with a voice in English."""
    body = load_body(str(Path(__file__).parents[2] / "examples" / "guide" / "robot.toml"))
    assert body.voice is not None
    voice = body.voice.replace(engine=engine, settings=Settings(variant="f3"))
    changed: Body = body.replace(gestures={each.name: each for each in GESTURES}, voice=voice)
    return changed


def room() -> World:
    return load_world(Source(ROOM, "room.toml"))


def robot(engine: str = "espeak") -> SimulatedRobot:
    return SimulatedRobot(room(), body=guide(engine))
