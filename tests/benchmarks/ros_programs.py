"""The processes that tests/benchmarks/ros.py measures: a robot, a mission on it, and the same with rclpy alone.

    python -m tests.benchmarks.ros_programs robot|mission|bare|bare-server REPORT [SECONDS]

Each writes its figures to the file REPORT. Times are those of CLOCK_MONOTONIC, which all processes share.
"""

from __future__ import annotations

import json
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

from btlang_interfaces.action import RunMission
from geometry_msgs.msg import PoseWithCovarianceStamped, Twist
from nav2_msgs.action import NavigateToPose
from nav_msgs.msg import Odometry
from rclpy.action import ActionClient, ActionServer, CancelResponse
from rclpy.task import Future
from sensor_msgs.msg import BatteryState, JointState, LaserScan

import btlang
from btlang.ros.connectors import connect_ros
from btlang.ros.node import LATCHED, SpunNode

RATE = 100.0
TOPICS: dict[str, tuple[type, float]] = {
    "/odom": (Odometry, 50.0),
    "/joint_states": (JointState, 50.0),
    "/amcl_pose": (PoseWithCovarianceStamped, 10.0),
    "/scan": (LaserScan, 10.0),
    "/battery_state": (BatteryState, 2.0),
}
"""What the robot publishes, and how often a second."""
ACTIONS = ("/navigate_to_pose", "/inspect")
FEEDBACK = 5.0
SPEED = 0.3
APART = 0.1  # seconds that the robot drives and stands between two measured starts
WORDS = "".join(
    f'[[action]]\nphrase = "{word} {{place}}"\nid = "{word.title()}"\n'
    f'ros = {{ action = "nav2_msgs/action/NavigateToPose", name = "{name}", goal = {{ pose = "{{place}}" }} }}\n'
    for word, name in zip(("patrol", "inspect"), ACTIONS, strict=True)
)
STEADY = "in parallel:\n    keep the time\n    patrol the kitchen\n    inspect the kitchen\n    move forward 1000 m\n"
STARTS = f"repeat:\n    note the start\n    move forward 10 m for {APART} s\n    wait {APART} s\n"


class Robot:
    """Publishes TOPICS, serves ACTIONS, whose goals last until they are cancelled, and notes commands."""

    def __init__(self, node: Any) -> None:
        self.arrivals: list[tuple[float, float]] = []
        self._speed = 0.0
        self._goals: list[tuple[Any, Future]] = []
        node.create_subscription(Twist, "/cmd_vel", self._drive, 100)
        for name, (kind, rate) in TOPICS.items():
            publisher = node.create_publisher(kind, name, LATCHED if name == "/amcl_pose" else 10)
            node.create_timer(1 / rate, partial(self._publish, publisher, self._message(kind)))
        self._servers = [
            ActionServer(node, NavigateToPose, name, self._execute, cancel_callback=lambda goal: CancelResponse.ACCEPT)
            for name in ACTIONS
        ]
        node.create_timer(1 / FEEDBACK, self._goals_go_on)

    def _drive(self, twist: Twist) -> None:
        self.arrivals.append((time.monotonic(), twist.linear.x))
        self._speed = twist.linear.x

    def _message(self, kind: type) -> Any:
        message = kind()
        if isinstance(message, LaserScan):
            message.ranges = [2.0] * 360
        elif isinstance(message, BatteryState):
            message.percentage = 0.8
        elif isinstance(message, JointState):
            message.name, message.position = [f"joint {i}" for i in range(8)], [0.0] * 8
        return message

    def _publish(self, publisher: Any, message: Any) -> None:
        if isinstance(message, Odometry):
            message.twist.twist.linear.x = self._speed
        publisher.publish(message)

    async def _execute(self, goal: Any) -> Any:
        over = Future()
        self._goals.append((goal, over))
        await over
        goal.canceled()
        return NavigateToPose.Result()

    def _goals_go_on(self) -> None:
        for goal, over in tuple(self._goals):
            if goal.is_cancel_requested:
                self._goals.remove((goal, over))
                over.set_result(None)
            else:
                goal.publish_feedback(NavigateToPose.Feedback())


