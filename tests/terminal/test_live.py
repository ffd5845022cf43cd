"""The live view of `btc run` as a user sees it in a terminal."""

from __future__ import annotations

import os
import re
import shlex
import signal
import subprocess
import sys
import termios
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import matches_golden

from .emulator import BTC, REPOSITORY, Terminal

GOLDEN = Path(__file__).parent / "golden"
FOREVER = "repeat (turn left then turn right)"
DRIVE = "move forward 9 m at 0.5 m/s"

Open = Callable[..., Terminal]


def run(terminal: Open, *options: str, **window: object) -> Terminal:
    """`btc run` in a terminal of its own."""
    return terminal(*BTC, "run", *options, **window)


def test_a_paused_run_ends_when_its_terminal_is_gone() -> None:
    master, slave = os.openpty()
    termios.tcsetwinsize(slave, (24, 80))
    environment = {**os.environ, "TERM": "xterm", "PYTHONPATH": str(REPOSITORY)}
    process = subprocess.Popen([*BTC, "run", "-c", DRIVE], stdin=slave, stdout=slave, stderr=slave, env=environment)
    os.close(slave)
    seen = b""
    while b"running" not in seen:
        seen += os.read(master, 65536)
    os.write(master, b" ")
    while b"paused" not in seen:
        seen += os.read(master, 65536)
    os.close(master)
    assert process.wait(timeout=20) == 130


def same_each_time(screen: str) -> str:
    """The screen with letters in place of what differs from run to run."""
    screen = re.sub(r"\d+\.\d s\b", "T s", screen)
    screen = re.sub(r"x -?[\d.]+ m  y -?[\d.]+ m  heading -?\d+°", "x X m  y Y m  heading H°", screen)
    screen = re.sub(r"^ +\d+\.\d\d  ", "   T  ", screen, flags=re.MULTILINE)
    return re.sub(r"ticks \d+( · overruns \d+)?", "ticks N", screen)


def robot(screen: str) -> str:
    """The line of the robot."""
    return next(line for line in screen.splitlines() if line.startswith("robot "))


def clock(screen: str) -> str:
    """The line with the time of the mission."""
    return next(line for line in screen.splitlines() if line.startswith("<command line>"))


def ticks(screen: str) -> int:
    return int(re.findall(r"^ticks (\d+)", screen, flags=re.MULTILINE)[-1])


def at_rest(seen: Terminal) -> str:
    """The screen, once it has not changed for two seconds: a busy machine may draw nothing for one."""
    before, screen = "", seen.screen()
    while screen != before:
        time.sleep(2.0)
        before, screen = screen, seen.screen()
    return screen


@pytest.fixture
def big(tmp_path: Path) -> str:
    """A mission of 500 nodes."""
    tasks = [f"task {chr(97 + i // 26)}{chr(97 + i % 26)}" for i in range(62)]
    text = [f"{task} is nod, wave, look left, look right, then look ahead" for task in tasks]
    text += ["repeat:", *[f"    {task}" for task in tasks]]
    path = tmp_path / "big.txt"
    path.write_text("\n".join(text) + "\n", encoding="utf-8")
    return str(path)


def test_it_shows_the_tree_the_robot_and_the_keys(terminal: Open) -> None:
    seen = run(terminal, "-c", f'say "On my way." then (drive then wave); drive is {DRIVE}')
    seen.wait_for("▶ move forward")
    seen.wait_until(lambda screen: "1." in clock(screen))
    seen.press("m")
    seen.press("Space")
    seen.wait_for("‖ move forward")
    screen = seen.wait_until(lambda screen: "kitchen" not in screen)
    matches_golden(same_each_time(screen), GOLDEN / "paused.txt")


@pytest.mark.parametrize("width", [80, 110])
def test_it_shows_the_map_below_the_tree_or_beside_it(terminal: Open, width: int) -> None:
    seen = run(terminal, "-c", "go to the hall then wait 20 s", width=width)
    screen = seen.wait_until(lambda screen: re.search("[→↗↑↖←↙↓↘]", screen) is not None, "the robot on the map")
    lines = screen.splitlines()
    at = next(index for index, line in enumerate(lines) if "▶ go to hall" in line)
    dock = next(index for index, line in enumerate(lines) if "dock" in line)
    assert dock > at + 5
    assert any("kitchen" in line and "living room" not in line for line in lines)
    assert ("⡤" in lines[at - 1] or "⡇" in lines[at]) == (width > 90)
    seen.press("m")
    seen.wait_until(lambda screen: "⠤" not in screen)
    seen.press("m")
    seen.wait_until(lambda screen: "⠤" in screen)


