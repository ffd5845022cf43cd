"""What attackers try, each with what is expected of the server."""

from __future__ import annotations

import asyncio
import json
import socket
import ssl
import threading
import time
from collections import Counter
from contextlib import closing, suppress
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given
from starlette.testclient import TestClient, WebSocketDisconnect
from websockets.exceptions import ConnectionClosed, InvalidStatus

from btlang.server.accounts.accounts import Accounts, UserRole
from btlang.server.accounts.passwords import LONGEST, Throttle, Verifier, fits, hash_password, problem
from btlang.server.http.app import Api
from btlang.server.http.listener import open_listener
from tests.profiles import amount, searches
from tests.server.doors import PASSWORD, Door, close_code, received, trusting
from tests.task.test_commands import commands

HUNG_UP = (1009, 1006)  # the second one where the server was gone before all was sent
EVIL = "https://evil.example"


def raw(door: Door, data: bytes, seconds: float = 20.0) -> bytes:
    """What the server says to these bytes, until it hangs up."""
    with (
        socket.create_connection(("127.0.0.1", door.port), seconds) as plain,
        trusting().wrap_socket(plain) as connection,
    ):
        said = b""
        try:
            connection.sendall(data)
            while part := connection.recv(65536):
                said += part
        except (TimeoutError, OSError):
            pass
        return said


def test_a_page_of_another_site_reaches_nothing(door: Door) -> None:
    cookie = door.log_in("olga")
    with pytest.raises(InvalidStatus) as refused:
        door.socket(cookie=cookie["cookie"], origin=EVIL)
    assert refused.value.response.status_code == 403
    for headers in ({"origin": EVIL}, {"origin": "null"}, {"x_csrf_token": ""}, {"x_csrf_token": "AAAA"}):
        reply = door.ask("POST", "/api/commands", {"command": "pause"}, **{**cookie, **headers})
        assert reply.status == 403, headers
    form = door.ask("POST", "/api/commands", b'{"command": "pause"}', **{**cookie, "content_type": "text/plain"})
    assert form.status == 415
    own = {**cookie, "origin": f"https://127.0.0.1:{door.port}", "host": f"127.0.0.1:{door.port}"}
    assert door.ask("POST", "/api/commands", {"command": "status"}, **own).status == 200


def test_a_csrf_token_is_of_one_session(door: Door) -> None:
    olga, ed = door.log_in("olga"), door.log_in("ed")
    mixed = {**olga, "x_csrf_token": ed["x_csrf_token"]}
    assert door.ask("POST", "/api/commands", {"command": "status"}, **mixed).status == 403


def test_cookies_and_tokens_are_not_exchangeable(door: Door) -> None:
    secret = door.log_in("vic")["cookie"].partition("=")[2]
    assert door.ask("GET", "/api/me", authorization=f"Bearer {secret}").status == 401
    token = door.user("token", "vic", "swap")
    assert door.ask("GET", "/api/me", cookie=f"__Host-btlang={token}").status == 401
    assert door.ask("GET", "/api/me", authorization=f"Basic {token}").status == 401
    assert door.ask("GET", "/api/me", authorization=f"Bearer {token}").status == 200


def test_a_session_is_not_fixed_by_who_has_none(door: Door) -> None:
    chosen = "__Host-btlang=chosen-by-somebody-else"
    reply = door.ask("POST", "/api/login", {"name": "vic", "password": PASSWORD}, cookie=chosen)
    given = reply.headers["set-cookie"]
    assert "chosen" not in given
    assert {"HttpOnly", "Secure", "SameSite=strict", "Path=/"} <= set(given.split("; "))
    assert door.ask("GET", "/api/me", cookie=chosen).status == 401


@pytest.mark.parametrize(
    "password", ["with\0NUL inside", "x" * LONGEST, "🔑🚪🤖🔑🚪🤖🔑🚪", "   spaces   ", "half \ud83d a surrogate"]
)
def test_odd_passwords(password: str) -> None:
    assert problem(password, "ann") == ""
    kept = hash_password(password)
    assert fits(password, kept)
    assert not fits(password[:-1], kept)
    assert not fits(password.replace("\0", ""), kept) or "\0" not in password


@pytest.mark.parametrize("password", ["short", "x" * (LONGEST + 1), "Administrator"])
def test_passwords_that_are_refused(password: str) -> None:
    assert problem(password, "administrator")


