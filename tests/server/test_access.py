"""Who comes in: by a password, a cookie or a token; and how long somebody who guesses has to wait."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from starlette.requests import Request

from btlang.server.accounts.accounts import Accounts, Identity, UserRole
from btlang.server.accounts.passwords import FREE, Throttle, hash_password
from btlang.server.http import access as module
from btlang.server.http.access import COOKIE, CSRF, Access, AccessError, address_of, host_of, is_same_site
from btlang.task.store.database import store_error
from tests.server.doors import PASSWORD

HERE, THERE = "10.0.0.1", "10.0.0.2"


class Guard:
    """Access to accounts, at times that the test gives."""

    def __init__(self, accounts: Accounts) -> None:
        self.accounts, self.now = accounts, 1000.0
        self.access = Access(accounts, "key", clock=lambda: self.now)

    def log_in(self, name: str, password: str = PASSWORD, address: str = HERE) -> tuple[Identity, str]:
        return asyncio.run(self.access.log_in(name, password, address))

    def status(self, name: str, password: str, address: str = HERE) -> int:
        """That of a log-in which is tried as soon as it may be."""
        try:
            self.log_in(name, password, address)
        except AccessError as error:
            return error.status
        return 200

    def wait(self, name: str, address: str = HERE) -> float:
        """The seconds that somebody with a wrong password has to wait; it isn't looked at if there are any."""
        try:
            self.log_in(name, "a wrong password", address)
        except AccessError as error:
            return error.wait
        raise AssertionError

    def identify(self, changes: bool = False, **headers: str) -> Identity:
        given = {name.replace("_", "-"): value for name, value in headers.items()}
        return asyncio.run(self.access.identify(given, changes=changes))


@pytest.fixture(scope="module")
def password() -> str:
    return hash_password(PASSWORD)


@pytest.fixture
def guard(tmp_path: Path, password: str) -> Iterator[Guard]:
    with closing(Accounts(str(tmp_path))) as accounts:
        for name, role in (("ann", UserRole.ADMINISTRATOR), ("bo", UserRole.VIEWER)):
            accounts.add(name, role, password)
        made = Guard(accounts)
        yield made
        made.access.close()


def refusal(call: Awaitable[Any] | Any) -> AccessError:
    with pytest.raises(AccessError) as refused:
        call()
    return refused.value


def test_a_log_in_begins_a_session(guard: Guard) -> None:
    identity, secret = guard.log_in("bo")
    assert (identity.user, identity.role, identity.is_session) == ("bo", UserRole.VIEWER, True)
    assert guard.identify(cookie=f"{COOKIE}={secret}") == identity
    [entry] = guard.accounts.entries()
    assert (entry.user, entry.address, entry.what, entry.outcome) == ("bo", HERE, "log in", "ok")


@pytest.mark.parametrize("name", ["bo", "nobody", "", "half \ud83d", "x" * 300, "a\nb"])
def test_what_is_wrong_is_in_the_trail(guard: Guard, name: str) -> None:
    error = refusal(lambda: guard.log_in(name, "a wrong password"))
    assert (error.status, error.reason, error.wait) == (401, "The name or the password is wrong.", 0.0)
    [entry] = guard.accounts.entries()
    assert (entry.address, entry.what, entry.outcome) == (HERE, "log in", "wrong")
    assert entry.user == name.replace("\n", "\\n").replace("\ud83d", "\\ud83d")[:100]


def test_somebody_who_guesses_waits_and_is_not_heard(guard: Guard) -> None:
    assert [guard.status("bo", "a wrong password") for _ in range(FREE)] == [401] * FREE
    error = refusal(lambda: guard.log_in("bo"))  # the right one
    assert (error.status, error.wait) == (429, 1.0)
    assert error.reason == "Too many wrong passwords. Try again in 1 s."
    assert guard.status("bo", PASSWORD, THERE) == 200  # where nobody has guessed
    assert guard.wait("ann") == 1.0  # and the address, whatever the account
    assert guard.wait("ann", THERE) == 0.0
    guard.now += 1.0
    assert guard.status("bo", PASSWORD) == 200


