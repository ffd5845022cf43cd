"""Tasks on the simulated robot: their order, their ends, interruptions, rules and stops."""

from __future__ import annotations

import gc
import importlib
import threading
import time
import weakref
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import closing
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from btlang.api import parse_tree
from btlang.diagnostics.diagnostic import MissionError
from btlang.run.events import Event, Printed
from btlang.task.execution import executor
from btlang.task.execution.missions import MissionReader
from btlang.task.layer import TaskLayer
from btlang.task.messages import Answer, Submit
from btlang.task.store.records import FINAL, MissionText, Task, TaskState

from .layers import ask, layer_in, refusal, submit, task, wait_for, wait_until

if TYPE_CHECKING:
    from btlang.run.events import Sink

RULES = "whenever the battery is below 60%, go to the dock then charge to 90%\n"


class Printer:
    """What the missions printed."""

    def __init__(self) -> None:
        self.texts: list[str] = []

    def __call__(self, event: Event) -> None:
        if isinstance(event, Printed):
            self.texts.append(event.text)

    def sinks(self, *_: object) -> list[Sink]:
        return [self]


def test_the_most_urgent_comes_first_then_the_oldest(tmp_path: Path, place: str) -> None:
    printer = Printer()
    with layer_in(tmp_path, store=place, sinks=printer.sinks) as layer:
        ask(layer, "pause")
        numbers = [submit(layer, f"print {number}", priority=number % 3) for number in range(6)]
        ask(layer, "reorder", task=numbers[3], before=numbers[0])
        ask(layer, "resume")
        for number in numbers:
            assert wait_for(layer, number, *FINAL).state is TaskState.COMPLETED
    assert printer.texts == ["2", "5", "1", "4", "3", "0"]


def test_a_more_urgent_task_interrupts_and_the_other_goes_on(tmp_path: Path, place: str) -> None:
    printer = Printer()
    with layer_in(tmp_path, store=place, sinks=printer.sinks) as layer:
        slow = submit(layer, "print a then wait 20 s then print b then wait 10 s then print c")
        wait_until(lambda: printer.texts == ["a"])
        urgent = submit(layer, "print now", priority=1)
        assert wait_for(layer, urgent, *FINAL).state is TaskState.COMPLETED
        assert wait_for(layer, slow, *FINAL).state is TaskState.COMPLETED
        states = [change.state for _, change in layer.store.changes(slow)]
    assert printer.texts == ["a", "now", "b", "c"]
    assert states == [
        TaskState.QUEUED, TaskState.STANDBY, TaskState.UNDERWAY, TaskState.DELAYED,
        TaskState.STANDBY, TaskState.UNDERWAY, TaskState.COMPLETED,
    ]  # fmt: skip


def test_an_interruption_ends_with_its_token(tmp_path: Path, place: str) -> None:
    printer = Printer()
    with layer_in(tmp_path, store=place, sinks=printer.sinks) as layer:
        number = submit(layer, "print a then wait 100 s then print b")
        wait_until(lambda: printer.texts == ["a"])
        token = ask(layer, "interrupt", task=number, reason="a child is in the way")["token"]
        assert task(layer, number).state is TaskState.DELAYED
        [waiting] = ask(layer, "list")["tasks"]
        assert waiting["waits"] == "it was interrupted: a child is in the way"
        other = submit(layer, "print c")
        assert wait_for(layer, other, *FINAL).state is TaskState.COMPLETED
        assert "has another token" in refusal(layer, "resume", task=number, token="0")
        ask(layer, "resume", task=number, token=token)
        assert wait_for(layer, number, *FINAL).state is TaskState.COMPLETED
        assert "was already over: completed" in refusal(layer, "resume", task=number, token=token)
    assert printer.texts == ["a", "c", "b"]


CLEANS = """
<TryCatch catch_on_halt="true"><Sleep msec="1000000"/><PrintText text="cleaned"/></TryCatch>
"""


@pytest.mark.parametrize(
    ("act", "state", "cleaned"), [("cancel", TaskState.CANCELED, 1), ("kill", TaskState.KILLED, 0)]
)
def test_a_cancel_cleans_up_and_a_kill_does_not(act: str, state: TaskState, cleaned: int, tmp_path: Path) -> None:
    printer = Printer()
    tree = f'<root BTCPP_format="4"><BehaviorTree ID="Main">{CLEANS}</BehaviorTree></root>'
    with layer_in(tmp_path, sinks=printer.sinks) as layer:
        number = submit(layer, tree.replace("PrintText", layer.reader.read(MissionText("print hi")).tree.root.id))
        wait_for(layer, number, TaskState.UNDERWAY)
        ask(layer, act, task=number, reason="too late")
        ended = task(layer, number)
        assert (ended.state, ended.reason) == (state, "too late")
        assert f"was already over: {state}" in refusal(layer, act, task=number)
    assert len(printer.texts) == cleaned


