"""A robot that speaks ROS 2, as actions see it; `btlang/ros/robot/interface.py` lists what it needs on the wire."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from functools import partial
from math import inf

import numpy as np
import numpy.typing as npt
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import Empty, Trigger

from btlang.robots.assembled import STOPPED, AssembledRobot
from btlang.robots.bodies.body import TOLERANCE, Body
from btlang.robots.bodies.body_file import standard_body
from btlang.robots.ears import Ears
from btlang.robots.geometry import Pose
from btlang.robots.motion.gesturing import Gestures
from btlang.robots.motion.guard.guard import Cause, Guard, Verdict
from btlang.robots.robot import CompletedOperation, Hand, OnEvent, Operation, RobotError, Station
from btlang.robots.voice import Synthesizer
from btlang.robots.worlds.world import Place, World, said
from btlang.ros.available import optional_interface
from btlang.ros.clocks import AWAKE
from btlang.ros.node import ExecutorThread
from btlang.ros.robot.base import RosBase
from btlang.ros.robot.hands import RosHands
from btlang.ros.robot.interface import VELOCITY
from btlang.ros.robot.joints import RosJoints
from btlang.ros.robot.navigation import Pursuit, RosNavigation, ServerGoal, ServerGoals
from btlang.ros.robot.places import RosDoors, RosPlaces
from btlang.ros.robot.power import RosDocking, RosPower
from btlang.ros.robot.sensors import RosPerception, RosSensors
from btlang.ros.robot.services import Services
from btlang.ros.robot.speech import RosEars, RosSpeech
from btlang.ros.robot.zones import RosZones
from btlang.ros.subscriptions import SubscriptionCache
from btlang.run.outcome import Standstill
from btlang.text.time_of_day import DAY, local, weekday_after

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.ros.robot.smooth_joints import RosSmoothJoints


CALL, FOLLOW = "call", "follow"
_STOP = "stop"
_LOCALIZE = "reinitialize_global_localization"
_COSTMAPS = ("global_costmap/clear_entirely_global_costmap", "local_costmap/clear_entirely_local_costmap")
_OPTIONAL = {
    FOLLOW: "btlang_interfaces/srv/Follow",
    **dict.fromkeys(_COSTMAPS, "nav2_msgs/srv/ClearEntireCostmap"),
}
_STOPPING = 5.0  # seconds for which a robot that was stopped gets zero velocity
_ANSWERED = 1.0  # seconds that its own stop gets to answer before a mission begins
_HEARTBEAT = 3.5  # seconds in which DDS learns for sure what has arrived
_LAST_WORDS = 2.0  # seconds that servers get to answer at the end


class RosRobot(AssembledRobot):
    """A `btlang.robots.robot.Robot` over ROS 2, whose pose is on the map of the world file.

    A silent sensor is a RobotError for who asks for it, never a wait. Another thread has to spin the node, whose
    namespace is that of the robot. Readings age by the seconds of `now`.
    """

    moves_by_itself = True
    power: RosPower
    _joints: RosJoints | RosSmoothJoints
    _voice: RosSpeech

    def __init__(
        self,
        node: Node,
        world: World,
        on_event: OnEvent | None = None,
        now: Callable[[], float] = AWAKE.now,
        body: Body | None = None,
    ) -> None:
        body = body or standard_body()
        super().__init__(body, on_event)
        self.subscriptions = subscriptions = SubscriptionCache(node, now)
        self._node, self._now = node, now
        self._world_began = world.clock
        self._naps = AWAKE.naps
        self._executor = ExecutorThread(node)
        self._known = self._places = RosPlaces(world, body, lambda name: self._emit("see", name=name))
        self._base = RosBase(
            node, subscriptions, body.radius, (body.driving.top_speed, body.turning.top_speed), self._latch
        )
        self._joints = ros_joints(node, subscriptions, body)
        self._gestures = Gestures(body, self._joints)
        self._voice = RosSpeech(node, subscriptions, Synthesizer(body))
        self._services = Services(node, self._executor)
        self._services.add(_STOP, Trigger)
        self._services.add(_LOCALIZE, Empty)
        self._senses = RosSensors(subscriptions, self._base, self._emit, body)
        make_docking = partial(RosDocking, node, self._executor, self._base.where, now)
        self.power = RosPower(node, subscriptions, self._services, self._emit, make_docking)
        self._hands = RosHands(node, subscriptions, self._services, self._places, self._base.where, self._emit, body)
        self._ears = RosEars(node, subscriptions, self._emit)
        self._perception = RosPerception(node, subscriptions, self._places)
        self._zones = RosZones(node, subscriptions, self._places.zones, world.zones, self.normal_speed)
        self._guard = Guard(
            body, self._places.zones, self._places.obstacles, sensors=lambda: self._senses.readings(now()),
            odometry=self._base.reading, pose=self._base.where, now=now,
        )  # fmt: skip
        self._doors = RosDoors(node, subscriptions, self._services, self._places, world, self._emit)
        self._calls = node.create_publisher(String, CALL, 10)
        self._optional = [name for name, kind in _OPTIONAL.items() if self._offer(name, kind)]
        self._began: Pose | None = None
        self._pursuit: Pursuit | None = None
        self._navigation: RosNavigation | None = None
        self.pending: Callable[[], Iterable[str]] = tuple
        """Further reasons why somebody may still move it, besides its own goals."""
        self._stops_for = 0.0
        self._driven = False  # by somebody else, since the latest step
        self._closed = False

    def prepare_navigation(self) -> None:
        """Make the client of the navigation server, which finds it in a moment. Needs nav2_msgs."""
        if self._navigation is None:
            tolerance = self.body.navigation.tolerance if self.body.navigation is not None else TOLERANCE
            self._navigation = RosNavigation(
                self._node, self._executor, self._base.where, self._now, lambda: self._base.is_localized, tolerance
            )

    @property
    def _servers(self) -> list[ServerGoals]:
        return [each for each in (self._navigation, self.power.docking) if each is not None]

    def step(self, dt: float) -> None:
        """Read what has come, and publish the wanted velocity again; `dt` seconds have passed."""
        self.time += dt
        self.subscriptions.read()
        self._joints.step()
        if self._naps != AWAKE.naps:
            self._naps = AWAKE.naps
            self._emit("warning", text=f"this computer was asleep for {AWAKE.nap:.0f} s, or btlang was suspended")
        if self._latch.refuses and self._stops_for > 0.0:
            self._stops_for -= dt
            self._rest()  # again: something else may drive the robot on, such as a server that ignores a cancel
        self._latch.step()
        if not self._driven:
            self._judge(*self._base.commanded)
        self._driven = False
        self._base.step(dt)
        self._voice.step(dt)
        here = self._base.where()
        self._began = self._began or here
        self._perception.step(self.time, here)
        off_limits = self._zones.step(dt, here)
        if off_limits and self._navigation is not None:
            self._navigation.stop(off_limits)
        arrived = self._navigation.step() if self._navigation is not None else None
        if self._pursuit is not None:
            self._pursuit.step(self.time)
        self.power.step()
        self._hands.step()
        self._gestures.step(dt)
        self._doors.step()
        self._ears.step(self.time)
        self._services.step()  # last: answers are newer than what topics reported before
        self._senses.step()
        if arrived is not None and arrived.failure is None:
            self._emit("arrive", name=arrived.name)
        if self.on_step is not None:
            self.on_step(dt)

    @property
    def time_of_day(self) -> float:
        """The time of this computer in its time zone; in simulated time, that of the world, which began at 0."""
        seconds, is_simulated = self._moment()
        return (self._world_began + seconds) % DAY if is_simulated else local(seconds)

    @property
    def weekday(self) -> int:
        """The weekday of this computer, or in simulated time that of the world."""
        seconds, is_simulated = self._moment()
        if not is_simulated:
            return time.localtime(seconds).tm_wday
        return weekday_after(self.world.weekday, self._world_began + seconds)

    def _moment(self) -> tuple[float, bool]:
        """Return the seconds since 1970, or since simulated time began, and whether time is simulated."""
        clock = self._node.get_clock()
        return float(clock.now().nanoseconds * 1e-9), clock.ros_time_is_active

    def stop(self) -> None:
        """Stop the base, the goals, joints and speech, and call the robot's own stop. From any
        thread, without waiting.
        """
        self._stops_for = _STOPPING
        self._latch.stop()
        self.stops += 1
        if not self._closed:
            self._rest()
            self._services.fire(_STOP)
            self._emit("stop")

    def enable(self) -> None:
        """Take commands again, once the robot's own stop has answered: a later answer would end the first command."""
        self._services.confirm(_ANSWERED)
        self._joints.step()  # `time` goes on from now
        self._voice.step(0.0)
        self._latch.open()

    def close(self) -> None:
        """Bring the robot to rest, and wait a few seconds at most until everybody has heard of it."""
        if self._closed:
            return
        self._latch.shut()
        self._rest()
        self._ears.begin()
        self._zones.begin()
        self._voice.speak_in()
        self._base.confirm_halt()
        self._voice.confirm(_HEARTBEAT)
        until = time.monotonic() + _LAST_WORDS
        for servers in self._servers:
            servers.confirm_stop(until - time.monotonic())
        self._services.confirm(until - time.monotonic())
        self._closed = True

    def _rest(self) -> None:
        self._base.halt()
        for servers in self._servers:
            servers.stop(STOPPED)
        self._services.stop(STOPPED)
        self._gestures.stop()
        self._joints.freeze()
        self._voice.silence()

    @property
    def moving(self) -> bool:
        """Whether the base still rolls or a joint moves; False if nothing reports it."""
        try:
            return self._joints.moving or self._base.velocity != (0.0, 0.0)
        except RobotError:
            return False

    @property
    def standstill(self) -> Standstill:
        """Whether it stands, by the odometry and by the servers' answers to cancelled goals."""
        motion = self._base.motion
        pending = [*self.pending(), *(reason for servers in self._servers for reason in servers.pending())]
        early = any(servers.has_just_stopped for servers in self._servers)
        if motion is None:
            return Standstill(None, "", tuple(pending), early)
        linear, angular = motion
        speed = f"at {abs(linear):.2g} m/s" if linear else f"at {abs(angular):.0f} degrees a second" if angular else ""
        return Standstill(bool(speed) or self._joints.moving, speed, tuple(pending), early)

    # Base
    @property
    def pose(self) -> Pose:
        """The pose on the map. Raises RobotError if the odometry is silent."""
        return self._base.pose

    @property
    def velocity(self) -> tuple[float, float]:
        """The metres and degrees a second of the odometry. Raises RobotError if it is silent."""
        return self._base.velocity

    def velocity_type(self) -> str:
        """Return the type of velocity messages that listeners take."""
        return self._base.adapt()

    def drive(self, linear: float, angular: float) -> None:
        """Set the wanted metres and degrees a second, and withdraw the current goal.

        Raises RobotError for numbers that aren't finite, and before a zone to keep out of.
        """
        if self._latch.refuses:
            return
        for servers in self._servers:
            servers.stop("another command took over the drive")
        try:
            verdict = self._judge(*self._base.clip(linear, angular))
        except RobotError:
            self._base.halt()
            raise
        if verdict.cause is Cause.ZONE and verdict.who and not verdict.linear:
            self._base.halt()
            raise RobotError(verdict.reason)
        self._base.drive(linear, angular)

    def _judge(self, linear: float, angular: float) -> Verdict:
        """Limit the base to the velocity that the guard allows."""
        verdict = self._guard.judge(linear, angular)
        most = abs(verdict.linear) if verdict.linear != linear else inf
        self._base.limits = most, abs(verdict.angular) if verdict.angular != angular else inf
        return verdict

    def judge(self, topic: str, linear: float, angular: float) -> Verdict | None:
        """Return the guard's verdict on somebody else's velocity; None for a topic that isn't this robot's."""
        resolve = self._node.resolve_topic_name
        if resolve(topic) != resolve(VELOCITY):
            return None
        self._driven = True
        return self._guard.judge(linear, angular)

    @property
    def bumps(self) -> int:
        """How often it ran into something."""
        return self._senses.bumps

    @property
    def bumped(self) -> bool:
        """Whether it ran into something and hasn't moved away yet."""
        return self._senses.bumped

    @property
    def stuck(self) -> bool:
        """Whether it has been commanded to move for a second and doesn't."""
        return self._base.stuck or self._guard.stuck

    def located(self, name: str) -> tuple[float, float, float | None]:
        """Return where a name of the world is: metres, and the direction to face in radians, None for any. Raises
        KeyError.
        """
        return self._places.located(name)

    def navigate_to(self, name: str) -> Operation:
        """Send NavigateToPose, again and again for somebody who walks.

        Raises RobotError for an unknown name, for a goal in a closed zone, and if the pose of the robot or the goal is
        unknown.
        """
        known = self._places.known(name)
        set_out = partial(self._set_out, known, lambda: self._places.goal(known, self.pose))
        operation: Operation
        if self._places.is_watched(known):
            operation = self._pursuit = Pursuit(known, self._places.sight, set_out, self.time)
        else:
            operation = set_out()
        self._emit("navigate", name=known)
        return operation

    def navigate_to_pose(self, pose: Pose, name: str = "") -> Operation:
        """Send NavigateToPose. Raises RobotError for a closed zone, and if the robot's pose is unknown."""
        shown = name or f"({pose.x:.2f}, {pose.y:.2f})"
        operation = self._set_out(shown, lambda: pose)
        self._emit("navigate", name=shown)
        return operation

    def _set_out(self, known: str, goal_of: Callable[[], Pose]) -> ServerGoal:
        self._check_stop()  # a goal that is sent may be driven to, whatever becomes of its cancel
        goal = goal_of()
        self._zones.set_out(known, goal)
        self.prepare_navigation()
        assert self._navigation is not None
        if self._base.driving:
            self._base.halt()
        operation = self._navigation.start(known, goal)
        if self._latch.refuses:
            operation.end(STOPPED)  # `stop` came in between from another thread
        return operation

    @property
    def set_out_from(self) -> Pose:
        """The pose at the begin of the run. Raises RobotError if the odometry is silent."""
        return self._began or self.pose

    @property
    def pace(self) -> float:
        """The share of the normal speed for journeys; a topic limits the navigation server to it."""
        return self._zones.pace

    @pace.setter
    def pace(self, share: float) -> None:
        self._zones.pace = share

    def reset_localization(self) -> None:
        """Call the service that resets the localization, if there is one."""
        self._services.fire(_LOCALIZE)

    # Senses
    def scan(self) -> npt.NDArray[np.float64]:
        """Return the nearest echo in each degree. Raises RobotError if the scanner is silent."""
        return self._senses.scan()

    def seed_choices(self, seed: int, made: int = 0) -> None:
        """Begin a run, whose random choices follow from the seed; `made` of them have been made already."""
        self._choices.begin(seed, made)
        self._began = None
        self._zones.begin()
        self._ears.begin()
        self._voice.speak_in()

    def name_places(self, places: Iterable[Place]) -> None:
        """Set the places of a mission, in addition to those of the world."""
        self._places.name_places(places)

    # What is around it, and who
    def sees(self, name: str) -> bool:
        """Return whether a name is in view. Raises RobotError for an unknown name, and if nothing reports it."""
        return self._perception.sees(name, self.pose)

    def seen(self, kind: str) -> list[str]:
        """Return the objects or people in view, nearest first. Raises RobotError if nothing reports them."""
        return self._perception.seen(kind, self.pose)

    def guide(self, person: str, follow: bool) -> None:
        """Let somebody follow the robot from now on, or no longer.

        Raises RobotError if the person isn't in view, or there is no such service.
        """
        known = self._places.known(person)
        if follow and not self.sees(known):
            raise RobotError(f"I don't see {said(known)}")
        if FOLLOW not in self._optional:
            raise RobotError(f"there is no service {self._node.resolve_service_name(FOLLOW)}")
        self._services.call(FOLLOW, lambda message: None, person=known, follow=follow)

    held_up = ""
    """Always "": no topic reports who is in its way."""

    def wait_for_way(self, seconds: float) -> None:
        """Do nothing: the navigation server decides how long it waits for people in its way."""

    def forget_map(self) -> None:
        """Forget where objects and people were seen, and clear the costmaps of Nav2, if there are any."""
        self._places.sight.forget()
        for name in _COSTMAPS:
            if name in self._optional:
                self._services.fire(name)

    def move_door(self, name: str, is_open: bool) -> Operation:
        """Open or close a door, or fail with the reason. Raises RobotError without a service for it."""
        self._check_stop()
        return self._doors.move_door(name, is_open)

    def is_open(self, door: str) -> bool:
        """Return whether a door is open. Raises RobotError if nothing reports it."""
        return self._doors.is_open(door)

    def switch(self, name: str, on: bool | None) -> Operation:
        """Switch an object on or off; None toggles it. Raises RobotError without a service for it."""
        self._check_stop()
        return self._doors.switch(name, on)

    def is_on(self, name: str) -> bool:
        """Return whether an object is switched on. Raises RobotError if nothing reports it."""
        return self._doors.is_on(name)

    def find_unreported(self, joints: bool = False) -> list[str]:
        """Return the topics of states that somebody publishes, but that have reported nothing yet.

        With `joints` also the joints that are missing, if some have been reported.
        """
        missing = self._joints.find_unreported() if joints else []
        return [
            *self._doors.find_unreported(),
            *self._perception.find_unreported(),
            *self._hands.find_unreported(),
            *missing,
        ]

    # Power

    @property
    def stations(self) -> list[Station] | None:
        """The docks, if the robot has a service for docking; None if it has a docking server."""
        return None if self.power.docks_by_itself else self._places.stations(self.pose)

    def dock(self) -> Operation:
        """Connect to the charger, or fail with the robot's reason. Raises RobotError without a server for it."""
        self._check_stop()
        return self.power.dock(self._places.dock(self.pose))

    def undock(self) -> Operation:
        """Disconnect, or fail with the robot's reason. Raises RobotError without a server for it."""
        self._check_stop()
        return self.power.undock()

    # Arms, hands, head

    def grasp(self, hand: Hand, name: str | None = None) -> Operation:
        """Close a hand; if it closes on another object than the named one, open it again and fail.

        Raises RobotError for an unknown name, and without a service for it.
        """
        self._check_stop()
        return self._hands.grasp(hand, name)

    def release(self, hand: Hand) -> Operation:
        """Open a hand, or fail with the robot's reason. Raises RobotError without a service for it."""
        return CompletedOperation() if self._latch.refuses else self._hands.release(hand)

    def hand_over(self, hand: Hand, person: str) -> Operation:
        """Give what a hand holds to a person, or fail with the reason. Raises RobotError without a service for it."""
        self._check_stop()
        return self._hands.hand_over(hand, person)

    def holding(self, hand: Hand) -> str | None:
        """Return the name of what the hand holds. Raises RobotError if nothing reports it."""
        return self._hands.holding(hand)

    # Ears and voice
    @property
    def ears(self) -> Ears:
        """What it has heard. Raises RobotError if it has no ears."""
        if self.body.ears is None:
            raise RobotError("the robot has no ears")
        return self._ears.ears

    def hear(self, text: str, who: str = "") -> None:
        """Take a text that somebody says or types."""
        self._ears.hear(text, who, self.time)

    def ask(self, question: str, person: str = "") -> None:
        """Implement Listening. A topic publishes the open question."""
        self._ears.ask(question or self._last_said, person)

    def call(self, text: str) -> None:
        """Call people for help, by an event and a topic."""
        self._calls.publish(String(data=text))
        super().call(text)

    def _offer(self, name: str, kind: str) -> bool:
        """Make the client of a service whose type may not be installed; return whether it is."""
        found = optional_interface(kind)
        if found is not None:
            self._services.add(name, found)
        return found is not None


def ros_joints(node: Node, subscriptions: SubscriptionCache, body: Body) -> RosJoints | RosSmoothJoints:
    """Return the joints of a body: smooth ones plan their movements."""
    if not body.is_smooth:
        return RosJoints(node, subscriptions, body)
    from btlang.ros.robot.smooth_joints import RosSmoothJoints  # brings ruckig

    return RosSmoothJoints(node, subscriptions, body)
