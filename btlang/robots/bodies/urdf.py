"""The body of a robot file as URDF, the format of ROS, and URDF files of other programs as a body."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import atan2, cos, hypot, isfinite, pi, sin, sqrt
from xml.parsers import expat
from xml.sax.saxutils import quoteattr

import numpy as np

from btlang.robots.bodies.body import Body, Capsule, Joint, Vector
from btlang.robots.bodies.body_file import BodyError
from btlang.robots.bodies.joint_tables import BASE
from btlang.robots.motion.kinematics import Array
from btlang.support.record import Record
from btlang.text.source import Source

ROOT_LINK = "base_link"
_EFFORT = 100  # newton metres: a robot file says nothing of it, and URDF needs it
_THIN = 1e-9  # metres
_MOVES = ("revolute", "continuous", "prismatic")
_KINDS = (*_MOVES, "fixed")
_AROUND = pi  # radians to both sides of a joint without limits
_SAME = 1e-6  # metres
_WIDTH = 0.2  # metres, where the base has no shape
_MOST = 1e6


def urdf(body: Body) -> str:
    """Return a body as the text of a URDF file. Blanks in names become underscores."""
    lines = [f"<robot name={quoteattr(_to_urdf_name(body.name))}>"]
    links = ["", *(joint.link for joint in body.joints if joint.link)]
    for link in links:
        lines += _link(link, [capsule for capsule in body.capsules if capsule.link == link])
    for joint in body.joints:
        if joint.link:
            lines += _joint(joint)
    return "\n".join(['<?xml version="1.0"?>', *lines, "</robot>"]) + "\n"


def _to_urdf_name(name: str) -> str:
    return name.replace(" ", "_")


def _link(link: str, capsules: Iterable[Capsule]) -> Iterator[str]:
    shapes = [shape for capsule in capsules for shape in _shapes(capsule)]
    name = quoteattr(_to_urdf_name(link) or ROOT_LINK)
    if not shapes:
        yield f"  <link name={name}/>"
        return
    yield f"  <link name={name}>"
    for tag in ("visual", "collision"):
        yield from (f"    <{tag}>{shape}</{tag}>" for shape in shapes)
    yield "  </link>"


def _shapes(capsule: Capsule) -> Iterator[str]:
    (ax, ay, az), (bx, by, bz), radius = capsule.start, capsule.end, capsule.radius
    x, y, z = bx - ax, by - ay, bz - az
    length = hypot(x, y, z)
    ends = [capsule.start, capsule.end] if length > _THIN else [capsule.start]
    if length > _THIN:
        middle = ((ax + bx) / 2, (ay + by) / 2, (az + bz) / 2)
        turned = (0.0, atan2(hypot(x, y), z), atan2(y, x))
        yield _shape(middle, f'<cylinder radius="{_number(radius)}" length="{_number(length)}"/>', turned)
    for end in ends:
        yield _shape(end, f'<sphere radius="{_number(radius)}"/>')


def _shape(at: Vector, geometry: str, turned: Vector = (0.0, 0.0, 0.0)) -> str:
    return f'<origin xyz="{_numbers(at)}" rpy="{_numbers(turned)}"/><geometry>{geometry}</geometry>'


def _joint(joint: Joint) -> Iterator[str]:
    kind = "prismatic" if joint.slides else "revolute"
    low, high, speed = (_number(value * joint.si) for value in (joint.low, joint.high, joint.speed))
    yield f'  <joint name={quoteattr(_to_urdf_name(joint.name))} type="{kind}">'
    yield f"    <parent link={quoteattr(_to_urdf_name(joint.parent) or ROOT_LINK)}/>"
    yield f"    <child link={quoteattr(_to_urdf_name(joint.link))}/>"
    yield f'    <origin xyz="{_numbers(joint.at)}" rpy="0 0 0"/>'
    yield f'    <axis xyz="{_numbers(joint.axis)}"/>'
    yield f'    <limit lower="{low}" upper="{high}" velocity="{speed}" effort="{_EFFORT}"/>'
    yield "  </joint>"


def _numbers(vector: Vector) -> str:
    return " ".join(map(_number, vector))


def _number(value: float) -> str:
    return f"{value:.12g}"


class _UrdfElement:
    """A tag with its line."""

    def __init__(self, tag: str, attributes: dict[str, str], line: int) -> None:
        self.tag, self.attributes, self.line = tag, attributes, line
        self.inner: list[_UrdfElement] = []

    def all(self, tag: str) -> list[_UrdfElement]:
        return [element for element in self.inner if element.tag == tag]

    def first(self, tag: str) -> _UrdfElement | None:
        return next(iter(self.all(tag)), None)


class Skeleton(Record):
    """The joints and capsules of a URDF file."""

    name: str
    joints: tuple[Joint, ...]
    capsules: tuple[Capsule, ...]

    @property
    def toml(self) -> str:
        """A robot file, to be completed by hand."""
        radii = [capsule.radius for capsule in self.capsules if not capsule.link]
        yields = [f"name = {_quote(self.name)}", f"radius = {max(radii, default=_WIDTH):g}", ""]
        yields += ["# Give joints of one part of the body, such as an arm, the same `part`, and all an `acceleration`"]
        yields += ["# and a `jerk`: URDF has none of these. `forbidden` are pairs of links that may not touch.", ""]
        for joint in self.joints:
            yields += ["[[joints]]", f"name = {_quote(joint.name)}", f"part = {_quote(joint.part)}"]
            yields += [f"{key} = {getattr(joint, key):.9g}" for key in ("low", "high", "speed", "rest")]
            yields += ["slides = true"] if joint.slides else []
            yields += [f"link = {_quote(joint.link)}", f"parent = {_quote(joint.parent or BASE)}"]
            yields += [f"at = {_format_list(joint.at)}", f"axis = {_format_list(joint.axis)}", ""]
        for capsule in self.capsules:
            yields += [
                "[[capsules]]",
                f"link = {_quote(capsule.link or BASE)}",
                f"start = {_format_list(capsule.start)}",
            ]
            yields += [f"end = {_format_list(capsule.end)}", f"radius = {capsule.radius:.9g}", ""]
        return "\n".join(yields)


def read_urdf(source: Source) -> Skeleton:
    """Return the moving joints, with the links between them in one piece. Shapes become capsules around them.

    Raises BodyError.
    """
    return _UrdfReader(source).skeleton()


class _UrdfReader:
    def __init__(self, source: Source) -> None:
        self._source = source

    def skeleton(self) -> Skeleton:
        root = self._parse()
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
        """For each link, our link that it is a part of, and its rotation and position with all joints at 0."""
        starts: dict[str, Array] = {"": np.zeros(3)}
        found: list[Joint] = []
        for joint in self._order(ways, roots[0], links, root):
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
        return Skeleton(_from_urdf_name(root.attributes.get("name") or "robot"), tuple(found), tuple(shapes))

    def _parse(self) -> _UrdfElement:
        parser, stack, roots = expat.ParserCreate(), list[_UrdfElement](), list[_UrdfElement]()

        def start(tag: str, attributes: dict[str, str]) -> None:
            element = _UrdfElement(tag, attributes, parser.CurrentLineNumber)
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

    def _order(
        self, ways: Mapping[str, _UrdfElement], root: str, links: Mapping[str, _UrdfElement], top: _UrdfElement
    ) -> Iterator[_UrdfElement]:
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

    def _joint(self, joint: _UrdfElement, child: str, whole: str, at: Array, turned: Array) -> Joint:
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
        said = _from_urdf_name(name)
        return Joint(
            said, said, low * unit, high * unit, speed * unit, min(max(0.0, low * unit), high * unit), slides,
            link=_link_name(child), parent=whole, at=_vector(at), axis=_vector(way / np.linalg.norm(way)),
        )  # fmt: skip

    def _capsules(self, link: _UrdfElement, whole: str, turned: Array, at: Array, start: Array) -> Iterator[Capsule]:
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

    def _extent(self, shape: _UrdfElement) -> tuple[Array, float]:
        """Return half the length of a shape, and the radius around it; 0 for a mesh, which needs capsules by hand."""
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

    def _origin(self, element: _UrdfElement) -> tuple[Array, Array]:
        origin = element.first("origin")
        if origin is None:
            return np.zeros(3), np.eye(3)
        roll, pitch, yaw = self._vector(origin, "rpy", (0.0, 0.0, 0.0))
        shift = np.array(self._vector(origin, "xyz", (0.0, 0.0, 0.0)))
        return shift, _around(2, yaw) @ _around(1, pitch) @ _around(0, roll)

    def _kind(self, joint: _UrdfElement) -> str:
        kind = self._text(joint, "type")
        if kind not in _KINDS:
            raise self._wrong(joint, f'a joint of the type "{kind}" can\'t be read; write one of {", ".join(_KINDS)}')
        return kind

    def _end(self, joint: _UrdfElement, tag: str, links: Mapping[str, _UrdfElement]) -> str:
        end = joint.first(tag)
        if end is None:
            raise self._wrong(joint, f"a joint needs a <{tag}> link")
        name = self._text(end, "link")
        if name not in links:
            raise self._wrong(end, f'there is no link "{name}"')
        return name

    def _text(self, element: _UrdfElement, name: str) -> str:
        if not element.attributes.get(name, "").strip():
            raise self._wrong(element, f'<{element.tag}> needs "{name}"')
        return element.attributes[name]

    def _number(self, element: _UrdfElement, name: str) -> float:
        return self._numbers(element, name, 1)[0]

    def _size(self, element: _UrdfElement, name: str) -> float:
        return abs(self._number(element, name))

    def _vector(self, element: _UrdfElement, name: str, usual: Vector | None = None) -> Sequence[float]:
        return usual if usual is not None and name not in element.attributes else self._numbers(element, name, 3)

    def _numbers(self, element: _UrdfElement, name: str, count: int) -> list[float]:
        try:
            found = [float(part) for part in self._text(element, name).split()]
        except ValueError:
            found = []
        if len(found) != count or not all(isfinite(value) and abs(value) <= _MOST for value in found):
            wanted = "a number" if count == 1 else f"{count} numbers"
            raise self._wrong(element, f'"{name}" of <{element.tag}> must be {wanted}')
        return found

    def _wrong(self, element: _UrdfElement, message: str) -> BodyError:
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


def _from_urdf_name(name: str) -> str:
    return " ".join(name.replace("_", " ").split()) or name


def _link_name(name: str) -> str:
    return f"moving {BASE}" if _from_urdf_name(name) == BASE else _from_urdf_name(name)


def _quote(text: str) -> str:
    import json

    return json.dumps(text, ensure_ascii=False)


def _format_list(vector: Vector) -> str:
    return f"[{', '.join(f'{value:.9g}' for value in vector)}]"
