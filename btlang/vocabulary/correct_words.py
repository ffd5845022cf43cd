"""The words of correct English, known to a mission or not. They are read only where something is wrong."""

from __future__ import annotations

import os
from functools import cache

from btlang.vocabulary.shipped import shipped


@cache
def correct_words(language: str) -> frozenset[str]:
    """Those of a language, in lower case; none where no list of them ships (`keywords/make_words.py` makes them)."""
    path = shipped("keywords", f"{language}.words")
    if not language.isalpha() or not os.path.exists(path):
        return frozenset()
    with open(path, encoding="utf-8") as file:
        return frozenset(line for line in file.read().splitlines() if not line.startswith("#"))
