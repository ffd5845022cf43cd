"""The robot as actions see it: what robots can do, as small protocols, and why one cannot do something."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import isnan
from typing import Any, Literal, Protocol

from btlang.engine.leaves.leaf import ActionFailed, Unknown
from btlang.robots.bodies.body import Body, Joint
from btlang.robots.ears import Ears
from btlang.robots.geometry import Point, Pose
from btlang.robots.zones import Zones
from btlang.run.outcome import Standstill
from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from btlang.speech.engine import Utterance

Hand = Literal["left", "right"]
OnEvent = Callable[[str, Mapping[str, Any]], None]
__all__ = ["CompletedOperation", "Hand", "OnEvent", "Operation", "Robot", "RobotError", "SensorSilent"]


class Station(Record):
    """A dock by its name. A connected robot stands at its `spot`, and drives straight in from `staging`."""

    name: str
    spot: Pose
    staging: Pose


class Operation(Protocol):
    """Something that the robot has started and that may take time: navigation, closing a hand, docking."""

    @property
    def done(self) -> bool:
        """Whether it has ended: accomplished, failed or cancelled."""

    @property
    def failure(self) -> str | None:
        """Why it failed; None while it is active and after a success."""

    def cancel(self) -> None:
        """Cancel: navigation brakes, and nobody waits for a hand any more. Does nothing when done."""


class CompletedOperation:
    """An operation that took no time."""

    done = True
    failure = None

    def cancel(self) -> None:
        """Do nothing."""


class Machine(Protocol):
    """A robot, whatever it has. Only `stop` and `disable` may be called from other threads.

    `on_event(kind, data)` is called for each event. Kinds: say, print, choose, navigate, arrive, bump, stuck, stop,
    grasp, release, drop, joint, dock, undock, battery, fault, hear, ask, see, come, leave, call, door, switch, give,
    picture, gesture.
    """

    on_event: OnEvent | None
    on_step: Callable[[float], object] | None
    """Called at the end of each step with its seconds."""

    @property
    def body(self) -> Body:
        """The body, from the robot file."""

    @property
    def moves_by_itself(self) -> bool:
        """True for a real robot; False if the world stands still between two steps."""

    @property
    def time(self) -> float:
        """The total seconds of all steps."""

    @property
    def time_of_day(self) -> float:
        """Seconds since midnight where the robot is."""

    @property
    def weekday(self) -> int:
        """The number of the weekday where the robot is: 0 is Monday."""

    def step(self, dt: float) -> None:
        """Let `dt` seconds pass. On a real robot time passes by itself and this only reads the sensors."""

    def stop(self) -> None:
        """Brake hard, cancel navigation, freeze joints, end speech; from any thread.

        Commands before the next `step` are ignored, so that the current tick can't undo it. `stops` counts it, so that
        a running action knows afterwards.
        """

    def disable(self) -> None:
        """Stop in an emergency, from any thread: `stop`, and ignore all commands until `enable`."""

    def enable(self) -> None:
        """Accept commands again. For a run that starts or continues: nothing else may undo an emergency stop."""

    @property
    def refuses(self) -> bool:
        """Whether it takes no commands, because it was stopped or disabled."""

    @property
    def stops(self) -> int:
        """How often `stop` was called."""

    @property
    def moving(self) -> bool:
        """Whether the base still rolls or a joint moves."""

    @property
    def standstill(self) -> Standstill:
        """What is known about whether it stands still, and will keep still."""


class Base(Machine, Protocol):
    """Wheels, and where the robot is."""

    pace: float
    """The share of the normal speed for journeys; 1 unless a mission gives another."""

    @property
    def radius(self) -> float:
        """The radius of the round footprint, in metres."""

    @property
    def normal_speed(self) -> float:
        """Metres per second if a mission doesn't give a speed."""

    @property
    def max_speed(self) -> float:
        """The limit of `drive`, in metres per second."""

    @property
    def normal_turn(self) -> float:
        """Degrees per second for turning on the spot."""

    @property
    def pose(self) -> Pose:
        """The pose on the map."""

    @property
    def velocity(self) -> tuple[float, float]:
        """Measured metres and degrees per second of the base."""

    def drive(self, linear: float, angular: float) -> None:
        """Set the target metres and degrees per second until the next call; end active navigation."""

    @property
    def stuck(self) -> bool:
        """Whether it should have been moving for a second but isn't."""

    @property
    def limited_by(self) -> str:
        """Why it drives slower than commanded, or stands, such as what a sensor sees ahead; "" if it doesn't."""

    @property
    def held_back(self) -> str:
        """Why it has stood for so long that a drive has failed; "" if it hasn't."""

    def touch(self) -> None:
        """Allow the base to touch what is ahead, slowly. Counts for a moment, as a velocity does."""

    def locate(self, name: str) -> Point:
        """Return where a place, object or person is. Raises RobotError for an unknown name."""

    def choose(self, kind: str, how: str, parts: Mapping[str, str] = {}) -> str:
        """Return the "nearest" or a "random" name of the type "place", "object" (not carried) or "person".

        "seen" is the nearest in view, else the nearest known; there are "furthest", "leftmost", "rightmost" and numbers
        ("2" is the second one, "-1" the last), and for objects "largest" and "smallest". `parts` describe it, by
        "color", "kind" and so on. Raises RobotError if there is none.
        """

    def described(self, kind: str, parts: Mapping[str, str]) -> list[str]:
        """Return the names of the known objects or people with these parts, nearest first."""

    def reset_localization(self) -> None:
        """Forget the pose on the map, if the sensors can find it again."""

    def seed_choices(self, seed: int, made: int = 0) -> None:
        """Begin a run, whose random choices follow from the seed; `made` of them were made before, in another run."""

    def nearby_people(self, within: float) -> list[str]:
        """Return the names of the people within that many metres, nearest first."""


