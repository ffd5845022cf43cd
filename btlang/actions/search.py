"""Searching: looks around, goes where something was, and then from place to place, the nearest first."""

from __future__ import annotations

from collections.abc import Callable, Generator
from contextlib import closing
from typing import Protocol, TypeAlias

from btlang.actions.common import COUNTABLE, DrivingRobot, Watch, compares, of_a_kind, spot
from btlang.actions.motion import Steps, turn
from btlang.actions.navigation import accomplish, go_to, travel
from btlang.actions.sensing import holding
from btlang.engine.leaves.leaf import ActionFailed, Failed
from btlang.robots.robot import Hands, Navigation, Perception
from btlang.robots.worlds.descriptions import describe_relations
from btlang.robots.worlds.likeness import describe
from btlang.robots.worlds.world import said
from btlang.text.formatting import joined
from btlang.vocabulary.references import choice_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.blackboard import Blackboard

Found: TypeAlias = Callable[[str], object]
"""Takes the name of what was found."""
COUNT = "@_count"
"""The blackboard key of the last count."""
_COUNTED, _PERSON = "@_counted", "person"  # what the last count was of: a kind, or a type of things
_NAMES = "@_counted_names"
_AROUND = 360.0


class SearchingRobot(Perception, Navigation, DrivingRobot, Hands, Protocol):
    """A robot that moves about and recognises what it sees."""


def look_for_person(
    robot: SearchingRobot,
    person: str,
    place: str | None = None,
    x: float | None = None,
    y: float | None = None,
    found: Found | None = None,
) -> Steps:
    """Search a place, or all of them, until a person is in view there. Fails if they are in none."""
    yield from _find(robot, "person", person, place, x, y, found)


def look_for_object(
    robot: SearchingRobot,
    object: str,
    place: str | None = None,
    x: float | None = None,
    y: float | None = None,
    found: Found | None = None,
) -> Steps:
    """Search a place, or all of them, until an object is in view there, or in a hand. Fails if it is in none."""
    yield from _find(robot, "object", object, place, x, y, found)


def look_for_someone(
    robot: SearchingRobot, place: str | None = None, x: float | None = None, y: float | None = None
) -> Steps:
    """Search a place, or all of them, until anybody is in view there. Fails if nobody is."""
    yield from _search(robot, "person", None, place, x, y)


def find_person(
    robot: SearchingRobot,
    person: str,
    place: str | None = None,
    x: float | None = None,
    y: float | None = None,
    found: Found | None = None,
) -> Steps:
    """Look for a person and go there."""
    name = yield from _find(robot, "person", person, place, x, y, found)
    yield from travel(robot, name)


def find_object(
    robot: SearchingRobot,
    object: str,
    place: str | None = None,
    x: float | None = None,
    y: float | None = None,
    found: Found | None = None,
) -> Steps:
    """Look for an object and go there."""
    name = yield from _find(robot, "object", object, place, x, y, found)
    yield from travel(robot, name)


def find_someone(
    robot: SearchingRobot, place: str | None = None, x: float | None = None, y: float | None = None
) -> Steps:
    """Look for anybody and go there."""
    yield from look_for_someone(robot, place, x, y)
    for person in _found(robot, "person", None, place)[:1]:
        yield from travel(robot, person)


def count_people(
    robot: SearchingRobot,
    blackboard: Blackboard,
    place: str | None = None,
    x: float | None = None,
    y: float | None = None,
) -> Steps:
    """Count the people in view from a place or a point, or from where the robot is, while it turns once around."""
    yield from _count(robot, blackboard, "person", place, x, y)


def count_objects(
    robot: SearchingRobot,
    blackboard: Blackboard,
    place: str | None = None,
    x: float | None = None,
    y: float | None = None,
) -> Steps:
    """Count the objects in view from a place or a point, or from where the robot is, while it turns once around."""
    yield from _count(robot, blackboard, "object", place, x, y)


def count_kind(
    robot: SearchingRobot,
    blackboard: Blackboard,
    kinds: str,
    place: str | None = None,
    x: float | None = None,
    y: float | None = None,
) -> Steps:
    """Count the objects or people of a kind, as `count_objects` counts all objects."""
    yield from _count(robot, blackboard, kinds, place, x, y, of_kind=True)


def count(blackboard: Blackboard) -> int | Failed:
    """Return how many the robot counted last. Fails if it hasn't counted."""
    if COUNT not in blackboard:
        raise ActionFailed("nothing was counted")
    return int(blackboard.get(COUNT))


def counted_names(blackboard: Blackboard) -> str | Failed:
    """Return who or what the robot counted last, of those at the place where it did. Fails if it hasn't counted."""
    if _NAMES not in blackboard:
        raise ActionFailed("nothing was counted")
    names = blackboard.get(_NAMES)
    return joined(names) if names else "nobody" if blackboard.get(_COUNTED) == _PERSON else "nothing"


