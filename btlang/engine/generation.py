"""When and how an engine exchanges the closures of its nodes for generated regions, which tick several times faster.

To generate and compile a region takes as long as some hundred ticks of it. So this begins when a tree has been ticked
`TICKS_BEFORE` times, and goes on a little at each tick; the closures tick the tree until all is ready. What nodes
remember is then moved, and leaves stay the objects that they are: nothing can be seen of the exchange.

Nodes without a template (nodes/templates.py), and those with scripts as conditions or ports from the blackboard, stay
closures between regions. A tree with hooks stays as it is.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from btlang.engine.compile import compile_node, reads_keys, waits
from btlang.engine.conditions import add_conditions, has_conditions
from btlang.engine.fused import has_usual_thresholds
from btlang.engine.instance import NodeInstance, halt_nothing
from btlang.engine.leaves.callables import find_function
from btlang.engine.resume_path import find_resume_paths, mark_resumable, resume_at_top
from btlang.engine.saving import move_memory
from btlang.engine.status_trace import NodeTrace, StatusTrace
from btlang.support.gc_pause import gc_paused
from btlang.tree.catalogue import SUBTREE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.instance import Compiled, Memory
    from btlang.engine.regions import Fragment

TICKS_BEFORE = 100
"""Ticks after which a tree is generated. 0: before the first one."""
MOST_NODES = 20_000
"""Nodes of the largest tree that is generated: the exchange takes a tick of some microseconds a node."""
NODES_A_TICK = 300
"""Nodes that are looked at in one tick, unless a region is to be compiled, which takes some milliseconds."""


def generate_later(
    instances: Sequence[NodeInstance],
    trace: StatusTrace | None,
    compiled: Compiled,
    exchange: Callable[[Compiled], None],
) -> None:
    """Count the ticks of a tree, and have what ticks and halts it exchanged when there have been enough."""
    if len(instances) > MOST_NODES:
        return
    tick, halt = compiled
    left = TICKS_BEFORE
    steps = generate(instances, trace)
    made: Generated | None = None

    def step() -> bool:
        """Go on with the regions; return whether they tick the tree from now on."""
        nonlocal made
        try:
            with gc_paused:
                made = next(steps)
            if made is not None:
                exchange(made.compiled)
                made.take_over()
        except BaseException:  # KeyboardInterrupt, in any line: all of it is done, or nothing
            exchange(compiled if made is None else made.compiled)
            if made is not None:
                made.take_over()
            raise
        return made is not None

    def counted_tick() -> int:
        nonlocal left
        left -= 1
        return made.compiled[0]() if left < 0 and step() and made is not None else tick()

    if left:
        exchange((counted_tick, halt))
        return
    while not step():
        pass


class Generated:
    """What ticks and halts a tree by its regions, and what their nodes will remember from then on."""

    __slots__ = ("_instances", "_memories", "compiled")

    def __init__(
        self,
        compiled: Compiled,
        instances: Sequence[NodeInstance],
        memories: list[tuple[NodeInstance, tuple[Memory, ...]]],
    ) -> None:
        self.compiled = compiled
        self._instances = instances
        self._memories = memories
        for instance, memory in memories:
            move_memory(instance.memory, memory)

    def take_over(self) -> None:
        """Let what the nodes remember be found in the regions."""
        for instance, memory in self._memories:
            instance.memory = memory
        for instance in self._instances:
            instance.leaf = None  # which the regions have


def generate(instances: Sequence[NodeInstance], trace: StatusTrace | None) -> Iterator[Generated | None]:
    """Generate all nodes of a tree. Yields None after each step, and at last the whole."""
    generation = _Generation(trace)
    waiting: list[Fragment | Compiled] = []  # as in compile_instances, which this follows
    around = find_resume_paths(instances, waits)
    for looked, instance in enumerate(reversed(instances), 1):
        count = 1 if instance.node.id == SUBTREE else len(instance.node.children)
        made: Fragment | Compiled
        node_trace = instance.state.node_trace = None if trace is None else NodeTrace(instance, trace)
        if count:
            made = generation.combine(instance, waiting[: -count - 1 : -1])
            del waiting[-count:]
        else:
            made = instance.leaf or compile_node(instance, ())
        path, above = around[instance.index], instance.above
        if path is not None and path.used and path.top == instance.index:
            made = resume_at_top(path, generation.close(made))
        if count and node_trace is not None:
            made = generation.traced(node_trace, made)
        if above is None or not generation.takes_parts(above):
            made = generation.close(made)
        if path is None and above is not None and not (isinstance(made, tuple) and made[1] is halt_nothing):
            wider = around[above.index]
            if wider is not None and generation.is_shortcut(above, wider.top):
                made = mark_resumable(wider, generation.close(made))
        waiting.append(made)
        if generation.has_compiled or not looked % NODES_A_TICK:
            generation.has_compiled = False
            yield None
    [compiled] = waiting
    assert isinstance(compiled, tuple)
    yield Generated(compiled, instances, generation.memories)


class _Generation:
    """The regions that are being generated, and what their nodes will remember."""

    def __init__(self, trace: StatusTrace | None) -> None:
        from btlang.engine import regions  # which few short runs need
        from btlang.engine.nodes import templates

        self._regions = regions
        self._templates = templates.TEMPLATES
        self._names = templates.NAMES
        self._trace = trace
        self.memories: list[tuple[NodeInstance, tuple[Memory, ...]]] = []
        self.has_compiled = False
        self._takes_parts: dict[int, bool] = {}

    def takes_parts(self, instance: NodeInstance) -> bool:
        """Return whether a node can be in a region with its children. Its closure ticks very many just as fast."""
        found = self._takes_parts.get(instance.index)
        if found is None:
            node, signatures = instance.node, instance.state.signatures
            functions = [
                not child.children and child.id in signatures and signatures[child.id].kind == "function"
                for child in node.children
            ]
            found = node.id in self._templates and not reads_keys(node) and has_usual_thresholds(node)
            found = found and self._regions.find_size(functions) <= self._regions.LARGEST
            self._takes_parts[instance.index] = found
        return found

    def is_shortcut(self, instance: NodeInstance, top: int) -> bool:
        """Return whether a resume path that begins at the node with a number is long above this one."""
        levels = 0
        while instance.index != top and instance.above is not None and levels < self._regions.LONG_WAY:
            instance = instance.above
            levels += 1
        return levels == self._regions.LONG_WAY

    def combine(self, instance: NodeInstance, children: Sequence[Fragment | Compiled]) -> Fragment | Compiled:
        """Make a node of its children: a part of a region if it has a template, else a closure."""
        node = instance.node
        is_asked = has_conditions(node)
        if node.id == SUBTREE:
            [made] = children
            if (trace := instance.state.node_trace) is None:
                pass
            elif isinstance(made, tuple):
                [made] = trace.wrap_functions([made], keeps=False)
            else:  # both have a trace
                made = self._part(instance, children) or self.close(made)
        elif self.takes_parts(instance) and (part := self._part(instance, children)) is not None:
            made = part
        else:
            return self._remembering(instance, (), lambda: compile_node(instance, [*map(self.close, children)]))
        if not is_asked:
            return made
        memory: tuple[Memory, ...] = ()
        compiled = self.close(made)
        if node.id != SUBTREE:
            _, memory = self.memories.pop()  # that of the highest node comes last
        return self._remembering(instance, memory, lambda: add_conditions(instance, compiled))

    def traced(self, trace: NodeTrace, made: Fragment | Compiled) -> Fragment | Compiled:
        """Trace a node with children: within its region, or around what ticks it."""
        if isinstance(made, tuple):
            return trace.wrap(made)
        made.trace = trace
        return made

    def _part(self, instance: NodeInstance, children: Sequence[Fragment | Compiled]) -> Fragment | None:
        """Make a part of a region, None if there is too much in it. Children that would make the region too deep or too
        large begin a region themselves.
        """
        regions, trace = self._regions, instance.state.node_trace
        functions = []
        single: list[Fragment | Compiled] = []
        for child in children:
            if (
                isinstance(child, tuple) and trace is not None
            ):  # a function that tells more than its status is in no row
                [child] = trace.wrap_functions([child], keeps=True)
            single.append(child)
            functions.append(isinstance(child, tuple) and find_function(child[0]) is not None)
        left = regions.LARGEST - regions.find_size(functions)
        if left < 0:
            return None
        for position, child in enumerate(single):
            if not isinstance(child, tuple):
                if child.size > left or child.height == regions.DEEPEST:
                    single[position] = self.close(child)
                else:
                    left -= child.size
        items = regions.find_items(single)
        return self._regions.Fragment(instance, self._templates[instance.node.id], items)

    def close(self, made: Fragment | Compiled) -> Compiled:
        """Let a region begin with this node."""
        if isinstance(made, tuple):
            return made
        compiled, memories, is_new = self._regions.make_region(made, self._names, self._trace)
        self.memories += [(instance, (memory,)) for instance, memory in reversed(memories)]
        self.has_compiled = self.has_compiled or is_new
        return compiled

    def _remembering(
        self, instance: NodeInstance, memory: tuple[Memory, ...], compile: Callable[[], Compiled]
    ) -> Compiled:
        """Compile a node that is still being ticked as it was: note what it will remember apart from that."""
        before, instance.memory = instance.memory, memory
        try:
            compiled = compile()
            self.memories.append((instance, instance.memory))
        finally:
            instance.memory = before
        return compiled