def test_failures_and_what_cannot_be_done_have_reasons(tmp_path: Path) -> None:
    with layer_in(tmp_path) as layer:
        number = submit(layer, "grasp the book")
        assert wait_for(layer, number, *FINAL).reason.startswith("grasp the book: ")
        assert "BT010" in refusal(layer, "submit", text="frobnicate")
        assert "isn't in the library" in refusal(layer, "submit", name="tour")
        assert "isn't known" in refusal(layer, "cancel", task=99)
        assert "there's no such command" in refusal(layer, "sumbit")
        assert "BT194" in refusal(layer, "submit", text="wave", at="half past")
        assert ask(layer, "list")["tasks"] == []


def test_an_emergency_stop_is_latched_also_by_the_next_process(tmp_path: Path) -> None:
    printer = Printer()
    with layer_in(tmp_path, sinks=printer.sinks) as layer:
        driving = submit(layer, "go to the lab")
        wait_for(layer, driving, TaskState.UNDERWAY)
        ask(layer, "emergency_stop", reason="smoke")
        assert wait_for(layer, driving, *FINAL).state is TaskState.KILLED
        waiting = submit(layer, "print later")
        assert layer.session.robot.velocity == (0.0, 0.0)
        assert ask(layer, "list")["tasks"][0]["waits"] == "the robot is stopped: emergency stop by ann: smoke"
    with layer_in(tmp_path, sinks=printer.sinks) as layer:
        assert layer.emergency.is_latched
        assert task(layer, waiting).state is TaskState.QUEUED
        assert printer.texts == []
        ask(layer, "release")
        assert wait_for(layer, waiting, *FINAL).state is TaskState.COMPLETED
    with layer_in(tmp_path) as layer:
        assert not layer.emergency.is_latched


def test_house_rules_hold_during_and_between_missions(tmp_path: Path) -> None:
    rules = tmp_path / "rules.txt"
    rules.write_text(RULES)
    printer = Printer()
    with layer_in(tmp_path, rules=str(rules), sinks=printer.sinks) as layer:
        power = layer.session.robot.power
        number = submit(layer, "print a then wait 20 s then print b")
        wait_until(lambda: printer.texts == ["a"])
        power.set_level(50.0)
        assert wait_for(layer, number, *FINAL).state is TaskState.COMPLETED
        assert layer.session.robot.battery > 85
        wait_until(lambda: layer.executor.run is not None)
        power.set_level(50.0)
        wait_until(lambda: layer.executor.hindrance() == "a house rule acts")
        number = submit(layer, "print c")
        assert wait_for(layer, number, *FINAL).state is TaskState.COMPLETED
        assert layer.session.robot.battery > 85
    assert printer.texts == ["a", "b", "c"]


def test_a_house_rule_that_fails_stops_the_robot_until_somebody_helps(tmp_path: Path) -> None:
    rules = tmp_path / "rules.txt"
    rules.write_text("whenever the battery is below 60%, grasp the book\n")
    printer, troubles = Printer(), list[str]()
    with layer_in(tmp_path, rules=str(rules), sinks=printer.sinks, trouble=troubles.append) as layer:
        number = submit(layer, "print a then wait 20 s then print b")
        wait_until(lambda: printer.texts == ["a"])
        layer.session.robot.power.set_level(50.0)
        wait_for(layer, number, TaskState.BLOCKED)
        other = submit(layer, "print c")
        assert "a house rule failed" in ask(layer, "list")["tasks"][0]["waits"]
        assert "The robot needs help" in troubles[0]
        layer.session.robot.power.set_level(90.0)
        ask(layer, "resume")
        assert wait_for(layer, number, *FINAL).state is TaskState.COMPLETED
        assert wait_for(layer, other, *FINAL).state is TaskState.COMPLETED
    assert printer.texts == ["a", "b", "c"]


def test_a_mission_that_is_deleted_while_it_waits_is_still_done(tmp_path: Path) -> None:
    printer = Printer()
    with layer_in(tmp_path, sinks=printer.sinks) as layer:
        ask(layer, "put", name="tour", text="print first")
        ask(layer, "pause")
        number = int(ask(layer, "submit", name="tour")["task"]["id"])
        ask(layer, "put", name="tour", text="print second")
        ask(layer, "delete", name="tour")
        ask(layer, "resume")
        assert wait_for(layer, number, *FINAL).state is TaskState.COMPLETED
        assert "isn't in the library" in refusal(layer, "submit", name="tour")
        revisions = ask(layer, "library", name="tour")["missions"]
        assert [each["text"] for each in revisions if not each["deleted"]] == ["print first", "print second"]
    assert printer.texts == ["first"]


