"""What watchers of a robot hear: the newest, without gaps where there may be none, and never at the robot's cost."""

from __future__ import annotations

import itertools
import json
import socket
import tempfile
import threading
from collections.abc import Iterator
from math import hypot
from pathlib import Path
from typing import Any

import pytest

from btlang.task.commands.client import USUAL_NAME, socket_path
from btlang.task.execution.missions import MissionReader
from btlang.task.layer import TaskLayer
from btlang.task.live.feed import _MOST_CHANGES
from btlang.task.store.records import FINAL, TaskState
from btlang.text.source import Source
from tests.world.worlds import LIVELY

from .layers import ask, layer_in, refusal, robot_up, submit, wait_for
from .places import a_task


class Watcher:
    """Somebody who reads all messages, in a thread of its own."""

    def __init__(self, layer: TaskLayer, **wanted: Any) -> None:
        self.messages: list[dict[str, Any]] = []
        self._news = threading.Condition()
        self._source = layer.feed.watch(**{"rate": 100.0, **wanted})
        threading.Thread(target=self._read, daemon=True).start()
        self.wait(lambda message: message["type"] == "hello")

    def _read(self) -> None:
        for message in self._source:
            with self._news:
                self.messages.append(message)
                self._news.notify_all()

    def wait(self, wanted: Any) -> dict[str, Any]:
        """The first message that is as wanted."""
        with self._news:
            assert self._news.wait_for(lambda: any(map(wanted, self.messages)), 10)
            return next(filter(wanted, self.messages))

    def of(self, kind: str) -> list[dict[str, Any]]:
        return [message for message in self.messages if message["type"] == kind]


def test_a_task_is_followed(tmp_path: Path) -> None:
    with layer_in(tmp_path) as layer:
        watcher = Watcher(layer)
        number = submit(layer, "wave then say hello")
        watcher.wait(lambda message: message.get("state") == TaskState.COMPLETED)
        run = watcher.wait(lambda message: message["type"] == "run" and message["task"] == number)
        assert [node[:2] for node in run["nodes"]] == [["/", "Sequence"], ["/0", "Wave"], ["/1", "Say"]]
        watcher.wait(lambda message: message.get("event", {}).get("event") == "end" and message["task"] == number)
        statuses: dict[int, str] = {}
        for message in watcher.of("statuses"):
            if message["run"] == run["run"]:
                statuses |= dict(message["changes"])
        assert statuses == {0: "SUCCESS", 1: "SUCCESS", 2: "SUCCESS"}
        assert [each["event"]["text"] for each in watcher.of("event") if each["event"]["event"] == "say"] == ["hello"]
        states = [message["state"] for message in watcher.of("change")]
        assert states == [TaskState.QUEUED, TaskState.STANDBY, TaskState.UNDERWAY, TaskState.COMPLETED]


def test_nodes_have_the_words_of_their_round(tmp_path: Path) -> None:
    with layer_in(tmp_path) as layer:
        watcher = Watcher(layer)
        visit = "visit {place} is go to {place}\nfor each room in the lab and the office: visit {room}"
        number = submit(layer, f'set n to 1\nrepeat 2 times: (say "round {{n}}" then increase n by 1)\n{visit}')

        def is_told(message: dict[str, Any]) -> bool:
            return message["type"] == "statuses" and any(
                words == 'say "round 2"' for _, words, *_ in message.get("words", ())
            )

        watcher.wait(is_told)
        late = Watcher(layer)
        late.wait(is_told)
        watcher.wait(lambda message: message.get("state") == TaskState.COMPLETED)
        run = watcher.wait(lambda message: message["type"] == "run" and message["task"] == number)
        assert [node[2] for node in run["nodes"] if node[1] == "GoTo"] == ["go to lab", "go to office"]
        says = next(index for index, node in enumerate(run["nodes"]) if node[1] == "Say")
        [prepared] = run["prepared"]
        assert run["nodes"][says][0] == f"{run['nodes'][prepared][0]}/1"
        found = [pair for message in watcher.of("statuses") for pair in message.get("words", ()) if pair[0] == says]
        assert [words for _, words, *_ in found] == ['say "round 1"', 'say "round 2"']


def test_who_comes_late_knows_what_the_robot_does(tmp_path: Path) -> None:
    with layer_in(tmp_path) as layer:
        number = submit(layer, "say hello then go to the lab then wait 1 s")
        watcher = Watcher(layer)
        watcher.wait(lambda message: message["type"] == "doing" and message["goal"] == "lab")
        late = Watcher(layer).wait(lambda message: message["type"] == "doing")
        assert {**late, "goal": ""} == {"type": "doing", "task": number, "goal": "", "says": "hello", "heard": ""}
        watcher.wait(lambda message: message.get("state") == TaskState.COMPLETED)
        watcher.wait(lambda message: message["type"] == "doing" and not message["task"])
        assert watcher.of("doing")[-1] == {"type": "doing", "task": 0, "goal": "", "says": "hello", "heard": ""}


