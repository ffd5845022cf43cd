"""Changes of missions by their trees, as the texts that come of them."""

from __future__ import annotations

import json

import pytest

from btlang.api import parse_tree
from btlang.diagnostics.diagnostic import MissionError
from btlang.editing.changes import apply_changes
from btlang.editing.edits import read_edit
from btlang.editing.palette import FORMS

from .edited import edited

TEA = """# Tea
patrol is go to the lobby then wave

Please go to the kitchen.  # where cups are
# take it
if battery is low:
  dock  # now
  charge
otherwise wave
Go to the lab, wave and say hello
repeat patrol 3 times
"""


def lines(old: str, new: str) -> str:
    """The lines that went, and those that came, without their common beginning and end."""
    before, after = old.split("\n"), new.split("\n")
    most = min(len(before), len(after))
    first = next((i for i in range(most) if before[i] != after[i]), most)
    last = next((i for i in range(most - first) if before[-1 - i] != after[-1 - i]), most - first)
    gone, come = before[first : len(before) - last], after[first : len(after) - last]
    return "\n".join([*(f"-{line}" for line in gone), *(f"+{line}" for line in come)])


CASES = {
    "a step goes, its comment stays": (
        {"do": "delete", "words": "go to the kitchen"},
        "-Please go to the kitchen.  # where cups are\n+# where cups are",
    ),
    "a part of a line goes": (
        {"do": "delete", "words": "wave", "nth": "2"},
        "-Go to the lab, wave and say hello\n+Go to the lab, say hello",
    ),
    "the first part of a line goes": (
        {"do": "delete", "words": "go to the lobby"},
        "-patrol is go to the lobby then wave\n+patrol is wave",
    ),
    "an otherwise goes": (
        {"do": "delete", "words": "wave", "nth": "1"},
        "-otherwise wave",
    ),
    "a step comes": (
        {"do": "insert", "words": "go to the kitchen", "given": "look around"},
        "+look around",
    ),
    "a step comes before a comment that belongs to the next one": (
        {"do": "insert", "words": "dock", "place": "before", "given": "say sorry"},
        "+  say sorry",
    ),
    "several steps come": (
        {"do": "insert", "words": "charge", "given": "wave, then undock"},
        "+  wave\n+  undock",
    ),
    "a condition comes": (
        {"do": "insert", "words": "battery is low", "given": "someone is near"},
        "-if battery is low:\n+if battery is low and someone is near:",
    ),
    "a part comes into a chain": (
        {"do": "insert", "words": "say hello", "given": "look around"},
        "-Go to the lab, wave and say hello\n+Go to the lab, wave and say hello and look around",
    ),
    "a step comes into a form": (
        {"do": "insert", "words": "repeat patrol 3 times", "place": "inside", "given": "wave"},
        "-repeat patrol 3 times\n+repeat patrol then wave 3 times",
    ),
    "one step in a retry": (
        {"do": "wrap", "words": "charge", "form": "retry", "given": "3"},
        "-  charge\n+  retry charge 3 times",
    ),
    "two steps in a retry": (
        {"do": "wrap", "words": "dock", "last": "charge", "form": "retry", "given": "3"},
        "-  dock  # now\n-  charge\n+  retry 3 times:\n+    dock  # now\n+    charge",
    ),
    "a step with a condition": (
        {"do": "wrap", "words": "go to the kitchen", "form": "unless", "given": "battery is low or someone is near"},
        "-Please go to the kitchen.  # where cups are\n+# where cups are\n"
        "+unless battery is low or someone is near, go to the kitchen",
    ),
    "parts of a line at the same time": (
        {"do": "wrap", "words": "go to the lobby", "last": "wave", "form": "in parallel"},
        "-patrol is go to the lobby then wave\n+patrol is go to the lobby and wave at the same time",
    ),
    "a condition that isn't so": (
        {"do": "wrap", "words": "battery is low", "form": "not"},
        "-if battery is low:\n+if not battery is low:",
    ),
    "a form goes": (
        {"do": "unwrap", "words": "repeat patrol 3 times"},
        "-repeat patrol 3 times\n+patrol",
    ),
    "a block goes, its lines stay": (
        {"do": "unwrap", "words": TEA[TEA.index("if") : TEA.index("\nGo")]},
        "-if battery is low:\n-  dock  # now\n-  charge\n-otherwise wave\n+dock  # now\n+charge\n+wave",
    ),
    "if becomes unless": (
        {"do": "turn", "words": TEA[TEA.index("if") : TEA.index("\nGo")]},
        "-if battery is low:\n+unless battery is low:",
    ),
    "steps the other way round": (
        {"do": "turn", "words": "go to the lobby then wave"},
        "-patrol is go to the lobby then wave\n+patrol is wave then go to the lobby",
    ),
    "another place": (
        {"do": "value", "words": "go to the kitchen", "port": "place", "given": "the dock"},
        "-Please go to the kitchen.  # where cups are\n+Please go to the dock.  # where cups are",
    ),
    "another count": (
        {"do": "value", "words": "repeat patrol 3 times", "port": "num_cycles", "given": "5"},
        "-repeat patrol 3 times\n+repeat patrol 5 times",
    ),
    "a step goes up, with its comments": (
        {"do": "move", "words": "go to the kitchen", "to": "repeat patrol 3 times"},
        "-Please go to the kitchen.  # where cups are\n-# take it\n-if battery is low:\n-  dock  # now\n-  charge\n"
        "-otherwise wave\n-Go to the lab, wave and say hello\n-repeat patrol 3 times\n"
        "+# take it\n+if battery is low:\n+  dock  # now\n+  charge\n"
        "+otherwise wave\n+Go to the lab, wave and say hello\n+repeat patrol 3 times\n"
        "+Please go to the kitchen.  # where cups are",
    ),
    "a step goes into a block": (
        {"do": "move", "words": "repeat patrol 3 times", "to": "charge", "place": "before"},
        "-  charge\n-otherwise wave\n-Go to the lab, wave and say hello\n-repeat patrol 3 times\n"
        "+  repeat patrol 3 times\n+  charge\n+otherwise wave\n+Go to the lab, wave and say hello",
    ),
    "a step twice": (
        {"do": "copy", "words": "charge", "to": "go to the kitchen"},
        "+charge",
    ),
    "a block gets a name": (
        {"do": "name", "words": "dock", "last": "charge", "given": "power up"},
        "-# take it\n-if battery is low:\n-  dock  # now\n-  charge\n+power up means:\n+  dock  # now\n+  charge\n"
        "+# take it\n+if battery is low:\n+  power up",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_texts(case: str) -> None:
    wanted, expected = CASES[case]
    given = {**wanted}
    if "nth" in given:
        given["nth"] = int(given["nth"])  # type: ignore[assignment]
    after = edited(TEA, **given)  # type: ignore[arg-type]
    assert lines(TEA, after.text) == expected
    assert apply_changes(TEA, [after.change]) == after.text
    assert after.start < after.end <= len(after.text) or given["do"] == "delete"


@pytest.mark.parametrize(
    ("text", "do", "words", "more", "expected"),
    [
        ("wave", "insert", "wave", {"given": "say hi"}, "wave\nsay hi"),
        ("wave.", "insert", "wave", {"given": "say hi", "place": "before"}, "say hi\nwave."),
        ("- wave\n- say hi\n", "delete", "wave", {}, "- say hi\n"),
        ("wave. Say hi. Nod.", "delete", "say hi", {}, "wave. Nod."),
        ("(wave then nod) twice", "insert", "nod", {"given": "say hi"}, "(wave then nod then say hi) twice"),
        ("in parallel:\n\twave\n\tsay ho\n", "insert", "wave", {"given": "look around"},
         "in parallel:\n\twave\n\tlook around\n\tsay ho\n"),
        ("in parallel:\n  wave\n  nod\nsay hi", "delete", "wave\n  nod", {}, "say hi"),
        ("wave\r\nnod\r\n", "insert", "wave", {"given": "say hi"}, "wave\r\nsay hi\nnod\r\n"),
        ("go to the lobby, the lab and the dock", "unwrap", "go to the lobby, the lab and the dock", {},
         "go to lobby\ngo to lab\ngo to dock"),
        ("wave. Do that 3 times.", "value", "wave. Do that 3 times", {"port": "num_cycles", "given": "4"},
         "wave. Do that 4 times."),
        ("wave twice", "value", "wave twice", {"port": "num_cycles", "given": "4"}, "wave 4 times"),
        ("say hi within 5 s", "value", "say hi within 5 s", {"port": "msec", "given": "1 minute"},
         "say hi within 1 minute"),
        ('say "it\'s # 1"  # yes', "wrap", 'say "it\'s # 1"', {"form": "retry", "given": "2"},
         '# yes\nretry say "it\'s # 1" 2 times'),
        ("if battery is low, dock. Otherwise wave.", "turn", "if battery is low, dock. Otherwise wave", {},
         "unless battery is low, dock. Otherwise wave."),
        ("turn left, then right", "move", "right", {"to": "turn left", "place": "before"},
         "turn right, then turn left"),
        ("wave if someone is near", "delete", "someone is near", {}, "BT220"),
        ("wave", "delete", "wave", {}, "BT220"),
        ("repeat wave twice", "move", "repeat wave twice", {"to": "wave", "place": "inside"}, "BT220"),
        ("set x to 3\nsay \"{x}\"", "delete", "set x to 3", {}, "BT043"),
        ("wave", "insert", "wave", {"given": "battery is low"}, "BT028"),
        ("wave", "insert", "wave", {"given": "dance a jig"}, "BT010"),
        ("wave", "insert", "wave", {"given": ""}, "BT220"),
        ("wave", "wrap", "wave", {"form": "within", "given": "red"}, "BT220"),
        ("wave", "wrap", "wave", {"form": "sideways"}, "BT220"),
        ("wave", "name", "wave", {"given": "then"}, "BT010"),
        ("go to the lab then dock", "wrap", "go to the lab", {"last": "dock", "form": "in parallel"}, "BT041"),
    ],
)  # fmt: skip
def test_other_texts(text: str, do: str, words: str, more: dict[str, str], expected: str) -> None:
    if expected.startswith("BT"):
        with pytest.raises(MissionError) as error:
            edited(text, do, words, **more)  # type: ignore[arg-type]
        assert error.value.diagnostics[0].code == expected
    else:
        assert edited(text, do, words, **more).text == expected  # type: ignore[arg-type]


@pytest.mark.parametrize("form", FORMS)
def test_every_form_that_is_put_round_something_can_go_again(form: str) -> None:
    needs = {"condition": "someone is near", "count": "2", "duration": "5 s", "time_of_day": "6 pm"}
    text, first, last = "nod\nwave\nlook around\nsay hi\n", "wave", "look around"
    if FORMS[form].of_conditions:
        text, first = (
            "wait until battery is low or bumped\nwait until holding the cup and path is clear",
            "battery is low",
        )
        first, last = {"not": (first, ""), "all of": (first, "bumped")}.get(form, ("holding the cup", "path is clear"))
    elif form == "whenever":
        first, last = "nod", ""
    elif form == "in sequence":
        text = "in parallel:\n  say hi\n  wave\n  look around\n"
    wrapped = edited(text, "wrap", first, last=last, form=form, given=needs.get(FORMS[form].needs, ""))
    assert wrapped.text != text
    again = edited(wrapped.text, "unwrap", wrapped.text[wrapped.start : wrapped.end])
    if form not in ("in sequence", "all of", "any of"):  # whose parts go into what is around it
        assert parse_tree(again.text).tree == parse_tree(text).tree


@pytest.mark.parametrize(
    "data",
    [
        None, [], "x", {}, {"do": "delete"}, {"do": "delete", "node": "1"}, {"do": "delete", "node": True},
        {"do": 3, "node": 0}, {"do": "delete", "node": 0, "other": 1}, {"do": "delete", "node": 1.5},
        {"do": "delete", "node": 0, "words": None}, {"do": "delete", "node": 0, "do\n": "x"},
    ],
)  # fmt: skip
def test_what_is_no_edit(data: object) -> None:
    with pytest.raises(MissionError, match="BT220"):
        read_edit(json.loads(json.dumps(data)))
