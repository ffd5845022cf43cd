"""The engine: a tree that can be ticked, halted, suspended, saved and restored."""

from __future__ import annotations

from _thread import get_ident  # `threading` takes longer to import
from collections.abc import Callable, Mapping, Sequence

from btlang.engine.blackboard import Blackboard
from btlang.engine.changes import Changes
from btlang.engine.clock import Clock
from btlang.engine.compile import allow_depth, compile_instances, expand
from btlang.engine.generation import generate_later
from btlang.engine.instance import EngineError, EngineState, Fault, NodeInstance, blackboard_key
from btlang.engine.leaves.leaf import REFUSED, ActionFailed, LeafBinding, ignore_progress, reason_text
from btlang.engine.saving import restore_nodes, save_nodes
from btlang.engine.script.values import as_text
from btlang.engine.status import FAILURE, IDLE
from btlang.engine.status_trace import StatusTrace
from btlang.support.gc_pause import gc_paused
from btlang.support.record import Record
from btlang.text.source import Span
from btlang.tree.node import Node, Tree

__all__ = ["Engine", "EngineError", "Failure"]

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.engine.clock import LeafTimer
    from btlang.engine.instance import Compiled, Hooks
    from btlang.engine.status_trace import Listener

# A node, its trace, its pre-conditions, and the check of ports from the blackboard; twice, because what starts at the
# end of one branch may halt another one.
_FRAMES_PER_LEVEL = 8
_FRAMES_FOR_LEAVES = 1000
_FRAMES_ASSUMED = 2000  # which Python is taken to allow, or nearly


class Failure(Record):
    """A failure of a node: the reason in words, with the exception if one was raised.

    `span` is the sentence of the node, or of the nearest one around it that has one. `around` are the nodes around it
    that failed with it and add something, innermost first: that all attempts failed, say.
    """

    index: int
    node: Node
    path: str
    reason: str
    exception: BaseException | None = None
    span: Span | None = None
    around: tuple[Failure, ...] = ()


