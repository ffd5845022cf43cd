"""The commands as a user types them."""

from __future__ import annotations

import io
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from btlang import cli
from btlang.cli import main
from btlang.cli.verbs import VERBS

REPOSITORY = Path(__file__).parent.parent


class Screen:
    """Runs `btc` in this process and keeps what it printed."""

    def __init__(self, capsys: pytest.CaptureFixture[str]) -> None:
        self._capsys = capsys
        self.out = self.err = ""

    def __call__(self, *arguments: str) -> int:
        code = main(arguments)
        self.out, self.err = self._capsys.readouterr()
        return code


@pytest.fixture
def btc(capsys: pytest.CaptureFixture[str]) -> Screen:
    return Screen(capsys)


def test_run_tells_each_command(btc: Screen) -> None:
    assert btc("run", "-c", "move forward then twist right and print hello", "--speed", "max") == 0
    lines = [line.split(maxsplit=1)[1] for line in btc.out.splitlines()[:-1]]
    assert lines == [
        "start  move forward",
        "done   move forward",
        "start  turn right",
        'prints "hello"',
        "done   print hello",
        "done   turn right",
    ]
    assert btc.out.splitlines()[-1].startswith("The mission succeeded in ")


def test_run_tells_what_failed(btc: Screen) -> None:
    assert btc("run", "-c", "wave then check battery is low", "--speed", "max") == 1
    assert btc.err.splitlines()[1:] == [
        "<command line>:1:17: battery is low",
        "  wave then check battery is low",
        "                  ^^^^^^^^^^^^^^".replace("  ", "", 1).rjust(32),
        "  BatteryLow: it is not true",
    ]


def test_the_log_ends_with_what_failed(btc: Screen, tmp_path: Path) -> None:
    log = tmp_path / "log.jsonl"
    command = ["run", "-c", "wave then check battery is below 20%", "--speed", "max", "--quiet", "--log", str(log)]
    assert btc(*command) == 1
    end = json.loads(log.read_text(encoding="utf-8").splitlines()[-1])
    assert end.pop("t") >= end.pop("seconds") > 1
    assert end.pop("number") > 10
    assert end.pop("wall") > 1.7e9
    assert len(end.pop("run")) == 32
    told = {"path": "/1", "id": "Battery", "reason": "battery is 100%", "place": "<command line>:1:17"}
    assert end == {"event": "end", "outcome": "FAILURE", "stopped": "", "still": True, **told}


def test_exit_codes(btc: Screen) -> None:
    assert btc("run", "-c", "if bumped, wave", "--quiet") == 0
    assert (btc.out, btc.err) == ("", "")
    assert btc("run", "-c", "fail", "--quiet") == 1
    assert btc("run", "-c", "fly", "--quiet") == 2
    assert btc("run", "-c", "repeat turn left", "--for", "3 s", "--speed", "max") == 0
    assert "Stopped after 3.0 s, as asked; the robot stands still." in btc.out


