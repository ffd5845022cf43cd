"""`btc check` for trees in XML: a project without a mistake, and one with one mistake of each kind."""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from btlang.cli import main
from btlang.diagnostics.codes import CODES
from tests.conftest import matches_golden, without_pointer
from tests.projects.trees import problems

ROOT = Path(__file__).parent.parent.parent
PROJECT = ROOT / "tests" / "corpus" / "project"
TEAM = ROOT / "tests" / "corpus" / "team"
OF_PROJECTS = {code for code in CODES if code.startswith("BT23")}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of the samples, which is the current folder."""
    shutil.copytree(PROJECT, tmp_path / "project")
    monkeypatch.chdir(tmp_path / "project")
    return tmp_path / "project"


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize("files", ["sound", "sound/doors.xml sound/nodes.xml sound/deliver.xml",
                                   "sound/deliver.xml sound sound/doors.xml",
                                   "--models sound/nodes.xml sound/doors.xml sound/deliver.xml"])  # fmt: skip
def test_a_sound_project(files: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", *files.split()]) == 0
    assert capsys.readouterr() == ("No problems found.\n", "")


@pytest.mark.usefixtures("folder")
def test_every_mistake_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "mistakes"]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    said = without_pointer(printed.err)
    matches_golden(said, PROJECT / "mistakes.out")
    assert set(re.findall(r"BT\d+", said)) >= (OF_PROJECTS - {"BT230"}) | {"BT052", "BT053", "BT120", "BT126", "BT127"}


@pytest.mark.usefixtures("folder")
def test_alone_a_file_lacks_the_models_and_trees_of_others(capsys: pytest.CaptureFixture[str]) -> None:
    codes = [problem["code"] for problem in problems(capsys, "sound/deliver.xml")]
    assert sorted(codes) == ["BT126", "BT126", "BT231", "BT231", "BT231"]


@pytest.mark.parametrize("path", sorted(TEAM.glob("[ghn]*.xml")), ids=lambda path: path.stem)
def test_leaves_from_elsewhere_are_no_errors(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found = problems(capsys, str(path))
    assert {problem["code"] for problem in found} <= {"BT231"}
    told = [problem["message"].split("'")[1] for problem in found]
    assert len(told) == len(set(told))
    assert main(["check", str(path)]) == 0


def test_what_runs_here_is_checked_as_before(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "tree.xml"
    path.write_text('<root BTCPP_format="4"><BehaviorTree ID="A"><GoTo to="kitchen"/></BehaviorTree></root>', "utf-8")
    assert [problem["code"] for problem in problems(capsys, str(path))] == ["BT132"]
    path.write_text('<root BTCPP_format="4"><BehaviorTree ID="A"><GoTo place="labb"/></BehaviorTree></root>', "utf-8")
    assert [problem["code"] for problem in problems(capsys, str(path))] == ["BT132"]
    path.write_text('<root BTCPP_format="4"><BehaviorTree ID="A"><Fly/></BehaviorTree></root>', "utf-8")
    assert [problem["code"] for problem in problems(capsys, str(path))] == ["BT231"]
    assert [problem["code"] for problem in problems(capsys, "--robot", "simulated", str(path))] == ["BT130", "BT231"]


def test_main_trees_of_several_programs_may_have_one_id(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("one", "two"):
        text = '<root BTCPP_format="4"><BehaviorTree ID="MainTree"><Wave/></BehaviorTree></root>'
        (tmp_path / f"{name}.xml").write_text(text, "utf-8")
    assert main(["check", str(tmp_path)]) == 0
    assert capsys.readouterr().err == ""


def test_trees_that_there_are_are_listed_by_id(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = '<root BTCPP_format="4"{}><BehaviorTree ID="{}"><AlwaysSuccess/></BehaviorTree></root>'
    for at, (main_tree, tree) in enumerate(
        (("", "MainTree"), ("", "MainTree"), (' main_tree_to_execute="X"', "Patrol"))
    ):
        (tmp_path / f"{at}.xml").write_text(text.format(main_tree, tree))
    [problem] = [found for found in problems(capsys, str(tmp_path)) if found["code"] == "BT126"]
    assert problem["hint"] == "There are: Patrol, MainTree, MainTree (2)"


def test_trees_in_each_other_do_not_hide_what_else_is_wrong(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    tree = '<BehaviorTree ID="{}"><Sequence><SubTree ID="{}"/><{}/></Sequence></BehaviorTree>'
    text = f'<root BTCPP_format="4">{tree}</root>'
    Path("a.xml").write_text(text.format("A", "B", 'Foo a="1"'), "utf-8")
    Path("b.xml").write_text(text.format("B", "A", "Sleep"), "utf-8")
    found = {(problem["code"], problem["file"]) for problem in problems(capsys, "a.xml", "b.xml")}
    assert {("BT124", "a.xml"), ("BT231", "a.xml")} <= found


def test_equal_warnings_of_several_files_name_their_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    model = '<TreeNodesModel><Action ID="Foo"><input_port name="y"/></Action></TreeNodesModel>'
    for name in "abc":
        text = f'<root BTCPP_format="4">\n<BehaviorTree ID="{name}"><Foo/></BehaviorTree>{model}</root>'
        Path(f"{name}.xml").write_text(text, "utf-8")
    given = '<root BTCPP_format="4"><BehaviorTree ID="D"><Sequence>{}</Sequence></BehaviorTree></root>'
    Path("d.xml").write_text(given.format('<Foo y="1"/>' * 4), "utf-8")  # so that the port isn't optional
    assert main(["check", "."]) == 0
    assert "And 2 more: b.xml:2, c.xml:2\n" in capsys.readouterr().err


def test_a_tree_names_what_it_is_given(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    use = '<SubTree ID="Talk" what="hello" volume="3" out="{x}" deep="1" a-b="2" node="{node}" server_timeout="{t}"/>'
    script = "<Script code=\"out := 'said'\"/>"
    inner = '<SubTree ID="Deep" _autoremap="true"/>'
    trees = {
        "Main": use,
        "Talk": f'<Sequence><Say text="{{what}}"/>{script}{inner}</Sequence>',
        "Deep": '<Say text="{deep}"/>',
    }
    text = "".join(f'<BehaviorTree ID="{name}">{tree}</BehaviorTree>' for name, tree in trees.items())
    (tmp_path / "talk.xml").write_text(f'<root BTCPP_format="4" main_tree_to_execute="Main">{text}</root>')
    found = [problem["message"] for problem in problems(capsys, str(tmp_path)) if problem["code"] == "BT235"]
    assert found == ["Nothing reads 'volume', which the port volume of Talk sets."]


def test_values_that_scripts_set(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    nodes = (
        "<Script code=\"a := 1; b := c := a; d = 'a'; total += 1; e == 1 &amp;&amp; true; @g := 1\"/>"
        '<SetBlackboard value="1" output_key="f"/><SetBlackboard value="{f}" output_key="{h}"/>'
        '<SetBlackboard value="1" output_key="said"/><Say text="{said}" _onSuccess="i := @k; i != 1 ?"/>'
        '<SetBlackboard value="1" output_key="k"/><AlwaysSuccess _onSuccess="last := i"/>'
    )
    tree = f'<BehaviorTree ID="Main"><Sequence>{nodes}</Sequence></BehaviorTree>'
    (tmp_path / "scripts.xml").write_text(f'<root BTCPP_format="4">{tree}</root>')
    found = [problem["message"] for problem in problems(capsys, str(tmp_path)) if problem["code"] == "BT235"]
    by_key = {
        **dict.fromkeys("bcd", "code of Script"),
        "h": "output_key of SetBlackboard",
        "last": "_onSuccess of AlwaysSuccess",
    }
    assert found == [f"Nothing reads '{key}', which the port {port} sets." for key, port in by_key.items()]


def test_missions_beside_trees(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "good.txt").write_text("wave\n", "utf-8")
    (folder / "bad.txt").write_text("flarp\n", "utf-8")
    assert main(["check", "good.txt", "sound"]) == 0
    capsys.readouterr()
    assert [problem["code"] for problem in problems(capsys, "bad.txt", "sound", "good.txt", "none.txt")] == [
        "BT010",
        "BT001",
    ]


def test_a_folder_without_trees_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "package.xml").write_text("<package/>", "utf-8")
    assert main(["check", str(tmp_path)]) == 2
    assert "there are no trees in XML" in capsys.readouterr().err


def test_comments_allow_warnings(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = folder / "mistakes" / "deliver.xml"
    text = path.read_text("utf-8").replace("<!-- wrong values -->", "<!-- allow: unknown node, missing port -->")
    path.write_text(text, "utf-8")
    codes = {problem["code"] for problem in problems(capsys, "mistakes")}
    assert "BT235" in codes
    assert not codes & {"BT231", "BT234"}


def test_certain_corrections_change_nothing_else(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = folder / "mistakes" / "deliver.xml"
    before = {each: each.read_bytes() for each in (folder / "mistakes").iterdir()}
    crlf = b"\xef\xbb\xbf" + before[path].replace(b"\n", b"\r\n")
    path.write_bytes(crlf)
    assert main(["check", "--fix", "mistakes"]) == 2
    assert "Corrected mistakes/deliver.xml: 2 changes." in capsys.readouterr().out
    wanted = crlf.replace(b"coridor=", b"corridor=").replace(b"<DoorIsOpne ", b"<DoorIsOpen ")
    assert {each: each.read_bytes() for each in before} == before | {path: wanted}


def test_missing_blanks_are_put_in(tmp_path: Path) -> None:
    path = tmp_path / "tree.xml"
    text = '<root BTCPP_format="4"main_tree_to_execute="A"><BehaviorTree ID="A"><Say text="ä"name="x"/>'
    text += "</BehaviorTree></root>"
    path.write_text(text, "utf-8")
    assert main(["check", "--fix", str(path)]) == 0
    assert path.read_text("utf-8") == text.replace('"main', '" main').replace('"name', '" name')


def test_names_of_version_3_stay(tmp_path: Path) -> None:
    path = tmp_path / "tree.xml"
    loop = '<RetryUntilSuccesful num_attempts="2"><Wave/></RetryUntilSuccesful>'
    text = f'<root><BehaviorTree ID="A">{loop}</BehaviorTree></root>'
    path.write_text(text, "utf-8")
    assert main(["check", "--fix", str(path)]) == 0
    assert path.read_text("utf-8") == text


def test_a_refused_id_is_told_once_and_no_error(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Each file has its own warning of other kinds."""
    tree = '<root BTCPP_format="4">stray<BehaviorTree ID="{}"><Sequence><Wave/>{}</Sequence></BehaviorTree></root>'
    (tmp_path / "main.xml").write_text(tree.format("Main", '<SubTree ID="Go Home"/>'), "utf-8")
    (tmp_path / "part.xml").write_text(tree.format("Go Home", "<Nod/>"), "utf-8")
    assert [problem["code"] for problem in problems(capsys, str(tmp_path))] == ["BT230", "BT238", "BT230"]
    assert main(["check", str(tmp_path)]) == 0
    assert capsys.readouterr().out == "No errors found.\n"


