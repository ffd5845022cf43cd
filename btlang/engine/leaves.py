"""Leaves: constants, and the functions, generators and classes described in leaf.py.

An exception, any but KeyboardInterrupt, becomes a FAILURE with its reason. A class that raises anything but
ActionFailed is halted as well: it had no chance to stop what it moves. What `halt` itself raises is kept in the
engine's `take_halt_failures`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial

from btlang.engine.build import Fault, Site, halt_nothing
from btlang.engine.leaf import ActionFailed, Failed, Unknown, described
from btlang.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    from btlang.engine.build import Compiled
    from btlang.engine.watch import Watch

    Stored: TypeAlias = Callable[[], Mapping[str, Any]] | None  # reads ports from the blackboard


def always_success(site: Site, children: Sequence[Compiled]) -> Compiled:
    """SUCCESS."""
    return (lambda: SUCCESS), halt_nothing


def always_failure(site: Site, children: Sequence[Compiled]) -> Compiled:
    """FAILURE."""
    return partial(site.fail, "the mission says so"), halt_nothing


def skipped(site: Site, children: Sequence[Compiled]) -> Compiled:
    """What a node with _skipIf="true" is: SKIPPED, and nothing below it is ticked."""
    return (lambda: SKIPPED), halt_nothing


_TRUTHS = ("bool", "bool_")  # what numpy's comparisons give goes by these names


class FunctionLeaf:
    """A function that is called as it is: none of its values come from the blackboard.

    What ticks many children calls such a function itself (see row.py) and hands on here what is no plain answer.
    """

    __slots__ = ("call", "site")

    def __init__(self, site: Site, call: Callable[[], Any]) -> None:
        self.site = site
        self.call = call

    def tick(self) -> int:
        try:
            result = self.call()
        except KeyboardInterrupt:
            raise
        except BaseException as problem:
            return unanswered(self.site, problem)
        return SUCCESS if result is True else status_of(self.site, result)


def as_function(tick: Any) -> FunctionLeaf | None:
    """The leaf that a tick belongs to, where that is a function that is called as it is."""
    leaf = getattr(tick, "__self__", None)
    return leaf if leaf.__class__ is FunctionLeaf else None


def function_leaf(site: Site, call: Callable[..., Any], stored: Stored) -> Compiled:
    """A function; `stored` gives the values that are read at each call."""
    if stored is None:
        return FunctionLeaf(site, call).tick, halt_nothing

    def tick() -> int:
        try:
            result = call(**stored())
        except KeyboardInterrupt:
            raise
        except BaseException as problem:
            return unanswered(site, problem)
        return status_of(site, result)

    return tick, halt_nothing


def generator_leaf(site: Site, call: Callable[..., Any], stored: Stored) -> Compiled:
    """A generator function; `stored` gives the values that are read at each start."""
    generator: Any = None
    interrupts, watch = site.shared.interrupts, _watch_of(site)

    def tick() -> int:
        nonlocal generator
        try:
            if generator is None:
                values = None if stored is None else stored()
                if interrupts or watch is not None:
                    _begin(interrupts, watch)
                generator = call() if values is None else call(**values)
            next(generator)
            return RUNNING
        except StopIteration as stop:
            generator = None
            status = status_of(site, stop.value)
        except KeyboardInterrupt:
            raise
        except BaseException as problem:
            generator = None
            status = failed(site, problem)
        return status if watch is None else watch.ended(status)

    def halt(keep: bool) -> None:
        nonlocal generator
        if generator is not None:
            running, generator = generator, None
            _stop(site, running.close)

    return tick, halt


def class_leaf(site: Site, leaf: Any, start: Callable[..., Any], stored: Stored) -> Compiled:
    """An object with `tick` and `halt`, and what starts it; `stored` gives the values that are read at each start."""
    go_on = leaf.tick
    interrupts, watch = site.shared.interrupts, _watch_of(site)
    running = False

    def tick() -> int:
        nonlocal running
        try:
            if running:
                result = go_on()
            else:
                values = None if stored is None else stored()
                if interrupts or watch is not None:
                    _begin(interrupts, watch)
                running = True
                result = start() if values is None else start(**values)
            if result is None or result == RUNNING:
                return RUNNING
            running = False
            status = SUCCESS if result is True else status_of(site, result)
        except ActionFailed as problem:
            running = False
            status = failed(site, problem)
        except KeyboardInterrupt:
            raise
        except BaseException as problem:
            halt(False)
            status = failed(site, problem)
        return status if watch is None else watch.ended(status)

    def halt(keep: bool) -> None:
        nonlocal running
        if running:
            running = False
            _stop(site, leaf.halt)

    return tick, halt


def _watch_of(site: Site) -> Watch | None:
    """Its watch, to which the leaf itself tells how it ended unless conditions around it may change that."""
    watch = site.shared.watch
    if watch is not None and watch.index and not any(port[:1] == "_" for port, _ in site.node.ports):
        watch.told_by_leaf = True
    return watch


def _begin(interrupts: list[Callable[[], None]], watch: Watch | None) -> None:
    """To be called before a generator or class leaf starts: running actions that it replaces are halted first."""
    while interrupts:
        interrupts.pop()()
    if watch is not None:
        watch.change(RUNNING)
        watch.trace.tell()  # so that a monitor shows a leaf that hangs


def _stop(site: Site, halt: Callable[[], object]) -> None:
    try:
        halt()
    except KeyboardInterrupt:
        raise
    except BaseException as problem:
        site.shared.halt_faults.append(Fault(site.index, described(problem), problem))


def failed(site: Site, problem: BaseException) -> int:
    """FAILURE, for the reason that the leaf gave, or with the exception that it should not have raised."""
    if isinstance(problem, ActionFailed):
        return site.fail(str(problem))
    return site.fail(described(problem), problem)


def unanswered(site: Site, problem: BaseException) -> int:
    """As `failed`, for a function, which may be a condition that does not know."""
    return site.cannot_know(str(problem)) if isinstance(problem, Unknown) else failed(site, problem)


def status_of(site: Site, result: object) -> int:
    """The status that a returned value stands for; a FAILURE is recorded as that of the leaf."""
    if result is True or result is None:
        return SUCCESS
    if result is False:
        return site.refuse()
    if isinstance(result, Failed):
        return site.fail(result.reason)
    if isinstance(result, int) and result in (RUNNING, SKIPPED):
        return int(result)
    if type(result).__name__ in _TRUTHS or (isinstance(result, int) and result in (FAILURE, SUCCESS)):
        return SUCCESS if result else site.refuse()
    return site.fail(f"it returned {result!r}, which is neither True, False, None nor a status")
