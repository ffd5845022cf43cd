"""Sentences that get a warning, and sentences that are near to them and get none."""

from __future__ import annotations

import pytest

from btlang.api import parse_tree
from btlang.passes.lint.endings import FAILURE, NEVER, SUCCESS, find_mission_ends
from btlang.repl.draft import MissionDraft
from btlang.vocabulary.entry import Entry


def warned(text: str) -> list[str]:
    """The codes of the warnings of a mission, in their order."""
    return [warning.code for warning in parse_tree(text).warnings]


TWO_READINGS = [
    "if not bumped or stuck, wave",
    "check not bumped or stuck or docked",
    "if bumped, wave. Nod. Otherwise say hello",
    "unless bumped, wave; nod; otherwise say hello",
    "wave then nod and say hello",
    "wave and nod then say hello",
    "wave and nod or say hello",
    "wave or nod then say hello",
    "wave, nod and say hello then turn left",
    "wave, then nod then turn left and look up",
    "wave after nod and say hello",
    "wave and nod after say hello",
    "if bumped and stuck or docked, wave",
    "wave if bumped or stuck and docked",
    "check that bumped and stuck or docked",
    "if bumped, wave then nod and say hello",
    "trouble is bumped and stuck or docked; if trouble, wave",
    "repeat wave and nod then say hello 3 times",
    "(wave then nod and say hello) twice",
    "repeat 3 times:\n  wave then nod and say hello",
    "wave then nod 3 times",
    "wave and nod for 5 s",
    "wave or nod if possible",
    "wave and nod until bumped",
    "wave then nod if bumped",
    "wave then nod unless bumped otherwise look up",
    "wave then nod within 10 s",
    "wave, nod and say hello twice",
    "wave then nod 3 times then look up",
    "if bumped, wave then nod twice",
    "if bumped, if stuck, wave otherwise nod",
    "if bumped, if stuck, wave\notherwise nod",
    "if bumped, say hello and if stuck, wave otherwise nod",
    "if bumped, try wave otherwise nod",
    "try if bumped, wave otherwise nod",
    "if bumped, wave if stuck otherwise nod",
    "if bumped, repeat if stuck, wave otherwise nod",
    "look at the lobby and the lab and wave",
    "look at the lobby, the lab and wave",
    "say hello and look at the lobby and the lab",
]
ONE_READING = [
    "if (not bumped) or stuck, wave",
    "if not bumped or not stuck, wave",
    "if not (bumped or stuck), wave",
    "if bumped, wave. Otherwise nod",
    "if bumped, wave otherwise look up. Nod. Otherwise say hello",
    "wave. Nod. Otherwise say hello",
    "if bumped, wave. Nod otherwise say hello",
    "wave then nod then look up",
    "wave, nod and say hello",
    "wave, nod, then say hello",
    "wave, then nod and say hello",
    "wave and nod, then say hello",
    "wave and nod, or say hello",
    "wave then nod, and say hello",
    "wave then (nod and say hello)",
    "(wave then nod) and say hello",
    "wave then nod\nlook up and say hello",
    "wave then nod; look up and say hello",
    "wave and nod. look up then say hello",
    "in parallel:\n  wave then say hello\n  nod",
    "if bumped and stuck, or docked, wave",
    "if bumped and (stuck or docked), wave",
    "if bumped and stuck, wave or nod",
    "if bumped then wave and nod",
    "wave then if bumped, nod and say hello",
    "wave then repeat nod and say hello 3 times",
    "wave and nod otherwise say sorry",
    "try wave and nod otherwise say sorry",
    "wave, then nod 3 times",
    "wave and (nod 3 times)",
    "wave then (nod) 3 times",
    "(wave then nod) 3 times",
    "wave then (nod and say hello) 3 times",
    "(wave 3 times) then nod",
    "wave 3 times then nod",
    "wave until bumped then nod",
    "wave then nod, if bumped",
    "repeat wave then nod 3 times",
    "repeat:\n  wave then nod",
    "if bumped, wave otherwise nod",
    "if bumped, wave, otherwise if stuck, nod",
    "if bumped, (if stuck, wave otherwise nod)",
    "if bumped, (if stuck, wave) otherwise nod",
    "if bumped:\n  if stuck, wave otherwise nod",
    "if bumped, if stuck, wave otherwise nod otherwise look up",
    "if bumped, say hello and (if stuck, wave otherwise nod)",
    "go to the lobby and the lab",
    "go to the lobby and the lab twice",
    "go to the lobby, the lab and wave",
    "say hello and go to the lobby and the lab",
    "go to the lobby and the lab, and wave",
    "(go to the lobby and the lab) and wave",
    "go to the lobby and the lab then wave",
    "go to the lobby or the lab or wave",
    "say \"this, then that and those\" then nod",
]  # fmt: skip


@pytest.mark.parametrize("text", TWO_READINGS)
def test_two_readings(text: str) -> None:
    assert warned(text).count("BT050") == 1


@pytest.mark.parametrize("text", ONE_READING)
def test_one_reading(text: str) -> None:
    assert "BT050" not in warned(text)


