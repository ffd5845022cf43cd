"""A simulated robot in its world, for one mission or for several that follow each other."""

from __future__ import annotations

from collections.abc import Mapping

from btlang.robots.bodies.body import Body
from btlang.robots.preflight import check_mission, needs_of_tree
from btlang.robots.simulation.robot import SimulatedRobot
from btlang.robots.worlds.world import World
from btlang.run.bus import Bus

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any, TypeAlias

    from btlang.engine.leaves.leaf import LeafBinding
    from btlang.robots.parts import Parts
    from btlang.robots.worlds.obstacles import Obstacles
    from btlang.run.controls import Controls
    from btlang.run.pace import Pace
    from btlang.tree.node import Tree
    from btlang.vocabulary.entry import Entry
    from btlang.vocabulary.lexicon import Lexicon

    MakeParts: TypeAlias = Callable[[World, Obstacles, Body], Parts]


class Simulation:
    """A connection to a simulated robot. The world keeps its state from one run to the next."""

    def __init__(self, world: World, body: Body | None = None, make_parts: MakeParts | None = None) -> None:
        self.world = world
        self.bus = Bus()
        self._early: list[tuple[str, Mapping[str, Any]]] = []  # faults from the start are there before anybody listens
        self._begun = False
        self.robot = SimulatedRobot(world, self._report, body, make_parts)

    def begin(self, bus: Bus) -> None:
        """Begin a run: what the robot reports goes to this bus."""
        self.bus, self._begun = bus, True
        for kind, data in self._early:
            bus.emit_robot(kind, data)
        self._early.clear()

    def bind(self, entry: Entry, vocabulary: Lexicon) -> LeafBinding | None:
        """Return None: words are done by their `call`."""
        return None

    def check(self, tree: Tree, vocabulary: Lexicon) -> None:
        """Raise MissionError if its body lacks what a leaf needs (BT072), or a goal is in a closed zone (BT074)."""
        check_mission(self.robot.world, self.robot.body, tree, vocabulary)
        if "navigation" in needs_of_tree(tree, vocabulary):
            self.robot.prepare_journeys()

    def pace(self, speed: float, controls: Controls) -> Pace:
        """Return a pace of any speed: the world moves on as fast as it is asked to."""
        from btlang.run.pace import Pace

        return Pace(speed, controls)

    def close(self) -> None:
        """Do nothing: the world stays as it is."""

    def _report(self, kind: str, data: Mapping[str, Any]) -> None:
        if self._begun:
            self.bus.emit_robot(kind, data)
        else:
            self._early.append((kind, data))
