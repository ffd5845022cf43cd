"""`--format json`: one document whatever happens, in which every place and fix can be used as it is."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from btlang.cli import main
from btlang.diagnostics.formats import format_json
from btlang.text.source import Source
from tests.diagnostics.samples import sample_diagnostics

ROOT = Path(__file__).parent.parent.parent
PLACE = {"file", "line", "column", "end_line", "end_column"}
KEYS = PLACE | {"code", "severity", "message", "hint", "words", "fix", "readings", "notes"}


def test_a_diagnostic_of_a_misspelt_name(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "--format", "json", "-c", "wave\ngo to the ktichen"]) == 2
    out, err = capsys.readouterr()
    assert err == ""
    place = {"file": "<command line>", "line": 2, "column": 11, "end_line": 2, "end_column": 18}
    assert json.loads(out) == [
        {
            "code": "BT013",
            "severity": "error",
            "message": "There's no place, person, object, door or zone called 'ktichen'.",
            "hint": "I understood 'go to ...'. Similar: kitchen, kitchen door",
            **place,
            "words": "ktichen",
            "fix": {"text": "kitchen", **place},
            "readings": [],
            "notes": [],
        }
    ]


def test_notes_have_places(capsys: pytest.CaptureFixture[str]) -> None:
    main(["check", "--format", "json", "-c", "turn left meanwhile move forward"])
    [problem] = json.loads(capsys.readouterr().out)
    [note] = problem["notes"]
    assert note.keys() == PLACE | {"message"}
    assert (note["message"], note["column"], note["end_column"]) == ("this needs the base too", 1, 10)


@pytest.mark.parametrize(
    ("arguments", "code", "codes"),
    [
        (["check", "-c", "wave"], 0, []),
        (["check", "-c", "wave is nod; wave"], 0, ["BT018"]),
        (["check", "-c", "wave nod; fly"], 2, ["BT021", "BT010"]),
        (["check", "no_such.txt"], 2, ["BT001"]),
        (["check", "-c", "wave", "--keywords", "no_such"], 2, ["BT063"]),
        (["check", "-c", "wave", "--world", "no_such.toml"], 2, ["BT070"]),
        (["tree", "-c", "wave"], 0, []),
        (["tree", "-c", "flarp"], 2, ["BT010"]),
        (["run", "-c", "wave", "--speed", "max"], 0, []),
        (["run", "-c", "flarp", "--quiet"], 2, ["BT010"]),
        (["run", "-c", "wave is fail; wave", "--speed", "max"], 1, ["BT018"]),
        (["run", "-c", "wave is nod; wave", "--log", "no/such/log"], 2, ["BT018", "BT009"]),
    ],
)
def test_one_document(arguments: list[str], code: int, codes: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    """`check` prints nothing else; for the others it is the last line of standard error."""
    assert main([*arguments, "--format", "json"]) == code
    out, err = capsys.readouterr()
    if arguments[0] == "check":
        assert err == ""
        assert out.count("\n") == 1
        document = json.loads(out)
    else:
        document = json.loads(err.splitlines()[-1])
        assert "BT0" not in "\n".join(err.splitlines()[:-1])
    assert [problem["code"] for problem in document] == codes
    assert main(arguments) == code


def test_every_sample_can_be_used() -> None:
    """Keys and types are those that are promised, and lines and columns lead back to the words."""
    problems = sample_diagnostics()
    document: list[dict[str, Any]] = json.loads(format_json(problems))
    assert len(document) == len(set(problems))
    sources = {problem.span.source.name: problem.span.source for problem in problems}
    for told in document:
        assert told.keys() == KEYS
        assert told["severity"] in ("error", "warning", "note")
        assert between(sources[told["file"]], told) == told["words"]
        if told["fix"] is not None:
            assert told["fix"].keys() == PLACE | {"text"}
        for part in (told, *told["notes"], *([told["fix"]] if told["fix"] else []), *told["readings"]):
            assert (1, 1) <= (part["line"], part["column"]) <= (part["end_line"], part["end_column"])


def between(source: Source, place: dict[str, Any]) -> str:
    """The text from a place to its end, counted by hand."""
    lines = source.text.split("\n")
    starts = [sum(len(line) + 1 for line in lines[:number]) for number in range(len(lines))]
    first, last = starts[place["line"] - 1], starts[place["end_line"] - 1]
    return source.text[first + place["column"] - 1 : last + place["end_column"] - 1]


def test_order_is_stable() -> None:
    problems = list(sample_diagnostics())
    assert format_json(problems) == format_json(reversed(problems))


def test_strange_characters_do_not_break_it(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "--format", "json", "-c", "wave \N{WAVING HAND SIGN} \udcff \x1b nod"]) == 2
    out = capsys.readouterr().out
    assert out.isascii()
    places = [(told["column"], told["words"]) for told in json.loads(out) if told["code"] == "BT003"]
    assert places[0] == (6, "\N{WAVING HAND SIGN}")


def test_every_key_is_documented() -> None:
    page = (ROOT / "docs" / "messages.md").read_text(encoding="utf-8")
    assert [key for key in sorted(KEYS | {"text"}) if f"`{key}`" not in page] == []
