"""A server with --ros, a real node, and clients that speak as roslibjs does; what they may, and what they may not."""

from __future__ import annotations

import json
import os
import shutil
import signal
import tempfile
import time
from argparse import ArgumentTypeError
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from pathlib import Path
from socket import SHUT_RDWR
from typing import Any

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection

pytest.importorskip("rclpy", reason="ROS 2 is not installed")
from geometry_msgs.msg import Twist
from sensor_msgs.msg import Image, LaserScan
from std_msgs.msg import ByteMultiArray, String
from std_srvs.srv import SetBool

from btlang.cli.values import ros_name
from btlang.diagnostics.diagnostic import MissionError
from btlang.ros.available import require_package
from btlang.ros.goals import GoalServer, HeldGoal
from btlang.ros.lease import Leases
from tests.profiles import only_long
from tests.ros.client import LATCHED, Client
from tests.ros.conftest import _found, _interfaces, _isolated  # noqa: F401
from tests.ros.domains import free_domain
from tests.server.bridge_client import Page
from tests.server.doors import Door, child_of, close_code
from tests.task.layers import wait_until

EVIL = "https://evil.example"
HUNG_UP = (1009, 1006)  # the second one where the server was gone before all was sent


class Robot(Client):
    """A node with a service, a latched topic and an action whose goals run until they are cancelled."""

    def __init__(self, domain: int, action: Any) -> None:
        super().__init__(domain)
        self.action = action
        self.goals: list[HeldGoal] = []
        self.cancelled: list[HeldGoal] = []
        self.node.create_service(SetBool, "/demo/switch", self._switch)
        self.node.create_publisher(String, "/demo/name", LATCHED).publish(String(data="Ada"))
        self.driven = self.hear(Twist, "/demo/cmd_vel")
        GoalServer(self.node, action, "/demo/go", self._begin, Leases(self.node))

    def _switch(self, request: Any, response: Any) -> Any:
        response.success, response.message = request.data, "switched"
        return response

    def _begin(self, goal: HeldGoal) -> Any:
        self.goals.append(goal)
        goal.publish_feedback(self.action.Feedback(distance_remaining=2.5))

        def cancel(reason: str) -> None:
            self.cancelled.append(goal)
            goal.end(False, self.action.Result(error_msg=reason))

        return cancel


@pytest.fixture(scope="module")
def robot() -> Iterator[Robot]:
    if not _found("nav2_msgs.action"):
        pytest.skip("nav2_msgs is not installed and cannot be compiled")
    from nav2_msgs.action import NavigateToPose

    with free_domain() as domain, pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DOMAIN_ID", str(domain))
        with closing(Robot(domain, NavigateToPose)) as robot:
            yield robot


@pytest.fixture(scope="module")
def door(robot: Robot) -> Iterator[Door]:
    """It lets /demo/... through, for a viewer and an operator with tokens."""
    with new_door("--ros", "/demo/*") as door:
        door.user("add", "vic")
        door.user("add", "olga", "--role", "operator")
        door.tokens = {name: door.user("token", name, "page") for name in ("vic", "olga")}  # type: ignore[attr-defined]
        yield door
    assert "Traceback" not in "".join(door.lines)


@contextmanager
def new_door(*options: str) -> Iterator[Door]:
    folder = Path(tempfile.mkdtemp(prefix="bt"))
    (folder / "btlang").mkdir(mode=0o700)
    try:
        with closing(Door(folder, *options)) as door:
            yield door
    finally:
        shutil.rmtree(folder, ignore_errors=True)


@pytest.fixture
def olga(door: Door) -> Iterator[Page]:
    with door.socket("/api/rosbridge") as socket:
        yield Page(socket, door.tokens["olga"])  # type: ignore[attr-defined]


@pytest.fixture
def vic(door: Door) -> Iterator[Page]:
    with door.socket("/api/rosbridge") as socket:
        yield Page(socket, door.tokens["vic"])  # type: ignore[attr-defined]


