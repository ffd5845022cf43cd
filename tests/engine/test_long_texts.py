"""Texts of a mission have a limit: one that is doubled 40 times would take a terabyte."""

from __future__ import annotations

import pytest

import btlang
from btlang.engine.blackboard import MOST_TEXT, Blackboard
from btlang.engine.leaves.leaf import ActionFailed

TREE = '<root BTCPP_format="4"><BehaviorTree ID="M"><Sequence>{}</Sequence></BehaviorTree></root>'
LONG = "x" * (MOST_TEXT + 1)


@pytest.mark.parametrize(
    "mission",
    [
        'set x to "ab"\nrepeat 40 times: set x to "{x}{x}"',
        TREE.format('<Script code="a:=\'xx\'"/><Repeat num_cycles="40"><Script code="a = a + a"/></Repeat>'),
        TREE.format('<Script code="a:=\'xx\'"/><Repeat num_cycles="40"><Script code="a = a .. a .. a"/></Repeat>'),
        TREE.format(f'<SetBlackboard output_key="a" value="{LONG}"/>'),
        TREE.format(f'<LoopString queue="{LONG}" value="{{a}}"><AlwaysSuccess/></LoopString>'),
    ],
    ids=["English", "plus", "joined", "SetBlackboard", "LoopString"],
)
def test_too_long_a_text_fails(mission: str) -> None:
    tree = btlang.parse_tree(mission)
    outcome = tree.run(speed="max")
    assert not outcome.status
    assert "more than 1,000,000 characters" in outcome.why()


def test_a_value_of_a_leaf() -> None:
    board = Blackboard()
    board.set("a", LONG[:-1])
    with pytest.raises(ActionFailed, match="too long"):
        board.set("a", LONG)
