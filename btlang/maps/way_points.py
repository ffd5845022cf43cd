"""Way points of Nav2 and of rovers: positions in the many forms that there are, recognised by their fields."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import cos, degrees, radians, tau

from btlang.maps.data_text import number, numbers, shown, yaw
from btlang.maps.point_shapes import are_numbers, usual_shape
from btlang.maps.route_graph import read_lanes
from btlang.robots.geometry import Point, wrap
from btlang.robots.worlds.world import Lane, Place
from btlang.support.record import Record
from btlang.text.toml_table import Problem

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    Fields = Mapping[str, Any]

MOST = 10_000
"""The most way points of one file."""
_LISTS = (
    "waypoints", "way_points", "poses", "points", "goals", "places", "locations", "stations", "route", "routes",
    "features", "nodes", "targets", "target_points", "patrol_points", "coordinates",
    "list", "items", "wps",
)  # fmt: skip
_NAMES = ("name", "label", "id", "frame_name", "location_name", "title", "location", "key")
_POSITIONS = (
    "position", "pose", "location", "point", "coordinates", "coordinate", "geometry", "goal", "target", "translation",
    "pos", "xy",
)  # fmt: skip
_POSES = ("pose", "goal", "target", "pos")  # whose third number is the yaw
_SHAPES = ("LineString", "MultiLineString", "Polygon", "MultiPolygon", "MultiPoint")  # of GeoJSON
_UNNAMED = ("ros__parameters", "properties", "geometry")
_GENERIC = ("node", "waypoint", "way_point", *_POSITIONS)  # keys that say what a point is, and not its name
_TURNS = ("orientation", "quaternion", "rotation", "angle", "rot", "quat", "rpy", "euler", "rotation_euler")
_TURNS_IN_DEGREES = tuple(f"{key}_{unit}" for key in _TURNS for unit in ("deg", "degrees"))
_YAWS = ("yaw", "theta", "heading", "th", "angle", "bearing")  # radians, as everywhere in ROS
_YAWS_IN_DEGREES = tuple(f"{key}_{unit}" for key in _YAWS for unit in ("deg", "degrees"))
_COMPASS = ("heading", "bearing")  # of geographic points: degrees from north, clockwise
_DIRECTION = ("direction", "facing")
_LATITUDES, _LONGITUDES = ("latitude", "lat"), ("longitude", "lon", "lng", "long")
_METRES = ("3857", "local", "engineering")  # in the crs of GeoJSON, for coordinates in metres; Nav2 writes EPSG:3857
_EARTH = 6_371_008.8  # metres
_FARTHEST = 100_000.0  # metres from the origin, beyond which the earth isn't flat
_FLAT = 1e-3  # of a quaternion


def _spellings(axis: str) -> tuple[str, ...]:
    before = (f"{word}{axis}" for word in ("pos_", "position_", "pose_", "goal_", "p"))
    return (axis, *before, *(f"{axis}_{word}" for word in ("pos", "pose", "position", "goal")))


_AXES = {axis: _spellings(axis) for axis in "xy"}
_QUATERNION = {axis: tuple(f"{word}{axis}" for word in ("q", "q_", "orientation_", "quaternion_")) for axis in "xyzw"}
_KNOWN = frozenset((
    *_NAMES, *_POSITIONS, *_TURNS, *_TURNS_IN_DEGREES, *_YAWS, *_YAWS_IN_DEGREES, *_DIRECTION, *_LATITUDES,
    *_LONGITUDES, *_AXES["x"], *_AXES["y"], *_spellings("z"), *(key for keys in _QUATERNION.values() for key in keys),
    "z", "w", "roll", "pitch", "altitude", "alt", "height", "covariance", "bbox",
))  # fmt: skip


class WayPoints(Record):
    """The way points of a file as places, and a line for each thing about them that a user should look at.

    `lanes` are the edges of a route graph.
    """

    places: tuple[Place, ...]
    notes: tuple[str, ...] = ()
    lanes: tuple[Lane, ...] = ()


class _Pose(Record):
    """A position, in metres or in degrees of longitude and latitude, and its direction.

    The direction is a number in radians, or in degrees.
    """

    x: float
    y: float
    radians: float | None = None
    degrees: float | None = None
    geographic: bool = False


def way_points(data: Any, origin: Point | None = None) -> WayPoints:
    """Return all way points in the order of the file. Those without a name are called "point 1" and so on.

    A point is a list of numbers, or a table with a position and perhaps a direction, in the forms that docs/worlds.md
    lists. Directions are in radians, unless one of them is more than a whole turn. Points in degrees need the latitude
    and longitude of the origin. Raises Problem.
    """
    data = usual_shape(data, _NAMES)
    reader = _Reader(geographic=_is_geographic(data))
    found: list[tuple[str, _Pose]] = []
    for name, value, where in reader.points(data, "", "the list" if isinstance(data, list) else ""):
        if len(found) == MOST:
            raise Problem(f"a file may have at most {MOST:,} way points")
        found.append((name or f"point {len(found) + 1}", reader.pose(value, where)))
    if not found:
        raise Problem(_expected(data))
    notes = reader.notes
    if reader.unread:
        notes.append(f"of the way points, these aren't read: {', '.join(reader.unread)}")
    if any(pose.geographic for _, pose in found):
        if origin is None:
            raise Problem(
                "its way points are degrees of latitude and longitude; give the origin of the world with --origin "
                f"LAT,LON, such as --origin={found[0][1].y:g},{found[0][1].x:g}"
            )
        notes.append(f"latitude and longitude are metres east and north of ({origin[0]:g}, {origin[1]:g})")
    turns = any(abs(pose.radians or 0.0) > tau + 0.01 for _, pose in found)
    if turns:
        notes.append("directions are read as degrees, because one of them is more than a whole turn in radians")
    places = tuple(_place(name, pose, origin, turns) for name, pose in found)
    in_degrees = origin if reader.geographic else None
    lanes = read_lanes(data, lambda at: at if in_degrees is None else _in_metres(at, in_degrees, "of a node"))
    return WayPoints(places, tuple(notes), lanes)


def _expected(data: Any) -> str:
    if not isinstance(data, list | dict):
        return f"way points are a list or a table, not {shown(data)}"
    return 'there are no way points in it: write for example {"kitchen": {"x": 2.5, "y": 4, "yaw": 1.57}}'


def _is_geographic(data: Any) -> bool:
    """Return whether lists of coordinates are longitude and latitude: in GeoJSON whose crs doesn't say metres."""
    if not isinstance(data, dict) or data.get("type") not in ("FeatureCollection", "Feature"):
        return False
    crs = str(data.get("crs", "")).lower()
    return not any(word in crs for word in _METRES)


