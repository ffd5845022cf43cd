"""Handlers of commands about the robot: its components and devices, its voice, and people in its world."""

from __future__ import annotations

import base64
import io
import wave
from base64 import b64encode
from collections.abc import Callable, Iterable, Mapping
from enum import StrEnum

from btlang.components.component import ComponentError
from btlang.components.connection import ComponentConnection
from btlang.components.manager import ComponentManager
from btlang.devices.driver import DeviceError
from btlang.devices.kinds import Image, png
from btlang.robots.bodies.body_file import read_body
from btlang.robots.bodies.urdf import urdf
from btlang.robots.robot import RobotError
from btlang.run.world_input import WorldInput
from btlang.session import Session
from btlang.speech.engine import Utterance
from btlang.task import messages
from btlang.task.commands.checks import choose_member, refusal_error
from btlang.task.messages import Answer, wrong
from btlang.text.formatting import one_line

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.session import Session


_WIDEST = 320  # pixels of a picture: many may watch


class ComponentChange(StrEnum):
    """A change of a component's state."""

    RESTART = "restart"
    LOAD = "load"
    UNLOAD = "unload"


class ComponentHandler:
    """A handler of commands about components, for any thread."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def list(self, command: messages.Components, person: str) -> Answer:
        """List the components and devices."""
        data = component_data(self._session)
        lines = [*map(_component_line, data["components"]), *map(_device_line, data["devices"])]
        return Answer(True, "\n".join(lines) or "The robot has no components or devices of its own.", data)

    def picture(self, command: messages.Picture, person: str) -> Answer:
        """Return what a camera sees. Raises MissionError."""
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
        """Return the body. Raises MissionError."""
        body = getattr(self._session.robot, "body", None)
        if body is None or not any(joint.link for joint in body.joints):
            raise refusal_error("The robot", "has no links in its file, so there is no URDF of it")
        return Answer(True, f"The body of the {one_line(body.name)}.", {"urdf": urdf(body)})

    def change(self, command: messages.ChangeComponent, person: str) -> Answer:
        """Change the state of one component. Raises MissionError."""
        connection = self._session.connection
        act = choose_member(ComponentChange, command.act, "act", command.tag)
        if not isinstance(connection, ComponentConnection):
            raise wrong(command.tag, "the robot has no components")
        try:
            _change(connection.manager, act, command.name, self._session)
        except ComponentError as problem:
            raise wrong(command.tag, str(problem)) from None
        waits = connection.manager.is_free(command.name)
        when = "now" if waits else "as soon as no running mission uses it"
        done = {
            ComponentChange.UNLOAD: "is brought down",
            ComponentChange.RESTART: "is started anew",
            ComponentChange.LOAD: "is loaded",
        }[act]
        return Answer(True, f"The {one_line(command.name)} {done}, {when}.", component_data(self._session))


def component_data(session: Session) -> dict[str, list[dict[str, Any]]]:
    """Return the components and devices of a robot, with their states."""
    connection = session.connection
    if not isinstance(connection, ComponentConnection):
        return {"components": [], "devices": []}
    components = [status.as_dict() for status in connection.manager.statuses()]
    devices = [
        {"name": device.name, "kind": device.kind, "driver": device.driver, "port": device.port, "silent": silent or ""}
        for device, silent in connection.devices.states()
    ]
    return {"components": components, "devices": devices}


def _change(manager: ComponentManager, act: ComponentChange, name: str, session: Session) -> None:
    if act is ComponentChange.RESTART:
        manager.restart(name)
    elif act is ComponentChange.UNLOAD:
        manager.unload(name)
    else:
        file = session.robot.body.file
        if not file:
            raise ComponentError("the robot has no file to load it from")
        manager.load(_find_component(read_body(file).components, name))


def _find_component(parts: Iterable[Any], name: str) -> Any:
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


_LONGEST_SOUND = 30.0  # seconds


class VoiceHandler:
    """A handler of the command `voice`, for any thread."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def sound(self, command: messages.Voice, person: str) -> Answer:
        """Return what it says now, or said last, from its beginning.

        Refused if it makes no sound, or plays it itself.
        """
        robot = self._session.robot
        body, said = getattr(robot, "body", None), getattr(robot, "said", None)
        if body is not None and any(device.kind == "speaker" for device in body.devices):
            raise refusal_error("The robot", "has a speaker, which plays what it says")
        if said is None or not said.samples:
            raise refusal_error(
                "The robot", "has said nothing that can be heard: its voice has no engine, or was silent"
            )
        began = min(max(0.0, robot.time - robot.said_at), said.seconds)
        data = {"wav": b64encode(as_wav(said, _LONGEST_SOUND)).decode(), "text": said.text, "seconds": began}
        return Answer(True, f'It says "{said.text}".', data)


def as_wav(said: Utterance, longest: float) -> bytes:
    """Return a file of its first seconds."""
    file = io.BytesIO()
    with wave.open(file, "wb") as sound:
        sound.setnchannels(1)
        sound.setsampwidth(2)
        sound.setframerate(said.rate)
        sound.writeframes(said.samples[: 2 * round(longest * said.rate)])
    return file.getvalue()


_HOLD, _RELEASE = "hold", "release"
_LONGEST = 500  # characters of an answer


class WorldHandler:
    """A handler of commands that act on the world of the robot, for any thread. `world_input` is a sink of all runs."""

    def __init__(self, session: Session, world_input: WorldInput) -> None:
        self._session, self._world_input = session, world_input

    def answer(self, command: messages.AnswerQuestion, person: str) -> Answer:
        """Let the robot hear a text after its question."""
        text = command.text.strip()
        if not 0 < len(text) <= _LONGEST:
            raise wrong(command.tag, f"it needs a text of 1 to {_LONGEST} characters")
        question = self._world_input.question
        if not question:
            raise refusal_error("The robot", "isn't asking anything")
        self._world_input.type(text)
        return Answer(True, "The robot hears that.", {"question": question})

    def talk(self, command: messages.Talk, person: str) -> Answer:
        """Hold the button to talk for somebody, or release it."""
        if command.act not in (_HOLD, _RELEASE):
            raise wrong(command.tag, f"'act' must be '{_HOLD}' or '{_RELEASE}', not '{command.act}'")
        held = command.act == _HOLD
        push = _button(self._session)
        if push is None:
            raise refusal_error("The robot", 'has no microphone that waits for a button: "push" of its ears')
        push(held)
        return Answer(True, "The robot listens." if held else "The robot has heard it.", {})

    def invite(self, command: messages.InviteVisitor, person: str) -> Answer:
        """Let somebody come into a simulated world."""
        if not takes_visitors(self._session):
            raise refusal_error("The robot", "isn't in a simulated world, so no visitor can be made to come")
        self._world_input.invite()
        return Answer(True, "A visitor comes.", {})


def takes_talk(session: Session) -> bool:
    """Return whether somebody who speaks to it has to hold a button."""
    return _button(session) is not None


def takes_visitors(session: Session) -> bool:
    """Return whether visitors can be made to come: the robot's world is simulated."""
    return hasattr(session.robot, "invite")


def _button(session: Session) -> Callable[[bool], object] | None:
    try:
        return session.robot.ears.talk  # type: ignore[no-any-return]
    except (AttributeError, RobotError):  # it has no ears
        return None
