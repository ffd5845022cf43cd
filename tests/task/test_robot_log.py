"""What is reported of a robot that is up: the lines of `btc robot up`, and pauses among the changes of a task."""

from __future__ import annotations

import re
from pathlib import Path

from btlang.cli.robot_log import RobotLog
from btlang.task import messages
from btlang.task.layer import TaskLayer
from btlang.task.store.records import FINAL, TaskState

from .layers import ask, layer_in, submit, task, wait_for, wait_until


def said(lines: list[str]) -> list[str]:
    assert all(re.match(r"\d\d:\d\d:\d\d  ", line) for line in lines)
    return [line[10:] for line in lines]


def do(layer: TaskLayer, log: RobotLog, command: messages.Command, person: str) -> None:
    assert layer.handle(command, person).ok
    log.look(person)


def test_a_line_for_stops_pauses_and_tasks_that_are_over(tmp_path: Path) -> None:
    lines: list[str] = []
    with layer_in(tmp_path) as layer:
        log = RobotLog(layer, lines.append)
        do(layer, log, messages.Pause(), "ann")
        do(layer, log, messages.Pause(), "ann")
        number = submit(layer, "wait 1 s")
        do(layer, log, messages.Resume(), "ben")
        wait_for(layer, number, *FINAL)
        wait_until(lambda: len(lines) == 3)
        layer.stop("the keyboard")
        wait_until(lambda: len(lines) == 4)  # without a command
        layer.stop("the keyboard")
        do(layer, log, messages.EmergencyStop("a cat"), "ann")
        do(layer, log, messages.Release(), "ben")
        failing = submit(layer, "grasp the book")
        wait_for(layer, failing, *FINAL)
        log.close()
        layer.stop("nobody reads this")
    assert said(lines)[:-1] == [
        "Paused by ann. To go on: btc robot resume",
        "The pause was ended by ben.",
        f"Task {number} completed: wait 1 s",
        "Stopped: emergency stop by the keyboard. To let it move: btc robot release",
        "Stopped: emergency stop by ann: a cat. To let it move: btc robot release",
        "Released by ben: the robot may move again.",
    ]
    assert said(lines)[-1].startswith(f"Task {failing} failed: grasp the book (")


def test_a_question_is_a_line_with_how_to_answer(tmp_path: Path) -> None:
    lines: list[str] = []
    with layer_in(tmp_path) as layer:
        log = RobotLog(layer, lines.append)
        number = submit(layer, 'ask "Tea?"')
        wait_until(lambda: len(lines) == 1)
        do(layer, log, messages.AnswerQuestion("yes"), "ann")
        wait_for(layer, number, *FINAL)
        log.close()
    assert said(lines)[0] == 'Asks "Tea?" To answer: btc task answer TEXT'


def test_a_robot_that_comes_up_stopped_reports_its_release(tmp_path: Path) -> None:
    with layer_in(tmp_path) as layer:
        layer.stop("ann")
    lines: list[str] = []
    with layer_in(tmp_path) as layer:
        log = RobotLog(layer, lines.append)
        do(layer, log, messages.Release(), "ben")
        log.close()
    assert said(lines) == ["Released by ben: the robot may move again."]


def test_a_terminal_that_is_gone_stops_nothing(tmp_path: Path) -> None:
    def write(line: str) -> None:
        raise BrokenPipeError

    with layer_in(tmp_path) as layer:
        log = RobotLog(layer, write)
        number = submit(layer, "wait 1 s")
        wait_for(layer, number, *FINAL)
        do(layer, log, messages.Pause(), "ann")
        log.close()


def test_a_pause_and_its_end_are_kept_with_the_task(tmp_path: Path) -> None:
    with layer_in(tmp_path, speed=20) as layer:
        number = submit(layer, "go to the lab")
        wait_for(layer, number, TaskState.UNDERWAY)
        ask(layer, "pause")
        ask(layer, "pause")  # is no second one
        assert task(layer, number).reason == "paused"
        ask(layer, "resume")
        ask(layer, "resume")
        assert wait_for(layer, number, *FINAL).state is TaskState.COMPLETED
        shown = ask(layer, "show", task=number)["task"]["changes"]
    texts = [(each["state"], each["cause"]) for each in shown]
    assert texts[-4:] == [
        ("underway", "it begins"),
        ("underway", "paused"), ("underway", "it goes on after a pause"), ("completed", ""),
    ]  # fmt: skip
    assert [each["person"] for each in shown[3:5]] == ["ann", "ann"]
