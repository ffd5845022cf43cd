"""Missions with their syntax tree and their behavior tree as golden files, by both parsers."""

from __future__ import annotations

from pathlib import Path

import pytest

from btlang.api import parse_tree, world_vocabulary
from btlang.diagnostics.reading import read_source
from btlang.frontends.mission import read_mission
from btlang.tree.dump import plain
from tests.conftest import matches_golden
from tests.language.letters import shown

GOOD = Path(__file__).parent / "good"
SAMPLES = sorted(GOOD.glob("*.txt"))


@pytest.mark.parametrize("parser", ["shunting-yard", "lark"])
@pytest.mark.parametrize("sample", SAMPLES, ids=[s.stem for s in SAMPLES])
def test_reading(sample: Path, parser: str) -> None:
    source = read_source(str(sample))
    mission = read_mission(source, world_vocabulary(), parser).mission
    definitions = [f"{d.name} = {shown(d.body)}" for d in mission.definitions]
    items = getattr(mission.body, "items", (mission.body,))
    tree = plain(parse_tree(source, parser=parser).tree)
    actual = "\n".join(["-- syntax", *definitions, *map(shown, items), "-- tree", tree, ""])
    matches_golden(actual, sample.with_suffix(".out"))
