"""Way points in the forms of Nav2 and of rovers."""

from __future__ import annotations

from math import cos, radians, sin
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from btlang.maps.data_text import ForeignFileError, read_data
from btlang.maps.way_points import way_points
from btlang.robots.worlds.world import Place
from btlang.text.source import Source
from btlang.text.toml_table import Problem

EAST, NORTH = {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}, {"x": 0, "y": 0, "z": 0.70710678, "w": 0.70710678}
POSE = {"position": {"x": 1.0, "y": 2.0, "z": 0.0}, "orientation": NORTH}
STAMPED = {"header": {"frame_id": "map"}, "pose": POSE}


def named(data: Any) -> list[tuple[str, float, float, float | None]]:
    return [
        (p.name, p.x, p.y, None if p.facing is None else round(p.facing, 3)) for p in way_points(data).places
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("data", "found"),
    [
        ({"poses": [STAMPED, POSE]}, [("point 1", 1, 2, 90), ("point 2", 1, 2, 90)]),
        ({"header": {}, "poses": [POSE]}, [("point 1", 1, 2, 90)]),
        ([STAMPED], [("point 1", 1, 2, 90)]),
        (STAMPED, [("point 1", 1, 2, 90)]),
        ({"pose": STAMPED}, [("point 1", 1, 2, 90)]),
        ({"waypoints": [{"name": "dock", "pose": POSE}]}, [("dock", 1, 2, 90)]),
        (
            {"waypoints": {"waypoint0": {"pose": [1, 2, 0], "orientation": [0.70710678, 0, 0, 0.70710678]}}},
            [("waypoint0", 1, 2, 90)],
        ),
        ({"waypoints": [{"x": 1, "y": 2, "yaw": 3.14159265}]}, [("point 1", 1, 2, 180)]),
        ({"kitchen": {"x": 1, "y": 2, "theta": -1.5707963}}, [("kitchen", 1, 2, -90)]),
        ({"frame_id": "map", "a": {"x": 1, "y": 2}}, [("a", 1, 2, None)]),
        (
            [{"name": "a", "position": {"x": 1, "y": 2, "z": 0}, "orientation": NORTH}, {"id": 7, "x": 3, "y": 4}],
            [("a", 1, 2, 90), ("point 7", 3, 4, None)],
        ),
        (
            [{"label": "a  b", "position": [1, 2, 0], "orientation": [0, 0, 0.70710678, 0.70710678]}],
            [("a b", 1, 2, 90)],
        ),
        ([[1, 2], [3, 4, 1.5707963]], [("point 1", 1, 2, None), ("point 2", 3, 4, 90)]),
        ({"lab": [1, 2, 0, 0, 0, 0.70710678, 0.70710678]}, [("lab", 1, 2, 90)]),
        ([{"position": {"x": 1, "y": 2}, "orientation": {"yaw": 1.5707963}}], [("point 1", 1, 2, 90)]),
        ({"locations": {"a": {"position": {"x": 1, "y": 2}}}}, [("a", 1, 2, None)]),
        ([{"pose": [1, 2, 1.5707963]}], [("point 1", 1, 2, 90)]),
        ({"points": {"x": 1, "y": 2}, "b": [1, 2]}, [("points", 1, 2, None), ("b", 1, 2, None)]),
        ([{"x": 1, "y": 2, "qz": 0.70710678, "qw": 0.70710678}], [("point 1", 1, 2, 90)]),
        ({"a": {"x": 1, "y": 2, "z": 0.70710678, "w": 0.70710678}}, [("a", 1, 2, 90)]),
        ({"a": [1, 2, 0.70710678, 0.70710678]}, [("a", 1, 2, 90)]),
        ({"a": [[1, 2, 0], [0, 0, 0.70710678, 0.70710678]]}, [("a", 1, 2, 90)]),
        ([{"point": POSE["position"], "quaternion": NORTH}], [("point 1", 1, 2, 90)]),
        ([{"point": {"x": 1, "y": 2, "th": 1.5707963}}], [("point 1", 1, 2, 90)]),
        ([{"location": {"X": 1, "Y": 2}, "name": "a"}], [("a", 1, 2, None)]),
        ([{"location": "lab_door", "x_pose": 1, "y_pose": 2}], [("lab door", 1, 2, None)]),
        ([{"position": [1, 2], "yaw_deg": 90}], [("point 1", 1, 2, 90)]),
        ([{"position": [1, 2, 0], "orientation": [0, 0, 1.5707963]}], [("point 1", 1, 2, 90)]),
        ([{"position": [1, 2, 0], "orientation": [0.70710678, 0, 0, 0.70710678]}], [("point 1", 1, 2, 90)]),
        ([{"position": [1, 2, 0], "orientation": [0, 0, 0, 0]}], [("point 1", 1, 2, None)]),  # never set
        ([{"pose": {"position": {"x": 1, "y": 2}, "angle": {"yaw": 90}}}], [("point 1", 1, 2, 90)]),
        ([[1, 2, 90.0], [3, 4, 1.0]], [("point 1", 1, 2, 90), ("point 2", 3, 4, 1)]),  # all of them in degrees
        ({"x": [1, 3], "y": [2, 4], "yaw": [0, 1.5707963]}, [("point 1", 1, 2, 0), ("point 2", 3, 4, 90)]),
        ({"a": {"names": ["b", "c"], "wp_x": [1, 3], "wp_y": [2, 4]}}, [("b", 1, 2, None), ("c", 3, 4, None)]),
        ([["a", 1, 2, 1.5707963]], [("a", 1, 2, 90)]),
        ({"a": "1.0, 2.0, 1.5707963", "b": "(3 -4)"}, [("a", 1, 2, 90), ("b", 3, -4, None)]),
        ([{"name": "1 2", "x": 1, "y": 2}], [("1 2", 1, 2, None)]),
        ({"a": [[1, 2], 1.5707963]}, [("a", 1, 2, 90)]),
        ([{"name": "a", "translation": [1, 2, 0], "rotation_euler_deg": [0, 0, 90]}], [("a", 1, 2, 90)]),
        ({"locations": [{"name": "a", "coords": {"x": 1, "y": 2}, "yaw": 1.5707963}]}, [("a", 1, 2, 90)]),
        ({"goals": {"list": [STAMPED]}}, [("point 1", 1, 2, 90)]),
        (
            {"patrol": {"ros__parameters": {"waypoints": ["a"], "a": [1, 2], "cycles": 3, "covariance": [1] * 36}}},
            [("a", 1, 2, None)],
        ),
        (
            {"/**": {"ros__parameters": {"waypoints": [1, 2, 0, 3, 4, 0, 5, 6, 0]}}},
            [("point 1", 1, 2, 0), ("point 2", 3, 4, 0), ("point 3", 5, 6, 0)],
        ),
        ({"waypoints": [1, 2, 3, 4]}, [("point 1", 1, 2, None), ("point 2", 3, 4, None)]),
        (
            {"north": [[1, 2], [3, 4]], "south": [[5, 6]]},
            [("north 1", 1, 2, None), ("north 2", 3, 4, None), ("south", 5, 6, None)],
        ),
        ([{"node": {"name": "a", "pose": POSE, "verts": [{"x": 9, "y": 9}]}, "meta": {"map": "m"}}], [("a", 1, 2, 90)]),
        (
            {
                "type": "FeatureCollection",
                "crs": {"properties": {"name": "urn:ogc:def:crs:EPSG::3857"}},
                "features": [
                    {"type": "Feature", "properties": {"id": 4}, "geometry": {"type": "Point", "coordinates": [1, 2]}},
                    {
                        "type": "Feature",
                        "properties": {"name": "dock"},
                        "geometry": {"type": "Point", "coordinates": [3, 4]},
                    },
                    {
                        "type": "Feature",
                        "properties": {"id": 9, "startid": 4},
                        "geometry": {"type": "LineString", "coordinates": [[1, 2], [3, 4]]},
                    },
                ],
            },
            [("point 4", 1, 2, None), ("dock", 3, 4, None)],
        ),
    ],
    ids=str,
)
def test_forms(data: Any, found: list[tuple[str, float, float, float | None]]) -> None:
    assert named(data) == found


