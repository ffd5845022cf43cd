"""Missions whose words are done by components, in a process of their own and in the robot's."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path
from typing import Any

import pytest

import btlang
from btlang.cli import main
from btlang.components import connection
from btlang.components.words import robot_words
from btlang.run.events import Event, PartChanged, RobotEvent, Warned
from tests.components.robots import machine, robot_file

WHERE = pytest.mark.parametrize("runs", ["process", "here"])


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """That of the robots of all tests which leave the samples as they are."""
    return tmp_path_factory.mktemp("robots")


def run(robot: str, text: str, **options: Any) -> tuple[btlang.Outcome, list[Event]]:
    events: list[Event] = []
    mission = btlang.parse_tree(text, keywords=robot_words(robot))
    with btlang.Session(robot) as session:
        outcome = session.run(mission, sinks=[events.append], **{"speed": "max", **options}).outcome
    assert outcome is not None
    return outcome, events


def printed(events: list[Event]) -> list[str]:
    return [event.text for event in events if event.tag == "print"]  # type: ignore[attr-defined]


@WHERE
def test_words_conditions_and_quantities(folder: Path, runs: str) -> None:
    robot = robot_file(folder, machine(runs=f'"{runs}"', parameters="{ heat = 70 }"))
    text = (
        "if something was brewed, print early otherwise brew tea\n"
        "brew\n"
        "if the number of cups is above 1, print many\n"
        "bring it to the lobby"
    )
    outcome, events = run(robot, text)
    assert outcome.succeeded, outcome.why()
    assert printed(events) == ["brewing tea at 70", "brewing coffee at 70", "many"]
    told = [(event.kind, dict(event.data)) for event in events if isinstance(event, RobotEvent)]
    assert told == [("say", {"cups": 0}), ("say", {"cups": 1})]
    assert outcome.seconds < 60


@WHERE
def test_what_it_raises_is_the_reason(folder: Path, runs: str) -> None:
    robot = robot_file(folder, machine(runs=f'"{runs}"', parameters='{ wrong = "raise in brew" }'))
    outcome, _ = run(robot, "brew tea")
    assert not outcome.succeeded
    assert "no water" in outcome.why()
    assert "raised in _go_wrong, coffee.py:" in outcome.why()


@WHERE
@pytest.mark.parametrize("hook", ["configure", "activate", "step"])
def test_where_a_hook_raised_is_said(folder: Path, runs: str, hook: str) -> None:
    robot = robot_file(folder, machine(runs=f'"{runs}"', parameters=f'{{ wrong = "raise in {hook}" }}', restarts=0))
    outcome, _ = run(robot, "wait 0.5 s then brew tea", speed="real")
    assert "RuntimeError: no water (raised in _go_wrong, coffee.py:" in outcome.why()


@WHERE
def test_a_refusal_is_a_plain_no(folder: Path, runs: str) -> None:
    robot = robot_file(folder, machine(runs=f'"{runs}"'))
    outcome, events = run(
        robot, "whenever the tray is full, print full\nif the tray is full, print yes otherwise print no"
    )
    assert outcome.succeeded, outcome.why()
    assert (printed(events), [each for each in events if isinstance(each, Warned)]) == (["no"], [])
    outcome, _ = run(robot, "check that the tray is full")
    assert "it has brewed 0 of 3" in outcome.why()
    outcome, _ = run(robot, "serve from the tray")
    assert "the tray is empty" in outcome.why()


@WHERE
def test_an_answer_that_was_forgotten_is_not_known(folder: Path, runs: str) -> None:
    robot = robot_file(folder, machine(runs=f'"{runs}"', parameters='{ wrong = "forget it" }'))
    outcome, events = run(robot, "if the tray is full, print yes otherwise print no")
    assert not outcome.succeeded
    assert printed(events) == []
    assert "it returned nothing" in outcome.why()


@pytest.mark.parametrize("wrong", ["raise", "exit"])
def test_one_that_does_not_start_fails_its_words(folder: Path, wrong: str) -> None:
    robot = robot_file(folder, machine(parameters=f'{{ wrong = "{wrong} in configure" }}', restarts=1))
    outcome, events = run(robot, "try brew tea otherwise print sorry")
    assert (outcome.succeeded, printed(events)) == (True, ["sorry"])
    outcome, _ = run(robot, "brew tea")
    assert "no water" in outcome.why() or "exit code 7" in outcome.why()


def test_a_death_fails_the_command_at_once_and_it_is_back_for_the_next(folder: Path) -> None:
    robot = robot_file(folder, machine())
    text = "try roll away otherwise print lost\nwait 3 seconds\nbrew tea"
    events: list[Event] = []
    mission = btlang.parse_tree(text, keywords=robot_words(robot))
    with btlang.Session(robot) as session:
        manager = session.connection.manager  # type: ignore[attr-defined]
        run = session.start(mission, sinks=[events.append])
        while session.robot.velocity[0] < 0.25:
            time.sleep(0.01)
        process = manager.statuses()[0].process
        os.kill(process, signal.SIGKILL)
        run.wait(30)
        assert run.outcome is not None
        assert run.outcome.succeeded, run.why()
        assert manager.statuses()[0].process not in (process, None)
    assert printed(events) == ["lost", "brewing tea at 90"]
    told = [event for event in events if isinstance(event, PartChanged)]
    assert "the machine was killed by signal 9" in [event.text for event in told]
    assert (told[-1].state, told[-1].text) == ("active", "the machine is active")
    for pid in (process, manager.statuses()[0].process):
        assert pid is None or not os.path.exists(f"/proc/{pid}")


def test_what_it_drives_stands_when_it_dies(folder: Path) -> None:
    robot = robot_file(folder, machine())
    mission = btlang.parse_tree("roll away", keywords=robot_words(robot))
    with btlang.Session(robot) as session:
        run = session.start(mission)
        while session.robot.velocity[0] < 0.25:
            time.sleep(0.01)
        os.kill(session.connection.manager.statuses()[0].process, signal.SIGKILL)  # type: ignore[attr-defined]
        outcome = run.wait(30)
        assert outcome is not None
        assert not outcome.succeeded
        assert "was killed by signal 9" in outcome.why()
        assert outcome.standstill.still
        assert session.robot.velocity == (0.0, 0.0)


def test_a_halt_ends_the_method_and_what_it_drives(folder: Path) -> None:
    robot = robot_file(folder, machine())
    outcome, _ = run(robot, "roll away for 1 second then brew tea", speed="real")
    assert outcome.succeeded, outcome.why()
    assert outcome.seconds < 5


@WHERE
def test_one_that_hangs_keeps_no_robot_from_going_down(
    folder: Path, runs: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(connection, "_UP", 0.5)
    hangs = machine(runs=f'"{runs}"', parameters='{ wrong = "hang in configure" }', limit=600)
    robot = robot_file(folder, hangs)
    began = time.monotonic()
    with btlang.Session(robot) as session:
        process = session.connection.manager.statuses()[0].process  # type: ignore[attr-defined]
    assert time.monotonic() - began < 20
    assert process is None or not os.path.exists(f"/proc/{process}")


def test_components_that_need_each_other_wait(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connection, "_UP", 0.5)
    robot = robot_file(folder, machine(needs='["other"]') + "\n" + machine(name='"other"', needs='["machine"]'))
    with btlang.Session(robot) as session:
        manager = session.connection.manager  # type: ignore[attr-defined]
        assert [each.why for each in manager.statuses()] == ["waits for the other", "waits for the machine"]
        assert manager.is_free("machine")


@WHERE
def test_an_emergency_stop_holds_what_a_component_moves_itself(folder: Path, runs: str) -> None:
    wheels = '\n[[device]]\nname = "wheels"\nkind = "drive"\ndriver = "simulated"\n'
    robot = robot_file(folder, machine(runs=f'"{runs}"', needs='["wheels"]') + wheels)
    mission = btlang.parse_tree("push the wheels", keywords=robot_words(robot))
    with btlang.Session(robot) as session:
        run = session.start(mission)
        while session.robot.velocity[0] < 0.25:
            time.sleep(0.01)
        run.emergency_stop()
        outcome = run.wait(30)
        assert outcome is not None
        assert outcome.standstill.still
        for _ in range(20):  # nobody ticks any more; the component may go on to write
            session.robot.step(0.05)
        assert session.robot.velocity == (0.0, 0.0)


def test_a_newer_version_waits_for_the_mission(tmp_path: Path) -> None:
    robot = robot_file(tmp_path, machine())
    mission = btlang.parse_tree("brew tea then wait 2 seconds then brew tea", keywords=robot_words(robot))
    with btlang.Session(robot) as session:
        manager = session.connection.manager  # type: ignore[attr-defined]
        run = session.start(mission)
        time.sleep(0.5)
        path = tmp_path / "coffee.py"
        path.write_text(path.read_text(encoding="utf-8").replace('"1.0"', '"2.0"'), encoding="utf-8")
        old = manager.statuses()[0]
        manager.load(manager.keeper("machine").part)
        time.sleep(0.5)
        assert manager.statuses()[0] == old
        outcome = run.wait(30)
        assert outcome is not None
        assert outcome.succeeded, outcome.why()
        with manager.changed:
            assert manager.changed.wait_for(lambda: manager.statuses()[0].version == "2.0", 20)
            assert manager.changed.wait_for(lambda: manager.statuses()[0].state == "active", 20)
        assert session.run(mission, speed="max").outcome.succeeded  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("table", "reason"),
    [
        (machine(parameters="{ heat = 99 }"), "heat must be from 60 to 95 °C, not 99"),
        (machine(parameters="{ cold = 1 }"), 'unknown parameter "cold"; the parameters are heat, wrong'),
        (machine(**{"class": '"coffee:Broken"'}), "isn't a class that is derived from btlang.Component"),
        (machine(**{"class": '"coffee:None"'}), "can't be loaded"),
    ],
)
def test_what_cannot_be_loaded_says_why(folder: Path, table: str, reason: str) -> None:
    robot = robot_file(folder, f"{table}\nrestarts = 0")
    with btlang.Session(robot) as session:
        assert reason in session.connection.manager.statuses()[0].why  # type: ignore[attr-defined]


@WHERE
def test_no_run_starts_without_a_class(tmp_path: Path, runs: str, capsys: pytest.CaptureFixture[str]) -> None:
    robot = robot_file(tmp_path, machine(runs=f'"{runs}"'))
    path = tmp_path / "coffee.py"
    path.write_text(path.read_text(encoding="utf-8").replace("def configure(self):", "def configure(self)"), "utf-8")
    assert main(["robot", "check", robot]) == 2
    said = capsys.readouterr().err
    assert "SyntaxError" in said
    for text in ("whenever something was brewed, print oh. go to the lab", "go to the lab"):
        assert main(["run", "-c", text, "--robot", robot, "--speed", "max"]) == 2
        out, err = capsys.readouterr()
        assert (out, err) == ("", said)
    mission = btlang.parse_tree("whenever something was brewed, print oh. go to the lab", keywords=robot_words(robot))
    with btlang.Session(robot) as session, pytest.raises(btlang.MissionError, match="SyntaxError"):
        session.prepare(mission)
    with btlang.Session(robot) as session:
        outcome = session.run("go to the lab", speed="max").outcome
        assert outcome is not None
        assert outcome.succeeded


@WHERE
def test_a_rule_that_never_knew_is_told_at_the_end(folder: Path, runs: str, capsys: pytest.CaptureFixture[str]) -> None:
    robot = robot_file(folder, machine(runs=f'"{runs}"', parameters='{ wrong = "slip" }'))
    outcome, events = run(robot, "whenever the tray is full, print full. go to the lab")
    assert outcome.succeeded
    [told] = outcome.unanswered
    assert told.startswith("A rule did nothing: 'tray is full' was never known (AttributeError: ")
    warned = next(event.text for event in events if isinstance(event, Warned))
    assert warned.startswith(
        "'tray is full' is not known: AttributeError: 'Machine' object has no attribute 'capacity'"
    )
    assert warned.count("(raised in is_full, coffee.py:") == 1
    assert str(outcome).splitlines()[1:] == [told, *outcome.caught]
    assert str(outcome).count("(raised in is_full, coffee.py:") == 1
    assert [event.text for event in events if isinstance(event, Warned)][-1] == told
    assert main(["run", "-c", "whenever the tray is full, print full. wave", "--robot", robot, "--speed", "max"]) == 0
    assert told in capsys.readouterr().out.splitlines()[-1]
