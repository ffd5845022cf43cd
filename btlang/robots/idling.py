"""What a robot does with joints that nothing else moves: it breathes, and looks at who speaks to it."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from btlang.robots.body import Body, Breathing
from btlang.robots.geometry import Point, Pose
from btlang.robots.gesture import Gesture
from btlang.robots.idle_file import LOOK_AT
from btlang.robots.parts import IdlePart
from btlang.robots.robot import RobotError
from btlang.robots.turning import turned

_LOOKS = 4.0  # seconds at somebody who has spoken
_TURNS = 0.5  # seconds at least until the head has turned
_OFF = 5.0  # degrees from where it should look
_SAME = 1e-3  # degrees
_AGAIN = 0.5  # seconds until something that can't be done is tried again
_COARSE = 1.0  # seconds between two steps from which on nobody watches


class Idling:
    """Of a robot; `place` says where somebody is, `pose` where the robot is. Nothing is begun before it is `on`."""

    def __init__(
        self, body: Body, joints: IdlePart, place: Callable[[str], Point | None], pose: Callable[[], Pose]
    ) -> None:
        self._body, self._joints, self._place, self._pose = body, joints, place, pose
        self.on = False
        self._tries_in = 0.0
        self._middle, self._side = float("nan"), 1.0
        self._who, self._left = "", 0.0
        self._home: Mapping[str, float] = {}
        self._turned: Mapping[str, float] = {}

    def halt(self) -> None:
        """Begins nothing until it is `on` again; whoever calls it halts the joints. For any thread."""
        self.on, self._who, self._turned = False, "", {}

    def attend(self, who: str) -> None:
        """Somebody speaks with the robot; "" where that isn't known."""
        if who and self._body.idle.look_at_speaker:
            self._who, self._left = who, _LOOKS

    def step(self, dt: float) -> None:
        """So many seconds have passed."""
        self._left -= dt
        self._tries_in -= dt
        if not self.on or dt >= _COARSE or self._tries_in > 0.0:
            return
        if self._body.idle.breathing is not None:
            self._breathe(self._body.idle.breathing)
        if self._who or self._home:
            self._look()

    def _breathe(self, breathing: Breathing) -> None:
        planned = self._joints.planned
        if not planned.rests((breathing.joint,)):
            return
        joint, at = self._body.joint(breathing.joint), planned.angle(breathing.joint)
        assert joint is not None
        if not abs(at - self._middle) <= breathing.by + _SAME:
            self._middle = min(joint.high - breathing.by, max(joint.low + breathing.by, at))
        if self._begin({joint.name: self._middle + self._side * breathing.by}, breathing.every / 2):
            self._side = -self._side

    def _look(self) -> None:
        """At who speaks, then back to where the head was, unless something else has moved it since."""
        names = list(self._body.postures[LOOK_AT][0])
        planned = self._joints.planned
        if not planned.rests(names):
            if not planned.at_target(tuple(names)):
                self._home = self._turned = {}
            return
        at = {name: planned.angle(name) for name in names}
        if any(abs(at[name] - angle) > _SAME for name, angle in self._turned.items()):
            self._home = self._turned = {}
        if self._left > 0.0 and self._who:
            wanted = self._aimed()
            if any(abs(at[name] - angle) > _OFF for name, angle in wanted.items()) and self._begin(wanted, _TURNS):
                self._home, self._turned = self._home or at, wanted
            return
        self._who = ""
        if self._home and self._begin(self._home, _TURNS):
            self._home = self._turned = {}

    def _aimed(self) -> Mapping[str, float]:
        """Where the head looks at who speaks; empty where it can't, or nobody knows where that is."""
        try:
            place = self._place(self._who)
            steps = turned(self._body, self._body.postures[LOOK_AT], self._pose, place, self._joints.planned.angle)
        except RobotError:
            return {}
        return steps[0] if place is not None and not isinstance(steps, Gesture) else {}

    def _begin(self, targets: Mapping[str, float], least: float) -> bool:
        found = self._joints.idle(targets, least)
        if not found:
            self._tries_in = _AGAIN
        return found
