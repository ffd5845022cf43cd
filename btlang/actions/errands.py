"""Errands: fetching and bringing things, coming back, and looking after places."""

from __future__ import annotations

from collections.abc import Generator
from typing import Protocol

from btlang.actions.common import DrivingRobot, MeetingRobot, keep_pace, speaker
from btlang.actions.joints import take
from btlang.actions.manipulation import FetchingRobot, hand_with, pick_up, put_down
from btlang.actions.motion import Steps, turn
from btlang.actions.navigation import accomplish, go_to, travel
from btlang.robots.robot import Hand, Navigation


class BringingRobot(FetchingRobot, MeetingRobot, Protocol):
    """A robot that carries things to people."""


class PatrollingRobot(DrivingRobot, Navigation, Protocol):
    """A robot that finds its way, and looks around."""


def come_back(robot: Navigation, manner: str | None = None) -> Steps:
    """Drive to where the robot was when the mission began, and face as it did then."""
    yield from keep_pace(robot, manner, _return(robot))


def _return(robot: Navigation) -> Steps:
    yield from accomplish(robot.navigate_to_pose(robot.set_out_from))


def fetch(robot: FetchingRobot, object: str, manner: str | None = None) -> Steps:
    """Pick up an object and bring it to where the robot is now. Fails as `pick_up` does."""
    yield from keep_pace(robot, manner, _fetch(robot, object))


def _fetch(robot: FetchingRobot, object: str) -> Steps:
    here = robot.pose
    yield from _hold(robot, object)
    yield from accomplish(robot.navigate_to_pose(here))


def bring_back(robot: FetchingRobot, object: str) -> Steps:
    """Pick up an object unless a hand holds it, and bring it to where the robot was when the mission began."""
    yield from _hold(robot, object)
    yield from _return(robot)


def hold(robot: FetchingRobot, object: str) -> Steps:
    """Pick up an object unless a hand holds it."""
    yield from _hold(robot, object)


def carry(
    robot: FetchingRobot,
    object: str,
    place: str | None = None,
    x: float | None = None,
    y: float | None = None,
    facing: float | None = None,
    manner: str | None = None,
) -> Steps:
    """Pick up an object unless a hand holds it, drive to a place or a point, and put it down there."""
    yield from keep_pace(robot, manner, _carry(robot, object, go_to(robot, place, x, y, facing)))


def put_in(robot: FetchingRobot, object: str, container: str, manner: str | None = None) -> Steps:
    """Pick up an object unless a hand holds it, drive up to another object and put it down there."""
    yield from keep_pace(robot, manner, _carry(robot, object, travel(robot, container)))


def put_beside(robot: FetchingRobot, object: str, other: str, manner: str | None = None) -> Steps:
    """Pick up an object unless a hand holds it, drive up to another one and put it down beside that."""
    yield from keep_pace(robot, manner, _carry(robot, object, travel(robot, other)))


def _carry(robot: FetchingRobot, object: str, way: Steps) -> Steps:
    """Pick up an object unless a hand holds it, go this way and put it down."""
    yield from _hold(robot, object)
    yield from way
    yield from put_down(robot, object)


def bring(robot: BringingRobot, object: str, person: str | None = None, manner: str | None = None) -> Steps:
    """Pick up an object unless a hand holds it, drive to a person and hand it over.

    Without a person it is the last speaker, else the nearest person in view; if there is nobody, the object is put down
    where the mission began. Fails if the person is gone or doesn't want it. Who has it already needn't get it.
    """
    yield from keep_pace(robot, manner, _bring(robot, object, person or speaker(robot)))


def _bring(robot: BringingRobot, object: str, person: str | None) -> Steps:
    if person is not None and object in robot.described("object", {"held_by": person}):
        return
    hand = yield from _hold(robot, object)
    if person is None:
        yield from _return(robot)
        yield from put_down(robot, object)
        return
    yield from travel(robot, person)
    yield from take(robot, f"{hand} arm reaching")
    yield from accomplish(robot.hand_over(hand, person))
    yield from take(robot, f"{hand} arm hanging")


def _hold(robot: FetchingRobot, object: str) -> Generator[None, None, Hand]:
    """Return the hand that holds the object, which is picked up first if none does."""
    hand = hand_with(robot, object)
    if hand is None:
        yield from pick_up(robot, object)
    return hand or "right"


def patrol(
    robot: PatrollingRobot,
    place: str | None = None,
    x: float | None = None,
    y: float | None = None,
    manner: str | None = None,
) -> Steps:
    """Drive to a place or a point and turn once around."""
    yield from keep_pace(robot, manner, go_to(robot, place, x, y))
    yield from turn(robot, 360.0)


def localize(robot: DrivingRobot) -> Steps:
    """Forget the pose on the map, if the robot can find it again, and turn once around so that its sensors do."""
    robot.reset_localization()
    yield from turn(robot, 360.0)
