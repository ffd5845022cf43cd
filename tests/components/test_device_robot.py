"""The robot over its devices: the examples on simulated twins, and what it does where devices are silent."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import pytest

import btlang
from btlang.cli.examples import examples
from btlang.components.device_robot import twins
from btlang.components.parts.parts import DeviceHands
from btlang.devices.kinds import Command, Grip, GripTarget
from btlang.devices.simulated import SimulatedDevice, twin
from btlang.robots.bodies.body import Device
from btlang.robots.bodies.body_file import standard_body
from btlang.robots.platforms import ALL
from btlang.robots.registry import connector
from btlang.robots.simulation.parts import SimulatedHands, make_simulated_parts
from btlang.robots.simulation.robot import SimulatedRobot
from btlang.robots.worlds.obstacles import Obstacles
from btlang.robots.worlds.world_file import load_world
from btlang.run.events import Event, Said
from btlang.vocabulary.shipped import shipped
from tests.components.robots import robot_file
from tests.profiles import cases, only_long

SHIPPED = Path(shipped("examples"))


def run(text: str | Path, robot: Any, world: str | None = None, **options: Any) -> tuple[btlang.Outcome, list[Event]]:
    events: list[Event] = []
    mission = btlang.parse_file(str(text), world=world) if isinstance(text, Path) else btlang.parse_tree(text)
    with btlang.Session(robot, world=mission.world) as session:
        options = {"speed": "max", "seed": 1, "time_limit": 300.0, **options}
        outcome = session.run(mission, sinks=[events.append], **options).outcome
    assert outcome is not None
    return outcome, events


@cases("example", examples(), 6, ids=lambda example: example.name)
def test_examples_run_unchanged_over_devices(example: Any) -> None:
    world = str(SHIPPED / "worlds" / Path(example.world).name) if example.world else None
    path = SHIPPED / f"{example.name}.txt"
    usual, heard = run(path, "simulated", world)
    over, told = run(path, connector("standard", "devices", simulate=[ALL]), world)
    assert (over.status, over.stopped) == (usual.status, usual.stopped)
    assert [event.text for event in told if isinstance(event, Said)] == [
        event.text for event in heard if isinstance(event, Said)
    ]
    assert over.seconds == pytest.approx(usual.seconds, rel=0.25)


@pytest.mark.parametrize(("times", "docks"), [(2, True), (3, False)])
def test_a_dock_that_does_not_connect_is_tried_again(tmp_path: Path, times: int, docks: bool) -> None:
    world = tmp_path / "hall.toml"
    fault = f'faults = [{{ kind = "dock", times = {times} }}]'
    world.write_text(f"start = {{ x = 1.5, y = 1.5 }}\ndock = {{ x = 0.4, y = 0.6, facing = 180 }}\n{fault}\n", "utf-8")
    mission = btlang.parse_tree("dock then undock then charge", world=str(world))
    with btlang.Session(connector("standard", "devices", simulate=[ALL]), world=str(world)) as session:
        outcome = session.run(mission, speed="max").outcome
    assert outcome is not None
    assert outcome.succeeded is docks
    assert docks or "Dock: the dock doesn't connect" in outcome.why()


def test_without_a_drive_it_says_so_and_does_not_move() -> None:
    outcome, _ = run("go to the lab", connector("standard", "devices"), speed="real")
    assert not outcome.succeeded
    assert "the base has no device" in outcome.why()
    assert outcome.standstill.still is None  # nobody knows


def device(name: str, kind: str, **options: str) -> str:
    listed = ", ".join(f"{key} = {value}" for key, value in options.items())
    return f'[[device]]\nname = "{name}"\nkind = "{kind}"\ndriver = "simulated"\noptions = {{ {listed} }}'


def test_wheels_that_fall_silent_end_the_journey(tmp_path: Path) -> None:
    robot = connector(robot_file(tmp_path, device("wheels", "drive", silent="[4, 1000]")), "devices", simulate=[ALL])
    outcome, _ = run("go to the lab", robot)
    assert not outcome.succeeded
    assert "the wheels is silent" in outcome.why()
    assert outcome.seconds == pytest.approx(4.0, abs=0.2)


def test_a_battery_that_is_silent_is_not_known(tmp_path: Path) -> None:
    robot = connector(robot_file(tmp_path, device("power", "battery", silent="[0, 1000]")), "devices", simulate=[ALL])
    outcome, events = run("if the battery is below 20%, print low otherwise print fine", robot)
    assert not outcome.succeeded
    assert [event.tag for event in events if event.tag in ("print", "warning")] == ["warning"]


def test_a_lidar_is_where_the_robot_file_has_the_scanner(tmp_path: Path) -> None:
    path = Path(robot_file(tmp_path, device("eye", "lidar")))
    text = path.read_text(encoding="utf-8")
    scanner = 'kind = "scanner"\nframe = "base_link"\n'
    path.write_text(text.replace(scanner, f"{scanner}ahead = 0.15\nangle = 180\n"), encoding="utf-8")
    world = tmp_path / "wall.toml"
    world.write_text("start = { x = 1, y = 1 }\nwalls = [[[1.6, 0], [1.6, 2]]]\n", encoding="utf-8")
    mission = tmp_path / "look.txt"
    mission.write_text("check that the distance ahead is above 39 cm and the distance ahead is below 41 cm", "utf-8")
    outcome, _ = run(mission, connector(str(path), "devices", simulate=[ALL]), str(world))
    assert outcome.succeeded, outcome.why()


@pytest.mark.parametrize("sensor", ["range", "button"])
def test_the_gate_stops_before_a_wall(tmp_path: Path, sensor: str) -> None:
    """The bumper that is always silent counts as one that is pressed."""
    guard = (
        device("front", "range", cone="90")
        if sensor == "range"
        else device("front bumper", "button", silent="[0, 1000]")
    )
    robot = connector(robot_file(tmp_path, guard), "devices", simulate=[ALL])
    outcome, events = run("drive forward at 1 m/s for 20 seconds then back up 0.3 m", robot, time_limit=40.0)
    assert "bump" not in [event.tag for event in events]
    assert outcome.seconds < 40


@pytest.mark.parametrize("ends", [0.0, 2.0])
def test_a_lidar_alone_stops_it_before_a_wall(tmp_path: Path, ends: float) -> None:
    """Also one that falls silent."""
    lidar = device("lidar", "lidar", **({"silent": f"[{ends}, 1000]"} if ends else {}))
    robot = connector(robot_file(tmp_path, lidar), "devices", simulate=[ALL])
    outcome, events = run("move forward 9 m", robot, time_limit=60.0)
    assert "bump" not in [event.tag for event in events]
    reason = "the lidar is silent" if ends else "scanner: 0.04 m ahead"
    assert reason in outcome.why()


def test_the_watchdog_stops_a_twin_that_nobody_commands(tmp_path: Path) -> None:
    from btlang.devices.device_set import DeviceSet
    from btlang.devices.kinds import WheelSpeeds
    from btlang.robots.bodies.body_file import load_body

    body = load_body(robot_file(tmp_path, device("wheels", "drive")))
    twin = SimulatedRobot(load_world(), body=body)
    devices = DeviceSet(body, twin, lambda kind, data: None)
    devices.readers["wheels"].write("wheels", WheelSpeeds(0.2, 0.2))
    for _ in range(3):
        twin.step(0.05)
        devices.step()
    assert twin.velocity[0] > 0.1
    for _ in range(6):
        twin.step(0.05)
        devices.step()
    assert twin.velocity == (0.0, 0.0)


def test_real_devices_run_in_real_time(tmp_path: Path) -> None:
    (tmp_path / "wheels.py").write_text(WHEELS, encoding="utf-8")
    table = '[[device]]\nname = "wheels"\nkind = "drive"\ndriver = "wheels:Driver"'
    robot = connector(robot_file(tmp_path, table), "devices")
    began = time.monotonic()
    outcome, _ = run("move forward 0.2 m", robot, speed="real", rate=2.0)
    assert outcome.succeeded, outcome.why()
    assert 0.2 < time.monotonic() - began < 20
    with pytest.raises(ValueError, match="real time"):
        run("move forward", robot, speed="max")


def mixed(folder: Path) -> Any:
    """Real wheels, and for everything else simulated devices."""
    (folder / "wheels.py").write_text(WHEELS, encoding="utf-8")
    wheels = '[[device]]\nname = "wheels"\nkind = "drive"\ndriver = "wheels:Driver"'
    others = [device(each.name, each.kind) for each in twins(standard_body()) if each.kind != "drive"]
    return connector(robot_file(folder, "\n".join([wheels, *others])), "devices")


def test_simulated_joints_move_beside_real_wheels(tmp_path: Path) -> None:
    text = "raise the left arm then move forward 0.2 m then look left and lower the left arm"
    outcome, _ = run(text, mixed(tmp_path), speed="real", time_limit=30.0)
    assert outcome.succeeded, outcome.why()


@only_long
@pytest.mark.parametrize("example", examples(), ids=lambda example: example.name)
def test_examples_run_on_a_mixed_robot(example: Any, tmp_path: Path) -> None:
    world = str(SHIPPED / "worlds" / Path(example.world).name) if example.world else None
    path = SHIPPED / f"{example.name}.txt"
    usual, _ = run(path, "simulated", world, time_limit=60.0)
    over, _ = run(path, mixed(tmp_path), world, speed="real", time_limit=60.0 + 0.25 * usual.seconds)
    assert usual.stopped or (over.status, over.stopped) == (usual.status, usual.stopped)


WHEELS = """
import time
from btlang.devices.kinds import Wheels, WheelSpeeds

