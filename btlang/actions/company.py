"""Actions with people: following, guiding, greeting and waiting for them."""

from __future__ import annotations

from collections.abc import Generator
from math import dist, inf
from typing import Any, Protocol

from btlang.actions.common import DrivingRobot, MeetingRobot, Watch, keep_pace, speaker, where
from btlang.actions.gestures import AimingRobot, wave
from btlang.actions.motion import Steps, turn
from btlang.actions.navigation import go_to, travel
from btlang.actions.speech import PresentingRobot, say
from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.geometry import Point
from btlang.robots.robot import Leading, Navigation, Operation, Perception
from btlang.robots.worlds.world import said

LOST = 5.0
"""Seconds out of sight, at the last position of a person, after which the robot has lost them."""
WAITS = 10.0
"""Seconds that a guiding robot waits for a person who has fallen behind, before it goes back."""
BEHIND = 3.0
"""Metres from the robot from which a guided person has fallen behind."""
RETURNS = 4
"""How often it goes back for a person."""

_TURNED = 30.0  # degrees to the side at which it turns to who it follows
_STEP = 0.4  # metres that who is followed may go before it sets out
_UNSEEN = 2.5  # seconds that who is guided may be out of view: cameras look ahead
_ARRIVED, _MOVED = 2.0, 0.2  # metres
_TRIES, _PAUSE = 3, 1.0  # journeys that fail one after the other, and the seconds between them


class FollowingRobot(MeetingRobot, DrivingRobot, Protocol):
    """A robot that follows people."""


class GuidingRobot(Leading, FollowingRobot, PresentingRobot, Protocol):
    """A robot that asks people to follow."""


class GreetingRobot(Navigation, PresentingRobot, AimingRobot, Protocol):
    """A robot that goes to people, waves and speaks."""


class TellingRobot(Navigation, PresentingRobot, Protocol):
    """A robot that goes to people and speaks."""


def _somebody(robot: MeetingRobot, person: str | None) -> str:
    found = person or speaker(robot)
    if found is None:
        raise ActionFailed("I see nobody")
    return found


def come_to_me(robot: MeetingRobot, manner: str | None = None) -> Steps:
    """Go to the last speaker, else to the nearest person in view."""
    yield from keep_pace(robot, manner, travel(robot, _somebody(robot, None)))


def follow(
    robot: FollowingRobot,
    person: str | None = None,
    place: str | None = None,
    x: float | None = None,
    y: float | None = None,
    manner: str | None = None,
    source: str | None = None,
) -> Steps:
    """Follow a person to a place or a point, or without end, from a place where it meets them if there is one.

    Without a person it follows the last speaker, else the nearest person in view. Fails if the person is out of view
    for five seconds.
    """
    if source is not None:
        yield from go_to(robot, source)
    name = _somebody(robot, person)
    goal = None if place is None and x is None else where(robot, place, x, y)
    yield from keep_pace(robot, manner or "quickly", _follow(robot, name, goal, inf))


def follow_until_still(robot: FollowingRobot, person: str, duration: float) -> Steps:
    """Follow a person until they stand for so many seconds. Fails as `follow` does."""
    yield from keep_pace(robot, "quickly", _follow(robot, person, None, duration))


def _follow(robot: FollowingRobot, person: str, goal: Point | None, stands: float) -> Steps:
    watch, journey = Watch(robot), _Journeys(robot, person)
    seen_at, stood_at, stood = robot.time, robot.time, robot.locate(person)
    try:
        while True:
            watch.check_stop()
            point = robot.locate(person)
            if robot.sees(person) or journey.is_under_way:
                seen_at = robot.time
            elif robot.time - seen_at > LOST:
                raise ActionFailed(f"I've lost {said(person)}")
            else:
                robot.drive(0.0, robot.normal_turn)  # looks around
            if dist(point, stood) > _MOVED:
                stood_at, stood = robot.time, point
            if robot.sees(person) and not journey.is_under_way:
                if goal is not None and dist(point, goal) <= _ARRIVED:
                    return
                if robot.time - stood_at >= stands:
                    return
            journey.go_on(point)
            yield
    finally:
        journey.end()


