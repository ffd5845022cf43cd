"""Tree to compiled nodes: subtrees are expanded, then each node is compiled by the function that its id names."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from btlang.engine.blackboard import Blackboard
from btlang.engine.clock import Clock
from btlang.engine.conditions import conditioned
from btlang.engine.fused import fused
from btlang.engine.instance import EngineError, EngineState, NodeInstance, halt_nothing
from btlang.engine.leaves.binding import bound_leaf
from btlang.engine.leaves.leaf import ActionFailed
from btlang.engine.leaves.signature import LeafSignature
from btlang.engine.nodes import (
    blackboard_nodes,
    branch,
    constants,
    constraints,
    control,
    decorators,
    guards,
    loops,
    nav2,
    reactive,
    script_nodes,
    timed,
    updates,
)
from btlang.engine.nodes.subtree import child_scope, subtree
from btlang.engine.nodes.switch import switch
from btlang.engine.nodes.try_catch import try_catch
from btlang.engine.nodes.whenever import whenever
from btlang.engine.resume_path import resumable, resume_paths, resuming
from btlang.engine.status_trace import NodeTrace, StatusTrace, repeats
from btlang.tree.catalogue import CATALOGUE, MOST_NODES, SUBTREE, NodeKind
from btlang.tree.node import Node, Tree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.instance import Compiled, Hooks


SEMANTICS: dict[str, Callable[[NodeInstance, Sequence[Compiled]], Compiled]] = {
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
    "KeepOut": constraints.keep_out,
    "KeepIn": constraints.keep_in,
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
    "WaitForTime": timed.wait_for_time,
    "AlwaysSuccess": constants.always_success,
    "AlwaysFailure": constants.always_failure,
    "SetBlackboard": blackboard_nodes.set_blackboard,
    "UnsetBlackboard": blackboard_nodes.unset_blackboard,
    "Script": script_nodes.script,
    "ScriptCondition": script_nodes.script_condition,
    SUBTREE: subtree,
}
"""What compiles each node of the catalogue."""


def expand(tree: Tree, blackboard: Blackboard, state: EngineState) -> list[NodeInstance]:
    """All nodes in preorder; a SubTree's only child is the root of its tree."""
    subtrees = dict(tree.subtrees)
    instances: list[NodeInstance] = []
    within: set[str] = set()  # names of the subtrees around the present node
    # to come: a node, the instance above it, its position there and its blackboard; a str: this subtree ends here
    stack: list[tuple[Node, NodeInstance | None, int, Blackboard] | str] = [(tree.root, None, 0, blackboard)]
    while stack:
        top = stack.pop()
        if isinstance(top, str):
            within.remove(top)
            continue
        node, above, position, scope = top
        if len(instances) == MOST_NODES:
            raise EngineError(f"the tree has more than {MOST_NODES:,} nodes", node)
        instance = NodeInstance(node, len(instances), above, position, scope, state)
        instances.append(instance)
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
        stack += [(children[at], instance, at, scope) for at in range(len(children) - 1, -1, -1)]
    return instances


def outline(tree: Tree) -> tuple[list[Node], list[int]]:
    """All nodes in preorder, after expansion of subtrees, and the index of each one's parent, -1 for the root."""
    instances = expand(tree, Blackboard(), EngineState(lambda id: None, Clock(), {}, {}, None))
    return [instance.node for instance in instances], [
        -1 if instance.above is None else instance.above.index for instance in instances
    ]


def _root_of(node: Node, name: str, subtrees: dict[str, Node]) -> Node:
    if not name:
        raise EngineError("SubTree needs a port ID", node)
    if name not in subtrees:
        raise EngineError(f"there is no subtree {name}", node)
    return subtrees[name]


