"""Four repositories with planted faults: `btc check` finds all of them, and what else it says of them is true.

Their trees were written by somebody who hadn't read the checker. Beside each repository is the list of its faults;
`others` are findings that were judged to be true. In one of them, IDs contain blanks (BT238), as in the field.
"""

from __future__ import annotations

import os
import re
import tomllib
from pathlib import Path

import pytest

from btlang.cli import main
from tests.projects.trees import TREE, problems, write

REPOSITORIES = Path(__file__).parent.parent / "corpus" / "repositories"
NAMES = sorted(path.stem for path in REPOSITORIES.glob("*.toml"))


@pytest.mark.parametrize("name", NAMES)
def test_all_planted_faults_are_found_and_nothing_false(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    listed = tomllib.loads((REPOSITORIES / f"{name}.toml").read_text("utf-8"))
    planted = {f"{fault['file']}:{fault['line']} {fault['code']}" for fault in listed["fault"]}
    assert len(planted) == 20
    folder = REPOSITORIES / name
    assert sum(path.read_text("utf-8").count("<BehaviorTree ") for path in folder.rglob("*.xml")) >= 30
    found = {
        f"{os.path.relpath(problem['file'], folder)}:{problem['line']} {problem['code']}"
        for problem in problems(capsys, str(folder))
    }
    assert planted <= found
    assert {each for each in found if not each.endswith("BT238")} == planted | set(listed["others"])


def test_older_versions_take_what_newer_ones_refuse(capsys: pytest.CaptureFixture[str]) -> None:
    folder = str(REPOSITORIES / "bench")
    newest = {problem["code"] for problem in problems(capsys, folder)}
    before_4_9 = {problem["code"] for problem in problems(capsys, "--btcpp", "4.8.4", folder)}
    assert newest - before_4_9 == {"BT242"}
    assert before_4_9 - {problem["code"] for problem in problems(capsys, "--btcpp", "4.8", folder)} == {"BT238"}


def test_two_async_sequences_are_refused_since_4_7(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    inner = "<AsyncSequence><Sleep msec='9'/></AsyncSequence>"
    write(tmp_path, "a.xml", TREE.format("Main", f"<ReactiveSequence>{inner * 2}</ReactiveSequence>"))
    [problem] = problems(capsys, str(tmp_path))
    assert "since 4.7" in problem["message"]
    assert problems(capsys, "--btcpp", "4.6", str(tmp_path)) == []


@pytest.mark.parametrize("text", ["5", "4.x", "four", "4.8.", ""])
def test_what_is_no_version(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["check", "--btcpp", text, "x.xml"])
    assert "is no version of BehaviorTree.CPP 3 or 4, such as 4.8" in capsys.readouterr().err


def test_a_version_decides_about_files_that_could_be_of_either(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """In version 4 a text without braces is no entry; in version 3 that of a SubTree is one."""
    (tmp_path / "a.xml").write_text(
        '<root main_tree_to_execute="A"><BehaviorTree ID="A"><SubTree ID="B" far="ten"/></BehaviorTree>'
        '<BehaviorTree ID="B"><Drive metres="{far}"/></BehaviorTree><TreeNodesModel><Action ID="Drive">'
        '<input_port name="metres" type="double"/></Action></TreeNodesModel></root>',
        "utf-8",
    )
    assert problems(capsys, str(tmp_path)) == []
    assert [problem["code"] for problem in problems(capsys, "--btcpp", "4.6", str(tmp_path))] == ["BT233"]


def test_one_circle_hides_nothing_else(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A single tree that used itself kept all other trees of a folder from most checks."""
    write(tmp_path, "a.xml", TREE.format("Again", '<Sequence><Wave/><SubTree ID="Again"/></Sequence>'))
    write(tmp_path, "b.xml", TREE.format("Never", "<Fallback><AlwaysSuccess/><Wave/></Fallback>"))
    write(tmp_path, "c.xml", TREE.format("Uses", '<Sequence><SubTree ID="Again"/><Switch2><Nod/></Switch2></Sequence>'))
    found = {problem["code"] for problem in problems(capsys, str(tmp_path))}
    assert found == {"BT124", "BT052", "BT132"}


def test_one_bad_tree_hides_no_other_tree_of_its_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    good = TREE.format("Greet", '<Say text="{who}"/>') + TREE.format("Main", '<SubTree ID="Greet" who="Ann"/>')
    write(tmp_path, "one/a.xml", good, TREE.format("Empty", ""), TREE.format("Twice", "<Wave/><Wave/>"))
    write(tmp_path, "two/b.xml", TREE.format("Greet", "<Wave/>"), TREE.format("Empty", "<Wave/>"))
    write(
        tmp_path, "one/c.xml", TREE.format("Other", '<Sequence><SubTree ID="Empty"/><SubTree ID="Twice"/></Sequence>')
    )
    assert {problem["code"] for problem in problems(capsys, str(tmp_path))} == {"BT122"}


def test_what_a_file_that_is_no_xml_may_define_is_not_missed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write(tmp_path, "a.xml", TREE.format("Main", '<Sequence><SubTree ID="Dock"/><Rinse hard="1"/></Sequence>'))
    (tmp_path / "b.xml").write_text('<root BTCPP_format="4"><BehaviorTree ID="Dock"><Nod/></BehaviorTree>'
                                    '<TreeNodesModel><Action ID="Rinse"/></TreeNodes></root>', "utf-8")  # fmt: skip
    assert [problem["code"] for problem in problems(capsys, str(tmp_path))] == ["BT120"]


def test_a_model_is_about_the_tree_of_its_own_program(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The default of one program's tree was given to the trees of that ID in all others."""
    model = '<SubTree ID="Greet"><input_port name="times" default="2"/><input_port name="who"/></SubTree>'
    write(tmp_path, "one.xml", TREE.format("Greet", '<Repeat num_cycles="{times}"><Say text="{who}"/></Repeat>'),
          TREE.format("Main", '<SubTree ID="Greet" who="Ann"/>'), models=model)  # fmt: skip
    write(tmp_path, "two.xml", TREE.format("Greet", "<Wave/>"), TREE.format("Main", '<SubTree ID="Greet"/>'))
    assert problems(capsys, str(tmp_path)) == []


def test_a_model_of_another_program_is_not_stale(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Both describe the node in their own way; what C++ says of it counts where no model does."""
    model = '<Action ID="Announce"><input_port name="text"/></Action>'
    write(tmp_path, "demo/fair.xml", TREE.format("Main", '<Announce text="Hello"/>'), models=model)
    write(tmp_path, "robot/parts.xml", TREE.format("Part", '<Announce text="a" volume="1"/>'))
    use = TREE.format("Main", '<Sequence><SubTree ID="Part"/><Announce text="b" volum="2"/></Sequence>')
    write(tmp_path, "robot/main.xml", '<include path="parts.xml"/>', use)
    (tmp_path / "robot" / "nodes.cpp").write_text(
        "class Announce : public BT::SyncActionNode { static BT::PortsList providedPorts() {\n"
        'return {BT::InputPort<std::string>("text"), BT::InputPort<int>("volume")}; } };\n', "utf-8"
    )  # fmt: skip
    [problem] = problems(capsys, str(tmp_path))
    assert (problem["code"], os.path.basename(problem["file"])) == ("BT232", "main.xml")


@pytest.mark.parametrize(
    ("tree", "reason"),
    [
        ('<Grip><Wave/></Grip>', "it is an Action, and has 1 child instead of 0"),
        ('<Condition ID="IsUp"><Wave/><Nod/></Condition>', "it is a Condition, and has 2 children instead of 0"),
        ('<Lamp><Wave/><Nod/></Lamp>', "it is a Decorator, and has 2 children instead of 1"),
        ('<Decorator ID="Light"/>', "it is a Decorator, and has 0 children instead of 1"),
    ],
)  # fmt: skip
def test_children_of_nodes_that_models_describe(
    tree: str, reason: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    models = '<Action ID="Grip"/><Condition ID="IsUp"/><Decorator ID="Lamp"/><Decorator ID="Light"/>'
    write(tmp_path, "a.xml", TREE.format("Main", f"<Sequence>{tree}<Lamp><Wave/></Lamp></Sequence>"), models=models)
    [problem] = problems(capsys, str(tmp_path))
    assert problem["code"] == "BT132"
    assert reason in problem["message"]


def test_references_that_are_none(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    models = '<Action ID="Log"><input_port name="text" type="std::string"/></Action>'
    texts = ("{a", "a}", " {a ", "{a}", "json:{'a': 1}", "{'a': [1]}", "{} of {}", "at {b}", "at {a}")
    logs = "".join(f'<Log text="{text}"/>' for text in texts)
    set_a = "<Script code=\"a := 'x'\"/>"
    write(tmp_path, "a.xml", TREE.format("Main", f"<Sequence>{set_a}{logs}</Sequence>"), models=models)
    uses = '<Say text="at {a}"/><Say text="at {b}"/><Say text="{a}"/><SubTree ID="Part" text="{a}."/>'
    part = TREE.format("Part", '<Say text="{text}"/>')
    write(tmp_path, "b.xml", TREE.format("Talk", f"<Sequence>{set_a}{uses}</Sequence>"), part)
    found = problems(capsys, str(tmp_path))
    broken = [problem["message"].split("'")[1] for problem in found if problem["code"] == "BT233"]
    assert broken == ["{a", "a}", " {a "]
    inside = [problem["hint"].split("give ")[1].split()[0] for problem in found if problem["code"] == "BT245"]
    assert inside == ["Say", "Part"]
    assert len(found) == 5


def test_a_tree_may_be_in_a_folder_that_is_not_checked(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Unless an include says which trees there are, or the ID is only misspelt."""
    use = TREE.format("{}", '<Sequence><SubTree ID="Look Around"/><SubTree ID="Waev"/></Sequence>')
    write(tmp_path, "a.xml", use.format("A"))
    write(tmp_path, "b.xml", use.format("B"), TREE.format("Wave", "<Nod/>"))
    found = [problem for problem in problems(capsys, str(tmp_path)) if problem["code"] != "BT238"]
    assert [problem["code"] for problem in found] == ["BT244", "BT126", "BT126"]
    assert "which is used twice" in found[0]["message"]
    write(tmp_path, "c.xml", '<include path="a.xml"/><include path="b.xml"/>', TREE.format("C", '<SubTree ID="A"/>'))
    found = [problem for problem in problems(capsys, str(tmp_path)) if re.match("BT(126|244)", problem["code"])]
    assert [problem["code"] for problem in found] == ["BT126"] * 4


def test_a_package_has_the_name_in_its_manifest(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A clone may be in a folder of any name."""
    write(tmp_path, "clone/trees/dock.xml", TREE.format("Dock", "<Nod/>"))
    (tmp_path / "clone" / "package.xml").write_text("<package><name>dock_trees</name></package>", "utf-8")
    path = "install/dock_trees/share/dock_trees/trees/dock.xml"
    write(tmp_path, "clone/main.xml", f'<include path="{path}"/>', TREE.format("Main", '<SubTree ID="Dock"/>'))
    assert problems(capsys, str(tmp_path)) == []


@pytest.mark.parametrize(
    ("first", "later", "code"),
    [
        ("std::string", "int", "BT246"),
        ("std::string", "std::string", ""),
        ("std::vector&lt;Part&gt;", "Part", "BT132"),
        ("Part", "std::vector&lt; Part &gt;", "BT132"),
        ("std::vector&lt;Part&gt;", "std::vector&lt;Part&gt;", ""),
        ("Parts", "Part", ""),
    ],
)
def test_types_of_an_entry(
    first: str, later: str, code: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    models = (f'<Action ID="Find"><output_port name="part" type="{first}"/></Action>'
              f'<Action ID="Take"><input_port name="part" type="{later}"/></Action>')  # fmt: skip
    write(tmp_path, "a.xml", TREE.format("Main", '<Sequence><Find part="{p}"/><Take part="{p}"/></Sequence>'),
          models=models)  # fmt: skip
    assert [problem["code"] for problem in problems(capsys, str(tmp_path))] == ([code] if code else [])


@pytest.mark.parametrize(
    ("action", "model", "warns"),
    [
        ("Grip", '<Action ID="Grip"/>', True),
        ("Grip", '<Condition ID="Grip"/>', False),
        ("Grip", '<Action ID="Grip"><output_port name="pose"/></Action>', True),
        ("Grip", "", False),
        ("CheckGrip", '<Action ID="CheckGrip"/>', False),
        ("PublishGrip", '<Action ID="PublishGrip"/>', False),
        ("SetGrip", '<Action ID="SetGrip"/>', True),
        ("SetFlag", "", False),
        ("SetArm", "", True),
    ],
)
def test_an_action_of_others_that_starts_again(
    action: str, model: str, warns: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Outputs that are read may be computed anew, and what sets a value at once may set it again."""
    models = f'{model}<Action ID="Then"/>'
    port = 'return {BT::InputPort<bool>("on")}; } };'
    code = "class %s : public BT::%s { static BT::PortsList providedPorts() { " + port
    classes = (code % each for each in (("SetFlag", "SyncActionNode"), ("SetArm", "StatefulActionNode")))
    (tmp_path / "nodes.cpp").write_text("\n".join(classes), "utf-8")
    tree = f'<ReactiveSequence><{action} on="true"/><SubTree ID="Rest"/></ReactiveSequence>'
    write(tmp_path, "a.xml", TREE.format("Main", tree), TREE.format("Rest", "<Then/>"), models=models)
    assert ("BT243" in {problem["code"] for problem in problems(capsys, str(tmp_path))}) == warns


@pytest.mark.parametrize(
    ("use", "takes", "code"),
    [
        ('<SubTree ID="Part" thing="{cup}"/>', "pose", "BT132"),
        ('<SubTree ID="Part" thing="{cup}"/>', "count", ""),
        ('<SubTree ID="Outer" given="{cup}"/>', "pose", "BT132"),
        ('<SubTree ID="Shared" _autoremap="true"/>', "pose", "BT132"),
        ('<SubTree ID="Shared" _autoremap="true"/>', "count", ""),
        ('<SubTree ID="Shared"/>', "pose", ""),
        ('<SubTree ID="Shared" cup="{plate}" _autoremap="true"/>', "pose", ""),
        ('<SubTree ID="Elsewhere" thing="{cup}"/><SubTree ID="Part" thing="{cup}"/>', "pose", "BT132"),
    ],
)
def test_types_through_subtrees(
    use: str, takes: str, code: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """In BehaviorTree.CPP an entry has the type that its first port gives it, in whatever tree that is."""
    models = (
        '<Action ID="Count"><output_port name="count" type="int"/></Action>'
        '<Action ID="Take"><input_port name="count" type="int" default="1"/>'
        '<input_port name="pose" type="geometry_msgs::msg::Pose" default=""/></Action>'
    )
    trees = {
        "Main": f'<Sequence><Count count="{{cup}}"/>{use}</Sequence>',
        "Outer": '<SubTree ID="Part" thing="{given}"/>',
        "Part": f'<Take {takes}="{{thing}}"/>',
        "Shared": f'<Take {takes}="{{cup}}"/>',
    }
    found = (TREE.format(name, tree) for name, tree in trees.items())
    write(tmp_path, "a.xml", *found, models=models, attributes='main_tree_to_execute="Main"')
    codes = {problem["code"] for problem in problems(capsys, str(tmp_path))}
    assert codes - {"BT126", "BT235", "BT236", "BT241"} == ({code} if code else set())
