"""Whether the base and the joints move as they were commanded to."""

from __future__ import annotations

from bisect import bisect_right
from collections import deque
from collections.abc import Callable, Collection
from math import cos, inf, radians, sin

from btlang.robots.bodies.body import Body, Joint
from btlang.robots.geometry import Pose, wrap
from btlang.robots.robot import RobotError, joint_of

_WINDOW = 0.8  # seconds over which both are compared
_LATER = (0.0, 0.25, 0.5)  # seconds that a command may take until the odometry shows it
_EACH = 0.1  # seconds between two comparisons
_SHARE = 0.5  # of what was commanded: both disagree if they differ by more
_SLACK, _TURN_SLACK = 0.03, 12.0  # metres and degrees by which they may differ besides
_SHORT, _SHORT_SLACK = 0.25, 0.03  # seconds and metres for robots that are too fast
_TOP, _ROLLS_ON = 1.0, 0.6  # seconds in which it is still as fast as it was commanded, or moved before
_AHEAD = 4.0  # times the slack by which more may be measured: robots roll on
_SETS_OFF, _STOPPED = 1.1, 0.65  # seconds without motion until a robot hasn't set off, and isn't under way any more
_NOTHING = 0.05  # of what is commanded: less is standing still
_STEP = 0.2  # seconds that a step counts at most: a robot brakes by itself before a command that comes late
_KEPT = 100  # commands
_STANDING = 0.3  # seconds without motion
STANDS = "shows that the robot doesn't move"
_DROVE, _TURNED = "shows {:.2f} m where {:.2f} m were commanded", "shows {:.0f} degrees where {:.0f} were commanded"
_NEARER = 0.5  # of what is close enough counts as nearer


class OdometryCheck:
    """A comparison of what was sent to the base with what its odometry shows, over a sliding window."""

    def __init__(self, body: Body) -> None:
        self._body = body
        self._times: list[float] = []
        self._ways: list[tuple[float, float]] = []  # metres and degrees that the commands come to, by the times
        self._speeds = self._way = 0.0, 0.0
        # a time, metres and degrees measured until then, and the time by the clock of the odometry
        self._samples: deque[tuple[float, float, float, float]] = deque()
        self._measured = self._turned = 0.0
        self._pose: Pose | None = None
        self._compared = self._moved_at = 0.0
        self._under_way = False
        self._tops: deque[tuple[float, float]] = deque()  # times and metres a second that were commanded
        self._drives_since = 0.0
        self.rolled = self.commanded = 0.0
        """Total metres by the odometry, in any direction, and by the commands."""

    def sent(self, now: float, linear: float, angular: float) -> None:
        """Note the commanded metres and degrees a second since the last call."""
        passed = min(now - self._times[-1], _STEP) if self._times else 0.0
        driving, turning = self._body.driving, self._body.turning
        speed = _towards(self._speeds[0], linear, driving.acceleration * passed, driving.brake * passed)
        spin = _towards(self._speeds[1], angular, turning.acceleration * passed, turning.brake * passed)
        self._speeds, self._way = (speed, spin), (self._way[0] + speed * passed, self._way[1] + spin * passed)
        self.commanded += abs(speed) * passed
        self._tops.append((now, abs(linear)))
        while self._tops[0][0] < now - _TOP:
            self._tops.popleft()
        self._times.append(now)
        self._ways.append(self._way)
        if len(self._times) > 2 * _KEPT:
            del self._times[:_KEPT], self._ways[:_KEPT]

    def rest(self) -> None:
        """Compare nothing while the base is commanded to stand: somebody else may move it."""
        self._samples.clear()

    def forget(self) -> None:
        """Forget the motion so far: somebody else moved the robot, or will."""
        self._samples.clear()
        self._times.clear()
        self._ways.clear()
        self._pose, self._speeds = None, (0.0, 0.0)

    def fault(self, pose: Pose, stamp: float, measured: float | None = None) -> str:
        """Return why a new pose can't be true, to be read after the name of the odometry; "" if it can.

        `measured` is when it was measured, by another clock than that of `stamp`.
        """
        self._add(pose, stamp, stamp if measured is None else measured)
        if len(self._samples) == 1:
            self._moved_at = self._drives_since = stamp
            self._under_way = False
        first = self._samples[0]
        if fault := self._too_fast(stamp):
            return fault
        if not self._times or stamp - first[0] < _WINDOW or stamp - self._compared < _EACH:
            return ""
        self._compared = stamp
        ways = [
            (end[0] - begin[0], end[1] - begin[1])
            for end, begin in ((self._predict(stamp - late), self._predict(first[0] - late)) for late in _LATER)
        ]
        measured, turned = self._measured - first[1], self._turned - first[2]
        if max(abs(way) for way, _ in ways) < _SLACK:
            found, shown = _disagreement(turned, [turn for _, turn in ways], _TURN_SLACK), _TURNED
        else:
            found, shown = _disagreement(measured, [way for way, _ in ways], _SLACK), _DROVE
        if found is None:
            return ""
        stood = stamp - self._moved_at
        if stood <= _STANDING:
            return shown.format(*found)
        return STANDS if stood > (_STOPPED if self._under_way else _SETS_OFF) else ""

    def _too_fast(self, stamp: float) -> str:
        """Return whether the robot moves faster than it was commanded a while ago, however late it obeys.

        It has to over a longer time, too: delayed messages arrive all at once.
        """
        if stamp - self._drives_since < _ROLLS_ON or not self._tops:
            return ""
        fault = self._too_fast_over(_SHORT, stamp)
        return fault if fault and self._too_fast_over(2 * _SHORT, stamp) else ""

    def _too_fast_over(self, seconds: float, stamp: float) -> str:
        before = next((each for each in reversed(self._samples) if each[0] <= stamp - seconds), None)
        if before is None:
            return ""
        passed = max(stamp - before[0], self._samples[-1][3] - before[3])  # what arrived late, or of what came so
        way, most = abs(self._measured - before[1]), max(top for _, top in self._tops) * passed
        return _DROVE.format(way, most) if way > (1.0 + _SHARE) * most + _SHORT_SLACK else ""

    def _add(self, pose: Pose, stamp: float, measured: float) -> None:
        before, self._pose = self._pose, pose
        if before is not None:
            turned = wrap(pose.heading - before.heading)
            middle = radians(before.heading + turned / 2)
            dx, dy = pose.x - before.x, pose.y - before.y
            self._measured += dx * cos(middle) + dy * sin(middle)
            self._turned += turned
            way = (dx * dx + dy * dy) ** 0.5
            self.rolled += way
            passed = stamp - self._samples[-1][0] if self._samples else 0.0
            if way > _NOTHING * abs(self._speeds[0]) * passed or abs(turned) > _NOTHING * abs(self._speeds[1]) * passed:
                self._moved_at, self._under_way = stamp, True
        self._samples.append((stamp, self._measured, self._turned, measured))
        while len(self._samples) > 1 and self._samples[1][0] <= stamp - _WINDOW:
            self._samples.popleft()

    def _predict(self, time: float) -> tuple[float, float]:
        at = bisect_right(self._times, time)
        if at in (0, len(self._times)):
            return self._ways[max(0, at - 1)]
        begin, end = self._times[at - 1], self._times[at]
        share = (time - begin) / (end - begin)
        (way, turn), (next_way, next_turn) = self._ways[at - 1], self._ways[at]
        return way + share * (next_way - way), turn + share * (next_turn - turn)


