"""Work that is handed from thread to thread: it is answered, also when nobody works any more."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

from btlang.robots.robot import RobotError
from btlang.ros.simulator.shared import CallQueue
from tests.ros.processes import LONG, wait_until


def refuse() -> None:
    raise RobotError("the hand is full")


def test_questions_are_answered_in_order():
    subscriptions, done = CallQueue(), []
    with ThreadPoolExecutor() as pool:
        first = pool.submit(subscriptions.ask, lambda: done.append(1))
        wait_until(lambda: subscriptions.work(0.0) or first.done(), "the first answer")
        second = pool.submit(subscriptions.ask, refuse)
        wait_until(lambda: subscriptions.work(0.0) or second.done(), "the second answer")
    subscriptions.post(lambda: done.append(2))
    subscriptions.post(lambda: done.append(3))
    subscriptions.work(0.0)
    assert (first.result(), second.result(), done) == ((True, ""), (False, "the hand is full"), [1, 2, 3])


def test_who_waits_is_told_when_nobody_works_any_more():
    subscriptions = CallQueue()
    with ThreadPoolExecutor() as pool:
        waiting = pool.submit(subscriptions.ask, lambda: "done")
        wait_until(waiting.running, "the question")
        subscriptions.close()
        assert waiting.result(LONG) == (False, "the simulated robot is shutting down")
    assert subscriptions.ask(lambda: "done") == (False, "the simulated robot is shutting down")


def test_a_wake_ends_the_wait_also_one_that_came_before():
    subscriptions = CallQueue()
    subscriptions.wake()
    subscriptions.work(3600.0)
