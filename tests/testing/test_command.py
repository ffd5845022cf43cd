"""`btc test` as a user types it: what it finds, what it prints, what it leaves behind."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

from btlang.cli import main
from tests.profiles import amount

PASSES = 'test "it waves":\n  run:\n    wave then nod\n  finally the mission succeeds\n'
FAILS = 'test "it nods <&> \\ more":\n  run:\n    wave\n  within 1 s it has said hello\n'
ROUNDS = 'test "by chance":\n  run:\n    go to a random place\n  finally it has never reached the lab\n'


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_files_are_found_below_a_folder(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("a.test.txt", "b/c.test.txt", ".hidden/d.test.txt", "b/e.txt", "node_modules/f.test.txt"):
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(PASSES)
    assert main(["test"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines == [
        "ok      a.test.txt:1: it waves (5.3 s)", "ok      b/c.test.txt:1: it waves (5.3 s)",
        "2 tests passed (10.6 s of mission time)",
    ]  # fmt: skip


def test_failures_are_shown_and_recorded(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "a.test.txt").write_text(PASSES + FAILS)
    assert main(["test", "--quiet", "--junit", "results.xml"]) == 1
    lines = capsys.readouterr().out.splitlines()
    recording = "test-recordings/a-it-nods-more-0.mcap"
    assert lines == [
        "FAILED  a.test.txt:5: it nods <&> \\ more", "  a.test.txt:8: within 1 s it has said hello",
        "    after 1.0 s: it is not true", "    the mission was at: wave", f"  recorded in {recording}",
        "1 of 2 tests failed (6.3 s of mission time)",
    ]  # fmt: skip
    assert main(["why", recording]) == 0
    assert "wave" in capsys.readouterr().out
    [suite] = ElementTree.parse("results.xml").getroot()
    assert (suite.get("name"), suite.get("tests"), suite.get("failures")) == ("a.test.txt", "2", "1")
    passed, failed = suite
    assert (passed.get("name"), len(passed)) == ("it waves", 0)
    assert (failed.get("name"), failed.get("line")) == ("it nods <&> \\ more", "5")
    assert "it has said hello" in str(failed[0].text)


def test_the_smallest_seed_that_fails(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "a.test.txt").write_text(ROUNDS)
    assert main(["test", "--repeat", "30"]) == 1
    line = capsys.readouterr().out.splitlines()[1]
    assert " of 30 failed; the first: btc test --seed " in line
    seed, file = line.split()[-2:]
    assert file == "a.test.txt"
    assert main(["test", "--repeat", seed]) == 0 if int(seed) else seed == "0"
    assert main(["test", "--seed", seed]) == 1


def test_in_processes_as_in_this_one(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for number in range(3):
        (folder / f"{number}.test.txt").write_text(PASSES + FAILS)
    assert main(["test", "--jobs", "1"]) == 1
    alone = capsys.readouterr().out
    assert main(["test", "--jobs", "2"]) == 1
    assert capsys.readouterr().out == alone


def test_coverage(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "m.txt").write_text("if the battery is low, wave, otherwise nod\n")
    (folder / "a.test.txt").write_text(
        'test "full":\n  run "m.txt"\n  finally it has done "nod"\n'
        'test "low":\n  with the battery at 5%\n  run "m.txt"\n  "wave" fails\n  finally the mission fails\n'
    )
    assert main(["test", "--coverage", "--name", "full"]) == 0
    assert capsys.readouterr().out.splitlines()[2:-1] == [
        "m.txt: 3 of 4 nodes ran, 3 of 8 outcomes happened", "IfThenElse   <- never failed",
        "├── battery is low   <- never succeeded", "├── wave   <- never ran", "└── nod   <- never failed",
    ]  # fmt: skip
    assert main(["test", "--coverage"]) == 0
    assert "m.txt: 4 of 4 nodes ran, 6 of 8 outcomes happened" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "code", "told"),
    [
        (["nothing.test.txt"], 2, "BT001"),
        (["empty"], 2, "BT184"),
        (["--name", "juggles"], 2, "BT184"),
        (["m.txt"], 2, "BT184"),
        (["--junit", "no/such/folder.xml"], 2, "BT009"),
    ],
)
def test_what_cannot_be_tested(
    folder: Path, words: list[str], code: int, told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "empty").mkdir()
    (folder / "m.txt").write_text("wave")
    (folder / "a.test.txt").write_text(PASSES)
    assert main(["test", *words]) == code
    assert told in capsys.readouterr().err


def test_a_file_that_cannot_be_read_keeps_no_other_from_running(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "a.test.txt").write_text(PASSES)
    (folder / "b.test.txt").write_text("wave")
    assert main(["test"]) == 2
    out, err = capsys.readouterr()
    assert "1 test passed" in out
    assert "b.test.txt:1:1: error BT180" in err


def test_a_mission_stands_for_its_tests(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for place in (folder, folder / "tests"):
        place.mkdir(exist_ok=True)
        (folder / "m.txt").write_text("wave")
        (place / "m.test.txt").write_text(PASSES)
        assert main(["test", "m.txt"]) == 0
        (place / "m.test.txt").unlink()
    assert main(["test", "first_steps"]) == 0
    assert capsys.readouterr().out.count("1 test passed") == 3


@pytest.mark.parametrize("option", ["--repeat=0", "--jobs=-1", "--seed=x", "--jobs=no"])
def test_options_are_checked(folder: Path, option: str) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["test", option])
    assert ended.value.code == 2


def test_words_without_code_can_be_faked(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A mission whose words have no Python yet, and one whose Python can't be loaded, which fails its test."""
    (folder / "w.toml").write_text('[[action]]\nphrase = "juggle [{number} balls]"\nid = "Juggle"\n')
    (folder / "m.txt").write_text('words "w.toml"\njuggle 3 balls then wave')
    begin = 'test "a":\n  run "m.txt"\n'
    (folder / "a.test.txt").write_text(f'{begin}  "juggle" takes 3 s\n  finally the mission succeeds\n')
    assert main(["test"]) == 0, capsys.readouterr().err
    (folder / "a.test.txt").write_text(f"{begin}  finally the mission succeeds\n")
    assert main(["test"]) == 1
    assert "has no call" in capsys.readouterr().out


