"""Reads and checks robot files (TOML). docs/robots.md has all keys."""

from __future__ import annotations

import os
from collections.abc import Collection, Mapping
from functools import cache

from btlang.robots.body import (
    BEARING,
    Base,
    Battery,
    Body,
    ComponentPart,
    Device,
    Dock,
    HandPart,
    Joint,
    Limits,
    Navigation,
    Sensor,
    Step,
    Voice,
)
from btlang.robots.data_file import DataFileError, as_mission_error, load_data
from btlang.robots.platforms import ROBOTS
from btlang.text.source import Source
from btlang.text.toml_table import Problem, Table
from btlang.vocabulary.capabilities import CAPABILITIES
from btlang.vocabulary.shipped import BODIES, STANDARD_BODY

_HANDS = ("left", "right")
_SENSORS = ("scanner", "bumper")
_RUNS = ("process", "here")
_LEAST = 0.001


class BodyError(DataFileError):
    """A robot file that cannot be used."""

    code = "BT071"


def load_body(file: str | Source, overs: Collection[str] = tuple(ROBOTS)) -> Body:
    """The robot in a file or a text, which may run on one of `overs`. Raises BodyError."""
    path = file.name if isinstance(file, Source) else file
    folder = os.path.dirname(os.path.abspath(path)) if os.path.isfile(path) else ""
    return load_data(file, "a robot", lambda top: _body(top, overs, folder), BodyError)


def read_body(file: str | Source, overs: Collection[str] = tuple(ROBOTS)) -> Body:
    """As `load_body`. Raises MissionError (BT071)."""
    try:
        return load_body(file, overs)
    except BodyError as error:
        raise as_mission_error(error) from None


@cache
def standard_body() -> Body:
    """The robot that a mission runs on where none is named."""
    return load_body(STANDARD_BODY)


def shipped_bodies() -> list[str]:
    """The names of the robots that ship."""
    return sorted(name.removesuffix(".toml") for name in os.listdir(BODIES) if name.endswith(".toml"))


def _body(top: Table, overs: Collection[str], folder: str) -> Body:
    name, over = top.text("name"), top.choice("over", tuple(ROBOTS), "simulated")
    if over not in overs:
        listed = " or ".join(f'"{each}"' for each in overs)
        raise top.problem("over", f'"over" may only be {listed} here; to allow "{over}", bring the robot up on it')
    radius = top.number("radius", low=0.01, high=10.0)
    base = _base(top.table("base")) if top.has("base") else None
    navigation = None
    if top.has("navigation"):
        table = top.table("navigation")
        navigation = table.finish(Navigation(table.number("objects", low=radius), table.number("people", low=radius)))
    joints = tuple(map(_joint, top.tables("joints")))
    _check_unique("joints", [joint.name for joint in joints])
    postures = _postures(top.table("postures"), joints) if top.has("postures") else {}
    hands = tuple(map(_hand, top.tables("hands")))
    _check_unique("hands", [hand.name for hand in hands])
    sensors = tuple(map(_sensor, top.tables("sensors")))
    _check_unique("sensors", [sensor.kind for sensor in sensors], "kind")
    battery, dock, voice = None, None, None
    if top.has("battery"):
        table = top.table("battery")
        battery = table.finish(Battery(*(table.number(key, low=0.0) for key in ("idle", "driving", "charging"))))
    if top.has("dock"):
        table = top.table("dock")
        within = table.number("within", low=_LEAST)
        beyond = table.number("beyond", low=within)
        dock = table.finish(Dock(within, beyond, table.number("backs_off", low=beyond)))
    if top.has("voice"):
        table = top.table("voice")
        voice = table.finish(Voice(table.number("text", low=0.0), table.number("character", low=0.0)))
    screen = top.flag("screen")
    devices = tuple(map(_device, top.tables("device")))
    components = tuple(map(_component, top.tables("component")))
    _check_unique("device", [device.name for device in devices])
    _check_unique("component", [component.name for component in components])
    made = Body(
        name, radius, over, base, navigation, joints, postures, hands, sensors, battery, dock, voice, screen,
        devices, components, folder,
    )  # fmt: skip
    return top.finish(made)


def _base(table: Table) -> Base:
    driving, turning = _limits(table.table("driving")), _limits(table.table("turning"))
    return table.finish(Base(driving, turning, table.number("wheel_gap", low=0.01)))


def _limits(table: Table) -> Limits:
    speed = table.number("speed", low=_LEAST)
    rates = (table.number(key, low=_LEAST) for key in ("acceleration", "slowing", "brake", "hard_brake"))
    return table.finish(Limits(speed, table.number("top_speed", low=speed), *rates))


def _joint(table: Table) -> Joint:
    name, part = table.text("name"), table.text("part")
    if part in CAPABILITIES:
        raise table.problem("part", f'"{part}" has another meaning; call the part "{name}", or similar')
    low = table.number("low")
    high = table.number("high", low=low)
    speed = table.number("speed", low=_LEAST)
    rest = table.number("rest", 0.0, low=low, high=high)
    return table.finish(Joint(name, part, low, high, speed, rest, table.flag("slides")))


def _postures(table: Table, joints: tuple[Joint, ...]) -> dict[str, tuple[Step, ...]]:
    postures = {}
    known = {joint.name: joint for joint in joints}
    for name in table.keys():  # noqa: SIM118
        steps = table.tables(name) if table.is_list(name) else [table.table(name)]
        postures[name] = tuple(_step(step, known) for step in steps)
    return postures


def _step(table: Table, known: Mapping[str, Joint]) -> Step:
    step: dict[str, float | str] = {}
    for name in table.keys():  # noqa: SIM118
        if name not in known:
            listed = ", ".join(known) or "none"
            raise table.problem(name, f'the robot has no joint "{name}"; its joints are {listed}')
        if table.is_text(name):
            step[name] = table.choice(name, (BEARING,))
        else:
            step[name] = table.number(name, low=known[name].low, high=known[name].high)
    return step


def _hand(table: Table) -> HandPart:
    name = table.choice("name", _HANDS)
    ahead, left = table.number("ahead"), table.number("left")
    return table.finish(
        HandPart(name, ahead, left, table.number("reach", low=_LEAST), table.number("puts_at", low=_LEAST))
    )


def _sensor(table: Table) -> Sensor:
    kind, frame = table.choice("kind", _SENSORS), table.text("frame")
    return table.finish(Sensor(kind, frame, table.number("range", low=_LEAST) if kind == "scanner" else 0.0))


def _device(table: Table) -> Device:
    name, kind, driver = table.text("name"), table.text("kind"), table.text("driver")
    port = table.text("port") if table.has("port") else ""
    scale, offset = table.number("scale", 1.0), table.number("offset", 0.0)
    if scale == 0.0:
        raise table.problem("scale", '"scale" must not be 0')
    return table.finish(Device(name, kind, driver, port, table.values("options"), scale, offset))


def _component(table: Table) -> ComponentPart:
    made = ComponentPart(
        table.text("name"),
        table.text("class"),
        table.choice("runs", _RUNS, _RUNS[0]),
        table.texts("needs"),
        table.values("parameters"),
        int(table.number("restarts", 5, low=0, high=1000)),
        table.number("limit", 10.0, low=0.1, high=3600.0),
        table.number("silence", 0.8, low=0.3, high=3600.0),
    )
    return table.finish(made)


def _check_unique(section: str, names: list[str], key: str = "name") -> None:
    seen: set[str] = set()
    for index, name in enumerate(names):
        if name in seen:
            raise Problem(f'"{name}" is given twice in {section}', section, index, key)
        seen.add(name)
