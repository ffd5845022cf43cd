"""What robots can do, as small protocols: an action uses the ones it needs.

Metres, degrees (counter-clockwise positive), seconds, percent. The keyword entry of a word lists its needs, by the
names in btlang.vocabulary.capabilities.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal, Protocol

from btlang.robots.body import Body
from btlang.robots.ears import Ears
from btlang.robots.geometry import Point, Pose
from btlang.robots.station import Station
from btlang.robots.zones import Zones
from btlang.run.outcome import Standstill

TYPE_CHECKING = False
if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from btlang.speech.engine import Utterance

Hand = Literal["left", "right"]
OnEvent = Callable[[str, Mapping[str, Any]], None]


class Operation(Protocol):
    """Something that the robot has started and that may take time: navigation, closing a hand, docking."""

    @property
    def done(self) -> bool:
        """True when it has ended: accomplished, failed or cancelled."""

    @property
    def failure(self) -> str | None:
        """Why it failed; None while it is active and after a success."""

    def cancel(self) -> None:
        """Gives up: navigation brakes, and nobody waits for a hand any more. Does nothing when done."""


class CompletedOperation:
    """An operation that took no time."""

    done = True
    failure = None

    def cancel(self) -> None:
        """Does nothing."""


class Machine(Protocol):
    """What every robot is. Only `stop` and `disable` may be called from other threads.

    `on_event(kind, data)` is called for each event. Kinds: say, print, choose, navigate, arrive, bump, stuck, stop,
    grasp, release, drop, joint, dock, undock, battery, fault, hear, ask, see, come, leave, call, door, switch,
    give, picture, gesture.
    """

    on_event: OnEvent | None
    on_step: Callable[[float], object] | None
    """Called at the end of each step with its seconds."""

    @property
    def body(self) -> Body:
        """What its file says of it."""

    @property
    def moves_by_itself(self) -> bool:
        """True for a real robot; False if the world stands still between two steps."""

    @property
    def time(self) -> float:
        """Total seconds of all steps."""

    @property
    def time_of_day(self) -> float:
        """Seconds since midnight where the robot is."""

    @property
    def weekday(self) -> int:
        """The number of the weekday where the robot is: 0 is Monday."""

    def step(self, dt: float) -> None:
        """Lets `dt` seconds pass. On a real robot time passes by itself and this only reads the sensors."""

    def stop(self) -> None:
        """Brakes hard, cancels navigation, freezes joints, ends speech; from any thread.

        Commands before the next `step` are ignored, so that the current tick can't undo it. `stops` counts it, so that
        a running action knows afterwards.
        """

    def disable(self) -> None:
        """Emergency stop, from any thread: `stop`, and ignores all commands until `enable`."""

    def enable(self) -> None:
        """Accepts commands again. For a run that starts or continues: nothing else may undo an emergency stop."""

    @property
    def refuses(self) -> bool:
        """Whether it takes no command: it was stopped or disabled."""

    @property
    def stops(self) -> int:
        """How often `stop` was called."""

    @property
    def moving(self) -> bool:
        """True while the base still rolls or a joint moves."""

    @property
    def standstill(self) -> Standstill:
        """What is known about whether it stands still, and will keep still."""


class Base(Machine, Protocol):
    """Wheels, and where the robot is."""

    pace: float
    """The share of the normal speed at which it goes its ways; 1 unless a mission says how."""

    @property
    def radius(self) -> float:
        """Of the round footprint."""

    @property
    def normal_speed(self) -> float:
        """Metres per second if a mission doesn't give a speed."""

    @property
    def max_speed(self) -> float:
        """`drive` goes no faster."""

    @property
    def normal_turn(self) -> float:
        """Degrees per second for turning on the spot."""

    @property
    def pose(self) -> Pose:
        """Where it is."""

    @property
    def velocity(self) -> tuple[float, float]:
        """Measured metres and degrees per second of the base."""

    def drive(self, linear: float, angular: float) -> None:
        """Sets the target metres and degrees per second until the next call; ends active navigation."""

    @property
    def stuck(self) -> bool:
        """True when it should have been moving for a second but isn't."""

    @property
    def limited_by(self) -> str:
        """Why it drives slower than commanded, or stands, such as what a sensor sees ahead; "" where it doesn't."""

    @property
    def held_back(self) -> str:
        """Why it has stood for so long that a drive has failed; "" where it hasn't."""

    def touch(self) -> None:
        """It may touch what is ahead, slowly. Counts for a moment, as a velocity does."""

    def locate(self, name: str) -> Point:
        """Where a place, object or person is. Raises RobotError for an unknown name."""

    def choose(self, kind: str, how: str, parts: Mapping[str, str] = {}) -> str:
        """The "nearest" or a "random" name of the type "place", "object" (not carried) or "person".

        "seen" is the nearest in view, else the nearest known; there are "furthest", "leftmost", "rightmost" and numbers
        ("2" is the second one, "-1" the last), and for objects "largest" and "smallest".
        `parts` are what it is like, by "color", "kind" and so on. Raises RobotError if there is none.
        """

    def described(self, kind: str, parts: Mapping[str, str]) -> list[str]:
        """The names of the objects or people with these parts that the robot knows, nearest first."""

    def reset_localization(self) -> None:
        """Forgets its place on the map, where something can find it again from what the sensors see."""

    def seed_choices(self, seed: int, made: int = 0) -> None:
        """A run begins. Its random choices follow from the seed; so many have been made before, in another run."""

    def nearby_people(self, within: float) -> list[str]:
        """Names of the people within that many metres, nearest first."""


