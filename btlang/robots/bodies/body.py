"""The body of a robot as its file describes it. Frozen data without numpy."""

from __future__ import annotations

import os
from collections.abc import Mapping
from math import cbrt, pi, sqrt

from btlang.robots.bodies.gesture import BEARINGS, Gesture, Step, angle_of
from btlang.robots.geometry import Pose
from btlang.speech.engine import Settings
from btlang.speech.recogniser import RecogniserSettings
from btlang.support.record import Record
from btlang.vocabulary.capabilities import POSTURE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

PATIENCE = 5.0
"""Seconds in which what moves has to make progress, unless a robot file gives another time."""
Vector = tuple[float, float, float]
"""Metres ahead, left and up."""
TOLERANCE = 0.5
"""Metres from the goal of a journey, unless a robot file gives another distance."""


class SpeedLimits(Record):
    """The speeds of a base: for driving in metres and seconds, or for turning in degrees and seconds.

    `speed` is the default for missions, `slowing` the deceleration before a goal, `hard_brake` that of a stop.
    """

    speed: float = 0.0
    top_speed: float = 0.0
    acceleration: float = 1.0
    slowing: float = 1.0
    brake: float = 1.0
    hard_brake: float = 1.0


class BaseSpec(Record):
    """A base with two wheels, `wheel_gap` metres apart. It touches things on purpose at `contact_speed` m/s at most."""

    driving: SpeedLimits
    turning: SpeedLimits
    wheel_gap: float
    contact_speed: float = 0.1


class NavigationSpec(Record):
    """The distances of navigation to objects (within reach of the hands) and to people, in metres between centres.

    A navigation server that reports success is believed within `tolerance` metres of the goal.
    """

    objects: float
    people: float
    tolerance: float = TOLERANCE


class Joint(Record):
    """A joint in degrees and degrees a second, or in metres if it `slides`.

    `part` is what it belongs to: "head", "lift". `acceleration` and `jerk` are in units a second squared and cubed;
    with 0 it has its speed at once. It moves its `link` around an `axis` through a point `at` of the `parent` link,
    both in the frame of that link: metres ahead, left and up. "" is the base, whose origin is on the floor below its
    centre.
    """

    name: str
    part: str
    low: float
    high: float
    speed: float
    rest: float = 0.0
    slides: bool = False
    acceleration: float = 0.0
    jerk: float = 0.0
    link: str = ""
    parent: str = ""
    at: Vector = (0.0, 0.0, 0.0)
    axis: Vector = (0.0, 0.0, 1.0)

    @property
    def si(self) -> float:
        """One of its units in radians or metres."""
        return 1.0 if self.slides else pi / 180

    @property
    def close_enough(self) -> float:
        """The accepted error: a centimetre or a degree."""
        return 0.01 if self.slides else 1.0

    def rest_to_rest_seconds(self, way: float) -> float:
        """Return the seconds for a distance from rest to rest, on a polynomial of degree five within the limits."""
        by_speed, by_force = 2.4 * way / self.speed, sqrt(6.4 * way / self.acceleration)
        return max(by_speed, by_force, cbrt(66 * way / self.jerk))


class Capsule(Record):
    """All points within `radius` metres of a line between two points of a link, in the frame of the link."""

    link: str
    start: Vector
    end: Vector
    radius: float


class HandPart(Record):
    """A hand, whose `name` is "left" or "right".

    It grasps objects within `reach` of a point, `ahead` metres before the robot's centre and `left` metres beside it,
    and puts things down with their rim `puts_at` metres ahead.
    """

    name: str
    ahead: float
    left: float
    reach: float
    puts_at: float


class Sensor(Record):
    """A sensor, whose `kind` is "scanner", "bumper" or "camera"; `frame` is its frame in ROS 2.

    It is `ahead` and `left` metres from the robot's centre, and sees as far as its `range`, `view` degrees wide, in the
    direction `angle` degrees left of ahead plus the angle of its `joint`. It recognises people and objects up to
    `recognizes` metres away.
    """

    kind: str
    frame: str
    range: float = 0.0
    view: float = 360.0
    angle: float = 0.0
    joint: str = ""
    recognizes: float = 0.0
    ahead: float = 0.0
    left: float = 0.0

    @property
    def pose(self) -> Pose:
        """The pose in the frame of the robot's centre, which faces along x."""
        return Pose(self.ahead, self.left, self.angle)


