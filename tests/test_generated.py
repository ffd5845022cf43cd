"""Files that are made from others are up to date."""

from __future__ import annotations

import pytest

from tests.generate import FILES, ROOT


@pytest.mark.parametrize("name", FILES)
def test_it_is_up_to_date(name: str) -> None:
    assert (ROOT / name).read_text(encoding="utf-8") == FILES[name](), "run python -m tests.generate"
