"""The plugin for pytest, which finds it by itself: files of tests (`*.test.txt`), each test an item, and fixtures for
components and drivers.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from btlang.support.test_files import is_test_file

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from typing import Any

    from btlang.testing.bench import ComponentBench, DeviceBench
    from btlang.testing.test import MissionTest


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """Collect a file of tests; return None for other files."""
    return MissionTestFile.from_parent(parent, path=file_path) if is_test_file(file_path.name) else None


@pytest.fixture
def component() -> Iterator[ComponentBench]:
    """Make components that are tested alone: see btlang.testing.bench.ComponentBench."""
    from btlang.testing.bench import ComponentBench

    bench = ComponentBench()
    yield bench
    bench.close()


@pytest.fixture
def device() -> Iterator[Callable[..., DeviceBench]]:
    """Make devices whose driver is tested alone: the parameters are those of btlang.testing.bench.DeviceBench."""
    from btlang.testing.bench import DeviceBench

    benches: list[DeviceBench] = []

    def make(*args: Any, **options: Any) -> DeviceBench:
        benches.append(DeviceBench(*args, **options))
        return benches[-1]

    yield make
    for bench in benches:
        bench.close()


class MissionTestFile(pytest.File):
    """A file of tests. One that can't be read is an error of collection, with all that is wrong with it."""

    def collect(self) -> Iterator[MissionTestItem]:
        """Yield its tests, in their order."""
        from btlang.diagnostics.diagnostic import MissionError
        from btlang.diagnostics.files import read_source
        from btlang.testing.test_file import read_tests

        try:
            tests = read_tests(read_source(str(self.path), str(self.config.rootpath)))
        except MissionError as error:
            raise self.CollectError(str(error)) from None
        for test in tests:
            yield MissionTestItem.from_parent(self, name=test.name, test=test)


class MissionTestItem(pytest.Item):
    """One test, with the seed 0."""

    def __init__(self, *, test: MissionTest, **options: Any) -> None:
        super().__init__(**options)
        self._test = test

    def runtest(self) -> None:
        """Raise Failed with what did not hold, and MissionError where the mission can't run."""
        from btlang.testing.runner import run_test

        result = run_test(self._test)
        if not result.passed:
            raise MissionTestFailed(result.problem)

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """Return the lines of `btc test` in place of a traceback."""
        if isinstance(excinfo.value, MissionTestFailed):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, int, str]:
        """Return where it stands."""
        line, _ = self._test.span.source.position(self._test.span.start)
        return self.path, line - 1, self.name


class MissionTestFailed(Exception):
    """A failure of a test: what did not hold."""
