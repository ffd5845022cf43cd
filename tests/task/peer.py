"""A robot that is up in a process of its own, for tests that kill it: `python -m tests.task.peer FOLDER [STORE]`.

Reads commands as lines of JSON, and writes what happens as lines: `up`, the numbers of new tasks, and what is printed.
"""

from __future__ import annotations

import json
import os
import sys

from btlang.run.events import Event, Printed
from btlang.task.layer import TaskLayer


def tell(line: str) -> None:
    """A line in one piece: several threads write, and the process may be killed."""
    os.write(1, f"{line}\n".encode())


def main() -> None:
    """Until its input ends."""
    folder, store = sys.argv[1], "".join(sys.argv[2:])

    def printed(event: Event) -> None:
        if isinstance(event, Printed):
            tell(f"printed {event.text}")

    printed.policy = "inline"  # type: ignore[attr-defined]
    with TaskLayer(folder=folder, store=store, speed=50.0, sinks=lambda *_: [printed]) as layer:
        tell("up")
        for line in sys.stdin:
            answer = layer.handle(json.loads(line), "ann")
            done = answer.data["task"]["id"] if "task" in answer.data else answer.text
            tell(f"answer {done if answer.ok else f'refused: {answer.text}'}")


if __name__ == "__main__":
    main()
