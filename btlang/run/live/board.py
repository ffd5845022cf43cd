"""From events to a frame: keeps the state of the run and the lines of what happened, and words both."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Sequence

from btlang.engine.compile import outline
from btlang.run.events import PeriodPassed
from btlang.run.live import frame
from btlang.run.live.selection import LEAST_HEIGHT
from btlang.run.logs import PlainLines
from btlang.run.snapshot import RunState, Shape
from btlang.text.formatting import one_line

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Protocol

    from btlang.run.events import Event
    from btlang.run.live.frame import Line
    from btlang.run.robot_state import RobotState
    from btlang.tree.node import Node, Tree

    class Map(Protocol):
        """A map of a world in the cells of a terminal; see btlang.pictures.terminal_map.TerminalMap."""

        def note(self, robot: RobotState | None) -> None: ...

        def size(self, width: int, height: int) -> tuple[int, int]: ...

        def lines(self, robot: RobotState | None, width: int, height: int) -> list[frame.Line]: ...

    class Viewed(Protocol):
        """The part of a mission that the live view needs."""

        @property
        def tree(self) -> Tree: ...

        def label(self, node: Node) -> str: ...

        def is_action(self, node: Node) -> bool: ...


_BESIDE = 90  # columns from which on the map stands beside the tree, not below it
_MAP_PART, _APART = 45, 2  # percent of the columns for it there, and columns between both
_MOST_WAITING = 50_000  # events; a terminal may be slower than the run, or be held by its user


class Board:
    """The state of a run and the lines about it, for the live view.

    `note` may be called from any thread and takes no time; all else is for one thread, that which draws.

    `changes` grows with each event. Raises EngineError for a tree that cannot be compiled.
    """

    def __init__(self, mission: Viewed, signs: frame.Signs) -> None:
        nodes, parents = outline(mission.tree)
        span = mission.tree.root.span
        self.changes = 0
        self.state = RunState(Shape(parents), nodes)
        self._title = one_line(os.path.basename(span.source.name)) if span is not None else "mission"
        self.signs = signs
        self._words = frame.ViewWords(nodes, mission.label)
        self._above: list[str] = []
        self._lines: Callable[[Event], None] = PlainLines(mission.label, mission.is_action, self._above.append)
        self._waiting: deque[Event | str | RunState] = deque(maxlen=_MOST_WAITING)
        self._noted = self._taken = self._lost = 0  # events
        self._period: PeriodPassed | None = None
        self._begun = False
        self.map: Map | None = None
        self.hides_map = False

    def note(self, event: Event | str) -> None:
        """Keep an event, or a line that was printed."""
        if isinstance(event, PeriodPassed):
            self._period, self._begun = event, True
        else:
            self._waiting.append(event)
            self._noted += 1
        self.changes += 1

    def jump(self, state: RunState) -> None:
        """Go on from another state; what has been noted before is still written."""
        self._waiting.append(state)
        self._noted += 1
        self._begun = True
        self.changes += 1

    def take(self) -> list[str]:
        """Bring the state up to date; return the lines of what happened since the last time."""
        noted = self._noted  # before the count, so that an event that comes just now is not taken for lost
        count = len(self._waiting)
        lost = noted - self._taken - self._lost - count
        for _ in range(count):
            self._take(self._waiting.popleft())
        self._taken += count
        if self._period is not None:
            self.state.take(self._period)
        if self.map is not None:
            self.map.note(self.state.robot)
        if lost > 0:
            self._lost += lost
            self._above.append(f"         ({lost} events came too fast for this terminal)")
        lines = self._above[:]
        self._above.clear()
        return lines

    def frame(
        self, width: int, height: int, doing: str, keys: Sequence[tuple[str, str]], explained: bool = False
    ) -> list[frame.Line]:
        """Return at most `height` lines (7 or more) while the run goes on.

        `doing` says what it does, "" that it has ended.

        `keys` are what frame.keys_line says; `explained` adds what the signs mean, as far as there is room. A run that
        ended before it began leaves nothing to show.
        """
        state, signs, over = self.state, self.signs, not doing
        below = [frame.robot_line(state, signs), frame.counts_line(state, signs)]
        if over and not self._begun:
            return []
        if over:
            return [*self._shown(width, height - len(below), over), *below]
        below.append(frame.keys_line(doing == "paused", keys, signs))
        if explained:
            below = [*frame.legend_lines(width, signs)[: height - LEAST_HEIGHT - 4], *below]
        shown = self._shown(width, height - 1 - len(below), over)
        return [frame.header(self._title, state, doing, signs), *shown, *below]

    def _shown(self, width: int, rows: int, over: bool) -> list[Line]:
        """Return the tree and the map, which stays as it was at the end of the run."""
        return (self._beside if width >= _BESIDE else self._above_each_other)(width, rows, over)

    def _beside(self, width: int, rows: int, over: bool) -> list[Line]:
        """Return the tree, and the map to the right of it."""
        columns, lines = self._map_size(width * _MAP_PART // 100, rows)
        left = width - columns - _APART if columns else width
        return frame.side_by_side(self._tree(left, rows, over), self._map(columns, lines), left + _APART)

    def _above_each_other(self, width: int, rows: int, over: bool) -> list[Line]:
        """Return the tree, and the map in the rows that it leaves, or in half of them."""
        tree = self._tree(width, rows, over)
        columns, lines = self._map_size(width, max(rows // 2, rows - len(tree)))
        if len(tree) > rows - lines:
            tree = self._tree(width, rows - lines, over)
        return [*tree, *self._map(columns, lines)]

    def _tree(self, width: int, rows: int, over: bool) -> list[Line]:
        return frame.tree_lines(self.state, self._words, rows, width, over, self.signs)

    def _map(self, columns: int, lines: int) -> list[Line]:
        return self.map.lines(self.state.robot, columns, lines) if self.map is not None and columns else []

    def _map_size(self, width: int, height: int) -> tuple[int, int]:
        return self.map.size(width, height) if self.map is not None and not self.hides_map else (0, 0)

    def _take(self, event: Event | str | RunState) -> None:
        if isinstance(event, str):
            self._above.append(event)
            return
        if isinstance(event, RunState):
            self._above.append(f"         ({event.now:.1f} s)")
            self.state, self._period = event, None
            return
        self.state.take(event)
        self._lines(event)
