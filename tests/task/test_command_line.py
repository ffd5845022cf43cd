"""What `btc task` and `btc robot` say to a robot that is up, in one process with it."""

from __future__ import annotations

import json
import re
import stat
import tempfile
from datetime import datetime
from pathlib import Path
from typing import Any

import pytest

from btlang.task.layer import TaskLayer
from btlang.task.store.records import TaskState

from .layers import Btc, ask, refusal, submit, task, wait_for, wait_until


def data(btc: Btc, *words: str) -> dict[str, Any]:
    """What an answer has for programs."""
    code, text = btc(*words, "--json")
    assert code == 0, text
    return dict(json.loads(text)["data"])


def test_a_long_list_says_what_it_leaves_out(robot: TaskLayer, btc: Btc) -> None:
    for _ in range(103):
        submit(robot, "wave")
    ask(robot, "cancel", task=1)
    lines = btc("task", "list")[1].splitlines()
    assert (len(lines), lines[-1]) == (101, "and 2 more: --limit N lists so many, --all every one")
    assert data(btc, "task", "list")["more"] == 2
    assert len(btc("task", "list", "--limit", "102")[1].splitlines()) == 102
    assert btc("task", "list", "--limit", "3")[1].splitlines()[3:] == [lines[-1].replace("2", "99")]
    assert len(btc("task", "list", "--all")[1].splitlines()) == 103
    assert data(btc, "task", "list", "--all")["more"] == 0


def test_a_list_says_which_task_comes_first_also_where_it_is_not_in_it(robot: TaskLayer, btc: Btc) -> None:
    submit(robot, "wave", at="in 20 h", priority=5)
    begun = submit(robot, "wait 10 h", priority=1)
    submit(robot, "nod", labels=["tour"])
    ask(robot, "resume")
    wait_for(robot, begun, TaskState.UNDERWAY)
    assert btc("task", "list", "--label", "tour")[1] == "   3  queued     nod  [task 2 comes first]\n"


def test_a_deleted_mission_says_which_schedules_have_its_text(robot: TaskLayer, btc: Btc) -> None:
    for name in ("tour", "other"):
        btc("task", "put", name, "-c", "wave")
    ask(robot, "schedule", rule="every day at 9:00", name="tour")
    ask(robot, "schedule", rule="every day at 9:00", name="tour", text="nod")  # the name of a file
    gone = "is no longer in the library."
    one = f"'tour' {gone} Schedule 1 goes on with its text. To end it: btc task unschedule\n"
    assert btc("task", "delete", "tour") == (0, one)
    assert btc("task", "delete", "other") == (0, f"'other' {gone}\n")
    btc("task", "put", "tour", "-c", "wave")
    ask(robot, "schedule", rule="every day at 9:00", name="tour")
    assert data(btc, "task", "delete", "tour") == {"schedules": [1, 3]}


GARDEN = 'start = { x = 1, y = 1 }\nplaces = [{ name = "shed", x = 1, y = 2 }]\n'


def test_worlds_and_robot_files(robot: TaskLayer, btc: Btc, tmp_path: Path) -> None:
    garden, cart = tmp_path / "garden.toml", tmp_path / "cart.toml"
    garden.write_bytes(b"\xef\xbb\xbf" + GARDEN.encode())
    cart.write_text('name = "cart"\nradius = 0.25\n')
    kept = "'q' is in the library, revision 1.\n"
    assert btc("task", "put", "q", str(garden), "--kind", "world") == (0, kept)
    assert btc("task", "put", "q", str(cart), "--kind", "robot") == (0, kept)
    assert btc("task", "put", "q", "-c", "wave") == (0, kept)
    for kind, text in (("world", GARDEN), ("robot", cart.read_text()), ("mission", "wave")):
        [listed] = data(btc, "task", "library", "--kind", kind)[f"{kind}s"]
        assert (listed["name"], listed["text"]) == ("q", text)
        assert btc("task", "library", "q", "--kind", kind)[1].startswith("q, revision 1: ")
    assert btc("task", "delete", "q", "--kind", "world") == (0, "'q' is no longer in the library.\n")
    assert btc("task", "library", "--kind", "world") == (0, "The library has no worlds.\n")
    assert "The world 'q' isn't in the library" in btc("task", "delete", "q", "--kind", "world")[1]
    assert (
        "'kind' must be one of 'mission', 'world', 'robot', 'test', not 'pack'"
        in btc("task", "library", "--kind", "pack")[1]
    )
    assert "--kind doesn't apply to it" in btc("task", "list", "--kind", "world")[1]
    garden.write_bytes(b"\xff\xfe")
    assert "BT002" in btc("task", "put", "q", str(garden), "--kind", "world")[1]


