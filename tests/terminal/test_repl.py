"""The REPL as its user sees it, in a real terminal."""

from __future__ import annotations

import os
import re
import signal
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import matches_golden, without_overruns
from tests.terminal.emulator import BTC, Terminal
from tests.test_readme import BLOCKS

GOLDEN = Path(__file__).parent / "golden"
Open = Callable[..., Terminal]


@pytest.fixture
def repl(terminal: Open, tmp_path: Path) -> Callable[..., Terminal]:
    """Opens the REPL; all those of a test share history and sessions."""

    def opened(*options: str, **how: int) -> Terminal:
        environment = {"XDG_STATE_HOME": str(tmp_path / "state")}
        started = terminal(*BTC, "repl", *options, folder=tmp_path, environment=environment, **{"height": 40, **how})
        started.wait_for("robot at")
        return started

    return opened


def shown(screen: str) -> str:
    """What must be the same in each run: without times and the places that a moving robot has come to."""
    screen = without_overruns(screen.rpartition("Ctrl-D twice leaves.\n")[2])  # below what it begins with
    screen = re.sub(r" · overruns \d+", "", screen)
    screen = re.sub(r"-?\d+\.\d+( s| m)?|(?<=ticks )\d+|(?<=facing |eading )-?\d+", "N", screen)
    return re.sub(r" {2,}(?=N)", " ", screen)


def golden(user: Terminal, text: str, name: str) -> None:
    """The screen once the text is on it, all of it is drawn, and nothing changes any more."""
    matches_golden(shown(prompted(user, text)), GOLDEN / f"repl_{name}.txt")


def prompted(user: Terminal, text: str) -> str:
    """Waits until the text is on the screen and the prompt reads keys again: what is typed earlier is echoed there."""
    user.wait_for(text)
    before = [""]

    def is_still(screen: str) -> bool:
        last, before[0] = before[0], screen
        return screen == last and "robot at " in screen.rstrip().splitlines()[-1]

    return user.wait_until(is_still)


def process(folder: Path) -> int:
    """The number of the one process that a session file is of."""
    (session,) = (folder / "state" / "btlang" / "sessions").glob("*.json")
    return int(session.stem.rpartition("-")[2])


def test_it_begins_with_the_map_and_three_things_to_try(repl: Callable[..., Terminal], tmp_path: Path) -> None:
    matches_golden(repl().screen(), GOLDEN / "repl_beginning.txt")
    (tmp_path / "empty.toml").write_text("[start]\nx = 0\ny = 0\n")
    screen = repl("--world", "empty.toml", height=12).screen()  # without names, and without room for a map
    assert "Try: wave" in screen
    assert "\N{RIGHTWARDS ARROW}" not in screen


def test_what_is_typed_behind_a_wrong_line_takes_its_place(repl: Callable[..., Terminal]) -> None:
    user = repl()
    user.type("hello")
    user.wait_for("Not run.")
    user.type("help")
    user.wait_for("A line of the mission runs at once")
    assert "hellohelp" not in user.history()


def test_a_session_from_the_first_mistake_to_the_history(repl: Callable[..., Terminal], tmp_path: Path) -> None:
    user = repl()
    user.type("patrol is go to the lobby then go to the ktich", enter=False)
    golden(user, "Similar: kitchen", "1_mistake")
    user.press("Tab")
    user.type(" then wav", enter=False)
    golden(user, "wave right arm", "2_completion")
    user.press("Tab")
    golden(user, "Wave: wave", "3_completed")
    user.press("Enter", "Enter")
    golden(user, "Defined: patrol", "4_defined")

    user.type("patrl", enter=False)
    golden(user, "Ctrl-F writes: patrol", "5_correction")
    user.press("C-f")
    user.wait_for("SubTree ID=patrol")
    user.press("Enter")
    user.wait_for("start  go to lobby")
    user.press("C-c")
    golden(user, "stands still", "6_interrupted")

    user.type("undo")
    golden(user, "- patrol", "7_undone")
    user.type("save mission.txt")
    prompted(user, "Saved 1 line to mission.txt.")
    assert (tmp_path / "mission.txt").read_text() == "patrol is go to the lobby then go to the kitchen then wave\n"
    user.press("C-d", "C-d")
    assert user.wait_for_end() == 0

    again = repl()
    assert "restore" not in again.screen()  # all was saved
    again.press("Up", "Up", "Up")
    golden(again, "> patrol", "8_history")
    again.press("C-c")
    again.type("load mission.txt")
    prompted(again, "Loaded 1 line")
    again.type("show")
    golden(again, "> show", "9_loaded")


