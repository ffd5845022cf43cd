"""Words made of the models and trees of a team: they are read as their nodes, and say trees that stay the same."""

from __future__ import annotations

import re
from functools import partial
from pathlib import Path

import pytest

from btlang.api import parse_file, parse_tree
from btlang.backends.keyword_pack import KeywordPack, keyword_pack, leaves_of, pack_of_files
from btlang.backends.keywords import is_unknown
from btlang.backends.wording import SpokenPorts, phrases
from btlang.cli import main
from btlang.diagnostics.files import read_source
from btlang.frontends.btcpp.files import read_files
from btlang.frontends.btcpp.models import nav2_models
from btlang.printer.phrase import leaf_words
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.text.source import Source
from btlang.tree.dump import plain
from btlang.tree.node import NodeModel
from btlang.vocabulary.load import vocabulary_with
from tests.conftest import matches_golden
from tests.profiles import only_long

CORPUS = Path(__file__).parents[1] / "corpus"
PACKS = Path(__file__).parent / "packs"
TEAM = ("groot1_shelf_picker", "groot2_greenhouse", "nav2_navigate_with_recovery")
FILES = [*(CORPUS / "team" / f"{name}.xml" for name in TEAM), CORPUS / "good" / "nav2_to_pose_with_recovery.xml"]


