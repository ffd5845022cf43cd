"""The change that a message proposes: applied, it mends the sentence."""

from __future__ import annotations

import pytest

import btlang
from btlang.diagnostics.diagnostic import MissionError


def mended(text: str) -> str:
    with pytest.raises(MissionError) as caught:
        btlang.parse_tree(text)
    problem = caught.value.diagnostics[0]
    assert problem.fix is not None
    span, words = problem.fix
    return text[: span.start] + words + text[span.end :]


@pytest.mark.parametrize(
    ("broken", "sound"),
    [
        ("go to the ktichen then wave", "go to the kitchen then wave"),
        ("mvoe forward 2 m", "move forward 2 m"),
        ("wave then rotaet left", "wave then rotate left"),
        ("patrol is wave\nptrol", "patrol is wave\npatrol"),
        ("do Beep with times 3 then wave", 'do "Beep" with times 3 then wave'),
        ('do open the gripper called "left" and wave', 'do "open the gripper" called "left" and wave'),
        ("if test A, wave", 'if test "A", wave'),
        ("do recovery nodee:\n  wave\n  nod", "do recovery node:\n  wave\n  nod"),
        ("do open grippr then wave", "open gripper then wave"),
        ("do opn gripper", "open gripper"),
        ("do open gripper", "open gripper"),
        ("wave then do go to the lab", "wave then go to the lab"),
        ("do the nod twice", "nod twice"),
        ("check test batery is low", "check battery is low"),
        ("move forward 2 then wave", "move forward 2 m then wave"),
        ("wave within 5", "wave within 5 s"),
        ("say hello dear friends", 'say "hello dear friends"'),
        ('say "hello', 'say "hello"'),
        ("the battery is low", "check the battery is low"),
        ("wave and battery is low", "wave and check battery is low"),
        ("wave nod", "wave then nod"),
        ("wave)", "wave"),
        (", wave", "wave"),
        ("wave,", "wave"),
        ("wave, twice, nod", "wave twice, nod"),
        ("check rhat the battery is full, then wave", "check that the battery is full, then wave"),
        ("nod until there is a wall in froont", "nod until there is a wall in front"),
        ("wave adn nod", "wave and nod"),
        ("wave tehn nod", "wave then nod"),
        ("wavethen nod", "wave then nod"),
        ("repeat 3 tims: wave", "repeat 3 times: wave"),
        ("if wall in front:\n  nod\notherwsie wave", "if wall in front:\n  nod\notherwise wave"),
        ("patrol menas wave then nod\npatrol", "patrol means wave then nod\npatrol"),
        ("patrol si wave\nnod", "patrol is wave\nnod"),
        ("turn left a quarter of a flul turn", "turn left a quarter of a full turn"),
        ("trouble means bumped or hsa bumped\ncheck trouble", "trouble means bumped or has bumped\ncheck trouble"),
        ("take teh step is nod\nwave\ntake the step twice", "take the step is nod\nwave\ntake the step twice"),
        (
            "set conuter to 3; check counter is 3 or counter is 4",
            "set counter to 3; check counter is 3 or counter is 4",
        ),
        ('set level to 3; say "it is { levle }"', 'set level to 3; say "it is {level}"'),
        ("set counter to 3; increase conuter by 1", "set counter to 3; increase counter by 1"),
        (
            "ofr each place in the lab, the dock: go to the place",
            "for each place in the lab, the dock: go to the place",
        ),
        ("the door is at (1, 2) faccing 90 degrees; nod", "the door is at (1, 2) facing 90 degrees; nod"),
    ],
)
def test_fix(broken: str, sound: str) -> None:
    assert mended(broken) == sound
    btlang.parse_tree(sound)
