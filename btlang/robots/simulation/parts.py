"""The parts of a robot that act in a simulated world: joints, hands, and the battery with its dock."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from math import copysign, hypot, inf

from btlang.robots.bodies.body import Battery, Body, Dock, HandPart
from btlang.robots.geometry import Point, Pose, segment_distance
from btlang.robots.motion.guard.readings import ObstacleReading, ScanReading
from btlang.robots.parts import JointsPart, Parts
from btlang.robots.robot import Hand, RobotError, Station, clip_targets, joint_of
from btlang.robots.simulation.base import SimulatedBase
from btlang.robots.voice import TimedVoice
from btlang.robots.worlds.obstacles import Obstacles
from btlang.robots.worlds.world import NEVER, Place, World, WorldObject, said

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.robots.worlds.scan import Array, Scanner

_DIRECTIONS = (0, 30, -30, 60, -60, 90, -90, 120, -120, 150, -150, 180)
_ENDLESS = Battery(0.0, 0.0, 0.0)  # of a robot whose file knows of no battery
_NO_DOCK = Dock(0.0, 0.0, 0.0)
_SHARES = (1.0, 0.75, 0.5, 0.25)  # of the way in front of a dock for which a wall may leave room
NO_CONTACT = "the dock doesn't connect"
_NOWHERE = "there is no dock in this world"


class SimulatedJoints:
    """Joints in degrees; each begins at rest and turns at most as fast as the body allows."""

    def __init__(self, body: Body) -> None:
        self._body = body
        self._angles = {joint.name: joint.rest for joint in body.joints}
        self._rates = {joint.name: joint.speed for joint in body.joints}
        self._targets: dict[str, float] = {}

    @property
    def moving(self) -> bool:
        """Whether any joint is on its way."""
        return bool(self._targets)

    def angle(self, name: str) -> float:
        """Return the angle of a joint. Raises RobotError for an unknown one."""
        return self._angles[joint_of(self._body, name).name]

    def move(self, targets: Mapping[str, float]) -> None:
        """Move towards targets, clipped to the joints' limits. Raises RobotError for an unknown joint."""
        self._targets.update(clip_targets(self._body, targets))

    def at_target(self, names: tuple[str, ...]) -> bool:
        """Return whether none of these joints is on its way."""
        return not any(name in self._targets for name in names)

    def freeze(self, names: tuple[str, ...] | None = None) -> None:
        """Hold these joints, or all for None, where they are."""
        for name in tuple(self._targets) if names is None else names:
            self._targets.pop(name, None)

    def step(self, dt: float) -> None:
        """Move on by `dt` seconds."""
        for name, target in list(self._targets.items()):
            left, most = target - self._angles[name], self._rates[name] * dt
            if abs(left) <= most:
                self._angles[name] = target
                self._targets.pop(name, None)
            else:
                self._angles[name] += copysign(most, left)


class SimulatedHands:
    """The hands and what they hold. Reach counts from a point of the body."""

    def __init__(self, obstacles: Obstacles, objects: tuple[str, ...], body: Body) -> None:
        self._body = body
        self._obstacles = obstacles
        self._objects = objects
        self.held: dict[Hand, str] = {}
        self._since: dict[Hand, float] = {}

    def grasp(self, hand: Hand, name: str | None, pose: Pose, now: float) -> str:
        """Grasp an object; return its name. Raises RobotError."""
        if hand in self.held:
            raise RobotError(f"the {hand} hand already holds {said(self.held[hand])}")
        found = self.within_reach(hand, name, pose)
        self._obstacles.pick_up(found)
        self.held[hand] = found
        self._since[hand] = now
        return found

    def within_reach(self, hand: Hand, name: str | None, pose: Pose) -> str:
        """Return the named or the nearest object that a hand could grasp. Raises RobotError if there is none."""
        part = self._part(hand)
        x, y = pose.ahead(part.ahead, part.left)
        known = (self._obstacles.things[key] for key in self._objects if not self._obstacles.is_carried(key))
        things = [thing for thing in known if not (isinstance(thing, WorldObject) and thing.fixed)]
        reachable = [
            (hypot(thing.x - x, thing.y - y) - thing.radius, thing.name)
            for thing in things
            if name in (None, thing.name) and not self._obstacles.wall_between((pose.x, pose.y), (thing.x, thing.y))
        ]
        distance, found = min(reachable, default=(part.reach + 1.0, ""))
        if distance > part.reach:
            what = said(name) + " is not" if name else "nothing is"
            raise RobotError(f"{what} within reach of the {hand} hand")
        return found

    def release(self, hand: Hand, pose: Pose) -> str | None:
        """Put down what the hand held in front of the robot, or where there is room; None for an empty hand."""
        name = self.held.pop(hand, None)
        if name is not None:
            self._obstacles.put_down(name, *self._spot(name, pose, self._part(hand)))
        return name

    def hand_over(self, hand: Hand) -> str | None:
        """Give away what the hand held: it stays off the floor. None for an empty hand."""
        return self.held.pop(hand, None)

    def drop(self, hand: Hand, pose: Pose) -> str | None:
        """Drop what the hand held, like `release`."""
        return self.release(hand, pose)

    def held_for(self, hand: Hand, now: float) -> float:
        """Return the seconds since the grasp; 0 for an empty hand."""
        return now - self._since[hand] if hand in self.held else 0.0

    def stop(self) -> None:
        """Do nothing: the hands are at rest."""

    def step(self, dt: float) -> None:
        """Do nothing: no motion of the hands takes time."""

    def _part(self, hand: Hand) -> HandPart:
        part = self._body.hand(hand)
        if part is None:
            raise RobotError(f"the robot has no {hand} hand")
        return part

    def _spot(self, name: str, pose: Pose, part: HandPart) -> Point:
        radius = self._obstacles.things[name].radius
        distance = part.puts_at + radius
        for direction in _DIRECTIONS:
            x, y = Pose(pose.x, pose.y, pose.heading + direction).ahead(distance)
            discs = self._obstacles.discs
            apart = all(hypot(x - dx, y - dy) > radius + other for dx, dy, other in discs)
            if apart and not self._obstacles.wall_between((pose.x, pose.y), (x, y)):
                return x, y
        return pose.ahead(distance)


