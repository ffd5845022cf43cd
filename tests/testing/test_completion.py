"""What is offered at the end of a text of tests can be read there."""

from __future__ import annotations

import pytest

from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.testing.statements import completions_in_tests
from btlang.testing.test_file import WORDS
from tests.testing.files import codes

VOCABULARY = world_vocabulary([WORDS])
HEAD = 'test "t":\n  run:\n    wave then go to the lab\n'


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("", "finally "),
        ("wi", "within "),
        ("then within 2 minutes the robot is ch", "then within 2 minutes the robot is charging"),
        ("finally it has ne", "finally it has never bumped"),
        ("after 30 s the battery dr", "after 30 s the battery drops to "),
        ("always the battery is ab", "always the battery is above "),
        ("when it has reached the l", "when it has reached the lab"),
        ("when it has reached the lab, the battery dr", "when it has reached the lab, the battery drops to "),
        ("finally it has said hello and the mis", "finally it has said hello and the mission succeeds"),
    ],
)
def test_lines(line: str, offered: str) -> None:
    text = f"{HEAD}  {line}"
    found = [text[: one.start] + one.text for one in completions_in_tests(text, VOCABULARY)]
    assert any(f"{one} ".startswith(f"{HEAD}  {offered}") for one in found), found


def test_the_mission_in_a_test() -> None:
    text = 'test "t":\n  run:\n    go to the la'
    assert text[:-2] + "lab" in [text[: one.start] + one.text for one in completions_in_tests(text, VOCABULARY)]


def test_whole_lines_that_are_offered_are_read() -> None:
    text = f"{HEAD}  finally it st"
    offered = [text[: one.start] + one.text for one in completions_in_tests(text, VOCABULARY)]
    assert offered
    assert all(codes(one) == [] for one in offered if one.endswith("still"))


def test_nothing_is_offered_before_the_first_test() -> None:
    assert completions_in_tests("fi", VOCABULARY) == ()
