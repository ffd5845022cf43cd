"""What a server of actions makes of goals, ticked by hand: values, resources, cancelling, and what leaves tell."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from btlang import Session
from btlang.backends.engine import bind_leaf
from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.ros.serving.goal_executor import BUSY, REST, GoalExecutor
from btlang.ros.serving.names import action_name, choose_actions, find_servable
from btlang.ros.serving.requested_leaf import make_leaf
from btlang.run.bus import Bus

WORDS = """
[[action]]
phrase = "count to {count}"
id = "CountTo"
call = "counting:Count"

[[action]]
phrase = "query the cloud"
id = "AskCloud"
call = "counting:ask"
resources = ["network"]

[[action]]
phrase = "stumble"
id = "Stumble"
call = "counting:stumble"
"""
TABLES = """
[[action]]
phrase = "speak {text}"
id = "Say"
ros = { phrase = "say {text}", name = "/actions/say" }

[[action]]
phrase = "announce by ros {text}"
id = "Announce"
ros = { publish = "std_msgs/msg/String", name = "/speech", message = { data = "{text}" } }
"""
PYTHON = """
import asyncio


class Count:
    def __init__(self, progress):
        self.progress = progress

    def start(self, count):
        self.count, self.at = count, 0

    def tick(self):
        self.at += 1
        self.progress(self.at / self.count, f"says {self.at}")
        return True if self.at == self.count else None

    def halt(self):
        pass


async def ask():
    await asyncio.sleep(60)


def stumble():
    raise RuntimeError("a stone")