@pytest.mark.parametrize(
    ("text", "noted"),
    [
        ("wait forever", "note: This mission has no end. To end it, press Ctrl-C, or run it with a time limit"),
        ("whenever bumped, nod", "note: This mission only ends if something in it fails. To end it, press Ctrl-C"),
        ("wave 3 times", ""),
    ],
)
def test_an_endless_mission_says_so_as_it_begins(
    text: str, noted: str, btc: Screen, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("btlang.engine.engine.Engine.tick", interrupted)
    assert btc("run", "-c", text, "--speed", "max") == 130
    assert btc.err.startswith(noted)
    assert btc.err.count("note:") == bool(noted)
    assert btc("run", "-c", text, "--speed", "max", "--quiet") == 130
    assert btc.err == ""
    assert btc("run", "-c", text, "--speed", "max", "--for", "3 s") == 130
    assert btc.err == ""


@pytest.mark.parametrize(
    "arguments",
    [
        ["run"],
        ["run", "a.txt", "-c", "wave"],
        ["run", "-c", "wave", "--speed", "0"],
        ["run", "-c", "wave", "--speed", "nan"],
        ["run", "-c", "wave", "--speed", "1e-12"],
        ["run", "-c", "wave", "--rate", "-1"],
        ["run", "-c", "wave", "--rate", "0.1"],
        ["run", "-c", "wave", "--for", "abc"],
        ["run", "-c", "wave", "--for", "2 m"],
        ["run", "-c", "wave", "--parser", "earley"],
    ],
)
def test_wrong_options_exit_with_2(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        main(arguments)
    assert caught.value.code == 2
    lines = capsys.readouterr().err.splitlines()
    assert (lines[0].startswith("btc run: "), lines[1:]) == (True, ["Run 'btc help run' for help."])


@pytest.mark.parametrize(("duration", "seconds"), [("1", "1.0"), ("2s", "2.0"), ("half a minute", "30.0")])
def test_time_limits(btc: Screen, duration: str, seconds: str) -> None:
    assert btc("run", "-c", "wait 2 min", "--for", duration, "--speed", "max") == 0
    assert f"Stopped after {seconds} s" in btc.out


def test_log_has_a_line_for_every_change(btc: Screen, tmp_path: Path) -> None:
    log = tmp_path / "log.jsonl"
    text = 'greet is say "hi there"; greet then move forward 20 cm'
    assert btc("run", "-c", text, "--speed", "max", "--quiet", "--log", str(log)) == 0
    events = [json.loads(line) for line in log.read_text(encoding="utf-8").splitlines()]
    changes = [event for event in events if "event" not in event]
    assert all(event.keys() >= {"t", "path", "id", "name", "ports", "status"} for event in changes)
    leaves = [(e["path"], e["name"], e["ports"], e["status"]) for e in changes if e["id"] in ("Say", "MoveForward")]
    assert leaves == [
        ("/0/0", 'say "hi there"', {"text": "hi there"}, "RUNNING"),
        ("/0/0", 'say "hi there"', {"text": "hi there"}, "SUCCESS"),
        ("/1", "move forward 0.2 m", {"distance": "0.2"}, "RUNNING"),
        ("/1", "move forward 0.2 m", {"distance": "0.2"}, "SUCCESS"),
    ]
    assert any(event.get("event") == "say" for event in events)
    assert (events[-1]["event"], events[-1]["outcome"]) == ("end", "SUCCESS")
    assert [event["t"] for event in events] == sorted(event["t"] for event in events)


def test_check_and_tree_read_files_and_standard_input(
    btc: Screen, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mission = tmp_path / "mission.txt"
    mission.write_text("wave then nod\n", encoding="utf-8")
    assert btc("check", str(mission)) == 0
    assert btc.out == "No problems found.\n"
    assert btc("tree", str(mission), "--plain") == 0
    assert btc.out == "Sequence\n  Wave\n  Nod\n"
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(b"wave and nod")))
    assert btc("tree", "-", "--parser", "lark") == 0
    assert btc.out == "Parallel\n├── Wave: wave\n└── Nod: nod\n"


def test_worlds_bring_their_names(btc: Screen) -> None:
    museum = str(REPOSITORY / "examples" / "worlds" / "museum.toml")
    assert btc("check", "-c", "go to the kitchen", "--world", museum) == 2
    assert "There's no place" in btc.err
    assert btc("check", "-c", "wave", "--world", str(REPOSITORY / "pyproject.toml")) == 2
    assert "BT070" in btc.err
    assert btc("check", "-c", "wave", "--world", "no_such_world.toml") == 2


def test_words(btc: Screen) -> None:
    assert btc("words", "--all") == 0
    assert "  move forward [{distance}] [at {speed}]\n" in btc.out
    assert "motion:" in btc.out
    assert btc("words") == 0
    assert len(btc.out.splitlines()) <= 22
    assert "btc words --all" in btc.out
    assert btc("words", "battery", "low") == 0
    assert btc.out.splitlines()[1].strip() == "battery is low  (condition)"


def test_warnings_do_not_stop_a_run(btc: Screen) -> None:
    assert btc("run", "-c", "wave is print hi; wave", "--speed", "max") == 0
    assert "warning BT018" in btc.err
    assert "Print" not in btc.err


def started(*arguments: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "btlang", *arguments]
    return subprocess.Popen(command, cwd=REPOSITORY, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_run_stops_the_robot_and_exits_with_the_signal(number: signal.Signals, tmp_path: Path) -> None:
    log = tmp_path / "log.jsonl"
    with started("run", "-c", "move forward 3 m", "--log", str(log)) as process:
        while not log.exists() or "RUNNING" not in log.read_text(encoding="utf-8"):
            time.sleep(0.02)
        time.sleep(0.3)
        process.send_signal(number)
        out, err = process.communicate(timeout=20)
    assert process.returncode == 128 + number, err
    assert "the robot stands still" in out
    assert err == ""
    *events, end = [json.loads(line) for line in log.read_text(encoding="utf-8").splitlines()]
    assert "IDLE" in [event.get("status") for event in events]
    assert (end["event"], end["stopped"]) == ("end", "interrupted")


def test_a_closed_pipe_is_no_error() -> None:
    with started("words") as process:
        assert process.stdout is not None
        process.stdout.close()
        assert process.stderr is not None
        assert process.stderr.read() == ""
    assert process.returncode == 0


def test_version() -> None:
    with started("--version") as process:
        assert process.communicate(timeout=20)[0].startswith("btc 0.")


def test_check_loads_nothing_heavy() -> None:
    script = (
        "import sys; from btlang.cli import main; main(['check', '-c', 'go to the lab then wave']);"
        "print(sorted({'lark', 'rich', 'asyncio', 'numpy', 'rclpy', 'rapidfuzz', 'dataclasses'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", script], cwd=REPOSITORY, text=True, capture_output=True, check=True)
    assert done.stdout.splitlines() == ["No problems found.", "[]"]


def test_a_second_check_reads_no_keyword_file(tmp_path: Path) -> None:
    script = (
        "import sys; before = set(sys.modules)\n"
        "from btlang.cli import main; main(['check', '-c', 'go to the lab then wave'])\n"
        "makers = {'tomllib', 'copy', 'shutil', 'btlang.vocabulary.keyword_file', 'btlang.robots.worlds.world_file'}\n"
        "print(sorted(makers & sys.modules.keys() - before))"
    )
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path)}
    for _ in range(2):
        done = subprocess.run(
            [sys.executable, "-c", script], cwd=REPOSITORY, env=environment, text=True, capture_output=True, check=True
        )
    assert done.stdout.splitlines() == ["No problems found.", "[]"]


