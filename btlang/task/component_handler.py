"""What is asked of the components and devices of a robot."""

from __future__ import annotations

import base64
from collections.abc import Iterable, Mapping
from enum import StrEnum

from btlang.components.component import ComponentError
from btlang.components.connection import ComponentConnection
from btlang.components.manager import ComponentManager
from btlang.devices.driver import DeviceError
from btlang.devices.kinds import Image, png
from btlang.robots.bodies.body_file import read_body
from btlang.robots.bodies.urdf import urdf
from btlang.task import messages
from btlang.task.checks import choice, refused
from btlang.task.messages import Answer, wrong
from btlang.text.escaping import one_line

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.session import Session

_WIDEST = 320  # pixels of a picture: many may watch


class Change(StrEnum):
    """What may be done to a component."""

    RESTART = "restart"
    LOAD = "load"
    UNLOAD = "unload"


class ComponentHandler:
    """Commands about components; for any thread."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def list(self, command: messages.Components, person: str) -> Answer:
        """All of them."""
        data = component_data(self._session)
        lines = [*map(_component_line, data["components"]), *map(_device_line, data["devices"])]
        return Answer(True, "\n".join(lines) or "The robot has no components or devices of its own.", data)

    def picture(self, command: messages.Picture, person: str) -> Answer:
        """What a camera sees. Raises MissionError."""
        connection = self._session.connection
        readers = connection.devices.readers if isinstance(connection, ComponentConnection) else {}
        if command.device not in readers:
            raise wrong(command.tag, f"the robot has no device '{one_line(command.device)}'")
        try:
            image = readers[command.device].read(command.device)
        except DeviceError as problem:
            raise wrong(command.tag, str(problem)) from None
        if not isinstance(image, Image):
            raise wrong(command.tag, f"the {one_line(command.device)} is no camera")
        small = image.smaller(_WIDEST)
        data = {"png": base64.b64encode(png(small)).decode(), "width": small.width, "height": small.height}
        return Answer(True, f"A picture of {small.width} by {small.height} pixels.", data)

    def urdf(self, command: messages.Urdf, person: str) -> Answer:
        """The body. Raises MissionError."""
        body = getattr(self._session.robot, "body", None)
        if body is None or not any(joint.link for joint in body.joints):
            raise refused("The robot", "has no links in its file, so there is no URDF of it")
        return Answer(True, f"The body of the {one_line(body.name)}.", {"urdf": urdf(body)})

    def change(self, command: messages.ChangeComponent, person: str) -> Answer:
        """One of them. Raises MissionError."""
        connection = self._session.connection
        act = choice(Change, command.act, "act", command.tag)
        if not isinstance(connection, ComponentConnection):
            raise wrong(command.tag, "the robot has no components")
        try:
            _change(connection.manager, act, command.name, self._session)
        except ComponentError as problem:
            raise wrong(command.tag, str(problem)) from None
        waits = connection.manager.is_free(command.name)
        when = "now" if waits else "as soon as no running mission uses it"
        done = {Change.UNLOAD: "is brought down", Change.RESTART: "is started anew", Change.LOAD: "is loaded"}[act]
        return Answer(True, f"The {one_line(command.name)} {done}, {when}.", component_data(self._session))


def component_data(session: Session) -> dict[str, list[dict[str, Any]]]:
    """The components and devices of a robot, with their states."""
    connection = session.connection
    if not isinstance(connection, ComponentConnection):
        return {"components": [], "devices": []}
    components = [status.as_dict() for status in connection.manager.statuses()]
    devices = [
        {"name": device.name, "kind": device.kind, "driver": device.driver, "port": device.port, "silent": silent or ""}
        for device, silent in connection.devices.states()
    ]
    return {"components": components, "devices": devices}


def _change(manager: ComponentManager, act: Change, name: str, session: Session) -> None:
    if act is Change.RESTART:
        manager.restart(name)
    elif act is Change.UNLOAD:
        manager.unload(name)
    else:
        file = session.robot.body.file
        if not file:
            raise ComponentError("the robot has no file to load it from")
        manager.load(_named(read_body(file).components, name))


def _named(parts: Iterable[Any], name: str) -> Any:
    known = {part.name: part for part in parts}
    if name not in known:
        raise ComponentError(f'the robot file has no component "{name}"; it has {", ".join(known) or "none"}')
    return known[name]


def _component_line(each: Mapping[str, Any]) -> str:
    why = f"  [{one_line(each['why'])}]" if each["why"] else ""
    version = f" {one_line(each['version'])}" if each["version"] else ""
    starts = f", started {each['starts']} times" if each["starts"] > 1 else ""
    return f"{one_line(each['name']):<20} {each['state']:<12} {each['place']}{version}{starts}{why}"


def _device_line(each: Mapping[str, Any]) -> str:
    port = f" on {one_line(each['port'])}" if each["port"] else ""
    state = "silent" if each["silent"] else "works"
    why = f"  [{one_line(each['silent'])}]" if each["silent"] else ""
    return f"{one_line(each['name']):<20} {state:<12} {each['kind']}, {each['driver']}{port}{why}"
