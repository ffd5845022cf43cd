"""What `btc check` says of entries of blackboards, of outputs, and of all that is wrong with one tag."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.projects.trees import TREE, problems, write

MODELS = """
<Action ID="Find"><output_port name="at" type="geometry_msgs::msg::Pose"/>
  <output_port name="count" type="int"/></Action>
<Action ID="Move"><input_port name="to" type="geometry_msgs::msg::Pose"/></Action>
<Action ID="Spin"><input_port name="speed" type="double"/><input_port name="times" type="int32_t"/></Action>
<Action ID="Log"><input_port name="text" type="std::string"/></Action>
<Action ID="Paint"><input_port name="color" type="RED|GREEN"/></Action>
"""


def found(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], *trees: str, code: str = "", models: str = MODELS
) -> list[str]:
    """The messages with a code, of trees of which the first is the main one."""
    named = [TREE.format(f"T{at}", f"<Sequence>{tree}</Sequence>") for at, tree in enumerate(trees)]
    write(tmp_path, "trees.xml", *named, models=models, attributes='main_tree_to_execute="T0"')
    return [problem["message"] for problem in problems(capsys, str(tmp_path)) if problem["code"] == code]


@pytest.mark.parametrize(
    ("use", "tree", "unset"),
    [
        ('<SubTree ID="T1"/>', '<Move to="{goal}"/>', "goal"),
        ('<SubTree ID="T1"/>', '<Sleep msec="{goal}"/>', "goal"),
        ('<SubTree ID="T1"/>', '<ScriptCondition code="goal &gt; 3"/>', "goal"),
        ('<SubTree ID="T1" goal="{x}"/><SubTree ID="T1"/>', '<Move to="{goal}"/>', "goal"),
        ('<SubTree ID="T1" goal="{x}"/>', '<Move to="{goal}"/>', ""),
        ('<SubTree ID="T1" _autoremap="true"/>', '<Move to="{goal}"/>', ""),
        ('<SubTree ID="T1"/>', '<Find at="{goal}"/><Move to="{goal}"/>', ""),
        ('<SubTree ID="T1"/>', '<Nobody to="{goal}"/><Move to="{goal}"/>', ""),
        ('<SubTree ID="T1"/>', '<Script code="goal := 1"/><Move to="{goal}"/>', ""),
        ('<SubTree ID="T1"/>', '<SetBlackboard output_key="goal" value="1"/><Move to="{goal}"/>', ""),
        ('<SubTree ID="T1"/>', '<SubTree ID="T2" out="{goal}"/><Move to="{goal}"/>', "goal"),
        ('<SubTree ID="T1"/>', '<SubTree ID="T3" out="{goal}"/><Move to="{goal}"/>', ""),
        ('<SubTree ID="T1"/>', '<SubTree ID="Gone" out="{goal}"/><Move to="{goal}"/>', ""),
        ('<SubTree ID="T1"/>', '<SubTree ID="T2" _autoremap="true"/><Move to="{goal}"/>', "goal"),
        ('<SubTree ID="T1"/>', '<SubTree ID="T3" _autoremap="true"/><Log text="{out}"/>', ""),
        ('<SubTree ID="T1"/>', '<SubTree ID="T4" text="{goal}"/>', "goal"),
        ('<SubTree ID="T1"/><SubTree ID="T1" _autoremap="true"/>', '<Move to="{goal}"/>', "goal"),
        ('<SubTree ID="T1"/>', '<Move to="{@goal}"/>', ""),
        ('<SubTree ID="T1"/>', '<Log text="at {goal}"/>', ""),
    ],
)
def test_entries_of_subtrees_that_nothing_sets(
    use: str, tree: str, unset: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A SubTree node sets what its tree sets, and an unknown port may set anything. Only a main tree is given more."""
    inner = '<Log text="x"/>', '<SubTree ID="T5" at="{out}"/>', '<SubTree ID="T6" text="{text}"/>'
    leaves = '<Find at="{at}"/>', '<Log text="{text}"/>'
    messages = found(tmp_path, capsys, use + '<Move to="{from_outside}"/>', tree, *inner, *leaves, code="BT241")
    assert [message.split("'")[1] for message in messages] == ([unset] if unset else [])


