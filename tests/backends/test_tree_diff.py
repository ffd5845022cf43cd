"""What differs between two trees, in words."""

from __future__ import annotations

import pytest
from hypothesis import given

from btlang.api import parse_tree
from btlang.backends.tree_diff import find_differences
from btlang.passes import compile_mission
from btlang.recording.diff import words_of
from tests.language.letters import letters
from tests.printer.trees import missions as trees
from tests.profiles import searches

ROUND = "retry go to the lab up to 6 times; dock; nod"
CASES = {
    "nothing": (ROUND, f"# the same\n{ROUND.replace('; ', chr(10))}", []),
    "a step more": (ROUND, ROUND.replace("dock", "dock; wave"), ["new step 'wave' behind 'dock'"]),
    "a step at the start": (ROUND, f"wave; {ROUND}", ["new step 'wave' before 'retry go to lab 6 times'"]),
    "a step less": (ROUND, "retry go to the lab up to 6 times; nod", ["the step 'dock' is gone"]),
    "a count": (ROUND, ROUND.replace("6 times", "3 times"), ["attempts of 'go to lab': 6 to 3"]),
    "endless": ("repeat 2 times: wave", "repeat wave", ["rounds of 'wave': 2 to no limit"]),
    "a time": ("dock within 10 s", "dock within 1 min", ["Timeout of 'dock': 10 s to 60 s"]),
    "a value": (ROUND, ROUND.replace("lab", "hall"), ["'go to lab' is now 'go to hall'"]),
    "another command": ("wave; nod; dock", "wave; say hi; dock", ["'nod' is now 'say hi'"]),
    "something around": (ROUND, ROUND.replace("nod", "nod twice"), ["new around 'nod': Repeat (rounds 2)"]),
    "nothing around": ("wave within 5 s; nod", "wave; nod", ["no longer around 'wave': Timeout (Timeout 5 s)"]),
    "another order": ("wave and nod", "wave then nod", ["'wave and nod' is now 'wave then nod'"]),
    "names": (
        "tour is wave; dance is nod; tour; dance",
        "tour is wave then nod\nbow is nod\ntour",
        [
            "the definition 'dance' is gone",
            "'tour ... dance' is now 'tour'",
            "'wave' is now 'wave then nod' in 'tour'",
            "new definition 'bow': nod",
        ],
    ),
}


@pytest.mark.parametrize(("old", "new", "lines"), CASES.values(), ids=CASES)
def test_differences(old: str, new: str, lines: list[str]) -> None:
    one, other = parse_tree(old), parse_tree(new)
    assert list(find_differences(one.tree, other.tree, words_of(one), words_of(other))) == lines


@searches(40, 2000, deadline=None)
@given(trees(), trees())
def test_there_are_some_just_where_the_trees_are_not_equal(one: object, other: object) -> None:
    old, new = (compile_mission(each, letters()) for each in (one, other))  # type: ignore[arg-type]
    found = list(find_differences(old, new, lambda node: node.id, lambda node: node.id))
    equal = old.root == new.root and dict(old.subtrees) == dict(new.subtrees)
    assert (found == []) == equal


def test_deep_and_long_trees() -> None:
    deep = parse_tree("(" * 300 + "wave" + " then nod) twice" * 300)
    other = parse_tree("(" * 300 + "dock" + " then nod) twice" * 300)
    assert list(find_differences(deep.tree, other.tree, words_of(deep), words_of(other))) == ["'wave' is now 'dock'"]
    long = parse_tree("wave; nod;" * 3000)
    assert list(find_differences(long.tree, long.tree, words_of(long), words_of(long))) == []
