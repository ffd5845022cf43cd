"""Each test of the engine runs twice: with closures alone, and with regions generated before the first tick."""

from __future__ import annotations

from collections.abc import Iterator
from unittest.mock import patch

import pytest

from btlang.engine import generation

NEVER = 1 << 60
"""So many ticks before regions are generated."""


@pytest.fixture(autouse=True, scope="module", params=[NEVER, 0], ids=["closures", "generated"])
def ticks_before(request: pytest.FixtureRequest) -> Iterator[int]:
    """After how many ticks regions are generated."""
    with patch.object(generation, "TICKS_BEFORE", request.param):
        yield request.param
