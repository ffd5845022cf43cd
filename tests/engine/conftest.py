"""Each test of the engine runs twice: with closures alone, and with regions generated before the first tick."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any
from unittest.mock import patch

import pytest
from hypothesis import strategies as st

from btlang.engine import generation, regions

NEVER = 1 << 60
"""So many ticks before regions are generated."""
USUAL = {"DEEPEST": regions.DEEPEST}
SIZES = st.sampled_from(
    (USUAL, {"DEEPEST": 2, "LARGEST": 4, "WIDE": 2, "LONG_WAY": 1}, {"WIDE": 2}, {"LARGEST": 8, "LONG_WAY": 1})
)
"""Limits of regions, so that small trees have several of them, rows of leaves in a loop, and resume paths."""


def limited(sizes: dict[str, int]) -> Any:
    """Limits regions."""
    return patch.multiple("btlang.engine.regions", **sizes)


@pytest.fixture(autouse=True, scope="module", params=[NEVER, 0], ids=["closures", "generated"])
def ticks_before(request: pytest.FixtureRequest) -> Iterator[int]:
    """After how many ticks regions are generated."""
    with patch.object(generation, "TICKS_BEFORE", request.param):
        yield request.param
