"""What verbs with roles, described things, sets and constraints mean: each row of meaning.txt, and back again."""

from __future__ import annotations

from collections.abc import Iterator
from copy import copy
from pathlib import Path
from typing import Any

import pytest

import btlang
from btlang.frontends.mission import reader
from btlang.frontends.mission.tokens.lexer import Lexer
from btlang.text.source import Source
from btlang.tree.dump import plain
from btlang.vocabulary.cache import recent
from btlang.vocabulary.lexicon import Lexicon
from tests.profiles import amount, each_of

HERE = Path(__file__).parent
WORLD = str(HERE / "meaning.toml")
PARSERS = ("shunting-yard", "lark")


def rows(file: str) -> list[tuple[str, str]]:
    """Two lines a row, a sentence (lines of it end in `\\n`) and its tree, with comments and empty lines between."""
    text = (HERE / file).read_text(encoding="utf-8").splitlines()
    lines = [line for line in text if line and not line.startswith("#")]
    return [(said.replace("\\n", "\n"), tree) for said, tree in zip(lines[::2], lines[1::2], strict=True)]


def in_one_line(mission: btlang.Mission) -> str:
    """The tree with a mark for each level."""
    return " | ".join(plain(mission.tree).replace("  ", ">").splitlines())


FILES = (
    "meaning", "said", "users", "chosen", "outcomes", "attempts", "replies", "times", "waits", "counts", "carried",
    "order", "journeys",
)  # fmt: skip
ROWS = [row for file in FILES for row in rows(f"{file}.txt")]
SPOKEN, REFUSED = rows("spoken.txt"), [*rows("refused.txt"), *rows("unclear.txt")]


@pytest.fixture(scope="module", autouse=True)
def _words_are_read_once() -> Iterator[None]:
    """Both parsers read what the same lexer found, as does whoever reads back what English was tried."""
    latest = dict[tuple[str, int], Lexer]()

    def lexed(source: Source, vocabulary: Lexicon, **options: Any) -> Lexer:
        kept = recent(latest, (source.text, id(vocabulary)), lambda: Lexer(source, vocabulary, **options))
        lexer = copy(kept)
        lexer.tokens = [token.copy() for token in kept.tokens]  # which are changed as they are grouped
        return lexer

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(reader, "Lexer", lexed)
        yield


@each_of(ROWS, at_a_time=25)
def test_meaning(sentence: str, tree: str) -> None:
    missions = [btlang.parse_tree(sentence, world=WORLD, parser=parser) for parser in PARSERS]
    assert [in_one_line(mission) for mission in missions] == [tree.strip()] * 2


