"""Way points of Nav2 and of rovers: lists and tables of positions in the many forms that there are."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import degrees

from btlang.maps.data_text import number, numbers, shown, yaw
from btlang.robots.geometry import wrap
from btlang.robots.worlds.world import Place
from btlang.text.toml_table import Problem

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

MOST = 10_000
"""The most way points of one file."""
_LISTS = ("waypoints", "way_points", "poses", "points", "goals", "places", "locations", "stations", "route")
_NAMES = ("name", "label", "id", "frame_name")
_ABOUT = ("frame_id", "frame", "map", "version", "name", "resolution")  # of the whole list
_YAWS = ("yaw", "theta", "heading")  # radians, as everywhere in ROS


def way_points(data: Any) -> list[Place]:
    """Return all way points in the order of the file. Those without a name are called "point 1" and so on.

    A point is [x, y], [x, y, yaw], a table with x and y, or one with a position (or pose) and perhaps an orientation.
    Angles are in radians; orientations are quaternions: tables with x, y, z, w, lists [w, x, y, z] beside a list "pose"
    as RViz saves them, other lists [x, y, z, w]. Raises Problem for any other form.
    """
    found: list[Place] = []
    for what, name, value in _list_points(data, ""):
        if len(found) == MOST:
            raise Problem(f"a file may have at most {MOST:,} way points")
        x, y, facing = _pose(value, what)
        found.append(Place(name or _name(value) or f"point {len(found) + 1}", x, y, facing))
    if not found:
        raise Problem("there are no way points in it")
    return found


def _list_points(data: Any, what: str) -> Iterator[tuple[str, str, Any]]:
    """Return for each point its name in messages, its own name if it is a key, and the point."""
    if isinstance(data, list):
        for index, value in enumerate(data):
            yield f"{what or 'the list'}[{index}]", "", value
        return
    if not isinstance(data, dict):
        raise Problem(f"way points are a list or a table, not {shown(data)}")
    lists = [key for key in _LISTS if isinstance(data.get(key), list | dict) and not _is_point(data[key])]
    if lists:
        for key in lists:
            yield from _list_points(data[key], key)
    elif _is_point(data):
        yield what or "the way point", "", data
    else:
        for key, value in data.items():
            if key in _ABOUT and not isinstance(value, dict | list):
                continue
            yield f"{what}.{key}" if what else str(key), " ".join(str(key).split())[:200], value


def _is_point(value: Any) -> bool:
    return isinstance(value, dict) and bool({"x", "position", "pose"} & value.keys())


def _name(value: Any) -> str:
    found = (value[key] for key in _NAMES if isinstance(value, dict) and key in value)
    text = next((str(each) for each in found if isinstance(each, str | int)), "")
    return " ".join(text.split())[:200]


def _pose(value: Any, what: str) -> tuple[float, float, float | None]:
    """Return x and y in metres, and the direction in degrees if there is one."""
    for _ in range(3):  # PoseStamped has a pose in a pose
        if isinstance(value, dict) and isinstance(value.get("pose"), dict):
            value = value["pose"]
    if isinstance(value, list):
        return _pose_list(value, what)
    if not _is_point(value):
        raise Problem(f"{what} must be a way point: a table with x and y, or with a position, or [x, y, yaw]")
    if "x" in value:
        return number(value["x"], f"{what}.x"), number(value.get("y"), f"{what}.y"), _find_facing(value, what)
    is_rviz = "position" not in value
    position = value["pose" if is_rviz else "position"]
    if isinstance(position, dict):
        x, y = number(position.get("x"), f"{what}.position.x"), number(position.get("y"), f"{what}.position.y")
        return x, y, _find_facing(value, what)
    x, y, *_ = numbers(position, f"{what}.{'pose' if is_rviz else 'position'}", 2, 3)
    if is_rviz and "orientation" not in value and len(position) == 3:
        return _pose_list(position, what)
    return x, y, _find_facing(value, what, w_first=is_rviz)


def _pose_list(value: list[Any], what: str) -> tuple[float, float, float | None]:
    """Return the pose in [x, y], [x, y, yaw], or [x, y, z, then a quaternion x, y, z, w]."""
    x, y, *more = numbers(value, what, 2, 3, 7)
    if len(more) == 5:
        return x, y, yaw(what, *more[1:])
    return x, y, wrap(degrees(more[0])) if more else None


def _find_facing(value: Mapping[str, Any], what: str, w_first: bool = False) -> float | None:
    turned = value.get("orientation")
    if turned is None:
        return _angle(value, what)
    where = f"{what}.orientation"
    if isinstance(turned, dict):
        if {"z", "w"} <= turned.keys():
            x, y, z, w = (number(turned.get(key, 0.0), f"{where}.{key}") for key in "xyzw")
            return yaw(where, x, y, z, w)
        return _angle(turned, where)
    if isinstance(turned, list):
        four = numbers(turned, where, 4)
        return (
            yaw(where, four[1], four[2], four[3], four[0])
            if w_first
            else yaw(where, four[0], four[1], four[2], four[3])
        )
    return wrap(degrees(number(turned, where)))


def _angle(value: Mapping[str, Any], what: str) -> float | None:
    angles = (number(value[key], f"{what}.{key}") for key in _YAWS if key in value)
    return next((wrap(degrees(angle)) for angle in angles), None)
