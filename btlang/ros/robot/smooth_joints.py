"""Smooth joints of a ROS 2 robot: whole movements are planned here, and sent as one JointTrajectory each."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from math import inf

import numpy as np
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from trajectory_msgs.msg import JointTrajectory

from btlang.robots.bodies.body import Body
from btlang.robots.bodies.gesture import Gesture, joints_of
from btlang.robots.motion.course import PERIOD, CourseSegment, JointLimits, MotionState, between, plan_brake, samples
from btlang.robots.motion.guard.tracking import shown_distance
from btlang.robots.motion.kinematics import Array
from btlang.robots.motion.movements import stay_at
from btlang.robots.motion.smooth_joints import SmoothJoints
from btlang.robots.motion.timeline import PlannedMotion
from btlang.robots.robot import RobotError, joint_of
from btlang.ros.messages import JointRange, motion, stamp
from btlang.ros.robot.joints import TRAJECTORY, JointStates, on_wire
from btlang.ros.subscriptions import SubscriptionCache
from btlang.support.record import Record

_AHEAD = 0.05
"""Seconds ahead that are settled: the time to plan and send a new trajectory before it begins."""
_WIRE = 0.02  # seconds that a braking trajectory gets to arrive
_EACH = 2  # samples between two points of a trajectory
_RENEWED = 0.2  # seconds of real time after which what is under way is sent again: the robot brakes where it isn't
_OFF, _OFF_SLIDING = 15.0, 0.1  # degrees and metres from the plan
_LOST = 0.5  # seconds for which a joint may be as far from it
_STAMPED = 1.0  # seconds that a stamp may be old; another one is from another clock


class SentTrajectory(Record):
    """A movement of all joints from a second of the node's clock on, and the command for some of them."""

    begins: float
    way: MotionState
    message: JointTrajectory

    @property
    def ends(self) -> float:
        """The second at which they rest."""
        return self.begins + PERIOD * (len(self.way.position) - 1)

    def at(self, seconds: float) -> MotionState:
        """Return the state at a second of the node's clock."""
        last = len(self.way.position) - 1
        passed = min(max(0.0, (seconds - self.begins) / PERIOD), last)
        before = int(passed)
        return between(self.way.rows(before), self.way.rows(min(before + 1, last)), passed - before)


class TrajectoryOperation:
    """A movement as an Operation, done when the joints report that they have arrived."""

    def __init__(self, joints: RosSmoothJoints, play: PlannedMotion, names: Sequence[str]) -> None:
        self._joints, self._play, self._names = joints, play, names
        self.done = False
        self.failure: str | None = None

    def cancel(self) -> None:
        """Brake the joints to rest, at once."""
        if not self.done:
            self.done = True
            self._joints.cancel(self._play)

    def step(self) -> None:
        """End with the planned motion, once the joints are there."""
        if self.done or not self._play.done:
            return
        own = tuple(self._names[index] for index in sorted(self._play.joints))
        try:
            self.failure = self._play.failure
            self.done = self.failure is not None or self._joints.at_target(own)
        except RobotError as problem:
            self.done, self.failure = True, str(problem)


