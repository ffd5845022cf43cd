"""`btc words rooms`: the names of the world that are searched for."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from btlang.cli import main
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.robots.worlds.name_listing import list_words
from btlang.vocabulary.listing import listing
from tests.profiles import searches

HOUSE = world_vocabulary()
ROOMS = ("lobby", "hall", "kitchen", "lab", "office", "living room")


def names(search: str, language: str = "en") -> tuple[str, ...]:
    """The names that the first lines have."""
    vocabulary = HOUSE if language == "en" else world_vocabulary(language=language)
    first = " ".join(list_words(vocabulary, search, width=1000)[0].split())
    begin, _, found = first.partition(" in this world: ")
    return tuple(found.removesuffix(".").split(", ")) if begin == f"The names for '{search}'" else ()


@pytest.mark.parametrize(
    ("search", "found"),
    [
        ("rooms", ROOMS),
        ("room", ROOMS),
        ("places", (*ROOMS, "door", "dock", "reading corner")),
        ("place", (*ROOMS, "door", "dock", "reading corner")),
        ("people", ("Alice", "Bob", "Carol")),
        ("zones", ("reading corner", *ROOMS)),
        ("doors", ("kitchen door",)),
        ("things", ("cup", "bottle", "book", "red ball", "light")),
        ("red things", ("red ball",)),
        *((word, ()) for word in ("battery", "the world", "conditions", "every", "to", "5 m", "", '"', "rooms rooms")),
    ],
)
def test_the_names_of_a_type_or_kind(search: str, found: tuple[str, ...]) -> None:
    assert names(search) == found


def test_the_names_in_another_language() -> None:
    assert names("personas", "es") == ("Alice", "Bob", "Carol")


def test_what_can_be_said_follows_words_that_are_said_too() -> None:
    for search in ("place", "cup", "room"):
        assert list_words(HOUSE, search)[-3:] == listing(HOUSE, search)[-3:]
    assert list_words(HOUSE, "rooms")[-1] == "btc words place lists what can be said about them."
    assert list_words(HOUSE, "red things", command="words")[-1] == "words object lists what can be said about it."
    assert list_words(HOUSE, "battery") == listing(HOUSE, "battery")


_WORDS = st.lists(st.sampled_from(["every", "2", "rooms", "red", "#", "and", '"'])).map(" ".join)


@searches(25, 5000)
@given(st.text(max_size=20) | _WORDS)
def test_any_search_gets_an_answer(search: str) -> None:
    assert list_words(HOUSE, search)


def test_the_command_line(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    world = tmp_path / "world.toml"
    world.write_text('start = { x = 1, y = 1 }\nplaces = [{ name = "bay", x = 2, y = 2 }]\n', encoding="utf-8")
    assert main(["words", "places", "--world", str(world)]) == 0
    assert "The names for 'places' in this world: bay.\n" in capsys.readouterr().out
