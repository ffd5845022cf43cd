"""A simulated robot in a simulated world: deterministic, and faster than real time by far."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from functools import cache
from math import ceil
from typing import Any

from btlang.robots.body import Body, Idle
from btlang.robots.body_file import standard_body
from btlang.robots.choices import Choices
from btlang.robots.ears import Ears
from btlang.robots.faults import Faults, describe
from btlang.robots.geometry import Point, Pose
from btlang.robots.gesturing import Gestures
from btlang.robots.idling import Idling
from btlang.robots.latch import Latch
from btlang.robots.motion.guard.guard import Guard, Guarded
from btlang.robots.motion.guard.readings import ObstacleReading, OdometryReading, ScanReading
from btlang.robots.navigation import NavigationGoal, Navigator
from btlang.robots.obstacles import Obstacles
from btlang.robots.parts import BasePart, IdlePart, Parts
from btlang.robots.power import stations
from btlang.robots.robot import CompletedOperation, Hand, OnEvent, Operation, RobotError, SensorSilent
from btlang.robots.simulated_parts import simulated_parts
from btlang.robots.station import Station
from btlang.robots.surroundings import Surroundings
from btlang.robots.world import Place, World, said
from btlang.robots.zones import Zones
from btlang.run.outcome import Standstill
from btlang.run.robot_state import Whereabouts
from btlang.text.time_of_day import DAY, weekday_after
from btlang.vocabulary.capabilities import part_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.robots.scan import Array
    from btlang.speech.engine import Utterance

_CONTROL_PERIOD = 0.05
_HANDS: tuple[Hand, Hand] = ("left", "right")


class SimulatedRobot(Guarded):
    """Implements `btlang.robots.robot.Robot`. The same commands and the same seed give the same run.

    `make_parts` makes its parts, which by default act in the world, of this and what stands there: its `obstacles`.
    Unless it `sees`, it drives as it is told, past its sensors: whoever commands it has the guard.
    """

    moves_by_itself = False

    def __init__(
        self,
        world: World,
        on_event: OnEvent | None = None,
        body: Body | None = None,
        make_parts: Callable[[World, Obstacles, Body], Parts] | None = None,
        obstacles: Obstacles | None = None,
        sees: bool = True,
    ) -> None:
        self.body = body = body or standard_body()
        self._has = cache(body.has)
        self.radius = body.radius
        self.normal_speed, self.max_speed = body.driving.speed, body.driving.top_speed
        self.normal_turn = body.turning.speed
        self.world = world
        self.on_event = on_event
        self.on_step: Callable[[float], object] | None = None
        """Called at the end of each step with its seconds."""
        self.time = 0.0
        self.stops = 0
        self._obstacles = obstacles or Obstacles(world)
        parts = (make_parts or simulated_parts)(world, self._obstacles, body)
        self._base, self.power, self._scan = parts.base, parts.power, parts.scan
        self._joints, self._hands, self._voice = parts.joints, parts.hands, parts.voice
        self._gestures = Gestures(body, self._joints)
        self.faults = Faults(world.faults)
        self._idling: Idling | None = None  # first: what is around it reports at once what it sees
        self._surroundings = Surroundings(world, self._obstacles, body, self._joints.angle, self._emit)
        if isinstance(self._joints, IdlePart) and body.idle != Idle():
            self._idling = Idling(body, self._joints, self._surroundings.where, lambda: self.pose)
        self._sensors, self._scanned = parts.sensors, 0.0
        self._guard = Guard(
            body, self._surroundings.zones, self._obstacles, sensors=self._readings if sees else list,
            odometry=self._odometry if sees else lambda: None, pose=lambda: self._base.pose, now=lambda: self.time,
        )  # fmt: skip
        self._navigator = Navigator(world, self._base, self._obstacles, self.faults, self._surroundings, self._guard)
        self._choices = Choices()
        self._latch = Latch()
        self._last_said = ""
        self._bumps_reported, self._stuck_reported = 0, False
        self._began = self._base.pose
        self._begin_faults()

    def step(self, dt: float) -> None:
        """Lets `dt` (> 0) seconds pass; the scan, the events and all sensors follow."""
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
        """Brakes hard, cancels the journey, freezes joints and hands, and ends speech. Safe from any thread."""
        self._latch.stop()
        self.stops += 1
        self._rest()
        self._emit("stop")

    def disable(self) -> None:
        """Stops, and takes no command until it is enabled. Safe from any thread."""
        self._latch.shut()
        self.stop()

    def enable(self) -> None:
        """Takes commands again."""
        if self._latch.refuses:
            self._rest()  # again, as in `step`
        self._latch.open()
        if self._idling is not None:
            self._idling.on = True

    @property
    def refuses(self) -> bool:
        """Whether it takes no command: it was stopped."""
        return self._latch.refuses

    def _rest(self) -> None:
        self._navigator.cancel("the robot was stopped")
        self._base.brake()
        if self._idling is not None:
            self._idling.halt()
        self._gestures.stop()
        self._joints.freeze()
        self._hands.stop()
        self._voice.silence()

    @property
    def time_of_day(self) -> float:
        """As the world says, when it began, and all steps since."""
        return (self.world.clock + self.time) % DAY

    @property
    def weekday(self) -> int:
        """As the world says, when it began, and all days since."""
        return weekday_after(self.world.weekday, self.world.clock + self.time)

    @property
    def moving(self) -> bool:
        """True while the base still rolls or a joint moves."""
        return self._base.rolling or self._joints.moving

    @property
    def standstill(self) -> Standstill:
        """Nothing else moves it."""
        return Standstill(None if self._base.silent is not None else self.moving)

    # Base
    @property
    def pose(self) -> Pose:
        """Where it is. Raises SensorSilent where that isn't known."""
        if (silent := self._base.silent) is not None:
            raise SensorSilent(silent)
        return self._base.pose

    @property
    def way(self) -> Sequence[Point]:
        """The points of the way that it follows, in metres from where it was planned; none where it follows none."""
        return self._navigator.way

    @property
    def base(self) -> BasePart:
        """Its wheels, of which those in a world know what is really around them."""
        return self._base

    @property
    def velocity(self) -> tuple[float, float]:
        """Metres and degrees a second. Raises SensorSilent."""
        if (silent := self._base.silent) is not None:
            raise SensorSilent(silent)
        return self._base.velocity

    @property
    def travelled(self) -> float:
        """Metres that it has driven."""
        return self._base.travelled

    @property
    def wheels(self) -> tuple[float, float]:
        """Metres that the left and the right wheel have rolled."""
        return self._base.wheels

    def drive(self, linear: float, angular: float) -> None:
        """Sets the wanted metres and degrees a second; ends a journey under way. Raises RobotError for no numbers."""
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
        """True from running into something until it has moved away."""
        return self._base.bumped

    @property
    def stuck(self) -> bool:
        """True when it has been commanded to move for a second and does not."""
        return self._base.stuck or self._guard.stuck

    @property
    def set_out_from(self) -> Pose:
        """Where it was when the run began."""
        return self._began

    @property
    def pace(self) -> float:
        """The share of the normal speed at which it goes its ways."""
        return self._navigator.pace

    @pace.setter
    def pace(self, share: float) -> None:
        self._navigator.pace = share

    def reset_localization(self) -> None:
        """Does nothing: it always knows its place."""

    def place_names(self) -> list[str]:
        """The names of all places, those of the mission among them."""
        return list(self.world.names.places)

    def navigate_to(self, name: str) -> NavigationGoal:
        """Sets out for a place, an object or a person. Raises RobotError for an unknown name."""
        known = self._surroundings.known(name)
        self._surroundings.check_free(known)
        return self._set_out(known)

    def navigate_to_pose(self, pose: Pose, name: str = "") -> NavigationGoal:
        """Sets out for a pose: to what it is for, by its name or its spot; see Surroundings.goal_at."""
        return self._set_out(name, pose) if name else self._set_out(*self._surroundings.goal_at(pose))

    def prepare_journeys(self) -> None:
        """Gets ready to set out, so that the first journey takes no longer than the others."""
        with suppress(RobotError):  # a world that is too large fails the journey, with its reason
            self._navigator.prepare()

    def _set_out(self, name: str, pose: Pose | None = None) -> NavigationGoal:
        self._need("navigation")
        goal = self._navigator.start(name, pose)
        if self._latch.refuses:
            goal.end("the robot was stopped")
        if self.power.empty:
            goal.end("the battery is empty")
        self._emit("navigate", name=name)
        return goal

    def drop_goal(self, reason: str) -> None:
        """A journey under way fails, as if the navigation had lost it."""
        self._navigator.cancel(reason)

    def scan(self) -> Array:
        """360 distances, computed when first read after a step. Raises RobotError when the scanner is silent."""
        self._need("scanner")
        if self.faults.scanner_silent:
            raise SensorSilent("the laser scanner is silent")
        return self._scan(self.pose)

    def locate(self, name: str) -> Point:
        """Where a place, object or person is. Raises RobotError for an unknown name, and for what it hasn't seen."""
        return self._surroundings.locate(name, self.pose)

    def choose(self, kind: str, how: str, parts: Mapping[str, str] = {}) -> str:
        """A name that is the "nearest", "random" and so on. Raises RobotError if there is none."""
        return self._surroundings.choose(
            kind, how, parts, lambda: self.pose, lambda: self.set_out_from, self._choices, self.on_event
        )

    def described(self, kind: str, parts: Mapping[str, str]) -> list[str]:
        """The objects or people with these parts that the robot knows, nearest first."""
        return self._surroundings.described(kind, parts, self.pose)

    def seed_choices(self, seed: int, made: int = 0) -> None:
        """A run begins. Its random choices follow from the seed; so many have been made."""
        self._choices.begin(seed, made)
        self._surroundings.begin(seed)
        self._voice.speak_in()
        self._began, self.pace = self._base.pose, 1.0

    def nearby_people(self, within: float) -> list[str]:
        """Names of the people within so many metres, nearest first."""
        return self._surroundings.nearby_people(within, self.pose)

    def sees(self, name: str) -> bool:
        """Whether an object or a person is in view. Raises RobotError for an unknown name."""
        return self._surroundings.sight.sees(self._surroundings.known(name), self.pose)

    def seen(self, kind: str) -> list[str]:
        """The objects or people in view, nearest first."""
        return self._surroundings.sight.seen(kind, self.pose)

    def take_picture(self) -> Operation:
        """Takes a picture; its event names what is in view. Raises RobotError where it has no camera."""
        self._need("perception")
        self._emit("picture", name=", ".join((*self.seen("person"), *self.seen("object"))))
        return CompletedOperation()

    @property
    def things(self) -> tuple[Whereabouts, ...]:
        """Where those are who walk, and what isn't known; for whoever watches."""
        return self._surroundings.whereabouts()

    @property
    def surroundings(self) -> Surroundings:
        """What is where around it, and who lives there."""
        return self._surroundings

    @property
    def zones(self) -> Zones:
        """Where it may not go, or only slowly."""
        return self._surroundings.zones

    @property
    def ears(self) -> Ears:
        """What it has heard. Raises RobotError where it has none."""
        self._need("ears")
        return self._surroundings.ears

    def hear(self, text: str, who: str = "") -> None:
        """It hears what somebody says, or types."""
        self._surroundings.hear(text, who)

    def invite(self) -> str:
        """A visitor comes; returns the name."""
        return self._surroundings.people.invite()

    def ask(self, question: str, person: str = "") -> None:
        """See `Listening.ask`: people of the world may answer."""
        question = question or self._last_said
        self.ears.asking = question or "..."
        self._emit("ask", text=question, who=person)
        self._surroundings.ask(question, person)

    def guide(self, person: str, follow: bool) -> None:
        """Somebody follows the robot from now on, or no longer. Raises RobotError for who isn't in view."""
        known = self._surroundings.known(person)
        if follow and not self._surroundings.sight.sees(known, self.pose):
            raise RobotError(f"I don't see {said(known)}")
        self._surroundings.people.follow(known, follow)
        if self._idling is not None and follow:
            self._idling.attend(known)

    def beside_door(self, name: str) -> list[Pose]:
        """Where it can stand to move a door, the nearer one first. Raises RobotError for an unknown door."""
        return self._surroundings.beside_door(name, self.pose)

    def move_door(self, name: str, is_open: bool) -> Operation:
        """Opens or closes a door within reach. Raises RobotError."""
        self._surroundings.move_door(name, is_open, self.pose)
        return CompletedOperation()

    def is_open(self, door: str) -> bool:
        """Whether a door is open. Raises RobotError for an unknown one."""
        return self._surroundings.is_open(door)

    def is_on(self, name: str) -> bool:
        """Whether an object is switched on. Raises RobotError for one that can't be switched."""
        return self._surroundings.is_on(name)

    def forget_map(self) -> None:
        """Forgets where it saw objects and people."""
        self._surroundings.sight.forget()

    def switch(self, name: str, on: bool | None) -> Operation:
        """Switches an object within reach on or off, with None to the other. Raises RobotError."""
        self._surroundings.switch(name, on, self.pose)
        return CompletedOperation()

    def call(self, text: str) -> None:
        """Calls people for help, by an event."""
        self._emit("call", text=text)

    @property
    def held_up(self) -> str:
        """Who is in its way, "" where nobody makes it wait."""
        return self._navigator.held_up

    def wait_for_way(self, seconds: float) -> None:
        """So long it waits for who is in its way, before it looks for another way."""
        self._navigator.patience = seconds

    def name_places(self, places: Iterable[Place]) -> None:
        """The places of a mission beside those of the world, in place of those of the mission before."""
        self._surroundings.name_places(places)
        self.world = self._surroundings.world
        self._navigator.name_places(self.world.places)

    def move_thing(self, name: str, x: float, y: float) -> None:
        """Puts an object or a person somewhere else, as somebody in the world would. Raises RobotError."""
        self._surroundings.move(name, x, y)

    def carry(self, pose: Pose) -> None:
        """Moves the base alone, as somebody who pushes it would; everything else goes on."""
        self._base.put(pose)

    def put(self, pose: Pose) -> None:
        """Puts the robot somewhere else, at rest, as somebody who carries it would."""
        self._rest()
        self._base.put(pose)
        self._guard.forget()

    # Power
    @property
    def battery(self) -> float:
        """Percent left."""
        return self.power.level

    @property
    def battery_empty(self) -> bool:
        """True when the wheels get no power any more."""
        return self.power.empty

    @property
    def docked(self) -> bool:
        """True while connected to the dock."""
        return self.power.docked

    @property
    def charging(self) -> bool:
        """True while docked and not full."""
        return self.power.charging

    @property
    def stations(self) -> list[Station]:
        """The docks, the nearest first. Raises RobotError if there is none."""
        self._need("docking")
        return stations(self.world, self.body, self.pose)

    def dock(self) -> CompletedOperation:
        """Connects to the charger at once. Raises RobotError where the robot does not stand at the dock."""
        self._need("docking")
        self.power.connect(self.pose, self.faults.fails_to_dock)
        self._emit("dock")
        return CompletedOperation()

    def undock(self) -> CompletedOperation:
        """Disconnects at once; moves nothing."""
        if self.power.docked:
            self.power.docked = False
            self._emit("undock")
        return CompletedOperation()

    # Arms, hands, head
    def joint(self, name: str) -> float:
        """Degrees. Raises RobotError for an unknown name."""
        return self._joints.angle(name)

    def move_joints(self, targets: Mapping[str, float]) -> None:
        """Sets off joints towards angles, clipped to their limits. Raises RobotError for an unknown name."""
        if not self._latch.refuses:
            self._joints.move(targets)
            self._emit("joint", targets=dict(targets))

    def joints_at_target(self, *names: str) -> bool:
        """True when none of them is on its way."""
        return self._joints.at_target(names)

    def freeze_joints(self, *names: str) -> None:
        """These joints stay where they are now."""
        self._joints.freeze(names)

    def gesture(self, name: str, *, aim: Point | None = None, stroke_at: float | None = None) -> Operation:
        """See btlang.robots.capabilities.Gesturing. Raises RobotError."""
        if self._latch.refuses:
            raise RobotError("the robot was stopped")
        room = None if stroke_at is None else stroke_at - self.time
        started, slower = self._gestures.start(name, lambda: self.pose, aim, room)
        self._emit("gesture", name=name, slower=round(slower, 2))
        return started

    def lead(self, name: str, aim: Point | None = None) -> float:
        """See btlang.robots.capabilities.Gesturing. Raises RobotError."""
        return self._gestures.lead(name, lambda: self.pose, aim)

    def grasp(self, hand: Hand, name: str | None = None) -> Operation:
        """Closes a hand on the named or the nearest object. Raises RobotError."""
        if self._latch.refuses:
            raise RobotError("the robot was stopped")
        if name is not None:
            self._surroundings.check_movable(name)
        found = self._hands.grasp(hand, None if name is None else self._surroundings.known(name), self.pose, self.time)
        self._emit("grasp", hand=hand, name=found if isinstance(found, str) else name)
        return CompletedOperation() if isinstance(found, str) else found

    def release(self, hand: Hand) -> Operation:
        """Opens a hand and puts down what it held."""
        if self._latch.refuses:
            return CompletedOperation()
        found = self._hands.release(hand, self.pose)
        self._emit("release", hand=hand, name=found if isinstance(found, str) else None)
        return CompletedOperation() if isinstance(found, str | None) else found

    def hand_over(self, hand: Hand, person: str) -> Operation:
        """Gives what a hand holds to a person within reach. Raises RobotError."""
        name = self._hands.held.get(hand)
        if name is None:
            raise RobotError(f"the {hand} hand is empty")
        if self._latch.refuses:
            raise RobotError("the robot was stopped")
        self._surroundings.check_taker(name, person, self.pose)
        found = self._hands.hand_over(hand)
        self._surroundings.give(name, person)
        self._emit("give", hand=hand, name=name, who=self._surroundings.known(person))
        return CompletedOperation() if isinstance(found, str | None) else found

    def holding(self, hand: Hand) -> str | None:
        """The name of what the hand holds."""
        return self._hands.held.get(hand)

    def say(self, text: str, after: float = 0.0) -> None:
        """Starts to speak after so many seconds, for as long as the voice of the body takes. Raises RobotError."""
        self._need("voice")
        if not self._latch.refuses:
            self._voice.say(text, after)
            self._last_said = text
            self._emit("say", text=text)

    @property
    def language(self) -> str:
        """In which it speaks; "" where it has no voice."""
        return self._voice.language

    def speak_in(self, language: str) -> None:
        """What is said from now on is in this language, to the end of the run. Raises RobotError where it can't."""
        self._need("voice")
        if language != self._voice.language:
            self._voice.speak_in(language)
            self._emit("language", name=language)

    def utterance(self, text: str) -> Utterance:
        """What it would say. Raises RobotError."""
        self._need("voice")
        return self._voice.utterance(text)

    @property
    def said(self) -> Utterance | None:
        """What it says, or said last."""
        return self._voice.said

    @property
    def said_at(self) -> float:
        """The second of `time` at which that begins."""
        return self.time - self._voice.position

    @property
    def speaking(self) -> bool:
        """True while it speaks."""
        return self._voice.speaking

    def silence(self) -> None:
        """Ends speech at once."""
        self._voice.silence()

    def print(self, text: str) -> None:
        """Shows text at once."""
        self._need("screen")
        self._voice.print(text)
        self._emit("print", text=text)

    def _need(self, need: str) -> None:
        """Raises RobotError where the body lacks it."""
        if not self._has(need):
            raise RobotError(f"the robot has no {part_of(need)}")

    def _readings(self) -> list[ObstacleReading]:
        """Those of the sensors; a scanner that is silent says what it said last."""
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
        if self.on_event is not None:
            self.on_event(event, data)