class Navigation(Base, Protocol):
    """Navigation to named places, objects and people."""

    @property
    def set_out_from(self) -> Pose:
        """The pose at the start of the run."""

    def place_names(self) -> list[str]:
        """Return the names of all places, including those of the mission."""

    @property
    def zones(self) -> Zones:
        """The zones of the world and the mission."""

    def navigate_to(self, name: str) -> Operation:
        """Go to a place, an object (within arm's reach) or a person (within talking distance), and face it.

        Raises RobotError for an unknown name. Any other problem is the operation's `failure`.
        """

    def navigate_to_pose(self, pose: Pose, name: str = "") -> Operation:
        """Go to a pose of the map. Problems are the operation's `failure`.

        Events and reasons use the name of the target, if one is given.
        """


class Sensors(Machine, Protocol):
    """The scanner and the bumper."""

    def scan(self) -> npt.NDArray[np.float64]:
        """Return 360 distances from the centre, index = degrees left of the heading, inf if nothing is in range.

        Raises SensorSilent if the scanner is silent.
        """

    @property
    def bumps(self) -> int:
        """How often the robot ran into something."""

    @property
    def bumped(self) -> bool:
        """Whether it ran into something and hasn't moved away yet."""


class Joints(Machine, Protocol):
    """The joints of the body, by their names in its file."""

    def joint(self, name: str) -> float:
        """Return the joint's angle. Raises RobotError for an unknown name."""

    def move_joints(self, targets: Mapping[str, float]) -> None:
        """Start moving joints to angles, clipped to the limits of the joint."""

    def joints_at_target(self, *names: str) -> bool:
        """Return whether these joints rest at their targets."""

    def freeze_joints(self, *names: str) -> None:
        """Hold these joints where they are."""


class Gesturing(Joints, Base, Protocol):
    """Gestures, played concurrently with the ticks of the mission."""

    def gesture(self, name: str, *, aim: Point | None = None, stroke_at: float | None = None) -> Operation:
        """Start a gesture from the current positions.

        `aim` is a point of the map that it points at or is turned to. With `stroke_at`, a second of `time`, its stroke
        is then, or as soon after that as the limits of the body allow. When it is cancelled, its joints come to rest
        within their limits. Raises RobotError for an unknown gesture, for an aim out of reach, and if the body would
        touch itself.
        """

    def lead(self, name: str, aim: Point | None = None) -> float:
        """Return the least seconds from now to the stroke of a gesture. Raises RobotError as `gesture` does."""


class Hands(Machine, Protocol):
    """The hands, which take objects and put them down."""

    def grasp(self, hand: Hand, name: str | None = None) -> Operation:
        """Close a hand on the named object, by default on the nearest one within reach.

        Raises RobotError, or fails, when nothing (or not that object) is within reach or the hand is full.
        """

    def release(self, hand: Hand) -> Operation:
        """Open a hand and put down the object in it."""

    def hand_over(self, hand: Hand, person: str) -> Operation:
        """Give the object in a hand to a person. Raises RobotError, or fails, if the person is
        too far away or refuses.
        """

    def holding(self, hand: Hand) -> str | None:
        """Return the name of the object in the hand."""


class Perception(Base, Protocol):
    """Sensors that recognise people and objects."""

    def sees(self, name: str) -> bool:
        """Return whether an object or a person is in view now. Raises RobotError for an unknown name."""

    def seen(self, kind: str) -> list[str]:
        """Return the names of the objects ("object") or people ("person") in view, nearest first."""

    def take_picture(self) -> Operation:
        """Take a picture of what is in view."""


class Listening(Machine, Protocol):
    """Ears."""

    @property
    def ears(self) -> Ears:
        """What was heard. Raises RobotError if the robot has no ears."""

    def hear(self, text: str, who: str = "") -> None:
        """Take a text that somebody says or types; "" if nobody knows who."""

    def ask(self, question: str, person: str = "") -> None:
        """Ask a person, or anybody: the question is open until `ears.asking` is cleared.

        "" asks nothing, but waits for an answer to what was said last.
        """


