"""Parts of a large tree of words that are read from a cache when something first asks for them.

Most commands need few of the words that ship, and reading all of their phrases was a third of `btc check`.
"""

from __future__ import annotations

import copyreg
from collections.abc import Callable, Collection, Iterator, Mapping
from io import BytesIO

from btlang.support.gc_pause import gc_paused

try:
    from _pickle import Pickler, Unpickler
except ImportError:
    from pickle import Pickler, Unpickler

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_PROTOCOL = 5
_update = dict.update


def _shared(number: int) -> object:
    """Stand in a pickle for what returns a shared object by its number; see `_Reader`."""
    raise NotImplementedError


class _Reader(Unpickler):
    """Reads a child, with the objects that all children share."""

    def __init__(self, file: BytesIO, shared: list[object]) -> None:
        super().__init__(file)
        self._shared = shared

    def find_class(self, module: str, name: str) -> Any:
        if (module, name) == (__name__, _shared.__name__):
            return self._shared.__getitem__
        return super().find_class(module, name)


def packed(tree: Mapping[str, Any], classes: tuple[type, ...]) -> tuple[dict[str, bytes], list[object]]:
    """Return the children of a tree as bytes, and the objects of these classes that they share."""
    shared: list[object] = []
    numbers: dict[int, int] = {}

    def reduced(thing: object) -> tuple[Callable[[int], object], tuple[int]]:
        number = numbers.setdefault(id(thing), len(shared))
        if number == len(shared):
            shared.append(thing)
        return _shared, (number,)

    # by class, where `persistent_id` would be called for each object
    table = {**copyreg.dispatch_table, **dict.fromkeys(classes, reduced)}
    children = {}
    for key, child in tree.items():
        file = BytesIO()
        writer = Pickler(file, _PROTOCOL)
        writer.dispatch_table = table
        writer.dump(dict(child) if isinstance(child, LaterTree) else child)
        children[key] = file.getvalue()
    return children, shared


def unpacked(children: Mapping[str, bytes], shared: list[object], now: Collection[str]) -> dict[str, Any]:
    """Return the tree again. Its children are read later, but those of some keys."""
    tree: dict[str, Any] = {}
    for key, data in children.items():
        tree[key] = _read(data, shared) if key in now else LaterTree(tree, key, data, shared)
    return tree


def _read(data: bytes, shared: list[object]) -> Any:
    with gc_paused:
        return _Reader(BytesIO(data), shared).load()


def _reading(name: str) -> Callable[..., Any]:
    method = getattr(dict, name)

    def read_first(self: LaterTree, *given: Any) -> Any:
        self.read()
        return method(self, *given)

    return read_first


class LaterTree(dict[str, "Any"]):
    """A child of a tree. Once it has been read, a plain dict takes its place there."""

    __slots__ = ("_key", "_tree", "_unread")

    def __init__(self, tree: dict[str, Any], key: str, data: bytes, shared: list[object]) -> None:
        super().__init__()
        self._tree, self._key = tree, key
        self._unread: tuple[bytes, list[object]] | None = (data, shared)

    def read(self) -> None:
        """Read it, unless it has been read."""
        unread = self._unread
        if unread is None:
            return
        found = _read(*unread)
        _update(self, found)
        self._unread = None  # only now: another thread may read it meanwhile
        if self._tree.get(self._key) is self:
            self._tree[self._key] = found
        self._tree = {}

    def __iter__(self) -> Iterator[str]:  # in the class, so that also `{**tree}` asks for it
        self.read()
        return super().__iter__()


for _name in (
    "__contains__", "__eq__", "__getitem__", "__len__", "__ne__", "__or__", "__repr__", "__setitem__", "copy", "get",
    "items", "keys", "pop", "setdefault", "update", "values",
):  # fmt: skip
    setattr(LaterTree, _name, _reading(_name))
