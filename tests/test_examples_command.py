"""`btc examples` lists, prints and copies the missions that ship; what was copied runs where it is."""

from __future__ import annotations

import os
import shlex
from pathlib import Path

import pytest

from btlang.cli import examples, main
from tests.examples.cases import CASES
from tests.profiles import cases

ROOT = Path(__file__).parent.parent
FOLDERS = ["guide", "rover"]


def command(text: str) -> list[str]:
    """The words after `btc` of the command in a mission's comment."""
    [line] = [line for line in text.splitlines() if line.startswith("#   btc ")]
    return shlex.split(line.removeprefix("#   btc "))


def test_every_part_is_included_by_a_mission() -> None:
    parts = {f"parts/{part}.txt" for case in CASES.values() for part in case.parts}
    assert {part for example in examples.examples() for part in example.parts} == parts
    assert {path.relative_to(ROOT / "examples").as_posix() for path in (ROOT / "examples" / "parts").iterdir()} == parts


def test_every_mission_is_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["examples"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines if line.startswith("  ")] == [*sorted(CASES), *FOLDERS]
    [locked] = [line for line in lines if line.startswith("  locked_lab ")]
    assert locked.endswith("The lab is locked for a while, so the robot knocks ...")
    assert max(map(len, lines)) <= 80
    assert not any(line.endswith(":") for line in lines if line.startswith("  "))


def test_worlds_are_those_that_the_missions_run_in() -> None:
    worlds = {example.name: Path(example.world).stem for example in examples.examples()}
    assert worlds == {name: case.world or "" for name, case in CASES.items()}


def test_an_example_runs_by_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["run", "greeter", "--speed", "max", "--lines"]) == 0
    assert 'says   "Here we are."' in capsys.readouterr().out
    assert main(["tree", "hello", "--plain"]) == 0
    (tmp_path / "hello").write_text("nod", encoding="utf-8")
    capsys.readouterr()
    assert main(["tree", "hello", "--plain"]) == 0  # a file of that name comes first
    assert capsys.readouterr().out == "Nod\n"
    assert main(["tree", "helloo", "--plain"]) == 2
    assert "BT001" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["hello", "hello.txt"])
def test_a_mission_is_printed(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["examples", name]) == 0
    text = (ROOT / "examples" / "hello.txt").read_text(encoding="utf-8")
    assert capsys.readouterr().out == text.replace("btc run examples/hello.txt", "btc run hello.txt")


def test_unknown_names_are_told_all_at_once(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["examples", "helo", "dance", "roming"]) == 2
    shown = capsys.readouterr()
    assert shown.out == ""
    assert shown.err.count("BT008") == 2
    assert "Similar: hello" in shown.err


def test_a_copy_has_all_missions_and_worlds(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "new" / "missions"
    assert main(["examples", "--copy", str(folder)]) == 0
    written = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
    shipped = ROOT / "examples"
    assert written == {path.relative_to(shipped).as_posix() for path in shipped.rglob("*.*") if path.suffix != ".pyc"}
    lines = capsys.readouterr().out.splitlines()
    begin = [f"To begin, read {folder / name / 'README.md'}" for name in FOLDERS]
    assert lines[-3:] == [*begin, f"To run a mission, use the command at its top, in this folder: {folder}"]
    assert set(lines[:-3]) == {str(folder / name) for name in written}


def test_no_help_shows_what_only_programs_understand(capsys: pytest.CaptureFixture[str]) -> None:
    for verb in ("robot", "task", "run", "serve", "examples"):
        assert main(["help", verb]) == 0
        assert " object at " not in capsys.readouterr().out


@cases("name", [*CASES], 6)
def test_the_command_of_a_copy_runs_in_its_folder(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["examples", "--copy", ".", name]) == 0
    case = CASES[name]
    needed = {f"worlds/{case.world}.toml"} if case.world else {f"parts/{part}.txt" for part in case.parts}
    needed |= {f"tests/{path.name}" for path in (ROOT / "examples" / "tests").glob(f"{name}.test.txt")}
    assert {p.relative_to(tmp_path).as_posix() for p in tmp_path.rglob("*.*")} == {f"{name}.txt"} | needed
    words = command((tmp_path / f"{name}.txt").read_text(encoding="utf-8"))
    assert words[:2] == ["run", f"{name}.txt"]
    assert main([*words, "--speed", "max", "--quiet"]) == case.code, capsys.readouterr().err


def test_nothing_is_overwritten(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "hello.txt").write_text("wave", encoding="utf-8")
    (tmp_path / "roaming.txt").symlink_to("nowhere")
    assert main(["examples", "--copy", str(tmp_path), "dance", "hello", "roaming"]) == 2
    shown = capsys.readouterr().err
    assert [line.split(": ")[1] for line in shown.splitlines() if "BT009" in line] == ["error BT009"] * 2
    assert str(tmp_path / "hello.txt") in shown
    assert str(tmp_path / "roaming.txt") in shown
    assert "Traceback" not in shown
    assert sorted(os.listdir(tmp_path)) == ["hello.txt", "roaming.txt"]
    assert (tmp_path / "hello.txt").read_text(encoding="utf-8") == "wave"


def test_missions_that_share_a_world_are_copied_one_by_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["examples", "--copy", str(tmp_path), "roaming"]) == 0
    assert main(["examples", "--copy", str(tmp_path), "careful_walk"]) == 0
    world = tmp_path / "worlds" / "walled_room.toml"
    world.write_text(world.read_text(encoding="utf-8") + "# mine\n", encoding="utf-8")
    assert main(["examples", "--copy", str(tmp_path), "look_before_you_go"]) == 2
    assert str(world) in capsys.readouterr().err
    assert world.read_text(encoding="utf-8").endswith("# mine\n")
    assert not (tmp_path / "look_before_you_go.txt").exists()


def test_a_folder_that_cannot_be_made(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "file"
    file.write_text("")
    assert main(["examples", "--copy", str(file / "below"), "hello"]) == 2
    shown = capsys.readouterr().err
    assert "BT009" in shown
    assert "Traceback" not in shown
