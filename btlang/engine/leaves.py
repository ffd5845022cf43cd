"""Leaves: constants, and the functions, generators and classes described in leaf.py.

An exception becomes a FAILURE with its reason. A class that raises anything but ActionFailed is halted as well: it had
no chance to stop what it moves. What `halt` itself raises is kept in the engine's `take_halt_failures`.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from functools import lru_cache, partial

from btlang.engine.build import Fault, Site, blackboard_key, halt_nothing
from btlang.engine.leaf import ActionFailed, Failed, LeafBinding, described
from btlang.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from inspect import Parameter
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


class Plan:
    """What the leaves of one engine with the same id share, found once.

    `kind` is "class", "async", "generator", "thread" or "function"; `given` keeps the names of the services that the
    call gets, by the names of the ports that a node has; for a class `made_with` keeps those of its constructor.
    """

    __slots__ = ("binding", "given", "kind", "made_with")

    def __init__(self, binding: LeafBinding) -> None:
        from inspect import isclass, iscoroutinefunction, isgeneratorfunction

        call = binding.call
        self.binding = binding
        self.given: dict[tuple[str, ...], list[str]] = {}
        self.made_with: list[str] | None = None
        if isclass(call):
            self.kind = "class"
        elif iscoroutinefunction(call) or iscoroutinefunction(type(call).__call__):
            self.kind = "async"
        elif isgeneratorfunction(call) or isgeneratorfunction(type(call).__call__):
            self.kind = "generator"
        else:
            self.kind = "thread" if binding.thread else "function"


def bound_leaf(site: Site, plan: Plan) -> Compiled:
    """A leaf that is a Python object; raises EngineError where its parameters do not fit its ports."""
    binding = plan.binding
    call: Any = binding.call
    ports = {**binding.defaults, **{port: text for port, text in site.node.ports if port[:1] != "_"}}
    if binding.thread and plan.kind != "thread":
        raise site.error(f"{site.node.id} is to run in a thread, and only a plain function can")
    names = tuple(ports)
    if plan.kind == "class":
        leaf = _make(site, plan)
        if names not in plan.given:
            plan.given[names] = _fill(site, leaf.start, names, ())
        constants, stored = _arguments(site, ports, binding)
        start = partial(leaf.start, **constants) if constants else leaf.start
        return _class_leaf(site, leaf, start, stored)
    given = plan.given.get(names)
    if given is None:
        services = site.shared.service_names
        given = plan.given[names] = _fill(site, call, names, services | {"halted"} if binding.thread else services)
    constants, stored = _arguments(site, ports, binding) if ports else ({}, None)
    for name in given:
        if name != "halted" or not binding.thread:
            constants[name] = site.service(name)
    if constants:
        call = partial(call, **constants)
    if plan.kind in ("async", "thread"):
        from btlang.engine.background import background_leaf

        background = background_leaf(site, call, binding.thread, "halted" in given)
        return _class_leaf(site, background, background.start, stored)
    return _generator_leaf(site, call, stored) if plan.kind == "generator" else _function_leaf(site, call, stored)


def _arguments(site: Site, ports: dict[str, str], binding: LeafBinding) -> tuple[dict[str, Any], Stored]:
    """As Site.arguments, with a function that writes for each output port."""
    if not binding.outputs:
        return site.arguments(ports, binding.converters)
    constants, stored = site.arguments(
        {port: text for port, text in ports.items() if port not in binding.outputs}, binding.converters
    )
    for port in binding.outputs:
        if port in ports:
            key = blackboard_key(port, ports[port])
            if key is None:
                raise site.error(f"{port} is an output: it must be a {{key}}, not {ports[port]!r}")
            constants[port] = partial(site.scope.set, key)
    return constants, stored


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
        except Exception as problem:
            return failed(self.site, problem)
        return SUCCESS if result is True else status_of(self.site, result)


def as_function(tick: Any) -> FunctionLeaf | None:
    """The leaf that a tick belongs to, where that is a function that is called as it is."""
    leaf = getattr(tick, "__self__", None)
    return leaf if leaf.__class__ is FunctionLeaf else None


def _function_leaf(site: Site, call: Callable[..., Any], stored: Stored) -> Compiled:
    if stored is None:
        return FunctionLeaf(site, call).tick, halt_nothing

    def tick() -> int:
        try:
            result = call(**stored())
        except Exception as problem:
            return failed(site, problem)
        return status_of(site, result)

    return tick, halt_nothing


def _generator_leaf(site: Site, call: Callable[..., Any], stored: Stored) -> Compiled:
    generator: Any = None
    interrupts, watch = site.shared.interrupts, site.shared.watch

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
            return status_of(site, stop.value)
        except Exception as problem:
            generator = None
            return failed(site, problem)

    def halt(keep: bool) -> None:
        nonlocal generator
        if generator is not None:
            running, generator = generator, None
            _stop(site, running.close)

    return tick, halt


def _class_leaf(site: Site, leaf: Any, start: Callable[..., Any], stored: Stored) -> Compiled:
    go_on = leaf.tick
    interrupts, watch = site.shared.interrupts, site.shared.watch
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
        except ActionFailed as problem:
            running = False
            return failed(site, problem)
        except Exception as problem:
            halt(False)
            return failed(site, problem)
        running = False
        return SUCCESS if result is True else status_of(site, result)

    def halt(keep: bool) -> None:
        nonlocal running
        if running:
            running = False
            _stop(site, leaf.halt)

    return tick, halt


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
    except Exception as problem:
        site.shared.halt_faults.append(Fault(site.index, described(problem), problem))


def failed(site: Site, problem: Exception) -> int:
    """FAILURE, for the reason that the leaf gave, or with the exception that it should not have raised."""
    if isinstance(problem, ActionFailed):
        return site.fail(str(problem))
    return site.fail(described(problem), problem)


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


def _make(site: Site, plan: Plan) -> Any:
    cls: Any = plan.binding.call
    if plan.made_with is None:
        missing = [method for method in ("start", "tick", "halt") if not callable(getattr(cls, method, None))]
        if missing:
            raise site.error(f"{cls.__name__} has no {' and no '.join(missing)}, so it is no leaf")
        plan.made_with = _fill(site, cls, (), site.shared.service_names)
    try:
        return cls(**{name: site.service(name) for name in plan.made_with})
    except Exception as problem:
        raise site.error(f"{cls.__name__} cannot be made: {described(problem)}") from problem


def _fill(site: Site, call: Callable[..., Any], ports: Collection[str], services: Collection[str]) -> list[str]:
    """Checks that ports and services fill the parameters; returns the names of the services that do."""
    try:
        parameters = _parameters(call)
    except (TypeError, ValueError) as problem:
        raise site.error(f"{site.node.id} cannot be called: {problem}") from problem
    named = {p.name: p for p in parameters if p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY)}
    takes_any = any(p.kind == p.VAR_KEYWORD for p in parameters)
    unknown = [port for port in ports if port not in named]
    if unknown and not takes_any:
        raise site.error(f"{site.node.id} takes no port {unknown[0]}" + _known(named, services))
    for p in parameters:
        required = p.default is p.empty and p.kind not in (p.VAR_POSITIONAL, p.VAR_KEYWORD)
        if required and (p.name not in named or (p.name not in ports and p.name not in services)):
            raise site.error(f"{site.node.id} needs a value for {p.name}")
    return [name for name in named if name in services and name not in ports]


def _parameters(call: Callable[..., Any]) -> tuple[Parameter, ...]:
    from inspect import isfunction, signature

    return _function_parameters(call) if isfunction(call) else tuple(signature(call).parameters.values())


@lru_cache(maxsize=256)  # a signature costs more than the rest of a leaf, and a mission uses few functions
def _function_parameters(call: Callable[..., Any]) -> tuple[Parameter, ...]:
    from inspect import signature

    return tuple(signature(call).parameters.values())


def _known(named: Collection[str], services: Collection[str]) -> str:
    ports = [name for name in named if name not in services]
    return f"; it takes {', '.join(ports)}" if ports else ""
