"""Worlds and robots are data in TOML files: reading one, and what is wrong with it as a message about its line."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterable, Iterator

from btlang.diagnostics.reading import read_bytes
from btlang.text.source import Source
from btlang.text.toml import line_of, parse_toml
from btlang.text.toml_table import Problem, Table
from btlang.vocabulary.shipped import PACKAGE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeVar

    from btlang.diagnostics.diagnostic import Diagnostic
    from btlang.diagnostics.errors import MissionError

    T = TypeVar("T")


class DataFileError(Exception):
    """A file that cannot be used: `message` says what to write instead; `line` counts from 1, None if unknown.
    `source` is what was read, None if that was no text.
    """

    code = ""

    def __init__(self, message: str, path: str, line: int | None = None, source: Source | None = None) -> None:
        super().__init__(f"{path}:{line}: {message}" if line else f"{path}: {message}")
        self.message = message
        self.path = path
        self.line = line
        self.source = source
        self.more: tuple[DataFileError, ...] = ()
        """What else is wrong with it."""


def load_data(file: str | Source, what: str, make: Callable[[Table], T], error: type[DataFileError]) -> T:
    """What `make` makes of a path or a text, which is "a world" or the like. Raises `error`."""
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
        raise all_of(placed((problem, *problem.more), source, path, error)) from None


def make_from(
    values: dict[str, Any], path: str, what: str, make: Callable[[Table], T], error: type[DataFileError]
) -> T:
    """As `load_data`, of tables that are no TOML: errors have no line."""
    try:
        return make(Table(what, values))
    except Problem as problem:
        raise all_of(error(each.message, path) for each in (problem, *problem.more)) from None


def all_of(errors: Iterable[DataFileError]) -> DataFileError:
    """The first of them, with the others."""
    first, *more = errors
    first.more = tuple(more)
    return first


def placed(
    problems: Iterable[Problem], source: Source, path: str, error: type[DataFileError]
) -> Iterator[DataFileError]:
    """Problems as errors at their lines."""
    from btlang.text.toml_positions import nearest, positions

    found = positions(source.text)
    for problem in problems:
        at = nearest(found, problem.path)
        yield error(problem.message, path, None if at is None else source.position(at)[0], source)


def as_mission_error(error: DataFileError) -> MissionError:
    """The code of all errors of a file at their lines."""
    from btlang.diagnostics.errors import MissionError

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
