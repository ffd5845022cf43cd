"""Phrase patterns: what each part means, and what is refused."""

from __future__ import annotations

import pytest

from btlang.vocabulary.pattern import PatternError, Slot, forms


def ways(pattern: str) -> set[str]:
    return {" ".join(f"{{{p.name}}}" if isinstance(p, Slot) else p for p in form) for form in forms(pattern)}


@pytest.mark.parametrize(
    ("pattern", "expected"),
    [
        ("wave", {"wave"}),
        ("Go Home", {"go home"}),
        ("item(s)", {"item", "items"}),
        ("turn/rotate left", {"turn left", "rotate left"}),
        ("wall (is) ahead", {"wall ahead", "wall is ahead"}),
        ("wave [at {person}]", {"wave", "wave at {person}"}),
        ("move [by] [{distance}]", {"move", "move by", "move {distance}", "move by {distance}"}),
        ("a [b [c]]", {"a", "a b", "a b c"}),
        (r"price \(net\)", {"price (net)"}),
        ("go forward(s)/ahead", {"go forward", "go forwards", "go ahead"}),
    ],
)
def test_forms(pattern: str, expected: set[str]) -> None:
    assert ways(pattern) == expected


def test_articles_are_left_out() -> None:
    assert forms("go to the {place}", frozenset(["the"])) == forms("go to {place}")


@pytest.mark.parametrize(
    ("pattern", "reason"),
    [
        ("", "no required word"),
        ("[wave]", "no required word"),
        ("wave [at", "without"),
        ("wave at]", "without"),
        ("wave {at", "not closed"),
        ("wave {to whom}", "one word in braces"),
        ("wave //", "empty"),
        ("a/b/c/d/e a/b/c/d/e a/b/c/d/e a/b/c/d/e", "more than 500 ways"),
    ],
)
def test_refused(pattern: str, reason: str) -> None:
    with pytest.raises(PatternError, match=reason):
        forms(pattern)
