"""Engines of speech: the times of words and phonemes."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from threading import Thread

import pytest

from btlang.cli import main
from btlang.robots.bodies.body import Body
from btlang.robots.bodies.body_file import BodyError, load_body
from btlang.robots.bodies.speech_tables import engine_of
from btlang.speech.engine import SHAPES, Estimate, Settings, SpeechError, Utterance, shape_at, shape_of
from btlang.speech.espeak import Espeak
from btlang.text.source import Source

TEXT = "Welcome to the museum. This is two thousand years old, and well-known!"
GOLDEN = {
    "Welcome": 0.0, "to": 0.44, "the": 0.6, "museum.": 0.73, "This": 1.74, "is": 1.95, "two": 2.1, "thousand": 2.32,
    "years": 2.85, "old,": 3.16, "and": 3.72, "well-known!": 3.93,
}  # fmt: skip
SECONDS = 4.56
HEAD = 'name = "x"\nradius = 0.2\n'


def check_order(utterance: Utterance) -> None:
    times = [0.0, *(word.time for word in utterance.words), utterance.seconds]
    assert all(one <= other for one, other in pairwise(times))
    assert [utterance.text[word.start : word.end] for word in utterance.words] == utterance.text.split()
    sounds = [phoneme.time for phoneme in utterance.phonemes]
    assert sounds == sorted(sounds)


def test_the_words_of_a_fixed_text_have_their_times() -> None:
    spoken = Espeak(Settings(variant="f3")).speak(TEXT)
    check_order(spoken)
    assert [word.text for word in spoken.words] == list(GOLDEN)
    assert spoken.seconds == pytest.approx(SECONDS, rel=0.05)
    for word in spoken.words:
        assert word.time == pytest.approx(GOLDEN[word.text], abs=0.05 * SECONDS)
    assert len(spoken.samples) == pytest.approx(2 * spoken.rate * spoken.seconds)
    assert any(spoken.samples)


def test_times_do_not_depend_on_what_was_said_before() -> None:
    one, other = Settings(pitch=50.0), Settings(pitch=50.5)  # the same for the library, but not for the cache
    first = Espeak(one).speak(TEXT)
    Espeak(one).speak("Something else, in between.")
    assert Espeak(other).speak(TEXT) == first


@pytest.mark.parametrize(
    "text",
    ["", " \n ", "<b>bold</b> &amp; [[h@l'oU]] <speak>", "a" * 10_000, "😀 & — !", "nul \0 in it", "\ud800 half"],
)
def test_any_text_is_plain_text(text: str) -> None:
    for engine in (Espeak(Settings()), Estimate(Settings())):
        check_order(engine.speak(text))


def test_what_looks_like_markup_is_spoken() -> None:
    espeak = Espeak(Settings())
    assert espeak.speak('<break time="9s"/>').seconds > espeak.speak("break time").seconds
    assert espeak.speak("[[h@l'oU]]").seconds > 1.5 * espeak.speak("hello").seconds


def test_languages_variants_speeds() -> None:
    usual = Espeak(Settings()).speak(TEXT)
    assert Espeak(Settings(speed=320.0)).speak(TEXT).seconds < 0.7 * usual.seconds
    assert Espeak(Settings(variant="m3")).speak(TEXT).samples != usual.samples
    assert Espeak(Settings(language="es")).speak("¿Qué tal?").words[1].text == "tal?"
    for settings, message in (
        (Settings(language="qq"), 'no language "qq"'),
        (Settings(language="../en"), "no language"),
        (Settings(variant="zz"), 'no variant "zz"; it has Alex'),
    ):
        with pytest.raises(SpeechError, match=message):
            Espeak(settings)


def test_threads_take_turns() -> None:
    texts = [f"Number {number} of them." for number in range(12)]
    found: dict[str, Utterance] = {}

    def speak(text: str) -> None:
        found[text] = Espeak(Settings(variant="m1" if len(text) % 2 else "f1")).speak(text)

    threads = [Thread(target=speak, args=(text,)) for text in texts]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    assert [found[text].words[1].text for text in texts] == [str(number) for number in range(12)]


def test_without_sound_words_share_the_time() -> None:
    spoken = Estimate(Settings(text=1.0, character=0.5)).speak("to be")
    assert (spoken.seconds, spoken.samples) == (3.5, b"")
    assert [(word.time, word.seconds) for word in spoken.words] == [(1.0, 1.5), (2.5, 1.0)]
    assert [spoken.time_of(index) for index in (0, 2, 3, 5)] == [1.0, 2.5, 2.5, 3.5]
    words = [spoken.word_at(time) for time in (0.0, 1.0, 2.6, 9.0)]
    assert [word.start for word in words if word is not None] == [0, 0, 3, 3]
    assert spoken.replace(words=()).word_at(1.0) is None


def test_mouths_follow_phonemes() -> None:
    spoken = Espeak(Settings()).speak("mama")
    assert {shape_at(spoken, time / 100) for time in range(50)} >= {"closed", "open"}
    assert shape_at(spoken, -1.0) == shape_at(spoken, spoken.seconds) == "rest"
    assert [shape_of(name) for name in ("", "'oU", "f", "t", "_:", "i:")] == [
        "rest", "round", "teeth", "narrow", "narrow", "wide",
    ]  # fmt: skip
    assert all(0.0 <= width <= 1.0 for width in SHAPES.values())


def load(text: str, folder: Path | None = None) -> Body:
    if folder is None:
        return load_body(Source(HEAD + text, "robot.toml"))
    (folder / "robot.toml").write_text(HEAD + text)
    return load_body(str(folder / "robot.toml"))


def test_robot_files_choose_the_engine(tmp_path: Path) -> None:
    assert isinstance(engine_of(load("[voice]\ntext = 1\ncharacter = 0\n")), Estimate)
    body = load('[voice]\nengine = "espeak"\nlanguage = "es"\nvariant = "f3"\nspeed = 200\npitch = 60\n')
    assert body.voice is not None
    assert body.voice.settings == Settings("es", "f3", 200.0, 60.0)
    assert isinstance(engine_of(body), Espeak)
    (tmp_path / "parrot.py").write_text(
        "from btlang.speech.engine import Utterance\n\n\nclass Parrot:\n    def __init__(self, settings):\n"
        "        self.settings = settings\n\n    def speak(self, text):\n        return Utterance(text, 7.0)\n"
    )
    assert engine_of(load('[voice]\nengine = "parrot:Parrot"\n', tmp_path)).speak("hi").seconds == 7.0
    for engine, message in (("parrot:Missing", "can't be loaded"), ("nobody", "has an engine of speech")):
        with pytest.raises(SpeechError, match=message):
            engine_of(load(f'[voice]\nengine = "{engine}"\n', tmp_path))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('[voice]\nengine = "mine:Voice"\n', "others run code"),
        ("[voice]\ntext = 1\n", 'needs a number "character"'),
        ('[voice]\nengine = "espeak"\nspeed = 1000\n', "from 80 to 450"),
        ("[voice]\ntext = 1\ncharacter = 0\nspeed = 100\n", 'unknown key "speed"'),
        ('[mouth]\njoint = "jaw"\n', '"joint" must be one of'),
        ("[mouth]\n", 'a mouth is a "joint" or a "display"'),
    ],
)
def test_wrong_voices_are_refused(text: str, message: str) -> None:
    with pytest.raises(BodyError, match=message):
        load(text)


def test_without_the_package_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("btlang.speech.espeak.find_spec", lambda name: None)
    with pytest.raises(SpeechError, match=r"pip install 'btlang\[voice\]'"):
        engine_of(load('[voice]\nengine = "espeak"\n'))


def test_in_simulation_it_runs_without_the_package(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("btlang.speech.espeak.find_spec", lambda name: None)
    robot = tmp_path / "robot.toml"
    robot.write_text(HEAD + '[voice]\nengine = "espeak"\ntext = 1\ncharacter = 0\n')
    run = ["run", "-c", 'speak Spanish and say "hola"', "--robot", str(robot), "--speed", "max"]
    assert main(run) == 0
    said = capsys.readouterr()
    assert "1.00  done   say hola" in said.out
    assert "note: The voice is silent and its times are estimated, because it needs the Python package" in said.err
    assert main([*run, "--voice", str(tmp_path / "said.wav")]) == 2
    assert "BT071" in capsys.readouterr().err
    assert not (tmp_path / "said.wav").exists()
