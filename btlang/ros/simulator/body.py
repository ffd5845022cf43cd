"""Arms, head, hands and voice: /joint_states, /joint_trajectory, /left_hand/..., /speech, /language, /print, ..."""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import partial
from math import isfinite
from time import monotonic
from typing import Any

from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, String
from std_srvs.srv import SetBool
from trajectory_msgs.msg import JointTrajectory

from btlang.robots.robot import Hand, RobotError
from btlang.robots.simulation.robot import SimulatedRobot
from btlang.ros.node import LATCHED
from btlang.ros.robot.joints import on_wire
from btlang.ros.robot.speech import LANGUAGE
from btlang.ros.simulator.shared import COMMANDS, CallQueue, LatchedPublisher, Moment, PeriodicPublisher
from btlang.text.output import show

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.ros.simulator.joint_player import JointPlayer

_HANDS: tuple[Hand, Hand] = ("left", "right")
_STEP = 0.1  # seconds of real time, between two steps, that count at most for the beginning of speech
_EXACT = 1e-6
_JOINTS, _SMOOTH_JOINTS = 20, 50  # states of them a second


class BodyTopics:
    """The joints, hands and voice. A `player` moves joints along whole trajectories."""

    def __init__(self, node: Node, robot: SimulatedRobot, calls: CallQueue, player: JointPlayer | None) -> None:
        self._robot, self._player, self._logger = robot, player, node.get_logger()
        self._calls = calls
        self._stepped = monotonic()
        self._names = {on_wire(joint.name): joint.name for joint in robot.body.joints}
        self._si = {joint.name: joint.si for joint in robot.body.joints}
        hands = [hand for hand in _HANDS if robot.body.hand(hand) is not None]
        self._joints = node.create_publisher(JointState, "joint_states", COMMANDS)
        self._joints_due = PeriodicPublisher(_JOINTS if player is None else _SMOOTH_JOINTS)
        self._speaking = LatchedPublisher(node, Bool, "speaking", robot.speaking)
        self._holding = {hand: LatchedPublisher(node, String, f"{hand}_hand/holding", "") for hand in hands}
        for hand in hands:
            node.create_service(SetBool, f"{hand}_hand/close", partial(self._close, hand))
        for kind, topic, act in (
            (JointTrajectory, "joint_trajectory", self._move),
            (String, "speech", self._say),
            (String, "print", self._print),
        ):
            node.create_subscription(kind, topic, partial(self._hand_over, act), COMMANDS)
        node.create_subscription(String, LANGUAGE, partial(self._hand_over, self._speak_in), LATCHED)

    def publish(self, now: Moment) -> None:
        """Publish the state of joints, hands and voice."""
        self._stepped = monotonic()
        self._speaking.set(self._speaks)
        for hand, topic in self._holding.items():
            topic.set(self._robot.holding(hand) or "")
        if self._joints_due.is_due(now.seconds):
            state = JointState(name=list(self._names))
            state.header.stamp = now.stamp
            state.position = [self._robot.joint(name) * self._si[name] for name in self._names.values()]
            self._joints.publish(state)

    @property
    def _speaks(self) -> bool:
        """Whether it speaks, and has begun to."""
        robot = self._robot
        return robot.speaking and robot.said_at <= robot.time + _EXACT

    def _hand_over(self, act: Callable[[Any], None], message: Any) -> None:
        self._calls.post(lambda: act(message))

    def _close(self, hand: Hand, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        response.success, response.message = self._calls.ask(partial(self._turn, hand, request.data))
        return response

    def _turn(self, hand: Hand, closes: bool) -> str | None:
        """Close or open a hand; return the name of what it took or put down. Raises RobotError."""
        if closes:
            self._robot.grasp(hand)
            return self._robot.holding(hand)
        held = self._robot.holding(hand)
        self._robot.release(hand)
        return held

    def _move(self, message: JointTrajectory) -> None:
        """Play points with velocities. Otherwise only the last point counts; without points, joints stay where they
        are.
        """
        try:
            if self._player is not None and any(len(point.velocities) for point in message.points):
                if not self._robot.refuses:
                    self._player.play(message)
                return
            self._go(message)
        except RobotError as problem:
            self._logger.warning(f"joint_trajectory: {problem}")

    def _go(self, message: JointTrajectory) -> None:
        names = [self._names[name] for name in message.joint_names if name in self._names]
        if not message.points:
            self._robot.freeze_joints(*(names or self._names.values()))
            return
        positions = dict(zip(message.joint_names, message.points[-1].positions, strict=False))
        known = {self._names[name]: at for name, at in positions.items() if name in self._names}
        targets = {name: at / self._si[name] for name, at in known.items() if isfinite(at)}
        if targets:
            self._robot.move_joints(targets)

    def _say(self, message: String) -> None:
        if message.data:
            self._robot.utterance(message.data)  # first: it takes its time, which isn't that of the voice
            since_step = 0.0 if self._player is None else min(monotonic() - self._stepped, _STEP)
            self._robot.say(message.data, since_step)
        else:
            self._robot.silence()
        self._speaking.set(self._speaks)

    def _speak_in(self, message: String) -> None:
        try:
            self._robot.speak_in(message.data)
        except RobotError as problem:
            show(f"I can't speak {message.data!r}: {problem}", stream=sys.stderr)

    def _print(self, message: String) -> None:
        self._robot.print(message.data)
