"""The engine does what the reference interpreter does, on random trees with random leaves.

After every tick, halt, emergency stop and suspension, also one that another engine goes on from: the same status, the
same calls and halts of leaves in the same order, the same blackboards. So do the plain nodes, where no faster variant
of them is chosen, and engines that generate regions sooner or later.
"""

from __future__ import annotations

import json
from contextlib import nullcontext
from itertools import cycle
from typing import Any
from unittest.mock import patch

from hypothesis import example, given
from hypothesis import strategies as st

from btlang.engine import generation
from btlang.engine.engine import Engine
from btlang.engine.status import IDLE
from btlang.tree.node import Node
from tests.profiles import searches

from .conftest import NEVER, SIZES, USUAL, limited
from .random_trees import BUSY, TREES, Drawn, letters
from .reference import Reference
from .reference_board import Board
from .reference_node import Mission
from .scripted import LETTER, World, n

LEFT_RUNNING = n("LoopString", n("RateController", Node("F:k"), hz=0.4), queue="1", value="{y}", if_empty="SUCCESS")
"""The loop ends while its child, which was SKIPPED, counts as RUNNING: its next run finds it so."""


PAUSED = n(
    "PauseResumeController", n("RateController", n("SkipUnlessUpdated", n("Sleep", msec=0), entry="{q}"), hz=0.4)
)
"""The controller completes while its child, which was SKIPPED, would go on: it is halted."""
ENGINES = st.lists(st.sampled_from((NEVER, 0, 1, 2)), min_size=1, max_size=4)
"""After how many ticks the first engine generates its regions, the second, and so on, and again from the first."""


@example(LEFT_RUNNING, "ttt", False, True, [NEVER], USUAL)
@example(LEFT_RUNNING, "ttt", False, True, [0], USUAL)
@example(PAUSED, "ttt", False, True, [NEVER], USUAL)
@searches(150, 20000)
@given(TREES | BUSY, letters("ttttthperm", 3, 12), st.booleans(), st.booleans(), ENGINES, SIZES)
def test_engine_equals_reference(
    shape: Node, orders: str, watched: bool, fused: bool, engines: list[int], sizes: dict[str, int]
) -> None:
    drawn, world = Drawn(shape), World()
    drawn.bind(world)
    variants = nullcontext() if fused else patch("btlang.engine.compile.choose_compiler", lambda usual, *_: usual)
    with variants, limited(sizes):
        check(drawn, world, orders, watched, engines if fused else [NEVER])  # each Parallel saves other things


def check(drawn: Drawn, world: World, orders: str, watched: bool, engines: list[int]) -> None:
    turns = cycle(engines)

    def make() -> Engine:
        with patch.object(generation, "TICKS_BEFORE", next(turns)):
            return world.engine(drawn.tree, watched)

    engine = make()
    mission = Mission(drawn.tree, drawn.scripts, world.clock)
    reference = Reference(drawn.tree.root, mission, Board())
    boards = [node.board for node in preorder(reference)]
    for order in orders:
        if order in "he":
            engine.halt(emergency=order == "e")
            mission.emergency = order == "e"
            reference.reset()
            mission.emergency = False
        elif order in "pr":
            saved = json.dumps(engine.save())
            engine.suspend()
            reference.suspend()
            if order == "r":
                engine = make()
                engine.restore(json.loads(saved))
                assert json.dumps(engine.save()) == saved or engines not in ([NEVER], [0])
        else:
            ours, theirs = engine.tick(), reference.execute()
            assert LETTER[ours] == LETTER[theirs]
            if LETTER[theirs] in "sf":
                reference.status = IDLE  # and no more: Tree::tickRoot leaves what is below the root as it is
        assert world.log == mission.log
        for instance, board in zip(engine._instances, boards, strict=True):
            assert values(instance.scope) == values(board)
        world.clock.advance(60 if order == "m" else 1)


def preorder(reference: Reference) -> list[Reference]:
    return [reference, *[node for child in reference.children for node in preorder(child)]]


def values(board: Any) -> list[object]:
    return [board.get(key) if key in board else None for key in ("q", "x", "y", "z", "_p")]
