"""Files made to break what reads them: each gets a message and no traceback, in time and memory that fit it."""

from __future__ import annotations

import io
import json
import sys
from pathlib import Path

import pytest

import btlang
from btlang.cli import main
from btlang.components.calls import pack
from btlang.maps.data_text import ForeignFileError, read_data
from btlang.recording.channels import messages
from btlang.run.events import RobotEvent, Sampled
from btlang.run.logs import JsonLog
from btlang.run.robot_state import Movements
from btlang.task.store.records import MissionText, Task
from btlang.task.store.task_store import open_store
from btlang.text.json_text import dump_json, is_deep, load_json
from btlang.text.source import Source
from tests.profiles import amount

WORLD = (Path(btlang.__file__).parent / "robots" / "worlds" / "default.toml").read_text(encoding="utf-8")
XML = '<root BTCPP_format="4"><BehaviorTree ID="M">{}</BehaviorTree></root>'
DIGITS = "9" * 100_000
LONG_PHRASE = " ".join(f"w{number}" for number in range(500))
UNIT = '[[type]]\nname = "glug"\nunits = [{{ words = ["glug"], factor = "{}" }}]\n'

KEYWORDS = {
    "articles that are words": 'articles = ["wave", "then"]\n',
    "nested": "x = " + "[" * 5000,
    "a phrase of 500 words": f'[[action]]\nphrase = "{LONG_PHRASE}"\nid = "Long"\n',
    "no number": UNIT.format("nan"),
    "infinite": UNIT.format("inf"),
    "nothing below": UNIT.format("1/0"),
    "a long number": f"x = {DIGITS}",
    "least": '[[type]]\nname = "glug"\nleast = nan\nunits = [{ words = ["glug"], factor = "1" }]\n',
}
WORLDS = {
    "far": WORLD.replace("x = 3.0, y = 1.5", "x = 1e300, y = 1.5"),
    "not a number": WORLD.replace("x = 3.0, y = 1.5", "x = nan, y = 1.5"),
    "endless": WORLD.replace("x = 3.0, y = 1.5", "x = inf, y = 1.5"),
    "many digits": WORLD.replace("x = 3.0, y = 1.5", f"x = {'9' * 400}, y = 1.5"),
    "nested": "x = " + "[" * 5000,
}
TEXTS = {
    "digits": f"move forward {DIGITS} m",
    "rounds": f"wave {DIGITS} times",
    "a far place": "the far is at (1" + "0" * 400 + ", 2); go to the far",
    "rounds in XML": XML.format(f'<Repeat num_cycles="{DIGITS}"><AlwaysSuccess/></Repeat>'),
    "a script": XML.format(f'<Sequence><Script code="a:={DIGITS}"/><Sleep msec="{DIGITS}"/></Sequence>'),
    "JSON nested": '{"format":1,"trees":' + '{"a":[' * 20_000,
    "JSON digits": f'{{"format": {DIGITS}, "trees": []}}',
    "NUL": json.dumps({"format": 1, "trees": [{"nodes": [{"id": "Say", "ports": {"text": "a\0b"}}]}]}),
    "a lone surrogate": json.dumps({"format": 1, "trees": [{"nodes": [{"id": "Say", "ports": {"text": "\ud800"}}]}]}),
    "JSON of escaped quotes": "{" + '"' + '\\"' * 500_000,
    "many ports": XML.format("<Wave " + " ".join(f'p{number}="1"' for number in range(3000)) + "/>"),
}


@pytest.mark.parametrize("text", KEYWORDS.values(), ids=KEYWORDS)
def test_keyword_files(text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "words.toml").write_text(text, encoding="utf-8")
    assert main(["check", "-c", "wave then nod", "--keywords", str(tmp_path / "words.toml")]) == 2
    assert "error BT06" in capsys.readouterr().err


@pytest.mark.parametrize("text", WORLDS.values(), ids=WORLDS)
def test_worlds(text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "world.toml").write_text(text, encoding="utf-8")
    assert main(["check", "-c", "wave", "--world", str(tmp_path / "world.toml")]) == 2
    assert "error BT070" in capsys.readouterr().err


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS)
def test_missions_and_trees(text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "mission.txt").write_text(text, encoding="utf-8")
    assert main(["check", str(tmp_path / "mission.txt")]) == 2
    said = capsys.readouterr().err
    assert "error BT" in said
    assert len(said) < 100_000


