"""Instances of nodes: what a node compiles to, and what its compiler may use.

A compiled node is a pair of closures:
- `tick()` returns a status. A node that returns SUCCESS or FAILURE has reset itself. One that returns SKIPPED may keep
  a count (Repeat and RetryUntilSuccessful do, as in BehaviorTree.CPP), so its parent halts it before it moves on. If a
  node returns FAILURE, it or a node below it has called `instance.fail`, and that failure is the latest one recorded.
  So if a node ticks other children after the one that decides, it records that child's failure again, and a branch
  that is SKIPPED restores the failure from before its condition.
- `halt(keep)` stops every leaf that runs below and resets. With `keep` it suspends: positions, counts and timers stay,
  and the next tick continues with them. It may be called at any time, even after an exception in a tick, and twice.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping, Sequence
from functools import cache

from btlang.engine.blackboard import Blackboard
from btlang.engine.clock import Clock, LeafTimer
from btlang.engine.leaves.leaf import REFUSED, ActionFailed, LeafBinding, NotThere, Reason
from btlang.engine.script.values import as_text, as_whole
from btlang.engine.status import FAILURE
from btlang.support.record import Record
from btlang.tree.catalogue import CATALOGUE
from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, Protocol, TypeAlias

    from btlang.engine.leaves.leaf import LeafSignature
    from btlang.engine.slot_memory import SlotMemory

    Tick: TypeAlias = Callable[[], int]
    Halt: TypeAlias = Callable[[bool], None]
    Compiled: TypeAlias = tuple[Tick, Halt]
    Memory: TypeAlias = Tick | SlotMemory

    class LeafTrace(Protocol):
        """The trace by which a leaf that takes time reports its own status; see NodeTrace in status_trace.py."""

        index: int
        reported_by_leaf: bool

        def change(self, status: int) -> None: ...

        def ended(self, status: int) -> int: ...

        def halted(self) -> None: ...

        def flush(self) -> None: ...

        def wrap_functions(self, children: Sequence[Compiled], keeps: bool) -> list[Compiled]: ...

    class Hooks(Protocol):
        """Calls before and behind the ticks of nodes; see Breakpoints in btlang/monitor/breakpoints.py."""

        def wrap(self, index: int, compiled: Compiled) -> Compiled: ...

    class BackgroundWork(Protocol):
        """The interface of Background in leaves/background.py."""

        @property
        def is_working(self) -> bool: ...

        def take_faults(self) -> list[Fault]: ...

        def close(self, patience: float) -> list[int]: ...


class EngineError(Exception):
    """An error that keeps the tree from being compiled; `node` is the node at fault."""

    def __init__(self, message: str, node: Node) -> None:
        super().__init__(message)
        self.message = message
        self.node = node


class Fault(Record):
    """A failure that was recorded during a tick: index of the node, reason for people (see REFUSED).

    `cause` is the failure below it that made it fail, if it has something to add.
    """

    index: int
    reason: Reason
    exception: BaseException | None = None
    cause: Fault | NodeInstance | None = None


class EngineState:
    """The state that all nodes of one engine share."""

    __slots__ = (
        "background",
        "bind",
        "clock",
        "emergency",
        "enums",
        "fault",
        "halt_faults",
        "interrupts",
        "node_trace",
        "on_warning",
        "proxies",
        "service_names",
        "services",
        "signatures",
        "stopwatch",
        "unanswered",
        "unknown",
        "unknowns",
        "warned",
    )  # fmt: skip

    def __init__(
        self,
        bind: Callable[[str], LeafBinding | None],
        clock: Clock,
        services: Mapping[str, Any],
        enums: Mapping[str, float],
        stopwatch: LeafTimer | None,
        proxies: Mapping[str, Callable[..., Any]] = {},
    ) -> None:
        self.bind = bind
        self.proxies = proxies  # what background leaves get in place of services, see Engine
        self.stopwatch = stopwatch
        self.clock = clock
        self.services = {"clock": clock, **services}
        self.service_names = frozenset(("blackboard", *self.services))
        self.signatures: dict[str, LeafSignature] = {}  # of the leaves that were bound so far, by id
        self.enums = {name: float(value) for name, value in enums.items()}  # names that scripts and Switch nodes know
        self.background: BackgroundWork | None = None  # where a leaf works beside the tick
        self.fault: Fault | NodeInstance | None = None  # the latest failure
        self.unknown: Fault | NodeInstance | None = None  # the latest failure that isn't an answer
        self.unknowns = 0  # how many there have been
        self.unanswered: dict[int, Fault | NodeInstance] = {}  # why the condition of a rule has never been known so far
        self.warned: set[int] = set()  # which of them `on_warning` knows of
        self.on_warning: Callable[[Fault | NodeInstance], object] | None = None
        # exceptions that leaves raised while they were halted; only the latest, should nobody ask for them
        self.halt_faults: deque[Fault] = deque(maxlen=1000)
        self.emergency = False  # whether the halt in progress is an emergency stop, which starts nothing
        # what reactive nodes that are at another child want stopped before an action starts there
        self.interrupts: list[Callable[[], None]] = []
        self.node_trace: LeafTrace | None = None  # of the node that is being compiled

    def note_answer(self, index: int, known: bool) -> None:
        """Note whether the condition of the rule with this number had an answer at last."""
        if known:
            self.unanswered.pop(index, None)
        elif self.unknown is not None:
            self.unanswered[index] = self.unknown


class NodeInstance:
    """A use of a node, after expansion of subtrees: what its compiler may use, and what identifies it later.

    `above` is the instance of its parent, None for the root, and `position` its place among the children there;
    `index` is its number in preorder; `scope` is its blackboard. It also represents a failure of its node
    without a separate reason.
    """

    __slots__ = ("_usual", "above", "index", "leaf", "memory", "node", "position", "scope", "state")

    reason = REFUSED
    exception = None
    cause = None

    def __init__(
        self, node: Node, index: int, above: NodeInstance | None, position: int, scope: Blackboard, state: EngineState
    ) -> None:
        self.node = node
        self.index = index
        self.above = above
        self.position = position
        self.scope = scope
        self.state = state
        self._usual: Fault | None = None
        self.memory: tuple[
            Memory, ...
        ] = ()  # what it remembers: functions whose cells hold that, or slots; see saving.py
        self.leaf: Compiled | None = None  # what a node without children was compiled to, unless it's a mere function

    @property
    def parent_keeps_completed(self) -> bool:
        """Whether the node above keeps completed children without resetting them."""
        kind = None if self.above is None else CATALOGUE.get(self.above.node.id)
        return kind is not None and kind.keeps_completed

    def refuse(self) -> int:
        """Record that this leaf has returned False; return FAILURE."""
        self.state.fault = self
        return FAILURE

    def fail(self, reason: Reason, exception: BaseException | None = None) -> int:
        """Record that this node failed; return FAILURE. Cheapest with the same text as the last time."""
        fault = self._usual
        if fault is None or fault.reason is not reason or exception is not None:
            fault = Fault(self.index, reason, exception)
            if exception is None:  # which would keep what its frames hold
                self._usual = fault
        self.state.fault = fault
        return FAILURE

    def cannot_know(self, reason: Reason, exception: BaseException | None = None) -> int:
        """Record that this node failed without an answer: its failure doesn't mean no. Returns FAILURE."""
        self.fail(reason, exception)
        state = self.state
        state.unknown = state.fault
        state.unknowns += 1
        if self.index not in state.warned and state.fault is not None:
            state.warned.add(self.index)
            if state.on_warning is not None:
                state.on_warning(state.fault)
        return FAILURE

    def not_known(self, before: int) -> bool:
        """Whether a node below gave no answer since `unknowns` was `before`; then that is the latest failure."""
        state = self.state
        if state.unknowns == before:
            return False
        state.fault = state.unknown
        return True

    def is_not_there(self) -> bool:
        """Whether the latest failure has a reason that may pass by itself."""
        fault = self.state.fault
        while fault is not None and fault.cause is not None:
            fault = fault.cause
        return fault is not None and isinstance(fault.reason, NotThere)

    def pass_on(self, reason: Reason) -> int:
        """Add this node's reason to the failure below it, which stays the cause; return FAILURE."""
        cause = self.state.fault
        below = cause is not None and cause.index > self.index
        self.state.fault = Fault(self.index, reason, None, cause if below else None)
        return FAILURE

    def service(self, name: str) -> Any:
        """Return a service for a leaf by name; the blackboard is that of its scope unless the engine got one."""
        return self.state.services.get(name, self.scope)

    def error(self, message: str) -> EngineError:
        """Make an error that blames this node."""
        return EngineError(message, self.node)

    def number(self, port: str, least: int = 0, most: int = 0) -> Callable[[], int]:
        """Make a function that returns the whole number in a port; for a `{key}` it may raise ActionFailed.

        `least` and `most` are the limits if the catalogue has none. Raises EngineError if the port is missing without a
        default, or if its number isn't from `least` to `most`.
        """
        known = CATALOGUE[self.node.id].ports[port]
        default = known.default
        least = least if known.least is None else known.least
        most = most if known.most is None else known.most
        text = self.node.port(port)
        key = blackboard_key(port, text)
        if key is not None:
            return lambda: _whole(value_of(self.scope, key), port, least, most)
        if not text and default is None:
            raise self.error(f"{self.node.id} needs a port {port}")
        try:
            value = _whole(text or default, port, least, most)
        except ActionFailed as problem:
            raise self.error(str(problem)) from None
        return _always(value)

    def arguments(
        self, ports: Mapping[str, str], converters: Mapping[str, Callable[[str], Any]]
    ) -> tuple[dict[str, Any], Callable[[], dict[str, Any]] | None]:
        """Return the values of leaf ports by name: constants, and a function that reads the others if there are any.

        That function raises ActionFailed if a `{key}` has no value. Constants are converted here, once; raises
        EngineError if that fails.
        """
        constants: dict[str, Any] = {}
        stored: list[tuple[str, str, Callable[[str], Any], Any]] = []
        for port, text in ports.items():
            convert = converters.get(port, str)
            if "{" in text and (key := blackboard_key(port, text)) is not None:
                stored.append((port, key, convert, _CONVERTED.get(convert, str)))
                continue
            try:
                constants[port] = convert(text)
            except Exception as problem:
                raise self.error(f"{port} cannot be {text!r}: {_NEEDED.get(convert, problem)}") from problem
        if not stored:
            return constants, None
        get = self.scope.get

        def read() -> dict[str, Any]:
            values = {}
            for port, key, convert, kinds in stored:
                try:
                    value = get(key)
                except KeyError:
                    raise _no_value(key) from None
                values[port] = _convert(value, port, convert) if isinstance(value, kinds) else value
            return values

        return constants, read


