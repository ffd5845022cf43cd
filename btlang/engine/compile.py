"""Compiles trees: expands the subtrees, compiles each node with the function of its id, and allows deep recursion."""

from __future__ import annotations

import sys
from _thread import allocate_lock
from collections.abc import Callable, Sequence

from btlang.engine.blackboard import Blackboard
from btlang.engine.clock import Clock
from btlang.engine.conditions import add_conditions
from btlang.engine.fused import choose_compiler
from btlang.engine.instance import EngineError, EngineState, NodeInstance, blackboard_key, halt_nothing
from btlang.engine.leaves.binding import bind_leaf
from btlang.engine.leaves.callables import find_function
from btlang.engine.leaves.leaf import ActionFailed, LeafSignature
from btlang.engine.nodes import (
    branches,
    built_in_leaves,
    control,
    decorators,
    guards,
    nav2,
    nav2_controllers,
    rules,
    timed,
)
from btlang.engine.nodes.ports import TRUTHS
from btlang.engine.resume_path import find_resume_paths, mark_resumable, resume_at_top
from btlang.engine.script.values import literal
from btlang.engine.status_trace import NodeTrace, StatusTrace
from btlang.tree.catalogue import CATALOGUE, MOST_NODES, SUBTREE, NodeKind
from btlang.tree.node import Node, Tree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.engine.instance import Compiled, Hooks


SEMANTICS: dict[str, Callable[[NodeInstance, Sequence[Compiled]], Compiled]] = {
    "Sequence": control.sequence,
    "Fallback": control.fallback,
    "AsyncSequence": control.async_sequence,
    "AsyncFallback": control.async_fallback,
    "SequenceWithMemory": control.sequence_with_memory,
    "Parallel": control.parallel,
    "ParallelAll": control.parallel_all,
    "ReactiveSequence": control.reactive_sequence,
    "ReactiveFallback": control.reactive_fallback,
    "IfThenElse": branches.if_then_else,
    "WhileDoElse": branches.while_do_else,
    **{f"Switch{cases}": branches.switch for cases in range(2, 7)},
    "TryCatch": branches.try_catch,
    "Whenever": rules.whenever,
    "PipelineSequence": nav2.pipeline_sequence,
    "NonblockingSequence": nav2.nonblocking_sequence,
    "PersistentSequence": nav2.persistent_sequence,
    "SingleTrigger": nav2.single_trigger,
    "SpeedController": nav2_controllers.speed_controller,
    "DistanceController": nav2_controllers.distance_controller,
    "GoalUpdatedController": nav2_controllers.goal_updated_controller,
    "GoalUpdater": nav2_controllers.goal_updater,
    "PathLongerOnApproach": nav2_controllers.path_longer_on_approach,
    "PauseResumeController": nav2.pause_resume_controller,
    "RecoveryNode": nav2.recovery_node,
    "RoundRobin": nav2.round_robin,
    "Inverter": decorators.inverter,
    "ForceSuccess": decorators.force_success,
    "ForceFailure": decorators.force_failure,
    "Repeat": decorators.repeat,
    "RetryUntilSuccessful": decorators.retry_until_successful,
    "KeepOut": rules.keep_out,
    "KeepIn": rules.keep_in,
    "Timeout": timed.timeout,
    "Delay": timed.delay,
    "RateController": nav2.rate_controller,
    "KeepRunningUntilFailure": guards.keep_running_until_failure,
    "RunOnce": guards.run_once,
    "Precondition": guards.precondition,
    "LoopInt": decorators.loop_int,
    "LoopBool": decorators.loop_bool,
    "LoopDouble": decorators.loop_double,
    "LoopString": decorators.loop_string,
    "SkipUnlessUpdated": guards.skip_unless_updated,
    "WaitValueUpdate": guards.wait_value_update,
    "WasEntryUpdated": guards.was_entry_updated,
    "Sleep": timed.sleep,
    "WaitForTime": timed.wait_for_time,
    "AlwaysSuccess": built_in_leaves.always_success,
    "AlwaysFailure": built_in_leaves.always_failure,
    "SetBlackboard": built_in_leaves.set_blackboard,
    "UnsetBlackboard": built_in_leaves.unset_blackboard,
    "Script": built_in_leaves.script,
    "ScriptCondition": built_in_leaves.script_condition,
    SUBTREE: lambda instance, children: children[0],  # subtree_node.cpp
}
"""What compiles each node of the catalogue."""
_lock = allocate_lock()
_asked: list[int] = []  # the frames that those ask for who run now
_usual = 0  # the limit while nobody does


