"""Route graphs of Nav2 in GeoJSON: nodes are points, and edges lead from one to another."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from btlang.maps.data_text import numbers, shown
from btlang.robots.geometry import Point
from btlang.robots.worlds.world import Lane, World
from btlang.text.toml_table import Problem

_FROM, _TO = "startid", "endid"


def join_lanes(ways: Iterable[tuple[Point, Point]]) -> tuple[Lane, ...]:
    """Return a lane for each way from a point to another one: those that lead both ways are one lane."""
    known = dict.fromkeys((start, end) for start, end in ways if start != end)
    both = ((min(way), max(way)) if way[::-1] in known else way for way in known)
    return tuple(Lane(*way, one_way=way[::-1] not in known) for way in dict.fromkeys(both))


def read_lanes(data: Any, to_metres: Callable[[Point], Point]) -> tuple[Lane, ...]:
    """Return the edges of a route graph between its nodes, () for other data. Raises Problem for unknown nodes."""
    features = data.get("features") if isinstance(data, Mapping) else None
    nodes: dict[str, Point] = {}
    edges: list[tuple[Any, Any]] = []
    for at, feature in enumerate(features if isinstance(features, list) else ()):
        properties, geometry = (_table(feature, key) for key in ("properties", "geometry"))
        if _FROM in properties and _TO in properties:
            edges.append((properties[_FROM], properties[_TO]))
        elif geometry.get("type") == "Point" and "id" in properties:
            x, y, *_ = numbers(geometry.get("coordinates"), f"features[{at}].geometry.coordinates", 2, 3)
            nodes[str(properties["id"])] = to_metres((x, y))
    missing = next((end for ends in edges for end in ends if str(end) not in nodes), None)
    if missing is not None:
        raise Problem(f"an edge leads to the node {shown(str(missing))}, which isn't in the graph")
    return join_lanes((nodes[str(start)], nodes[str(end)]) for start, end in edges)


def _table(feature: Any, key: str) -> Mapping[str, Any]:
    found = feature.get(key) if isinstance(feature, Mapping) else None
    return found if isinstance(found, Mapping) else {}


def write_route_graph(world: World) -> str:
    """Return the lanes of a world as a route graph. Its nodes have the names of places that are there."""
    points = dict.fromkeys(point for lane in world.lanes for point in (lane.start, lane.end))
    ids = {point: id for id, point in enumerate(points)}
    names = {(place.x, place.y): place.name for place in world.places}
    features = [
        _feature("Point", point, {"id": id, "frame": "map", **({"name": names[point]} if point in names else {})})
        for point, id in ids.items()
    ]
    ways = [(lane.start, lane.end) for lane in world.lanes]
    ways += [(lane.end, lane.start) for lane in world.lanes if not lane.one_way]
    for id, (start, end) in enumerate(ways, len(ids)):
        ends = {"id": id, _FROM: ids[start], _TO: ids[end]}
        features.append(_feature("MultiLineString", [[start, end]], ends))
    crs = {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::3857"}}
    return json.dumps({"type": "FeatureCollection", "name": "graph", "crs": crs, "features": features}, indent=1) + "\n"


def _feature(sort: str, coordinates: Any, properties: Mapping[str, Any]) -> dict[str, Any]:
    geometry = {"type": sort, "coordinates": coordinates}
    return {"type": "Feature", "properties": dict(properties), "geometry": geometry}