def test_a_cancel_in_the_moment_of_the_end_is_true_or_says_so(tmp_path: Path) -> None:
    """Each answer agrees with what the store says from then on."""
    with layer_in(tmp_path) as layer:
        answers = set()
        for _ in range(40):
            number = submit(layer, "wait 0.2 s")
            wait_for(layer, number, TaskState.UNDERWAY, *FINAL)
            answer = layer.handle({"command": "cancel", "task": number}, "ann")
            state = wait_for(layer, number, *FINAL).state
            assert state in (TaskState.CANCELED, TaskState.COMPLETED)
            assert answer.ok is (state is TaskState.CANCELED), answer.text
            answers.add(state)
        assert answers


def test_a_cancel_of_a_task_that_is_about_to_begin_is_not_lost(tmp_path: Path) -> None:
    with ThreadPoolExecutor(1) as thread:
        answers: list[Future[Answer]] = []

        def sinks(task: Task, *_: object) -> list[Sink]:
            answers.append(thread.submit(layer.handle, {"command": "cancel", "task": task.id}, "ann"))
            time.sleep(0.1)
            return []

        with layer_in(tmp_path, sinks=sinks) as layer:
            number = submit(layer, "wait 100 s")
            assert wait_for(layer, number, *FINAL).state is TaskState.CANCELED
            assert answers[0].result().text == f"Task {number} is canceled."


@pytest.mark.parametrize(
    ("restart", "state"), [("give up", TaskState.ERROR), ("again", TaskState.QUEUED), ("resume", TaskState.QUEUED)]
)
def test_a_robot_that_goes_down_ends_its_task_as_that_says(restart: str, state: TaskState, tmp_path: Path) -> None:
    with layer_in(tmp_path) as layer:
        number = submit(layer, "wait 24 h", restart=restart)
        wait_for(layer, number, TaskState.UNDERWAY)
        layer.halt()
        ended = task(layer, number)
        assert ended.state is state
        assert ended.reason.startswith("the robot was shut down")
        assert bool(ended.saved) is (restart == "resume")


def test_a_layer_that_is_closed_leaves_nothing(tmp_path: Path) -> None:
    """No thread, no open file and no memory: a process may make many."""
    left: list[weakref.ref[object]] = []

    def up_and_down() -> None:
        with layer_in(tmp_path, recordings=str(tmp_path)) as layer:
            number = submit(layer, "wave")
            wait_for(layer, number, *FINAL)
            left.extend(map(weakref.ref, (layer, layer.store, layer.session, layer.executor)))

    up_and_down()
    before = threading.active_count(), open_files()
    for _ in range(3):
        up_and_down()
    gc.collect()
    assert [each() for each in left] == [None] * 16
    assert (threading.active_count(), open_files()) == before


def open_files() -> int:
    folder = Path("/proc/self/fd")
    return len(list(folder.iterdir())) if folder.exists() else 0


def test_parameters_are_values_of_the_mission(tmp_path: Path) -> None:
    printer = Printer()
    with layer_in(tmp_path, sinks=printer.sinks) as layer:
        number = submit(
            layer, 'repeat twice: increase visitors then print "{visitors} for {guide}"',
            values={"visitors": 3, "guide": "Ann"},
        )  # fmt: skip
        assert wait_for(layer, number, *FINAL).state is TaskState.COMPLETED
        assert "BT010" in refusal(layer, "submit", text="if visitors is 3, wave")
    assert printer.texts == ["4 for Ann", "5 for Ann"]


def test_a_schedule_makes_its_tasks(tmp_path: Path, place: str) -> None:
    """An hour in a moment: the robot's time is simulated."""
    begins = datetime(2026, 3, 2, 8, 50, tzinfo=UTC).timestamp()
    with closing(TaskLayer(folder=str(tmp_path), store=place, speed="max", begins=begins)) as layer:
        rule = "every 10 minutes between 9:00 and 9:30"
        ask(layer, "schedule", rule=rule, zone="UTC", text="wave", labels=["tour"])
        layer.start()  # only now: while the store keeps the schedule, an hour may go by
        wait_until(lambda: layer.now() > begins + 3000)
        ask(layer, "pause")
        tours = ask(layer, "list", states=["completed"], label="tour")["tasks"]
        report = ask(layer, "report", since=begins)["lines"]
    assert sorted(tour["due"] - begins for tour in tours) == [600, 1200, 1800, 2400]
    assert all(0 <= tour["started"] - tour["due"] < 5 for tour in tours), tours
    assert report[2] == "wave (every 10 minutes between 09:00 and 09:30): 4 of 4 done."


