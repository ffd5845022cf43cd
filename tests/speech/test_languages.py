"""What is said from now on is in another language, to the end of the mission."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import btlang
from btlang.cli import main
from btlang.diagnostics.diagnostic import MissionError
from btlang.robots.bodies.body_file import load_body
from btlang.robots.voice import Synthesizer
from btlang.run.events import LanguageChosen
from btlang.session import Session
from btlang.speech.engine import Settings
from btlang.speech.espeak import Espeak

ROBOT = """
name = "talker"
radius = 0.2
[voice]
engine = "{engine}"
language = "en"
"""
PARROT = """
from btlang.speech.engine import SpeechError, Utterance

SECONDS = {"en": 1.0, "es": 3.0}


class Parrot:
    def __init__(self, settings):
        if settings.language not in SECONDS:
            raise SpeechError(f"a parrot doesn't speak {settings.language}")
        self.seconds = SECONDS[settings.language]

    def speak(self, text):
        return Utterance(text, self.seconds)
"""


@pytest.fixture
def parrot(tmp_path: Path) -> str:
    (tmp_path / "parrot.py").write_text(PARROT, encoding="utf-8")
    (tmp_path / "robot.toml").write_text(ROBOT.format(engine="parrot:Parrot"), encoding="utf-8")
    return str(tmp_path / "robot.toml")


@pytest.mark.parametrize(
    ("text", "read"),
    [
        ("speak Spanish", ("SpeakLanguage", "es")), ("speak in german", ("SpeakLanguage", "de")),
        ("switch to Chinese", ("SpeakLanguage", "cmn")), ("speak hello", ("Say", "hello")),
        ("say Spanish", ("Say", "Spanish")), ('speak "in Spanish, please"', ("Say", "in Spanish, please")),
    ],
)  # fmt: skip
def test_a_language_is_no_text(text: str, read: tuple[str, str]) -> None:
    root = btlang.parse_tree(text).tree.root
    assert (root.id, root.ports[0][1]) == read


def test_it_speaks_as_the_engine_does_in_that_language(tmp_path: Path) -> None:
    (tmp_path / "robot.toml").write_text(ROBOT.format(engine="espeak"), encoding="utf-8")
    with Session(str(tmp_path / "robot.toml")) as session:
        for text, language in (
            ('speak Spanish then say "1984 1985"', "es"), ('say "1984 1985"', "en"),
            ('speak German then speak English then say "1984 1985"', "en"),
        ):  # fmt: skip
            run = session.run(btlang.parse_tree(text), speed="max")
            assert run.outcome is not None
            assert run.outcome.succeeded
            seconds = Espeak(Settings(language)).speak("1984 1985").seconds
            assert run.outcome.seconds == pytest.approx(seconds, abs=0.1), text
    assert Espeak(Settings("es")).speak("1984 1985").seconds != pytest.approx(seconds, abs=0.1)


def test_a_text_is_spoken_once_in_each_language(parrot: str, monkeypatch: pytest.MonkeyPatch) -> None:
    spoken: list[str] = []
    synthesizer = Synthesizer(load_body(parrot))
    for language in ("en", "es"):
        synthesizer.speak_in(language)
        engine = synthesizer._engine
        monkeypatch.setattr(engine, "speak", lambda text, by=engine.speak: spoken.append(text) or by(text))
        assert synthesizer.speak("hi") is synthesizer.speak("hi")
        assert synthesizer.speak("hi").seconds == {"en": 1.0, "es": 3.0}[language]
    synthesizer.speak("ho")
    synthesizer.speak("hi")
    assert spoken == ["hi", "hi", "ho", "hi"]


def test_what_it_speaks_is_an_event(parrot: str) -> None:
    found: list[str] = []
    with Session(parrot) as session:
        text = "speak English then speak Spanish then speak Spanish then speak English"
        session.run(
            btlang.parse_tree(text), speed="max",
            sinks=[lambda event: found.append(event.name) if isinstance(event, LanguageChosen) else None],
        )  # fmt: skip
    assert found == ["es", "en"]


def test_a_language_that_it_lacks_is_refused(parrot: str, capsys: pytest.CaptureFixture[str]) -> None:
    text = "say hello then speak Spanish then speak Finnish"
    assert main(["run", "--robot", parrot, "--speed", "max", "-c", text]) == 2
    shown = capsys.readouterr()
    assert "BT072: The robot 'talker' has no voice for the language \"fi\", which 'speak Finnish' needs." in shown.err
    assert "says" not in shown.out


def test_one_that_only_the_run_knows_fails(parrot: str, capsys: pytest.CaptureFixture[str]) -> None:
    text = "for each tongue in Spanish, Finnish: speak {tongue} then say hello"
    assert main(["run", "--robot", parrot, "--speed", "max", "-c", text]) == 1
    shown = capsys.readouterr()
    assert "a parrot doesn't speak fi" in shown.err
    assert shown.out.count('says   "hello"') == 1


def test_a_run_that_goes_on_later_speaks_on_in_it(parrot: str) -> None:
    mission = btlang.parse_tree("speak Spanish then wait 1 s then say hello")
    with Session(parrot) as session:
        run = session.prepare(mission, speed="max")
        run.tick()
        saved = json.loads(json.dumps(run.save()))
        run.nodes.suspend()
        between = session.run(btlang.parse_tree("say hello"), speed="max").outcome
        restored = session.restore(mission, saved, speed="max")
        again = restored.save()
        outcome = restored.execute()
        assert between is not None
        assert between.seconds == pytest.approx(1.0, abs=0.1)
        assert outcome.seconds == pytest.approx(4.0, abs=0.2)
        assert again["language"] == "es"
        with pytest.raises(MissionError, match="BT193"):
            session.restore(mission, {**saved, "language": "fi"})
