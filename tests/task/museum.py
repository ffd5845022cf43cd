"""Some hours of a museum's robot in a process of its own: `python -m tests.task.museum FOLDER BEGINS ENDS HOW`.

Time is simulated, from BEGINS to ENDS (seconds since 1970). HOW is `cut` for a power cut at the end, or `end`.
"""

from __future__ import annotations

import os
import signal
import sys
import time
from pathlib import Path

from btlang.task.execution.missions import MissionReader
from btlang.task.layer import TaskLayer
from btlang.task.messages import AddSchedule
from btlang.vocabulary.shipped import DEFAULT_WORLD

TOUR = "say welcome then go to the lab then go to the kitchen then go to the living room then wave"
RULES = "whenever the battery is below 30%, go to the dock then charge to 90%\n"
HOUR = 3600.0
DAY = 24 * HOUR


def main() -> None:
    """One piece of the week."""
    folder, begins, ends = Path(sys.argv[1]), float(sys.argv[2]), float(sys.argv[3])
    rules, world = folder / "rules.txt", folder / "world.toml"
    rules.write_text(RULES)
    midnight = begins // DAY * DAY
    closed = [(midnight + day * DAY + 13 * HOUR - begins, midnight + day * DAY + 15 * HOUR - begins) for day in (0, 1)]
    faults = "".join(
        f'\n[[faults]]\nkind = "blocked"\nplace = "kitchen"\nfrom = {max(0.0, start)}\nuntil = {end}\n'
        for start, end in closed
        if end > 0
    )
    world.write_text(Path(DEFAULT_WORLD).read_text() + faults)
    with TaskLayer(
        "simulated", MissionReader(world=str(world)), folder=str(folder), rules=str(rules), speed="max", begins=begins,
        trouble=lambda text: print(text, file=sys.stderr),
    ) as layer:  # fmt: skip
        if not layer.store.schedules():
            answer = layer.handle(
                AddSchedule("every hour between 10 and 17", TOUR, zone="UTC", labels=("tour",), within=20 * 60),
                "museum",
            )
            assert answer.ok, answer.text
        while layer.now() < ends:
            time.sleep(0.0005)
        if sys.argv[4] == "cut":
            os.kill(os.getpid(), signal.SIGKILL)


if __name__ == "__main__":
    main()
