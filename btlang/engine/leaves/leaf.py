"""Leaves: what a leaf can be, and how it is bound to the Python object that does its work.

A leaf is one of
- a function: called at a tick; returns True or None (SUCCESS), False (FAILURE) or a status integer;
- a generator function: each `yield` is RUNNING, its return value counts as a function's; halting closes it, so stop
  what it moves with `try: ... finally: robot.stop()`;
- a class with `start(**ports)`, `tick()` and `halt()`: created once for its node; `start` and `tick` return the same
  as functions, but None means RUNNING. `halt` is only called while it runs. With a class attribute `interrupts = False`
  it isn't known to be an action: what it replaces is halted after it has started, if it is RUNNING then;
- a background leaf: an `async def` function, or a plain function with `thread` in its binding. It runs concurrently
  with ticks and is RUNNING until it returns; its value counts as a function's, and the next tick comes at once. Halting
  cancels the task of an async function, and sets the event `halted` for a thread, which should check it. The engine
  doesn't wait for either: a leaf that keeps running isn't started again before it has ended, and is reported if it
  outlives the run.

Parameters are filled by name: ports first, then services (`robot`, `clock`, `blackboard`, `wake`, `wake_at`,
`progress`, `beside`); a class gets the services in its constructor and the ports in `start`. `wake()` asks for a tick
at once, from any thread. `wake_at(time)`, called during a tick, asks for the next tick at that time of the clock if
that is sooner than usual. A thread also gets `halted`, a threading.Event. `progress(share, state)` reports from any
thread how much is done, from 0 to 1, and in words what the leaf is doing; in most runs nobody listens. `beside` is a
set of whatever works in real time elsewhere, as in another process: a run at full speed waits for it.
A generator function with a parameter `kept` gets a dictionary of plain values there, in which it writes how far it is:
empty at a start, and as it left it where it starts again after it was suspended. A saved run has it too.

Background leaves run concurrently with ticks. Safe for them are `wake`, `progress`, `halted`, reading `clock.now`, and
reading and setting single blackboard entries. Other services may be proxies (see Engine): they run calls on the thread
that ticks, and refuse them once the leaf was halted.

A leaf that fails says why: it raises ActionFailed, or returns `Failed(reason)`, which is cheaper and can compute the
reason later. For False the reason is the `refusal` of its binding.

A condition that can't know its answer raises Unknown. If it raises anything else, or returns neither a truth nor a
status, its answer isn't known either: only False and `Failed` mean no.

For an output port (its text is a `{key}`), the parameter gets a function: `store(value)` writes the value to that key.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from btlang.support.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    Ports: TypeAlias = tuple[tuple[str, str], ...]
    Call: TypeAlias = tuple[Callable[..., Any], Callable[[], Mapping[str, Any]] | None, list[str]]

Reason: TypeAlias = "str | Callable[[], str]"
"""Why something failed, for people: a text, or what gives it when somebody asks."""

REFUSED = "it returned False"
"""Stands for the `refusal` of a leaf's binding, which is looked for when somebody asks."""


class NotThere(str):
    """A reason that may pass by itself: a device, a server or a component isn't there now. A retry waits for it."""

    __slots__ = ()


def ignore_progress(share: float, state: str = "") -> None:
    """Do nothing: the service `progress` if nobody listens."""


class ActionFailed(Exception):
    """An exception that makes a leaf FAIL with a reason for people: `raise ActionFailed("nothing within reach")`."""


class Unknown(ActionFailed):
    """An exception of a condition that can't know its answer: `raise Unknown("the scanner is silent")`.

    The condition FAILS, and so do an Inverter, an IfThenElse and a WhileDoElse above it: unknown doesn't mean false.
    """


class Failed(Record):
    """A FAILURE with a reason, which a leaf can return instead of False."""

    reason: Reason

    def __bool__(self) -> bool:
        return False


def reason_text(reason: Reason) -> str:
    """Return the text of a reason. If a function can't compute it, it is the text of the exception."""
    if isinstance(reason, str):
        return str(reason)
    try:
        return reason()
    except KeyboardInterrupt:
        raise
    except BaseException as problem:
        return describe_exception(problem)


def describe_exception(problem: BaseException) -> str:
    """Describe an exception as the reason of a failure."""
    name, text = type(problem).__name__, str(problem)
    return f"{name}: {text}" if text else name


def find_raising_line(problem: BaseException | None) -> str:
    """Return the line of Python that raised an exception, for people; "" if it isn't known."""
    if problem is None or problem.__traceback__ is None:
        return ""
    import os
    from traceback import extract_tb

    *_, frame = extract_tb(problem.__traceback__, limit=-1)
    return f"{frame.name}, {os.path.basename(frame.filename)}:{frame.lineno}"


def failure_reason(problem: BaseException) -> str:
    """Return why something failed: the message of an ActionFailed, else the description of the exception."""
    return str(problem) if isinstance(problem, ActionFailed) else describe_exception(problem)


def locate_failure(problem: BaseException) -> str:
    """Return why something failed, with the line of Python that raised it, unless it is an ActionFailed."""
    place = "" if isinstance(problem, ActionFailed) else find_raising_line(problem)
    return failure_reason(problem) + (f" (raised in {place})" if place else "")


class LeafBinding(Record):
    """The Python side of a leaf id: what to call, how to convert the text of each port, and values for missing ports.

    `outputs` are the ports that the leaf writes, `refusal` is the reason for a returned False.
    With `thread` a plain function is called in a separate thread. With `condition` the leaf is a question: whatever it
    raises means that its answer isn't known. `measured` says what it measured at the latest call that was true.
    """

    call: Callable[..., Any]
    converters: Mapping[str, Callable[[str], Any]] = {}
    defaults: Mapping[str, str] = {}
    outputs: tuple[str, ...] = ()
    refusal: str = REFUSED
    thread: bool = False
    condition: bool = False
    measured: Callable[[], str] | None = None


class LeafSignature:
    """The part of a binding that the leaves of one engine with the same id share, found once.

    `kind` is "class", "async", "generator", "thread" or "function"; `given` keeps the names of the services that the
    call gets, by the names of the ports that a node has; for a class `made_with` keeps those of its constructor.
    `calls` are shared by equal leaves: what `binding` makes of the ports and the blackboard of a node.
    """

    __slots__ = ("binding", "calls", "given", "kind", "made_with")

    def __init__(self, binding: LeafBinding) -> None:
        from inspect import isclass, iscoroutinefunction, isgeneratorfunction

        call = binding.call
        self.binding = binding
        self.given: dict[tuple[str, ...], list[str]] = {}
        self.calls: dict[tuple[Ports, object], Call] = {}
        self.made_with: list[str] | None = None
        if isclass(call):
            self.kind = "class"
        elif iscoroutinefunction(call) or iscoroutinefunction(type(call).__call__):
            self.kind = "async"
        elif isgeneratorfunction(call) or isgeneratorfunction(type(call).__call__):
            self.kind = "generator"
        else:
            self.kind = "thread" if binding.thread else "function"