def test_one_of_a_kind_for_each_sentence() -> None:
    assert warned("wave then nod and say hello then look up and say goodbye") == ["BT050"]
    assert warned("wave then nod and say hello; wave then nod and say hello") == ["BT050", "BT050"]
    assert warned("wave then nod and say hello twice") == ["BT050", "BT050"]


def test_what_two_readings_shows() -> None:
    [warning] = parse_tree("go to the lobby then wave and look around").warnings
    assert warning.message == "This can be read in two ways."
    assert warning.hint.splitlines() == [
        "I read: go to lobby then (wave and look around)",
        "To keep that, write: go to the lobby, then wave and look around",
        "It could also mean: (go to lobby then wave) and look around at the same time",
    ]


@pytest.mark.parametrize(
    ("text", "codes"),
    [
        ("bow is nod; wave", ["BT051"]),
        ("bow is nod; bow", []),
        ("bow is deep bow; deep bow is nod; wave", ["BT051", "BT051"]),
        ("bow is deep bow; deep bow is nod; bow", []),
        ("tired is the battery is low; if tired, wave", []),
    ],
)
def test_unused_names(text: str, codes: list[str]) -> None:
    assert warned(text) == codes


@pytest.mark.parametrize(
    ("text", "reason", "never"),
    [
        ("wave forever then nod", "continues until it fails", "nod"),
        ("wave forever\nnod", "continues until it fails", "nod"),
        ("nod every 2 s then wave", "continues until it fails", "wave"),
        ("(wave if possible) forever, then nod", "never ends", "nod"),
        ("if bumped:\n  repeat wave\n  nod", "continues until it fails", "nod"),
        ("dance is nod forever; dance then wave", "continues until it fails", "wave"),
        ("fail then wave", "always fails", "wave"),
        ("give in is fail; give in, then wave", "always fails", "wave"),
        ("if bumped, fail, otherwise fail\nwave", "always fails", "wave"),
        ("(say sorry then fail) then wave", "always fails", "wave"),
        ("fail 3 times then wave", "always fails", "wave"),
        ("wave if possible or nod", "always succeeds", "nod"),
        ("do nothing or nod", "always succeeds", "nod"),
        ("try (wave if possible) otherwise nod", "always succeeds", "nod"),
        ("wait 5 s otherwise nod", "always succeeds", "nod"),
        ("wait until bumped otherwise nod", "continues until it succeeds", "nod"),
        ("(wait 5 s then do nothing) or nod", "always succeeds", "nod"),
        ("try in order:\n  wave\n  nod if possible\n  look up", "always succeeds", "look up"),
        ("(wave forever and nod forever) then say hello", "continues until it fails", "say hello"),
    ],
)
def test_never_runs(text: str, reason: str, never: str) -> None:
    [warning] = [warning for warning in parse_tree(text).warnings if warning.code == "BT052"]
    assert (warning.span.text, dict(warning.arguments)["reason"]) == (never, reason)
    assert len(warning.notes) == 1


@pytest.mark.parametrize(
    ("text", "ends"),
    [
        ("wait forever", NEVER),
        ("whenever bumped, try to wave", NEVER),
        ("wave forever", NEVER | FAILURE),
        ("go to the lab then wave forever", NEVER | FAILURE),
        ("look is wave forever. nod then look", NEVER | FAILURE),
        ("never enter the lab. wave forever", NEVER | FAILURE),
        ("whenever bumped, nod", NEVER | FAILURE),
        ("wave. whenever bumped, nod", SUCCESS | FAILURE),
        ("wave forever until bumped", SUCCESS | FAILURE),
        ("(wave forever) for 5 s", SUCCESS | FAILURE),
        ("if bumped, wave forever, otherwise nod", NEVER | SUCCESS | FAILURE),
    ],
)
def test_endings_of_missions(text: str, ends: int) -> None:
    assert find_mission_ends(parse_tree(text).tree) == ends


@pytest.mark.parametrize(
    "text",
    [
        "wave forever or nod",
        "nod forever",
        "wave while bumped then nod",
        "wave until bumped then nod",
        "(wave forever) for 5 s, then nod",
        "(wave forever) within 5 s, otherwise nod",
        "(wave forever) provided that docked, otherwise nod",
        "wave forever and say hello",
        "fail or wave",
        "wave or fail then nod",
        "fail if bumped\nwave",
        "wait until bumped within 5 s, otherwise nod",
        "(wave if possible) then nod",
        "wave if bumped or nod",
        "if bumped, do nothing, otherwise nod",
        "until bumped, do nothing",
        "while bumped, fail",
        "try wave up to 3 times otherwise nod",
        "(wave if bumped) twice",
        "whenever bumped, fail\nwave",
    ],
)
def test_all_can_run(text: str) -> None:
    assert "BT052" not in warned(text)


