"""What waits for one client: the newest statuses, the order of what comes, what is lost, and texts that are shared."""

from __future__ import annotations

import asyncio
import json
from typing import Any

import pytest

from btlang.server.live.client_queue import _MOST, _MUCH, ClientQueue, RobotNews
from btlang.server.live.robot_feeds import RobotFeed
from btlang.task.live.feed import Allowance


def statuses(run: str, *changes: tuple[int, str], t: float = 1.0, robot: str = "robot") -> RobotNews:
    return RobotNews(robot, {"type": "statuses", "run": run, "t": t, "changes": [list(change) for change in changes]})


def begun(run: str) -> RobotNews:
    return RobotNews("robot", {"type": "run", "run": run, "task": 1})


def said(text: str, robot: str = "robot") -> RobotNews:
    return RobotNews(robot, {"type": "event", "text": text})


def taken(outlet: ClientQueue) -> list[dict[str, Any]]:
    return [json.loads(text) for text in outlet.take()]


def filled(*news: RobotNews) -> ClientQueue:
    outlet = ClientQueue()
    for each in news:
        outlet.put(each)
    return outlet


def test_statuses_are_merged_and_the_newest_wins() -> None:
    outlet = filled(
        statuses("a", (0, "RUNNING"), (1, "RUNNING")),
        statuses("a", (1, "SUCCESS"), t=2.0),
        statuses("a", (1, "FAILURE"), (2, "RUNNING"), t=3.0),
    )
    [message] = taken(outlet)
    assert dict(message["changes"]) == {0: "RUNNING", 1: "FAILURE", 2: "RUNNING"}
    assert (message["robot"], message["run"], message["t"]) == ("robot", "a", 3.0)
    assert outlet.take() == []


def test_words_are_merged_like_statuses() -> None:
    first, second = statuses("a", (0, "RUNNING")), statuses("a", (0, "SUCCESS"))
    third = statuses("a", (1, "RUNNING"))
    first.message["words"] = [[0, "go to lab"], [1, "wave"]]
    third.message["words"] = [[0, "go to office"]]
    [message] = taken(filled(first, second, third))
    assert dict(message["words"]) == {0: "go to office", 1: "wave"}
    assert "words" not in taken(filled(second, statuses("a", (1, "RUNNING"))))[0]


def test_merging_changes_nothing_that_others_wait_for() -> None:
    first, second = statuses("a", (0, "RUNNING")), statuses("a", (0, "SUCCESS"))
    slow, quick = filled(first), filled(first)
    slow.put(second)
    assert [message["changes"] for message in taken(quick)] == [[[0, "RUNNING"]]]
    quick.put(second)
    assert taken(quick) == taken(slow)
    assert first.message["changes"] == [[0, "RUNNING"]]


def test_clients_share_a_text() -> None:
    first, second, third = (statuses("a", (index, "RUNNING")) for index in range(3))
    texts = [filled(first, second, third).take(), filled(first, second, third).take()]
    assert texts[0][0] is texts[1][0] is not third.text
    assert filled(third).take()[0] is filled(third).take()[0]
    assert len({id(filled(said).take()[0]) for said in [said("hello")] for _ in range(3)}) == 1


def test_statuses_of_a_run_come_before_the_next_run() -> None:
    outlet = filled(begun("a"), statuses("a", (0, "RUNNING")), begun("b"), statuses("b", (0, "FAILURE")))
    assert [(message["type"], message["run"]) for message in taken(outlet)] == [
        ("run", "a"), ("statuses", "a"), ("run", "b"), ("statuses", "b"),
    ]  # fmt: skip


def test_statuses_of_another_run_take_the_place_of_older_ones() -> None:
    [message] = taken(filled(statuses("a", (0, "RUNNING")), statuses("b", (1, "SUCCESS"))))
    assert (message["run"], message["changes"]) == ("b", [[1, "SUCCESS"]])


def test_robots_are_kept_apart() -> None:
    outlet = filled(
        statuses("a", (0, "RUNNING"), robot="anna"),
        statuses("b", (0, "FAILURE"), robot="otto"),
        RobotNews("anna", {"type": "robot", "battery": 90.0}),
        RobotNews("otto", {"type": "robot", "battery": 50.0}),
        RobotNews("anna", {"type": "robot", "battery": 89.0}),
    )
    messages = taken(outlet)
    assert [(m["robot"], m["run"]) for m in messages if m["type"] == "statuses"] == [("anna", "a"), ("otto", "b")]
    assert [(m["robot"], m["battery"]) for m in messages if m["type"] == "robot"] == [("anna", 89.0), ("otto", 50.0)]


