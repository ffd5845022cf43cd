"""What `btc robot` does with robot files: check, show, urdf and import."""

from __future__ import annotations

import sys
from collections.abc import Iterator

from btlang.components.checking import check_robot, describe_apart, levels
from btlang.components.component import ComponentError
from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.files import read_source
from btlang.robots.bodies.body import Body, ComponentPart
from btlang.robots.bodies.body_file import BodyError, read_body
from btlang.robots.bodies.urdf import urdf
from btlang.robots.files import as_mission_error
from btlang.text.formatting import one_line
from btlang.text.output import pass_on, show
from btlang.text.source import Source

_OF_NODES = {"version": "", "needs": []}


def read_robot_file(act: str, path: str) -> int:
    """Check a robot file, draw the robot, write it as URDF, or make a robot file from URDF; return the exit code.

    Raises MissionError with all that is wrong.
    """
    source = read_source(path)
    if act == "urdf":
        pass_on(urdf(read_body(source)))
        return 0
    if act == "import":
        pass_on(_import(source))
        return 0
    if act == "show":
        show("\n".join(draw_robot(read_body(source))))
        return 0
    problems = check_robot(source)[1]
    if problems:
        raise MissionError(problems)
    show("No problems found.")
    return 0


def _import(source: Source) -> str:
    from btlang.robots.bodies.urdf_reader import read_urdf  # brings numpy

    try:
        found = read_urdf(source)
    except BodyError as problem:
        raise as_mission_error(problem) from None
    for note in found.notes:
        show(one_line(f"Check: {note}"), sys.stderr)
    return found.toml()


def draw_robot(body: Body) -> Iterator[str]:
    """Draw the robot as lines: its body, its components as they come up, and its devices by their port."""
    yield f"{one_line(body.name)}, over {body.over}"
    yield from _tree([(part, []) for part in _parts(body)])
    if body.components:
        yield "components"
        yield from _tree(_components(body))
    if body.devices:
        yield "devices"
        yield from _tree(_devices(body))


def _parts(body: Body) -> Iterator[str]:
    if body.base is not None:
        yield f"base: up to {body.driving.top_speed:g} m/s, wheels {body.base.wheel_gap:g} m apart"
    yield from (f"{sensor.kind}" + (f" up to {sensor.range:g} m" if sensor.range else "") for sensor in body.sensors)
    parts = {joint.part: 0 for joint in body.joints}
    for joint in body.joints:
        parts[joint.part] += 1
    yield from (f"{part}: {count} joint{'s' if count > 1 else ''}" for part, count in parts.items())
    yield from (f"{hand.name} hand" for hand in body.hands)
    others = {"navigation": body.navigation, "battery": body.battery, "dock": body.dock, "voice": body.voice,
              "screen": body.screen}  # fmt: skip
    yield from (name for name, part in others.items() if part)


def _components(body: Body) -> list[tuple[str, list[str]]]:
    needs: dict[str, set[str]] = {}
    lines: dict[str, tuple[str, list[str]]] = {}
    for part in body.components:
        own = set(part.needs)
        try:
            known = describe_apart(part, body.folder) if part.node is None else _OF_NODES
            own |= set(known["needs"])
            version = f" {known['version']}" if known["version"] else ""
        except ComponentError as problem:
            version = f" [{one_line(str(problem))}]"
        needs[part.name] = own
        where = _where(part)
        below = [f"needs {', '.join(sorted(own))}"] if own else []
        below += [f"{name} = {value}" for name, value in part.parameters.items()]
        lines[part.name] = f"{one_line(part.name)}: {part.place}{version}, {where}", below
    return [lines[name] for group in levels(needs) for name in group]


def _where(part: ComponentPart) -> str:
    if part.node is None:
        return "in a process of its own" if part.runs == "process" else "in the robot's process"
    if part.node.container:
        return f"{part.node.plugin} loaded into {part.node.container}"
    started = " ".join(map(one_line, part.node.command))
    return f"ROS 2 node started by '{started}'" if started else "ROS 2 node"


def _devices(body: Body) -> list[tuple[str, list[str]]]:
    ports: dict[str, list[str]] = {}
    for device in body.devices:
        place = f"{device.driver} {device.port}".strip()
        options = "".join(f", {name} {value}" for name, value in device.options.items())
        ports.setdefault(one_line(place), []).append(f"{one_line(device.name)}: {device.kind}{one_line(options)}")
    return list(ports.items())


def _tree(branches: list[tuple[str, list[str]]]) -> Iterator[str]:
    for index, (line, below) in enumerate(branches):
        last = index == len(branches) - 1
        yield f"{'└─' if last else '├─'} {line}"
        for at, each in enumerate(below):
            yield f"{'  ' if last else '│ '} {'└─' if at == len(below) - 1 else '├─'} {each}"
