"""What administrators do about users, tokens and the trail, and that nobody else does."""

from __future__ import annotations

import threading
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from btlang.diagnostics.diagnostic import MissionError
from btlang.server.accounts.accounts import Accounts, UserRole
from btlang.server.live.sockets import REVOKED
from tests.server.doors import PASSWORD, Door, close_code, received

ROUTES = [("GET", "/api/users"), ("POST", "/api/users"), ("GET", "/api/trail"), ("POST", "/api/confirm")]
ANYTHING = {"act": "add", "name": "eve", "role": "administrator", "password": PASSWORD}


class Administrator:
    """Somebody who is logged in as an administrator."""

    def __init__(self, door: Door) -> None:
        self._door, self._headers = door, door.log_in("ann")

    def change(self, act: str, name: str, **more: str) -> dict[str, Any]:
        """What a change answers, with its status."""
        reply = self._door.ask("POST", "/api/users", {"act": act, "name": name, **more}, **self._headers)
        return {"status": reply.status, **reply.data}

    @property
    def users(self) -> dict[str, tuple[str, list[str]]]:
        """The role and the tokens of each user."""
        listed = self._door.ask("GET", "/api/users", **self._headers).data["users"]
        return {each["name"]: (each["role"], [token["name"] for token in each["tokens"]]) for each in listed}

    def trail(self, query: str = "") -> list[str]:
        """Who did what, and how it went; the newest first."""
        entries = self._door.ask("GET", f"/api/trail?{query}", **self._headers).data["entries"]
        return [f"{each['user']}: {each['what']}: {each['outcome']}" for each in entries]


@pytest.fixture
def ann(door: Door) -> Administrator:
    return Administrator(door)


@pytest.mark.parametrize(("method", "path"), ROUTES)
def test_only_administrators_see_and_change_users(door: Door, ann: Administrator, method: str, path: str) -> None:
    before = ann.users
    assert door.ask(method, path, ANYTHING if method == "POST" else None).status == 401
    for name in ("vic", "olga", "ed"):
        reply = door.ask(method, path, ANYTHING if method == "POST" else None, **door.log_in(name))
        assert (reply.status, reply.data["text"]) == (403, "Only administrators may do this.")
        assert reply.data.keys() == {"ok", "text", "code"}
        assert ann.trail()[0] == f"{name}: {path}: refused"
    assert ann.users == before


def test_a_page_of_another_site_changes_nothing(door: Door) -> None:
    cookie = door.log_in("ann")["cookie"]
    assert door.ask("POST", "/api/users", ANYTHING, cookie=cookie).status == 403


def test_a_program_reads_and_changes_nothing(door: Door, ann: Administrator) -> None:
    headers = {"authorization": f"Bearer {ann.change('token', 'ann', token='monitor')['token']}"}
    assert door.ask("GET", "/api/users", **headers).status == 200
    assert door.ask("GET", "/api/trail", **headers).status == 200
    reply = door.ask("POST", "/api/users", ANYTHING, **headers)
    assert (reply.status, reply.data["text"]) == (
        403, "Programs can't change users: do it in the page, or with 'btc user'."
    )  # fmt: skip
    assert ann.change("revoke", "ann", token="monitor")["status"] == 200
    assert door.ask("GET", "/api/users", **headers).status == 401


def test_a_user_comes_and_goes(door: Door, ann: Administrator) -> None:
    password = ann.change("add", "kim", role="viewer")["password"]
    assert ann.users["kim"] == ("viewer", [])
    assert ann.change("add", "kim", role="viewer")["text"].endswith("The user 'kim' exists already.")
    with door.socket(Cookie=door.log_in("kim", password)["cookie"]) as page:
        assert received(page, type="auth_ok")["role"] == "viewer"
        assert ann.change("role", "kim", role="operator")["status"] == 200
        assert door.ask("GET", "/api/me", **door.log_in("kim", password)).data["role"] == "operator"
        page.send('{"id": 1, "command": "cancel", "task": 999}')
        assert received(page, id=1).get("status") != 403  # the open socket has the new role
        assert ann.change("logout", "kim")["status"] == 200
        assert close_code(page) == REVOKED
    other = ann.change("password", "kim")["password"]
    assert door.ask("POST", "/api/login", {"name": "kim", "password": password}).status == 401
    headers = door.log_in("kim", other)
    secret = ann.change("token", "kim", token="phone")["token"]
    assert ann.users["kim"] == ("operator", ["phone"])
    with door.socket(Authorization=f"Bearer {secret}") as program:
        received(program, type="auth_ok")
        assert ann.change("revoke", "kim", token="phone")["status"] == 200
        assert close_code(program) == REVOKED
    with door.socket(Cookie=headers["cookie"]) as page:
        received(page, type="auth_ok")
        assert ann.change("remove", "kim")["status"] == 200
        assert close_code(page) == REVOKED
    assert "kim" not in ann.users
    assert ann.trail("filter=KIM+ok+ann&limit=7") == [
        "ann: remove the user 'kim': ok", "ann: revoke the token 'phone' of 'kim': ok",
        "ann: make the token 'phone' of 'kim': ok", "ann: set a new password for 'kim': ok",
        "ann: log out 'kim' everywhere: ok", "ann: give 'kim' the role operator: ok",
        "ann: add the user 'kim' as viewer: ok",
    ]  # fmt: skip
    assert "ann: add the user 'kim' as viewer: refused" in ann.trail("filter=refused")
    assert secret not in str(ann.trail("limit=1000"))


