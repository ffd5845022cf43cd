"""The JSON log and the lines for people."""

from __future__ import annotations

import io
import json

import btlang
from btlang.engine.changes import Changes
from btlang.engine.instance import Fault, NodeInstance
from btlang.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS
from btlang.run.events import Bumped, Dropped, Event, FaultInjected, Printed, RobotEvent, Said, StatusesChanged, Stuck
from btlang.run.logs import JsonLog, PlainLines
from btlang.text.source import Source, Span
from btlang.tree.node import Node

GO = Node("GoTo", ports=(("place", "the lab"),))
SEE = Node("See")


def label(node: Node) -> str:
    return {"GoTo": "go to the lab", "See": "i see a person", "Sleep": "wait 5 s"}.get(node.id, node.name or node.id)


class One:
    """The only node of a tree, at /0/1."""

    def __init__(self, node: Node) -> None:
        self._node = node

    def path(self, index: int) -> str:
        return "/0/1"

    def node(self, index: int) -> Node:
        return self._node

    def reason(self, index: int, fault: Fault | NodeInstance | None) -> str:
        return "" if fault is None else str(fault.reason)


def changed(t: float, node: Node, status: int, reason: str = "") -> StatusesChanged:
    changes = Changes()
    changes.add(3, IDLE, status, Fault(3, reason) if reason else None)
    return StatusesChanged(t, "r1", 7, 1.5, changes, One(node))


def happened(t: float, kind: type[Event], *data: object) -> Event:
    return kind(t, "r1", 7, 1.5, *data)


class Output(io.StringIO):
    """Counts flushes."""

    flushes = 0

    def flush(self) -> None:
        self.flushes += 1


def test_json_lines() -> None:
    output = Output()
    log = JsonLog(output, label)
    log(changed(0.1 + 0.2, GO, RUNNING))
    log(changed(9.8, GO, FAILURE, "the way is blocked"))
    log(happened(2.0, Said, "héllo\nyou"))
    log(happened(2.5, RobotEvent, "pose", {"where": complex(1, 2)}))
    where = {"path": "/0/1", "id": "GoTo", "name": "go to the lab", "ports": {"place": "the lab"}}
    common = {"number": 7, "wall": 1.5, "run": "r1"}
    lines = output.getvalue().splitlines()
    assert [json.loads(line) for line in lines] == [
        {"t": 0.3, **where, "status": "RUNNING", "before": "IDLE", **common},
        {"t": 9.8, **where, "status": "FAILURE", "before": "IDLE", "reason": "the way is blocked", **common},
        {"t": 2.0, "event": "say", "text": "héllo\nyou", **common},
        {"t": 2.5, "event": "robot", "kind": "pose", "data": {"where": "(1+2j)"}, **common},
    ]
    assert lines[0].startswith('{"t": 0.3, "path": "/0/1", "id": "GoTo"')
    assert output.flushes == 4


def test_human_lines() -> None:
    written: list[str] = []
    sink = PlainLines(label, lambda node: node.id == "GoTo", written.append)
    for t, node, status, reason in [
        (0.0, SEE, SUCCESS, ""),
        (0.0, Node("Sequence"), RUNNING, ""),
        (1.35, GO, RUNNING, ""),
        (9.8, GO, SUCCESS, ""),
        (10.0, GO, FAILURE, "the way is blocked"),
        (11.0, GO, IDLE, ""),
        (12.0, GO, SKIPPED, ""),
        (1234.5, Node("Sleep", span=Span(Source("wait 5 s"), 0, 8)), RUNNING, ""),
        (1235.0, Node("Sleep"), RUNNING, ""),  # the timer of a form
    ]:
        sink(changed(t, node, status, reason))
    sink(happened(2.0, Said, "hello"))
    sink(happened(2.0, Printed, "hello"))
    sink(happened(2.1, Bumped, "a wall"))
    sink(happened(2.1, RobotEvent, "pose", {"x": 1}))
    sink(happened(2.2, Dropped, "right", "cup"))
    sink(happened(2.3, Stuck))
    sink(happened(2.4, FaultInjected, "laser", "the laser scanner is silent"))
    assert written == [
        "   1.35  start  go to the lab",
        "   9.80  done   go to the lab",
        "  10.00  failed go to the lab: the way is blocked",
        "  11.00  halted go to the lab",
        "  12.00  skipped go to the lab",
        "1234.50  start  wait 5 s",
        '   2.00  says   "hello"',
        '   2.00  prints "hello"',
        "   2.10  bumps  a wall",
        "   2.20  drops  cup",
        "   2.30  stuck",
        "   2.40  fault  the laser scanner is silent",
    ]


def test_lines_show_the_values_that_a_command_worked_with() -> None:
    tree = btlang.parse_tree(
        'meet {someone} is say "hello {someone}"\nfor each spot in door, hall: go to spot\nmeet Alice\n'
    )
    written: list[str] = []
    tree.run(speed="max", sinks=[PlainLines(tree.label, tree.is_action, written.append)])
    assert [line.split(None, 1)[1] for line in written if "says" not in line] == [
        "start  go to door",
        "done   go to door",
        "start  go to hall",
        "done   go to hall",
        'start  say "hello Alice"',
        'done   say "hello Alice"',
    ]
