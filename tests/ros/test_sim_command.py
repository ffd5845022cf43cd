"""How `btc sim-ros` begins and ends, and what it says where it cannot."""

from __future__ import annotations

import signal
import subprocess
import time

import pytest
from rosgraph_msgs.msg import Clock

from btlang.cli import main
from tests.profiles import amount
from tests.ros.client import Client
from tests.ros.processes import Command


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129)])
def test_a_signal_ends_it(start_sim, number: signal.Signals, code: int):
    # without the guard the wheels start Python anew, as they do in a terminal; the process stays the same
    sim = start_sim(_ROS_WHEELS_BOOTSTRAP_COMPLETE=None) if number == signal.SIGTERM else start_sim()
    assert sim.end(number) == code
    assert sim.err == ""
    assert sim.out.count("\n") == 1


@pytest.mark.long
def test_some_in_a_row_leave_nothing(start_sim, client: Client):
    for _ in range(amount(2, 5)):
        sim = start_sim()
        clock = client.hear(Clock, "/clock")
        clock.wait()
        assert sim.end() == 130
    assert client.node.count_publishers("/clock") in (0, 1)  # the last one may not have been noticed to be gone


class Begun(Command):
    """`btc`, which says when it begins: a signal before, while Python itself starts, is none of its business."""

    program = ("-c", "import sys; from btlang.__main__ import main; print('begun', flush=True); sys.exit(main())")


def test_a_signal_while_it_starts(tmp_path, domain: int):
    for milliseconds in (50, 250, 500):
        folder = tmp_path / str(milliseconds)
        folder.mkdir()
        sim = Begun(folder, domain, "sim-ros")
        sim.wait_for("begun")
        with pytest.raises(subprocess.TimeoutExpired):
            sim.process.wait(milliseconds / 1000)
        assert sim.end(signal.SIGINT) in (130, -signal.SIGINT)
        assert "Traceback" not in sim.err


def test_a_domain_that_cannot_be(tmp_path, domain: int):
    sim = Command(tmp_path, domain, "sim-ros", ROS_DOMAIN_ID="kitchen")
    assert sim.process.wait(20) == 2
    assert "error BT100: ROS 2 can't be used: " in sim.err
    assert "Traceback" not in sim.err


def test_a_world_that_cannot_be(capsys: pytest.CaptureFixture[str]):
    assert main(["sim-ros", "--world", "nowhere.toml"]) == 2
    assert "BT070" in capsys.readouterr().err


@pytest.mark.parametrize(
    "options", [["--speed", "max"], ["--speed", "0"], ["--rate", "0"], ["--namespace", "a//b"], ["--namespace", "1a"]]
)
def test_wrong_options(options: list[str], capsys: pytest.CaptureFixture[str]):
    with pytest.raises(SystemExit) as caught:
        main(["sim-ros", *options])
    assert caught.value.code == 2
    assert "Run 'btc help sim-ros'" in capsys.readouterr().err


class WithoutNav2(Command):
    """`btc` where nav2_msgs is not installed."""

    program = ("-c", "import sys; sys.modules['nav2_msgs'] = None; from btlang.cli import main; sys.exit(main())")


def test_without_nav2_it_does_all_the_rest(tmp_path, domain: int, client: Client):
    sim = WithoutNav2(tmp_path, domain, "sim-ros")
    sim.wait_for("ready")
    client.hear(Clock, "/clock").wait()
    assert sim.end() == 130
    assert sim.err == "btlang sim-ros: no /navigate_to_pose: the package nav2_msgs is not installed\n"


def test_a_signal_does_not_wait_for_the_next_step(start_sim):
    sim = start_sim("--rate", "1", "--speed", "0.05")  # a step takes 20 s
    began = time.monotonic()
    assert sim.end() == 130
    assert time.monotonic() - began < 5
