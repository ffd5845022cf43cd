"""`is not`, and what else says that a condition does not hold."""

from __future__ import annotations

import pytest

from btlang.api import parse_tree
from btlang.tree.dump import plain


@pytest.mark.parametrize("parser", ["shunting-yard", "lark"])
@pytest.mark.parametrize(
    "text",
    [
        "check not battery is low",
        "check the battery is not low",
        "check the battery isn't low",
        "check that it is not true that the battery is low",
    ],
)
def test_negated(text: str, parser: str) -> None:
    assert plain(parse_tree(text, parser=parser).tree) == "Inverter\n  BatteryLow"


def test_negated_with_a_slot_and_joined() -> None:
    tree = parse_tree("if you are not holding the cup and the robot is not at the dock, wave").tree
    assert plain(tree).splitlines()[1:6] == [
        "  Sequence",
        "    Inverter",
        "      Holding object=cup",
        "    Inverter",
        "      AtPlace place=dock",
    ]


def test_a_definition_by_a_negated_condition() -> None:
    tree = parse_tree("awake is the battery is not low\ncheck awake").tree
    assert plain(tree) == "SubTree ID=awake\nBehaviorTree ID=awake\n  Inverter\n    BatteryLow"


@pytest.mark.parametrize("text", ["print a then wave", "print the then wave"])
def test_an_article_can_be_the_text(text: str) -> None:
    article = text.split()[1]
    assert plain(parse_tree(text).tree) == f"Sequence\n  Print text={article}\n  Wave"
