"""Ears with a microphone: what is listened for, who is heard, and what is asked."""

from __future__ import annotations

import wave
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

import btlang
from btlang.actions.conversation import has_heard, somebody_says
from btlang.components.parts import hearing
from btlang.components.parts.hearing import Hearing
from btlang.devices.kinds import Sound
from btlang.engine.leaves.leaf import Unknown
from btlang.robots.bodies.body import Body, EarsSpec
from btlang.robots.robot import RobotError
from btlang.run.events import Event, PartChanged, Said
from btlang.speech.recogniser import RecognisedSpeech, RecogniserSettings

ROBOT = """
name = "listener"
over = "devices"
radius = 0.25
[voice]
text = 0.1
character = 0.01
[ears]
within = 3.0
engine = "pocketsphinx"
[[device]]
name = "microphone"
kind = "microphone"
driver = "sound"
port = "{port}"
"""
PIECE = Sound(bytes(1600), 16_000)


class Recogniser:
    """In place of a thread with a recogniser: it understands what a test says."""

    problem = ""

    def __init__(self, recogniser: Any) -> None:
        self.said: list[RecognisedSpeech] = []
        self.expected: Any = None
        self.heard = self.forgotten = self.ended = 0

    def expect(self, expected: Any) -> None:
        self.expected = expected

    def hear(self, samples: bytes) -> None:
        self.heard += 1

    def end(self) -> None:
        self.ended += 1

    def forget(self) -> None:
        self.forgotten += 1

    def understood(self) -> RecognisedSpeech | None:
        return self.said.pop(0) if self.said else None

    def close(self) -> None:
        pass


class Rig:
    """A robot with a microphone, whose clock the test drives."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, wake: str = "", push: bool = False) -> None:
        monkeypatch.setattr(hearing, "Listener", Recogniser)
        monkeypatch.setattr(hearing, "recogniser_of", lambda body: None)
        from btlang.robots.ears import Ears as RobotEars

        self.takes: dict[str, Callable[[Any], object]] = {}
        self.ears, self.said, self.texts = RobotEars(), list[str](), list[str]()
        body = Body("listener", 0.2, ears=EarsSpec(3.0, "pocketsphinx", RecogniserSettings(push=push), wake))
        self.robot = SimpleNamespace(
            ears=self.ears, time=0.0, speaking=False, refuses=False, body=body, say=self.said.append, hear=self.hear
        )
        devices: Any = SimpleNamespace(
            first=lambda kind: "microphone",
            loops=[SimpleNamespace(devices={"microphone": None})],
            devices={"talk button": SimpleNamespace(kind="button")},
            follow=self.takes.__setitem__,
        )
        self.told: list[tuple[str, Any]] = []
        self.clock = 0.0
        self.hearing = Hearing(body, self.robot, devices, self.tell, lambda: self.clock)
        self.listener: Any = self.hearing._listener

    def tell(self, kind: str, data: Any) -> None:
        self.told.append((kind, data))

    def hear(self, text: str) -> None:
        self.texts.append(text)
        self.ears.hear(text, "", self.robot.time)

    def step(self, seconds: float = 0.05, *said: RecognisedSpeech) -> None:
        self.robot.time += seconds
        self.listener.said += said
        self.hearing.step()


def test_it_listens_for_what_is_looked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    rig = Rig(monkeypatch)
    assert rig.ears.news("stop", rig.robot.time) == []
    rig.step()
    assert rig.listener.expected.phrases == ("stop",)
    rig.step(0.05, RecognisedSpeech("stop"))
    assert [heard.text for heard in rig.ears.news("stop", rig.robot.time)] == ["stop"]
    rig.step()
    assert rig.ears.news("stop", rig.robot.time) == []
    rig.step(6.0)
    assert rig.listener.expected.phrases == ()


def test_it_does_not_hear_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    rig = Rig(monkeypatch)
    rig.takes["microphone"](PIECE)
    assert rig.listener.heard == 1
    rig.robot.speaking = True
    rig.step()
    rig.takes["microphone"](PIECE)
    rig.step(0.05, RecognisedSpeech("stop"))
    assert (rig.listener.heard, rig.listener.forgotten, rig.texts) == (1, 1, [])
    rig.robot.speaking = False
    rig.step(0.2)
    rig.takes["microphone"](PIECE)
    assert rig.listener.heard == 1
    rig.step(0.2)
    rig.takes["microphone"](PIECE)
    assert rig.listener.heard == 2


@pytest.mark.parametrize(("answer", "heard"), [("of course", ["tea"]), ("no thanks", []), (None, [])])
def test_what_it_is_not_sure_of_is_asked(monkeypatch: pytest.MonkeyPatch, answer: str | None, heard: list[str]) -> None:
    rig = Rig(monkeypatch)
    rig.step(0.05, RecognisedSpeech("tea", sure=False))
    assert rig.said == ['Did you say "tea"?']
    rig.step()
    assert {"yes", "no"} <= set(rig.listener.expected.phrases)
    assert rig.listener.expected.mode == "open"
    rig.step(0.05, RecognisedSpeech("yes", sure=False))
    if answer is None:
        rig.step(9.0)
    else:
        rig.step(0.05, RecognisedSpeech(answer))
    assert rig.texts == heard
    rig.step()
    assert rig.listener.expected.phrases == ()


def test_a_stopped_robot_asks_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    rig = Rig(monkeypatch)
    rig.robot.refuses = True
    rig.step(0.05, RecognisedSpeech("tea", sure=False))
    assert (rig.said, rig.texts) == ([], [])


def test_without_a_voice_it_hears_only_what_it_is_sure_of(monkeypatch: pytest.MonkeyPatch) -> None:
    rig = Rig(monkeypatch)

    def say(text: str) -> None:
        raise RobotError("the robot has no voice")

    rig.robot.say = say
    rig.step(0.05, RecognisedSpeech("tea", sure=False), RecognisedSpeech("coffee"))
    assert rig.texts == ["coffee"]


def test_push_to_talk(monkeypatch: pytest.MonkeyPatch) -> None:
    rig = Rig(monkeypatch, push=True)
    rig.takes["microphone"](PIECE)
    assert rig.listener.heard == 0
    rig.hearing.push(True)
    rig.takes["microphone"](PIECE)
    assert (rig.listener.heard, rig.listener.ended) == (1, 0)
    rig.hearing.push(False)
    rig.takes["microphone"](PIECE)
    assert (rig.listener.heard, rig.listener.ended) == (1, 1)


def test_a_button_in_a_page_counts_for_two_seconds(monkeypatch: pytest.MonkeyPatch) -> None:
    rig = Rig(monkeypatch, push=True)
    assert rig.ears.talk is not None
    for _ in range(3):
        rig.ears.talk(True)
        rig.clock += 1.9
        rig.takes["microphone"](PIECE)
    assert (rig.listener.heard, rig.listener.ended) == (3, 0)
    rig.clock += 0.2
    rig.takes["microphone"](PIECE)
    assert (rig.listener.heard, rig.listener.ended) == (3, 1)
    rig.ears.talk(True)
    rig.clock += 2.1
    rig.step()
    assert rig.listener.ended == 2
    rig.ears.talk(True)
    rig.ears.talk(False)
    rig.takes["microphone"](PIECE)
    assert (rig.listener.heard, rig.listener.ended) == (3, 3)


def test_ears_that_listen_all_the_time_need_no_button(monkeypatch: pytest.MonkeyPatch) -> None:
    assert Rig(monkeypatch, wake="hello robot").ears.talk is None


def test_what_ears_that_fail_have_not_heard_is_not_known(monkeypatch: pytest.MonkeyPatch) -> None:
    rig = Rig(monkeypatch)
    rig.step(0.05, RecognisedSpeech("tea"))
    rig.listener.problem = "ValueError: no sound"
    rig.step()
    rig.step()
    text = "the ears don't work: ValueError: no sound"
    failed = {"kind": "ears", "name": "pocketsphinx", "state": "silent", "text": text}
    assert rig.told == [("part", failed)]
    assert has_heard(rig.robot, "tea")
    with pytest.raises(Unknown, match="the ears don't work: ValueError: no sound"):
        has_heard(rig.robot, "stop")
    with pytest.raises(Unknown):
        somebody_says(rig.robot, "stop")
    rig.hear("stop")
    rig.step()
    assert somebody_says(rig.robot, "stop")
    rig.listener.problem = ""
    rig.step()
    assert not somebody_says(rig.robot, "stop")
    assert [data["state"] for _, data in rig.told] == ["silent", "works"]


RAISES = """
class Ears:
    def __init__(self, settings):
        self.heard = 0

    def expect(self, expected):
        return []

    def hear(self, samples):
        self.heard += 1
        if self.heard > 3:
            raise SystemExit("gone")
        return []

    def end(self):
        return []

    def forget(self):
        pass