def blackboard_key(port: str, text: str) -> str | None:
    """Return the key in a text `{key}`, None for any other text; `{=}` is the key named as the port.

    Spaces around it do not count (TreeNode::isBlackboardPointer).
    """
    text = text.strip(" ")
    key = text[1:-1]
    if text[:1] != "{" or text[-1:] != "}" or not key or "{" in key or "}" in key:
        return None
    return port if key == "=" else key


def value_of(scope: Blackboard, key: str) -> Any:
    """Return the value of a `{key}`. Raises ActionFailed if there is none."""
    try:
        return scope.get(key)
    except KeyError:
        raise _no_value(key) from None


def _no_value(key: str) -> ActionFailed:
    return ActionFailed(f"{{{key}}} has no value")


def halt_nothing(keep: bool) -> None:
    """Do nothing: the `halt` of a leaf that never runs for longer than its tick."""


def split_children(children: Sequence[Compiled]) -> tuple[tuple[Tick, ...], tuple[Halt, ...]]:
    """Split compiled children into their ticks and their halts."""
    return tuple([tick for tick, _ in children]), tuple([halt for _, halt in children])


@cache  # one function for all nodes that have the number
def _always(value: int) -> Callable[[], int]:
    return lambda: value


_NEEDED: dict[Callable[[str], Any], str] = {float: "a number is needed", int: "a whole number is needed"}


_CONVERTED: dict[Callable[[str], Any], Any] = {as_text: object, as_whole: (str, float)}
"""The values on the blackboard that a converter takes; all others take texts, and other values stay as they are."""


def _convert(value: Any, port: str, convert: Callable[[str], Any]) -> Any:
    try:
        return convert(value)
    except Exception as problem:
        raise ActionFailed(f"{port} cannot be {value!r}: {_NEEDED.get(convert, problem)}") from problem


def _whole(value: Any, port: str, least: int, most: int) -> int:
    """Convert a value to a whole number. Raises ActionFailed unless it is one within the limits; `1.0` isn't, as in
    C++.
    """
    try:
        number = int(value)
    except (TypeError, ValueError, OverflowError):
        number = least - 1
    if not least <= number <= most or (not isinstance(value, str) and number != value):
        raise ActionFailed(f"{port} must be a whole number from {least} to {most}, not {str(value)!r}")
    return number
