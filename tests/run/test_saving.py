"""A run that is saved at any tick and goes on in another session, or another process, has the future that it had."""

from __future__ import annotations

import json
import multiprocessing
from typing import Any

import pytest

import btlang
from btlang.diagnostics.diagnostic import MissionError
from btlang.engine.status import RUNNING
from btlang.run.events import Event, Printed, Said
from btlang.session import Run, Session

TALK = """
greeting is say "hello" then wait 0.3 s
whenever n is 2, say "two"
set n to 0
repeat 4 times: increase n then greeting then say "{n}"
"""
MISSIONS = {
    "counts, rules and values": TALK,
    "retries and limits": """
        try to (wait 0.2 s then grasp the book) up to 3 times, otherwise say "no way"
        (repeat forever: say "again" then wait 0.3 s) for 5 s
    """,
    "choices": 'repeat 5 times: face a random place then say "there" then wait 0.1 s',
    "side by side": 'say "a" then wait 1 s and meanwhile repeat 3 times: say "b" then wait 0.2 s',
    "lists": 'for each room in lab, kitchen and lobby: say "{room}" then wait 0.1 s',
    "times of day": 'wait 0.2 s then wait until 9:01 then say "now"',
}


def told(events: list[Event]) -> list[tuple[float, str]]:
    return [(round(event.t, 3), event.text) for event in events if isinstance(event, Said | Printed)]


def ticked(run: Run, most: int) -> int:
    """Ticks it until it ends; returns how often, at most so often."""
    for count in range(most):
        if run.tick() != RUNNING:
            return count
    return most


def future(text: str, ticks: int, restores: bool) -> list[tuple[float, str]]:
    """What is said after a pause behind so many ticks, which in the end another run of the session may follow."""
    events: list[Event] = []
    mission = btlang.parse_tree(text)
    with Session() as session:
        run = session.prepare(mission, speed="max", seed=5, sinks=[events.append])
        ticked(run, ticks)
        saved = json.dumps(run.save())
        run.nodes.suspend()
        before = len(events)
        if restores:
            run = session.restore(mission, json.loads(saved), speed="max", sinks=[events.append])
        ticked(run, 3000)
    return told(events[before:])


def saved_after(text: str, ticks: int) -> str:
    with Session() as session:
        run = session.prepare(btlang.parse_tree(text), seed=5)
        ticked(run, ticks)
        return json.dumps(run.save())


def restored_future(text: str, saved: str) -> list[tuple[float, str]]:
    events: list[Event] = []
    with Session() as session:
        run = session.restore(btlang.parse_tree(text), json.loads(saved), speed="max", sinks=[events.append])
        ticked(run, 3000)
    return told(events)


@pytest.mark.parametrize("text", MISSIONS.values(), ids=MISSIONS)
def test_it_goes_on_as_after_a_pause(text: str) -> None:
    with Session() as session:
        length = ticked(session.prepare(btlang.parse_tree(text), speed="max", seed=5), 3000)
    for ticks in range(1, length, max(1, length // 12)):
        assert future(text, ticks, restores=True) == future(text, ticks, restores=False)


def test_in_another_process() -> None:
    ticks = range(1, 60, 6)
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        restored = pool.starmap(restored_future, [(TALK, saved_after(TALK, count)) for count in ticks])
    assert restored == [future(TALK, count, restores=False) for count in ticks]
    assert all(restored)


def test_a_run_that_goes_on_is_saved_between_two_ticks_and_suspended() -> None:
    mission = btlang.parse_tree('repeat 3 times: print "now" then wait 0.5 s')
    with Session() as session:
        run = session.start(mission, seed=1)
        saved: dict[str, Any] = {}
        while saved.get("now", 0.0) < 0.3:
            saved = run.save()
        run.suspend()
        outcome = run.wait(5)
        assert outcome is not None
        assert outcome.stopped == "suspended"
        later = run.save()
        assert later["now"] >= saved["now"]
        events: list[Event] = []
        assert session.restore(mission, later, speed="max", sinks=[events.append]).execute().succeeded
        assert len(told(events)) == 2


def test_what_can_not_be_saved_or_restored_is_said() -> None:
    mission, other = btlang.parse_tree("wait 1 s"), btlang.parse_tree("wait 1 s then wait 2 s")
    with Session() as session:
        run = session.prepare(mission)
        run.tick()
        saved = run.save()
        for wrong in ({}, {**saved, "format": 99}, {**saved, "nodes": {"x": 1}}, {**saved, "scopes": 3}):
            with pytest.raises(MissionError, match="BT193"):
                session.restore(mission, wrong)
        with pytest.raises(MissionError, match="BT193"):
            session.restore(other, saved)
        run = session.prepare(mission)
        run.tick()
        run.nodes.blackboard.set("thing", object())
        with pytest.raises(MissionError, match="BT192"):
            run.save()