def test_a_store_that_refuses_is_not_asked_all_the_time(tmp_path: Path) -> None:
    troubles: list[str] = []
    with layer_in(tmp_path, trouble=troubles.append) as layer:
        number = submit(layer, "wait 5 s")
        wait_for(layer, number, TaskState.UNDERWAY)
        wait_until(lambda: layer.executor.run is not None)
        layer.store.close()
        wait_until(lambda: layer.executor.task is None)
        layer.executor.wake()
        time.sleep(0.3)
        assert len(troubles) < 10


def test_a_command_that_hangs_keeps_no_robot_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "words.toml").write_text('[[action]]\nphrase = "hang"\nid = "Hang"\ncall = "hangs:hang"\n')
    (tmp_path / "hangs.py").write_text(
        "from threading import Event\nreleased = Event()\n"
        "def hang(robot):\n    robot.drive(0.5, 0.0)\n    released.wait(60)\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(executor, "_END", 0.3)
    told: list[str] = []
    layer = TaskLayer(
        "simulated", MissionReader([str(tmp_path / "words.toml")]), folder=str(tmp_path), trouble=told.append
    )
    layer.start()
    number = submit(layer, "hang")
    wait_for(layer, number, TaskState.UNDERWAY)
    assert not layer.halt()
    assert told == ["The mission doesn't end because a command hangs; the robot was stopped."]
    assert not layer.close()
    assert not layer.session.robot.moving
    importlib.import_module("hangs").released.set()


@pytest.mark.parametrize("name", ["\0", "a\nb", "\x1b[2J", "x" * 5000, "../../x", "🤖"])
def test_any_name(tmp_path: Path, name: str) -> None:
    with layer_in(tmp_path) as layer:
        if "\0" not in name:
            assert wait_for(layer, submit(layer, "wave", name=name), *FINAL).state is TaskState.COMPLETED
        answer = layer.handle({"command": "put", "name": name, "text": "wave"}, "ann")
        assert answer.ok or answer.code in ("BT195", "BT198")
        assert "\x1b" not in answer.text


@pytest.mark.parametrize("text", ["\ud800", "a\0b"])
def test_texts_that_nothing_can_keep(tmp_path: Path, text: str) -> None:
    with layer_in(tmp_path) as layer:
        number = submit(layer, "wave", at="23:59")
        for command in (
            {"command": "submit", "text": "wave", "labels": [text]},
            {"command": "submit", "text": f'include "{text}"'},
            {"command": "submit", "text": "wave", "values": {"n": [{"m": text}]}},
            {"command": "cancel", "task": number, "reason": text},
            {"command": "put", "name": text, "text": "wave"},
            Submit("wave", labels=(text,)),
        ):
            answer = layer.handle(command, "ann")
            assert (answer.ok, answer.code) == (False, "BT198")
    with pytest.raises(MissionError):
        parse_tree(f'include "{text}"')


@pytest.mark.parametrize("within", [float("inf"), float("nan"), 1e400, 0, -5])
def test_times_that_are_none(tmp_path: Path, within: float) -> None:
    with layer_in(tmp_path) as layer:
        fields = {"command": "schedule", "text": "wave", "rule": "every minute", "within": within}
        assert layer.handle(fields, "ann").code == "BT198"


def test_recordings_that_cannot_be_written_are_told_once(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    troubles: list[str] = []
    with layer_in(tmp_path, recordings=str(tmp_path / "file"), trouble=troubles.append) as layer:
        for _ in range(2):
            assert wait_for(layer, submit(layer, "wave"), *FINAL).state is TaskState.COMPLETED
    assert len(troubles) == 1
    assert "BT009" in troubles[0]


def test_a_task_says_what_it_needs_of_the_robot(tmp_path: Path) -> None:
    with layer_in(tmp_path) as layer:
        number = submit(layer, "go to the lab then say hello", at="in 1 hour")
        assert task(layer, number).needs == ("navigation", "voice")
        assert "needs navigation, voice" in layer.handle({"command": "show", "task": number}, "ann").text
        assert task(layer, int(ask(layer, "again", task=number)["task"]["id"])).needs == ("navigation", "voice")
        plan = ask(layer, "schedule", text="wave", rule="every minute", missed="all")["schedule"]["id"]
        layer.store.amend_schedule(plan, next=layer.now() - 1)
        ask(layer, "pause")
        layer.manager.refresh(layer.now())
        [made] = layer.store.tasks(schedule=plan)[:1]
        assert made.needs == ("posture wave", "right arm")


def test_status_between_two_commands_has_words(tmp_path: Path) -> None:
    with layer_in(tmp_path) as layer:
        number = submit(layer, "wait until the battery is below 1%")
        wait_for(layer, number, TaskState.UNDERWAY)
        wait_until(lambda: not ask(layer, "status")["running"])
        assert layer.handle({"command": "status"}, "ann").text == f"Task {number} is under way.\nNothing waits."
