"""The table of targets, `btc compile`, and what each target writes."""

from __future__ import annotations

import os
import subprocess
import sys
import warnings
from importlib.util import find_spec
from pathlib import Path
from shutil import which
from typing import Any

import pydot
import pytest

import btlang
from btlang.api import Mission, format_mission
from btlang.backends.targets import TARGETS, compile_to, target_of
from btlang.builders import sequence
from btlang.cli import main
from btlang.diagnostics.diagnostic import MissionError
from btlang.frontends.json.reader import read_json
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.text.source import Source
from btlang.tree.node import Node, NodeModel, PortModel, Tree
from tests.engine.scripted import n
from tests.examples.cases import world_of
from tests.profiles import cases

ROOT = Path(__file__).parents[2]
EXAMPLES = sorted((ROOT / "examples").glob("*.txt"))
MISSION = """bay is at (1 m, 1 m)
patrol is: go to the kitchen then say "a 'b\\n"
repeat 2 times patrol
if battery is above 20% go to the bay
"""


def example(path: Path) -> Mission:
    text = path.read_text(encoding="utf-8")
    return btlang.parse_tree(Source(text, str(path)), world=world_of(path, text))


def deep(levels: int = 10_000) -> Mission:
    node = Node("Wave")
    for _ in range(levels):
        node = Node("Inverter", (node,))
    return Mission(Tree(node), world_vocabulary())


