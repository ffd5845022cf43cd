"""Leaves that touch on purpose: while such a leaf works, the guard lets the robot drive to contact, slowly."""

from __future__ import annotations

from functools import wraps

from btlang.tree.catalogue import CATALOGUE
from btlang.tree.node import Tree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Generator
    from typing import Any


def awaited(tree: Tree) -> frozenset[str]:
    """The ids of leaves that a node looks at while it runs another child, and that may end it: `until bumped`."""
    found: set[str] = set()
    for node in tree.walk():
        kind = CATALOGUE.get(node.id)
        if kind is not None and kind.reactive and kind.interrupts:
            looked_at = node.children[:1] if kind.roles else node.children[:-1]
            for child in looked_at:
                found.update(each.id for each in Tree(child).walk() if not each.children)
    return frozenset(found)


def touching(call: Callable[..., Any]) -> Callable[..., Any]:
    """The function of a leaf, which says at each tick that the robot may touch what is ahead. It takes a `robot`."""
    from inspect import isgeneratorfunction  # takes longer to import than most checks

    if not isgeneratorfunction(call):

        @wraps(call)
        def look(robot: Any, **values: Any) -> Any:
            robot.touch()
            return call(robot=robot, **values)

        return look

    @wraps(call)
    def work(robot: Any, **values: Any) -> Generator[None, None, Any]:
        running = call(robot=robot, **values)
        try:
            while True:
                robot.touch()
                try:
                    next(running)
                except StopIteration as end:
                    return end.value
                yield
        finally:
            running.close()

    return work
