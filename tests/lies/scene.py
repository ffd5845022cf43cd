"""A true robot with sensors that lie: what all four forms of the peer share."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from tests.lies.lies import BUMPER, JOINT, ODOMETRY, SCANNER, SONAR, WHEELS, Liar, Lie, OdometrySaid, ScanSaid
from tests.lies.true_robot import TrueRobot, Witness

TOUCHES = 0.002  # metres at which a bumper is pressed


@dataclass
class Result:
    """What came of a run: metres and seconds from the beginning of the lie to rest, whether it touched a wall, metres
    driven in sum, how far the wall was then, and why the mission failed ("" if it didn't)."""

    way: float = 0.0
    seconds: float = 0.0
    touched: bool = False
    driven: float = 0.0
    free: float = 0.0
    moved_on: bool = False
    reason: str = ""

    def data(self) -> dict[str, Any]:
        """All of it, for JSON."""
        return asdict(self)


class Scene:
    """`after` are the metres after which the lies begin, `end` the seconds after which they are over; `latency` are
    seconds that all that sensors say is late.
    """

    def __init__(
        self,
        lies: Sequence[Lie] = (),
        after: float = 0.3,
        end: float = float("inf"),
        latency: float = 0.0,
        **robot: float,
    ) -> None:
        self.robot = TrueRobot(**robot)  # type: ignore[arg-type]
        self.witness = Witness(self.robot)
        self._liar = Liar(lies, after, self.witness.begin, end)
        self._latency = latency
        self._truths: deque[tuple[float, OdometrySaid, float]] = deque()

    def drive(self, linear: float, angular: float) -> None:
        """It is commanded so, and does it unless its wheels lie."""
        share = float(self._liar.says(WHEELS, 1.0, self.robot.time))
        self.robot.drive(share * linear, share * angular)

    def step(self, passed: float) -> None:
        """So many seconds pass."""
        robot = self.robot
        robot.step(passed)
        self._liar.drives(robot.time, robot.driven)
        self.witness.look()
        said = OdometrySaid(robot.x, robot.y, robot.heading, robot.speed, robot.spin, robot.time)
        self._truths.append((robot.time, said, robot.joint))
        while len(self._truths) > 1 and self._truths[1][0] <= robot.time - self._latency:
            self._truths.popleft()

    def odometry(self, clock: float) -> OdometrySaid | None:
        """What it says, with stamps of a clock that is so many seconds ahead of that of the robot."""
        truth = self._truths[0][1]
        made = OdometrySaid(truth.x, truth.y, truth.heading, truth.speed, truth.spin, truth.stamp + clock)
        said: OdometrySaid | None = self._liar.says(ODOMETRY, made, self.robot.time)
        return said

    def scan(self, clock: float) -> ScanSaid | None:
        """What it says."""
        truth = ScanSaid([float(each) for each in self.robot.ranges()], self.robot.time + clock)
        said: ScanSaid | None = self._liar.says(SCANNER, truth, self.robot.time)
        return said

    def sonar(self) -> float | None:
        """What it says."""
        said: float | None = self._liar.says(SONAR, self.robot.ahead(), self.robot.time)
        return said

    def bumper(self) -> bool | None:
        """What it says."""
        said: bool | None = self._liar.says(BUMPER, self.robot.free < TOUCHES, self.robot.time)
        return said

    def joint(self) -> float | None:
        """What it says, and where it is."""
        said: float | None = self._liar.says(JOINT, self.robot.joint, self.robot.time)
        return said

    def wait_for_rest(self) -> None:
        """Waits a second of real time at most until the robot stands; somebody else steps it."""
        until = time.monotonic() + 1.0
        while not self.robot.at_rest and time.monotonic() < until:
            time.sleep(0.01)

    @property
    def result(self) -> Result:
        """What came of it until now."""
        robot, witness = self.robot, self.witness
        return Result(
            witness.way, witness.seconds, robot.touched, robot.driven, robot.free, not robot.at_rest
        )  # fmt: skip
