"""Whoever joins late or reads slowly sees what those see who were there; the page has the same reducer."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from btlang.server.live.client_queue import ClientQueue, RobotNews
from btlang.server.live.robot_view import STATES, RobotView
from tests.profiles import searches

CASES = json.loads(Path(__file__).with_name("robot_views.json").read_text(encoding="utf-8"))
UNKNOWN: dict[str, Any] = {
    "up": False, "run": None, "rules": None, "state": None, "map": None, "things": [], "asking": "", "scan": None,
    "parts": {"components": [], "devices": []}, "joints": [], "speech": {"text": "", "start": 0, "end": 0}, "way": [],
    "values": {}, "doing": {"task": 0, "goal": "", "says": "", "heard": ""},
}  # fmt: skip
"""What the page knows of a robot in the beginning."""
RENAMED = {"robot": "state", "components": "parts"}
ONLY = {"things": "things", "values": "values", "asking": "text", "way": "points", "joints": "positions"}


def view_of(messages: list[dict[str, Any]]) -> RobotView:
    view = RobotView()
    for message in messages:
        view.take(message)
    return view


def state(view: RobotView) -> dict[str, Any]:
    """What is known, as the page has it."""
    found: dict[str, Any] = {**UNKNOWN, "up": view.is_up}
    for is_task, run in view.runs.items():
        statuses = view.statuses.get(run["run"], {})
        changes, words = dict(statuses.get("changes", ())), dict(statuses.get("words", ()))
        found["run" if is_task else "rules"] = {
            "id": run["run"], "task": run["task"],
            "statuses": [changes.get(index, "IDLE") for index in range(len(run["nodes"]))],
            "words": [words.get(index, node[2]) for index, node in enumerate(run["nodes"])],
        }  # fmt: skip
    for kind, message in view.states.items():
        fields = {name: value for name, value in message.items() if name not in ("type", "robot")}
        found[RENAMED.get(kind, kind)] = fields[ONLY[kind]] if kind in ONLY else fields
    return found if view.is_up else {**found, "state": None}


def slowly(messages: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """What somebody gets who reads once, at the end."""
    outlet = ClientQueue()
    for message in messages:
        outlet.put(RobotNews("robot", message))
    return [json.loads(text) for text in outlet.take()]


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_the_state_after_messages(case: dict[str, Any]) -> None:
    assert state(view_of(case["messages"])) == {**UNKNOWN, **case["state"]}


NODES = [["/", "Sequence", "Sequence"], ["/0", "Wave", "wave"], ["/1", "Nod", "nod"]]
STATUSES = st.tuples(st.integers(0, 2), st.sampled_from(["IDLE", "RUNNING", "SUCCESS", "FAILURE", "SKIPPED"]))
WORDS = st.tuples(st.integers(0, 2), st.sampled_from(["go to lab", "go to hall"]))


def begun(task: int) -> dict[str, Any]:
    return {"type": "run", "run": f"t{task}" if task else "r0", "task": task, "nodes": NODES, "prepared": []}


def changed(run: str, changes: list[tuple[int, str]], words: list[tuple[int, str]]) -> dict[str, Any]:
    message = {"type": "statuses", "run": run, "t": 1.0, "changes": [*map(list, changes)]}
    return {**message, "words": [*map(list, words)]} if words else message


MESSAGES = st.one_of(
    st.builds(begun, st.integers(0, 2)),
    st.builds(
        changed, st.sampled_from(["t1", "t2", "r0"]), st.lists(STATUSES, max_size=3), st.lists(WORDS, max_size=2)
    ),
    st.sampled_from([{"type": "asking", "text": text} for text in ("", "Tea?")]),
    st.sampled_from([{"type": "doing", "task": 1, "goal": goal, "says": "", "heard": ""} for goal in ("", "lab")]),
    st.just({"type": "up", "change": 1}),
    st.just({"type": "away"}),
    st.just({"type": "change", "number": 4, "task": 1, "state": "queued"}),
)


@searches(100, 5_000, deadline=None)
@given(messages=st.lists(MESSAGES, max_size=12))
def test_who_joins_late_sees_what_others_see(messages: list[dict[str, Any]]) -> None:
    view = view_of([{"type": "up", "change": 0}, *messages])
    late = view_of(view.messages())
    assert state(late) == (state(view) if view.is_up else UNKNOWN)
    assert late.change == (view.change if view.is_up else None)
    assert late.messages() == view.messages()


@searches(100, 5_000, deadline=None)
@given(messages=st.lists(MESSAGES, max_size=12))
def test_who_reads_slowly_sees_what_others_see(messages: list[dict[str, Any]]) -> None:
    messages = [{"type": "up", "change": 0}, *messages]
    assert state(view_of(slowly(messages))) == state(view_of(messages))


def test_every_kind_of_state_is_in_the_cases() -> None:
    assert {message["type"] for case in CASES for message in case["messages"]} >= {*STATES} - {"map"}