def test_the_map_and_what_the_scanner_sees(tmp_path: Path) -> None:
    with layer_in(tmp_path) as layer:
        watcher = Watcher(layer)
        known = watcher.wait(lambda message: message["type"] == "map")
        lab = next(place for place in known["places"] if place["name"] == "lab")
        assert (lab["x"], lab["y"]) == (6.0, 6.2)
        assert {len(point) for wall in known["walls"] for point in wall} == {2}
        ranges = watcher.wait(lambda message: message["type"] == "scan")["ranges"]
        assert len(ranges) == 360
        assert all(distance is None or 0 < distance < 100 for distance in ranges)
        assert json.loads(json.dumps(watcher.messages, default=str, allow_nan=False))


def test_what_a_mission_counts(tmp_path: Path) -> None:
    with layer_in(tmp_path) as layer:
        watcher = Watcher(layer)
        submit(layer, 'set cups to 3\nset guest to "Ann"\nwait 1 s\ndecrease cups by 1\nwait 100 s')
        watcher.wait(lambda message: message.get("values") == {"cups": 3})
        watcher.wait(lambda message: message.get("values") == {"cups": 2})


def test_the_way_that_it_follows(tmp_path: Path) -> None:
    with layer_in(tmp_path) as layer:
        watcher = Watcher(layer)
        submit(layer, "go to the lab then wait 1 s")
        way = watcher.wait(lambda message: message["type"] == "way")["points"]
        assert hypot(way[-1][0] - 6.0, way[-1][1] - 6.2) < 0.1
        watcher.wait(lambda message: message["type"] == "way" and not message["points"])


def test_people_doors_and_zones(tmp_path: Path) -> None:
    with layer_in(tmp_path, reader=MissionReader((), Source(LIVELY, "lively.toml"))) as layer:
        watcher = Watcher(layer)
        vera = watcher.wait(
            lambda m: m["type"] == "things" and any(each[0] == "Vera" and each[1] for each in m["things"])
        )
        assert all(name in ("Vera", "cup") for name, *_ in vera["things"])
        submit(layer, "close the door then close the wet floor then open the stairs then wait 5 min")
        watcher.wait(lambda m: m["type"] == "map" and not m["doors"][0]["open"])
        watcher.wait(lambda m: m["type"] == "map" and [each["kind"] for each in m["zones"]] == ["keep out", "open"])
        late = Watcher(layer)
        assert not late.wait(lambda m: m["type"] == "map")["doors"][0]["open"]
        late.wait(lambda m: m["type"] == "things")


def test_a_question_and_its_answer(tmp_path: Path) -> None:
    with layer_in(tmp_path) as layer:
        watcher = Watcher(layer)
        assert "isn't asking" in refusal(layer, "answer", text="yes")
        number = submit(layer, 'ask "Shall I go?" then if the answer is yes, say "Off I go"')
        assert watcher.wait(lambda m: m["type"] == "asking")["text"] == "Shall I go?"
        late = Watcher(layer)
        assert late.wait(lambda m: m["type"] == "asking")["text"] == "Shall I go?"
        for text in ("", "  ", "x" * 501):
            assert "1 to 500" in refusal(layer, "answer", text=text)
        assert ask(layer, "answer", text=" Yes, please ")["question"] == "Shall I go?"
        watcher.wait(lambda m: m["type"] == "asking" and not m["text"])
        assert wait_for(layer, number, *FINAL).state is TaskState.COMPLETED
        heard = [m["event"] for m in watcher.of("event") if m["event"]["event"] in ("hear", "say")]
        assert [each["text"] for each in heard] == ["Shall I go?", "Yes, please", "Off I go"]


def test_answers_from_a_file_and_a_visitor(tmp_path: Path) -> None:
    with layer_in(tmp_path, answers={"coffee": ["yes"], "*": ["no"]}) as layer:
        watcher = Watcher(layer)
        mission = 'ask "Some coffee?", check that the answer is yes, ask "Tea?" then check that the answer is no'
        assert wait_for(layer, submit(layer, mission), *FINAL).state is TaskState.COMPLETED
        assert watcher.wait(lambda m: m["type"] == "robot")["visitors"] is True
        ask(layer, "visitor")
        come = watcher.wait(lambda m: m.get("event", {}).get("event") == "come")["event"]["name"]
        watcher.wait(lambda m: m["type"] == "things" and come in [name for name, *_ in m["things"]])


