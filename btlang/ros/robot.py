"""A robot that speaks ROS 2, as actions see it; `btlang/ros/wire.py` lists what it needs on the wire."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from math import inf, radians
from typing import Any

import numpy as np
import numpy.typing as npt
from rclpy.node import Node
from sensor_msgs.msg import BatteryState, LaserScan
from std_msgs.msg import Bool, String
from std_srvs.srv import SetBool, Trigger

from btlang.robots.geometry import Point, Pose
from btlang.robots.robot import Hand, Navigation, OnEvent, RobotError
from btlang.robots.world import ROBOT_RADIUS, Place, World, said
from btlang.ros.base import RosBase
from btlang.ros.inbox import Inbox
from btlang.ros.joints import RosJoints
from btlang.ros.places import Places
from btlang.ros.services import Services, wait_all
from btlang.ros.voice import RosVoice

TYPE_CHECKING = False
if TYPE_CHECKING:
    from threading import Event

    from btlang.ros.journey import RosNavigation

_SCAN, _BATTERY, _BUMP, _DOCKED = "/scan", "/battery_state", "/bump", "/docked"
_SCAN_SILENT, _BATTERY_SILENT = 2.0, 30.0  # seconds
_FREE_AGAIN = 0.03  # metres from where it bumped
_LAST_WORDS = 1.0  # seconds that servers get to answer at the end
_CHARGING = 1  # sensor_msgs/BatteryState.POWER_SUPPLY_STATUS_CHARGING
_HANDS: tuple[Hand, Hand] = ("left", "right")


class RosRobot:
    """Implements `btlang.robots.robot.Robot`; the pose is on the map of the world file.

    A sensor that is silent is a RobotError for who asks for it, never a wait. The hands and the dock are services,
    which the tick waits for, a few seconds at most. The node has to be spun in a thread of its own. Sensors get old
    by the seconds of `now`, and by those of the system's clock.
    """

    moves_by_itself = True
    radius = ROBOT_RADIUS
    normal_speed = 0.5
    max_speed = 1.0
    normal_turn = 90.0

    def __init__(
        self,
        node: Node,
        world: World,
        on_event: OnEvent | None = None,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self.on_event = on_event
        self.stops = 0
        self.bumps = 0
        self.inbox = inbox = Inbox(node, now)
        self._node = node
        self._places = Places(world)
        self._base = RosBase(node, inbox, self.radius)
        self._joints = RosJoints(node, inbox)
        self._voice = RosVoice(node, inbox)
        self._services = Services(node)
        self._navigation: RosNavigation | None = None
        self._asked: list[Event] = []
        self._stopping = self._closed = self._stuck_told = False
        self._contact: Pose | None = None
        self._holding: dict[Hand, str] = {}
        self._docked: bool | None = None
        inbox.listen(_SCAN, LaserScan, "laser scan")
        inbox.listen(_BATTERY, BatteryState, "battery state")
        inbox.listen(_BUMP, String, "bumps", qos="events")
        inbox.listen(_DOCKED, Bool, "word of the dock", qos="state")
        for hand in _HANDS:
            inbox.listen(_held(hand), String, f"word of the {hand} hand", qos="state")
            self._services.add(f"/{hand}_hand/close", SetBool)
        for name in ("/dock", "/undock", "/stop"):
            self._services.add(name, Trigger)

    def prepare_navigation(self) -> None:
        """Makes the client of the navigation server, which finds it in a moment. Needs nav2_msgs."""
        if self._navigation is None:
            from btlang.ros.journey import RosNavigation

            self._navigation = RosNavigation(self._node)

    def step(self, dt: float) -> None:
        """`dt` seconds have passed: reads what has come, and tells the wanted velocity again."""
        self.inbox.read()
        if self._stopping:
            self._rest()  # again: what was under way in this thread may have overwritten what `stop` did in another
            self._stopping = False
        self._base.step(dt)
        self._voice.step(dt)
        arrived = self._navigation.step() if self._navigation is not None else None
        for message in self.inbox.events(_DOCKED):
            self._docked = bool(message.data)
        self._hear_hands()
        self._tell_contacts()
        if arrived is not None and arrived.failure is None:
            self._emit("arrive", name=arrived.name)

    def stop(self) -> None:
        """Zero velocity, no journey, frozen joints, silence, and the robot's own stop where it has one.

        From any thread; waits for nothing.
        """
        self._stopping = True
        self.stops += 1
        if not self._closed:
            self._rest()
            self._asked.append(self._services.fire("/stop"))
            self._emit("stop")

    def close(self) -> None:
        """The end: at rest, and waits a second or two at most until all who have to know of it do."""
        if self._closed:
            return
        self._rest()
        self._base.confirm_halt()
        if self._navigation is not None:
            self._navigation.confirm_stop(_LAST_WORDS)
        wait_all(self._asked, _LAST_WORDS)
        self._closed = True

    def _rest(self) -> None:
        self._base.halt()
        if self._navigation is not None:
            self._navigation.stop("the robot was told to stop")
        self._joints.freeze()
        self._voice.silence()

    @property
    def moving(self) -> bool:
        """True while the base still rolls or a joint moves; False where nothing tells of it."""
        try:
            return self._joints.moving or self._base.velocity != (0.0, 0.0)
        except RobotError:
            return False

    # Base
    @property
    def pose(self) -> Pose:
        """Where it is on the map. Raises RobotError where the odometry is silent."""
        return self._base.pose

    @property
    def velocity(self) -> tuple[float, float]:
        """Metres and degrees a second, as the odometry measures. Raises RobotError where it is silent."""
        return self._base.velocity

    def drive(self, linear: float, angular: float) -> None:
        """Sets the wanted metres and degrees a second; ends a journey under way."""
        if self._stopping:
            return
        if self._navigation is not None:
            self._navigation.stop("the robot was told to drive elsewhere")
        self._base.drive(max(-self.max_speed, min(self.max_speed, linear)), angular)
        if self._stopping:
            self._base.halt()  # `stop` came in between from another thread

    @property
    def bumped(self) -> bool:
        """True from a contact until it has moved away."""
        return self._contact is not None

    @property
    def stuck(self) -> bool:
        """True when it has been told to move for a second and does not."""
        return self._base.stuck

    def navigate_to(self, name: str) -> Navigation:
        """Sends NavigateToPose. Raises RobotError for an unknown name, and where nobody knows where the robot is."""
        known = self._places.known(name)
        goal = self._places.goal(known, self.pose)
        self.prepare_navigation()
        assert self._navigation is not None
        if self._base.driving:
            self._base.halt()
        journey = self._navigation.start(known, goal)
        if self._stopping:
            journey.end("the robot was told to stop")
        self._emit("navigate", name=known)
        return journey

    # Senses
    def scan(self) -> npt.NDArray[np.float64]:
        """The nearest echo in each degree. Raises RobotError when the scanner is silent."""
        return _degrees(self.inbox.get(_SCAN, _SCAN_SILENT))

    def locate(self, name: str) -> Point:
        """Where it is by the world file and the mission. Raises RobotError for an unknown name."""
        return self._places.locate(name, self.pose)

    def nearby_people(self, within: float) -> list[str]:
        """Names of the people of the world file within so many metres, nearest first."""
        return self._places.nearby_people(within, self.pose)

    def add_place(self, place: Place) -> None:
        """Names one more place; one of the same name is replaced."""
        self._places.add(place)

    # Power
    @property
    def battery(self) -> float:
        """Percent left. Raises RobotError where nothing tells of it."""
        share = float(self.inbox.get(_BATTERY, _BATTERY_SILENT).percentage)
        if not 0.0 <= share <= 1.0:
            raise RobotError(f"{_BATTERY} tells no percentage")
        return 100.0 * share

    @property
    def battery_empty(self) -> bool:
        """Only where the robot says so."""
        try:
            return self.battery <= 0.0
        except RobotError:
            return False

    @property
    def docked(self) -> bool:
        """True while connected to the dock. Raises RobotError where nothing tells of it."""
        return self._docked if self._docked is not None else bool(self.inbox.get(_DOCKED).data)

    @property
    def charging(self) -> bool:
        """True while the battery is being charged. Raises RobotError where nothing tells of it."""
        return bool(self.inbox.get(_BATTERY, _BATTERY_SILENT).power_supply_status == _CHARGING)

    def dock(self) -> None:
        """Connects to the charger. Raises RobotError with the robot's reason."""
        self._services.call("/dock")
        self._docked = True  # before the topic tells so
        self._emit("dock")

    def undock(self) -> None:
        """Disconnects. Raises RobotError with the robot's reason."""
        self._services.call("/undock")
        self._docked = False
        self._emit("undock")

    # Arms, hands, head
    def joint(self, name: str) -> float:
        """Degrees. Raises RobotError for an unknown joint, and where nothing tells of it."""
        return self._joints.angle(name)

    def move_joints(self, targets: Mapping[str, float]) -> None:
        """Sets off joints towards angles. Raises RobotError as `joint` does."""
        if not self._stopping:
            self._joints.move(targets)
            self._emit("joint", targets=dict(targets))

    def joints_at_target(self, *names: str) -> bool:
        """True when none of them is on its way. Raises RobotError where one is stuck or silent."""
        return self._joints.at_target(names)

    def freeze_joints(self, *names: str) -> None:
        """These joints stay where they are now."""
        self._joints.freeze(names)

    def grasp(self, hand: Hand, name: str | None = None) -> str:
        """Closes a hand; where it closes on another object than the named one, it opens again. Raises RobotError."""
        if self._stopping:
            raise RobotError("the robot was told to stop")
        wanted = None if name is None else self._places.known(name)
        found = self._services.call(f"/{hand}_hand/close", data=True)
        if wanted is not None and found.lower() != wanted.lower():
            self._services.call(f"/{hand}_hand/close", data=False)
            raise RobotError(f"the {hand} hand closed on {said(found)} instead of {said(wanted)}")
        self._holds(hand, found)
        self._emit("grasp", hand=hand, name=found)
        return found

    def release(self, hand: Hand) -> str | None:
        """Opens a hand; the name of what it put down. Raises RobotError with the robot's reason."""
        if self._stopping:
            return None
        name = self._services.call(f"/{hand}_hand/close", data=False) or None
        self._holds(hand, "")
        self._emit("release", hand=hand, name=name)
        return name

    def holding(self, hand: Hand) -> str | None:
        """The name of what the hand holds. Raises RobotError where nothing tells of it."""
        if hand not in self._holding:
            self.inbox.get(_held(hand))
        return self._holding.get(hand) or None

    # Voice
    def say(self, text: str) -> None:
        """Starts to speak. Raises RobotError where nobody listens."""
        if not self._stopping:
            self._voice.say(text)
            self._emit("say", text=text)

    @property
    def speaking(self) -> bool:
        """True while it speaks. Raises RobotError where it does not come to an end."""
        return self._voice.speaking

    def silence(self) -> None:
        """Ends speech at once."""
        self._voice.silence()

    def print(self, text: str) -> None:
        """Shows text at once. Raises RobotError where nobody listens."""
        self._voice.print(text)
        self._emit("print", text=text)

    def _holds(self, hand: Hand, name: str) -> None:
        before = self._holding.get(hand, "")
        if name == before:
            return
        self._holding[hand] = name
        objects = self._places.world.names.objects
        here = self._where()
        if before in objects and here is not None:
            self._places.put_down(before, here)
        if name in objects:
            self._places.picked_up(name)

    def _hear_hands(self) -> None:
        for hand in _HANDS:
            for message in self.inbox.events(_held(hand)):
                before = self._holding.get(hand, "")
                self._holds(hand, message.data)
                if before and not message.data:
                    self._emit("drop", hand=hand, name=before)

    def _tell_contacts(self) -> None:
        for message in self.inbox.events(_BUMP):
            self.bumps += 1
            self._contact = self._where()
            self._emit("bump", into=message.data)
        now = self._where()
        if self._contact is not None and now is not None and self._contact.distance_to((now.x, now.y)) > _FREE_AGAIN:
            self._contact = None
        if self._base.stuck and not self._stuck_told:
            self._emit("stuck")
        self._stuck_told = self._base.stuck

    def _where(self) -> Pose | None:
        try:
            return self.pose
        except RobotError:
            return None

    def _emit(self, event: str, **data: Any) -> None:
        if self.on_event is not None:
            self.on_event(event, data)


def _held(hand: Hand) -> str:
    return f"/{hand}_hand/holding"


def _degrees(scan: Any) -> npt.NDArray[np.float64]:
    """360 distances, index = degrees left of the heading; inf where no beam came back."""
    ranges = np.asarray(scan.ranges, dtype=np.float64)
    angles = scan.angle_min + scan.angle_increment * np.arange(len(ranges))
    seen = np.isfinite(ranges) & (ranges >= scan.range_min) & (ranges <= scan.range_max)
    found = np.full(360, inf)
    np.minimum.at(found, np.rint(angles[seen] / radians(1.0)).astype(int) % 360, ranges[seen])
    return found
