"""Regions: parts of a tree that one generated Python function ticks, in place of a closure for each node.

A region has one list, `S`: the state of the engine, then the functions and leaves that it calls, and what its nodes
remember, each in a slot. What a node does is written in nodes/templates.py, once for each kind of node; here the
texts of all nodes of a region become one function. Regions of the same shape share its code. The text of a tree never
becomes code: what is generated holds the words of the templates and the numbers of slots, nothing else.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import groupby
from types import CodeType, FunctionType

from btlang.engine.changes import REACHED
from btlang.engine.instance import EngineState, NodeInstance
from btlang.engine.leaves.callables import ClassLeaf, FunctionLeaf, GeneratorLeaf, find_function
from btlang.engine.row_trace import RowTrace
from btlang.engine.slot_memory import SlotMemory
from btlang.engine.status import SUCCESS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    from btlang.engine.instance import Compiled, Halt
    from btlang.engine.status_trace import NodeTrace, StatusTrace

    Slots: TypeAlias = list[Any]
    Layout: TypeAlias = tuple[Callable[[Slots, int, Any, bool], None], int, Any]
    Emit: TypeAlias = Callable[["Region", "Fragment", int, int], Layout]

DEEPEST = 8
"""Levels of nodes in a region. Each takes a loop, and Python nests 20 of these at most."""
LARGEST = 60
"""Children in a region. Long functions are compiled slowly, and a step of generation is one of them."""
WIDE = 16
"""Leaves in a row from which on a loop calls them: each function by itself would be faster, and is more code."""
LONG_WAY = 3
"""Levels of a resume path from which on it is a shortcut: those of a region are gone through nearly as fast."""
_MOST_SHAPES = 500


class Fragment:
    """A node that is to be a part of a region, with the nodes below it that are to be in the same one."""

    __slots__ = ("emit", "height", "instance", "items", "size", "trace")

    def __init__(self, instance: NodeInstance, emit: Emit, items: list[Item]) -> None:
        self.instance = instance
        self.emit = emit
        self.items = items
        self.trace: NodeTrace | None = None
        below = [item.child for item in items if isinstance(item.child, Fragment)]
        self.height: int = 1 + max([each.height for each in below], default=0)
        self.size = sum([1 if item.is_wide else item.end - item.first for item in items])
        self.size += sum([each.size for each in below])

    @property
    def count(self) -> int:
        """The number of its children."""
        return self.items[-1].end

    @property
    def singles(self) -> list[Item]:
        """Its children as items of one each, for a node that doesn't tick them in a row."""
        found = []
        for item in self.items:
            children = [[leaf] for leaf in item.child] if isinstance(item.child, list) else [item.child]
            found += [Item(item.first + number, child) for number, child in enumerate(children)]
        return found


class Item:
    """A child of a fragment, or several functions in a row. `first` is the position of the first, `end` that behind."""

    __slots__ = ("child", "end", "first")

    def __init__(self, first: int, child: Fragment | Resumed | Compiled | list[FunctionLeaf]) -> None:
        self.first = first
        self.end = first + (len(child) if isinstance(child, list) else 1)
        self.child = child

    @property
    def is_wide(self) -> bool:
        """Whether they are functions that a loop calls."""
        return self.end - self.first >= WIDE


def find_size(functions: Sequence[bool]) -> int:
    """Return how many children a node counts for, which of them are functions."""
    size = 0
    for are_functions, row in groupby(functions):
        count = sum(1 for _ in row)
        size += 1 if are_functions and count >= WIDE else count
    return size


class Resumed:
    """A leaf that is a generator or an object, with what halts it, which may be traced."""

    __slots__ = ("halt", "leaf")

    def __init__(self, leaf: ClassLeaf | GeneratorLeaf, halt: Halt) -> None:
        self.leaf = leaf
        self.halt = halt


def find_items(children: list[Fragment | Compiled]) -> list[Item]:
    """Return the children of a node as the items of its fragment."""
    items: list[Item] = []
    for position, child in enumerate(children):
        if isinstance(child, Fragment):
            items.append(Item(position, child))
            continue
        function, leaf = find_function(child[0]), getattr(child[0], "__self__", None)
        if function is None:
            items.append(
                Item(position, Resumed(leaf, child[1]) if leaf.__class__ in (ClassLeaf, GeneratorLeaf) else child)
            )
        elif items and isinstance(items[-1].child, list):
            items[-1].child.append(function)
            items[-1].end += 1
        else:
            items.append(Item(position, [function]))
    return items


def group_lasting(items: list[Item]) -> Iterator[list[Item]]:
    """Yield items one by one, but many leaves of one class that take time together: a loop can resume them."""
    for kind, group in groupby(items, lambda item: isinstance(item.child, Resumed) and item.child.leaf.__class__):
        found = list(group)
        if kind and len(found) >= WIDE:
            yield found
        else:
            yield from ([item] for item in found)


