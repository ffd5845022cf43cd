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
from btlang.engine.switch import switch
from btlang.engine.try_catch import try_catch
from btlang.engine.watch import Trace, Watch, repeats
from btlang.engine.whenever import whenever
from btlang.tree.catalogue import CATALOGUE, MOST_NODES, SUBTREE, NodeKind
from btlang.tree.node import Node, Tree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.build import Compiled


SEMANTICS: dict[str, Callable[[Site, Sequence[Compiled]], Compiled]] = {
    "Sequence": control.sequence,
    "Fallback": control.fallback,
    "AsyncSequence": control.async_sequence,
    "AsyncFallback": control.async_fallback,
    "SequenceWithMemory": control.sequence_with_memory,
    "Parallel": control.parallel,
    "ParallelAll": control.parallel_all,
    "ReactiveSequence": reactive.reactive_sequence,
    "ReactiveFallback": reactive.reactive_fallback,
    "IfThenElse": branch.if_then_else,
    "WhileDoElse": branch.while_do_else,
    **{f"Switch{cases}": switch for cases in range(2, 7)},
    "TryCatch": try_catch,
    "Whenever": whenever,
    "PipelineSequence": nav2.pipeline_sequence,
    "RecoveryNode": nav2.recovery_node,
    "RoundRobin": nav2.round_robin,
    "Inverter": decorators.inverter,
    "ForceSuccess": decorators.force_success,
    "ForceFailure": decorators.force_failure,
    "Repeat": decorators.repeat,
    "RetryUntilSuccessful": decorators.retry_until_successful,
    "Timeout": timed.timeout,
    "Delay": timed.delay,
    "RateController": nav2.rate_controller,
    "KeepRunningUntilFailure": guards.keep_running_until_failure,
    "RunOnce": guards.run_once,
    "Precondition": guards.precondition,
    "LoopInt": loops.loop_int,
    "LoopBool": loops.loop_bool,
    "LoopDouble": loops.loop_double,
    "LoopString": loops.loop_string,
    "SkipUnlessUpdated": updates.skip_unless_updated,
    "WaitValueUpdate": updates.wait_value_update,
    "WasEntryUpdated": updates.was_entry_updated,
    "Sleep": timed.sleep,
    "AlwaysSuccess": leaves.always_success,
    "AlwaysFailure": leaves.always_failure,
    "SetBlackboard": blackboard_nodes.set_blackboard,
    "UnsetBlackboard": blackboard_nodes.unset_blackboard,
    "Script": script_nodes.script,
    "ScriptCondition": script_nodes.script_condition,
    SUBTREE: subtree,
}
"""What compiles each node of the catalogue."""


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
        if len(sites) == MOST_NODES:
            raise EngineError(f"the tree has more than {MOST_NODES:,} nodes", node)
        site = Site(node, len(sites), above, position, scope, shared)
        sites.append(site)
        children = node.children
        if node.id == SUBTREE:
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
        count = 1 if node.id == SUBTREE else len(node.children)
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
    kind = CATALOGUE.get(site.node.id)
    if kind is None or not kind.waits:
        return False
    for port, text in site.node.ports:
        if (port[:1] == "_" and port != "_autoremap") or ("{" in text and not kind.any_ports):
            return False  # pre-conditions are asked, and a port is read, at each tick
    return True


def compile_node(site: Site, children: Sequence[Compiled]) -> Compiled:
    """One node whose children are compiled. Raises EngineError."""
    node = site.node
    kind = CATALOGUE.get(node.id)
    if kind is None:
        compiled = _compile_leaf(site, children)
    else:
        if not kind.least <= len(children) <= kind.most and kind.id != SUBTREE:
            raise site.error(f"{node.id} has {len(children)} children instead of {_how_many(kind)}")
        compiled = _compile_built_in(site, kind, children)
    return conditioned(site, compiled) if node.ports else compiled


def _compile_built_in(site: Site, kind: NodeKind, children: Sequence[Compiled]) -> Compiled:
    ports = kind.ports
    from_blackboard = False
    for port, text in site.node.ports:
        if port in ports:
            from_blackboard = from_blackboard or "{" in text
        elif port[:1] != "_" and not kind.any_ports:
            raise site.error(f"{kind.id} takes no port {port}")
    compiled = SEMANTICS[kind.id](site, children)
    return _checked(site, compiled) if from_blackboard and not kind.any_ports else compiled


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


def _how_many(kind: NodeKind) -> str:
    if kind.most == MOST_NODES:
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
