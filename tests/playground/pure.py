"""Runs missions, and looks for near words, with what the playground has in place of compiled packages.

`python -m tests.playground.pure MISSION...` prints how each ends, as JSON, and what is similar to some words.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

from btlang.api import parse_file
from btlang.session import Session
from btlang.text.spelling import distance, fewest_slips, misspelt, nearest, nearest_start, respellings

STAND_INS = Path(__file__).parents[2] / "btlang" / "playground" / "stand_ins"
WORDS = (
    "kitchen",
    "kitchen door",
    "bottle",
    "wave",
    "wait",
    "living room",
    "lobby",
    "go",
    "nod",
    "breakfast",
    "red ball",
)
WRITTEN = ("kichen", "kitchne", "wvae", "botle", "livin rom", "lobbby", "g", "breakfst", "", "xyzzy", "wavewait", "Ää")


def found(missions: list[str]) -> dict[str, Any]:
    """How the missions end, what they said on the way, and what is near to some written words."""
    known, starts = frozenset(WORDS), {word: word.split() for word in WORDS}
    near = [
        [nearest(each, WORDS), misspelt(each, WORDS), respellings(each, known), fewest_slips(each, known),
         nearest_start(each.split(), starts), [distance(each, word) for word in WORDS]]
        for each in WRITTEN
    ]  # fmt: skip
    return {"near": near, "ends": {mission: _end(mission) for mission in missions}}


def _end(path: str) -> list[str]:
    mission = parse_file(path)
    said: list[str] = []
    with Session(world=mission.world) as session:
        run = session.run(
            mission,
            speed="max",
            time_limit=120.0,
            seed=3,
            sinks=[lambda event: said.append(getattr(event, "text", ""))],
        )
    return [str(run.outcome), run.why(), *filter(None, said)]


def found_without_packages(missions: list[str]) -> dict[str, Any]:
    """The same in a process in which NumPy is the stand-in, and rapidfuzz is in Python."""
    paths = os.pathsep.join([str(STAND_INS), str(STAND_INS.parents[2])])
    done = subprocess.run(
        [sys.executable, "-m", "tests.playground.pure", *missions], check=True, stdout=subprocess.PIPE, text=True,
        env={**os.environ, "PYTHONPATH": paths, "RAPIDFUZZ_IMPLEMENTATION": "python"},
    )  # fmt: skip
    return dict(json.loads(done.stdout))


if __name__ == "__main__":
    import numpy
    from rapidfuzz import fuzz, fuzz_py

    assert getattr(numpy, "is_stand_in", False)
    assert fuzz.ratio is fuzz_py.ratio
    print(json.dumps(found(sys.argv[1:])))
