"""A server with a robot, shared by the tests of a file."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from btlang.task.layer import TaskLayer
from tests.server.cable import Cable
from tests.server.doors import Door, robot_in
from tests.server.elsewhere import Elsewhere, invited
from tests.task.layers import wait_until

ROLES = {"vic": "viewer", "olga": "operator", "ed": "editor", "ann": "administrator"}


@pytest.fixture(scope="module")
def robot() -> Iterator[TaskLayer]:
    folder = Path(tempfile.mkdtemp(prefix="bt"))
    try:
        with robot_in(folder) as layer:
            layer.folder = folder  # type: ignore[attr-defined]
            yield layer
    finally:
        shutil.rmtree(folder, ignore_errors=True)


@pytest.fixture(scope="module")
def door(robot: TaskLayer) -> Iterator[Door]:
    """With a user of each role, all with the same password."""
    with closing(Door(robot.folder)) as door:  # type: ignore[attr-defined]
        for name, role in ROLES.items():
            door.user("add", name, "--role", role)
        wait_until(lambda: door.ask("GET", "/api/robots", **door.log_in()).data["robots"][:1])
        yield door


@pytest.fixture(scope="module")
def cable(door: Door) -> Iterator[Cable]:
    with closing(Cable(door.port)) as cable:
        yield cable


@pytest.fixture(scope="module")
def joined(door: Door, cable: Cable) -> Iterator[Elsewhere]:
    code = invited(door, "kim")
    with closing(Elsewhere(cable.port, code)) as robot:
        yield robot
    shutil.rmtree(robot.folder)