def test_a_log_that_cannot_be_written_is_told(btc: Screen) -> None:
    assert btc("run", "-c", "wave", "--speed", "max", "--quiet", "--log", "/dev/full") == 2
    assert "BT009" in btc.err


def test_a_log_holds_what_utf_8_does_not(btc: Screen, tmp_path: Path) -> None:
    log = tmp_path / "log.jsonl"
    assert btc("run", "-c", "print '\udcff' then wave", "--speed", "max", "--log", str(log)) == 0
    assert '"Wave"' in log.read_text(encoding="utf-8")


def test_a_time_limit_is_kept_at_any_rate(btc: Screen) -> None:
    assert btc("run", "-c", "move forward 5 m", "--rate", "1", "--for", "1.3", "--speed", "max") == 0
    assert "Stopped after 1.3 s" in btc.out


def test_a_signal_before_the_first_tick_ends_the_run(tmp_path: Path) -> None:
    (tmp_path / "early.py").write_text("import os, signal\nos.kill(os.getpid(), signal.SIGTERM)\ndef hop(): pass\n")
    words = tmp_path / "early.toml"
    words.write_text('[[action]]\nphrase = "hop"\nid = "Hop"\ncall = "early:hop"\n')
    with started("run", "-c", "hop then move forward", "--keywords", str(words)) as process:
        out, err = process.communicate(timeout=20)
    assert (process.returncode, "succeeded" in out) == (128 + signal.SIGTERM, False), err


def test_closed_standard_input() -> None:
    command = f"{sys.executable} -m btlang check - <&-"
    done = subprocess.run(command, shell=True, cwd=REPOSITORY, text=True, capture_output=True, check=False)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr


