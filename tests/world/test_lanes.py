"""Lanes: a robot keeps to them, in their direction, unless that is a long way round."""

from __future__ import annotations

from pathlib import Path

import pytest

from btlang.cli import main
from btlang.robots.geometry import Point, Pose, segment_distance
from btlang.robots.worlds.obstacles import Obstacles
from btlang.robots.worlds.planning import PathPlanner
from btlang.robots.worlds.world import FurnitureBox, Lane, World

CORNERS = ((0.0, 0.0), (20.0, 0.0), (20.0, 10.0), (0.0, 10.0), (0.0, 0.0))
LANES = (
    Lane((2.0, 2.0), (2.0, 8.0)),
    Lane((2.0, 8.0), (18.0, 8.0)),
    Lane((18.0, 8.0), (18.0, 2.0)),
    Lane((18.0, 2.0), (2.0, 2.0), one_way=True),
)


def way(start: Point, goal: Point, *boxes: FurnitureBox) -> list[Point]:
    world = World(Pose(1.0, 1.0), walls=(CORNERS,), lanes=LANES, boxes=boxes)
    found = PathPlanner(world, Obstacles(world), 0.2).path(start, goal)
    assert found is not None
    return found


def share_on(lanes: tuple[Lane, ...], points: list[Point]) -> float:
    near = [min(segment_distance(at, (*lane.start, *lane.end)) for lane in lanes) < 0.2 for at in points]
    return sum(near) / len(near)


def test_a_robot_keeps_to_lanes() -> None:
    assert share_on(LANES[:3], way((2.0, 3.0), (18.0, 3.0))) == 1.0


def test_a_lane_that_leads_one_way_is_for_one_way() -> None:
    there, back = way((1.0, 1.0), (19.0, 1.0)), way((19.0, 1.0), (1.0, 1.0))
    assert share_on(LANES[:3], there) > 0.85
    assert share_on(LANES[3:], back) > 0.85


def test_a_robot_leaves_lanes_for_short_ways() -> None:
    """Around what is in the way, too."""
    assert len(way((9.0, 4.0), (12.0, 4.0))) < 35
    around = way((2.0, 5.0), (18.0, 5.0), FurnitureBox(10.0, 8.0, 1.0, 1.0))
    assert 0.7 < share_on(LANES[:3], around) < 1.0


def test_lanes_of_a_world_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "world.toml"
    path.write_text("start = { x = 1, y = 1 }\nlanes = [{ from = [1, 1], to = [3, 1], one_way = 1 }]\n", "utf-8")
    assert main(["world", "check", str(path)]) == 2
    assert '"one_way" must be true or false' in capsys.readouterr().err
    path.write_text("start = { x = 1, y = 1 }\nlanes = [{ from = [1, 1], to = [3, 1], one_way = true }]\n", "utf-8")
    assert main(["world", str(path)]) == 0
    assert "lanes: 1\n" in capsys.readouterr().out
    picture = tmp_path / "world.svg"
    assert main(["world", str(path), "--picture", str(picture)]) == 0
    assert "#7a9e87" in picture.read_text("utf-8")


def test_the_page_gets_lanes() -> None:
    shown = World(Pose(1.0, 1.0), lanes=LANES[3:]).as_map()["lanes"]
    assert shown == [{"start": (18.0, 2.0), "end": (2.0, 2.0), "one_way": True}]
