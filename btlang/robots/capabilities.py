"""What robots can do, as small protocols: an action asks for those that it needs.

Metres, degrees (counter-clockwise positive), seconds, percent. What a word needs is in its keyword entry, by the names
of btlang.vocabulary.capabilities.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Literal, Protocol

from btlang.robots.body import Body
from btlang.robots.geometry import Point, Pose
from btlang.run.standstill import Standstill

TYPE_CHECKING = False
if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

Hand = Literal["left", "right"]
OnEvent = Callable[[str, Mapping[str, Any]], None]


class Operation(Protocol):
    """What the robot has set about and may take time: a journey, a hand that closes, docking."""

    @property
    def done(self) -> bool:
        """True when it has ended: accomplished, failed or cancelled."""

    @property
    def failure(self) -> str | None:
        """Why it was not accomplished; None while under way and where it was."""

    def cancel(self) -> None:
        """Gives up: a journey brakes, and nobody waits for a hand any more. Does nothing when done."""


class CompletedOperation:
    """A operation that took no time."""

    done = True
    failure = None

    def cancel(self) -> None:
        """Does nothing."""


class Machine(Protocol):
    """What every robot is. Only `stop` and `disable` may be called from other threads.

    `on_event(kind, data)` is told what happens. Kinds: say, print, navigate, arrive, bump, stuck, stop, grasp, release,
    drop, joint, dock, undock, battery, fault.
    """

    on_event: OnEvent | None

    @property
    def body(self) -> Body:
        """What its file says of it."""

    @property
    def moves_by_itself(self) -> bool:
        """True for a real robot; False where the world stands still between two steps."""

    @property
    def time(self) -> float:
        """Seconds that it was stepped."""

    def step(self, dt: float) -> None:
        """Lets `dt` seconds pass. On a real robot time passes by itself and this only reads the sensors."""

    def stop(self) -> None:
        """Brakes hard, cancels the journey, freezes joints, ends speech; from any thread.

        Commands given before the next `step` are ignored, so that a tick in flight cannot undo it; `stops` counts it,
        so that an action under way knows afterwards.
        """

    def disable(self) -> None:
        """Emergency stop, from any thread: `stop`, and ignores all commands until `enable`."""

    def enable(self) -> None:
        """Takes commands again. For a run that begins or goes on: nothing else may undo an emergency stop."""

    @property
    def stops(self) -> int:
        """How often `stop` was called."""

    @property
    def moving(self) -> bool:
        """True while the base still rolls or a joint moves."""

    @property
    def standstill(self) -> Standstill:
        """What is known of whether it stands still, and will."""


class Base(Machine, Protocol):
    """Wheels, and where the robot is."""

    @property
    def radius(self) -> float:
        """Of the round footprint."""

    @property
    def normal_speed(self) -> float:
        """Metres a second where a mission asks for no other speed."""

    @property
    def max_speed(self) -> float:
        """`drive` goes no faster."""

    @property
    def normal_turn(self) -> float:
        """Degrees a second for turning on the spot."""

    @property
    def pose(self) -> Pose:
        """Where it is."""

    @property
    def velocity(self) -> tuple[float, float]:
        """Metres and degrees a second that the base really moves."""

    def drive(self, linear: float, angular: float) -> None:
        """Sets the wanted metres and degrees a second until told otherwise; ends a journey under way."""

    @property
    def stuck(self) -> bool:
        """True when it has been told to move for a second and does not."""

    def locate(self, name: str) -> Point:
        """Where a place, object or person is. Raises RobotError for an unknown name."""

    def nearby_people(self, within: float) -> list[str]:
        """Names of the people within so many metres, nearest first."""


class Navigation(Base, Protocol):
    """Ways to what has a name."""

    def navigate_to(self, name: str) -> Operation:
        """Sets out for a place, for an object (within arm's reach) or a person (within talking distance), and faces it.

        Raises RobotError for an unknown name; all else that goes wrong is the operation's `failure`.
        """


class Sensors(Machine, Protocol):
    """The scanner and the bumper."""

    def scan(self) -> npt.NDArray[np.float64]:
        """360 distances from the centre, index = degrees left of the heading, inf where nothing is in range.

        Raises SensorSilent when the scanner is silent.
        """

    @property
    def bumps(self) -> int:
        """How often the robot ran into something."""

    @property
    def bumped(self) -> bool:
        """True from running into something until it has moved away."""


class Joints(Machine, Protocol):
    """The joints of the body, by their names in its file."""

    def joint(self, name: str) -> float:
        """The joint's angle. Raises RobotError for an unknown name."""

    def move_joints(self, targets: Mapping[str, float]) -> None:
        """Sets off joints towards angles, which are clipped to what the joint can do."""

    def joints_at_target(self, *names: str) -> bool:
        """True when these joints rest where they were told to go."""

    def freeze_joints(self, *names: str) -> None:
        """These joints stay where they are now."""


class Hands(Machine, Protocol):
    """What takes objects and puts them down."""

    def grasp(self, hand: Hand, name: str | None = None) -> Operation:
        """Closes a hand on the named object, else on the nearest within reach.

        Raises RobotError, or fails, when nothing (or not that object) is within reach or the hand is full.
        """

    def release(self, hand: Hand) -> Operation:
        """Opens a hand and puts down what it held."""

    def holding(self, hand: Hand) -> str | None:
        """The name of what the hand holds."""


class Voice(Machine, Protocol):
    """Speech, and the screen."""

    def say(self, text: str) -> None:
        """Starts to speak; `speaking` tells when it has finished."""

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
        """True when the wheels get no power any more; False too where the robot does not tell."""

    @property
    def charging(self) -> bool:
        """True while docked and not full."""


class Docking(Machine, Protocol):
    """The charging station."""

    @property
    def docked(self) -> bool:
        """True while connected to the dock."""

    def dock(self) -> Operation:
        """Connects to the charger. Raises RobotError, or fails, where the robot does not stand at the dock."""

    def undock(self) -> Operation:
        """Disconnects; moves nothing."""


class Robot(Navigation, Sensors, Joints, Hands, Voice, Power, Docking, Protocol):
    """A robot that can do all of this. One whose body lacks a part raises RobotError where it is asked for it."""
