"""`btc sim-ros` that prints how its joints and its voice are, each time that something moves or is said."""

from __future__ import annotations

import json
import sys

from btlang.cli import main
from btlang.ros.simulator.simulator import Simulator
from tests.ros.processes import Command


def watch() -> None:
    """Each step prints a line from now on, unless nothing has changed."""
    step, before = Simulator.step, [""]

    def watched(simulator: Simulator, seconds: float) -> None:
        step(simulator, seconds)
        robot = simulator.robot
        joints = {joint.name: round(robot.joint(joint.name), 4) for joint in robot.body.joints}
        said = [round(robot.said_at, 4), robot.said.text] if robot.said is not None else None
        look = json.dumps([joints, said, robot.speaking, robot.moving])
        if look != before[0]:
            before[0] = look
            print(json.dumps(["look", robot.time, joints, said, robot.speaking, robot.moving]), flush=True)

    Simulator.step = watched  # type: ignore[method-assign]


class Look:
    """The simulated robot at a second."""

    def __init__(self, line: str) -> None:
        _, self.time, self.joints, said, self.speaking, self.moving = json.loads(line)
        self.said_at, self.text = said or (0.0, "")


class WatchedSim(Command):
    """The robot, and what it did."""

    program = ("-m", "tests.ros.watched_sim")

    @property
    def looks(self) -> list[Look]:
        """All so far."""
        return [Look(line) for line in self.out.splitlines() if line.startswith('["look"') and line.endswith("]")]


if __name__ == "__main__":
    watch()
    sys.exit(main(sys.argv[1:]))