def test_what_is_left_out_is_said_once() -> None:
    outlet = filled(*(said(str(number)) for number in range(_MOST + 5)))
    outlet.say('{"type":"result"}')
    messages = taken(outlet)
    assert [message["type"] for message in messages] == ["event"] * _MOST + ["result", "lost"]
    assert messages[_MOST - 1]["text"] == str(_MOST - 1)
    outlet.put(said("again"))
    assert [message["type"] for message in taken(outlet)] == ["event"]


def test_who_takes_nothing_fills_no_memory() -> None:
    outlet = ClientQueue()
    for number in range(3 * _MOST):
        outlet.put(statuses("a", (number % 7, "RUNNING")))
        outlet.put(RobotNews("robot", {"type": "robot", "battery": number}))
    messages = taken(outlet)
    assert [message["type"] for message in messages] == ["statuses", "robot"]
    assert len(messages[0]["changes"]) == 7


def test_an_answer_ends_the_wait_that_a_rate_asks_for() -> None:
    async def both() -> tuple[bool, list[str]]:
        outlet = filled(said("hello"))
        await outlet.wait()
        await outlet.wait_for_answer(0.001)
        waiting = asyncio.ensure_future(outlet.wait_for_answer(1000.0))
        await asyncio.sleep(0)
        before = waiting.done()
        outlet.say("{}")
        await waiting
        return before, outlet.take()

    before, texts = asyncio.run(both())
    assert not before
    assert texts == [said("hello").text, "{}"]


def test_of_other_topics_nothing_waits() -> None:
    outlet = ClientQueue()
    outlet.topics = {"map", "tasks"}
    for kind in ("up", "map", "scan", "robot", "event", "change"):
        outlet.put(RobotNews("kim", {"type": kind, "number": 1}))
    outlet.put(statuses("1", {0: "RUNNING"}))
    outlet.put(RobotNews("kim", {"type": "scan", "number": 2}))
    assert [(each["type"], each.get("number")) for each in taken(outlet)] == [
        ("up", 1),
        ("change", 1),
        ("map", 1),
        ("scan", 2),
    ]


def test_a_client_that_comes_late_gets_what_is_now() -> None:
    link, outlet = RobotFeed("robot"), ClientQueue()
    for message in (
        {"type": "hello", "change": 3},
        begun("a").message,
        statuses("a", (0, "RUNNING"), (1, "RUNNING")).message,
        statuses("a", (1, "SUCCESS"), t=2.0).message,
    ):
        link._take(message)
    link.add(outlet)
    link._take(statuses("a", (0, "SUCCESS"), t=3.0).message)
    messages = taken(outlet)
    assert [message["type"] for message in messages] == ["up", "run", "statuses"]
    assert (dict(messages[2]["changes"]), messages[2]["t"]) == ({0: "SUCCESS", 1: "SUCCESS"}, 3.0)


def test_what_comes_in_step_does_not_wait() -> None:
    allowance = Allowance(0.05)
    for number in range(1000):
        now = number * 0.05 + (0.01 if number % 3 else 0.0)
        assert allowance.wait(now) == 0.0
        allowance.use(now)


def test_what_comes_between_delays_for_a_while_only() -> None:
    allowance, waits = Allowance(0.05), []
    for _ in range(3):
        allowance.use(0.0)
    for number in range(1, 100):
        waits.append(allowance.wait(number * 0.05))
        allowance.use(number * 0.05 + waits[-1])
    assert waits[0] > 0.0
    assert waits[-1] == 0.0


@pytest.mark.parametrize("rate", [0.5, 20.0, 100.0])
def test_no_more_often_than_the_rate(rate: float) -> None:
    allowance, count, now = Allowance(1.0 / rate), 0, 0.0
    while now < 100.0 / rate:
        if allowance.wait(now) == 0.0:
            allowance.use(now)
            count += 1
        now += 0.01 / rate
    assert 95 <= count <= 107


def test_of_a_topic_the_newest_wait() -> None:
    outlet = ClientQueue()
    for number in range(5):
        outlet.keep("/one", f"one {number}", 1)
        outlet.keep("/three", f"three {number}", 3)
    assert outlet.take() == ["one 4", "three 2", "three 3", "three 4"]
    assert outlet.take() == []


def test_who_does_not_read_waits_with_what_he_asks_for() -> None:
    async def asked() -> None:
        outlet = ClientQueue()
        await outlet.wait_for_room()
        for _ in range(50):
            outlet.keep("/big", "x" * 100_000, 100)
        outlet.keep("/small", "x", 100)
        room = asyncio.create_task(outlet.wait_for_room())
        await asyncio.sleep(0)
        assert not room.done()
        assert sum(map(len, outlet.take())) < _MUCH + 200_000
        await asyncio.wait_for(room, 1.0)

    asyncio.run(asked())