def test_a_killed_session_is_offered_again(repl: Callable[..., Terminal], tmp_path: Path) -> None:
    user = repl()
    user.type("bow is nod")
    user.wait_for("Defined: bow")
    user.type("bow then wa", enter=False)
    user.wait_for("wait")
    os.kill(process(tmp_path), signal.SIGKILL)
    user.wait_for("[status 137]")
    again = repl()
    again.wait_for("'restore' brings it back")
    again.type("restore")
    golden(again, "> bow then wa", "restored")
    again.press("C-c")
    again.type("show")
    prompted(again, "> show\nbow is nod")
    again.press("C-d", "C-d")
    again.wait_for("This session is saved")
    assert again.wait_for_end() == 0


def test_the_word_that_leaves_is_no_line_of_the_session(repl: Callable[..., Terminal]) -> None:
    user = repl("--speed", "max")
    user.type("nod")
    user.wait_for("The mission succeeded")
    user.type("quit")
    assert user.wait_for_end() == 0
    again = repl()
    again.wait_for("The last session had 1 line: 'restore' brings it back")
    again.type("restore")
    again.wait_for("Back: 1 line")
    again.type("show")
    again.wait_for("> show\nnod")


def test_a_choice_between_two_readings(repl: Callable[..., Terminal]) -> None:
    user = repl()
    user.type("nod then wave 3 times within 1 min")
    screen = user.wait_for("Two readings. 1 writes: nod, then wave 3 times within 1 min")
    assert "2 writes: ((nod" in screen
    user.press("1")
    user.wait_for("> nod, then wave 3 times within 1 min")
    user.press("Enter")
    user.wait_for("The mission succeeded")


def test_ctrl_c_stops_the_robot_and_not_the_repl(repl: Callable[..., Terminal]) -> None:
    user = repl()
    user.type("turn left forever")
    user.wait_for("start  turn left")
    user.press("C-c")
    user.wait_for("Interrupted after")
    user.type("world")
    user.wait_for("places")
    user.press("C-c")
    user.wait_for("Ctrl-D twice leaves")
    user.type("say still here")
    user.wait_for("quotes")
    user.press("C-c", "C-d")
    user.wait_for("Press Ctrl-D again to leave")
    user.type("nod", enter=False)  # anything else is no second Ctrl-D
    user.wait_for("Nod: nod")
    user.press("C-c", "C-d", "C-d")
    assert user.wait_for_end() == 0


@pytest.mark.parametrize(("number", "status"), [(signal.SIGTERM, 143), (signal.SIGHUP, 129)])
@pytest.mark.parametrize("is_running", [True, False])
def test_signals_halt_the_robot_and_leave(
    repl: Callable[..., Terminal], tmp_path: Path, number: int, status: int, is_running: bool
) -> None:
    user = repl()
    if is_running:
        user.type("turn left forever")
        user.wait_for("start  turn left")
    else:
        user.type("turn left", enter=False)
        user.wait_for("TurnLeft")
    os.kill(process(tmp_path), number)
    assert user.wait_for_end() == status
    assert "Traceback" not in user.history()
    assert ("halted turn left" in user.history()) == is_running
    assert repl().wait_for("'restore' brings it back")


def test_blocks_take_several_lines(repl: Callable[..., Terminal]) -> None:
    user = repl("--speed", "max")
    user.type("try:")
    user.type("check the battery is low")
    user.press("BSpace")
    user.type("otherwise:")
    user.type("nod")
    golden(user, "Fallback", "block")
    user.press("Enter")
    user.wait_for("succeeded")
    user.press("Up")
    user.wait_until(lambda screen: screen.count("otherwise:") == 2)


def test_what_cannot_run_stays_in_the_line(repl: Callable[..., Terminal]) -> None:
    user = repl()
    user.type("wave nod")
    matches_golden(shown(user.wait_for("Not run: there's a mistake. Ctrl-F writes: then")), GOLDEN / "repl_refused.txt")
    user.press("C-f")
    user.wait_for("> wave then nod")


def test_what_is_typed_ahead_stands_in_the_next_line(repl: Callable[..., Terminal]) -> None:
    user = repl()
    user.type("move forward 1 m")
    user.wait_for("start  move forward 1 m")
    user.type("say sq", enter=False)  # neither pauses, nor steps, nor stops
    user.wait_for("succeeded")
    user.wait_for("> say sq")


def test_space_pauses_and_resumes(repl: Callable[..., Terminal]) -> None:
    user = repl()
    user.type("move forward 2 m")
    user.wait_for("space pause \N{MIDDLE DOT} Ctrl-C stop")
    user.press("Space")
    user.wait_for("paused")
    user.wait_for("space resume \N{MIDDLE DOT} s step \N{MIDDLE DOT} q stop")
    user.press("x", "Space")  # while it is paused, nothing is typed ahead
    user.wait_for("running")
    user.press("Space")
    user.wait_for("paused")
    user.press("q")
    user.wait_for("Interrupted after")
    prompted(user, ">")
    assert "x" not in user.screen().splitlines()[-2]