def test_who_comes_back_misses_no_change(tmp_path: Path) -> None:
    with layer_in(tmp_path) as layer:
        for _ in range(3):
            submit(layer, "wave", at="in 2 hours")
        first = Watcher(layer, after=1)
        assert [first.wait(lambda m, n=n: m.get("number") == n)["task"] for n in (2, 3)] == [2, 3]
        late = Watcher(layer)
        ask(layer, "cancel", task=2)
        assert late.wait(lambda message: message["type"] == "change")["number"] == 4
        assert len(late.of("change")) == 1


def test_all_that_was_missed_comes_first(tmp_path: Path) -> None:
    with layer_in(tmp_path) as layer:
        for _ in range(2 * _MOST_CHANGES):
            layer.store.add(a_task(earliest=1e12))
        _, *messages = itertools.islice(layer.feed.watch(after=0), 2 * _MOST_CHANGES + 1)
        assert [message["number"] for message in messages] == list(range(1, 2 * _MOST_CHANGES + 1))


def test_numbers_of_another_store_are_unknown(tmp_path: Path) -> None:
    with layer_in(tmp_path) as layer:
        submit(layer, "wave", at="in 2 hours")
        watcher = Watcher(layer, after=1000)
        assert watcher.of("hello")[0]["change"] == 1
        ask(layer, "cancel", task=1)
        assert watcher.wait(lambda message: message["type"] == "change")["number"] == 2


def test_numbers_go_on_where_old_changes_were_deleted(tmp_path: Path) -> None:
    with layer_in(tmp_path) as layer:
        submit(layer, "wave", at="in 2 hours")
        ask(layer, "cancel", task=1)
        assert layer.store.clean(1e12) == 1
        assert Watcher(layer, after=2).of("hello")[0]["change"] == 2


def test_stops_and_pauses_are_told(tmp_path: Path) -> None:
    with layer_in(tmp_path) as layer:
        watcher = Watcher(layer)
        layer.stop("ann")
        told = watcher.wait(lambda message: message.get("stopped"))
        assert told["stopped"] == "emergency stop by ann"
        ask(layer, "release")
        ask(layer, "pause")
        assert not watcher.wait(lambda message: message.get("paused"))["stopped"]
        assert watcher.wait(lambda message: message.get("pose"))["battery"] == 100.0


def test_who_reads_nothing_delays_nobody_and_fills_no_memory(tmp_path: Path) -> None:
    with layer_in(tmp_path) as layer:
        silent = layer.feed.watch()
        next(silent)
        numbers = [submit(layer, f"repeat 60 times: print {number}") for number in range(20)]
        for number in numbers:
            assert wait_for(layer, number, *FINAL).state is TaskState.COMPLETED
        [watcher] = layer.feed._watchers
        assert len(watcher.events) == watcher.events.maxlen
        assert len(watcher.runs) == watcher.runs.maxlen
        messages = list(itertools.takewhile(lambda message: message["type"] != "robot", silent))
        assert [m["number"] for m in messages if m["type"] == "change"] == list(range(1, 81))
        silent.close()
        assert layer.feed._watchers == []


@pytest.fixture
def door(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[TaskLayer]:
    """A robot with its sockets."""
    with tempfile.TemporaryDirectory() as short:
        monkeypatch.setenv("XDG_RUNTIME_DIR", short)
        with robot_up(tmp_path) as layer:
            yield layer


@pytest.mark.parametrize("wanted", [{}, {"rate": 50, "after": 0}, {"rate": "x", "after": []}, [], None, {"rate": -1e9}])
def test_over_the_socket(door: TaskLayer, wanted: object) -> None:
    with socket.socket(socket.AF_UNIX) as connection:
        connection.settimeout(10)
        connection.connect(socket_path(USUAL_NAME))
        connection.sendall(json.dumps({"watch": wanted}).encode() + b"\n")
        with connection.makefile("rb") as lines:
            assert json.loads(lines.readline())["type"] == "hello"
            assert json.loads(lines.readline())["type"] in ("run", "robot")


def test_somebody_else_is_named(door: TaskLayer) -> None:
    with socket.socket(socket.AF_UNIX) as connection:
        connection.connect(socket_path(USUAL_NAME))
        connection.sendall(b'{"command": "pause", "as": "bo"}\n{"command": "pause", "as": 7}\n')
        with connection.makefile("rb") as lines:
            assert all(json.loads(lines.readline())["ok"] for _ in range(2))
    acts = door.store.acts()
    assert acts[1].person == "bo"
    assert acts[0].person not in ("bo", "7", "")
