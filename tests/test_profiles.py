"""How much of tests is done in each run, and what is said of many rows at a time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pytest

from tests.profiles import each_of


def test_each_row_that_fails_is_named_with_its_reason() -> None:
    @each_of([("one", 1), ("two", 2), ("three", 3), ("four", 4)], at_a_time=3)
    def is_odd(name: str, number: int) -> None:
        if number == 4:
            pytest.fail("no such number")
        assert number % 2, f"{number} is even"

    [mark] = is_odd.pytestmark
    groups: list[Sequence[Any]] = mark.args[1]
    assert [[name for name, _ in group] for group in groups] == [["one", "two", "three"], ["four"]]
    for group, name, reason in zip(groups, ("two", "four"), ("2 is even", "no such number"), strict=True):
        with pytest.raises(pytest.fail.Exception) as failed:
            is_odd(group)
        assert str(failed.value).startswith(f"{name}, ")
        assert reason in str(failed.value)
        assert "one" not in str(failed.value)
    is_odd(groups[0][:1])