def expand(tree: Tree, blackboard: Blackboard, state: EngineState) -> list[NodeInstance]:
    """List all nodes in preorder; a SubTree's only child is the root of its tree."""
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
    """List all nodes in preorder, after expansion of subtrees, and the index of each one's parent, -1 for the root."""
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
    """Compile from the last node to the root, so that children are compiled before their parents."""
    waiting: list[Compiled] = []  # compiled nodes whose parents come later, so that the last ones are the next one's
    around = find_resume_paths(instances, waits)
    for instance in reversed(instances):
        node = instance.node
        count = 1 if node.id == SUBTREE else len(node.children)
        children: Sequence[Compiled] = ()
        if count:
            children = waiting[: -count - 1 : -1]
            del waiting[-count:]
        above, node_trace = instance.above, None
        if trace is not None:
            node_trace = NodeTrace(instance, trace)
        instance.state.node_trace = node_trace if hooks is None else None  # a hook may change what a leaf would report
        compiled = compile_node(instance, children)
        lasts = compiled[1] is not halt_nothing
        path = around[instance.index]
        if path is not None and path.used and path.top == instance.index:
            compiled = resume_at_top(path, compiled)
        if hooks is not None:
            compiled = hooks.wrap(instance.index, compiled)
        if node_trace is not None and not (instance.index and find_function(compiled[0])):
            compiled = node_trace.wrap(compiled)
        if not count and find_function(compiled[0]) is None:
            instance.leaf = compiled
        if path is None and above is not None and lasts:
            wider = around[above.index]
            if wider is not None and wider.top != above.index:  # else the way down is not longer
                compiled = mark_resumable(wider, compiled)
        waiting.append(compiled)
    [root] = waiting
    return root


def waits(instance: NodeInstance) -> bool:
    """Return whether a node only asks its child while that is RUNNING, so that it may be part of a resume path."""
    kind = CATALOGUE.get(instance.node.id)
    if kind is None or not kind.waits:
        return False
    if any(port[:1] == "_" and port != "_autoremap" for port, _ in instance.node.ports):
        return False  # pre-conditions are asked at each tick
    return not reads_keys(instance.node)


def reads_keys(node: Node) -> bool:
    """Return whether a built-in node reads ports from the blackboard at each tick."""
    kind = CATALOGUE[node.id]
    return not kind.any_ports and any("{" in text for port, text in node.ports if port in kind.ports)


def compile_node(instance: NodeInstance, children: Sequence[Compiled]) -> Compiled:
    """Compile one node whose children are compiled. Raises EngineError."""
    node = instance.node
    kind = CATALOGUE.get(node.id)
    if kind is None:
        compiled = _compile_leaf(instance, children)
    else:
        if not kind.least <= len(children) <= kind.most and kind.id != SUBTREE:
            has = f"{len(children)} child{'ren' * (len(children) != 1)}"
            raise instance.error(f"{node.id} has {has} instead of {_how_many(kind)}")
        compiled = _compile_built_in(instance, kind, children)
    return add_conditions(instance, compiled) if node.ports else compiled


def _compile_built_in(instance: NodeInstance, kind: NodeKind, children: Sequence[Compiled]) -> Compiled:
    for port, _ in instance.node.ports:
        if port not in kind.ports and port[:1] != "_" and not kind.any_ports:
            raise instance.error(f"{kind.id} takes no port {port}")
    usual = SEMANTICS[kind.id]
    if (trace := instance.state.node_trace) is not None:
        children = trace.wrap_functions(children, keeps=False)
    compiled = choose_compiler(usual, instance, children)(instance, children)
    if kind.id != SUBTREE:  # which is its child
        instance.memory = (compiled[0],)
    return _check_ports(instance, compiled) if reads_keys(instance.node) else compiled


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
    compiled = bind_leaf(instance, signature)
    return compiled if state.stopwatch is None else state.stopwatch.wrap(instance.index, compiled)


def _how_many(kind: NodeKind) -> str:
    if kind.most == MOST_NODES:
        return f"{kind.least} or more"
    return str(kind.least) if kind.least == kind.most else f"{kind.least} or {kind.most}"


def _check_ports(instance: NodeInstance, compiled: Compiled) -> Compiled:
    """Wrap a node that reads a number from the blackboard: it fails if there is no number."""
    tick, halt = compiled

    def checked() -> int:
        try:
            return tick()
        except ActionFailed as failed:
            halt(False)
            return instance.fail(str(failed))

    return checked, halt


def child_scope(node: Node, scope: Blackboard) -> Blackboard:
    """Make the blackboard of a SubTree node's tree.

    A port `key="{other}"` makes `key` there a name for `other` here, any other text is a value set once, a number where
    it is one, as in C++. With `_autoremap="true"` all keys but private ones (`_name`) are state that have no port.
    """
    shares = TRUTHS.get(text := node.port("_autoremap", "false"))
    if shares is None:
        raise EngineError(f"_autoremap must be true or false, not {text!r}", node)
    remapped: dict[str, tuple[Blackboard, str]] = {}
    values: dict[str, int | float | str] = {}
    for port, text in node.ports:
        if port == "ID" or port.startswith("_"):
            continue
        key = blackboard_key(port, text)
        if key is None:
            values[port] = literal(text)
        else:
            remapped[port] = (scope, key)
    return Blackboard(remapped, scope, shares=shares, values=values)


def allow_depth(frames: int, do: Callable[..., Any]) -> Callable[..., Any]:
    """Wrap a function so that so many frames are allowed while it runs, in whatever thread.

    The limit doesn't stay raised: what recurses in C, as Python's JSON does, would crash where it says now that
    something is nested too deep.
    """

    def done(*args: Any) -> Any:
        _raise(frames)
        try:
            return do(*args)
        finally:
            _lower(frames)

    return done


def _raise(frames: int) -> None:
    global _usual
    with _lock:
        if not _asked:
            _usual = sys.getrecursionlimit()
        _asked.append(frames)
        sys.setrecursionlimit(max([_usual, *_asked]))


def _lower(frames: int) -> None:
    with _lock:
        _asked.remove(frames)
        sys.setrecursionlimit(max([_usual, *_asked]))
