"""Reads and checks robot files (TOML). docs/robots.md has all keys."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Collection
from functools import cache

from btlang.diagnostics.files import is_below, real_path
from btlang.robots.bodies import joint_tables
from btlang.robots.bodies.body import (
    PATIENCE,
    TOLERANCE,
    BaseSpec,
    Battery,
    Body,
    ComponentPart,
    Device,
    Dock,
    HandPart,
    Idle,
    NavigationSpec,
    RosNode,
    Sensor,
    SpeedLimits,
)
from btlang.robots.bodies.gesture import Gesture, Step
from btlang.robots.bodies.gesture_file import read_gestures
from btlang.robots.bodies.joint_tables import read_idle
from btlang.robots.bodies.speech_tables import read_ears, read_mouth, read_voice
from btlang.robots.files import DataFileError, as_mission_error, load_data
from btlang.robots.platforms import ROBOTS
from btlang.text.source import Source
from btlang.text.toml_table import Problem, Problems, Table
from btlang.vocabulary.shipped import BODIES, STANDARD_BODY

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeVar

    from btlang.diagnostics.diagnostic import MissionError

    T = TypeVar("T")

_HANDS = ("left", "right")
_SENSORS = ("scanner", "bumper", "camera")
_RUNS = ("process", "here")
_NODE = re.compile(r"(?:/[A-Za-z_][A-Za-z0-9_]*)+")
_LEAST = 0.001
_FOREIGN = 'components, and drivers but for "simulated", may only be in a robot file on this computer: they run code'


class BodyError(DataFileError):
    """The reason why a robot file can't be used."""

    code = "BT071"


def load_body(file: str | Source, overs: Collection[str] = tuple(ROBOTS)) -> Body:
    """Return the robot in a file or a text, which may run on one of `overs`. Raises BodyError, or GestureError.

    A text that isn't from a file that the user named has no components, and only simulated devices.
    """
    named = file if isinstance(file, str) else file.name if file.may_load else ""
    real = os.path.abspath(named) if os.path.isfile(named) else ""
    return load_data(file, "a robot", lambda top: _body(top, overs, real), BodyError)


def read_body(file: str | Source, overs: Collection[str] = tuple(ROBOTS)) -> Body:
    """Return the robot as `load_body` does. Raises MissionError (BT071, BT076)."""
    try:
        return load_body(file, overs)
    except DataFileError as error:
        raise as_mission_error(error) from None


def unusable_robot(problem: Exception) -> MissionError:
    """Return the error (BT071) for a problem that no line of the file shows: something isn't
    installed, or is missing.
    """
    from btlang.diagnostics.diagnostic import MissionError, diagnostic
    from btlang.text.source import NOWHERE

    return MissionError([diagnostic(BodyError.code, NOWHERE, reason=str(problem))])


@cache
def standard_body() -> Body:
    """Return the robot that a mission runs on by default."""
    return load_body(STANDARD_BODY)


def shipped_bodies() -> list[str]:
    """Return the names of the robots that ship."""
    return sorted(name.removesuffix(".toml") for name in os.listdir(BODIES) if name.endswith(".toml"))