def test_a_robot_comes_up_with_what_its_library_has(
    robot: TaskLayer, btc: Btc, monkeypatch: pytest.MonkeyPatch
) -> None:
    store = robot.store.place
    for kind, text in (("world", GARDEN), ("robot", 'name = "cart"\nradius = 0.25\n')):
        ask(robot, "put", name="q", kind=kind, text="# old\n" + text)
        ask(robot, "put", name="q", kind=kind, text=text)
    up = ("robot", "up", "--name", "other", "--store", store)
    for kind, called in (("world", "world"), ("robot", "robot file")):
        code, text = btc(*up, f"--{kind}", "library:nosuch")
        assert code == 2
        assert text.startswith(f"btc: error BT187: The {called} 'nosuch' isn't in the library.\n")
        assert f"\n  To put it there: btc task put nosuch FILE --kind {kind}\n" in text
    made: list[tuple[Any, Any]] = []

    def layer(robot: Any, reader: Any, **_: Any) -> None:
        made.append((robot, reader.world))
        raise KeyboardInterrupt

    monkeypatch.setattr("btlang.cli.robot.make_robot_layer", layer)
    named = ("--robot", "library:q", "--world", "library:q")
    btc(*up, *named)
    [(connect, world)] = made
    assert (connect.body.name, connect.over, world.text) == ("cart", "simulated", GARDEN)
    assert " ".join(named) in btc("robot", "unit", *named)[1]


def test_a_report_begins_in_the_past(robot: TaskLayer, btc: Btc) -> None:
    ask(robot, "resume")
    number = submit(robot, "wave", at="in 20 h")
    wait_until(lambda: robot.now() > task(robot, number).created)
    for since in ("0:00", "yesterday at 9:00", "2 hours ago"):
        code, text = btc("robot", "report", "--since", since)
        assert code == 0
        assert "0 of 1 done, 1 not over yet" in text
    code, text = btc("robot", "report", "--since", "tomorrow at 9:00")
    assert code == 1
    assert "yesterday at 9:00" in text
    assert "would begin at" in refusal(robot, "report", since=4e9)
    assert "would begin at" in refusal(robot, "report", since="1 hour ago", until="2 hours ago")


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        ("task add -c wave --zone UTC", "'add' can't be read: --zone doesn't apply to it"),
        ("task add -c wave --overlap skip", "--overlap doesn't apply to it"),
        ("task schedule -c wave --every daily --at 9:00", "--at doesn't apply to it"),
        ("task show 1 2", "'2' is more than it takes"),
        ("task cancel 4 5", "'5' is more than it takes"),
        ("task unschedule 8 9", "'9' is more than it takes"),
        ("task list 1", "'1' is more than it takes"),
        ("task put a b c", "'c' is more than it takes"),
        ("task add tour.txt -c wave", "it takes -c TEXT or 'tour.txt', but not both"),
        ("task put tour tour.txt -c wave", "it takes -c TEXT or 'tour.txt', but not both"),
        ("task move 1 --priority 2 --before 3", "it takes --priority or --before, but not both"),
        ("task list --live --json", "it takes --live or --json, but not both"),
        ("task list --label a --label b", "it takes one --label"),
        ("task list --label=", "--label needs a text"),
        ("task add -c wave --label=", "--label needs a text"),
        ("task add -c wave --set cups", "'add' can't be read: --set needs NAME=VALUE, not 'cups'"),
        ("task add -c wave --restart never", "'restart' must be one of 'give up', 'again', 'resume', not 'never'"),
        (
            "task schedule -c wave --every hourly --overlap no",
            "'schedule' can't be read: 'overlap' must be one of 'skip'",
        ),
        ("task schedule -c wave --every hourly --priority 101", "'schedule' can't be read: 'priority' must be from"),
        ("task add -c wave --set cups=1", "The mission has no value 'cups'"),
        ("task show ../x", "'../x' isn't the number of a task"),
        ("task unschedule x", "'x' isn't the number of a schedule"),
        ("task --name ../x list", "--name: expected up to 32 letters, digits, '-' and '_', not '../x'"),
        ("task", "say what to do: "),
        ("robot", "say what to do: "),
        ("robot status --speed max", "--speed doesn't apply to it"),
        ("robot status now", "'now' is more than it takes"),
        ("robot unit --json", "--json doesn't apply to it"),
        ("robot up --reason x", "--reason doesn't apply to it"),
        ("robot backup a b", "'b' is more than it takes"),
        ("robot say", "it needs a text"),
    ],
)
def test_what_does_not_apply_is_refused(words: str, reason: str, robot: TaskLayer, btc: Btc) -> None:
    code, text = btc(*words.split())
    assert code in (1, 2)
    assert reason in text
    assert robot.store.tasks() == []