class Region:
    """The text and the slots of a region while they are written."""

    def __init__(self, state: EngineState, trace: StatusTrace | None) -> None:
        self.values: Slots = [state]
        self.trace = trace
        self.layouts: list[Layout] = []
        self.memories: list[tuple[NodeInstance, SlotMemory]] = []
        self._lines: list[str] = []

    def add(self, depth: int, *lines: str) -> None:
        """Write lines."""
        self._lines += [" " * depth + line for line in lines]

    def slot(self, value: object) -> int:
        """Return the number of a new slot."""
        self.values.append(value)
        return len(self.values) - 1

    def remember(self, instance: NodeInstance, **initial: object) -> int:
        """Make slots for what a node remembers, one behind the other, and return the first one's number. Names are
        those that its closure has for the same: what one of them has saved, the other one restores.
        """
        if not initial:
            self.memories.append((instance, _NO_MEMORY))
            return 0
        first = len(self.values)
        self.values += initial.values()
        self.memories.append((instance, SlotMemory(self.values, first, tuple(initial))))
        return first

    def layout(self, layout: Layout) -> int:
        """Return the number of a layout, by which the text names it."""
        self.layouts.append(layout)
        return len(self.layouts) - 1

    def child(self, item: Item, depth: int, level: int, before: Sequence[str] = (), running: str = "r = 2") -> Layout:
        """Write what ticks a child and leaves its status in `r`; return its layout. `before` are lines that are needed
        before it starts, `running` is what to do at once if it goes on, as a generator or an object.
        """
        child = item.child
        if isinstance(child, Resumed):
            at = self.slot(child.leaf)
            self.slot(child.halt)
            self.add(
                depth,
                f"send = S[{at}].send",
                f"if send is None: {'; '.join([*before, f'r = S[{at}].tick()'])}",
                "else:",
                " try:",
                f"  if (r := send({'None' if child.leaf.__class__ is GeneratorLeaf else ''})) is None: {running}",
                f"  else: r = S[{at}].yielded(r)",
                f" except: r = S[{at}].ended(caught())",
            )
            return _halt_pair, at + 1, None
        self.add(depth, *before)
        if isinstance(child, Fragment):
            return self.node(child, depth, level)
        if isinstance(child, list):
            return self._function(child[0], depth)
        tick, halt = child
        at = self.slot(tick)
        self.slot(halt)
        self.add(depth, f"r = S[{at}]()")
        return _halt_pair, at + 1, None

    def node(self, node: Fragment, depth: int, level: int) -> Layout:
        """Write what ticks a node, and traces its status; return its layout. The root counts the ticks."""
        if node.trace is not None and not node.trace.index:
            self.add(depth, f"S[{self.slot(node.trace.trace.begin_tick)}]()")
        layout = node.emit(self, node, depth, level)
        trace = node.trace
        if trace is None:
            return layout
        at = self.slot(trace.place)
        self.slot(trace)
        note = f"S[{at + 1}].complete(r)"
        same = f"if W[S[{at}]] == r: W[S[{at}]] = r | {REACHED}"
        self.add(depth, *([note] if trace.every else [same, f"else: {note}"]))
        return _halt_traced, at + 1, layout

    def _function(self, leaf: FunctionLeaf, depth: int) -> Layout:
        at = self.slot(leaf.call)
        self.slot(leaf.instance)
        self.add(
            depth,
            f"try: r = S[{at}]()",
            "except: r = caught()",
            f"if r is False: S[0].fault = S[{at + 1}]",
            f"elif r is not True: r = find_status(S[{at + 1}], r)",
        )
        if self.trace is None:
            return _NOTHING
        row = self.slot(self.trace_row([leaf], SUCCESS))
        self.add(depth, f"S[{row}].answered(0, r)")
        return halt_row, row, None

    def trace_row(self, row: list[FunctionLeaf], passes: int) -> RowTrace | None:
        """Return the trace of functions in a row."""
        if self.trace is None:
            return None
        return RowTrace(self.trace, [leaf.instance for leaf in row], passes)

    @property
    def next_line(self) -> int:
        """The number of the line that is written next."""
        return len(self._lines) + 2

    @property
    def text(self) -> str:
        """The whole function."""
        return "\n".join(["def tick(S, L, W):", *self._lines, " return r"])


_shapes: dict[str, tuple[CodeType, tuple[Layout, ...], Layout]] = {}


def make_region(
    fragment: Fragment, names: dict[str, Any], trace: StatusTrace | None
) -> tuple[Compiled, list[tuple[NodeInstance, SlotMemory]], bool]:
    """Generate a region. Returns what ticks and halts it, what its nodes remember, and whether its shape is new.
    `names` are all that the code knows.
    """
    region = Region(fragment.instance.state, trace)
    top = region.node(fragment, 1, 0)
    text = region.text
    known = _shapes.get(text)
    shape = known or (_compile(text), tuple(region.layouts), top)
    if known is None:
        if len(_shapes) >= _MOST_SHAPES:
            _shapes.clear()
        _shapes[text] = shape
    code, layouts, top = shape
    slots = region.values
    tick = FunctionType(code, names, None, (slots, layouts, None if trace is None else trace.now))

    def halt(keep: bool) -> None:  # no partial: a deep tree would need much of the stack of C
        halt_part(slots, top, keep)

    return (tick, halt), region.memories, known is None


def _compile(text: str) -> CodeType:
    [code] = [each for each in compile(text, "<tree>", "exec").co_consts if isinstance(each, CodeType)]
    return code


def halt_part(slots: Slots, layout: Layout, keep: bool) -> None:
    """Halt a node of a region, or suspend it."""
    halt, at, children = layout
    halt(slots, at, children, keep)


def _halt_traced(slots: Slots, at: int, node: Layout, keep: bool) -> None:
    halt_part(slots, node, keep)
    slots[at].halted()


def halt_row(slots: Slots, at: int, children: object, keep: bool) -> None:
    """Record that functions in a row were halted, if somebody listens: they know nothing of it."""
    if slots[at] is not None:
        slots[at].all_halted()


def _halt_pair(slots: Slots, at: int, children: object, keep: bool) -> None:
    slots[at](keep)


def _halt_nothing(slots: Slots, at: int, children: object, keep: bool) -> None:
    pass


_NO_MEMORY = SlotMemory([], 0, ())
_NOTHING: Layout = (_halt_nothing, 0, None)
