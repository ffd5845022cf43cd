"""`btc words` and help on words: all that can be said is listed, and every example does what it says."""

from __future__ import annotations

from pathlib import Path

import pytest

import btlang
from btlang.api import parse_tree
from btlang.engine.status import FAILURE, SKIPPED, SUCCESS
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.vocabulary.items import items
from btlang.vocabulary.language_tables import EXPLAINED, ROLES
from btlang.vocabulary.listing import help_on, listing, overview
from btlang.vocabulary.load import load_vocabulary
from btlang.vocabulary.pattern import forms

VOCABULARY = world_vocabulary()
ITEMS = items(VOCABULARY)
EXAMPLES = {item.names[0]: item.example for item in ITEMS if item.sort in ("command", "word")}
CONDITIONS = {item.names[0]: item.example for item in ITEMS if item.sort == "condition"}
WHOLE = "\n".join(listing(VOCABULARY))

# What cannot succeed where the robot starts: why it fails there, and the command after which it succeeds.
NEEDS = {
    "CloseHand": ("nothing is within reach of the right hand", "approach the cup"),
    "CloseLeftHand": ("nothing is within reach of the left hand", "approach the cup"),
    "Grasp": ("the cup is not within reach of the right hand", "approach the cup"),
    "Release": ("the robot isn't holding the cup", "pick up the cup"),
    "PutDown": ("the robot isn't holding the cup", "pick up the cup"),
    "WaitForPerson": ("Alice didn't come", "go to Alice"),
    "WaitForSomeone": ("nobody came", "go to Alice"),
    "TakePictureOfPerson": ("I don't see Alice", "go to Alice"),
    "TakePictureOfObject": ("I don't see the cup", "approach the cup"),
    "speaking": ("I don't see anybody", "go to Alice"),
    "Ask": ("Alice didn't answer", "go to Alice"),
    "ComeToMe": ("I see nobody", "go to Alice"),
    "LookAtObject": ("the cup is behind the robot; the head can't turn that far", "face the cup"),
}
UNKNOWN_AT_THE_START = {"Answer", "Count", "Counted", "CountedNames"}
"""Nobody has been asked, and nothing counted."""
HOLDS_AT_THE_START = {
    "HandEmpty", "PathClear", "BatteryFull", "DistanceAhead", "DistanceToPlace", "DistanceToPerson", "DistanceToObject",
    "PeopleNear", "BatterySufficient", "DoorOpen", "PlaceOfPerson", "PlaceOfObject", "SwitchedOn", "TodayIs",
    "ObjectKnown", "NobodyAnswered", "ObjectsAt", "DayOfWeek",
}  # fmt: skip


def outcome(text: str) -> tuple[int, str]:
    """How a mission ends and why it failed; it compiles without a warning and ends by itself."""
    tree = parse_tree(text)
    # whom it asks is where it is, what it compares was counted, and what it checks is known
    assert {warning.code for warning in tree.warnings} <= {
        "BT068",
        "BT146",
        "BT149",
        "BT254",
    }  # `wave if somebody says stop`
    ended = tree.run(speed="max", time_limit=120)
    assert not ended.stopped
    return ended.status, ended.failure.reason if ended.failure else ""


@pytest.mark.parametrize(("name", "example"), EXAMPLES.items(), ids=list(EXAMPLES))
def test_examples_run(name: str, example: str) -> None:
    if name in ("ListenFor", "ListenForYesOrNo", "Obey"):
        assert outcome(example) == (FAILURE, "nobody answered")
        return
    if name in NEEDS:
        reason, first = NEEDS[name]
        assert outcome(example) == (FAILURE, reason)
        example = f"{first} then {example}"
    assert outcome(example) == (SUCCESS, "")


@pytest.mark.parametrize(("name", "example"), CONDITIONS.items(), ids=list(CONDITIONS))
def test_examples_of_conditions_are_asked(name: str, example: str) -> None:
    assert outcome(f"check that {example}")[0] == (SUCCESS if name in HOLDS_AT_THE_START else FAILURE)
    denied = FAILURE if name in UNKNOWN_AT_THE_START else SKIPPED
    assert outcome(f"wave if {example}")[0] == (SUCCESS if name in HOLDS_AT_THE_START else denied)


def test_everything_has_its_topic_help_and_example() -> None:
    said = [item for item in ITEMS if item.sort != "value"]
    phrased = {node_id for node_id, entries in VOCABULARY.entries.items() if entries[0].phrases}
    assert VOCABULARY.entries.keys() - phrased == {"Choose", "ChooseAll"}
    assert {name for item in said for name in item.names} == {*phrased, *EXPLAINED}
    for item in said:
        assert item.topic not in ("", "other", "other words"), item
        assert item.help.endswith("."), item
        assert item.example, item


def test_examples_of_words_use_their_words() -> None:
    for role in (ROLES.keys() & EXPLAINED) - {
        "include",
        "needs_world",
        "needs_words",
        "needs_robot",
    }:  # these need a file
        about, [item] = VOCABULARY.about[role], [item for item in ITEMS if item.names == (role,)]
        words = {word for way in item.ways for form in forms(way) for word in form}
        assert words & set(about.example.replace(",", "").lower().split()), role