def test_a_page_listens_drives_calls_and_sends_a_goal(door: Door, olga: Page, robot: Robot) -> None:
    olga.send("subscribe", topic="/demo/name", type="std_msgs/String", compression="none", throttle_rate=0)
    olga.send("advertise", topic="/demo/cmd_vel", type="geometry_msgs/Twist", latch=False, queue_size=100)
    assert olga.wait(op="publish", topic="/demo/name")["msg"] == {"data": "Ada"}
    call = olga.send("call_service", service="/demo/switch", args={"data": True})
    answer = olga.wait(op="service_response", id=call)
    assert (answer["service"], answer["result"]) == ("/demo/switch", True)
    assert answer["values"] == {"success": True, "message": "switched"}
    olga.send("publish", topic="/demo/cmd_vel", msg={"linear": {"x": 0.5}})
    assert robot.driven.wait(lambda twist: twist.linear.x).angular.z == 0.0
    goal = {"pose": {"header": {"frame_id": "map"}, "pose": {"position": {"x": 3, "y": 1.5}}}}
    wanted = {"action": "/demo/go", "action_type": "nav2_msgs/action/NavigateToPose", "args": goal, "feedback": True}
    id = olga.send("send_action_goal", **wanted)
    assert olga.wait(op="action_feedback", id=id)["values"]["distance_remaining"] == 2.5
    begun = robot.goals[-1].request.pose
    assert (begun.pose.position.x, begun.header.frame_id, begun.header.stamp.sec > 0) == (3.0, "map", True)
    olga.send("cancel_action_goal", action="/demo/go", id=id)
    result = olga.wait(op="action_result", id=id)
    assert (result["result"], result["status"], result["values"]["error_msg"]) == (False, 5, "it was cancelled")
    olga.send("send_action_goal", **wanted)
    wait_until(lambda: robot.goals[-1].request.pose is not begun)
    robot.goals[-1].end(True, robot.action.Result())
    assert olga.wait(op="action_result", result=True)["status"] == 4
    assert "rclpy" not in Path(f"/proc/{door.process.pid}/maps").read_text()
    assert "rclpy" in Path(f"/proc/{child_of(door.process.pid)}/maps").read_text()


def test_who_is_not_logged_in_gets_nothing(door: Door) -> None:
    cookie = door.log_in("olga")["cookie"]
    for first in ('{"op": "subscribe", "topic": "/demo/name"}', '{"op": "auth", "mac": "btl_wrong"}', "x", "[]"):
        with door.socket("/api/rosbridge") as socket:
            socket.send(first)
            assert "Log in first" in json.loads(socket.recv())["msg"]
            assert close_code(socket) == 4003
    with pytest.raises(InvalidStatus):
        door.socket("/api/rosbridge", cookie=cookie, origin=EVIL)
    with door.socket("/api/rosbridge", cookie=cookie) as socket:
        page = Page(socket)
        page.send("auth", mac="")
        assert page.wait(op="status", level="info")["msg"] == "You're logged in as olga."


def test_a_viewer_only_listens(door: Door, vic: Page, robot: Robot) -> None:
    before = len(robot.driven.messages), len(robot.goals)
    vic.send("subscribe", topic="demo/name")
    assert vic.wait(op="publish", topic="demo/name")["msg"] == {"data": "Ada"}  # called as it was asked for
    assert "Only operators" in vic.refused("advertise", topic="/demo/cmd_vel", type="geometry_msgs/Twist")
    assert "Only operators" in vic.refused("publish", topic="/demo/cmd_vel", msg={"linear": {"x": 9.0}})
    assert "Only operators" in vic.refused("call_service", service="/demo/switch", args={"data": True})
    assert vic.wait(op="service_response")["result"] is False
    assert "Only operators" in vic.refused(
        "send_action_goal", action="/demo/go", action_type="nav2_msgs/NavigateToPose"
    )
    answer = vic.wait(op="action_result")
    assert (answer["result"], answer["status"]) == (False, 0)
    assert (len(robot.driven.messages), len(robot.goals)) == before
    assert any(line.endswith("vic from 127.0.0.1: publish /demo/cmd_vel: refused") for line in trail(door))


NOT_ALLOWED = (
    "/other", "/demo", "/demo/../other", "/demo/name\n", "/demo/na\nme", "/demo//name", "~/name", "/demo/{node}", "", 7,
    "/demo/go/_action/send_goal", "/demo/" + "x" * 300, "/demo/né", "/Demo/name", None, ["/demo/name"],
)  # fmt: skip


def test_other_names_are_refused(door: Door, olga: Page) -> None:
    for name in NOT_ALLOWED:
        for op, field in (("subscribe", "topic"), ("publish", "topic"), ("call_service", "service")):
            assert olga.refused(op, **{field: name, "type": "std_msgs/String", "msg": {}}), name
    assert any(line.endswith("olga from 127.0.0.1: subscribe /other: refused") for line in trail(door))
    assert not any(line.startswith("me") for line in trail(door))


WRONG_TYPES = {
    "os/msg/Path": "no package of interfaces", "antigravity/Fly": "no package of interfaces", "../x": "isn't a type",
    "no_such_msgs/msg/Thing": "no package of interfaces", "os/path": "isn't a type", "x\ny/msg/Z": "isn't a type",
    "std_msgs/msg/Strin": "no type", "std_srvs/srv/SetBool": "isn't a type of messages", 7: "isn't a type",
}  # fmt: skip


