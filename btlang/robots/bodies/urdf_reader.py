"""URDF and MJCF files of other programs as the body of a robot file."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterable, Iterator, Mapping
from math import atan2, ceil, cos, degrees, pi, sin, sqrt

import numpy as np

from btlang.robots.bodies.body import Capsule, Joint, Sensor, Vector
from btlang.robots.bodies.joint_tables import BASE
from btlang.robots.bodies.mesh_bounds import mesh_bounds
from btlang.robots.bodies.mjcf import robot_of_mjcf
from btlang.robots.bodies.urdf_elements import UrdfElement, UrdfFile, value_of
from btlang.robots.bodies.urdf_wheels import Drive, describe_base, gap_between, plugin_drive, wheel_joints
from btlang.robots.motion.kinematics import Array
from btlang.support.record import Record
from btlang.text.source import Source

_MOVES = ("revolute", "continuous", "prismatic")
_RIGID = ("fixed", "floating", "planar")
_AROUND = pi  # radians to both sides of a joint without limits
_ENDLESS = 100.0  # radians: a limit so far away is none
_SPEED, _SLIDING_SPEED = 1.0, 0.1  # of a joint without a velocity, in radians or metres per second
_SAME = 1e-6  # metres
_THINNEST = 0.001  # metres, of a capsule in a robot file
_MOST_LISTED = 5  # meshes in a note
_RIM = np.array([[cos(step * pi / 8), sin(step * pi / 8), 0.0] for step in range(16)])
_WIDTH = 0.2  # metres, where the base has no shape
_SCANNERS = ("ray", "gpu_ray", "lidar", "gpu_lidar")
_SCANNER_LINK = re.compile("lidar|laser|base_scan|rplidar", re.IGNORECASE)
_RANGE = 8.0  # metres that a scanner sees if the file doesn't say it
_BODY_SCANS = 2.0  # metres around the robot in which it recognises things by its scanner


class Skeleton(Record):
    """The joints, shapes, wheels and scanners of a URDF file, and a line for each thing that a user should check."""

    name: str
    joints: tuple[Joint, ...]
    capsules: tuple[Capsule, ...]
    radius: float = _WIDTH
    drive: Drive | None = None
    gap: float | None = None
    scanners: tuple[Sensor, ...] = ()
    notes: tuple[str, ...] = ()

    def toml(self, more: Iterable[str] = ()) -> str:
        """Return a robot file, to be completed by hand, with `more` lines about the whole robot."""
        lines = [f"# Check: {' '.join(note.split())}" for note in self.notes]
        lines += [f"name = {_quote(self.name)}", f"radius = {self.radius:.4g}", *more, ""]
        if self.gap is not None:
            lines += [*describe_base(self.drive or Drive(), self.gap), ""]
            lines += ["[navigation]", f"objects = {self.radius + 0.3:.4g}", f"people = {self.radius + 0.6:.4g}", ""]
        for scanner in self.scanners:
            lines += ["[[sensors]]", f"kind = {_quote(scanner.kind)}", f"frame = {_quote(scanner.frame)}"]
            keys = ("range", "view", "angle", "ahead", "left", "recognizes")
            lines += [*(f"{key} = {getattr(scanner, key):.6g}" for key in keys), ""]
        if self.joints:
            lines += [
                "# Give joints of one part of the body, such as an arm, the same `part`, and all an `acceleration`"
            ]
            lines += ["# and a `jerk`: URDF has none of these. `forbidden` are pairs of links that may not touch.", ""]
        for joint in self.joints:
            lines += ["[[joints]]", f"name = {_quote(joint.name)}", f"part = {_quote(joint.part)}"]
            lines += [f"{key} = {getattr(joint, key):.9g}" for key in ("low", "high", "speed", "rest")]
            lines += ["slides = true"] if joint.slides else []
            lines += [f"link = {_quote(joint.link)}", f"parent = {_quote(joint.parent or BASE)}"]
            lines += [f"at = {_format_list(joint.at)}", f"axis = {_format_list(joint.axis)}", ""]
        for capsule in self.capsules:
            lines += [
                "[[capsules]]",
                f"link = {_quote(capsule.link or BASE)}",
                f"start = {_format_list(capsule.start)}",
            ]
            lines += [f"end = {_format_list(capsule.end)}", f"radius = {capsule.radius:.9g}", ""]
        return "\n".join(lines)


class _Extent(Record):
    """How large a shape is: its middle, half its length, the radius around that, and points around all of it."""

    middle: Array
    along: Array
    radius: float
    outline: Array


def read_urdf(source: Source) -> Skeleton:
    """Return the moving joints, with the links between them in one piece. Shapes become capsules around them.

    Wheels are a base and no joints. Raises BodyError.
    """
    return _UrdfReader(source).skeleton()


class _UrdfReader:
    def __init__(self, source: Source) -> None:
        self._file, self._path = UrdfFile(source), source.name
        if self._file.root.tag == "mujoco":
            self._file.root = robot_of_mjcf(self._file.root, self._file.wrong)
        self._notes: list[str] = []
        self._reach = 0.0
        """How far the base reaches from its axis, in metres."""
        self._meshes: dict[str, str] = {}
        """The links of meshes that can't be read."""

    def skeleton(self) -> Skeleton:
        file, root = self._file, self._file.root
        links = {file.name(link, "name"): link for link in root.all("link")}
        joints = {file.name(joint, "name"): joint for joint in root.all("joint")}
        for joint in joints.values():
            self._end(joint, "parent", links)
        ways = {self._end(joint, "child", links): joint for joint in joints.values()}
        roots = [name for name in links if name not in ways]
        if len(roots) != 1:
            raise file.wrong(root, f"one link must have no joint that moves it; {len(roots) or 'no'} links have none")
        plugin = plugin_drive(file)
        children = {name: self._end(joint, "child", links) for name, joint in joints.items()}
        wheels = wheel_joints(joints, children, plugin[1] if plugin else frozenset())
        carried: dict[str, tuple[str, Array, Array]] = {roots[0]: ("", np.eye(3), np.zeros(3))}
        """For each link, our link that it is a part of, and its rotation and position with all joints at 0."""
        starts: dict[str, Array] = {"": np.zeros(3)}
        found: list[Joint] = []
        for joint in self._order(ways, roots[0], links, root):
            parent, child = self._end(joint, "parent", links), self._end(joint, "child", links)
            whole, turned, at = carried[parent]
            shift, turn = self._origin(joint)
            at, turned = at + turned @ shift, turned @ turn
            if file.name(joint, "name") not in wheels and self._moves(joint):
                made = self._joint(joint, child, whole, at - starts[whole], turned)
                found.append(made)
                whole, starts[made.link] = made.link, at
            carried[child] = whole, turned, at
        shapes = [
            capsule
            for name, link in links.items()
            for capsule in self._capsules(name, link, *carried[name], starts[carried[name][0]])
        ]
        at_wheels = {f"{name} {children[name]}": _vector(carried[children[name]][2]) for name in wheels}
        drive, gap = self._drive(plugin[0] if plugin else Drive(), at_wheels)
        scanners = tuple(self._scanners(carried))
        radius = self._reach
        if radius < 0.01:
            self._notes.append(f"the base has no shape that can be read, so its radius of {_WIDTH:g} m is a guess")
            radius = _WIDTH
        if self._meshes:
            listed = [f"{os.path.basename(mesh)} ({link})" for mesh, link in self._meshes.items()]
            others = f" and {len(listed) - _MOST_LISTED} others" if len(listed) > _MOST_LISTED else ""
            self._notes.append(
                f"these meshes have no shape here, as they aren't STL or OBJ files in the folder of this package: "
                f"{', '.join(listed[:_MOST_LISTED])}{others}"
            )
        if file.has_expressions:
            self._notes.append("names are without expressions such as ${namespace}, which a launch file fills in")
        name = _from_urdf_name(root.attributes.get("name") or "robot")
        return Skeleton(
            name, tuple(found), tuple(shapes), min(ceil(radius * 1000 - _SAME) / 1000, 10.0), drive, gap, scanners,
            tuple(self._notes),
        )  # fmt: skip

    def _order(
        self, ways: Mapping[str, UrdfElement], root: str, links: Mapping[str, UrdfElement], top: UrdfElement
    ) -> Iterator[UrdfElement]:
        below: dict[str, list[str]] = {}
        for child, joint in ways.items():
            below.setdefault(self._end(joint, "parent", links), []).append(child)
        left, seen = [root], 1
        while left:
            for child in below.get(left.pop(0), ()):
                left.append(child)
                seen += 1
                yield ways[child]
        if seen < len(links):
            raise self._file.wrong(top, "some links aren't joined to the others: their joints form a circle")

    def _moves(self, joint: UrdfElement) -> bool:
        kind = self._file.name(joint, "type")
        if kind not in (*_MOVES, *_RIGID):
            listed = ", ".join((*_MOVES, *_RIGID))
            raise self._file.wrong(joint, f'a joint of the type "{kind}" can\'t be read; write one of {listed}')
        name, limit = self._file.name(joint, "name"), joint.first("limit")
        if kind in ("revolute", "prismatic") and limit is not None:
            low, high = (self._file.number(limit, key, 0.0) for key in ("lower", "upper"))
            if low == high:
                self._notes.append(f'the joint "{name}" has no room to move, so it is rigid')
                return False
        if kind in ("floating", "planar"):
            self._notes.append(f'the joint "{name}" is {kind}, so it is rigid here')
        return kind in _MOVES

    def _joint(self, joint: UrdfElement, child: str, whole: str, at: Array, turned: Array) -> Joint:
        file, kind, name = self._file, self._file.name(joint, "type"), self._file.name(joint, "name")
        limit = joint.first("limit")
        if limit is None and kind != "continuous":
            raise file.wrong(joint, f'the joint "{name}" needs a <limit> with lower, upper and velocity')
        slides = kind == "prismatic"
        unit = 1.0 if slides else 180 / pi
        low, high, speed = -_AROUND, _AROUND, 0.0
        if limit is not None:
            speed = file.number(limit, "velocity", 0.0)
            if kind != "continuous":
                low, high = file.number(limit, "lower", 0.0), file.number(limit, "upper", 0.0)
        if not slides and max(abs(low), abs(high)) > _ENDLESS:
            low, high = -_AROUND, _AROUND
        if limit is not None and (low > high or speed < 0.0):
            raise file.wrong(limit, f'the <limit> of the joint "{name}" leaves it no room to move')
        if not speed:
            speed = _SLIDING_SPEED if slides else _SPEED
            pace = f"{speed:g} m/s" if slides else f"{speed * unit:.0f} degrees per second"
            self._notes.append(f'the joint "{name}" has no top speed; {pace} is a guess')
        mimic = joint.first("mimic")
        if mimic is not None:
            self._notes.append(f'the joint "{name}" moves by itself here, and not with "{file.name(mimic, "joint")}"')
        axis = joint.first("axis")
        way = turned @ np.array(file.vector(axis, "xyz", (1.0, 0.0, 0.0)) if axis is not None else (1.0, 0.0, 0.0))
        if np.linalg.norm(way) < _SAME:
            raise file.wrong(axis or joint, f'the axis of the joint "{name}" points nowhere')
        said = _from_urdf_name(name)
        return Joint(
            said, said, low * unit, high * unit, speed * unit, min(max(0.0, low * unit), high * unit), slides,
            link=_link_name(child), parent=whole, at=_vector(at), axis=_vector(way / np.linalg.norm(way)),
        )  # fmt: skip

    def _capsules(
        self, name: str, link: UrdfElement, whole: str, turned: Array, at: Array, start: Array
    ) -> Iterator[Capsule]:
        found: list[Capsule] = []
        for collision in link.all("collision") or link.all("visual"):
            shift, turn = self._origin(collision)
            corner, turn = at - start + turned @ shift, turned @ turn
            for shape in (shape for geometry in collision.all("geometry") for shape in geometry.inner):
                extent = self._extent(shape, name)
                if extent is not None:
                    one, other = (corner + turn @ (extent.middle + way) for way in (-extent.along, extent.along))
                    found.append(Capsule(whole, _vector(one), _vector(other), max(extent.radius, _THINNEST)))
                    outline = corner + extent.outline @ turn.T
                    reach = float(np.hypot(outline[:, 0], outline[:, 1]).max())
                    self._reach = self._reach if whole else max(self._reach, reach)
        long = [capsule for capsule in found if capsule.start != capsule.end]
        for capsule in found:
            if capsule in long or not any(_is_end(capsule, other) for other in long):
                yield capsule

    def _extent(self, shape: UrdfElement, link: str) -> _Extent | None:
        """Return how large a shape is; None for a mesh that can't be read, and for an unknown shape."""
        middle = along = np.zeros(3)
        if shape.tag == "sphere":
            radius = abs(self._file.number(shape, "radius"))
            return _Extent(middle, along, radius, radius * np.vstack([_RIM, _RIM[:, [0, 2, 1]], _RIM[:, [2, 0, 1]]]))
        if shape.tag in ("cylinder", "capsule"):
            along = np.array([0.0, 0.0, abs(self._file.number(shape, "length")) / 2])
            radius = abs(self._file.number(shape, "radius"))
            return _Extent(middle, along, radius, np.vstack([radius * _RIM - along, radius * _RIM + along]))
        if shape.tag == "box":
            half = np.abs(self._file.vector(shape, "size")) / 2
            return _box(-half, half)
        if shape.tag != "mesh":
            return None
        name = self._file.name(shape, "filename")
        bounds = mesh_bounds(name, self._path)
        if bounds is None:
            self._meshes.setdefault(name, link)
            return None
        scale = np.array(self._file.vector(shape, "scale", (1.0, 1.0, 1.0)))
        ends = bounds[0] * scale, bounds[1] * scale
        return _box(np.minimum(*ends), np.maximum(*ends))

    def _drive(self, drive: Drive, wheels: Mapping[str, Vector]) -> tuple[Drive | None, float | None]:
        """Return what is known of the base, and the distance between its wheels; None without wheels."""
        gap = drive.gap or gap_between(wheels)
        if not wheels and gap is None:
            return None, None
        if gap is None:
            self._notes.append("no two wheels are beside each other, so there is no [base]")
            return drive, None
        where = f'as the plugin "{drive.plugin}" has it' if drive.gap else "by the places of their joints"
        radius = f", {drive.wheel_radius:g} m in radius" if drive.wheel_radius else ""
        self._notes.append(f"the wheels are {gap:g} m apart{radius}, {where}")
        guessed = ["speeds"] if drive.speed is None else []
        guessed += ["accelerations"] if drive.acceleration is None else []
        if guessed:
            self._notes.append(f"the {' and '.join(guessed)} of the base are guesses")
        return drive, gap

    def _scanners(self, carried: Mapping[str, tuple[str, Array, Array]]) -> Iterator[Sensor]:
        """Yield the scanners that Gazebo simulates; without any, one at a link that is called so."""
        found = False
        for gazebo in self._file.root.all("gazebo"):
            for sensor in gazebo.all("sensor"):
                link = gazebo.attributes.get("reference", "")
                if sensor.attributes.get("type") in _SCANNERS and link in carried and not carried[link][0]:
                    found = True
                    yield self._scanner(link, carried, sensor)
        link = next((name for name, place in carried.items() if _SCANNER_LINK.search(name) and not place[0]), "")
        if link and not found:
            self._notes.append(f'the link "{link}" is taken for a laser scanner that sees {_RANGE:g} m')
            yield self._scanner(link, carried, None)

    def _scanner(
        self, link: str, carried: Mapping[str, tuple[str, Array, Array]], sensor: UrdfElement | None
    ) -> Sensor:
        _, turned, at = carried[link]
        reach, view = _RANGE, 360.0
        if sensor is not None:
            ranges = next(sensor.below("range"), sensor)
            reach = value_of(ranges, ("max",), lambda value: 0.1 <= value <= 1000.0) or _RANGE
            low, high = (
                value_of(sensor, (key,), lambda value: abs(value) <= 7.0) for key in ("min_angle", "max_angle")
            )
            if low is not None and high is not None and high > low:
                view = min(360.0, max(1.0, degrees(high - low)))
        angle = degrees(atan2(turned[1, 0], turned[0, 0]))
        x, y, _ = _vector(at)
        return Sensor("scanner", link, reach, view, round(angle, 3) + 0.0, "", min(reach, _BODY_SCANS), x, y)

    def _origin(self, element: UrdfElement) -> tuple[Array, Array]:
        origin = element.first("origin")
        if origin is None:
            return np.zeros(3), np.eye(3)
        roll, pitch, yaw = self._file.vector(origin, "rpy", (0.0, 0.0, 0.0))
        shift = np.array(self._file.vector(origin, "xyz", (0.0, 0.0, 0.0)))
        return shift, _around(2, yaw) @ _around(1, pitch) @ _around(0, roll)

    def _end(self, joint: UrdfElement, tag: str, links: Mapping[str, UrdfElement]) -> str:
        end = joint.first(tag)
        if end is None:
            raise self._file.wrong(joint, f"a joint needs a <{tag}> link")
        name = self._file.name(end, "link")
        if name not in links:
            raise self._file.wrong(end, f'there is no link "{name}"')
        return name