class SimulatedPower:
    """The battery in percent: it drains with time and with metres, and charges at the dock."""

    def __init__(self, level: float, docks: tuple[Place, ...], body: Body) -> None:
        self._battery, self._docking = body.battery or _ENDLESS, body.dock or _NO_DOCK
        self.level = level
        self.docked = False
        self._docks = docks

    @property
    def empty(self) -> bool:
        """Whether the battery is at 0 percent: the wheels get no power."""
        return self.level <= 0.0

    @property
    def charging(self) -> bool:
        """Whether it is docked and not full."""
        return self.docked and self.level < 100.0

    def set_level(self, percent: float) -> None:
        """Set the level, 0 to 100."""
        self.level = min(100.0, max(0.0, percent))

    def connect(self, pose: Pose, fails: Callable[[str], bool]) -> None:
        """Connect to the dock. Raises RobotError if there is none at the pose, or the one of this name `fails` to
        connect.
        """
        if not self._docks:
            raise RobotError(_NOWHERE)
        away, name = self._nearest(pose)
        if away > self._docking.within:
            raise RobotError(f"the {name} is {away:.1f} m away")
        if fails(name):
            raise RobotError(NO_CONTACT)
        self.docked = True

    def is_near_dock(self, pose: Pose) -> bool:
        """Return whether it can connect at a pose."""
        return self._nearest(pose)[0] <= self._docking.within

    def _nearest(self, pose: Pose) -> tuple[float, str]:
        """Return the metres to the nearest dock, and its name."""
        return min(((pose.distance_to((dock.x, dock.y)), dock.name) for dock in self._docks), default=(NEVER, ""))

    def step(self, dt: float, metres: float, pose: Pose) -> bool:
        """Move on by `dt` seconds; return whether the robot has just driven off its dock."""
        if self.docked and self._nearest(pose)[0] > self._docking.beyond:
            self.docked = False
            self._drain(dt, metres)
            return True
        if self.docked:
            self.level = min(100.0, self.level + self._battery.charging * dt)
        else:
            self._drain(dt, metres)
        return False

    def _drain(self, dt: float, metres: float) -> None:
        self.level = max(0.0, self.level - self._battery.idle * dt - self._battery.driving * metres)


def stations(world: World, body: Body, pose: Pose) -> list[Station]:
    """Return the docks of a world, nearest first. Raises RobotError if it has none."""
    if not world.all_docks:
        raise RobotError(_NOWHERE)
    return [_station(dock, world, body) for dock in world.docks_from(pose)]


def _station(dock: Place, world: World, body: Body) -> Station:
    """Return a dock with its staging pose: as far in front as the body says, or nearer if walls leave less room."""
    spot = Pose(dock.x, dock.y, dock.facing or 0.0)
    wanted = (body.dock or _NO_DOCK).staging
    stagings = (Pose(*spot.ahead(-share * wanted), spot.heading) for share in _SHARES)
    return Station(dock.name, spot, next((each for each in stagings if _is_free(each, world, body.radius)), spot))


def _is_free(spot: Pose, world: World, radius: float) -> bool:
    point = spot.x, spot.y
    gap = min((segment_distance(point, segment) for segment in world.segments()), default=NEVER)
    return gap >= radius and not any(box.contains(point) for box in world.boxes)


def make_simulated_parts(world: World, obstacles: Obstacles, body: Body) -> Parts:
    """Return the parts that act in a world."""
    scanners: list[Scanner] = []

    def scan(pose: Pose) -> Array:
        if not scanners:
            from btlang.robots.worlds.scan import (
                Scanner,  # brings numpy, which takes longer to import than many missions
            )

            scanners.append(Scanner(obstacles, body.range))
        return scanners[0].read(pose)

    def sensors(now: float) -> list[ObstacleReading]:
        if scanner is None:
            return []
        look = partial(scan, base.pose)
        return [ScanReading("scanner", now, "", look, scanner.view, scanner.angle, base.room, inf, base.free_way)]

    scanner = body.sensor("scanner")
    base, power = SimulatedBase(world.start, obstacles, body), SimulatedPower(world.battery, world.all_docks, body)
    joints = make_joints(body)
    hands = SimulatedHands(obstacles, world.names.objects, body)
    return Parts(base, power, scan, joints, hands, TimedVoice(body, joints.move, may_estimate=True), sensors)


def make_joints(body: Body) -> JointsPart:
    """Return the joints of a body: smooth ones plan their movements."""
    if not body.is_smooth:
        return SimulatedJoints(body)
    from btlang.robots.motion.smooth_joints import SmoothJoints  # brings numpy and ruckig

    return SmoothJoints(body)
