"""Leaves that return what a script says, and a short way to write trees."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import cycle
from typing import Any

from btlang.engine.clock import Clock
from btlang.engine.engine import Engine
from btlang.engine.leaves.leaf import ActionFailed, LeafBinding
from btlang.engine.status import FAILURE, RUNNING, SKIPPED, SUCCESS
from btlang.robots.geometry import Pose
from btlang.tree.node import Node, Tree

STATUS = {"r": RUNNING, "s": SUCCESS, "f": FAILURE, "k": SKIPPED}
LETTER = {status: letter for letter, status in STATUS.items()}


def n(id: str, *children: Node, **ports: object) -> Node:
    """A node."""
    return Node(id, children, tuple((port, str(text)) for port, text in ports.items()))


def said(letter: str) -> int:
    """The status of a letter."""
    if letter == "x":
        raise ValueError("as its script says")
    return STATUS[letter]


class Zones:
    """The zones of a robot. It knows any zone but `nowhere`."""

    def __init__(self) -> None:
        self.held: list[str] = []
        """What holds: `out:lab` for a zone to keep out of, `in:hall:lab` for zones to stay in."""

    def keep_out(self, *names: str) -> Any:
        return Restriction(self.held, names, [f"out:{name}" for name in names])

    def keep_in(self, *names: str) -> Any:
        return Restriction(self.held, names, [":".join(("in", *sorted(names)))])

    @property
    def text(self) -> str:
        """What holds, each once."""
        return " ".join(sorted(set(self.held)))


class Restriction:
    """What `keep_out` and `keep_in` of a robot return."""

    def __init__(self, held: list[str], names: Sequence[str], entries: list[str]) -> None:
        self._held, self._names, self._entries = held, names, entries

    def begin(self) -> None:
        if "nowhere" in self._names:
            raise ActionFailed("there's no zone called 'nowhere'")
        self._held.extend(self._entries)

    def end(self) -> None:
        for entry in self._entries:
            self._held.remove(entry)


class Base:
    """The base of a robot that stands."""

    pose = Pose(0.0, 0.0, 0.0)
    velocity = 0.0, 0.0


class Zoned:
    """A robot that has zones and a base, and nothing else."""

    def __init__(self) -> None:
        self.zones = Zones()
        self.base = Base()


class World:
    """Binds leaf ids to scripts and logs what the engine does with them.

    `fn(id, "rsf")` is a function that returns RUNNING, SUCCESS, FAILURE and so on in turn, over and over.
    `cls(id, ...)` is a class whose start and tick do.
    The letter `x` raises an exception.
    `gen(id, ...)` is a generator, each run of which ends at the next letter that is not `r`.
    The log has `id` for a function's call and `id.start`, `id.tick`, `id.halt` for the others.
    """

    def __init__(self) -> None:
        self.log: list[str] = []
        self.bindings: dict[str, LeafBinding] = {}
        self.clock = Clock()
        self.robot = Zoned()
        self.changes: list[tuple[int, int]] = []

    def bind(self, id: str, call: Callable[..., Any], **options: Any) -> Node:
        self.bindings[id] = LeafBinding(call, **options)
        return Node(id)

    def fn(self, id: str, script: str) -> Node:
        statuses = cycle(script)

        def call() -> int:
            self.log.append(id)
            return said(next(statuses))

        return self.bind(id, call)

    def cls(self, id: str, script: str) -> Node:
        statuses, log = cycle(script), self.log

        class Leaf:
            def start(self) -> int:
                log.append(f"{id}.start")
                return said(next(statuses))

            def tick(self) -> int:
                log.append(f"{id}.tick")
                return said(next(statuses))

            def halt(self) -> None:
                log.append(f"{id}.halt")

        return self.bind(id, Leaf)

    def gen(self, id: str, script: str) -> Node:
        statuses = cycle(script)

        def call() -> Any:
            step = "start"
            try:
                while True:
                    self.log.append(f"{id}.{step}")
                    status = said(next(statuses))
                    if status != RUNNING:
                        return status
                    step = "tick"
                    yield
            except GeneratorExit:
                self.log.append(f"{id}.halt")

        return self.bind(id, call)

    def engine(self, root: Node | Tree, watched: bool = False, **options: Any) -> Engine:
        listener = (lambda told: self.changes.extend(change[:2] for change in told)) if watched else None
        tree = root if isinstance(root, Tree) else Tree(root)
        services = {"robot": self.robot, **options.pop("services", {})}
        return Engine(tree, self.bindings.get, clock=self.clock, listener=listener, services=services, **options)

    def since(self) -> list[str]:
        """The log since the last call."""
        log, self.log[:] = list(self.log), []
        return log

    def ticks(self, engine: Engine, times: int) -> str:
        """The letters of so many ticks."""
        return "".join(LETTER[engine.tick()] for _ in range(times))


def results(build: Callable[[World], Node], ticks: int) -> tuple[str, list[str]]:
    """Letters of a number of ticks, and the log."""
    world = World()
    engine = world.engine(build(world))
    return world.ticks(engine, ticks), world.log


def leaves(world: World, scripts: Sequence[str]) -> list[Node]:
    """Function leaves A, B, C ... with these scripts; in capitals, class leaves."""
    names = "ABCDEFGH"
    return [
        world.cls(name, script.lower()) if script.isupper() else world.fn(name, script)
        for name, script in zip(names, scripts, strict=False)
    ]


class Broken:
    """A class leaf that raises in one of its methods, and logs their names."""

    def __init__(self, where: str, problem: BaseException, log: list[str]) -> None:
        self.where, self.problem, self.log = where, problem, log

    def _at(self, method: str) -> None:
        self.log.append(method)
        if self.where == method:
            raise self.problem

    def start(self) -> None:
        self._at("start")

    def tick(self) -> None:
        self._at("tick")

    def halt(self) -> None:
        self._at("halt")


def broken(world: World, id: str, where: str, problem: BaseException) -> Node:
    """A class leaf that raises in that method and else runs for ever."""

    class Leaf(Broken):
        def __init__(self) -> None:
            super().__init__(where, problem, world.log)

    return world.bind(id, Leaf)
