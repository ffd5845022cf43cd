"""The world from above in the cells of a terminal: walls, zones, places, people, the robot and the way that it came.

Each cell has two by four dots of Braille, or one character where the terminal has no others.
"""

from __future__ import annotations

from itertools import groupby, pairwise
from math import ceil, hypot
from operator import itemgetter

from rich.cells import cell_len

from btlang.robots.geometry import Point
from btlang.robots.worlds.world import World
from btlang.run.robot_state import RobotState
from btlang.text.formatting import one_line

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence

    from rich.text import Text

    from btlang.run.live.frame import Line

_ACROSS, _DOWN = 2, 4  # dots of a cell
_BRAILLE = 0x2800
_BITS = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))  # by row and column
_ARROWS, _PLAIN_ARROWS = "→↗↑↖←↙↓↘", ">/^\\</v\\"
_ROUND = 0.3  # metres around everything
_STEP = 0.05  # metres between points of the way that are kept
_ROBOT, _PERSON, _PLACE, _THING, _WALL, _WAY = "bold cyan", "bold magenta", "bold", "yellow", "dim", "green"
_CLOSED, _SLOW = "red", "yellow"
_DASH = 3  # dots of an outline, and of the gap after them
_SIGNS = {_WALL: "#", _WAY: ".", _CLOSED: "x", _SLOW: "~"}
LEAST_WIDTH, LEAST_HEIGHT = 16, 5
"""The cells in which a map is of use."""


class TerminalMap:
    """A map of one world for a terminal. `note` takes where the robot is at each time."""

    def __init__(self, world: World, unicode: bool) -> None:
        self._world, self._unicode = world, unicode
        self._zones = [zone for zone in world.zones if zone.is_closed or zone.is_slow]
        self._lines = [*world.walls, *(((a, b), (c, d)) for box in world.boxes for a, b, c, d in box.edges())]
        points = [point for line in self._lines for point in line]
        points += [(world.start.x, world.start.y), *((place.x, place.y) for place in world.places)]
        points += [(thing.x, thing.y) for thing in (*world.objects, *world.people)]
        xs, ys = [x for x, _ in points], [y for _, y in points]
        self._left, self._top = min(xs) - _ROUND, max(ys) + _ROUND
        self._width, self._height = max(xs) + _ROUND - self._left, self._top - min(ys) + _ROUND
        self._way: list[Point] = []
        self._dots: _Dots | None = None  # of the walls and the way, of the latest size
        self._drawn = 0  # points of the way

    def note(self, robot: RobotState | None) -> None:
        """Keep the way that the robot comes."""
        if robot is None or robot.pose is None:
            return
        here = robot.pose.x, robot.pose.y
        if not self._way or hypot(here[0] - self._way[-1][0], here[1] - self._way[-1][1]) > _STEP:
            self._way.append(here)

    def size(self, width: int, height: int) -> tuple[int, int]:
        """Return the columns and rows that it takes of those that there are; (0, 0) where these are too few."""
        if width < LEAST_WIDTH or height < LEAST_HEIGHT:
            return 0, 0
        dots = self._scale(width, height)
        return min(ceil(self._width * dots / _ACROSS), width), min(ceil(self._height * dots / _DOWN), height)

    def lines(self, robot: RobotState | None, width: int, height: int) -> list[Line]:
        """Return the map in so many cells, which `size` has given."""
        scale = self._scale(width, height)

        def at(x: float, y: float) -> tuple[float, float]:
            return (x - self._left) * scale, (self._top - y) * scale

        dots = self._dots
        if dots is None or dots.size != (width, height):
            dots = self._dots = _Dots(width, height)
            self._drawn = 0
            for zone in self._zones:
                outline = [at(*point) for point in (*zone.points, zone.points[0])]
                dots.line(outline, _CLOSED if zone.is_closed else _SLOW, _DASH)
            for line in self._lines:
                dots.line([at(*point) for point in line], _WALL)
        for point in self._way[self._drawn :]:
            dots.dot(*at(*point), _WAY)
        self._drawn = len(self._way)
        letters = _Letters(width, height)
        moved = {name: (x, y) for name, x, y, _ in (robot.things if robot is not None else ())}
        for place in self._world.places:
            letters.name(*at(place.x, place.y), place.name, _PLACE)
        for zone in self._zones:
            middle = (sum(values) / len(values) for values in zip(*zone.points, strict=True))
            letters.name(*at(*middle), zone.name, _CLOSED if zone.is_closed else _SLOW)
        things = [(each, _THING) for each in self._world.objects]
        for thing, style in (*things, *((each, _PERSON) for each in self._world.people)):
            x, y = moved.get(thing.name, (thing.x, thing.y))
            if x is not None and y is not None:
                letters.name(*at(x, y), thing.name, style)
        if robot is not None and robot.pose is not None:
            turn = round(robot.pose.heading / 45.0) % len(_ARROWS)
            sign = (_ARROWS if self._unicode else _PLAIN_ARROWS)[turn]
            letters.mark(*at(robot.pose.x, robot.pose.y), sign, _ROBOT)
        return [self._line(dots, letters, row) for row in range(height)]

    def text(self, robot: RobotState | None, width: int, height: int) -> Text | None:
        """Return the map as a text of at most so many cells, None where these are too few."""
        from rich.text import Text

        columns, rows = self.size(width, height)
        drawn = [Text.assemble(*line) for line in self.lines(robot, columns, rows)] if columns else []
        return Text("\n").join(drawn) if drawn else None

    def _scale(self, width: int, height: int) -> float:
        """Return the dots a metre."""
        return min(width * _ACROSS / self._width, height * _DOWN / self._height)

    def _line(self, dots: _Dots, letters: _Letters, row: int) -> Line:
        """Return a row, its neighbours of one style together."""
        cells = (letters.cells.get((row, column)) or self._cell(dots, row, column) for column in range(dots.size[0]))
        groups = groupby(cells, key=itemgetter(1))
        return tuple(("".join(text for text, _ in group), style) for style, group in groups)

    def _cell(self, dots: _Dots, row: int, column: int) -> tuple[str, str]:
        found, style = dots.cells[row][column], dots.styles.get((row, column), "")
        if not found:
            return " ", ""
        return chr(_BRAILLE + found) if self._unicode else _SIGNS[style], style