@pytest.mark.long
def test_a_line_full_of_mistakes_takes_no_time_of_its_square(capsys: pytest.CaptureFixture[str]) -> None:
    count = amount(4_000, 15_000)  # which took half a minute, when each looked for its sentence
    assert main(["check", "-c", "wave. " + "frob. " * count]) == 2  # where nothing is understood, only some are told
    assert capsys.readouterr().err.count("error BT010") == count


def test_a_world_too_large_to_plan_in(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "world.toml").write_text(WORLD.replace("x = 3.0, y = 1.5", "x = 1e5, y = 1.5"), encoding="utf-8")
    command = ["run", "--speed", "max", "--quiet", "--world", str(tmp_path / "world.toml")]
    assert main([*command, "-c", "move forward 0.5 m"]) == 0
    assert main([*command, "-c", "go to the lobby"]) == 1
    assert "too large to plan a way" in capsys.readouterr().err


@pytest.mark.parametrize("verb", [["check"], ["tree"], ["tree", "--plain"], ["compile", "--to", "xml"]])
def test_what_is_said_of_a_deep_tree_grows_with_it_and_not_with_its_square(
    verb: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def length(depth: int) -> int:
        nodes: list[dict[str, object]] = [{"id": "Inverter", "children": [at + 1]} for at in range(depth)]
        tree = {"format": 1, "trees": [{"nodes": [*nodes, {"id": "AlwaysSuccess"}]}]}
        (tmp_path / "deep.json").write_text(json.dumps(tree))
        assert main([verb[0], str(tmp_path / "deep.json"), *verb[1:]]) == 0
        return len(capsys.readouterr().out)

    assert length(10_000) < 6 * length(2_000)


def test_deep_values_are_not_written_where_a_deep_tree_has_raised_the_limit_of_recursion(tmp_path: Path) -> None:
    """Python's writer of JSON recurses in C, and would crash."""
    deep: list[object] = []
    for _ in range(200_000):
        deep = [deep]
    twice: list[object] = []
    for _ in range(60):  # a text of 2 to the power of 60 brackets
        twice = [twice, twice]
    inside: list[object] = []
    inside.append(inside)
    log = io.StringIO()
    before = sys.getrecursionlimit()
    sys.setrecursionlimit(1_000_000)
    try:
        event = RobotEvent(0.0, "r", 0, 0.0, "odd", {"deep": deep, "inside": inside, "flat": [1, {"a": (2,)}]})
        JsonLog(log, str)(event)
        [(_, written)] = messages(Sampled(0.0, "r", 0, 0.0, {"deep": deep, "n": [1]}), 0, str, Movements())
        for value in (deep, {"a": {"b": deep}}, inside):
            with pytest.raises(ValueError, match="nested too deep"):
                dump_json(value)
            with pytest.raises(TypeError, match="nested too deeply"):
                pack(value)
        with (
            open_store(str(tmp_path / "tasks.db")) as store,
            pytest.raises(btlang.MissionError, match="nested so deep"),
        ):
            store.add(Task(0, MissionText("wave", values={"x": deep}), "ann", 0.0))
        with btlang.Session() as session:
            run = session.prepare(btlang.parse_tree("wave"), values={"x": deep})
            with pytest.raises(btlang.MissionError, match="nested too deep"):
                run.save()
    finally:
        sys.setrecursionlimit(before)
    assert json.loads(log.getvalue())["data"] == {
        "deep": "(nested too deep)", "inside": "(nested too deep)", "flat": [1, {"a": [2]}],
    }  # fmt: skip
    assert isinstance(written, dict)
    assert written["values"] == {"deep": "(nested too deep)", "n": [1]}
    assert not is_deep(twice)
    for brackets in (100, 101):
        text = "[" * brackets + "]" * brackets
        assert is_deep(json.loads(text)) == (brackets > 100)


def test_nested_json_where_a_deep_tree_has_raised_the_limit_of_recursion() -> None:
    """Python's reader of JSON recurses in C, and would crash."""
    before = sys.getrecursionlimit()
    sys.setrecursionlimit(1_000_000)
    try:
        with pytest.raises(btlang.MissionError, match="nested too deep"):
            btlang.parse_tree('{"format":1,"trees":' + '{"a":[' * 200_000)
        with pytest.raises(ForeignFileError, match="nested too deep"):
            read_data(Source("[" * 200_000, "points.json"))
        for text in ("[" * 200_000, b'{"a":' * 200_000):
            with pytest.raises(ValueError, match="nested too deep"):
                load_json(text)
    finally:
        sys.setrecursionlimit(before)