class RosSmoothJoints:
    """Joints whose movements are planned here; see SmoothJoints. Plans follow the node's clock, `_AHEAD` of it.

    A new trajectory replaces the rest of the previous one. `freeze` of all joints takes no lock: it sends how they
    brake, from what was sent last.
    """

    def __init__(self, node: Node, subscriptions: SubscriptionCache, body: Body) -> None:
        self._body, self._clock = body, node.get_clock()
        self._names = [joint.name for joint in body.joints]
        self._limits = JointLimits.of(body.joints)
        self._off = np.array([_OFF_SLIDING if joint.slides else _OFF for joint in body.joints])
        self._si = np.array([joint.si for joint in body.joints])
        self._states = JointStates(subscriptions, body)
        self._smooth = SmoothJoints(body)
        self._origin = self._stepped = self._now()  # of the clock, when the timeline began and at the latest step
        self._commanded: tuple[int, ...] = ()
        self._sent: SentTrajectory | None = None
        self._way = self._smooth.timeline.plan[1]  # what was sent, or needs not be
        self._braked: tuple[float, CourseSegment] | None = None  # by `freeze`; the timeline doesn't know it yet
        self._played: list[TrajectoryOperation] = []
        self._near = inf  # when all joints were last near to the plan
        self._publisher = node.create_publisher(JointTrajectory, TRAJECTORY, 10)
        node.create_timer(_RENEWED, self._renew, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def find_unreported(self) -> list[str]:
        return self._states.find_unreported()

    @property
    def moving(self) -> bool:
        """Whether any joint is on its way, as far as that is known."""
        sent = self._sent
        with suppress(RobotError):
            return sent is not None and (self._now() < sent.ends or not self._have_arrived(self._commanded))
        return False

    def angle(self, name: str) -> float:
        return self._states.angle(name)

    def move(self, targets: Mapping[str, float]) -> None:
        """Plan a movement to targets, as SmoothJoints does. Raises RobotError as `angle` does, too."""
        self._begin(targets)
        self._smooth.move(targets)
        self._send()

    def play(
        self, wanted: Gesture | Sequence[Mapping[str, float]], room: float | None
    ) -> tuple[TrajectoryOperation, float]:
        """Plan a gesture, as SmoothJoints does; `room` counts from the latest step on."""
        self._begin(joints_of(wanted))
        play, slower = self._smooth.play(wanted, None if room is None else room - self._passed)
        made = TrajectoryOperation(self, play, self._names)
        self._played.append(made)
        self._send()
        return made, slower

    def lead(self, wanted: Gesture | Sequence[Mapping[str, float]]) -> float:
        """Return the seconds to a gesture's stroke, as SmoothJoints does, from the latest step on."""
        self._advance()
        if not self.moving:
            self._seed()
        return self._passed + self._smooth.lead(wanted)

    def at_target(self, names: tuple[str, ...]) -> bool:
        """Return whether none of these joints is on its way. Raises RobotError if one is
        silent, or didn't get there.
        """
        sent, joints = self._sent, [self._names.index(joint_of(self._body, name).name) for name in names]
        if sent is None or not self._smooth.timeline.rests(joints):
            return sent is None
        if self._have_arrived([joint for joint in joints if joint in self._commanded]):
            return True
        for joint in joints:
            left = abs(self._measure(joint) - sent.way.position[-1][joint])
            if self._now() > sent.ends + self._body.patience and left > self._body.joints[joint].close_enough:
                far = shown_distance(self._body.joints[joint], left)
                raise RobotError(f"the {self._names[joint]} doesn't move: it is {far} from where it should be")
        return False

    def freeze(self, names: tuple[str, ...] = ()) -> None:
        """Brake these joints to rest."""
        if names:
            self._advance()
            self._smooth.freeze(names)
            self._send()
        else:
            self._smooth.freeze()
            self._brake()

    def cancel(self, play: PlannedMotion) -> None:
        """Brake the joints of a planned motion to rest."""
        self._advance()
        play.cancel()
        self._send()

    def step(self) -> None:
        """Check whether the joints are where they should be."""
        self._advance()
        self._stepped = self._now()
        self._compare()
        self._send()
        for played in self._played:
            played.step()
        self._played = [played for played in self._played if not played.done]

    @property
    def _passed(self) -> float:
        """Seconds from the latest step to the earliest moment that can be changed."""
        return self._origin + self._smooth.timeline.seconds - self._stepped

    def _now(self) -> float:
        return float(self._clock.now().nanoseconds) * 1e-9

    def _advance(self) -> None:
        timeline = self._smooth.timeline
        braked, self._braked = self._braked, None
        if braked is not None:
            began, piece = braked[0] - self._origin, braked[1]
            timeline.follow(
                range(len(self._names)),
                lambda times: piece.at(np.maximum(times - began, 0.0)),
                timeline.seconds,
                began + piece.seconds,
            )
            self._way = timeline.plan[1]
        passed = self._now() + _AHEAD - self._origin - timeline.seconds
        if passed > 0.0:
            timeline.step(passed)
        elif passed < -_STAMPED:  # a simulation has begun again
            self._origin += passed

    def _begin(self, names: Collection[str]) -> None:
        """Begin where the joints are, if they rest. Raises RobotError if one of them is silent."""
        for name in names:
            self.angle(name)
        self._advance()
        rests = not self.moving
        if rests:
            self._seed()
        moved = {self._names.index(name) for name in names}
        self._commanded = tuple(sorted(moved if moved and rests else moved.union(self._commanded)))
        self._near = self._now()

    def _seed(self) -> None:
        self._smooth.timeline.put(self._here())
        self._way = self._smooth.timeline.plan[1]

    def _here(self) -> Array:
        """Return the positions of all joints; the planned one of a joint that is silent."""
        return np.array([self._measure(index) for index in range(len(self._names))])

    def _measure(self, index: int) -> float:
        try:
            return self.angle(self._names[index])
        except RobotError:
            return float(self._smooth.timeline.state.position[index])

    def _have_arrived(self, joints: Sequence[int]) -> bool:
        """Return whether the joints are at their targets. Raises RobotError if one is silent."""
        if self._sent is None:
            return True
        ends = self._sent.way.position[-1]
        return all(
            abs(self.angle(self._names[joint]) - ends[joint]) <= self._body.joints[joint].close_enough
            for joint in joints
        )

    def _compare(self) -> None:
        """Stop all joints if one was far from the plan for too long, or is silent."""
        sent, now = self._sent, self._now()
        if sent is None or not sent.begins < now < sent.ends + _LOST:
            return
        try:
            off = {joint: abs(self._off_plan(joint, sent, now)) for joint in self._commanded}
            far = max(off, key=lambda joint: off[joint] / self._off[joint])
            if off[far] <= self._off[far]:
                self._near = now
            elif now - self._near > _LOST:
                away = shown_distance(self._body.joints[far], off[far])
                self._stay(f"the {self._names[far]} doesn't follow: it is {away} from where it should be")
        except RobotError as problem:
            self._stay(str(problem))

    def _off_plan(self, joint: int, sent: SentTrajectory, now: float) -> float:
        angle, said = self._states.find_stamped(self._names[joint])
        return angle - float(sent.at(said if 0.0 <= now - said < _STAMPED else now).position[joint])

    def _stay(self, reason: str) -> None:
        timeline = self._smooth.timeline
        timeline.halt(reason)
        timeline.follow(range(len(self._names)), stay_at(self._here()), timeline.seconds, timeline.seconds)

    def _brake(self) -> None:
        """Send how all joints come to rest from the motion that was sent last. For any thread."""
        sent, begins = self._sent, self._now() + _WIRE
        if sent is None or begins >= sent.ends:
            return
        piece = plan_brake(sent.at(begins), self._limits)
        self._braked = begins, piece
        self._publish(begins, samples([piece]))

    def _send(self) -> None:
        """Send the new part of the plan."""
        begins, way = self._smooth.timeline.plan
        if way is self._way:
            return
        self._way = way
        self._publish(self._origin + begins + PERIOD, way.rows(slice(1, None)))  # the first one is what was before

    def _publish(self, begins: float, way: MotionState) -> None:
        if not self._commanded:
            return
        last = len(way.position) - 1
        rows = sorted({*range(0, last, _EACH), last})
        at, speed = (self._on_wire(values[rows]) for values in (way.position, way.velocity))
        message = motion(
            self._reach(), [PERIOD * row for row in rows], list(zip(at, speed, strict=True)), stamp(begins)
        )
        self._sent = sent = SentTrajectory(begins, way, message)
        self._publisher.publish(message)
        if self._sent is not sent:
            self._renew()  # another thread has stopped them meanwhile

    def _on_wire(self, values: Array) -> list[list[float]]:
        joints = list(self._commanded)
        made: list[list[float]] = (values[:, joints] * self._si[joints]).tolist()
        return made

    def _reach(self) -> dict[str, JointRange]:
        joints = [self._body.joints[index] for index in self._commanded]
        return {
            on_wire(joint.name): JointRange(joint.low * joint.si, joint.high * joint.si, joint.speed * joint.si)
            for joint in joints
        }

    def _renew(self) -> None:
        """Send the current movement again; a joint controller goes on with it."""
        sent: SentTrajectory | None = None
        while sent is not self._sent:
            sent = self._sent
            if sent is not None and self._now() < sent.ends:
                self._publisher.publish(sent.message)