def _body(top: Table, overs: Collection[str], file: str) -> Body:
    name, over = top.text("name"), top.choice("over", tuple(ROBOTS), "simulated")
    if over not in overs:
        listed = " or ".join(f'"{each}"' for each in overs)
        raise top.problem("over", f'"over" may only be {listed} here; to allow "{over}", bring the robot up on it')
    problems = Problems()
    radius = problems.part(lambda: top.number("radius", low=0.01, high=10.0), 0.01)
    base = problems.part(lambda: _base(top.table("base")) if top.has("base") else None, None)
    navigation = problems.part(lambda: _navigation(top, radius), None)
    joints = _read_list(top, "joints", joint_tables.joint, problems)
    postures = problems.part(lambda: joint_tables.postures(top, joints), dict[str, tuple[Step, ...]]())
    capsules = tuple(each for each in problems.rows(top, "capsules", joint_tables.capsule) if each is not None)
    forbidden = problems.part(lambda: joint_tables.forbidden_pairs(top), tuple[tuple[str, str], ...]())
    if not problems.found:
        problems.found += joint_tables.link_problems(joints, capsules, forbidden)
    gestures = dict[str, Gesture]()
    if top.has("gestures") and not problems.found:
        gestures = problems.part(lambda: read_gestures(top, joints, file), gestures)
    hands = _read_list(top, "hands", _hand, problems)
    sensors = _read_list(top, "sensors", _sensor, problems, key="kind")
    problems.found += [
        Problem(f'there is no joint "{sensor.joint}"', "sensors", index, "joint")
        for index, sensor in enumerate(sensors)
        if sensor.joint and all(joint.name != sensor.joint for joint in joints)
    ]
    battery = problems.part(lambda: _battery(top), None)
    dock = problems.part(lambda: _dock(top), None)
    voice = problems.part(lambda: read_voice(top, bool(file)), None)
    screen = problems.part(lambda: top.flag("screen"), False)
    devices = _read_list(top, "device", _device, problems)
    components = _read_list(top, "component", _component, problems)
    made = Body(
        name, radius, over, base, navigation, joints, postures, hands, sensors, battery, dock, voice, screen,
        devices, components, file, problems.part(lambda: _beside(top, "world", file), ""),
        problems.part(lambda: read_ears(top, bool(file)), None), capsules, forbidden,
        rules=problems.part(lambda: _beside(top, "rules", file), ""),
        missions=problems.part(lambda: _beside(top, "missions", file, os.path.isdir), ""),
        schedules=problems.part(lambda: _beside(top, "schedules", file), ""), gestures=gestures,
        patience=problems.part(lambda: top.number("patience", PATIENCE, low=0.1, high=3600.0), PATIENCE),
    )  # fmt: skip
    mouth = problems.part(lambda: read_mouth(top, made), None)
    idle = problems.part(lambda: read_idle(top, made), Idle())
    problems.part(lambda: top.finish(made), made)
    if not file:
        problems.found += [Problem(_FOREIGN, "component", index) for index in range(len(components))]
        real = (index for index, device in enumerate(devices) if device.driver != "simulated")
        problems.found += [Problem(_FOREIGN, "device", index, "driver") for index in real]
    problems.end()
    complete: Body = made.replace(mouth=mouth, idle=idle)
    return complete


def _beside(top: Table, key: str, file: str, exists: Callable[[str], bool] = os.path.isfile) -> str:
    """Return the path of a file or folder in the folder of the robot file; "" if there is no such key."""
    if not top.has(key):
        return ""
    folder = os.path.dirname(file)
    path = os.path.join(folder, top.text(key))
    if file and not os.path.lexists(path):
        raise top.problem(key, f'"{key}": there is no "{top.text(key)}" in the folder of the robot file')
    if not (file and is_below(real_path(path), folder) and exists(path)):
        what = "file" if exists is os.path.isfile else "folder"
        raise top.problem(key, f'"{key}" must be a {what} in the folder of the robot file')
    return path


def _read_list(
    top: Table, section: str, make: Callable[[Table], T], problems: Problems, key: str = "name"
) -> tuple[T, ...]:
    """Return what is made of the tables of a list, without the wrong ones; names are unique."""
    found: list[T] = []
    tables: list[Table] = problems.part(lambda: top.tables(section), [])
    for index, table in enumerate(tables):
        try:
            each = make(table)
        except Problem as problem:
            problems.found.append(problem)
            continue
        if getattr(each, key) in [getattr(other, key) for other in found]:
            problems.found.append(Problem(f'"{getattr(each, key)}" is given twice in {section}', section, index, key))
        found.append(each)
    return tuple(found)


def _navigation(top: Table, radius: float) -> NavigationSpec | None:
    if not top.has("navigation"):
        return None
    table = top.table("navigation")
    near = table.number("objects", low=radius), table.number("people", low=radius)
    return table.finish(NavigationSpec(*near, table.number("tolerance", TOLERANCE, low=_LEAST, high=100.0)))


def _battery(top: Table) -> Battery | None:
    if not top.has("battery"):
        return None
    table = top.table("battery")
    return table.finish(Battery(*(table.number(key, low=0.0) for key in ("idle", "driving", "charging"))))


