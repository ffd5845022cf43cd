"""Values that a mission names: what is set or remembered, parameters, and what `for each` goes through."""

from __future__ import annotations

import pytest

import btlang
from btlang.diagnostics.diagnostic import MissionError
from btlang.engine.status import FAILURE, SUCCESS
from btlang.run.events import Said
from btlang.tree.dump import plain

PARSERS = ("shunting-yard", "lark")


def tree_of(text: str) -> list[str]:
    """The tree that both parsers give, a line each."""
    trees = {plain(btlang.parse_tree(text, parser=parser).tree) for parser in PARSERS}
    assert len(trees) == 1
    return trees.pop().splitlines()


def codes(text: str) -> list[str]:
    """The codes of what is wrong, the same from both parsers."""
    found = []
    for parser in PARSERS:
        with pytest.raises(MissionError) as error:
            btlang.parse_tree(text, parser=parser)
        found.append([problem.code for problem in error.value.diagnostics if problem.is_error])
    assert found[0] == found[1]
    return found[0]


def said(text: str) -> list[str]:
    """What the robot says, when the mission succeeds."""
    words: list[str] = []

    def listen(event: object) -> None:
        if isinstance(event, Said):
            words.append(event.text)

    outcome = btlang.parse_tree(text).run(speed="max", sinks=[listen])
    assert outcome.status == SUCCESS, outcome
    return words


@pytest.mark.parametrize(
    ("text", "node"),
    [
        ("set counter to 3", 'Script code="counter := 3"'),
        ("set the first gap to half a meter", 'Script code="first_gap := 0.5"'),
        ("set goal to the living room", "Script code=\"goal := 'living room'\""),
        ('set mood to "it is fine"', "Script code=\"mood := 'it is fine'\""),
        ("remember the battery as level", "Battery value={level}"),
        ("remember the lab as goal", "Script code=\"goal := 'lab'\""),
        ("set {x} to 2", 'Script code="x := 2"'),
    ],
)
def test_giving_a_value(text: str, node: str) -> None:
    assert tree_of(text) == [node]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("set x to 3; increase x; decrease x by 2; say {x}", ["2"]),
        ("set x to 3; set y to x; increase x by y; say {x}", ["6"]),
        ('set x to 0.1; increase x by 0.2; say "{x}"', ["0.3"]),
        ('set name to "O\'Neil"; say "it\'s {name}"', ["it's O'Neil"]),
        ('set x to 1; say "{x} {{x}} {X}"', ["1 {x} 1"]),
        ("twice as {n} is say {n} then say {n}; twice as 7", ["7", "7"]),
        ('add {n} is increase sum by {n}\nset sum to 0; add 2; add 3; say "{sum}"', ["5"]),
        ('tell {who} {what} is say "{who}: {what}"; tell Alice "good day"', ["Alice: good day"]),
        ("for each n in 1, 2 and 3: say {n}", ["1", "2", "3"]),
        ('for each x in 1, 2: for each y in 3, 4: say "{x}{y}"', ["13", "14", "23", "24"]),
        ('for each x in 1, 2: for each x in 3, 4: say "{x}"', ["3", "4", "3", "4"]),
        ('for each place in the lab: say "{place}" then say "{place}"', ["lab", "lab"]),
        ('set x to 2; for each n in {x}, 5: say "{n}"', ["2", "5"]),
        ("set n to 2; (say hi) n times; nod {n} times", ["hi", "hi"]),
        ("set x to 9; if x is 9 and x is not 8, say yes, otherwise say no", ["yes"]),
        ("set x to 10; set y to 9; if x is above {y}, say yes, otherwise say no", ["yes"]),
        ("compare {x} with {y} is if {x} is above {y}, say yes, otherwise say no; compare 10 with 9", ["yes"]),
        ("set goal to the lab; if goal is the lab, say yes, otherwise say no", ["yes"]),
        ("remember the battery as level; if the battery is at most {level}, say yes", ["yes"]),
        ("set pause to 0.3 s; say a then wait {pause} then say b", ["a", "b"]),
        ("enough means x is above 2\nset x to 3; if enough, say yes", ["yes"]),
        ("count is increase x by 1\nset x to 0; count 3 times; say {x}", ["3"]),
        (
            'call {who} is say "agent {who}" then say {who}\ncall James; call "007"; call "2.50"; call "3"',
            ["agent James", "James", "agent 007", "007", "agent 2.50", "2.50", "agent 3", "3"],
        ),
        ('for each name in "007", "it": say {name}', ["007", "it"]),
        ("set n to 2; set n to {n}; say {n}", ["2"]),
    ],
)
def test_running(text: str, expected: list[str]) -> None:
    assert said(text) == expected


def test_the_type_of_a_parameter_follows_from_its_use() -> None:
    visit = tree_of("visit {goal} is go to the goal; visit the lab")
    assert [visit[0], visit[2]] == ['SubTree ID="visit {goal}" goal=lab', "  GoTo place={goal}"]
    assert tree_of("meet {guest} is go to guest then wave at guest; meet Alice")[3] == "    GoToPerson person={guest}"
    assert tree_of("rest {time} is wait {time}; rest half a minute")[0] == 'SubTree ID="rest {time}" time=30'
    handed_on = "outer {a} is inner {a}; inner {b} is wave at {b}; outer Alice and Bob"
    assert tree_of(handed_on)[:3] == ["Sequence", '  SubTree ID="outer {a}" a=Alice', '  SubTree ID="outer {a}" a=Bob']
    assert codes("visit {goal} is go to the goal; visit 3 m") == ["BT011"]


def test_values_of_the_mission_are_ports_of_the_subtrees_that_need_them() -> None:
    text = "outer is inner; inner is increase x by 1\nset x to 0; outer"
    assert tree_of(text) == [
        "Sequence",
        '  Script code="x := 0"',
        "  SubTree ID=outer x={x}",
        "BehaviorTree ID=inner",
        '  Script code="x += 1"',
        "BehaviorTree ID=outer",
        "  SubTree ID=inner x={x}",
    ]


def test_a_body_sees_what_is_around_it_and_nothing_else() -> None:
    assert codes('greet {x} is say "{x}"; greet Alice; say {x}') == ["BT043"]
    assert codes('(for each n in 1, 2: say "{n}") then say "{n}"') == ["BT043"]
    assert codes("one {x} is wave at {x}; two {y} is wave at {x}; one Alice; two Bob") == ["BT043"]
    inner = tree_of('greet {x} is for each n in 1, 2: say "{x} {n}"; greet Alice')
    assert "    SubTree ID=each_n n=1 x={x}" in inner


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("say {x}", ["BT043"]),
        ("increase x", ["BT043"]),
        ("set x", ["BT039"]),
        ("set x to 3; turn left {x}", ["BT044"]),
        ("set x to 3; set x to the lab", ["BT048"]),
        ("set x to 3; for each x in 1, 2: wave", ["BT045"]),
        ("for each x in: wave", ["BT039"]),
        ("greet {x} is greet {x}; greet Alice", ["BT040"]),
        ("{x} is wave", ["BT016"]),
        ("if x is 3, wave", ["BT010"]),
        ("set x to 3 if", ["BT020"]),
    ],
)
def test_what_is_wrong(text: str, expected: list[str]) -> None:
    assert codes(text) == expected


def test_a_value_that_is_not_set_when_it_is_needed_fails_with_a_reason() -> None:
    outcome = btlang.parse_tree('say "{x}"; set x to 3').run(speed="max")
    assert outcome.status == FAILURE
    assert "{x} has no value" in outcome.failure.reason
