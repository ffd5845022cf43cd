"""Where sound goes: a speaker, the page, and the mouth."""

from __future__ import annotations

import io
import wave
from base64 import b64decode
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from btlang.components.parts.parts import DeviceJoints, DeviceVoice
from btlang.devices.driver import DeviceError
from btlang.devices.kinds import Command, Play, Shown
from btlang.devices.media import SoundCard
from btlang.diagnostics.diagnostic import MissionError
from btlang.robots.bodies.body import Body, Device, Joint, Mouth
from btlang.robots.registry import Connector
from btlang.robots.simulation.robot import SimulatedRobot
from btlang.session import Session
from btlang.task import messages
from btlang.task.commands.robot_handlers import VoiceHandler
from btlang.text.source import Source
from tests.speech.guide import ROOM, guide, room

TICK = 0.05


class Devices(dict[str, Any]):
    """A reader for each device, which keeps what it is told."""

    def __init__(self) -> None:
        super().__init__(speaker=self, face=self, screen=self)
        self.told: list[tuple[str, Command]] = []

    def write(self, name: str, command: Command) -> None:
        self.told.append((name, command))


def device_voice(body: Body) -> tuple[DeviceVoice, Devices]:
    devices = Devices()
    return DeviceVoice(body, devices, "speaker", ["screen"], DeviceJoints(body, devices)), devices


def plays(devices: Devices) -> list[bytes]:
    return [told.samples for name, told in devices.told if isinstance(told, Play) and name == "speaker"]


def test_a_speaker_plays_one_sound_and_is_silent_at_once() -> None:
    voice, devices = device_voice(guide())
    voice.say("Hello, everybody.", after=0.1)
    voice.step(TICK)
    assert plays(devices) == []
    for _ in range(4):
        voice.step(TICK)
    assert voice.said is not None
    assert set(plays(devices)) == {voice.said.samples}
    commands = [told for _, told in devices.told]
    assert all(told is commands[0] for told in commands)  # told again, not begun again
    voice.silence()
    assert plays(devices)[-1] == b""
    count = len(plays(devices))
    voice.step(TICK)
    voice.silence()
    assert len(plays(devices)) == count


def test_what_ends_is_not_told_again() -> None:
    voice, devices = device_voice(guide())
    voice.say("Hi.")
    while voice.speaking:
        voice.step(TICK)
    voice.step(TICK)
    assert plays(devices)[-1] == b""


def test_a_speaker_that_is_a_file_has_the_sound(tmp_path: Path) -> None:
    pytest.importorskip("av")
    path = tmp_path / "heard.wav"
    card = SoundCard(str(path), [Device("speaker", "speaker", "sound")])
    card.open()
    voice, devices = device_voice(guide())
    voice.say("Hello.")
    voice.step(TICK)
    playing: Mapping[str, Any] = card.exchange({"speaker": devices.told[-1][1]})
    assert not isinstance(playing["speaker"], DeviceError)
    assert voice.said is not None
    assert playing["speaker"].left == pytest.approx(voice.said.seconds, abs=0.2)
    card.close()


def test_the_display_of_a_mouth_has_shapes_and_other_displays_texts() -> None:
    body = guide().replace(mouth=Mouth("", "face"))
    voice, devices = device_voice(body)
    voice.say("Mama, papa.")
    while voice.speaking:
        voice.step(TICK)
    voice.print("hello")
    shown = [(name, told.text) for name, told in devices.told if isinstance(told, Shown)]
    assert {text for name, text in shown if name == "face"} >= {"closed", "open", "rest"}
    assert [text for name, text in shown if name == "screen"] == ["hello"]


def test_the_joint_of_a_mouth_opens_and_an_emergency_stop_leaves_it() -> None:
    body = Body("talker", 0.2, voice=guide().voice, mouth=Mouth("jaw"))
    body = body.replace(joints=(Joint("jaw", "jaw", 0.0, 20.0, 400.0),))
    robot = SimulatedRobot(room(), body=body)
    robot.say("Papa, aha, mama.")
    angles = []
    while robot.speaking and robot.time < 10.0:
        robot.step(TICK)
        angles.append(robot.joint("jaw"))
    assert max(angles) == 20.0
    robot.step(0.2)
    assert robot.joint("jaw") == 0.0
    robot.say("Aha, aha, aha.")
    while robot.joint("jaw") < 10.0:
        robot.step(TICK)
    robot.disable()
    there = robot.joint("jaw")
    robot.step(1.0)
    assert robot.joint("jaw") == there
    assert not robot.moving


def test_a_page_gets_the_sound_of_a_robot_without_a_speaker() -> None:
    speaker = Device("horn", "speaker", "simulated")
    with Session(robot=Connector(guide(), "simulated"), world=Source(ROOM, "room.toml")) as session:
        with pytest.raises(MissionError, match="has said nothing"):
            VoiceHandler(session).sound(messages.Voice(), "ann")
        session.robot.say("Hello, everybody.")
        session.robot.step(0.5)
        answer = VoiceHandler(session).sound(messages.Voice(), "ann")
        session.robot.body = guide().replace(devices=(speaker,))
        with pytest.raises(MissionError, match="has a speaker"):
            VoiceHandler(session).sound(messages.Voice(), "ann")
    assert (answer.data["text"], answer.data["seconds"]) == ("Hello, everybody.", pytest.approx(0.5))
    with wave.open(io.BytesIO(b64decode(answer.data["wav"]))) as sound:
        assert sound.getnframes() / sound.getframerate() > 0.5