class Battery(Record):
    """The percentages that a battery loses a second and a metre, and gains a second at the dock."""

    idle: float
    driving: float
    charging: float


class Dock(Record):
    """The docking of a robot, with distances in metres from the dock. Distances are in metres from the dock.

    It connects `within`, has left the dock `beyond`, and `backs_off` so far when it undocks. It drives straight in from
    `staging` metres in front of the dock, at `speed` m/s, and tries again `retries` times.
    """

    within: float
    beyond: float
    backs_off: float
    staging: float = 0.4
    speed: float = 0.15
    retries: int = 2


class VoiceSpec(Record):
    """The voice of a robot and its engine: "espeak", the name of an installed one, or `module:Class`.

    "" is an engine without sound.
    """

    settings: Settings
    engine: str = ""


class Mouth(Record):
    """The mouth of a robot: a `joint` that is open at its high end, a `display`, or both."""

    joint: str = ""
    display: str = ""


class Breathing(Record):
    """A motion of a `joint` by so many degrees to both sides, once in so many seconds."""

    joint: str
    by: float
    every: float


class Idle(Record):
    """The motion of joints that nothing else moves; see btlang.robots.motion.gesturing."""

    breathing: Breathing | None = None
    look_at_speaker: bool = False


class EarsSpec(Record):
    """The ears of a robot: they understand speech up to `within` metres away, by a recogniser, "" for none.

    Without a `wake` word and `settings.push` it listens all the time.
    """

    within: float
    engine: str = ""
    settings: RecogniserSettings = RecogniserSettings()
    wake: str = ""


class Device(Record):
    """A device: `kind` and `driver` are names of btlang.devices, `options` are those of its driver.

    `scale` and `offset` correct what its driver reads: value * scale + offset; for a command the other way round. It
    looks `angle` degrees left of ahead.
    """

    name: str
    kind: str
    driver: str
    port: str = ""
    options: Mapping[str, Any] = {}
    scale: float = 1.0
    offset: float = 0.0
    angle: float = 0.0


class RosNode(Record):
    """A ROS 2 lifecycle node, by its full name.

    Somebody else starts it, unless there is a `command`, or a `container`: the full name of a node that loads the
    `plugin` of a `package`.
    """

    name: str
    command: tuple[str, ...] = ()
    container: str = ""
    package: str = ""
    plugin: str = ""


class ComponentPart(Record):
    """A component. `place` is its class, `module:Class` or the name of an installed one; of a ROS 2 `node`, its name.

    `runs` is "process" or "here", in the robot's own process. Robots of one user whose components have the same name in
    `shared` have one process for them. `needs` are further ones than those that its class names. `restarts` is how
    often in a minute it is started again after a failure. It is given up if a transition takes longer than `limit`
    seconds, or if it is silent for longer than `silence` seconds.
    """

    name: str
    place: str
    runs: str = "process"
    needs: tuple[str, ...] = ()
    parameters: Mapping[str, Any] = {}
    restarts: int = 5
    limit: float = 10.0
    silence: float = 0.8
    shared: str = ""
    node: RosNode | None = None


