"""Saying with gestures: strokes meet their words, halting stops both, and an interrupted sentence begins again."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import btlang
from btlang.actions.speech import say
from btlang.diagnostics.diagnostic import MissionError
from btlang.engine.status import RUNNING
from btlang.robots.registry import Connector
from btlang.run.events import Event, GestureStarted, Said, StrokePlanned, Warned
from btlang.session import Session
from btlang.text.source import Source
from tests.profiles import only_long
from tests.speech.guide import ROOM, SAMPLES, guide, robot
from tests.speech.strokes import Met, measured

TICK = 0.05
MOST = 0.08  # seconds between a stroke and its word
LAST_REST = 0.3  # seconds until it rests
SENTENCES = "One is the first. Two is the second, <wave> and it waves. Three is the last."


def p95(found: list[Met]) -> float:
    return sorted(abs(met.late) for met in found)[int(0.95 * len(found))]


@pytest.mark.parametrize(("period", "drives"), [(0.05, False), (0.2, False), (0.05, True)])
def test_strokes_meet_their_words(period: float, drives: bool) -> None:
    found: list[Met] = []
    for name in ("welcome", "names", "stairs"):
        speaker = robot()
        found += measured(
            speaker, SAMPLES[name].replace("{guest}", "Ann"), period, lambda it=speaker: drives and it.drive(0.2, 5.0)
        )
    assert len(found) == 11
    assert p95(found) <= MOST


@only_long
@pytest.mark.parametrize("period", [0.02, 0.05, 0.1, 0.2])
@pytest.mark.parametrize("drives", [False, True])
def test_strokes_of_all_commentaries(period: float, drives: bool) -> None:
    found: list[Met] = []
    for text in SAMPLES.values():
        speaker = robot()
        found += measured(speaker, text, period, lambda it=speaker: drives and it.drive(0.1, 4.0))
    print(f"{period} s, driving {drives}: p95 {1000 * p95(found):.1f} ms of {len(found)}")
    assert p95(found) <= MOST


def test_speech_begins_later_where_the_first_stroke_needs_it() -> None:
    speaker = robot()
    planned: list[Any] = []
    speaker.on_event = lambda kind, data: planned.append(data) if kind == "stroke" else None
    steps = say(speaker, "<bow> Hello, and <nod> <shrug> welcome.")
    next(steps)
    assert 0.5 <= speaker.said_at <= 1.0
    assert speaker.speaking
    assert planned == [{"name": "bow", "stroke": pytest.approx(0.0, abs=0.1), "word": 0.0}]


def test_a_stroke_that_cannot_come_in_time_says_so() -> None:
    speaker = robot()
    planned: dict[str, float] = {}
    speaker.on_event = lambda kind, data: (
        planned.update({data["name"]: data["stroke"] - data["word"]}) if kind == "stroke" else None
    )
    for _ in say(speaker, "<raise arms> So <bow> big!"):
        speaker.step(TICK)
    assert abs(planned["raise arms"]) < MOST < planned["bow"]


def test_halting_stops_sound_and_arms() -> None:
    speaker = robot()
    steps = say(speaker, "Welcome <wave> to the museum, all of you.")
    while speaker.joint("right shoulder lift") < 20.0:
        next(steps)
        speaker.step(TICK)
    assert speaker.speaking
    assert speaker.moving
    steps.close()
    assert not speaker.speaking
    for _ in range(round(LAST_REST / TICK)):
        speaker.step(TICK)
    assert not speaker.moving


def test_without_a_gesture_in_reach_it_speaks_on() -> None:
    speaker = robot()
    told: list[str] = []
    speaker.on_event = lambda kind, data: told.append(data["text"]) if kind == "warning" else None
    speaker.put(speaker.pose.replace(heading=180.0))
    for _ in say(speaker, "This <look at the statue> is old. <unknown> And big."):
        speaker.step(TICK)
    assert speaker.said is not None
    assert speaker.said.text == "This is old. And big."
    assert ["unknown" in told[0], "behind the robot" in told[1]] == [True, True]


def events_of(mission: str, ticks: int | None = None, again: str = "") -> list[Event]:
    """Of a mission that is interrupted after so many ticks, and goes on: "pause", "saved" or "rule"."""
    events: list[Event] = []
    read = btlang.parse_tree(mission, world=Source(ROOM, "room.toml"))
    with Session(robot=guide_file(), world=Source(ROOM, "room.toml")) as session:
        run = session.prepare(read, speed="max", seed=5, sinks=[events.append])
        for _ in range(ticks or 0):
            assert run.tick() == RUNNING
        if again == "pause":
            run.nodes.suspend()
        elif again == "saved":
            saved = json.loads(json.dumps(run.save()))
            run = session.restore(read, saved, speed="max", sinks=[events.append])
        elif again == "rule":
            session.robot.ears.answer = "stop"
        while run.tick() == RUNNING:
            pass
    return events


def guide_file() -> Connector:
    return Connector(guide(""), "simulated")


def said(events: list[Event]) -> list[str]:
    return [event.text for event in events if isinstance(event, Said)]


@pytest.mark.parametrize("again", ["pause", "saved"])
@pytest.mark.parametrize(("ticks", "rest"), [(5, 0), (35, 18), (60, 18), (75, 51)])
def test_interrupted_it_begins_the_sentence_again(again: str, ticks: int, rest: int) -> None:
    plain = SENTENCES.replace("<wave> ", "")
    events = events_of(f'say "{SENTENCES}"', ticks, again)
    assert said(events) == [plain, plain[rest:]]
    waved = [event for event in events if isinstance(event, StrokePlanned)]
    assert len(waved) == (2 if ticks == 60 else 1)
    assert sum(isinstance(event, GestureStarted) for event in events) == len(waved)


def test_a_rule_interrupts_a_sentence() -> None:
    mission = f'whenever the answer is stop, say "I stop."\nsay "{SENTENCES}"\nsay "{SENTENCES}"'
    plain = SENTENCES.replace("<wave> ", "")
    assert said(events_of(mission, 35, "rule")) == [plain, "I stop.", plain[18:], plain]


def test_halted_it_forgets_where_it_was() -> None:
    mission = f'repeat 2 times: (say "{SENTENCES}") for 2 s'
    plain = SENTENCES.replace("<wave> ", "")
    assert said(events_of(mission)) == [plain, plain]


def test_values_are_said_and_marks_in_them_are_gestures() -> None:
    mission = 'remember "Ann <nod>" as guest\nsay "Hello {guest}, <wave> nice to see you."'
    events = events_of(mission)
    assert said(events) == ["Hello Ann, nice to see you."]
    assert [event.name for event in events if isinstance(event, StrokePlanned)] == ["nod", "wave"]
    assert not any(isinstance(event, Warned) for event in events)


def test_voice_and_arms_are_parts_of_their_own() -> None:
    events = events_of('say "Good morning, <nod> everybody. How are you?" and wave')
    assert [event.name for event in events if isinstance(event, StrokePlanned)] == ["nod"]
    assert said(events) == ["Good morning, everybody. How are you?"]


@pytest.mark.parametrize(
    ("text", "code", "place", "message", "hint"),
    [
        ('say "Hi <wav> there"', "BT072", (8, 13), 'no gesture "wav"', "Similar: wave"),
        ('say "Hi <point at the statu> there"', "BT013", (8, 28), "called 'statu'", "Similar: statue"),
        ('say "Hi <wave at the statue> there"', "BT072", (8, 28), 'no gesture "wave at the statue"', ""),
        ('ask "Who <wav> are you?"', "BT072", (9, 14), 'no gesture "wav"', "Similar: wave"),
        (
            'remember "Ann" as guest\nsay "Hi {guest}, <wav> there"', "BT072", (41, 46), 'no gesture "wav"',
            "Similar: wave",
        ),
        (
            'tell {story} means: say "{story}"\n\ntell "This <wav> is old"', "BT072", (46, 51), 'no gesture "wav"',
            "Similar: wave",
        ),
    ],
)  # fmt: skip
def test_what_the_robot_cannot_do_is_refused(
    text: str, code: str, place: tuple[int, int], message: str, hint: str
) -> None:
    with pytest.raises(MissionError) as caught:
        events_of(text)
    [problem] = caught.value.diagnostics
    assert (problem.code, (problem.span.start, problem.span.end)) == (code, place)
    assert message in problem.message
    assert hint in problem.hint


def test_what_is_said_is_written_as_sound(tmp_path: Path) -> None:
    import wave

    from btlang.robots.voice import voice_track

    path = str(tmp_path / "said.wav")
    mission = 'wait 1 s\nsay "Hello."\n(say "This is a long sentence, which nobody hears to its end.") for 0.5 s'
    body = guide()
    with (
        voice_track(path, body) as sinks,
        Session(robot=Connector(body, "simulated"), world=Source(ROOM, "room.toml")) as session,
    ):
        run = session.prepare(btlang.parse_tree(mission), speed="max", sinks=sinks)
        assert run.execute().succeeded
        seconds = run.bus.clock.now
    with wave.open(path) as sound:
        samples = sound.readframes(sound.getnframes())
        rate = sound.getframerate()
    assert len(samples) / 2 / rate == pytest.approx(seconds, abs=0.1)
    assert not any(samples[: 2 * rate])
    assert any(samples[2 * rate : 3 * rate])
    with pytest.raises(MissionError, match="needs a voice with an engine"), voice_track(path, guide("")):
        pass


def test_pauses_in_the_sound_are_silent(tmp_path: Path) -> None:
    """Where speech has ended, and where it was cut short."""
    import wave

    from btlang.robots.voice import voice_track

    path, body = str(tmp_path / "said.wav"), guide()
    mission = 'say "Hello."\nwait 2 s\n(say "Nobody hears this to its end.") for 0.5 s\nwait 2 s\nsay "Hello."'
    begun: list[float] = []
    with (
        voice_track(path, body) as sinks,
        Session(robot=Connector(body, "simulated"), world=Source(ROOM, "room.toml")) as session,
    ):
        hears = [*sinks, lambda event: begun.append(event.t) if isinstance(event, Said) else None]
        assert session.prepare(btlang.parse_tree(mission), speed="max", sinks=hears).execute().succeeded
    with wave.open(path) as sound:
        samples, rate = sound.readframes(sound.getnframes()), sound.getframerate()
    assert len(begun) == 3
    for begin in begun[1:]:
        last = 2 * round((begin - (1.9 if begin == begun[1] else 1.4)) * rate), 2 * round((begin - 0.05) * rate)
        assert not any(samples[slice(*last)])
        assert any(samples[2 * round(begin * rate) : 2 * round((begin + 0.4) * rate)])
