"""The engine does what the reference interpreter does, on random trees with random leaves.

After every tick, halt, emergency stop and suspension: the same status, the same calls and halts of leaves in the same
order, the same blackboards.
"""

from __future__ import annotations

from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from btlang.engine.status import IDLE
from btlang.tree.node import Node
from tests.profiles import searches

from .random_trees import BUSY, TREES, Drawn, letters
from .reference import Mission, Reference
from .reference_board import Board
from .scripted import LETTER, World


@searches(300, 20000)
@given(TREES | BUSY, letters("ttttthpe", 3, 12), st.booleans())
def test_engine_equals_reference(shape: Node, orders: str, watched: bool) -> None:
    drawn, world = Drawn(shape), World()
    drawn.bind(world)
    engine = world.engine(drawn.tree, watched)
    mission = Mission(drawn.tree, drawn.scripts, world.clock)
    reference = Reference(drawn.tree.root, mission, Board())
    boards = [(site.scope, node.board) for site, node in zip(engine._sites, preorder(reference), strict=True)]
    for order in orders:
        if order in "he":
            engine.halt(emergency=order == "e")
            mission.emergency = order == "e"
            reference.reset()
            mission.emergency = False
        elif order == "p":
            engine.suspend()
            reference.suspend()
        else:
            ours, theirs = engine.tick(), reference.execute()
            assert LETTER[ours] == LETTER[theirs]
            if LETTER[theirs] in "sf":
                reference.reset_children()
                reference.status = IDLE
        assert world.log == mission.log
        for ours, theirs in boards:
            assert values(ours) == values(theirs)
        world.clock.advance(1)


def preorder(reference: Reference) -> list[Reference]:
    return [reference, *[node for child in reference.children for node in preorder(child)]]


def values(board: Any) -> list[object]:
    return [board.get(key) if key in board else None for key in ("q", "x", "y", "z", "_p")]
