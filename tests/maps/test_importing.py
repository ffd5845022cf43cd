"""Files of other programs become worlds, or errors: never anything else."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given
from hypothesis import strategies as st

from btlang.diagnostics.diagnostic import MissionError
from btlang.maps.data_text import notation
from btlang.maps.importing import ImportedWorld, import_world
from btlang.robots.geometry import Pose
from btlang.robots.worlds.world import World
from tests.profiles import searches
from tests.robots.random_worlds import worlds

RADIUS = 0.2
ON_FILES = {"suppress_health_check": [HealthCheck.function_scoped_fixture], "deadline": None}


def codes(path: Path, start: Pose | None = None) -> list[str]:
    """Of what is wrong with a file, none where it becomes a world."""
    try:
        import_world([str(path)], RADIUS, start)
    except MissionError as error:
        return [problem.code for problem in error.diagnostics]
    return []


@pytest.mark.parametrize("to", ["json", "yaml"])
@searches(25, 1500, **ON_FILES)
@given(world=worlds())
def test_random_worlds_come_back(tmp_path: Path, to: str, world: World) -> None:
    pytest.importorskip("yaml")
    path = tmp_path / f"world.{to}"
    path.write_text(notation(world, to), encoding="utf-8")
    assert import_world([str(path)], RADIUS) == ImportedWorld(world)


_KEYS = (
    "world", "start", "walls", "people", "answers", "walks", "image", "resolution", "origin", "mode", "negate",
    "waypoints", "poses", "pose", "position", "orientation", "x", "y", "z", "w", "theta", "yaw", "name", "dock",
    "points", "1",
)  # fmt: skip
_atoms = (
    st.none() | st.booleans() | st.integers(-3, 3) | st.floats() | st.sampled_from(["map.pgm", "anywhere", "", "a"])
)
_data = st.recursive(
    _atoms,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.sampled_from(_KEYS), inner, max_size=4),
    max_leaves=20,
)


@searches(150, 20_000, **ON_FILES)
@given(data=_data, wrap=st.booleans())
def test_any_data_are_a_world_or_an_error(tmp_path: Path, data: Any, wrap: bool) -> None:
    (tmp_path / "map.pgm").write_bytes(b"P5 2 2 255\n\0\0\0\0")
    path = tmp_path / "data.json"
    path.write_text(json.dumps({"world": {"start": {"x": 1, "y": 1}, "people": data}} if wrap else data))
    assert set(codes(path, Pose(9.0, 9.0))) <= {"BT070", "BT075"}


@searches(100, 10_000, **ON_FILES)
@given(image=st.binary(max_size=60) | st.binary(max_size=40).map(lambda data: b"P5 3 3 255\n" + data))
def test_any_image_is_walls_or_an_error(tmp_path: Path, image: bytes) -> None:
    pytest.importorskip("PIL")
    (tmp_path / "map.pgm").write_bytes(image)
    path = tmp_path / "map.json"
    path.write_text('{"image": "map.pgm", "resolution": 0.05}')
    assert codes(path, Pose(9.0, 9.0)) in ([], ["BT075"])


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("world: {start: {x: 1, y: 1}, people: [{name: a, x: 3, y: 3, answers: {1: b}}]}", ""),
        ("world: {start: {x: 1, y: 1}, people: [{name: a, x: 3, y: 3, answers: {2026-01-01: b}}]}", "BT075"),
        ("world: {start: {x: 1, y: 1}, clock: 2026-03-02 08:55:00}", "BT070"),
        ("{waypoints: " * 300 + "1" + "}" * 300, "BT075"),
        ("2026-01-01: {x: 1, y: 2}", ""),
    ],
)
def test_odd_yaml(tmp_path: Path, text: str, code: str) -> None:
    pytest.importorskip("yaml")
    path = tmp_path / "world.yaml"
    path.write_text(text)
    assert codes(path) == ([code] if code else [])


def test_deep_json_is_an_error(tmp_path: Path) -> None:
    path = tmp_path / "deep.json"
    for depth in (200, 900, 990, 5000):
        path.write_text('{"waypoints": ' * depth + "1" + "}" * depth)
        with pytest.raises(MissionError):
            import_world([str(path)], RADIUS)


def test_all_files_are_told_of(tmp_path: Path) -> None:
    paths = [tmp_path / name for name in ("one.json", "two.json")]
    for path in paths:
        path.write_text("[3]")
    with pytest.raises(MissionError) as caught:
        import_world([*map(str, paths), str(tmp_path / "none.json")], RADIUS)
    assert [problem.code for problem in caught.value.diagnostics] == ["BT001", "BT075", "BT075"]


GPS = [
    {"name": "gate", "latitude": 48.0, "longitude": 11.001},
    {"name": "shed", "latitude": 48.0001, "longitude": 11.0},
]


def test_degrees_become_metres_from_an_origin(tmp_path: Path) -> None:
    path = tmp_path / "gps.json"
    path.write_text(json.dumps(GPS))
    with pytest.raises(MissionError, match="give the origin of the world with --origin LAT,LON, such as --o"):
        import_world([str(path)], RADIUS)
    gate, shed = import_world([str(path)], RADIUS, origin=(48.0, 11.0)).world.places
    assert (gate.x, gate.y) == pytest.approx((74.4, 0.0), abs=0.05)
    assert (shed.x, shed.y) == pytest.approx((0.0, 11.12), abs=0.01)
    with pytest.raises(MissionError, match='the way point "gate" is more than 100 km from --origin'):
        import_world([str(path)], RADIUS, origin=(-48.0, 11.0))


def test_what_was_read_is_shown(tmp_path: Path) -> None:
    path = tmp_path / "points.json"
    path.write_text(json.dumps({f"stop_{at}": [at, 0, 1.5707963] for at in range(12)}))
    found = import_world([str(path)], RADIUS).found
    assert found[:2] == (f"{path}: 12 way points", "  stop 0: (0, 0), facing 90 degrees")
    assert found[-1] == "  ... and 2 more"
