"""Quantities: compared by the language, bound to a function that gives a number."""

from __future__ import annotations

from pathlib import Path

import pytest

import btlang
from btlang.backends.engine import bind_leaf, compare_quantity
from btlang.diagnostics.diagnostic import MissionError
from btlang.engine.clock import Clock
from btlang.engine.engine import Engine
from btlang.engine.instance import EngineError
from btlang.engine.leaves.leaf import Failed, Unknown, reason_text
from btlang.engine.status import FAILURE, SUCCESS
from btlang.tree.dump import plain
from btlang.tree.node import Node, Tree
from tests.trial import Trial


@pytest.mark.parametrize(
    ("condition", "node"),
    [
        ("the battery is below 20%", "Battery below=20"),
        ("battery level is less than 20 percent", "Battery below=20"),
        ("the battery drops below twenty percent", "Battery below=20"),
        ("the battery is more than half a percent", "Battery above=0.5"),
        ("the battery is at least 20%", "Battery at_least=20"),
        ("the battery is 20% or less", "Battery at_most=20"),
        ("the battery is 20%", "Battery equal=20"),
        ("the distance ahead is between 50 cm and 2 m", "DistanceAhead at_least=0.5 at_most=2"),
        ("the distance to the living room is under 1 m", 'DistanceToPlace below=1 place="living room"'),
        ("the number of people nearby is 0", "PeopleNear equal=0"),
    ],
)
def test_comparisons(condition: str, node: str) -> None:
    for parser in ("shunting-yard", "lark"):
        assert plain(btlang.parse_tree(f"check {condition}", parser=parser).tree) == node
        negated = btlang.parse_tree(f"wave if not {condition}", parser=parser).tree.root.children[0]
        assert negated.id == "Inverter"
    tree = btlang.parse_tree(f"check {condition}")
    assert plain(btlang.parse_tree(f"check {tree.label(tree.tree.root)}").tree) == node  # reads back


def test_negation_stands_inside_too() -> None:
    assert plain(btlang.parse_tree("check the battery is not below 20%").tree) == "Inverter\n  Battery below=20"
    assert plain(btlang.parse_tree("check the battery isn't between 2% and 3%").tree).startswith("Inverter\n  Battery")


def test_a_quantity_at_line_start_compares_and_defines_nothing() -> None:
    for text in ("the battery is below 20%", "battery is 20% then wave"):
        with pytest.raises(MissionError) as caught:
            btlang.parse_tree(text)
        assert caught.value.diagnostics[0].code == "BT028"
    tree = btlang.parse_tree("tired is the battery is below 20%\nwave unless tired").tree
    assert plain(tree).endswith("BehaviorTree ID=tired\n  Battery below=20")


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("check the battery is below 20", "BT011"),
        ("check the battery is below 2 m", "BT011"),
        ("check the battery is below", "BT012"),
        ("check the battery is below -1%", "BT014"),
        ("check the battery is nice", "BT010"),
        ("check the distance to the moon is below 2 m", "BT013"),
    ],
)
def test_wrong_values(text: str, code: str) -> None:
    with pytest.raises(MissionError) as caught:
        btlang.parse_tree(text)
    assert [problem.code for problem in caught.value.diagnostics] == [code]


@pytest.mark.parametrize(
    ("condition", "status"),
    [
        ("the battery is above 99%", SUCCESS),
        ("the battery is below 99%", FAILURE),
        ("the battery is 100%", SUCCESS),
        ("the battery is at least 100%", SUCCESS),
        ("the battery is at most 99.9%", FAILURE),
        ("the battery is between 99% and 100%", SUCCESS),
        ("the distance to the lobby is 1.5 m", SUCCESS),
        ("the distance to Alice is more than 10 m", FAILURE),
        ("the number of people nearby is less than 1", SUCCESS),
    ],
)
def test_they_hold_in_the_world(condition: str, status: int) -> None:
    assert btlang.parse_tree(f"check {condition}").run(speed="max").status == status


