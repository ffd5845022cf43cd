"""The simulated robot with all its topics, services and actions."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from importlib.util import find_spec
from typing import Any, Protocol, cast

from rclpy.qos import QoSProfile
from rosgraph_msgs.msg import Clock
from std_msgs.msg import String
from std_srvs.srv import Trigger

from btlang.robots.bodies import body as bodies
from btlang.robots.parts import JointsPart, Parts
from btlang.robots.simulation.parts import make_simulated_parts
from btlang.robots.simulation.robot import SimulatedRobot
from btlang.robots.worlds.world import World
from btlang.ros.available import optional_interface
from btlang.ros.messages import stamp
from btlang.ros.node import SpunNode
from btlang.ros.robot.sensors import SIGHTINGS_TYPE
from btlang.ros.simulator.base import BaseTopics, SensorTopics
from btlang.ros.simulator.body import BodyTopics
from btlang.ros.simulator.doors import DoorTopics
from btlang.ros.simulator.shared import COMMANDS, CallQueue, Moment

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.robots.motion.smooth_joints import SmoothJoints
    from btlang.ros.simulator.people import HearingTopics


class SimulatorPart(Protocol):
    """Some topics, services and actions of the robot."""

    def publish(self, now: Moment) -> None:
        """Publish the state after the step."""


class Simulator:
    """A node, `node`, with the simulated robot of a world. Use it with `with`.

    `work` and `step` are for one thread, in turn. With `gives_clock` the simulated time is published on /clock and
    stamps are of that time, otherwise of the system's. `show` gets what the robot says and prints, a line at a time.
    Without nav2_msgs there is no navigation, without btlang's interfaces no hearing or sight. What people do by chance
    follows from `seed`, by default that of the world.
    """

    def __init__(
        self,
        world: World,
        *,
        namespace: str,
        gives_clock: bool,
        show: Callable[[str], object],
        body: bodies.Body | None = None,
        seed: int | None = None,
    ) -> None:
        joints: list[JointsPart] = []

        def make_parts(*of: Any) -> Parts:
            made = make_simulated_parts(*of)
            joints.append(made.joints)
            return made

        quiet = body and body.replace(idle=bodies.Idle())  # over ROS, what moves isn't idle
        self.robot = SimulatedRobot(world, body=quiet, make_parts=make_parts, sees=False)
        if seed is not None:
            self.robot.seed_choices(seed)
        self._show = show
        self._calls = CallQueue()
        self._spun = SpunNode("btlang_sim", namespace=namespace)
        self.node = node = self._spun.node
        self._wheels = BaseTopics(node, self.robot, self._calls)
        self._player = None
        if self.robot.body.is_smooth:
            from btlang.ros.simulator.joint_player import JointPlayer  # brings ruckig

            self._player = JointPlayer(self.robot.body, cast("SmoothJoints", joints[0]), self._clocks)
        self._parts: list[SimulatorPart] = [
            self._wheels,
            SensorTopics(node, self.robot, self._calls),
            BodyTopics(node, self.robot, self._calls, self._player),
            DoorTopics(node, self.robot, self._calls),
        ]
        self._hearing: HearingTopics | None = None
        if can_meet_people():
            from btlang.ros.simulator.people import HearingTopics, SightTopics

            self._hearing = HearingTopics(node, self.robot, self._calls)
            self._parts += [self._hearing, SightTopics(node, self.robot, self._calls)]
        if can_navigate() and self.robot.body.has("navigation"):
            from btlang.ros.simulator.navigation import NavigationServer

            self._parts.append(NavigationServer(node, self.robot, self._calls, self._wheels))
            if self.robot.body.has("docking"):
                with suppress(ImportError):  # Nav2 has had docking since Jazzy
                    from btlang.ros.simulator.docking import DockingServer

                    self._parts.append(DockingServer(node, self.robot, self._calls, self._wheels))
        self._stepped = self._system_time()
        self._clock = node.create_publisher(Clock, "/clock", QoSProfile(depth=1)) if gives_clock else None
        node.create_service(Trigger, "stop", self._stop)
        node.create_subscription(String, "call", self._on_call, COMMANDS)
        self.robot.on_event = self._take_event

    def work(self, seconds: float) -> None:
        """Do what topics, services and actions ask for, for so many seconds of real time or until `wake`."""
        self._calls.work(seconds)

    def wake(self) -> None:
        """End `work`, from any thread and from handlers of signals."""
        self._calls.wake()

    def step(self, seconds: float) -> None:
        """Let simulated time pass and publish the state of the robot."""
        self._wheels.watch()
        if self._player is not None:
            self._player.watch()
        self.robot.step(seconds)
        self._stepped = self._system_time()
        now = self._now()
        if self._clock is not None:
            self._clock.publish(Clock(clock=now.stamp))
        for part in self._parts:
            part.publish(now)

    def __enter__(self) -> Simulator:
        self._spun.start()
        return self

    def __exit__(self, *problem: object) -> None:
        self._calls.close()  # first: who waits in the thread of the executor would keep it from ending
        self._spun.close()

    def _now(self) -> Moment:
        seconds = self.robot.time
        if self._clock is None:
            return Moment(seconds, self._spun.node.get_clock().now().to_msg())
        return Moment(seconds, stamp(seconds))

    def _system_time(self) -> float:
        return float(self.node.get_clock().now().nanoseconds) * 1e-9

    def _clocks(self) -> list[float]:
        """Return the seconds of all clocks that nodes may use, at the latest step."""
        return [self._stepped, *([self.robot.time] if self._clock is not None else [])]

    def _stop(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Stop at once, in the thread of the executor, without waiting for a step. Later requests count again."""
        self.robot.stop()
        self._calls.post(self.robot.enable)
        response.success = True
        return response

    def _take_event(self, kind: str, data: Mapping[str, Any]) -> None:
        if kind == "bump":
            self._wheels.bumped(data["into"])
        elif kind in ("say", "print"):
            self._show(f'{kind}s "{data["text"]}"')
        elif kind == "hear" and self._hearing is not None:
            self._hearing.heard(data["text"], data["who"])

    def _on_call(self, message: String) -> None:
        self._calls.post(lambda: self._show(f'calls "{message.data}"'))


def can_navigate() -> bool:
    """Return whether the interfaces of Nav2 are installed."""
    return find_spec("nav2_msgs") is not None


def can_meet_people() -> bool:
    """Return whether btlang's interfaces are compiled."""
    return optional_interface(SIGHTINGS_TYPE) is not None
