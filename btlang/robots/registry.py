"""Finds robots: by the name of what they run on, by the name of an installed package, or by a robot file."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from importlib.util import find_spec

from btlang.robots.bodies.body_file import read_body, shipped_bodies, standard_body
from btlang.robots.platforms import ALL, COMPONENTS, ROBOTS, import_function
from btlang.support.record import Record
from btlang.text.source import Source
from btlang.vocabulary.shipped import BODIES

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    from btlang.robots.bodies.body import Body
    from btlang.robots.worlds.world import World
    from btlang.run.connection import Connection

    Connect: TypeAlias = Callable[[World], Connection]


ENTRY_POINTS = "btlang.robots"
"""Each entry point names a package with a file `robot.toml`: an installed robot."""


def body_of(robot: str | Source) -> Body:
    """Return the body of a robot: a name in ROBOTS, a robot file, its text, or the name of an installed package.

    Raises MissionError (BT071), and ValueError if it isn't a robot.
    """
    if isinstance(robot, Source):
        return read_body(robot)
    if robot in ROBOTS:
        return standard_body()
    if robot in shipped_bodies():
        return read_body(os.path.join(BODIES, f"{robot}.toml"))
    if robot.endswith(".toml") or (os.path.exists(robot) and not os.path.isdir(robot)):
        return read_body(robot)
    path = find_installed_robot(robot)
    if path is None:
        names = " or ".join(map(repr, ROBOTS))
        raise ValueError(
            f"robot must be {names}, a robot file, an installed robot, or a function that connects to one, "
            f"not {robot!r}"
        )
    return read_body(path)


def find_installed_robot(name: str) -> str | None:
    """Return the robot file of an installed package, by the name of its entry point; None if there is none."""
    from importlib.metadata import entry_points

    for entry_point in entry_points(group=ENTRY_POINTS, name=name):
        with suppress(ImportError, ValueError):
            spec = find_spec(entry_point.value)
            for folder in (spec.submodule_search_locations or ()) if spec is not None else ():
                return os.path.join(folder, "robot.toml")
    return None


def runs_on(robot: str | Source, over: str | None = None) -> tuple[Body, str]:
    """Return the body, and the name in ROBOTS of what it runs on: `over`, or else what the robot file says.

    Raises as `body_of`, and ValueError for another `over`.
    """
    if over is not None and over not in ROBOTS:
        raise ValueError(f"over must be {' or '.join(map(repr, ROBOTS))}, not {over!r}")
    body = body_of(robot)
    return body, over or (robot if robot in ROBOTS else body.over)


def runs_in_real_time(body: Body, over: str, simulate: Sequence[str] = ()) -> bool:
    """Return whether it takes no other speed: it is remote, or has real devices, which `simulate` doesn't name.

    See btlang.components.device_robot.
    """
    if over != "devices":
        return over != "simulated"
    real = (device for device in body.devices if device.driver != "simulated")
    return ALL not in simulate and any(not {device.name, device.kind} & set(simulate) for device in real)


class Connector(Record):
    """A function that connects a robot in a world to what it runs on: `over`, a name in ROBOTS."""

    body: Body
    over: str
    options: Mapping[str, Any] = {}

    def __call__(self, world: World) -> Connection:
        """Connect. Raises MissionError if the robot can't be reached."""
        connect = partial(import_function(ROBOTS[self.over]), world, body=self.body, **self.options)
        connection: Connection
        if self.body.components or self.body.devices:
            connection = import_function(COMPONENTS)(connect, self.body)
        else:
            connection = connect()
        return connection


def connector(robot: str | Source, over: str | None = None, **options: Any) -> Connector:
    """Return the connector of a robot. The options are for one that isn't simulated. Raises as `runs_on`."""
    body, name = runs_on(robot, over)
    return Connector(body, name, {} if name == "simulated" else options)
