"""The fixture `terminal`: opens terminals for a test and closes them after it."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest

from tests.terminal.emulator import Terminal


@pytest.fixture
def terminal() -> Iterator[Callable[..., Terminal]]:
    """A function that opens a terminal (see Terminal) in which a command runs; all are closed after the test."""
    opened: list[Terminal] = []

    def open_terminal(*command: str, **options: object) -> Terminal:
        made = Terminal(*command, **options)  # type: ignore[arg-type]
        opened.append(made)
        return made

    yield open_terminal
    for one in opened:
        one.close()