def test_an_unknown_user_takes_as_long() -> None:
    """Of the processor, and the least of several times, since a machine that tests run on is busy."""

    async def seconds(kept: str | None) -> float:
        began = time.process_time()
        assert not await verifier.fits("wrong password", kept)
        return time.process_time() - began

    async def least() -> list[float]:
        kept = hash_password(PASSWORD)
        pairs = [(await seconds(kept), await seconds(None)) for _ in range(amount(7, 40))]
        return [min(each) for each in zip(*pairs, strict=True)]

    verifier = Verifier()
    with closing(verifier):
        known, unknown = asyncio.run(least())
    assert 0.5 < known / unknown < 2.0


def test_wrong_passwords_cost_time() -> None:
    now = [0.0]
    throttle = Throttle(lambda: now[0])
    waits = []
    for _ in range(12):
        waits.append(throttle.wait("ann"))
        now[0] += waits[-1]
        throttle.wrong("ann")
    assert waits == [0, 0, 0, 0, 0, 1, 2, 4, 8, 16, 32, 60]
    assert throttle.wait("bo") == 0
    throttle.right("ann")
    assert throttle.wait("ann") == 0
    for number in range(30_000):
        throttle.wrong(str(number))
    assert len(throttle._wrong) == 10_000


@pytest.mark.long
def test_a_flood_of_wrong_passwords(robot: Any) -> None:
    """Of 10,000 (in the suite 60) from one address; somebody who comes from another one logs in meanwhile."""
    answers: Counter[int] = Counter()
    with closing(Door(robot.folder)) as door:
        if not any("flo" in line for line in door.user("list").splitlines()):
            door.user("add", "flo")

        def attack(count: int) -> None:
            with closing(door.connection()) as connection:
                for number in range(count):
                    body = json.dumps({"name": f"u{number % 7}", "password": "guess" * 3})
                    connection.request("POST", "/api/login", body, {"content-type": "application/json"})
                    answer = connection.getresponse()
                    answers[answer.status] += 1
                    answer.read()

        threads = [threading.Thread(target=attack, args=(amount(15, 2500),)) for _ in range(4)]
        began = time.monotonic()
        for thread in threads:
            thread.start()
        connection = door.connection()
        connection.source_address = ("127.0.0.2", 0)
        connection.request(
            "POST",
            "/api/login",
            json.dumps({"name": "flo", "password": PASSWORD}),
            {"content-type": "application/json"},
        )
        assert connection.getresponse().status == 200
        connection.close()
        for thread in threads:
            thread.join()
        assert time.monotonic() - began < 120
    assert set(answers) <= {401, 429, 503}
    assert answers[429] > sum(answers.values()) / 2


@pytest.mark.parametrize(
    "path", ["../../etc/passwd", "%2e%2e%2f%2e%2e%2fetc%2fpasswd", "..%5c..%5cx", "a/b", "%00", "x" * 9000]
)
def test_names_lead_to_no_files(door: Door, path: str) -> None:
    ed = door.log_in("ed")
    got = door.ask("GET", f"/api/missions/{path}", **ed)
    assert got.status in (200, 400, 404, 409)
    assert b"root:" not in got.body
    put = door.ask("PUT", f"/api/missions/{path}", {"text": "wave"}, **ed)
    assert put.status in (200, 400, 404, 409)


def test_bodies_that_are_too_much(door: Door) -> None:
    ed = door.log_in("ed")
    assert door.ask("POST", "/api/commands", b"[" * 100_000, **ed).status == 400
    assert door.ask("POST", "/api/commands", b'{"a":' * 100_000, **ed).status == 400
    assert door.ask("POST", "/api/commands", b" " * 1_000_001, **ed).status == 413
    zipped = door.ask("POST", "/api/commands", b"\x1f\x8b\x08", **{**ed, "content_encoding": "gzip"})
    assert zipped.status == 415
    assert door.ask("POST", "/api/commands", b"\xff\xfe", **ed).status == 400
    assert door.ask("POST", "/api/login", {"name": ["ann"], "password": 1}).status == 400
    assert door.ask("POST", "/api/login", {"name": "a\r\nset-cookie: x=1", "password": "p" * 9}).status == 401


