"""The wheels: a round differential drive with limited acceleration that stops at whatever it touches."""

from __future__ import annotations

from math import ceil, copysign, cos, degrees, inf, isnan, radians, sin

from btlang.robots.bodies.body import Body
from btlang.robots.geometry import Pose, wrap
from btlang.robots.robot import RobotError
from btlang.robots.worlds.obstacles import Obstacles

_SUBSTEP = 0.02
_STUCK_AFTER = 1.0
_FREE_AGAIN = 0.03
_BESIDE = 1e-3  # metres by which it may touch what it drives along
_ROOM = 0.2  # metres: with more there is no need to look how much exactly


class SimulatedBase:
    """The base in a simulated world, in metres, degrees and seconds.

    `bumped_into` names what a contact was with, `bumps` counts contacts.
    """

    silent = None
    """Always None: a simulated base knows its pose."""

    def __init__(self, pose: Pose, obstacles: Obstacles, body: Body) -> None:
        self.pose = pose
        self.body = body
        self._driving, self._turning = body.driving, body.turning
        self._radius = body.radius
        self._wheel_gap = body.base.wheel_gap if body.base is not None else 1.0
        self.velocity = (0.0, 0.0)
        self.bumps = 0
        self.bumped_into = ""
        self.travelled = 0.0
        self._rolled = self._turned = 0.0
        self.grips = (1.0, 1.0)
        self.limits = inf, inf
        """Metres and degrees a second that it doesn't exceed, whatever is commanded."""
        self._obstacles = obstacles
        self.commanded = (0.0, 0.0)
        self._speeds = (0.0, 0.0)
        self._hard = False
        self._contact: Pose | None = None
        self._pressed = False
        self._idle = 0.0
        self._free = 0.0
        self._near = ""
        self._layout = -1

    @property
    def wheels(self) -> tuple[float, float]:
        """The metres that the left and the right wheel have rolled."""
        side = radians(self._turned) * self._wheel_gap / 2
        return self._rolled - side, self._rolled + side

    @property
    def bumped(self) -> bool:
        """Whether it ran into something and hasn't moved away yet."""
        return self._contact is not None

    @property
    def stuck(self) -> bool:
        """Whether it has been commanded to move for a second and doesn't."""
        return self._idle >= _STUCK_AFTER

    @property
    def rolling(self) -> bool:
        """Whether it isn't at rest yet."""
        return self._speeds != (0.0, 0.0)

    def drive(self, linear: float, angular: float) -> None:
        """Set the wanted velocity, within the limits."""
        self.commanded = (clip_speed(linear, self._driving.top_speed), clip_speed(angular, self._turning.top_speed))
        self._hard = False
        if self.commanded == (0.0, 0.0):
            self._forget_trouble()

    def brake(self) -> None:
        """Come to rest as fast as the wheels can."""
        self.commanded = (0.0, 0.0)
        self._hard = True
        self._forget_trouble()

    def put(self, pose: Pose) -> None:
        """Put the base at a pose at once, at rest."""
        self.pose, self.commanded, self._speeds = pose, (0.0, 0.0), (0.0, 0.0)
        self._contact, self._layout = None, -1
        self._forget_trouble()

    def step(self, dt: float) -> None:
        """Move on by `dt` in equal pieces of at most 0.02 s."""
        if self.commanded == (0.0, 0.0) and not self.rolling:
            self.velocity = (0.0, 0.0)
            return
        pieces = max(1, ceil(dt / _SUBSTEP - 1e-9))
        for _ in range(pieces):
            self._substep(dt / pieces)

    @property
    def room(self) -> float:
        """The metres that are free around it at least, without another look at the obstacles."""
        obstacles, pose = self._obstacles, self.pose
        if self._layout != obstacles.layout or self._free < _ROOM:
            self._free = obstacles.nearest_standing(pose.x, pose.y)[0] - self._radius
            self._layout = obstacles.layout
        if not obstacles.walking:
            return self._free
        return min(self._free, obstacles.nearest_walking(pose.x, pose.y)[0] - self._radius)

    def free_way(self, direction: float) -> float:
        """Return the metres that are free in a direction (degrees left of ahead), inf beyond the scanner's range."""
        pose = self.pose
        free = self._obstacles.free_way(pose.x, pose.y, pose.heading + direction, self._radius - _BESIDE)
        return free if free <= self.body.range - self._radius else inf

    def _forget_trouble(self) -> None:
        """Give a new attempt to move its own second until it is stuck, and its own bump."""
        self._idle, self._pressed = 0.0, False

    def _substep(self, h: float) -> None:
        linear, angular = self._speeds
        driving, turning = self._driving, self._turning
        brake, turn_brake = (driving.hard_brake, turning.hard_brake) if self._hard else (driving.brake, turning.brake)
        most, most_turn = self.limits
        wanted, turn = limit_value(self.commanded[0], most), limit_value(self.commanded[1], most_turn)
        if abs(linear) > most:
            brake = driving.hard_brake
        linear = step_towards(linear, wanted, driving.acceleration * h, brake * h)
        angular = step_towards(angular, turn, turning.acceleration * h, turn_brake * h)
        self._speeds = linear, angular
        v, w = self._on_floor(linear, angular)
        old = self.pose
        middle = radians(old.heading + w * h / 2)
        moved = v * h
        new = Pose(old.x + moved * cos(middle), old.y + moved * sin(middle), wrap(old.heading + w * h))
        if self._hits(new, abs(moved)):
            new = self._last_free(old, new)
            v, self._speeds = 0.0, (0.0, angular)
            if not self._pressed:
                self._bump(new)
            self._pressed = True
        else:
            self._pressed = False
        self.pose = new
        self.velocity = v, w
        self.travelled += abs(v) * h
        self._rolled += linear * h
        self._turned += angular * h
        if self._contact is not None and self._contact.distance_to((new.x, new.y)) > _FREE_AGAIN:
            self._contact = None
        wanted = abs(wanted) + self._radius * radians(abs(turn))
        real = abs(v) + self._radius * radians(abs(w))
        self._idle = self._idle + h if real < 0.05 * wanted else 0.0

    def _on_floor(self, linear: float, angular: float) -> tuple[float, float]:
        """Return the part of the wheels' motion that reaches the floor if one slips."""
        if self.grips == (1.0, 1.0):
            return linear, angular
        side = radians(angular) * self._wheel_gap / 2
        left, right = (linear - side) * self.grips[0], (linear + side) * self.grips[1]
        return (left + right) / 2, degrees((right - left) / self._wheel_gap)

    def _hits(self, pose: Pose, moved: float) -> bool:
        """Return whether it touches something. `_free` is a lower bound of the room, so that
        most steps needn't check.
        """
        if moved == 0.0:
            return False
        obstacles = self._obstacles
        walking = obstacles.nearest_walking(pose.x, pose.y)[0] - self._radius if obstacles.walking else inf
        if self._layout == obstacles.layout and self._free > moved:
            self._free -= moved
            now = self._free
        else:
            now = self._free = obstacles.nearest_standing(pose.x, pose.y)[0] - self._radius
            self._layout = obstacles.layout
        if now >= 0.0 and walking >= 0.0:
            return False
        now, before = self._gap(pose), self._gap(self.pose)
        if now > before:
            return False  # moving away from something that was put onto the robot
        self._free = 0.0
        return True

    def _gap(self, pose: Pose) -> float:
        distance, self._near = self._obstacles.nearest(pose.x, pose.y)
        return inf if distance == inf else distance - self._radius

    def _last_free(self, old: Pose, new: Pose) -> Pose:
        """Halve the way until the touching point is known to a few micrometres."""
        low, high = 0.0, 1.0
        for _ in range(12):
            middle = (low + high) / 2
            pose = Pose(old.x + middle * (new.x - old.x), old.y + middle * (new.y - old.y), new.heading)
            low, high = (middle, high) if self._gap(pose) >= 0.0 else (low, middle)
        self._gap(new)
        return Pose(old.x + low * (new.x - old.x), old.y + low * (new.y - old.y), new.heading)

    def _bump(self, pose: Pose) -> None:
        self.bumps += 1
        self.bumped_into = self._near
        self._contact = pose


def clip_speed(value: float, limit: float) -> float:
    """Return the velocity, limited to `most`. Raises RobotError for NaN: no limit would hold it."""
    if isnan(value):
        raise RobotError("the robot can't drive at a speed that is not a number")
    return copysign(min(abs(value), limit), value)


def limit_value(value: float, most: float) -> float:
    """Return a value with the same sign, limited to `most`."""
    return value if abs(value) <= most else copysign(most, value)


def step_towards(value: float, target: float, more: float, less: float) -> float:
    """Step towards the target: by at most `less` while slowing down, `more` while speeding up."""
    slowing = abs(target) < abs(value) or target * value < 0.0
    limit = less if slowing else more
    goal = 0.0 if target * value < 0.0 else target
    difference = goal - value
    return goal if abs(difference) <= limit else value + copysign(limit, difference)