"""


class Caller:
    def __init__(self) -> None:
        self.told: list[tuple[float, str]] = []
        self.ended: list[tuple[bool, str]] = []

    def report(self, share: float, state: str) -> None:
        self.told.append((share, state))

    def end(self, success: bool, reason: str) -> None:
        self.ended.append((success, reason))


class Server:
    """A simulated robot and its goals; time passes only in `tick`."""

    def __init__(self, *keywords: str) -> None:
        self.vocabulary = world_vocabulary(keywords)
        self.stage = Session().connection
        self.stage.begin(Bus())
        self.executor = GoalExecutor(self.stage, self.vocabulary, lambda: self.stage.bus.clock.now)

    def begin(self, node_id: str, **values: str) -> tuple[Caller, Callable[[], None]]:
        caller, entries = Caller(), self.vocabulary.entries[node_id]
        leaf = make_leaf("", list(values), list(values.values()), entries, self.vocabulary)
        return caller, self.executor.begin(leaf, caller)

    def tick(self, seconds: float = 0.05) -> None:
        """Until so many seconds of the mission are over."""
        until = self.stage.bus.clock.now + seconds - 1e-9
        while self.stage.bus.clock.now < until:
            self.executor.tick()
            self.stage.bus.clock.advance(0.05)
            self.stage.robot.step(0.05)


@pytest.fixture
def keywords(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    (tmp_path / "counting.py").write_text(PYTHON, encoding="utf-8")
    (tmp_path / "counting.toml").write_text(WORDS, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    return str(tmp_path / "counting.toml")


def test_goals_of_different_resources_run_side_by_side():
    server = Server()
    say, _ = server.begin("Say", text="hello there")
    drive, _ = server.begin("MoveForward", distance="0.6 m")
    server.tick(0.2)
    assert server.stage.robot.speaking
    assert server.stage.robot.velocity[0] > 0
    server.tick(5)
    assert (say.ended, drive.ended) == ([(True, "")], [(True, "")])
    assert drive.told[0] == (0.0, "move forward 0.6 m")
    shares = [share for share, _ in drive.told]
    assert shares == sorted(shares)
    assert shares[-1] > 0.8


def test_a_caller_hears_again_and_again_that_it_goes_on(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("btlang.ros.serving.goal_executor.WORD", 0.0)
    server = Server()
    say, _ = server.begin("Say", text="hello there")
    server.tick(0.5)
    assert len(say.told) >= 9
    assert len(set(say.told)) == 1


def test_the_later_of_two_goals_that_need_the_same_fails():
    server = Server()
    first, _ = server.begin("MoveForward", distance="0.6 m")
    second, _ = server.begin("TurnLeft", angle="90 degrees")
    server.tick(BUSY + 0.1)
    assert second.told == [(0.0, "waits for the base")]
    assert second.ended == [(False, "'move forward 0.6 m' is using the base")]
    server.tick(5)
    assert first.ended == [(True, "")]


def test_the_word_that_cancels_comes_after_the_next_goal():
    server = Server()
    first, cancel = server.begin("MoveForward", distance="3 m")
    server.tick(1)
    second, _ = server.begin("TurnLeft", angle="90 degrees")
    server.tick(0.1)
    cancel("it was cancelled")
    server.tick(5)
    assert first.ended == [(False, "it was cancelled")]
    assert second.ended == [(True, "")]


def test_a_cancelled_goal_ends_when_the_robot_stands():
    server = Server()
    drive, cancel = server.begin("MoveForward", distance="1 m")
    server.tick(1)
    cancel("it was cancelled")
    server.tick()
    assert (drive.ended, server.stage.robot.moving) == ([], True)
    server.tick(REST)
    assert drive.ended == [(False, "it was cancelled")]
    assert server.stage.robot.velocity == (0.0, 0.0)


def test_cancelled_before_it_begins():
    server = Server()
    drive, cancel = server.begin("MoveForward", distance="1 m")
    cancel("it was cancelled")
    server.tick()
    assert drive.ended == [(False, "it was cancelled")]
    assert not server.stage.robot.moving


def test_the_end_of_the_server():
    server = Server()
    drive, _ = server.begin("MoveForward", distance="3 m")
    server.tick(1)
    new, _ = server.begin("Say", text="hello")
    server.executor.halt()
    server.executor.answer_all()
    assert drive.ended == new.ended == [(False, "the server was stopped")]
    assert not server.stage.robot.speaking


def test_a_class_of_a_user_tells_what_it_does(keywords: str):
    server = Server(keywords)
    count, _ = server.begin("CountTo", count="ten")
    server.tick(1)
    assert count.told[0] == (0.0, "count to 10")
    assert (0.2, "says 2") in count.told
    assert count.ended == [(True, "")]


def test_an_async_function_is_cancelled(keywords: str):
    server = Server(keywords)
    ask, cancel = server.begin("AskCloud")
    server.tick(0.2)
    cancel("it was cancelled")
    server.tick(0.1)
    assert ask.ended == [(False, "it was cancelled")]
    again, _ = server.begin("AskCloud")
    server.tick(1)
    assert again.ended == []
    server.executor.halt()


def test_what_goes_wrong_in_python_is_the_reason(keywords: str):
    server = Server(keywords)
    stumble, _ = server.begin("Stumble")
    drive, _ = server.begin("MoveForward")  # which has a default
    server.tick(0.1)
    assert stumble.ended == [(False, "RuntimeError: a stone")]
    assert drive.ended == []


@pytest.mark.parametrize(
    ("phrase", "values", "port"),
    [
        ("", {"distance": "2 m"}, "2"),
        ("MoveForward", {"distance": "half a meter"}, "0.5"),
        ("move forward [{distance}] [at {speed}]", {"distance": "2.5"}, "2.5"),
    ],
)
def test_values_as_in_a_mission(phrase: str, values: dict[str, str], port: str):
    vocabulary = world_vocabulary()
    entries = vocabulary.entries["MoveForward"]
    phrase = entries[0].phrases[0] if phrase.startswith("move") else phrase
    assert make_leaf(phrase, list(values), list(values.values()), entries, vocabulary).port("distance") == port


@pytest.mark.parametrize(
    ("node_id", "phrase", "names", "values", "reason"),
    [
        ("Wave", "move forward", [], [], "'move forward' isn't served here: this is Wave, with the phrase 'wave"),
        ("Wave", "", ["times"], [], "1 name and 0 values are given"),
        ("GoTo", "", ["plac"], ["lab"], "GoTo has no parameter 'plac': its parameters are place"),
        ("ShakeHead", "", ["speed"], ["1"], "ShakeHead has no parameter 'speed': it has no parameters"),
        ("GoTo", "", ["place", "place"], ["lab", "lab"], "place is given twice"),
        ("GoTo", "", ["place"], ["the labb"], "place is 'the labb', which isn't a place; similar: lab"),
        ("GoTo", "", ["place"], ["xyz"], "place is 'xyz', which isn't a place; there are "),
        ("MoveForward", "", ["distance"], ["two cats"], "distance is 'two cats', which isn't a length, such as 5 m"),
        ("MoveForward", "", ["distance"], ["inf"], "distance is 'inf', which isn't a length, such as 5 m"),
        ("Say", "", ["text"], ["{key}"], "text is '{key}', a value of a mission, but"),
    ],
)
def test_what_makes_no_sense(node_id: str, phrase: str, names: list[str], values: list[str], reason: str):
    vocabulary = world_vocabulary()
    with pytest.raises(ActionFailed) as caught:
        make_leaf(phrase, names, values, vocabulary.entries[node_id], vocabulary)
    assert str(caught.value).startswith(reason)


def test_a_value_that_is_missing():
    server = Server()
    go, _ = server.begin("GoTo")
    server.tick(0.1)
    assert go.ended == [(False, "neither a place nor a point is given")]


def test_all_that_ships_has_a_name_and_can_be_bound():
    vocabulary = world_vocabulary()
    ids = choose_actions((), find_servable(vocabulary, ros=False), vocabulary)
    assert len({action_name(node_id) for node_id in ids}) == len(ids) > 50
    assert action_name("MoveForward") == "move_forward"
    assert all(bind_leaf(node_id, vocabulary) is not None for node_id in ids)


def test_what_another_server_does_is_not_served(tmp_path: Path):
    """Else its goal could be for itself."""
    words = tmp_path / "words.toml"
    words.write_text(TABLES, encoding="utf-8")
    vocabulary = world_vocabulary([str(words)])
    assert "Say" in find_servable(vocabulary, ros=False)
    assert "Announce" not in find_servable(vocabulary, ros=False)
    assert "Say" not in find_servable(vocabulary, ros=True)
    assert "Announce" in find_servable(vocabulary, ros=True)


def test_some_of_them():
    vocabulary = world_vocabulary()
    ids = find_servable(vocabulary, ros=False)
    assert choose_actions(["speech", "move_forward", "TurnLeft"], ids, vocabulary) == [
        "Say",
        "ReportBack",
        "SpeakLanguage",
        "Print",
        *(
            "Ask",
            "ListenForYesOrNo",
            "ListenFor",
            "Obey",
            "CallStaff",
            "RaiseAlarm",
            "GreetPerson",
            "TellPerson",
            "CountAloud",
        ),
        "MoveForward",
        "TurnLeft",
    ]
    with pytest.raises(ValueError, match=r"there is no action 'move_forwad'; similar: move_forward"):
        choose_actions(["move_forwad"], ids, vocabulary)
