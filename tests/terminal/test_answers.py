"""Missions with a person in the loop: what is typed in the live view is the answer to what the robot asks."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from btlang.diagnostics.diagnostic import MissionError
from btlang.robots.ears import read_answers
from btlang.run.world_input import WorldInput
from btlang.text.source import Source

from .emulator import BTC, Terminal

Open = Callable[..., Terminal]
ASKS = 'ask "Shall I go on?"; if the answer is yes, say "Here I go!", otherwise say "I stay."; wait 1 s'


def test_what_is_typed_is_the_answer(terminal: Open) -> None:
    seen = terminal(*BTC, "run", "-c", ASKS)
    seen.wait_for("Shall I go on? _")
    seen.type("yes, ple", enter=False)  # s and e would be a single step and the emergency stop
    seen.wait_for("Shall I go on? yes, ple_")
    seen.type("ase")
    seen.wait_for('hears  "yes, please"')
    assert seen.wait_for_end() == 0
    assert 'says   "Here I go!"' in seen.history()


def test_answers_of_a_file(terminal: Open, tmp_path: Path) -> None:
    (tmp_path / "answers.toml").write_text('"go on" = ["no", "yes"]\n', encoding="utf-8")
    seen = terminal(*BTC, "run", "--speed", "max", "--answers", str(tmp_path / "answers.toml"), "-c", f"{ASKS}; {ASKS}")
    assert seen.wait_for_end() == 0
    said = seen.history()
    assert said.index('says   "I stay."') < said.index('says   "Here I go!"')


@pytest.mark.parametrize(
    "text", ["a = 1", "a = []", "a = [1]", "a = {}", "= 1", '"a" = "\\u0000"' * 2, "[a]\nb = 'c'", 'a = ""', "a = nan"]
)
def test_wrong_answers_are_told(text: str) -> None:
    with pytest.raises(MissionError, match="BT073"):
        read_answers(Source(text, "answers.toml"))


def test_answers_go_by_words_of_the_question() -> None:
    given = WorldInput({"tea": ["no", "yes"], "*": ["pardon?"]})
    assert [given._take_answer(question) for question in ("tea?", "coffee?", "more tea?", "tea again?")] == [
        "no", "pardon?", "yes", "yes",
    ]  # fmt: skip
