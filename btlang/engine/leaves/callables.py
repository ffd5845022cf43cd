"""Leaves that are Python objects: functions, generators and classes, as described in leaf.py.

An exception, any but KeyboardInterrupt, becomes a FAILURE with its reason. It isn't an answer: the nodes that turn a
failure into something else don't take it for a no (`NodeInstance.cannot_know`). A class that raises anything but
ActionFailed is halted as well: it had no chance to stop what it moves. What `halt` itself raises is kept in the
engine's `take_halt_failures`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

from btlang.engine.instance import Fault, NodeInstance, halt_nothing
from btlang.engine.leaves.leaf import ActionFailed, Failed, NotThere, Unknown, describe_exception
from btlang.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    from btlang.engine.instance import Compiled, LeafTrace

    Stored: TypeAlias = Callable[[], Mapping[str, Any]] | None  # reads ports from the blackboard


KEPT = "kept"
"""The parameter of a generator for what it keeps while it is suspended."""
_TRUTHS = ("bool", "bool_")  # what numpy's comparisons give goes by these names


class FunctionLeaf:
    """A leaf that calls a function.

    What ticks many children calls the function itself (see fused.py) and hands on here what is no plain answer.
    """

    __slots__ = ("call", "instance")

    def __init__(self, instance: NodeInstance, call: Callable[[], Any]) -> None:
        self.instance = instance
        self.call = call

    def tick(self) -> int:
        try:
            result = self.call()
        except KeyboardInterrupt:
            raise
        except BaseException as problem:
            return fail_with(self.instance, problem)
        return SUCCESS if result is True else status_of(self.instance, result)


def find_function(tick: Any) -> FunctionLeaf | None:
    """Return the leaf that a tick belongs to if it is a function."""
    leaf = getattr(tick, "__self__", None)
    return leaf if leaf.__class__ is FunctionLeaf else None


def function_leaf(instance: NodeInstance, call: Callable[..., Any], stored: Stored) -> Compiled:
    """Compile a function; `stored` returns the values that are read at each call."""
    return FunctionLeaf(instance, call if stored is None else lambda: call(**stored())).tick, halt_nothing


class GeneratorLeaf:
    """A leaf that runs a generator function; `stored` returns the values that are read at each start.

    A class and not two closures as most nodes are: there are many of them, and each would need six cells. `send` goes
    on with what runs, and is None if nothing does; regions (regions.py) call it, and hand on what isn't None.
    """

    __slots__ = ("call", "instance", "send", "stored", "trace")

    def __init__(self, instance: NodeInstance, call: Callable[..., Any], stored: Stored) -> None:
        self.instance = instance
        self.call = call
        self.stored = stored
        self.trace = _trace_of(instance)
        self.send: Any = None  # that of the generator that is running; a call of it is quicker than `next`

    def tick(self) -> int:
        try:
            if self.send is None:
                values = None if self.stored is None else self.stored()
                interrupts = self.instance.state.interrupts
                if interrupts or self.trace is not None:
                    _begin(interrupts, self.trace)
                self.send = (self.call() if values is None else self.call(**values)).send
            given = self.send(None)
        except KeyboardInterrupt:
            raise
        except BaseException as problem:
            return self.ended(problem)
        return RUNNING if given is None else self.yielded(given)

    def yielded(self, given: object) -> int:
        """Return the status if the generator has yielded this."""
        try:
            if given == RUNNING:
                return RUNNING
            running, self.send = self.send, None
            running.__self__.close()
        except KeyboardInterrupt:
            raise
        except BaseException as problem:
            return self.ended(problem)
        reason = f"it yielded {given!r}: to end, return that; a yield says that it runs"
        return _completed(self.trace, self.instance.cannot_know(reason))

    def ended(self, problem: BaseException) -> int:
        """Return the status if the generator has raised this, or has returned."""
        self.send = None
        if isinstance(problem, StopIteration):
            return _completed(self.trace, status_of(self.instance, problem.value))
        return _completed(self.trace, fail_with(self.instance, problem))

    def halt(self, keep: bool) -> None:
        if self.send is not None:
            running, self.send = self.send, None
            _stop(self.instance, running.__self__.close)
        _halted(self.trace)


class KeptValues(dict[str, "Any"]):
    """The values that a generator keeps while it is suspended."""

    def saved(self) -> dict[str, Any]:
        """Return them as JSON."""
        return dict(self)

    def restore(self, saved: Mapping[str, Any]) -> None:
        """Take back what `saved` returned."""
        self.clear()
        self.update(saved)


def resumable_leaf(instance: NodeInstance, call: Callable[..., Any], stored: Stored) -> Compiled:
    """Compile a generator function that takes what it kept when it was suspended."""
    kept = KeptValues()
    leaf = GeneratorLeaf(instance, partial(call, **{KEPT: kept}), stored)

    def tick() -> int:
        status = leaf.tick()
        if status != RUNNING:
            kept.clear()
        return status

    def halt(keep: bool) -> None:
        leaf.halt(keep)
        if not keep:
            kept.clear()

    instance.memory = (tick,)
    return tick, halt


class ClassLeaf:
    """A leaf that runs an object with `start`, `tick` and `halt`; as GeneratorLeaf otherwise.

    It has a `start` of its own only if that has constant values: a bound method for each of many leaves takes memory.
    """

    __slots__ = ("instance", "interrupts", "leaf", "send", "start", "stored", "trace")

    def __init__(self, instance: NodeInstance, leaf: Any, start: Callable[..., Any] | None, stored: Stored) -> None:
        self.instance = instance
        self.leaf = leaf
        self.start = start
        self.stored = stored
        self.trace = _trace_of(instance)
        self.interrupts = instance.state.interrupts if getattr(leaf, "interrupts", True) else _NO_INTERRUPTS
        self.send: Any = None  # the `tick` of the object while it runs

    def tick(self) -> int:
        try:
            if self.send is not None:
                given = self.send()
            else:
                values = None if self.stored is None else self.stored()
                if self.interrupts or self.trace is not None:
                    _begin(self.interrupts, self.trace)
                self.send = self.leaf.tick
                start = self.leaf.start if self.start is None else self.start
                given = start() if values is None else start(**values)
        except KeyboardInterrupt:
            raise
        except BaseException as problem:
            return self.ended(problem)
        return RUNNING if given is None else self.yielded(given)

    def yielded(self, given: object) -> int:
        """Return the status if the object has returned this."""
        try:
            if given == RUNNING:
                return RUNNING
            self.send = None
            status = SUCCESS if given is True else status_of(self.instance, given)
        except KeyboardInterrupt:
            raise
        except BaseException as problem:
            return self.ended(problem)
        return _completed(self.trace, status)

    def ended(self, problem: BaseException) -> int:
        """Return the status if the object has raised this."""
        running, self.send = self.send, None
        if running is not None and not isinstance(problem, ActionFailed):
            _stop(self.instance, self.leaf.halt)
        return _completed(self.trace, fail_with(self.instance, problem))

    def halt(self, keep: bool) -> None:
        if self.send is not None:
            self.send = None
            _stop(self.instance, self.leaf.halt)
        _halted(self.trace)


_NO_INTERRUPTS: list[Callable[[], None]] = []


def _completed(trace: LeafTrace | None, status: int) -> int:
    return status if trace is None else trace.ended(status)


def _halted(trace: LeafTrace | None) -> None:
    if trace is not None and trace.reported_by_leaf:
        trace.halted()


def _trace_of(instance: NodeInstance) -> LeafTrace | None:
    """Return its trace. The leaf itself reports how it ended, unless conditions around it may change that."""
    trace = instance.state.node_trace
    if trace is not None and trace.index and not any(port[:1] == "_" for port, _ in instance.node.ports):
        trace.reported_by_leaf = True
    return trace


def _begin(interrupts: list[Callable[[], None]], trace: LeafTrace | None) -> None:
    """Halt the running actions that a generator or class leaf replaces. Called before it starts."""
    while interrupts:
        interrupts.pop()()
    if trace is not None:
        trace.change(RUNNING)
        trace.flush()  # so that a monitor shows a leaf that hangs


def _stop(instance: NodeInstance, halt: Callable[[], object]) -> None:
    try:
        halt()
    except KeyboardInterrupt:
        raise
    except BaseException as problem:
        instance.state.halt_faults.append(Fault(instance.index, describe_exception(problem), problem))


def fail_with(instance: NodeInstance, problem: BaseException) -> int:
    """Return FAILURE, for the reason that the leaf gave, or with the exception that it shouldn't have raised."""
    if not isinstance(problem, ActionFailed):
        return instance.cannot_know(describe_exception(problem), problem)
    fail = instance.cannot_know if _is_question(instance, problem) else instance.fail
    return fail(_reason(problem))


