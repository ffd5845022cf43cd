"""The parts of a robot that act in a simulated world."""

from __future__ import annotations

from functools import partial

from btlang.robots.base import Base
from btlang.robots.body import Body
from btlang.robots.geometry import Pose
from btlang.robots.hands import Hands
from btlang.robots.joints import Joints
from btlang.robots.motion.guard.readings import ObstacleReading, ScanReading
from btlang.robots.obstacles import Obstacles
from btlang.robots.parts import JointsPart, Parts
from btlang.robots.power import Power
from btlang.robots.voice import Voice
from btlang.robots.world import World

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.robots.scan import Array, Scanner


def simulated_parts(world: World, obstacles: Obstacles, body: Body) -> Parts:
    """Those that act in a world."""
    scanners: list[Scanner] = []

    def scan(pose: Pose) -> Array:
        if not scanners:
            from btlang.robots.scan import Scanner  # brings numpy, which takes longer to import than many missions

            scanners.append(Scanner(obstacles, body.range))
        return scanners[0].read(pose)

    def sensors(now: float) -> list[ObstacleReading]:
        if scanner is None:
            return []
        look = partial(scan, base.pose)
        return [ScanReading("scanner", now, "", look, scanner.view, scanner.angle, base.room)]

    scanner = body.sensor("scanner")
    base, power = Base(world.start, obstacles, body), Power(world.battery, world.all_docks, body)
    joints = joints_part(body)
    hands = Hands(obstacles, world.names.objects, body)
    return Parts(base, power, scan, joints, hands, Voice(body, joints.move), sensors)


def joints_part(body: Body) -> JointsPart:
    """Joints as the body has them: smooth ones plan their movements."""
    if not body.is_smooth:
        return Joints(body)
    from btlang.robots.motion.smooth_joints import SmoothJoints  # brings numpy and ruckig

    return SmoothJoints(body)