def test_guesses_at_many_accounts_count_together(guard: Guard) -> None:
    for number in range(FREE):
        assert guard.wait(f"somebody {number}") == 0.0
    assert guard.wait("another one") == 1.0
    assert guard.wait("another one", THERE) == 0.0


def test_an_account_of_ones_own_makes_guessing_at_others_no_cheaper(guard: Guard) -> None:
    """A correct log-in had cleared the count of the address."""
    for _ in range(FREE - 1):
        assert guard.wait("ann") == 0.0
    guard.log_in("bo")
    assert guard.wait("somebody else") == 0.0
    assert guard.wait("ann") == 1.0


def test_who_mistyped_and_then_was_right_is_forgiven(guard: Guard) -> None:
    for _ in range(3):
        guard.wait("bo")
    guard.wait("ann")
    guard.log_in("bo")
    for number in range(FREE - 1):  # beside the one of ann
        assert guard.wait(f"somebody {number}") == 0.0
    assert guard.wait("somebody else") == 1.0


def test_an_outsider_keeps_nobody_out(guard: Guard) -> None:
    """Three guesses a second had kept a user out who had the right password, and others at that address."""
    guard.log_in("bo")
    device = guard.access.device("", "bo")
    for address in (THERE, HERE):
        for name in ("ann", "bo"):
            for _ in range(30):
                guard.now += 0.3
                guard.status(name, "a wrong password", address)
    assert guard.wait("bo") > 0  # who guesses at the address of bo is still held up
    for _ in range(15):
        assert asyncio.run(guard.access.log_in("bo", PASSWORD, HERE, device))[0].user == "bo"
    assert guard.status("ann", PASSWORD, "10.0.0.3") == 200


def test_a_device_counts_its_own_guesses(guard: Guard) -> None:
    device = guard.access.device("", "bo")
    assert guard.access.device(device, "ann").count(".") == 1
    for _ in range(FREE):
        refusal(lambda: asyncio.run(guard.access.log_in("bo", "a wrong password", HERE, device)))
    assert refusal(lambda: asyncio.run(guard.access.log_in("bo", PASSWORD, HERE, device))).status == 429
    assert refusal(lambda: asyncio.run(guard.access.log_in("ann", PASSWORD + "x", HERE, device))).status == 401
    assert guard.status("bo", PASSWORD) == 200
    forged = device[:-2] + ("AA" if device[-2:] != "AA" else "BB")
    assert guard.access._devices.number(forged, "bo") == ""


def test_guesses_that_come_at_once_count_before_they_are_verified(guard: Guard) -> None:
    """Of sixty, 33 had been verified."""

    async def guess() -> list[int]:
        async def status() -> int:
            try:
                await guard.access.log_in("bo", "a wrong password", HERE)
            except AccessError as error:
                return error.status
            return 200

        return sorted(await asyncio.gather(*(status() for _ in range(60))))

    assert asyncio.run(guess()) == [401] * FREE + [429] * (60 - FREE)


