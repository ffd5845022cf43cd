"""Missions on the forms of the liar that are devices: a driver, and a serial board on a pty."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import btlang
from btlang.devices.kinds import Distance, JointState, Pressed
from btlang.devices.serial_board.messages import BoardChannel
from btlang.devices.serial_board.simulated_board import SimulatedBoard, SimulatedLine
from btlang.robots.registry import connector
from btlang.text.source import Source
from tests.components.robots import robot_file
from tests.lies.lies import Lie
from tests.lies.lying_driver import SCENES, WheelsOf, commanded
from tests.lies.scene import Result, Scene

EMPTY = "[start]\nx = 0\ny = 0\n"
_WHEELS, _SONAR, _BUMPER, _JOINT, _TILT = 1, 2, 3, 4, 5
_MEASURES = 0.01  # seconds
JOINTS = {"head turn": "joint", "head tilt": "joint"}
CHANNELS = (
    BoardChannel(_WHEELS, "drive", 0.02),
    BoardChannel(_SONAR, "range", 0.05),
    BoardChannel(_BUMPER, "button", 0.02),
    BoardChannel(_JOINT, "joint", 0.02),
    BoardChannel(_TILT, "joint", 0.02),
)


class LyingBoard(SimulatedBoard):
    """The form of the liar that is a board."""

    def __init__(self, scene: Scene) -> None:
        self._scene, self._wheels, self._measured = scene, WheelsOf(), 0.0
        super().__init__("liar", CHANNELS)

    def turn(self, now: float) -> None:
        """See BoardModel."""
        scene, passed = self._scene, now - self._turned
        for number, command in self.commands.items():
            if number != _TILT:
                commanded(scene, command)
        super().turn(now)
        scene.step(passed)
        if now - self._measured < _MEASURES:
            return
        self._measured = now
        odometry, distance, pressed, joint = scene.odometry(0.0), scene.sonar(), scene.bumper(), scene.joint()
        if odometry is not None:
            self.readings[_WHEELS] = self._wheels.reading(odometry)
        if distance is not None:
            self.readings[_SONAR] = Distance(distance)
        if pressed is not None:
            self.readings[_BUMPER] = Pressed(pressed)
        if joint is not None:
            self.readings[_JOINT] = JointState(joint)
        said = {_WHEELS: odometry, _SONAR: distance, _BUMPER: pressed, _JOINT: joint}
        self.frozen = {number for number, each in said.items() if each is None}


def device(name: str, kind: str, driver: str, port: str, options: str = "") -> str:
    """A device of a robot file."""
    lines = f'name = "{name}"\nkind = "{kind}"\ndriver = "{driver}"\nport = "{port}"\n{options}'
    return f"\n[[device]]\n{lines}\n"


def robot_over_driver(folder: Path, port: str) -> str:
    """A robot file whose devices are those of a scene."""
    kinds = {"base": "drive", "lidar": "lidar", "sonar": "range", "bumper": "button", **JOINTS}
    made = (device(name, kind, "tests.lies.lying_driver:LyingDriver", port) for name, kind in kinds.items())
    return robot_file(folder, "".join(made))


def robot_over_board(folder: Path, port: str) -> str:
    """A robot file whose devices are those of a lying board."""
    channels = {"base": "drive", "sonar": "range", "bumper": "button", **JOINTS}
    made = (
        device(name, kind, "serial-board", port, f"options = {{ channel = {number} }}\n")
        for number, (name, kind) in enumerate(channels.items(), 1)
    )
    return robot_file(folder, "".join(made))


@contextmanager
def _on_board(scene: Scene) -> Iterator[str]:
    with SimulatedLine(LyingBoard(scene)) as line:
        yield line.path


def run(folder: Path, mission: str, lies: Sequence[Lie], *, board: bool = False, **scene: float) -> Result:
    """A mission on a robot over devices that lie, in real time."""
    made = Scene(lies, **scene)
    folder.mkdir(parents=True, exist_ok=True)
    if board:
        with _on_board(made) as port:
            return _ran(robot_over_board(folder, port), mission, made)
    SCENES[str(folder)] = made
    try:
        return _ran(robot_over_driver(folder, str(folder)), mission, made)
    finally:
        del SCENES[str(folder)]


def _ran(robot: str, mission: str, scene: Scene) -> Result:
    with btlang.Session(connector(robot, "devices"), world=Source(EMPTY, "empty.toml")) as session:
        run = session.run(btlang.parse_tree(mission), time_limit=20.0)
        scene.wait_for_rest()
        result = scene.result
    outcome = run.outcome
    assert outcome is not None
    result.reason = "" if outcome.failure is None else str(outcome.failure.reason)
    result.reason = result.reason or outcome.stopped
    return result
