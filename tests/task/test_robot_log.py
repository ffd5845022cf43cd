"""The lines of `btc robot up`: nothing that people do to the robot goes unreported, and the last line is true."""

from __future__ import annotations

import re
from pathlib import Path

from btlang.cli.robot_log import RobotLog
from btlang.task import messages
from btlang.task.layer import TaskLayer
from btlang.task.store.records import FINAL

from .layers import layer_in, submit, wait_for, wait_until


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
