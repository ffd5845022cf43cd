"""The form of the liar that is a simulated robot: what it senses goes through the lies."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from typing import Any

import numpy as np

import btlang
from btlang.robots.bodies.body_file import standard_body
from btlang.robots.geometry import Pose
from btlang.robots.motion.guard.readings import ObstacleReading, ScanReading
from btlang.robots.parts import Parts
from btlang.robots.robot import SensorSilent
from btlang.robots.simulation.connection import Simulation
from btlang.robots.simulation.parts import make_simulated_parts
from btlang.robots.worlds.scan import summary
from btlang.robots.worlds.world import World
from tests.lies.lies import ODOMETRY, SCANNER, WHEELS, Liar, Lie, OdometrySaid, ScanSaid
from tests.lies.scene import Result
from tests.lies.true_robot import RADIUS, Witness


class LyingBase:
    """A simulated base that lies about where it is; all else is that of the true one."""

    def __init__(self, base: Any, lies: Sequence[Lie], after: float, end: float) -> None:
        self.__dict__.update(
            true=base, time=0.0, said=None, said_at=-1.0, touched=False,
            lies=lies, after=after, end=end, witness=None, liar=None,
        )  # fmt: skip
        self.__dict__["witness"] = Witness(self)  # type: ignore[arg-type]
        self.__dict__["liar"] = Liar(lies, after, self.witness.begin, end)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.true, name)

    def __setattr__(self, name: str, value: Any) -> None:
        if name != "grips":
            setattr(self.true, name, value)

    @property
    def driven(self) -> float:
        """Metres that it has really driven."""
        return float(self.true.travelled)

    @property
    def at_rest(self) -> bool:
        """Whether it really stands."""
        return not self.true.rolling or self.true.velocity == (0.0, 0.0)

    @property
    def pose(self) -> Pose:
        """Where it says that it is."""
        said = self._say()
        return self.true.pose if said is None else Pose(said.x, said.y, said.heading)

    @property
    def velocity(self) -> tuple[float, float]:
        """How fast it says that it is."""
        said = self._say()
        return self.true.velocity if said is None else (said.speed, said.spin)

    @property
    def silent(self) -> str | None:
        """Whether it says nothing."""
        return None if self._say() is not None else "odometry is silent"

    def step(self, dt: float) -> None:
        """It really moves on."""
        share = self.liar.says(WHEELS, 1.0, self.time)
        self.true.grips = share, share
        self.true.step(dt)
        self.__dict__["time"] = self.time + dt
        self.liar.drives(self.time, self.driven)
        self.witness.look()

    def _say(self) -> OdometrySaid | None:
        if self.said_at != self.time:
            pose, (speed, spin) = self.true.pose, self.true.velocity
            truth = OdometrySaid(pose.x, pose.y, pose.heading, speed, spin, self.time)
            self.__dict__["said"] = self.liar.says(ODOMETRY, truth, self.time)
            self.__dict__["said_at"] = self.time
        said: OdometrySaid | None = self.said
        return said


class LyingScanner:
    """A simulated scanner that lies."""

    def __init__(self, base: LyingBase, scan: Any) -> None:
        self._base, self._scan = base, scan
        self._said: ScanSaid | None = None
        self._time, self._heard = -1.0, 0.0

    def read(self, pose: Pose | None = None) -> Any:
        """What it says. Raises SensorSilent."""
        base = self._base
        if self._time != base.time:
            truth = ScanSaid([float(each) for each in self._scan(base.true.pose)], base.time)
            self._said, self._time = base.liar.says(SCANNER, truth, base.time), base.time
        if self._said is None:
            raise SensorSilent("the laser scanner is silent")
        self._heard = base.time
        return np.array(self._said.ranges)

    def readings(self, now: float) -> list[ObstacleReading]:
        """What the guard gets of it."""
        try:
            ranges = self.read()
        except SensorSilent:
            return [ScanReading("scanner", self._heard, "", self.read)]
        return [ScanReading("scanner", now, "", lambda: ranges, 360.0, 0.0, *summary(ranges, RADIUS))]


def run(mission: str, lies: Sequence[Lie], wall: float, after: float, end: float = inf) -> Result:
    """A mission on a simulated robot that lies."""
    ahead = wall + RADIUS
    room = ((ahead, -4.0), (ahead, 4.0), (-4.0, 4.0), (-4.0, -4.0), (ahead, -4.0))
    world = World(start=Pose(0.0, 0.0), walls=(room,))
    bases: list[LyingBase] = []

    def parts(world: World, obstacles: Any, body: Any) -> Parts:
        made = make_simulated_parts(world, obstacles, body)
        base = LyingBase(made.base, lies, after, end)
        bases.append(base)
        scanner = LyingScanner(base, made.scan)
        lying: Parts = made.replace(base=base, scan=scanner.read, sensors=scanner.readings)
        return lying

    with btlang.Session(lambda world_: Simulation(world, standard_body(), parts)) as session:
        made = session.run(btlang.parse_tree(mission), speed="max", time_limit=40.0)
        for _ in range(20):
            session.robot.step(0.05)
    [base] = bases
    outcome = made.outcome
    assert outcome is not None
    reason = "" if outcome.failure is None else str(outcome.failure.reason)
    return Result(
        base.witness.way, base.witness.seconds, base.true.bumps > 0, base.driven, base.true.room,
        not base.at_rest, reason or outcome.stopped,
    )  # fmt: skip