def _box(low: Array, high: Array) -> _Extent:
    sides = high - low
    longest = int(np.argmax(sides))
    along = np.zeros(3)
    along[longest] = sides[longest] / 2
    radius = sqrt(float(np.sum(np.delete(sides, longest) ** 2))) / 2
    corners = np.array([[(low, high)[bits >> axis & 1][axis] for axis in range(3)] for bits in range(8)])
    return _Extent((low + high) / 2, along, radius, corners)


def _is_end(sphere: Capsule, other: Capsule) -> bool:
    apart = min(float(np.linalg.norm(np.subtract(sphere.start, end))) for end in (other.start, other.end))
    return apart < _SAME and abs(sphere.radius - other.radius) < _SAME


def _around(axis: int, angle: float) -> Array:
    first, second = [(1, 2), (2, 0), (0, 1)][axis]
    found = np.eye(3)
    found[first, first] = found[second, second] = cos(angle)
    found[first, second], found[second, first] = -sin(angle), sin(angle)
    return found


def _vector(values: Array) -> Vector:
    x, y, z = (round(float(value), 9) + 0.0 for value in values)
    return x, y, z


def _from_urdf_name(name: str) -> str:
    return " ".join(name.replace("_", " ").split()) or name


def _link_name(name: str) -> str:
    return f"moving {BASE}" if _from_urdf_name(name) == BASE else _from_urdf_name(name)


def _quote(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


def _format_list(vector: Vector) -> str:
    return f"[{', '.join(f'{value:.9g}' for value in vector)}]"
