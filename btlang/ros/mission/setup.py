"""What the options of `btc ros-node` settle for all missions of its node."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

from btlang.api import RunnableTree, parse_tree, read_world
from btlang.record import Record
from btlang.robots.stages import stage_maker
from btlang.text.source import Source

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.run.stage import Stage


class Setup(Record):
    """`robot` is a name of ROBOTS; `file` is the mission that the node runs when it is activated, "" for none."""

    name: str = "btlang"
    robot: str = "simulated"
    sim_time: bool = False
    namespace: str = ""
    speed: float | str = "real"
    file: str = ""
    keywords: Sequence[str] = ()
    world: str | None = None
    parser: str = "shunting-yard"

    def stage(self) -> Stage:
        """The robot in its world. Raises MissionError."""
        make: Callable[..., Stage] = stage_maker(self.robot)
        if self.robot != "simulated":
            make = partial(make, sim_time=self.sim_time, namespace=self.namespace, name=f"{self.name}_robot")
        return make(read_world(self.world))

    def compiled(self, source: Source, keywords: Sequence[str] = ()) -> RunnableTree:
        """A mission, with further keyword files. Raises MissionError."""
        return parse_tree(source, parser=self.parser, keywords=[*self.keywords, *keywords], world=self.world)