class Leading(Perception, Navigation, Protocol):
    """A robot that people can follow."""

    def guide(self, person: str, follow: bool) -> None:
        """Let somebody follow the robot from now on, or no longer. Raises RobotError if they aren't in view."""


class Handling(Base, Protocol):
    """Doors and switches within reach."""

    def beside_door(self, name: str) -> list[Pose]:
        """Return where it can stand to move a door: before it and behind it, the nearer one first."""

    def move_door(self, name: str, is_open: bool) -> Operation:
        """Open or close a door. Raises RobotError, or fails, if it is out of reach or something is in it."""

    def is_open(self, door: str) -> bool:
        """Return whether a door is open."""

    def switch(self, name: str, on: bool | None) -> Operation:
        """Switch an object on or off; None toggles it. Raises RobotError, or fails."""

    def is_on(self, name: str) -> bool:
        """Return whether an object is switched on."""


class Cautious(Navigation, Protocol):
    """People in the way, and what was seen."""

    @property
    def held_up(self) -> str:
        """The person in its way; "" if nobody makes it wait."""

    def wait_for_way(self, seconds: float) -> None:
        """Set the seconds to wait for somebody in its way before it looks for another way."""

    def forget_map(self) -> None:
        """Forget what it has seen on the way: obstacles, and where objects and people were."""


class Messenger(Machine, Protocol):
    """A way to call people who aren't there."""

    def call(self, text: str) -> None:
        """Report an event to whoever watches the robot."""


class Voice(Machine, Protocol):
    """Speech, and the screen."""

    def say(self, text: str, after: float = 0.0) -> None:
        """Start to speak after so many seconds; `speaking` is False when it has finished. Raises RobotError."""

    @property
    def language(self) -> str:
        """The language in which it speaks, such as "en"; "" without a voice."""

    def speak_in(self, language: str) -> None:
        """Speak in a language until the end of the run. Raises RobotError if it can't."""

    def utterance(self, text: str) -> Utterance:
        """Return the sound and the times of a text. Raises RobotError."""

    @property
    def said(self) -> Utterance | None:
        """The current or the last utterance; None if it hasn't said anything."""

    @property
    def said_at(self) -> float:
        """The second of `time` at which that utterance begins, as far as it's known."""

    @property
    def speaking(self) -> bool:
        """Whether it speaks."""

    def silence(self) -> None:
        """End speech at once."""

    def print(self, text: str) -> None:
        """Show a text at once."""


class Power(Machine, Protocol):
    """The battery."""

    @property
    def battery(self) -> float:
        """The percentage that is left."""

    @property
    def battery_empty(self) -> bool:
        """Whether the wheels have no power any more; False also if the robot doesn't report it."""

    @property
    def charging(self) -> bool:
        """Whether it is docked and not full."""


class Docking(Machine, Protocol):
    """The charging station."""

    @property
    def docked(self) -> bool:
        """Whether it is connected to the dock."""

    @property
    def stations(self) -> Sequence[Station] | None:
        """The docks that it may drive into, the best one first; None if `dock` and `undock` drive by themselves.

        Raises RobotError without a dock.
        """

    def dock(self) -> Operation:
        """Connect to the charger. Raises RobotError, or fails, if the robot isn't at the dock."""

    def undock(self) -> Operation:
        """Disconnect, without moving unless `stations` is None."""


class Conversing(Listening, Voice, Base, Protocol):
    """A robot that can ask, and hear the answer."""


class Robot(Leading, Cautious, Handling, Messenger, Sensors, Joints, Hands, Conversing, Power, Docking, Protocol):
    """A robot that can do all of this. If its body lacks a part, using the part raises RobotError."""


class RobotError(ActionFailed):
    """The reason why the robot can't do a command, in plain English: a leaf that doesn't catch it fails with it."""


class SensorSilent(RobotError, Unknown):
    """The error that something isn't known: a sensor reports nothing, or nothing that can be true."""


def joint_of(body: Body, name: str) -> Joint:
    """Return the joint of a name. Raises RobotError if the body has no such joint."""
    joint = body.joint(name)
    if joint is None:
        raise RobotError(f'the robot has no joint "{name}"')
    return joint


def clip_targets(body: Body, targets: Mapping[str, float]) -> dict[str, float]:
    """Return the targets within the limits of their joints. Raises RobotError for an unknown joint, and for NaN."""
    for name, target in targets.items():
        if isnan(target):
            raise RobotError(f'the joint "{name}" can\'t move to what is not a number')
    joints = {name: joint_of(body, name) for name in targets}
    return {name: min(joint.high, max(joint.low, targets[name])) for name, joint in joints.items()}
