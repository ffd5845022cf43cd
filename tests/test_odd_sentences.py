"""Texts that once ended in a traceback."""

from __future__ import annotations

import pytest

import btlang


@pytest.mark.parametrize("parser", ["shunting-yard", "lark"])
@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("patrol is: please", "BT027"),
        ("if battery is low: please", "BT027"),
        ("repeat 3 times:\n  please\nwave", "BT027"),
        ("please\notherwise wave", "BT067"),
        ("if the path is clear:\n  please\n  otherwise wave", "BT067"),
        ('say"hello" there', "BT010"),
        ("until and : \n   cm show\r nan: ", "BT020"),
        ("{a} is b", "BT016"),
        ("greet {} is wave", "BT015"),
        ("{x} means wave the % y", "BT016"),
        ('x "it is {level}" is wave', "BT015"),
    ],
)
def test_messages(text: str, code: str, parser: str) -> None:
    with pytest.raises(btlang.MissionError) as caught:
        btlang.parse_tree(text, parser=parser)
    assert code in [problem.code for problem in caught.value.diagnostics]


@pytest.mark.parametrize("text", ["repeat 3 times: please wave", "repeat: please\n  wave", "please: wave"])
def test_politeness_changes_nothing(text: str) -> None:
    if text.startswith("please:"):
        with pytest.raises(btlang.MissionError):
            btlang.parse_tree(text)
    else:
        assert btlang.parse_tree(text).tree.root.id == "Repeat"


@pytest.mark.parametrize(
    ("broken", "mended"),
    [
        ("turn left 45 derees", "turn left 45 degrees"),
        ("move forward 3 meeters", "move forward 3 meters"),
        ("whree is the cup?", "where is the cup?"),
        ("wave at Allice", "wave at Alice"),
        ("pick up the bookk", "pick up the book"),
        ("go upstairs", None),
        ("say 'hello world' at Bob", None),
    ],
)
def test_fixes_change_something(broken: str, mended: str | None) -> None:
    with pytest.raises(btlang.MissionError) as caught:
        btlang.parse_tree(broken)
    fix = caught.value.diagnostics[0].fix
    assert (fix is None) == (mended is None)
    if fix is not None:
        assert broken[: fix[0].start] + fix[1] + broken[fix[0].end :] == mended
