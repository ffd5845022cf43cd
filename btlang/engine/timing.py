"""How long leaves take. Compiled in only where somebody wants to know."""

from __future__ import annotations

from time import perf_counter

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.instance import Compiled


class Stopwatch:
    """Adds up the real seconds that each leaf spends in its ticks and halts, by index in preorder."""

    def __init__(self) -> None:
        self.spent: dict[int, float] = {}

    def wrap(self, index: int, compiled: Compiled) -> Compiled:
        """The same leaf, timed."""
        tick, halt = compiled
        spent = self.spent

        def timed_tick() -> int:
            began = perf_counter()
            try:
                return tick()
            finally:
                spent[index] = spent.get(index, 0.0) + perf_counter() - began

        def timed_halt(keep: bool) -> None:
            began = perf_counter()
            try:
                halt(keep)
            finally:
                spent[index] = spent.get(index, 0.0) + perf_counter() - began

        return timed_tick, timed_halt

    def slowest(self) -> tuple[int, float] | None:
        """Index and seconds of the leaf that took longest since `spent` was cleared, None where none was reached."""
        return max(self.spent.items(), key=lambda item: item[1], default=None)