def test_topics_come_in_order() -> None:
    heads = [line[:-1] for line in WHOLE.splitlines() if line.endswith(":") and not line.startswith(" ")]
    assert heads[:7] == ["motion", "navigation", "manipulation", "gestures", "speech", "sensing", "power"]
    assert heads[7:] == [
        *("joining", "conditions", "repeating", "timing", "trying", "names", "politeness"),
        *("nodes", "values", "the world"),
    ]


def test_lines_fit_a_terminal() -> None:
    assert max(map(len, WHOLE.splitlines())) <= 80


def test_entries_of_the_list() -> None:
    assert (
        "  patrol {place} [{manner}]\n      Drives to a place and turns once around. For example: patrol the lobby\n"
    ) in WHOLE
    assert "  battery is low  (condition)\n" in WHOLE
    assert "  retry, retry to, keep trying to, keep trying\n" in WHOLE
    places = "  {place}     dock, door, hall, kitchen, lab, living room, lobby, office,\n              reading corner\n"
    assert places in WHOLE + "\n"
    assert "  {duration}  a number and one of s, ms, min, h\n" in WHOLE


def heads(lines: list[str]) -> list[str]:
    """The first lines of what is listed, without topics."""
    return [line.strip() for line in lines if line.startswith("  ") and not line.startswith("   ")]


@pytest.mark.parametrize(
    ("search", "found"),
    [
        ("print", ["print {text}"]),
        ("battery low", ["battery is low  (condition)"]),
        ("Battery LOW", ["battery is low  (condition)"]),
        ("Undock", ["undock"]),
        ("recharge", ["charge [to {percent}]"]),
        ("twice", ["twice"]),
        ("retry", ["try [it/that/this] again", "retry"]),
        (
            "kitchen",
            [
                "{place}     dock, door, hall, kitchen, lab, living room, lobby, office,",
                "{zone}      hall, kitchen, lab, living room, lobby, office, reading corner",
                "{door}      kitchen door",
            ],
        ),
        ("spot towards person", ["face {person}"]),
        ("round robin", ["do"]),
        (
            "count",
            [
                "count to {number}",
                "count people [in {place}]",
                "count objects [in {place}]",
                "count {kinds} [in {place}]",
                "there are fewer than {below}  (condition)",
                "last count is below {value}  (condition)",
                "names of those counted is below {value}  (condition)",
                "twice, thrice, forever, endlessly, over and over, again and again, in loop,",
                "{count}     a whole number from 1 on",
                "{counted}   objects, people",
            ],
        ),
    ],
)
def test_search(search: str, found: list[str]) -> None:
    assert heads(listing(VOCABULARY, search)) == found


def test_of_little_all_is_told() -> None:
    assert listing(VOCABULARY, "undock") == ["power:", *("  " + line for line in help_on(VOCABULARY, "undock"))]
    assert "needs: voice" not in "\n".join(listing(VOCABULARY, "speech"))


def test_conditions_are_found_by_their_sort() -> None:
    found = heads(listing(VOCABULARY, "conditions"))
    assert len([line for line in found if line.endswith("  (condition)")]) == len(CONDITIONS)
    assert "unless, except if, except when, but not if/when/while, except while" in found
    assert "go to {place}" not in found


@pytest.mark.parametrize(
    ("search", "near"),
    [("wvae", "wave"), ("kichen", "kitchen"), ("move forwrd", "forward"), ("manipluation", "manipulation")],
)
def test_the_nearest_words_are_offered(search: str, near: str) -> None:
    first, second = listing(VOCABULARY, search)
    assert first == f"No phrase has the words: {search}"
    assert near in second.removeprefix("Similar: ").split(", ")
    assert help_on(VOCABULARY, search) == [first, second]


def test_help_on_a_phrase_tells_all() -> None:
    expected = """\
charge [to {percent}]
    Docks and waits until the battery is full or reaches the percentage.
    also: charge/recharge [up] [to [at least] {percent}]
          charge/recharge battery [[up] to {percent}]
          charge/recharge [fully] until full
          charge/recharge [fully] until it is full/charged
          charge/recharge [fully] until you are full/charged
          charge/recharge [fully] until robot is full/charged
          charge/recharge yourself
          charge/recharge fully
          charge/recharge completely
          go/get back to charging
          return to charging
          start charging
          charge/recharge until battery is [at [least]] {percent} [full]
          charge/recharge until it/you is/are [at [least]] {percent} [full]
          charge/recharge until it/battery/you reaches/reach {percent}
    {percent}: a number and one of %; 100% if left out
    needs: base
    node: Charge
    for example: charge to 80%"""
    for text in ("charge", "Charge", "charge to 50%", "recharge the battery", " charge  then wave"):
        assert "\n".join(help_on(VOCABULARY, text)) == expected, text


