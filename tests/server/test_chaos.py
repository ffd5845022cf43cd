"""Whatever goes wrong around a server, the robot is stopped within a second, and all is as before afterwards."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from tests.profiles import amount
from tests.server import chaos
from tests.server.chaos import Fault, World
from tests.task.layers import wait_until

SHORT = (chaos.no_descriptors, chaos.full_disk, chaos.hung_server)


@pytest.fixture(scope="module")
def world() -> Iterator[World]:
    with tempfile.TemporaryDirectory(prefix="bt") as folder, closing(World(Path(folder))) as world:
        yield world
    assert not any("Traceback" in line for line in world.door.lines)


@pytest.mark.long
@pytest.mark.parametrize("fault", chaos.HARMLESS if amount(0, 1) else SHORT, ids=lambda fault: fault.__name__)
def test_a_robot_is_stopped_within_a_second(world: World, fault: Fault) -> None:
    world.door.ask("GET", "/metrics", **world.ann)
    before = world.door.memory
    with fault(world):
        for _ in range(amount(1, 3)):
            assert world.stop() < 1.0
            assert world.command("status")["data"]["stopped"]
            assert world.command("release")["ok"]
    wait_until(lambda: b'"up":true' in world.door.ask("GET", "/api/robots", **world.ann).body)
    wait_until(lambda: world.door.memory < 1.1 * before + 5, 30.0)