def test_what_cannot_be_read_is_said(olga: Page) -> None:
    for text in ("x", "[]", "{", '{"op": 7}', '{"op": ["subscribe"]}', '{"op": "fragment"}', '{"a":' * 40_000):
        olga.socket.send(text)
        assert olga.wait(op="status", level="error")["msg"]
    olga.socket.send('{"op": "subscribe", "topic": "/demo/name", "id": {}}')
    assert "'id' must be" in olga.wait(op="status", level="error")["msg"]
    listen: dict[str, Any] = {"topic": "/demo/other"}
    for kind, reason in WRONG_TYPES.items():
        assert reason in olga.refused("subscribe", **listen, type=kind)
    assert "is of the type" in olga.refused("subscribe", topic="/demo/name", type="std_msgs/Int8")
    assert "throttle_rate" in olga.refused("subscribe", **listen, type="std_msgs/String", throttle_rate=-1)
    assert "compression" in olga.refused("subscribe", **listen, type="std_msgs/String", compression="png")
    olga.send("advertise", topic="/demo/cmd_vel", type="geometry_msgs/Twist")
    for fields in (
        {"linear": {"x": "fast"}}, {"linear": {"x": None}}, {"linear": {"x": float("inf")}}, {"linear": {"x": 10**400}},
        {"linear": {"x": True}}, {"linear": [1, 2, 3, 4]}, {"linaer": {}}, {"__class__": {}}, "x", 7,
    ):  # fmt: skip
        assert olga.refused("publish", topic="/demo/cmd_vel", msg=fields), fields
    assert "haven't subscribed" in olga.refused("unsubscribe", topic="/demo/cmd_vel")
    assert "haven't advertised" in olga.refused("unadvertise", topic="/demo/name")
    assert "has this id" in olga.refused("cancel_action_goal", action="/demo/go")
    assert "can't hold" in olga.refused("call_service", service="/demo/switch", args={"data": 1})
    assert olga.wait(op="service_response")["result"] is False


def test_numbers_bytes_and_throttling(vic: Page, robot: Robot) -> None:
    scans = robot.node.create_publisher(LaserScan, "/demo/scan", 10)
    sounds = robot.node.create_publisher(ByteMultiArray, "/demo/sound", 10)
    vic.send("subscribe", topic="/demo/scan", type="sensor_msgs/LaserScan", throttle_rate=300, queue_length=1)
    vic.send("subscribe", topic="/demo/sound", type="std_msgs/ByteMultiArray")
    wait_until(lambda: scans.get_subscription_count() and sounds.get_subscription_count())
    time.sleep(0.5)  # until it has fitted to these publishers
    for number in range(20):
        scans.publish(LaserScan(range_max=float(number), ranges=[1.0, float("nan"), float("inf")]))
        time.sleep(0.02)
    heard = [vic.wait(op="publish", topic="/demo/scan")["msg"]]
    while heard[-1]["range_max"] < 19.0:
        heard.append(vic.wait(op="publish", topic="/demo/scan")["msg"])
    assert len(heard) <= 5
    assert heard[0]["ranges"] == [1.0, None, None]
    sounds.publish(ByteMultiArray(data=[b"\x01", b"\xff"]))
    assert vic.wait(op="publish", topic="/demo/sound")["msg"]["data"] == "Af8="
    for publisher in (scans, sounds):
        robot.node.destroy_publisher(publisher)


def test_messages_that_are_too_big(vic: Page, robot: Robot) -> None:
    images = robot.node.create_publisher(Image, "/demo/image", LATCHED)
    images.publish(Image(data=bytes(300_000)))
    vic.send("subscribe", topic="/demo/image")
    assert "262,144" in vic.wait(op="status")["msg"]
    images.publish(Image(data=b"abc"))
    assert vic.wait(op="publish")["msg"]["data"] == "YWJj"
    robot.node.destroy_publisher(images)
    with suppress(ConnectionClosed):
        vic.send("publish", topic="/demo/name", msg={"data": "x" * 300_000})
    assert close_code(vic.socket) in HUNG_UP


def test_a_goal_ends_with_who_sent_it(door: Door, robot: Robot) -> None:
    before = len(robot.cancelled)
    for number, leave in enumerate((ClientConnection.close, lambda socket: socket.socket.close())):
        with door.socket("/api/rosbridge") as socket:
            page = Page(socket, door.tokens["olga"])  # type: ignore[attr-defined]
            page.send("send_action_goal", action="/demo/go", action_type="nav2_msgs/NavigateToPose", feedback=True)
            page.wait(op="action_feedback")
            leave(socket)
        wait_until(lambda: len(robot.cancelled) > before + number)  # noqa: B023


