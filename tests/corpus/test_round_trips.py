"""Random trees: what is written is read as the same tree, and written from that as the same text."""

from __future__ import annotations

from xml.etree import ElementTree

import pytest
from hypothesis import given

from btlang.tree.node import Tree
from tests.corpus.random_xml import trees
from tests.corpus.same import content, read, written
from tests.profiles import searches


@searches(40, 2000)
@pytest.mark.parametrize("dialect", [3, 4])
@given(tree=trees())
def test_written_and_read_it_is_the_same(dialect: int, tree: Tree) -> None:
    text = written(tree, dialect)
    ElementTree.fromstring(text)  # it is strict XML
    again = read(text)
    assert again == tree
    assert written(again, dialect) == text
    assert written(again.replace(origin=None), dialect) == text


@searches(40, 2000)
@given(tree=trees())
def test_the_other_dialect_keeps_the_tree(tree: Tree) -> None:
    there = read(written(tree, 4))
    older = read(written(there, 3))
    assert older == tree
    back = written(older, 4)
    assert read(back) == tree
    assert content(back) == content(written(tree, 4))
