"""A program that dies lets go of the robot: the servers of its goals halt them, and they halt no others."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from nav_msgs.msg import Odometry
from std_msgs.msg import Empty
from unique_identifier_msgs.msg import UUID

from tests.ros.client import Client, Goal
from tests.ros.declared import Peer
from tests.ros.processes import LONG, ROOM, Command

SOON = 4.0  # seconds: a lease of one, the halt, and a machine that is busy


@pytest.fixture
def start(tmp_path: Path, domain: int) -> Iterator[Callable[..., Command]]:
    """Starts `btc`; a server is told to end, and says nothing on standard error."""
    started: list[Command] = []

    def start(*arguments: str) -> Command:
        folder = tmp_path / f"btc{len(started)}"
        folder.mkdir()
        started.append(Command(folder, domain, *arguments))
        return started[-1]

    yield start
    for command in reversed(started):
        command.end()


def killed(command: Command) -> float:
    """Kills a process; the time of its death."""
    os.killpg(command.process.pid, signal.SIGKILL)
    command.process.wait()
    return time.monotonic()


def test_a_journey_ends_with_its_client(
    start_sim: Callable[..., Command], start: Callable[..., Command], client: Client, nav2: Any
) -> None:
    start_sim("--speed", "1")
    odometry = client.hear(Odometry, "/odom")
    mission = start("run", "--robot", "ros", "-c", "go to the lab", "--world", str(ROOM))
    odometry.wait(lambda message: message.twist.twist.linear.x > 0.3)
    died = killed(mission)
    odometry.wait(lambda message: message.twist.twist.linear.x == 0.0 and message.twist.twist.angular.z == 0.0)
    assert time.monotonic() - died < SOON


def test_an_action_that_is_served_ends_with_its_client(start: Callable[..., Command], run_mission: object) -> None:
    server = start("serve-actions", "--only", "motion")
    server.wait_for("ready")
    mission = start("run", "--robot", "actions", "-c", "move forward 3 m at 0.1 meters per second")
    server.wait_for("start  move forward")
    died = killed(mission)
    server.wait_for("halted move forward")
    assert time.monotonic() - died < SOON
    several = "move forward 20 cm at 0.1 m/s then turn left 10 degrees then move backward 20 cm at 0.1 m/s"
    second = start("run", "--robot", "actions", "-c", several)  # longer goals than a lease, one after the other
    assert second.process.wait(LONG) == 0, second.err
    assert server.err == ""


def test_a_mission_ends_with_its_client(start_node: Callable[..., Command], domain: int, run_mission: object) -> None:
    node = start_node()
    peer = Peer("mission_client", "move forward 3 m at 0.1 meters per second", domain=domain)
    node.wait_for("start  move forward")
    peer.kill()
    died = time.monotonic()
    node.wait_for("halted move forward")
    assert time.monotonic() - died < SOON
    node.wait_for("the mission was stopped")
    assert "its client is gone" in node.out + node.err
    peer.close()


def test_a_client_without_a_lease_is_not_watched(
    start: Callable[..., Command], client: Client, run_mission: object
) -> None:
    from btlang_interfaces.action import RunPhrase

    server = start("serve-actions", "--only", "motion", "--speed", "5")
    server.wait_for("ready")
    request = RunPhrase.Goal(names=["distance", "speed"], values=["1.5 m", "0.1 m/s"])
    goal = Goal(client, client.action(RunPhrase, "/actions/move_forward"), request)
    assert goal.accepted
    assert goal.result().result.success


def test_a_client_of_whose_life_dds_says_nothing(
    start: Callable[..., Command], client: Client, run_mission: object
) -> None:
    """It is not taken for dead: it counts as gone when its publisher is."""
    from btlang_interfaces.action import RunPhrase

    server = start("serve-actions", "--only", "motion")
    server.wait_for("ready")
    goal_id = UUID(uuid=list(b"btc\x01" + bytes(range(12))))
    silent = client.begin(lambda: client.node.create_publisher(Empty, f"/_btlang/lease_{bytes(range(6)).hex()}", 1))
    request = RunPhrase.Goal(names=["distance", "speed"], values=["3 m", "0.1 m/s"])
    goal = Goal(client, client.action(RunPhrase, "/actions/move_forward"), request, goal_id)
    assert goal.accepted
    server.wait_for("start  move forward")
    time.sleep(2.5)
    assert "halted" not in server.out
    client.begin(lambda: client.node.destroy_publisher(silent))
    server.wait_for("halted move forward")


def test_a_client_that_is_held_up_keeps_its_goals(
    start_node: Callable[..., Command], domain: int, run_mission: object
) -> None:
    """No Python of it gets on for longer than the lease, which a thread of DDS asserts."""
    node = start_node()
    peer = Peer("mission_client", 'wait 4 s then say "done"', "2.5", domain=domain)
    peer.expect("held up", LONG)
    peer.expect("goes on", LONG)
    node.wait_for('says   "done"')
    assert "halted" not in node.out
    peer.close()
