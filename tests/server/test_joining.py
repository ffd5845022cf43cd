"""Robots of other computers: each is a process here, in folders of its own, behind a cable that can be cut."""

from __future__ import annotations

import json
import os
import signal
import threading
import time
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from btlang.diagnostics.diagnostic import MissionError
from btlang.server.accounts.accounts import Accounts
from btlang.server.fleet.fleet import VALID, Fleet, pin_in
from btlang.server.live.robot_connection import STREAM
from btlang.server.live.sockets import FORBIDDEN
from tests.server.cable import Cable
from tests.server.doors import Door, Reply, close_code, received
from tests.server.elsewhere import Elsewhere, asked_to_watch, btc, command, in_background, invited, is_up, listed
from tests.task.layers import LONG, wait_until

_PINGS = 60
"""Bytes: fewer that the server sends may be pings, and no command."""


@pytest.fixture
def kim(door: Door, joined: Elsewhere) -> Elsewhere:
    """One for all tests, which is up again, may move, and has nothing left to do of the test before."""
    wait_until(lambda: is_up(door, "kim"))
    for task in command(door, "kim", command="list").data["data"]["tasks"]:
        command(door, "kim", command="cancel", task=task["id"])  # refused where it has ended
    assert command(door, "kim", command="release").data["ok"]
    return joined


def tasks(door: Door) -> list[str]:
    return [task["mission"] for task in command(door, "kim", command="list").data["data"]["tasks"]]


def test_a_robot_elsewhere_is_like_one_here(door: Door, kim: Elsewhere) -> None:
    assert listed(door)["kim"]["elsewhere"]
    with door.socket(Cookie=door.log_in("olga")["cookie"]) as socket:
        socket.send(json.dumps({"id": 1, "type": "subscribe", "robots": ["kim"], "rate": 20}))
        socket.send(json.dumps({"id": 2, "robot": "kim", "command": "submit", "text": "wait 100 s"}))
        messages: list[dict[str, Any]] = []  # the run may begin before the result of the command arrives
        task = received(socket, messages, type="result", id=2)["data"]["task"]["id"]
        assert received(socket, messages, type="run", robot="kim", task=task)["nodes"]
        assert received(socket, messages, type="statuses", robot="kim")["changes"]
        began = time.monotonic()
        stopped = door.ask("POST", "/api/stop", {"robot": "kim", "reason": "test"}, **door.log_in("vic"))
        assert (stopped.status, stopped.data["ok"]) == (200, True)
        assert time.monotonic() - began < 2.0
        assert received(socket, type="change", robot="kim", state="killed")["cause"]
    state = command(door, "kim", command="status").data["data"]
    assert state["stopped"] == "emergency stop by vic: test"
    assert "last seen" in btc(door, "robot", "invited")


def submit(door: Door, mission: str) -> tuple[threading.Thread, list[Reply]]:
    """Submits a mission in the background; who asks has logged in before, which takes a busy machine a while."""
    fields, olga = {"robot": "kim", "command": "submit", "text": mission}, door.log_in("olga")
    return in_background(lambda: door.ask("POST", "/api/commands", fields, **olga))


def test_a_command_whose_link_breaks_is_done_once(door: Door, cable: Cable, kim: Elsewhere) -> None:
    for lost in (cable.out_open, cable.in_open):  # on its way to the robot, and its answer
        mission = f"wait {100 + len(tasks(door))} s"
        lost.clear()
        thread, replies = submit(door, mission)
        if lost is cable.out_open:
            wait_until(lambda: cable.held_up() > _PINGS)
        else:
            wait_until(lambda text=mission: text in kim.tasks())
        assert not replies
        cable.cut()
        thread.join(LONG)
        assert replies[0].status == 200
        assert tasks(door).count(mission) == 1


def test_a_stop_that_did_not_arrive_is_told_and_never_sent_again(door: Door, cable: Cable, kim: Elsewhere) -> None:
    vic = door.log_in("vic")
    cable.out_open.clear()
    thread, replies = in_background(lambda: door.ask("POST", "/api/stop", {"robot": "kim"}, **vic))
    wait_until(lambda: cable.held_up() > _PINGS)
    cable.cut()
    thread.join(LONG)
    assert replies[0].status == 503
    assert "STOP IT WHERE IT STANDS" in replies[0].data["text"]
    wait_until(lambda: is_up(door, "kim"))
    assert not command(door, "kim", command="status").data["data"]["stopped"]


def test_who_knew_what_was_done_is_gone(door: Door, cable: Cable, kim: Elsewhere) -> None:
    cable.in_open.clear()
    thread, replies = submit(door, "wait 200 s")
    wait_until(lambda: "wait 200 s" in kim.tasks())
    assert not replies
    os.kill(kim.dialer(), signal.SIGKILL)
    cable.cut()
    thread.join(LONG)
    assert replies[0].status == 503
    assert "it may have done it" in replies[0].data["text"]
    kim.told("starts again")
    wait_until(lambda: is_up(door, "kim"))
    assert tasks(door).count("wait 200 s") == 1


