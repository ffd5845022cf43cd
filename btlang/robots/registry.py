"""Which robots a mission can run on: by name, what connects to one; or a robot file."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from functools import partial

from btlang.record import Record
from btlang.robots.body_file import read_body, shipped_bodies, standard_body
from btlang.robots.platforms import ROBOTS, component_function, connection_function
from btlang.text.source import Source
from btlang.vocabulary.shipped import BODIES

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    from btlang.robots.body import Body
    from btlang.robots.world import World
    from btlang.run.connection import Connection

    Connect: TypeAlias = Callable[[World], Connection]


def body_of(robot: str | Source) -> Body:
    """The body of a robot: of a name in ROBOTS that which ships, else of the robot file, or of its text.

    Raises MissionError (BT071), and ValueError for what is no robot.
    """
    if isinstance(robot, Source):
        return read_body(robot)
    if robot in ROBOTS:
        return standard_body()
    if robot in shipped_bodies():
        return read_body(os.path.join(BODIES, f"{robot}.toml"))
    if not (robot.endswith(".toml") or os.path.exists(robot)):
        names = " or ".join(map(repr, ROBOTS))
        raise ValueError(f"robot must be {names}, a robot file, or a function that connects to one, not {robot!r}")
    return read_body(robot)


def runs_on(robot: str | Source, over: str | None = None) -> tuple[Body, str]:
    """The body, and the name in ROBOTS of what it runs on: that of `over`, else what the robot says.

    Raises as `body_of`, and ValueError for another `over`.
    """
    if over is not None and over not in ROBOTS:
        raise ValueError(f"over must be {' or '.join(map(repr, ROBOTS))}, not {over!r}")
    body = body_of(robot)
    return body, over or (robot if robot in ROBOTS else body.over)


class Connector(Record):
    """Connects a robot of a body, in a world, to what it runs on: `over`, a name in ROBOTS."""

    body: Body
    over: str
    options: Mapping[str, Any] = {}

    def __call__(self, world: World) -> Connection:
        """Raises MissionError where the robot cannot be reached."""
        connect = partial(connection_function(self.over), world, body=self.body, **self.options)
        if not (self.body.components or self.body.devices):
            return connect()
        return component_function()(connect, self.body)


def connector(robot: str | Source, over: str | None = None, **options: Any) -> Connector:
    """What connects to a robot. The options are for one that does not run simulated. Raises as `runs_on`."""
    body, name = runs_on(robot, over)
    return Connector(body, name, {} if name == "simulated" else options)