@pytest.mark.parametrize("words", ["stop now --speed max --json", "stop"])
def test_nothing_that_is_typed_keeps_the_robot_from_stopping(words: str, robot: TaskLayer, btc: Btc) -> None:
    assert btc("robot", *words.split())[0] == 0
    assert robot.emergency.is_latched


def test_options_may_stand_anywhere(robot: TaskLayer, btc: Btc) -> None:
    number = str(submit(robot, "wave"))
    for words in (["show", "--name", "robot", number], ["--name", "robot", "show", number], ["show", number, "--json"]):
        assert btc("task", *words)[0] == 0
    said = list[str]()
    robot.session.robot.say = said.append
    assert btc("robot", "say", "--json", "hi", "there")[0] == 0
    assert btc("robot", "say", "--", "--json") == (0, 'The robot says "--json".\n')
    assert said == ["hi there", "--json"]


def test_an_answer_and_a_visitor(robot: TaskLayer, btc: Btc) -> None:
    assert "The robot isn't asking anything." in btc("task", "answer", "yes")[1]
    ask(robot, "resume")
    submit(robot, 'ask "Shall I go?" then wait 1 h')
    wait_until(lambda: robot.world_input.question)
    assert btc("task", "answer", "yes", "please") == (0, "The robot hears that.\n")
    wait_until(lambda: robot.session.robot.ears.answer == "yes please")
    assert btc("robot", "visitor") == (0, "A visitor comes.\n")


def test_the_status_of_a_task_that_waits_for_an_answer_says_how_to_answer(robot: TaskLayer, btc: Btc) -> None:
    ask(robot, "resume")
    submit(robot, 'ask Alice "Coffee?" then wait 1 h')
    wait_until(lambda: robot.world_input.question)
    assert 'It waits for an answer to "Coffee?". To answer: btc task answer TEXT\n' in btc("robot", "status")[1]
    assert data(btc, "robot", "status")["question"] == "Coffee?"
    assert '[it waits for an answer to "Coffee?"]\n' in btc("task", "list")[1]
    btc("task", "answer", "yes")
    wait_until(lambda: not robot.world_input.question)
    assert "answer" not in btc("robot", "status")[1]


def test_a_task_for_later_says_when(robot: TaskLayer, btc: Btc, monkeypatch: pytest.MonkeyPatch) -> None:
    now = datetime(2026, 11, 28, 14, 35).timestamp()
    monkeypatch.setattr(robot.handler, "_now", lambda: now)
    for words, said in (
        (["--at", "14:30"], " It begins tomorrow, 2026-11-29 14:30, at the earliest."),
        (["--at", "14:40"], " It begins at 14:40 at the earliest."),
        (["--by", "14:30"], " It is skipped if it hasn't begun by tomorrow, 2026-11-29 14:30."),
        (["--at", "24 December at 9:00"], " It begins at 2026-12-24 09:00 at the earliest."),
        ([], ""),
    ):
        text = btc("task", "add", "-c", "wave", *words)[1]
        assert text.partition("is queued.")[2] == f"{said}\n"


def test_somebody_holds_the_button_to_talk(robot: TaskLayer) -> None:
    assert "has no microphone that waits for a button" in refusal(robot, "talk", act="hold")
    held: list[bool] = []
    robot.session.robot.ears.talk = held.append
    assert robot.handle({"command": "talk", "act": "hold"}, "ann").text == "The robot listens."
    assert robot.handle({"command": "talk", "act": "release"}, "ann").ok
    assert "'act' must be 'hold' or 'release', not 'on'" in refusal(robot, "talk", act="on")
    assert held == [True, False]


