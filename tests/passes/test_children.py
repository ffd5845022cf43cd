"""Nodes with too few or too many children, said by their ids: told as mistakes by `check`, never a traceback."""

from __future__ import annotations

from contextlib import suppress

import pytest

from btlang.api import parse_tree
from btlang.diagnostics.diagnostic import MissionError
from btlang.tree.catalogue import CATALOGUE

INNER = [node_id for node_id, kind in CATALOGUE.items() if kind.most]
COUNTS = range(4)
CHILDREN = ("wave", "nod", "say hello")
TARGETS = ("xml", "english", "json", "python", "py_trees", "dot", "tree", "keywords")


def _said(node_id: str, count: int, indent: str = "") -> str:
    children = [f"\n{indent}  {child}" for child in CHILDREN[:count]]
    return f'{indent}do "{node_id}"' + (":" if children else "") + "".join(children)


@pytest.mark.parametrize("parser", ["shunting-yard", "lark"])
@pytest.mark.parametrize("node_id", INNER)
def test_a_wrong_number_of_children_is_told(node_id: str, parser: str) -> None:
    """In all places where a lint looks at the ending of a node."""
    kind = CATALOGUE[node_id]
    for count in COUNTS:
        alone, inside = _said(node_id, count), _said(node_id, count, "  ")
        text = f"{alone}\nwave\ndo fallback:\n{inside}\n  wave\ndo retry until successful:\n{inside}"
        tree = parse_tree(text, parser=parser)  # the lints look at it
        told = []
        try:
            tree.check()
        except MissionError as error:
            told = [problem.code for problem in error.diagnostics if f"{node_id} has {count}" in problem.message]
        fits = kind.least <= count <= kind.most or (kind.most == 1 and count > 1)  # several are one sequence
        assert told == ([] if fits else ["BT132"] * 3)


@pytest.mark.parametrize("count", COUNTS)
def test_no_target_falls_over_it(count: int) -> None:
    for node_id in INNER:
        tree = parse_tree(_said(node_id, count))
        for target in TARGETS:
            with suppress(MissionError):  # py_trees refuses what it cannot say
                tree.to(target)


def test_a_count_that_is_no_number() -> None:
    """`²` is a digit for Python, but no number."""
    tree = parse_tree('do parallel with success count "²":\n  wave\n  nod')
    with pytest.raises(MissionError, match="BT132"):
        tree.check()
