"""Chaos: what a world allows to go wrong goes wrong at random times, and the rules of safety are watched meanwhile."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import combinations
from random import Random

from btlang.robots.geometry import Pose
from btlang.robots.robot import RobotError
from btlang.robots.simulation.robot import SimulatedRobot
from btlang.robots.worlds.world import WorldFault, said
from btlang.run.bus import INLINE
from btlang.run.controls import Controls
from btlang.run.events import Event, PeriodPassed
from btlang.testing.observations import Observations
from btlang.tree.node import Node
from btlang.vocabulary.lexicon import Lexicon

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    Trouble: TypeAlias = tuple[float, str, Callable[[], object]]

_PACE = 8.0  # seconds of mission time between two troubles, on average
_LASTS = (1.0, 15.0)  # seconds of a fault that ends
_STOPS = 1 / 3  # of the runs end with an emergency stop
_STANDS_AFTER = 2.0  # seconds after which a robot that was stopped must stand still
_TOLERANCE = 1.001


class Chaos:
    """A sink for one run, behind its observations. The same seed gives the same troubles.

    The rules: no faster than the body allows; no two commands at the same part of the robot; a stop is a stop.
    """

    policy = INLINE

    def __init__(
        self, seed: int, limit: float, observed: Observations, robot: SimulatedRobot, controls: Controls, words: Lexicon
    ) -> None:
        self.broken = ""
        """The first rule that did not hold, and when."""
        self.troubles: list[str] = []
        """The faults in the world, and when they came."""
        self._observed, self._robot, self._controls, self._words = observed, robot, controls, words
        self._random = Random(seed)
        self._pending = list(self._plan(limit))
        self._stopped_at: float | None = None

    def __call__(self, event: Event) -> None:
        """Take in an event of the run."""
        if not isinstance(event, PeriodPassed):
            return
        while self._pending and self._pending[0][0] <= event.t:
            at, what, happen = self._pending.pop(0)
            self.troubles.append(f"{at:.1f} s: {what}")
            try:
                happen()
            except RobotError as problem:
                self.troubles[-1] += f" ({problem})"
        if not self.broken:
            self.broken = next(self._rules(event.t), "")
            if self.broken:
                self._controls.stop()

    def end(self) -> None:
        """Check a run that is over: the robot stands, and keeps standing."""
        before = self._robot.travelled
        for _ in range(20):
            self._robot.step(0.05)
        if not self.broken and (self._robot.moving or self._robot.travelled > before):
            self.broken = "it moved after the mission was over"

    def _rules(self, now: float) -> Iterator[str]:
        """Yield what does not hold now."""
        body, (linear, angular) = self._robot.body, self._robot.velocity
        if abs(linear) > body.driving.top_speed * _TOLERANCE:
            yield f"after {now:.1f} s it drove at {linear:.2f} m/s, faster than its body allows"
        if abs(angular) > body.turning.top_speed * _TOLERANCE:
            yield f"after {now:.1f} s it turned at {angular:.0f} degrees/s, faster than its body allows"
        for one, other in combinations(self._observed.running.values(), 2):
            shared = self._parts(one) & self._parts(other)
            if shared:
                yield f"after {now:.1f} s '{one.id}' and '{other.id}' both used: {', '.join(sorted(shared))}"
        if self._stopped_at is not None and now > self._stopped_at + _STANDS_AFTER and self._robot.moving:
            yield f"after {now:.1f} s it moved, {now - self._stopped_at:.1f} s after a stop"

    def _parts(self, node: Node) -> set[str]:
        entry = self._words.entry(node.id)
        return set(entry.resources) if entry is not None and entry.sort == "action" else set()

    def _plan(self, limit: float) -> Iterator[Trouble]:
        """Plan faults in the order of time."""
        at = 0.0
        end = self._random.uniform(0.0, min(limit, 120.0)) if self._random.random() < _STOPS else limit
        while (at := at + self._random.expovariate(1 / _PACE)) < end:
            yield at, *self._random.choice(self._kinds())(at)
        if end < limit:
            yield end, "an emergency stop", self._stop

    def _kinds(self) -> Sequence[Callable[[float], tuple[str, Callable[[], object]]]]:
        kinds = [self._slip, self._silence, self._drop_goal]
        world = self._robot.world
        kinds += [self._block] if world.places else []
        kinds += [self._in_the_way] if world.objects or world.people else []
        return kinds + ([self._weak_hand] if self._robot.body.hand("right") is not None else [])

    def _stop(self) -> None:
        self._stopped_at = self._observed.now
        self._controls.emergency_stop()

    def _fault(self, at: float, kind: str, **more: object) -> Callable[[], object]:
        fault = WorldFault(kind, at, at + self._random.uniform(*_LASTS), **more)  # type: ignore[arg-type]
        return lambda: self._robot.faults.begin(fault)

    def _slip(self, at: float) -> tuple[str, Callable[[], object]]:
        wheel, grip = self._random.choice(("left", "right", "both")), self._random.uniform(0.0, 0.9)
        return f"{wheel} wheel: {grip:.0%} grip", self._fault(at, "slip", wheel=wheel, grip=grip)

    def _silence(self, at: float) -> tuple[str, Callable[[], object]]:
        return "the laser scanner is silent", self._fault(at, "silent scanner")

    def _block(self, at: float) -> tuple[str, Callable[[], object]]:
        place = self._random.choice(self._robot.world.places).name
        return f"the way to {said(place)} is blocked", self._fault(at, "blocked", place=place)

    def _weak_hand(self, at: float) -> tuple[str, Callable[[], object]]:
        return "the right hand is weak", self._fault(at, "weak hand", hand="right")

    def _drop_goal(self, at: float) -> tuple[str, Callable[[], object]]:
        return "a goal is dropped", lambda: self._robot.drop_goal("the goal was dropped")

    def _in_the_way(self, at: float) -> tuple[str, Callable[[], object]]:
        world = self._robot.world
        name = self._random.choice((*world.objects, *world.people)).name
        distance = self._random.uniform(0.6, 1.5)

        def step_in() -> None:
            pose: Pose = self._robot.pose
            self._robot.move_thing(name, *pose.ahead(distance))

        return f"{said(name)} is in the way", step_in
