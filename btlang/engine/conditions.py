"""Pre- and post-conditions: scripts in ports that every node may have, as in tree_node.cpp of BehaviorTree.CPP 4.10.

Before a node starts, in this order: `_failureIf` FAILURE, `_successIf` SUCCESS where it holds, `_onlyIf` SKIPPED where
it does not, `_skipIf` SKIPPED where it holds, and `_while` SKIPPED where it does not; the node is then not ticked.
While it is RUNNING only `_while` is asked, and where it does not hold the node is halted: SKIPPED. When it has
completed, also by a pre-condition, `_onSuccess` or `_onFailure` runs, then `_post`. `_onHalted` runs after the node was
halted while RUNNING. The scripts of a SubTree see the blackboard around it.

A suspended node has started: what is asked before a start is not asked again, and `_onHalted` waits for a real halt.

Differences:
- `_onlyIf` is there only with a change that some programs make;
- a script that cannot go on makes the node fail with its reason; there it raises an exception out of the tick;
- a node that returned SKIPPED has not started: its pre-conditions are asked again, and halting it runs no `_onHalted`.
  There this holds for leaves only;
- a child of a PipelineSequence and the condition of a WhileDoElse or IfThenElse start again when they are ticked after
  they completed. There their pre-conditions are not asked again;
- halting the whole tree runs the `_onHalted` of its root only where it is RUNNING.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from btlang.engine.blackboard import Blackboard
from btlang.engine.instance import Fault, NodeInstance
from btlang.engine.leaves.leaf import ActionFailed
from btlang.engine.nodes.built_in_leaves import always_skipped, read_script
from btlang.engine.nodes.ports import STATUSES
from btlang.engine.script.values import truth
from btlang.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS
from btlang.text.spelling import distance
from btlang.tree.catalogue import POST_CONDITIONS, PRE_CONDITIONS, SUBTREE
from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    from btlang.engine.instance import Compiled

    Script: TypeAlias = Callable[[Blackboard], Any]

_DECIDES = {port: (answer, STATUSES[status]) for port, (answer, status) in PRE_CONDITIONS.items()}
_NEAR = 2  # one letter, as `distance` counts


def is_editor_attribute(port: str) -> bool:
    """Whether an attribute does nothing: editors write some for themselves, such as `_uid` and `_collapsed`.

    A misspelt condition such as `_skipif` isn't one of these.
    """
    if port[:1] != "_" or port == "_autoremap":
        return False
    written, known = port.lower(), [condition.lower() for condition in (*PRE_CONDITIONS, *POST_CONDITIONS)]
    return not any(distance(written, each) <= _NEAR or each.startswith(written) for each in known)


def has_conditions(node: Node) -> bool:
    """Return whether a node has pre- or post-conditions."""
    return any(port in PRE_CONDITIONS or port in POST_CONDITIONS for port, _ in node.ports)


def add_conditions(instance: NodeInstance, compiled: Compiled) -> Compiled:
    """Add its pre- and post-conditions to a node; without any it stays as it is."""
    texts: dict[str, str] = {}
    for port, text in instance.node.ports:
        if port[:1] != "_":
            continue
        if port in PRE_CONDITIONS or port in POST_CONDITIONS:
            texts[port] = text
        elif not is_editor_attribute(port) and (port != "_autoremap" or instance.node.id != SUBTREE):
            raise instance.error(f"{instance.node.id} takes no port {port}")
    if texts.get("_skipIf") == "false":
        del texts["_skipIf"]
    if not texts:
        return compiled
    if texts == {"_skipIf": "true"}:
        return always_skipped(instance, ())
    compiled = _wrap_in_scripts(instance, compiled, texts)
    instance.memory = (*instance.memory, compiled[0])
    return compiled


def _wrap_in_scripts(instance: NodeInstance, compiled: Compiled, texts: Mapping[str, str]) -> Compiled:
    tick_node, halt_node = compiled
    scope = instance.scope
    scripts = {port: read_script(instance, port, text) for port, text in texts.items()}
    before = tuple([(port, scripts[port], *rule) for port, rule in _DECIDES.items() if port in scripts])
    goes_on = scripts.get("_while")
    after = {
        SUCCESS: [scripts[port] for port in ("_onSuccess", "_post") if port in scripts],
        FAILURE: [scripts[port] for port in ("_onFailure", "_post") if port in scripts],
    }
    on_halted = scripts.get("_onHalted")
    running = False

    def verdict() -> int:
        """Return what the pre-conditions decide, IDLE if they decide nothing. A FAILURE is recorded."""
        try:
            if running:
                return IDLE if goes_on is None or truth(goes_on(scope)) else SKIPPED
            for port, script, answer, status in before:
                if truth(script(scope)) == answer:
                    return instance.fail(f"{port} holds: {texts[port]}") if status == FAILURE else status
        except ActionFailed as failed:
            return instance.cannot_know(str(failed))
        return IDLE

    def tick() -> int:
        nonlocal running
        status = verdict() if before else IDLE
        if status == IDLE:
            status = tick_node()
            running = status == RUNNING
        else:
            fault = instance.state.fault
            halt(False)
            instance.state.fault = fault
        if status in (SUCCESS, FAILURE):
            try:
                for script in after[status]:
                    script(scope)
            except ActionFailed as failed:
                return (instance.fail if status == SUCCESS else instance.pass_on)(str(failed))
        return status

    def halt(keep: bool) -> None:
        nonlocal running
        halt_node(keep)
        if running and not keep:
            running = False
            if on_halted is not None:
                try:
                    on_halted(scope)
                except ActionFailed as failed:
                    instance.state.halt_faults.append(Fault(instance.index, str(failed), failed))

    return tick, halt
