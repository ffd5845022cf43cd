"""Plans for py_trees: each node of a tree becomes its own node if that means the same, else one of ours."""

from __future__ import annotations

from collections.abc import Callable

from btlang.backends.checking import accept_anything, tree_problems
from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic
from btlang.engine.blackboard import Blackboard
from btlang.engine.clock import Clock
from btlang.engine.compile import expand
from btlang.engine.conditions import is_editor_attribute
from btlang.engine.instance import EngineState, NodeInstance
from btlang.engine.leaves.leaf import LeafBinding
from btlang.printer.phrase import phrase_of
from btlang.support.record import Record
from btlang.text.source import NOWHERE
from btlang.tree.catalogue import CATALOGUE, SUBTREE, Port, zone_names
from btlang.tree.node import Node, Tree
from btlang.vocabulary.lexicon import Lexicon

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

ON_COMPLETION = "common.OneShotPolicy.ON_COMPLETION"
DEEPEST = 250
"""Levels of a tree; py_trees calls itself at each one."""


class Variable(Record):
    """An argument that is a variable."""

    text: str


class Part(Record):
    """A call of `make` with a name, the parts below it, and further arguments.

    `make` is a class of node.py and the modules beside it, "composites.Sequence" or another of py_trees, "leaf",
    "parent" for a node of another program with children, or "engine_leaf". `starts` marks an action that stops others
    before it starts (see `interrupting` in node.py).
    """

    make: str
    name: str
    children: tuple[Part, ...] = ()
    arguments: tuple[tuple[str, Any], ...] = ()
    starts: bool = False


class SubtreeValues(Record):
    """The values of a subtree: the variable that holds them, its ports, and the variable of those around it."""

    name: str
    ports: tuple[tuple[str, str], ...]
    around: str


class Plan(Record):
    """A plan of a tree; `scopes` come before those within them."""

    root: Part
    scopes: tuple[SubtreeValues, ...]
    uses: frozenset[str]  # what is called


class _Inexpressible(Exception):
    """An error that says why py_trees can't express a node."""


def plan_of(
    tree: Tree, vocabulary: Lexicon, is_action: Callable[[Node], bool] | None = None, *, with_parents: bool = False
) -> Plan:
    """Plan a tree, each use of a subtree for itself. `is_action` says which leaves take more than one tick.

    With `with_parents`, unknown nodes with children are parts "parent".

    Raises MissionError with all errors of the tree (BT126, BT131, BT132), or all that py_trees can't express (BT134).
    """
    problems = tree_problems(tree, vocabulary, lambda id: LeafBinding(accept_anything))
    problems = [problem for problem in problems if not (with_parents and problem.code == "BT131")]
    if problems:
        raise MissionError(problems)
    instances = expand(tree, Blackboard(), EngineState(lambda id: None, Clock(), {}, {}, None))
    planner = _Planner(instances, tree, vocabulary, is_action)
    return planner.plan()


