"""Frozen value classes with slots: the base of tokens, AST, tree, diagnostics and vocabulary entries.

Why not `dataclasses` or attrs: importing them costs more than the rest of `btc check`, and their comparison
recurses, which crashes on a tree that is 10,000 deep (both measured). mypy sees a Record as a dataclass.
"""

from __future__ import annotations

from collections.abc import Container
from functools import cache
from types import CodeType, FunctionType

TYPE_CHECKING = False  # as typing.TYPE_CHECKING, without importing typing at start-up
if TYPE_CHECKING:
    from typing import Any, ClassVar, dataclass_transform
else:

    def dataclass_transform(**_options: object):
        return lambda cls: cls


class _RecordMeta(type):
    """The metaclass that turns the annotations of a class body into slots and a positional constructor, in the order
    written.
    """

    def __new__(
        mcs, name: str, bases: tuple[type, ...], body: dict[str, Any], uncompared: tuple[str, ...] = ()
    ) -> _RecordMeta:
        own = [f for f, kind in body.get("__annotations__", {}).items() if not str(kind).startswith("ClassVar")]
        inherited = [f for base in bases for f in getattr(base, "fields", ())]
        defaults = {k: v for base in bases for k, v in getattr(base, "field_defaults", {}).items()}
        defaults |= {f: body.pop(f) for f in own if f in body}
        cls = super().__new__(mcs, name, bases, body | {"__slots__": tuple(own)})
        fields = tuple(inherited + own)
        cls.fields = fields  # type: ignore[attr-defined]
        cls.field_defaults = defaults  # type: ignore[attr-defined]
        cls._compared = tuple(f for f in fields if f not in uncompared)  # type: ignore[attr-defined]
        if fields:
            cls.__new__ = _make_first(cls, mcs, tuple(own))  # type: ignore[method-assign]
        return cls


def _make_first(cls: type, mcs: type, own: tuple[str, ...]) -> Any:
    """Return what makes the first instance of a class, and then leaves this to a constructor that it makes: of most
    classes a command has none, and making their constructors would be a twentieth of `btc check`.
    """

    def first(kind: type, /, *values: Any, **named: Any) -> Any:
        body = {"__slots__": own, "__setattr__": object.__setattr__, "__delattr__": object.__delattr__}
        open_class: type = type.__new__(mcs, f"_{cls.__name__}", cls.__bases__, body)
        cls.__new__ = _make_new(open_class, cls.fields, cls.field_defaults)  # type: ignore[attr-defined,method-assign]
        return cls.__new__(kind, *values, **named)

    return first


def _make_new(open_class: type, fields: tuple[str, ...], defaults: dict[str, Any]) -> Any:
    """Return a constructor that fills an instance of a class with the same slots that is not frozen, then makes it one
    of the frozen class: writing past a frozen `__setattr__` costs ten times as much for each field.
    """
    code = _new_code(len(fields))
    names = {f"field_{at}": field for at, field in enumerate(fields)}
    code = code.replace(
        co_varnames=tuple(names.get(name, name) for name in code.co_varnames),
        co_names=tuple(names.get(name, name) for name in code.co_names),
    )
    scope = {"make": object.__new__, "open_class": open_class}
    return FunctionType(code, scope, "__new__", tuple(defaults[field] for field in fields if field in defaults))


@cache
def _new_code(count: int) -> CodeType:
    """Compile the code of a constructor, shared by all classes with as many fields: compiling it for each would be a
    tenth of `btc check`.
    """
    arguments = "".join(f", field_{at}" for at in range(count))
    lines = "\n".join(f"    made.field_{at} = field_{at}" for at in range(count))
    scope: dict[str, FunctionType] = {}
    begin, end = "    made = make(open_class)", "    made.__class__ = cls\n    return made"
    exec(f"def __new__(cls{arguments}):\n{begin}\n{lines}\n{end}", scope)
    return scope["__new__"].__code__


@dataclass_transform(frozen_default=True)
class Record(metaclass=_RecordMeta):
    """The base of frozen values. Equality and hashing are loops, so that depth does not matter.

    `class X(Record, uncompared=("span",))` leaves fields out of comparison. Setting a field raises AttributeError.
    """

    if TYPE_CHECKING:
        fields: ClassVar[tuple[str, ...]]
        field_defaults: ClassVar[dict[str, Any]]
        _compared: ClassVar[tuple[str, ...]]

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{type(self).__name__} is frozen: cannot set {name}")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"{type(self).__name__} is frozen: cannot delete {name}")

    def __eq__(self, other: object) -> bool:
        if self.__class__ is not other.__class__:
            return NotImplemented
        return _equal(self, other)

    def __hash__(self) -> int:
        return hash(_flat(self))

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(_brief(self, f) for f in self.fields)})"

    def replace(self, **changes: Any) -> Any:
        """Return a copy with the named fields changed."""
        return type(self)(**{f: changes.get(f, getattr(self, f)) for f in self.fields})

    def as_dict(self, without: Container[str] = ()) -> dict[str, Any]:
        """Return its fields by their names, as they are."""
        return {f: getattr(self, f) for f in self.fields if f not in without}

    def __deepcopy__(self, memo: dict[int, Any]) -> Record:
        return self  # a copy of what is frozen would be the same, and copying a deep tree is recursion

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), tuple(getattr(self, f) for f in self.fields)


def _brief(record: Record, field: str) -> str:
    value = getattr(record, field)
    if (isinstance(value, tuple) and len(value) > 3) or (isinstance(value, Record) and "children" in value.fields):
        return f"{field}=..."
    return f"{field}=({len(value)} items)" if _holds_records(value) else f"{field}={value!r}"


def _holds_records(value: object) -> bool:
    return isinstance(value, tuple) and any(isinstance(v, Record) for v in value)


def _equal(left: object, right: object) -> bool:
    """Compare structure with an explicit stack."""
    stack = [(left, right)]
    while stack:
        a, b = stack.pop()
        if a is b:
            continue
        if isinstance(a, Record):
            if a.__class__ is not b.__class__:
                return False
            stack += [(getattr(a, f), getattr(b, f)) for f in a._compared]
        elif isinstance(a, tuple):
            if not isinstance(b, tuple) or len(a) != len(b):
                return False
            stack += zip(a, b, strict=True)
        elif a != b:
            return False
    return True


def _flat(record: Record) -> tuple[object, ...]:
    """Return every compared atom in a fixed order, with types and lengths as marks."""
    atoms: list[object] = []
    stack: list[object] = [record]
    while stack:
        item = stack.pop()
        if isinstance(item, Record):
            atoms.append(type(item).__name__)
            stack += [getattr(item, f) for f in item._compared]
        elif isinstance(item, tuple):
            atoms.append(len(item))
            stack += item
        else:
            atoms.append(item)
    return tuple(atoms)
