"""What the words of tests (words.toml) do: they ask what has happened so far, or change the world."""

from __future__ import annotations

from btlang.actions.common import where
from btlang.engine.leaves.leaf import Failed
from btlang.engine.status import FAILURE, RUNNING, SUCCESS
from btlang.robots.geometry import Pose
from btlang.robots.robot import Hand
from btlang.robots.simulation.robot import SimulatedRobot
from btlang.robots.worlds.world import WorldFault
from btlang.run.controls import Controls
from btlang.testing.observations import Observations

_HANDS: tuple[Hand, Hand] = ("left", "right")


def _exactly(wanted: int, count: int) -> bool | Failed:
    return count == wanted or Failed(f"it was {count} time{'s' * (count != 1)}")


def mission_succeeds(observed: Observations) -> bool:
    """Return whether the mission succeeded, once it has ended."""
    return observed.outcome is not None and observed.outcome.succeeded


def mission_fails(observed: Observations) -> bool:
    """Return whether the mission failed, once it has ended; one that was stopped has not failed."""
    outcome = observed.outcome
    return outcome is not None and not outcome.succeeded and not outcome.stopped


def mission_ends(observed: Observations) -> bool:
    return observed.is_over


def has_said(observed: Observations, text: str) -> bool:
    return observed.said_times(text) > 0


def has_said_once(observed: Observations, text: str) -> bool | Failed:
    return _exactly(1, observed.said_times(text))


def has_said_times(observed: Observations, text: str, number: int) -> bool | Failed:
    return _exactly(number, observed.said_times(text))


def has_never_said(observed: Observations, text: str) -> bool:
    return observed.said_times(text) == 0


def has_printed(observed: Observations, text: str) -> bool:
    return observed.printed_times(text) > 0


def has_done(observed: Observations, text: str) -> bool:
    return observed.times(text, SUCCESS) > 0


def has_done_once(observed: Observations, text: str) -> bool | Failed:
    return _exactly(1, observed.times(text, SUCCESS))


def has_done_times(observed: Observations, text: str, number: int) -> bool | Failed:
    return _exactly(number, observed.times(text, SUCCESS))


def has_tried(observed: Observations, text: str) -> bool:
    return observed.times(text, RUNNING) > 0


def has_tried_once(observed: Observations, text: str) -> bool | Failed:
    return _exactly(1, observed.times(text, RUNNING))


def has_tried_times(observed: Observations, text: str, number: int) -> bool | Failed:
    return _exactly(number, observed.times(text, RUNNING))


def has_never_tried(observed: Observations, text: str) -> bool:
    return observed.times(text, RUNNING) == 0


def has_failed_to(observed: Observations, text: str) -> bool:
    return observed.times(text, FAILURE) > 0


def is_doing(observed: Observations, text: str) -> bool:
    return observed.is_doing(text)


def has_reached(observed: Observations, place: str) -> bool:
    return place in observed.reached


def has_never_reached(observed: Observations, place: str) -> bool:
    return place not in observed.reached


def has_reached_person(observed: Observations, person: str) -> bool:
    return person in observed.reached


def has_held(observed: Observations, object: str) -> bool:
    return object in observed.held


def has_never_held(observed: Observations, object: str) -> bool:
    return object not in observed.held


def has_dropped(observed: Observations) -> bool:
    return observed.drops > 0


def has_bumped(observed: Observations) -> bool:
    return observed.bumps > 0


def has_never_bumped(observed: Observations) -> bool:
    return observed.bumps == 0


def stands_still(robot: SimulatedRobot) -> bool:
    return not robot.moving


def mission_time(observed: Observations) -> float:
    """Return the time of the mission in seconds."""
    return observed.now


def distance_travelled(robot: SimulatedRobot) -> float:
    """Return the distance in metres."""
    return robot.travelled


def set_battery(robot: SimulatedRobot, percent: float) -> None:
    robot.power.set_level(percent)


def put_robot(
    robot: SimulatedRobot,
    place: str | None = None,
    x: float | None = None,
    y: float | None = None,
    facing: float | None = None,
) -> None:
    at = where(robot, place, x, y)
    robot.put(Pose(*at, robot.pose.heading if facing is None else facing))


def put_person(
    robot: SimulatedRobot, person: str, place: str | None = None, x: float | None = None, y: float | None = None
) -> None:
    robot.move_thing(person, *where(robot, place, x, y))


def put_object(
    robot: SimulatedRobot, object: str, place: str | None = None, x: float | None = None, y: float | None = None
) -> None:
    robot.move_thing(object, *where(robot, place, x, y))


def block_way(robot: SimulatedRobot, place: str) -> None:
    robot.faults.begin(WorldFault("blocked", place=place))


def free_way(robot: SimulatedRobot, place: str) -> None:
    robot.faults.end("blocked", place)


def silence_scanner(robot: SimulatedRobot) -> None:
    robot.faults.begin(WorldFault("silent scanner"))


def repair_scanner(robot: SimulatedRobot) -> None:
    robot.faults.end("silent scanner")


def slip(robot: SimulatedRobot, percent: float) -> None:
    robot.faults.begin(WorldFault("slip", grip=min(1.0, percent / 100)))


def grip(robot: SimulatedRobot) -> None:
    robot.faults.end("slip")


def weaken_hands(robot: SimulatedRobot) -> None:
    for hand in _HANDS:
        robot.faults.begin(WorldFault("weak hand", hand=hand))


def restore_hands(robot: SimulatedRobot) -> None:
    robot.faults.end("weak hand")


def stop_mission(controls: Controls) -> None:
    controls.stop()


def emergency_stop(controls: Controls) -> None:
    controls.emergency_stop()


def person_comes(robot: SimulatedRobot, person: str) -> None:
    robot.surroundings.people.come(person)


def visitor_comes(robot: SimulatedRobot) -> None:
    robot.invite()


def person_leaves(robot: SimulatedRobot, person: str) -> None:
    robot.surroundings.people.leave(person)


def person_walks(
    robot: SimulatedRobot, person: str, place: str | None = None, x: float | None = None, y: float | None = None
) -> None:
    robot.surroundings.people.walk(person, where(robot, place, x, y))


def person_answers(robot: SimulatedRobot, person: str, text: str) -> None:
    robot.surroundings.people.answer(person, text)


def person_says(robot: SimulatedRobot, person: str, text: str) -> None:
    robot.surroundings.people.say(person, text)


def somebody_answers(robot: SimulatedRobot, text: str) -> None:
    robot.hear(text)


def somebody_opens(robot: SimulatedRobot, door: str) -> None:
    robot.surroundings.swing(door, True)


def somebody_closes(robot: SimulatedRobot, door: str) -> None:
    robot.surroundings.swing(door, False)


def break_dock(robot: SimulatedRobot) -> None:
    robot.faults.begin(WorldFault("dock"))


def repair_dock(robot: SimulatedRobot) -> None:
    robot.faults.end("dock")


def has_seen_person(observed: Observations, person: str) -> bool:
    return person in observed.met


def has_called(observed: Observations) -> bool:
    return observed.calls > 0


def has_never_called(observed: Observations) -> bool:
    return observed.calls == 0
