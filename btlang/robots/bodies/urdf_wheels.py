"""The wheels of a robot in a URDF file: their joints, the distance between them, and what plugins say of the drive."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from btlang.robots.bodies.urdf_elements import UrdfElement, UrdfFile, value_of
from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.robots.bodies.body import Vector

_WHEEL = re.compile("wheel|caster|castor", re.IGNORECASE)
_CASTER = re.compile("caster|castor", re.IGNORECASE)
_DRIVE = re.compile("diff_?drive|skid_?steer", re.IGNORECASE)
_JOINTS = (
    "left_joint", "right_joint", "leftJoint", "rightJoint", "leftFrontJoint", "rightFrontJoint", "leftRearJoint",
    "rightRearJoint",
)  # fmt: skip
_GAPS = ("wheel_separation", "wheelSeparation", "wheel_track", "track_width")
_RADII, _DIAMETERS = ("wheel_radius", "wheelRadius"), ("wheel_diameter", "wheelDiameter")
_SPEEDS = ("max_linear_velocity", "max_velocity", "maxVelocity")
_ACCELERATIONS = ("max_linear_acceleration", "max_acceleration")
_LEAST_GAP, _MOST_GAP = 0.02, 20.0  # metres


class Drive(Record):
    """What a URDF file says about a base with wheels, in metres and seconds. None is unknown."""

    gap: float | None = None
    wheel_radius: float | None = None
    speed: float | None = None
    acceleration: float | None = None
    plugin: str = ""
    """The name of the plugin that says it."""


def plugin_drive(file: UrdfFile) -> tuple[Drive, frozenset[str]] | None:
    """Return what the plugin of a differential drive says, and the names of its joints; None if there isn't one."""
    for plugin in file.root.below("plugin"):
        title = plugin.attributes.get("name", "") + " " + plugin.attributes.get("filename", "")
        if _DRIVE.search(title):
            diameter = value_of(plugin, _DIAMETERS, _is_size)
            radius = value_of(plugin, _RADII, _is_size) or (diameter / 2 if diameter else None)
            drive = Drive(
                value_of(plugin, _GAPS, _is_gap),
                radius,
                value_of(plugin, _SPEEDS, _is_size),
                value_of(plugin, _ACCELERATIONS, _is_size),
                plugin.attributes.get("name", "") or plugin.attributes.get("filename", ""),
            )
            return drive, frozenset(each.text.strip() for each in plugin.below(*_JOINTS))
    return None


def _is_size(value: float) -> bool:
    return 0.001 <= value <= 100.0


def _is_gap(value: float) -> bool:
    return _LEAST_GAP <= value <= _MOST_GAP


def wheel_joints(joints: Mapping[str, UrdfElement], children: Mapping[str, str], driven: frozenset[str]) -> set[str]:
    """Return the names of the joints of wheels: those that a plugin drives, and those that turn without end and that
    are called so, or whose link is; `children` has the link of each joint.
    """
    return {
        name
        for name, joint in joints.items()
        if name in driven or (_turns_on(joint) and _WHEEL.search(f"{name} {children[name]}"))
    }


def _turns_on(joint: UrdfElement) -> bool:
    return joint.attributes.get("type", "") in ("continuous", "revolute")


def gap_between(wheels: Mapping[str, Vector]) -> float | None:
    """Return the distance across between the outermost wheels at these points of the base; casters don't count."""
    across = [point[1] for name, point in wheels.items() if not _CASTER.search(name)]
    gap = max(across) - min(across) if across else 0.0
    return round(gap, 4) if _is_gap(gap) else None


def describe_base(drive: Drive, gap: float) -> Iterator[str]:
    """Yield the lines of a robot file about a base with these wheels. What isn't known is a guess."""
    speed, acceleration = drive.speed or _SPEED, drive.acceleration or _ACCELERATION
    turn = min(180.0, 2 * speed / gap * 57.29578)
    driving = (speed, speed, acceleration, 0.6 * acceleration, 2 * acceleration, 4 * acceleration)
    turning = (min(90.0, turn), turn, 2 * turn, 1.5 * turn, 4 * turn, 8 * turn)
    yield "[base]"
    for name, values in (("driving", driving), ("turning", turning)):
        pairs = ", ".join(f"{key} = {value:.4g}" for key, value in zip(_LIMITS, values, strict=True))
        yield f"{name} = {{ {pairs} }}"
    yield f"wheel_gap = {gap:.4g}"


_SPEED, _ACCELERATION = 0.5, 0.5  # where the file has none
_LIMITS = ("speed", "top_speed", "acceleration", "slowing", "brake", "hard_brake")
