"""Kinds of faults that were missed, and of false alarms, in repositories of teams that were new to the checker."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.projects.trees import TREE, problems, write

POSE, IMAGE = "geometry_msgs::msg::PoseStamped", "sensor_msgs::msg::Image"
DRIVE = '<Action ID="Drive"><input_port name="goal" type="Pose"/></Action><Action ID="Then"/>'


def codes(folder: Path, capsys: pytest.CaptureFixture[str], *wanted: str) -> list[str]:
    found = [problem["code"] for problem in problems(capsys, str(folder))]
    return [code for code in found if code in wanted] if wanted else found


def test_a_misspelt_port_reads_what_the_right_one_would(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    trees = {
        "Main": '<SubTree ID="Trip"/>',
        "Trip": '<SubTree ID="Leg" to="{nowhere}"/>',
        "Leg": '<Drive gaol="{to}"/>',
    }
    write(tmp_path, "a.xml", *(TREE.format(name, tree) for name, tree in trees.items()), models=DRIVE)
    assert sorted(codes(tmp_path, capsys, "BT232", "BT241")) == ["BT232", "BT241"]


LIFT = """
class Lift : public BT::StatefulActionNode {
  static BT::PortsList providedPorts() { return { BT::InputPort<double>("height"), BT::OutputPort<double>("load") }; }
};
"""


def test_outputs_that_only_cpp_shows(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "lift.hpp").write_text(LIFT, "utf-8")
    model = '<Action ID="Lift"><input_port name="height" type="double"/></Action>'
    write(tmp_path, "a.xml", TREE.format("Main", '<Lift height="1" load="0"/>'), models=model)
    assert codes(tmp_path, capsys, "BT233") == ["BT233"]


@pytest.mark.parametrize(("text", "is_wrong"), [("0.5", True), ("score", False), ("{score}", False)])
def test_version_3_writes_a_number_nowhere(
    text: str, is_wrong: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    tree = TREE.format("Main", f'<Action ID="Look" score="{text}"/>')
    model = '<TreeNodesModel><Action ID="Look"><output_port name="score"/></Action></TreeNodesModel>'
    (tmp_path / "a.xml").write_text(f'<root main_tree_to_execute="Main">{tree}{model}</root>', "utf-8")
    assert codes(tmp_path, capsys, "BT233") == ["BT233"] * is_wrong


ENUM = "enum class Lamp : int { OFF = 0, GREEN, /* no BLUE, */ RED = 3 };"


@pytest.mark.parametrize(
    ("source", "unset"),
    [
        (f"{ENUM} void f() {{ factory.registerScriptingEnums<robot::Lamp>(); }}", {"GREN", "BLUE"}),
        ("void f() { factory.registerScriptingEnums<robot::Lamp>(); }", set()),
        (None, {"OFF", "GREN", "BLUE"}),
    ],
)
def test_enums_that_are_registered_as_a_whole(
    source: str | None, unset: set[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Where a folder has no C++, the warning says that its source is missing."""
    if source is not None:
        (tmp_path / "main.cpp").write_text(source, "utf-8")
        (tmp_path / "then.hpp").write_text(LIFT, "utf-8")
    tree = '<Script code="a := OFF; b := GREN; c := BLUE; d := a + b + c; a := d"/>'
    write(tmp_path, "a.xml", TREE.format("Main", tree))
    found = [each["message"].split("'")[1] for each in problems(capsys, str(tmp_path)) if each["code"] == "BT241"]
    assert set(found) == unset