@pytest.mark.parametrize(
    ("tree", "unset"),
    [
        ('<Script code="count := 1; done := 2"/><ScriptCondition code="coutn == done"/>', "coutn"),
        ('<Script code="count := 1"/><ScriptCondition code="coutn == count"/>', ""),  # count has a reader
        ('<Script code="count := 1"/><ScriptCondition code="limit == 2"/>', ""),
        ('<SubTree ID="T1" at="{goal}"/><Move to="{gaol}"/>', "gaol"),
    ],
)
def test_what_is_set_in_a_main_tree_is_read_by_another_name(
    tree: str, unset: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    messages = found(tmp_path, capsys, tree, '<Find at="{at}"/>', code="BT241")
    assert [message.split("'")[1] for message in messages] == ([unset] if unset else [])


@pytest.mark.parametrize(
    ("use", "tree", "wanted"),
    [
        ('<SubTree ID="T1" v="fast"/>', '<Spin speed="{v}"/>', ["a number"]),
        ('<SubTree ID="T1" v="1.5"/>', '<Spin speed="{v}"/>', []),
        ('<SubTree ID="T1" v="blue"/>', '<SubTree ID="T2" c="{v}"/>', ["one of RED, GREEN"]),
        ('<SubTree ID="T1" v="fast"/>', '<Script code="v := 1"/><Spin speed="{v}"/>', []),
        ('<SubTree ID="T1" v="{fast}"/>', '<Spin speed="{v}"/>', []),
    ],
)
def test_a_constant_of_a_subtree_is_read_as_what_it_can_be(
    use: str, tree: str, wanted: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    messages = found(tmp_path, capsys, use, tree, '<Paint color="{c}"/>', code="BT233")
    assert [message.partition("of T1: ")[2].removesuffix(" is needed.") for message in messages] == wanted


def test_version_3_names_outputs_without_braces(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main = TREE.format("MainTree", '<SubTree ID="Go"/>')
    inner = TREE.format("Go", '<Sequence><Action ID="Find" at="goal"/><Action ID="Move" to="{goal}"/></Sequence>')
    text = f"<root>{main}{inner}<TreeNodesModel>{MODELS}</TreeNodesModel></root>"
    (tmp_path / "old.xml").write_text(text, "utf-8")
    assert problems(capsys, str(tmp_path)) == []


def test_outputs_are_entries(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    tree = '<Find at="goal" count="${n}"/><Find at="{goal}" count=""/><Find at="{=}" count="{n}"/>'
    assert found(tmp_path, capsys, tree, code="BT233") == [
        "'goal' can't be the port at of Find: an entry such as {key} is needed.",
        "'${n}' can't be the port count of Find: an entry such as {key} is needed.",
    ]


@pytest.mark.parametrize(
    ("tree", "types"),
    [
        ('<Find count="{n}"/><Spin speed="{n}"/>', "int, and its port speed is of type double"),
        ('<Find at="{n}"/><Spin times="{n}"/>', "geometry_msgs::msg::Pose, and its port times is of type int32_t"),
        ('<Find count="{n}"/><Log text="{n}"/>', "int, and its port text is of type std::string"),
        ('<Repeat num_cycles="{n}"><Spin speed="{n}"/></Repeat>', "int, and its port speed is of type double"),
        ('<Find count="{n}"/><Spin times="{n}"/>', ""),  # one type with two names
        ('<Log text="{n}"/><Spin speed="{n}"/>', ""),  # a text can be read as anything
        ('<Nobody n="{n}"/><Find count="{n}"/><Spin speed="{n}"/>', ""),  # the first type isn't known
        ('<SetBlackboard output_key="n" value="1"/><Find count="{n}"/><Spin speed="{n}"/>', ""),
        ('<SubTree ID="T1" x="{n}"/><Find count="{n}"/><Spin speed="{n}"/>', ""),
        ('<Find count="{n}"/><Paint color="{n}"/>', ""),
    ],
)
def test_two_types_of_an_entry(tree: str, types: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    messages = found(tmp_path, capsys, tree, '<Log text="{x}"/>', code="BT132")
    assert [message.partition("'n' is of type ")[2] for message in messages] == ([f"{types}."] if types else [])


TEXT, NUMBER = "<Script code=\"n := 'slow'\"/>", '<Script code="n := 1"/>'
TO_NUMBER, TO_TEXT = (
    "BT132 a text, and its port code makes it a number",
    "BT132 a number, and its port code makes it a text",
)


@pytest.mark.parametrize(
    ("tree", "wanted"),
    [
        (NUMBER + TEXT, TO_TEXT),
        (TEXT + NUMBER, TO_NUMBER),
        (TEXT + '<Script code="n += 1"/>', TO_NUMBER),
        ('<SetBlackboard output_key="n" value="0"/><Script code="n = n + 1"/>', TO_NUMBER),
        ('<Script code="n := m == 1"/><Log text="x" _onSuccess="n := \'done\'"/>',
         "BT132 a number, and its port _onSuccess makes it a text"),
        (NUMBER + '<Script code="n := \'5\'"/>', ""),  # the text is converted
        (NUMBER + '<Script code="n := \'RED\'"/>', ""),  # it may be an enum
        (NUMBER + '<Script code="n := m"/>' + NUMBER, ""),
        (NUMBER + '<Script code="n := m ? \'a\' : \'b\'"/>', ""),
        (NUMBER + '<Script code="n := -2.5; n := 0x10"/>', ""),
        (NUMBER + '<Log text="{n}"/>', ""),  # a number is read as a text
        (TEXT + '<Spin speed="{n}"/>', "BT233 'slow' can't be the port speed of Spin: a number is needed"),
        (NUMBER + '<Move to="{n}"/>',
         "BT132 of type geometry_msgs::msg::Pose, and its port code makes it a number"),
        ('<SetBlackboard output_key="n" value="soon"/><Sleep msec="{n}"/>',
         "BT233 'soon' can't be the port msec of Sleep: a whole number from 0 to 4,294,967,295 is needed"),
        ('<Script code="n := 2.5"/><Spin times="{n}"/>',
         "BT233 '2.5' can't be the port times of Spin: a whole number from -2,147,483,648 to 2,147,483,647 is needed"),
        ('<Script code="n := 0x10"/><Spin times="{n}"/>', ""),
        ('<SetBlackboard output_key="n" value="3"/><Sleep msec="{n}"/><Script code="n += 1"/>', ""),  # Sleep types it
        (NUMBER + '<SubTree ID="T1" text="{n}"/>', "BT132 a number, and its port text makes it a text"),
        (NUMBER + '<SubTree ID="T2" _autoremap="true"/>', "BT132 a number, and its tree makes it a text"),
        ('<SubTree ID="T1" text="5"/>', "BT132 a number, and its port text makes it a text"),
        ('<SubTree ID="T1" text="five"/>', ""),
        (NUMBER + TEXT + '<Nobody n="{n}"/>', ""),  # its port may have a type that both become
    ],
)  # fmt: skip
def test_values_of_scripts_that_an_entry_cannot_become(
    tree: str, wanted: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """An entry has the type of its ports, wherever they are, else of its first value."""
    trees = tree, "<Script code=\"text := 'slow'\"/>", TEXT
    named = [TREE.format(f"T{at}", f"<Sequence>{each}</Sequence>") for at, each in enumerate(trees)]
    write(tmp_path, "trees.xml", *named, models=MODELS, attributes='main_tree_to_execute="T0"')
    found = [problem for problem in problems(capsys, str(tmp_path)) if problem["code"] in ("BT132", "BT233")]
    code, _, text = wanted.partition(" ")
    assert [problem["code"] for problem in found] == ([code] if wanted else [])
    assert all(problem["message"].endswith(f"{text}.") for problem in found)


def test_only_one_asynchronous_sequence_in_a_reactive_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    part = '<AsyncSequence><Log text="x"/></AsyncSequence>'
    trees = f"<ReactiveSequence>{part * 2}</ReactiveSequence><ReactiveSequence>{part}</ReactiveSequence>{part}{part}"
    [message] = found(tmp_path, capsys, trees, code="BT132")
    assert "BehaviorTree.CPP refuses more than one AsyncSequence in it since 4.7" in message


SCRIPTS = '<Script code="color := RED; other := GREN; third := BLUE"/><Log text="{color}{other}{third}"/>'


@pytest.mark.parametrize(
    ("source", "unset"),
    [
        ("", ["GREN"]),
        ('factory.registerNodeType<Log>("Log");', ["BLUE", "GREN"]),
        ('factory.registerNodeType<Log>("Log"); factory.registerScriptingEnum("BLUE", 3);', ["GREN"]),
        ('factory.registerNodeType<Log>("Log"); factory.registerScriptingEnums<Color>();', ["GREN"]),
    ],
)
def test_names_of_enums_in_scripts(
    source: str, unset: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """They are known by the types of ports and by C++; what C++ doesn't show is only reported if it is misspelt."""
    (tmp_path / "main.cpp").write_text(source, "utf-8")
    messages = found(tmp_path, capsys, SCRIPTS, code="BT241")
    assert sorted(message.split("'")[1] for message in messages) == unset


def test_all_that_is_wrong_with_a_tag(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    trees = '<Timeout timeout_ms="3"/><Parallel success_count="9" failure_count="x" fast="1"><Log text="x"/></Parallel>'
    reasons = [message.partition("like this: ")[2] for message in found(tmp_path, capsys, trees, code="BT132")]
    assert sorted(reasons) == [
        "Parallel takes no port fast.",
        "Timeout has 0 children instead of 1.",
        "Timeout needs a port msec.",
        "Timeout takes no port timeout_ms.",
        "failure_count must be a whole number from -2 to 1, not 'x'.",
        "success_count must be a whole number from -2 to 1, not '9'.",
    ]


def test_a_wrong_number_hides_no_other_mistake(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    tree = '<Repeat num_cycles="x" times="3"><Log text="x"/></Repeat>'
    write(tmp_path, "tree.xml", TREE.format("Main", tree), models=MODELS)
    assert [problem["code"] for problem in problems(capsys, str(tmp_path))] == ["BT014", "BT132"]