def test_other_verbs(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "a.test.txt").write_text(PASSES.replace("  ", "     "))
    assert main(["check", "a.test.txt"]) == 0
    assert main(["format", "--check", "a.test.txt"]) == 1
    assert main(["format", "a.test.txt"]) == 0
    assert (folder / "a.test.txt").read_text() == PASSES
    assert main(["tree", "a.test.txt"]) == 2
    assert "To run them: btc test a.test.txt" in capsys.readouterr().err


def test_check_mends_tests_too(folder: Path) -> None:
    (folder / "a.test.txt").write_text(PASSES.replace("nod", "nodd"))
    assert main(["check", "--fix", "a.test.txt"]) == 0
    assert (folder / "a.test.txt").read_text() == PASSES


def test_pytest_collects_them(folder: Path) -> None:
    (folder / "a.test.txt").write_text(PASSES + FAILS)
    (folder / "b.test.txt").write_text("nonsense")
    words = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:xdist"]
    words.append("--continue-on-collection-errors")
    done = subprocess.run(words, capture_output=True, text=True, check=False, cwd=folder)
    assert "1 failed, 1 passed, 1 error" in done.stdout
    assert "BT180" in done.stdout
    assert "after 1.0 s: it is not true" in done.stdout
    assert "Traceback" not in done.stdout


@pytest.mark.long
def test_many_tests_of_five_minutes(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "m.txt").write_text("repeat forever: go to the lobby then go to the lab and look around\n")
    count = amount(5, 100)
    (folder / "a.test.txt").write_text(
        "\n".join(
            f'test "{number}":\n  run "m.txt" for 5 minutes\n  within 2 minutes it has reached the lab\n'
            "  always the battery is above 10%\n  finally it has never bumped\n"
            for number in range(count)
        )
    )
    assert main(["test", "--quiet"]) == 0
    assert capsys.readouterr().out == f"{count} tests passed ({5 * count} min 0.0 s of mission time)\n"


@pytest.mark.parametrize("start", ["project", "project/tests", "elsewhere", "."])
@pytest.mark.parametrize("is_absolute", [False, True])
def test_a_test_runs_from_any_folder(
    tmp_path: Path, start: str, is_absolute: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    tests = tmp_path / "project" / "tests"
    tests.mkdir(parents=True)
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "project" / "hello.txt").write_text("wave then nod")
    (tests / "hello.test.txt").write_text('test "it waves":\n  run "../hello.txt"\n  finally the mission succeeds\n')
    (tests / "out.test.txt").write_text('test "out":\n  run "../../other.txt"\n  finally the mission succeeds\n')
    (tmp_path / "other.txt").write_text("wave")
    monkeypatch.chdir(tmp_path / start)
    for name, code in (("hello", 0), ("out", 0 if start == "." else 2)):
        file = tests / f"{name}.test.txt"
        assert main(["test", str(file) if is_absolute else os.path.relpath(file)]) == code, capsys.readouterr().err