@given(angle=st.floats(-179.9, 179.9), length=st.floats(0.1, 10.0), roll=st.booleans())
def test_the_yaw_of_quaternions(angle: float, length: float, roll: bool) -> None:
    half = radians(angle) / 2
    z, w = sin(half) * length, cos(half) * length
    turned = {"x": w, "y": z, "z": 0.0, "w": 0.0} if roll else {"x": 0.0, "y": 0.0, "z": z, "w": w}  # rolled over
    [place] = way_points([{"position": {"x": 0, "y": 0}, "orientation": turned}]).places
    assert place.facing == pytest.approx(angle, abs=1e-6)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (None, "way points are a list or a table, not None"),
        ("kitchen", "way points are a list or a table, not 'kitchen'"),
        ([], "there are no way points in it: write for example"),
        ({}, "there are no way points in it"),
        ([3], "the list has 1 numbers, which may be points x, y or points x, y, yaw"),
        ({"a": "b"}, "there are no way points in it"),
        ({"waypoints": [1, 2, 3, 4, 5, 6]}, "waypoints has 6 numbers, which may be points x, y or points x, y, yaw"),
        ({"a": {"lat": 48, "lon": 11}}, "give the origin of the world with --origin LAT,LON, such as --origin=48,11"),
        ({"a": {"lat": 148, "lon": 11}}, "a.lat must be from -90 to 90"),
        ({"a": {"lat": 48}}, "a.longitude must be a number, not None"),
        (
            {"type": "Feature", "geometry": {"type": "Point", "coordinates": [11, 48]}},
            "give the origin of the world with --origin LAT,LON",
        ),
        ({"a": {"x": 1}}, "a.y must be a number, not None"),
        ({"a": {"x": float("nan"), "y": 1}}, "a.x must be a number from -1,000,000"),
        ({"a": {"x": True, "y": 1}}, "a.x must be a number, not True"),
        ({"a": {"x": 10**400, "y": 1}}, "a.x must be a number from -1,000,000"),
        ([[1]], "the list[0] has 1 numbers"),
        ({"a": {"x": 1, "y": 2, "orientation": [1, 2]}}, "a.orientation must be a list of 3 or 4 numbers"),
        ({"a": {"position": 3}}, "there are no way points in it"),
        ([[0, 0]] * 10_001, "a file may have at most 10,000 way points"),
    ],
    ids=lambda value: str(value)[:40],
)
def test_what_may_be_wrong(data: Any, message: str) -> None:
    with pytest.raises(Problem) as caught:
        way_points(data)
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("a.json", "{", "this isn't JSON"),
        ("a.json", "[" * 100_000, "nested too deep"),
        ("a.json", "9" * 5000, "this isn't JSON"),
        ("a.yaml", "a: [1, 2", "this isn't YAML"),
        ("a.yaml", "a: &x [1]\nb: *x\n", "aliases (*name) can't be used here"),
        ("a.yaml", "!!python/object/apply:os.system ['true']", "this isn't YAML"),
        ("a.yaml", "[" * 3000, "nested too deep"),
        ("a.yaml", "? [a]\n: b", "this isn't YAML"),
        ("a.yaml", "a: 2026-99-99", "this isn't YAML"),
        ("a.yaml", "a: \0", "this isn't YAML"),
        ("a.yaml", "a: b\n" * 300_000, "at most 1,000,000 characters"),
    ],
    ids=lambda value: str(value)[:30],
)
def test_unreadable_texts(name: str, text: str, message: str) -> None:
    pytest.importorskip("yaml")
    with pytest.raises(ForeignFileError) as caught:
        read_data(Source(text, name))
    assert message in caught.value.message


