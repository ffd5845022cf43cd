"""Worlds and robot files over the net: as missions are, and from people who may not write anything they like."""

from __future__ import annotations

import json
import subprocess
import sys
from typing import Any

import pytest

from btlang.task.layer import TaskLayer
from tests.server.doors import Door, received
from tests.task.layers import LONG, wait_until

GARDEN = 'start = { x = 1, y = 1 }\nplaces = [{ name = "shed", x = 1, y = 2 }]\n'
CART = 'name = "cart"\nradius = 0.25\n'
TESTS = 'test "it waves":\n  run "green one"\n  finally the mission succeeds\n'
KINDS = {
    "missions": ("mission", "wave"), "worlds": ("world", GARDEN), "robot-files": ("robot", CART),
    "tests": ("test", TESTS),
}  # fmt: skip


@pytest.fixture(scope="module")
def ed(door: Door) -> dict[str, str]:
    """The headers of an editor."""
    return door.log_in("ed")


@pytest.fixture(scope="module")
def vic(door: Door) -> dict[str, str]:
    """Those of a viewer."""
    return door.log_in("vic")


@pytest.mark.parametrize("path", KINDS)
def test_each_kind_has_the_same_routes(door: Door, ed: dict[str, str], vic: dict[str, str], path: str) -> None:
    kind, text = KINDS[path]
    at = f"/api/{path}/green%20one"
    assert door.ask("PUT", at, {"text": text}).status == 401
    assert door.ask("PUT", at, {"text": text}, **vic).status == 403
    first = door.ask("PUT", at, {"text": text, "revision": 0}, **ed)
    assert (first.status, first.data["data"][kind]["number"]) == (200, 1)
    assert door.ask("PUT", at, {"text": f"# 2\n{text}", "revision": 1}, **ed).status == 200
    stale = door.ask("PUT", at, {"text": f"# 3\n{text}", "revision": 1}, **ed)
    assert (stale.status, stale.data["code"], stale.data["data"]["revision"]) == (409, "BT187", 2)
    assert stale.data["data"]["diff"].splitlines()[3:5] == ["-# 2", "+# 3"]
    listed = door.ask("GET", f"/api/{path}", **vic).data["data"][f"{kind}s"]
    assert [(each["name"], each["number"], each["kind"]) for each in listed] == [("green one", 2, kind)]
    history = door.ask("GET", at, **vic).data["data"][f"{kind}s"]
    assert [each["text"] for each in history] == [text, f"# 2\n{text}"]
    if kind != "test":  # which is read when it runs
        wrong = door.ask("PUT", at, {"text": "wals = []"}, **ed)
        code = {"mission": "BT010", "world": "BT070", "robot": "BT071"}[kind]
        assert (wrong.status, wrong.data["code"]) == (409, code)
        assert "green one:1:1: error" in wrong.data["text"]
    assert door.ask("DELETE", at, **vic).status == 403
    assert door.ask("DELETE", at, **ed).status == 200
    assert door.ask("DELETE", at, **ed).status == 409
    assert door.ask("GET", f"/api/{path}", **vic).data["data"] == {f"{kind}s": []}


def test_a_mission_is_written_for_a_world_of_the_library(door: Door, ed: dict[str, str], vic: dict[str, str]) -> None:
    assert door.ask("PUT", "/api/worlds/garden", {"text": GARDEN.replace("shed", "pond")}, **ed).status == 200
    assert door.ask("PUT", "/api/worlds/garden", {"text": GARDEN}, **ed).status == 200
    there, here = {"text": "go to the shed", "world": "garden"}, {"text": "go to the shed"}
    for kind in ("check", "explain", "format"):
        assert door.ask("POST", f"/api/{kind}", there, **vic).data["ok"], kind
        assert not door.ask("POST", f"/api/{kind}", here, **vic).data["ok"], kind
        gone = door.ask("POST", f"/api/{kind}", {"text": "go to the kitchen", "world": "garden"}, **vic).data
        assert (gone["ok"], gone["messages"][0]["code"]) == (False, "BT013"), gone
    offered = door.ask("POST", "/api/complete", {"text": "go to the s", "world": "garden"}, **vic).data
    assert "shed" in [each["text"] for each in offered["completions"]]
    missing = door.ask("POST", "/api/check", {**there, "world": "moon"}, **vic)
    assert (missing.status, missing.data["code"]) == (409, "BT187")
    assert "The world 'moon' isn't in the library" in missing.data["text"]
    assert door.ask("POST", "/api/check", {**there, "robot": "other"}, **vic).status == 404
    for world in (None, 3, ["garden"], {"text": GARDEN}):
        assert door.ask("POST", "/api/check", {**there, "world": world}, **vic).status == 400
    for world in ("", "../../etc/passwd", "a\0b", "\ud800", "🤖", "x" * 10_000):
        reply = door.ask("POST", "/api/check", {**there, "world": world}, **vic)
        assert reply.status in (400, 409), world
        assert b"root:" not in reply.body
    assert door.ask("DELETE", "/api/worlds/garden", **ed).status == 200


