"""A world as files of Nav2: a map, masks of its filters with their parameters, and way points."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import ceil, cos, radians, sin

import numpy as np

from btlang.maps.occupancy import MOST_CELLS
from btlang.maps.reach import reached
from btlang.maps.route_graph import write_route_graph
from btlang.robots.geometry import Point, Segment
from btlang.robots.worlds.world import World
from btlang.text.toml_table import Problem

TYPE_CHECKING = False
if TYPE_CHECKING:
    import numpy.typing as npt

    Cells = npt.NDArray[np.bool_]

_MARGIN = 10.5  # cells around everything
_OCCUPIED, _FREE, _UNKNOWN = 0, 254, 205  # grey, as map_saver writes them
_MAP = """image: {image}
mode: {mode}
resolution: {resolution}
origin: [{x}, {y}, 0.0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
"""
_FILTERS = """# For nav2_map_server (the masks) and nav2_costmap_2d (the filters).
keepout_filter_mask_server:
  ros__parameters:
    yaml_filename: keepout_mask.yaml
    topic_name: keepout_filter_mask
    frame_id: map
keepout_costmap_filter_info_server:
  ros__parameters:
    type: 0
    filter_info_topic: keepout_costmap_filter_info
    mask_topic: keepout_filter_mask
    base: 0.0
    multiplier: 1.0
speed_filter_mask_server:
  ros__parameters:
    yaml_filename: speed_mask.yaml
    topic_name: speed_filter_mask
    frame_id: map
speed_costmap_filter_info_server:
  ros__parameters:
    type: 1  # percent of the full speed, which is {speed:g} m/s here
    filter_info_topic: speed_costmap_filter_info
    mask_topic: speed_filter_mask
    base: 100.0  # a cell with the value v in the mask is for 100 - v percent
    multiplier: -1.0
"""


class GridTooLarge(ValueError):
    """The error that a world has too many cells."""


class CellGrid:
    """Cells with sides of `resolution` metres that cover a world; the first one is in the south-west at `origin`."""

    def __init__(self, world: World, resolution: float) -> None:
        """Make the grid. Raises GridTooLarge."""
        points = [segment[at : at + 2] for segment in world.segments() for at in (0, 2)]
        middles = np.min(points or [(0.0, 0.0)], axis=0)  # of cells: walls are mostly at round coordinates
        points += [door_end for door in world.doors for door_end in (door.start, door.end)]
        points += [point for zone in world.zones for point in zone.points]
        points += [(place.x, place.y) for place in world.places] + [(world.start.x, world.start.y)]
        low, high = np.min(points, axis=0), np.max(points, axis=0)
        self.resolution = resolution
        start = middles - (np.ceil((middles - low) / resolution) + _MARGIN) * resolution
        self.origin: Point = (round(float(start[0]), 6), round(float(start[1]), 6))
        self.width, self.height = (ceil(float(cells)) for cells in (high - start) / resolution + _MARGIN)
        if self.width * self.height > MOST_CELLS:
            message = f"{self.width:,} x {self.height:,} cells are too many; use a larger --resolution"
            raise GridTooLarge(message)

    def empty(self) -> Cells:
        """Return an array without set cells, with a row from the south for each first index."""
        return np.zeros((self.height, self.width), dtype=bool)

    def cell(self, point: Point) -> tuple[int, int]:
        """Return the column and the row of a point."""
        return tuple(int((point[axis] - self.origin[axis]) / self.resolution) for axis in (0, 1))  # type: ignore[return-value]

    def draw(self, cells: Cells, segments: Iterable[Segment]) -> None:
        """Add the cells that segments run through."""
        for ax, ay, bx, by in segments:
            steps = ceil(max(abs(bx - ax), abs(by - ay)) / self.resolution * 4) + 1
            columns = (np.linspace(ax, bx, steps) - self.origin[0]) / self.resolution
            rows = (np.linspace(ay, by, steps) - self.origin[1]) / self.resolution
            cells[rows.astype(int), columns.astype(int)] = True

    def fill(self, cells: Cells, polygon: Sequence[Point]) -> None:
        """Add the cells of a polygon: those whose middle is inside, and those that its sides run through."""
        self.draw(cells, ((*polygon[at - 1], *polygon[at]) for at in range(len(polygon))))
        cells |= self.inside(polygon)

    def inside(self, polygon: Sequence[Point]) -> Cells:
        """Return the cells whose middle is in a polygon, by the even-odd rule."""
        found = self.empty()
        columns = self.origin[0] + (np.arange(self.width) + 0.5) * self.resolution
        rows = self.origin[1] + (np.arange(self.height) + 0.5) * self.resolution
        for at in range(len(polygon)):
            (ax, ay), (bx, by) = polygon[at - 1], polygon[at]
            crossed = np.nonzero((ay > rows) != (by > rows))[0]
            for row in crossed.tolist():
                found[row] ^= columns < ax + (rows[row] - ay) * (bx - ax) / (by - ay)
        return found


def walls_in(grid: CellGrid, world: World) -> Cells:
    """Return the cells of walls, furniture and closed doors."""
    cells = grid.empty()
    _draw_fixed(grid, cells, world)
    grid.draw(cells, ((*door.start, *door.end) for door in world.doors if not door.open))
    return cells


def _draw_fixed(grid: CellGrid, cells: Cells, world: World) -> None:
    """Add the cells of walls and furniture."""
    grid.draw(cells, world.wall_segments())
    for box in world.boxes:
        left, low = grid.cell((box.x - box.width / 2, box.y - box.height / 2))
        right, high = grid.cell((box.x + box.width / 2, box.y + box.height / 2))
        cells[low : high + 1, left : right + 1] = True


def nav2_files(world: World, resolution: float, full_speed: float) -> dict[str, bytes]:
    """Return the files by their names. The speed of slow zones is a share of `full_speed`
    (m/s). Raises GridTooLarge.
    """
    grid = CellGrid(world, resolution)
    keep_out, slow = grid.empty(), np.zeros((grid.height, grid.width), dtype=np.uint8)
    for zone in world.zones:
        if zone.is_closed:
            grid.fill(keep_out, zone.points)
        else:
            cells = grid.empty()
            grid.fill(cells, zone.points)
            percent = min(max(round(100 * zone.speed / full_speed), 1), 100)
            slow[cells] = np.maximum(slow[cells], 100 - percent)  # where zones overlap the slower counts
    files = {
        **_image(grid, "map", _map_of(grid, world), "trinary"),
        **_image(grid, "keepout_mask", np.where(keep_out, _OCCUPIED, _FREE).astype(np.uint8), "trinary"),
        **_image(grid, "speed_mask", slow, "raw"),
        "filters.yaml": _FILTERS.format(speed=full_speed).encode(),
    }
    if world.places:
        files["waypoints.yaml"] = _way_points(world).encode()
    if world.lanes:
        files["route_graph.geojson"] = write_route_graph(world).encode()
    return files


def _map_of(grid: CellGrid, world: World) -> npt.NDArray[np.uint8]:
    """Return a map: white where the start and places are open to, black if something is in the way, grey elsewhere."""
    barred = grid.empty()
    _draw_fixed(grid, barred, world)
    seeds = [grid.cell(point) for point in [(world.start.x, world.start.y), *((p.x, p.y) for p in world.places)]]
    try:
        free = reached(~barred, seeds)
    except Problem as problem:
        raise GridTooLarge(problem.message) from None
    return np.where(walls_in(grid, world), _OCCUPIED, np.where(free, _FREE, _UNKNOWN)).astype(np.uint8)


def _image(grid: CellGrid, name: str, cells: npt.NDArray[np.uint8], mode: str) -> Mapping[str, bytes]:
    x, y = grid.origin
    about = _MAP.format(image=f"{name}.pgm", mode=mode, resolution=grid.resolution, x=x, y=y)
    image = f"P5\n{grid.width} {grid.height}\n255\n".encode() + cells[::-1].tobytes()
    return {f"{name}.pgm": image, f"{name}.yaml": about.encode()}


def _way_points(world: World) -> str:
    """Return way points as RViz saves and loads them: orientations are w, x, y, z."""
    lines = ["waypoints:\n"]
    for place in world.places:
        half = radians(place.facing or 0.0) / 2
        turned = f"[{cos(half):.6f}, 0.0, 0.0, {sin(half):.6f}]"
        at = f"[{place.x:.4f}, {place.y:.4f}, 0.0]"
        lines.append(f"  {_quote(place.name)}:\n    pose: {at}\n    orientation: {turned}\n")
    return "".join(lines)


def _quote(text: str) -> str:
    """Return a text as YAML that any reader takes."""
    plain = (c if " " <= c <= "~" and c not in '"\\' else f"\\U{ord(c):08x}" for c in text)
    return f'"{"".join(plain)}"'