def pack_of(*sources: Source) -> KeywordPack:
    """As `btc words --from` makes it."""
    return pack_of_files(sources, world_vocabulary(), vocabulary_with)[0]


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_words_of_a_file_say_its_tree(path: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pack = tmp_path / "words.toml"
    assert main(["words", "--from", str(path), "-o", str(pack)]) == 0
    assert capsys.readouterr() == ("", "")
    matches_golden(pack.read_text(encoding="utf-8"), PACKS / f"{path.stem}.toml")
    mission = parse_file(str(path), keywords=[str(pack)])
    text = str(mission.to("english"))
    for parser in ("shunting-yard", "lark"):
        assert plain(parse_tree(text, parser=parser, keywords=[str(pack)]).tree) == plain(mission.tree)


def said(*models: str) -> list[str]:
    """The phrases of a pack for these models, and the ids without any."""
    text = f'<root BTCPP_format="4"><TreeNodesModel>{"".join(models)}</TreeNodesModel></root>'
    pack = pack_of(Source(text))
    lines = [line for line in pack.text.splitlines() if line.startswith("phrase = ")]
    return [line.removeprefix('phrase = "').removesuffix('"') for line in lines] + [
        dict(warning.arguments)["id"] for warning in pack.warnings
    ]


def test_included_files_count_where_they_are_there(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(
        '<root BTCPP_format="4"><TreeNodesModel><Action ID="Grab"/></TreeNodesModel></root>', encoding="utf-8"
    )
    text = (
        '<root BTCPP_format="4"><include path="arm.xml"/><include ros_pkg="elsewhere" path="gone.xml"/>'
        '<BehaviorTree ID="A"><Sequence><Grab/><Drop/></Sequence></BehaviorTree></root>'
    )
    path = tmp_path / "main.xml"
    path.write_text(text, encoding="utf-8")
    assert [line for line in pack_of(read_source(str(path))).text.splitlines() if line.startswith("id")] == [
        'id = "Grab"', 'id = "Drop"'
    ]  # fmt: skip


def test_conditions_say_what_is_so() -> None:
    ids = ("IsDoorOpen", "IsObjectInGripper", "HasPayload", "CanReach", "PosesNear", "WouldAPlanHelp", "CheckLid")
    assert said(*(f'<Condition ID="{id}"/>' for id in ids)) == [
        "door is open", "object is in gripper", "robot has payload", "robot can reach", "poses are near",
        "a plan would help", "check lid succeeds",
    ]  # fmt: skip


def test_kinds_follow_from_tags_and_from_nav2() -> None:
    tree = '<Sequence><Condition ID="Quiet"/><IsStuck/><Spin spin_dist="{d}" error_code_id="{e}"/></Sequence>'
    pack = pack_of(Source(f'<root BTCPP_format="4"><BehaviorTree ID="A">{tree}</BehaviorTree></root>')).text
    entries = re.findall(r'\[\[(\w+)\]\]\nphrase = ".*"\nid = "(\w+)"', pack)
    assert entries == [("condition", "Quiet"), ("condition", "IsStuck"), ("action", "Spin")]
    assert 'outputs = ["error_code_id"]' in pack


def test_what_a_phrase_writes_is_no_value_that_the_mission_needs(tmp_path: Path) -> None:
    ports = '<input_port name="goal"/><output_port name="reason"/>'
    models = f'<Action ID="Drive">{ports}</Action><Action ID="Report"><input_port name="words"/></Action>'
    tree = '<Sequence><Drive goal="{goal}" reason="{why}"/><Report words="{why}"/></Sequence>'
    main_tree = f'<BehaviorTree ID="MainTree">{tree}</BehaviorTree>'
    file, words = tmp_path / "drive.xml", tmp_path / "words.toml"
    file.write_text(f'<root BTCPP_format="4">{main_tree}<TreeNodesModel>{models}</TreeNodesModel></root>')
    assert main(["words", "--from", str(file), "-o", str(words)]) == 0
    mission = parse_file(str(file), keywords=[str(words)])
    text = str(mission.to("english"))
    assert "this mission is given {goal}\n" in text
    for said in (text, text.replace('"{why}"', "{why}")):
        assert plain(parse_tree(said, keywords=[str(words)]).tree) == plain(mission.tree)


def test_a_phrase_that_is_too_long_for_a_line_is_said_by_its_ports(tmp_path: Path) -> None:
    names = [f"{word}_of_the_gripper" for word in ("pose", "speed", "force", "width", "height", "depth", "weight")]
    ports = "".join(f'<input_port name="{name}"/>' for name in names)
    values = " ".join(f'{name}="as before"' for name in names)
    file, words = tmp_path / "grip.xml", tmp_path / "words.toml"
    tree = f'<BehaviorTree ID="MainTree"><Grip {values}/></BehaviorTree>'
    model = f'<TreeNodesModel><Action ID="Grip">{ports}</Action></TreeNodesModel>'
    file.write_text(f'<root BTCPP_format="4">{tree}{model}</root>')
    assert main(["words", "--from", str(file), "-o", str(words)]) == 0
    mission = parse_file(str(file), keywords=[str(words)])
    lines = str(mission.to("english")).splitlines()
    assert max(map(len, lines)) < 120
    assert plain(parse_tree("\n".join(lines), keywords=[str(words)]).tree) == plain(mission.tree)


def test_phrases_that_mean_something_else_get_another_form() -> None:
    """Those of words that ship, of the language, and of the pack itself."""
    ids = ("OpenGripper", "If", "DoNothing", "Pour", "pour", "POUR", "Pour_")
    assert said(*(f'<Action ID="{id}"/>' for id in ids)) == [
        "run open gripper", "run if", "run do nothing", "pour", "run pour", "run node pour", "Pour_",
    ]  # fmt: skip
    assert said('<Condition ID="IsBatteryLow"/>', '<Action ID="GoTo"/>', '<Control ID="Both"/>') == [
        "is battery low succeeds"
    ]


def test_types_of_slots_follow_from_the_model() -> None:
    ports = (
        ("x", "double", ""), ("n", "int", ""), ("fast", "bool", ""), ("grasp", "", "top|side"), ("a-b", "", ""),
        ("place", "std::string", "it's where"),
    )  # fmt: skip
    told = "".join(f'<input_port name="{name}" type="{kind}">{text}</input_port>' for name, kind, text in ports)
    more = '<output_port name="found"/><input_port name="speed" type="float" default="1"/>'
    about = "<description>Finds it.\nx</description>"
    model = f'<Action ID="FindIt">{told}{more}{about}</Action>'
    pack = pack_of(Source(f'<root BTCPP_format="4"><TreeNodesModel>{model}</TreeNodesModel></root>'))
    entry = vocabulary_with(Source(pack.text)).entries["FindIt"][0]
    assert {slot.name: slot.type for slot in entry.slots} == {
        "x": "number", "n": "whole_number", "fast": "boolean", "grasp": "grasp", "place": "text", "found": "text",
        "speed": "number",
    }  # fmt: skip
    assert entry.outputs == ("found",)
    assert entry.help == "Finds it. x; grasp: top|side; place: it's where"
    assert entry.phrases[0].endswith("place {place} [at speed {speed}] [giving {found}]")
    assert '# Ports that aren\'t in the phrase: "a-b"' in pack.text


def test_all_nodes_of_nav2_can_be_said() -> None:
    ids = ("BackUp", "Wait", "ComputeRoute", "DockRobot", "IsStuck", "GoalUpdated", "TruncatePathLocal")
    vocabulary = world_vocabulary()
    leaves = leaves_of(nav2_models(ids).values(), (), vocabulary)
    pack = keyword_pack(leaves, vocabulary, partial(vocabulary_with, keywords=()))
    assert not pack.warnings
    assert vocabulary_with(Source(pack.text)).entries.keys() >= set(ids)


def test_a_subject_takes_its_value() -> None:
    found = phrases("IsPathValid", SpokenPorts(("path", "cost")), (), is_condition=True)
    assert next(found) == "path {path} is valid cost {cost}"


@pytest.mark.parametrize(
    ("node_id", "ports", "phrase"),
    [
        ("Navigate", SpokenPorts(("goal",), texts=frozenset({"goal"})), "navigate to {goal}"),
        ("GoTo", SpokenPorts(("goal",), texts=frozenset({"goal"})), "go to {goal}"),
        ("PathToPose", SpokenPorts(("goal",), texts=frozenset({"goal"})), "path to pose {goal}"),
        ("PathToPose", SpokenPorts(("goal", "start")), "path to pose goal {goal} from {start}"),
        ("PublishTwist", SpokenPorts(("v_x",), ("topic",)), "publish twist v x {v_x} [on {topic}]"),
        ("Fly", SpokenPorts(("goal", "target"), ("speed",)), "fly to {goal} target {target} [at speed {speed}]"),
    ],
)
def test_ports_are_said_by_their_part_in_what_is_done(node_id: str, ports: SpokenPorts, phrase: str) -> None:
    assert next(phrases(node_id, ports, (), is_condition=False)) == phrase


def test_a_comment_silences_the_warning(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "nodes.xml"
    text = '<root BTCPP_format="4">{}<TreeNodesModel><Action ID="a;b"/></TreeNodesModel></root>'
    for comment, told in (("", "nodes.xml:1:40: warning BT240"), ("<!-- allow: node without words -->", "")):
        file.write_text(text.format(comment))
        assert main(["words", "--from", str(file)]) == 0
        assert (told in capsys.readouterr().err) if told else not capsys.readouterr().err


def test_the_pack_of_the_docs_is_what_is_made() -> None:
    page = (Path(__file__).parents[2] / "docs" / "team_trees.md").read_text(encoding="utf-8")
    model, pack = (re.search(rf"```\w+ robot_nodes\.{kind}\n(.*?)```", page, re.DOTALL) for kind in ("xml", "toml"))
    assert model is not None
    assert pack is not None
    assert pack_of(Source(model[1])).text == pack[1]


def test_files_that_are_no_models_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "mission.txt"
    file.write_text("wave\n")
    assert main(["words", "--from", str(file)]) == 2
    assert "error BT120" in capsys.readouterr().err
    assert main(["words", "--from", str(tmp_path / "no.xml")]) == 2
    assert "error BT001" in capsys.readouterr().err
    for words in (["--from", str(file), "--all"], ["-o", str(file)]):
        with pytest.raises(SystemExit):
            main(["words", *words])


def test_hostile_models_make_a_file_that_loads() -> None:
    text = "]]\n[[action]]\nphrase = 'x'\ncall = 'os:system'\n\"\"\" \u2028 \x7f \\"
    names = ('a"b', "x\n[y]", "'", "{z}", "[", "/", "(", "é" * 300, "A" * 300, "A1" * 80)
    models = [NodeModel(kind, name, text=text) for name in names for kind in ("Action", "Condition")]
    vocabulary = world_vocabulary()
    pack = keyword_pack(leaves_of(models, (), vocabulary), vocabulary, vocabulary_with)
    made = vocabulary_with(Source(pack.text))
    assert not any(entry.call for id in names for entry in made.entries.get(id, ()))


@only_long
def test_most_leaves_have_a_phrase_that_says_all_of_their_ports() -> None:
    """Where any name in braces is a value, at most 30 % are left that only their ids say."""
    by_phrase = total = 0
    for path in sorted((CORPUS / "team").glob("*.xml")):
        read = read_files([read_source(str(path))])
        known = world_vocabulary()
        pack = keyword_pack(leaves_of(read.models.values(), read.nodes(), known), known, vocabulary_with)
        words = vocabulary_with(Source(pack.text)).with_references()
        leaves = [node for node in read.nodes() if not node.children and is_unknown(node.id, known)]
        said = [leaf_words(node.id, dict(node.ports), words, exactly=True) for node in leaves]
        by_phrase, total = by_phrase + sum(map(bool, said)), total + len(leaves)
    assert total > 100
    assert by_phrase >= 0.7 * total


@only_long
def test_few_leaves_are_said_by_ids_in_quotes() -> None:
    """In what is printed, with words made from names and with ids in words alone; and no line is long."""
    quoted = {"words": 0, "ids": 0}
    total = longest = 0
    for path in sorted((CORPUS / "team").glob("*.xml")):
        for way, keywords in (("words", [str(path)]), ("ids", [])):
            mission = parse_file(str(path), keywords=keywords)
            lines = [line for line in str(mission.to("english")).splitlines() if line[:2] != "#:"]
            leaves = [node.id for node in mission.tree.walk() if not node.children]
            unknown = [node_id for node_id in leaves if is_unknown(node_id, world_vocabulary())]
            said = re.findall(r'\b(?:do|test) (?:node )?"([^"]*)"', "\n".join(lines))
            quoted[way] += sum(node_id in unknown for node_id in said)
            total += len(unknown) if way == "words" else 0
            longest = max(longest, *map(len, lines))
    assert total > 100
    assert quoted["words"] <= 0.3 * total
    assert quoted["ids"] <= 0.3 * total
    assert longest <= 200
