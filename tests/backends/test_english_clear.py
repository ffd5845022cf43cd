"""What is made from trees can be read in one way only, by people too: blocks and brackets where one line is unclear."""

from __future__ import annotations

import pytest

from btlang.api import parse_tree
from btlang.backends.english import to_english
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.tree.node import Node, Tree

WAVE, NOD, TURN, LOW = Node("Wave"), Node("Nod"), Node("TurnLeft"), Node("BatteryLow")
SKIPPED = Node("AlwaysSuccess", (), (("_skipIf", "true"),))


def sequence(*children: Node) -> Node:
    return Node("Sequence", children)


def fallback(*children: Node) -> Node:
    return Node("Fallback", children)


def parallel(*children: Node) -> Node:
    return Node("Parallel", children)


def inverter(child: Node) -> Node:
    return Node("Inverter", (child,))


def times(child: Node) -> Node:
    return Node("Repeat", (child,), (("num_cycles", "3"),))


def within(child: Node) -> Node:
    return Node("Timeout", (child,), (("msec", "9000"),))


def when(condition: Node, child: Node, otherwise: Node = SKIPPED) -> Node:
    return Node("IfThenElse", (condition, child, otherwise))


CASES = [
    (
        inverter(sequence(WAVE, fallback(NOD, TURN, WAVE), NOD)),
        "inverting the result:\n  wave\n  nod or turn left or wave\n  nod",
    ),
    (fallback(sequence(WAVE, NOD), TURN), "try:\n  wave\n  nod\notherwise:\n  turn left"),
    (fallback(WAVE, sequence(NOD, TURN), WAVE), "try in order:\n  wave\n  nod then turn left\n  wave"),
    (fallback(WAVE, parallel(NOD, TURN)), "try in order:\n  wave\n  nod and turn left"),
    (parallel(TURN, fallback(NOD, WAVE)), "at the same time:\n  turn left\n  nod or wave"),
    (sequence(WAVE, sequence(NOD, fallback(TURN, WAVE))), "wave\nstep by step:\n  nod\n  turn left or wave"),
    (when(LOW, sequence(WAVE, NOD), TURN), "if battery is low:\n  wave\n  nod\notherwise:\n  turn left"),
    (when(LOW, when(LOW, WAVE, NOD)), "if battery is low, (if battery is low, wave otherwise nod)"),
    (when(fallback(sequence(LOW, LOW), LOW), WAVE),
     "if (battery is low and battery is low) or battery is low, wave"),
    (inverter(sequence(WAVE, parallel(NOD, TURN))), "inverting the result:\n  wave\n  nod and turn left"),
    (inverter(sequence(WAVE, times(NOD))), "inverting the result:\n  wave\n  nod 3 times"),
    (inverter(sequence(times(WAVE), NOD)), "inverting the result:\n  wave 3 times\n  nod"),
    (within(sequence(WAVE, fallback(NOD, TURN))), "within 9 s:\n  wave\n  nod or turn left"),
    # a sequence that can be skipped is no `step by step:` below `try in order:`
    (fallback(WAVE, NOD, sequence(when(LOW, WAVE), fallback(NOD, TURN))),
     "try in order:\n  wave\n  nod\n  (if battery is low, wave) then (nod or turn left)"),
]  # fmt: skip


@pytest.mark.parametrize(("root", "text"), CASES, ids=range(len(CASES)))
def test_one_reading(root: Node, text: str) -> None:
    said = to_english(Tree(root), world_vocabulary())
    assert said == text + "\n"
    again = parse_tree(said)
    assert again.tree.root == root
    assert not [warning for warning in again.warnings if warning.code == "BT050"]
