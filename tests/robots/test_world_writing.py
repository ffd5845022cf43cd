"""Worlds are written as TOML that gives the same world."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from btlang.robots.worlds.world import World
from btlang.robots.worlds.world_file import load_world
from btlang.robots.worlds.world_writing import to_toml
from btlang.text.source import Source
from tests.profiles import searches
from tests.robots.random_worlds import worlds

EXAMPLES = Path(__file__).parents[2] / "examples"
WORLDS = [*sorted((EXAMPLES / "worlds").glob("*.toml")), *EXAMPLES.glob("*/world.toml")]


@pytest.mark.parametrize("path", [None, *WORLDS], ids=lambda path: "-".join(path.parts[-2:]) if path else "default")
def test_shipped_worlds_come_back(path: Path | None) -> None:
    world = load_world(path)
    assert load_world(Source(to_toml(world), "world.toml")) == world


@searches(60, 3000)
@given(world=worlds())
def test_random_worlds_come_back(world: World) -> None:
    assert load_world(Source(to_toml(world), "world.toml")) == world


@given(text=st.text(min_size=1).filter(lambda text: bool(text.strip())))
def test_any_text_comes_back(text: str) -> None:
    world = load_world(Source('start = { x = 1, y = 1 }\npeople = [{ name = "Vera", x = 3, y = 3 }]', "world.toml"))
    [vera] = world.people
    world = world.replace(people=(vera.replace(wears=(text,), answers={text.lower(): text}),))
    assert load_world(Source(to_toml(world), "world.toml")) == world