@each_of(ROWS[:: -(-len(ROWS) // amount(400, len(ROWS)))], at_a_time=20)
@pytest.mark.long
def test_every_form_keeps_the_meaning(sentence: str, tree: str) -> None:
    mission = btlang.parse_tree(sentence, world=WORLD)
    for form in ("xml", "json", "english"):
        text = str(mission.to(form))
        assert btlang.parse_tree(text, world=WORLD).tree == mission.tree, text


@each_of(SPOKEN, at_a_time=25)
def test_numbers_that_are_said(sentence: str, tree: str) -> None:
    missions = [btlang.parse_tree(sentence, world=WORLD, parser=parser) for parser in PARSERS]
    assert [in_one_line(mission) for mission in missions] == [tree.strip()] * 2


@each_of(SPOKEN[:: -(-len(SPOKEN) // amount(40, len(SPOKEN)))], at_a_time=20)
@pytest.mark.long
def test_every_form_keeps_numbers_that_are_said(sentence: str, tree: str) -> None:
    mission = btlang.parse_tree(sentence, world=WORLD)
    for form in ("json", "english"):
        assert btlang.parse_tree(str(mission.to(form)), world=WORLD).tree == mission.tree
    typed = btlang.parse_tree(str(mission.to("xml")), world=WORLD)
    assert btlang.parse_tree(str(typed.to("english")), world=WORLD).tree == typed.tree


@each_of(REFUSED, at_a_time=20)
def test_what_is_refused(sentence: str, code: str) -> None:
    for parser in PARSERS:
        with pytest.raises(btlang.MissionError) as refused:
            btlang.parse_tree(sentence, world=WORLD, parser=parser)
        assert next(each.code for each in refused.value.diagnostics if each.is_error) == code.strip()


def test_what_only_permits_is_noted() -> None:
    mission = btlang.parse_tree("go to the lab. Then you may go to the hall.", world=WORLD)
    assert [warning.code for warning in mission.warnings] == ["BT176"]


@pytest.mark.parametrize(
    ("sentence", "owners"),
    [
        ("bring me my plate", []),
        ("look at her plate", ["her"]),
        ("go to Alice and Bob, then take her plate", ["her"]),
        ("go to my room, then to Bob's room", []),
        ("take my book to his room", ["his"]),
    ],
)
def test_an_owner_whom_nobody_knows_is_noted(sentence: str, owners: list[str]) -> None:
    mission = btlang.parse_tree(sentence, world=WORLD)
    assert [warning.span.text for warning in mission.warnings if warning.code == "BT177"] == owners


def test_nobody_owns_anything_where_the_world_does_not_say_so() -> None:
    mission = btlang.parse_tree("bring me my cup, then go to Alice's cup")
    assert [warning.span.text for warning in mission.warnings] == ["my", "Alice's"]
    assert "owner" not in plain(mission.tree)


@pytest.mark.parametrize(
    ("sentence", "readings"),
    [
        (
            "put the book on the table in the box",
            ["put the book that is on the table in the box", "put the book on the table that is in the box"],
        ),
        ("put the book that is on the table in the box", []),
        ("put the book on the table that is in the box", []),
        ("put the book on the table near the sink", []),
        ("take the book on the table to the box", []),
        ("bring the book on the table to Alice", []),
    ],
)
def test_two_goals_in_a_row_show_both_readings(sentence: str, readings: list[str]) -> None:
    mission = btlang.parse_tree(sentence, world=WORLD)
    twice = [warning for warning in mission.warnings if warning.code == "BT050"]
    assert [text for warning in twice for _, text in warning.readings] == readings
    trees = [plain(btlang.parse_tree(text, world=WORLD).tree) for text in readings]
    assert trees == [] or (trees[0] == plain(mission.tree) != trees[1])


@pytest.mark.parametrize(
    ("sentence", "kept"),
    [
        (
            "if bumped, wave. If someone is near, nod. Otherwise dock",
            "if bumped, wave. If someone is near, nod, otherwise dock",
        ),
        (
            "if the lamp is on, switch it off. If it's off, switch it on",
            "if the lamp is on, switch it off. Then if it's off, switch it on",
        ),
        ("look for Alice for 5 minutes", "repeat (look for Alice) for 5 minutes"),
        ("if Alice is near wave, and if Bob is near nod", "if Alice is near, (wave, and if Bob is near nod)"),
        ("wave, or nod if Alice is near", "wave, or (nod if Alice is near)"),
        ("wave, or nod unless Alice is near", "wave, or (nod unless Alice is near)"),
        ("try to wave, then dock", "try to (wave, then dock)"),
    ],
)
def test_sentences_that_exclude_one_another_and_searches_show_both_readings(sentence: str, kept: str) -> None:
    mission = btlang.parse_tree(sentence, world=WORLD)
    (warning,) = (warning for warning in mission.warnings if warning.code == "BT050")
    taken, other = (btlang.parse_tree(dict(warning.arguments)[key], world=WORLD) for key in ("taken", "other"))
    assert plain(taken.tree) == plain(mission.tree) != plain(other.tree)
    mended = btlang.parse_tree(kept, world=WORLD)
    assert (plain(mended.tree), list(mended.warnings)) == (plain(mission.tree), [])


def run(sentence: str) -> btlang.Outcome:
    """The outcome of a mission on the simulated robot."""
    return btlang.parse_tree(sentence, world=WORLD).run(speed="max")


def test_a_closed_zone_is_driven_round() -> None:
    through, around = run("go to the lab"), run("go to the lab without entering the hall")
    assert through.succeeded
    assert around.succeeded
    assert around.seconds > through.seconds


@pytest.mark.parametrize(
    ("sentence", "reason"),
    [
        ("go to the kitchen, then (go to the hall without leaving the kitchen)", "outside the kitchen"),
        ("go to (10, 5) without entering the hall", "where the robot may not go"),
        ("pick up the red cup in the hall", "I know no red cup in the hall"),
        ("pick up three cups", "3 are needed"),
        ("look at every book near Alice", "book near Alice"),
        ("bring Alice my book", "a book that belongs to you"),
        ("pick up Bob's plate", "plate that belongs to Bob"),
        ("pick up the dirty blue plate", "dirty blue plate"),
        ("look at the plate on the small plate", "plate on the small plate"),
    ],
)
def test_what_cannot_be_done_says_why(sentence: str, reason: str) -> None:
    outcome = run(sentence)
    assert not outcome.succeeded
    assert reason in outcome.why()


def test_zones_open_again_however_their_statement_ends() -> None:
    assert run("try (go to (10, 5) without entering the hall). Go to the hall.").succeeded
    assert run("(go to the lab without entering the hall) within 1 s if possible. Go to the hall.").succeeded


@pytest.mark.parametrize(
    ("text", "tree"),
    [
        ("nod; wave until you can see Alice", "SeesPerson"),
        ("nod then stay with Bob", "Follow"),
        ("avoid the reading corner; wait 1 s; you may enter the reading corner", "OpenZone"),
        ("nod then wave or stay with Bob", "Wave"),
    ],
)
def test_what_sounds_like_a_permission_is_kept(text: str, tree: str) -> None:
    mission = btlang.parse_tree(text)
    assert tree in plain(mission.tree)
    assert "BT176" not in {warning.code for warning in mission.warnings}


@pytest.mark.parametrize("text", ["nod; if you are in the kitchen you may wave", "nod; if bumped, now you can wave"])
def test_what_is_permitted_after_a_condition_is_left_out(text: str) -> None:
    mission = btlang.parse_tree(text)
    assert plain(mission.tree).strip() == "Nod"
    assert [warning.code for warning in mission.warnings] == ["BT176"]


def test_what_describes_a_thing_is_no_definition() -> None:
    english = str(btlang.parse_tree("bring me a cup that isn't red; nod").to("english"))
    assert english.splitlines()[0] == "bring me cup that is not red"


@pytest.mark.parametrize(
    ("text", "warned"),
    [
        ("If the lab door is open, bring a cup to the lab. Put it in the hall.", ["Put it in the hall"]),
        ("Give Bob a cup, but only if he is in the lab. If he isn't, put it in the hall.", ["put it in the hall"]),
        ("If the lab door is open, bring a cup to the lab and put it in the hall.", []),
        ("If the lab door is open, bring a cup to the lab. Otherwise, put it in the hall.", []),
        ("Bring a cup to the lab, then if the lab door is open, put it in the hall.", []),
    ],
)
def test_what_is_chosen_in_one_branch_only_is_warned_of(text: str, warned: list[str]) -> None:
    warnings = btlang.parse_tree(text, world=WORLD).warnings
    assert [warning.span.text for warning in warnings if warning.code == "BT069"] == warned


@pytest.mark.parametrize(
    ("text", "codes"),
    [
        ("go to Alice. Ask her if she is done. If so, tell Bob that she can go home", ["BT050"]),  # Alice, or Bob
        ("wait for Alice. If she doesn't come, tell Bob that she is late", []),
        ("go to Alice. Ask her if she is done. If so, tell her that she can go home", []),
    ],
)
def test_who_may_be_meant_is_shown(text: str, codes: list[str]) -> None:
    assert [warning.code for warning in btlang.parse_tree(text, world=WORLD).warnings] == codes
