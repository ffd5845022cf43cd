"""The correct words of a language, known to a mission or not. They are read only where something is wrong."""

from __future__ import annotations

import os
from functools import cache


@cache
def correct_words(path: str) -> frozenset[str]:
    """Those of a list, in lower case; none where there is no such file (`keywords/en/make_words.py` makes one)."""
    if not os.path.isfile(path):
        return frozenset()
    with open(path, encoding="utf-8") as file:
        return frozenset(line for line in file.read().splitlines() if not line.startswith("#"))