@pytest.mark.parametrize(
    ("first", "later", "is_wrong"),
    [
        (IMAGE, "std::vector&lt;Tag&gt;", True),
        ("std::vector&lt;Tag&gt;", IMAGE, True),
        (IMAGE, POSE, True),
        ("int", "std::vector&lt;Tag&gt;", True),
        ("std::vector&lt;Tag&gt;", "std::vector&lt;robot::Tag&gt;", False),
        (f"std::vector&lt;{POSE}&gt;", "nav_msgs::msg::Goals", False),
    ],
)
def test_messages_and_lists_of_one_entry(
    first: str, later: str, is_wrong: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Nav2's list of goals is another type in another version."""
    models = (f'<Action ID="Find"><output_port name="it" type="{first}"/></Action>'
              f'<Action ID="Take"><input_port name="it" type="{later}"/></Action>')  # fmt: skip
    write(tmp_path, "a.xml", TREE.format("Main", '<Sequence><Find it="{x}"/><Take it="{x}"/></Sequence>'),
          models=models)  # fmt: skip
    assert codes(tmp_path, capsys) == ["BT132"] * is_wrong


@pytest.mark.parametrize(
    ("main", "inner", "is_wrong"),
    [
        ('<Script code="n = 3"/>', "<Then/>", True),
        ('<Script code="n := 3; n = 4"/>', "<Then/>", False),
        ('<Script code="n = 3" _skipIf="n == 2"/>', "<Then/>", False),
        ("<Then/>", '<Script code="n = 3" _skipIf="n == 2"/>', True),
        ('<SubTree ID="Inner" n="{count}"/>', '<Script code="n = 3"/>', False),
        ('<SubTree ID="Inner" _autoremap="true"/>', '<Script code="n = 3"/>', False),
    ],
)
def test_a_script_changes_only_what_there_is(
    main: str, inner: str, is_wrong: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A program may make entries of a main tree that the tree also reads."""
    use = "" if "SubTree" in main else '<SubTree ID="Inner"/>'
    trees = TREE.format("Main", f"<Sequence>{main}{use}</Sequence>"), TREE.format("Inner", inner)
    write(tmp_path, "a.xml", *trees, models=DRIVE, attributes='main_tree_to_execute="Main"')
    found = [each for each in problems(capsys, str(tmp_path)) if "`=` only changes" in each["hint"]]
    assert len(found) == is_wrong


LATER = "<Then/>"


@pytest.mark.parametrize(
    ("first", "later", "warns"),
    [
        ('<SubTree ID="Inner"/>', LATER, True),
        ('<Sequence><IsOpen/><Open side="left"/></Sequence>', LATER, True),
        ('<Fallback><IsOpen/><Open side="left"/></Fallback>', LATER, False),
        ('<Open side="left" _skipIf="open"/>', LATER, False),
        ('<Open side="left" _while="shut"/>', LATER, False),
        ('<Open side="left"/>', "<Inverter><IsOpen/></Inverter>", False),
        ('<Open side="left"/>', '<Delay delay_msec="9"><IsOpen/></Delay>', True),
        ('<Look pose="{unread}"/>', LATER, True),
        ('<Look pose="{read}"/>', '<Open side="{read}"/>', False),
    ],
)
def test_what_a_reactive_sequence_starts_again(
    first: str, later: str, warns: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    models = (
        '<Condition ID="IsOpen"/><Action ID="Open"><input_port name="side"/></Action><Action ID="Then"/>'
        '<Action ID="Look"><output_port name="pose"/></Action>'
    )
    main = TREE.format("Main", f"<ReactiveSequence>{first}{later}</ReactiveSequence>")
    write(tmp_path, "a.xml", main, TREE.format("Inner", '<Open side="left"/>'), models=models)
    assert codes(tmp_path, capsys, "BT243") == ["BT243"] * warns


@pytest.mark.parametrize(("times", "warns"), [(1, True), (3, False)])
def test_a_team_that_always_repeats_instant_actions_means_it(
    times: int, warns: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "say.hpp").write_text("class Honk : public BT::SyncActionNode { };", "utf-8")
    part = '<ReactiveSequence><Honk/><Sleep msec="9"/></ReactiveSequence>'
    write(tmp_path, "a.xml", TREE.format("Main", f"<Sequence>{part * times}</Sequence>"),
          models='<Action ID="Honk"/>')  # fmt: skip
    assert codes(tmp_path, capsys) == ["BT243"] * warns


def test_which_of_two_trees_is_unused_is_not_known(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    trees = (TREE.format("Main", '<SubTree ID="Dock"/>'), *(TREE.format("Dock", "<Then/>") for _ in range(2)))
    write(tmp_path, "a.xml", *trees, models=DRIVE, attributes='main_tree_to_execute="Main"')
    assert codes(tmp_path, capsys) == ["BT127"]


def test_a_model_that_is_out_of_date_in_several_ways_is_one_warning(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = """class Choose : public BT::ControlNode {
      static BT::PortsList providedPorts() { return { BT::InputPort<std::string>("by"), make("case_1") }; } };"""
    (tmp_path / "choose.hpp").write_text(source, "utf-8")
    trees = '<Choose by="{x}" case_1="a"><Then/><Then/></Choose><Choose by="{x}" case_1="b" case_2="c"><Then/></Choose>'
    write(tmp_path, "a.xml", TREE.format("Main", f'<Sequence><Script code="x := 1"/>{trees}</Sequence>'),
          models=f'<Decorator ID="Choose"/>{DRIVE}')  # fmt: skip
    assert codes(tmp_path, capsys) == ["BT239"]


@pytest.mark.parametrize(
    "source",
    [
        "class Twirl : public BT::SyncActionNode { BT::NodeStatus tick() override; };",
        'class Twirl : public Own { enum class Side { LEFT }; PortsList providedPorts() { InputPort<int>("n"); } }',
    ],
)
def test_nodes_of_cpp_that_are_known(source: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Those without ports are known by their base, and an enum inside of a class is none."""
    (tmp_path / "twirl.hpp").write_text(source, "utf-8")
    write(tmp_path, "a.xml", TREE.format("Main", "<Twirl/>"))
    assert codes(tmp_path, capsys) == []


@pytest.mark.parametrize("depends", [True, False])
def test_trees_of_a_package_that_is_not_used_say_nothing(
    depends: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Which tree has that ID when the program runs, is known only if a package depends on the other one."""
    uses = "<exec_depend>base</exec_depend>" if depends else ""
    write(tmp_path, "arm/pick.xml", TREE.format("Pick", '<SubTree ID="Lift" height="1"/>'))
    write(tmp_path, "base/lift.xml", TREE.format("Lift", "<Then/>"), models=DRIVE)
    for name, text in {"arm": uses, "base": ""}.items():
        (tmp_path / name / "package.xml").write_text(f"<package><name>{name}</name>{text}</package>", "utf-8")
    assert codes(tmp_path, capsys) == ["BT235"] * depends


def test_ids_have_no_numbers_in_messages(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for folder in ("a", "b"):
        dock = TREE.format("Dock", "<Then/>")
        write(tmp_path, f"{folder}/dock.xml", TREE.format(f"Main{folder}", '<SubTree ID="Dock" n="1"/>'), dock,
              models=DRIVE)  # fmt: skip
    write(tmp_path, "c.xml", TREE.format("Other", '<SubTree ID="Dok"/>'))
    found = problems(capsys, str(tmp_path))
    assert sorted({problem["code"] for problem in found}) == ["BT126", "BT235"]
    assert not any("(2)" in problem["message"] + problem["hint"] for problem in found)


READS = {
    "if (!getInput<int>(\"n\", n_)) { n_ = 0; }": False,
    "if (!this->getInput(\"n\", n_)) { throw BT::RuntimeError(\"no n\"); }": True,
    "if (!getInput(\"n\", n_)) return BT::NodeStatus::FAILURE;": True,
    "auto given = getInput<int>(\"n\"); if (given) { n_ = given.value(); } else { n_ = 1; }": False,
    "auto given = getInput<int>(\"n\"); if (!given) { n_ = 1; }": False,
    "auto given = getInput<int>(\"n\"); if (!given) { throw BT::RuntimeError(\"no n\"); }": True,
    "n_ = getInput<int>(\"n\").value();": True,
}  # fmt: skip


@pytest.mark.parametrize(("code", "is_needed"), READS.items())
def test_what_a_class_does_without_a_port(
    code: str, is_needed: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    ports = 'static BT::PortsList providedPorts() { return { BT::InputPort<int>("n"), BT::InputPort<int>("m") }; }'
    source = f"class Count : public BT::SyncActionNode {{ {ports} BT::NodeStatus tick() {{ {code} return run(); }} }};"
    (tmp_path / "count.hpp").write_text(source, "utf-8")
    model = '<Action ID="Count"><input_port name="n" type="int"/></Action>'
    write(tmp_path, "a.xml", TREE.format("Main", "<Count/>"), models=model)
    assert codes(tmp_path, capsys) == ["BT234"] * is_needed


def test_a_class_that_is_elsewhere_may_be_of_any_kind(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "main.cpp").write_text('factory.registerNodeType<robot::FirstNode>("FirstOf");', "utf-8")
    write(tmp_path, "a.xml", TREE.format("Main", "<FirstOf><Then/><Then/></FirstOf>"), models=DRIVE)
    assert codes(tmp_path, capsys) == []


def test_files_of_other_programs_with_a_root(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write(tmp_path, "a.xml", TREE.format("Main", "<Then/>"), models=DRIVE)
    (tmp_path / "plots.xml").write_text("<root><curves><curve>speed</curve></curves></root>", "utf-8")
    assert codes(tmp_path, capsys) == []


def test_variants_of_a_program_have_the_same_ids(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A further file that uses one of the IDs isn't about theirs."""
    for name in ("red", "blue"):
        write(tmp_path, f"{name}.xml", *(TREE.format(tree, "<Then/>") for tree in ("Lift", "Lower")), models=DRIVE)
    write(tmp_path, "green.xml", TREE.format("Green", '<SubTree ID="Lift"/>'))
    assert codes(tmp_path, capsys, "BT127") == []


def test_a_palette_of_ids_alone_is_out_of_date(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write(tmp_path, "a.xml", TREE.format("Main", '<Go x="1" y="2"/>'), models='<Action ID="Go" editable="true"/>')
    assert codes(tmp_path, capsys) == ["BT239"]


@pytest.mark.parametrize(
    ("tree", "models", "reasons"),
    [
        ('<SubTreePlus ID="In"/>', "", ["format 4 calls it SubTree"]),
        ('<SubTree ID="In" __autoremap="1"/>', "", ["format 4 has _autoremap in place of __autoremap"]),
        ("<FallbackStar><Then/></FallbackStar>", "", ["format 4 calls it Fallback"]),
        ("<SequenceStar><Then/></SequenceStar>", "", []),
        ("<FallbackStar><Then/></FallbackStar>", '<Control ID="FallbackStar"/>', []),
    ],
)
def test_names_of_version_3_in_format_4(
    tree: str, models: str, reasons: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    trees = TREE.format("Main", tree), TREE.format("In", "<Then/>")
    write(tmp_path, "a.xml", *trees, models=DRIVE + models, attributes='main_tree_to_execute="Main"')
    found = [each["message"].partition("like this: ")[2].rstrip(".") for each in problems(capsys, str(tmp_path))]
    assert [reason for reason in found if reason] == reasons