class Body(Record):
    """All that is known of a robot. What it lacks is None, or isn't in the tuples.

    `over` is what it runs on by default: a name of btlang.robots.registry.ROBOTS. Joints that a posture doesn't name
    stay where they are; its steps follow each other. `file` is the path of the robot file, `world` that of the world
    where it works; "" without one. `rules`, `missions` and `schedules` are the paths of what it does by itself: see
    btlang.task.execution.missions. `forbidden` has pairs of links that may not touch. What moves has to make progress
    within the seconds of its `patience`.
    """

    name: str
    radius: float
    over: str = "simulated"
    base: BaseSpec | None = None
    navigation: NavigationSpec | None = None
    joints: tuple[Joint, ...] = ()
    postures: Mapping[str, tuple[Step, ...]] = {}
    hands: tuple[HandPart, ...] = ()
    sensors: tuple[Sensor, ...] = ()
    battery: Battery | None = None
    dock: Dock | None = None
    voice: VoiceSpec | None = None
    screen: bool = False
    devices: tuple[Device, ...] = ()
    components: tuple[ComponentPart, ...] = ()
    file: str = ""
    world: str = ""
    ears: EarsSpec | None = None
    capsules: tuple[Capsule, ...] = ()
    forbidden: tuple[tuple[str, str], ...] = ()
    rules: str = ""
    missions: str = ""
    schedules: str = ""
    gestures: Mapping[str, Gesture] = {}
    mouth: Mouth | None = None
    idle: Idle = Idle()
    patience: float = PATIENCE

    @property
    def folder(self) -> str:
        """The folder of its file, which also has the classes of its components; "" without a file."""
        return os.path.dirname(self.file)

    @property
    def driving(self) -> SpeedLimits:
        """The speed limits for driving; all zero without a base."""
        return self.base.driving if self.base is not None else SpeedLimits()

    @property
    def turning(self) -> SpeedLimits:
        """The speed limits for turning; all zero without a base."""
        return self.base.turning if self.base is not None else SpeedLimits()

    @property
    def contact_speed(self) -> float:
        """The metres a second at which it touches things on purpose."""
        return self.base.contact_speed if self.base is not None else 0.0

    def sensor(self, kind: str) -> Sensor | None:
        """Return the first sensor of a kind."""
        return next((sensor for sensor in self.sensors if sensor.kind == kind), None)

    @property
    def range(self) -> float:
        """The metres that the scanner sees, 0 without one."""
        scanner = self.sensor("scanner")
        return scanner.range if scanner is not None else 0.0

    def hand(self, name: str) -> HandPart | None:
        """Return the hand of a name."""
        return next((hand for hand in self.hands if hand.name == name), None)

    def joint(self, name: str) -> Joint | None:
        """Return the joint of a name."""
        return next((joint for joint in self.joints if joint.name == name), None)

    def bearing_joint(self, posture: str) -> Joint | None:
        """Return the joint that turns towards something in a posture."""
        steps = self.postures.get(posture, ())
        return next((self.joint(name) for step in steps for name, at in step.items() if at in BEARINGS), None)

    @property
    def is_smooth(self) -> bool:
        """Whether its joints have limits of acceleration, so that their movements are planned."""
        return any(joint.acceleration for joint in self.joints)

    def falls_short(self, posture: str, bearing: float) -> Joint | None:
        """Return the joint that can't turn to a target `bearing` degrees to the left in a posture; None if all can."""
        for step in self.postures.get(posture, ()):
            for name, at in step.items():
                joint = self.joint(name)
                if at in BEARINGS and joint is not None and not joint.low <= angle_of(at, bearing) <= joint.high:
                    return joint
        return None

    def has(self, need: str) -> bool:
        """Return whether it has what a word needs; see btlang.vocabulary.capabilities."""
        if need.startswith(POSTURE):
            return need.removeprefix(POSTURE) in self.postures
        return need in self._parts

    @property
    def _parts(self) -> set[str]:
        """The needs of words that it meets."""
        return {
            *(("base", "pose") if self.base else ()),
            *(("navigation",) if self.base and self.navigation else ()),
            *(("joints",) if self.joints else ()),
            *(joint.part for joint in self.joints),
            *(("hand", "holding") if self.hands else ()),
            *(f"{hand.name} hand" for hand in self.hands),
            *(sensor.kind for sensor in self.sensors),
            *(("battery", "charging") if self.battery else ()),
            *(("docking", "docked") if self.dock else ()),
            *(("voice",) if self.voice else ()),
            *(("ears",) if self.ears else ()),
            *(("perception",) if any(sensor.recognizes for sensor in self.sensors) else ()),
            *(("screen",) if self.screen else ()),
        }
