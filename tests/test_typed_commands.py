"""The command line as people type it: without a verb, with a mistyped one, asking for help."""

from __future__ import annotations

import re
import shlex
from importlib import import_module
from pathlib import Path

import pytest

from btlang import __version__
from btlang.cli import main
from btlang.cli.parser import parse_arguments
from btlang.cli.verbs import VERBS
from btlang.task.commands import client
from btlang.vocabulary.shipped import shipped

RUN = ["--speed", "max", "--lines"]


@pytest.fixture(autouse=True)
def in_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("tea.txt").write_text("wave\n", encoding="utf-8")


def typed(*arguments: str) -> int | str | None:
    try:
        return main(arguments)
    except SystemExit as end:
        return end.code


@pytest.mark.parametrize("mission", ["wave", "wave then wait 1 s", "wave.", "-c wave", "tea.txt", "./tea.txt"])
def test_a_mission_runs_without_a_verb(mission: str, capsys: pytest.CaptureFixture[str]) -> None:
    words = mission.split(maxsplit=1) if mission.startswith("-") else [mission]
    assert typed(*words, *RUN) == 0
    assert "done   wave" in capsys.readouterr().out


def test_a_file_wins_over_a_mission_of_the_same_words(capsys: pytest.CaptureFixture[str]) -> None:
    Path("wave then nod").write_text("say hi\n", encoding="utf-8")
    assert typed("wave then nod", *RUN) == 0
    assert 'says   "hi"' in capsys.readouterr().out


