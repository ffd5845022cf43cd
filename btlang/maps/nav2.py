"""A world as files of Nav2: a map, the masks of its keep-out and speed filters with their parameters, way points."""

from __future__ import annotations

from collections.abc import Mapping
from math import cos, radians, sin

import numpy as np

from btlang.maps.raster import Grid, walls_in
from btlang.robots.worlds.world import World
from btlang.robots.worlds.world_bounds import outer_wall

TYPE_CHECKING = False
if TYPE_CHECKING:
    import numpy.typing as npt

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


def nav2_files(world: World, resolution: float, full_speed: float) -> dict[str, bytes]:
    """The files by their names. `full_speed` (m/s) is what slow zones are a share of. Raises GridTooLarge."""
    grid = Grid(world, resolution)
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
    return files


def _map_of(grid: Grid, world: World) -> npt.NDArray[np.uint8]:
    """White inside the outer wall, grey outside, black where something is in the way."""
    wall = outer_wall(world)
    inside = np.ones((grid.height, grid.width), dtype=bool) if wall is None else grid.inside(wall)
    return np.where(walls_in(grid, world), _OCCUPIED, np.where(inside, _FREE, _UNKNOWN)).astype(np.uint8)


def _image(grid: Grid, name: str, cells: npt.NDArray[np.uint8], mode: str) -> Mapping[str, bytes]:
    x, y = grid.origin
    about = _MAP.format(image=f"{name}.pgm", mode=mode, resolution=grid.resolution, x=x, y=y)
    image = f"P5\n{grid.width} {grid.height}\n255\n".encode() + cells[::-1].tobytes()
    return {f"{name}.pgm": image, f"{name}.yaml": about.encode()}


def _way_points(world: World) -> str:
    """As RViz saves and loads them: orientations are w, x, y, z."""
    lines = ["waypoints:\n"]
    for place in world.places:
        half = radians(place.facing or 0.0) / 2
        turned = f"[{cos(half):.6f}, 0.0, 0.0, {sin(half):.6f}]"
        at = f"[{place.x:.4f}, {place.y:.4f}, 0.0]"
        lines.append(f"  {_quoted(place.name)}:\n    pose: {at}\n    orientation: {turned}\n")
    return "".join(lines)


def _quoted(text: str) -> str:
    """A text as YAML that any reader takes."""
    plain = (c if " " <= c <= "~" and c not in '"\\' else f"\\U{ord(c):08x}" for c in text)
    return f'"{"".join(plain)}"'