class _Planner:
    def __init__(
        self, instances: list[NodeInstance], tree: Tree, vocabulary: Lexicon, is_action: Callable[[Node], bool] | None
    ) -> None:
        self._instances = instances
        self._vocabulary = vocabulary
        self._conditions = {model.id for model in tree.models if model.kind == "Condition"}
        self._is_action = is_action or self._takes_time
        self._suspended = [False] * len(instances)  # below a Whenever: all must be able to stop and go on
        self._asked = [False] * len(instances)  # again while others run
        self._skips = [False] * len(instances)
        self._acts = [False] * len(instances)  # holds an action
        self._scopes = [""] * len(instances)  # of the children
        self._depths = [0] * len(instances)
        self._problems: list[Diagnostic] = []
        self._uses: set[str] = set()

    def plan(self) -> Plan:
        scopes = [scope for instance in self._instances if (scope := self._look_down(instance)) is not None]
        waiting: list[tuple[int, Part]] = []  # parts whose parents come later, so that the last ones are the next one's
        for instance in reversed(self._instances):
            count = 1 if instance.node.id == SUBTREE else len(instance.node.children)
            below = waiting[: -count - 1 : -1] if count else []
            del waiting[len(waiting) - count :]
            part = self._part(instance, [index for index, _ in below], tuple(part for _, part in below))
            waiting.append((instance.index, part))
        if self._problems:
            raise MissionError(self._problems)
        return Plan(waiting[0][1], tuple(scopes), frozenset(self._uses))

    def _look_down(self, instance: NodeInstance) -> SubtreeValues | None:
        """Return the scope that a node has because of those around it."""
        index, above = instance.index, instance.above
        around = "values"
        if above is not None:
            around = self._scopes[above.index]
            self._depths[index] = self._depths[above.index] + 1
            self._suspended[index] = self._suspended[above.index] or (
                above.node.id == "Whenever" and instance.position > 0
            )
            kind = CATALOGUE.get(above.node.id)
            before = 0
            if kind is not None and kind.reactive:
                before = 1 if kind.asks_first else len(above.node.children) - 1
            self._asked[index] = self._asked[above.index] or instance.position < before
        self._scopes[index] = around
        if instance.node.id != SUBTREE:
            return None
        self._scopes[index] = f"values_{index}"
        return SubtreeValues(self._scopes[index], instance.node.ports, around)

    def _part(self, instance: NodeInstance, below: list[int], children: tuple[Part, ...]) -> Part:
        node, index = instance.node, instance.index
        self._acts[index] = any(self._acts[i] for i in below) or (not node.children and self._is_action(node))
        part = Part("Skipped", self._name(node))
        try:
            if self._depths[index] == DEEPEST + 1:  # once is enough
                raise _Inexpressible(f"it is more than {DEEPEST} levels deep, and py_trees recurses at each level")
            if self._always_skipped(node):
                self._skips[index] = True
            else:
                part = self._express(instance, below, children)
        except _Inexpressible as problem:
            span = node.span or NOWHERE
            self._problems.append(diagnostic("BT134", span, id=node.id, target="py_trees", reason=str(problem)))
        self._uses.add(part.make)
        if part.starts:
            self._uses.add("interrupting")
        return part

    def _express(self, instance: NodeInstance, below: list[int], children: tuple[Part, ...]) -> Part:
        node, index = instance.node, instance.index
        if not children:
            return self._leaf(instance)
        skips = [self._skips[i] for i in below]
        kind = CATALOGUE.get(node.id)
        if kind is None:
            if any(skips):
                raise _Inexpressible("a child of it can be skipped, and only btlang's nodes know that")
            return Part("parent", self._name(node), children, (("id", node.id), ("ports", dict(node.ports))))
        self._skips[index] = _SKIPPED[kind.skipped](skips)
        if node.id == "RunOnce":
            self._skips[index] = skips[0] or _truth(node, "then_skip")
        native = not self._suspended[index] and not any(skips) and (node.id != "RunOnce" or not self._skips[index])
        if node.id in ("ReactiveSequence", "ReactiveFallback"):
            native = native and not any(self._acts[i] for i in below[:-1])
        make, arguments = THEIRS[node.id] if native and node.id in THEIRS else _ours(node)
        return Part(make, self._name(node), children, arguments)

    def _leaf(self, instance: NodeInstance) -> Part:
        node, index = instance.node, instance.index
        ports = tuple((port, text) for port, text in node.ports if port != "_skipIf")
        scope = Variable(self._scopes[index])
        if node.id == "Sleep" and "{" not in node.port("msec"):
            seconds = int(node.port("msec")) / 1000
            return Part("Sleep", self._name(node), (), (("seconds", seconds), ("now", Variable("now"))))
        if node.id in ("AlwaysSuccess", "AlwaysFailure"):
            return Part(f"behaviours.{node.id.removeprefix('Always')}", self._name(node))
        starts = self._asked[index] and self._acts[index]
        if node.id in CATALOGUE:
            given = (("id", node.id), ("ports", dict(ports)), ("values", scope), ("now", Variable("now")))
            return Part("engine_leaf", self._name(node), (), given, starts)
        return Part("leaf", self._name(node), (), (("id", node.id), ("ports", dict(ports)), ("values", scope)), starts)

    def _takes_time(self, node: Node) -> bool:
        if node.id in CATALOGUE or node.id in self._conditions:
            return False
        entry = self._vocabulary.entry(node.id)
        return entry is None or entry.sort == "action"

    def _always_skipped(self, node: Node) -> bool:
        for port, text in node.ports:
            if port[:1] != "_" or port == "_autoremap" or is_editor_attribute(port):
                continue
            if port != "_skipIf" or text not in ("true", "false"):
                raise _Inexpressible(f"py_trees has no {port}")
        return node.port("_skipIf") == "true"

    def _name(self, node: Node) -> str:
        if node.name or node.id == SUBTREE:
            return node.name or node.port("ID")
        return node.id if node.children else phrase_of(node.replace(ports=_without_conditions(node)), self._vocabulary)


_SKIPPED: dict[str, Callable[[list[bool]], bool]] = {
    "any": any,
    "all": all,
    "first": lambda skips: skips[0],
    "last": lambda skips: skips[-1],
    "tried": lambda skips: all(skips[:-1]),
    "branch": lambda skips: any(skips[1:]),
    "never": lambda skips: False,
}
"""Whether a node can be skipped, by whether its children can be, for each way of NodeKind.skipped."""

