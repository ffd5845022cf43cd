"""Rules of schedules, for tests of what is said where one can't be read."""

from __future__ import annotations

import sys
from collections.abc import Iterable

from btlang.diagnostics.diagnostic import MissionError
from btlang.task.schedule.recurrence import read_rule


def read_schedules(rules: Iterable[str], zone: str = "") -> int:
    """Prints what is wrong with them and returns the exit code, as `btc` does."""
    problems = []
    for rule in rules:
        try:
            read_rule(rule, zone)
        except MissionError as error:
            problems.append(str(error))
    if problems:
        print("\n\n".join(problems), file=sys.stderr)
    return 2 if problems else 0
