"""Whatever a simulator's clock does, a run ends, and so it does when it is told to."""

from __future__ import annotations

import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from btlang.cli import main
from tests.profiles import cases
from tests.ros.declared import Peer
from tests.ros.processes import LONG, Command

RUN = "run", "-c", "move forward 100 m"
ENDS_IN = 2.0  # real seconds
FAULTS = ("backward", "standing", "slow", "twice")


@contextmanager
def driving(folder: Path, domain: int, fault: str, *options: str) -> Iterator[tuple[Command, Peer]]:
    """A long drive on a robot without a watchdog, from whose beginning on its clock lies."""
    peer = Peer("faulty_robot", f"clock={fault}@moving", domain=domain)
    peer.expect("ready")
    command = Command(folder, domain, *options, "--robot", "ros", "--sim-time")
    peer.expect("drive 0.5")
    yield command, peer
    peer.close()


@cases("fault", FAULTS, 1)
def test_a_time_limit_counts(fault: str, tmp_path: Path, domain: int) -> None:
    with driving(tmp_path, domain, fault, *RUN, "--for", "3s") as (command, peer):
        began = time.monotonic()
        peer.expect("drive 0.000 0.000")
        assert command.process.wait(10.0) in (0, 1), command.err
        assert time.monotonic() - began < 3.0 + ENDS_IN


@cases(("fault", "number", "code"), [(fault, *way) for fault in FAULTS for way in (
    (signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGQUIT, 131),
)], 2)  # fmt: skip
def test_it_ends_when_it_is_told_to(fault: str, number: signal.Signals, code: int, tmp_path: Path, domain: int) -> None:
    with driving(tmp_path, domain, fault, *RUN) as (command, peer):
        time.sleep(0.3)
        ends_after(command, peer, number, code)


@cases("number", [signal.SIGINT, signal.SIGTERM], 1)
@cases("fault", FAULTS, 1)
def test_a_robot_with_tasks_ends_too(fault: str, number: signal.Signals, tmp_path: Path, domain: int) -> None:
    mission = tmp_path / "mission.txt"
    mission.write_text("move forward 100 m", encoding="utf-8")
    with driving(tmp_path, domain, fault, "ros-node", "--mission", str(mission)) as (command, peer):
        time.sleep(1.5)  # the clock has failed by then
        ends_after(command, peer, number, 128 + number)


def ends_after(command: Command, peer: Peer, number: signal.Signals, code: int) -> None:
    """The base is stopped first."""
    began = time.monotonic()
    command.process.send_signal(number)
    peer.expect("drive 0.000 0.000")
    stopped = time.monotonic() - began
    assert command.process.wait(LONG) == code, command.err
    took = time.monotonic() - began
    command.end()
    print(f"stopped {stopped:.2f} ended {took:.2f}")
    assert stopped < 0.5
    assert took < ENDS_IN


def test_two_clocks_are_reported_before_a_run(
    domain: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    monkeypatch.setattr("btlang.ros.robot.connection._DISCOVERY", 2.0)  # nodes of tests announce themselves every 0.1 s
    peers = [Peer("faulty_robot", domain=domain) for _ in range(2)]
    for peer in peers:
        peer.expect("ready")
    assert main(["run", "--robot", "ros", "--sim-time", "-c", "move forward 1 m", "--preflight"]) == 0
    printed = capsys.readouterr().out
    for topic in ("/clock", "/odom"):
        assert f"warning: /faulty_robot and /faulty_robot publish {topic}, so it contradicts itself" in printed
    for peer in peers:
        peer.close()
