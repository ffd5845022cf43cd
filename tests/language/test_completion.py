"""Completion offers exactly what may follow: what is offered is accepted, and what is accepted is offered."""

from __future__ import annotations

import re
from functools import cache
from itertools import product

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from btlang.diagnostics.diagnostic import MissionError
from btlang.frontends.mission.completion.completer import Completion, completions
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.vocabulary.lexicon import Lexicon
from tests.language.letters import letters, read
from tests.language.sentences import broken_missions, english, missions
from tests.profiles import searches


@cache
def shipped() -> Lexicon:
    return world_vocabulary()


_OPERANDS = ["", " u", " p", " p u", " s", " twice"]
_OPERANDS += [" u or v", " u and v", " u, v", " p or q", " p and q", " p, q", " p nor q", " nor q"]
_BODIES = ["", " u", ": u"]


def offered(text: str, vocabulary: Lexicon | None = None) -> dict[str, Completion]:
    return {option.text: option for option in completions(text, vocabulary or shipped())}


def is_sound(text: str) -> bool:
    try:
        read(text)
    except MissionError:
        return False
    return True


def places(text: str) -> list[int]:
    """Where words begin."""
    return [match.start() for match in re.finditer(r"[a-z]+", text)]


@searches(30, 3000, deadline=None)
@given(missions.map(english), st.data())
def test_what_is_accepted_is_offered(text: str, data: st.DataObject) -> None:
    assume(is_sound(text))
    at = data.draw(st.sampled_from(places(text)))
    word = re.match(r"[a-z]+", text[at:]).group()  # type: ignore[union-attr]
    found = {*offered(text[:at], letters()), *offered(text[: at + 1], letters())}
    units_and_rounds = {"s", "times"}
    assert word in units_and_rounds or word in {option.split()[0] for option in found}


@searches(2, 800, deadline=None)
@given(st.one_of(missions, broken_missions()).map(english), st.data())
def test_what_is_offered_is_accepted(text: str, data: st.DataObject) -> None:
    at = data.draw(st.sampled_from([*places(text), len(text)]))
    start = text[:at] if text[:at].endswith((" ", "\n")) or not at else text[:at] + " "
    above = start.rpartition("\n")[0]
    # where an earlier line is wrong, what is offered in this one mends nothing
    assume(not above.strip() or is_sound(above) or is_sound(f"{above}\n{' ' * 40}u"))
    for text, option in offered(start, letters()).items():
        if len(text) == 1 or (option.kind == "connective" and text[-1] != " "):  # the others take values
            assert is_finishable(start + text), text


def is_finishable(text: str) -> bool:
    """Whether some words and closing brackets make a mission of it."""
    most = text.count("(")
    closing = [")" * brackets for brackets in range(min(most, 4) + 1)]
    endings = ("".join(parts) for parts in product(_OPERANDS, closing, _BODIES, closing))
    return not text.strip() or any(is_sound(text + ending) for ending in endings)


