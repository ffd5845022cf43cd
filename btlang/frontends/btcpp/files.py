"""XML files with the files that they include, each read once."""

from __future__ import annotations

import os
from collections.abc import Iterable

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.diagnostics.errors import MissionError
from btlang.diagnostics.reading import MOST_DEEP, TOO_DEEP, included_path, read_included, real_path
from btlang.frontends.btcpp.file import XmlFile
from btlang.frontends.btcpp.scan import scanned
from btlang.text.source import Source, Span

_ROS_FOLDERS = "AMENT_PREFIX_PATH"  # where ROS 2 has its packages


class XmlFiles:
    """The files that were added, each before those that it includes; what is wrong with them, and what is only odd.

    A file that is included and is one of `sources` isn't read again.
    """

    def __init__(self, sources: Iterable[Source] = ()) -> None:
        self._sources = {real_path(source.name): source for source in sources}
        self.files: list[XmlFile] = []
        self.problems: list[Diagnostic] = []
        self.warnings: list[Diagnostic] = []
        self._read: set[str] = set()

    def add(self, source: Source) -> None:
        """Reads a file and what it includes, unless that is done."""
        real = real_path(source.name)
        if real not in self._read:
            self._read_file(source, (real,))

    def _read_file(self, source: Source, within: tuple[str, ...], dialect: int = 3) -> None:
        """Reads a file and what it includes; `within` are the files around it, its own last, `dialect` is theirs."""
        self._read.add(within[-1])
        try:
            file = XmlFile(scanned(source), dialect)
        except MissionError as error:
            self.problems += error.diagnostics
            return
        self.problems += file.problems
        self.warnings += file.warnings
        file.is_sound = not file.problems
        file.problems.clear()
        self.files.append(file)
        for attributes, span in file.includes:
            if "path" not in attributes:
                self.problems.append(diagnostic("BT123", span, tag="include", attribute="path", advice=""))
                continue
            self._include(attributes, span, within, file.dialect)

    def _include(self, attributes: dict[str, str], span: Span, within: tuple[str, ...], dialect: int) -> None:
        path, source = attributes["path"], span.source
        if "ros_pkg" in attributes and source.roots:
            folder = _package_folder(attributes["ros_pkg"])
            if folder is None:
                self._not_included(span, path=path, reason=_no_package(attributes["ros_pkg"]))
                return
            # an installed package may be included from anywhere
            source = Source("", folder=folder, hides_includes=source.hides_includes)
        _, real = included_path(path, source)
        if real in within:
            circle = " -> ".join(map(os.path.basename, (*within[within.index(real) :], real)))
            self._not_included(span, path=path, reason=f"it includes itself: {circle}")
        elif len(within) >= MOST_DEEP:
            self._not_included(span, path=path, reason=TOO_DEEP)
        elif real in self._read:
            pass
        elif real in self._sources:
            self._read_file(self._sources[real], (*within, real), dialect)
        else:
            try:
                included = read_included(path, source)
            except MissionError as error:
                [problem] = error.diagnostics
                if problem.code != "BT001":
                    self.problems.append(problem)
                    return
                self._not_included(span, path=path, reason=dict(problem.arguments)["reason"])
                return
            self._read_file(included, (*within, real), dialect)

    def _not_included(self, span: Span, *, path: str, reason: str) -> None:
        self.problems.append(diagnostic("BT128", span, path=path, reason=reason))


def _package_folder(package: str) -> str | None:
    """The folder of a ROS 2 package, None where it is not installed."""
    for prefix in os.environ.get(_ROS_FOLDERS, "").split(os.pathsep):
        found = os.path.join(prefix, "share", package)
        if prefix and os.path.isdir(found) and package == os.path.basename(package) and package.strip("."):
            return found
    return None


def _no_package(package: str) -> str:
    where = "not in any folder of" if os.environ.get(_ROS_FOLDERS) else "because there is no"
    return f"the ROS package {package} is not found, {where} {_ROS_FOLDERS}"
