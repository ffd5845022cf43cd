"""Decorators of Nav2 that pass on a goal, or tick their child when the goal, the path, the place or the speed asks for
it (nav2_behavior_tree/plugins/decorator).

Differences: the GoalUpdater has no topics, so its goals come from the blackboard alone. Pose and speed are those of the
robot, not of transforms and odometry, so the frames are not used. Ports under a `{key}` are read at every tick.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from math import dist

from btlang.engine.instance import NodeInstance, blackboard_key
from btlang.engine.leaves.leaf import ActionFailed
from btlang.engine.nodes.ports import rate_port, value_port
from btlang.engine.nodes.timed import Stopwatch
from btlang.engine.status import FAILURE, RUNNING, SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Protocol, TypeAlias

    from btlang.engine.instance import Compiled, EngineState

    Point: TypeAlias = tuple[float, float]

    class Trigger(Protocol):
        """When a decorator ticks its child again. The methods raise ActionFailed for what can't be known."""

        def begin(self) -> None: ...

        def due(self) -> bool: ...

        def succeeded(self) -> None: ...

        def wait(self) -> int: ...

        def halt(self, keep: bool) -> None: ...


def goal_updater(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Copy input_goal and input_goals to output_goal and output_goals, and tick the child (goal_updater_node.cpp)."""
    [(child, halt_child)] = children
    pairs = tuple(
        (_goal_entry(instance, f"input_{name}"), blackboard_key(f"output_{name}", instance.node.port(f"output_{name}")))
        for name in ("goal", "goals")
    )
    scope = instance.scope

    def tick() -> int:
        for goal, key in pairs:
            value = goal()
            if key is not None and value is not None:
                scope.set(key, value)
        return child()

    return tick, halt_child


def goal_updated_controller(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Tick its child at the start, while it is RUNNING, and when the goal has changed (goal_updated_controller.cpp)."""
    return _on_demand(instance, children, GoalTrigger(instance))


def distance_controller(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Tick its child at the start, while it is RUNNING, and each time the robot is `distance` metres away from where it
    was at the child's last success (distance_controller.cpp).
    """
    return _on_demand(instance, children, DistanceTrigger(instance))


def speed_controller(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Tick its child at the start, while it is RUNNING, when the goal has changed, and the more often the faster the
    robot drives (speed_controller.cpp).
    """
    return _on_demand(instance, children, SpeedTrigger(instance))


def path_longer_on_approach(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Tick its child while the path to the same goal is `length_factor` times as long as before, which was shorter than
    `prox_len` metres; SUCCESS otherwise (path_longer_on_approach.cpp).

    The path before is that of the last tick without the child, or of the child's end; no halt makes it forgotten. A
    child that is RUNNING when the path is no longer that long is halted; there it keeps running. Only the positions of
    goals are compared.
    """
    [(child, halt)] = children
    path, near, factor = (
        _goal_entry(instance, "path"),
        rate_port(instance, "prox_len"),
        rate_port(instance, "length_factor"),
    )
    before: list[Point] = []

    def tick() -> int:
        nonlocal before
        try:
            now, most = _points(path()), factor() * _length(before)
            is_longer = (
                bool(now and before) and now[-1] == before[-1] and _length(before) < near() and _length(now) > most
            )
        except ActionFailed as problem:
            halt(False)
            return instance.fail(str(problem))
        if is_longer:
            status = child()
            if status in (SUCCESS, FAILURE):
                before = now
            return status
        halt(False)
        before = now
        return SUCCESS

    return tick, halt


def _points(path: Any) -> list[Point]:
    """Return the points of a path: a message with poses, a list of poses or of points [x, y], or JSON; [] for None.

    Raises ActionFailed.
    """
    try:
        found = json.loads(path.removeprefix("json:")) if isinstance(path, str) else path
        return [_point(_part(_part(pose, "pose"), "position")) for pose in _part(found, "poses") or ()]
    except (ValueError, TypeError, LookupError, AttributeError, RecursionError):
        raise ActionFailed(f"path must be a path, such as json:[[0, 0], [1, 2]], not {str(path)[:80]!r}") from None


def _part(whole: Any, name: str) -> Any:
    """Return what a message or its JSON has by a name, else the whole."""
    return whole.get(name, whole) if isinstance(whole, Mapping) else getattr(whole, name, whole)


def _point(position: Any) -> Point:
    x, y = position[:2] if isinstance(position, Sequence) else (_part(position, axis) for axis in "xy")
    return float(x), float(y)


def _length(points: Sequence[Point]) -> float:
    return sum(map(dist, points, points[1:]))


def _on_demand(instance: NodeInstance, children: Sequence[Compiled], trigger: Trigger) -> Compiled:
    """Tick the child at the start, while it is RUNNING, and when the trigger says so; RUNNING in between."""
    [(child, halt_child)] = children
    stays = instance.parent_keeps_completed  # it does not reset a child that has completed
    fresh, running = True, False

    def tick() -> int:
        nonlocal fresh, running
        try:
            if fresh:
                trigger.begin()
            if not (trigger.due() or fresh or running):
                return trigger.wait()
            status = child()
            running = status == RUNNING
            if status == SUCCESS and stays:
                trigger.succeeded()
        except ActionFailed as problem:
            halt(False)
            return instance.fail(str(problem))
        fresh = status in (SUCCESS, FAILURE) and not stays
        return status

    def halt(keep: bool) -> None:
        nonlocal fresh, running
        halt_child(keep)
        trigger.halt(keep)
        if not keep:
            fresh, running = True, False

    return tick, halt


def _goal_entry(instance: NodeInstance, port: str, key: str | None = None) -> Callable[[], Any]:
    """Make a function that returns the value of a port, or of the entry `key` if the port isn't given; None for
    none.
    """
    text, scope = instance.node.port(port), instance.scope
    name = blackboard_key(port, text) if text else key
    if name is None:
        return lambda: text or None
    return lambda: scope.get(name) if name in scope else None


class GoalTrigger:
    """A trigger for goals that change: those in the ports goal and goals, or else in the entries of these names."""

    def __init__(self, instance: NodeInstance) -> None:
        self._entries = [_goal_entry(instance, name, name) for name in ("goal", "goals")]
        self._goals: list[Any] | None = None

    def begin(self) -> None:
        """Take the goals as they are."""
        self._goals = [goal() for goal in self._entries]

    def due(self) -> bool:
        """Return whether they have changed since the last call."""
        before, self._goals = self._goals, [goal() for goal in self._entries]
        return before is not None and before != self._goals

    def succeeded(self) -> None:
        """Do nothing."""

    def wait(self) -> int:
        """Return RUNNING."""
        return RUNNING

    def halt(self, keep: bool) -> None:
        """Do nothing: the next run begins anew."""

    def saved(self) -> None:
        """Save nothing: in a restored run, the goals are as they are at its first tick."""

    def restore(self, saved: None) -> None:
        """Forget the goals."""
        self._goals = None


class DistanceTrigger:
    """A trigger for the distance from where the robot was."""

    def __init__(self, instance: NodeInstance) -> None:
        self._state = instance.state
        self._distance = rate_port(instance, "distance")
        self._from = (0.0, 0.0)

    def begin(self) -> None:
        """Measure from here."""
        pose = _base_of(self._state).pose
        self._from = pose.x, pose.y

    succeeded = begin

    def due(self) -> bool:
        """Return whether the robot is far enough away."""
        pose = _base_of(self._state).pose
        return dist(self._from, (pose.x, pose.y)) >= self._distance()

    def wait(self) -> int:
        """Return RUNNING."""
        return RUNNING

    def halt(self, keep: bool) -> None:
        """Do nothing: the next run begins anew."""

    def saved(self) -> list[float]:
        """Return from where it measures."""
        return [*self._from]

    def restore(self, saved: list[float]) -> None:
        """Measure from there."""
        x, y = saved
        self._from = x, y


class SpeedTrigger:
    """A trigger for goals that change, and for a rate that grows with the speed, from min_rate to max_rate."""

    def __init__(self, instance: NodeInstance) -> None:
        self._state = instance.state
        self._goals = GoalTrigger(instance)
        self._rates = rate_port(instance, "min_rate"), rate_port(instance, "max_rate")
        self._speeds = [value_port(instance, port, _number) for port in ("min_speed", "max_speed")]
        self._stopwatch = Stopwatch(instance.state.clock)
        self._period = 0.0  # milliseconds

    def begin(self) -> None:
        """Begin with the highest rate."""
        self._goals.begin()
        self._start(self._rates[1]())

    def due(self) -> bool:
        """Return whether the goal has changed or the time is over, and begin the next time."""
        if self._goals.due():
            self._start(self._rates[1]())
            return True
        if not self._stopwatch.reached(self._period):
            return False
        low, high = (rate() for rate in self._rates)
        slow, fast = (speed() for speed in self._speeds)
        speed = _base_of(self._state).velocity[0]
        share = (speed - slow) / (fast - slow) if fast > slow else float(speed >= fast)
        self._start(low + (high - low) * min(max(share, 0.0), 1.0))
        return True

    def succeeded(self) -> None:
        """Do nothing: the time counts from the last tick."""

    def wait(self) -> int:
        """Return RUNNING, and ask for a tick when the time is over."""
        return self._stopwatch.wait(self._period)

    def halt(self, keep: bool) -> None:
        """Pause or reset the time."""
        self._stopwatch.halt(keep)

    def saved(self) -> list[float]:
        """Return the time that has passed, and how long it is."""
        return [self._stopwatch.saved(), self._period]

    def restore(self, saved: list[float]) -> None:
        """Go on with that time."""
        seconds, self._period = saved
        self._stopwatch.restore(seconds)

    def _start(self, rate: float) -> None:
        self._period = 1000 / rate
        self._stopwatch.halt(False)
        self._stopwatch.reached(self._period)


def _base_of(state: EngineState) -> Any:
    base = getattr(state.services.get("robot"), "base", None)
    if base is None:
        raise ActionFailed("this robot has no base")
    return base


def _number(value: Any) -> float:
    try:
        return float(value)
    except (TypeError, ValueError):
        raise ActionFailed(f"a speed must be a number, not {value!r}") from None
