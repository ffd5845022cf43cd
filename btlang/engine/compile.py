"""Tree to compiled nodes: subtrees are expanded, then each node is compiled by the function that its id names."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from btlang.engine import (
    blackboard_nodes,
    branch,
    control,
    decorators,
    guards,
    leaves,
    loops,
    nav2,
    reactive,
    script_nodes,
    timed,
    updates,
)
from btlang.engine.bind import Plan, bound_leaf
from btlang.engine.blackboard import Blackboard
from btlang.engine.build import EngineError, Shared, Site, halt_nothing
from btlang.engine.clock import Clock
from btlang.engine.conditions import conditioned
from btlang.engine.leaf import ActionFailed
from btlang.engine.region import at_top, below, regions
from btlang.engine.subtree import child_scope, subtree
from btlang.engine.switch import switch, switch_ports
from btlang.engine.try_catch import try_catch
from btlang.engine.watch import Trace, Watch, repeats
from btlang.engine.whenever import whenever
from btlang.record import Record
from btlang.tree.node import Node, Tree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.build import Compiled

MAX_NODES = 1_000_000


class NodeType(Record):
    """How many children a node has, which ports, and the function that compiles it.

    `waits`: while a child is RUNNING, a tick asks that child, and nothing else happens where it still is.
    """

    compile: Callable[[Site, Sequence[Compiled]], Compiled]
    least: int
    most: int
    ports: tuple[str, ...] = ()
    waits: bool = False


_MANY = MAX_NODES

NODE_TYPES = {
    "Sequence": NodeType(control.sequence, 1, _MANY, waits=True),
    "Fallback": NodeType(control.fallback, 1, _MANY, waits=True),
    "AsyncSequence": NodeType(control.async_sequence, 1, _MANY, waits=True),
    "AsyncFallback": NodeType(control.async_fallback, 1, _MANY, waits=True),
    "SequenceWithMemory": NodeType(control.sequence_with_memory, 1, _MANY, waits=True),
    "Parallel": NodeType(control.parallel, 1, _MANY, ("success_count", "failure_count")),
    "ParallelAll": NodeType(control.parallel_all, 1, _MANY, ("max_failures",)),
    "ReactiveSequence": NodeType(reactive.reactive_sequence, 1, _MANY),
    "ReactiveFallback": NodeType(reactive.reactive_fallback, 1, _MANY),
    "IfThenElse": NodeType(branch.if_then_else, 2, 3, waits=True),
    "WhileDoElse": NodeType(branch.while_do_else, 2, 3),
    **{f"Switch{cases}": NodeType(switch, cases + 1, cases + 1, switch_ports(cases)) for cases in range(2, 7)},
    "TryCatch": NodeType(try_catch, 2, _MANY, ("catch_on_halt",)),
    "Whenever": NodeType(whenever, 3, 3),
    "PipelineSequence": NodeType(nav2.pipeline_sequence, 1, _MANY),
    "RecoveryNode": NodeType(nav2.recovery_node, 2, 2, ("number_of_retries",), waits=True),
    "RoundRobin": NodeType(nav2.round_robin, 1, _MANY, waits=True),
    "Inverter": NodeType(decorators.inverter, 1, 1, waits=True),
    "ForceSuccess": NodeType(decorators.force_success, 1, 1, waits=True),
    "ForceFailure": NodeType(decorators.force_failure, 1, 1, waits=True),
    "Repeat": NodeType(decorators.repeat, 1, 1, ("num_cycles",), waits=True),
    "RetryUntilSuccessful": NodeType(decorators.retry_until_successful, 1, 1, ("num_attempts",), waits=True),
    "Timeout": NodeType(timed.timeout, 1, 1, ("msec",)),
    "Delay": NodeType(timed.delay, 1, 1, ("delay_msec",)),
    "RateController": NodeType(nav2.rate_controller, 1, 1, ("hz",)),
    "KeepRunningUntilFailure": NodeType(guards.keep_running_until_failure, 1, 1, waits=True),
    "RunOnce": NodeType(guards.run_once, 1, 1, ("then_skip",)),
    "Precondition": NodeType(guards.precondition, 1, 1, ("if", "else")),
    "LoopInt": NodeType(loops.loop_int, 1, 1, loops.LOOP_PORTS),
    "LoopBool": NodeType(loops.loop_bool, 1, 1, loops.LOOP_PORTS),
    "LoopDouble": NodeType(loops.loop_double, 1, 1, loops.LOOP_PORTS),
    "LoopString": NodeType(loops.loop_string, 1, 1, loops.LOOP_PORTS),
    "SkipUnlessUpdated": NodeType(updates.skip_unless_updated, 1, 1, ("entry",)),
    "WaitValueUpdate": NodeType(updates.wait_value_update, 1, 1, ("entry",)),
    "WasEntryUpdated": NodeType(updates.was_entry_updated, 0, 0, ("entry",)),
    "Sleep": NodeType(timed.sleep, 0, 0, ("msec",)),
    "AlwaysSuccess": NodeType(leaves.always_success, 0, 0),
    "AlwaysFailure": NodeType(leaves.always_failure, 0, 0),
    "SetBlackboard": NodeType(blackboard_nodes.set_blackboard, 0, 0, ("value", "output_key")),
    "UnsetBlackboard": NodeType(blackboard_nodes.unset_blackboard, 0, 0, ("key",)),
    "Script": NodeType(script_nodes.script, 0, 0, ("code",)),
    "ScriptCondition": NodeType(script_nodes.script_condition, 0, 0, ("code",)),
}
CONDITIONS = frozenset(("ScriptCondition", "WasEntryUpdated"))
"""Those of them that only ask."""
_SUBTREE = NodeType(subtree, 1, 1, waits=True)


def expand(tree: Tree, blackboard: Blackboard, shared: Shared) -> list[Site]:
    """All nodes in preorder; a SubTree's only child is the root of its tree."""
    subtrees = dict(tree.subtrees)
    sites: list[Site] = []
    within: set[str] = set()  # names of the subtrees around the present node
    # what is to come: a node, the site above it, its position there and its blackboard; a str: this subtree ends here
    stack: list[tuple[Node, Site | None, int, Blackboard] | str] = [(tree.root, None, 0, blackboard)]
    while stack:
        top = stack.pop()
        if isinstance(top, str):
            within.remove(top)
            continue
        node, above, position, scope = top
        if len(sites) == MAX_NODES:
            raise EngineError(f"the tree has more than {MAX_NODES:,} nodes", node)
        site = Site(node, len(sites), above, position, scope, shared)
        sites.append(site)
        children = node.children
        if node.id == "SubTree":
            name = node.port("ID")
            if children:
                raise EngineError("SubTree takes no children", node)
            children = (_root_of(node, name, subtrees),)
            if name in within:
                raise EngineError(f"the subtree {name} contains itself", node)
            within.add(name)
            stack.append(name)
            scope = child_scope(node, scope)
        stack += [(children[at], site, at, scope) for at in range(len(children) - 1, -1, -1)]
    return sites


