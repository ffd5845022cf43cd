"""Trees as teams have them, in English that they can edit: names before statements, guards, short ports and blocks."""

from __future__ import annotations

from pathlib import Path

import pytest

from btlang.api import parse_tree
from btlang.cli import main
from btlang.diagnostics.diagnostic import MissionError
from btlang.text.source import Source

TREE = '<root BTCPP_format="4"><BehaviorTree ID="MainTree">{}</BehaviorTree></root>'
PORTS = 'goal="{goal}" planner="Smac"'
LONG = " ".join(f'{name}="{name} of the cell"' for name in ("shelf", "tray", "gripper", "camera", "approach"))

CASES = {
    "a name before a leaf": (
        f'<Sequence><DetectTags name="first look" {PORTS}/><Wave name="hi"/>'
        '<Sleep name="settle" msec="500"/></Sequence>',
        ['"first look": do detect tags with {goal}, planner "Smac"', '"hi": wave', '"settle": wait 0.5 s'],
    ),
    "a name before a condition": (
        '<Sequence><Fallback><IsGripperOk/><Wave/></Fallback><IsGripperOk name="ok?" door="2"/></Sequence>',
        ["check test is gripper ok or wave", '"ok?": check test is gripper ok with door 2'],
    ),
    "a name before a node of a team": (
        '<Recovery name="again" retries="3"><Wave/><Nod/></Recovery>',
        ['"again", do recovery with retries 3:', "  wave", "  nod"],
    ),
    "a name before a form": (
        '<RetryUntilSuccessful name="thrice" num_attempts="3"><Wave/></RetryUntilSuccessful>',
        ['"thrice": retry wave 3 times'],
    ),
    "a guard with a name": (
        '<ReactiveSequence name="still wanted"><Inverter><IsGoalNew/></Inverter><DetectTags goal="{goal}"/>'
        "</ReactiveSequence>",
        ['"still wanted": do detect tags with {goal} provided that not test is goal new'],
    ),
    "several guards": (
        "<ReactiveSequence><IsLidOpen/><Inverter><IsGoalNew/></Inverter><Wave/></ReactiveSequence>",
        ["provided that test is lid open, provided that not test is goal new, wave"],
    ),
    "several guards with a name, of something long": (
        f'<ReactiveSequence name="g"><IsLidOpen/><IsGoalNew/><Sequence><DetectTags {LONG}/><Wave/></Sequence>'
        "</ReactiveSequence>",
        [
            '"g", provided that test is lid open, provided that test is goal new:',
            '  do detect tags with shelf "shelf of the cell", tray "tray of the cell",',
            '      gripper "gripper of the cell", camera "camera of the cell", approach "approach of the cell"',
            "  wave",
        ],
    ),
    "guards in each other": (
        "<ReactiveSequence><IsLidOpen/><ReactiveSequence><IsGoalNew/><Wave/></ReactiveSequence></ReactiveSequence>",
        ["in order, checked at each tick:", "  check test is lid open", "  wave provided that test is goal new"],
    ),
    "trees of other files": (
        '<Sequence><SubTree ID="move_to_dock" speed="{v}"/><SubTree ID="Dock"/><move_arm/></Sequence>',
        ['do "move_to_dock" with speed {v}', 'do subtree "Dock"', "do move_arm"],
    ),
    "a guard of something long": (
        f"<ReactiveSequence><IsLidOpen/><Sequence><DetectTags {LONG}/><Wave/></Sequence></ReactiveSequence>",
        [
            "provided that test is lid open:",
            '  do detect tags with shelf "shelf of the cell", tray "tray of the cell",',
            '      gripper "gripper of the cell", camera "camera of the cell", approach "approach of the cell"',
            "  wave",
        ],
    ),
    "a long sequence in a fallback": (
        f"<Fallback><Sequence><Wave/><DetectTags {LONG}/></Sequence><Nod/><Wave/></Fallback>",
        [
            "try in order:",
            "  step by step:",
            "    wave",
            '    do detect tags with shelf "shelf of the cell", tray "tray of the cell",',
            '        gripper "gripper of the cell", camera "camera of the cell", approach "approach of the cell"',
            "  nod",
            "  wave",
        ],
    ),
    "a time limit of something long": (
        f'<Timeout msec="2500"><Sequence><Wave/><DetectTags {LONG}/></Sequence></Timeout>',
        [
            "within 2.5 s:",
            "  wave",
            '  do detect tags with shelf "shelf of the cell", tray "tray of the cell",',
            '      gripper "gripper of the cell", camera "camera of the cell", approach "approach of the cell"',
        ],
    ),
    "a decorator of a sequence": (
        "<ForceFailure><Sequence><Wave/><Nod/></Sequence></ForceFailure>",
        ["failing in any case:", "  wave", "  nod"],
    ),
    "a condition of other programs": (
        '<Wave name="hi" _onlyIf="x &gt; 1"/>',
        ['"hi": wave only if "x > 1"'],
    ),
    "a script that says what isn't": (
        "<Sequence><Wave _skipIf=\"mode != 'a b'\"/><Nod _skipIf='!done'/>"
        "<Wave _skipIf='a != 1 &amp;&amp; b'/></Sequence>",
        ["wave if \"mode == 'a b'\"", 'nod if "done"', 'wave unless "a != 1 && b"'],
    ),
    "a script before other ports": (
        "<Sequence><PushCart _while=\"mode == 'push'\" speed='0.2' safe_dist='0.5'/><Wave _skipIf='busy' volume='2'/>"
        '<OpenLid _failureIf="jammed" door="2"/><SubTree ID="Dock" _while="low" _autoremap="true" v="1"/></Sequence>',
        [
            "do push cart with speed 0.2, safe dist 0.5 while \"mode == 'push'\"",
            'wave with volume 2 unless "busy"',
            'do open lid with door 2 failing if "jammed"',
            'do subtree "Dock" with v 1 with all values while "low"',
        ],
    ),
    "scripts": (
        '<Sequence><Script code="x := a || b"/><IfThenElse><ScriptCondition name="far?" code="x || y"/><Wave/><Nod/>'
        '</IfThenElse><UnsetBlackboard key="{x}"/></Sequence>',
        [
            'do script "x := a || b"',
            'if test script condition "x || y" called "far?", wave otherwise nod',
            "do unset blackboard with key {x}",
        ],
    ),
    "decorators": (
        '<ForceSuccess _skipIf="mode != 5"><Precondition if="ready" else="SUCCESS"><RunOnce><DistanceController '
        'distance="1.5"><GoalUpdatedController name="new goal"><Wave/></GoalUpdatedController></DistanceController>'
        "</RunOnce></Precondition></ForceSuccess>",
        [
            'succeeding in any case if "mode == 5":',
            '  only if "ready", else succeeding:',
            "    only once:",
            "      once every 1.5 m:",
            '        "new goal", once for each new goal:',
            "          wave",
        ],
    ),
    "a goal that changes, and a rate by speed": (
        '<GoalUpdater input_goal="{goal}" output_goal="{latest}"><SpeedController min_rate="0.1" max_rate="1.0">'
        "<Wave/></SpeedController></GoalUpdater>",
        [
            "with {latest} as the latest {goal}:",
            "  more often the faster it drives with min rate 0.1, max rate 1.0:",
            "    wave",
        ],
    ),
    "a script before something long": (
        f'<Sequence><DetectTags name="look" _while="a &lt; 3" {LONG}/><Wave/></Sequence>',
        [
            '"look": while "a < 3", do detect tags with shelf "shelf of the cell", tray "tray of the cell",',
            '    gripper "gripper of the cell", camera "camera of the cell", approach "approach of the cell"',
            "wave",
        ],
    ),
    "ports that begin like commands": (
        '<DriveArc speed="2" stop_dist="0.5" wave="3" turn_rate="1" label="a"/>',
        ['do drive arc with speed 2, stop_dist 0.5 with wave 3, turn rate 1, label "a"'],
    ),
    "a form that goes on in another line": (
        '<ReactiveSequence name="stand at the entrance of the hall until the game begins" _while="state == 1"><Wave/>'
        "<Nod/></ReactiveSequence>",
        [
            '"stand at the entrance of the hall until the game begins",',
            '    in order, checked at each tick while "state == 1":',
            "  wave",
            "  nod",
        ],
    ),
    "thresholds of a parallel": (
        '<Parallel success_count="1" failure_count="2"><Wave/><Nod/></Parallel>',
        ["at the same time, until 1 succeeded or 2 failed:", "  wave", "  nod"],
    ),
    "a tree of another file, and an id with the words of a statement": (
        '<Sequence><SubTree ID="Move to Waypoint" goal="{goal}"/><AddPoseToVector input="{pose}"/></Sequence>',
        ['do "Move to Waypoint" with {goal}', "do add pose to vector with input {pose}"],
    ),
}


