"""Both readings that a warning shows are readings: one is what the sentence means, brackets in it give the other."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import combinations
from typing import NamedTuple

from hypothesis import example, given, reject
from hypothesis import strategies as st

from btlang.diagnostics.diagnostic import Diagnostic, MissionError
from btlang.frontends.mission.reader import read_mission
from btlang.passes import compile_mission
from btlang.passes.compilation import Compilation
from btlang.passes.lint.two_readings import find_two_readings
from btlang.printer.mission import english
from btlang.text.source import Source
from btlang.tree.node import Node, Tree
from tests.language.letters import letters
from tests.language.sentences import commands, missions
from tests.language.sentences import english as text_of
from tests.printer.trees import missions as trees
from tests.profiles import searches

_joints = st.sampled_from(["and", "or", "then", "after", ",", ", and", ", or", ", then", "otherwise"])
_behind = st.sampled_from(["3 times", "for 5 s", "if possible", "until p", "unless p and q or r", "within 9 s"])
_plain = st.sampled_from("uvwxyz")
_parts = st.one_of(
    _plain,
    _plain,
    st.tuples(_plain, _behind).map(" ".join),
    st.tuples(st.sampled_from(["if p,", "if p or q and r,", "repeat", "try"]), _plain).map(" ".join),
)
crowded = st.lists(st.tuples(_joints, _parts), min_size=2, max_size=4).map(
    lambda drawn: " ".join(word for pair in drawn for word in pair).partition(" ")[2]
)
"""Sentences with many connectives and few brackets; not all of them can be read."""


class Read(NamedTuple):
    """A mission, its tree and its warnings of two readings."""

    subject: Compilation
    tree: Tree
    warnings: list[Diagnostic]


def read(text: str) -> Read:
    mission = read_mission(Source(text), letters()).mission
    tree = compile_mission(mission, letters())
    subject = Compilation(letters(), mission, tree)
    return Read(subject, tree, list(find_two_readings(subject)))


def found_in(text: str) -> Read:
    """As `read`, of a text that a test draws."""
    try:
        return read(text)
    except MissionError:
        reject()


def root(text: str) -> Node | None:
    """The tree of a command or condition; None where it is neither."""
    for attempt in (text, f"check {text}"):
        try:
            return read(attempt).tree.root
        except MissionError:
            pass
    return None


def shown(warning: Diagnostic) -> tuple[str, str]:
    arguments = dict(warning.arguments)
    return arguments["taken"], arguments["other"]


def with_brackets(text: str) -> Iterator[str]:
    """The text with one pair of brackets more, everywhere."""
    places = sorted({place for word in re.finditer(r"\w+", text) for place in word.span()})
    for start, end in combinations(places, 2):
        yield f"{text[:start]}({text[start:end]}){text[end:]}"


@searches(25, 1500, deadline=None)
@given(trees(), st.sampled_from(["clear", "all"]))
def test_what_is_said_with_more_brackets_has_one_reading(mission: object, brackets: str) -> None:
    assert read(english(mission, letters(), brackets=brackets)).warnings == []  # type: ignore[arg-type]


@searches(60, 4000, deadline=None)
@given(missions.map(text_of))
@example("u after v and w")
@example("u and v after w")
@example("u then v after w and x")
@example("u, v and w then x twice")
def test_the_sentence_has_the_first_one(text: str) -> None:
    found = found_in(text)
    for warning in found.warnings:
        taken, other = shown(warning)
        if " ... " not in taken + other:
            assert root(taken) != root(other)
            assert root(taken) is not None
            assert root(other) is not None


@searches(60, 4000, deadline=None)
@given(st.one_of(crowded, missions.map(text_of)))
def test_the_fix_keeps_the_tree_and_ends_the_warning(text: str) -> None:
    found = found_in(text)
    for warning in found.warnings:
        if warning.fix is not None:
            span, words = warning.fix
            mended = read(text[: span.start] + words + text[span.end :])
            assert mended.tree == found.tree
            assert len(mended.warnings) <= len(found.warnings)
            assert shown(warning) not in [shown(other) for other in mended.warnings if other.span == warning.span]


@searches(50, 3000, deadline=None)
@given(st.one_of(crowded, commands.map(text_of)))
@example("u then v and w")
@example("u after v and w")
@example("u and v after w")
@example("u, v then w and x")
@example("u then v and w after x")
@example("u and v until p, w, and x")
@example("u then v 3 times within 9 s")
@example("try u, then v and w")
@example("u, or v unless p")
@example("if p, if q, u otherwise v")
@example("if p, u and repeat if q, v otherwise w")
def test_brackets_give_the_other_one(text: str) -> None:
    for warning in found_in(text).warnings:
        taken, other = shown(warning)
        words = warning.span.text
        assert root(words) == root(taken)
        if len(words.split()) <= 10:
            meant = root(other)
            assert any(root(attempt) == meant for attempt in with_brackets(words))
