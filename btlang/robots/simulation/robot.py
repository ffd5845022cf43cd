"""A simulated robot in a simulated world: deterministic, and faster than real time by far."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from functools import cache
from math import ceil
from typing import Any

from btlang.robots.assembled import STOPPED, AssembledRobot
from btlang.robots.bodies.body import Body, Idle
from btlang.robots.bodies.body_file import standard_body
from btlang.robots.ears import Ears
from btlang.robots.geometry import Point, Pose
from btlang.robots.motion.gesturing import Gestures, Idling
from btlang.robots.motion.guard.guard import Guard
from btlang.robots.motion.guard.readings import ObstacleReading, OdometryReading, ScanReading
from btlang.robots.parts import BasePart, IdlePart, JointsPart, Parts, PowerPart
from btlang.robots.robot import CompletedOperation, Hand, OnEvent, Operation, RobotError, SensorSilent, Station
from btlang.robots.simulation.faults import Faults, describe
from btlang.robots.simulation.navigation import NavigationGoal, Navigator
from btlang.robots.simulation.parts import make_simulated_parts, stations
from btlang.robots.simulation.surroundings import Surroundings
from btlang.robots.worlds.obstacles import Obstacles
from btlang.robots.worlds.world import Place, World, said
from btlang.run.outcome import Standstill
from btlang.text.time_of_day import DAY, weekday_after
from btlang.vocabulary.capabilities import part_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.robots.worlds.scan import Array
    from btlang.speech.engine import Utterance

_CONTROL_PERIOD = 0.05
_HANDS: tuple[Hand, Hand] = ("left", "right")


class SimulatedRobot(AssembledRobot):
    """A `btlang.robots.robot.Robot` in a world. The same commands and the same seed give the same run.

    `make_parts` makes its parts, which by default act in the world, from the world and its `obstacles`. Unless it
    `sees`, it drives as commanded, past its sensors: whoever commands it has the guard.
    """

    moves_by_itself = False
    power: PowerPart
    _joints: JointsPart

    def __init__(
        self,
        world: World,
        on_event: OnEvent | None = None,
        body: Body | None = None,
        make_parts: Callable[[World, Obstacles, Body], Parts] | None = None,
        obstacles: Obstacles | None = None,
        sees: bool = True,
    ) -> None:
        body = body or standard_body()
        super().__init__(body, on_event)
        self._has = cache(body.has)
        self._obstacles = obstacles or Obstacles(world)
        parts = (make_parts or make_simulated_parts)(world, self._obstacles, body)
        self._base, self.power, self._scan = parts.base, parts.power, parts.scan
        self._joints, self._hands, self._voice = parts.joints, parts.hands, parts.voice
        self._gestures = Gestures(body, self._joints)
        self.faults = Faults(world.faults)
        self._idling: Idling | None = None  # first: what is around it reports at once what it sees
        self._known = self._surroundings = Surroundings(world, self._obstacles, body, self._joints.angle, self._emit)
        if isinstance(self._joints, IdlePart) and body.idle != Idle():
            self._idling = Idling(body, self._joints, self._surroundings.where, lambda: self.pose)
        self._sensors, self._scanned = parts.sensors, 0.0
        self._guard = Guard(
            body, self._surroundings.zones, self._obstacles, sensors=self._readings if sees else list,
            odometry=self._odometry if sees else lambda: None, pose=lambda: self._base.pose, now=lambda: self.time,
        )  # fmt: skip
        self._navigator = Navigator(world, self._base, self._obstacles, self.faults, self._surroundings, self._guard)
        self._bumps_reported, self._stuck_reported = 0, False
        self._began = self._base.pose
        self._begin_faults()

    def step(self, dt: float) -> None:
        """Let `dt` (> 0) seconds pass; the scan, the events and all sensors follow."""
        stopped = self._latch.refuses
        self._latch.step()
        pieces = max(1, ceil(dt / _CONTROL_PERIOD - 1e-9))
        for _ in range(pieces):
            if stopped or self._latch.refuses:
                self._rest()  # again: what was under way in this thread may have overwritten what `stop` did in another
            self._move_on(dt / pieces)
        if self._idling is not None:
            self._idling.step(dt)
        if self.on_step is not None:
            self.on_step(dt)

    def _move_on(self, dt: float) -> None:
        self.time += dt
        self._begin_faults()
        arrived = self._navigator.control(self.time)
        travelled = self._base.travelled
        self._surroundings.step(self.time, dt, self._base.pose, self._base.velocity[0])
        self._navigator.protect()
        self._base.step(dt)
        self._joints.step(dt)
        self._gestures.step(dt)
        if not self._latch.refuses:  # an emergency stop leaves the mouth as it is
            self._voice.step(dt)
        self._hands.step(dt)
        self._drop()
        self._use_power(dt, self._base.travelled - travelled)
        self._report_contacts()
        if arrived is not None and arrived.failure is None:
            self._emit("arrive", name=arrived.name)

    def stop(self) -> None:
        """Brake hard, cancel navigation, freeze joints and hands, and end speech. For any thread."""
        self._latch.stop()
        self.stops += 1
        self._rest()
        self._emit("stop")

    def enable(self) -> None:
        """Take commands again."""
        if self._latch.refuses:
            self._rest()  # again, as in `step`
        self._latch.open()
        if self._idling is not None:
            self._idling.on = True

    def _rest(self) -> None:
        self._navigator.cancel(STOPPED)
        self._base.brake()
        if self._idling is not None:
            self._idling.halt()
        self._gestures.stop()
        self._joints.freeze()
        self._hands.stop()
        self._voice.silence()

    @property
    def time_of_day(self) -> float:
        """The world's time of day at the start, plus all steps since."""
        return (self.world.clock + self.time) % DAY

    @property
    def weekday(self) -> int:
        """The world's weekday at the start, plus all days since."""
        return weekday_after(self.world.weekday, self.world.clock + self.time)

    @property
    def moving(self) -> bool:
        """Whether the base still rolls or a joint moves."""
        return self._base.rolling or self._joints.moving

    @property
    def standstill(self) -> Standstill:
        """Whether it stands still: nothing else moves it."""
        return Standstill(None if self._base.silent is not None else self.moving)

    # Base
    @property
    def pose(self) -> Pose:
        """The pose. Raises SensorSilent if it isn't known."""
        if (silent := self._base.silent) is not None:
            raise SensorSilent(silent)
        return self._base.pose

    @property
    def way(self) -> Sequence[Point]:
        """The points of the way that it follows, in metres from where it was planned; none without a goal."""
        return self._navigator.way

    @property
    def base(self) -> BasePart:
        """The wheels; those in a world know what is really around them."""
        return self._base

    @property
    def velocity(self) -> tuple[float, float]:
        """The metres and degrees a second. Raises SensorSilent."""
        if (silent := self._base.silent) is not None:
            raise SensorSilent(silent)
        return self._base.velocity

    @property
    def travelled(self) -> float:
        """The metres that it has driven."""
        return self._base.travelled

    @property
    def wheels(self) -> tuple[float, float]:
        """The metres that the left and the right wheel have rolled."""
        return self._base.wheels

    def drive(self, linear: float, angular: float) -> None:
        """Set the wanted metres and degrees a second; end navigation. Raises RobotError for NaN."""
        if self._latch.refuses or self.power.empty:
            return
        self._navigator.cancel("another command took over the drive")
        self._base.drive(linear, angular)
        if linear == 0.0 == angular:
            self._guard.rest()

    @property
    def bumps(self) -> int:
        """How often it ran into something."""
        return self._base.bumps

    @property
    def bumped(self) -> bool:
        """Whether it ran into something and hasn't moved away yet."""
        return self._base.bumped

    @property
    def stuck(self) -> bool:
        """Whether it has been commanded to move for a second and doesn't."""
        return self._base.stuck or self._guard.stuck

    @property
    def set_out_from(self) -> Pose:
        """The pose at the start of the run."""
        return self._began

    @property
    def pace(self) -> float:
        """The share of the normal speed for journeys."""
        return self._navigator.pace

    @pace.setter
    def pace(self, share: float) -> None:
        self._navigator.pace = share

    def reset_localization(self) -> None:
        """Do nothing: it always knows its pose."""

    def navigate_to(self, name: str) -> NavigationGoal:
        """Go to a place, an object or a person. Raises RobotError for an unknown name."""
        known = self._surroundings.known(name)
        self._surroundings.check_free(known)
        return self._set_out(known)

    def navigate_to_pose(self, pose: Pose, name: str = "") -> NavigationGoal:
        """Go to a pose: to a target by its name or its spot; see Surroundings.goal_at."""
        return self._set_out(name, pose) if name else self._set_out(*self._surroundings.goal_at(pose))

    def prepare_journeys(self) -> None:
        """Load the planner, so that the first journey takes no longer than the others."""
        with suppress(RobotError):  # a world that is too large fails the journey, with its reason
            self._navigator.prepare()

    def _set_out(self, name: str, pose: Pose | None = None) -> NavigationGoal:
        self._need("navigation")
        goal = self._navigator.start(name, pose)
        if self._latch.refuses:
            goal.end(STOPPED)
        if self.power.empty:
            goal.end("the battery is empty")
        self._emit("navigate", name=name)
        return goal

    def drop_goal(self, reason: str) -> None:
        """Fail the current journey, as if navigation had lost it."""
        self._navigator.cancel(reason)

    def scan(self) -> Array:
        """Return 360 distances, computed when first read after a step. Raises RobotError if the scanner is silent."""
        self._need("scanner")
        if self.faults.scanner_silent:
            raise SensorSilent("the laser scanner is silent")
        return self._scan(self.pose)

    def seed_choices(self, seed: int, made: int = 0) -> None:
        """Begin a run, whose random choices follow from the seed; `made` of them have been made already."""
        self._choices.begin(seed, made)
        self._surroundings.begin(seed)
        self._voice.speak_in()
        self._began, self.pace = self._base.pose, 1.0

    def sees(self, name: str) -> bool:
        """Return whether an object or a person is in view. Raises RobotError for an unknown name."""
        return self._surroundings.sight.sees(self._surroundings.known(name), self.pose)

    def seen(self, kind: str) -> list[str]:
        """Return the objects or people in view, nearest first."""
        return self._surroundings.sight.seen(kind, self.pose)

    def take_picture(self) -> Operation:
        """Take a picture; its event names what is in view. Raises RobotError without a camera."""
        self._need("perception")
        return super().take_picture()

    @property
    def surroundings(self) -> Surroundings:
        """The surroundings, and who lives there."""
        return self._surroundings

    @property
    def ears(self) -> Ears:
        """What it has heard. Raises RobotError if it has no ears."""
        self._need("ears")
        return self._surroundings.ears

    def hear(self, text: str, who: str = "") -> None:
        """Take a text that somebody says or types."""
        self._surroundings.hear(text, who)

    def invite(self) -> str:
        """Let a guest come; return the name."""
        return self._surroundings.people.invite()

    def ask(self, question: str, person: str = "") -> None:
        """Implement Listening. People of the world may answer."""
        question = question or self._last_said
        self.ears.asking = question or "..."
        self._emit("ask", text=question, who=person)
        self._surroundings.ask(question, person)

    def guide(self, person: str, follow: bool) -> None:
        """Let somebody follow the robot from now on, or no longer. Raises RobotError if they aren't in view."""
        known = self._surroundings.known(person)
        if follow and not self._surroundings.sight.sees(known, self.pose):
            raise RobotError(f"I don't see {said(known)}")
        self._surroundings.people.follow(known, follow)
        if self._idling is not None and follow:
            self._idling.attend(known)

    def move_door(self, name: str, is_open: bool) -> Operation:
        """Open or close a door within reach. Raises RobotError."""
        self._surroundings.move_door(name, is_open, self.pose)
        return CompletedOperation()

    def is_open(self, door: str) -> bool:
        """Return whether a door is open. Raises RobotError for an unknown one."""
        return self._surroundings.is_open(door)

    def is_on(self, name: str) -> bool:
        """Return whether an object is switched on. Raises RobotError for one that can't be switched."""
        return self._surroundings.is_on(name)

    def forget_map(self) -> None:
        """Forget where it saw objects and people."""
        self._surroundings.sight.forget()

    def switch(self, name: str, on: bool | None) -> Operation:
        """Switch an object within reach on or off; None toggles it. Raises RobotError."""
        self._surroundings.switch(name, on, self.pose)
        return CompletedOperation()

    @property
    def held_up(self) -> str:
        """The person in its way, "" if nobody makes it wait."""
        return self._navigator.held_up

    def wait_for_way(self, seconds: float) -> None:
        """Set the seconds to wait for somebody in its way before it looks for another way."""
        self._navigator.patience = seconds

    def name_places(self, places: Iterable[Place]) -> None:
        """Set the places of a mission, in addition to those of the world."""
        self._surroundings.name_places(places)

    def move_thing(self, name: str, x: float, y: float) -> None:
        """Put an object or a person somewhere else, as somebody in the world would. Raises RobotError."""
        self._surroundings.move(name, x, y)

    def carry(self, pose: Pose) -> None:
        """Move only the base, as somebody who pushes it would; everything else goes on."""
        self._base.put(pose)

    def put(self, pose: Pose) -> None:
        """Put the robot somewhere else, at rest, as somebody who carries it would."""
        self._rest()
        self._base.put(pose)
        self._guard.forget()

    # Power

    @property
    def stations(self) -> list[Station]:
        """The docks, nearest first. Raises RobotError if there are none."""
        self._need("docking")
        return stations(self.world, self.body, self.pose)

    def dock(self) -> CompletedOperation:
        """Connect to the charger at once. Raises RobotError if the robot isn't at the dock."""
        self._need("docking")
        self.power.connect(self.pose, self.faults.fails_to_dock)
        self._emit("dock")
        return CompletedOperation()

    def undock(self) -> CompletedOperation:
        """Disconnect at once, without moving."""
        if self.power.docked:
            self.power.docked = False
            self._emit("undock")
        return CompletedOperation()

    # Arms, hands, head

    def grasp(self, hand: Hand, name: str | None = None) -> Operation:
        """Close a hand on the named or the nearest object. Raises RobotError."""
        self._check_stop()
        if name is not None:
            self._surroundings.check_movable(name)
        found = self._hands.grasp(hand, None if name is None else self._surroundings.known(name), self.pose, self.time)
        self._emit("grasp", hand=hand, name=found if isinstance(found, str) else name)
        return CompletedOperation() if isinstance(found, str) else found

    def release(self, hand: Hand) -> Operation:
        """Open a hand and put down what it held."""
        if self._latch.refuses:
            return CompletedOperation()
        found = self._hands.release(hand, self.pose)
        self._emit("release", hand=hand, name=found if isinstance(found, str) else None)
        return CompletedOperation() if isinstance(found, str | None) else found

    def hand_over(self, hand: Hand, person: str) -> Operation:
        """Give what a hand holds to a person within reach. Raises RobotError."""
        name = self._hands.held.get(hand)
        if name is None:
            raise RobotError(f"the {hand} hand is empty")
        self._check_stop()
        self._surroundings.check_taker(name, person, self.pose)
        found = self._hands.hand_over(hand)
        self._surroundings.give(name, person)
        self._emit("give", hand=hand, name=name, who=self._surroundings.known(person))
        return CompletedOperation() if isinstance(found, str | None) else found

    def holding(self, hand: Hand) -> str | None:
        """Return the name of what the hand holds."""
        return self._hands.held.get(hand)

    def say(self, text: str, after: float = 0.0) -> None:
        """Start to speak after so many seconds, for as long as the voice of the body takes. Raises RobotError."""
        self._need("voice")
        super().say(text, after)

    def speak_in(self, language: str) -> None:
        """Speak in a language until the end of the run. Raises RobotError if it can't."""
        self._need("voice")
        super().speak_in(language)

    def utterance(self, text: str) -> Utterance:
        """Return the sound and the times of a text. Raises RobotError."""
        self._need("voice")
        return super().utterance(text)

    def print(self, text: str) -> None:
        """Show a text at once."""
        self._need("screen")
        super().print(text)

    def _need(self, need: str) -> None:
        """Raise RobotError if the body lacks a part."""
        if not self._has(need):
            raise RobotError(f"the robot has no {part_of(need)}")

    def _readings(self) -> list[ObstacleReading]:
        """Return the readings of the sensors; a silent scanner repeats its last one."""
        readings = self._sensors(self.time)
        if not self.faults.scanner_silent:
            self._scanned = self.time
            return readings
        return [each.replace(stamp=self._scanned) if isinstance(each, ScanReading) else each for each in readings]

    def _odometry(self) -> OdometryReading | None:
        return OdometryReading("odometry", self.time, self._base.silent or "", self._base.pose)

    def _begin_faults(self) -> None:
        for fault in self.faults.advance(self.time):
            self._emit("fault", kind=fault.kind, text=describe(fault))
        self._base.grips = self.faults.grips

    def _use_power(self, dt: float, metres: float) -> None:
        was_empty = self.power.empty
        if self.power.step(dt, metres, self._base.pose):
            self._emit("undock")
        if self.power.empty and not was_empty:
            self._navigator.cancel("the battery is empty")
            self._base.brake()
            self._emit("battery", percent=0.0)

    def _drop(self) -> None:
        for hand in _HANDS:
            if hand in self._hands.held and self._hands.held_for(hand, self.time) >= self.faults.holds_for(hand):
                name = self._hands.drop(hand, self._base.pose)
                self._emit("drop", hand=hand, name=name)

    def _report_contacts(self) -> None:
        if self._base.bumps > self._bumps_reported:
            self._bumps_reported = self._base.bumps
            self._emit("bump", into=self._base.bumped_into)
        if self.stuck and not self._stuck_reported:
            self._emit("stuck")
        self._stuck_reported = self.stuck

    def _emit(self, event: str, **data: Any) -> None:
        if self._idling is not None and event in ("hear", "ask"):
            self._idling.attend(data["who"])
        super()._emit(event, **data)
