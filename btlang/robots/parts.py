"""What a robot is made of: parts that act in a simulated world, or through devices."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Protocol

from btlang.record import Record
from btlang.robots.body import Body
from btlang.robots.capabilities import Hand, Operation
from btlang.robots.geometry import Pose

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.robots.scan import Array


class BasePart(Protocol):
    """The wheels, and where they have brought the robot; see btlang.robots.base.Base."""

    pose: Pose
    body: Body
    velocity: tuple[float, float]
    travelled: float
    wheels: tuple[float, float]
    bumps: int
    bumped_into: str
    grips: tuple[float, float]

    @property
    def bumped(self) -> bool: ...
    @property
    def stuck(self) -> bool: ...
    @property
    def rolling(self) -> bool: ...
    def drive(self, linear: float, angular: float) -> None: ...
    def brake(self) -> None: ...
    def put(self, pose: Pose) -> None: ...
    def step(self, dt: float) -> None: ...


class PowerPart(Protocol):
    """The battery and the dock; see btlang.robots.power.Power."""

    docked: bool

    @property
    def level(self) -> float: ...
    @property
    def empty(self) -> bool: ...
    @property
    def charging(self) -> bool: ...
    def set_level(self, percent: float) -> None: ...
    def connect(self, pose: Pose) -> None: ...
    def step(self, dt: float, metres: float, pose: Pose) -> bool: ...


class JointsPart(Protocol):
    """The joints; see btlang.robots.joints.Joints."""

    @property
    def moving(self) -> bool: ...
    def angle(self, name: str) -> float: ...
    def move(self, targets: Mapping[str, float]) -> None: ...
    def at_target(self, names: tuple[str, ...]) -> bool: ...
    def freeze(self, names: tuple[str, ...] | None = None) -> None: ...
    def step(self, dt: float) -> None: ...


class HandsPart(Protocol):
    """The hands; see btlang.robots.hands.Hands. What isn't done at once is an operation in place of a name."""

    @property
    def held(self) -> Mapping[Hand, str]: ...
    def grasp(self, hand: Hand, name: str | None, pose: Pose, now: float) -> str | Operation: ...
    def release(self, hand: Hand, pose: Pose) -> str | Operation | None: ...
    def held_for(self, hand: Hand, now: float) -> float: ...


class VoicePart(Protocol):
    """The voice and the screen; see btlang.robots.voice.Voice."""

    @property
    def speaking(self) -> bool: ...
    def say(self, text: str) -> None: ...
    def silence(self) -> None: ...
    def print(self, text: str) -> None: ...
    def step(self, dt: float) -> None: ...


class Parts(Record):
    """All parts of a robot. `scan` gives the distances from a pose, see btlang.robots.capabilities.Sensors."""

    base: BasePart
    power: PowerPart
    scan: Callable[[Pose], Array]
    joints: JointsPart
    hands: HandsPart
    voice: VoicePart
