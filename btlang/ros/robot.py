"""A robot that speaks ROS 2, as actions see it; `btlang/ros/robot_interface.py` lists what it needs on the wire."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from math import inf
from typing import Any

import numpy as np
import numpy.typing as npt
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import Empty, Trigger

from btlang.robots.body import TOLERANCE, Body
from btlang.robots.body_file import standard_body
from btlang.robots.choices import Choices
from btlang.robots.ears import Ears
from btlang.robots.geometry import Point, Pose
from btlang.robots.gesturing import Gestures
from btlang.robots.latch import Latch
from btlang.robots.motion.guard.guard import Cause, Guard, Guarded, Verdict
from btlang.robots.robot import CompletedOperation, Hand, OnEvent, Operation, RobotError
from btlang.robots.station import Station
from btlang.robots.voice import Synthesizer
from btlang.robots.world import Place, World, said
from btlang.robots.zones import Zones
from btlang.ros.available import optional_interface
from btlang.ros.awake import AWAKE
from btlang.ros.base import RosBase
from btlang.ros.doors import RosDoors
from btlang.ros.ears import RosEars
from btlang.ros.executor_thread import ExecutorThread
from btlang.ros.hands import RosHands
from btlang.ros.joints import ros_joints
from btlang.ros.perception import RosPerception
from btlang.ros.places import Places
from btlang.ros.power import RosPower, make_docking_clients
from btlang.ros.pursuit import Pursuit
from btlang.ros.robot_interface import VELOCITY
from btlang.ros.sensors import RosSensors
from btlang.ros.services import Services
from btlang.ros.speech import RosSpeech
from btlang.ros.subscription_cache import SubscriptionCache
from btlang.ros.zones import RosZones
from btlang.run.outcome import Standstill
from btlang.run.robot_state import Whereabouts
from btlang.text.time_of_day import DAY, local, weekday_after

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.ros.navigation_goal import RosNavigation
    from btlang.ros.server_goal import ServerGoal, ServerGoals
    from btlang.speech.engine import Utterance

CALL, FOLLOW = "call", "follow"
_STOP = "stop"
_LOCALIZE = "reinitialize_global_localization"
_COSTMAPS = ("global_costmap/clear_entirely_global_costmap", "local_costmap/clear_entirely_local_costmap")
_OPTIONAL = {
    FOLLOW: "btlang_interfaces/srv/Follow",
    **dict.fromkeys(_COSTMAPS, "nav2_msgs/srv/ClearEntireCostmap"),
}
_STOPPED = "the robot was stopped"
_STOPPING = 5.0  # seconds for which a robot that was stopped gets zero velocity
_ANSWERED = 1.0  # seconds that its own stop gets to answer before a mission begins
_HEARTBEAT = 3.5  # seconds in which DDS learns for sure what has arrived
_LAST_WORDS = 2.0  # seconds that servers get to answer at the end


class RosRobot(Guarded):
    """Implements `btlang.robots.robot.Robot`; the pose is on the map of the world file.

    A sensor that is silent is a RobotError for who asks for it, never a wait. The node has to be spun in a thread of
    its own; its namespace is that of the robot. Sensors get old by the seconds of `now`.
    """

    moves_by_itself = True

    def __init__(
        self,
        node: Node,
        world: World,
        on_event: OnEvent | None = None,
        now: Callable[[], float] = AWAKE.now,
        body: Body | None = None,
    ) -> None:
        self.body = body = body or standard_body()
        self.radius = body.radius
        self.normal_speed, self.max_speed = body.driving.speed, body.driving.top_speed
        self.normal_turn = body.turning.speed
        self.on_event = on_event
        self.on_step: Callable[[float], object] | None = None
        self.stops = 0
        self.time = 0.0
        self.subscriptions = subscriptions = SubscriptionCache(node, now)
        self._node, self._now = node, now
        self._world_began = world.clock
        self._naps = AWAKE.naps
        self._executor = ExecutorThread(node)
        self._places = Places(world, body, lambda name: self._emit("see", name=name))
        self._choices = Choices()
        self._latch = Latch()
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
        make_docking = partial(make_docking_clients, node, self._executor, self._base.where, now)
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
        self._last_said = ""
        self._began: Pose | None = None
        self._pursuit: Pursuit | None = None
        self._navigation: RosNavigation | None = None
        self.pending: Callable[[], Iterable[str]] = tuple
        """Further reasons why it may be moved on, beside its journeys."""
        self._stops_for = 0.0
        self._driven = False  # by somebody else, since the latest step
        self._closed = False

    def prepare_navigation(self) -> None:
        """Makes the client of the navigation server, which finds it in a moment. Needs nav2_msgs."""
        if self._navigation is None:
            from btlang.ros.navigation_goal import RosNavigation

            tolerance = self.body.navigation.tolerance if self.body.navigation is not None else TOLERANCE
            self._navigation = RosNavigation(
                self._node, self._executor, self._base.where, self._now, lambda: self._base.is_localized, tolerance
            )

    @property
    def _servers(self) -> list[ServerGoals]:
        return [each for each in (self._navigation, self.power.docking) if each is not None]

    def step(self, dt: float) -> None:
        """`dt` seconds have passed: reads what has come, and publishes the wanted velocity again."""
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
            self._judge(*self._base.wanted)
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
    def refuses(self) -> bool:
        """Whether it takes no command: it was stopped."""
        return self._latch.refuses

    @property
    def time_of_day(self) -> float:
        """That of this computer, in its time zone; in simulated time that of the world, which began at 0."""
        seconds, is_simulated = self._moment()
        return (self._world_began + seconds) % DAY if is_simulated else local(seconds)

    @property
    def weekday(self) -> int:
        """As `time_of_day`: that of this computer, or that of the world."""
        seconds, is_simulated = self._moment()
        if not is_simulated:
            return time.localtime(seconds).tm_wday
        return weekday_after(self.world.weekday, self._world_began + seconds)

    def _moment(self) -> tuple[float, bool]:
        """Seconds since 1970, or since simulated time began; whether time is simulated."""
        clock = self._node.get_clock()
        return float(clock.now().nanoseconds * 1e-9), clock.ros_time_is_active

    def stop(self) -> None:
        """Zero velocity, no journey, frozen joints, silence, the robot's own stop. From any thread, without waiting."""
        self._stops_for = _STOPPING
        self._latch.stop()
        self.stops += 1
        if not self._closed:
            self._rest()
            self._services.fire(_STOP)
            self._emit("stop")

    def disable(self) -> None:
        """Stops, and takes no command until it is enabled; from any thread."""
        self._latch.shut()
        self.stop()

    def enable(self) -> None:
        """Takes commands again, once the robot's own stop has answered: one that comes later would end the first."""
        self._services.confirm(_ANSWERED)
        self._joints.step()  # `time` goes on from now
        self._voice.step(0.0)
        self._latch.open()

    def close(self) -> None:
        """The end: at rest, and waits a few seconds at most until all who have to know of it do."""
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
            servers.stop(_STOPPED)
        self._services.stop(_STOPPED)
        self._gestures.stop()
        self._joints.freeze()
        self._voice.silence()

    @property
    def moving(self) -> bool:
        """True while the base still rolls or a joint moves; False if nothing reports it."""
        try:
            return self._joints.moving or self._base.velocity != (0.0, 0.0)
        except RobotError:
            return False

    @property
    def standstill(self) -> Standstill:
        """By the odometry, and by what servers answered to the cancelling of their goals."""
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
        """Where it is on the map. Raises RobotError where the odometry is silent."""
        return self._base.pose

    @property
    def velocity(self) -> tuple[float, float]:
        """Metres and degrees a second, as the odometry measures. Raises RobotError where it is silent."""
        return self._base.velocity

    def velocity_type(self) -> str:
        """The type of message that those who listen to the velocity take."""
        return self._base.adapt()

    def drive(self, linear: float, angular: float) -> None:
        """Sets the wanted metres and degrees a second; ends a journey under way.

        Raises RobotError for no numbers, and before a zone to keep out of.
        """
        if self._latch.refuses:
            return
        for servers in self._servers:
            servers.stop("another command took over the drive")
        try:
            verdict = self._judge(*self._base.clipped(linear, angular))
        except RobotError:
            self._base.halt()
            raise
        if verdict.cause is Cause.ZONE and verdict.who and not verdict.linear:
            self._base.halt()
            raise RobotError(verdict.reason)
        self._base.drive(linear, angular)

    def _judge(self, linear: float, angular: float) -> Verdict:
        """The base drives no faster than the guard allows."""
        verdict = self._guard.judge(linear, angular)
        most = abs(verdict.linear) if verdict.linear != linear else inf
        self._base.limits = most, abs(verdict.angular) if verdict.angular != angular else inf
        return verdict

    def judge(self, topic: str, linear: float, angular: float) -> Verdict | None:
        """What of a velocity that somebody else sends the guard allows; None for a topic that isn't this robot's."""
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
        """True from a contact until it has moved away."""
        return self._senses.bumped

    @property
    def stuck(self) -> bool:
        """True when it has been commanded to move for a second and does not."""
        return self._base.stuck or self._guard.stuck

    def located(self, name: str) -> tuple[float, float, float | None]:
        """Where a name of the world is: metres, and the direction to face in radians, None for any. Raises KeyError."""
        return self._places.located(name)

    def navigate_to(self, name: str) -> Operation:
        """Sends NavigateToPose, again and again to who walks. Raises RobotError for an unknown name, for a goal in a
        closed zone, and where nobody knows where the robot or its goal is.
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
        """Sends NavigateToPose. Raises RobotError for a closed zone, and where nobody knows where the robot is."""
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
            operation.end(_STOPPED)  # `stop` came in between from another thread
        return operation

    @property
    def set_out_from(self) -> Pose:
        """Where it was when the run began. Raises RobotError where the odometry is silent."""
        return self._began or self.pose

    @property
    def pace(self) -> float:
        """The share of the normal speed at which it goes its ways; a topic limits the navigation server to it."""
        return self._zones.pace

    @pace.setter
    def pace(self, share: float) -> None:
        self._zones.pace = share

    def place_names(self) -> list[str]:
        """The names of all places, those of the mission among them."""
        return list(self.world.names.places)

    def reset_localization(self) -> None:
        """See `Base.reset_localization`: a service does it, where it is served."""
        self._services.fire(_LOCALIZE)

    # Senses
    def scan(self) -> npt.NDArray[np.float64]:
        """The nearest echo in each degree. Raises RobotError when the scanner is silent."""
        return self._senses.scan()

    @property
    def world(self) -> World:
        """What it knows of its surroundings."""
        return self._places.world

    def locate(self, name: str) -> Point:
        """Where it is by the world file, the mission and what was seen. Raises RobotError for what isn't known."""
        return self._places.locate(name, self.pose)

    def choose(self, kind: str, how: str, parts: Mapping[str, str] = {}) -> str:
        """A name of the world file or the mission, or of who was seen. Raises RobotError if there is none."""
        return self._places.choose(
            kind, how, parts, lambda: self.pose, lambda: self.set_out_from, self._choices, self.on_event
        )

    def described(self, kind: str, parts: Mapping[str, str]) -> list[str]:
        """The objects or people with these parts that the robot knows, nearest first."""
        return self._places.described(kind, parts, self.pose)

    def seed_choices(self, seed: int, made: int = 0) -> None:
        """A run begins. Its random choices follow from the seed; so many have been made."""
        self._choices.begin(seed, made)
        self._began = None
        self._zones.begin()
        self._ears.begin()
        self._voice.speak_in()

    def nearby_people(self, within: float) -> list[str]:
        """Names of people within so many metres, nearest first: those who walk as far as they are in view."""
        return self._places.nearby_people(within, self.pose)

    def name_places(self, places: Iterable[Place]) -> None:
        """The places of a mission beside those of the world, in place of those of the mission before."""
        self._places.name_places(places)

    # What is around it, and who
    def sees(self, name: str) -> bool:
        """Whether it is in view. Raises RobotError for an unknown name, and if nothing reports it."""
        return self._perception.sees(name, self.pose)

    def seen(self, kind: str) -> list[str]:
        """The objects or people in view, nearest first. Raises RobotError if nothing reports them."""
        return self._perception.seen(kind, self.pose)

    def take_picture(self) -> Operation:
        """An event names what is in view. Raises RobotError if nothing reports it."""
        self._emit("picture", name=", ".join((*self.seen("person"), *self.seen("object"))))
        return CompletedOperation()

    @property
    def things(self) -> tuple[Whereabouts, ...]:
        """Where those were seen who walk, and what isn't known; for whoever watches."""
        return self._places.whereabouts()

    def guide(self, person: str, follow: bool) -> None:
        """Somebody follows the robot from now on, or no longer.

        Raises RobotError for who isn't in view, and where nothing serves it.
        """
        known = self._places.known(person)
        if follow and not self.sees(known):
            raise RobotError(f"I don't see {said(known)}")
        if FOLLOW not in self._optional:
            raise RobotError(f"there is no service {self._node.resolve_service_name(FOLLOW)}")
        self._services.call(FOLLOW, lambda message: None, person=known, follow=follow)

    @property
    def zones(self) -> Zones:
        """Where it may not go, or only slowly."""
        return self._zones.zones

    held_up = ""
    """No topic reports who is in its way."""

    def wait_for_way(self, seconds: float) -> None:
        """Does nothing: the navigation server decides how long it waits for who is in its way."""

    def forget_map(self) -> None:
        """Forgets where it saw objects and people; the costmaps of Nav2 are cleared where there are some."""
        self._places.sight.forget()
        for name in _COSTMAPS:
            if name in self._optional:
                self._services.fire(name)

    def beside_door(self, name: str) -> list[Pose]:
        """Where it can stand to move a door, the nearer one first. Raises RobotError for an unknown door."""
        return self._places.beside_door(name, self.pose)

    def move_door(self, name: str, is_open: bool) -> Operation:
        """Opens or closes a door, or fails with the reason. Raises RobotError where nothing serves it."""
        self._check_stop()
        return self._doors.move_door(name, is_open)

    def is_open(self, door: str) -> bool:
        """Whether a door is open. Raises RobotError if nothing reports it."""
        return self._doors.is_open(door)

    def switch(self, name: str, on: bool | None) -> Operation:
        """Switches an object on or off, with None to the other. Raises RobotError where nothing serves it."""
        self._check_stop()
        return self._doors.switch(name, on)

    def is_on(self, name: str) -> bool:
        """Whether an object is switched on. Raises RobotError if nothing reports it."""
        return self._doors.is_on(name)

    def awaited(self, joints: bool = False) -> list[str]:
        """The topics on the state of things that somebody publishes, but that have reported nothing yet.

        With `joints` these too, if some have been reported and others haven't.
        """
        missing = self._joints.awaited() if joints else []
        return [*self._doors.awaited(), *self._perception.awaited(), *self._hands.awaited(), *missing]

    # Power
    @property
    def battery(self) -> float:
        """Percent left. Raises RobotError if nothing reports it."""
        return self.power.battery

    @property
    def battery_empty(self) -> bool:
        """Only where the robot says so."""
        return self.power.empty

    @property
    def docked(self) -> bool:
        """True while connected to the dock. Raises RobotError if nothing reports it."""
        return self.power.docked

    @property
    def charging(self) -> bool:
        """True while the battery is being charged. Raises RobotError if nothing reports it."""
        return self.power.charging

    @property
    def stations(self) -> list[Station] | None:
        """The docks, where the robot has a service; None where it has a docking server."""
        return None if self.power.docks_by_itself else self._places.stations(self.pose)

    def dock(self) -> Operation:
        """Connects to the charger, or fails with the robot's reason. Raises RobotError where nothing serves it."""
        self._check_stop()
        return self.power.dock(self._places.dock(self.pose))

    def undock(self) -> Operation:
        """Disconnects, or fails with the robot's reason. Raises RobotError where nothing serves it."""
        self._check_stop()
        return self.power.undock()

    # Arms, hands, head
    def joint(self, name: str) -> float:
        """Degrees. Raises RobotError for an unknown joint, and if nothing reports it."""
        return self._joints.angle(name)

    def move_joints(self, targets: Mapping[str, float]) -> None:
        """Sets off joints towards angles. Raises RobotError as `joint` does."""
        if not self._latch.refuses:
            self._joints.move(targets)
            if self._latch.refuses:
                self._joints.freeze()  # `stop` came in between from another thread
            self._emit("joint", targets=dict(targets))

    def joints_at_target(self, *names: str) -> bool:
        """True when none of them is on its way. Raises RobotError where one is stuck or silent."""
        return self._joints.at_target(names)

    def freeze_joints(self, *names: str) -> None:
        """These joints stay where they are now."""
        self._joints.freeze(names)

    def gesture(self, name: str, *, aim: Point | None = None, stroke_at: float | None = None) -> Operation:
        """See btlang.robots.capabilities.Gesturing. Raises RobotError."""
        self._check_stop()
        room = None if stroke_at is None else stroke_at - self.time
        started, slower = self._gestures.start(name, lambda: self.pose, aim, room)
        if self._latch.refuses:
            self._joints.freeze()  # `stop` came in between from another thread
        self._emit("gesture", name=name, slower=round(slower, 2))
        return started

    def lead(self, name: str, aim: Point | None = None) -> float:
        """See btlang.robots.capabilities.Gesturing. Raises RobotError."""
        return self._gestures.lead(name, lambda: self.pose, aim)

    def grasp(self, hand: Hand, name: str | None = None) -> Operation:
        """Closes a hand; where it closes on another object than the named one, it opens again and fails.

        Raises RobotError for an unknown name, and where nothing serves it.
        """
        self._check_stop()
        return self._hands.grasp(hand, name)

    def release(self, hand: Hand) -> Operation:
        """Opens a hand, or fails with the robot's reason. Raises RobotError where nothing serves it."""
        return CompletedOperation() if self._latch.refuses else self._hands.release(hand)

    def hand_over(self, hand: Hand, person: str) -> Operation:
        """Gives what a hand holds to a person, or fails with the reason. Raises RobotError where nothing serves it."""
        self._check_stop()
        return self._hands.hand_over(hand, person)

    def holding(self, hand: Hand) -> str | None:
        """The name of what the hand holds. Raises RobotError if nothing reports it."""
        return self._hands.holding(hand)

    # Ears and voice
    @property
    def ears(self) -> Ears:
        """What it has heard. Raises RobotError where it has none."""
        if self.body.ears is None:
            raise RobotError("the robot has no ears")
        return self._ears.ears

    def hear(self, text: str, who: str = "") -> None:
        """Somebody says it, or types it."""
        self._ears.hear(text, who, self.time)

    def ask(self, question: str, person: str = "") -> None:
        """See `Listening.ask`: a topic says which question is open."""
        self._ears.ask(question or self._last_said, person)

    def call(self, text: str) -> None:
        """Calls people for help, by an event and a topic."""
        self._calls.publish(String(data=text))
        self._emit("call", text=text)

    def say(self, text: str, after: float = 0.0) -> None:
        """Starts to speak after so many seconds. Raises RobotError where nobody listens."""
        if not self._latch.refuses:
            self._voice.say(text, after)
            self._last_said = text
            self._emit("say", text=text)

    @property
    def language(self) -> str:
        """In which it speaks."""
        return self._voice.language

    def speak_in(self, language: str) -> None:
        """What is said from now on is in this language, to the end of the run. Raises RobotError where it can't."""
        if language != self._voice.language:
            self._voice.speak_in(language)
            self._emit("language", name=language)

    def utterance(self, text: str) -> Utterance:
        """What it would say. Raises RobotError."""
        return self._voice.utterance(text)

    @property
    def said(self) -> Utterance | None:
        """What it says, or said last."""
        return self._voice.said

    @property
    def said_at(self) -> float:
        """The second of `time` at which that begins, as far as it's known yet."""
        return self.time - self._voice.position

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

    def _offer(self, name: str, kind: str) -> bool:
        """Makes the client of a service whose type may not be installed; whether it is."""
        found = optional_interface(kind)
        if found is not None:
            self._services.add(name, found)
        return found is not None

    def _check_stop(self) -> None:
        if self._latch.refuses:
            raise RobotError(_STOPPED)

    def _emit(self, event: str, **data: Any) -> None:
        if self.on_event is not None:
            self.on_event(event, data)
