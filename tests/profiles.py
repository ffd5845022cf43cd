"""How much tests do that search or repeat: a little in each run of the suite, and much with `pytest -m long`."""

from __future__ import annotations

import os
import traceback
from collections.abc import Callable, Sequence
from functools import wraps
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

LONG = "BTLANG_LONG"
"""The environment variable that tests/conftest.py sets where the tests are those of `-m long`."""


def amount(usual: int, long: int) -> int:
    """A test that is marked `long` does so many in each run, and so many in a long one."""
    return long if os.environ.get(LONG) else usual


def cases(
    names: str | tuple[str, ...], values: Sequence[Any], usual: int, first: int = 0, **options: Any
) -> Callable[[Any], Any]:
    """A test of many cases does `usual` of them in each run, one here and one there, and all in a long one.

    Tests of the same cases begin with another `first` one each, so that each case is in one of them.
    """
    some = values[amount(first, 0) :: -(-len(values) // amount(usual, len(values)))]

    def decorate(test: Any) -> Any:
        return pytest.mark.long(pytest.mark.parametrize(names, some, **options)(test))

    return decorate


def each_of(rows: Sequence[tuple[Any, ...]], at_a_time: int) -> Callable[[Any], Any]:
    """A test of thousands of short rows runs many of them at a time, which takes less than a test of each: it is called
    with one row after the other, and its failure names each row that failed, with its reason.
    """
    groups = [rows[first : first + at_a_time] for first in range(0, len(rows), at_a_time)]

    def decorate(test: Any) -> Any:
        def of_rows(group: Sequence[tuple[Any, ...]]) -> None:
            failed = [said for row in group if (said := _failure(test, row))]
            if failed:
                pytest.fail("\n\n".join(failed), pytrace=False)

        wraps(test)(of_rows)
        del of_rows.__wrapped__  # type: ignore[attr-defined] # whose parameters pytest would take for those of fixtures
        return pytest.mark.parametrize("group", groups, ids=[f"{group[0][0]} to {group[-1][0]}" for group in groups])(
            of_rows
        )

    return decorate


def _failure(test: Any, row: tuple[Any, ...]) -> str:
    """Why a row fails; nothing if it doesn't."""
    try:
        test(*row)
    except (Exception, pytest.fail.Exception) as error:
        where = traceback.extract_tb(error.__traceback__)[-1]
        name = ", ".join(getattr(part, "__name__", str(part)) for part in row)
        return f"{name}\n{type(error).__name__}, {Path(where.filename).name}:{where.lineno}: {error}"
    return ""


def only_long(test: Any) -> Any:
    """A test that runs with `-m long` alone."""
    return pytest.mark.long(pytest.mark.skipif(not amount(0, 1), reason="takes seconds: with -m long")(test))


def searches(usual: int, long: int, **options: Any) -> Callable[[Any], Any]:
    """A property test draws so many examples in each run, and so many in a long one."""

    def decorate(test: Any) -> Any:
        return pytest.mark.long(settings(max_examples=amount(usual, long), **options)(test))

    return decorate