HOSTILE = {
    "a path": GARDEN + 'include = "../../etc/passwd"',
    "NaN": GARDEN + "dock = { x = nan, y = 1 }",
    "a huge number": GARDEN + f"walls = [[[0x{'f' * 500}, 1], [2, 2]]]",
    "deep lists": GARDEN + "walls = " + "[" * 100_000,
    "deep keys": GARDEN + "a." * 90_000 + "a = 1",
    "many keys": GARDEN + "".join(f"k{number} = 1\n" for number in range(15_000)),
    "many objects": GARDEN + "objects = [" + '{name="o",x=9,y=9},' * 40_000 + "]",
    "not TOML": "\x01\x02",
}


@pytest.mark.parametrize("name", HOSTILE)
def test_texts_that_are_too_much(door: Door, ed: dict[str, str], name: str) -> None:
    for path in ("worlds", "robot-files"):
        reply = door.ask("PUT", f"/api/{path}/bad", {"text": HOSTILE[name]}, **ed)
        assert (reply.status, reply.data["code"][:2]) == (409, "BT"), reply.body[:300]
        assert reply.data["code"] in ("BT070", "BT071", "BT198")
        assert b"Traceback" not in reply.body
        assert door.ask("GET", f"/api/{path}/bad", **ed).status == 409
    assert door.ask("PUT", "/api/worlds/bad", b'{"text": "' + b"# " * 2_000_000 + b'"}', **ed).status == 413
    assert door.ask("PUT", "/api/worlds/bad", b'{"text": "\xff\xfe"}', **ed).status == 400
    assert door.ask("PUT", "/api/worlds/bad", {"text": 3}, **ed).status == 400
    assert door.ask("PUT", "/api/worlds/bad", {"text": GARDEN, "revision": "1"}, **ed).status == 400


@pytest.mark.parametrize("path", ["..%2f..%2fetc%2fpasswd", "a/b", "%00", "%0a", "x" * 9000, "%ff"])
def test_names_lead_to_no_files(door: Door, ed: dict[str, str], path: str) -> None:
    for place, (_, text) in KINDS.items():
        put = door.ask("PUT", f"/api/{place}/{path}", {"text": text}, **ed)
        got = door.ask("GET", f"/api/{place}/{path}", **ed)
        if put.status == 200:
            assert door.ask("DELETE", f"/api/{place}/{path}", **ed).status == 200
        assert put.status in (200, 400, 404, 409)
        assert b"root:" not in got.body


def test_a_kind_that_does_not_exist(door: Door, ed: dict[str, str]) -> None:
    assert door.ask("GET", "/api/packs", **ed).status == 404
    reply = door.ask("POST", "/api/commands", {"command": "put", "name": "a", "text": "", "kind": "pack"}, **ed)
    assert (reply.status, reply.data["code"]) == (409, "BT198")


def test_a_world_over_the_socket(door: Door, robot: TaskLayer) -> None:
    token = door.user("token", "ed", "worlds")
    with door.socket(authorization=f"Bearer {token}") as socket:
        command: dict[str, Any] = {"id": 1, "command": "put", "name": "pond", "text": GARDEN, "kind": "world"}
        socket.send(json.dumps(command))
        assert received(socket, type="result", id=1)["data"]["world"]["number"] == 1
    assert next(act.person for act in robot.store.acts() if act.command == "put") == "ed"


def test_a_robot_comes_up_in_a_world_of_its_library(door: Door, vic: dict[str, str]) -> None:
    def begun(*words: str) -> subprocess.Popen[str]:
        command = [sys.executable, "-m", "btlang", *words, "--name", "second"]
        return subprocess.Popen(command, env=door.environment, text=True, stdout=subprocess.PIPE)

    def btc(*words: str) -> int:
        with begun(*words) as process:
            return process.wait(LONG)

    def up(*words: str) -> subprocess.Popen[str]:
        process = begun("robot", "up", "--speed", "max", *words)
        assert process.stdout is not None
        assert process.stdout.readline().startswith("The robot 'second' is up")
        return process

    with up():
        for kind, text in (("world", GARDEN), ("robot", CART)):
            assert btc("task", "put", "q", "-c", text, "--kind", kind) == 0
        assert btc("robot", "down") == 0
    with up("--world", "library:q", "--robot", "library:q"):
        asked = {"text": "go to the shed", "robot": "second"}
        wait_until(lambda: door.ask("POST", "/api/check", asked, **vic).data["ok"])  # with the words of the robot
        assert btc("task", "add", "-c", "go to the shed") == 1  # the cart has no wheels
        assert btc("robot", "down") == 0
