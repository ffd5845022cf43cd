"""Files of robots: data in TOML with messages about its lines, Python modules beside it, and the folder of sockets."""

from __future__ import annotations

import os
import stat
import sys
import tempfile
import tomllib
from collections.abc import Callable, Iterable, Iterator
from importlib import import_module
from importlib.machinery import PathFinder
from importlib.util import module_from_spec

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.diagnostics.files import read_bytes
from btlang.text.source import NOWHERE, Source
from btlang.text.toml import line_of, parse_toml
from btlang.text.toml_table import Problem, Table
from btlang.vocabulary.shipped import PACKAGE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import ModuleType
    from typing import Any, TypeVar

    from btlang.diagnostics.diagnostic import Diagnostic

    T = TypeVar("T")

_LONGEST = 100
"""Bytes of the path of a Unix socket; Linux takes 107, macOS 103."""


class DataFileError(Exception):
    """The reason why a file can't be used: `message` includes what to write instead.

    `line` counts from 1, None if unknown. `source` is what was read, None if that wasn't text.
    """

    code = ""

    def __init__(self, message: str, path: str, line: int | None = None, source: Source | None = None) -> None:
        super().__init__(f"{path}:{line}: {message}" if line else f"{path}: {message}")
        self.message = message
        self.path = path
        self.line = line
        self.source = source
        self.more: tuple[DataFileError, ...] = ()
        """Further problems of the file."""


def load_data(file: str | Source, what: str, make: Callable[[Table], T], error: type[DataFileError]) -> T:
    """Return what `make` makes of a path or a text, which is called "a world" or the like. Raises `error`."""
    path = file.name if isinstance(file, Source) else file
    try:
        source = file if isinstance(file, Source) else Source(_read(file), file)
    except OSError as problem:
        raise error(f"cannot read {what.replace('a ', 'the ')} file: {problem.strerror or problem}", path) from None
    except UnicodeDecodeError:
        raise error(f"{what} file must be UTF-8 text; save it that way", path) from None
    try:
        return make(Table(what, parse_toml(source.text)))
    except tomllib.TOMLDecodeError as problem:
        raise error(f"this isn't TOML: {problem}", path, line_of(problem), source) from None
    except Problem as problem:
        raise all_of(locate_problems((problem, *problem.more), source, path, error)) from None


def make_from(
    values: dict[str, Any], path: str, what: str, make: Callable[[Table], T], error: type[DataFileError]
) -> T:
    """Return the same as `load_data`, from tables that aren't TOML: errors have no line."""
    try:
        return make(Table(what, values))
    except Problem as problem:
        raise all_of(error(each.message, path) for each in (problem, *problem.more)) from None


def all_of(errors: Iterable[DataFileError]) -> DataFileError:
    """Return the first error, with all others attached."""
    first, *more = errors
    first.more = tuple(more)
    return first


def locate_problems(
    problems: Iterable[Problem], source: Source, path: str, error: type[DataFileError]
) -> Iterator[DataFileError]:
    """Return problems as errors at their lines."""
    from btlang.text.toml import find_positions, nearest_position

    found = find_positions(source.text)
    for problem in problems:
        at = nearest_position(found, problem.path)
        yield error(problem.message, path, None if at is None else source.position(at)[0], source)


def as_mission_error(error: DataFileError) -> MissionError:
    """Return all errors of a file at their lines as a MissionError with their code."""
    from btlang.diagnostics.diagnostic import MissionError

    return MissionError([_diagnostic(each) for each in (error, *error.more)])


def _diagnostic(error: DataFileError) -> Diagnostic:
    from btlang.diagnostics.diagnostic import diagnostic
    from btlang.text.source import Span

    source = error.source or Source("", error.path)
    start = source.offset(error.line or 1)
    end = start + len(source.line(error.line).rstrip()) if error.line and source.text else start
    return diagnostic(error.code, Span(source, start, end), reason=error.message)


def _read(path: str) -> str:
    if path.startswith(PACKAGE):
        read = getattr(__spec__.loader, "get_data", None)  # from a zipped wheel too
        if read is not None:
            data: bytes = read(path)
            return data.decode("utf-8-sig")
    return read_bytes(path).decode("utf-8-sig")


def module_of(name: str, folder: str) -> ModuleType:
    """Import a module. One in the folder is read again each time.

    It may have a newer version, or belong to another robot with a module of the same name. Raises what the module
    raises.
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
    """Return a class by its `module:Class`, or by its name in a group of entry points.

    Raises ValueError with the reason, whose text uses a `noun` such as "a recogniser" and an `example` of a place.
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


def socket_folder() -> str:
    """Return a folder for sockets that only this user can access. Raises MissionError (BT195) if there can't be one."""
    runtime = os.environ.get("XDG_RUNTIME_DIR", "")
    folder = os.path.join(runtime, "btlang")
    if not os.path.isdir(runtime) or len(os.fsencode(folder)) > _LONGEST - len("/.sock") - 38:
        folder = os.path.join(tempfile.gettempdir(), f"btlang-{os.getuid()}")
    try:
        os.makedirs(folder, mode=0o700, exist_ok=True)
        status = os.lstat(folder)
    except OSError as error:
        raise MissionError([diagnostic("BT195", NOWHERE, place=folder, reason=str(error))]) from None
    if not stat.S_ISDIR(status.st_mode) or status.st_uid != os.getuid() or status.st_mode & 0o077:
        reason = "it belongs to somebody else, or others may use it"
        raise MissionError([diagnostic("BT195", NOWHERE, place=folder, reason=reason)])
    return folder
