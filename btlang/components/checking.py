"""What is wrong with the components and devices of a robot file: all of it at once, without starting any."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Collection, Iterator, Mapping, Sequence

from btlang.components.component import ComponentError, ParameterError
from btlang.components.location import WRONG_PARAMETERS, locate_class, words_file
from btlang.components.words import check_words
from btlang.devices.driver import SIMULATED, DeviceError, driver_class, make_driver
from btlang.devices.kinds import KINDS
from btlang.devices.simulated import SimulatedDevice
from btlang.diagnostics.diagnostic import Diagnostic, MissionError
from btlang.robots.bodies.body import Body, ComponentPart, Device
from btlang.robots.bodies.body_file import BodyError, load_body
from btlang.robots.bodies.gesture_words import gesture_words
from btlang.robots.files import DataFileError, as_mission_error, locate_problems
from btlang.text.source import Source
from btlang.text.toml_table import Problem
from btlang.vocabulary.capabilities import CAPABILITIES

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_DESCRIBE = 30.0  # seconds that a class gets to be loaded and to say what it is


def circle(needs: Mapping[str, Collection[str]]) -> list[str]:
    """Return names that need each other in a circle, with the first one again at the end; none without a circle."""
    done: set[str] = set()
    for start in needs:
        path: dict[str, None] = {}
        stack = [iter([start])]
        while stack:
            name = next(stack[-1], None)
            if name is None:
                stack.pop()
                if path:
                    done.add(path.popitem()[0])
            elif name in path:
                names = list(path)
                return [*names[names.index(name) :], name]
            elif name not in done:
                path[name] = None
                stack.append(iter(sorted(needs.get(name, ()))))
    return []


def levels(needs: Mapping[str, Collection[str]]) -> list[list[str]]:
    """Return names in groups that come up one after the other: each needs only those of earlier groups."""
    left, found = dict(needs), list[list[str]]()
    while left:
        ready = [name for name, wanted in left.items() if not any(each in left for each in wanted if each != name)]
        group = ready or list(left)  # a circle, which was reported before
        found.append(group)
        for name in group:
            del left[name]
    return found


def check_robot(source: Source) -> tuple[Body | None, list[Diagnostic]]:
    """Return the body of a robot file, None if it can't be read, and what is wrong with the file (BT071, BT076)."""
    try:
        body = load_body(source)
    except DataFileError as error:
        return None, list(as_mission_error(error).diagnostics)
    found: list[Diagnostic] = []
    described: dict[str, Mapping[str, Any]] = {}
    problems = (*_devices(body), *_components(body, described))
    for wrong in locate_problems(problems, source, source.name, BodyError):
        found += as_mission_error(wrong).diagnostics
    all_loaded = all(part.place in described for part in body.components if part.node is None)
    methods = {locate_class(place): known["methods"] for place, known in described.items()} if all_loaded else {}
    for path in _words(body):
        found += check_words(path, methods)
    try:
        gesture_words(body)
    except MissionError as error:
        found += error.diagnostics
    return body, found


