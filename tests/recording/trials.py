"""Trials of missions, for tests of what is said where one is refused."""

from __future__ import annotations

import sys

from btlang.api import parse_tree
from btlang.diagnostics.diagnostic import MissionError
from btlang.recording.film import try_mission


def try_sample(text: str, keywords: str) -> int:
    """Prints why a mission can't be tried, and returns the exit code, as `btc` does."""
    try:
        try_mission(parse_tree(text, keywords=[keywords]))
    except MissionError as error:
        print(error, file=sys.stderr)
        return 2
    return 0
