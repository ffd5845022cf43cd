"""The table of lies, and who tells them. A lie changes what one sensor says, from a beginning to an end."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass, field
from math import inf, nan
from typing import Any

SIMULATED, DEVICES, BOARD, ROS = "simulated", "devices", "board", "ros"
ALL = (SIMULATED, DEVICES, BOARD, ROS)
ODOMETRY, SCANNER, SONAR, BUMPER, JOINT, WHEELS = "odometry", "scanner", "sonar", "bumper", "joint", "wheels"


@dataclass
class OdometrySaid:
    """What an odometry says: metres, degrees and seconds."""

    x: float
    y: float
    heading: float
    speed: float
    spin: float
    stamp: float
    covariance: float = 0.0
    quaternion: float = 1.0


@dataclass
class ScanSaid:
    """What a scanner says: metres, degrees and seconds."""

    ranges: list[float]
    stamp: float
    start: float = 0.0
    step: float = 1.0
    low: float = 0.05
    high: float = 10.0


@dataclass
class Telling:
    """A lie that is being told: for so many `seconds`, by now."""

    strength: float
    seconds: float = 0.0
    said: list[tuple[float, Any]] = field(default_factory=list)
    """What would have been true, with its times, from 3 s before the lie began on."""
    first: Any = None
    """What was true when it began."""
    told: Any = None
    """What was said last."""


Tell = Callable[[Any, Telling], Any]
"""What a sensor says in place of the truth; None: nothing."""


@dataclass(frozen=True)
class Lie:
    """`outcome` says what it asks of the robot: to "stop" at once, to stay clear of the "wall" although it may be
    hidden or to stop before it early, to go on as if nothing was ("fine"), or to "fail" without moving on.

    `words` is a pattern of the reason that has to be given; `platforms` are those that can tell it. A robot that has to
    stop is at rest within `way` metres and so many `seconds`.
    """

    name: str
    sensor: str
    tell: Tell
    outcome: str
    words: str
    platforms: Sequence[str] = ALL
    strength: float = 1.0
    way: float = 0.5
    seconds: float = 1.0


def _lag(said: Any, telling: Telling) -> Any:
    """What was true `strength` seconds ago, with the stamp of then."""
    now = telling.said[-1][0]
    return next((each for time, each in reversed(telling.said) if time <= now - telling.strength), telling.said[0][1])


def _lag_fresh(said: Any, telling: Telling) -> Any:
    old = copy(_lag(said, telling))
    old.stamp = said.stamp
    return old


def _scaled(said: OdometrySaid, telling: Telling) -> OdometrySaid:
    """The way since the lie began, `strength` times as long."""
    first, k = telling.first, telling.strength
    made = copy(said)
    made.x, made.y = first.x + k * (said.x - first.x), first.y + k * (said.y - first.y)
    made.speed = k * said.speed
    return made


def _sideways(said: OdometrySaid, telling: Telling) -> OdometrySaid:
    first, made = telling.first, copy(said)
    made.x, made.y = first.x - (said.y - first.y), first.y + (said.x - first.x)
    return made


def _with(**changes: Any) -> Tell:
    def tell(said: Any, telling: Telling) -> Any:
        made = copy(said)
        for name, value in changes.items():
            setattr(made, name, value(getattr(said, name), telling) if callable(value) else value)
        return made

    return tell


def _frozen(*names: str) -> Tell:
    """These fields are as they were when the lie began."""
    return _with(**{name: lambda value, telling, name=name: getattr(telling.first, name) for name in names})


def _silent(said: Any, telling: Telling) -> None:
    return None


def _spin(said: OdometrySaid, telling: Telling) -> OdometrySaid:
    made = copy(said)
    made.heading = (telling.seconds * 400.0) % 360.0 - 180.0
    return made


def _noise(said: OdometrySaid, telling: Telling) -> OdometrySaid:
    made = copy(said)
    made.x += telling.strength * math.sin(97.0 * telling.seconds)
    return made


def _sector(value: float, begin: int, end: int) -> Tell:
    """Beams from one degree to another say this."""

    def tell(said: ScanSaid, telling: Telling) -> ScanSaid:
        made = copy(said)
        made.ranges = list(said.ranges)
        for beam in range(begin, end):
            made.ranges[beam % 360] = value
        return made

    return tell


def _few(said: ScanSaid, telling: Telling) -> ScanSaid:
    made = copy(said)
    made.ranges, made.step = [said.ranges[beam] for beam in (90, 180, 270)], 90.0
    made.start = 90.0
    return made


def _behind(said: ScanSaid, telling: Telling) -> ScanSaid:
    made = copy(said)
    made.ranges, made.start = said.ranges[90:271], 90.0
    return made


def _halved(said: ScanSaid, telling: Telling) -> ScanSaid:
    made = copy(said)
    made.ranges = [telling.strength * each for each in said.ranges]
    return made


def _number(value: float) -> Tell:
    return lambda said, telling: value


def _factor(said: float, telling: Telling) -> Any:
    return telling.strength


def _frozen_number(said: float, telling: Telling) -> Any:
    return telling.first


def _back(value: float, telling: Telling) -> float:
    return value - 2.0 * telling.seconds - 0.1


STAMPED = (ROS,)
_DISAGREES = r"odom\w* shows -?\d+\.\d\d m where \d+\.\d\d m were commanded"
STANDS = r"odom\w* shows that the robot doesn't move"
_BLIND = r"scanner: no valid beam looks ahead"
SEEN = r"(scanner|sonar): 0\.0\d m ahead"
LIES: tuple[Lie, ...] = (
    # Odometry
    Lie(
        "odometry lags by 1.5 s",
        ODOMETRY,
        _lag,
        "stop",
        f"{_DISAGREES}|is 1.\\d s old|repeats its time stamp|{STANDS}",
        ALL,
        1.5,
    ),
    Lie(
        "odometry lags by 1.5 s with fresh stamps",
        ODOMETRY,
        _lag_fresh,
        "stop",
        f"{_DISAGREES}|{STANDS}",
        STAMPED,
        1.5,
    ),
    Lie("odometry with the wrong sign", ODOMETRY, _scaled, "stop", _DISAGREES, ALL, -1.0),
    Lie("odometry sideways", ODOMETRY, _sideways, "stop", _DISAGREES, (SIMULATED, ROS)),
    Lie("a tenth of the way", ODOMETRY, _scaled, "stop", _DISAGREES, ALL, 0.1),
    Lie("a third of the way", ODOMETRY, _scaled, "stop", _DISAGREES, ALL, 0.3),
    Lie("three times the way", ODOMETRY, _scaled, "stop", _DISAGREES, ALL, 3.0),
    Lie("ten times the way", ODOMETRY, _scaled, "stop", _DISAGREES, ALL, 10.0),
    Lie("nine tenths of the way", ODOMETRY, _scaled, "fine", "", ALL, 0.9),
    Lie("a frozen pose", ODOMETRY, _frozen("x", "y", "heading"), "stop", f"{STANDS}|{_DISAGREES}", ALL),
    Lie("a pose of noise", ODOMETRY, _noise, "stop", f"{_DISAGREES}|jumps", (SIMULATED, ROS), 0.5),
    Lie("a heading that spins", ODOMETRY, _spin, "stop", f"{_DISAGREES}", (ROS,)),
    Lie("silent odometry", ODOMETRY, _silent, "stop", "silent|reports nothing new"),
    Lie("frozen stamps of odometry", ODOMETRY, _frozen("stamp"), "stop", "/odom repeats its time stamp", STAMPED),
    Lie("a repeated odometry", ODOMETRY, _frozen("x", "y", "heading", "stamp"), "stop", "/odom repeats", STAMPED),
    Lie(
        "odometry stamps that go back",
        ODOMETRY,
        _with(stamp=_back),
        "stop",
        "/odom has time stamps that go back",
        STAMPED,
    ),
    Lie(
        "odometry stamps 10 s old",
        ODOMETRY,
        _with(stamp=lambda at, telling: at - 10.0),
        "stop",
        "/odom (is 10.0 s old|has time stamps that go back)",
        STAMPED,
    ),
    Lie(
        "odometry stamps 10 s ahead",
        ODOMETRY,
        _with(stamp=lambda at, telling: at + 10.0),
        "stop",
        "/odom has time stamps that are 10.0 s in the future",
        STAMPED,
    ),
    Lie("odometry of NaN", ODOMETRY, _with(x=nan), "stop", "not finite", STAMPED),
    Lie("odometry of inf", ODOMETRY, _with(x=inf), "stop", "not finite", STAMPED),
    Lie("a speed of NaN", ODOMETRY, _with(speed=nan), "stop", "not finite|not a number", (DEVICES, ROS)),
    Lie("a covariance of NaN", ODOMETRY, _with(covariance=nan), "stop", "covariance that is not finite", STAMPED),
    Lie("a quaternion of zero", ODOMETRY, _with(quaternion=0.0), "stop", "invalid quaternion", STAMPED),
    Lie("a pose 1e9 m away", ODOMETRY, _with(x=1e9), "stop", r"1e\+09 m away|jumps|shows", (DEVICES, ROS)),
    Lie("a speed of 300 m/s", ODOMETRY, _with(speed=300.0), "stop", "moves at 300 m/s", STAMPED),
    # Scanner
    Lie("a silent scanner", SCANNER, _silent, "stop", "scan\\w* is silent|nothing new", (SIMULATED, DEVICES, ROS)),
    Lie("a scan of NaN", SCANNER, _sector(nan, 0, 360), "stop", "no valid beam", (SIMULATED, DEVICES, ROS)),
    Lie("an empty scan", SCANNER, _with(ranges=[]), "stop", "no valid beam", (DEVICES, ROS)),
    Lie("beams only behind", SCANNER, _behind, "stop", _BLIND, (DEVICES, ROS)),
    Lie("no valid beam ahead", SCANNER, _sector(nan, -30, 31), "stop", _BLIND, (SIMULATED, DEVICES, ROS)),
    Lie("a gap of 12 degrees ahead", SCANNER, _sector(nan, -6, 6), "stop", _BLIND, (SIMULATED, DEVICES, ROS)),
    Lie("a gap of 3 degrees ahead", SCANNER, _sector(nan, -1, 2), "wall", SEEN, (SIMULATED, DEVICES, ROS)),
    Lie("no valid beam behind", SCANNER, _sector(nan, 150, 211), "wall", SEEN, (SIMULATED, DEVICES, ROS)),
    Lie(
        "frozen ranges",
        SCANNER,
        _frozen("ranges"),
        "wall",
        "scanner: shows the same|" + SEEN,
        (SIMULATED, DEVICES, ROS),
    ),
    Lie("a repeated scan", SCANNER, _frozen("ranges", "stamp"), "stop", "/scan repeats its time stamp", STAMPED),
    Lie("scan stamps that go back", SCANNER, _with(stamp=_back), "stop", "/scan has time stamps that go back", STAMPED),
    Lie(
        "scan stamps 10 s old",
        SCANNER,
        _with(stamp=lambda at, telling: at - 10.0),
        "stop",
        "/scan (is 10.0 s old|has time stamps that go back)",
        STAMPED,
    ),
    Lie(
        "scan stamps 10 s ahead",
        SCANNER,
        _with(stamp=lambda at, telling: at + 10.0),
        "stop",
        "/scan has time stamps that are 10.0 s in the future",
        STAMPED,
    ),
    Lie("scans that lag by 1.5 s", SCANNER, _lag, "stop", "/scan is 1.\\d s old", STAMPED, 1.5),
    Lie("scans of -1 m", SCANNER, _sector(-1.0, 0, 360), "stop", "no valid beam|scanner: 0.00 m ahead", (DEVICES, ROS)),
    Lie("scans of 0 m", SCANNER, _sector(0.0, 0, 360), "stop", "no valid beam|scanner: 0.00 m ahead", (DEVICES, ROS)),
    Lie(
        "scans from 12 m to 10 m",
        SCANNER,
        _with(low=12.0),
        "stop",
        "/scan says that it sees from 12 m to 10 m",
        STAMPED,
    ),
    Lie("no angle between beams", SCANNER, _with(step=0.0), "stop", "where its beams point|no valid beam", (ROS,)),
    Lie("beams from 1e30 degrees on", SCANNER, _with(start=1e30), "stop", "where its beams point", (ROS,)),
    Lie(
        "too close to be measured",
        SCANNER,
        _sector(-inf, -10, 11),
        "stop",
        "scanner: 0.00 m ahead|not a number",
        (DEVICES, ROS),
    ),
    Lie("half of the range", SCANNER, _halved, "wall", r"scanner: 0\.0\d m ahead", (SIMULATED, DEVICES, ROS), 0.5),
    Lie(
        "a phantom ahead", SCANNER, _sector(0.22, -10, 11), "stop", r"scanner: 0\.02 m ahead", (SIMULATED, DEVICES, ROS)
    ),
    Lie("a phantom beside", SCANNER, _sector(0.22, 85, 96), "wall", SEEN, (SIMULATED, DEVICES, ROS)),
    Lie("a phantom behind", SCANNER, _sector(0.22, 170, 191), "wall", SEEN, (SIMULATED, DEVICES, ROS)),
    Lie("three beams, none ahead", SCANNER, _few, "stop", _BLIND, (DEVICES, ROS)),
    # Distance sensor and bumper
    Lie("a silent sonar", SONAR, _silent, "stop", "sonar is silent", (DEVICES, BOARD)),
    Lie("a sonar of NaN", SONAR, _number(nan), "stop", "sonar is silent: its distance is not a number", (DEVICES,)),
    Lie("a sonar of 0 m", SONAR, _number(0.0), "stop", r"sonar: 0\.00 m ahead", (DEVICES, BOARD)),
    Lie(
        "a frozen sonar",
        SONAR,
        _frozen_number,
        "wall",
        r"sonar: (shows the same|0\.0\d m ahead)|scanner",
        (DEVICES, BOARD),
    ),
    Lie("a phantom for the sonar", SONAR, _number(0.03), "stop", r"sonar: 0\.03 m ahead", (DEVICES, BOARD)),
    Lie("a sonar that sees nothing", SONAR, _number(inf), "wall", SEEN, (DEVICES,)),
    Lie("a bumper that is always pressed", BUMPER, _number(True), "stop", "bumped|is pressed", (DEVICES, BOARD)),
    Lie("a silent bumper", BUMPER, _silent, "stop", "bumper is silent", (DEVICES, BOARD)),
    Lie("a bumper that is never pressed", BUMPER, _number(False), "wall", r"sonar|scanner", (DEVICES, BOARD)),
    # Wheels that do something else than they are told
    Lie("wheels that stand", WHEELS, _number(0.0), "fail", f"{STANDS}|doesn't move|{_DISAGREES}", ALL),
    Lie("wheels that turn the other way", WHEELS, _factor, "stop", _DISAGREES, (DEVICES, BOARD, ROS), -1.0),
    Lie("wheels at a quarter of the speed", WHEELS, _factor, "fail", _DISAGREES, (DEVICES, BOARD, ROS), 0.25),
    Lie(
        "wheels that run three times as fast",
        WHEELS,
        _factor,
        "stop",
        _DISAGREES,
        (DEVICES, BOARD, ROS),
        3.0,
        way=1.1,
        seconds=1.4,
    ),
    # Joints
    Lie("a joint that is stuck", JOINT, _frozen_number, "fail", "head turn doesn't move", (DEVICES, BOARD, ROS)),
    Lie("a joint that is silent", JOINT, _silent, "fail", "silent", (DEVICES, BOARD)),
    Lie("a joint of NaN", JOINT, _number(nan), "fail", "not a number|doesn't report the joint", (DEVICES, ROS)),
)


def look_true(lies: Sequence[Lie]) -> bool:
    """Whether wheels and odometry lie so that together they show about what was commanded: nobody can tell that."""
    factors = [lie.strength for lie in lies if lie.tell in (_factor, _scaled)]
    return len(factors) == 2 and 0.5 <= factors[0] * factors[1] <= 1.5


BY_NAME = {lie.name: lie for lie in LIES}


class Liar:
    """Tells lies from the moment on when the robot has driven so far. Times are those of the true robot."""

    def __init__(self, lies: Sequence[Lie], after: float, begin: Callable[[], object], end: float = inf) -> None:
        self._lies = {lie.sensor: (lie, Telling(lie.strength)) for lie in lies}
        self._after, self._begin, self._end = after, begin, end
        self._began: float | None = None

    def drives(self, time: float, driven: float) -> None:
        """The robot has driven so far."""
        if self._began is None and driven >= self._after:
            self._began = time
            self._begin()

    def says(self, sensor: str, truth: Any, time: float) -> Any:
        """What the sensor says; None: nothing."""
        lie, telling = self._lies.get(sensor, (None, None))
        if lie is None or telling is None:
            return truth
        telling.said.append((time, truth))
        while telling.said[0][0] < time - 3.0:
            telling.said.pop(0)
        if self._began is None or time >= self._began + self._end:
            return truth
        if telling.first is None:
            telling.first = truth
        telling.seconds = time - self._began
        return lie.tell(truth, telling)

    def tells(self, sensor: str) -> bool:
        """Whether it lies about this sensor."""
        return sensor in self._lies
