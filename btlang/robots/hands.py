"""The hands: they grasp what is within reach, carry it along and put it down."""

from __future__ import annotations

from math import hypot

from btlang.robots.body import Body, HandPart
from btlang.robots.geometry import Point, Pose
from btlang.robots.obstacles import Obstacles
from btlang.robots.robot import Hand, RobotError
from btlang.robots.world import WorldObject, said

_DIRECTIONS = (0, 30, -30, 60, -60, 90, -90, 120, -120, 150, -150, 180)


class Hands:
    """What each hand holds. Reach is measured from a point that the body says."""

    def __init__(self, obstacles: Obstacles, objects: tuple[str, ...], body: Body) -> None:
        self._body = body
        self._obstacles = obstacles
        self._objects = objects
        self.held: dict[Hand, str] = {}
        self._since: dict[Hand, float] = {}

    def grasp(self, hand: Hand, name: str | None, pose: Pose, now: float) -> str:
        """The name of what the hand now holds. Raises RobotError."""
        if hand in self.held:
            raise RobotError(f"the {hand} hand already holds {said(self.held[hand])}")
        found = self.within_reach(hand, name, pose)
        self._obstacles.pick_up(found)
        self.held[hand] = found
        self._since[hand] = now
        return found

    def within_reach(self, hand: Hand, name: str | None, pose: Pose) -> str:
        """The named or the nearest object that a hand could grasp. Raises RobotError if there is none."""
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
        """Puts down what the hand held in front of the robot, or where there is room; None for an empty hand."""
        name = self.held.pop(hand, None)
        if name is not None:
            self._obstacles.put_down(name, *self._spot(name, pose, self._part(hand)))
        return name

    def hand_over(self, hand: Hand) -> str | None:
        """Somebody takes what the hand held: it stays off the floor. None for an empty hand."""
        return self.held.pop(hand, None)

    def drop(self, hand: Hand, pose: Pose) -> str | None:
        """As `release`, by itself."""
        return self.release(hand, pose)

    def held_for(self, hand: Hand, now: float) -> float:
        """Seconds since the grasp; 0 for an empty hand."""
        return now - self._since[hand] if hand in self.held else 0.0

    def stop(self) -> None:
        """Does nothing: they are at rest."""

    def step(self, dt: float) -> None:
        """Does nothing: all that it does takes no time."""

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