def test_too_many_at_once(guard: Guard, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("btlang.server.accounts.passwords._MOST_WAITING", 0)
    error = refusal(lambda: guard.log_in("bo"))
    assert (error.status, error.wait) == (503, 1.0)
    monkeypatch.undo()
    assert guard.status("bo", PASSWORD) == 200  # which was no wrong password


def test_a_user_who_is_removed_meanwhile_does_not_come_in(guard: Guard, monkeypatch: pytest.MonkeyPatch) -> None:
    begin = guard.accounts.log_in

    def removed(user: str, address: str) -> str:
        secret = begin(user, address)
        guard.accounts.remove(user)
        return secret

    monkeypatch.setattr(guard.accounts, "log_in", removed)
    assert refusal(lambda: guard.log_in("bo")).status == 401


def test_tokens_and_cookies(guard: Guard) -> None:
    token = guard.accounts.add_token("bo", "script")
    _, secret = guard.log_in("bo")
    for header in (f"Bearer {token}", f"bearer  {token} "):
        identity = guard.identify(changes=True, authorization=header)
        assert (identity.user, identity.is_session) == ("bo", False)
    for header in (f"Basic {token}", f"Bearer {secret}", "Bearer", "Bearer btl_wrong", "Bearer half \ud83d"):
        error = refusal(lambda header=header: guard.identify(authorization=header, cookie=f"{COOKIE}={secret}"))
        assert (error.status, error.reason) == (401, "This token isn't valid.")
    for cookie in ("", f"{COOKIE}={token}", f"{COOKIE}=", f"other={secret}", f"{COOKIE}", "\0=;;=" * 3):
        error = refusal(lambda cookie=cookie: guard.identify(cookie=cookie))
        assert (error.status, error.reason) == (401, "Log in first.")
    assert asyncio.run(guard.access.by_token(token)) is not None
    assert asyncio.run(guard.access.by_token(secret)) is None
    assert asyncio.run(guard.access.by_token("")) is None


def test_what_changes_something_comes_from_the_page(guard: Guard) -> None:
    identity, secret = guard.log_in("bo")
    other, _ = guard.log_in("ann")
    cookie, csrf = f"{COOKIE}={secret}", guard.access.csrf(identity)
    assert csrf != guard.access.csrf(other)
    host = "robots.example:8443"
    good = {"cookie": cookie, CSRF.replace("-", "_"): csrf, "host": host}
    for origin in ({}, {"origin": f"https://{host}"}):
        assert guard.identify(changes=True, **{**good, **origin}) == identity
    for bad in (
        {"origin": "https://evil.example"}, {"origin": "null"}, {"origin": "https://robots.example"}, {"origin": ""},
        {"x_csrf_token": ""}, {"x_csrf_token": guard.access.csrf(other)}, {"x_csrf_token": csrf[:-1]},
        {"x_csrf_token": "half \ud83d"}, {"x_csrf_token": f"{csrf}.{csrf}"},
    ):  # fmt: skip
        error = refusal(lambda bad=bad: guard.identify(changes=True, **{**good, **bad}))
        assert (error.status, error.reason) == (403, "This request doesn't come from the page of this server."), bad
        assert guard.identify(changes=False, **{**good, **bad}) == identity
    assert not is_same_site({"origin": "null", "host": ""})
    for odd in ("", "host", "http://[host", "http://", "://host"):
        assert not is_same_site({"origin": odd, "host": "host"}, "https")
    assert [host_of(each) for each in ("a:1", "https://a:1", "[::1]:1", "[x", "")] == ["a", "a", "::1", "", ""]
    page = {"origin": "http://host", "host": "host"}
    assert [is_same_site(page, scheme) for scheme in ("http", "ws", "https", "wss")] == [True, True, False, False]


def test_who_was_here_a_moment_ago_is_known_without_the_disk(guard: Guard) -> None:
    token, gone = guard.accounts.add_token("bo", "script"), guard.accounts.add_token("bo", "gone")
    header = f"Bearer {token}"
    known = guard.identify(authorization=header)
    guard.identify(authorization=f"Bearer {gone}")
    guard.accounts.revoke("bo", "gone")
    guard.accounts.set_role("bo", UserRole.EDITOR)
    guard.now += 9.9
    assert guard.identify(authorization=header) == known
    assert guard.identify(authorization=f"Bearer {gone}")
    guard.now += 0.1
    assert guard.identify(authorization=header).role is UserRole.EDITOR
    assert refusal(lambda: guard.identify(authorization=f"Bearer {gone}")).status == 401
    guard.accounts.set_role("bo", UserRole.OPERATOR)
    now = asyncio.run(guard.access.still(guard.identify(authorization=header)))
    assert now.role is UserRole.OPERATOR
    guard.accounts.revoke("bo", "script")
    assert refusal(lambda: asyncio.run(guard.access.still(now))).status == 401


def test_those_who_are_known_fill_no_memory(guard: Guard, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_MOST_KNOWN", 3)
    tokens = [guard.accounts.add_token("bo", f"script {number}") for number in range(7)]
    for token in tokens:
        assert guard.identify(authorization=f"Bearer {token}").user == "bo"
        assert len(guard.access._known) <= 3
    assert len(guard.access._known) == 1
    for number in range(20):
        refusal(lambda number=number: guard.identify(authorization=f"Bearer btl_{number}"))
    assert len(guard.access._known) <= 3


def test_a_session_begins_on_a_full_disk_and_ends_with_the_password(
    guard: Guard, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(user: str, address: str) -> str:
        raise store_error("here", "the disk is full")

    monkeypatch.setattr(guard.accounts, "log_in", full)
    identity, secret = guard.log_in("bo")
    assert guard.identify(cookie=f"{COOKIE}={secret}") == identity
    guard.now += 11.0
    assert guard.identify(cookie=f"{COOKIE}={secret}") == identity
    assert refusal(lambda: guard.identify(cookie=f"{COOKIE}={secret}x")).status == 401
    guard.accounts.set_password("bo", "other")
    assert refusal(lambda: asyncio.run(guard.access.still(identity))).status == 401
    guard.now += 11.0
    assert refusal(lambda: guard.identify(cookie=f"{COOKIE}={secret}")).status == 401


def test_its_threads_end(guard: Guard) -> None:
    guard.log_in("bo")
    guard.access.close()
    with pytest.raises(RuntimeError, match="after shutdown"):
        guard.log_in("bo")


def wrong(throttle: Throttle, key: str, times: int = 1) -> Throttle:
    for _ in range(times):
        throttle.wrong(key)
    return throttle


def test_wrong_passwords_are_forgotten_after_a_quarter_of_an_hour() -> None:
    now = [0.0]
    throttle = wrong(Throttle(lambda: now[0]), "ann", FREE)
    now[0] = 899.9
    assert wrong(throttle, "ann").wait("ann") == pytest.approx(2.0)
    now[0] += 899.9
    assert throttle.right("ann") == FREE + 1
    assert throttle.right("ann") == 0
    wrong(throttle, "ann", FREE)
    now[0] += 900.0
    assert wrong(throttle, "ann").wait("ann") == 0.0
    assert throttle.right("ann") == 1


def test_of_too_many_the_least_recent_is_forgotten(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("btlang.server.accounts.passwords._MOST_KNOWN", 2)
    throttle = Throttle(lambda: 0.0)
    for key in ("ann", "bo", "ann", "ed"):
        throttle.wrong(key)
    assert [throttle.right(key) for key in ("ann", "bo", "ed")] == [2, 0, 1]


def test_some_wrong_passwords_are_forgiven() -> None:
    throttle = wrong(Throttle(lambda: 0.0), "here", FREE + 2)
    throttle.forgive("here", 2)
    assert throttle.wait("here") == 1.0
    throttle.forgive("here", FREE + 9)
    throttle.forgive("there", 3)
    assert [throttle.right("here"), throttle.right("there")] == [0, 0]


def test_where_somebody_is() -> None:
    assert address_of(Request({"type": "http", "client": (HERE, 5)})) == HERE
    assert address_of(Request({"type": "http"})) == ""


def test_a_trail_that_is_not_kept_keeps_nobody_out(guard: Guard, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_entry: str) -> None:
        guard.accounts.add("ann", UserRole.VIEWER, "")  # which is refused like a full disk is: by a MissionError

    monkeypatch.setattr(guard.accounts, "log", full)
    assert guard.status("bo", PASSWORD) == 200
    assert guard.status("bo", "a wrong password") == 401


def test_accounts_are_changed_only_soon_after_the_password_was_given(guard: Guard) -> None:
    identity, _ = guard.log_in("ann")
    guard.access.require_fresh(identity)
    guard.now += 301.0
    error = refusal(lambda: guard.access.require_fresh(identity))
    assert (error.status, error.code) == (403, module.CONFIRM)
    error = refusal(lambda: asyncio.run(guard.access.confirm(identity, "a wrong password", HERE)))
    assert error.status == 401
    assert guard.accounts.entries()[0].what == "confirm the password"
    refusal(lambda: guard.access.require_fresh(identity))
    asyncio.run(guard.access.confirm(identity, PASSWORD, HERE))
    guard.access.require_fresh(identity)
    for _ in range(FREE):  # guessing costs what it costs at the log-in
        refusal(lambda: asyncio.run(guard.access.confirm(identity, "a wrong password", HERE)))
    assert refusal(lambda: guard.log_in("ann")).status == 429
