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
        (p.name, p.x, p.y, None if p.facing is None else round(p.facing, 3)) for p in way_points(data)
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
            [("a", 1, 2, 90), ("7", 3, 4, None)],
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
    [place] = way_points([{"position": {"x": 0, "y": 0}, "orientation": turned}])
    assert place.facing == pytest.approx(angle, abs=1e-6)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (None, "way points are a list or a table, not None"),
        ("kitchen", "way points are a list or a table, not 'kitchen'"),
        ([], "there are no way points in it"),
        ({}, "there are no way points in it"),
        ([3], "the list[0] must be a way point"),
        ({"a": "b"}, "a must be a way point"),
        ({"a": {"x": 1}}, "a.y must be a number, not None"),
        ({"a": {"x": float("nan"), "y": 1}}, "a.x must be a number from -1,000,000"),
        ({"a": {"x": True, "y": 1}}, "a.x must be a number, not True"),
        ({"a": {"x": 10**400, "y": 1}}, "a.x must be a number from -1,000,000"),
        ([[1]], "the list[0] must be a list of 2, 3 or 7 numbers"),
        ({"a": {"x": 1, "y": 2, "orientation": {"z": 0, "w": 0}}}, "a.orientation must be a quaternion"),
        ({"a": {"x": 1, "y": 2, "orientation": [1, 2]}}, "a.orientation must be a list of 4 numbers"),
        ({"a": {"pose": {"pose": {"pose": {"pose": {"pose": POSE}}}}}}, "a.position.x must be a number, not None"),
        ({"a": {"position": 3}}, "a.position must be a list of 2 or 3 numbers"),
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
    assert way_points(data) == [Place("point 1", 1.0, 2.0), Place("point 2", 3.0, 4.0)]
