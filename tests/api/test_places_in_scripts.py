"""Trees that are built in Python know their lines in the script."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import btlang
from btlang import action, leaf, parallel, repeat, script, sequence, timeout
from btlang.behavior import Behavior

HERE = Path(__file__)


@action
def stumble() -> None:
    raise btlang.ActionFailed("a shoe")


@action("lift {count} boxes", resources=["arms"])
def lift(count: int) -> None:
    """Lifts nothing."""


def line_of(words: str) -> int:
    """The line of this file that ends with a comment."""
    return 1 + next(at for at, line in enumerate(HERE.read_text().splitlines()) if line.endswith(f"# {words}"))


def messages(tree: Behavior) -> str:
    with pytest.raises(btlang.MissionError) as caught:
        tree.mission().check()
    return str(caught.value)


def test_an_error_names_the_line_of_its_node() -> None:
    tree = sequence(
        "wave",
        repeat(  # a round
            "nod",
            num_cycles="many",
        ),
    )
    assert messages(tree).startswith(f"{HERE}:{line_of('a round')}:9: error BT014: 'Repeat' is out of range")
    tree = sequence("wave", leaf("Wafe"))  # another leaf
    said = messages(tree)
    assert f"{HERE}:{line_of('another leaf')}:5: error BT130" in said
    assert 'Did you mean: tree = sequence("wave", leaf("Wave"))' in said


def test_an_error_in_a_text_names_the_line_and_the_text() -> None:
    tree = sequence("wave", "go to the moon")  # the moon
    assert messages(tree).startswith(f"{HERE}:{line_of('the moon')} <text>:1:11: error BT013")


def test_a_function_is_at_the_line_of_its_parent() -> None:
    tree = sequence(lift)  # a missing value
    assert f"{HERE}:{line_of('a missing value')}:5: error BT132" in messages(tree)


def test_a_conflict_names_both_nodes() -> None:
    said = messages(parallel(leaf(lift, 1), leaf(lift, 2)))  # both
    assert f"{HERE}:{line_of('both')}:5: error BT041: 'Lift' and 'Lift' both need the arms" in said, said
    assert "as children of a Sequence" in said


def test_a_failure_names_the_line() -> None:
    tree = timeout(
        sequence("wave", leaf(stumble)),  # a failure
        msec=90_000,
    )
    said = tree.run(speed="max").why().splitlines()
    assert said[1] == f"{HERE}:{line_of('a failure')}:9: stumble"
    assert said[4] == "  Stumble: a shoe"


def test_the_line_is_not_taken_for_the_words_of_a_node() -> None:
    tree = sequence(script(code="x := 1"), leaf("Say", text="hi"))
    mission = tree.mission()
    assert "tree" not in str(mission)
    assert repr(mission) == "<Mission 'Sequence', 3 nodes>"
    assert tree == sequence(script(code="x := 1"), leaf("Say", text="hi"))


def test_a_session_runs_a_function_at_its_own_line() -> None:
    with btlang.Session() as session:
        outcome = session.run(stumble, speed="max").outcome  # the run
    assert outcome is not None
    assert f"{HERE}:{line_of('the run')}:" in outcome.why()


def test_without_a_file_there_is_no_line() -> None:
    program = "import btlang; print(btlang.repeat('wave', num_cycles=-7).span)"
    environment = {**os.environ, "PYTHONPATH": str(HERE.parents[2])}
    done = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True)
    assert done.stdout in ("None\n", f"{program}\n")  # Python 3.13 knows the text