def test_values_that_the_mission_has_are_given(robot: TaskLayer, btc: Btc) -> None:
    mission = 'repeat twice: increase my visitors then print "{my visitors} for {guide}"'
    assert btc("task", "add", "-c", mission, "--set", "My Visitors=3", "--set", "guide=Ann")[0] == 0
    values = {"my visitors": 1, "guide": "Ann", "guests": 2}
    assert "has no value 'guests'" in refusal(robot, "submit", text=mission, values=values)


def test_what_could_never_happen_is_refused(robot: TaskLayer) -> None:
    now = robot.now()
    assert "its deadline" in refusal(robot, "submit", text="wave", by=now - 1)
    assert "its deadline" in refusal(robot, "submit", text="wave", by="2020-01-01 9:00")
    told = refusal(robot, "submit", text="wave", at="in 2 hours", by="in 1 hour")
    assert "its earliest time" in told
    assert "is after its deadline" in told
    never = refusal(robot, "schedule", rule="on 24 December 2020 at 9:00", text="wave")
    assert "The schedule 'on 24 December 2020 at 09:00' would never be due: its time has passed." in never
    assert robot.store.tasks() == []
    assert robot.store.schedules() == []


def test_what_is_not_there_is_called_so(robot: TaskLayer, btc: Btc) -> None:
    huge = "9" * 26
    for words in (f"show {huge}", f"cancel {huge}", f"unschedule {huge}", "library nosuch", "delete nosuch"):
        code, text = btc("task", *words.split())
        assert code == 1
        assert "isn't known" in text or "The mission 'nosuch' isn't in the library" in text
    assert btc("task", "list", "--limit", huge) == (0, "There are no tasks.\n")
    assert btc("task", "library") == (0, "The library is empty.\n")
    assert "isn't the number of a task" in btc("task", "show", "9" * 5000)[1]


def test_a_schedule_of_a_file_whose_mission_is_not_there(tmp_path: Path, btc: Btc) -> None:
    (tmp_path / "week.toml").write_text('[[schedule]]\nmission = "rounds"\nevery = "every day at 9:00"\n')
    code, text = btc("robot", "up", "--name", "other", "--schedules", str(tmp_path / "week.toml"))
    assert code == 2
    assert "The mission 'rounds' isn't in the library.\n" in text
    assert "Or name its folder in the robot file: missions =" in text


def test_a_mission_in_quotes_is_a_task_unless_it_is_a_name(robot: TaskLayer, btc: Btc) -> None:
    ask(robot, "pause")
    assert btc("task", "add", "go to the kitchen") == (0, "Task 1 is queued.\n")
    ask(robot, "put", name="evening round", text="wave")
    assert btc("task", "add", "evening round")[0] == 0
    assert btc("task", "schedule", "wave and nod", "--every", "every hour")[0] == 0
    assert [task.mission.name for task in robot.store.tasks()] == ["", "evening round"]
    assert robot.store.schedules()[0].mission.text == "wave and nod"
    code, text = btc("task", "add", "morning round")
    assert code == 1
    assert "There's no mission 'morning round' in the library. As a mission it has mistakes:" in text
    assert "I don't know" in text
    assert "isn't in the library" in btc("task", "add", "morning")[1]
    assert btc("task", "add", "nod") == (0, "Task 3 is queued.\n")
    assert 'put the mission in quotes: btc task add "go to the lab"' in btc("task", "add", "go", "to", "the", "lab")[1]


def test_what_a_queued_mission_is_warned_of_is_shown(robot: TaskLayer, btc: Btc) -> None:
    ask(robot, "pause")
    code, text = btc("task", "add", "every minute say hello. go to the lab")
    assert (code, text.partition("\n\n")[0]) == (0, "Task 1 is queued.")
    assert "warning BT052" in text
    assert [each["code"] for each in data(btc, "task", "add", "when bumped, stop")["messages"]] == ["BT068"]
    assert "warning BT068" in btc("task", "schedule", "when bumped, stop", "--every", "every hour")[1]
    assert "messages" not in data(btc, "task", "add", "wave")
    assert "warning" not in btc("task", "trail")[1]