@pytest.mark.parametrize(
    ("text", "is_busy"),
    [
        ("check that the battery is low forever", True),
        ("repeat print hello", True),
        ("repeat do nothing", True),
        ("repeat (wave or print sorry)", False),
        ("while bumped, do nothing", True),
        ("print hello until bumped", True),
        ("look is check that bumped then print hello; look forever", True),
        ("keep trying (print hello then fail)", True),
        ("keep trying to check that bumped", False),
        ("wait until bumped", False),
        ("as soon as two people are near, wave", False),
        ("repeat (wait until bumped then print ouch)", False),
        ("repeat (print hello then wait 1 s)", False),
        ("print hello every 1 s", False),
        ("print hello for 5 s", False),
        ("print hello 3 times", False),
        ("repeat after 1 s, print hello", False),
        ("repeat if bumped, wave", False),
        ("(print hello 3 times) forever", True),
        ("wave for 5 s; repeat print hello", True),
    ],
)
def test_busy_loops(text: str, is_busy: bool) -> None:
    assert ("BT053" in warned(text)) == is_busy


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("put down the cup for 5 s", 1),
        ("put down the cup within 5 s", 1),
        ("put down the cup until bumped", 1),
        ("while bumped, put down the cup", 1),
        ("put down the cup provided that docked", 1),
        ("serve is put down the cup; serve for 5 s", 1),
        ("(put down the cup for 5 s) within 1 min", 1),
        ("(pick up the cup then put down the cup) within 1 min", 1),
        ("put down the cup", 0),
        ("wave for 5 s", 0),
        ("put down the cup 3 times", 0),
        ("if bumped, put down the cup", 0),
        ("put down the cup and nod", 0),
        ("whenever bumped, wave\nput down the cup", 0),
        ("whenever bumped, put down the cup\nwave", 0),
    ],
)
def test_cut_off(text: str, number: int) -> None:
    assert warned(text).count("BT054") == number


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("dance is: wave; nod; dance", "nod"),
        ("dance is: wave. Nod then bow.\nbow is look down; dance", "Nod"),
        ("dance is wave; nod; dance", None),
        ("dance is: wave\nnod; dance", None),
        ("dance is:\n  wave; nod\ndance", None),
        ("dance is: wave; bow is: nod\ndance then bow", None),
    ],
)
def test_line_ends(text: str, told: str | None) -> None:
    found = [warning.span.text for warning in parse_tree(text).warnings if warning.code == "BT055"]
    assert found == ([told] if told else [])


SENTENCE = "wave then nod 3 times"


@pytest.mark.parametrize(
    ("text", "codes"),
    [
        (f"{SENTENCE} # allow: two readings", []),
        (f"{SENTENCE} #allow:Two  Readings", []),
        (f"{SENTENCE} # allow: never runs", ["BT050"]),
        (f"{SENTENCE} # allow: never runs, two readings", []),
        (f"wave\n{SENTENCE} # allow: two readings\n{SENTENCE}", ["BT050"]),
        (f"# allow: two readings\n{SENTENCE}\nwave\n{SENTENCE}", []),
        (f"{SENTENCE}\n# allow: two readings", []),
        (f"if bumped: # allow: two readings\n  {SENTENCE}\n  {SENTENCE}\n{SENTENCE}", ["BT050"]),
        (f"if bumped: # allow: two readings\n  wave\notherwise:\n  {SENTENCE}\n{SENTENCE}", ["BT050"]),
        (f"if bumped:\n  wave # allow: two readings\n  {SENTENCE}", ["BT050"]),
        (f'say "# allow: two readings"\n{SENTENCE}', ["BT050"]),
        (f"{SENTENCE} # allow: two raedings", ["BT050", "BT056"]),
        ("wave # allow: nonsense # allow: unknown warning", ["BT056"]),
        ("# allow: unknown warning\nwave # allow: nonsense", []),
        ("wave # allow:", []),
        ("wave is nod # allow: hiding name\nwave", []),
        ("bow is nod\nbow is wave # allow: redefined name\nbow", []),
        ("wave # allow: two readings", []),
    ],
)
def test_silencing(text: str, codes: list[str]) -> None:
    assert warned(text) == codes


def test_a_session_has_lints_of_what_was_typed() -> None:
    draft = MissionDraft()
    bow = draft.compile("bow is wave then nod twice")
    assert [warning.code for warning in bow.mission.warnings] == ["BT050"]
    draft.add(bow.entry)
    assert draft.compile("bow").mission.warnings == ()


def test_what_an_action_says_of_itself() -> None:
    def call() -> None: ...

    spin = Entry("action", "Spin", ("spin quickly",), call, instant=True)
    weld = Entry("action", "Weld", ("weld",), call, uninterruptible=True)
    tree = parse_tree("spin quickly forever; weld for 5 s # allow: never runs", keywords=[spin, weld])
    assert [warning.code for warning in tree.warnings] == ["BT053", "BT054"]


def test_a_time_far_inside_takes_no_time_of_its_square() -> None:
    deep = "(" * 5_000 + "wave until 5 pm. At 5 pm, nod" + " then nod) twice" * 5_000
    assert warned(deep) == ["BT169"]  # half a minute, when each command looked for a time in all that is in it