class _Journeys:
    """The journeys to somebody who walks on, one after the other."""

    def __init__(self, robot: FollowingRobot, person: str) -> None:
        self._robot, self._person = robot, person
        self._operation: Operation | None = None
        self._failed, self._next = 0, 0.0
        self._reach = 0.0

    @property
    def is_under_way(self) -> bool:
        return self._operation is not None and not self._operation.done

    def go_on(self, point: Point) -> None:
        """Set out if the person has gone away or to the side. Raises ActionFailed if there is no way."""
        robot, operation = self._robot, self._operation
        if operation is not None and operation.done:
            self._operation = None
            self._failed = self._failed + 1 if operation.failure else 0
            self._next = robot.time + _PAUSE if operation.failure else 0.0
            self._reach = robot.pose.distance_to(point)
            if self._failed == _TRIES and operation.failure:
                raise ActionFailed(operation.failure)
        if self._operation is not None or robot.time < self._next:
            return
        away = robot.pose.distance_to(point) > self._reach + _STEP
        if away or (robot.sees(self._person) and abs(robot.pose.bearing_to(point)) > _TURNED):
            self._operation = robot.navigate_to(self._person)

    def end(self) -> None:
        """Brake."""
        if self._operation is not None:
            self._operation.cancel()
        self._robot.drive(0.0, 0.0)


def guide(
    robot: GuidingRobot,
    person: str | None = None,
    place: str | None = None,
    x: float | None = None,
    y: float | None = None,
    facing: float | None = None,
    manner: str | None = None,
    source: str | None = None,
) -> Steps:
    """Ask a person to follow and drive to a place or a point, from a place where it meets them if there is one.

    It waits for a person who falls behind, and goes back for one who doesn't come. Without a person it is the last
    speaker, else the nearest person in view. Fails after four returns.
    """
    if source is not None:
        yield from go_to(robot, source)
    name = _somebody(robot, person)
    if not robot.sees(name):
        yield from travel(robot, name)
    if manner != "quietly":
        yield from say(robot, f"Please follow me, {name}.")
    robot.guide(name, True)
    try:
        for _ in range(RETURNS):
            leads = keep_pace(robot, manner, go_to(robot, place, x, y, facing))
            if (yield from _lead(robot, name, leads)):
                return
            yield from _rejoin(robot, name)
        raise ActionFailed(f"I've lost {said(name)}")
    finally:
        robot.guide(name, False)


def fetch_person(robot: GuidingRobot, person: str) -> Steps:
    """Go to a person and guide them to where the robot is now. Fails as `guide` does."""
    here = robot.pose
    yield from travel(robot, person)
    yield from guide(robot, person, x=here.x, y=here.y)


def _lead(robot: GuidingRobot, person: str, steps: Steps) -> Generator[None, None, bool]:
    """Go on while the person keeps up; return whether both came to the end together."""
    with_us, arrived = robot.time, False
    try:
        while True:
            if _is_with(robot, person):
                with_us = robot.time
                if arrived:
                    return True
            elif robot.time - with_us > _UNSEEN:
                return False
            try:
                if not arrived:
                    next(steps)
            except StopIteration:
                arrived = True
            yield
    finally:
        steps.close()


def _is_with(robot: GuidingRobot, person: str) -> bool:
    return robot.sees(person) and robot.pose.distance_to(robot.locate(person)) <= BEHIND


def _rejoin(robot: GuidingRobot, person: str) -> Steps:
    """Wait for a person, facing where they were seen last, then go there."""
    watch, until = Watch(robot), robot.time + WAITS
    yield from turn(robot, robot.pose.bearing_to(robot.locate(person)))
    while robot.time < until:
        watch.check_stop()
        if _is_with(robot, person):
            return
        yield
    try:
        yield from travel(robot, person)
    except ActionFailed:
        watch.check_stop()  # who isn't there any more may be near
    if robot.sees(person):
        robot.guide(person, True)


def greet(robot: GreetingRobot, person: str, text: str | None = None) -> Steps:
    """Drive to a person, wave and say the text, or hello."""
    yield from travel(robot, person)
    yield from wave(robot, person)
    yield from say(robot, text or f"Hello, {person}!")


def tell(robot: TellingRobot, person: str, text: str, kept: dict[str, Any] | None = None) -> Steps:
    """Drive to a person and say the text."""
    yield from travel(robot, person)
    yield from say(robot, text, kept)


def wait_for_person(robot: Perception, person: str, duration: float | None = None) -> Steps:
    """Wait until a person is in view. Fails after `duration` seconds, if given."""
    yield from _wait(robot, person, duration)


def wait_for_someone(robot: Perception, duration: float | None = None) -> Steps:
    """Wait until anybody is in view. Fails after `duration` seconds, if given."""
    yield from _wait(robot, None, duration)


def _wait(robot: Perception, person: str | None, duration: float | None) -> Steps:
    begun = robot.time
    while not (robot.sees(person) if person else robot.seen("person")):
        if duration is not None and robot.time - begun >= duration:
            raise ActionFailed(f"{said(person)} didn't come" if person else "nobody came")
        yield
