"""Trees as JSON: the form is that of the schema, and what is read back is the same tree."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from btlang.api import parse_tree
from btlang.backends.json_tree import SCHEMA, to_json
from btlang.diagnostics.diagnostic import MissionError
from btlang.frontends.json.reader import read_json
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.support.record import Record
from btlang.tree.node import Node, NodeModel, PortModel, Tree

WORDS = world_vocabulary()
TEXTS = st.text(st.characters(exclude_categories=["Cs"]), max_size=8)
PORTS = st.dictionaries(TEXTS, TEXTS, max_size=3).map(lambda ports: tuple(ports.items()))
IDS = st.sampled_from(("Sequence", "GoTo", "SubTree", "Script")) | TEXTS.filter(bool)
NODES = st.recursive(
    st.builds(Node, IDS, st.just(()), PORTS, TEXTS),
    lambda nodes: st.builds(Node, IDS, st.lists(nodes, max_size=3).map(tuple), PORTS, TEXTS),
    max_leaves=8,
)
MODELS = st.builds(
    NodeModel,
    st.sampled_from(("Action", "Condition", "Decorator", "Control", "SubTree")),
    TEXTS,
    st.lists(
        st.builds(PortModel, TEXTS, st.sampled_from(("input", "output", "inout")), TEXTS, st.none() | TEXTS, TEXTS),
        max_size=2,
    ).map(tuple),
    TEXTS,
)
TREES = st.builds(
    Tree,
    NODES,
    st.lists(st.tuples(TEXTS, NODES), max_size=2).map(tuple),
    TEXTS,
    st.lists(MODELS, max_size=2).map(tuple),
).filter(lambda tree: len({tree.name, *dict(tree.subtrees)}) == 1 + len(tree.subtrees))


@cache
def schema() -> Any:
    """What checks a document. The package comes with the extra `dev`."""
    jsonschema = pytest.importorskip("jsonschema")
    text = json.loads(Path(SCHEMA).read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(text)
    return jsonschema.Draft202012Validator(text)


def _has_nul(value: object) -> bool:
    if isinstance(value, Record):
        return any(_has_nul(getattr(value, name)) for name in value.fields if name not in ("span", "origin"))
    return any(map(_has_nul, value)) if isinstance(value, tuple) else "\0" in str(value)


@settings(max_examples=50)
@given(TREES)
def test_what_is_written_is_read_back(tree: Tree) -> None:
    if _has_nul(tree):
        with pytest.raises(MissionError, match="a NUL or a lone surrogate"):
            to_json(tree, WORDS)
        return
    read = read_json(to_json(tree, WORDS))
    assert read == tree
    assert read.models == tree.models


@settings(max_examples=30, deadline=None)
@given(TREES)
def test_documents_fit_the_schema(tree: Tree) -> None:
    assume(not _has_nul(tree))
    schema().validate(json.loads(to_json(tree, WORDS)))


def test_a_document_of_a_mission_fits_the_schema() -> None:
    told = json.loads(to_json(parse_tree("patrol is wave then nod\nif battery is above 20% patrol").tree, WORDS))
    schema().validate(told)
    for broken in ({}, {**told, "format": 2}, {**told, "trees": []}, {**told, "trees": [{"name": "", "nodes": [{}]}]}):
        assert not schema().is_valid(broken)


def test_spans_are_those_of_the_ids() -> None:
    tree = read_json(to_json(parse_tree("wave then nod then wave").tree, WORDS))
    assert [node.span.text for node in tree.walk() if node.span] == [f'"id": "{node.id}"' for node in tree.walk()]


@pytest.mark.parametrize(
    ("document", "reason"),
    [
        ("{", "it is not JSON"),
        ("[" * 100_000, "it is nested too deep"),
        (f'{{"format": {"1" * 5000}}}', "a number is too long"),
        ("[]", "the document isn't an object"),
        ('{"format": 2}', '"format" is not 1'),
        ('{"format": 1, "trees": []}', "contains no tree"),
        ('{"format": 1, "trees": [{"nodes": []}]}', "0 roots"),
        ('{"format": 1, "trees": [{"nodes": [{"id": "a"}, {"id": "b"}]}]}', "2 roots"),
        ('{"format": 1, "trees": [{"nodes": [{"id": "a", "children": [0]}]}]}', "must come after it"),
        ('{"format": 1, "trees": [{"nodes": [{"id": "a", "children": [true]}]}]}', "must come after it"),
        ('{"format": 1, "trees": [{"nodes": [{"id": "a", "children": [1, 1]}, {"id": "b"}]}]}', "two nodes"),
        ('{"format": 1, "trees": [{"nodes": [{"id": "a", "ports": {"p": 1}}]}]}', "the port p"),
        ('{"format": 1, "trees": [{"nodes": [{"id": 1}]}]}', "the id of node 0"),
        ('{"format": 1, "trees": [{"nodes": [{"id": "a"}]}, {"nodes": [{"id": "b"}]}]}', "two trees have the name ''"),
        ('{"format": 1, "trees": [{"nodes": [{"id": "a"}]}], "models": [{"ports": [1]}]}', "model 0"),
    ],
)
def test_what_is_no_tree_is_told(document: str, reason: str) -> None:
    with pytest.raises(MissionError) as refused:
        read_json(document)
    assert [problem.code for problem in refused.value.diagnostics] == ["BT133"]
    assert reason in str(refused.value)


@pytest.mark.parametrize("parallel", ["Parallel", "P\\u0061rallel"])
def test_checks_do_without_places(parallel: str) -> None:
    """A node whose id is spelled with escapes has no place in the text, nor has any after it."""
    nodes = f'[{{"id": "{parallel}", "children": [1, 2]}}, {{"id": "MoveForward"}}, {{"id": "MoveBackward"}}]'
    with pytest.raises(MissionError) as refused:
        parse_tree(f'{{"format": 1, "trees": [{{"nodes": {nodes}}}]}}')
    assert [problem.code for problem in refused.value.diagnostics] == ["BT041"]
    assert "MoveForward and MoveBackward as children of a Sequence" in str(refused.value)


def test_too_large_without_places() -> None:
    uses = [f'{{"id": "SubTr\\u0065e", "ports": {{"ID": "t{at}"}}}}' for at in range(25)]
    trees = [f'{{"nodes": [{uses[0]}]}}']
    for at, use in enumerate([*uses[1:], '{"id": "Wave"}']):
        nodes = f'{{"id": "Sequ\\u0065nce", "children": [1, 2]}}, {use}, {use}'
        trees.append(f'{{"name": "t{at}", "nodes": [{nodes}]}}')
    with pytest.raises(MissionError) as refused:
        parse_tree(f'{{"format": 1, "trees": [{", ".join(trees)}]}}')
    assert [problem.code for problem in refused.value.diagnostics] == ["BT042"]


@pytest.mark.parametrize("name", ["", '"name": "Main", '])
def test_another_tree_may_be_the_main_one(name: str) -> None:
    trees = f'{{{name}"nodes": [{{"id": "Wave"}}]}}, {{"name": "B", "nodes": [{{"id": "Nod"}}]}}'
    document = f'{{"format": 1, "trees": [{trees}]}}'
    others = (("Main", Node("Wave")),) if name else ()
    assert parse_tree(document, main="B").tree == Tree(Node("Nod"), others, "B")
    with pytest.raises(MissionError, match="BT126: There's no tree called 'C'"):
        parse_tree(document, main="C")


def test_a_mission_has_no_other_tree() -> None:
    with pytest.raises(MissionError, match="BT126: There's no tree called 'B'") as refused:
        parse_tree("wave", main="B")
    assert "A mission in English is one tree." in str(refused.value)
