"""Binding of leaves to the Python objects that do their work (see leaf.py), whose parameters are filled by name."""

from __future__ import annotations

from collections.abc import Callable, Collection
from functools import partial
from weakref import WeakKeyDictionary

from btlang.engine.instance import NodeInstance, blackboard_key
from btlang.engine.leaves.callables import (
    KEPT,
    ClassLeaf,
    GeneratorLeaf,
    answering,
    function_leaf,
    resumable_leaf,
)
from btlang.engine.leaves.leaf import LeafBinding, LeafSignature, describe_exception

TYPE_CHECKING = False
if TYPE_CHECKING:
    from inspect import Parameter
    from typing import Any

    from btlang.engine.instance import Compiled
    from btlang.engine.leaves.callables import Stored


_OWN: dict[str, set[str]] = {"thread": {"halted"}, "generator": {KEPT}}
"""What only leaves of a kind get, each its own."""
GIVEN = frozenset().union(*_OWN.values())
"""The parameters that no port fills, and that a leaf of another kind doesn't get."""
# A signature costs more than the rest of a leaf. Weak, since a comparison is a function made for one run.
_signatures: WeakKeyDictionary[Callable[..., Any], tuple[Parameter, ...]] = WeakKeyDictionary()


def bind_leaf(instance: NodeInstance, signature: LeafSignature) -> Compiled:
    """Compile a leaf that is a Python object. Raises EngineError if its parameters don't fit its ports."""
    binding, kind = signature.binding, signature.kind
    if binding.thread and kind != "thread":
        raise instance.error(f"{instance.node.id} can't run in a thread: only a plain function can")
    if kind == "class":
        leaf, ports = _make_object(instance, signature), _ports(instance, binding)
        names = tuple(ports)
        if names not in signature.given:
            signature.given[names] = _fill(instance, leaf.start, names, ())
        constants, stored = _arguments(instance, ports, binding)
        return _both(ClassLeaf(instance, leaf, partial(leaf.start, **constants) if constants else None, stored))
    key = instance.node.ports, instance.scope
    if key not in signature.calls:
        signature.calls[key] = _find_call(instance, signature)
    call, stored, given = signature.calls[key]
    if kind == "generator":
        if binding.condition:
            raise instance.error(f"{instance.node.id} is a condition: it has to return its answer, and can't yield")
        if KEPT in given:
            return resumable_leaf(instance, call, stored)
        return _both(GeneratorLeaf(instance, call, stored))
    if kind == "function":
        return function_leaf(instance, call, stored)
    from btlang.engine.leaves.background import background_leaf

    proxied = {name: instance.service(name) for name in given if name in instance.state.proxies}
    background = background_leaf(instance, call, binding.thread, "halted" in given, proxied)
    return _both(ClassLeaf(instance, background, None, stored))


def _both(leaf: ClassLeaf | GeneratorLeaf) -> Compiled:
    return leaf.tick, leaf.halt


def _ports(instance: NodeInstance, binding: LeafBinding) -> dict[str, str]:
    return {**binding.defaults, **{port: text for port, text in instance.node.ports if port[:1] != "_"}}


def _find_call(instance: NodeInstance, signature: LeafSignature) -> tuple[Callable[..., Any], Stored, list[str]]:
    """Return the callable with its constant values, a function that reads the others, and the services that it gets."""
    binding, ports = signature.binding, _ports(instance, signature.binding)
    names = tuple(ports)
    given = signature.given.get(names)
    if given is None:
        services = instance.state.service_names | _OWN.get(signature.kind, set())
        given = signature.given[names] = _fill(instance, binding.call, names, services)
    constants, stored = _arguments(instance, ports, binding) if ports else ({}, None)
    beside = instance.state.proxies if signature.kind in ("async", "thread") else ()
    for name in given:
        if name not in beside and name not in _OWN.get(signature.kind, ()):
            constants[name] = instance.service(name)
    call = partial(binding.call, **constants) if constants else binding.call
    is_asked = binding.condition and signature.kind == "function"
    return answering(call) if is_asked and not _promises_truth(binding.call) else call, stored, given


def _promises_truth(call: Callable[..., Any]) -> bool:
    """Whether a function says that it returns a truth, so that what it returns needn't be looked at each time."""
    return "bool" in str(getattr(call, "__annotations__", {}).get("return", ""))


def _arguments(instance: NodeInstance, ports: dict[str, str], binding: LeafBinding) -> tuple[dict[str, Any], Stored]:
    """Return the arguments as NodeInstance.arguments does, with a function that writes for each output port."""
    if not binding.outputs:
        return instance.arguments(ports, binding.converters)
    constants, stored = instance.arguments(
        {port: text for port, text in ports.items() if port not in binding.outputs}, binding.converters
    )
    for port in binding.outputs:
        if port in ports:
            key = blackboard_key(port, ports[port])
            if key is None:
                raise instance.error(f"{port} is an output: it must be a {{key}}, not {ports[port]!r}")
            constants[port] = partial(instance.scope.set, key)
    return constants, stored


def _make_object(instance: NodeInstance, signature: LeafSignature) -> Any:
    cls: Any = signature.binding.call
    if signature.made_with is None:
        missing = [method for method in ("start", "tick", "halt") if not callable(getattr(cls, method, None))]
        if missing:
            raise instance.error(f"{cls.__name__} has no {' and no '.join(missing)}, so it isn't a leaf")
        signature.made_with = _fill(instance, cls, (), instance.state.service_names)
    try:
        return cls(**{name: instance.service(name) for name in signature.made_with})
    except KeyboardInterrupt:
        raise
    except BaseException as problem:
        raise instance.error(f"{cls.__name__} cannot be made: {describe_exception(problem)}") from problem


def _fill(
    instance: NodeInstance, call: Callable[..., Any], ports: Collection[str], services: Collection[str]
) -> list[str]:
    """Check that ports and services fill the parameters; return the names of the services that do."""
    try:
        parameters = _parameters(call)
    except (TypeError, ValueError) as problem:
        raise instance.error(f"{instance.node.id} cannot be called: {problem}") from problem
    named = {p.name: p for p in parameters if p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY)}
    takes_any = any(p.kind == p.VAR_KEYWORD for p in parameters)
    unknown = [port for port in ports if port not in named]
    if unknown and not takes_any:
        raise instance.error(f"{instance.node.id} takes no port {unknown[0]}" + _list_ports(named, services))
    for p in parameters:
        required = p.default is p.empty and p.kind not in (p.VAR_POSITIONAL, p.VAR_KEYWORD)
        if required and (p.name not in named or (p.name not in ports and p.name not in services)):
            raise instance.error(f"{instance.node.id} needs a value for {p.name}")
    return [name for name in named if name in services and name not in ports]


def _parameters(call: Callable[..., Any]) -> tuple[Parameter, ...]:
    from inspect import isfunction
    from inspect import signature as signature_of

    if not isfunction(call):
        return tuple(signature_of(call).parameters.values())
    found = _signatures.get(call)
    if found is None:
        found = _signatures[call] = tuple(signature_of(call).parameters.values())
    return found


def _list_ports(named: Collection[str], services: Collection[str]) -> str:
    ports = [name for name in named if name not in services]
    return f"; it takes {', '.join(ports)}" if ports else ""
