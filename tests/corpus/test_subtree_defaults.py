"""Defaults of SubTree ports in TreeNodesModel: a node that leaves a port out has it all the same."""

from __future__ import annotations

import btlang
from btlang.frontends.json.reader import read_json
from btlang.tree.dump import plain
from tests.corpus.same import content, read, written

FILE = (
    '<root BTCPP_format="4"><TreeNodesModel><SubTree ID="Sub"><input_port name="v" default="42"/>'
    '<output_port name="result" default="{out}"/></SubTree></TreeNodesModel>'
    '<BehaviorTree ID="MainTree"><Sequence><SubTree ID="Sub"/><ScriptCondition code="out == 43"/></Sequence>'
    '</BehaviorTree><BehaviorTree ID="Sub"><Sequence><ScriptCondition code="v == 42"/><Script code="result := 43"/>'
    "</Sequence></BehaviorTree></root>"
)


def test_it_runs() -> None:
    assert btlang.parse_tree(FILE).run(speed="max").status is btlang.Status.SUCCESS


def test_it_runs_after_json_and_english() -> None:
    tree = btlang.parse_tree(FILE)
    for target in ("json", "english"):
        again = btlang.parse_tree(str(tree.to(target)))
        assert plain(again.tree) == plain(tree.tree)
        assert again.run(speed="max").status is btlang.Status.SUCCESS


def test_the_file_is_written_as_it_was() -> None:
    assert content(written(read(FILE))) == content(FILE)


def test_a_tree_from_elsewhere_is_written_with_the_port() -> None:
    tree = read(FILE)
    text = written(read_json(str(btlang.parse_tree(FILE).to("json"))))
    assert '<SubTree ID="Sub" v="42" result="{out}"/>' in text
    assert '<input_port name="v" default="42"/>' in text
    assert read(text) == tree


def test_a_model_gives_no_port_to_a_node_without_it() -> None:
    """Else the tree that is written would be another one."""
    older = read(FILE.replace(' BTCPP_format="4"', ' BTCPP_format="3"'))
    text = written(older, 4)
    assert '<SubTree ID="Sub"/>' in text
    assert "default" not in text
    assert read(text) == older
