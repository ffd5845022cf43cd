"""Facts: places of a mission."""

from __future__ import annotations

import pytest

import btlang
from btlang.engine.status import FAILURE, SUCCESS
from btlang.repl.draft import MissionDraft
from tests.trial import Trial


def test_a_place_may_be_used_before_it_is_given() -> None:
    tree = Trial("go to the pantry\nthe pantry is at (3, 4) looking 90 degrees")
    assert tree.run(speed="max").status == SUCCESS
    pose = tree.robot.pose
    assert (round(pose.x, 1), round(pose.y, 1), round(pose.heading / 10) * 10) == (3.0, 4.0, 90)


@pytest.mark.parametrize(
    ("fact", "x", "y", "facing"),
    [
        ("the lab door is at (3, 4)", 3, 4, None),
        ("Home is located at (1.5 m, -20 cm) facing 180 degrees", 1.5, -0.2, None),
        ("robot, home is at (two, half a meter) facing -90 degrees", 2, 0.5, -90),
    ],
)
def test_facts(fact: str, x: float, y: float, facing: float | None) -> None:
    for parser in ("shunting-yard", "lark"):
        tree = btlang.parse_tree(f"{fact}.\nwave", parser=parser)
        (found,) = tree.facts
        assert (found.x, found.y) == (x, y)
        if facing is not None:
            assert found.facing == facing


def test_a_fact_takes_the_place_of_a_place_of_the_world() -> None:
    tree = Trial("the lab is at (3, 1.5); the lab is at (2.5, 1.5); go to the lab")
    tree.run(speed="max")
    assert round(tree.robot.pose.x, 1) == 2.5


def test_a_place_outside_of_the_world() -> None:
    outcome = btlang.parse_tree("moon is at (1e6, 1e6); go to the moon").run(speed="max")
    assert outcome.status == FAILURE
    assert outcome.failure is not None
    assert "no free way" in outcome.failure.reason


def test_a_text_of_facts_alone_has_no_command() -> None:
    with pytest.raises(btlang.MissionError) as caught:
        btlang.parse_tree("moon is at (1, 1)")
    assert [problem.code for problem in caught.value.diagnostics] == ["BT005"]


def test_a_session_keeps_facts() -> None:
    session = MissionDraft()
    session.add(session.compile("corner is at (3, 4)").entry)
    compiled = session.compile("go to the corner")
    assert compiled.mission.run(speed="max").status == SUCCESS
    session.add(compiled.entry)
    session.add(session.compile("corner is at (3, 1.5)").entry)
    assert session.text == "go to the corner\ncorner is at (3, 1.5)\n"
    assert [entry.definitions for entry in session.entries_of(session.text)] == [
        entry.definitions for entry in session.entries
    ]
