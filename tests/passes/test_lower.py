"""What skipping does to the tree, and checks that look through names."""

from __future__ import annotations

import pytest

from btlang.api import parse_tree
from btlang.diagnostics.diagnostic import MissionError
from btlang.tree.dump import plain
from btlang.tree.node import Node


def ids(node: Node) -> object:
    """A tree as nested tuples of ids."""
    return (node.id, *map(ids, node.children)) if node.children else node.id


def test_fallbacks_are_flat() -> None:
    flat = ("Fallback", "Wave", "Nod", "Stop")
    assert ids(parse_tree("try to wave, otherwise nod, otherwise stop").tree.root) == flat
    assert ids(parse_tree("wave otherwise nod otherwise stop").tree.root) == flat


SKIP = ("IfThenElse", "WallInFront", "Wave", "AlwaysSuccess")
ROUND = ("Sequence", SKIP, "AlwaysSuccess")


@pytest.mark.parametrize(
    ("text", "tree"),
    [
        ("repeat: wave if wall in front", ("Repeat", ROUND)),
        ("retry 2 times: wave if wall in front", ("RetryUntilSuccessful", ROUND)),
        ("while bumped, wave if wall in front", ("WhileDoElse", "Bumped", ("Repeat", ROUND), "AlwaysSuccess")),
        ("(wave if wall in front) within 3 s", ("Timeout", ROUND)),
        ("(wave if wall in front) for 3 s", ("Parallel", "Sleep", ("Repeat", ROUND))),
        ("every 3 s, wave if wall in front", ("Repeat", ("Parallel", ROUND, "Sleep"))),
        ("(wave if wall in front) and nod", ("Parallel", ROUND, "Nod")),
        ("after 3 s, wave if wall in front", ("Delay", SKIP)),
        ("repeat: try wave if wall in front", ("Repeat", ("Sequence", ("ForceSuccess", SKIP), "AlwaysSuccess"))),
        ("repeat: (wave if wall in front) or nod", ("Repeat", ("Fallback", SKIP, "Nod"))),
        ("repeat: (wave if wall in front) then nod", ("Repeat", ("Sequence", SKIP, "Nod"))),
        (
            "repeat: (wave if wall in front) then (wave if wall in front)",
            ("Repeat", ("Sequence", ("Sequence", SKIP, SKIP), "AlwaysSuccess")),
        ),
        ("timid is wave if wall in front; repeat timid", ("Repeat", ("Sequence", "SubTree", "AlwaysSuccess"))),
    ],
)
def test_a_skipped_round_counts_as_a_round(text: str, tree: object) -> None:
    assert ids(parse_tree(text).tree.root) == tree


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("move forward 2 m then twist right", "MOVE FORWARD two meters, spin right!"),
        ("if wall in front, wave", "wave if there is a wall ahead"),
        ("while bumped, wave", "wave as long as the robot is bumped"),
        ("repeat wave 2 times", "wave twice"),
        ("wave before nod", "nod after wave"),
        ("turn left", "turn left by 90 degrees"),
        ("round is wave then nod\nround", "round means:\n   wave\n   nod\nplease round"),
    ],
)
def test_texts_of_one_meaning_print_the_same(one: str, other: str) -> None:
    assert plain(parse_tree(one).tree) == plain(parse_tree(other).tree)


def test_resources_are_found_through_names_and_forms() -> None:
    together = "(slow spin twice) and wave and go to the lab at the same time"
    text = f"spin is turn left\nslow spin is after 1 s, spin\nif bumped, ({together})"
    with pytest.raises(MissionError, match="'slow spin' and 'go to the lab' both need the base at the same time"):
        parse_tree(text)
    parse_tree("wave and go to the lab and say hello and look around at the same time")


def test_all_circles_are_told() -> None:
    with pytest.raises(MissionError) as caught:
        parse_tree("a1 is b1\nb1 is c1 then a1\nc1 is wave\nx1 is x1\na1")
    messages = [problem.message for problem in caught.value.diagnostics]
    assert messages == [
        "'a1' is defined in terms of itself: 'a1' uses 'b1' uses 'a1'.",
        "'x1' is defined in terms of itself: 'x1' uses 'x1'.",
    ]