@pytest.mark.parametrize(
    ("text", "among"),
    [
        ("", ["move forward", "go to ", "if", "repeat", "wait "]),
        ("go to ", ["lab", "living room", "Alice", "cup"]),
        ("go to the l", ["lab", "lobby", "living room"]),
        ("go to the living ", ["room"]),
        ("pick up the red b", ["ball"]),
        ("Move Forward ", ["5 m", "at ", "then"]),
        ("move forward 2", ["2 m", "2 cm"]),
        ("move forward two ", ["m", "cm"]),
        ("move forward 2 m ", ["at ", "then", "within "]),
        ("wave with", ["within "]),
        ("wave until ", ["6 pm", "someone is near"]),
        ("at 8", ["8 am", "8 pm"]),
        ("every day at 8 ", ["am", "pm"]),
        ("at 8 p", ["pm"]),
        ("if it is after ", ["6 pm"]),
        ("wait until 8:15 ", ["am", "then"]),
        ("if the battery ", ["is low", "is full", "is not low"]),
        ("if battery is low ", ["wave", "and"]),
        ("if battery is low, ", ["wave", "someone is near"]),
        ("wave if ", ["not", "someone is near", "neither", "any of"]),
        ("if neither bumped ", ["nor"]),
        ("if neither bumped nor ", ["stuck"]),
        ("if any of bumped, ", ["stuck"]),
        ("if Alice and Bob ", ["are near", "is near"]),
        ("one of wave, ", ["nod"]),
        ("wave 3 ", ["times"]),
        ("(wave then nod", [" "]),
        ("(wave ", [")"]),
        ("try wave ", ["otherwise", "if possible"]),
        ("parade ", ["is ", "means "]),
        ("patrol is wave\npa", ["patrol"]),
        ("look far is someone is near\nwave if look ", ["far"]),
        ("say ", ['"hello"']),
        ("repeat:\n  wave\n  ", ["wave", "go to "]),
        ("while someone is near:\n  wave\n", ["otherwise", "go to "]),
        ("wave, please, then ", ["wave"]),
        ("wave ", ["called ", "with ", "giving "]),
        ("go to the lab wi", ["with "]),
        ("go to the lab with ", ["manner "]),
        ('do "PointAtPlace" ', ["with ", "called "]),
        ("do point at place with ", ["place ", "x "]),
        ('do point at place with place "lab", ', ["x ", "y "]),
        ('do "Choose" giving ', ["{output}"]),
        ('"Tour" is: wave\ndo ', ['"Tour"']),
        ("this mission is given {goal}, {path}\ngo to ", ["{goal}", "{path}", "lab"]),
        ("this mission is given {goal}, {path}\ngo to {", ["goal}", "path}"]),
        ("this mission ", ["is given {"]),
        ("this mission is gi", ["given {"]),
    ],
)
def test_offered(text: str, among: list[str]) -> None:
    found = offered(text)
    assert [option for option in among if option not in found] == [] or among == [" "]


@pytest.mark.parametrize(
    ("text", "absent"),
    [
        ("wave ", ["go to ", "battery is low", "not", ")"]),
        ("", ["and", "twice", "battery is low", "not", ")", "otherwise"]),
        ("if ", ["wave", "then"]),
        ("if bumped ", ["nor"]),
        ("wave then ", ["neither", "any of"]),
        ("wave and ", ["battery is low", "or"]),
        ("if battery is low and ", ["wave"]),
        ("go to the ", ["move forward", "is "]),
        ("flarp then ", ["wave"]),
        ('say "go to ', ["lab"]),
        ("patrol is wave\nwave if pa", ["patrol"]),
        ("wave nod ", ["then"]),
        ('do "GoTo" with ', ["is ", "means "]),
        ('do point at place with place "lab", ', ["place "]),
        ('wave called "first" ', ["called "]),
        ("wave then ", ["called ", "with "]),
        ("this mission is given {goal}\nwave ", ["{goal}"]),
        ("wave\nthis is ", ["given {"]),
    ],
)
def test_not_offered(text: str, absent: list[str]) -> None:
    found = offered(text)
    assert [option for option in absent if option in found] == []


@pytest.mark.parametrize(
    ("text", "corrected"),
    [("go to the ktichen", "kitchen"), ("mvoe", "move forward"), ("wave tehn", "then"), ("go to livng", "living room")],
)
def test_misspelt_words_are_corrected(text: str, corrected: str) -> None:
    option = offered(text)[corrected]
    assert option.spelling
    assert text[option.start :] == text.split()[-1]


def test_every_option_tells_what_it_is() -> None:
    kinds = {option.kind for text in ("", "wave ", "go to ", "if ") for option in completions(text, shipped())}
    assert kinds == {"command", "condition", "connective", "value"}
    assert offered("")["move forward"].help.startswith("Drives")


def test_words_that_stand_for_names_are_offered_once_they_are_begun() -> None:
    assert {"nearest person", "nearest object"} <= offered("look at the nea").keys()
    assert "place" in offered("go to a random ")
    assert "every person" in offered("wave at ev")


@pytest.mark.parametrize(
    "text", ["otherwise \n otherwise \n ", "wave\n meanwhile \n otherwise \n o", "again. again. a"]
)
def test_a_stop_before_a_word_that_goes_on_is_no_word(text: str) -> None:
    assert isinstance(completions(text, shipped()), tuple)
