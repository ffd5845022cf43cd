"""Ticks that take too long: what is told of them, and whom they blame."""

from __future__ import annotations

import io
import json
import math
import time
from typing import Any

import pytest

import btlang
from btlang.engine import clock as engine_clock
from btlang.engine.clock import Clock, LeafTimer
from btlang.engine.engine import Engine
from btlang.engine.leaves.leaf import LeafBinding
from btlang.engine.status import RUNNING, SUCCESS
from btlang.run import pace as overruns
from btlang.run import terminal
from btlang.run.bus import Bus
from btlang.run.events import Overrun
from btlang.run.logs import JsonLog, PlainLines
from btlang.run.runner import Runner
from btlang.tree.node import Node, Tree


class Time:
    """Real time that passes only where a leaf takes some."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now = 50.0
        monkeypatch.setattr(engine_clock, "perf_counter", lambda: self.now)
        monkeypatch.setattr(overruns, "perf_counter", lambda: self.now)

    def leaf(self, *seconds: float) -> LeafBinding:
        """A leaf that runs for as many ticks, each of which takes so long."""
        left = list(seconds)

        def call() -> int:
            self.now += left.pop(0)
            return RUNNING if left else SUCCESS

        return LeafBinding(call)


def run(
    root: Node, leaves: dict[str, LeafBinding], speed: float = 1.0, rate: float = 10.0
) -> tuple[Any, list[Overrun]]:
    """Runs with 10 ticks a second, which are 0.1 s; returns the outcome and what was told."""
    told: list[Overrun] = []
    bus = Bus()
    bus.add(lambda event: told.append(event) if isinstance(event, Overrun) else None)
    engine = Engine(Tree(root), leaves.get, clock=bus.clock, stopwatch=LeafTimer())
    outcome = Runner(engine, bus=bus, rate=rate, speed=speed).run()
    assert outcome.status == SUCCESS
    return outcome, told


A, B = Node("A"), Node("B")


def test_the_slowest_leaf_is_blamed(monkeypatch: pytest.MonkeyPatch) -> None:
    real = Time(monkeypatch)
    root = Node("Parallel", (A, B))
    leaves = {"A": real.leaf(0.02, 0.05, 0.01, 0), "B": real.leaf(0.03, 0.2, 0.4, 0)}
    outcome, told = run(root, leaves)
    assert [(round(event.t, 6), event.path, event.node, round(event.seconds, 6)) for event in told] == [
        (0.1, "/1", B, 0.25),
        (0.2, "/1", B, 0.41),
    ]
    assert [event.leaf_seconds for event in told] == [pytest.approx(0.2), pytest.approx(0.4)]
    assert {event.period for event in told} == {0.1}
    assert (outcome.overruns, outcome.worst, outcome.ticks) == (2, (B, pytest.approx(0.4)), 4)


def test_no_leaf_is_blamed_that_took_less_than_half_a_period(monkeypatch: pytest.MonkeyPatch) -> None:
    real = Time(monkeypatch)
    root = Node("Sequence", tuple(Node(id) for id in "ABC"))
    outcome, told = run(root, {id: real.leaf(0.04) for id in "ABC"})
    assert [(event.path, event.node, event.leaf_seconds) for event in told] == [("", None, 0.0)]
    assert (outcome.overruns, outcome.worst) == (1, None)


def test_no_leaf_is_blamed_for_what_may_be_noise(monkeypatch: pytest.MonkeyPatch) -> None:
    real = Time(monkeypatch)
    _, [event] = run(A, {"A": real.leaf(0.015)}, rate=100)
    assert (event.seconds, event.period, event.node) == (pytest.approx(0.015), 0.01, None)


def test_no_leaf_is_blamed_for_what_a_robot_would_give_it(monkeypatch: pytest.MonkeyPatch) -> None:
    real = Time(monkeypatch)
    _, [event, slow] = run(A, {"A": real.leaf(0.09, 0.11)}, speed=100)
    assert (event.seconds, event.period, event.node) == (pytest.approx(0.09), 0.001, None)
    assert (slow.path, slow.leaf_seconds) == ("/", pytest.approx(0.11))


def test_a_leaf_that_is_ticked_often_adds_up(monkeypatch: pytest.MonkeyPatch) -> None:
    real = Time(monkeypatch)
    calls = real.leaf(*[0.04] * 4)
    leaf = LeafBinding(lambda: calls.call() == SUCCESS)
    root = Node("RecoveryNode", (A, Node("AlwaysSuccess")), (("number_of_retries", "9"),))
    _, [event] = run(root, {"A": leaf})
    assert (event.path, event.leaf_seconds) == ("/0", pytest.approx(0.16))


def test_the_time_of_a_halt_counts_too(monkeypatch: pytest.MonkeyPatch) -> None:
    real = Time(monkeypatch)

    class Slow:
        def start(self) -> None: ...

        def tick(self) -> None: ...

        def halt(self) -> None:
            real.now += 0.3

    root = Node("Parallel", (Node("Slow"), B), (("success_count", "1"),))
    _, [event] = run(root, {"Slow": LeafBinding(Slow), "B": real.leaf(0, 0)})
    assert (event.path, event.leaf_seconds) == ("/0", pytest.approx(0.3))


def test_nothing_is_measured_at_full_speed(monkeypatch: pytest.MonkeyPatch) -> None:
    real = Time(monkeypatch)
    outcome, told = run(A, {"A": real.leaf(9.0, 9.0)}, speed=math.inf)
    assert (told, outcome.overruns, outcome.worst) == ([], 0, None)


def test_no_wrapper_is_compiled_in_without_a_stopwatch(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(engine_clock, "perf_counter", lambda: 1 / 0)
    engine = Engine(Tree(A), {"A": LeafBinding(lambda: None)}.get, clock=Clock())
    assert engine.tick() == SUCCESS


SLOW = Overrun(2.0, "r1", 7, 1.5, 0.4, 0.05, "/1", A, 0.31)


def test_the_log_has_it() -> None:
    output = io.StringIO()
    log = JsonLog(output, lambda node: "look around")
    log(SLOW)
    log(Overrun(3.0, "r1", 8, 1.5, 0.06, 0.05))
    assert [json.loads(line) for line in output.getvalue().splitlines()] == [
        {
            "t": 2.0, "event": "overrun", "seconds": 0.4, "period": 0.05,
            "path": "/1", "id": "A", "name": "look around", "ports": {}, "leaf_seconds": 0.31,
            "number": 7, "wall": 1.5, "run": "r1",
        },
        {"t": 3.0, "event": "overrun", "seconds": 0.06, "period": 0.05, "number": 8, "wall": 1.5, "run": "r1"},
    ]  # fmt: skip


def test_one_line_a_leaf() -> None:
    lines: list[str] = []
    sink = PlainLines(lambda node: "look around", lambda node: True, lines.append)
    for event in (
        SLOW.replace(t=1.0, node=None, path=""),
        SLOW,
        SLOW.replace(t=3.0),
        SLOW.replace(t=4.0, path="/2", period=0.0025),
    ):
        sink(event)
    assert lines == [
        "   2.00  slow   look around: took 0.31 s, but a tick has only 0.05 s",
        "   4.00  slow   look around: took 0.31 s, but a tick has only 0.0025 s",
    ]


def test_the_end_of_a_run_names_it(capsys: pytest.CaptureFixture[str]) -> None:
    @btlang.action("peer about")
    def peer_about() -> None:
        time.sleep(0.12)

    tree = btlang.parse_tree("peer about then wait 1 s then peer about", keywords=[peer_about])
    assert terminal.run_mission(tree, btlang.Session, speed=10, rate=100, time_limit=None, log=None, quiet=False) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line[:28] for line in lines if " slow " in line] == [
        "   0.00  slow   peer about: ",
        "   1.00  slow   peer about: ",
    ]
    assert lines[-2].split("; ")[1].startswith('the slowest leaf was "peer about" with 0.1')
    assert int(lines[-2].split(" ")[0]) >= 2
    assert " of 101 ticks took too long; " in lines[-2]
    assert lines[-1] == "The mission succeeded in 1.0 s."
