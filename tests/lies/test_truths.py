"""Robots that say the truth, as bad as real ones do: not one of them is stopped."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from math import inf
from random import Random

import numpy as np
import pytest

from btlang.robots.bodies.body_file import standard_body
from btlang.robots.geometry import Pose
from btlang.robots.motion.guard.guard import Guard
from btlang.robots.motion.guard.readings import ObstacleReading, OdometryReading, ScanReading, StampCheck
from btlang.robots.motion.progress import Approach
from btlang.robots.worlds.scan import Array, scan, summary
from btlang.robots.zones import Zones
from tests.lies.true_robot import RADIUS, TrueRobot
from tests.profiles import amount

TICK, SCANS = 0.05, 0.1


@dataclass
class Truth:
    """A robot and its surroundings. `door` metres ahead is one that is 10 cm wider than the robot, 0 for none."""

    seed: int
    rate: float
    latency: float
    late: float
    acceleration: float
    grip: float
    skew: float
    door: float
    crowd: int


def drawn(seed: int) -> Truth:
    random = Random(seed)
    return Truth(
        seed, random.choice((5.0, 10.0, 20.0, 50.0)), random.choice((0.0, 0.1, 0.3)), random.choice((0.0, 0.1)),
        random.choice((0.25, 0.5, 1.0)), random.choice((0.9, 0.95, 1.0)), random.choice((-5.0, 0.0, 5.0)),
        random.choice((0.0, 0.0, 1.0, 2.0)), random.choice((0, 0, 4, 10)),
    )  # fmt: skip


class World:
    """A door, and people who walk past on both sides or cross the way."""

    def __init__(self, truth: Truth, robot: TrueRobot) -> None:
        random = Random(truth.seed + 1)
        gap = RADIUS + 0.05
        if truth.door:
            at = truth.door + RADIUS
            robot.walls += [(at, gap, at, 4.0), (at, -gap, at, -4.0)]
        self._walls = np.array(robot.walls, dtype=np.float64).reshape(-1, 4)
        sides = [random.choice((-1, 1)) * random.uniform(0.75, 2.0) for _ in range(truth.crowd)]
        self._people = [(random.uniform(0.0, 5.0), side, random.uniform(-1.2, 1.2)) for side in sides]
        self._random, self._robot = random, robot
        self.walking: dict[str, tuple[float, float, float]] = {}

    def step(self) -> None:
        """They walk on, along the way or beside it."""
        time = self._robot.time
        self.walking = {
            f"person {number}": ((x + speed * time) % 6.0 - 0.5, side, 0.25)
            for number, (x, side, speed) in enumerate(self._people)
        }

    def wall_between(self, a: object, b: object) -> bool:
        """See WalkingPeople."""
        return False

    def ranges(self) -> Array:
        """A scan with noise, and beams that are lost."""
        discs = np.array([*self.walking.values()], dtype=np.float64).reshape(-1, 3)
        noise = np.random.default_rng(self._random.getrandbits(32))
        ranges = scan(self._walls, discs, self._robot.pose, 10.0) + noise.normal(0.0, 0.005, 360)
        ranges[noise.random(360) < 0.02] = np.nan
        return ranges


def drive(truth: Truth, metres: float) -> tuple[str, float, bool]:
    """Why the guard ended a drive, "" if it didn't; metres that it really drove, and whether it touched something."""
    body = standard_body()
    driving = body.driving.replace(acceleration=truth.acceleration)
    body = body.replace(base=body.base.replace(driving=driving))  # type: ignore[union-attr]
    robot = TrueRobot(8.0, truth.late, truth.acceleration, truth.grip)
    world = World(truth, robot)
    odometry, scans = StampCheck(), StampCheck()
    random = Random(truth.seed)
    under_way: deque[tuple[float, float, Pose]] = deque()  # arrives, stamp, pose
    seen: dict[str, tuple[float, str, object]] = {}
    sent = scanned = -inf

    def sensors() -> list[ObstacleReading]:
        arrived, fault, ranges = seen["scan"]
        room, content = summary(ranges, RADIUS)  # type: ignore[arg-type]
        look = lambda: ranges  # noqa: E731
        return [ScanReading("scanner", arrived, fault, look, 360.0, 0.0, room, content)]  # type: ignore[arg-type]

    def latest() -> OdometryReading | None:
        if "odometry" not in seen:
            return None
        arrived, fault, pose = seen["odometry"]
        return OdometryReading("odometry", arrived, fault, pose)  # type: ignore[arg-type]

    guard = Guard(
        body, Zones(()), world, sensors=sensors, odometry=latest, pose=lambda: robot.pose, now=lambda: robot.time
    )
    approach = Approach(driving.speed, 2.0, driving.slowing, 0.05)
    start: Pose | None = None
    while robot.time < 60.0:
        robot.step(TICK)
        world.step()
        now = robot.time
        if now - sent >= 1.0 / truth.rate - 1e-9:
            sent = now
            at = Pose(robot.x + random.gauss(0.0, 0.001), robot.y, robot.heading + random.gauss(0.0, 0.05))
            under_way.append((now + truth.latency + random.uniform(0.0, 0.02), now + truth.skew + 100.0, at))
        while under_way and under_way[0][0] <= now:
            _, stamp, pose = under_way.popleft()
            seen["odometry"] = now, odometry.fault(stamp, now), pose
        if now - scanned >= SCANS - 1e-9:
            scanned = now
            seen["scan"] = now, scans.fault(now + truth.skew + 100.0, now), world.ranges()
        found = latest()
        if found is None:
            continue
        start = start or found.pose
        left = metres - start.progress_of(found.pose)
        if abs(left) < 0.05:
            robot.drive(0.0, 0.0)
            robot.step(1.0)
            return "", robot.x, robot.touched
        course = start.heading - found.pose.heading - 20.0 * (found.pose.y - start.y)
        verdict = guard.judge(approach.velocity(left), max(-20.0, min(20.0, 1.0 * course)))
        robot.drive(verdict.linear, verdict.angular)
        if guard.held:
            return guard.held, robot.x, robot.touched
    return f"time is up: {guard.verdict}", robot.x, robot.touched


@pytest.mark.long
def test_who_says_the_truth_is_not_stopped() -> None:
    for seed in range(amount(15, 1000)):
        truth = drawn(seed)
        reason, x, touched = drive(truth, 3.0)
        assert (reason, touched) == ("", False), truth
        assert x == pytest.approx(3.0, abs=0.35), truth


def test_the_door_is_10_cm_wider_than_the_robot() -> None:
    truth = Truth(0, 20.0, 0.0, 0.0, 1.0, 1.0, 0.0, 1.0, 0)
    robot = TrueRobot(8.0)
    World(truth, robot)
    robot.x = 1.0 + RADIUS
    assert robot.free == pytest.approx(0.05)
