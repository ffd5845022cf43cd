"""How much tests do that search or repeat: a little in each run of the suite, and much with `pytest -m long`."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from typing import Any

import pytest
from hypothesis import settings

LONG = "BTLANG_LONG"
"""The environment variable that tests/conftest.py sets where the tests are those of `-m long`."""


def amount(usual: int, long: int) -> int:
    """A test that is marked `long` does so many in each run, and so many in a long one."""
    return long if os.environ.get(LONG) else usual


def cases(names: str | tuple[str, ...], values: Sequence[Any], usual: int, **options: Any) -> Callable[[Any], Any]:
    """A test of many cases does `usual` of them in each run, one here and one there, and all in a long one."""
    some = values[:: -(-len(values) // amount(usual, len(values)))]

    def decorate(test: Any) -> Any:
        return pytest.mark.long(pytest.mark.parametrize(names, some, **options)(test))

    return decorate


def only_long(test: Any) -> Any:
    """A test that runs with `-m long` alone."""
    return pytest.mark.long(pytest.mark.skipif(not amount(0, 1), reason="takes seconds: with -m long")(test))


def searches(usual: int, long: int, **options: Any) -> Callable[[Any], Any]:
    """A property test draws so many examples in each run, and so many in a long one."""

    def decorate(test: Any) -> Any:
        return pytest.mark.long(settings(max_examples=amount(usual, long), **options)(test))

    return decorate
