"""The guide over DDS: strokes meet their words, sound and arms stop together, and the whole case in three processes."""

from __future__ import annotations

import signal
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import btlang
from btlang.robots.bodies.body_file import load_body
from btlang.robots.bodies.speech_tables import engine_of
from btlang.robots.preflight import said_gesture
from btlang.robots.registry import Connector
from btlang.run.events import Event, Said, StrokePlanned
from btlang.session import Session
from btlang.speech.marks import read_marks
from btlang.text.source import Source
from tests.profiles import only_long
from tests.ros.client import Client
from tests.ros.processes import REPOSITORY, Command, wait_until
from tests.ros.watched_sim import Look, WatchedSim
from tests.speech.guide import ROOM, SAMPLES, guide

GUIDE = REPOSITORY / "examples" / "guide"
MOST = 0.08  # seconds between a stroke and its word
BUSY = 0.5  # the same where other processes may hold everything up
LAST_REST = 0.3  # seconds until it rests
TEXT = "Good morning. <bow> Welcome to the museum, all of you, and come in: there is a lot to see today."
TOUR = 300.0  # seconds


@pytest.fixture
def watched(tmp_path: Path, domain: int, monkeypatch: pytest.MonkeyPatch) -> Iterator[WatchedSim]:
    """The guide in a room."""
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    world = tmp_path / "room.toml"
    world.write_text(ROOM)
    sim = WatchedSim(tmp_path, domain, "sim-ros", "--robot", str(GUIDE / "robot.toml"), "--world", str(world))
    sim.wait_for("ready")
    yield sim
    assert sim.end() == 130
    assert sim.err == ""


def speaker(sim_time: bool = False) -> Connector:
    """The guide over ROS 2, with gestures of the tests and the voice of its file.

    In simulated time it doesn't matter whether a busy machine slows the robot down.
    """
    body = load_body(str(GUIDE / "robot.toml"))
    return Connector(guide("").replace(voice=body.voice, components=()), "ros", {"sim_time": sim_time})


def run(session: Session, mission: str) -> list[Event]:
    events: list[Event] = []
    session.start(btlang.parse_tree(mission, world=Source(ROOM, "room.toml")), sinks=[events.append]).wait()
    return events


def rests(looks: list[Look], text: str) -> tuple[float, float]:
    """The seconds at which the voice ended, and at which the joints did."""
    spoken = [look.time for look in looks if look.speaking and look.text == text]
    return spoken[-1], max(look.time for look in looks if look.moving)


def test_a_stroke_meets_its_word_and_voice_and_arms_stop_together(watched: WatchedSim) -> None:
    with Session(robot=speaker(), world=Source(ROOM, "room.toml")) as session:
        run(session, 'say "Hello."')  # on a busy computer DDS takes seconds until the first word
        events = run(session, f'(say "{TEXT}") for 4 s')  # late enough for the stroke, in time before the end
    [planned] = [event for event in events if isinstance(event, StrokePlanned)]
    text = read_marks(TEXT)[0]
    late = watched.late(guide("").gestures["bow"], text, planned.word)
    assert late is not None
    assert abs(late - (planned.stroke - planned.word)) < BUSY
    silent, still = rests(watched.looks, text)
    assert still - silent < LAST_REST + BUSY
    assert watched.looks[-1].moving is False


@only_long
def test_strokes_of_all_commentaries(watched: WatchedSim) -> None:
    found: list[float] = []
    promised: list[float] = []
    with Session(robot=speaker(sim_time=True), world=Source(ROOM, "room.toml")) as session:
        for sample in SAMPLES.values():
            events = run(session, f'say "{sample.replace("{guest}", "Ann")}"')
            text = next(event.text for event in events if isinstance(event, Said))
            for event in (event for event in events if isinstance(event, StrokePlanned)):
                late = watched.late(guide("").gestures[event.name], text, event.word)
                if late is not None:
                    print(f"{event.name}: {1000 * late:.0f} ms, {1000 * (event.stroke - event.word):.0f} planned")
                    found.append(abs(late))
                    promised.append(abs(event.stroke - event.word))
    p95 = sorted(found)[int(0.95 * len(found))]
    print(
        f"{len(found)} strokes: p95 {1000 * p95:.0f} ms, most {1000 * max(found):.0f} ms, planned {max(promised):.2f} s"
    )
    assert p95 <= MOST