def test_frames_that_are_too_much(door: Door) -> None:
    token = {"authorization": f"Bearer {door.user('token', 'vic', 'frames')}"}
    with door.socket(**token) as whole:
        assert "permessage-deflate" not in str(whole.response and whole.response.headers)
        with suppress(ConnectionClosed):
            whole.send("x" * 1_000_000)
        assert close_code(whole) in HUNG_UP
    with door.socket(**token) as pieces:
        with suppress(ConnectionClosed):
            pieces.send("x" * 50_000 for _ in range(100))
        assert close_code(pieces) in HUNG_UP
    with door.socket(**token) as binary:
        binary.send(b"{}")
        assert close_code(binary) == 1003
    with door.socket(**token) as deep:
        deep.send('{"a":' * 40_000)
        assert received(deep, type="result")["status"] == 400
        deep.send(json.dumps({"id": 7, "type": "ping"}))
        assert received(deep, id=7)["ok"]


def test_a_token_that_is_none(door: Door) -> None:
    for said in (
        '{"type": "auth", "token": "btl_wrong"}',
        '{"type": "auth", "token": 7}',
        "[]",
        "x",
        '{"type": "hello"}',
    ):
        with door.socket() as connection:
            received(connection, type="auth_required")
            connection.send(said)
            received(connection, type="auth_invalid")
            assert close_code(connection) == 4003


def test_old_tls_is_refused(door: Door) -> None:
    old = trusting()
    with pytest.warns(DeprecationWarning, match="deprecated"):
        old.minimum_version = ssl.TLSVersion.TLSv1
    with pytest.warns(DeprecationWarning, match="deprecated"):
        old.maximum_version = ssl.TLSVersion.TLSv1_1
    old.set_ciphers("ALL:@SECLEVEL=0")
    with socket.create_connection(("127.0.0.1", door.port)) as plain, pytest.raises(ssl.SSLError):
        old.wrap_socket(plain)
    new = trusting()
    new.minimum_version = ssl.TLSVersion.TLSv1_3
    with socket.create_connection(("127.0.0.1", door.port)) as plain, new.wrap_socket(plain) as connection:
        assert connection.version() == "TLSv1.3"
        connection.sendall(b"GET /live HTTP/1.1\r\nhost: localhost\r\n\r\n")
        assert connection.recv(100).startswith(b"HTTP/1.1 200")
        assert connection.session is not None
        assert not connection.session.has_ticket


def test_no_answer_is_held_back() -> None:
    """Its head and its body are written apart: the second one waited 40 ms for the other end to have the first."""
    with open_listener("127.0.0.1", 0) as door, socket.create_connection(door.getsockname()):
        accepted, _ = door.accept()
        with accepted:
            assert accepted.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)


def test_what_browsers_are_told(door: Door) -> None:
    for reply in (door.ask("GET", "/api/me"), door.ask("GET", "/nowhere"), door.ask("POST", "/live")):
        headers = {name.lower(): value for name, value in reply.headers.items()}
        assert headers["content-security-policy"].startswith("default-src 'none'")
        assert "frame-ancestors 'none'" in headers["content-security-policy"]
        assert (headers["x-frame-options"], headers["x-content-type-options"]) == ("DENY", "nosniff")
        assert headers["cache-control"] == "no-store"
        assert "server" not in headers
    assert door.ask("GET", "/api/me").headers["content-type"] == "application/json"


@pytest.mark.parametrize(
    "request_",
    [
        b"POST /api/login HTTP/1.1\r\nhost: x\r\ncontent-length: 5\r\ntransfer-encoding: chunked\r\n\r\n0\r\n\r\n",
        b"GET / HTTP/1.1\r\nhost: x\r\nhost: y\r\n\r\n",
        b"GET /\x00 HTTP/1.1\r\nhost: x\r\n\r\n",
        b"GET / HTTP/1.1\r\nhost: x\r\n" + b"a: " + b"b" * 70_000 + b"\r\n\r\n",
        b"\x16\x03\x01\x00\x00" * 50,
        b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n",
    ],
)
def test_requests_that_are_none(door: Door, request_: bytes) -> None:
    said = raw(door, request_ + b"\r\n\r\n", 5.0)
    assert said[9:12] in (b"400", b"404", b"415", b"431", b""), said[:200]
    assert b"Traceback" not in said
    assert door.ask("GET", "/live").body == b"live"


@searches(15, 1500, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=commands())
def test_no_command_is_too_much(door: Door, data: dict[str, Any]) -> None:
    """An administrator sends anything but what ends the robot's process."""
    if data["command"] == "down":
        return
    if not hasattr(door, "fuzzer"):
        door.fuzzer = {"authorization": f"Bearer {door.user('token', 'ann', 'fuzz')}"}  # type: ignore[attr-defined]
    reply = door.ask("POST", "/api/commands", data, **door.fuzzer)  # type: ignore[attr-defined]
    assert reply.status in (200, 400, 404, 409), (data, reply.body)
    assert set(reply.data) >= {"ok", "text", "code"}


