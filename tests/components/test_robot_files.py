"""`btc robot check` and `btc robot show`: all that is wrong with a robot file at once, and the robot drawn."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from btlang.components.checking import check_robot, circle, levels
from btlang.components.component import ComponentError
from btlang.components.manager import class_of
from btlang.diagnostics.files import read_source
from btlang.robots.bodies.body import ComponentPart, RosNode
from btlang.robots.bodies.body_file import read_body
from btlang.text.source import Source
from tests.components.robots import machine, robot_file

BODY = """
name = "small"
radius = 0.2
over = "devices"
[base]
driving = { speed = 0.5, top_speed = 1, acceleration = 1.0, slowing = 0.6, brake = 2.0, hard_brake = 4.0 }
turning = { speed = 90, top_speed = 180, acceleration = 240, slowing = 180, brake = 480, hard_brake = 960 }
wheel_gap = 0.3
"""
ON = '[[device]]\nname = "{}"\nkind = "{}"\ndriver = "{}"\nport = "{}"\n'
WHEELS = '[[device]]\nname = "wheels"\nkind = "drive"\ndriver = "simulated"\n'


def wrong(folder: Path, text: str) -> list[str]:
    path = Path(robot_file(folder, ""))
    path.write_text(text, encoding="utf-8")
    return [str(dict(each.arguments)["reason"]) for each in check_robot(read_source(str(path)))[1]]


@pytest.mark.parametrize(
    ("text", "reasons"),
    [
        ("", ["the base needs a device of the kind \"drive\""]),
        (WHEELS.replace('"drive"', '"drve"'), [
            "there is no kind \"drve\"; the kinds are range, lidar, drive, imu, battery, joint, hand, camera, "
            "microphone, speaker, button, gauge, light, display",
            "the base needs a device of the kind \"drive\"",
        ]),
        (WHEELS.replace("simulated", "nothing:There"), [
            "the driver \"nothing:There\" can't be loaded: No module named 'nothing'",
        ]),
        (WHEELS + ON.format("a", "range", "serial-board", "/dev/x") + ON.format("b", "joint", "dynamixel", "/dev/x"),
         [
            "the robot has no joint \"b\"", "the port \"/dev/x\" is that of the a, too",
            "the a needs its number on the board, 0 to 255. Write for example: channel = 1",
            "the b: the option 'id' is missing, the number of the servo on its port",
        ]),
        (WHEELS + ON.format("eye", "lidar", "camera", "/dev/video0"), [
            "\"camera\" has no devices of the kind \"lidar\", only camera",
        ]),
        (WHEELS + ON.format("eye", "camera", "camera", ""), [
            "\"port\" must be text in quotes; write port = \"kitchen\"",
        ]),
        (WHEELS + machine(needs='["helper"]') + "\n" + machine(name='"helper"', needs='["machine", "tail"]'), [
            "\"helper\" needs \"tail\", which is no component, device or part",
            "components need each other in a circle: machine → helper → machine",
        ]),
        (WHEELS + machine(name='"wheels"'), ["\"wheels\" is the name of a device, too"]),
        (WHEELS + machine(needs='["voice"]'), ["\"machine\" needs \"voice\", which the robot lacks"]),
        (WHEELS + machine(parameters='{ heat = "hot" }'), ["heat must be a number, not 'hot'"]),
        (WHEELS + machine(**{"class": '"pot"'}), [
            "no package has a component \"pot\"; or write its place, such as \"coffee:Machine\"",
        ]),
        ("[battery]\nidle = -1\n[[joints]]\nname = \"neck\"\n[[device]]\nname = \"x\"\n[[component]]\nclass = 1\n", [
            "\"idle\" must be at least 0, not -1", "joints needs a text \"part\"", "device needs a text \"kind\"",
            "component needs a text \"name\"",
        ]),
    ],
)  # fmt: skip
def test_what_may_be_wrong(tmp_path: Path, text: str, reasons: list[str]) -> None:
    assert wrong(tmp_path, BODY + text) == reasons


def test_a_sound_one(tmp_path: Path) -> None:
    assert wrong(tmp_path, BODY + WHEELS + machine(needs='["wheels", "base"]')) == []


def test_the_command(tmp_path: Path) -> None:
    robot = robot_file(tmp_path, machine(parameters="{ heat = 70 }", needs='["wheels"]') + "\n" + WHEELS)

    def btc(*words: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "btlang", "robot", *words]
        return subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, timeout=60, check=False)

    assert btc("check", "robot.toml").stdout == "No problems found.\n"
    shown = btc("show", robot).stdout
    assert "└─ machine: coffee:Machine 1.0, in a process of its own\n   ├─ needs wheels\n   └─ heat = 70\n" in shown
    assert "devices\n└─ simulated\n   └─ wheels: drive\n" in shown
    (tmp_path / "robot.toml").write_text(BODY + machine(needs='["tail"]'), encoding="utf-8")
    found = btc("check", "robot.toml")
    assert (found.returncode, found.stderr.count("error BT071")) == (2, 2)
    assert "robot.toml:6:1" in found.stderr or "robot.toml:5:1" in found.stderr


def test_a_text_from_elsewhere_runs_no_code(tmp_path: Path) -> None:
    for text in (machine(), WHEELS.replace("simulated", "os:system"), WHEELS.replace("simulated", "serial-board")):
        from btlang.diagnostics.diagnostic import MissionError

        source = Source(BODY.replace('over = "devices"', "") + text, str(tmp_path / "robot.toml"))
        with pytest.raises(MissionError, match="may only be in a robot file on this computer"):
            read_body(source)


def test_a_node_is_no_class() -> None:
    """It was looked for among the installed classes, so it could not be loaded anew."""
    assert class_of(ComponentPart("arm", "/arm", node=RosNode("/arm"))) is None
    assert class_of(ComponentPart("machine", "coffee:Machine")) == "coffee:Machine"
    with pytest.raises(ComponentError, match="no package has a component"):
        class_of(ComponentPart("machine", "coffee"))


def test_order() -> None:
    assert levels({"a": ["b", "c"], "b": ["c"], "c": [], "d": []}) == [["c", "d"], ["b"], ["a"]]
    assert circle({"a": ["b", "c"], "b": ["c"], "c": []}) == []
    assert circle({"a": ["b"], "b": ["c"], "c": ["b"]}) == ["b", "c", "b"]
    assert circle({"a": ["a"]}) == ["a", "a"]
    deep = {str(n): [str(n + 1)] for n in range(20_000)}
    assert circle(deep) == []


@pytest.mark.parametrize(
    ("before", "after", "reason"),
    [
        ("Machine.brew", "Machine.brow", "coffee:Machine has no method brow"),
        ("Machine.brew", "Pot.brew", "the robot has no component of the class coffee:Pot"),
        ("{drink}]\"", "{drink} [now {count}]]\"", "coffee:Machine.brew takes no parameter count"),
        ("brew [[a] {drink}]", "brew", "coffee:Machine.brew has a parameter drink, which is no slot"),
    ],
)  # fmt: skip
def test_words_that_do_not_fit_their_class(tmp_path: Path, before: str, after: str, reason: str) -> None:
    robot = robot_file(tmp_path, machine())
    words = tmp_path / "coffee.toml"
    text = words.read_text(encoding="utf-8")
    text = text.replace(before, after)
    if after == "brew":
        text = "\n".join(line for line in text.splitlines() if not line.startswith("slots"))
    words.write_text(text, encoding="utf-8")
    _, found = check_robot(read_source(robot))
    assert reason in " ".join(each.message for each in found)
    assert {each.span.source.name for each in found} == {str(words)}