@only_long
@pytest.mark.parametrize("how", ["halt", "emergency"])
def test_halted_in_the_stroke(watched: WatchedSim, how: str) -> None:
    found: list[float] = []
    with Session(robot=speaker(), world=Source(ROOM, "room.toml")) as session:
        for number in range(12):
            run(session, 'say "<bow> And up again."')
            wait_until(lambda: watched.looks and not watched.last.moving, "rest")
            assert watched.last.joint("waist tilt") == pytest.approx(0.0, abs=0.5)
            text = f"Number {number}. {TEXT}"
            mission = btlang.parse_tree(f'say "{text}"', world=Source(ROOM, "room.toml"))
            going = session.start(mission)
            plain = read_marks(text)[0]

            def bows(plain: str = plain) -> bool:
                return watched.last.text == plain and 3.0 < watched.last.joint("waist tilt") < 20.0

            wait_until(bows, "the bow")
            if how == "halt":
                going.stop()
            else:
                session.robot.stop()
                going.stop()
            going.wait()
            wait_until(lambda: not watched.last.moving, "rest")
            silent, still = rests(watched.looks, plain)
            found.append(still - silent)
    print(f"{how}: arms rest {1000 * max(found):.0f} ms after the voice at most, {1000 * min(found):.0f} at least")
    assert max(found) <= LAST_REST + MOST


@only_long
def test_the_whole_case_in_three_processes(
    tmp_path: Path, domain: int, start_node: Callable[..., Command], client: Client, run_mission: Any, nav2: Any
) -> None:
    from btlang_interfaces.msg import Heard

    folder = tmp_path / "sim"
    folder.mkdir()
    sim = WatchedSim(folder, domain, "sim-ros", "--robot", str(GUIDE / "robot.toml"))
    sim.wait_for("ready")
    node = start_node("--robot", str(GUIDE / "robot.toml"), "--over", "ros")
    heard = client.publisher(Heard, "/heard")

    def btc(*arguments: str) -> Command:
        place = tmp_path / f"task{time.monotonic_ns()}"
        place.mkdir()
        command = Command(place, domain, *arguments, XDG_RUNTIME_DIR=node.sockets)
        command.process.wait(60)
        return command

    added = btc("task", "add", str(GUIDE / "missions" / "short_tour.txt"), "--name", "btlang")
    assert added.process.returncode == 0, added.err
    wait_until(lambda: "Follow me!" in sim.out, "the welcome", 60.0)
    heard.publish(Heard(who="Ann", text="where is the cafe?"))
    wait_until(lambda: "You were wonderful. Goodbye!" in sim.out, "the end of the tour", TOUR)
    wait_until(lambda: "completed" in btc("task", "list", "--all", "--name", "btlang").out, "the end of the task", 30.0)
    body = load_body(str(GUIDE / "robot.toml"))
    texts = {look.text for look in sim.looks if look.speaking}
    assert any("cafe" in text for text in texts), texts
    tour = (GUIDE / "missions" / "short_tour.txt").read_text(encoding="utf-8")
    said = [line.split('"')[1] for line in tour.splitlines() if line.startswith("say")]
    found: dict[str, float | None] = {}
    for line in said:
        text, marks = read_marks(line)
        for mark in marks:
            gesture = said_gesture(body, mark.words)
            assert gesture is not None
            if gesture.name in body.gestures:
                word = engine_of(body).speak(text).time_of(mark.index)
                found[mark.words] = sim.late(body.gestures[gesture.name], text, word)
    print({words: None if late is None else round(late, 3) for words, late in found.items()})
    assert all(abs(late) < BUSY for late in found.values() if late is not None)
    assert sim.end(signal.SIGINT) == 130