class Marks:
    """For each tick its time, and the CPU times of the thread that ticks, of the one that spins, and of the process."""

    def __init__(self) -> None:
        self.ticks: list[tuple[float, float, float, float]] = []
        self._spinning: int | None = None

    def __call__(self) -> None:
        if self._spinning is None:
            [thread] = [thread for thread in threading.enumerate() if thread.name.startswith("ros ")]
            assert thread.ident is not None
            self._spinning = time.pthread_getcpuclockid(thread.ident)
        spun = time.clock_gettime(self._spinning)
        self.ticks.append((time.monotonic(), time.thread_time(), spun, time.process_time()))


def robot(report: Path) -> None:
    """Until a signal comes."""
    over = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: over.set())
    with SpunNode("robot") as spun:
        made = Robot(spun.node)
        print("ready", flush=True)
        while not over.wait(0.1):
            pass
    write(report, arrivals=made.arrivals)


def mission(report: Path, seconds: float) -> None:
    """The missions STEADY and STARTS, each for so long, at RATE on btlang's own stage and runner."""
    marks, starts = Marks(), []

    @btlang.action("keep the time")
    def keep_the_time() -> Iterator[None]:
        while True:
            marks()
            yield

    @btlang.action("note the start")
    def note_the_start() -> None:
        starts.append(time.monotonic())

    words = report.with_suffix(".toml")
    words.write_text(WORDS, encoding="utf-8")
    for text in (STEADY, STARTS):
        tree = btlang.parse_tree(text, keywords=[str(words), keep_the_time, note_the_start])
        outcome = tree.run(rate=RATE, time_limit=seconds, robot=connect_ros)
        if not outcome.stopped:
            sys.exit(f"the mission ended: {outcome.why()}")
    write(report, ticks=marks.ticks, starts=starts)


def bare(report: Path, seconds: float) -> None:
    """The same with rclpy alone: five subscriptions, two goals, a thread that spins and a loop at RATE."""
    marks, starts = Marks(), []
    latest: dict[str, Any] = {}
    with bare_robot() as (spun, publisher):
        for name, (kind, _) in TOPICS.items():
            spun.node.create_subscription(kind, name, partial(latest.__setitem__, name), 10)
        clients = [ActionClient(spun.node, NavigateToPose, name) for name in ACTIONS]
        for client in clients:
            client.wait_for_server()
            spun.node.executor.create_task(partial(client.send_goal_async, NavigateToPose.Goal()))
        due = time.monotonic()
        for _ in range(round(seconds * RATE)):
            marks()
            publisher.publish(moving(SPEED))
            due += 1 / RATE
            time.sleep(max(0.0, due - time.monotonic()))
        for _ in range(round(seconds / APART / 2)):
            publisher.publish(moving(0.0))
            time.sleep(APART)
            starts.append(time.monotonic())
            publisher.publish(moving(SPEED))
            time.sleep(APART)
        publisher.publish(moving(0.0))
    write(report, ticks=marks.ticks, starts=starts)


def bare_server(report: Path) -> None:
    """Serves RunMission with rclpy alone: drives for a moment, whatever the mission is. Until a signal comes."""
    over = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: over.set())
    with bare_robot() as (spun, publisher):

        def execute(goal: Any) -> Any:
            publisher.publish(moving(SPEED))
            time.sleep(APART)
            publisher.publish(moving(0.0))
            goal.succeed()
            return RunMission.Result()

        server = ActionServer(spun.node, RunMission, "/bare/run_mission", execute)
        print("ready", flush=True)
        while not over.wait(0.1):
            pass
        server.destroy()


@contextmanager
def bare_robot() -> Iterator[tuple[SpunNode, Any]]:
    """A spun node, and its publisher of velocities once somebody listens."""
    with SpunNode("bare") as spun:
        publisher = spun.node.create_publisher(Twist, "/cmd_vel", 10)
        while not publisher.get_subscription_count():
            time.sleep(0.01)
        yield spun, publisher


def moving(speed: float) -> Twist:
    """The command to drive at a speed."""
    message = Twist()
    message.linear.x = speed
    return message


def write(report: Path, **figures: Any) -> None:
    """Hands figures to the benchmark."""
    report.write_text(json.dumps(figures), encoding="utf-8")


PROGRAMS: dict[str, Callable[..., None]] = {
    "robot": robot, "mission": mission, "bare": bare, "bare-server": bare_server,
}  # fmt: skip

if __name__ == "__main__":
    PROGRAMS[sys.argv[1]](Path(sys.argv[2]), *map(float, sys.argv[3:]))