@pytest.mark.parametrize(
    ("change", "status", "words"),
    [
        ({"act": "promote", "name": "vic"}, 400, "'act' must be one of these"),
        ({"act": "add", "name": "x", "role": "king"}, 400, "'role' must be one of"),
        ({"act": "add", "name": " ", "role": "viewer"}, 400, "a name must have up to 64 characters"),
        ({"act": "add", "name": "x\n", "role": "viewer"}, 400, "a name must have up to 64 characters"),
        ({"act": "token", "name": "vic", "token": "x" * 65}, 400, "a name must have up to 64 characters"),
        ({"act": "token", "name": "nobody", "token": "x"}, 400, "The user 'nobody' isn't known"),
        ({"act": "revoke", "name": "vic", "token": "x"}, 400, "The token 'x' of 'vic' isn't known"),
        ({"act": "role", "name": "vic"}, 400, "'role' must be a text"),
        *(({"act": act, "name": "ann", "role": "viewer"}, 409, "Your own account") for act in ("role", "remove")),
        *(({"act": act, "name": "ann"}, 409, "Your own account") for act in ("password", "logout")),
    ],
    ids=str,
)
def test_what_is_refused(ann: Administrator, change: dict[str, str], status: int, words: str) -> None:
    before = ann.users
    found = ann.change(**change)
    assert found["status"] == status
    assert words in found["text"]
    assert ann.users == before


def test_the_trail_is_filtered(door: Door, ann: Administrator) -> None:
    door.ask("POST", "/api/login", {"name": "100%_\u00e4", "password": "a wrong one"})
    assert ann.trail("filter=100%25_&limit=1") == ["100%_\u00e4: log in: wrong"]
    assert ann.trail("filter=wrong+nobody+at+all") == []
    assert ann.trail("failures=true&limit=1") == ["100%_\u00e4: log in: wrong"]
    assert ann.trail("limit=2")[1] == "ann: log in: ok"
    assert not any(entry.endswith(": ok") for entry in ann.trail("failures=true"))
    assert len(ann.trail("limit=1")) == 1
    headers = door.log_in("ann")
    for query in ("limit=0", "limit=1001", "limit=x", "limit=\u00b2", f"filter={'x' * 201}"):
        reply = door.ask("GET", f"/api/trail?{query}".encode("ascii", "replace").decode(), **headers)
        assert reply.status == 400, query


def test_a_wrong_password_confirms_nothing(door: Door) -> None:
    headers = door.log_in("ann")
    assert door.ask("POST", "/api/confirm", {"password": "a wrong one"}, **headers).status == 401
    assert door.ask("POST", "/api/confirm", {"password": PASSWORD}, **headers).status == 200
    assert door.ask("POST", "/api/confirm", {}, **headers).status == 400


def test_one_administrator_stays_whoever_is_faster(tmp_path: Path) -> None:
    """Both looked first, and changed then."""
    names = [f"admin {number}" for number in range(8)]
    with closing(Accounts(str(tmp_path))) as accounts:
        for name in names:
            accounts.add(name, UserRole.ADMINISTRATOR, "hash")
        refused, barrier = [], threading.Barrier(len(names))

        def demote(name: str) -> None:
            barrier.wait()
            try:
                accounts.set_role(name, UserRole.VIEWER)
            except MissionError as error:
                refused.append(str(error))

        threads = [threading.Thread(target=demote, args=(name,)) for name in names]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert [user.role for user in accounts.users()].count(UserRole.ADMINISTRATOR) == 1
        assert len(refused) == 1
        assert "is the only administrator" in refused[0]
