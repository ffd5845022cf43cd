"""The parts of a robot over its devices: battery, joints, hands and voice."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import inf

from btlang.components.parts.base import DeviceBase
from btlang.components.parts.sensors import DeviceSensors, servo_angle
from btlang.devices.device_set import DeviceSet, Reads, reader
from btlang.devices.driver import DeviceError
from btlang.devices.kinds import Charge, Grip, GripTarget, JointTarget, Play, Shown
from btlang.robots.bodies.body import Body
from btlang.robots.geometry import Pose
from btlang.robots.motion.guard.tracking import JointProgress
from btlang.robots.parts import JointsPart, Parts
from btlang.robots.robot import Hand, RobotError, clip_targets, joint_of
from btlang.robots.simulation.parts import NO_CONTACT, SimulatedHands
from btlang.robots.voice import TimedVoice
from btlang.robots.worlds.obstacles import Obstacles
from btlang.robots.worlds.world import World, said

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.robots.robot import Operation

BUMPER = "bumper"
_FULL = 100.0  # percent
_GRIP_AFTER = 0.8  # seconds after which a hand that closes on nothing has failed


def device_parts(
    world: World,
    obstacles: Obstacles,
    body: Body,
    devices: DeviceSet,
    advance: Callable[[float], object],
    locate: Callable[[], Pose] | None = None,
) -> Parts:
    """Return the parts of a body over its devices: by kind; hands, joints and bumpers by name.

    A part without a device is silent. `advance` and `locate` are those of DeviceBase.
    """
    readers = devices.readers
    bumpers = tuple(name for name, device in devices.devices.items() if device.kind == "button" and BUMPER in name)
    base = DeviceBase(
        world.start, body, readers, wheels=devices.first("drive"), imu=devices.first("imu"), bumpers=bumpers,
        locate=locate, advance=advance,
    )  # fmt: skip
    lidar = devices.first("lidar")
    sensors = DeviceSensors(devices, bumpers, lidar, body.sensor("scanner"), body.radius)
    face = body.mouth.display if body.mouth is not None else ""
    displays = [name for name, device in devices.devices.items() if device.kind == "display" and name != face]
    joints = joints_over(body, readers)
    return Parts(
        base,
        DevicePower(devices.first("battery"), readers),
        lambda pose: sensors.scan(),
        joints,
        DeviceHands(body, readers, SimulatedHands(obstacles, world.names.objects, body)),
        DeviceVoice(body, readers, devices.first("speaker"), displays, joints),
        sensors.readings,
    )


class DevicePower:
    """A battery, as a PowerPart."""

    def __init__(self, name: str, devices: Mapping[str, Reads]) -> None:
        self._name, self._devices = name, devices
        self.docked = False

    @property
    def level(self) -> float:
        """The percentage. Raises DeviceSilent."""
        return self._charge().percent

    @property
    def empty(self) -> bool:
        """Whether the battery is at 0 percent; False also if it is silent."""
        try:
            return self._charge().percent <= 0.0
        except DeviceError:
            return False

    @property
    def charging(self) -> bool:
        """Whether the battery reports that it is charged. Raises DeviceSilent."""
        return bool(self._charge().charging)

    def set_level(self, percent: float) -> None:
        """Raise RobotError: nobody can set the level of a real battery."""
        raise RobotError("the battery of this robot can't be set")

    def connect(self, pose: Pose, fails: Callable[[str], bool]) -> None:
        """Raise RobotError if it doesn't charge, or `fails`."""
        if fails("dock"):
            raise RobotError(NO_CONTACT)
        if not (self.charging or self.level >= _FULL):
            raise RobotError("the battery doesn't charge")
        self.docked = True

    def step(self, dt: float, metres: float, pose: Pose) -> bool:
        """Return whether it has just left its dock."""
        try:
            charge = self._charge()
        except DeviceError:
            return False
        connected = bool(charge.charging) or (self.docked and charge.percent >= _FULL)  # a full one doesn't charge
        left, self.docked = self.docked and not connected, connected
        return left

    def _charge(self) -> Charge:
        reading = reader(self._devices, self._name, "battery").read(self._name)
        assert isinstance(reading, Charge)
        return reading