def sarif(required: str, **properties: Any) -> dict[str, Any]:
    """An object of SARIF 2.1.0 with these properties and no others."""
    return {"type": "object", "properties": properties, "required": required.split(), "additionalProperties": False}


TEXT = {"type": "string", "minLength": 1}
LEVEL = {"enum": ["none", "note", "warning", "error"]}
PLACE = {"type": "integer", "minimum": 1}
MESSAGE = sarif("text", text=TEXT)
ARTIFACT = sarif("uri", uri={"type": "string", "pattern": r"^(file:///)?([A-Za-z0-9_.~/-]|%[0-9A-F]{2})+$"})
REGION = sarif("startLine", startLine=PLACE, startColumn=PLACE, endLine=PLACE, endColumn=PLACE)
PHYSICAL = sarif("artifactLocation", artifactLocation=ARTIFACT, region=REGION)
LOCATION = sarif("", id={"type": "integer", "minimum": -1}, physicalLocation=PHYSICAL, message=MESSAGE)
REPLACEMENT = sarif("deletedRegion", deletedRegion=REGION, insertedContent=sarif("text", text={"type": "string"}))
SOME = {"type": "array", "minItems": 1, "uniqueItems": True}
CHANGE = sarif("artifactLocation replacements", artifactLocation=ARTIFACT, replacements={**SOME, "items": REPLACEMENT})
FIX = sarif("artifactChanges", description=MESSAGE, artifactChanges={**SOME, "items": CHANGE})
RULE = sarif("id", id=TEXT, shortDescription=MESSAGE, defaultConfiguration=sarif("", level=LEVEL))
RESULT = sarif(
    "message", ruleId=TEXT, ruleIndex={"type": "integer", "minimum": -1}, level=LEVEL, message=MESSAGE,
    locations={"type": "array", "items": LOCATION}, relatedLocations={**SOME, "items": LOCATION},
    fixes={**SOME, "items": FIX},
)  # fmt: skip
RUN = sarif(
    "tool", columnKind={"enum": ["utf16CodeUnits", "unicodeCodePoints"]},
    tool=sarif("driver", driver=sarif("name", name=TEXT, rules={"type": "array", "uniqueItems": True, "items": RULE})),
    results={"type": "array", "items": RESULT},
)  # fmt: skip
SARIF = sarif("version runs", version={"const": "2.1.0"}, runs={"type": "array", "items": RUN})
"""The part of the schema of SARIF 2.1.0 that btc uses."""