def _disagreement(measured: float, commanded: list[float], slack: float) -> tuple[float, float] | None:
    """Return what was measured and what was commanded, if these differ too much."""
    if max(commanded) < 0.0:
        measured, commanded, sign = -measured, [-way for way in commanded], -1.0
    else:
        sign = 1.0
    least, most = min(commanded), max(commanded)
    if least > 0.0 and measured < _SHARE * least - slack:
        return sign * measured, sign * least
    if least > 0.0 and measured > (1.0 + _SHARE) * most + _AHEAD * slack:
        return sign * measured, sign * most
    return None


def _towards(value: float, target: float, more: float, less: float) -> float:
    limit = less if abs(target) < abs(value) or target * value < 0.0 else more
    return max(value - limit, min(value + limit, target))


class JointProgress:
    """The joints of a body that are on their way. `now` returns seconds."""

    def __init__(self, body: Body, now: Callable[[], float]) -> None:
        self._body, self._now = body, now
        self._nearest: dict[str, tuple[float, float]] = {}  # what was left at the nearest, and since when

    def start(self, names: Collection[str]) -> None:
        """Start watching joints that set off now."""
        self._nearest.update(dict.fromkeys(names, (inf, self._now())))

    def has_arrived(self, name: str, left: float) -> bool:
        """Return whether a joint is close enough, with so much left. Raises RobotError if it gets no nearer for too
        long.
        """
        joint = joint_of(self._body, name)
        if abs(left) <= joint.close_enough:
            self._nearest.pop(name, None)
            return True
        now = self._now()
        nearest, since = self._nearest.setdefault(name, (inf, now))
        if abs(left) < nearest - _NEARER * joint.close_enough:
            self._nearest[name] = abs(left), now
        elif now - since > self._body.patience:
            raise RobotError(f"the {name} doesn't move: it is {shown_distance(joint, left)} from where it should be")
        return False


def shown_distance(joint: Joint, distance: float) -> str:
    """Return how far a joint is from where it should be, for people."""
    return f"{abs(distance):.2f} m" if joint.slides else f"{abs(distance):.0f} degrees"
