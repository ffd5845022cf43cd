"""The catalogue of nodes is the one place that says what a built-in node is."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from btlang import parse_tree
from btlang.engine.compile import SEMANTICS
from btlang.tree.catalogue import CATALOGUE, NodeKind

PACKAGE = Path(__file__).parents[2] / "btlang"
AT_HOME = {
    "tree/catalogue.py",
    "engine/compile.py",  # semantics
    "passes/__init__.py",
    "passes/lower.py",
    "engine/nodes/templates.py",
    "passes/lower_time.py",
    "passes/scope.py",
    "passes/scripts.py",
}
"""Where ids may be spelt, beside the folders that hold the English of a node and the nodes of py_trees."""
FOLDERS = ("printer/", "backends/english/", "backends/py_trees/")
KINDS = pytest.mark.parametrize("kind", CATALOGUE.values(), ids=CATALOGUE.keys())


def test_every_node_has_its_semantics() -> None:
    assert SEMANTICS.keys() == CATALOGUE.keys()


def test_no_id_is_spelt_elsewhere() -> None:
    found = []
    for path in PACKAGE.rglob("*.py"):
        name = path.relative_to(PACKAGE).as_posix()
        if name in AT_HOME or name.startswith(FOLDERS):
            continue
        text = path.read_text()
        if not any(node_id in text for node_id in CATALOGUE):
            continue  # to parse all of the package takes seconds
        spelt = (item.value for item in ast.walk(ast.parse(text)) if isinstance(item, ast.Constant))
        found += [(name, value) for value in spelt if isinstance(value, str) and value in CATALOGUE]
    assert found == []


@KINDS
def test_an_entry_is_consistent(kind: NodeKind) -> None:
    assert kind.least <= kind.most
    assert len(kind.roles) in (0, kind.most)
    kinds = {0: ("Action", "Condition", "SubTree"), 1: ("Decorator",)}
    assert kind.kind in kinds.get(kind.most, ("Control",))
    assert {kind.rounds, kind.enough} - {""} <= kind.ports.keys()
    assert not kind.endless or kind.again
    for port in kind.ports.values():
        assert (port.unit in ("ms", "rounds")) <= (port.least is not None and port.most is not None)
        assert port.default in ("", None) or not port.type.endswith("int") or port.default.lstrip("-").isdecimal()


@pytest.mark.parametrize(
    ("text", "codes"),
    [
        ("do keep running until failure:\n  print hello", ["BT053"]),
        ("do keep running until failure:\n  wait 1 s", []),
        ("do keep running until failure:\n  check the battery is above 20%", []),  # waits until it is not
        ("do repeat with num cycles -1:\n  print hello", ["BT053"]),
        ("do async sequence:\n  repeat: wave\n  nod", ["BT052"]),
        ("do sequence with memory:\n  fail\n  nod", ["BT052"]),
        ("do async fallback:\n  wait 1 s\n  nod", ["BT052"]),
        ("do round robin:\n  do nothing\n  nod", []),  # which comes to its second child at the next run
        ("do pipeline sequence:\n  repeat: wave\n  nod", ["BT052"]),
    ],
)
def test_lints_know_all_nodes_of_a_family(text: str, codes: list[str]) -> None:
    warnings = parse_tree(text).warnings
    assert [warning.code for warning in warnings if warning.code in ("BT052", "BT053")] == codes, warnings