def test_a_script_that_fails_is_told_with_the_sentence_that_needed_it(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "-c", 'if bumped, set x to 3; say "x is {x}"', "--speed", "max"]) == 1
    errors = capsys.readouterr().err
    assert '<command line>:1:24: say "x is {x}"' in errors
    assert "Script: {x} has no value" in errors


def test_without_a_verb_it_is_the_prompt(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []
    monkeypatch.setattr(cli, "_run_handler", lambda options, _: asked.append(options) or 0)
    assert main([]) == 0
    assert main(["repl"]) == 0
    own = {"report": None, "refuse": None}  # methods of the parser of each verb
    assert [vars(options) | own for options in asked] == [vars(asked[0]) | own] * 2


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no /dev/full")
@pytest.mark.parametrize(("mission", "code", "told"), [("wave", 2, "succeeded"), ("fail", 1, "failed")])
def test_a_log_on_a_full_disk_does_not_hide_how_the_mission_ended(
    mission: str, code: int, told: str, btc: Screen
) -> None:
    assert btc("run", "-c", mission, "--speed", "max", "--log", "/dev/full") == code
    assert f"The mission {told}" in btc.out + btc.err
    assert "error BT009: I can't write /dev/full: no space left on device" in btc.err


def test_certain_corrections_are_written(btc: Screen, tmp_path: Path) -> None:
    """What leaves a choice stays as it is."""
    file = tmp_path / "mission.txt"
    file.write_text("go to the kitchenn and look around\nwav then nod\nif bumped, nod. Wave. Otherwise say hi\n")
    assert btc("check", "--fix", str(file)) == 0
    assert btc.out == f"Corrected {file}: 2 changes.\nNo errors found.\n"
    mended = "go to the kitchen and look around\nwave then nod\nif bumped, nod. Wave. Otherwise say hi\n"
    assert file.read_text() == mended
    assert "BT050" in btc.err
    assert btc("check", "--fix", "-c", "go to the lbby") == 0
    assert btc.out == "go to the lobby\nNo problems found.\n"
    assert btc("check", "--fix", "-c", "frobnicate") == 2
    assert btc.out == "frobnicate\n"
    assert btc("check", "--fix", "--format", "json", "-c", "go to the lbby") == 0
    assert (btc.out.strip(), btc.err) == ("[]", "go to the lobby\n")


def test_notes_are_no_problems(btc: Screen) -> None:
    assert btc("check", "-c", "turn left and move forward") == 0
    assert "note BT174: 'and' means 'then' here" in btc.err
    assert btc.out == "No problems found.\n"
    assert btc("check", "-c", "turn left and move forward  # allow: shared part") == 0
    assert (btc.out, btc.err) == ("No problems found.\n", "")


def test_programs_get_notes_as_notes(btc: Screen, tmp_path: Path) -> None:
    file = tmp_path / "mission.txt"
    file.write_text("turn left and move forward\n")
    assert btc("check", "--format", "json", str(file)) == 0
    assert [each["severity"] for each in json.loads(btc.out)] == ["note"]
    assert btc("check", "--format", "sarif", str(file)) == 0
    assert [each["level"] for each in json.loads(btc.out)["runs"][0]["results"]] == ["note"]
    assert btc("check", "--format", "github", str(file)) == 0
    assert btc.out.startswith("::notice file=")


def test_equal_warnings_are_shown_once(btc: Screen) -> None:
    text = "\n".join(["wave then nod twice", *["nod then wave twice"] * 12])
    assert btc("check", "-c", text) == 0
    assert btc.err.count("BT050:") == 2
    assert "  And 11 more: lines 3, 4, 5, 6, 7, 8, 9, 10, ...\n" in btc.err
    assert btc("check", "--format", "json", "-c", text) == 0
    assert btc.out.count('"BT050"') == 13


def test_help_has_an_example_of_each_act(capsys: pytest.CaptureFixture[str]) -> None:
    for verb in VERBS.values():
        if verb.acts:
            assert main(["help", verb.name]) == 0
            shown = " ".join(capsys.readouterr().out.split())
            for name, act in verb.acts.items():
                about, examples = act.explain(verb.name, name)
                assert f"{about}: {examples}" in shown
                assert examples.startswith(f"btc {verb.name} {name}"), examples