@pytest.mark.parametrize("name", [name for name, target in TARGETS.items() if target.runs])
def test_nothing_that_runs_is_written_of_a_tree_that_uses_one_that_is_not_there(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for file, text in (
        ("gone.xml", '<root BTCPP_format="4"><BehaviorTree ID="A"><SubTree ID="Gone"/></BehaviorTree></root>'),
        ("gone.txt", 'do subtree "Gone"'),
    ):
        path = tmp_path / file
        path.write_text(text, encoding="utf-8")
        for verb in (["check"], ["compile", "--to", name, "-o", str(tmp_path / "out")]):
            assert main([*verb, str(path)]) == 2
            assert "error BT126: There's no tree called 'Gone'." in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("name", TARGETS)
def test_every_target_can_be_loaded(name: str) -> None:
    module = TARGETS[name].make.partition(":")[0]
    if find_spec(module) is None:
        pytest.skip(f"{module} is not there")
    made = btlang.parse_tree("wave then nod").to(name)
    assert isinstance(made, bytes if TARGETS[name].binary else str)
    assert made


def test_suffixes_belong_to_one_target() -> None:
    suffixes = [suffix for target in TARGETS.values() for suffix in target.suffixes]
    assert len(set(suffixes)) == len(suffixes)
    assert target_of("a/tree.SVG") == "svg"
    assert target_of("tree") == ""


def test_unknown_targets_and_options_are_refused() -> None:
    tree = btlang.parse_tree("wave")
    with pytest.raises(ValueError, match="the targets are xml, "):
        tree.to("cobol")
    with pytest.raises(ValueError, match="takes no dialect"):
        tree.to("dot", dialect=3)


@pytest.mark.parametrize("name", ["json", "dot", "python", "keywords", "tree"])
def test_deep_trees_have_text(name: str) -> None:
    assert len(compile_to(deep().tree, deep().vocabulary, name)) > 40


@cases("path", EXAMPLES, 7, ids=lambda path: path.stem)
def test_examples_can_be_compiled_to_all(path: Path) -> None:
    tree = example(path)
    for name in ("json", "dot", "python", "keywords", "tree", "py_trees"):
        made = tree.to(name)
        assert isinstance(made, str)
        if name == "json":
            assert read_json(made) == tree.tree
        elif name == "dot":
            assert_graph(made, tree.tree)
        elif name in ("python", "py_trees"):
            compile(made, "made.py", "exec")
        elif name == "keywords":
            assert made == "# Every leaf of this tree has a keyword entry.\n"


def assert_graph(text: str, tree: Tree) -> None:
    """It is read by the grammar of pydot, and has a box for each node and an arrow for each child and use."""
    graph = graph_of(text)
    boxes = [box for part in (graph, *graph.get_subgraphs()) for box in boxes_of(part)]
    arrows = [arrow for part in (graph, *graph.get_subgraphs()) for arrow in part.get_edges()]
    nodes = list(tree.walk())
    assert len(boxes) == len(nodes)
    assert len(arrows) == sum(len(node.children) + (node.id == "SubTree") for node in nodes)


def boxes_of(graph: pydot.Dot) -> list[str]:
    """The names of its nodes, without what is set for all."""
    return [node.get_name() for node in graph.get_nodes() if node.get_name() not in ("node", "graph")]


def graph_of(text: str) -> pydot.Dot:
    """What the grammar of pydot reads; it uses old names of pyparsing."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        [graph] = pydot.graph_from_dot_data(text) or []
    return graph


ODD = Node('a"b\\n]', ports=(("p", '{x} "\\" <&> \n ü'),), name='"')


def test_dot_escapes_everything() -> None:
    text = compile_to(Tree(ODD, (('t"\\', ODD),)), world_vocabulary(), "dot")
    assert isinstance(text, str)
    graph = graph_of(text)
    assert boxes_of(graph) == ["n0"]


@pytest.mark.skipif(which("dot") is None, reason="Graphviz is not installed")
@pytest.mark.parametrize("tree", [ODD, *EXAMPLES], ids=lambda tree: getattr(tree, "stem", "odd"))
def test_graphviz_draws_it_without_a_word(tree: Node | Path) -> None:
    made = Tree(tree, (('t"\\', tree),)) if isinstance(tree, Node) else example(tree).tree
    text = str(compile_to(made, world_vocabulary(), "dot"))
    drawn = subprocess.run(["dot", "-Tsvg"], input=text.encode(), capture_output=True, check=True, timeout=60)
    assert drawn.stderr == b""
    assert drawn.stdout.count(b'class="node"') == text.count("[label=")


def test_the_module_does_what_run_does(tmp_path: Path) -> None:
    (tmp_path / "mission.txt").write_text(MISSION, encoding="utf-8")
    (tmp_path / "mission.py").write_text(str(btlang.parse_tree(MISSION).to("python")), encoding="utf-8")
    runs = [["mission.py"], ["-m", "btlang", "run", "mission.txt", "--lines"]]
    ran, run = (python(tmp_path, *words, "--speed", "max") for words in runs)
    assert (ran.returncode, ran.stdout) == (run.returncode, run.stdout) == (0, run.stdout)
    assert "going to bay" in run.stdout or "go to bay" in run.stdout


def test_the_module_imports_the_functions_of_its_leaves(tmp_path: Path) -> None:
    (tmp_path / "cells.py").write_text(
        "import btlang\n\n"
        '@btlang.action("weld {number} plates")\n'
        'def weld(robot, number: int):\n    robot.print(f"welding {number}")\n\n'
        '@btlang.condition("plate is hot")\ndef is_hot():\n    return True\n',
        encoding="utf-8",
    )
    (tmp_path / "write.py").write_text(
        "import pathlib, btlang, cells\nfrom btlang.builders import leaf, sequence\n"
        'tree = sequence("plate is hot", leaf(cells.weld, 2), cells.is_hot, "say done")\n'
        'pathlib.Path("made.py").write_text(sequence(tree, cells.is_hot).to("python"))\n',
        encoding="utf-8",
    )
    for words in (["write.py"], ["made.py", "--speed", "max"]):
        ran = python(tmp_path, *words, path=ROOT)
        assert ran.returncode == 0, ran.stderr
    assert "welding 2" in ran.stdout
    made = (tmp_path / "made.py").read_text(encoding="utf-8")
    assert "KEYWORDS = [words_1.is_hot, words_1.weld]" in made or "KEYWORDS = [words_1.weld, words_1.is_hot]" in made


def test_functions_that_no_module_can_import_are_refused_by_name() -> None:
    @btlang.action("polish")
    def polish() -> None: ...

    @btlang.condition("it shines")
    def shines() -> bool:
        return True

    with pytest.raises(MissionError) as caught:
        sequence(shines, polish).to("python")
    assert {problem.code for problem in caught.value.diagnostics} == {"BT134"}
    assert all(name in str(caught.value) for name in ("polish, its function", "shines, its function"))


def test_a_deep_module_makes_the_same_tree() -> None:
    names: dict[str, Mission] = {"__name__": "made"}  # type: ignore[dict-item]
    exec(str(deep().to("python")), names)
    assert names["mission"].tree == deep().tree


def test_the_module_for_py_trees_needs_py_trees_only(tmp_path: Path) -> None:
    (tmp_path / "tree.py").write_text(str(btlang.parse_tree(MISSION).to("py_trees")), encoding="utf-8")
    (tmp_path / "btlang.py").write_text("raise ImportError('it is not needed')", encoding="utf-8")
    ran = python(tmp_path, "tree.py", path=tmp_path)
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout.endswith("battery is above 20%\ngo to bay\nSUCCESS\n")


def test_the_module_for_py_trees_prints_the_zones_that_hold(tmp_path: Path) -> None:
    root = n("KeepIn", n("KeepOut", n("Wave"), zones="stairs; wet floor"), zones="hall")
    (tmp_path / "tree.py").write_text(str(compile_to(Tree(root), world_vocabulary(), "py_trees")), encoding="utf-8")
    (tmp_path / "btlang.py").write_text("raise ImportError('it is not needed')", encoding="utf-8")
    ran = python(tmp_path, "tree.py", path=tmp_path)
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout.splitlines()[-6:] == [
        "stay in hall",
        "keep out of stairs, wet floor",
        "wave",
        "keep out of stairs, wet floor: over",
        "stay in hall: over",
        "SUCCESS",
    ]


def python(folder: Path, *words: str, path: Path = ROOT) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(path)}
    command = [sys.executable, "-W", "error", *words]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, encoding="utf-8", check=False)


def test_keyword_entries_make_the_tree_known(tmp_path: Path) -> None:
    ports = (PortModel("p", "input", "double", "1.5"), PortModel("q-r", "input", "std::string"))
    leaves = (
        Node("MoveTo", ports=(("goal", "1;2"), ("speed", "0.5"))),
        Node("IsDoorOpen"),
        Node("Then"),
        Node("A"),
        Node("SaySomething", ports=(("message", "{m}"),)),
        Node("SAY_something", ports=(("message", "hello"),)),
        Node("DockNow", ports=(("p", "2"),)),
    )
    tree = Tree(Node("Sequence", leaves), models=(NodeModel("Condition", "DockNow", ports, 'Is "docked"\n now\x7f'),))
    text = compile_to(tree, world_vocabulary(), "keywords")
    assert isinstance(text, str)
    file = tmp_path / "words.toml"
    file.write_text(text, encoding="utf-8")
    vocabulary = world_vocabulary([str(file)])
    assert [vocabulary.entries[leaf.id][0].sort for leaf in leaves] == [
        "action", "condition", "action", "action", "action", "action", "condition"
    ]  # fmt: skip
    assert compile_to(tree, vocabulary, "keywords").count("[[") == 0
    Mission(tree, vocabulary).check()


def test_compile_writes_a_file_at_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "tree.json"
    assert main(["compile", "-c", "wave", "-o", str(out)]) == 0
    assert read_json(out.read_text(encoding="utf-8")) == btlang.parse_tree("wave").tree
    out.chmod(0o640)
    assert main(["compile", "-c", "nod", "-o", str(out), "--to", "tree"]) == 0
    assert (out.read_text(encoding="utf-8"), out.stat().st_mode & 0o777) == ("Nod\n", 0o640)
    assert [path.name for path in tmp_path.iterdir()] == ["tree.json"]
    assert main(["compile", "-c", "nod", "--to", "tree"]) == 0
    assert capsys.readouterr().out == "Nod\n"
    assert main(["compile", "-c", "nod", "-o", str(tmp_path / "no" / "tree.json")]) == 2
    assert "error BT009" in capsys.readouterr().err


def test_json_has_no_lone_surrogates(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """As XML has none."""
    assert main(["compile", "-c", 'say "a\udcff"', "-o", str(tmp_path / "tree.json")]) == 2
    assert "error BT134" in capsys.readouterr().err
    assert not (tmp_path / "tree.json").exists()


@pytest.mark.parametrize("target", ["python", "english", "tree"])
def test_a_file_holds_what_utf_8_does_not(target: str, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert main(["compile", "-c", 'say "a\udcff"', "-o", str(out), "--to", target]) == 0
    assert "a\\udcff" in out.read_text(encoding="utf-8")


def test_compile_says_what_it_can_write(capsys: pytest.CaptureFixture[str]) -> None:
    for words in (["-c", "wave"], ["-c", "wave", "-o", "tree"], ["-c", "wave", "--to", "dot", "--dialect", "3"]):
        with pytest.raises(SystemExit) as refused:
            main(["compile", *words])
        assert refused.value.code == 2
        assert "choose a target" in capsys.readouterr().err or "--dialect" in words


def test_all_that_is_wrong_is_told_at_once() -> None:
    inner = (("ID", "inner"),)
    leaves = (Node("Nobody"), Node("Repeat"), Node("GoTo", ports=(("plase", "x"),)), Node("SubTree", ports=inner))
    tree = Tree(
        Node("Sequence", leaves), (("inner", Node("Foo", (Node("SubTree", ports=inner),))), ("free", leaves[0]))
    )
    runnable = Mission(tree, world_vocabulary())
    for attempt in (runnable.check, lambda: runnable.run(speed="max")):
        with pytest.raises(MissionError) as refused:
            attempt()
        told = sorted(problem.code for problem in refused.value.diagnostics)
        assert told == ["BT130", "BT131", *["BT132"] * 4], refused.value
    assert str(runnable)
    assert runnable.to("json")


def told(text: str) -> list[tuple[str, int, bool]]:
    """The code and line of each message of a check, and whether it holds a keyword entry."""
    with pytest.raises(MissionError) as refused:
        btlang.parse_tree(text).check()
    found = refused.value.diagnostics
    return [(each.code, each.span.source.position(each.span.start)[0], "[[action]]" in each.hint) for each in found]


def test_an_entry_is_told_where_its_leaf_is_first_missed() -> None:
    used_first = '<BehaviorTree ID="Part"><Pour/></BehaviorTree>\n'
    main = '<BehaviorTree ID="Main"><Sequence><SubTree ID="Part"/><Pour/></Sequence></BehaviorTree>\n'
    root = '<root BTCPP_format="4" main_tree_to_execute="Main">\n'
    assert told(f"{root}{used_first}{main}</root>") == [("BT130", 2, True), ("BT130", 3, False)]


def test_a_port_that_is_missing_is_no_number_out_of_range() -> None:
    tree = '<BehaviorTree ID="Main">\n<Timeout><Pour/></Timeout>\n</BehaviorTree>'
    assert told(f'<root BTCPP_format="4">{tree}</root>') == [("BT132", 2, False), ("BT130", 2, True)]


def test_py_trees_has_classes_for_nodes_with_children_that_are_not_there() -> None:
    """They stand for nodes of other programs: what these do, whoever uses the module writes."""
    tree = btlang.parse_tree(
        'do "WithLamp" called "light" with brightness 0.5:\n  wave\n'
        'do "For-Each":\n  nod\n  wave\ndo "For Each":\n  nod\n  nod\ndo "WithLamp":\n  do "WithLamp":\n    nod\n'
        'do "Sequence2":\n  nod\ndo "class":\n  nod\ndo "PrintingLeaf":\n  nod\ndo "3D":\n  nod\n  nod'
    )
    names: dict[str, Any] = {"__name__": "tree"}
    exec(tree.to("py_trees"), names)
    root = names["create_root"]()
    found = [(type(node).__name__, node.name) for node in root.iterate() if hasattr(node, "ports")]
    assert sorted(found) == [
        ("For_Each", "For-Each"), ("For_Each_", "For Each"), ("Node3D", "3D"), ("PrintingLeaf_", "PrintingLeaf"),
        ("Sequence2", "Sequence2"), ("WithLamp", "WithLamp"), ("WithLamp", "WithLamp"), ("WithLamp", "light"),
        ("class_", "class"),
    ]  # fmt: skip
    [light] = [node for node in root.iterate() if node.name == "light"]
    assert light.ports == {"brightness": "0.5"}
    root.tick_once()
    assert root.status.value == "SUCCESS"


def test_live_trees_of_py_trees_need_all_nodes() -> None:
    from btlang.backends.py_trees.build import to_py_trees

    tree = btlang.parse_tree('do "WithLamp":\n  wave')
    with pytest.raises(MissionError, match="BT131: There's no node 'WithLamp' that takes children"):
        to_py_trees(tree.tree, tree.vocabulary)


def test_py_trees_knows_no_skipped_child_of_a_node_that_is_not_there() -> None:
    tree = btlang.parse_tree('do "WithLamp":\n  do always success with _skipIf "true"')
    with pytest.raises(MissionError, match="BT134"):
        tree.to("py_trees")


def test_attributes_of_editors_do_nothing() -> None:
    tree = btlang.parse_tree((ROOT / "tests/corpus/good/v4_attributes_of_editors.xml").read_text())
    tree.check()
    assert tree.run(speed="max").status
    assert "_description" in str(tree.to("xml"))
    assert tree.to("py_trees")


def test_a_run_tells_of_all_nodes_that_a_mission_says_by_unknown_ids() -> None:
    tree = btlang.parse_tree('do "OpenGripper" with width 1 then do "Pour"')
    with pytest.raises(MissionError) as checked:
        tree.check()
    with pytest.raises(MissionError) as refused:
        tree.run(speed="max")
    assert [problem.code for problem in refused.value.diagnostics] == ["BT130", "BT130"]
    assert refused.value.diagnostics == checked.value.diagnostics


@pytest.mark.parametrize("text", ["<root/>", '{"format": 1}'])
def test_what_is_no_english_has_no_layout(text: str) -> None:
    with pytest.raises(MissionError, match="BT001: I can't read <text>: it isn't English"):
        format_mission(text)
