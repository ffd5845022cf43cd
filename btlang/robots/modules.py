"""Python modules that a robot file names: those in its folder come before the ones that are installed."""

from __future__ import annotations

import sys
from importlib import import_module
from importlib.machinery import PathFinder
from importlib.util import module_from_spec

TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import ModuleType
    from typing import Any


def module_of(name: str, folder: str) -> ModuleType:
    """A module. One in the folder is reread each time: it may have a newer version, or be that of another robot with
    one of the same name. Raises what the module raises.
    """
    top = name.partition(".")[0]
    spec = PathFinder.find_spec(top, [folder]) if folder and top else None
    if spec is not None and folder not in sys.path:
        sys.path.insert(0, folder)
    if spec is None or spec.loader is None or top != name:
        return import_module(name)
    before, module = sys.modules.get(name), module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[name]
        if before is not None:
            sys.modules[name] = before
        raise
    return module


def class_of(place: str, group: str, folder: str, noun: str, example: str) -> Any:
    """A class by its `module:Class`, or by its name in a group of entry points.

    Raises ValueError with the reason. For its text: a `noun` such as "a recogniser", an `example` of a place.
    """
    from importlib.metadata import entry_points

    named = entry_points(group=group, name=place)
    module, colon, name = (next(iter(named)).value.replace(" ", "") if named else place).partition(":")
    if not colon:
        raise ValueError(f'no package has {noun} "{place}"; or write its place, such as "{example}"')
    try:
        return getattr(module_of(module, folder), name)
    except Exception as problem:  # whatever somebody's module raises
        raise ValueError(f"{place} can't be loaded: {type(problem).__name__}: {problem}") from problem