def test_space_pauses_and_resumes(terminal: Open) -> None:
    seen = run(terminal, "-c", DRIVE)
    seen.wait_until(lambda screen: "· 1." in screen, "the second second")
    seen.press("Space")
    seen.wait_for("‖ move forward")
    still = at_rest(seen)
    assert "space resume" in still
    time.sleep(1.0)
    assert seen.screen() == still
    seen.press("Space")
    later = seen.wait_until(lambda screen: "running" in screen and ticks(screen) > ticks(still) + 10)
    assert robot(later) != robot(still)


def test_a_question_mark_shows_the_legend(terminal: Open) -> None:
    seen = run(terminal, "-c", DRIVE)
    seen.wait_for("? legend")
    seen.press("?")
    seen.wait_for("✗ failed")
    seen.press("?")
    seen.wait_until(lambda screen: "✗ failed" not in screen)


def test_s_makes_single_steps(terminal: Open) -> None:
    seen = run(terminal, "-c", DRIVE)
    seen.wait_for("▶ move forward")
    seen.press("s")
    paused = ticks(seen.wait_for("paused"))
    seen.press("s")
    seen.wait_until(lambda screen: ticks(screen) > paused)
    first = ticks(at_rest(seen))  # on a busy machine the ticks of these steps may still be to come
    for step in range(1, 4):
        seen.press("s")
        seen.wait_until(lambda screen, wanted=first + step: ticks(screen) == wanted, "one more tick")
    assert ticks(at_rest(seen)) == first + 3


def test_other_keys_do_nothing(terminal: Open) -> None:
    seen = run(terminal, "-c", DRIVE)
    seen.wait_for("▶ move forward")
    seen.press("Up", "F4", "x", "M-s", "M-q", "Enter")
    before = ticks(seen.screen())
    screen = seen.wait_until(lambda screen: ticks(screen) > before + 10)
    assert "running" in screen
    assert "x" not in screen.splitlines()[-1]


@pytest.mark.parametrize("key", ["q", "Q", "C-c"])
def test_the_run_can_be_stopped(terminal: Open, key: str) -> None:
    seen = run(terminal, "-c", f"nod then {FOREVER}")
    seen.wait_for("▶ turn")
    seen.press(key)
    assert seen.wait_for_end() == 130
    screen = seen.screen()
    assert "■ turn" in screen
    assert "the robot stands still." in screen
    assert "space pause" not in screen
    assert seen.cursor_shown


@pytest.mark.parametrize("end", ["C-c", "q", "failure", "exception", "terminated"])
def test_the_terminal_is_as_it_was(terminal: Open, end: str, tmp_path: Path) -> None:
    (tmp_path / "crash.py").write_text("import sys\ndef crash():\n    yield\n    sys.exit('crashed')\n")
    (tmp_path / "crash.toml").write_text('[[action]]\nphrase = "crash"\nid = "Crash"\ncall = "crash:crash"\n')
    mission = {"failure": "wait 1 s then fail", "exception": "wait 1 s then crash"}.get(end, FOREVER)
    btc = shlex.join([*BTC, "run", "-c", mission, "--keywords", "crash.toml"])
    seen = terminal(folder=tmp_path)
    seen.type(f"stty -a > before.txt; sh -c 'echo $$ > pid.txt; exec {btc.replace(chr(39), chr(34))}'")
    seen.wait_for("space pause")
    assert not seen.cursor_shown
    if end == "terminated":
        seen.wait_for("▶ turn left")
        os.kill(int((tmp_path / "pid.txt").read_text()), signal.SIGTERM)
    elif mission == FOREVER:
        seen.wait_for("▶ turn left")
        seen.press(end)
    seen.wait_for({"failure": "AlwaysFailure", "exception": "crashed"}.get(end, "stands still"))
    seen.type("stty -a > after.txt; echo all is we''ll")
    seen.wait_for("all is well")
    assert seen.cursor_shown
    assert (tmp_path / "after.txt").read_text() == (tmp_path / "before.txt").read_text()


def test_a_stopped_process_gives_the_terminal_back(terminal: Open) -> None:
    seen = terminal("bash", "--norc", "--noprofile", environment={"PS1": "> "})
    seen.type(shlex.join([*BTC, "run", "-c", FOREVER]))
    seen.wait_for("▶ turn left")
    seen.press("C-z")
    seen.wait_for("Stopped")
    assert seen.cursor_shown
    seen.type("clear; echo still he''re")
    seen.wait_for("still here")
    seen.type("bg; clear; echo behi''nd")
    seen.wait_for("behind")
    assert "ticks" not in seen.screen()
    seen.type("clear; fg")
    seen.wait_for("running")
    seen.press("Space")  # read as a key again
    seen.wait_for("paused")
    seen.press("q")
    seen.wait_for("stands still")


def test_500_nodes_fit(terminal: Open, big: str) -> None:
    seen = run(terminal, big, "--speed", "20")
    seen.wait_for("▶ task ae", 60)
    seen.press("m")
    seen.press("Space")
    screen = seen.wait_for("‖")
    lines = screen.splitlines()
    assert len(lines) <= 24
    assert any(line.startswith("big.txt · ") for line in lines)
    assert re.search(r"✓ task \w\w  [\d.]+ s  \(6 nodes\)", screen)
    assert re.search(r"‖ (nod|wave|look left|look right|look ahead)  ", screen)
    assert re.search(r"└── … \d\d to come", screen)
    assert lines[-1] == "space resume · s step · q stop · e emergency stop · m map · ? legend"