def compile_instances(
    instances: Sequence[NodeInstance], trace: StatusTrace | None, hooks: Hooks | None = None
) -> Compiled:
    """Compiles from the last node to the root, so that children are there before their parents."""
    waiting: list[Compiled] = []  # compiled nodes whose parents come later, so that the last ones are the next one's
    traces: list[NodeTrace] = []
    around = resume_paths(instances, _waits)
    for instance in reversed(instances):
        node = instance.node
        count = 1 if node.id == SUBTREE else len(node.children)
        children: Sequence[Compiled] = ()
        if count:
            children = waiting[: -count - 1 : -1]
            del waiting[-count:]
        above, node_trace = instance.above, None
        if trace is not None:
            lower = traces[: -count - 1 : -1] if count else []
            node_trace = NodeTrace(instance.index, above is not None and repeats(above.node), lower, trace)
            trace.nodes.append(node_trace)
            traces[len(traces) - count :] = [node_trace]
        instance.state.node_trace = node_trace if hooks is None else None  # a hook may change what a leaf would report
        compiled = compile_node(instance, children)
        lasts = compiled[1] is not halt_nothing
        path = around[instance.index]
        if path is not None and path.used and path.top == instance.index:
            compiled = resuming(path, compiled)
        if hooks is not None:
            compiled = hooks.wrap(instance.index, compiled)
        if node_trace is not None:
            compiled = node_trace.wrap(compiled)
        if path is None and above is not None and lasts:
            wider = around[above.index]
            if wider is not None and wider.top != above.index:  # else the way down is not longer
                compiled = resumable(wider, compiled)
        waiting.append(compiled)
    if trace is not None:
        trace.nodes.reverse()
    [root] = waiting
    return root


def _waits(instance: NodeInstance) -> bool:
    kind = CATALOGUE.get(instance.node.id)
    if kind is None or not kind.waits:
        return False
    for port, text in instance.node.ports:
        if (port[:1] == "_" and port != "_autoremap") or ("{" in text and not kind.any_ports):
            return False  # pre-conditions are asked, and a port is read, at each tick
    return True


def compile_node(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """One node whose children are compiled. Raises EngineError."""
    node = instance.node
    kind = CATALOGUE.get(node.id)
    if kind is None:
        compiled = _compile_leaf(instance, children)
    else:
        if not kind.least <= len(children) <= kind.most and kind.id != SUBTREE:
            has = f"{len(children)} child{'ren' * (len(children) != 1)}"
            raise instance.error(f"{node.id} has {has} instead of {_how_many(kind)}")
        compiled = _compile_built_in(instance, kind, children)
    return conditioned(instance, compiled) if node.ports else compiled


def _compile_built_in(instance: NodeInstance, kind: NodeKind, children: Sequence[Compiled]) -> Compiled:
    ports = kind.ports
    from_blackboard = False
    for port, text in instance.node.ports:
        if port in ports:
            from_blackboard = from_blackboard or "{" in text
        elif port[:1] != "_" and not kind.any_ports:
            raise instance.error(f"{kind.id} takes no port {port}")
    compiled = fused(SEMANTICS[kind.id], instance, children)(instance, children)
    if kind.id != SUBTREE:  # which is its child
        instance.memory = (compiled[0],)
    return _checked(instance, compiled) if from_blackboard and not kind.any_ports else compiled


def _compile_leaf(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    node_id, state = instance.node.id, instance.state
    signature = state.signatures.get(node_id)
    if signature is None:
        binding = state.bind(node_id)
        if binding is None:
            raise instance.error(f"nothing is bound to {node_id}")
        signature = state.signatures[node_id] = LeafSignature(binding)
    if children:
        raise instance.error(f"{node_id} is a leaf, which takes no children")
    compiled = bound_leaf(instance, signature)
    return compiled if state.stopwatch is None else state.stopwatch.wrap(instance.index, compiled)


def _how_many(kind: NodeKind) -> str:
    if kind.most == MOST_NODES:
        return f"{kind.least} or more"
    return str(kind.least) if kind.least == kind.most else f"{kind.least} or {kind.most}"


def _checked(instance: NodeInstance, compiled: Compiled) -> Compiled:
    """A node that reads a number from the blackboard and fails if there is none."""
    tick, halt = compiled

    def checked() -> int:
        try:
            return tick()
        except ActionFailed as failed:
            halt(False)
            return instance.fail(str(failed))

    return checked, halt
