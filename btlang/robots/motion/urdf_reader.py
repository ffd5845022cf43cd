"""URDF files of other programs, as joints and capsules of a robot file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import cos, isfinite, pi, sin, sqrt
from xml.parsers import expat

import numpy as np

from btlang.robots.body import Capsule, Joint, Vector
from btlang.robots.body_file import BodyError
from btlang.robots.joint_tables import BASE
from btlang.robots.motion.kinematics import Array
from btlang.support.record import Record
from btlang.text.source import Source

_MOVES = ("revolute", "continuous", "prismatic")
_KINDS = (*_MOVES, "fixed")
_AROUND = pi  # radians to both sides of a joint without limits
_SAME = 1e-6  # metres
_WIDTH = 0.2  # metres, where the base has no shape
_MOST = 1e6


class _Element:
    """A tag with its line."""

    def __init__(self, tag: str, attributes: dict[str, str], line: int) -> None:
        self.tag, self.attributes, self.line = tag, attributes, line
        self.inner: list[_Element] = []

    def all(self, tag: str) -> list[_Element]:
        return [element for element in self.inner if element.tag == tag]

    def first(self, tag: str) -> _Element | None:
        return next(iter(self.all(tag)), None)


class Skeleton(Record):
    """What a URDF file says of a body."""

    name: str
    joints: tuple[Joint, ...]
    capsules: tuple[Capsule, ...]

    @property
    def toml(self) -> str:
        """As a robot file, to be completed."""
        radii = [capsule.radius for capsule in self.capsules if not capsule.link]
        yields = [f"name = {_quoted(self.name)}", f"radius = {max(radii, default=_WIDTH):g}", ""]
        yields += ["# Give joints of one part of the body, such as an arm, the same `part`, and all an `acceleration`"]
        yields += ["# and a `jerk`: URDF has none of these. `forbidden` are pairs of links that may not touch.", ""]
        for joint in self.joints:
            yields += ["[[joints]]", f"name = {_quoted(joint.name)}", f"part = {_quoted(joint.part)}"]
            yields += [f"{key} = {getattr(joint, key):.9g}" for key in ("low", "high", "speed", "rest")]
            yields += ["slides = true"] if joint.slides else []
            yields += [f"link = {_quoted(joint.link)}", f"parent = {_quoted(joint.parent or BASE)}"]
            yields += [f"at = {_listed(joint.at)}", f"axis = {_listed(joint.axis)}", ""]
        for capsule in self.capsules:
            yields += ["[[capsules]]", f"link = {_quoted(capsule.link or BASE)}", f"start = {_listed(capsule.start)}"]
            yields += [f"end = {_listed(capsule.end)}", f"radius = {capsule.radius:.9g}", ""]
        return "\n".join(yields)


def read_urdf(source: Source) -> Skeleton:
    """Its joints that move, with the links between them in one piece. Shapes become capsules around them.

    Raises BodyError.
    """
    return _Reader(source).skeleton()


class _Reader:
    def __init__(self, source: Source) -> None:
        self._source = source

    def skeleton(self) -> Skeleton:
        root = self._parsed()
        if root.tag != "robot":
            raise self._wrong(root, f"this isn't URDF: it begins with <{root.tag}>, not with <robot>")
        links = {self._text(link, "name"): link for link in root.all("link")}
        joints = {self._text(joint, "name"): joint for joint in root.all("joint")}
        for joint in joints.values():
            self._end(joint, "parent", links)
        ways = {self._end(joint, "child", links): joint for joint in joints.values()}
        roots = [name for name in links if name not in ways]
        if len(roots) != 1:
            raise self._wrong(root, f"one link must have no joint that moves it; {len(roots) or 'no'} links have none")
        carried: dict[str, tuple[str, Array, Array]] = {roots[0]: ("", np.eye(3), np.zeros(3))}
        """By link, the link of ours that it is a piece of; how it is turned and where it is with all joints at 0."""
        starts: dict[str, Array] = {"": np.zeros(3)}
        found: list[Joint] = []
        for joint in self._ordered(ways, roots[0], links, root):
            parent, child = self._end(joint, "parent", links), self._end(joint, "child", links)
            whole, turned, at = carried[parent]
            shift, turn = self._origin(joint)
            at, turned = at + turned @ shift, turned @ turn
            if self._kind(joint) in _MOVES:
                made = self._joint(joint, child, whole, at - starts[whole], turned)
                found.append(made)
                whole, starts[made.link] = made.link, at
            carried[child] = whole, turned, at
        shapes = [
            capsule
            for name, link in links.items()
            for capsule in self._capsules(link, *carried[name], starts[carried[name][0]])
        ]
        return Skeleton(_named(root.attributes.get("name") or "robot"), tuple(found), tuple(shapes))

    def _parsed(self) -> _Element:
        parser, stack, roots = expat.ParserCreate(), list[_Element](), list[_Element]()

        def start(tag: str, attributes: dict[str, str]) -> None:
            element = _Element(tag, attributes, parser.CurrentLineNumber)
            (stack[-1].inner if stack else roots).append(element)
            stack.append(element)

        def doctype(*_: object) -> None:
            raise BodyError(
                "a URDF file has no DOCTYPE; remove it", self._source.name, parser.CurrentLineNumber, self._source
            )

        parser.StartElementHandler, parser.EndElementHandler = start, lambda tag: stack.pop()
        parser.StartDoctypeDeclHandler = doctype
        try:
            parser.Parse(self._source.text.encode(errors="replace"), True)
        except expat.ExpatError as problem:
            says = expat.errors.messages.get(problem.code, "it can't be read")
            raise self._wrong_at(problem.lineno, f"this isn't XML: {says}") from None
        return roots[0]

    def _ordered(
        self, ways: Mapping[str, _Element], root: str, links: Mapping[str, _Element], top: _Element
    ) -> Iterator[_Element]:
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
            raise self._wrong(top, "some links aren't joined to the others: their joints form a circle")

    def _joint(self, joint: _Element, child: str, whole: str, at: Array, turned: Array) -> Joint:
        kind, name, limit = self._kind(joint), self._text(joint, "name"), joint.first("limit")
        if limit is None:
            raise self._wrong(joint, f'the joint "{name}" needs a <limit> with lower, upper and velocity')
        slides = kind == "prismatic"
        unit = 1.0 if slides else 180 / pi
        low, high = (-_AROUND, _AROUND) if kind == "continuous" else (
            self._number(limit, "lower"), self._number(limit, "upper")
        )  # fmt: skip
        speed = self._number(limit, "velocity")
        if low > high or speed <= 0.0:
            raise self._wrong(limit, f'the <limit> of the joint "{name}" leaves it no room to move')
        axis = joint.first("axis")
        way = turned @ np.array(self._vector(axis, "xyz", (1.0, 0.0, 0.0)) if axis is not None else (1.0, 0.0, 0.0))
        if np.linalg.norm(way) < _SAME:
            raise self._wrong(axis or joint, f'the axis of the joint "{name}" points nowhere')
        said = _named(name)
        return Joint(
            said, said, low * unit, high * unit, speed * unit, min(max(0.0, low * unit), high * unit), slides,
            link=_link(child), parent=whole, at=_vector(at), axis=_vector(way / np.linalg.norm(way)),
        )  # fmt: skip

    def _capsules(self, link: _Element, whole: str, turned: Array, at: Array, start: Array) -> Iterator[Capsule]:
        found: list[Capsule] = []
        for collision in link.all("collision"):
            shift, turn = self._origin(collision)
            middle, turn = at - start + turned @ shift, turned @ turn
            for shape in (shape for geometry in collision.all("geometry") for shape in geometry.inner):
                along, radius = self._extent(shape)
                if radius > 0.0:
                    ends = _vector(middle - turn @ along), _vector(middle + turn @ along)
                    found.append(Capsule(whole, *ends, radius))
        long = [capsule for capsule in found if capsule.start != capsule.end]
        for capsule in found:
            if capsule in long or not any(_is_end(capsule, other) for other in long):
                yield capsule

    def _extent(self, shape: _Element) -> tuple[Array, float]:
        """Half of its length, and the radius around it; 0 for a mesh, which needs capsules by hand."""
        if shape.tag == "sphere":
            return np.zeros(3), self._size(shape, "radius")
        if shape.tag in ("cylinder", "capsule"):
            return np.array([0.0, 0.0, self._size(shape, "length") / 2]), self._size(shape, "radius")
        if shape.tag == "box":
            sides = np.abs(self._vector(shape, "size"))
            longest = int(np.argmax(sides))
            along = np.zeros(3)
            along[longest] = sides[longest] / 2
            return along, sqrt(float(np.sum(np.delete(sides, longest) ** 2))) / 2
        return np.zeros(3), 0.0

    def _origin(self, element: _Element) -> tuple[Array, Array]:
        origin = element.first("origin")
        if origin is None:
            return np.zeros(3), np.eye(3)
        roll, pitch, yaw = self._vector(origin, "rpy", (0.0, 0.0, 0.0))
        shift = np.array(self._vector(origin, "xyz", (0.0, 0.0, 0.0)))
        return shift, _around(2, yaw) @ _around(1, pitch) @ _around(0, roll)

    def _kind(self, joint: _Element) -> str:
        kind = self._text(joint, "type")
        if kind not in _KINDS:
            raise self._wrong(joint, f'a joint of the type "{kind}" can\'t be read; write one of {", ".join(_KINDS)}')
        return kind

    def _end(self, joint: _Element, tag: str, links: Mapping[str, _Element]) -> str:
        end = joint.first(tag)
        if end is None:
            raise self._wrong(joint, f"a joint needs a <{tag}> link")
        name = self._text(end, "link")
        if name not in links:
            raise self._wrong(end, f'there is no link "{name}"')
        return name

    def _text(self, element: _Element, name: str) -> str:
        if not element.attributes.get(name, "").strip():
            raise self._wrong(element, f'<{element.tag}> needs "{name}"')
        return element.attributes[name]

    def _number(self, element: _Element, name: str) -> float:
        return self._numbers(element, name, 1)[0]

    def _size(self, element: _Element, name: str) -> float:
        return abs(self._number(element, name))

    def _vector(self, element: _Element, name: str, usual: Vector | None = None) -> Sequence[float]:
        return usual if usual is not None and name not in element.attributes else self._numbers(element, name, 3)

    def _numbers(self, element: _Element, name: str, count: int) -> list[float]:
        try:
            found = [float(part) for part in self._text(element, name).split()]
        except ValueError:
            found = []
        if len(found) != count or not all(isfinite(value) and abs(value) <= _MOST for value in found):
            wanted = "a number" if count == 1 else f"{count} numbers"
            raise self._wrong(element, f'"{name}" of <{element.tag}> must be {wanted}')
        return found

    def _wrong(self, element: _Element, message: str) -> BodyError:
        return self._wrong_at(element.line, message)

    def _wrong_at(self, line: int, message: str) -> BodyError:
        return BodyError(message, self._source.name, line, self._source)


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


def _named(name: str) -> str:
    return " ".join(name.replace("_", " ").split()) or name


def _link(name: str) -> str:
    return f"moving {BASE}" if _named(name) == BASE else _named(name)


def _quoted(text: str) -> str:
    import json

    return json.dumps(text, ensure_ascii=False)


def _listed(vector: Vector) -> str:
    return f"[{', '.join(f'{value:.9g}' for value in vector)}]"
