"""Maps of ROS: a YAML file and its image become cells that are occupied or not."""

from __future__ import annotations

import os
from collections.abc import Mapping

import numpy as np

from btlang.diagnostics.reading import is_below, real_path, reason_of
from btlang.maps.fields import number, numbers, shown
from btlang.maps.images import MapImage, read_image
from btlang.robots.geometry import Pose
from btlang.support.record import Record
from btlang.text.toml_table import Problem

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    import numpy.typing as npt

_MODES = ("trinary", "scale", "raw")


class OccupancyMap(Record):
    """Which cells are occupied, a row from the south for each first index.

    A cell has sides of `resolution` metres; `origin` is the corner of the first cell and the direction of its row.
    """

    occupied: npt.NDArray[np.bool_]
    resolution: float
    origin: Pose


def is_map(data: object) -> bool:
    """Whether the data of a file are those of a map."""
    return isinstance(data, Mapping) and "image" in data and "resolution" in data


def read_map(data: Mapping[str, Any], folder: str) -> OccupancyMap:
    """A map whose image is in the folder of its YAML file. Cells are what nav2_map_server takes them for; of "raw"
    images a cell is occupied as in "scale": above `occupied_thresh`.

    Raises Problem, and MissionError (BT087).
    """
    resolution = number(data["resolution"], '"resolution"', 0.001, 1000.0)
    x, y, angle = numbers(data.get("origin", [0.0, 0.0, 0.0]), '"origin"', 3)
    occupied_above = number(data.get("occupied_thresh", 0.65), '"occupied_thresh"', 0.0, 1.0)
    mode = data.get("mode", _MODES[0])
    if mode not in _MODES:
        raise Problem(f'"mode" must be trinary, scale or raw, not {shown(mode)}')
    negate = data.get("negate", 0)
    if negate not in (0, 1):
        raise Problem(f'"negate" must be 0 or 1, not {shown(negate)}')
    image = _image(data["image"], folder)
    occupied = _occupied(image, str(mode), bool(negate), occupied_above)
    return OccupancyMap(occupied[::-1], resolution, Pose(x, y, float(np.degrees(angle))))


def _image(name: Any, folder: str) -> MapImage:
    if not isinstance(name, str) or not name:
        raise Problem(f'"image" must be the name of a file, not {shown(name)}')
    path = real_path(os.path.join(folder, name))
    if not is_below(path, folder):
        raise Problem(f"the image {shown(name)} must be in the folder of the map, or below it; move it there")
    if not os.path.isfile(path):
        raise Problem(f"there is no image {shown(name)}")
    try:
        return read_image(path)
    except OSError as error:
        raise Problem(f"I can't read the image {shown(name)}: {reason_of(error)}") from None


def _occupied(image: MapImage, mode: str, negate: bool, above: float) -> npt.NDArray[np.bool_]:
    shades, alpha = image.shades, image.alpha
    if mode == "raw":
        percent = np.rint(shades * 255)
        return (percent <= 100) & (percent > above * 100)
    if mode == "trinary" and alpha is not None:
        shades = (shades * np.float32(3) + alpha) / np.float32(4)  # as nav2_map_server does it
    found = (shades if negate else 1 - shades) > above
    if mode == "scale" and alpha is not None:
        found &= alpha == 1
    return found
