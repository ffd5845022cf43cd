"""Trees that are built in Python."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

import btlang
from btlang import (
    PUBLIC,
    action,
    builders,
    condition,
    fallback,
    if_then_else,
    leaf,
    parallel,
    repeat,
    sequence,
    sub_tree,
    timeout,
    whenever,
)
from btlang.tree.catalogue import CATALOGUE
from btlang.tree.dump import plain
from btlang.tree.node import Node

DONE: list[object] = []


@action("cheer for {person} {count} times", id="CheerFor")
def cheer(person: str, count: int = 1) -> None:
    DONE.append((person, count))


@action("shout")
def shout() -> None:
    DONE.append("shout")


@condition("somebody shouted")
def shouted() -> bool:
    return "shout" in DONE


def test_a_tree_of_functions_texts_and_nodes_runs() -> None:
    DONE.clear()
    tree = sequence(
        fallback(shouted, shout),
        leaf(cheer, "Alice", count=2),
        "cheer for Bob 3 times then say hello",
        Node("Say", ports=(("text", "bye"),)),
        btlang.parse_tree("shout", keywords=[shout]),
    )
    assert tree.run(speed="max").succeeded
    assert DONE == ["shout", ("Alice", 2), ("Bob", 3), "shout"]
    with btlang.Session() as session:
        assert session.run(tree, speed="max").outcome.succeeded  # type: ignore[union-attr]
        assert session.run(shout, speed="max").outcome.succeeded  # type: ignore[union-attr]


def test_it_is_the_tree_of_the_same_english() -> None:
    tree = whenever("the battery is low", "go to the dock", repeat(sequence("wave", "nod"), num_cycles=2))
    english = tree.to("english")
    assert isinstance(english, str)
    assert plain(btlang.parse_tree(english).tree) == plain(tree.mission().tree)
    xml = tree.to("xml")
    assert isinstance(xml, str)
    assert '<Repeat num_cycles="2">' in xml
    assert "Whenever" in str(tree)


def test_a_text_may_be_a_condition() -> None:
    tree = fallback("the battery is not low", "the battery is above 20% and not bumped", "dock")
    assert plain(tree.mission().tree) == plain(
        btlang.parse_tree(
            "(check the battery is not low) or (check the battery is above 20% and not bumped) or dock"
        ).tree
    )
    with pytest.raises(btlang.MissionError, match="BT164"):
        fallback("the battery is purple", "dock").mission()


@btlang.quantity("the noise here", type="number")
def noise() -> float:
    return 7.0


def test_a_text_may_use_functions_of_the_script_that_are_no_leaves() -> None:
    tree = sequence("if the noise here is above 5, wave", shout)
    assert tree.run(speed="max").succeeded
    with pytest.raises(btlang.MissionError, match=r"BT010.*fly") as caught:
        sequence("if the noise here is above 5, fly").mission()
    assert len(caught.value.diagnostics) == 1


def test_ports_are_texts_in_the_tree() -> None:
    tree = timeout(parallel("wave", "nod", success_count=1, name="both"), msec=1500, _skipIf="x > 3")
    assert dict(tree.ports) == {"msec": "1500", "_skipIf": "x > 3"}
    assert plain(tree.mission().tree).splitlines()[1] == "  Parallel name=both success_count=1"
    assert dict(whenever("bumped", "wave", "nod", once=True).ports) == {"once": "true"}
    assert len(if_then_else("bumped", "wave").children) == 2


def test_named_trees() -> None:
    tree = sequence(sub_tree(ID="Greet"), "greeting means: nod\ngreeting")
    mission = tree.mission(subtrees={"Greet": "wave"})
    assert {name for name, _ in mission.tree.subtrees} >= {"Greet"}
    mission.check()
    with pytest.raises(btlang.MissionError, match="BT127"):
        sequence("greeting means: nod\ngreeting", "greeting means: wave\ngreeting").mission()
    with pytest.raises(btlang.MissionError, match="BT126"):
        sub_tree(ID="Greet").run(speed="max")


def test_a_replacing_function_without_an_id() -> None:
    done = []

    @action("go to {place}", replace=True)
    def fake(place: str) -> None:
        done.append(place)

    assert sequence(leaf(fake, "lab"), "go to the kitchen").run(speed="max").succeeded
    assert done == ["lab", "kitchen"]

    @action("wave", replace=True)
    def fake_wave() -> None:
        done.append("wave")

    with btlang.Session() as session:
        assert session.run(fake_wave, speed="max").outcome.succeeded  # type: ignore[union-attr]
    assert done[2:] == ["wave"]


@action("{manner} weld part {number}", slots={"manner": "text"})
def weld(number: int, manner: str = "slow") -> Iterator[None]:
    yield


@action("listen to {text}")
async def listen(text: str) -> None:
    """Nothing is heard."""


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: repeat("wave", "nod"), "positional"),
        (lambda: sequence(), "Sequence takes at least 1 child, not 0"),
        (lambda: builders.recovery_node("wave"), "RecoveryNode takes 2 children, not 1"),
        (lambda: sequence(3), "can't be a part of a tree"),
        (lambda: sequence(print), "print can't be a part of a tree"),
        (lambda: repeat(weld(1), num_cycles=2), r"weld can't be a part of a tree; give .*: leaf\(weld, 'slow', 1\)$"),
        (lambda: sequence(weld(2, "fast")), r"leaf\(weld, 'fast', 2\)"),
        (lambda: sequence(listen("x")), r"leaf\(listen, 'x'\)"),
        (lambda: repeat(shout(), num_cycles=2), r"None can't be a part of a tree; .* leaf\(function, value\)"),  # type: ignore[func-returns-value]
        (lambda: sequence("wave", None), "None can't be a part of a tree"),  # type: ignore[arg-type]
        (lambda: builders.if_then_else(None, "wave", "nod"), "None can't be a part of a tree"),  # type: ignore[arg-type]
        (lambda: sequence(["wave"]), r"a list can't be a part of a tree; .* sequence\(\*children\)"),  # type: ignore[arg-type]
        (lambda: repeat("wave", times=3, num_cycles=1), "Repeat has no port 'times', but num_cycles$"),
        (lambda: repeat("wave", times=3), "Repeat has no port 'times'"),
        (lambda: repeat("wave", num_cycles=[]), "num_cycles is a text, a number or a bool, not a list"),
        (lambda: leaf(cheer, "Bob", number=3), "CheerFor takes person, count, not 'number'"),
        (lambda: leaf(shout, 1), "Shout takes no values, not 1 values"),
        (lambda: leaf("GoTo", "lab"), "set by their names"),
    ],
)
def test_what_does_not_fit_is_refused_at_once(call: Any, said: str) -> None:
    with pytest.raises(TypeError, match=said):
        call()


def test_mistakes_in_texts_and_values() -> None:
    with pytest.raises(btlang.MissionError, match="BT013"):
        sequence("go to the moon").mission()
    with pytest.raises(btlang.MissionError, match="BT130"):
        leaf("Fly").run()
    with pytest.raises(btlang.MissionError, match="BT014"):
        repeat("wave", num_cycles=-7).run()


def test_depth_does_not_matter() -> None:
    tree: Any = "wave"
    for _ in range(3000):
        tree = builders.force_success(tree)
    assert sum(1 for _ in tree.mission().tree.walk()) == 3001


def test_each_public_name_is_listed_once_and_there() -> None:
    listed = [name for names in PUBLIC.values() for name in names]
    assert sorted(listed) == btlang.__all__ == sorted(set(listed))
    assert all(getattr(btlang, name) is not None for name in listed)
    assert set(PUBLIC["btlang.builders"]) == set(builders.__all__) == {"leaf", *map(builders.builder_name, CATALOGUE)}
    assert repr(sequence("wave", "nod")) == "<Behavior Sequence, 2 children>"


@pytest.mark.parametrize(
    ("call", "reason"),
    [
        (lambda: leaf("GoTo", place=3), "place must be the name of a place, not the value 3"),
        (lambda: leaf("Say", text=True), "text must be a text, not the value true"),
        (lambda: leaf(cheer, 5), "person must be the name of a person, not the value 5"),
        (lambda: leaf("GoTo", place="moon"), "there is no place 'moon'"),
        (lambda: leaf(cheer, "Zed"), "there is no person 'Zed'"),
        (lambda: leaf("GoTo", plce="lab"), "GoTo takes no port plce"),
        (lambda: leaf("MoveForward", distance="far"), "distance cannot be 'far': a number is needed"),
        (lambda: leaf("MoveForward", distance=True), "distance cannot be 'true': a number is needed"),
        (lambda: leaf(weld, "slow", 1.5), r"number cannot be '1\.5': a whole number is needed"),
        (lambda: builders.parallel("wave", "nod", success_count="x"), "success_count must be a whole number"),
        (lambda: sequence("wave", _skipIf=1), "_skipIf must be a script, not the value 1"),
    ],
)
def test_ports_that_do_not_fit_are_errors_at_the_line_of_the_script(call: Any, reason: str) -> None:
    line = call.__code__.co_firstlineno
    with pytest.raises(btlang.MissionError, match=reason) as raised:
        sequence("wave", call()).mission()
    [problem] = raised.value.diagnostics
    assert problem.code == "BT132"
    assert problem.span.place.startswith(f"{__file__}:{line}:")


def test_an_unknown_node_may_be_written_for_other_programs() -> None:
    assert '<Fly height="2"/>' in leaf("Fly", height=2).to("xml")
    assert leaf("GoTo", place="{goal}").mission().label
