"""The part of NumPy with which a simulated robot plans ways and reads its scanner, in plain Python.

Arrays are lists of Python's numbers with a shape. What is taken out of an array is a copy, never a view.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, nullcontext
from itertools import chain, compress, repeat
from math import inf, nan
from types import SimpleNamespace

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    Shape = tuple[int, ...]

__all__ = ["inf", "nan"]
float64, int64, bool_ = float, int, bool
is_stand_in = True
"""What is done for many entries at a time is slow here: see btlang/robots/worlds/scan.py."""


def _divide(one: float, other: float) -> float:
    if other:
        return one / other
    return nan if not one or one != one else math.copysign(inf, one) * math.copysign(1.0, other)


def _operator(do: Callable[[Any, Any], Any]) -> Any:
    """Return an operator of arrays, and the same with its operands exchanged."""
    return lambda one, other: _both(do, one, other), lambda one, other: _both(do, other, one)


class ndarray:
    """An array of up to three dimensions. `flat` are its entries, the last index changes fastest."""

    __slots__ = ("__weakref__", "flags", "flat", "shape")
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, flat: list[Any], shape: Shape) -> None:
        self.flat, self.shape = flat, shape
        self.flags = SimpleNamespace(writeable=True)

    def __len__(self) -> int:
        return self.shape[0]

    def __iter__(self) -> Iterator[Any]:
        return iter(self.flat) if len(self.shape) == 1 else (self[row] for row in range(len(self)))

    def __repr__(self) -> str:
        return f"array({self.tolist()!r})"

    @property
    def T(self) -> ndarray:
        rows, columns = self.shape
        return ndarray([each for column in range(columns) for each in self.flat[column::columns]], (columns, rows))

    def tolist(self) -> list[Any]:
        return self.flat.copy() if len(self.shape) == 1 else [row.tolist() for row in self]

    def copy(self) -> ndarray:
        return ndarray(self.flat.copy(), self.shape)

    def ravel(self) -> ndarray:
        return ndarray(self.flat.copy(), (len(self.flat),))

    def reshape(self, *shape: int) -> ndarray:
        known = math.prod(size for size in shape if size >= 0)
        return ndarray(self.flat.copy(), tuple(len(self.flat) // known if size < 0 else size for size in shape))

    def astype(self, kind: type) -> ndarray:
        return ndarray([kind(each) for each in self.flat], self.shape)

    def any(self) -> bool:
        return any(self.flat)

    def all(self) -> bool:
        return all(self.flat)

    def sum(self) -> Any:
        return sum(self.flat)

    def max(self) -> Any:
        return max(self.flat)

    def min(self, axis: int | None = None, initial: float = inf) -> Any:
        if axis is None:
            return min(self.flat, default=initial)
        rows = [row.flat for row in self]
        return ndarray(list(map(min, *rows)) if len(rows) > 1 else rows[0], self.shape[1:])

    def argmin(self) -> int:
        return self.flat.index(min(self.flat))

    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, int) and len(self.shape) > 1:
            size = math.prod(self.shape[1:])
            return ndarray(self.flat[key * size : (key + 1) * size], self.shape[1:])
        if isinstance(key, tuple) and any(each is None for each in key):
            return ndarray(self.flat, (len(self), 1) if key[1] is None else (1, len(self)))
        places, shape = self._places(key)
        return self.flat[places[0]] if shape is None else ndarray([self.flat[at] for at in places], shape)

    def __setitem__(self, key: Any, value: Any) -> None:
        places, shape = self._places(key)
        values = _entries(value, shape or ()) if isinstance(value, ndarray) else repeat(value)
        for at, each in zip(places, values, strict=False):
            self.flat[at] = each

    def _places(self, key: Any) -> tuple[Sequence[int], Shape | None]:
        """Return the places of what a key stands for, and the shape of that; None for one entry."""
        if isinstance(key, ndarray) and key.flat and isinstance(key.flat[0], bool):
            found = list(compress(range(len(self.flat)), key.flat))
            return found, (len(found),)
        keys = key if isinstance(key, tuple) else (key,)
        if all(isinstance(each, ndarray) for each in keys):
            step = math.prod(self.shape[len(keys) :])
            starts = [_place(indices, self.shape) for indices in zip(*(each.flat for each in keys), strict=True)]
            inner = self.shape[len(keys) :]
            return [at for start in starts for at in range(start, start + step)], (len(starts), *inner)
        shape: list[int] = []
        size, starts = len(self.flat), [0]
        for length, each in zip(self.shape, (*keys, *repeat(slice(None), len(self.shape) - len(keys))), strict=True):
            size //= length or 1
            chosen = range(length)[each] if isinstance(each, slice) else range(each % length, each % length + 1)
            shape += [len(chosen)] if isinstance(each, slice) else []
            starts = [start + size * at for start in starts for at in chosen]
        return starts, tuple(shape) if shape else None

    def __matmul__(self, other: ndarray) -> ndarray:
        first, *others = other
        found: list[Any] = []
        for row in self:
            sums = [row.flat[0] * each for each in first.flat]
            for factor, line in zip(row.flat[1:], others, strict=True):
                sums = [each + factor * number for each, number in zip(sums, line.flat, strict=True)]
            found += sums
        return ndarray(found, (len(self), other.shape[1]))

    def __invert__(self) -> ndarray:
        return ndarray(list(map(operator.not_, self.flat)), self.shape)

    def __abs__(self) -> ndarray:
        return ndarray(list(map(operator.abs, self.flat)), self.shape)

    def __neg__(self) -> ndarray:
        return ndarray(list(map(operator.neg, self.flat)), self.shape)

    __add__, __radd__ = _operator(operator.add)
    __sub__, __rsub__ = _operator(operator.sub)
    __mul__, __rmul__ = _operator(operator.mul)
    __mod__, __rmod__ = _operator(operator.mod)
    __pow__, __rpow__ = _operator(operator.pow)
    __and__, __rand__ = _operator(operator.and_)
    __or__, __ror__ = _operator(operator.or_)
    __xor__, __rxor__ = _operator(operator.xor)
    __truediv__, __rtruediv__ = _operator(_divide)
    __lt__, __gt__ = _operator(operator.lt)[0], _operator(operator.gt)[0]
    __le__, __ge__ = _operator(operator.le)[0], _operator(operator.ge)[0]
    __eq__, __ne__ = _operator(operator.eq)[0], _operator(operator.ne)[0]


def _place(indices: Sequence[int], shape: Shape) -> int:
    """Return the place in `flat` at which the entries of some first indices begin."""
    at = 0
    for index, length in zip(indices, shape, strict=False):
        at = at * length + index % length
    return at * math.prod(shape[len(indices) :])


def _entries(value: Any, shape: Shape) -> Iterable[Any]:
    """Return the entries of a number or an array as many times as a shape needs them."""
    if not isinstance(value, ndarray):
        return repeat(value, math.prod(shape))
    if value.shape == shape:
        return value.flat
    if value.shape[-1:] == (1,) and len(value.shape) > 1:  # a column
        return chain.from_iterable(repeat(each, shape[-1]) for each in value.flat)
    return value.flat * (math.prod(shape) // (len(value.flat) or 1))


def _both(do: Callable[[Any, Any], Any], one: Any, other: Any) -> Any:
    """Do something with each pair of entries."""
    shapes = [each.shape for each in (one, other) if isinstance(each, ndarray)]
    if not shapes:
        return do(one, other)
    longest = max(map(len, shapes))
    sizes = zip(*((1,) * (longest - len(shape)) + shape for shape in shapes), strict=True)
    shape = tuple(min(each) if 0 in each else max(each) for each in sizes)
    return ndarray(list(map(do, _entries(one, shape), _entries(other, shape))), shape)


def _each(do: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """Return a function of numbers and arrays that does something with each entry."""
    return lambda value: ndarray(list(map(do, value.flat)), value.shape) if isinstance(value, ndarray) else do(value)


class _Pairwise:
    """A function of two numbers or arrays."""

    def __init__(self, do: Callable[[Any, Any], Any]) -> None:
        self._do = do

    def __call__(self, one: Any, other: Any, out: ndarray | None = None) -> Any:
        found = _both(self._do, one, other)
        if out is not None:
            out.flat[:] = found.flat
        return found

    def reduce(self, arrays: Iterable[ndarray]) -> ndarray:
        first, *others = arrays
        for each in others:
            first = _both(self._do, first, each)
        return first

    def at(self, array: ndarray, places: ndarray, values: ndarray) -> None:
        for place, value in zip(places.flat, values.flat, strict=True):
            array.flat[place] = self._do(array.flat[place], value)


def _least(one: float, other: float) -> float:
    return one if one < other or one != one else other


def _most(one: float, other: float) -> float:
    return one if one > other or one != one else other


hypot, arctan2, divide = _Pairwise(math.hypot), _Pairwise(math.atan2), _Pairwise(_divide)
minimum, maximum, logical_or = _Pairwise(_least), _Pairwise(_most), _Pairwise(operator.or_)
fmin = _Pairwise(lambda one, other: other if one != one or other < one else one)
sqrt, cos, sin, abs = _each(math.sqrt), _each(math.cos), _each(math.sin), _each(operator.abs)
radians, degrees, isnan, isfinite = _each(math.radians), _each(math.degrees), _each(math.isnan), _each(math.isfinite)
rint = _each(lambda each: float(round(each)))


def array(values: Any, dtype: type | None = None) -> ndarray:
    if isinstance(values, ndarray):
        return values.copy()
    rows = list(values)
    flat: list[Any] = rows
    shape: Shape = (len(rows),)
    if rows and isinstance(rows[0], ndarray | list | tuple):
        inner = [each if isinstance(each, ndarray) else array(each) for each in rows]
        flat, shape = [each for row in inner for each in row.flat], (len(rows), *inner[0].shape)
    return ndarray(flat if dtype is None else [dtype(each) for each in flat], shape)


def asarray(values: Any, dtype: type | None = None) -> ndarray:
    return values if isinstance(values, ndarray) else array(values, dtype)


def full(shape: int | Shape, value: Any) -> ndarray:
    sizes = (shape,) if isinstance(shape, int) else shape
    return ndarray([value] * math.prod(sizes), sizes)


def zeros(shape: int | Shape, dtype: type = float) -> ndarray:
    return full(shape, dtype(0))


empty = zeros


def ones(shape: int | Shape) -> ndarray:
    return full(shape, 1.0)


def arange(start: float, stop: float | None = None) -> ndarray:
    low, high = (type(start)(0), start) if stop is None else (start, stop)
    count = max(0, math.ceil(high - low))
    return ndarray([low + at for at in range(count)], (count,))


def linspace(start: float, stop: float, count: int) -> ndarray:
    step = (stop - start) / max(count - 1, 1)
    return ndarray([start + at * step for at in range(count - 1)] + [stop] * (count > 1) or [start], (count,))


def meshgrid(across: ndarray, down: ndarray) -> tuple[ndarray, ndarray]:
    shape = len(down), len(across)
    return ndarray(across.flat * len(down), shape), ndarray([each for each in down.flat for _ in across.flat], shape)


def clip(values: Any, low: Any, high: Any) -> Any:
    return minimum(maximum(values, low), high)


def where(chosen: ndarray, yes: Any, no: Any) -> ndarray:
    pairs = zip(chosen.flat, _entries(yes, chosen.shape), _entries(no, chosen.shape), strict=True)
    return ndarray([one if is_one else other for is_one, one, other in pairs], chosen.shape)


def flatnonzero(values: ndarray) -> ndarray:
    found = [at for at, each in enumerate(values.flat) if each]
    return ndarray(found, (len(found),))


def convolve(values: ndarray, kernel: ndarray, mode: str) -> ndarray:
    """Return the sums of as many neighbours as the kernel has entries, all of them 1."""
    width, count = len(kernel), len(values) - len(kernel) + 1
    return ndarray([sum(values.flat[at : at + width]) for at in range(count)], (count,))


def errstate(**_: str) -> AbstractContextManager[None]:
    """Return a context without warnings: there are none here."""
    return nullcontext()
