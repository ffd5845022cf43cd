"""Which version a file without BTCPP_format is read as: a SubTree port without braces is a key in version 3 alone."""

from __future__ import annotations

from pathlib import Path

import pytest

from btlang.diagnostics.files import read_source
from btlang.frontends.btcpp.origin import XmlOrigin
from btlang.frontends.btcpp.reader import read_xml
from btlang.tree.node import Node, Tree
from tests.corpus.same import content, read, written

USE = '<SubTree ID="Speak" text="hello"{}/>'
SPEAK = '<BehaviorTree ID="Speak"><Say text="{text}"/></BehaviorTree>'


def said(nodes: str, root: str = "") -> str:
    """What the SubTree is given."""
    main = f'<BehaviorTree ID="MainTree"><Sequence>{nodes}</Sequence></BehaviorTree>'
    tree = read(f"<root{root}>{main}{SPEAK}</root>")
    [text] = [node.port("text") for node in tree.walk() if node.id == "SubTree"]
    return text


@pytest.mark.parametrize(
    "node",
    [
        '<Script code="x := 1"/>',
        "<TryCatch><Wave/><Nod/></TryCatch>",
        '<Decorator ID="Twice" _while="x"><Wave/></Decorator>',
        '<Parallel success_count="1"><Wave/></Parallel>',
        '<Sleep msec="1"/>',
    ],
)
def test_what_only_version_4_has(node: str) -> None:
    assert said(node + USE.format("")) == "hello"
    assert said(USE.format(' _skipIf="x"') + node) == "hello"
    assert said(node + USE.format(""), ' BTCPP_format="3"') == "{hello}"


@pytest.mark.parametrize(
    "node",
    [
        "<SequenceStar><Wave/></SequenceStar>",
        '<RetryUntilSuccesful num_attempts="2"><Wave/></RetryUntilSuccesful>',
        '<BlackboardCheckInt value_A="{a}" value_B="1"><Wave/></BlackboardCheckInt>',
        '<Parallel threshold="1"><Wave/></Parallel>',
        '<Wave to="${somebody}"/>',
    ],
)
def test_what_only_version_3_has(node: str) -> None:
    """It counts for more: version 4 refuses it, while version 3 takes any node that somebody made."""
    script = '<Script code="lua"/>'
    assert said(script + node + USE.format("")) == "{hello}"
    assert said(script + USE.format(' __shared_blackboard="false"')) == "{hello}"
    assert said(script + node + USE.format(""), ' BTCPP_format="4"') == "hello"


@pytest.mark.parametrize("node", ['<Action ID="Script" file="a.lua"/>', '<Sleep seconds="1"/>', "<Wave/>"])
def test_what_both_may_have(node: str) -> None:
    assert said(node + USE.format("")) == "{hello}"


def test_an_included_file_is_as_the_one_around_it() -> None:
    good = Path(__file__).parent / "good"
    for name, text in (("v3_includes_without_format.xml", "{hello}"), ("v4_includes_without_format.xml", "hello")):
        trees = dict(read_xml(read_source(str(good / name))).subtrees)
        assert trees["Bare"].port("text") == text


def test_version_3_is_told_where_nodes_tell_otherwise() -> None:
    tree = read('<root BTCPP_format="4"><BehaviorTree ID="MainTree"><Wave _skipIf="x"/></BehaviorTree></root>')
    text = written(tree, 3)
    assert '<root BTCPP_format="3"' in text
    assert read(text) == tree
    assert "BTCPP_format" not in written(Tree(Node("Wave")), 3)


def test_nothing_is_added_to_a_file_that_does_not_tell() -> None:
    text = '<root><BehaviorTree ID="MainTree"><Script code="x := 1"/></BehaviorTree></root>'
    tree = read(text)
    assert isinstance(tree.origin, XmlOrigin)
    assert tree.origin.dialect == 4
    assert content(written(tree)) == content(text)
    assert 'BTCPP_format="4"' in written(tree.replace(origin=None))