_INTERRUPTS = (("interrupts", Variable("interrupts")),)
OURS = {
    "Sequence": "SkippableSequence",
    "Fallback": "SkippableFallback",
    **{id: id for id in ("SequenceWithMemory", "IfThenElse", "PipelineSequence", "RoundRobin", SUBTREE)},
    **{id: id for id in ("Inverter", "ForceSuccess", "ForceFailure", "KeepRunningUntilFailure")},
}
_REACTIVE = ("ReactiveSequence", "ReactiveFallback", "WhileDoElse", "Whenever")
THEIRS: dict[str, tuple[str, tuple[tuple[str, Any], ...]]] = {
    "Sequence": ("composites.Sequence", (("memory", True),)),
    "Fallback": ("composites.Selector", (("memory", True),)),
    "ReactiveSequence": ("composites.Sequence", (("memory", False),)),
    "ReactiveFallback": ("composites.Selector", (("memory", False),)),
    "ForceSuccess": ("decorators.FailureIsSuccess", ()),
    "ForceFailure": ("decorators.SuccessIsFailure", ()),
    "KeepRunningUntilFailure": ("decorators.SuccessIsRunning", ()),
    "RunOnce": ("decorators.OneShot", (("policy", Variable(ON_COMPLETION)),)),
    SUBTREE: ("decorators.PassThrough", ()),
}
"""The nodes of py_trees that mean the same where no child can be skipped, and nothing has to be suspended.

Its Inverter does not: it makes a SUCCESS of a condition that could not know.
"""


def _ours(node: Node) -> tuple[str, tuple[tuple[str, Any], ...]]:
    """Return our class for a node, and its arguments."""
    if node.id == "RoundRobin" and not _truth(node, "wrap_around"):
        raise _Inexpressible("py_trees has no such node without wrap_around and btlang has no replacement")
    if node.id in OURS:
        return OURS[node.id], ()
    if node.id == "Whenever":
        return node.id, (("once", _truth(node, "once")), *_INTERRUPTS)
    if node.id in _REACTIVE:
        return node.id, _INTERRUPTS
    if node.id == "RunOnce":
        return node.id, (("then_skip", _truth(node, "then_skip")),)
    if node.id in ("KeepOut", "KeepIn"):
        return node.id, (("names", zone_names(_constant(node, "zones"))), ("zones", Variable("zones")))
    if node.id == "TryCatch" and not _truth(node, "catch_on_halt"):
        return node.id, ()
    if node.id not in NUMBERS:
        what = "with catch_on_halt " if node.id == "TryCatch" else ""
        raise _Inexpressible(f"py_trees has no such node {what}and btlang has no replacement")
    make, names = NUMBERS[node.id]
    arguments: list[tuple[str, Any]] = []
    for name, port in zip(names, CATALOGUE[node.id].ports.items(), strict=True):
        arguments += _argument(node, name, *port)
    return make, tuple(arguments)


def _argument(node: Node, name: str, port: str, kind: Port) -> list[tuple[str, Any]]:
    """Return a port of numbers as an argument of our class; times are in seconds there, and need a clock."""
    text = node.port(port) or kind.default or ""
    if "{" in text:
        raise _Inexpressible(f"its {port} is a value of the mission, and py_trees needs a number")
    if kind.unit == "ms":
        return [(name, float(text) * 0.001), ("now", Variable("now"))]
    if kind.unit == "Hz":
        return [(name, 1 / float(text)), ("now", Variable("now"))]
    return [(name, int(text))]


NUMBERS: dict[str, tuple[str, tuple[str, ...]]] = {
    "Parallel": ("Parallel", ("successes", "failures")),
    "ParallelAll": ("ParallelAll", ("failures",)),
    "Repeat": ("Repeat", ("most",)),
    "RetryUntilSuccessful": ("Retry", ("most",)),
    "RecoveryNode": ("RecoveryNode", ("retries",)),
    "Timeout": ("Timeout", ("seconds",)),
    "Delay": ("Delay", ("seconds",)),
    "RateController": ("RateController", ("seconds",)),
}
"""Our class, and its arguments for the ports of the node."""


def _truth(node: Node, port: str) -> bool:
    return _constant(node, port) in ("true", "1")


def _constant(node: Node, port: str) -> str:
    text = node.port(port) or CATALOGUE[node.id].ports[port].default or ""
    if "{" in text:
        raise _Inexpressible(f"its {port} is a value of the mission, and py_trees needs a constant")
    return text


def _without_conditions(node: Node) -> tuple[tuple[str, str], ...]:
    return tuple((port, text) for port, text in node.ports if port[:1] != "_")
