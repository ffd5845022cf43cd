"""Who is here: pages say what they show, and hear of each other as long as their sockets last."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from contextlib import ExitStack
from typing import Any

import pytest
from websockets.sync.client import ClientConnection

from btlang.server.live import clients as presence
from tests.server.doors import Door, received
from tests.task.layers import LONG

TEA = {"robot": "robot", "screen": "write", "mission": "tea", "changing": False}


def page(door: Door, user: str) -> ClientConnection:
    return door.socket(cookie=door.log_in(user)["cookie"])


def show(connection: ClientConnection, **fields: Any) -> dict[str, Any]:
    connection.send(json.dumps({"id": 1, "type": "presence", **TEA, **fields}))
    return received(connection, type="result", id=1)


def seen(connection: ClientConnection, wanted: Callable[[list[dict[str, Any]]], object]) -> list[dict[str, Any]]:
    """The next list of people that is as wanted."""
    until = time.monotonic() + LONG
    while time.monotonic() < until:
        people: list[dict[str, Any]] = received(connection, type="people")["people"]
        if wanted(people):
            return people
    raise AssertionError(wanted)


def names(people: list[dict[str, Any]]) -> list[str]:
    return [each["user"] for each in people]


def test_two_people_hear_of_each_other_before_anybody_saves(door: Door) -> None:
    with page(door, "ann") as ann, page(door, "ed") as ed:
        first = show(ann)["page"]
        assert names(seen(ann, bool)) == ["ann"]
        second = show(ed, changing=True)["page"]
        people = seen(ann, lambda people: len(people) == 2)
        assert [each["page"] for each in people] == [first, second]
        assert people[1] == {**TEA, "page": second, "user": "ed", "changing": True}
        assert show(ed, screen="watch", mission="")["page"] == second
        assert seen(ann, lambda people: people[1]["screen"] == "watch")[1]["mission"] == ""
        ed.close()
        assert names(seen(ann, lambda people: len(people) == 1)) == ["ann"]


def test_who_is_revoked_is_gone_from_the_list(door: Door) -> None:
    door.user("add", "guest", "--role", "viewer")
    with page(door, "ann") as ann, page(door, "guest") as guest:
        show(ann)
        show(guest)
        seen(ann, lambda people: names(people) == ["ann", "guest"])
        door.user("remove", "guest")
        seen(ann, lambda people: names(people) == ["ann"])


def test_two_windows_of_one_user_are_two_pages(door: Door) -> None:
    cookie = door.log_in("ed")["cookie"]
    with door.socket(cookie=cookie) as one, door.socket(cookie=cookie) as other:
        pages = [show(one)["page"], show(other)["page"]]
        assert [each["page"] for each in seen(one, lambda people: len(people) == 2)] == pages


def test_who_shows_nothing_hears_nothing(door: Door) -> None:
    """Somebody who only subscribed, and somebody who isn't logged in."""
    with page(door, "ann") as ann, page(door, "ed") as silent, door.socket() as stranger:
        assert json.loads(stranger.recv(LONG))["type"] == "auth_required"
        silent.send(json.dumps({"id": 1, "type": "subscribe"}))
        received(silent, id=1)
        show(ann)
        seen(ann, bool)
        with pytest.raises(TimeoutError):
            stranger.recv(0.5)
        silent.send(json.dumps({"id": 2, "type": "ping"}))
        while (message := json.loads(silent.recv(LONG))).get("id") != 2:
            assert message["type"] != "people"


def test_programs_are_not_people(door: Door) -> None:
    token = door.user("token", "olga", "no person")
    with door.socket(authorization=f"Bearer {token}") as program:
        refused = show(program)
        assert (refused["ok"], refused["status"]) == (False, 403)


@pytest.mark.parametrize(
    "fields",
    [
        {"robot": 1}, {"robot": None}, {"robot": "r" * 201}, {"screen": "kitchen"}, {"screen": []}, {"mission": {}},
        {"mission": "m" * 201}, {"changing": 1}, {"changing": "yes"},
    ],
)  # fmt: skip
def test_hostile_values_are_refused_and_not_passed_on(door: Door, fields: dict[str, Any]) -> None:
    with page(door, "ed") as ed:
        refused = show(ed, **fields)
        assert (refused["ok"], refused["status"]) == (False, 400)
        show(ed, mission="</script>\ud83d\0")
        assert seen(ed, bool)[0]["mission"] == "</script>\ud83d\0"


def test_a_million_names_cost_their_page_alone(door: Door) -> None:
    """Each name replaces the one before, and lists are sent a few times a second, however often it changes."""
    with page(door, "ann") as ann, page(door, "ed") as ed:
        show(ann)
        seen(ann, bool)
        began = time.monotonic()
        for number in range(3000):
            ed.send(json.dumps({"type": "presence", **TEA, "mission": f"{number}"}))
            if number % 100 == 99:
                show(ed, mission=f"{number}")
        lists = 0
        while True:
            people = received(ann, type="people")["people"]
            lists += 1
            if people[-1]["mission"] == "2999":
                break
        assert len(people) == 2
        assert lists <= (time.monotonic() - began) / 0.2 + 2


def test_a_user_opens_only_so_many_pages(door: Door) -> None:
    with ExitStack() as stack, page(door, "ann") as ann:
        pages = [stack.enter_context(page(door, "ed")) for _ in range(3)]
        before = presence.MOST_PAGES_OF_USER
        cookie = door.log_in("ed")["cookie"]
        pages += [stack.enter_context(door.socket(cookie=cookie)) for _ in range(before - 3)]
        assert all(show(each)["ok"] for each in pages)
        one_more = stack.enter_context(door.socket(cookie=cookie))
        assert show(one_more)["status"] == 429
        assert show(pages[0], mission="another")["ok"]
        assert show(ann)["ok"]