@pytest.mark.parametrize(
    ("text", "firsts"),
    [
        (
            "go to",
            [
                "go to {place} [through {via}] [{manner}]",
                "go to {person} [{manner}]",
                "approach {object} [{manner}]",
                "go to {door} [{manner}]",
                "go to {side} {place} [{manner}]",
            ],
        ),
        ("wall in front", ["wall in front  (condition)"]),
        (
            "after",
            [
                "after",
                "after {duration}",
                "stop after {count}",
                "[all night/day/morning/afternoon/evening [,]] between {time_of_day}",
            ],
        ),
        (
            "wait for",
            [
                "wait [for] {duration}",
                "wait for",
                "wait [for] up to {duration} until/till/for",
                "wait until {time_of_day}",
            ],
        ),
        ("and at the same time", ["meanwhile"]),
        ("is", ["is below {value}", "is"]),
        ("define_strong", ["means"]),
        ("forever", ["twice"]),
        ("3 times", ["twice"]),
        ("{duration}", ["  {duration}  a number and one of s, ms, min, h"]),
        ("then wave", ["then"]),
        ("speech", ["speech:"]),
    ],
)
def test_help_finds(text: str, firsts: list[str]) -> None:
    blocks = "\n".join(help_on(VOCABULARY, text)).split("\n\n")
    assert [block.splitlines()[0] for block in blocks] == firsts


def test_the_overview_counts_what_each_topic_lists() -> None:
    first, *lines, more, last = overview(VOCABULARY)
    assert first == "What you can say, by topic:"
    assert len(lines) <= 20
    assert max(map(len, lines)) <= 80
    assert [line[2:16].strip() for line in lines] == list(dict.fromkeys(item.topic for item in ITEMS))
    for line in lines:
        topic, count = line[2:16].strip(), int(line[16:18])
        assert count == sum(item.topic == topic for item in ITEMS)
    assert "  joining       29  then, and, but, or, one of, at the same time, after, ..." in lines
    assert f"{more} {last}" == (
        "btc words motion lists a topic, btc words battery finds a word, btc words --all lists everything."
    )


@pytest.mark.parametrize("text", ["((", '"', "\0", "\n", "{", "then", "   (", "#", "é", "1" * 400])
def test_any_text_gets_an_answer(text: str) -> None:
    for lines in (help_on(VOCABULARY, text), listing(VOCABULARY, text)):
        assert lines
        assert all(line.isprintable() for line in lines)


def test_packs_and_functions_are_listed(tmp_path: Path) -> None:
    pack = tmp_path / "band.toml"
    pack.write_text(
        '[[type]]\nname = "song"\nvalues = ["la paloma", "yesterday"]\n'
        '[[action]]\nphrase = "play {song}"\nid = "Play"\ntopic = "music"\nhelp = "Plays."\n'
        '[roles]\nthen = ["und"]\nand = ["as well as"]\n'
        '[about]\nthen = { topic = "zusammen", help = "Danach.", example = "wave und nod" }\n',
        encoding="utf-8",
    )

    @btlang.action("cheer")
    def cheer() -> None:
        """Cheers
        aloud."""

    vocabulary = load_vocabulary([str(pack), cheer])
    lines = listing(vocabulary)
    topics = [line for line in lines if line.endswith(":") and not line.startswith(" ")]
    assert topics[7:11] == ["music:", "other:", "zusammen:", "joining:"]
    assert listing(vocabulary, "cheer") == ["other:", "  cheer", "      Cheers aloud.", "      node: Cheer"]
    assert "    {song}: la paloma, yesterday" in help_on(vocabulary, "Play")
    assert "  {song}      la paloma, yesterday" in lines
    assert "  {place}     nothing in this world" in lines
    assert listing(vocabulary, "danach")[1:] == ["  und", "      Danach.", "      for example: wave und nod"]
    assert vocabulary.about["and"].help == VOCABULARY.about["and"].help
    assert vocabulary.about["and"].example == ""


def test_a_verb_is_listed_once_with_its_roles() -> None:
    lines = listing(VOCABULARY, "navigation")
    assert "  go to {place}, to {person}, to {door} or into {zone} [through {via}]" in lines
    assert "  find {person} or {object} [in {place}]" in lines
    said = heads(listing(VOCABULARY))
    verbs = [(item.topic, item.verb) for item in ITEMS if item.verb]
    of_several = [item for item in ITEMS if verbs.count((item.topic, item.verb)) > 1]
    assert len(of_several) > 5
    assert {item.ways[0] for item in of_several}.isdisjoint(said)


def test_a_word_of_many_ways_is_listed_with_those_that_were_searched_for() -> None:
    lines = listing(VOCABULARY, "last")
    assert "  then, [and] at last, [and] when/once/after you've" in lines
    assert not any("afterwards" in line for line in lines)
    assert len(listing(VOCABULARY, "count")) < 50


def test_a_quantity_says_how_it_becomes_a_value() -> None:
    assert "      as a value: remember last count as ..., then {...} in a text" in listing(VOCABULARY, "last count")
