"""What the page *Try it* asks, in one thread: texts, runs that are stepped, and what no page should be able to do."""

from __future__ import annotations

import json
import os
import sys
import threading
from pathlib import Path
from typing import Any

import pytest

from btlang.playground import playground as module
from btlang.playground import prepare
from btlang.playground.playground import MOST_CHARACTERS, Playground
from btlang.support.user_dirs import user_dir
from btlang.vocabulary.cache import stamp
from tests.test_house import ROOT

PAGE = ROOT / "btlang" / "web" / "src" / "playground"
EXAMPLES = json.loads((PAGE / "examples.json").read_text(encoding="utf-8"))
MISTAKE, ENDLESS = "A mistake to fix", "A mission without an end"


def ask(playground: Playground, kind: str, text: str, **arguments: Any) -> dict[str, Any]:
    return dict(json.loads(playground.ask(kind, text, json.dumps(arguments))))


def begin(playground: Playground, text: str) -> list[dict[str, Any]]:
    begun = json.loads(playground.begin(text))
    assert begun["ok"], begun
    return list(begun["news"])


def step(playground: Playground, seconds: float) -> dict[str, Any]:
    return dict(json.loads(playground.advance(seconds, 10.0)))


def ended(playground: Playground, within: float = 200.0) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """How a run ends, and all news on the way."""
    news: list[dict[str, Any]] = []
    for _ in range(round(within)):
        found = step(playground, 1.0)
        assert "problem" not in found, found
        news += found["news"]
        if found["over"]:
            return found, news
    raise AssertionError(f"it goes on for {within} s")


def of_type(news: list[dict[str, Any]], kind: str) -> list[dict[str, Any]]:
    return [each for each in news if each["type"] == kind]


@pytest.mark.parametrize(("name", "text"), EXAMPLES, ids=[name for name, _ in EXAMPLES])
def test_examples_succeed(name: str, text: str) -> None:
    playground = Playground()
    if name == MISTAKE:
        [message] = ask(playground, "document", text)["messages"]
        assert text[message["fix"]["start"] : message["fix"]["end"]] == "kichen"
        text = text.replace("kichen", message["fix"]["text"])
    begin(playground, text)
    if name == ENDLESS:
        assert step(playground, 60.0)["seconds"] == pytest.approx(60.0)
        return
    last, news = ended(playground)
    assert last["succeeded"], last
    assert of_type(news, "event")
    assert len({tuple(each["pose"]) for each in of_type(news, "robot")}) > 10


def test_a_text_is_shown_with_its_tree_and_its_english() -> None:
    playground = Playground()
    text = 'say "\N{PARTY POPPER}" then go to the kichen'
    refused = ask(playground, "document", text)
    assert not refused["ok"]
    [message] = refused["messages"]
    assert (message["start"], message["end"]) == (24, 30)  # of UTF-16, in which the popper has two units
    read = ask(playground, "document", text.replace("kichen", "kitchen"))
    assert [node["id"] for node in read["nodes"]] == ["Sequence", "Say", "GoTo"]
    assert ask(playground, "english", "wave and nod")["text"] == "wave and nod\n"
    assert ask(playground, "hover", "wave", at=2)["found"]["words"] == "wave"


def test_the_house_is_there_before_any_run() -> None:
    world, robot = json.loads(Playground().house())["news"]
    assert (world["type"], robot["type"]) == ("map", "robot")
    assert "kitchen" in [place["name"] for place in world["places"]]


def test_a_run_starts_no_thread() -> None:
    before, playground = threading.active_count(), Playground()
    news = begin(playground, "say hello and wave then move forward 1 m")
    assert of_type(news, "run")[0]["text"].startswith("say hello")
    ended(playground)
    assert threading.active_count() == before


def test_a_step_takes_no_longer_than_asked() -> None:
    playground = Playground()
    begin(playground, "repeat forever: wave")
    passed = json.loads(playground.advance(1000.0, 0.05))["passed"]
    assert 0.0 < passed < 1000.0


