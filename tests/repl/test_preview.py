"""What is shown of an entry while it is typed."""

from __future__ import annotations

import pytest
from hypothesis import given

from btlang.repl.draft import MissionDraft
from btlang.repl.preview import continuations, preview
from tests.language.sentences import broken_missions, english
from tests.profiles import searches

SESSION = MissionDraft()


@pytest.mark.parametrize(
    "text",
    ["go to the ", "go to", "mo", "move forward 2", "wave then ", "if ", "if battery is lo", "(wave then nod",
     'say "he', "repeat:", "repeat:\n  wa", "patrol is ", "wave within 5 "],
)  # fmt: skip
def test_a_beginning_is_no_mistake(text: str) -> None:
    assert preview(SESSION, text).unfinished


@pytest.mark.parametrize(
    "text", ["go to the ktichen", "flarp", "wave nod", "wave then then", "go to the ktich then wave and ", "wave))"]
)
def test_a_mistake_is_told_at_once(text: str) -> None:
    seen = preview(SESSION, text)
    assert not seen.unfinished
    assert any(name == "error" for _, _, name in seen.marks)


def test_the_tree_of_an_entry() -> None:
    assert str(preview(SESSION, "wave then nod").tree) == "Sequence\n├── Wave: wave\n└── Nod: nod"
    assert str(preview(SESSION, "bow is nod").tree) == "bow:\nNod: nod"
    assert preview(SESSION, "  ").tree is None


def test_the_tree_so_far() -> None:
    for more in ("", " th", " then ", " then wa", " then (no", " and if ", " then flarp"):
        assert str(preview(SESSION, f"wave then nod{more}").tree).startswith("Sequence\n├── Wave: wave"), more


def test_marks() -> None:
    assert preview(SESSION, "bow is nod and wave").marks == ((0, 6, "name"), (11, 14, "connective"))


def test_names_of_the_session_are_offered() -> None:
    draft = MissionDraft()
    draft.add(draft.compile("bow is nod").entry)
    (offer,) = (option for option in continuations(draft, "wave then bo") if option.kind == "name")
    assert (offer.text, offer.start) == ("bow", 10)


@searches(6, 1000, deadline=None)
@given(broken_missions().map(english))
def test_any_text_has_a_preview(text: str) -> None:
    seen = preview(SESSION, text)
    assert seen.errors or seen.tree or not text.strip()
    for start, end, _ in seen.marks:
        assert 0 <= start <= end <= len(text) + 1
    continuations(SESSION, text)