def counted(
    blackboard: Blackboard,
    below: float | None = None,
    above: float | None = None,
    at_least: float | None = None,
    at_most: float | None = None,
    equal: float | None = None,
    kinds: str | None = None,
    counted: str | None = None,
) -> bool | Failed:
    """Return whether the robot counted so many last; without a limit, any. Fails if it hasn't counted.

    Fails, too, if it counted anything but these kinds, or what `counted` says: "person" or "object".
    """
    found = count(blackboard)
    if isinstance(found, Failed):
        return found
    things = str(blackboard.get(_COUNTED)) if _COUNTED in blackboard else ""
    if kinds not in (None, things) or (counted is not None and (counted == _PERSON) != (things == _PERSON)):
        raise ActionFailed(f"it counted something else last: {things}")
    return compares(found, below, above, at_least, at_most, equal) or Failed(lambda: f"it counted {found}")


def _count(
    robot: SearchingRobot,
    blackboard: Blackboard,
    what: str,
    place: str | None,
    x: float | None,
    y: float | None,
    of_kind: bool = False,
) -> Steps:
    if place is not None or x is not None:
        yield from go_to(robot, place, x, y)
    types = COUNTABLE if of_kind else (what,)
    found = set[str]().union(*map(robot.seen, types))
    with closing(turn(robot, _AROUND)) as turning:
        for _ in turning:
            yield
            found.update(*map(robot.seen, types))
    if of_kind:
        found &= set(of_a_kind(robot, what))
    there = found if place is None else set[str]().union(*(robot.described(type, {"at": place}) for type in types))
    blackboard.set(_NAMES, sorted(found & there))
    blackboard.set(COUNT, len(found))
    blackboard.set(_COUNTED, what)


def _find(
    robot: SearchingRobot,
    type: str,
    sought: str,
    place: str | None,
    x: float | None,
    y: float | None,
    found: Found | None,
) -> Generator[None, None, str]:
    """Search for what has a name or fits a description, and return its name. A hand may hold it."""
    held = _held(robot, type, sought)
    if not held:
        yield from _search(robot, type, sought, place, x, y)
    name = (held or _found(robot, type, sought, place))[0]
    if found is not None:
        found(name)
    return name


def _held(robot: SearchingRobot, type: str, sought: str) -> list[str]:
    """Return what the hands hold of what is sought."""
    may_hold = type == "object" and robot.body.has("holding")
    return [name for name in _known(robot, type, sought) if holding(robot, name)] if may_hold else []


def _known(robot: SearchingRobot, type: str, sought: str) -> list[str]:
    """Return the name that is sought, or those that the robot knows of what fits the description, nearest first."""
    choice = choice_of(sought)
    return [sought] if choice is None else robot.described(type, dict(choice.parts))


def _search(
    robot: SearchingRobot, type: str, sought: str | None, place: str | None, x: float | None, y: float | None
) -> Steps:
    is_here = place is not None or x is not None
    tour = _look_in(robot, place, x, y) if is_here else _tour(robot, type, sought)
    with closing(tour):
        while not _found(robot, type, sought, place):
            try:
                next(tour)
            except StopIteration:
                where = f" in {said(place or spot(x, y))}" if is_here else ""
                raise ActionFailed(f"I haven't found {_words(type, sought)}{where}") from None
            yield


def _words(type: str, sought: str | None) -> str:
    """Return the words for what is sought."""
    choice = choice_of(sought or "")
    if choice is not None:
        parts = dict(choice.parts)
        return describe(type, parts, describe_relations(parts))
    return said(sought) if sought else "anybody"


def _found(robot: SearchingRobot, type: str, sought: str | None, place: str | None) -> list[str]:
    """Return which of those that are searched are in view, and at the place as far as the robot knows."""
    if sought is None:
        seen = robot.seen(type)
    else:
        seen = [name for name in _known(robot, type, sought) if robot.sees(name)]
    if not seen or place is None:
        return seen
    there = robot.described(type, {"at": place})
    return [each for each in seen if each in there]


def _look_in(robot: SearchingRobot, place: str | None, x: float | None, y: float | None) -> Steps:
    yield from go_to(robot, place, x, y)
    yield from turn(robot, _AROUND)


def _tour(robot: SearchingRobot, type: str, sought: str | None) -> Steps:
    """Turn once around here, go where the robot knows it, and look into all places."""
    watch = Watch(robot)
    yield from turn(robot, _AROUND)
    for name in _known(robot, type, sought)[:1] if sought is not None else ():
        try:
            yield from accomplish(robot.navigate_to(name))
            yield from turn(robot, _AROUND)
        except ActionFailed:
            watch.check_stop()  # the robot doesn't know it, or it isn't there any more
    left = robot.place_names()
    while left:
        nearest = min(left, key=lambda place: robot.pose.distance_to(robot.locate(place)))
        left.remove(nearest)
        try:
            yield from travel(robot, nearest)
        except ActionFailed:
            watch.check_stop()
            continue  # no way leads there
        yield from turn(robot, _AROUND)