def _place(name: str, pose: _Pose, origin: Point | None, in_degrees: bool) -> Place:
    facing = pose.degrees
    if pose.radians is not None:
        facing = pose.radians if in_degrees else degrees(pose.radians)
    x, y = pose.x, pose.y
    if pose.geographic and origin is not None:
        x, y = _in_metres((x, y), origin, f'"{name}"')
    return Place(name, x, y, None if facing is None else wrap(facing))


def _in_metres(degrees: Point, origin: Point, name: str) -> Point:
    """Return the metres east and north of the origin of a longitude and latitude. Raises Problem if that is too far."""
    longitude, latitude = degrees
    x = radians((longitude - origin[1] + 180.0) % 360.0 - 180.0) * cos(radians(origin[0])) * _EARTH
    y = radians(latitude - origin[0]) * _EARTH
    if max(abs(x), abs(y)) > _FARTHEST:
        raise Problem(f"the way point {name} is more than {_FARTHEST / 1000:g} km from --origin")
    return round(x, 3), round(y, 3)


def _fields(value: Any) -> Fields:
    """Return the table of a point with its keys in small letters."""
    return {str(key).lower(): inner for key, inner in value.items()} if isinstance(value, dict) else {}


def _first(fields: Fields, keys: tuple[str, ...]) -> str:
    """Return the first of these keys that is there, "" for none."""
    return next((key for key in keys if fields.get(key) is not None), "")


def place_name(text: object) -> str:
    """Return the name of a place that people can say: with blanks for underscores, and "point 7" for a number."""
    name = " ".join(str(text).replace("_", " ").split())[:200]
    return f"point {name}" if name.isdigit() else name