def test_a_wrong_time_is_no_mistake_of_the_mission(robot: TaskLayer, btc: Btc) -> None:
    for words in (["task", "schedule", "wave and nod", "--every", "in 5 minutes"],
                  ["task", "add", "wave and nod", "--at", "tomorrow"]):  # fmt: skip
        code, text = btc(*words)
        assert (code, "BT194" in text, "it has mistakes" in text) == (1, True, False), text


def test_a_token_that_is_not_given_is_asked_for(robot: TaskLayer, btc: Btc) -> None:
    ask(robot, "resume")
    number = submit(robot, "wait 10 h")
    wait_for(robot, number, TaskState.UNDERWAY)
    ask(robot, "interrupt", task=number)
    assert "only the token of that lets it go on: --token TOKEN" in btc("task", "resume", str(number))[1]


def test_a_schedule_shows_what_is_not_as_usual(robot: TaskLayer, btc: Btc) -> None:
    ask(robot, "schedule", rule="every day at 9:00", text="wave")
    ask(
        robot, "schedule", rule="every day at 9:00", text="print n", values={"n": 1}, zone="Asia/Tokyo", priority=-2,
        overlap="queue", missed="once", within=600, labels=["tour", "early"], restart="again",
    )  # fmt: skip
    usual, other = btc("task", "schedules")[1].splitlines()
    assert re.fullmatch(r" {3}1  every day at 09:00: wave; next at [-\d: ]+", usual)
    unusual = "overlap queue, missed once, restart again, priority -2, within 10 min, label tour, label early, n=1"
    assert re.fullmatch(rf" {{3}}2  every day at 09:00 in Asia/Tokyo: print n; next at [-\d: ]+  \[{unusual}\]", other)


def test_a_backup_is_for_its_owner_alone(robot: TaskLayer, btc: Btc, tmp_path: Path) -> None:
    file = tmp_path / "backup.db"
    assert btc("robot", "backup", str(file), "--store", robot.store.place)[0] == 0
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    assert [path.name for path in tmp_path.iterdir()] == ["backup.db"]


def test_a_unit_keeps_its_lines(btc: Btc, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    code, text = btc("robot", "unit", "--world", "a\nExecStartPre=/bin/rm")
    assert code == 2
    assert "'a\\nExecStartPre=/bin/rm' can't stand in a unit" in text
    code, text = btc("robot", "unit", "--keep", "7", "--rules", 'a "b" $c 5%')
    assert code == 0
    assert 'robot up --rules "a \\"b\\" $$c 5%%" --keep 7\n' in text
    assert text.startswith("[Unit]\n")
    for store in ("postgresql://u:secret@h/db", "postgresql://h/db?user=u&password=secret"):
        assert btc("robot", "unit", "--store", store)[1].startswith("# The password of the store is in this file")
    assert btc("robot", "unit", "--store", "postgresql://u@h/db")[1].startswith("[Unit]\n")


def test_only_what_waits_gets_another_place(robot: TaskLayer) -> None:
    waiting, begun = submit(robot, "nod"), submit(robot, "wait 10 h", priority=1)
    ask(robot, "resume")
    wait_for(robot, begun, TaskState.UNDERWAY)
    assert "can't come before itself" in refusal(robot, "reorder", task=waiting, before=waiting)
    for number, before in ((begun, waiting), (waiting, begun)):
        assert f"Task {begun} has begun" in refusal(robot, "reorder", task=number, before=before)
    assert "either 'priority' or 'before'" in refusal(robot, "reorder", task=waiting)
    assert "either 'priority' or 'before'" in refusal(robot, "reorder", task=waiting, priority=1, before=begun)
    assert "a label must have a text" in refusal(robot, "submit", text="wave", labels=["tour", " "])
    assert "a label must have a text" in refusal(robot, "schedule", rule="hourly", text="wave", labels=[""])


def test_what_is_typed_while_a_robot_is_up_says_that_it_moves_another_one(robot: TaskLayer, btc: Btc) -> None:
    code, text = btc("run", "-c", "stop", "--speed", "max")
    assert code == 0
    assert "not on the robot 'robot', which is up. To stop that: btc robot stop." in text


def test_without_a_robot_nothing_is_said_of_one(btc: Btc, monkeypatch: pytest.MonkeyPatch) -> None:
    with tempfile.TemporaryDirectory() as short:
        monkeypatch.setenv("XDG_RUNTIME_DIR", short)
        assert "btc robot stop" not in btc("run", "-c", "stop", "--speed", "max")[1]