def test_a_stopped_run_is_over_and_the_robot_rests() -> None:
    playground = Playground()
    begin(playground, "go to the office")
    step(playground, 3.0)
    stopped = json.loads(playground.stop())
    assert (stopped["over"], stopped["succeeded"]) == (True, False)
    assert stopped["ended"] == "Stopped after 3.0 s."
    assert of_type(stopped["news"], "statuses")[-1]["changes"][0][1] == "IDLE"
    begin(playground, "wave")  # another one begins in a house where nothing has happened
    assert ended(playground)[0]["succeeded"]


def test_a_failed_run_says_why() -> None:
    playground = Playground()
    begin(playground, "move forward 30 m")
    last, _ = ended(playground)
    assert not last["succeeded"]
    assert last["ended"].startswith("The mission failed after ")
    assert "\n" not in last["ended"]
    assert "MoveForward" in last["why"]


def test_who_is_asked_may_answer() -> None:
    playground = Playground()
    begin(playground, 'ask "Tea?"\nif the answer is yes, say "Coming."')
    asked = [each["text"] for _ in range(8) for each in of_type(step(playground, 0.5)["news"], "asking")]
    assert asked == ["Tea?"]
    playground.hear("yes")
    _, news = ended(playground)
    assert "Coming." in [each["event"].get("text") for each in of_type(news, "event")]


def test_huge_texts_are_refused() -> None:
    playground, text = Playground(), "wave\n" * (MOST_CHARACTERS // 5 + 1)
    for answer in (ask(playground, "document", text), json.loads(playground.begin(text))):
        assert answer == {"ok": False, "problem": "The playground reads missions of up to 20,000 characters."}
    assert f"MOST = {MOST_CHARACTERS:_};" in (PAGE / "share.ts").read_text(encoding="utf-8")


def test_a_mission_names_no_files(tmp_path: Path) -> None:
    (tmp_path / "other.txt").write_text("nod", encoding="utf-8")
    for line, code in ((f'world "{tmp_path}/world.toml"', "BT049"), (f'include "{tmp_path}/other.txt"', "BT001")):
        answer = json.loads(Playground().begin(f"{line}\nwave"))
        assert [message["code"] for message in answer["messages"]] == [code]


def test_words_are_cached_for_files_that_are_unpacked_anew(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Else each visit makes them, which takes seconds: only the times of the files differ."""
    file = tmp_path / "words.toml"
    file.write_text("", encoding="utf-8")
    before = stamp(str(file))
    os.utime(file, (1, 1))
    assert stamp(str(file)) != before
    monkeypatch.setattr(sys, "platform", "emscripten")
    before = stamp(str(file))
    os.utime(file, (2, 2))
    assert stamp(str(file)) == before
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert user_dir("cache") == str(tmp_path / "btlang")


def test_a_home_from_an_archive_is_the_users_own(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(sys, "path", [*sys.path])
    (tmp_path / "cache").mkdir()
    (tmp_path / "cache" / "words").write_text("", encoding="utf-8")
    for path in (tmp_path, tmp_path / "cache", tmp_path / "cache" / "words"):
        path.chmod(0o777)
    prepare(str(tmp_path))
    assert {path.stat().st_mode & 0o077 for path in (tmp_path, tmp_path / "cache", tmp_path / "cache" / "words")} == {0}
    assert sys.path[-1].endswith("stand_ins")  # behind all others: real packages come first


def test_no_error_shows_a_traceback(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise RuntimeError("<b>broken</b>")

    monkeypatch.setattr(module, "answer_of", fail)
    problem = ask(Playground(), "document", "wave")["problem"]
    assert problem.startswith("An error inside btlang: RuntimeError: <b>broken</b>")
    assert "Traceback" not in problem
    missing = ModuleNotFoundError(name="ruckig")
    monkeypatch.setattr(module, "answer_of", lambda *_: (_ for _ in ()).throw(missing))
    assert ask(Playground(), "document", "wave")["problem"] == (
        "This needs the package ruckig, which the playground doesn't have."
    )
