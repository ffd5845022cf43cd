"""The body of a robot file as URDF, the format of ROS."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import atan2, hypot
from xml.sax.saxutils import quoteattr

from btlang.robots.bodies.body import Body, Capsule, Joint, Vector

ROOT_LINK = "base_link"
_EFFORT = 100  # newton metres: a robot file says nothing of it, and URDF needs it
_THIN = 1e-9  # metres


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
