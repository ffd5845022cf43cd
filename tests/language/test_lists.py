"""Lists in one slot distribute: one command, a Sequence with `and`, a Fallback with `or`."""

from __future__ import annotations

import pytest

import btlang
from btlang.tree.dump import plain

THREE = "GoTo place=lobby|GoTo place=lab|GoTo place=dock"


def tree_of(text: str) -> str:
    """One line, levels as brackets; both parsers."""
    trees = {plain(btlang.parse_tree(text, parser=parser).tree) for parser in ("shunting-yard", "lark")}
    (tree,) = trees
    return tree.replace("\n", "|")


@pytest.mark.parametrize(
    ("text", "tree"),
    [
        ("go to the lobby, the lab and the dock", f"Sequence|{THREE}"),
        ("go to the lobby, the lab, and the dock", f"Sequence|{THREE}"),
        ("go to the lobby, the lab, the dock", f"Sequence|{THREE}"),
        ("go to the lobby and the lab and the dock", f"Sequence|{THREE}"),
        ("go to the lobby, the lab or the dock", f"Fallback|{THREE}"),
        ("go to the lobby and the lab twice", "Repeat num_cycles=2|Sequence|GoTo place=lobby|GoTo place=lab"),
        ("go to the lobby, the lab and wave", "Sequence|Sequence|GoTo place=lobby|GoTo place=lab|Wave"),
        ("go to the lobby and wave", "Sequence|GoTo place=lobby|Wave"),
        ("go to the lobby, then go to the lab", "Sequence|GoTo place=lobby|GoTo place=lab"),
        ("go to the lobby and say lab", "Sequence|GoTo place=lobby|Say text=lab"),
        ("go to Alice or Bob", "Fallback|GoToPerson person=Alice|GoToPerson person=Bob"),
        ("go to the living room and the lab", 'Sequence|GoTo place="living room"|GoTo place=lab'),
        (
            "move forward 1 m, 2 m and 30 cm",
            "Sequence|MoveForward distance=1|MoveForward distance=2|MoveForward distance=0.3",
        ),
        ("say hello and wave", "Parallel|Say text=hello|Wave"),
        ("check holding the cup or the book", "Fallback|Holding object=cup|Holding object=book"),
        ("check not holding the cup and the book", "Inverter|Sequence|Holding object=cup|Holding object=book"),
        (
            "check the distance to the cup or the book is below 1 m",
            "Fallback|DistanceToObject below=1 object=cup|DistanceToObject below=1 object=book",
        ),
        ("check the battery is between 1% and 2%", "Battery at_least=1 at_most=2"),
        ("go to the lobby if at the lab or the hall", None),
    ],
)
def test_lists(text: str, tree: str | None) -> None:
    found = tree_of(text)
    if tree is not None:
        assert found.replace("  ", "") == tree


def test_a_list_is_one_command() -> None:
    found = plain(btlang.parse_tree("go to the lobby and the lab then go to the dock").tree)
    assert found.splitlines()[1:4] == ["  Sequence", "    GoTo place=lobby", "    GoTo place=lab"]


def test_a_list_ends_before_a_longer_phrase() -> None:
    found = tree_of("lab tour is nod\ngo to the lobby and lab tour")
    assert found.startswith("Sequence|  GoTo place=lobby|  SubTree")


@pytest.mark.parametrize(
    "text", ["wait 2 s and 3 s", "wave 2 and 3 times", "go to the lobby, the", "go to the lobby and"]
)
def test_what_takes_no_list(text: str) -> None:
    with pytest.raises(btlang.MissionError):
        btlang.parse_tree(text)


def test_a_list_ends_before_a_command_without_an_article() -> None:
    """`dock` is a command and a place."""
    assert plain(btlang.parse_tree("if you are at the kitchen, dock").tree).splitlines()[:3] == [
        "IfThenElse",
        "  AtPlace place=kitchen",
        "  Dock",
    ]
    assert plain(btlang.parse_tree("go to the lab, the dock").tree) == "Sequence\n  GoTo place=lab\n  GoTo place=dock"
