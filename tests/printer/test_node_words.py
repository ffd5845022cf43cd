"""The words of nodes, in the English of their mission."""

from __future__ import annotations

import pytest

from btlang.api import parse_tree
from btlang.engine.compile import outline

BLOCKS = """\
# A tour
greet is wave then nod
say "hello"  # first
greet
bow is:
    wave
    nod
if the battery is low:
    wave
otherwise:
    # only this
    nod
"""


def words_of(text: str, language: str = "en") -> list[str]:
    mission = parse_tree(text, language=language)
    return [mission.words(node) for node in outline(mission.tree)[0]]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("try up to 4 times: go to the lab", ["try up to 4 times", "go to lab"]),
        ("try up to 2 times: check that the battery is low", ["try up to 2 times", "battery is low"]),
        ("go to the lab, at most 3 times", ["at most 3 times", "go to lab"]),
        ("wave within 5 s", ["within 5 s", "wave"]),
        ("wave twice", ["twice", "wave"]),
        ("keep out of the kitchen while going to the lab", ["without entering kitchen", "go to lab"]),
        ("go to the lab, avoiding the kitchen", ["avoiding the kitchen", "go to lab"]),
        ("wait until the battery is low", ["wait until", "battery is low"]),
        ("go to the lab then wave otherwise nod", ["otherwise", "then", "go to lab", "wave", "nod"]),
        ("check that the battery is not low", ["not", "battery is low"]),
        ("visit the lab and the kitchen", ["then", "go to lab", "go to kitchen"]),
        ("for each room: say hello", ["for each room", "lobby", "say hello", "hall"]),
        ("whenever the battery is low, wave\nnod", ["whenever", "battery is low", "wave", "nod"]),
    ],
)
def test_nodes_are_said_as_in_the_mission(text: str, words: list[str]) -> None:
    assert words_of(text)[: len(words)] == words


def test_other_statements_and_comments_are_not_in_the_words() -> None:
    found = words_of(BLOCKS)
    assert found[:3] == ["then", "say hello", "greet"]
    assert found[6:] == ["if … otherwise", "battery is low", "wave", "nod"]


def test_a_mission_in_spanish_has_spanish_words() -> None:
    assert words_of("avanza 2 metros y luego di hola", "es")[0] == "y luego"


def test_nodes_of_xml_have_the_words_of_the_language() -> None:
    body = '<RetryUntilSuccessful num_attempts="4"><Sequence><Wave/><Nod/></Sequence></RetryUntilSuccessful>'
    words = words_of(f'<root BTCPP_format="4"><BehaviorTree ID="T">{body}</BehaviorTree></root>')
    assert words == ["retry 4 times", "then", "wave", "nod"]


@pytest.mark.parametrize(
    ("xml", "words"),
    [
        ("<KeepRunningUntilFailure><Wave/></KeepRunningUntilFailure>", "again and again until it fails"),
        ('<Parallel success_count="1"><Wave/><Nod/></Parallel>', "at the same time, until 1 succeeded"),
        ("<Parallel><Wave/><Nod/></Parallel>", "at the same time"),
        ('<RateController hz="0.3"><Wave/></RateController>', "at most 0.3 times a second"),
        ('<AsyncSequence name="tea"><Wave/></AsyncSequence>', "tea"),
        ('<DriveAlong corridor="{door}" fast="true"/>', 'drive along with corridor {door}, fast "true"'),
        ("<Wave/>", "wave"),
    ],
)
def test_nodes_without_words_are_said_as_in_the_english_of_the_tree(xml: str, words: str) -> None:
    tree = f'<root BTCPP_format="4"><BehaviorTree ID="T">{xml}</BehaviorTree></root>'
    assert words_of(tree)[0] == words
