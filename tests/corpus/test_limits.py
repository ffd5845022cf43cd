"""What is refused, what is large, and what reading XML costs those who do not."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import btlang
from btlang.cli import main
from btlang.diagnostics.diagnostic import MissionError
from btlang.frontends.btcpp.scan import MOST_DEEP
from btlang.tree.node import Node, Tree
from tests.corpus.same import content, read, written

ROOT = Path(btlang.__file__).parents[1]


def deep(levels: int) -> Node:
    """A node with so many levels, itself counted."""
    node = Node("AlwaysSuccess")
    for _ in range(levels - 1):
        node = Node("Inverter", (node,))
    return node


@pytest.mark.parametrize("dialect", [3, 4])
def test_trees_may_be_deep(dialect: int) -> None:
    tree = Tree(deep(MOST_DEEP))
    text = written(tree, dialect)
    assert read(text) == tree
    assert written(read(text), dialect) == text
    assert len(text) < 3_000_000  # the margin does not grow without end


def test_deeper_ones_are_refused() -> None:
    text = written(Tree(deep(MOST_DEEP + 1)))
    with pytest.raises(MissionError) as raised:
        read(text)
    [problem] = raised.value.diagnostics
    assert (problem.code, problem.span.text) == ("BT121", "<AlwaysSuccess/>")


@pytest.mark.parametrize("tag", ["<a>", "<a", "<!--", '<a b="', "<![CDATA[", "&", "<?x "])
def test_large_nonsense_takes_no_time(tag: str) -> None:
    with pytest.raises(MissionError):
        read("<root>" + tag * 100_000)


def test_entities_are_never_expanded(tmp_path: Path) -> None:
    secret = tmp_path / "secret.txt"
    secret.write_text("secret")
    for declared in (f'[<!ENTITY a SYSTEM "{secret}">]', '[<!ENTITY a "aaaa">]', f'SYSTEM "{secret}"'):
        with pytest.raises(MissionError) as raised:
            read(f'<!DOCTYPE root {declared}><root><BehaviorTree><Say text="&a;"/></BehaviorTree></root>')
        assert [problem.code for problem in raised.value.diagnostics] == ["BT121"]


@pytest.mark.parametrize("text", ["\x00", "a\x0bb", "\x1f", "\ufffe", "\ud800"])
def test_characters_that_xml_cannot_hold(text: str) -> None:
    tree = Tree(Node("Sequence", (Node("Say", (), (("text", text),)), Node("Wave", name=text))))
    with pytest.raises(MissionError) as raised:
        written(tree)
    assert {problem.code for problem in raised.value.diagnostics} == {"BT129"}


@pytest.mark.parametrize("name", ["two words", "", "1st", "a=b", "name"])
def test_names_that_are_no_attributes(name: str) -> None:
    with pytest.raises(MissionError) as raised:
        written(Tree(Node("Say", (), ((name, "x"),))))
    assert [problem.code for problem in raised.value.diagnostics] == ["BT129"]


def test_there_are_two_dialects() -> None:
    with pytest.raises(ValueError, match="5"):
        written(Tree(Node("Wave")), 5)


def test_main_chooses_a_tree(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = tmp_path / "tree.xml"
    file.write_text(
        '<root><BehaviorTree ID="A"><Wave/></BehaviorTree><BehaviorTree ID="B"><Nod/></BehaviorTree></root>'
    )
    assert main(["tree", str(file), "--plain", "--main", "B"]) == 0
    assert capsys.readouterr().out.splitlines() == [
        "BehaviorTree ID=B main=true", "Nod", "BehaviorTree ID=A", "  Wave"
    ]  # fmt: skip
    assert main(["explain", str(file), "--main", "B"]) == 0
    assert '"A" means wave' in capsys.readouterr().out
    assert main(["check", str(file), "--main", "C"]) == 2
    assert "error BT126" in capsys.readouterr().err


def test_a_tree_that_was_chosen_stays_the_main_one() -> None:
    tree = btlang.parse_tree(
        '<root main_tree_to_execute="A"><BehaviorTree ID="A"><Wave/></BehaviorTree>'
        '<BehaviorTree ID="B"><Nod/></BehaviorTree></root>',
        main="B",
    ).tree
    assert read(written(tree, 3)) == tree


def test_a_changed_tree_is_written_as_it_is() -> None:
    tree = read("<root><BehaviorTree><Sequence><!-- gone --><Wave/></Sequence></BehaviorTree></root>")
    changed = tree.replace(root=Node("Nod"))
    assert "Nod" in written(changed, 3)
    assert "Wave" not in written(changed, 3)


def test_a_mission_becomes_xml() -> None:
    """With names that BehaviorTree.CPP takes, and models of its commands."""
    tree = btlang.parse_tree('greet {someone} is say "hello {someone}"\ngreet Alice then move forward 2 m').tree
    text = written(tree)
    assert '<BehaviorTree ID="greet_someone" _name="greet {someone}">' in text
    assert '<SubTree ID="greet_someone" someone="Alice"/>' in text
    assert '<input_port name="distance" type="double"' in text
    assert read(text) == tree
    assert content(written(read(text), 4)) == content(text)


def test_a_tree_of_xml_runs() -> None:
    tree = btlang.parse_tree(
        '<root BTCPP_format="4"><BehaviorTree ID="MainTree"><Sequence>'
        '<SubTree ID="Talk" what="hello"/><SetBlackboard output_key="x" value="1"/></Sequence></BehaviorTree>'
        '<BehaviorTree ID="Talk"><Say text="{what}"/></BehaviorTree></root>'
    )
    outcome = tree.run(speed="max")
    assert outcome.status is btlang.Status.SUCCESS


def test_a_failure_shows_the_tag(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = tmp_path / "tree.xml"
    file.write_text(
        '<root><BehaviorTree>\n  <Sequence>\n    <GoTo place="atlantis"/>\n  </Sequence></BehaviorTree></root>'
    )
    assert main(["run", str(file), "--speed", "max", "--quiet"]) in (1, 2)
    errors = capsys.readouterr().err
    assert '    <GoTo place="atlantis"/>\n      ^^^^^^^^^^^^^^^^^^^^^^^^\n' in errors
    assert "Traceback" not in errors


def test_missions_do_not_pay_for_xml() -> None:
    program = (
        "import sys; from btlang.cli import main; code = main(['check', '-c', 'move forward 1 m then say done']); "
        "sys.exit(code or any('xml' in name or 'expat' in name or 'btcpp' in name for name in sys.modules))"
    )
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, check=False)
    assert done.returncode == 0