class Engine:
    """A compiled tree. `bind` finds the Python side of a leaf id, `services` are what leaves may ask for by name.

    `enums` are names of numbers that scripts and the cases of Switch nodes may use. A `stopwatch` times the leaves.
    `proxies` are for services that are not safe beside the tick: by their names, what makes of the service, and of
    `Work.in_tick`, what background leaves get; its `let_go` is called when such a leaf was halted or has failed.
    `hooks` may step in before and behind each tick of a node, which then takes longer.

    Raises EngineError where the tree cannot be compiled. `listener` gets lists of status changes, children before
    parents; see status_trace.py for what counts as one, and when it gets them. `on_warning` is called during a tick if
    a condition isn't known, or a leaf raises what isn't ActionFailed: once for each node until the tree is halted.
    """

    def __init__(
        self,
        tree: Tree,
        bind: Callable[[str], LeafBinding | None],
        *,
        clock: Clock,
        services: Mapping[str, Any] = {},
        blackboard: Blackboard | None = None,
        listener: Listener | None = None,
        enums: Mapping[str, float] = {},
        stopwatch: LeafTimer | None = None,
        on_warning: Callable[[Failure], object] | None = None,
        proxies: Mapping[str, Callable[..., Any]] = {},
        hooks: Hooks | None = None,
    ) -> None:
        self.blackboard = Blackboard() if blackboard is None else blackboard
        self.stopwatch = stopwatch
        self.on_wake: Callable[[], object] | None = None
        """What the service `wake` calls, in the thread of whoever asks for it: "tick again now"."""
        self._beside: set[object] = set()
        own = {"wake": self._wake, "wake_at": clock.leaf_wake_at, "progress": ignore_progress, "beside": self._beside}
        self._state = EngineState(bind, clock, {**own, **services}, enums, stopwatch, proxies)
        self.raised: dict[int, Failure] = {}
        """The latest failure of each leaf that raised what isn't ActionFailed, by the number of its node."""
        self._on_warning = on_warning
        self._state.on_warning = self._warn
        with gc_paused:
            self._instances = expand(tree, self.blackboard, self._state)
            self._trace = None if listener is None else StatusTrace(self._state, listener, self._instances)
            compiled = compile_instances(self._instances, self._trace, hooks)
        self._frames = _depth(self._instances) * _FRAMES_PER_LEVEL + _FRAMES_FOR_LEAVES
        self._use(compiled)
        if hooks is None:
            generate_later(self._instances, self._trace, compiled, self._use)
        listened = self._instances if listener is not None else ()
        self._keyed = frozenset([s.index for s in listened if any("{" in text for _, text in s.node.ports)])
        self._busy = False
        self.status = IDLE
        self._fault: Fault | NodeInstance | None = None

    def tick(self) -> int:
        """Tick the tree once; return its status.

        KeyboardInterrupt halts the tree and comes through; any other exception of a leaf is its failure.
        Raises RuntimeError where a leaf or another thread ticks, halts or suspends the tree during a tick.
        """
        if self._busy:  # nothing that could let another thread run stands between this and the next statement
            self._refuse()
        self._busy = True
        try:
            tick = self._tick  # Python calls what is in a variable faster than what is in an attribute
            self.status = status = tick()
            if status is FAILURE:
                self._fault = self._state.fault
            if self._trace is not None:
                self._trace.flush()
            return status
        except BaseException:
            self._halt_all(False, cut_short=True)
            raise
        finally:
            self._busy = False

    @property
    def failure(self) -> Failure | None:
        """Why the latest tick failed: the leaf, or the decorator, that made the root fail. None where it did not."""
        return None if self._fault is None or self.status not in (FAILURE, IDLE) else self._failure(self._fault)

    @property
    def unknowns(self) -> int:
        """How many failures so far were no answers: a condition could not know (`btlang.Unknown`)."""
        return self._state.unknowns

    @property
    def unanswered(self) -> list[Failure]:
        """Why conditions of rules haven't been known a single time so far: those rules have done nothing."""
        found = {id(fault): fault for _, fault in sorted(self._state.unanswered.items())}
        return [self._failure(fault) for fault in found.values()]

    def halt(self, emergency: bool = False) -> None:
        """Halt every running leaf, children before parents, and reset all nodes; the next tick starts over.

        Only a SequenceWithMemory keeps its place, as in BehaviorTree.CPP. What `catch_on_halt` of a TryCatch starts
        to clean up does not run in an emergency.
        """
        self._state.emergency = emergency
        try:
            self._stop(False)
        finally:
            self._state.emergency = False

    def suspend(self) -> None:
        """Halt every running leaf but keep positions, counts and timers; the next tick restarts those leaves."""
        self._stop(True)

    def save(self) -> dict[str, Any]:
        """Return what it remembers between two ticks, as JSON. Running leaves start again later, as after `suspend`.

        Raises SaveError for a value on the blackboard that JSON can't hold.
        """
        return {"now": self._state.clock.now, **save_nodes(self._instances, self._trace)}

    def restore(self, saved: Mapping[str, Any]) -> None:
        """Go on where another engine of the same tree was saved, its clock too. Call it before the first tick.

        Raises SaveError if that was another tree, or another version of btlang.
        """
        restore_nodes(saved, self._instances, self._trace)
        self._state.clock.now = float(saved["now"])
        self.suspend()  # nodes work out again what follows from what they remember

    def take_halt_failures(self) -> list[Failure]:
        """Return what leaves raised while they were halted since the last call, oldest first.

        What a background leaf raises that ends after its halt is among them once it has ended.
        """
        faults = self._state.halt_faults
        if self._state.background is not None:
            faults += self._state.background.take_faults()
        if not faults:
            return []
        failures = [self._failure(fault) for fault in faults]
        faults.clear()
        return failures

    def close(self, patience: float = 0.0) -> list[Failure]:
        """End what works for background leaves, after a halt. Returns those that were halted and haven't ended.

        It waits for them at most `patience` seconds of real time. The engine can be ticked again.
        """
        background = self._state.background
        if background is None:
            return []
        return [self._failure(Fault(index, "it did not end")) for index in background.close(patience)]

    @property
    def works_beside(self) -> bool:
        """Whether a leaf works in a thread, on the event loop, or elsewhere."""
        background = self._state.background
        return bool(self._beside) or (background is not None and background.is_working)

    @property
    def nodes(self) -> list[tuple[str, Node]]:
        """The path and node of all nodes in preorder, after expansion of subtrees; made at each call."""
        paths: list[str] = []
        for instance in self._instances:
            above = paths[instance.above.index] if instance.above is not None and instance.above.index else ""
            paths.append(f"{above}/{instance.position}" if instance.above is not None else "/")
        return [(path, instance.node) for path, instance in zip(paths, self._instances, strict=True)]

    @property
    def size(self) -> int:
        """The number of nodes, after expansion of subtrees."""
        return len(self._instances)

    def node(self, index: int) -> Node:
        """Return the node with an index in preorder."""
        return self._instances[index].node

    def filled(self, index: int) -> Node:
        """Return a node with the arguments of the subtrees around it in place of their `{names}`."""
        node, scope = self._instances[index].node, self._instances[index].scope
        keys = [(port, text, blackboard_key(port, text)) for port, text in node.ports]
        ports = tuple((port, text if key is None else _argument(scope, key, text)) for port, text, key in keys)
        return node if ports == node.ports else node.replace(ports=ports)

    def valued(self, changes: Changes) -> dict[int, Node]:
        """Return the changed nodes whose ports name keys, with the texts and numbers that are under them now.

        None in an engine without a listener.
        """
        if not self._keyed:
            return {}
        return {index: self._with_values(self._instances[index]) for index, _ in changes.of(self._keyed)}

    def path(self, index: int) -> str:
        """Return the path of a node: `/` is the root, `/0/1` the second child of its first child. A SubTree's tree is
        child 0.
        """
        steps: list[str] = []
        instance = self._instances[index]
        while instance.above is not None:
            steps.append(str(instance.position))
            instance = instance.above
        return "/" + "/".join(reversed(steps))

    def flush(self) -> None:
        """Hand the pending status changes to the listener. Leaves may call it.

        In another thread than that of the latest tick it does nothing: that tick may go on.
        """
        if self._trace is not None and self._trace.thread == get_ident():
            self._trace.flush()

    def values(self, index: int) -> dict[str, Any]:
        """Return the blackboard values of a node, without those that it shares with the node above. Any thread may call
        it.
        """
        return self._instances[index].scope.own_values()

    def is_question(self, index: int) -> bool:
        """Whether a node is a condition, or a node that asks a script."""
        signature = self._state.signatures.get(self.node(index).id)
        return signature is None or signature.binding.condition

    def parent(self, index: int) -> int:
        """Return the index of the node above a node, -1 for the root."""
        above = self._instances[index].above
        return -1 if above is None else above.index

    def span(self, index: int) -> Span | None:
        """Return the sentence of a node, or of the nearest one around it that has one."""
        instance = self._instances[index]
        while instance.node.span is None and instance.above is not None:
            instance = instance.above
        return instance.node.span

    def reason(self, index: int, fault: Fault | NodeInstance | None = None) -> str:
        """Return what a failure, by default the latest, or one that caused it, says about a node.

        "" where only a node below it can say that.
        """
        fault = fault or self._state.fault
        while fault is not None and fault.index < index:  # causes are below
            fault = fault.cause
        return self._text(fault) if fault is not None and fault.index == index else ""

    def _with_values(self, instance: NodeInstance) -> Node:
        ports = tuple((port, _fill_value(instance.scope, port, text)) for port, text in instance.node.ports)
        return instance.node.replace(ports=ports)  # type: ignore[no-any-return]

    def _warn(self, fault: Fault | NodeInstance) -> None:
        failure = self._failure(fault)
        if failure.exception is not None and not isinstance(failure.exception, ActionFailed):
            self.raised[failure.index] = failure
        if self._on_warning is not None:
            self._on_warning(failure)

    def _use(self, compiled: Compiled) -> None:
        """Tick and halt by these from now on."""
        tick, halt = compiled
        deep = self._frames > _FRAMES_ASSUMED
        self._tick = allow_depth(self._frames, tick) if deep else tick
        self._halt = allow_depth(self._frames, halt) if deep else halt

    def _wake(self) -> None:
        if self.on_wake is not None:
            self.on_wake()

    def _stop(self, keep: bool) -> None:
        if self._busy:
            self._refuse()
        self._busy = True
        try:
            self._halt_all(keep)
        finally:
            self._busy = False

    def _refuse(self) -> None:
        raise RuntimeError("the tree is being ticked: neither a leaf nor another thread may tick or halt it now")

    def _halt_all(self, keep: bool, cut_short: bool = False) -> None:
        """Halt all nodes. A leaf that is interrupted while it halts counts as halted, and another attempt goes on.

        Where a tick or a halt was cut short, nodes do not know which of their children run. So all is stopped before a
        TryCatch starts to clean up.
        """
        interrupted: BaseException | None = None
        for _ in range(len(self._instances) + 1):  # each leaf interrupts it once at most, and so does each TryCatch
            self._state.interrupts.clear()
            try:
                if cut_short:
                    self._halt(True)
                self._halt(keep)
                break
            except BaseException as exception:
                interrupted = interrupted or exception
                cut_short = True
        if not keep:
            if self.status is not FAILURE and self.status != IDLE:
                self._fault = None
            self.status = IDLE
            self._state.warned.clear()
        if self._trace is not None:
            self._trace.flush()
        if interrupted is not None:
            raise interrupted

    def _text(self, fault: Fault | NodeInstance) -> str:
        if fault.reason is REFUSED:
            return self._state.signatures[self.node(fault.index).id].binding.refusal
        return reason_text(fault.reason) or "it gave no reason"

    def _failure(self, fault: Fault | NodeInstance) -> Failure:
        around: list[Failure] = []
        while fault.cause is not None:
            around.append(self._describe(fault))
            fault = fault.cause
        return self._describe(fault, tuple(reversed(around)))

    def _describe(self, fault: Fault | NodeInstance, around: tuple[Failure, ...] = ()) -> Failure:
        index = fault.index
        return Failure(
            index, self.node(index), self.path(index), self._text(fault), fault.exception, self.span(index), around
        )


def _argument(scope: Blackboard, key: str, text: str) -> str:
    value = scope.argument(key)
    return as_text(value) if isinstance(value, str | int | float) else text


def _fill_value(scope: Blackboard, port: str, text: str) -> str:
    key = blackboard_key(port, text)
    value = scope.get(key) if key is not None and key in scope else text
    return as_text(value) if isinstance(value, str | int | float) else text


def _depth(instances: Sequence[NodeInstance]) -> int:
    depths = [0] * len(instances)
    for instance in instances:
        if instance.above is not None:
            depths[instance.index] = depths[instance.above.index] + 1
    return max(depths)
