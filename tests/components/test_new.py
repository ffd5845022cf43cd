"""`btc new`: its projects work as they are, alone and as packages, and names that can't be are refused."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from btlang.cli import main
from btlang.templates.project import KINDS, make_project
from tests.profiles import cases, only_long

ROOT = Path(__file__).parent.parent.parent
NAME = "coffee_machine"
EVERY = pytest.mark.parametrize("kind", KINDS)
SPEED = {"component": ["--speed", "max"], "device": ["--speed", "max", "--simulate"], "robot": ["--speed", "max"]}


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])  # drivers of robot files are imported
    return tmp_path


def python(*words: str, path: object = "", **options: object) -> subprocess.CompletedProcess[str]:
    """Runs it with btlang and what is in another folder."""
    environment = {**os.environ, "PYTHONPATH": f"{ROOT}:{path}", **options.pop("env", {})}  # type: ignore[dict-item]
    return subprocess.run(  # type: ignore[call-overload, no-any-return]
        [sys.executable, *words], env=environment, capture_output=True, text=True, timeout=120, check=False, **options
    )


@EVERY
def test_its_own_tests_pass(kind: str, folder: Path) -> None:
    make_project(kind, NAME)
    done = python("-m", "pytest", "-q", "-p", "no:xdist", "-W", "error", cwd=folder / NAME)
    assert done.returncode == 0, done.stdout
    assert " passed" in done.stdout


WHEEL = (
    '<link name="{0}_wheel"/><joint name="{0}" type="continuous"><parent link="base_link"/><child link="{0}_wheel"/>'
    '<origin xyz="0 {1} 0"/></joint>'
)
BOX = '<collision><geometry><box size="0.3 0.2 0.1"/></geometry></collision>'
URDF = f"""<robot name="cart"><link name="base_link">{BOX}</link>
{WHEEL.format("left", 0.12)}{WHEEL.format("right", -0.12)}</robot>"""
STOPS = {"home": [0.5, 0.5], "tool_shelf": {"x": 2.5, "y": 0.5, "yaw": 1.57}, "vault": [3.5, 0.5], "moon": [40, 40]}


def test_a_robot_of_files_that_a_team_has(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rows = [bytes([0] * 45), *[bytes([0] + [254] * 34 + [0] + [254] * 8 + [0])] * 20, bytes([0] * 45)]
    Path("map.pgm").write_bytes(b"P5 45 22 255\n" + b"".join(rows))
    Path("map.json").write_text('{"image": "map.pgm", "resolution": 0.1, "origin": [-0.5, -0.5, 0]}')
    Path("stops.json").write_text(json.dumps(STOPS))
    Path("cart.urdf").write_text(URDF)
    files = ["--from", "cart.urdf", "--map", "map.json", "--waypoints", "stops.json"]
    assert main(["new", "robot", "cart", *files]) == 0
    told = capsys.readouterr()
    assert "stops.json: 4 way points\n  home: (0.5, 0.5)\n  tool shelf: (2.5, 0.5), facing 89.95 degrees" in told.out
    checks = [line.removeprefix("Check: ") for line in told.err.splitlines()]
    assert checks == [
        "the wheels are 0.24 m apart, by the places of their joints",
        "the speeds and accelerations of the base are guesses",
        'on the map there is no way from the start to the place "vault"',
        'the place "moon" is outside the outer walls',
        'the robot finds no way to the place "vault"',
        'the robot finds no way to the place "moon"',
    ]
    assert all(f"- [ ] {check}" in Path("cart/README.md").read_text() for check in checks)
    assert "go to the home, then go to the tool shelf\n" in Path("cart/patrol.txt").read_text()
    assert main(["run", "cart/patrol.txt", "--robot", "cart/robot.toml", "--speed", "max", "--quiet"]) == 0
    assert main(["test", "cart"]) == 0


@pytest.mark.parametrize("kind", ["component", "device"])
def test_only_robots_are_made_of_files(kind: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["new", kind, "gripper", "--from", "cart.urdf"])
    assert "--from, --map and --waypoints are for a robot" in capsys.readouterr().err
    assert main(["new", "robot", "gripper", "--from", "gone.urdf"]) == 2
    assert not Path("gripper").exists()


def test_a_robot_with_words_as_its_readme_says(folder: Path) -> None:
    make_project("robot", NAME)
    home = folder / NAME
    made = python("-m", "btlang", "new", "component", "nose", cwd=home)
    assert made.returncode == 0, made.stderr
    tables = (home / "nose" / "robot.toml").read_text("utf-8")
    with (home / "robot.toml").open("a", encoding="utf-8") as robot:
        robot.write("\n" + tables[tables.index("[[component]]") :])
    for file in ("nose.py", "nose.toml"):
        (home / "nose" / file).rename(home / file)
    shutil.rmtree(home / "nose")
    (home / "smell.txt").write_text('world "world.toml"\ngo to the shelf, then run the nose\n', "utf-8")
    for words in (["btlang", "robot", "check", "robot.toml"], ["btlang", "test"], ["pytest", "-q", "-W", "error"]):
        done = python("-m", *words, cwd=home)
        assert done.returncode == 0, done.stdout + done.stderr
    assert " passed" in done.stdout


def test_a_robot_file_is_checked_without_missions(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    make_project("robot", NAME)
    path = f"{NAME}/robot.toml"
    assert main(["check", "--robot", path]) == 0
    assert capsys.readouterr().out == (
        f"No problems found in {path}. To check missions for this robot: btc check FILE --robot {path}\n"
    )
    robot = folder / path
    robot.write_text(robot.read_text("utf-8") + '[[device]]\nname = "lamp"\nkind = "lihgt"\ndriver = "simulated"\n')
    assert main(["check", "--robot", path]) == 2
    assert "robot.toml:36:1: error BT071" in capsys.readouterr().err
    for words in ([], ["--robot", "simulated"]):
        with pytest.raises(SystemExit):
            main(["check", *words])
        assert "btc check: it needs a FILE or -c TEXT\n" in capsys.readouterr().err


@cases("kind", [*KINDS], usual=1)
def test_its_own_tests_pass_inside_another_project(kind: str, folder: Path) -> None:
    (folder / "pyproject.toml").write_text('[tool.pytest.ini_options]\naddopts = ["--of-another-project"]\n', "utf-8")
    make_project(kind, NAME)
    done = python("-m", "pytest", "-q", cwd=folder / NAME)
    assert done.returncode == 0, done.stdout + done.stderr


@EVERY
def test_its_robot_is_right_and_runs_its_mission(kind: str, capsys: pytest.CaptureFixture[str]) -> None:
    name = f"coffee_{kind}"  # another module for each in this process
    assert main(["new", kind, name]) == 0
    assert f"{name}/robot.toml" in capsys.readouterr().out
    assert main(["robot", "check", f"{name}/robot.toml"]) == 0
    mission = f"{name}/patrol.txt" if kind == "robot" else f"{name}/mission.txt"
    assert main(["run", mission, "--robot", f"{name}/robot.toml", *SPEED[kind]]) == 0
    assert "The mission succeeded" in capsys.readouterr().out


def test_a_new_driver_drives_in_real_time(capsys: pytest.CaptureFixture[str]) -> None:
    make_project("device", "tea_device")
    words = ["run", "--robot", "tea_device/robot.toml", "-c"]
    assert main([*words, "move forward 0.1 m"]) == 0
    with pytest.raises(SystemExit):
        main([*words, "wait 1 s", "--speed", "max"])
    assert "runs in real time, so it takes no --speed" in capsys.readouterr().err


@EVERY
def test_modules_are_short_and_nothing_of_the_template_is_left(kind: str) -> None:
    for path in map(Path, make_project(kind, NAME)):
        text = path.read_text(encoding="utf-8")
        assert "gadget" not in f"{path}{text}".lower()
        assert path.suffix != ".py" or len(text.splitlines()) < 60


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        *((name, "expected a name of small letters") for name in ("..", "a b", "a/b", "", "Tea", "é", "9a", "a__b")),
        *((name, "expected a name of small letters") for name in ("class", "a" * 41, "a\n", "$(ls)")),
        *((name, "there is a Python module of this name") for name in ("json", "numpy", "btlang", "sys")),
        ("robot", "another file of the project has this name"),
        ("parameter", "the project has another Parameter"),
        ("means", "missions can't say this name"),
        ("full", "the folder is there already, and it isn't empty"),
        ("file", "file exists"),
        ("link", "file exists"),
    ],
)
def test_names_that_cannot_be(name: str, reason: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "full").mkdir()
    (folder / "full" / "work.txt").write_text("wave")
    (folder / "file").write_text("wave")
    (folder / "link").symlink_to("nowhere")
    before = sorted(folder.rglob("*"))
    try:
        code = main(["new", "component", name])
    except SystemExit as ended:
        code = int(ended.code or 0)
    assert code == 2
    assert reason in capsys.readouterr().err
    assert sorted(folder.rglob("*")) == before


@pytest.mark.parametrize("name", ["standard", "small", "simulated", "devices"])
def test_a_robot_has_no_name_of_another(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new", "robot", name]) == 2
    assert "there is a robot of this name" in capsys.readouterr().err


def test_where_nobody_may_write(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir("/proc")  # root may write everywhere else
    assert main(["new", "robot", NAME]) == 2
    assert f"I can't write {NAME}" in capsys.readouterr().err


def test_an_empty_folder_is_used(folder: Path) -> None:
    (folder / NAME).mkdir()
    assert main(["new", "robot", NAME]) == 0
    assert (folder / NAME / "robot.toml").exists()


USES = """
name = "other"
radius = 0.25
screen = true