def test_a_whole_line_can_be_typed_ahead(repl: Callable[..., Terminal]) -> None:
    user = repl()
    user.type("move forward")
    user.wait_for("start  move forward")
    user.type("say hello")
    user.wait_for('says   "hello"')


@pytest.mark.parametrize(
    ("line", "why"),
    [
        ("go to the ktichen", "Not run: there's a mistake. Ctrl-F writes: kitchen"),
        ("hepl", "Not run. Did you mean: help"),
        ("wor", "I don't know the command 'wor'"),
        ("go to the", "After 'go to' I expected a place"),
    ],
)
def test_enter_says_why_a_line_does_not_run(repl: Callable[..., Terminal], line: str, why: str) -> None:
    user = repl()
    user.type(line, enter=False)
    user.press("Enter")
    user.wait_for(why)
    assert user.screen().count(f"> {line}") == 1


def test_a_line_of_which_nothing_was_understood_gives_way_to_the_next(repl: Callable[..., Terminal]) -> None:
    user = repl()
    user.type("hello")
    user.wait_for("Not run")
    user.type("show")
    user.wait_until(lambda screen: "helloshow" not in screen and "> show" in screen)
    user.type("frobnicate")
    user.wait_for("Type something else, or press an arrow key")
    user.press("Left")
    user.type("x", enter=False)
    user.wait_for("> frobnicatxe")


@pytest.mark.parametrize("word", ["exit", "bye", ":quit"])
def test_words_that_leave(repl: Callable[..., Terminal], word: str) -> None:
    user = repl()
    user.type(word)
    assert user.wait_for_end() == 0


def test_clear_leaves_an_empty_screen(repl: Callable[..., Terminal]) -> None:
    user = repl()
    user.type("bow is nod")
    prompted(user, "Defined: bow")
    user.type("clear")
    user.wait_until(lambda screen: "Defined" not in screen)
    user.type("show")
    prompted(user, "> show\nbow is nod")


def test_beginnings_that_are_nothing(repl: Callable[..., Terminal]) -> None:
    user = repl()
    user.type("# a comment", enter=False)
    user.press("C-c")
    prompted(user, ">")
    user.type("bow is nod")
    prompted(user, "Defined: bow")
    for text in (" wave", "repeat 2 times: please", 'say"hello" there', "please"):
        user.type(text, enter=False)
        user.press("C-c")
        prompted(user, ">")
    user.type("# a comment")
    prompted(user, "> # a comment")
    user.type("  nod")
    user.wait_for("succeeded")
    assert "exception" not in user.history().lower()
    assert "Traceback" not in user.history()


def test_a_narrow_terminal(repl: Callable[..., Terminal]) -> None:
    user = repl(width=40, height=12)
    user.type("repeat go to the lab, then wave and say hello, then go to the lobby 3 times then nod", enter=False)
    user.wait_for("Nods the head")  # the menu may come after the tree
    golden(user, "more lines", "narrow")


def test_without_a_terminal_lines_are_read(tmp_path: Path) -> None:
    lines = "bow is nod\nspeed max\nrepeat 2 times:\n  bow\nsay done\nflarp\nshow\nquit\nwave\n"
    done = subprocess.run([*BTC], input=lines, capture_output=True, text=True, cwd=tmp_path, check=False, env={
        **os.environ, "PYTHONPATH": str(Path(__file__).parents[2]), "XDG_STATE_HOME": str(tmp_path),
    })  # fmt: skip
    assert done.returncode == 2
    assert "I don't know the command 'flarp'" in done.stderr
    assert done.stdout.endswith("bow is nod\nrepeat 2 times:\n  bow\nsay done\n")
    assert done.stdout.count("start  nod") == 2
    assert list(tmp_path.iterdir()) == []  # nothing is kept


def test_a_folder_that_cannot_be_written_to(terminal: Open, tmp_path: Path) -> None:
    (tmp_path / "state").write_text("a file, and no folder")
    user = terminal(*BTC, folder=tmp_path, environment={"XDG_STATE_HOME": str(tmp_path / "state")})
    user.wait_for("What you type isn't saved")
    user.type("nod")
    user.wait_for("succeeded")


SCREENS = [block.text for block in BLOCKS if block.language == "screen"]


@pytest.mark.parametrize("screen", SCREENS, ids=lambda screen: screen.partition("\n")[0])
def test_the_screens_of_the_tutorial(repl: Callable[..., Terminal], screen: str) -> None:
    user = repl()
    prompt, *lines = screen.splitlines()
    user.type(prompt.removeprefix("> "), enter=False)
    user.wait_until(lambda seen: all(line in seen.splitlines() for line in lines), screen)
