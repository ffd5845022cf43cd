"""The node through which a robot leads those of its components that are ROS 2 nodes, and uses them."""

from __future__ import annotations

from collections.abc import Callable
from math import radians

from btlang.robots.geometry import Pose
from btlang.robots.robot import RobotError
from btlang.ros.binding import bind_ros
from btlang.ros.clients import Clients
from btlang.ros.component_host import NodeHost
from btlang.ros.node import SpunNode
from btlang.ros.places import Places

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.engine.leaves.leaf import LeafBinding
    from btlang.robots.body import ComponentPart
    from btlang.vocabulary.entry import Entry
    from btlang.vocabulary.lexicon import Lexicon

_LAST_ANSWERS = 2.0  # seconds that goals which were halted get to end


class ComponentNodes:
    """Those of one robot, from the start to `close`. Raises MissionError (BT100) where ROS 2 doesn't start."""

    def __init__(self, robot: Any) -> None:
        self._robot = robot
        self._spun = SpunNode("btlang_components")
        try:
            self._clients = Clients(self._spun.node)
            self._spun.start()
        except BaseException:
            self._spun.close()
            raise

    def host(self, part: ComponentPart, changed: Callable[[], object], closing: Callable[[], bool]) -> NodeHost:
        """Where a component lives that is a node."""
        return NodeHost(part, changed, closing)

    def bind(self, entry: Entry, vocabulary: Lexicon) -> LeafBinding | None:
        """What does a word with a `ros` table, for robots that are none of ROS 2. Raises MissionError."""
        return bind_ros(entry, vocabulary, self._clients, self._located)

    def close(self) -> None:
        """Leaves the ROS graph."""
        try:
            self._clients.close(_LAST_ANSWERS)
        finally:
            self._spun.close()

    def _located(self, name: str) -> tuple[float, float, float | None]:
        places = Places(self._robot.world, self._robot.body)
        try:
            known = places.known(name)
            point = places.locate(known, Pose(0.0, 0.0, 0.0))
        except RobotError:
            raise KeyError(name) from None
        facing = next((place.facing for place in self._robot.world.places if place.name == known), None)
        return *point, None if facing is None else radians(facing)
