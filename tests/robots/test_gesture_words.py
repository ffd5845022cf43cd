"""Gestures as words of missions for the robot that has them."""

from __future__ import annotations

from pathlib import Path

import pytest

from btlang import MissionError, parse_tree
from btlang.cli import main
from btlang.components.words import robot_words
from btlang.robots import registry
from btlang.robots.bodies.body import Body
from tests.robots.motion.bodies import GUIDE
from tests.robots.test_gesture_file import NOD, POINT, robot_file


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Nobody writes into its folder, so that its words are made once."""
    return robot_file(
        tmp_path_factory.mktemp("robot"),
        'gestures = ["gestures"]',
        bow='phrase = ["bow", "take [a] bow"]\n' + NOD,
        show='phrase = ["beckon [to] {target}", "point at {target}"]\nmirror = "nearer"\n' + POINT,
        wave='phrase = ["wave", "wave to the crowd"]\nhelp = "Waves."\n'
        + NOD.replace("head tilt", "right elbow").replace("-", ""),
        twirl='phrase = "twirl the arms"\n[[frame]]\nat = 0.5\n"left arm turn" = 20\n"right arm turn" = 20\n',
    )


def printed(arguments: list[str], capsys: pytest.CaptureFixture[str], code: int = 0) -> str:
    assert main(arguments) == code
    found = capsys.readouterr()
    return found.out + found.err


def test_a_gesture_is_a_word_of_its_robot(robot: str, capsys: pytest.CaptureFixture[str]) -> None:
    lines = printed(["run", "--speed", "max", "--robot", robot, "-c", "twirl your arms then take a bow"], capsys)
    assert "gestures twirl" in lines
    assert "gestures bow" in lines
    assert "The mission succeeded" in lines


def test_it_is_aimed_at_what_is_named(robot: str, capsys: pytest.CaptureFixture[str]) -> None:
    said = "turn to the cup then beckon to the cup then point at (100, 100), otherwise say sorry"
    lines = printed(["run", "--speed", "max", "--robot", robot, "-c", said], capsys)
    assert "gestures show" in lines
    assert "sorry" not in lines


def test_it_takes_over_a_word_with_its_phrase(robot: str, capsys: pytest.CaptureFixture[str]) -> None:
    tree = parse_tree("wave at Alice; wave; point at the cup; nod", keywords=robot_words(robot))
    assert [node.id for node in tree.tree.walk()][1:] == ["Wave", "Wave", "PointAtObject", "Nod"]
    lines = printed(["run", "--speed", "max", "--robot", robot, "-c", "wave to the crowd then nod"], capsys)
    assert "gestures wave" in lines
    assert "gestures nod" not in lines  # this robot has no file for it: its posture does


def test_in_another_language_it_is_called_as_it_is(robot: str, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["run", "--speed", "max", "--language", "es", "--robot", robot, "-c", "twirl the arms y luego bow"]
    assert "gestures twirl" in printed(arguments, capsys)


def test_it_needs_the_parts_that_it_moves(robot: str) -> None:
    with pytest.raises(MissionError, match=r"both need the right arm at the same time"):
        parse_tree("twirl the arms at the same time as wave", keywords=robot_words(robot))
    parse_tree("bow at the same time as wave", keywords=robot_words(robot))


def test_words_and_check_know_it(robot: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert "twirl" in printed(["words", "--robot", robot, "twirl"], capsys)
    assert "No problems found." in printed(["check", "--robot", robot, "-c", "twirl the arms"], capsys)


def test_a_phrase_that_means_something_else(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    robot = robot_file(tmp_path, 'gestures = ["gestures"]', halt='phrase = "stop"\n' + NOD)
    lines = printed(["robot", "check", robot], capsys, 2)
    assert (
        'halt.toml:1:1: error BT076: This gesture can\'t be used: "stop" has another meaning already; choose another'
        in lines
    )


def test_a_phrase_that_clashes_is_named_by_its_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = 'help = "Shows it."\nphrase = [\n  "exhibit {target}",\n  "show {target}",\n]\n' + POINT
    robot = robot_file(tmp_path, 'gestures = ["gestures"]', show=text)
    for arguments in (["robot", "check", robot], ["check", "--robot", robot, "-c", "stop"]) * 2:
        lines = printed(arguments, capsys, 2)
        assert (
            'show.toml:4:1: error BT076: This gesture can\'t be used: "show {target}" and "print {text}" can' in lines
        )
        assert "/words/" not in lines


def test_robots_without_gestures_have_no_more_words() -> None:
    assert robot_words("simulated") == []
    assert "gestures" in robot_words(str(GUIDE))[-1]


def test_one_command_reads_the_robot_once(
    robot: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    read, files = registry.read_body, list[object]()

    def noted(file: object) -> Body:
        files.append(file)
        return read(file)

    monkeypatch.setattr(registry, "read_body", noted)
    for arguments in (["tree", "-c", "bow"], ["gesture", "play", "bow", "--speed", "max"]):
        printed([*arguments, "--robot", robot], capsys)
        assert files == [robot]
        files.clear()