class _Reader:
    def __init__(self, geographic: bool) -> None:
        self.geographic = geographic
        self.notes: list[str] = []
        self.unread: dict[str, None] = {}

    def points(self, data: Any, name: str, where: str) -> Iterator[tuple[str, Any, str]]:
        """Yield the name of each point, the point, and where it is in messages; `name` is that of the whole."""
        if self._is_point(data):
            yield name or self._name(data), data, where or "the way point"
        elif are_numbers(data):
            yield from self._flat(data, name, where)
        elif isinstance(data, list):
            for index, value in enumerate(data):
                inner = f"{where}[{index}]"
                own = self._name(value)
                numbered = f"{name} {index + 1}" if name and len(data) > 1 else name
                if self._is_point(value):
                    yield own or numbered, value, inner
                elif isinstance(value, dict | list):
                    yield from self.points(value, own or numbered, inner)
        elif isinstance(data, dict) and data.get("type") not in _SHAPES:
            yield from self._in_table(data, name, where)

    def _in_table(self, data: dict[Any, Any], name: str, where: str) -> Iterator[tuple[str, Any, str]]:
        lists = [key for key in data if str(key).lower() in _LISTS and isinstance(data[key], list | dict)]
        lists = [key for key in lists if not self._is_point(data[key])]
        found = False
        for keys in (lists, [key for key in data if key not in lists]):
            for key in keys:
                value = data[key]
                if isinstance(value, dict | list):
                    is_named = key not in lists and str(key) not in _UNNAMED
                    is_named = is_named and not (isinstance(value, dict) and "ros__parameters" in value)
                    own = self._name(value) if str(key).lower() in _GENERIC else ""
                    own = own or (place_name(key) if is_named else name)
                    for point in self.points(value, own, f"{where}.{key}" if where else str(key)):
                        found = True
                        yield point
            if found:
                others = [str(key) for key in data if key not in keys and self._is_point(data[key])]
                self.notes += [f"left out, beside the way points: {', '.join(others)}"] if others else []
                return

    def _flat(self, values: list[Any], name: str, where: str) -> Iterator[tuple[str, Any, str]]:
        """Yield the points of a list of numbers, two or three for each point.

        Under a name of their own, numbers that can't be one point are something else.
        """
        if name and not where.lower().endswith(_LISTS):
            return
        sizes = [size for size in (2, 3) if len(values) % size == 0]
        if len(sizes) != 1:
            raise Problem(
                f"{where or 'the list'} has {len(values)} numbers, which may be points x, y or points x, y, yaw; write "
                "each point as a list of its own"
            )
        size = sizes[0]
        for at in range(0, len(values), size):
            yield "", values[at : at + size], f"{where}[{at // size}]"

    def _is_point(self, value: Any) -> bool:
        if isinstance(value, list):
            pair = len(value) == 2 and are_numbers(value[0]) and are_numbers(value[1])
            pair = pair and len(value[0]) in (2, 3) and len(value[1]) == 4
            return pair or (are_numbers(value) and (len(value) in (2, 3, 7) or _is_planar(value)))
        fields = _fields(value)
        if _first(fields, _AXES["x"]) or _first(fields, _LATITUDES):
            return not any(isinstance(fields[key], dict | list) for key in ("x", "y") if key in fields)
        inner = fields.get(self._position(fields))
        if inner is None:
            return False
        if fields.get("type") in _SHAPES:
            return False
        return self._is_point(inner) or are_numbers(inner)

    def _position(self, fields: Fields) -> str:
        """Return the key of the position in the table of a point, "" if it has none.

        In a table with a name, that is the only point under any key.
        """
        known = _first(fields, _POSITIONS)
        if known or not _first(fields, _NAMES):
            return known
        others = [key for key in fields if key not in (*_TURNS, *_LISTS) and self._is_point(fields[key])]
        return others[0] if len(others) == 1 else ""

    def _name(self, value: Any) -> str:
        fields = _fields(value)
        for table in (fields, _fields(fields.get("properties"))):
            text = next((table[key] for key in _NAMES if isinstance(table.get(key), str | int)), "")
            if text != "":
                return place_name(text)
        return ""

    def pose(self, value: Any, where: str) -> _Pose:
        """Return the pose of a point. Raises Problem."""
        if isinstance(value, list):
            return self._pose_list(value, where)
        fields = _fields(value)
        north, x = _first(fields, _LATITUDES), _first(fields, _AXES["x"])
        inner = "" if north or x else self._position(fields)
        self.unread |= dict.fromkeys(key for key in fields if key != inner and not _is_known(key, fields[key]))
        if north:
            longitude = number(fields.get(_first(fields, _LONGITUDES)), f"{where}.longitude", -180.0, 180.0)
            found = _Pose(longitude, number(fields[north], f"{where}.{north}", -90.0, 90.0), geographic=True)
        elif x:
            y = _first(fields, _AXES["y"]) or "y"
            found = _Pose(number(fields[x], f"{where}.{x}"), number(fields.get(y), f"{where}.{y}"))
        elif isinstance(fields[inner], list):
            found = self._pose_list(fields[inner], f"{where}.{inner}", with_yaw=inner in _POSES)
        else:
            found = self.pose(fields[inner], f"{where}.{inner}")
        return self._turned(found, fields, where, w_first=inner == "pose" and isinstance(fields[inner], list))

    def _pose_list(self, value: list[Any], where: str, with_yaw: bool = True) -> _Pose:
        """Return the pose in a list; the third of three numbers is its yaw, or else its height."""
        if len(value) == 2 and isinstance(value[0], list):
            return _with_list(self._pose_list(value[0][:2], where), value[1], where, w_first=False)
        if self.geographic:
            longitude, latitude, *_ = numbers(value, where, 2, 3)
            return _Pose(longitude, latitude, geographic=True)
        x, y, *more = numbers(value, where, 2, 3, 4, 7)
        found = _Pose(x, y)
        if len(more) == 5:
            return _facing(found, in_degrees=yaw(where, *more[1:]))
        if len(more) == 2:
            return _facing(found, in_degrees=yaw(where, 0.0, 0.0, *more))
        return _facing(found, more[0]) if more and with_yaw else found

    def _turned(self, pose: _Pose, fields: Fields, where: str, w_first: bool) -> _Pose:
        """Return a pose with the direction that its table has, if it has one."""
        turn = fields.get(_first(fields, _TURNS))
        in_degrees = fields.get(_first(fields, _TURNS_IN_DEGREES))
        if isinstance(in_degrees, list):
            return _facing(pose, in_degrees=numbers(in_degrees, f"{where}.orientation", 3)[2])
        if isinstance(turn, list):
            return _with_list(pose, turn, f"{where}.orientation", w_first)
        if isinstance(turn, dict):
            where, inner = f"{where}.orientation", _fields(turn)
            if _has_w(inner):
                return _with_axes(pose, {axis: axis for axis in "xyzw"}, inner, where)
            return self._turned(pose, inner, where, w_first)
        spelt = {axis: _first(fields, keys) for axis, keys in _QUATERNION.items()}
        if spelt["z"] and spelt["w"]:
            return _with_axes(pose, spelt, fields, where)
        if _has_w(fields) and "x" in fields:  # z and w beside x and y are those of a quaternion
            return _with_axes(pose, {"z": "z", "w": "w"}, fields, where)
        return self._with_angle(pose, fields, turn, where)

    def _with_angle(self, pose: _Pose, fields: Fields, turn: Any, where: str) -> _Pose:
        key = _first(fields, _YAWS_IN_DEGREES)
        if key:
            return _facing(pose, in_degrees=number(fields[key], f"{where}.{key}"))
        key = _first(fields, _COMPASS) if pose.geographic else ""
        if key:
            return _facing(pose, in_degrees=90.0 - number(fields[key], f"{where}.{key}"))
        key = _first(fields, _YAWS)
        if key and not isinstance(fields[key], dict | list):
            return _facing(pose, number(fields[key], f"{where}.{key}"))
        if turn is not None:
            return _facing(pose, number(turn, f"{where}.orientation"))
        key = _first(fields, _DIRECTION)
        if key and pose.radians is None and pose.degrees is None:
            self.notes.append(f"{where} faces any direction: {key} {shown(fields[key])} isn't an angle")
        return pose