@pytest.mark.long
def test_who_says_nothing_is_hung_up_on(door: Door) -> None:
    """A thousand of them at once keep nobody out, and none stays."""
    if not amount(0, 1):
        pytest.skip("takes ten seconds of silence: with -m long")
    silent = [socket.create_connection(("127.0.0.1", door.port)) for _ in range(500)]
    shaken = [trusting().wrap_socket(socket.create_connection(("127.0.0.1", door.port))) for _ in range(500)]
    assert door.ask("GET", "/live").body == b"live"
    for each in shaken:
        each.settimeout(30)
        assert each.recv(1) == b""
        each.close()
    for other in silent:
        other.close()
    assert door.ask("GET", "/live").body == b"live"


def test_the_last_administrator_stays(tmp_path: Path) -> None:
    with closing(Accounts(str(tmp_path))) as accounts:
        accounts.add("ann", UserRole.ADMINISTRATOR, "hash")
        accounts.add("bo", UserRole.EDITOR, "hash")
        for attempt in (lambda: accounts.remove("ann"), lambda: accounts.set_role("ann", UserRole.VIEWER)):
            with pytest.raises(Exception, match="is the only administrator"):
                attempt()
        accounts.set_role("bo", UserRole.ADMINISTRATOR)
        accounts.remove("ann")
        assert [user.name for user in accounts.users()] == ["bo"]


def test_the_trail_fills_no_disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("btlang.server.accounts.accounts.MOST_ENTRIES", 3)
    with closing(Accounts(str(tmp_path))) as accounts:
        for number in range(5):
            accounts.log("ann", "::1", str(number), "refused")
        assert [entry.what for entry in accounts.entries()] == ["4", "3", "2"]


def test_sessions_end_by_themselves(tmp_path: Path) -> None:
    now = [1000.0]
    with closing(Accounts(str(tmp_path), clock=lambda: now[0])) as accounts:
        accounts.add("ann", UserRole.VIEWER, "hash")
        secret = accounts.log_in("ann", "::1")
        for _ in range(20):
            now[0] += 7 * 3600
            assert accounts.identity(secret) is not None
        now[0] += 9 * 3600
        assert accounts.identity(secret) is None
        long = accounts.log_in("ann", "::1")
        for _ in range(25):
            now[0] += 7 * 3600
            known = accounts.identity(long)
        assert known is None
        assert accounts.identity("") is None


def test_who_asks_but_never_reads_has_to_wait(door: Door) -> None:
    """Answers are never left out, so they would fill the memory."""
    before = door.memory
    head = f"""GET /api/ws HTTP/1.1
host: 127.0.0.1:{door.port}
cookie: {door.log_in("vic")["cookie"]}
connection: upgrade
upgrade: websocket
sec-websocket-version: 13
sec-websocket-key: AAAAAAAAAAAAAAAAAAAAAA==

"""
    question = json.dumps({"id": "x" * 100_000, "type": "ping"}).encode()
    frame = b"\x81\xff" + len(question).to_bytes(8, "big") + bytes(4) + question  # masked, with zeros
    with (
        socket.create_connection(("127.0.0.1", door.port)) as plain,
        trusting().wrap_socket(plain) as connection,
    ):
        connection.sendall(head.replace("\n", "\r\n").encode())
        assert b" 101 " in connection.recv(1000)
        connection.settimeout(2.0)
        sent = 0
        with suppress(TimeoutError):
            while sent < 2000:
                connection.sendall(frame)
                sent += 1
        assert sent < 1000
    assert door.memory - before < 100
    assert door.ask("GET", "/live").status == 200


def test_a_head_that_comes_in_one_piece_is_no_longer_than_others_may_be(tmp_path: Path) -> None:
    with closing(Accounts(str(tmp_path / "accounts"))) as accounts:
        client: Any = TestClient(Api(accounts, "key").app())
        asked = [client.get("/live", headers={"a": "b" * letters}).status_code for letters in (15_000, 20_000)]
        assert asked == [200, 431]
        with pytest.raises(WebSocketDisconnect), client.websocket_connect("/api/ws", headers={"a": "b" * 20_000}):
            pass
