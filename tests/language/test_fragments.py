"""Words that are only a part of a sentence get a message that shows the whole of it, which can be pasted."""

from __future__ import annotations

import pytest

from btlang import action
from btlang.api import parse_tree
from btlang.diagnostics.diagnostic import Diagnostic, MissionError


def problems(text: str) -> list[Diagnostic]:
    with pytest.raises(MissionError) as refused:
        parse_tree(text)
    return [problem for problem in refused.value.diagnostics if problem.is_error]


@pytest.mark.parametrize(
    ("text", "code", "message"),
    [
        ("Turn 90 degrees.", "BT012", "After 'Turn 90 degrees' I expected 'left' or 'right'."),
        ("the kitchen", "BT019", ""),
        ("wave then the lab", "BT019", ""),
        ("to the kitchen", "BT154", "'to the kitchen' is only a part of a command or condition."),
        ("go the kitchen", "BT012", "After 'go' I expected 'to', 'around' or 'into'."),
        ("if battery below 20%, dock", "BT012", "After 'battery' I expected 'is'."),
    ],
)
def test_a_part_of_a_sentence(text: str, code: str, message: str) -> None:
    problem = problems(text)[0]
    assert (problem.code, problem.message if message else "") == (code, message)
    for example in dict(problem.arguments)["example"].split(", or: "):
        parse_tree(f"if {example}, wave" if text.startswith("if") else example)


def test_the_example_of_a_phrase_that_goes_on_behind_its_value_is_whole() -> None:
    @action("vent the fan {times} times", slots={"times": "count"})
    def vent(times: int) -> None:
        """Do nothing."""

    with pytest.raises(MissionError) as refused:
        parse_tree("vent the fan", keywords=[vent])
    assert refused.value.diagnostics[0].hint == "Write for example: vent the fan 3 times"
    parse_tree("vent the fan 3 times", keywords=[vent])


@pytest.mark.parametrize("text", ["stop waving", "wave. Stop turning left.", "go to the lab then halt nodding"])
def test_a_command_that_is_to_be_stopped(text: str) -> None:
    problem = problems(text)[0]
    assert problem.code == "BT152"
    assert "but stop when" in problem.hint


@pytest.mark.parametrize("text", ["go to the lab without waving", "nod without stopping"])
def test_what_is_not_to_be_done_meanwhile(text: str) -> None:
    problem = next(problem for problem in problems(text) if problem.code == "BT155")
    assert "but stop when" in problem.hint


def test_what_is_not_done_with_a_thing_is_to_be_left_out() -> None:
    problem = next(problem for problem in problems("wave without the cup") if problem.code == "BT155")
    assert "leave this out" in problem.hint


@pytest.mark.parametrize("text", ["frobnicate", "xyzzy the plugh", "turn lfet", "ge to the lab"])
def test_other_words_get_the_message_that_they_had(text: str) -> None:
    assert problems(text)[0].code == "BT010"
