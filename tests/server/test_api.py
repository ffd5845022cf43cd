"""The API as a program and a page use it: log-in, commands, missions, roles, what happens."""

from __future__ import annotations

import json
from typing import Any

import pytest
from websockets.exceptions import InvalidStatus

from btlang.server.accounts.accounts import NEEDED, UserRole
from btlang.task.layer import TaskLayer
from btlang.task.messages import COMMANDS
from btlang.task.store.records import TaskState
from tests.server.conftest import ROLES
from tests.server.doors import PASSWORD, Door, close_code, received
from tests.task.layers import wait_for, wait_until


def test_every_command_needs_a_role() -> None:
    assert set(NEEDED) == set(COMMANDS.values())
    assert [UserRole.OPERATOR.covers(role) for role in UserRole] == [True, True, False, False]


def test_a_task_from_log_in_to_its_end(door: Door, robot: TaskLayer) -> None:
    olga = door.log_in("olga")
    me = door.ask("GET", "/api/me", **olga).data
    assert (me["user"], me["role"]) == ("olga", "operator")
    answer = door.ask("POST", "/api/commands", {"command": "submit", "text": "wave", "labels": ["x"]}, **olga)
    assert (answer.status, answer.data["ok"]) == (200, True)
    task = wait_for(robot, answer.data["data"]["task"]["id"], TaskState.COMPLETED)
    assert task.person == "olga"
    refused = door.ask("POST", "/api/commands", {"command": "cancel", "task": task.id}, **olga)
    assert (refused.status, refused.data["code"]) == (409, "BT187")
    wrong = door.ask("POST", "/api/commands", {"command": "submti"}, **olga)
    assert (wrong.status, wrong.data["code"]) == (400, "BT198")
    nowhere = door.ask("POST", "/api/commands", {"command": "status", "robot": "other"}, **olga)
    assert (nowhere.status, nowhere.data["text"]) == (404, "There's no robot 'other'.")


@pytest.mark.parametrize(
    ("command", "least"),
    [
        ({"command": "status"}, "vic"),
        ({"command": "pause"}, "olga"),
        ({"command": "put", "name": "a", "text": "nod"}, "ed"),
    ],
)
def test_roles(door: Door, command: dict[str, str], least: str) -> None:
    names = list(ROLES)
    for name in names:
        reply = door.ask("POST", "/api/commands", command, **door.log_in(name))
        assert reply.status == (200 if names.index(name) >= names.index(least) else 403), name
    door.ask("POST", "/api/commands", {"command": "resume"}, **door.log_in("ann"))


def test_everybody_may_stop_the_robot_and_an_operator_lets_it_move(door: Door, robot: TaskLayer) -> None:
    vic = door.log_in("vic")
    assert door.ask("POST", "/api/stop", {"reason": "smoke"}, **vic).status == 200
    assert robot.emergency.reason == "emergency stop by vic: smoke"
    assert door.ask("POST", "/api/commands", {"command": "release"}, **vic).status == 403
    assert door.ask("POST", "/api/commands", {"command": "release"}, **door.log_in("olga")).status == 200
    assert not robot.emergency.is_latched


def test_missions_are_never_overwritten_in_silence(door: Door) -> None:
    ed = door.log_in("ed")
    first = door.ask("PUT", "/api/missions/morning%20tour", {"text": "wave", "revision": 0}, **ed)
    assert first.data["data"]["mission"]["number"] == 1
    assert door.ask("PUT", "/api/missions/morning%20tour", {"text": "nod", "revision": 1}, **ed).status == 200
    stale = door.ask("PUT", "/api/missions/morning%20tour", {"text": "nod then wave", "revision": 1}, **ed)
    assert (stale.status, stale.data["data"]["revision"]) == (409, 2)
    assert stale.data["data"]["diff"].splitlines()[-2:] == ["-nod", "+nod then wave"]
    history = door.ask("GET", "/api/missions/morning%20tour", **ed).data["data"]["missions"]
    assert [each["text"] for each in history] == ["wave", "nod"]
    wrong = door.ask("PUT", "/api/missions/bad", {"text": "move forwarrd 1 m"}, **ed)
    assert (wrong.status, wrong.data["code"]) == (409, "BT010")
    assert door.ask("DELETE", "/api/missions/morning%20tour", **ed).status == 200
    listed = door.ask("GET", "/api/missions", **ed).data["data"]["missions"]
    assert "morning tour" not in [each["name"] for each in listed]


