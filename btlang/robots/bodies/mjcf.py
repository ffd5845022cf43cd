"""MJCF, the format of MuJoCo, as the tags of URDF: bodies, hinges, slides and simple shapes of one robot.

Classes of defaults, units of angles and meshes are read. What a file takes from others, or makes many of, isn't.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from math import asin, atan2, hypot, radians

import numpy as np

from btlang.robots.bodies.body_file import BodyError
from btlang.robots.bodies.urdf_elements import UrdfElement
from btlang.robots.motion.kinematics import Array

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    Wrong: TypeAlias = Callable[[UrdfElement, str], BodyError]

_SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "box": 3, "ellipsoid": 3}  # numbers of `size`
_SPANNED = ("capsule", "cylinder")  # shapes that `fromto` may give
_UNREAD = ("include", "attach", "replicate", "composite", "flexcomp", "frame")
_SAVE = "load it in MuJoCo and save it with mujoco.mj_saveLastXML"
_TURNS = ("quat", "euler", "axisangle", "xyaxes", "zaxis")
_UP = np.array([0.0, 0.0, 1.0])
_TINY = 1e-9


def robot_of_mjcf(root: UrdfElement, wrong: Wrong) -> UrdfElement:
    """Return the <robot> that an MJCF file describes, with the lines of its tags. Raises BodyError."""
    return _Mjcf(root, wrong).robot()


class _Mjcf:
    def __init__(self, root: UrdfElement, wrong: Wrong) -> None:
        self._root, self._wrong = root, wrong
        for tag in root.below(*_UNREAD):
            raise wrong(tag, f"<{tag.tag}> of MJCF can't be read; {_SAVE}")
        compiler = root.first("compiler")
        settings = compiler.attributes if compiler is not None else {}
        self._in_degrees = settings.get("angle", "degree") == "degree"
        self._eulers = settings.get("eulerseq", "xyz")
        self._folder = settings.get("meshdir", settings.get("assetdir", ""))
        self._classes: dict[str, dict[str, dict[str, str]]] = {}
        for default in root.all("default"):
            self._read_defaults(default, "main", {})
        self._meshes = {
            mesh.attributes.get("name") or os.path.splitext(os.path.basename(file))[0]: mesh
            for assets in root.all("asset")
            for mesh in assets.all("mesh")
            if (file := mesh.attributes.get("file", ""))
        }
        self._robot = UrdfElement("robot", {"name": root.attributes.get("model", "robot")}, root.line)

    def robot(self) -> UrdfElement:
        tops = [body for world in self._root.all("worldbody") for body in world.all("body")]
        robots = [body for body in tops if any(True for _ in body.below("body", "joint", "freejoint"))]
        if len(robots or tops) != 1:
            counted = f"{len(robots or tops) or 'no'} bodies"
            raise self._wrong(self._root, f"the <worldbody> has {counted} that may be the robot; leave one in it")
        left = [(body, "", "") for body in robots or tops]
        while left:
            body, parent, outer = left.pop()
            own = body.attributes.get("childclass", outer)
            name = body.attributes.get("name") or f"body {len(self._robot.all('link')) + 1}"
            self._add_body(body, name, parent, own)
            left += [(inner, name, own) for inner in reversed(body.all("body"))]
        return self._robot

    def _read_defaults(self, default: UrdfElement, name: str, outer: Mapping[str, dict[str, str]]) -> None:
        """Note the attributes of a class, and of those inside it, which have them, too."""
        found = {tag: dict(attributes) for tag, attributes in outer.items()}
        for tag in default.inner:
            if tag.tag != "default":
                found[tag.tag] = found.get(tag.tag, {}) | tag.attributes
        self._classes[default.attributes.get("class", name)] = self._classes[name] = found
        for inner in default.all("default"):
            self._read_defaults(inner, inner.attributes.get("class", ""), found)

    def _with_defaults(self, tag: UrdfElement, outer: str) -> UrdfElement:
        known = self._classes.get(tag.attributes.get("class", outer) or "main", {})
        return UrdfElement(tag.tag, known.get(tag.tag, {}) | tag.attributes, tag.line)

    def _add_body(self, body: UrdfElement, name: str, parent: str, outer: str) -> None:
        """Add the link of a body, and its joints: between two of them there is a link without a shape."""
        at, turned = self._vector(body, "pos"), self._turn(body)
        joints = [self._with_defaults(joint, outer) for joint in body.all("joint")] if parent else []
        moving = [joint for joint in joints if joint.attributes.get("type", "hinge") != "free"]
        before, shift = parent, np.zeros(3)
        for number, joint in enumerate(moving):
            pivot = self._vector(joint, "pos")
            step = at + turned @ pivot if number == 0 else pivot - shift
            child = name if number == len(moving) - 1 and not pivot.any() else f"{name} {number + 1}"
            self._add_joint(joint, before, child, step, turned if number == 0 else np.eye(3))
            if child != name:
                self._add("link", body, name=child)
            before, shift = child, pivot
        if parent and before != name:
            at, turned = (-shift, np.eye(3)) if moving else (at, turned)
            fixed = self._add("joint", body, name=f"{name} fixed", type="fixed")
            _add_ends(fixed, before, name, at, turned)
        link = self._add("link", body, name=name)
        for geom in body.all("geom"):
            self._add_shape(link, self._with_defaults(geom, outer))

    def _add_joint(self, joint: UrdfElement, parent: str, child: str, at: Array, turned: Array) -> None:
        kind, limits = joint.attributes.get("type", "hinge"), joint.attributes.get("range", "")
        if kind not in ("hinge", "slide"):
            raise self._wrong(joint, f'a joint of the type "{kind}" can\'t be read; write hinge, slide or free')
        limited = bool(limits) and joint.attributes.get("limited", "auto") != "false"
        types = {"slide": "prismatic", "hinge": "revolute" if limited else "continuous"}
        made = self._add("joint", joint, name=joint.attributes.get("name") or f"{child} joint", type=types[kind])
        _add_ends(made, parent, child, at, turned)
        made.inner.append(UrdfElement("axis", {"xyz": joint.attributes.get("axis", "0 0 1")}, joint.line))
        if limited:
            low, high = self._numbers(joint, "range", limits, 2)
            if kind == "hinge" and self._in_degrees:
                low, high = radians(low), radians(high)
            made.inner.append(UrdfElement("limit", {"lower": f"{low:.12g}", "upper": f"{high:.12g}"}, joint.line))

    def _add_shape(self, link: UrdfElement, geom: UrdfElement) -> None:
        kind = geom.attributes.get("type", "mesh" if "mesh" in geom.attributes else "sphere")
        made = self._mesh(geom) if kind == "mesh" else self._primitive(geom, kind) if kind in _SIZES else None
        if made is None:
            return  # a plane, a height field or a signed distance function is no part of a robot
        shape, at, turned = made
        touches = any(geom.attributes.get(key, "1") != "0" for key in ("contype", "conaffinity"))
        solid = UrdfElement("collision" if touches else "visual", {}, geom.line)
        geometry = UrdfElement("geometry", {}, geom.line)
        geometry.inner.append(shape)
        solid.inner += (_origin(at, turned, geom.line), geometry)
        link.inner.append(solid)

    def _mesh(self, geom: UrdfElement) -> tuple[UrdfElement, Array, Array]:
        name = geom.attributes.get("mesh", "")
        mesh = self._meshes.get(name)
        if mesh is None:
            raise self._wrong(geom, f'there is no mesh "{name}"')
        attributes = {"filename": os.path.join(self._folder, mesh.attributes["file"])}
        attributes |= {key: mesh.attributes[key] for key in ("scale",) if key in mesh.attributes}
        return UrdfElement("mesh", attributes, geom.line), self._vector(geom, "pos"), self._turn(geom)

    def _primitive(self, geom: UrdfElement, kind: str) -> tuple[UrdfElement, Array, Array]:
        ends = geom.attributes.get("fromto", "") if kind in _SPANNED else ""
        at, turned = self._vector(geom, "pos"), self._turn(geom)
        size = self._numbers(geom, "size", geom.attributes.get("size", ""), 1 if ends else _SIZES[kind])
        if ends:
            values = np.array(self._numbers(geom, "fromto", ends, 6))
            at, along = (values[:3] + values[3:]) / 2, values[3:] - values[:3]
            size, turned = [size[0], float(np.linalg.norm(along)) / 2], _towards(along)
        if kind in ("box", "ellipsoid"):
            attributes = {"size": " ".join(f"{2 * side:.12g}" for side in size)}
        else:
            attributes = {"radius": f"{size[0]:.12g}"} | ({"length": f"{2 * size[1]:.12g}"} if len(size) > 1 else {})
        return UrdfElement("box" if kind == "ellipsoid" else kind, attributes, geom.line), at, turned

    def _add(self, tag: str, source: UrdfElement, **attributes: str) -> UrdfElement:
        made = UrdfElement(tag, attributes, source.line)
        self._robot.inner.append(made)
        return made

    def _vector(self, element: UrdfElement, name: str) -> Array:
        return np.array(self._numbers(element, name, element.attributes.get(name, "0 0 0"), 3))

    def _numbers(self, element: UrdfElement, name: str, text: str, count: int) -> list[float]:
        """Return the first numbers of an attribute; a size may have more than its shape needs."""
        try:
            found = [float(part) for part in text.split()]
        except ValueError:
            found = []
        if len(found) < count or not np.isfinite(found).all():
            raise self._wrong(element, f'"{name}" of <{element.tag}> must be {count} numbers')
        return found[:count]

    def _turn(self, element: UrdfElement) -> Array:
        """Return how a body or shape is turned, as a matrix."""
        way = next((key for key in _TURNS if key in element.attributes), "")
        text = element.attributes.get(way, "")
        if way == "quat":
            w, x, y, z = self._numbers(element, way, text, 4)
            return _around(np.array([x, y, z]), 2 * atan2(float(np.linalg.norm([x, y, z])), w))
        if way == "axisangle":
            *axis, angle = self._numbers(element, way, text, 4)
            return _around(np.array(axis), self._angle(angle))
        if way == "zaxis":
            return _towards(np.array(self._numbers(element, way, text, 3)))
        if way == "xyaxes":
            values = np.array(self._numbers(element, way, text, 6))
            first = _unit(values[:3])
            second = _unit(values[3:] - first * float(first @ values[3:]))
            return np.column_stack([first, second, np.cross(first, second)])
        turned = np.eye(3)
        for letter, angle in zip(self._eulers, self._numbers(element, way, text, 3) if way else (), strict=False):
            one = _around(np.eye(3)["xyz".index(letter.lower())], self._angle(angle))
            turned = turned @ one if letter.islower() else one @ turned
        return turned

    def _angle(self, angle: float) -> float:
        return radians(angle) if self._in_degrees else angle


def _add_ends(joint: UrdfElement, parent: str, child: str, at: Array, turned: Array) -> None:
    ends = (UrdfElement(tag, {"link": link}, joint.line) for tag, link in (("parent", parent), ("child", child)))
    joint.inner += (*ends, _origin(at, turned, joint.line))


def _origin(at: Array, turned: Array, line: int) -> UrdfElement:
    """Return the place of a tag, with the roll, pitch and yaw of a matrix."""
    pitch = asin(max(-1.0, min(1.0, -float(turned[2, 0]))))
    if hypot(turned[2, 1], turned[2, 2]) > _TINY:
        roll, yaw = atan2(turned[2, 1], turned[2, 2]), atan2(turned[1, 0], turned[0, 0])
    else:
        roll, yaw = 0.0, atan2(-turned[0, 1], turned[1, 1])
    return UrdfElement("origin", {"xyz": _spell(at), "rpy": _spell((roll, pitch, yaw))}, line)


def _spell(values: Array | tuple[float, ...]) -> str:
    return " ".join(f"{float(value) + 0.0:.12g}" for value in values)


def _unit(vector: Array) -> Array:
    length = float(np.linalg.norm(vector))
    return vector / length if length > _TINY else _UP


def _around(axis: Array, angle: float) -> Array:
    """Return the matrix of a turn around an axis (Rodrigues' formula)."""
    x, y, z = _unit(axis)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turned: Array = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    return turned


def _towards(along: Array) -> Array:
    """Return the least turn of the z axis to a direction."""
    way = _unit(along)
    axis = np.cross(_UP, way)
    sideways = float(np.linalg.norm(axis))
    return _around(axis if sideways > _TINY else np.eye(3)[0], atan2(sideways, float(_UP @ way)))