class Navigation(Base, Protocol):
    """Navigation to named places, objects and people."""

    @property
    def set_out_from(self) -> Pose:
        """Where it was when the run began."""

    def place_names(self) -> list[str]:
        """The names of all places, those of the mission among them."""

    @property
    def zones(self) -> Zones:
        """Where it may not go, or only slowly."""

    def navigate_to(self, name: str) -> Operation:
        """Starts to a place, an object (within arm's reach) or a person (within talking distance), and faces it.

        Raises RobotError for an unknown name. Any other problem is the operation's `failure`.
        """

    def navigate_to_pose(self, pose: Pose, name: str = "") -> Operation:
        """Starts to a point of the map, and faces as the pose does. Problems are the operation's `failure`.

        Events and reasons call it by the name of what it is for, if one is given.
        """


class Sensors(Machine, Protocol):
    """The scanner and the bumper."""

    def scan(self) -> npt.NDArray[np.float64]:
        """360 distances from the centre, index = degrees left of the heading, inf if nothing is in range.

        Raises SensorSilent when the scanner is silent.
        """

    @property
    def bumps(self) -> int:
        """How often the robot ran into something."""

    @property
    def bumped(self) -> bool:
        """True after running into something until it has moved away."""


class Joints(Machine, Protocol):
    """The joints of the body, by their names in its file."""

    def joint(self, name: str) -> float:
        """The joint's angle. Raises RobotError for an unknown name."""

    def move_joints(self, targets: Mapping[str, float]) -> None:
        """Starts moving joints to angles, clipped to the limits of the joint."""

    def joints_at_target(self, *names: str) -> bool:
        """True when these joints rest at their targets."""

    def freeze_joints(self, *names: str) -> None:
        """These joints stay where they are now."""


class Gesturing(Joints, Base, Protocol):
    """Gestures, played beside the ticks of the mission."""

    def gesture(self, name: str, *, aim: Point | None = None, stroke_at: float | None = None) -> Operation:
        """Starts one from wherever the body is. `aim` is a point of the map that it points at or is turned to.

        With `stroke_at`, a second of `time`, its stroke is then, or as soon after as the limits of the body let it.
        Cancelled, its joints come to rest within their limits. Raises RobotError for an unknown gesture, for an aim out
        of reach, and where the body would touch itself.
        """

    def lead(self, name: str, aim: Point | None = None) -> float:
        """Seconds that the gesture needs at least from now to its stroke. Raises RobotError as `gesture` does."""


class Hands(Machine, Protocol):
    """The hands, which take objects and put them down."""

    def grasp(self, hand: Hand, name: str | None = None) -> Operation:
        """Closes a hand on the named object, by default on the nearest one within reach.

        Raises RobotError, or fails, when nothing (or not that object) is within reach or the hand is full.
        """

    def release(self, hand: Hand) -> Operation:
        """Opens a hand and puts down the object in it."""

    def hand_over(self, hand: Hand, person: str) -> Operation:
        """Gives the object in a hand to a person. Raises RobotError, or fails, where that person is far or refuses."""

    def holding(self, hand: Hand) -> str | None:
        """The name of the object in the hand."""