@pytest.mark.parametrize("parser", ["shunting-yard", "lark"])
@pytest.mark.parametrize(("tree", "lines"), CASES.values(), ids=CASES)
def test_what_a_team_reads(tree: str, lines: list[str], parser: str) -> None:
    xml = TREE.format(tree)
    text = str(parse_tree(xml).to("english"))
    said = [line for line in text.splitlines() if not line.startswith(("this mission is", "#"))]
    assert said == lines
    assert parse_tree(text, parser=parser).to("xml", onto=Source(xml)) == xml


def test_a_text_without_its_command_is_no_name() -> None:
    with pytest.raises(MissionError) as error:
        parse_tree('"Good morning", then wave')
    assert "BT019" in [problem.code for problem in error.value.diagnostics]


@pytest.mark.parametrize("text", ['"x": wave called "y"', '"x": check test is door open called "y"'])
def test_a_node_has_one_name(text: str) -> None:
    with pytest.raises(MissionError) as error:
        parse_tree(text)
    assert [problem.code for problem in error.value.diagnostics] == ["BT141"]


def test_trees_of_other_files_in_spanish(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """It has no word for a subtree."""
    path = tmp_path / "tree.xml"
    path.write_text(TREE.format('<SubTree ID="move_to_dock" speed="0.5"/>'), "utf-8")
    assert main(["compile", "--language", "es", "--to", "english", str(path)]) == 0
    assert capsys.readouterr().out.splitlines()[0] == 'haz "move_to_dock" con speed 0.5'
