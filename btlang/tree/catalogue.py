"""The catalogue of built-in nodes: what each of them is. The engine has what it does, under the same id.

Sources: the manifests (`providedPorts`) of BehaviorTree.CPP 4.10, and of Nav2's nodes. A new node needs an entry here,
its semantics in engine/compile.py and a row in the behaviour tables of the tests; XML, lints and drawings look it up.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


SEQUENCE, SUBTREE = "Sequence", "SubTree"
"""The ids that others than lowering have to make or know."""
ON_SUCCESS, ON_FAILURE, ON_SKIPPED = "SUCCESS", "FAILURE", "SKIPPED"
BEHAVIOR_TREE_CPP, NAV2, BTLANG = "BehaviorTree.CPP", "Nav2", "btlang"

PRE_CONDITIONS = {
    "_failureIf": (True, ON_FAILURE),
    "_successIf": (True, ON_SUCCESS),
    "_onlyIf": (False, ON_SKIPPED),
    "_skipIf": (True, ON_SKIPPED),
    "_while": (False, ON_SKIPPED),
}
"""Scripts that every node may have, in the order in which they are asked: which answer decides, and the status then.

Some programs add `_onlyIf` to BehaviorTree.CPP, which doesn't know it.
"""
POST_CONDITIONS = ("_onSuccess", "_onFailure", "_onHalted", "_post")
"""Scripts in ports that every node may have."""
SCRIPT, KEY = "script", "key"

MOST_NODES = 1_000_000
"""Of a tree with its subtrees filled in."""
_INT = 2**31 - 1
_UNSIGNED = 2**32 - 1


class Port(Record):
    """A port: `type` as in C++, "" if it is a template or a text that the node interprets.

    `default` is None where the port must be given. `least` and `most` bound the value of a number; None: they depend on
    the node's children. `unit` is "ms", "Hz", "rounds" or "time of day", "" for others. `name_3` is its name in
    version 3. `holds` is SCRIPT or KEY where its text is a script, or the name of an entry without braces.
    """

    type: str = ""
    default: str | None = None
    least: int | None = None
    most: int | None = None
    unit: str = ""
    direction: str = "input"
    name_3: str = ""
    holds: str = ""


class NodeKind(Record):
    """A kind of node. The fields after `ports` are traits: what others need to know about its semantics.

    - `kind`: the tag that names its sort in XML: Control, Decorator, Action, Condition or SubTree.
    - `least`, `most`: the number of children; `roles` are the first ones' parts in it, for drawings and lints.
    - `any_ports`: it takes ports beyond `ports`.
    - `waits`: while a child is RUNNING a tick asks that child, and nothing else happens where it still is.
    - `goes_on`: the status of a child after which the next one is ticked, "" where children don't follow in order;
      `rotates`: the next run begins with another child.
    - `at_once`: children are ticked side by side; `enough`: the port with the number of successes that ends it.
    - `again`: the status of its child after which it runs the child again; `rounds`: the port that limits how often
      (-1: no limit), "" where no port does; `endless`: nothing else limits it either.
    - `reactive`: children before the running one are asked at each tick; `interrupts`: it may halt a running child.
    - `takes_time`: it is RUNNING for some time by itself.
    - `turns`: statuses of its child that it turns into another one.
    - `ends`: the statuses that a leaf can end with, where not every one.
    - `skipped`: which children must be SKIPPED for it to be: "any", "all", "first", "last", "tried" (all but the
      last), "branch" (any but the first) or "never".
    - `keeps_completed`: it does not reset a child that has completed.
    - `alone_in`: the node in which BehaviorTree.CPP takes only one child of this kind, "" if there is none.
    - `symbol`: for drawings; `origin`: the library that has it; `text`: what it does, where that library isn't at hand.
    - `tags_3`: its tags in version 3 of BehaviorTree.CPP, the one to write first, () where it has no such node;
      `is_common_name`: users of version 3 have their own nodes by this name, so that it doesn't show the version.
    """

    id: str
    kind: str
    least: int = 0
    most: int = 0
    roles: tuple[str, ...] = ()
    ports: Mapping[str, Port] = {}
    any_ports: bool = False
    waits: bool = False
    goes_on: str = ""
    rotates: bool = False
    at_once: bool = False
    enough: str = ""
    again: str = ""
    rounds: str = ""
    endless: bool = False
    reactive: bool = False
    interrupts: bool = False
    takes_time: bool = False
    turns: tuple[tuple[str, str], ...] = ()
    ends: tuple[str, ...] = ()
    skipped: str = "any"
    keeps_completed: bool = False
    alone_in: str = ""
    symbol: str = ""
    origin: str = BEHAVIOR_TREE_CPP
    text: str = ""
    tags_3: tuple[str, ...] = ()
    is_common_name: bool = False

    @property
    def asks_first(self) -> bool:
        """Whether its first child is a condition whose failure is an answer."""
        return self.roles[:1] in (("if",), ("while",), ("whenever",))

    @property
    def is_wait(self) -> bool:
        """Whether it is a leaf that only lets time pass."""
        return self.takes_time and not self.most

    def is_endless(self, ports: Sequence[tuple[str, str]]) -> bool:
        """Whether a node of this kind with these ports runs its child again and again without a limit."""
        return dict(ports).get(self.rounds) == "-1" if self.rounds else self.endless


def _control(id: str, least: int = 1, most: int = MOST_NODES, **traits: Any) -> NodeKind:
    return NodeKind(id, "Control", least, most, **traits)


def _decorator(id: str, **traits: Any) -> NodeKind:
    return NodeKind(id, "Decorator", 1, 1, **traits)


def _switch(cases: int) -> NodeKind:
    id = f"Switch{cases}"
    ports = {"variable": Port(), **{f"case_{number}": Port() for number in range(1, cases + 1)}}
    return _control(id, cases + 1, cases + 1, ports=ports, tags_3=(id,))


def _loop(sort: str) -> NodeKind:
    ports = {"queue": Port(), "if_empty": Port(default="SUCCESS"), "value": Port(default="", direction="output")}
    return _decorator(f"Loop{sort}", ports=ports, again=ON_SUCCESS)


_IN_ORDER: dict[str, Any] = {"goes_on": ON_SUCCESS, "skipped": "all", "symbol": "→"}
_IN_TURN: dict[str, Any] = {"goes_on": ON_FAILURE, "skipped": "all", "symbol": "?"}
_AT_ONCE: dict[str, Any] = {"at_once": True, "skipped": "all", "symbol": "⇉"}
_BRANCHES: dict[str, Any] = {"skipped": "branch"}
_MILLISECONDS = Port("unsigned int", None, 0, _UNSIGNED, "ms")
_GOALS = {"goal": Port(default=""), "goals": Port(default="")}
_ROUNDS = Port("int", None, -1, _INT, "rounds")

CATALOGUE: dict[str, NodeKind] = {
    kind.id: kind
    for kind in (
        _control(SEQUENCE, waits=True, tags_3=("Sequence",), **_IN_ORDER),
        _control("AsyncSequence", waits=True, alone_in="ReactiveSequence", **_IN_ORDER),
        _control("SequenceWithMemory", waits=True, tags_3=("SequenceStar",), **_IN_ORDER),
        _control("ReactiveSequence", reactive=True, interrupts=True, tags_3=("ReactiveSequence",), **_IN_ORDER),
        _control("PipelineSequence", origin=NAV2, keeps_completed=True, **_IN_ORDER),
        _control("NonblockingSequence", origin=NAV2, keeps_completed=True, **_AT_ONCE),
        _control(
            "PersistentSequence", ports={"current_child_idx": Port("int", direction="inout")}, origin=NAV2,
            goes_on=ON_SUCCESS, skipped="never", symbol="→",
        ),
        _control("Fallback", waits=True, tags_3=("Fallback", "FallbackStar"), **_IN_TURN),
        _control("AsyncFallback", waits=True, **_IN_TURN),
        _control("ReactiveFallback", reactive=True, interrupts=True, tags_3=("ReactiveFallback",), **_IN_TURN),
        _control(
            "RoundRobin", ports={"wrap_around": Port("bool", "true")}, origin=NAV2, waits=True, rotates=True,
            goes_on=ON_FAILURE, skipped="all",
        ),
        _control(
            "Parallel",
            ports={
                "success_count": Port("int", "-1", name_3="success_threshold"),
                "failure_count": Port("int", "1", name_3="failure_threshold"),
            },
            enough="success_count", tags_3=("Parallel",),
            **_AT_ONCE,
        ),
        _control("ParallelAll", ports={"max_failures": Port("int", "1")}, **_AT_ONCE),
        _control("IfThenElse", 2, 3, roles=("if", "then", "else"), waits=True, tags_3=("IfThenElse",), **_BRANCHES),
        _control(
            "WhileDoElse", 2, 3, roles=("while", "do", "else"), reactive=True, interrupts=True, tags_3=("WhileDoElse",),
            **_BRANCHES,
        ),
        _control(
            "Whenever", 3, 3, roles=("whenever", "reaction", "work"), ports={"once": Port("bool", "false")},
            reactive=True, skipped="last", origin=BTLANG,
            text="Condition, reaction, work. Each time the condition becomes true (with once=true only the first "
            "time), the work is suspended, the reaction runs once, and the work goes on.",
        ),
        _control("TryCatch", 2, ports={"catch_on_halt": Port("bool", "false")}, skipped="tried"),
        _control(
            "RecoveryNode", 2, 2, ports={"number_of_retries": Port("int", "1", 0, _INT)}, waits=True, again=ON_FAILURE,
            rounds="number_of_retries", skipped="first", origin=NAV2,
        ),
        _control(
            "PauseResumeController", 1, 4, skipped="never", origin=NAV2,
            ports={"pause_service_name": Port("std::string", ""), "resume_service_name": Port("std::string", "")},
        ),
        *(_switch(cases) for cases in range(2, 7)),
        _decorator("Inverter", waits=True, turns=(("SUCCESS", "FAILURE"), ("FAILURE", "SUCCESS")), symbol="¬",
                   tags_3=("Inverter",)),
        _decorator("ForceSuccess", waits=True, turns=(("FAILURE", "SUCCESS"),), symbol="✓", tags_3=("ForceSuccess",)),
        _decorator("ForceFailure", waits=True, turns=(("SUCCESS", "FAILURE"),), symbol="✗", tags_3=("ForceFailure",)),
        _decorator("Repeat", ports={"num_cycles": _ROUNDS}, waits=True, again=ON_SUCCESS, rounds="num_cycles",
                   symbol="↻", tags_3=("Repeat",)),
        _decorator("RetryUntilSuccessful", ports={"num_attempts": _ROUNDS}, waits=True, again=ON_FAILURE,
                   rounds="num_attempts", symbol="↺", tags_3=("RetryUntilSuccesful", "RetryUntilSuccessful")),
        _decorator("KeepRunningUntilFailure", waits=True, again=ON_SUCCESS, endless=True, skipped="never",
                   tags_3=("KeepRunningUntilFailure",)),
        *(_loop(sort) for sort in ("Int", "Bool", "Double", "String")),
        _decorator(
            "KeepOut", ports={"zones": Port()}, waits=True, origin=BTLANG,
            text="The robot keeps out of the zones (names between semicolons) while the child runs.",
        ),
        _decorator(
            "KeepIn", ports={"zones": Port()}, waits=True, origin=BTLANG,
            text="The robot stays in the zones (names between semicolons) while the child runs.",
        ),
        _decorator("Timeout", ports={"msec": _MILLISECONDS}, interrupts=True, tags_3=("Timeout",)),
        _decorator("Delay", ports={"delay_msec": _MILLISECONDS}, takes_time=True, tags_3=("Delay",)),
        _decorator("RateController", ports={"hz": Port("double", "10", unit="Hz")}, takes_time=True, origin=NAV2),
        _decorator(
            "SpeedController",
            ports={
                "min_rate": Port("double", "0.1", unit="Hz"), "max_rate": Port("double", "1.0", unit="Hz"),
                "min_speed": Port("double", "0.0"), "max_speed": Port("double", "0.5"), **_GOALS,
            },
            takes_time=True, origin=NAV2,
        ),
        _decorator(
            "DistanceController",
            ports={
                "distance": Port("double", "1.0"), "global_frame": Port("std::string", ""),
                "robot_base_frame": Port("std::string", ""),
            },
            takes_time=True, origin=NAV2,
        ),
        _decorator("GoalUpdatedController", ports=_GOALS, takes_time=True, origin=NAV2),
        _decorator(
            "GoalUpdater",
            ports={
                "input_goal": Port(default=""), "input_goals": Port(default=""),
                "output_goal": Port(default="", direction="output"),
                "output_goals": Port(default="", direction="output"),
            },
            origin=NAV2,
        ),
        _decorator(
            "PathLongerOnApproach",
            ports={
                "path": Port("nav_msgs::msg::Path"), "prox_len": Port("double", "3.0"),
                "length_factor": Port("double", "2.0"),
            },
            origin=NAV2,
        ),
        _decorator("SingleTrigger", origin=NAV2),
        _decorator("RunOnce", ports={"then_skip": Port("bool", "true")}),
        _decorator("Precondition", ports={"if": Port(holds=SCRIPT), "else": Port(default="FAILURE")}),
        _decorator("SkipUnlessUpdated", ports={"entry": Port()}),
        _decorator("WaitValueUpdate", ports={"entry": Port()}, takes_time=True),
        NodeKind("WasEntryUpdated", "Condition", ports={"entry": Port()}),
        NodeKind("ScriptCondition", "Condition", ports={"code": Port(holds=SCRIPT)}),
        NodeKind("Script", "Action", ports={"code": Port(holds=SCRIPT)}),
        NodeKind("SetBlackboard", "Action", ports={"value": Port(), "output_key": Port(holds=KEY)},
                 tags_3=("SetBlackboard",)),
        NodeKind("UnsetBlackboard", "Action", ports={"key": Port()}),
        NodeKind("Sleep", "Action", ports={"msec": _MILLISECONDS}, takes_time=True, ends=("SUCCESS",),
                 is_common_name=True),
        NodeKind("WaitForTime", "Action", ports={"time": Port(unit="time of day")}, takes_time=True, ends=("SUCCESS",),
                 origin=BTLANG, text="Ends when the clock next shows a time of day such as 18:30."),
        NodeKind("AlwaysSuccess", "Action", ends=("SUCCESS",), tags_3=("AlwaysSuccess",)),
        NodeKind("AlwaysFailure", "Action", ends=("FAILURE",), tags_3=("AlwaysFailure",)),
        NodeKind(SUBTREE, "SubTree", ports={"ID": Port()}, any_ports=True, waits=True,
                 tags_3=("SubTree", "SubTreePlus")),
    )
}  # fmt: skip
"""By id."""


CONSTRAINTS = {"keep out": "KeepOut", "keep in": "KeepIn"}
"""The nodes of what a command may ask of others."""
_BETWEEN = re.compile(r"\s*[;,]\s*")


def zone_names(text: str) -> list[str]:
    """Return the names in the port of such a node, or in another one that may hold several."""
    return [name for name in _BETWEEN.split(text.strip()) if name]


def never_ends(node_id: str, ports: Sequence[tuple[str, str]], endless: Sequence[bool]) -> bool:
    """Whether a node with these ports runs until it fails or is stopped; `endless` says which of its children do."""
    kind = CATALOGUE.get(node_id)
    if kind is None or not endless:
        return False
    if kind.goes_on == ON_FAILURE or kind.at_once:
        return all(endless)
    if kind.roles:
        return kind.roles[-1] == "work" and endless[-1]
    if kind.goes_on or kind.takes_time:
        return any(endless)
    return kind.again == ON_SUCCESS and kind.is_endless(ports)


def takes_one_child(node_id: str) -> bool:
    """Whether a node of this kind has exactly one child, so that several can only be one sequence."""
    kind = CATALOGUE.get(node_id)
    return kind is not None and kind.most == 1


def only_port(node_id: str) -> str:
    """Return the port of a leaf that has just one, such as `code` of a script; "" for any other node."""
    kind = CATALOGUE.get(node_id)
    return next(iter(kind.ports)) if kind is not None and not kind.most and len(kind.ports) == 1 else ""


def port_content(node_id: str, port: str) -> str:
    """Return what the text of a port is: SCRIPT, KEY, or "" for a value or a reference."""
    if port in PRE_CONDITIONS or port in POST_CONDITIONS:
        return SCRIPT
    kind = CATALOGUE.get(node_id)
    return kind.ports[port].holds if kind is not None and port in kind.ports else ""
