"""What has happened in a run so far, for the conditions of a test."""

from __future__ import annotations

from collections.abc import Mapping

from btlang.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS
from btlang.run.bus import INLINE
from btlang.run.events import (
    Arrived,
    Bumped,
    Called,
    Dropped,
    Event,
    Grasped,
    PeriodPassed,
    Printed,
    Said,
    Seen,
    StatusesChanged,
)
from btlang.run.outcome import Outcome
from btlang.testing.commands import Command
from btlang.tree.catalogue import SUBTREE
from btlang.tree.node import Node


class Observations:
    """A sink for one run. `commands` are those that the test asks for, by the words with which it does."""

    policy = INLINE

    def __init__(self, commands: Mapping[str, Command]) -> None:
        self.now = 0.0
        """Seconds of mission time."""
        self.outcome: Outcome | None = None
        self.is_over = False
        """Whether the mission has ended; its outcome is known a little later, when the robot is at rest."""
        self.reached: set[str] = set()
        self.held: set[str] = set()
        self.met: set[str] = set()
        """Who and what was seen for the first time."""
        self.bumps = self.drops = self.calls = 0
        self.seen: dict[int, int] = {}
        """Of each node that ran, by its number, the statuses that it had: a bit for each."""
        self.nodes: dict[int, Node] = {}
        """These nodes."""
        self.running: dict[int, Node] = {}
        """The commands under way."""
        self._said: list[str] = []
        self._printed: list[str] = []
        self._commands = commands
        self._times: dict[tuple[str, int], int] = {}

    def __call__(self, event: Event) -> None:
        if isinstance(event, PeriodPassed):
            self.now = event.t
        elif isinstance(event, StatusesChanged):
            self._changed(event)
        elif isinstance(event, Said):
            self._said.append(_plain(event.text))
        elif isinstance(event, Printed):
            self._printed.append(_plain(event.text))
        elif isinstance(event, Arrived):
            self.reached.add(event.name)
        elif isinstance(event, Grasped):
            self.held.add(event.name)
        elif isinstance(event, Seen):
            self.met.add(event.name)
        elif isinstance(event, Called):
            self.calls += 1
        elif isinstance(event, Bumped):
            self.bumps += 1
        elif isinstance(event, Dropped):
            self.drops += 1

    def said_times(self, text: str) -> int:
        """How often the robot has begun to say it."""
        return self._said.count(_plain(text))

    def printed_times(self, text: str) -> int:
        """How often it was shown."""
        return self._printed.count(_plain(text))

    def times(self, text: str, status: int) -> int:
        """How often a command has ended with SUCCESS or FAILURE, or has begun (RUNNING)."""
        return self._times.get((text, status), 0)

    def is_doing(self, text: str) -> bool:
        """Whether a command runs."""
        command = self._commands[text]
        return any(command.matches(node) for node in self.running.values())

    def _changed(self, event: StatusesChanged) -> None:
        for index, status, before, _ in event.changes:
            node = self.nodes.get(index)
            if node is None:
                node = self.nodes[index] = event.nodes.node(index)
            if index == 0:
                self.is_over = status not in (RUNNING, IDLE)
            self.seen[index] = self.seen.get(index, 0) | 1 << status
            if node.children and node.id != SUBTREE:
                continue
            node = event.valued.get(index, node)
            begins = before != RUNNING and status not in (IDLE, SKIPPED)
            if status == RUNNING:
                self.running[index] = node
            else:
                self.running.pop(index, None)
            happened = [RUNNING] if begins else []
            if status in (SUCCESS, FAILURE):
                happened.append(status)
            for text, command in self._commands.items() if happened else ():
                if command.matches(node):
                    for one in happened:
                        self._times[text, one] = self._times.get((text, one), 0) + 1


def _plain(text: str) -> str:
    return text.casefold().strip(" .!")