def _reason(problem: ActionFailed) -> str:
    first = problem.args[0] if problem.args else ""
    if isinstance(first, NotThere):
        return first
    return NotThere(problem) if isinstance(problem, Unknown) else str(problem)


def _is_question(instance: NodeInstance, problem: ActionFailed) -> bool:
    """Whether a leaf was asked something. A function that raises Unknown counts even if it isn't a declared
    condition.
    """
    signature = instance.state.signatures[instance.node.id]
    return signature.binding.condition or (isinstance(problem, Unknown) and signature.kind == "function")


def answering(call: Callable[..., Any]) -> Callable[..., Any]:
    """Return a condition that raises Unknown where what it returns is no answer: nothing, or a number."""

    def ask(**given: Any) -> Any:
        answer = call(**given)
        if answer is None:
            raise Unknown("it returned nothing, and a condition has to return True or False")
        if type(answer) is int:
            raise Unknown(f"it returned {answer}, which is no answer: return True or False, as in bool(...)")
        return answer

    return ask


def find_status(instance: NodeInstance, answer: object) -> int:
    """Return the status of what a function returned, or of the exception that it raised instead."""
    return fail_with(instance, answer) if isinstance(answer, BaseException) else status_of(instance, answer)


def status_of(instance: NodeInstance, result: object) -> int:
    """Return the status of a returned value; a FAILURE is recorded as that of the leaf."""
    if result is True or result is None:
        return SUCCESS
    if result is False:
        return instance.refuse()
    if isinstance(result, Failed):
        return instance.fail(result.reason)
    if isinstance(result, int) and result in (RUNNING, SKIPPED):
        return int(result)
    if type(result).__name__ in _TRUTHS or (isinstance(result, int) and result in (FAILURE, SUCCESS)):
        return SUCCESS if result else instance.refuse()
    return instance.cannot_know(f"it returned {result!r}, which is neither True, False, None nor a status")
