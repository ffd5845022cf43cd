"""What a picture of a run knows: commands, places, things that moved, statuses."""

from __future__ import annotations

import pytest

from btlang.api import parse_tree
from btlang.engine.changes import Changes
from btlang.engine.clock import Clock
from btlang.engine.engine import Engine
from btlang.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS
from btlang.pictures.run_picture import numbers
from btlang.pictures.run_record import LastStatuses, RunRecord, Sighting, by_definition
from btlang.pictures.track import place_of, sighting_at, ways
from btlang.robots.geometry import Point
from btlang.robots.worlds.world_file import load_world
from btlang.run.events import StatusesChanged
from btlang.session import Session
from btlang.text.source import Source
from btlang.tree.node import Node, Tree
from tests.trial import Trial
from tests.world.worlds import LIVELY


def recorded(mission: str, time_limit: float | None = None) -> tuple[RunRecord, dict[str, int]]:
    trial = Trial(mission)
    record, statuses = RunRecord(trial.mission.label, trial.mission.is_action), LastStatuses()
    trial.run(speed="max", sinks=[record, statuses], time_limit=time_limit)
    assert trial.sink_errors == []
    return record, statuses.by_path


def test_commands_are_numbered_and_know_how_they_ended() -> None:
    record, _ = recorded("move forward 1 m, wait 1 s, print hi, grasp the cup if possible, then move forward 5 m", 9)
    found = [(c.number, c.text, c.status) for c in record.commands]
    assert found == [
        (1, "move forward 1 m", SUCCESS),
        (2, "wait 1 s", SUCCESS),
        (3, "print hi", SUCCESS),
        (4, "grasp cup", FAILURE),
        (5, "move forward 5 m", IDLE),
    ]
    assert "reach" in record.commands[3].reason
    assert record.commands[1].end - record.commands[1].start.t > 0.99
    assert record.ended is not None
    assert record.ended[0] == IDLE


def test_commands_say_the_values_that_they_had() -> None:
    record, _ = recorded("for each place in the kitchen, the lab: go to the place then say 'at {place}'")
    assert [c.text for c in record.commands] == ["go to kitchen", 'say "at kitchen"', "go to lab", 'say "at lab"']


def test_the_track_follows_the_robot() -> None:
    record, _ = recorded("move forward 1 m, wait 1 min, then turn left 90 degrees")
    first, last = record.track[0], record.track[-1]
    assert abs(last.pose.x - first.pose.x - 1) < 0.05
    assert abs(last.pose.heading - 90) < 3
    assert last.battery < first.battery
    assert len(record.track) < 300, "a robot that stands still gives one sample a second"


def test_things_lie_where_they_were_put() -> None:
    record, _ = recorded("go to the kitchen, pick up the cup, go to the office then put down the cup")
    place = record.moved["cup"]
    assert place is not None
    assert 9 < place[0] < 11
    assert [mark.kind for mark in record.marks] == ["grasp", "release"]
    assert recorded("pick up the cup")[0].moved == {"cup": None}
    assert recorded("open the hand")[0].marks == []


def test_bumps_and_speech_are_marked() -> None:
    record, _ = recorded("say hello then move forward until bumped then fail")
    assert [mark.kind for mark in record.marks] == ["say", "bump"]
    assert record.marks[0].text == "hello"
    assert record.ended is not None
    assert record.ended[0] == FAILURE


def test_people_doors_and_what_was_heard() -> None:
    text = 'ask Olga "Coffee?" then call the staff saying "One coffee" then close the door then wait 10 s'
    record, world = RunRecord(str, lambda node: True), Source(LIVELY, "lively.toml")
    with Session(world=world) as session:
        session.run(parse_tree(text, world=world), speed="max", sinks=[record], seed=3)
    vera = record.sightings["Vera"]
    assert vera[0] == Sighting(0.0, None, False)
    assert len(vera) < 100
    assert {each.seen for each in vera} == {True, False}
    [way] = ways(vera)
    assert way[0] == pytest.approx((9, 3.2), abs=0.2)
    assert way[-1] == pytest.approx((3, 3.2), abs=0.3)
    assert sighting_at(vera, -1.0).point is None
    passing = next(each for each in vera if each.point is not None and each.point[0] < 6)
    assert sighting_at(vera, passing.t + 0.01).point == pytest.approx(passing.point, abs=0.05)
    assert [(name, is_open) for _, name, is_open in record.doors] == [("door", False)]
    heard = [(mark.kind, mark.text, mark.who) for mark in record.marks]
    assert heard == [
        ("say", "Coffee?", ""),
        ("ask", "Coffee?", "Olga"),
        ("hear", "yes", "Olga"),
        ("call", "One coffee", ""),
    ]
    assert place_of(load_world(world), record, "Olga", 5.0) == (2.4, 2.8)
    assert place_of(load_world(world), record, "Nobody", 5.0) is None


def test_who_leaves_and_comes_back_walked_twice() -> None:
    def seen(*points: Point | None) -> list[Sighting]:
        return [Sighting(float(t), point, True) for t, point in enumerate(points)]

    assert ways(seen((0, 0), (0.5, 0), None, (4, 0), (4, 0.5))) == [[(0, 0), (0.5, 0)], [(4, 0), (4, 0.5)]]
    assert ways(seen((0, 0), (0, 0), (9, 9))) == []  # it was put there
    assert ways([]) == []


def test_last_statuses() -> None:
    _, statuses = recorded("greet is wave then nod; if bumped, wave; greet; move forward 9 m; wave", 8)
    named = {path: statuses.get(path) for path in ("/0", "/0/0", "/0/1", "/1", "/1/0", "/1/0/1", "/2", "/3")}
    assert named == {
        "/0": SKIPPED,
        "/0/0": FAILURE,
        "/0/1": None,
        "/1": SUCCESS,
        "/1/0": SUCCESS,
        "/1/0/1": SUCCESS,
        "/2": IDLE,
        "/3": None,
    }


def test_a_reset_is_no_status() -> None:
    sink, engine = LastStatuses(), Engine(Tree(Node("AlwaysSuccess")), lambda id: None, clock=Clock())
    for status in (RUNNING, SUCCESS, IDLE):
        changes = Changes()
        changes.add(0, IDLE, status)
        sink(StatusesChanged(0.0, "", 0, 0.0, changes, engine))
    assert sink.by_path == {"/": SUCCESS}


def test_a_definition_shows_the_latest_of_its_uses() -> None:
    call = Node("SubTree", ports=(("ID", "job"),))
    tree = Tree(Node("Fallback", (call, call)), (("job", Node("Sequence", (Node("A"), Node("B")))),))
    statuses = {"/0/0/0": FAILURE, "/0/0": FAILURE, "/0": FAILURE, "/1/0/1": SUCCESS, "/1/0": SUCCESS, "/": SUCCESS}
    assert by_definition(statuses | {"/7": SUCCESS}, tree) == {
        ("job", "/0"): FAILURE,
        ("job", "/"): SUCCESS,
        ("", "/0"): FAILURE,
        ("job", "/1"): SUCCESS,
        ("", "/"): SUCCESS,
    }


def test_numbers_are_joined() -> None:
    assert numbers([1]) == "1"
    assert numbers([1, 2, 3, 7]) == "1\N{EN DASH}3, 7"
    assert numbers([1, 3, 5, 7, 9]) == "1, 3, 5, …"
