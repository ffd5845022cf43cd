"""An action that calls sys.exit fails, and says so: it ends no program."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from typing import Any

import pytest

import btlang
from btlang.engine.status import FAILURE


def function() -> None:
    sys.exit(0)


def generator() -> Iterator[None]:
    yield
    sys.exit(0)


async def awaited() -> None:
    sys.exit(0)


class Made:
    def start(self) -> None: ...

    def tick(self) -> None:
        sys.exit(0)

    def halt(self) -> None: ...


@pytest.mark.parametrize(("call", "thread"), [(function, False), (function, True), (generator, False), (awaited, False),
                                              (Made, False)])  # fmt: skip
def test_an_exit_is_a_failure_with_a_reason(call: Callable[..., Any], thread: bool) -> None:
    tree = btlang.parse_tree("leave then wave", keywords=[btlang.action("leave", thread=thread)(call)])
    outcome = tree.run(speed="max", time_limit=600)
    assert (outcome.status, outcome.failure and outcome.failure.reason) == (FAILURE, "SystemExit: 0")
    assert "leave" in outcome.why()