@pytest.mark.parametrize(
    ("condition", "reason"),
    [
        ("the battery is below 99%", "battery is 100%"),
        ("the battery is not at least 20%", "it is true"),
        ("the distance to the lobby is below 1 m", "distance to lobby is 1.5 m"),
        ("the distance to Alice is more than 10 m", "distance to Alice is 5.98 m"),
        ("the number of people nearby is 3", "number of people near is 0"),
        ("the distance to the place is below 1 m", "distance to lobby is 1.5 m"),
    ],
)
def test_what_was_read_is_the_reason(condition: str, reason: str) -> None:
    tree = btlang.parse_tree(
        f"look at {{place}} is check {condition.replace('the place', '{place}')}; look at the lobby"
    )
    failure = tree.run(speed="max").failure
    assert failure is not None
    assert failure.reason == reason


@pytest.mark.parametrize(
    ("ports", "value", "reason"),
    [
        ({"below": 20.0}, 20.04, "20"),
        ({"at_least": 20.0}, 19.96, "19.96"),
        ({"at_least": 20.0}, 19.12, "19.1"),
        ({"at_least": 20.0, "at_most": 30.0}, 12.3456, "12.3"),
        ({"above": 20.0}, 20.0, "20"),
        ({"below": 1.0}, float("inf"), "inf"),
    ],
)
def test_a_reading_is_rounded_so_that_it_still_fails(ports: dict[str, float], value: float, reason: str) -> None:
    refused = compare_quantity(lambda: value, lambda given, read: read)(**ports)
    assert isinstance(refused, Failed)
    assert reason_text(refused.reason) == reason


def test_a_reading_that_is_not_a_number_is_unknown() -> None:
    with pytest.raises(Unknown, match="it is not a number"):
        compare_quantity(lambda: float("nan"), lambda given, read: read)(above=1.0)


def test_they_stop_a_loop() -> None:
    tree = Trial("move forward 5 m until the distance ahead is less than 2 m")
    assert tree.run(speed="max").status == SUCCESS
    assert 1.7 < 6.0 - 0.2 - tree.robot.pose.x < 2.0  # the wall is at x = 6


def measured(id: str, **ports: str) -> Engine:
    """An engine of one condition, over the robot of a mission."""
    mission = btlang.parse_tree("wave")
    tree = Tree(Node(id, ports=tuple(ports.items())))
    services = {"robot": btlang.Session().robot}
    return Engine(tree, lambda id: bind_leaf(id, mission.vocabulary), clock=Clock(), services=services)


@pytest.mark.parametrize(
    ("ports", "status"),
    [({}, SUCCESS), ({"below": "20"}, FAILURE), ({"above": "20", "at_most": "100"}, SUCCESS)],
)
def test_what_was_measured_is_remembered_before_it_is_compared(ports: dict[str, str], status: int) -> None:
    engine = measured("Battery", value="{level}", **ports)
    assert engine.tick() == status
    assert engine.blackboard.get("level") == 100


def test_a_quantity_remembers_only_under_a_key() -> None:
    engine = measured("DistanceToPlace", value="{=}", place="lobby")
    assert engine.tick() == SUCCESS
    assert engine.blackboard.get("value") == 1.5
    with pytest.raises(EngineError, match=r"value is an output: it must be a \{key\}, not '20'"):
        measured("Battery", value="20")


def test_a_function_that_has_such_a_parameter_itself_is_no_quantity(tmp_path: Path) -> None:
    (tmp_path / "odd_load.py").write_text("def load(value=3):\n    return value\n", encoding="utf-8")
    words = tmp_path / "odd.toml"
    words.write_text(
        '[[quantity]]\nphrase = "load"\nid = "Load"\ntype = "length"\ncall = "odd_load:load"\n', encoding="utf-8"
    )
    with pytest.raises(MissionError, match="odd_load:load cannot be a quantity: duplicate parameter name"):
        btlang.parse_tree("check the load is below 3 m", keywords=[str(words)]).run(speed="max")
