"""Hands and arms. The right arm is the one that picks up."""

from __future__ import annotations

from typing import Protocol

from btlang.actions.joints import posture, take
from btlang.actions.motion import Steps
from btlang.actions.navigation import accomplish, travel
from btlang.engine.leaves.leaf import ActionFailed
from btlang.robots.robot import Base, Hand, Hands, Joints, Navigation, RobotError
from btlang.robots.worlds.world import said

BESIDE = 1.0
"""Metres from the robot within which an object that it doesn't hold has been put down."""


class ReachingRobot(Joints, Hands, Protocol):
    """Arms with hands."""


class PlacingRobot(Base, ReachingRobot, Protocol):
    """Arms with hands on a base."""


class FetchingRobot(Navigation, ReachingRobot, Protocol):
    """Arms with hands on a base that finds its way."""


def open_right_hand(robot: Hands) -> Steps:
    """Open the hand; what it held is put down."""
    yield from accomplish(robot.release("right"))


def open_left_hand(robot: Hands) -> Steps:
    """Open the hand; what it held is put down."""
    yield from accomplish(robot.release("left"))


def close_right_hand(robot: Hands) -> Steps:
    """Close the hand on the nearest object. Fails if nothing is within reach or the hand is full."""
    yield from accomplish(robot.grasp("right"))


def close_left_hand(robot: Hands) -> Steps:
    """Close the hand on the nearest object. Fails if nothing is within reach or the hand is full."""
    yield from accomplish(robot.grasp("left"))


def grasp(robot: Hands, object: str | None = None) -> Steps:
    """Close the right hand on the object, or on the nearest one. Fails as `close_right_hand` does."""
    yield from accomplish(robot.grasp("right", object))


def release(robot: Hands, object: str | None = None) -> Steps:
    """Open the hand that holds the object, or any. Fails if none does."""
    yield from accomplish(robot.release(_full_hand(robot, object)))


def pick_up(robot: FetchingRobot, object: str) -> Steps:
    """Drive up to the object, grasp it with the right hand and lift it. Fails if one of these fails.

    An object that the hand holds is only lifted: a rule may have halted the command once it was grasped.
    """
    held = robot.holding("right")
    if held not in (None, object):
        raise ActionFailed(f"the right hand already holds {said(held)}")
    if held is None:
        yield from travel(robot, object)
        yield from take(robot, "right arm reaching")
        yield from accomplish(robot.grasp("right", object))
    yield from take(robot, "right arm carrying")


def put_down(robot: PlacingRobot, object: str | None = None) -> Steps:
    """Lower the arm that holds the object (or anything) and open its hand.

    Fails if none does, unless the object lies within reach: then it has been put down.
    """
    if object is not None and hand_with(robot, object) is None and _lies_here(robot, object):
        return
    hand = _full_hand(robot, object)
    yield from take(robot, f"{hand} arm reaching")
    yield from accomplish(robot.release(hand))
    yield from take(robot, f"{hand} arm hanging")


def hand_with(robot: Hands, object: str | None = None) -> Hand | None:
    """Return the hand that holds the object (or anything), the right one first; None if none does."""
    hands: tuple[Hand, Hand] = ("right", "left")
    for hand in hands:
        held = robot.holding(hand)
        if held is not None and object in (None, held):
            return hand
    return None


def _lies_here(robot: PlacingRobot, object: str) -> bool:
    """Return whether an object lies within reach, as far as the robot knows."""
    if not robot.body.has("pose"):
        return False
    try:
        return robot.pose.distance_to(robot.locate(object)) <= BESIDE
    except RobotError:
        return False


def _full_hand(robot: Hands, object: str | None) -> Hand:
    hand = hand_with(robot, object)
    if hand is None:
        raise ActionFailed(f"the robot isn't holding {said(object)}" if object else "the robot isn't holding anything")
    return hand


raise_right_arm = posture("right arm raised")
raise_left_arm = posture("left arm raised")
raise_both_arms = posture("left arm raised", "right arm raised")
lower_right_arm = posture("right arm hanging")
lower_left_arm = posture("left arm hanging")
lower_both_arms = posture("left arm hanging", "right arm hanging")
stretch_right_arm = posture("right arm stretched")
stretch_left_arm = posture("left arm stretched")
retract_right_arm = posture("right arm folded")
retract_left_arm = posture("left arm folded")