def describe_apart(part: ComponentPart, folder: str) -> Mapping[str, Any]:
    """Return the description of a component's class, made in another process. Raises
    ComponentError, or ParameterError.
    """
    command = [
        sys.executable,
        "-B",
        "-m",
        "btlang.components.location",
        part.place,
        folder,
        json.dumps(dict(part.parameters)),
    ]
    try:
        done = subprocess.run(command, capture_output=True, timeout=_DESCRIBE, check=False, stdin=subprocess.DEVNULL)
    except subprocess.TimeoutExpired:
        raise ComponentError(f"{part.place} isn't loaded after {_DESCRIBE:g} s") from None
    if done.returncode:
        lines = done.stderr.decode("utf-8", "replace").strip().splitlines()
        wrong = ParameterError if done.returncode == WRONG_PARAMETERS else ComponentError
        raise wrong(lines[-1] if lines else f"{part.place} ended with exit code {done.returncode}")
    known: Mapping[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return known


def _devices(body: Body) -> Iterator[Problem]:
    ports: dict[str, Device] = {}
    groups: dict[tuple[str, str], list[tuple[int, Device]]] = {}
    for index, device in enumerate(body.devices):
        if device.kind not in KINDS:
            yield Problem(
                f'there is no kind "{device.kind}"; the kinds are {", ".join(KINDS)}', "device", index, "kind"
            )
            continue
        if device.kind == "joint" and device.driver != SIMULATED and body.joint(device.name) is None:
            yield Problem(f'the robot has no joint "{device.name}"', "device", index, "name")
        first = ports.setdefault(device.port, device) if device.port else device
        if first.driver != device.driver:
            yield Problem(f'the port "{device.port}" is that of the {first.name}, too', "device", index, "port")
        groups.setdefault((device.driver, device.port), []).append((index, device))
    for (driver, port), members in groups.items():
        yield from _of_driver(body, driver, port, members)
    if body.over == "devices":
        yield from _find_missing_devices(body)


def _of_driver(body: Body, driver: str, port: str, members: Sequence[tuple[int, Device]]) -> Iterator[Problem]:
    index = members[0][0]
    if driver == SIMULATED:
        for index, device in members:
            try:
                SimulatedDevice(device, None)
            except DeviceError as problem:
                yield Problem(str(problem), "device", index, "options")
        return
    try:
        kind = driver_class(driver, body.folder)
    except DeviceError as problem:
        yield Problem(str(problem), "device", index, "driver")
        return
    wrong = False
    for index, device in members:
        if device.kind not in kind.kinds:
            wrong = True
            listed = ", ".join(kind.kinds)
            yield Problem(
                f'"{driver}" has no devices of the kind "{device.kind}", only {listed}', "device", index, "kind"
            )
        if kind.needs_port and not port:
            wrong = True
            yield Problem(f'"{driver}" needs a port', "device", index, "port")
    if wrong:
        return
    try:
        make_driver(driver, body.folder, port, [device for _, device in members])
    except DeviceError as problem:
        named = [at for at, device in members if device.name in str(problem)]
        yield Problem(str(problem), "device", *(named or [index])[:1], "options")


def _find_missing_devices(body: Body) -> Iterator[Problem]:
    """Return the parts of the body without a device, though it runs over devices."""
    kinds, names = {device.kind for device in body.devices}, {device.name for device in body.devices}
    parts = {
        "base": ("drive", body.base),
        "sensors": ("lidar", body.sensor("scanner")),
        "battery": ("battery", body.battery),
    }
    for section, (kind, part) in parts.items():
        if part and kind not in kinds:
            yield Problem(f'the {section} needs a device of the kind "{kind}"', section)
    for index, joint in enumerate(body.joints):
        if joint.name not in names:
            yield Problem(f'the joint "{joint.name}" needs a device of its name', "joints", index)
    for index, hand in enumerate(body.hands):
        if f"{hand.name} hand" not in names:
            yield Problem(f'the hand needs a device "{hand.name} hand"', "hands", index)


def _components(body: Body, described: dict[str, Mapping[str, Any]]) -> Iterator[Problem]:
    """Fill `described` with the descriptions of the classes that can be loaded, by their place."""
    names, devices = {part.name for part in body.components}, {device.name for device in body.devices}
    known = names | devices | set(CAPABILITIES)
    needs: dict[str, set[str]] = {}
    for index, part in enumerate(body.components):
        if part.name in devices:
            yield Problem(f'"{part.name}" is the name of a device, too', "component", index, "name")
        own = set(part.needs)
        try:
            if part.node is None:
                says = described[part.place] = describe_apart(part, body.folder)
                own |= set(says["needs"])
        except ComponentError as problem:
            yield Problem(
                str(problem), "component", index, "parameters" if isinstance(problem, ParameterError) else "class"
            )
        for need in sorted(own - known):
            yield Problem(
                f'"{part.name}" needs "{need}", which is no component, device or part', "component", index, "needs"
            )
        for need in sorted(own & set(CAPABILITIES) - names):
            if not body.has(need):
                yield Problem(f'"{part.name}" needs "{need}", which the robot lacks', "component", index, "needs")
        needs[part.name] = own & names
    around = circle(needs)
    if around:
        index = next(at for at, part in enumerate(body.components) if part.name == around[0])
        yield Problem(f"components need each other in a circle: {' → '.join(around)}", "component", index, "needs")


def _words(body: Body) -> list[str]:
    found = []
    for part in body.components:
        if part.node is not None:
            continue
        try:
            path = words_file(locate_class(part.place), body.folder)
        except ComponentError:
            continue
        if path is not None and path not in found:
            found.append(path)
    return found
