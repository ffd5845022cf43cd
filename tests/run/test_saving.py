"""A run that is saved at any tick and goes on in another session, or another process, has the future that it had."""

from __future__ import annotations

import json
import multiprocessing
from typing import Any

import pytest

import btlang
from btlang.diagnostics.errors import MissionError
from btlang.engine.status import RUNNING
from btlang.run.events import Event, Printed, Said
from btlang.session import Run, Session

TALK = """
greeting is say "hello" then wait 0.3 s
whenever {n} = 2, say "two"
set n to 0
repeat 4 times: set n to {n} + 1 then greeting then say "{n}"
"""
MISSIONS = {
    "counts, rules and values": TALK,
    "retries and limits": """
        try to (wait 0.2 s then go to the moon pool) up to 3 times, otherwise say "no way"
        for 1 s: say "again" then wait 0.3 s
    """.replace("go to the moon pool", "pick up the ball"),
    "choices": 'repeat 5 times: choose a random place as goal then say "{goal}" then wait 0.1 s',
    "side by side": 'say "a" then wait 1 s and meanwhile repeat 3 times: say "b" then wait 0.2 s',
    "lists": 'for each place: say "{place}" then wait 0.1 s',
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


def interrupted_future(text: str, ticks: int) -> tuple[list[tuple[float, str]], str]:
    """What is said after a pause behind so many ticks, and what was saved there."""
    events: list[Event] = []
    with Session() as session:
        run = session.prepare(btlang.parse_tree(text), speed="max", seed=5, sinks=[events.append])
        ticked(run, ticks)
        saved = json.dumps(run.save())
        run.nodes.suspend()
        before = len(events)
        ticked(run, 3000)
        return told(events[before:]), saved


def restored_future(text: str, saved: str) -> list[tuple[float, str]]:
    events: list[Event] = []
    with Session() as session:
        run = session.restore(btlang.parse_tree(text), json.loads(saved), speed="max", sinks=[events.append])
        ticked(run, 3000)
    return told(events)


@pytest.mark.parametrize("text", MISSIONS.values(), ids=MISSIONS)
def test_it_goes_on_as_after_a_pause(text: str) -> None:
    ticks, futures = 1, []
    while ticks == 1 or futures[-1]:
        future, saved = interrupted_future(text, ticks)
        assert restored_future(text, saved) == future
        futures.append(future)
        ticks += 3
    assert len(futures) > 3


def test_in_another_process() -> None:
    futures = [interrupted_future(TALK, ticks) for ticks in range(1, 30, 4)]
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        restored = pool.starmap(restored_future, [(TALK, saved) for _, saved in futures])
    assert restored == [future for future, _ in futures]


def test_a_run_that_goes_on_is_saved_between_two_ticks_and_suspended() -> None:
    mission = btlang.parse_tree('repeat 3 times: say "now" then wait 0.5 s')
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