def test_a_program_follows_a_mission(door: Door, robot: TaskLayer) -> None:
    token = door.user("token", "olga", "my program")
    with door.socket() as socket:
        assert json.loads(socket.recv())["type"] == "auth_required"
        socket.send(json.dumps({"type": "auth", "token": token}))
        assert received(socket, type="auth_ok")["user"] == "olga"
        socket.send(json.dumps({"id": 1, "type": "subscribe", "rate": 50}))
        assert received(socket, type="up")["robot"] == "robot"
        assert received(socket, type="result", id=1)["ok"]
        socket.send(json.dumps({"id": 2, "command": "submit", "text": "wave then say done"}))
        messages: list[dict[str, Any]] = []  # the run may begin before the result of the command arrives
        number = received(socket, messages, type="result", id=2)["data"]["task"]["id"]
        run = received(socket, messages, type="run", task=number)
        assert [node[1] for node in run["nodes"]] == ["Sequence", "Wave", "Say"]
        received(socket, messages, type="change", task=number, state="completed")
    listed = door.user("tokens", "olga")
    assert listed.startswith("my program  used at")


def test_who_is_revoked_is_out_at_once(door: Door) -> None:
    token = door.user("token", "vic", "screen")
    cookie = door.log_in("vic")
    with door.socket(authorization=f"Bearer {token}") as by_token, door.socket(cookie=cookie["cookie"]) as by_cookie:
        assert received(by_token, type="auth_ok")["role"] == received(by_cookie, type="auth_ok")["role"] == "viewer"
        door.user("revoke", "vic", "screen")
        assert close_code(by_token) == 4001
        assert door.ask("GET", "/api/me", authorization=f"Bearer {token}").status == 401
        by_cookie.send(json.dumps({"id": 1, "type": "ping"}))
        assert received(by_cookie, id=1)["ok"]
        door.user("logout", "vic")
        assert close_code(by_cookie) == 4001
    assert door.ask("GET", "/api/me", **cookie).status == 401


def test_another_role_holds_at_once(door: Door) -> None:
    door.user("add", "temp", "--role", "operator")
    temp = door.log_in("temp")
    with door.socket(cookie=temp["cookie"]) as socket:
        door.user("role", "temp", "viewer")
        socket.send(json.dumps({"id": 1, "command": "pause"}))
        assert received(socket, id=1)["status"] == 403
        door.user("remove", "temp")
        assert close_code(socket) == 4001


def test_log_out(door: Door) -> None:
    here, there = door.log_in("ed"), door.log_in("ed")
    assert door.ask("POST", "/api/logout", {}, **here).status == 200
    assert [door.ask("GET", "/api/me", **each).status for each in (here, there)] == [401, 200]
    again = door.log_in("ed")
    assert door.ask("POST", "/api/logout", {"everywhere": True}, **again).status == 200
    assert door.ask("GET", "/api/me", **there).status == 401


def test_the_trail_says_who_did_what(door: Door, robot: TaskLayer) -> None:
    door.ask("POST", "/api/commands", {"command": "release"}, **door.log_in("vic"))
    door.ask("POST", "/api/commands", {"command": "release"}, **door.log_in("olga"))
    trail = door.user("trail").splitlines()
    assert any(line.endswith("vic from 127.0.0.1: release: refused") for line in trail)
    assert any(line.endswith("olga from 127.0.0.1: log in: ok") for line in trail)
    wait_until(lambda: any(act.person == "olga" for act in robot.store.acts()))


def test_ros_is_shut_by_default(door: Door) -> None:
    with pytest.raises(InvalidStatus) as refused:
        door.socket("/api/rosbridge", authorization=f"Bearer {door.user('token', 'ann', 'ros')}")
    assert refused.value.response.status_code == 404


def test_liveness_and_readiness_need_no_log_in(door: Door) -> None:
    assert [door.ask("GET", path).body for path in ("/live", "/ready")] == [b"live", b"ready"]


def test_nothing_that_is_kept_or_printed_has_a_secret(door: Door, robot: TaskLayer) -> None:
    olga, token = door.log_in("olga"), door.user("token", "olga", "secrets").split()[-1]
    door.ask("POST", "/api/login", {"name": "olga", "password": "a wrong secret"})
    door.ask("POST", "/api/commands", {"command": "status"}, **olga)
    door.ask("POST", "/api/commands", {"command": "down"}, authorization=f"Bearer {token}")
    secrets = [PASSWORD, "a wrong secret", token, olga["cookie"].partition("=")[2], olga["x_csrf_token"]]
    kept = [path.read_bytes() for path in door.folder.rglob("*") if path.is_file()]
    assert any(b"olga" in each for each in kept)
    for secret in secrets:
        assert secret not in door.user("trail")
        assert not any(secret.encode() in each for each in kept)