class _Dots:
    """The cells with dots, each in the style of its latest one."""

    def __init__(self, width: int, height: int) -> None:
        self.size = width, height
        self.cells = [[0] * width for _ in range(height)]
        self.styles: dict[tuple[int, int], str] = {}

    def dot(self, x: float, y: float, style: str) -> None:
        column, row = int(x) // _ACROSS, int(y) // _DOWN
        if 0 <= column < self.size[0] and 0 <= row < self.size[1]:
            self.cells[row][column] |= _BITS[int(y) % _DOWN][int(x) % _ACROSS]
            self.styles[row, column] = style

    def line(self, points: Sequence[tuple[float, float]], style: str, dash: int = 0) -> None:
        """Draw a line through points; with `dash` so many dots, then as many left out."""
        for (x, y), (to_x, to_y) in pairwise(points):
            steps = max(int(max(abs(to_x - x), abs(to_y - y))), 1)
            for step in range(steps + 1):
                if not dash or step // dash % 2 == 0:
                    self.dot(x + (to_x - x) * step / steps, y + (to_y - y) * step / steps, style)


class _Letters:
    """The cells with letters. A name that would touch another one is written above or below its point.

    Where there is no room for it either, only its first letter is written, if that hides no other name.
    """

    def __init__(self, width: int, height: int) -> None:
        self._width, self._height = width, height
        self.cells: dict[tuple[int, int], tuple[str, str]] = {}

    def name(self, x: float, y: float, text: str, style: str) -> None:
        """Write a name whose middle is at a point."""
        said = one_line(text)
        own, first = int(y) // _DOWN, int(x) // _ACROSS - len(said) // 2
        first = max(min(first, self._width - len(said)), 0)
        fits = len(said) <= self._width and cell_len(said) == len(said)
        for row in (own, own - 1, own + 1) if fits else ():
            around = [(row, column) for column in range(first - 1, first + len(said) + 1)]
            if 0 <= row < self._height and not any(cell in self.cells for cell in around):
                self.cells.update((cell, (letter, style)) for cell, letter in zip(around[1:-1], said, strict=True))
                return
        if (own, int(x) // _ACROSS) not in self.cells:
            self.mark(x, y, said[:1] if said.isascii() else "*", style)

    def mark(self, x: float, y: float, sign: str, style: str) -> None:
        cell = int(y) // _DOWN, int(x) // _ACROSS
        if 0 <= cell[0] < self._height and 0 <= cell[1] < self._width:
            self.cells[cell] = sign, style