def test_a_narrow_terminal_and_another_size(terminal: Open, big: str) -> None:
    seen = run(terminal, big, width=34, height=12)
    screen = seen.wait_for("▶ nod")
    assert max(map(len, screen.splitlines())) <= 33
    seen.resize(90, 20)
    seen.wait_until(lambda screen: len(screen.splitlines()) > 14 and "heading" in screen and "battery" in screen)
    seen.resize(20, 6)
    seen.wait_until(lambda screen: "▶" in screen and len(screen.splitlines()) <= 6)
    seen.resize(80, 24)
    seen.wait_for("q stop")
    seen.press("q")
    assert seen.wait_for_end() == 130


def test_what_happened_stays_and_the_final_tree(terminal: Open) -> None:
    text = 'say hello, then wave and print "one line", then try to check bumped, otherwise look left'
    seen = run(terminal, "-c", text, "--speed", "4")
    assert seen.wait_for_end() == 0
    matches_golden(same_each_time(seen.history()), GOLDEN / "finished.txt")


def test_a_failure(terminal: Open) -> None:
    seen = run(terminal, "-c", "wait 1 s then close the left hand")
    assert seen.wait_for_end() == 1
    matches_golden(same_each_time(seen.history()), GOLDEN / "failed.txt")


def test_what_python_prints_comes_above(terminal: Open, tmp_path: Path) -> None:
    (tmp_path / "talk.py").write_text(
        "import sys\n"
        "def talk():\n"
        "    print('to the output\\nin two lines')\n"
        "    print('to the errors', file=sys.stderr)\n"
        "    print('x' * 79 + '|')\n"
        "    print('y' * 159 + '|')\n"
        "    print('with no end', end='')\n"
    )
    (tmp_path / "talk.toml").write_text('[[action]]\nphrase = "talk"\nid = "Talk"\ncall = "talk:talk"\n')
    seen = run(terminal, "-c", "wait 1 s then talk then wait 1 s", "--keywords", str(tmp_path / "talk.toml"))
    assert seen.wait_for_end() == 0
    matches_golden(same_each_time(seen.history()), GOLDEN / "printed.txt")


def test_no_colours_where_none_are_wanted(terminal: Open) -> None:
    seen = run(terminal, "-c", DRIVE, environment={"NO_COLOR": "1"})
    seen.wait_for("▶ move forward")
    assert "cyan" not in seen.colours()
    coloured = run(terminal, "-c", DRIVE)
    coloured.wait_for("▶ move forward")
    assert "cyan" in coloured.colours()


@pytest.mark.parametrize(
    ("options", "window"),
    [
        (["--lines"], {}),
        ([], {"environment": {"TERM": "dumb"}}),
        ([], {"height": 8}),
        ([], {"width": 24}),
        (["|", "cat"], {}),
    ],
)
def test_plain_lines(terminal: Open, options: list[str], window: dict[str, object]) -> None:
    seen = terminal("sh", "-c", f"{shlex.join(BTC)} run -c 'wave and nod' --speed max {' '.join(options)}", **window)
    assert seen.wait_for_end() == 0
    assert [line.split(maxsplit=1)[-1] for line in seen.history().splitlines()[:4]] == [
        "start  wave",
        "start  nod",
        "done   nod",
        "done   wave",
    ]
    assert "ticks" not in seen.history()


def test_quiet_is_silent(terminal: Open) -> None:
    seen = run(terminal, "-c", "wave", "--speed", "max", "--quiet")
    assert seen.wait_for_end() == 0
    assert seen.history() == "[status 0]\n"


def test_a_mission_from_standard_input_has_no_keys(terminal: Open) -> None:
    seen = terminal("sh", "-c", f"echo '{DRIVE}' | {shlex.join(BTC)} run -")
    seen.wait_for("Ctrl-C stop")
    seen.press("C-c")
    assert seen.wait_for_end() == 130


def test_rich_is_imported_only_for_the_view() -> None:
    program = (
        "import sys; from btlang.cli import main; main(['run', '-c', 'wave', '--speed', 'max']);"
        "print(sorted({'rich', 'prompt_toolkit'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", program], cwd=REPOSITORY, text=True, capture_output=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"


@pytest.mark.parametrize("key", ["e", "C-\\"])
def test_an_emergency_stop(terminal: Open, key: str) -> None:
    seen = run(terminal, "-c", DRIVE)
    seen.wait_for("▶ move forward")
    seen.press(key)
    assert seen.wait_for_end() == 131
    assert "Emergency stop after" in seen.screen()