def test_errors_of_yaml_have_a_line() -> None:
    pytest.importorskip("yaml")
    with pytest.raises(ForeignFileError) as caught:
        read_data(Source("a: &x [1]\nb: 2\nc: *x\n", "a.yaml"))
    assert caught.value.line == 3


def test_several_documents_are_a_list() -> None:
    pytest.importorskip("yaml")
    data = read_data(Source("position: {x: 1, y: 2}\n---\nposition: {x: 3, y: 4}\n---\n", "a.yaml"))
    assert way_points(data).places == (Place("point 1", 1.0, 2.0), Place("point 2", 3.0, 4.0))


@pytest.mark.parametrize(
    ("data", "note"),
    [
        ([[1, 2, 180.0]], "directions are read as degrees, because one of them is more than a whole turn in radians"),
        ([{"x": 1, "y": 2, "direction": "SOUTH"}], "the list[0] faces any direction: direction 'SOUTH' isn't an angle"),
        ({"waypoints": [[1, 2]], "start": [0, 0]}, "left out, beside the way points: start"),
    ],
    ids=str,
)
def test_what_a_user_should_look_at(data: Any, note: str) -> None:
    assert way_points(data).notes == (note,)


def test_compass_headings_of_geographic_points() -> None:
    [place] = way_points([{"latitude": 48.0, "longitude": 11.0, "heading": 0}], (48.0, 11.0)).places
    assert (place.x, place.y, place.facing) == (0.0, 0.0, 90.0)


def test_what_is_not_read_of_way_points_is_said() -> None:
    """A direction under an odd key isn't lost in silence."""
    found = way_points([{"x": 1, "y": 2, "z": 0, "a": 1.57}, {"x": 2, "y": 2, "turned": [0, 1], "name": "b"}])
    assert found.notes == ("of the way points, these aren't read: a, turned",)
    with pytest.raises(Problem, match="x has 2 numbers, and y has 1"):
        way_points({"x": [1, 2], "y": [1]})


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("name,x,y,yaw\na,1,2,1.5707963\n", [("a", 1, 2, 90)]),
        ("X;Y;Label\n1;2;a\n\n3;4;b\n", [("a", 1, 2, None), ("b", 3, 4, None)]),
        ("1,2\n3,4\n", [("point 1", 1, 2, None), ("point 2", 3, 4, None)]),
        ("lab 1   2 1.5707963\nhall 3 4\n", [("lab", 1, 2, 90), ("hall", 3, 4, None)]),
        ("# x y\nlab\t1\t2\t0\n", [("lab", 1, 2, 0)]),
    ],
)
def test_way_points_in_csv(text: str, found: Any) -> None:
    assert named(read_data(Source(text, "points.csv"))) == found
    assert named(read_data(Source(text, "points.txt"))) == found


def test_a_cell_of_csv_that_is_too_long() -> None:
    assert read_data(Source(f'"{"a" * 200_000}",1,2', "points.csv")) == []