class Driver:
    kinds, needs_port, rate = ("drive",), False, 50.0

    def __init__(self, port, devices):
        self.name = devices[0].name
        self.at = [0.0, 0.0]
        self.speeds = WheelSpeeds()
        self.last = None

    def open(self):
        self.last = time.monotonic()

    def exchange(self, commands):
        now = time.monotonic()
        passed, self.last = now - self.last, now
        self.at[0] += self.speeds.left * passed
        self.at[1] += self.speeds.right * passed
        self.speeds = commands[self.name]
        return {self.name: Wheels(*self.at, self.speeds.left, self.speeds.right)}

    def close(self):
        self.speeds = WheelSpeeds()
"""


def test_a_stop_holds_a_hand_that_closes() -> None:
    told: list[Command] = []

    class Hand:
        def read(self, name: str) -> Grip:
            return Grip(0.5, False)

        def write(self, name: str, command: Command) -> None:
            told.append(command)

        def silent(self, name: str) -> str | None:
            return None

    body = standard_body()
    known = SimulatedHands(Obstacles(load_world()), (), body)
    parts = make_simulated_parts(load_world(), Obstacles(load_world()), body)
    name = body.hands[0].name
    hands = DeviceHands(body, {f"{name} hand": Hand()}, known)
    robot = SimulatedRobot(load_world(), make_parts=lambda world, obstacles, body: parts.replace(hands=hands))
    operation = robot.grasp(name)  # type: ignore[arg-type]
    robot.step(0.05)
    assert told[-1] == GripTarget(1.0)
    robot.stop()
    assert told[-1] == GripTarget()
    robot.step(0.05)
    assert told[-1] == GripTarget()
    assert (operation.done, operation.failure) == (True, "the robot was stopped")


def test_who_else_looks_changes_no_noise() -> None:
    """A page that shows the robot reads its devices, too."""
    seen = []
    for looks in (1, 3):
        robot = SimulatedRobot(load_world())
        front = SimulatedDevice(Device("front", "range", "simulated", options={"noise": 0.1, "range": 100.0}), robot)
        found = []
        for _ in range(3):
            robot.step(0.05)
            found += [[front.read("front") for _ in range(looks)][-1]]
        seen.append(found)
    assert seen[0] == seen[1]
    assert len(set(seen[0])) == 3


def test_a_twin_has_the_options_of_its_kind() -> None:
    scale = Device("scale", "gauge", "scales:Scale", options={"value": 3, "baud": 9600, "delay": 1})
    assert twin(scale) == Device("scale", "gauge", "simulated", options={"value": 3})
    assert twin(scale.replace(options={"value": "three"})).options == {}
