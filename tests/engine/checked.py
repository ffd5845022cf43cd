"""Leaves that check how the engine treats them, on a tree where any call may raise."""

from __future__ import annotations

from collections import Counter
from collections.abc import Generator
from itertools import cycle
from typing import Any

from btlang.engine.leaves.leaf import LeafBinding
from btlang.engine.status import RUNNING, SUCCESS

from .random_trees import Drawn
from .scripted import STATUS, World


class CheckedWorld(World):
    """Binds the leaves of a drawn tree; what the engine does wrong is in `problems`.

    Each call and each halt of a leaf takes the next letter of `trouble`: `x` raises an exception, `i` an interrupt.
    """

    def __init__(self, drawn: Drawn, trouble: str) -> None:
        super().__init__()
        self.trouble = cycle(trouble)
        self.problems: list[str] = []
        self.live: list[tuple[str, object]] = []  # the leaves that run: id, and what stands for the run
        self.halts = 0
        self.successes: Counter[str] = Counter()
        kinds = {"F": self.function, "C": self.leaf, "G": self.generator}
        for id, script in drawn.scripts.items():
            self.bindings[id] = LeafBinding(kinds[id[0]](id, script))
        self.checked = self.engine(drawn.tree, watched=True)
        places = [
            (tuple(map(int, path.split("/")[1:] if path != "/" else ())), node.id) for path, node in self.checked.nodes
        ]
        self.kinds = dict(places)
        uses = Counter(id for _, id in places)  # a leaf of a subtree that is used twice has no place of its own
        self.paths = {id: path for path, id in places if id in drawn.scripts and uses[id] == 1}

    def stumble(self) -> None:
        letter = next(self.trouble)
        if letter == "x":
            raise ValueError("trouble")
        if letter == "i":
            raise KeyboardInterrupt

    def calm(self) -> None:
        """Ends what runs, without trouble: a generator that is left alone would meet it later."""
        self.trouble = cycle(".")
        self.checked.halt()

    def note_successes(self) -> None:
        """A closed generator that is resumed ends at once, which would count as a success."""
        for index, status in self.changes:
            id = self.checked.node(index).id
            if status == SUCCESS and id[0] == "G" and id in self.paths:
                self.successes[id] -= 1
                if self.successes[id] < 0:
                    self.problems.append(f"{id} succeeded without being called")

    def begin(self, id: str, run: object) -> None:
        """To be called first when a leaf starts: nothing may run that a reactive node above should have halted."""
        for other, _ in self.live:
            if id in self.paths and other in self.paths and self.excludes(self.paths[id], self.paths[other]):
                self.problems.append(f"{id} started while {other} ran")
        self.live.append((id, run))

    def end(self, id: str, run: object, how: str) -> None:
        if (id, run) in self.live:
            self.live.remove((id, run))
        else:
            self.problems.append(f"{id} {how}, but it did not run")

    def excludes(self, path: tuple[int, ...], other: tuple[int, ...]) -> bool:
        """Whether the node above both leaves is one that runs at most one of these two children."""
        common = 0
        while path[common] == other[common]:
            common += 1
        kind, its = self.kinds[path[:common]], other[common]
        if kind in ("WhileDoElse", "Whenever"):
            return its > 0  # the condition may run beside the others
        return kind.startswith("Reactive")

    def function(self, id: str, script: str) -> Any:
        letters = cycle(script)

        def call() -> int:
            self.stumble()
            return STATUS[next(letters).replace("x", "f")]

        return call

    def leaf(self, id: str, script: str) -> Any:
        world, letters = self, cycle(script)

        class Leaf:
            def start(self) -> int:
                world.begin(id, self)
                return self.step()

            def tick(self) -> int:
                if (id, self) not in world.live:
                    world.problems.append(f"{id} was ticked without a start")
                return self.step()

            def step(self) -> int:
                world.stumble()
                status = STATUS[next(letters).replace("x", "f")]
                if status != RUNNING:
                    world.end(id, self, "completed")
                return status

            def halt(self) -> None:
                world.halts += 1
                world.end(id, self, "was halted")
                world.stumble()

        return Leaf

    def generator(self, id: str, script: str) -> Any:
        letters = cycle(script)

        def call() -> Generator[None, None, int | None]:
            run = object()
            self.begin(id, run)
            try:
                while True:
                    self.stumble()
                    status = STATUS[next(letters).replace("x", "f")]
                    if status != RUNNING:
                        self.successes[id] += status == SUCCESS
                        return status
                    yield
            except GeneratorExit:
                self.halts += 1
                self.stumble()
                return None
            finally:
                self.end(id, run, "ended")

        return call
