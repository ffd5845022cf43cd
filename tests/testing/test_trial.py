"""Tests of a mission that somebody writes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from btlang.api import Mission, parse_tree
from btlang.testing.trial import results_of
from btlang.text.source import Source

TEXT = "go to the lab\nwave"
TESTS = """\
test "it waves":
  run "tour"
  finally the mission succeeds and it has done "wave"

# A lab that nobody can reach.
test "it says hello":
  run "tour.txt"
  "go to the lab" fails once
  within 5 s it has said hello
"""


def results(tests: str, text: str = TEXT, **options: Any) -> dict[str, Any]:
    mission = parse_tree(Source(text, "mission", roots=()))

    def given(name: str, world: str | None) -> Mission | None:
        return mission if name in ("tour", "tour.txt") else None

    found: dict[str, Any] = json.loads(json.dumps(results_of(Source(tests, "tests", roots=()), given, **options)))
    return found


def test_what_passes_and_what_fails() -> None:
    found = results(TESTS)
    assert found["problems"] == []
    passed, failed = found["results"]
    assert (passed["name"], passed["line"], passed["passed"]) == ("it waves", 1, True)
    assert passed["seconds"] > 1.0
    assert (failed["name"], failed["line"], failed["passed"], failed["at"]) == ("it says hello", 6, False, 9)
    assert TEXT[failed["start"] : failed["end"]] == "go to the lab"
    assert "the mission failed: go to lab" in failed["problem"]
    assert failed["film"]["text"] == TEXT


def test_a_mission_in_the_test() -> None:
    [failed] = results('test "t":\n  run:\n    wave\n  within 1 s it has said hello')["results"]
    assert (failed["passed"], failed["at"], failed["start"]) == (False, 4, None)
    assert (failed["film"]["text"], failed["film"]["nodes"][0]["start"]) == ("", None)


@pytest.mark.parametrize(
    ("tests", "line", "code"),
    [
        ("wave", 1, "BT180"),
        ("", 1, "BT181"),
        ('test "t":\n  run "tour"\n  frobnicate', 3, "BT010"),
        ('test "t":\n  run "README.md"', 2, "BT001"),
        ('test "t":\n  in the world "examples/worlds/museum.toml"\n  run "tour"', 2, "BT001"),
        ('test "t":\n  run "../tour.txt"', 2, "BT001"),
        ('test "t":\n  run:\n    include "README.md"\n    wave', 3, "BT001"),
    ],
)
def test_what_is_wrong_with_tests(tests: str, line: int, code: str) -> None:
    found = results(tests)
    assert [(each["line"], each["code"]) for each in found["problems"]][:1] == [(line, code)]
    assert found["results"] == []


def test_words_with_python_of_their_own_are_refused(tmp_path: Path) -> None:
    words = tmp_path / "words.toml"
    words.write_text(
        '[[action]]\nid = "Jump"\nphrase = "jump"\ncall = "nowhere_at_all:jump"\nhelp = "x"\nexample = "jump"\n'
    )
    mission = parse_tree("if battery is low, jump", keywords=[str(words)])
    tests = Source('test "t":\n  run "x"\n  "jump" takes 1 s\n  finally the mission succeeds', "tests", roots=())
    assert results_of(tests, lambda name, world: mission)["problems"][0]["code"] == "BT221"


def test_they_take_no_longer_than_they_may() -> None:
    endless = 'test "t":\n  run "tour" for at most 1 hour\n  finally the mission succeeds\n'
    first, second = results(2 * endless, "repeat: print hello", patience=0.5)["results"]
    assert (first["passed"], first["problem"]) == (False, "it took too long to simulate")
    assert second["passed"] is None