@pytest.mark.parametrize(
    ("line", "error"),
    [
        ("rnu tea.txt", "btc: there's no verb or file 'rnu'\nDid you mean: btc run tea.txt\n"),
        ("chekc", "btc: there's no verb or file 'chekc'\nDid you mean: btc check\n"),
        ("go to the lab", "btc: there's no verb or file 'go'\nPut a mission in quotes: btc \"go to the lab\"\n"),
        ('say "hi"', "btc: there's no verb or file 'say'\nPut a mission in quotes: btc 'say \"hi\"'\n"),
        ("add wave", "btc: there's no verb or file 'add'\nDid you mean: btc task add wave\n"),
        ("hello", "btc: there's no verb or file 'hello'\nDid you mean: btc run hello\n"),
        ("patrol --watch", "btc: there's no verb or file 'patrol'\nDid you mean: btc run patrol --watch\n"),
        ("list", "btc: there's no verb or file 'list'\n"
         "Did you mean: btc robot list, btc task list, btc components list or btc user list\n"),
        ("worlds", "btc: there's no verb or file 'worlds'\nDid you mean: btc world\n"),
        ("missions", "btc: there's no verb or file 'missions'\nDid you mean: btc examples\n"),
        ("simulate tea.txt", "btc: there's no verb or file 'simulate'\nDid you mean: btc run tea.txt\n"),
        ("start", "btc: there's no verb or file 'start'\nDid you mean: btc robot up\n"),
        ("start robot", "btc: there's no verb or file 'start'\nDid you mean: btc robot up\n"),
        ("task watch 1", "btc task: there's no act 'watch'\nDid you mean: btc watch\n"),
        ("robot rules", "btc robot: there's no act 'rules'\nDid you mean: btc robot status\n"),
        ("gesture", "btc gesture: say what to do: play, check, picture, record\nRun 'btc help gesture' for help.\n"),
        ("fly x", "btc: there's no verb or file 'fly'\nRun 'btc help' for help.\n"),
        ("--world x.toml", "btc: unexpected option '--world'\nA verb comes first: btc VERB --world x.toml\n"),
        ("help rnu", "btc: there's no verb 'rnu'\nDid you mean: btc help run\n"
         "Words of missions: btc words rnu\n"),
        ("help wave", "btc: there's no verb 'wave'\nWords of missions: btc words wave\n"),
        ("run --sped max -c wave", "btc run: there's no option '--sped'\nDid you mean: --speed\n"),
        ("run --verbose tea.txt", "btc run: there's no option '--verbose'\nRun 'btc help run' for help.\n"),
        ("tea.txt --xyz", "btc run: there's no option '--xyz'\nRun 'btc help run' for help.\n"),
        ("robot stpo", "btc robot: there's no act 'stpo'\nDid you mean: btc robot stop\n"),
        ("robot halt", "btc robot: there's no act 'halt'\nDid you mean: btc robot stop\n"),
        ("robot cancel 3", "btc robot: there's no act 'cancel'\nDid you mean: btc task cancel\n"),
        ("task pause 3", "btc task: there's no act 'pause'\nDid you mean: btc task interrupt\n"),
        ("task lst --json", "btc task: there's no act 'lst'\nDid you mean: btc task list\n"),
        ("task xyzzy", "btc task: there's no act 'xyzzy'\nRun 'btc help task' for help.\n"),
        ("estop", "btc: there's no verb or file 'estop'\nTo stop the robot that is up: btc robot stop\n"),
        ("emergency stop", "btc: there's no verb or file 'emergency stop'\n"
         "To stop the robot that is up: btc robot stop\n"),
        ("tree tea.txt wave", "btc tree: unexpected argument 'wave'\nRun 'btc help tree' for help.\n"),
    ],
)  # fmt: skip
def test_a_usage_error_is_a_line_and_a_hint(line: str, error: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert typed(*line.split()) == 2
    assert capsys.readouterr().err == error


@pytest.mark.parametrize("line", [["stop"], ["halt!"], ["stop now"], ["stop", "now"], ["stop", "--speed", "max"]])
def test_stop_alone_is_refused_while_a_robot_is_up(
    line: list[str], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    if line == ["stop"]:
        assert typed("stop", *RUN) == 0
        capsys.readouterr()
    monkeypatch.setattr(client, "names_up", lambda: ["museum"])
    assert typed(*line) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert "stops a simulation, not the robot that is up\nTo stop the robot that is up: btc robot stop\n" in err
    assert typed("go to the lab, then stop", *RUN) == 0


def test_release_is_refused_while_a_robot_is_up(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(client, "names_up", lambda: ["museum"])
    assert typed("release") == 2
    assert capsys.readouterr().err == (
        "btc: 'release' as a mission opens the gripper in a simulation\n"
        "To let the robot that is up move again: btc robot release\n"
    )


@pytest.mark.parametrize("words", [["round", "every", "day", "at", "17:30"], ["every day at 17:30", "round"]])
def test_a_rule_among_the_words_of_a_schedule_is_shown_in_its_option(
    words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert typed("task", "schedule", *words) == 2
    assert 'btc task schedule "round" --every "every day at 17:30"' in capsys.readouterr().err


def test_names_that_are_nearly_those_of_examples(capsys: pytest.CaptureFixture[str]) -> None:
    for name, said in (("gretter", "Examples with a similar name: greeter\n"),
                       ("rover", "To copy it: btc examples --copy FOLDER rover\n")):  # fmt: skip
        assert typed("run", name) == 2
        assert said in capsys.readouterr().err


def test_house_rules_that_do_not_hold_are_said(capsys: pytest.CaptureFixture[str]) -> None:
    robot = shipped("examples", "rover", "robot.toml")
    assert typed("wave", "--robot", robot, *RUN) == 0
    assert "note: the house rules of this robot hold with btc robot up, and not in btc run\n" in capsys.readouterr().err


def test_no_word_stands_for_two_acts_or_verbs() -> None:
    for verb in VERBS.values():
        words = [*verb.acts, *(word for act in verb.acts.values() for word in act.also)]
        assert len(words) == len(set(words))
    words = [*VERBS, *(word for verb in VERBS.values() for word in verb.also)]
    assert len(words) == len(set(words))


def test_a_word_that_is_neither_is_read_as_a_mission(capsys: pytest.CaptureFixture[str]) -> None:
    assert typed("fly") == 2
    assert "<command line>:1:1: error BT010: I don't know the command 'fly'." in capsys.readouterr().err
    assert typed("tee.txt") == 2
    assert "error BT001: I can't read tee.txt" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("line", "hint"),
    [
        (["run", "go to the moon"], 'To give a mission as text: btc run -c "go to the moon"'),
        (["run", "wave"], 'To give a mission as text: btc run -c "wave"'),
        (["tree", 'say "$5"'], """To give a mission as text: btc tree -c 'say "$5"'"""),
    ],
)
def test_a_missing_file_that_reads_as_a_mission(line: list[str], hint: str, capsys: pytest.CaptureFixture[str]) -> None:
    """It doesn't run: a file name that is mistyped never moves a robot."""
    assert typed(*line) == 2
    assert capsys.readouterr().err.splitlines()[1:] == [f"  {hint}"]


def test_a_missing_file_that_is_no_mission(capsys: pytest.CaptureFixture[str]) -> None:
    assert typed("run", "nowhere") == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


@pytest.mark.parametrize("line", [["help"], ["-h"], ["--help"]])
def test_help_lists_the_verbs(line: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert not typed(*line)
    out = capsys.readouterr().out
    assert [verb for verb in VERBS if f"\n  {verb}" not in out] == []


@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_has_its_handler(verb: str) -> None:
    module, _, function = VERBS[verb].handler.partition(":")
    assert callable(getattr(import_module(module), function))


def test_help_on_a_verb_is_that_of_the_verb(capsys: pytest.CaptureFixture[str]) -> None:
    helps = []
    for line in (["help", "run"], ["run", "--help"], ["tea.txt", "-h"]):
        assert not typed(*line)
        helps.append(capsys.readouterr().out)
    assert helps[0].startswith("usage: btc run ")
    assert helps == [helps[0]] * 3


@pytest.mark.parametrize("word", ["version", "--version"])
def test_version(word: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert typed(word) == 0
    assert capsys.readouterr().out == f"btc {__version__}\n"


@pytest.mark.parametrize(
    ("mission", "last"),
    [
        ("go to the ktichen", "For more, run: btc explain BT013"),
        ("go to the ktichen then move forward 2", "For more, run: btc explain CODE, where CODE is BT011 or BT013"),
        ("(wave", "  Add ')' where the group ends, on the same line."),  # the page says no more than this
    ],
)
def test_messages_end_with_where_to_read_more(mission: str, last: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert typed("check", "-c", mission) == 2
    assert capsys.readouterr().err.splitlines()[-1] == last
    typed("check", "-c", mission, "--format", "json")
    assert "For more" not in "".join(capsys.readouterr())


@pytest.mark.parametrize("verb", ["run", "check", "compile --to xml", "tree"])
def test_a_mission_for_the_robot_beside_it(verb: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """One that is right needs none, and one that is chosen isn't named."""
    (tmp_path / "missions").mkdir()
    (tmp_path / "robot.toml").write_text('name = "guide"\nradius = 0.2\n', encoding="utf-8")
    mission = tmp_path / "missions" / "tour.txt"
    mission.write_text("approach the statue\n", encoding="utf-8")
    robot, named = str(tmp_path / "robot.toml"), "If the mission is for the robot in"
    assert typed(*verb.split(), str(mission)) == 2
    assert f"\n{named} {robot}, add: --robot {robot}\n" in capsys.readouterr().err
    assert typed(*verb.split(), str(mission), "--robot", robot) == 2
    assert named not in capsys.readouterr().err
    other = tmp_path / "missions" / "elsewhere" / "tea.txt"
    other.parent.mkdir()
    other.write_text("approach the statue\n", encoding="utf-8")
    assert typed("check", str(mission), str(other)) == 2
    assert named in capsys.readouterr().err
    mission.write_text("say hi\n", encoding="utf-8")
    assert typed("check", str(mission)) == 0
    assert named not in "".join(capsys.readouterr())


def test_explain_asks_for_a_mission_as_text(capsys: pytest.CaptureFixture[str]) -> None:
    assert typed("explain", "wave") == 2
    assert 'To give a mission as text: btc explain -c "wave"' in capsys.readouterr().err


def test_pictures_are_reported(capsys: pytest.CaptureFixture[str]) -> None:
    assert typed("tea.txt", *RUN, "--tree-picture", "tree.svg") == 0
    assert capsys.readouterr().out.endswith("\nWrote tree.svg.\n")
    assert typed("tea.txt", *RUN, "--tree-picture", "tree.svg", "--quiet") == 0
    assert capsys.readouterr().out == ""


def test_a_failed_not_says_what_was_true(capsys: pytest.CaptureFixture[str]) -> None:
    assert typed("check that the battery is not full", *RUN) == 1
    assert capsys.readouterr().err.endswith("\n  BatteryFull: 'battery is full' was true\n")


@pytest.mark.parametrize("verb", [name for name, verb in VERBS.items() if verb.acts])
def test_help_says_what_each_act_does(verb: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert not typed("help", verb)
    out = capsys.readouterr().out
    for name, act in VERBS[verb].acts.items():
        assert f"\n  {name} " in out
        for example in re.findall(r"(?<=btc )[^,]+", act.about):
            options = parse_arguments(shlex.split(example))
            assert (options.verb, options.act) == (verb, name)


@pytest.mark.parametrize("verb", [name for name, verb in VERBS.items() if verb.examples])
def test_examples_of_a_verb_are_commands(verb: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert not typed("help", verb)
    out = capsys.readouterr().out
    for command, about in VERBS[verb].examples:
        assert f"\n  {command}\n      {about}\n" in out
        assert parse_arguments(shlex.split(command)[1:]).verb == verb


@pytest.mark.parametrize(
    "page", sorted(Path(shipped("examples")).resolve().rglob("*.md")), ids=lambda page: page.parent.name
)
def test_commands_of_the_pages_of_examples_are_known(page: Path) -> None:
    shown = re.findall(r"^ {4}btc (.+)$|`btc ([^`]+)`", page.read_text(encoding="utf-8"), re.MULTILINE)
    assert len(shown) > 1
    for line in map("".join, shown):
        assert parse_arguments(shlex.split(line)).verb == line.split()[0]


def test_names_of_another_world_that_ships(capsys: pytest.CaptureFixture[str]) -> None:
    assert typed("check", "-c", "go to the reception, then go to room 1") == 2
    [advice] = [line for line in capsys.readouterr().err.splitlines() if line.startswith("A world that ships")]
    world = shlex.split(advice.partition("--world ")[2])[0]
    assert typed("check", "-c", "go to the reception, then go to room 1", "--world", world) == 0
    capsys.readouterr()
    assert typed("check", "-c", "go to the reception, then fly") == 2
    assert "A world that ships" not in capsys.readouterr().err
    assert typed("check", "-c", "go to the reception", "--world", str(Path(world).with_name("museum.toml"))) == 2
    assert "A world that ships" not in capsys.readouterr().err


def test_worlds_of_an_installed_package_are_found(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    worlds = tmp_path / "btlang" / "_resources" / "examples" / "worlds"
    worlds.parent.mkdir(parents=True)
    worlds.symlink_to(Path(shipped("examples", "worlds")).resolve())
    (tmp_path / "keywords").symlink_to(Path(shipped("keywords")).resolve())
    monkeypatch.setattr("btlang.vocabulary.shipped.PACKAGE", str(tmp_path / "btlang"))
    monkeypatch.setattr("btlang.cli.missions.shipped", shipped.__wrapped__)
    assert typed("check", "-c", "go to the mummy") == 2
    assert f"To use it, add: --world {worlds / 'museum.toml'}\n" in capsys.readouterr().err


def test_the_world_that_ships_is_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert not typed("world")
    assert "places: lobby, hall, kitchen" in capsys.readouterr().out
    Path("w.toml").write_text(
        "start = { x = 0, y = 0 }\n"
        'objects = [{ name = "glass 1", kind = "glass", content = "water", has = ["red lid"], x = 1, y = 1 }]\n',
        encoding="utf-8",
    )
    assert not typed("world", "w.toml")
    assert "objects: glass 1 (glass, of water, with red lid)" in capsys.readouterr().out
