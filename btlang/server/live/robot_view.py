"""What is known of a robot from its messages: the state after each of them, for who joins late or reads slowly.

The page has the same reducer (`Robot` in `btlang/web/src/fleet.ts`); both pass the same cases.
"""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

STATES = ("asking", "components", "doing", "joints", "map", "robot", "scan", "speech", "things", "values", "way")
"""The kinds of messages that say how the robot is now: the newest one of each is kept for who joins late."""
NEWEST = (*STATES, "ages")
"""The kinds of messages of which only the newest one counts."""


class RobotView:
    """The state of one robot. It has at most two runs: the latest one of a task, and the latest one of house rules."""

    def __init__(self) -> None:
        self.is_up = False
        self.change: int | None = None
        """The number of the last change of a task."""
        self.runs: dict[bool, dict[str, Any]] = {}
        """The runs by whether they are those of a task; the latest one is the last."""
        self.statuses: dict[str, dict[str, Any]] = {}
        """All statuses and words of a run as one message, by the id of the run."""
        self.states: dict[str, dict[str, Any]] = {}
        """The newest message of each kind of STATES."""

    def take(self, message: dict[str, Any]) -> None:
        """Take in a message. One that is broken raises KeyError, TypeError or ValueError."""
        kind = message["type"]
        if kind == "up":  # the robot says everything again that isn't as in the beginning
            self.is_up, self.change, self.states = True, int(message["change"]), {}
        elif kind == "away":
            self.is_up = False
        elif kind == "change":
            self.change = int(message["number"])
        elif kind == "run":
            is_task = bool(message["task"])
            self.runs.pop(is_task, None)
            self.runs[is_task] = message
            ids = [run["run"] for run in self.runs.values()]
            self.statuses = {id: found for id, found in self.statuses.items() if id in ids and id != message["run"]}
        elif kind == "statuses":
            if any(run["run"] == message["run"] for run in self.runs.values()):
                self.statuses[message["run"]] = merge_statuses(self.statuses.get(message["run"]), message)
        elif kind in STATES:
            self.states[kind] = message

    def messages(self) -> list[dict[str, Any]]:
        """Return messages that bring somebody who knows nothing to the same state."""
        if not self.is_up:
            return [{"type": "away"}]
        messages: list[dict[str, Any]] = [{"type": "up", "change": self.change}]
        for run in self.runs.values():
            messages += [run, *filter(None, [self.statuses.get(run["run"])])]
        return [*messages, *self.states.values()]


def merge_statuses(before: dict[str, Any] | None, after: dict[str, Any]) -> dict[str, Any]:
    """Return statuses together with earlier ones of the same run as one message."""
    if before is None:
        return after
    message = {**before, **after}
    for part in {"changes", "words"} & message.keys():
        both = {each[0]: each for each in (*before.get(part, ()), *after.get(part, ()))}
        message[part] = [*both.values()]
    return message