def outline(tree: Tree) -> tuple[list[Node], list[int]]:
    """All nodes in preorder, after expansion of subtrees, and the index of each one's parent, -1 for the root."""
    sites = expand(tree, Blackboard(), Shared(lambda id: None, Clock(), {}, {}, None))
    return [site.node for site in sites], [-1 if site.above is None else site.above.index for site in sites]


def _root_of(node: Node, name: str, subtrees: dict[str, Node]) -> Node:
    if not name:
        raise EngineError("SubTree needs a port ID", node)
    if name not in subtrees:
        raise EngineError(f"there is no subtree {name}", node)
    return subtrees[name]


def compile_sites(sites: Sequence[Site], trace: Trace | None) -> Compiled:
    """Compiles from the last node to the root, so that children are there before their parents."""
    waiting: list[Compiled] = []  # compiled nodes whose parents come later, so that the last ones are the next one's
    watches: list[Watch] = []
    around = regions(sites, _waits)
    for site in reversed(sites):
        node = site.node
        count = 1 if node.id == "SubTree" else len(node.children)
        children: Sequence[Compiled] = ()
        if count:
            children = waiting[: -count - 1 : -1]
            del waiting[-count:]
        above, watch = site.above, None
        if trace is not None:
            lower = watches[: -count - 1 : -1] if count else []
            watch = Watch(site.index, above is not None and repeats(above.node), lower, trace)
            watches[len(watches) - count :] = [watch]
        site.shared.watch = watch
        compiled = compile_node(site, children)
        lasts = compiled[1] is not halt_nothing
        region = around[site.index]
        if region is not None and region.used and region.top == site.index:
            compiled = at_top(region, compiled)
        if watch is not None:
            compiled = watch.wrap(compiled)
        if region is None and above is not None and lasts:
            wider = around[above.index]
            if wider is not None and wider.top != above.index:  # else the way down is not longer
                compiled = below(wider, compiled)
        waiting.append(compiled)
    [root] = waiting
    return root


def _waits(site: Site) -> bool:
    kind = _SUBTREE if site.node.id == "SubTree" else NODE_TYPES.get(site.node.id)
    if kind is None or not kind.waits:
        return False
    for port, text in site.node.ports:
        if (port[:1] == "_" and port != "_autoremap") or ("{" in text and kind is not _SUBTREE):
            return False  # pre-conditions are asked, and a port is read, at each tick
    return True


def compile_node(site: Site, children: Sequence[Compiled]) -> Compiled:
    """One node whose children are compiled. Raises EngineError."""
    node = site.node
    kind = _SUBTREE if node.id == "SubTree" else NODE_TYPES.get(node.id)
    if kind is None:
        compiled = _compile_leaf(site, children)
    else:
        if not kind.least <= len(children) <= kind.most:
            raise site.error(f"{node.id} has {len(children)} children instead of {_how_many(kind)}")
        for port, _ in node.ports:
            if kind is not _SUBTREE and port not in kind.ports and port[:1] != "_":
                raise site.error(f"{node.id} takes no port {port}")
        compiled = kind.compile(site, children)
        for port, text in node.ports:
            if "{" in text and port in kind.ports:
                compiled = _checked(site, compiled)
                break
    return conditioned(site, compiled) if node.ports else compiled


def _compile_leaf(site: Site, children: Sequence[Compiled]) -> Compiled:
    node_id, shared = site.node.id, site.shared
    plan = shared.plans.get(node_id)
    if plan is None:
        binding = shared.bind(node_id)
        if binding is None:
            raise site.error(f"nothing is bound to {node_id}")
        plan = shared.plans[node_id] = Plan(binding)
    if children:
        raise site.error(f"{node_id} is a leaf, which takes no children")
    compiled = bound_leaf(site, plan)
    return compiled if shared.stopwatch is None else shared.stopwatch.wrap(site.index, compiled)


def _how_many(kind: NodeType) -> str:
    if kind.most == _MANY:
        return f"{kind.least} or more"
    return str(kind.least) if kind.least == kind.most else f"{kind.least} or {kind.most}"


def _checked(site: Site, compiled: Compiled) -> Compiled:
    """A node that reads a number from the blackboard and fails where there is none."""
    tick, halt = compiled

    def checked() -> int:
        try:
            return tick()
        except ActionFailed as failed:
            halt(False)
            return site.fail(str(failed))

    return checked, halt
