"""The trees that benchmarks tick, with leaves that do nothing."""

from __future__ import annotations

from collections.abc import Iterator
from random import Random

from btlang.engine.leaves.leaf import LeafBinding
from btlang.tree.node import Node

CONDITIONS, RUNNERS, ACTIONS = 10, 50, 10_000
MIX, DEPTH = 1_000, 6
SETTLED = 200
"""Ticks after which an engine of these trees has generated what it will, and ticks as it does in a long run."""


def run() -> Iterator[None]:
    """An action that never completes."""
    while True:
        yield


class Wait:
    """An action that never completes, as a class."""

    def start(self) -> None: ...

    def tick(self) -> None: ...

    def halt(self) -> None: ...


KEY = "x"
"""A value of the blackboard that leaves read at each tick."""
BINDINGS = {
    "Yes": LeafBinding(lambda: True),
    "No": LeafBinding(lambda: False),
    "Act": LeafBinding(lambda: None),
    "Run": LeafBinding(run),
    "Wait": LeafBinding(Wait),
    "Keyed": LeafBinding(lambda value: True, {"value": float}),
}


def n(id: str, *children: Node) -> Node:
    return Node(id, children=children)


def mix() -> Node:
    """MIX nodes of depth DEPTH, all of which a tick visits: conditions, actions, sequences, fallbacks, decorators."""
    random, left = Random(7), MIX

    def grown(depth: int, succeeds: bool, share: int) -> Node:
        """A tree of about `share` nodes that completes at once."""
        nonlocal left
        left -= 1
        if depth == DEPTH or share < 3:
            return n(random.choice(("Yes", "Act")) if succeeds else "No")
        if random.random() < 0.15:
            return n("Inverter", grown(depth + 1, not succeeds, share - 1))
        kind = random.choice(("Sequence", "Fallback", "Parallel") if succeeds else ("Sequence", "Fallback"))
        count = min(random.randint(3, 6), share)
        passes = kind != "Fallback"
        shares = (share - 1) // count
        children = [grown(depth + 1, passes, shares) for _ in range(count - 1)]
        return n(kind, *children, grown(depth + 1, succeeds, shares))

    children: list[Node] = []
    while left > 0:
        children.append(grown(1, True, min(left, 4 * MIX)))
    return n("Sequence", *children)


TREES: dict[str, tuple[str, Node]] = {
    "T1": (
        f"resumed leaf behind {CONDITIONS} conditions",
        n("Sequence", *[n("Yes")] * CONDITIONS, n("Run")),
    ),
    "T2": (f"fresh tick of about {MIX:,} nodes of depth {DEPTH}", mix()),
    "T3": (f"reactive guard of {CONDITIONS} conditions", n("ReactiveSequence", *[n("Yes")] * CONDITIONS, n("Run"))),
    "T4": (f"parallel of {RUNNERS} running leaves", n("Parallel", *[n("Run")] * RUNNERS)),
    "T5": (f"sequence of {ACTIONS:,} actions run to the end", n("Sequence", *[n("Act")] * ACTIONS)),
    "T6": (f"parallel of {RUNNERS} running classes", n("Parallel", *[n("Wait")] * RUNNERS)),
    "T7": (
        f"reactive guard of {CONDITIONS} conditions with a port from the blackboard",
        n("ReactiveSequence", *[Node("Keyed", ports=(("value", f"{{{KEY}}}"),))] * CONDITIONS, n("Run")),
    ),
}


def nodes(root: Node) -> Iterator[Node]:
    stack = [root]
    while stack:
        node = stack.pop()
        yield node
        stack += node.children


def again(child: Node) -> Node:
    return Node("Repeat", (child,), (("num_cycles", "-1"),))


ODD = [False]
"""Whether the number of the tick is odd."""
BINDINGS["Odd"] = LeafBinding(lambda: ODD[0])
CHANGING: dict[str, Node] = {
    f"{ACTIONS:,} actions in a loop": again(n("Sequence", *[n("Act")] * ACTIONS)),
    f"{ACTIONS // MIX} times T2 in a loop": again(n("Sequence", *[mix() for _ in range(ACTIONS // MIX)])),
    f"{ACTIONS // 12} times T3 in a loop": again(
        n("Sequence", *[n("ReactiveSequence", *[n("Yes")] * CONDITIONS, n("Act"))] * (ACTIONS // 12))
    ),
    f"{ACTIONS // 4:,} conditions that change": n(
        "ReactiveSequence", *[n("Fallback", n("Odd"), n("Yes"))] * (ACTIONS // 4), n("Run")
    ),
}
