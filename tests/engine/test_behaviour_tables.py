"""Every row of the tables in docs/engine.md is what the engine does."""

from __future__ import annotations

from pathlib import Path

import pytest

from btlang.tree.catalogue import CATALOGUE
from btlang.tree.node import Node, Tree

from .scripted import LETTER, World, leaves

PAGE = Path(__file__).parents[2] / "docs" / "engine.md"


def rows(columns: int) -> list[list[str]]:
    """The rows of the tables with so many columns, without their heads and backticks."""
    found = []
    for line in PAGE.read_text(encoding="utf-8").splitlines():
        cells = [cell.strip().strip("`") for cell in line.strip("|").split("|")]
        if line.startswith("| `") and len(cells) == columns:
            found.append(cells)
    return found


def built(world: World, text: str, scripts: str) -> Tree:
    """`Repeat num_cycles=2` over leaves with these scripts."""
    id, *words = text.split()
    ports = tuple((port, value) for port, _, value in (word.partition("=") for word in words))
    children = tuple(leaves(world, scripts.split()))
    if id == "leaf":
        return Tree(children[0].replace(ports=ports))
    if id == "SubTree":
        return Tree(Node(id, ports=(("ID", "go"), *ports)), (("go", Node("Sequence", children)),))
    return Tree(Node(id, children, ports))


def play(text: str, scripts: str, ticks: str) -> tuple[str, str]:
    """What happened, written as in the columns `ticks` and `calls`."""
    world = World()
    engine = world.engine(built(world, text, scripts))
    engine.blackboard.set("x", [] if "path=" in text else 0)
    happened = ""
    for step in ticks:
        if step.isdigit():
            engine.blackboard.set("x", [[int(step), 0], [0, 0]] if "path=" in text else int(step))
            happened += step
            continue
        if step in "!e":
            engine.halt(emergency=step == "e")
            happened += step
        elif step == "~":
            engine.suspend()
            happened += "~"
        else:
            happened += LETTER[engine.tick()]
        world.clock.advance(1)
    calls = world.log
    if ":=" in text or "+=" in text or "value={x}" in text:
        calls = [*calls, f"x={engine.blackboard.get('x')}"]
    if "zones=" in text:
        calls = [*calls, "closed" if world.robot.zones.held else "open"]
    return happened, " ".join(calls)


@pytest.mark.parametrize(("node", "children", "letters"), [(row[0], row[1], "".join(row[2:])) for row in rows(6)])
def test_one_tick(node: str, children: str, letters: str) -> None:
    assert "".join(play(node, children.replace("?", letter), ".")[0] for letter in "rsfk") == letters


@pytest.mark.parametrize(("node", "children", "ticks", "calls"), [row[:4] for row in rows(5)])
def test_over_time(node: str, children: str, ticks: str, calls: str) -> None:
    assert play(node, children, ticks) == (ticks, calls)


def test_no_node_is_left_out() -> None:
    same = {
        "Switch2": ("Switch3", "Switch4", "Switch5", "Switch6"),
        "LoopString": ("LoopInt", "LoopBool", "LoopDouble"),
    }
    for columns in (6, 5):
        named = {row[0].split()[0] for row in rows(columns)}
        alike = {id for first, others in same.items() if first in named for id in others}
        missing = {id for id, kind in CATALOGUE.items() if kind.most and id not in named | alike}
        assert missing <= ({"ForceSuccess", "ForceFailure"} if columns == 5 else set())
