"""Route graphs of Nav2, and lanes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from btlang.cli import main
from btlang.maps.nav2 import nav2_files
from btlang.maps.route_graph import join_lanes
from btlang.maps.way_points import way_points
from btlang.robots.geometry import Pose
from btlang.robots.worlds.world import Lane, Place, World
from btlang.robots.worlds.world_file import load_world
from btlang.text.toml_table import Problem

LANES = Lane((1.0, 1.0), (1.0, 5.0)), Lane((1.0, 5.0), (11.0, 5.0), one_way=True)


def graph(*edges: tuple[int, int], crs: str = "EPSG:3857") -> dict[str, Any]:
    scale = 1.0 if crs == "EPSG:3857" else 0.01
    nodes = {0: (1.0, 1.0), 1: (1.0, 5.0), 2: (11.0, 5.0)}
    features: list[Any] = []
    for id, at in nodes.items():
        geometry = {"type": "Point", "coordinates": [scale * x for x in at]}
        features.append({"type": "Feature", "properties": {"id": id}, "geometry": geometry})
    for number, (start, end) in enumerate(edges, 10):
        properties = {"id": number, "startid": start, "endid": end, "cost": 1.0}
        features.append({"type": "Feature", "properties": properties, "geometry": {"type": "MultiLineString"}})
    return {"type": "FeatureCollection", "crs": {"properties": {"name": crs}}, "features": features}


def test_edges_become_lanes() -> None:
    """Two edges that lead both ways are one lane; one from a node to itself is none."""
    assert way_points(graph((1, 0), (1, 2), (0, 1), (2, 2))).lanes == LANES
    assert way_points(graph()).lanes == ()
    assert join_lanes([((0.0, 0.0), (1.0, 0.0))] * 2) == (Lane((0.0, 0.0), (1.0, 0.0), one_way=True),)


def test_edges_in_degrees_need_an_origin() -> None:
    lanes = way_points(graph((0, 1), crs="WGS84"), (0.01, 0.01)).lanes
    assert [(lane.start, round(lane.end[1])) for lane in lanes] == [((0.0, 0.0), 4448)]


def test_an_edge_to_nowhere() -> None:
    with pytest.raises(Problem, match="an edge leads to the node '9', which isn't in the graph"):
        way_points(graph((0, 9)))


def test_the_exported_graph_is_read_back(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any) -> None:
    monkeypatch.chdir(tmp_path)
    world = World(Pose(1.0, 1.0), places=(Place("gate", 1.0, 1.0),), lanes=LANES)
    for name, content in nav2_files(world, 0.1, 0.5).items():
        Path(name).write_bytes(content)
    assert json.loads(Path("route_graph.geojson").read_text())["features"][0]["properties"]["name"] == "gate"
    assert main(["world", "import", "route_graph.geojson", "waypoints.yaml", "-o", "back.toml"]) == 0
    told = capsys.readouterr()
    assert told.out.startswith("route_graph.geojson: 3 way points and 2 lanes\n")
    assert told.err == ""  # the gate is one place in both files
    again = load_world("back.toml")
    assert again.lanes == LANES
    assert again.places[0] == Place("gate", 1.0, 1.0, 0.0)
    assert "route_graph.geojson" not in nav2_files(world.replace(lanes=()), 0.1, 0.5)
