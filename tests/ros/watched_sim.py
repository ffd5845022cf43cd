"""`btc sim-ros` that prints how its joints and its voice are, each time that something moves or is said."""

from __future__ import annotations

import json
import sys

from btlang.cli import main
from btlang.robots.bodies.gesture import Gesture
from btlang.ros.simulator.simulator import Simulator
from tests.ros.processes import Command
from tests.speech.strokes import Way

_LINE = 4000  # characters of two lines
_AROUND = 1.0  # seconds around a word in which its stroke is looked for


def watch() -> None:
    """Each step prints a line from now on, unless nothing has changed."""
    step, before = Simulator.step, [""]

    def watched(simulator: Simulator, seconds: float) -> None:
        step(simulator, seconds)
        robot = simulator.robot
        joints = {joint.name: round(robot.joint(joint.name), 4) for joint in robot.body.joints}
        said = [round(robot.said_at, 4), robot.said.text] if robot.said is not None else [0.0, ""]
        look = json.dumps([joints, said, robot.speaking, robot.moving])
        if look != before[0]:
            before[0] = look
            print(json.dumps(["look", robot.time, joints, said, robot.speaking, robot.moving]), flush=True)

    setattr(Simulator, "step", watched)  # noqa: B010


class Look:
    """The simulated robot at a second."""

    def __init__(self, line: str) -> None:
        found = json.loads(line)
        self.time, self.joints = float(found[1]), dict[str, float](found[2])
        self.said_at, self.text = float(found[3][0]), str(found[3][1])
        self.speaking, self.moving = bool(found[4]), bool(found[5])

    def joint(self, name: str) -> float:
        """Degrees."""
        angle: float = self.joints[name]
        return angle


class WatchedSim(Command):
    """The robot, and what it did."""

    program = ("-m", "tests.ros.watched_sim")

    @property
    def looks(self) -> list[Look]:
        """All so far."""
        return [Look(line) for line in self.out.splitlines() if line.startswith('["look"') and line.endswith("]")]

    @property
    def last(self) -> Look:
        """The latest one; there has to be one."""
        whole = self.out[-_LINE:].split("\n")[:-1]
        return Look(next(line for line in reversed(whole) if line.startswith('["look"')))

    def late(self, gesture: Gesture, text: str, word: float) -> float | None:
        """Seconds by which the joints had the stroke of a gesture after a second of a text that it said; None where
        they had it not, or geometry finds it.
        """
        [frame] = [frame for frame in gesture.frames if frame.at <= gesture.stroke <= frame.at + frame.hold]
        if gesture.aim:
            return None
        looks = self.looks
        at = next(look.said_at for look in looks if look.speaking and look.text == text) + word
        way = Way(gesture.name, {name: float(angle) for name, angle in frame.joints.items()}, at)
        for look in looks:
            if abs(look.time - at) < _AROUND:
                way.look(look)
        return None if way.met is None else way.met - at - (0.0 if frame.hold == 0.0 else frame.at - gesture.stroke)


if __name__ == "__main__":
    watch()
    sys.exit(main(sys.argv[1:]))