class Perception(Base, Protocol):
    """Sensors that recognise people and objects."""

    def sees(self, name: str) -> bool:
        """Whether an object or a person is in view now. Raises RobotError for an unknown name."""

    def seen(self, kind: str) -> list[str]:
        """The names of the "object"s or "person"s in view, nearest first."""

    def take_picture(self) -> Operation:
        """Takes a picture of what is in view."""


class Listening(Machine, Protocol):
    """Ears."""

    @property
    def ears(self) -> Ears:
        """What was heard. Raises RobotError where the robot has no ears."""

    def hear(self, text: str, who: str = "") -> None:
        """Somebody says it, or types it; "" where nobody knows who."""

    def ask(self, question: str, person: str = "") -> None:
        """The robot has asked a person, or anybody: the question is open until `ears.asking` is cleared.

        "" asks nothing, but waits for an answer to what was said last.
        """


class Leading(Perception, Navigation, Protocol):
    """People follow it."""

    def guide(self, person: str, follow: bool) -> None:
        """Somebody follows the robot from now on, or no longer. Raises RobotError for who isn't in view."""


class Handling(Base, Protocol):
    """Doors, and what can be switched, within reach."""

    def beside_door(self, name: str) -> list[Pose]:
        """Where it can stand to move a door: before it and behind it, the nearer one first."""

    def move_door(self, name: str, is_open: bool) -> Operation:
        """Opens or closes a door. Raises RobotError, or fails, where it is out of reach or something is in it."""

    def is_open(self, door: str) -> bool:
        """Whether a door is open."""

    def switch(self, name: str, on: bool | None) -> Operation:
        """Switches an object on or off, with None to the other of both. Raises RobotError, or fails."""

    def is_on(self, name: str) -> bool:
        """Whether an object is switched on."""


class Cautious(Navigation, Protocol):
    """Others in the way, and what was seen."""

    @property
    def held_up(self) -> str:
        """Who is in its way; "" where nobody makes it wait."""

    def wait_for_way(self, seconds: float) -> None:
        """So long it waits for who is in its way, before it looks for another way."""

    def forget_map(self) -> None:
        """Forgets what it has seen on the way: obstacles, and where objects and people were."""


class Messenger(Machine, Protocol):
    """It can call people who aren't there."""

    def call(self, text: str) -> None:
        """An event, which whoever watches the robot gets."""


class Voice(Machine, Protocol):
    """Speech, and the screen."""

    def say(self, text: str, after: float = 0.0) -> None:
        """Starts to speak after so many seconds; `speaking` is False when it has finished. Raises RobotError."""

    @property
    def language(self) -> str:
        """In which it speaks, such as "en"; "" where it has no voice."""

    def speak_in(self, language: str) -> None:
        """What is said from now on is in this language, to the end of the run. Raises RobotError where it can't."""

    def utterance(self, text: str) -> Utterance:
        """What it would say, with the times of the words. Raises RobotError."""

    @property
    def said(self) -> Utterance | None:
        """What it says, or said last, with the times of its words; None where it hasn't said anything."""

    @property
    def said_at(self) -> float:
        """The second of `time` at which that begins, as far as it's known yet."""

    @property
    def speaking(self) -> bool:
        """True while it speaks."""

    def silence(self) -> None:
        """Ends speech at once."""

    def print(self, text: str) -> None:
        """Shows text at once."""


class Power(Machine, Protocol):
    """The battery."""

    @property
    def battery(self) -> float:
        """Percent left."""

    @property
    def battery_empty(self) -> bool:
        """True when the wheels get no power any more; False also if the robot doesn't report it."""

    @property
    def charging(self) -> bool:
        """True while docked and not full."""


class Docking(Machine, Protocol):
    """The charging station."""

    @property
    def docked(self) -> bool:
        """True while connected to the dock."""

    @property
    def stations(self) -> Sequence[Station] | None:
        """The docks that it may drive into, the best one first; None where `dock` and `undock` drive by themselves.
        Raises RobotError where there is no dock.
        """

    def dock(self) -> Operation:
        """Connects to the charger. Raises RobotError, or fails, if the robot isn't at the dock."""

    def undock(self) -> Operation:
        """Disconnects, without moving unless `stations` is None."""


class Conversing(Listening, Voice, Base, Protocol):
    """It can ask, and hear the answer."""


class Robot(Leading, Cautious, Handling, Messenger, Sensors, Joints, Hands, Conversing, Power, Docking, Protocol):
    """A robot that can do all of this. If its body lacks a part, using the part raises RobotError."""