def joints_over(body: Body, devices: Mapping[str, Reads]) -> JointsPart:
    """Return joints over servos, whose movements are planned if they are smooth."""
    if not body.is_smooth:
        return DeviceJoints(body, devices)
    from btlang.components.parts.servo_joints import ServoJoints  # brings numpy and ruckig

    return ServoJoints(body, devices)


class DeviceJoints:
    """Joints over servos of the same names, as a JointsPart. Each step commands them again."""

    def __init__(self, body: Body, devices: Mapping[str, Reads]) -> None:
        self._body, self._devices = body, devices
        self._targets: dict[str, float] = {}
        self._time = 0.0
        self._progress = JointProgress(body, lambda: self._time)

    @property
    def moving(self) -> bool:
        """Whether any joint is on its way, as far as that is known."""
        try:
            return any(abs(self._left(name)) > joint_of(self._body, name).close_enough for name in tuple(self._targets))
        except DeviceError:
            return False

    def angle(self, name: str) -> float:
        """Return the angle of a joint. Raises RobotError for an unknown one, and DeviceSilent."""
        return servo_angle(self._body, self._devices, name)

    def move(self, targets: Mapping[str, float]) -> None:
        """Move towards targets, clipped to the joints' limits. Raises RobotError."""
        wanted = clip_targets(self._body, targets)
        for name in wanted:
            self.angle(name)
        self._targets.update(wanted)
        self._progress.start(wanted)
        self.step(0.0)

    def at_target(self, names: tuple[str, ...]) -> bool:
        """Return whether none of these joints is on its way. Raises DeviceSilent, and RobotError if one is stuck."""
        return all(self._progress.has_arrived(name, self._left(name)) for name in names if name in self._targets)

    def freeze(self, names: tuple[str, ...] | None = None) -> None:
        """Hold these joints, or all for None, where they are."""
        for name in tuple(self._targets) if names is None else names:
            if self._targets.pop(name, None) is not None:
                self._devices[name].write(name, JointTarget())

    def step(self, dt: float) -> None:
        """Command the joints again; one that has arrived holds its position by itself."""
        self._time += dt
        for name, target in tuple(self._targets.items()):
            self._devices[name].write(name, JointTarget(target, joint_of(self._body, name).speed))

    def _left(self, name: str) -> float:
        return self._targets[name] - self.angle(name)


class GripOperation:
    """A hand that closes or opens, as an Operation. `report` gets whether something is in it."""

    def __init__(self, name: str, device: Reads, closes: bool, report: Callable[[bool], object]) -> None:
        self._name, self._device, self._closes, self._report = name, device, closes, report
        self.done = False
        self.failure: str | None = None
        self._passed = 0.0

    def cancel(self, failure: str | None = None) -> None:
        """Hold the hand as it is, at once. For any thread."""
        if not self.done:
            self._end(failure)
            self._device.write(self._name, GripTarget())

    def step(self, dt: float) -> None:
        """Check how far the hand is."""
        if self.done:
            return
        self._device.write(self._name, GripTarget(float(self._closes)))
        self._passed += dt
        try:
            reading = self._device.read(self._name)
        except DeviceError as problem:
            self._end(str(problem))
            return
        holds = isinstance(reading, Grip) and bool(reading.holds)
        if holds == self._closes or self._passed >= _GRIP_AFTER:
            self._report(holds)
            self._end("nothing is in the hand" if self._closes and not holds else None)

    def _end(self, failure: str | None) -> None:
        self.done, self.failure = True, failure