def test_who_is_revoked_is_out_at_once(door: Door, robot: Robot) -> None:
    token, count = door.user("token", "olga", "short"), len(robot.cancelled)
    with door.socket("/api/rosbridge", authorization=f"Bearer {token}") as socket:
        page = Page(socket)
        page.send("send_action_goal", action="/demo/go", action_type="nav2_msgs/NavigateToPose", feedback=True)
        page.wait(op="action_feedback")
        door.user("revoke", "olga", "short")
        assert close_code(socket) == 4001
    wait_until(lambda: len(robot.cancelled) == count + 1)


def test_the_last_message_of_who_leaves_is_heard(door: Door, robot: Robot) -> None:
    with door.socket("/api/rosbridge") as socket:
        page = Page(socket, door.tokens["olga"])  # type: ignore[attr-defined]
        page.send("advertise", topic="/demo/cmd_vel", type="geometry_msgs/Twist")
        heard = len(robot.driven.messages)
        while len(robot.driven.messages) == heard:  # until the node has found it
            page.send("publish", topic="/demo/cmd_vel", msg={"linear": {"x": 1.0}})
            time.sleep(0.05)
        page.send("publish", topic="/demo/cmd_vel", msg={"linear": {"x": 0.125}})
    robot.driven.wait(lambda twist: twist.linear.x == 0.125)


def test_ros_that_cannot_start(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", "500")
    with new_door("--ros", "*", "--no-tls") as door:
        door.user("add", "vic")
        with door.socket("/api/rosbridge", authorization=f"Bearer {door.user('token', 'vic', 'page')}") as socket:
            assert "ROS_DOMAIN_ID must be from 0 to" in Page(socket).wait(op="status")["msg"]
            assert close_code(socket) == 1011


def test_what_btc_serve_is_not_started_with() -> None:
    with pytest.raises(ArgumentTypeError, match="begins with /"):
        ros_name("cmd_vel")
    with pytest.raises(MissionError, match="no Python package no_such_package"):
        require_package("no_such_package")


def test_so_many_subscriptions_and_no_more(olga: Page) -> None:
    ids = [olga.send("subscribe", topic=f"/demo/topic{number}", type="std_msgs/String") for number in range(1000)]
    for _ in range(900):
        assert "is the most" in olga.wait(op="status")["msg"]
    olga.send("unsubscribe", topic="/demo/topic0", id=ids[0])
    olga.send("subscribe", topic="/demo/name")
    assert olga.wait(op="publish")["msg"] == {"data": "Ada"}


@only_long
def test_a_bridge_that_dies_is_started_again(door: Door, vic: Page) -> None:
    vic.send("subscribe", topic="/demo/name")
    vic.wait(op="publish")
    os.kill(child_of(door.process.pid), signal.SIGKILL)
    assert "has ended" in vic.wait(op="status")["msg"]
    assert close_code(vic.socket) == 1011
    with door.socket("/api/rosbridge") as socket:
        again = Page(socket, door.tokens["vic"])  # type: ignore[attr-defined]
        again.send("subscribe", topic="/demo/name")
        assert again.wait(op="publish")["msg"] == {"data": "Ada"}


@only_long
def test_a_slow_client_delays_nobody(door: Door, vic: Page, robot: Robot) -> None:
    words = robot.node.create_publisher(String, "/demo/words", 10)
    with door.socket("/api/rosbridge") as socket:
        slow = Page(socket, door.tokens["vic"])  # type: ignore[attr-defined]
        for page in (slow, vic):
            page.send("subscribe", topic="/demo/words", type="std_msgs/String", queue_length=1)
        wait_until(lambda: words.get_subscription_count() == 2)
        time.sleep(0.5)
        began = time.monotonic()
        for number in range(200):  # more than the buffers on the way hold
            words.publish(String(data=f"{number} " + "x" * 100_000))
            assert vic.wait(op="publish")["msg"]["data"].split()[0] == str(number)
        assert time.monotonic() - began < 5
        socket.socket.shutdown(SHUT_RDWR)
    robot.node.destroy_publisher(words)


@only_long
def test_the_bridge_ends_with_the_server(robot: Robot) -> None:
    with new_door("--ros", "*", "--no-tls") as door:
        door.user("add", "olga", "--role", "operator")
        with door.socket("/api/rosbridge", authorization=f"Bearer {door.user('token', 'olga', 'page')}") as socket:
            page = Page(socket)
            page.send("send_action_goal", action="/demo/go", action_type="nav2_msgs/NavigateToPose", feedback=True)
            page.wait(op="action_feedback")
            child, count = child_of(door.process.pid), len(robot.cancelled)
            door.process.kill()
            wait_until(lambda: len(robot.cancelled) == count + 1)
            wait_until(lambda: not Path(f"/proc/{child}").exists())


def trail(door: Door) -> list[str]:
    """What `btc user trail` shows."""
    return door.user("trail").splitlines()
