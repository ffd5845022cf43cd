"""Saving and restoring what an engine remembers between two ticks: positions, counts, timers, statuses and values.

The memory of a node is what the cells of its `tick` hold: numbers, truths, texts, lists of these, failures, and objects
with `saved` and `restore`, such as a Stopwatch. (Its `halt` may be that of its child.) Leaves have none: one that was
running starts again, as after a pause. So nodes need no code for it, and pay nothing for it while they are ticked.
In a generated region it is in slots, which have the same names (regions.py): either restores what the other has saved.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from types import CellType

from btlang.engine.blackboard import Blackboard
from btlang.engine.instance import Fault, NodeInstance
from btlang.engine.leaves.leaf import REFUSED, reason_text
from btlang.engine.slot_memory import Slot, SlotMemory
from btlang.engine.status import IDLE, RUNNING

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.engine.instance import Memory
    from btlang.engine.status_trace import StatusTrace

FORMAT = 1
"""Of what is saved; it grows when a node remembers something else."""
_DEEPEST = 40  # lists in each other, each of which is one in an object: see btlang.text.json_text.DEEPEST
_PLAIN = (bool, int, float, str, type(None))


class SaveError(Exception):
    """An error because memory can't be saved, or because what was saved belongs to another tree."""


def save_nodes(instances: Sequence[NodeInstance], trace: StatusTrace | None) -> dict[str, Any]:
    """Save all nodes between two ticks. Raises SaveError for a value on the blackboard that JSON can't hold."""
    nodes = {}
    for instance in instances:
        layers = [_read(tick) for tick in instance.memory]
        if any(layers):
            nodes[str(instance.index)] = layers
    scopes = [scope.dump(_to_json) for scope in _scopes(instances)]
    statuses = {}
    if trace is not None:
        last = [trace.last[place] for place in trace.layout.places]
        statuses = {str(index): status for index, status in enumerate(last) if status not in (IDLE, RUNNING)}
    return {"format": FORMAT, "size": len(instances), "nodes": nodes, "scopes": scopes, "statuses": statuses}


def restore_nodes(saved: Mapping[str, Any], instances: Sequence[NodeInstance], trace: StatusTrace | None) -> None:
    """Restore nodes that haven't been ticked. Raises SaveError if they aren't those of the tree that was saved."""
    scopes = list(_scopes(instances))
    try:
        if (saved["format"], saved["size"], len(saved["scopes"])) != (FORMAT, len(instances), len(scopes)):
            raise SaveError("it was saved by another version of btlang, or from another tree")
        for index, layers in saved["nodes"].items():
            instance = instances[int(index)]
            for tick, layer in zip(instance.memory, layers, strict=True):
                _write(tick, layer, instances)
        for scope, values in zip(scopes, saved["scopes"], strict=True):
            scope.load(values, _from_json)
        if trace is not None:
            trace.restore({int(index): status for index, status in saved["statuses"].items()})
    except (KeyError, IndexError, TypeError, ValueError, AttributeError):
        raise SaveError("it was saved from another tree, or is damaged") from None


def _scopes(instances: Sequence[NodeInstance]) -> Iterator[Blackboard]:
    return iter(dict.fromkeys(instance.scope for instance in instances))


def move_memory(old: Sequence[Memory], new: Sequence[Memory]) -> None:
    """Let a node that was compiled once more remember what it remembered so far, between two ticks."""
    for before, after in zip(old, new, strict=True):
        found = _cells(before)
        for name, cell in _cells(after).items():
            if name in found and _is_memory(value := found[name].cell_contents):
                cell.cell_contents = value


def _is_memory(value: object) -> bool:
    return isinstance(value, (*_PLAIN, list, deque, Fault, NodeInstance)) or hasattr(value, "saved")


def _cells(tick: Memory) -> Mapping[str, CellType | Slot]:
    if isinstance(tick, SlotMemory):
        return tick.cells()
    code = getattr(tick, "__code__", None)  # a partial has none, and remembers nothing
    return {} if code is None else dict(zip(code.co_freevars, tick.__closure__ or (), strict=True))


def _read(tick: Memory) -> dict[str, Any]:
    memory: dict[str, Any] = {}
    for name, cell in _cells(tick).items():
        value = cell.cell_contents
        if isinstance(value, _PLAIN):
            memory[name] = value
        elif isinstance(value, list | deque):
            memory[name] = {"list": [_to_json(each) for each in value]}
        elif isinstance(value, Fault | NodeInstance):
            memory[name] = {"fault": _fault_to_json(value)}
        elif hasattr(value, "saved"):
            memory[name] = {"object": value.saved()}
    return memory


def _write(tick: Memory, memory: Mapping[str, Any], instances: Sequence[NodeInstance]) -> None:
    cells = _cells(tick)
    for name, value in memory.items():
        if name not in cells and isinstance(tick, SlotMemory):  # a closure has cells of what never changes, too
            continue
        cell = cells[name]
        if not isinstance(value, dict):
            cell.cell_contents = value
        elif "object" in value:
            cell.cell_contents.restore(value["object"])
        elif "list" in value:
            values = cell.cell_contents  # itself, since others hold it too
            values.clear()
            values.extend(map(_from_json, value["list"]))
        else:
            cell.cell_contents = _fault_from_json(value["fault"], instances)


def _fault_to_json(fault: Fault | NodeInstance) -> list[Any]:
    """List a failure and its causes, the outermost first. A refusal without a reason gets its text again later."""
    found: list[Any] = []
    while True:
        found.append([fault.index, None if fault.reason is REFUSED else reason_text(fault.reason)])
        if fault.cause is None:
            return found
        fault = fault.cause


def _fault_from_json(chain: Sequence[Any], instances: Sequence[NodeInstance]) -> Fault | NodeInstance | None:
    fault: Fault | NodeInstance | None = None
    for index, reason in reversed(chain):
        alone = reason is None and fault is None
        fault = instances[index] if alone else Fault(index, REFUSED if reason is None else reason, None, fault)
    return fault


def _to_json(value: Any, depth: int = 0) -> Any:
    """Convert a value to JSON. Raises SaveError if that can't hold it."""
    if depth > _DEEPEST:
        raise SaveError("a value that is nested too deep can't be saved")
    if isinstance(value, _PLAIN):
        return value
    if isinstance(value, list | tuple | deque):
        return {type(value).__name__: [_to_json(each, depth + 1) for each in value]}
    raise SaveError(f"a value of the kind {type(value).__name__} can't be saved")


def _from_json(value: Any) -> Any:
    if not isinstance(value, dict):
        return value
    [(kind, values)] = value.items()
    return {"list": list, "tuple": tuple, "deque": deque}[kind](map(_from_json, values))
