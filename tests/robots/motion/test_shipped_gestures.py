"""The gestures of the guide: its body can do all of them, and the missions of the museum find theirs."""

from __future__ import annotations

from functools import cache

import pytest

from btlang.robots.bodies.body import Body
from btlang.robots.bodies.body_file import load_body
from btlang.robots.preflight import said_gesture
from btlang.robots.simulation.rehearsal import rehearse
from btlang.speech.marks import read_marks
from tests.robots.motion.bodies import GUIDE

STAYS = ("look at",)  # at what it looks at


@cache
def shipped() -> Body:
    return load_body(str(GUIDE))


def test_thirty_gestures_ship() -> None:
    assert len({gesture.file for gesture in shipped().gestures.values()}) >= 30


@pytest.mark.parametrize("name", sorted(shipped().gestures))
def test_the_body_can_do_it(name: str) -> None:
    gesture = shipped().gestures[name]
    rehearsal = rehearse(shipped(), gesture)
    assert (rehearsal.problem, rehearsal.slower) == ("", 1.0)
    assert gesture.help
    assert 0.5 < rehearsal.seconds < 4.5
    if name not in STAYS:
        assert max(map(abs, rehearsal.angles[-1].values())) < 0.01


@pytest.mark.parametrize("aim", [(3.0, 0.5), (2.0, -2.0), (1.0, 2.0), (0.3, -2.0), (4.0, 3.0)])
def test_it_points_to_both_sides(aim: tuple[float, float]) -> None:
    rehearsal = rehearse(shipped(), shipped().gestures["point at"], aim)
    assert rehearsal.problem == ""
    assert max(map(abs, rehearsal.angles[-1].values())) < 0.01


def test_marks_in_what_is_said_are_gestures() -> None:
    texts = (path.read_text(encoding="utf-8") for path in GUIDE.parent.rglob("*.t*") if path.parent.name != "gestures")
    marks = {mark.words for text in texts for line in text.splitlines() for mark in read_marks(line)[1]}
    assert len(marks) > 20
    assert [words for words in marks if said_gesture(shipped(), words) is None] == []