def _dock(top: Table) -> Dock | None:
    if not top.has("dock"):
        return None
    table = top.table("dock")
    within = table.number("within", low=_LEAST)
    beyond = table.number("beyond", low=within)
    backs_off = table.number("backs_off", low=beyond)
    staging = table.number("staging", 0.4, low=within, high=100.0)
    speed = table.number("speed", 0.15, low=_LEAST)
    retries = int(table.number("retries", 2, low=0, high=100))
    return table.finish(Dock(within, beyond, backs_off, staging, speed, retries))


def _base(table: Table) -> BaseSpec:
    driving, turning = _limits(table.table("driving")), _limits(table.table("turning"))
    gap = table.number("wheel_gap", low=0.01)
    return table.finish(
        BaseSpec(
            driving,
            turning,
            gap,
            table.number("contact_speed", min(0.1, driving.speed), low=_LEAST, high=driving.speed),
        )
    )


def _limits(table: Table) -> SpeedLimits:
    speed = table.number("speed", low=_LEAST)
    rates = (table.number(key, low=_LEAST) for key in ("acceleration", "slowing", "brake", "hard_brake"))
    return table.finish(SpeedLimits(speed, table.number("top_speed", low=speed), *rates))


def _hand(table: Table) -> HandPart:
    name = table.choice("name", _HANDS)
    ahead, left = table.number("ahead"), table.number("left")
    return table.finish(
        HandPart(name, ahead, left, table.number("reach", low=_LEAST), table.number("puts_at", low=_LEAST))
    )


def _sensor(table: Table) -> Sensor:
    kind, frame = (
        table.choice("kind", _SENSORS, hint='what measures something else is a device: [[device]], kind = "gauge"'),
        table.text("frame"),
    )
    if kind == "bumper":
        return table.finish(Sensor(kind, frame))
    reach, view = table.number("range", low=_LEAST), table.number("view", 360.0, low=1.0, high=360.0)
    angle, joint = table.number("angle", 0.0, low=-360.0, high=360.0), table.text("joint") if table.has("joint") else ""
    recognizes = table.number("recognizes", reach if kind == "camera" else 0.0, low=0.0, high=reach)
    ahead, left = table.number("ahead", 0.0), table.number("left", 0.0)
    return table.finish(Sensor(kind, frame, reach, view, angle, joint, recognizes, ahead, left))


def _device(table: Table) -> Device:
    name, kind, driver = table.text("name"), table.text("kind"), table.text("driver")
    port = table.text("port") if table.has("port") else ""
    scale, offset = table.number("scale", 1.0), table.number("offset", 0.0)
    if scale == 0.0:
        raise table.problem("scale", '"scale" must not be 0')
    angle = table.number("angle", 0.0, low=-360, high=360)
    return table.finish(Device(name, kind, driver, port, table.values("options"), scale, offset, angle))


def _component(table: Table) -> ComponentPart:
    name, node = table.text("name"), _node(table) if table.has("node") else None
    if node is not None and table.has("class"):
        raise table.problem("class", 'a component has a "class" or a "node", not both')
    if node is not None and table.has("runs"):
        raise table.problem("runs", 'a "node" is in a process of its own, so it has no "runs"')
    made = ComponentPart(
        name,
        table.text("class") if node is None else node.name,
        table.choice("runs", _RUNS, _RUNS[0]),
        table.texts("needs"),
        table.values("parameters"),
        int(table.number("restarts", 5, low=0, high=1000)),
        table.number("limit", 10.0, low=0.1, high=3600.0),
        table.number("silence", 0.8, low=0.3, high=3600.0),
        table.text("shared") if table.has("shared") else "",
        node,
    )
    if made.shared and (made.runs != "process" or node is not None):
        raise table.problem("shared", '"shared" is for components in a process of their own')
    return table.finish(made)


def _node(table: Table) -> RosNode:
    name, command = _node_name(table, "node"), table.texts("command")
    if not table.has("container"):
        return RosNode(name, command)
    if command:
        raise table.problem("command", 'a node is started by a "command" or loaded into a "container", not both')
    return RosNode(name, (), _node_name(table, "container"), table.text("package"), table.text("plugin"))


def _node_name(table: Table, key: str) -> str:
    name = table.text(key)
    if _NODE.fullmatch(name) is None:
        raise table.problem(key, f'"{key}" must be the full name of a ROS 2 node; write {key} = "/arm_driver"')
    return name