class DeviceHands:
    """Hands over the devices "left hand" and "right hand", as a HandsPart.

    A hand holds what was nearest to it, as far as the robot knows where things are.
    """

    def __init__(self, body: Body, devices: Mapping[str, Reads], known: SimulatedHands) -> None:
        self._body, self._devices, self._known = body, devices, known
        self.held: dict[Hand, str] = {}
        self._grippings: dict[Hand, GripOperation] = {}

    def grasp(self, hand: Hand, name: str | None, pose: Pose, now: float) -> Operation:
        """Begin to close a hand. Raises RobotError if it holds something."""
        if hand in self.held:
            raise RobotError(f"the {hand} hand already holds {said(self.held[hand])}")
        try:
            found = self._known.within_reach(hand, name, pose)
        except RobotError:  # it may be there all the same
            found = name or "something"
        return self._begin(hand, True, lambda holds: self.held.update({hand: found} if holds else {}))

    def release(self, hand: Hand, pose: Pose) -> Operation:
        """Begin to open a hand."""
        return self._begin(hand, False, lambda holds: None if holds else self.held.pop(hand, None))

    def hand_over(self, hand: Hand) -> Operation:
        """Begin to open a hand: somebody takes what is in it."""
        return self._begin(hand, False, lambda holds: None if holds else self.held.pop(hand, None))

    def drop(self, hand: Hand, pose: Pose) -> str | None:
        """Note that a hand has lost what was in it."""
        return self.held.pop(hand, None)

    def held_for(self, hand: Hand, now: float) -> float:
        """Return 0 while a hand holds something, inf if it reports that it doesn't any more."""
        return inf if self._is_empty(hand) else 0.0

    def _is_empty(self, hand: Hand) -> bool:
        name = f"{hand} hand"
        gripping = self._grippings.get(hand)
        if name not in self._devices or (gripping is not None and not gripping.done):
            return False
        try:
            reading = self._devices[name].read(name)
        except DeviceError:
            return False
        return isinstance(reading, Grip) and reading.holds is False

    def stop(self) -> None:
        """Hold all hands as they are."""
        for gripping in tuple(self._grippings.values()):
            gripping.cancel("the robot was stopped")

    def step(self, dt: float) -> None:
        """Move on by `dt` seconds."""
        for gripping in self._grippings.values():
            gripping.step(dt)

    def _begin(self, hand: Hand, closes: bool, report: Callable[[bool], object]) -> GripOperation:
        name = f"{hand} hand"
        if self._body.hand(hand) is None:
            raise RobotError(f"the robot has no {name}")
        gripping = self._grippings[hand] = GripOperation(name, reader(self._devices, name, name), closes, report)
        return gripping


class DeviceVoice(TimedVoice):
    """The simulated voice, with a speaker that plays it, and displays that show printed texts."""

    def __init__(
        self, body: Body, devices: Mapping[str, Reads], speaker: str, displays: Sequence[str], joints: JointsPart
    ) -> None:
        super().__init__(body, joints.move)
        self._devices, self._speaker, self._displays = devices, speaker, displays
        self._face = body.mouth.display if body.mouth is not None else ""
        self._playing: Play | None = None

    def silence(self) -> None:
        """End speech and silence the speaker at once; from any thread."""
        super().silence()
        self._play(None)

    def step(self, dt: float) -> None:
        """Command the speaker again, since its loop needs that."""
        super().step(dt)
        self._play_on()

    def _play_on(self) -> None:
        if not self.speaking:
            self._play(None)
        elif self.said is not None and self.said.samples and self.position >= 0.0:
            self._play(self._playing or Play(self.said.samples, self.said.rate))

    def _play(self, sound: Play | None) -> None:
        if self._speaker and (sound or self._playing):
            self._devices[self._speaker].write(self._speaker, sound or Play())
        self._playing = sound

    def show(self, shape: str) -> None:
        """Show the mouth on the display of the face."""
        if self._face:
            self._devices[self._face].write(self._face, Shown(shape))

    def print(self, text: str) -> None:
        """Show a text on all displays."""
        for name in self._displays:
            self._devices[name].write(name, Shown(text))
