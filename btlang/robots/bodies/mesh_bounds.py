"""The bounds of meshes in STL and OBJ files that lie in the package of a URDF file."""

from __future__ import annotations

import os
import re

import numpy as np

from btlang.diagnostics.files import is_below, real_path
from btlang.robots.motion.kinematics import Array

_MOST_BYTES = 60_000_000
_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_VERTEX = re.compile(rb"^\s*v(?:ertex)?\s+(\S+)\s+(\S+)\s+(\S+)", re.MULTILINE)


def mesh_bounds(name: str, urdf: str) -> tuple[Array, Array] | None:
    """Return the lowest and the highest corner of a mesh, in the units of its file.

    `name` is the file as a URDF file at the path `urdf` has it. None if it isn't in the package of that file, or can't
    be read.
    """
    path = _find(name, urdf)
    if path is None:
        return None
    try:
        with open(path, "rb") as file:
            data = file.read(_MOST_BYTES + 1)
    except OSError:
        return None
    ending = os.path.splitext(path)[1].lower()
    corners = _stl(data) if ending == ".stl" else _text(data) if ending == ".obj" else None
    if len(data) > _MOST_BYTES or corners is None or not len(corners) or not np.isfinite(corners).all():
        return None
    return corners.min(axis=0).astype(np.float64), corners.max(axis=0).astype(np.float64)


def _find(name: str, urdf: str) -> str | None:
    """Return the real path of a file in the folder of the URDF file or in its package."""
    if not os.path.isfile(urdf):
        return None
    folder = os.path.dirname(os.path.abspath(urdf))
    root = _package(folder)
    for scheme in ("package://", "model://"):
        if name.startswith(scheme):
            name = name.removeprefix(scheme).partition("/")[2]
            folder = root
    found = real_path(os.path.join(folder, name.removeprefix("file://")))
    return found if is_below(found, root) and os.path.isfile(found) else None


def _package(folder: str) -> str:
    """Return the folder with the package.xml above a folder; the folder itself if there isn't any."""
    at = folder
    while not os.path.isfile(os.path.join(at, "package.xml")):
        above = os.path.dirname(at)
        if above == at:
            return folder
        at = above
    return at


def _stl(data: bytes) -> Array | None:
    count = int.from_bytes(data[80:84], "little")
    if len(data) >= 84 and len(data) == 84 + count * _FACET.itemsize:
        return np.asarray(np.frombuffer(data, _FACET, count, 84)["corners"].reshape(-1, 3))
    return _text(data)


def _text(data: bytes) -> Array | None:
    try:
        return np.array(_VERTEX.findall(data), dtype=np.float64)
    except ValueError:
        return None
