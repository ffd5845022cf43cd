"""The verb `check`: missions and files of tests one by one, all trees in XML together as a project."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from btlang.cli.missions import hint_at_text, mission_of, parse_mission, read_typed
from btlang.diagnostics.diagnostic import Diagnostic, MissionError
from btlang.diagnostics.files import has_mark, read_source
from btlang.frontends.table import frontend_of
from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.robots.platforms import ROBOTS
from btlang.support.test_files import is_test_file
from btlang.text.output import show
from btlang.text.source import Source

_SUCCESS, _BAD_INPUT = 0, 2


def check_files(options: argparse.Namespace) -> int:
    """Check what the options name; return the exit code: 2 if any of the files has an error."""
    if options.text is None and not options.file:
        return _check_robot_alone(options)
    check = _FileCheck(options)
    check.read()
    if options.fix:
        check.mend()
    check.check()
    if not check.failed and not options.report.is_for_programs:
        show("No errors found." if options.report.has_problems else "No problems found.")
    return _BAD_INPUT if check.failed else _SUCCESS


def _check_robot_alone(options: argparse.Namespace) -> int:
    """Check a robot file for which no missions are named, and say how to check these; return the exit code."""
    path = options.robot
    if path in ("", *ROBOTS) or not os.path.isfile(path):
        options.refuse("it needs a FILE or -c TEXT", "A file, a folder, or - for standard input: btc check FILE")
    from shlex import quote

    from btlang.components.checking import check_robot

    problems = check_robot(read_source(path))[1]
    options.report.add(problems)
    if any(problem.is_error for problem in problems):
        return _BAD_INPUT
    if not options.report.is_for_programs:
        show(f"No problems found in {path}. To check missions for this robot: btc check FILE --robot {quote(path)}")
    return _SUCCESS


class _FileCheck:
    """A check of some files. What it finds goes to the report; `failed`: there are errors."""

    def __init__(self, options: argparse.Namespace) -> None:
        self.failed = False
        self._options = options
        self._alone: list[Source] = []
        self._trees: list[Source] = []

    def read(self) -> None:
        """Read the files; what isn't a tree in XML is checked alone."""
        if self._options.text is not None:
            self._add(read_typed(self._options))
            return
        from btlang.projects.files import find_named_files

        with self._report_errors():
            for path in find_named_files(self._options.file):
                with self._report_errors(), hint_at_text(path, "check"):
                    self._add(read_source(path, self._options.include_root))

    def _add(self, source: Source) -> None:
        is_tree = not is_test_file(source.name) and frontend_of(source) == "xml"
        (self._trees if is_tree else self._alone).append(source)

    def mend(self) -> None:
        """Write corrections into the files; show what a text, or standard input, becomes."""
        from btlang.diagnostics.diagnostic import apply_fixes, apply_fixes_together

        done = [apply_fixes(source, self._problems_alone) for source in self._alone]
        self._alone = [source for source, _ in done]
        if self._trees:
            done += (both := apply_fixes_together(self._trees, self._problems_together))
            self._trees = [source for source, _ in both]
        for source, count in done:
            with self._report_errors():
                self._put(source, count)

    def _put(self, source: Source, count: int) -> None:
        from btlang.diagnostics.files import replace_text

        aside = sys.stderr if self._options.report.is_for_programs else sys.stdout
        if self._options.text is not None or source.name == "-":
            show(source.text.rstrip("\n"), stream=aside)
        elif count:
            mark = "\ufeff" if has_mark(source.name) else ""
            replace_text(source.name, mark + source.text)
            show(f"Corrected {source.name}: {count} change{'s' * (count > 1)}.", stream=aside)

    def check(self) -> None:
        """Report what is wrong now."""
        report, robot = self._options.report, self._options.robot
        for source in self._alone:
            with self._report_errors():
                if is_test_file(source.name):
                    from btlang.testing.test_file import check_tests  # most files are missions

                    report.add(check_tests(source))
                else:
                    mission = mission_of(self._options, source, tells_undeclared=False)
                    mission.check(robot)
        if self._trees:
            with self._report_errors():
                problems = self._problems_together(self._trees)
                report.add(problems)
                self.failed |= any(problem.is_error for problem in problems)
        for source in self._trees if robot and not self.failed else ():
            with self._report_errors():
                parse_mission(source, self._options).check(robot)

    @contextmanager
    def _report_errors(self) -> Iterator[None]:
        """Add errors to the report, and go on with the rest."""
        try:
            yield
        except MissionError as error:
            self.failed = True
            self._options.report.add(error.diagnostics)

    def _problems_alone(self, source: Source) -> Sequence[Diagnostic]:
        try:
            if is_test_file(source.name):
                from btlang.testing.test_file import check_tests  # most files are missions

                return check_tests(source)
            return parse_mission(source, self._options).warnings
        except MissionError as error:
            return error.diagnostics

    def _problems_together(self, sources: Sequence[Source]) -> Sequence[Diagnostic]:
        from btlang.projects.checking import check_trees

        options = self._options
        models = [read_source(path, options.include_root) for path in options.models]
        vocabulary = world_vocabulary(options.keywords, options.world, options.language)
        folders = [path for path in options.file or () if os.path.isdir(path)]
        return check_trees(sources, vocabulary, models=models, main=options.main, folders=folders, btcpp=options.btcpp)
