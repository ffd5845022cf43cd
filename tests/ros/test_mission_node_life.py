"""The lifecycle of `btc ros-node`: what a lifecycle manager does with it, and how its own mission goes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState, GetState
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from std_srvs.srv import Trigger

from tests.ros.client import Client
from tests.ros.processes import Command, wait_until
from tests.ros.test_mission_node import FAR, mission

CONFIGURE, CLEANUP = Transition.TRANSITION_CONFIGURE, Transition.TRANSITION_CLEANUP
ACTIVATE, DEACTIVATE = Transition.TRANSITION_ACTIVATE, Transition.TRANSITION_DEACTIVATE
SHUTDOWN = Transition.TRANSITION_UNCONFIGURED_SHUTDOWN


def change(client: Client, number: int) -> bool:
    request = {"transition": Transition(id=number)}
    return bool(client.call(ChangeState, "/btlang/change_state", **request).success)


def state(client: Client) -> str:
    return str(client.call(GetState, "/btlang/get_state").current_state.label)


def set_mission(client: Client, text: str) -> None:
    value = ParameterValue(type=ParameterType.PARAMETER_STRING, string_value=text)
    client.call(SetParameters, "/btlang/set_parameters", parameters=[Parameter(name="mission", value=value)])


def test_all_transitions(start_node, client: Client, run_mission: Any):
    node = start_node("--no-autostart")
    assert state(client) == "unconfigured"
    assert not any(change(client, number) for number in (ACTIVATE, DEACTIVATE, CLEANUP, 99))
    assert client.call(Trigger, "/btlang/stop").success  # for when there is a robot
    set_mission(client, "move forwarrd")
    assert not change(client, CONFIGURE)
    assert state(client) == "unconfigured"
    wait_until(lambda: "mission:1:1: error BT010" in node.err, "why it is not configured")
    set_mission(client, FAR)
    assert change(client, CONFIGURE)
    assert client.call(Trigger, "/btlang/status").message.startswith("The robot is stopped: emergency stop by ROS 2")
    assert client.call(Trigger, "/btlang/release").success
    assert not mission(client, run_mission, "say hello").accepted
    wait_until(lambda: "mission rejected: the node is not active" in node.err, "why it is rejected")
    for _ in range(2):  # each activation runs the mission from its start
        before = node.out.count("start  move forward")
        assert change(client, ACTIVATE)
        wait_until(lambda before=before: node.out.count("start  move forward") > before, "the mission")
        goal = mission(client, run_mission, "say hello")
        goal.feedback.wait()
        assert change(client, DEACTIVATE)
        assert state(client) == "inactive"
        assert goal.result().result.reason == "the node was deactivated"
        told = 2 * before + 2
        wait_until(lambda told=told: node.out.count(": the node was deactivated") == told, "both ends on the log")
    assert change(client, CLEANUP)
    assert change(client, SHUTDOWN)
    assert state(client) == "finalized"


def test_its_own_mission(start_node, client: Client, run_mission: Any, tmp_path: Path):
    file = tmp_path / "hello.txt"
    file.write_text("say hello\n", encoding="utf-8")
    node = start_node("--speed", "10", "--mission", str(file))
    node.wait_for("the mission succeeded after")
    assert state(client) == "active"
    assert mission(client, run_mission, 'say "again"').result().result.success


def test_a_mission_that_cannot_be_read(tmp_path: Path, domain: int, run_mission: Any):
    node = Command(tmp_path, domain, "ros-node", "--mission", "nowhere.txt")
    assert node.process.wait(20) == 2
    assert "nowhere.txt" in node.err
    assert "Traceback" not in node.err


def test_arguments_of_ros(start_node, client: Client, run_mission: Any):
    node = start_node("--speed", "10", "--ros-args", "-p", "mission:=say hello")
    node.wait_for("the mission succeeded after")