def _is_known(key: str, value: Any) -> bool:
    """Return whether a field of a point is read, needn't be, or can't be a part of its pose."""
    of_a_pose = are_numbers(value) or (isinstance(value, int | float) and not isinstance(value, bool))
    return not of_a_pose or key in _KNOWN


def _facing(pose: _Pose, in_radians: float | None = None, in_degrees: float | None = None) -> _Pose:
    return _Pose(pose.x, pose.y, in_radians, in_degrees, pose.geographic)


def _with_axes(pose: _Pose, spelt: Mapping[str, str], fields: Fields, where: str) -> _Pose:
    """Return a pose with the direction of a quaternion; one with the length 0 was never set."""
    x, y, z, w = (number(fields.get(spelt.get(axis, ""), 0.0), f"{where}.{spelt.get(axis)}") for axis in "xyzw")
    return _facing(pose, in_degrees=yaw(where, x, y, z, w)) if x or y or z or w else pose


def _with_list(pose: _Pose, turn: list[Any], where: str, w_first: bool) -> _Pose:
    """Return a pose with the direction of a quaternion, or of roll, pitch and yaw.

    The zeros of a quaternion of a robot on the ground show whether w is first.
    """
    one, two, three, *four = numbers(turn, where, 3, 4)
    if not four:
        return _facing(pose, three)
    if max(abs(one), abs(two)) < _FLAT:
        w_first = False
    elif max(abs(two), abs(three)) < _FLAT:
        w_first = True
    order = (1, 2, 3, 0) if w_first else (0, 1, 2, 3)
    axes = dict(zip("xyzw", order, strict=True))
    return _with_axes(pose, {axis: axis for axis in axes}, {axis: turn[at] for axis, at in axes.items()}, where)


def _has_w(fields: Fields) -> bool:
    return fields.get("w") is not None and fields.get("z") is not None


def _is_planar(value: list[Any]) -> bool:
    """Return whether four numbers are x, y and the z and w of a turn on the ground."""
    return len(value) == 4 and abs(value[2] ** 2 + value[3] ** 2 - 1.0) < 0.01
