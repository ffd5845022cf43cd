"""Signs of comparisons in missions: the message says the words, and nothing that follows from the sign."""

from __future__ import annotations

import pytest

import btlang
from btlang.diagnostics.diagnostic import Diagnostic, apply_fixes
from btlang.text.source import Source


def problems(text: str) -> tuple[Diagnostic, ...]:
    with pytest.raises(btlang.MissionError) as raised:
        btlang.parse_tree(text)
    return tuple(raised.value.diagnostics)


def problems_of(source: Source) -> tuple[Diagnostic, ...]:
    try:
        btlang.parse_tree(source.text)
    except btlang.MissionError as error:
        return tuple(problem.replace(fix=_in(source, problem)) for problem in error.diagnostics)
    return ()


def _in(source: Source, problem: Diagnostic):  # type: ignore[no-untyped-def]
    if problem.fix is None:
        return None
    span, words = problem.fix
    return span.replace(source=source), words


@pytest.mark.parametrize(
    ("wrong", "right"),
    [
        ("if battery < 30%, charge", "if battery is below 30%, charge"),
        ("whenever the battery is <= 30%, wave. nod", "whenever the battery is at most 30%, wave. nod"),
        ("if the battery is = 30%, wave", "if the battery is exactly 30%, wave"),
        ("if battery>30% then wave", "if battery is above 30% then wave"),
        ("wait until battery == 50%", "wait until battery is 50%"),
        ("if the distance to Alice ≥ 2 m, wave", "if the distance to Alice is at least 2 m, wave"),
        ("if battery > 20% and battery < 40%, wave", "if battery is above 20% and battery is below 40%, wave"),
    ],
)
def test_the_words_for_a_sign_are_the_correction(wrong: str, right: str) -> None:
    assert {problem.code for problem in problems(wrong)} == {"BT250"}
    source = Source(wrong, "<text>")
    assert apply_fixes(source, problems_of)[0].text == right


@pytest.mark.parametrize("text", ["if battery < 30%, frobnicate", "if 30% > battery, wave", "say a<b", "count = 5"])
def test_no_correction_that_cannot_be_read(text: str) -> None:
    [sign] = [problem for problem in problems(text) if problem.code == "BT250"]
    assert sign.fix is None
    assert sign.hint.endswith("For example: the battery is below 30%")


def test_other_mistakes_stay() -> None:
    assert [p.code for p in problems("if battery < 30%, frobnicate")] == ["BT250", "BT010"]
    assert [p.code for p in problems("if battery < 30%, wave\nfrobnicate")] == ["BT250", "BT010"]
    assert [p.code for p in problems("wals = []")] == ["BT010", "BT250", "BT003"]
    assert [p.code for p in problems("if the battery @ 5%, wave")][-1:] != ["BT250"]