[[component]]
name = "machine"
class = "tea"
parameters = { speed = 100 }

[[device]]
name = "tea lamp"
kind = "light"
driver = "simulated"

[[device]]
name = "tea lid"
kind = "button"
driver = "simulated"

[[device]]
name = "front"
kind = "range"
driver = "sonar"
port = "loopback"
"""


@pytest.fixture
def installed(folder: Path) -> Path:
    """A folder with all three projects, built and unpacked as pip does it."""
    place = folder / "site"
    for kind, name in (("component", "tea"), ("device", "sonar"), ("robot", "buggy")):
        make_project(kind, name)
        done = python("-m", "hatchling", "build", "-t", "wheel", "-d", str(folder / "wheels"), cwd=folder / name)
        assert done.returncode == 0, done.stderr
    for wheel in (folder / "wheels").iterdir():
        zipfile.ZipFile(wheel).extractall(place)
    return place


def test_packages_work_elsewhere(installed: Path, folder: Path) -> None:
    elsewhere = folder / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / "robot.toml").write_text(USES)
    check = python("-m", "btlang", "robot", "check", "robot.toml", path=installed, cwd=elsewhere)
    assert (check.returncode, check.stdout) == (0, "No problems found.\n"), check.stderr
    words = ("-m", "btlang", "run", "--speed", "max", "--robot")
    done = python(*words, "robot.toml", "-c", "run the tea", path=installed, cwd=elsewhere)
    assert done.returncode == 0, done.stderr
    done = python(*words, "buggy", "-c", "go to the shelf", path=installed, cwd=elsewhere)
    assert done.returncode == 0, done.stderr
    missing = python(*words, "rovr", "-c", "wave", path=installed, cwd=elsewhere)
    assert missing.returncode == 2
    assert "or a robot file, not 'rovr'" in missing.stderr


@pytest.fixture
def short() -> Iterator[str]:
    """A folder whose path is short enough for that of a socket."""
    with tempfile.TemporaryDirectory() as made:
        yield made


def test_an_installed_robot_is_brought_up(installed: Path, short: str) -> None:
    bring_up(sys.executable, f"{ROOT}:{installed}", short)


def bring_up(interpreter: str, path: str, folder: str) -> None:
    """Brings the robot "buggy" up, gives it work in its own world, and takes it down."""
    environment = {**os.environ, "PYTHONPATH": path, "XDG_RUNTIME_DIR": folder, "XDG_DATA_HOME": folder}
    btc = [interpreter, "-m", "btlang"]
    up = subprocess.Popen(
        [*btc, "robot", "up", "--robot", "buggy", "--speed", "max"],
        cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
    )  # fmt: skip
    try:
        assert up.stdout is not None
        assert "is up" in up.stdout.readline()
        done = subprocess.run(
            [*btc, "task", "add", "-c", "go to the shelf"], cwd=folder, env=environment, capture_output=True, text=True
        )
        assert done.returncode == 0, done.stderr
    finally:
        up.send_signal(signal.SIGTERM)
        printed, _ = up.communicate(timeout=30)
    assert (up.returncode, "is down" in printed) == (0, True), printed


@only_long
def test_a_fresh_environment(folder: Path, short: str) -> None:
    """pip builds and installs the robot where btlang and what it needs are seen, as on another computer."""
    make_project("robot", "buggy")
    done = python(
        "-m", "pip", "wheel", "-q", "--no-deps", "--no-build-isolation", "-w", "wheels", "./buggy", cwd=folder
    )
    assert done.returncode == 0, done.stderr
    fresh = folder / "fresh"
    assert python("-m", "venv", str(fresh)).returncode == 0
    interpreter = str(fresh / "bin" / "python")
    [wheel] = (folder / "wheels").iterdir()
    subprocess.run([interpreter, "-m", "pip", "install", "-q", "--no-deps", str(wheel)], check=True, timeout=120)
    seen = next(path for path in sys.path if path.endswith("site-packages"))
    bring_up(interpreter, f"{ROOT}:{seen}", short)