def test_sarif_has_the_form_of_its_schema_whatever_files_are_called(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = (folder / "mistakes" / "deliver.xml").read_bytes()
    for name in (b"a b#1%20&.xml", b"x:y.xml", b"new\nline.xml", "tür.xml".encode(), b"\xff\xfe.xml"):
        try:
            (folder / os.fsdecode(name)).write_bytes(text)
        except OSError:  # a file system may refuse a name
            continue
    for files in (["mistakes"], ["."], [str(folder)], ["-c", "go to the ktichen"], ["nowhere.xml"]):
        assert main(["check", *files, "--format", "sarif"]) == 2
        document = json.loads(capsys.readouterr().out)
        Draft202012Validator(SARIF).validate(document)
        assert document["runs"][0]["results"]


@pytest.mark.usefixtures("folder")
def test_sarif(capsys: pytest.CaptureFixture[str]) -> None:
    told = problems(capsys, "mistakes")
    assert main(["check", "mistakes", "--format", "sarif"]) == 2
    printed = capsys.readouterr()
    assert printed.err == ""
    document = json.loads(printed.out)
    assert document["version"] == "2.1.0"
    [run] = document["runs"]
    rules = [rule["id"] for rule in run["tool"]["driver"]["rules"]]
    assert len(rules) == len(set(rules))
    assert len(run["results"]) == len(told)
    for result, problem in zip(run["results"], told, strict=True):
        [location] = result["locations"]
        place = location["physicalLocation"]
        assert rules[result["ruleIndex"]] == result["ruleId"] == problem["code"]
        assert result["level"] == problem["severity"]
        assert place["artifactLocation"]["uri"] == problem["file"]
        assert place["region"]["startLine"] == problem["line"]
        assert ("fixes" in result) == (problem["fix"] is not None)
    assert main(["check", "sound", "--format", "sarif"]) == 0
    assert json.loads(capsys.readouterr().out)["runs"][0]["results"] == []


def test_github(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "100%, odd:name.txt").write_text("go to 50%\nflarp\n", "utf-8")
    assert main(["check", "100%, odd:name.txt", "mistakes", "--format", "github"]) == 2
    printed = capsys.readouterr()
    assert printed.err == ""
    lines = printed.out.splitlines()
    assert all(re.fullmatch(r"::(error|warning) file=[^,:]+(,\w+=[^,:]+)*,title=BT\d+::.+", line) for line in lines)
    assert any(line.startswith("::error file=100%25%2C odd%3Aname.txt,line=2,endLine=2,col=1,") for line in lines)
    assert any("wheels' isn't a port of DriveAlong.%0AIt has corridor" in line for line in lines)
    assert main(["check", "sound", "--format", "github"]) == 0
    assert capsys.readouterr() == ("", "")


def test_the_hook_as_pre_commit_runs_it(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """It appends the names of changed files, some of them after the folder that is given as an argument."""
    yaml = pytest.importorskip("yaml", reason="PyYAML is not installed")
    [hook] = yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text("utf-8"))
    assert (hook["id"], hook["language"]) == ("btc-check", "python")
    names = ["sound/doors.xml", "mission.txt", "package.xml", "CMakeLists.txt", "docs/notes.md"]
    chosen = [name for name in names if re.search(hook["files"], name) and not re.search(hook["exclude"], name)]
    assert chosen == ["sound/doors.xml", "mission.txt"]
    (folder / "mission.txt").write_text("wave\n", "utf-8")
    [btc, *words] = shlex.split(hook["entry"])
    assert btc == "btc"
    assert main([*words, "sound", *chosen]) == 0
    capsys.readouterr()
    assert main([*words, "sound", "mistakes/deliver.xml"]) == 2