def test_a_robot_that_is_revoked_is_gone_at_once(door: Door, cable: Cable) -> None:
    code = invited(door, "lee")
    with closing(Elsewhere(cable.port, code)) as robot:
        wait_until(lambda: is_up(door, "lee"))
        robot.close()
        with closing(Elsewhere(cable.port, "", robot.folder)) as again:  # its key is good without the code
            wait_until(lambda: is_up(door, "lee"))
            with closing(Elsewhere(cable.port, code)) as other:
                other.told("the server refuses it")  # which is good once
            btc(door, "robot", "revoke", "lee")
            assert "lee" not in listed(door)
            again.told("the server refuses it")
            assert again.process.poll() is None  # the robot itself goes on
    trail = door.user("trail")
    assert "lee from 127.0.0.1: join: ok" in trail
    assert " from 127.0.0.1: join: refused" in trail


def test_another_server_is_told_nothing(door: Door, cable: Cable) -> None:
    code = invited(door, "max")
    end = "A" if code[-1] != "A" else "B"
    with closing(Elsewhere(cable.port, code[:-1] + end)) as robot:
        robot.told("its certificate isn't that of the server which invited this robot; nothing was sent")
    with closing(Elsewhere(cable.port, "hello")) as robot:
        robot.told("a code is what 'btc robot invite' prints, whole")
    with closing(Elsewhere(cable.port, "")) as robot:
        robot.told("it needs a --code")
    assert not is_up(door, "max")


def test_who_says_nothing_sensible_does_not_join(door: Door) -> None:
    for text in ("", "{", "[]", '{"type":"join"}', '{"key": "x", "code": 1, "instance": null}') * 4:
        with door.socket(path="/api/join") as socket:
            socket.send(text)
            assert json.loads(socket.recv(LONG))["type"] == "refused"
    assert door.user("trail").count("join: refused") < 20  # a flood of them doesn't fill the disk


def test_a_robot_may_say_anything(door: Door) -> None:
    """What it says can't hurt the server: its words are text, and its files are not on this computer."""
    code, key = invited(door, "eve"), "k" * 40
    join = {"type": "join", "key": key, "code": code, "instance": "1"}
    hello = {"type": "hello", "change": 0, "words": {"keywords": ["/etc/passwd"], "world": "/etc/passwd"}}
    with door.socket(path="/api/join") as socket:
        socket.send(json.dumps(join))
        assert json.loads(socket.recv(LONG)) == {"type": "joined", "name": "eve"}
        for line in (b"[]\n", b"5\n", b"{}\n", b'{"type": "statuses"}\n', b"\xff\n", b"x" * 200_000):
            stream = asked_to_watch(socket)
            socket.send(b"\xff" + line)
            socket.send(stream.to_bytes(STREAM, "big") + line)
            for answer in ({}, {"id": 1}, {"id": "x", "answer": 5}, {"type": "watched", "stream": stream}):
                socket.send(json.dumps(answer))
        socket.send(asked_to_watch(socket).to_bytes(STREAM, "big") + json.dumps(hello).encode() + b"\n")
        wait_until(lambda: is_up(door, "eve"))
        checked = door.ask("POST", "/api/check", {"text": "wave", "robot": "eve"}, **door.log_in("vic"))
        assert checked.data["ok"]
        socket.send("[]")
        assert close_code(socket) == FORBIDDEN
    btc(door, "robot", "revoke", "eve")


def test_codes(tmp_path: Path) -> None:
    now = [0.0]
    with closing(Accounts(str(tmp_path))) as accounts:
        fleet = Fleet(accounts.database, clock=lambda: now[0])
        first = fleet.invite("kim", b"p" * 32)
        second = fleet.invite("kim", b"p" * 32)  # the first one is good no longer
        assert pin_in(second) == b"p" * 32
        assert fleet.admit("a" * 40, first) is None
        now[0] = VALID + 1
        assert fleet.admit("a" * 40, second) is None
        third = fleet.invite("kim", b"p" * 32)
        assert fleet.admit("a" * 40, third) is not None
        assert fleet.admit("a" * 40, third) is not None  # the answer may have been lost
        assert fleet.admit("b" * 40, third) is None
        with pytest.raises(MissionError, match="revoke it first"):
            fleet.invite("kim", b"p" * 32)
        fleet.revoke("kim")
        assert fleet.admit("a" * 40, third) is None
        with pytest.raises(MissionError, match="isn't known"):
            fleet.revoke("kim")
    for wrong in ("", "btr_", third[:-4], third + "AAAA", "btr_\0"):
        with pytest.raises(ValueError, match=r"code|base64|[Pp]adding|string"):
            pin_in(wrong)