"""


def test_a_robot_whose_recogniser_dies_goes_on(tmp_path: Path) -> None:
    pytest.importorskip("av")
    path = tmp_path / "silence.wav"
    with wave.open(str(path), "wb") as file:
        file.setparams((1, 2, 16_000, 0, "NONE", ""))
        file.writeframes(bytes(64_000))
    (tmp_path / "broken_ears.py").write_text(RAISES, encoding="utf-8")
    robot = ROBOT.format(port=path).replace('"pocketsphinx"', '"broken_ears:Ears"')
    (tmp_path / "robot.toml").write_text(robot, encoding="utf-8")
    rule = 'whenever somebody says stop, say "stopped"'
    mission = f'{rule}. wait 1 second then check that you have heard stop, otherwise say "done"'
    events: list[Event] = []
    with btlang.Session(robot=str(tmp_path / "robot.toml")) as session:
        run = session.run(btlang.parse_tree(mission), sinks=[events.append])
        assert run.outcome is not None
        assert run.outcome.succeeded, run.outcome.why()
    texts = [event.text for event in events if isinstance(event, PartChanged)]
    assert texts[-1] == "the ears don't work: SystemExit: gone"
    assert any(isinstance(event, Said) and event.text == "done" for event in events)


def test_a_mission_hears_what_is_said_into_a_file(tmp_path: Path) -> None:
    pytest.importorskip("pocketsphinx")
    pytest.importorskip("espeakng_loader")
    pytest.importorskip("av")
    from tests.speech.sounds import VOICES, recorded

    path = tmp_path / "said.wav"
    with wave.open(str(path), "wb") as file:
        file.setparams((1, 2, 16_000, 0, "NONE", ""))
        file.writeframes(recorded("i am looking for the toilet", VOICES["test"][0])[:64_000])
        file.writeframes(recorded("coffee please", VOICES["test"][0]))
    (tmp_path / "robot.toml").write_text(ROBOT.format(port=path), encoding="utf-8")
    mission = btlang.parse_tree("listen for coffee within 20 s")
    with btlang.Session(robot=str(tmp_path / "robot.toml")) as session:
        run = session.run(mission)
        assert run.outcome is not None
        assert run.outcome.succeeded, run.outcome.why()
        assert session.robot.ears.answer == "coffee please"
        assert [heard.text for heard in session.robot.ears.since(0)] == ["coffee please"]
