"""Docking as Nav2 does it: /dock_robot and /undock_robot of `btc sim-ros`, and missions that use them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from action_msgs.msg import GoalStatus
from std_msgs.msg import Bool

pytest.importorskip("nav2_msgs.action._dock_robot", reason="nav2_msgs with docking is not installed")

from nav2_msgs.action import DockRobot, UndockRobot

from btlang.ros.robot.navigation import GoalTask, ServerGoal
from btlang.ros.robot.power import _DOCKING
from tests.ros.client import LATCHED, Client, Goal
from tests.ros.processes import LONG, Command

HALL = """
start = { x = 1.5, y = 1.5 }
dock = { x = 0.4, y = 0.6, facing = 180 }
walls = [[[0, 0], [6, 0], [6, 4], [0, 4], [0, 0]]]
"""
FAULT = 'faults = [{ kind = "dock", times = 3 }]\n'


@pytest.fixture
def hall(tmp_path: Path) -> Path:
    path = tmp_path / "hall.toml"
    path.write_text(HALL, encoding="utf-8")
    return path


def test_the_definitions_are_those_of_nav2() -> None:
    assert DockRobot.Goal.get_fields_and_field_types() == {
        "use_dock_id": "boolean",
        "dock_id": "string",
        "dock_pose": "geometry_msgs/PoseStamped",
        "dock_type": "string",
        "max_staging_time": "float",
        "navigate_to_staging_pose": "boolean",
    }
    assert (DockRobot.Goal().use_dock_id, DockRobot.Goal().navigate_to_staging_pose) == (True, True)
    assert DockRobot.Result.get_fields_and_field_types() == {
        "success": "boolean",
        "error_code": "uint16",
        "num_retries": "uint16",
        "error_msg": "string",
    }
    assert DockRobot.Feedback.get_fields_and_field_types() == {
        "state": "uint16",
        "docking_time": "builtin_interfaces/Duration",
        "num_retries": "uint16",
    }
    codes = ("DOCK_NOT_IN_DB", "DOCK_NOT_VALID", "FAILED_TO_STAGE", "FAILED_TO_DETECT_DOCK", "FAILED_TO_CONTROL")
    assert [getattr(DockRobot.Result, code) for code in codes] == [901, 902, 903, 904, 905]
    assert (DockRobot.Result.FAILED_TO_CHARGE, DockRobot.Result.UNKNOWN, DockRobot.Result.NONE) == (906, 999, 0)
    states = ("NONE", "NAV_TO_STAGING_POSE", "INITIAL_PERCEPTION", "CONTROLLING", "WAIT_FOR_CHARGE", "RETRY")
    assert [getattr(DockRobot.Feedback, state) for state in states] == [0, 1, 2, 3, 4, 5]
    assert UndockRobot.Goal.get_fields_and_field_types() == {"dock_type": "string", "max_undocking_time": "float"}
    assert UndockRobot.Result.get_fields_and_field_types() == {
        "success": "boolean",
        "error_code": "uint16",
        "error_msg": "string",
    }


class Done:
    """A future with its result."""

    def __init__(self, value: Any) -> None:
        self._value = value

    def done(self) -> bool:
        return True

    def result(self) -> Any:
        return self._value

    def add_done_callback(self, call: Callable[[Done], object]) -> None:
        call(self)


@pytest.mark.parametrize(
    ("code", "message", "retries", "reason"),
    [
        (904, "", 0, "the dock wasn't detected"),
        (906, "", 3, "the robot is in the dock, but doesn't charge (3 retries)"),
        (906, "no current", 1, "no current (1 retry)"),
        (999, "", 0, "the docking server gave up on the way into the dock"),
    ],
)
def test_error_codes_are_reasons(code: int, message: str, retries: int, reason: str) -> None:
    result = SimpleNamespace(error_code=code, error_msg=message, num_retries=retries)
    answer = Done(SimpleNamespace(status=GoalStatus.STATUS_ABORTED, result=result))
    handle = Done(SimpleNamespace(accepted=True, get_result_async=lambda: answer))
    client = SimpleNamespace(server_is_ready=lambda: True, send_goal_async=lambda *_, **__: handle)
    task = GoalTask("docking", "dock", "docking", "dock", " on the way into the dock", _DOCKING, False)
    goal = ServerGoal(
        task, client, "/dock_robot", DockRobot.Goal(), None, lambda work: work(), lambda: None, lambda: 0.0
    )
    goal.step()
    goal.step()
    assert goal.failure == reason


def test_a_mission_docks_by_the_docking_server(
    hall: Path, tmp_path: Path, domain: int, start_sim: Callable[..., Command]
) -> None:
    hall.write_text(HALL + FAULT, encoding="utf-8")
    start_sim("--world", str(hall), "--speed", "4")
    mission = 'dock, otherwise say "broken"; dock then undock'
    options = ("--world", str(hall), "--robot", "ros", "--sim-time", "--lines")
    command = Command(tmp_path, domain, "run", "-c", mission, *options)
    assert command.process.wait(2 * LONG) == 0, command.err
    assert "failed dock: the dock doesn't connect (2 retries)" in command.out
    told = [line.split(maxsplit=1)[1] for line in command.out.splitlines() if "dock" in line]
    assert [line for line in told if line.startswith("done")] == ["done   dock", "done   undock"]


class OldSimulator(Command):
    """`btc sim-ros` without a docking server."""

    program = (
        "-c",
        "import sys; sys.modules['btlang.ros.simulator.docking'] = None\n"
        "from btlang.__main__ import main; sys.exit(main())",
    )


@pytest.mark.long
def test_without_a_docking_server_the_services_do(hall: Path, tmp_path: Path, domain: int) -> None:
    (tmp_path / "sim").mkdir()
    sim = OldSimulator(tmp_path / "sim", domain, "sim-ros", "--world", str(hall), "--speed", "4")
    sim.wait_for("ready")
    options = ("--world", str(hall), "--robot", "ros", "--sim-time", "--lines")
    command = Command(tmp_path, domain, "run", "-c", "dock then undock", *options)
    assert command.process.wait(2 * LONG) == 0, command.err
    assert "done   undock" in command.out
    assert sim.end() == 130


@pytest.mark.long
def test_the_preflight_lists_the_docking_server(
    hall: Path, tmp_path: Path, domain: int, start_sim: Callable[..., Command]
) -> None:
    start_sim("--world", str(hall))
    options = ("--world", str(hall), "--robot", "ros", "--preflight")
    command = Command(tmp_path, domain, "run", "-c", "dock", *options)
    assert command.process.wait(2 * LONG) == 0, command.err
    assert "/dock_robot" in command.out
    assert "/docked" in command.out
    assert "std_srvs/srv/Trigger" not in command.out


@pytest.mark.long
def test_a_halted_dock_is_cancelled(hall: Path, tmp_path: Path, domain: int, start_sim: Callable[..., Command]) -> None:
    start_sim("--world", str(hall), "--speed", "4")
    options = ("--world", str(hall), "--robot", "ros", "--sim-time", "--lines")
    mission = "dock within 6 s, otherwise say late; wait 3 s; check that the robot is docked"
    command = Command(tmp_path, domain, "run", "-c", mission, *options)
    assert command.process.wait(2 * LONG) == 1, command.err
    assert "halted dock" in command.out


@pytest.mark.long
def test_what_the_server_tells(hall: Path, start_sim: Callable[..., Command], client: Client) -> None:
    hall.write_text(HALL + FAULT, encoding="utf-8")
    start_sim("--world", str(hall), "--speed", "4")
    docked = client.hear(Bool, "/docked", LATCHED)
    server = client.action(DockRobot, "/dock_robot")

    def ended(goal: Goal) -> tuple[int, int, str, int]:
        answer = goal.result()
        assert answer.result.success is (answer.status == GoalStatus.STATUS_SUCCEEDED)
        return answer.status, answer.result.error_code, answer.result.error_msg, answer.result.num_retries

    aborted, succeeded = GoalStatus.STATUS_ABORTED, GoalStatus.STATUS_SUCCEEDED
    unknown = Goal(client, server, DockRobot.Goal(dock_id="home"))
    assert ended(unknown) == (aborted, 901, 'there is no dock "home", only "dock"', 0)
    elsewhere = DockRobot.Goal(use_dock_id=False)
    elsewhere.dock_pose.header.frame_id, elsewhere.dock_pose.pose.position.x = "map", 5.0
    assert ended(Goal(client, server, elsewhere)) == (aborted, 904, "there is no dock at (5.00, 0.00)", 0)
    from_here = DockRobot.Goal(dock_id="dock", navigate_to_staging_pose=False)
    assert ended(Goal(client, server, from_here)) == (aborted, 903, "the robot isn't in front of the dock", 0)

    failing = Goal(client, server, DockRobot.Goal(dock_id="dock"))
    assert ended(failing) == (aborted, 906, "the dock doesn't connect", 2)
    states = [message.state for message in failing.feedback.messages]
    assert states == [1, 3, 4, 5, 3, 4, 5, 3, 4]
    assert [message.num_retries for message in failing.feedback.messages][-1] == 2
    assert ended(Goal(client, server, DockRobot.Goal(dock_id="dock"))) == (succeeded, 0, "", 0)
    docked.wait(lambda message: message.data)

    leaving = client.action(UndockRobot, "/undock_robot")
    assert Goal(client, leaving, UndockRobot.Goal()).result().status == succeeded
    docked.wait(lambda message: not message.data)
    again = Goal(client, server, DockRobot.Goal(dock_id="dock"))
    again.feedback.wait(lambda message: message.state == 3)
    assert again.cancel() == 1
    assert ended(again)[0] == GoalStatus.STATUS_CANCELED
