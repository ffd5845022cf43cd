"""What has happened in a run so far, for the conditions of a test, and which nodes ran in all tests."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from btlang.api import Mission
from btlang.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS
from btlang.passes.lint import endings
from btlang.passes.lint.endings import Ends, find_ends
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
from btlang.testing.test import MissionTest, NamedCommand
from btlang.tree.catalogue import SUBTREE
from btlang.tree.dump import outline
from btlang.tree.node import Node, Tree
from btlang.tree.visit import fold


class Observations:
    """A sink for one run. `commands` are those that the test asks for, by the words with which it does."""

    policy = INLINE

    def __init__(self, commands: Mapping[str, NamedCommand]) -> None:
        self.now = 0.0
        """The mission time in seconds."""
        self.outcome: Outcome | None = None
        self.is_over = False
        """Whether the mission has ended; its outcome is known a little later, when the robot is at rest."""
        self.reached: set[str] = set()
        self.held: set[str] = set()
        self.met: set[str] = set()
        """The people and things that were seen for the first time."""
        self.bumps = self.drops = self.calls = 0
        self.seen: dict[int, int] = {}
        """The statuses that each node had that ran, by its number: a bit for each."""
        self.nodes: dict[int, Node] = {}
        """The nodes of a mission by their numbers."""
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
            self._take_change(event)
        elif isinstance(event, Said):
            self._said.append(_normalize(event.text))
        elif isinstance(event, Printed):
            self._printed.append(_normalize(event.text))
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
        """Return how often the robot has begun to say it."""
        return self._said.count(_normalize(text))

    def printed_times(self, text: str) -> int:
        """Return how often it was shown."""
        return self._printed.count(_normalize(text))

    def times(self, text: str, status: int) -> int:
        """Return how often a command has ended with SUCCESS or FAILURE, or has begun (RUNNING)."""
        return self._times.get((text, status), 0)

    def is_doing(self, text: str) -> bool:
        """Return whether a command runs."""
        command = self._commands[text]
        return any(command.matches(node) for node in self.running.values())

    def _take_change(self, event: StatusesChanged) -> None:
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


def _normalize(text: str) -> str:
    return text.casefold().strip(" .!")


_NAMES = {SUCCESS: "succeeded", FAILURE: "failed"}
_ENDS = {SUCCESS: endings.SUCCESS, FAILURE: endings.FAILURE}


def statuses_seen(tree: Tree, observed: Observations) -> tuple[int, ...]:
    """Return, for each node in the order of `Tree.walk`, the statuses that it had: a bit for each.

    Uses of a subtree are one.
    """
    seen: dict[int, int] = {}
    for index, bits in observed.seen.items():
        key = id(observed.nodes[index])
        seen[key] = seen.get(key, 0) | bits
    return tuple(seen.get(id(node), 0) for node in tree.walk())


class Coverage:
    """The coverage of one mission by its tests."""

    def __init__(self, mission: Mission) -> None:
        self._mission = mission
        self._nodes = list(mission.tree.walk())
        self._seen = [0] * len(self._nodes)
        self._ends = _possible(mission.tree)

    def add(self, seen: Sequence[int]) -> None:
        """Add what one test has seen."""
        if len(seen) == len(self._seen):
            self._seen = [before | bits for before, bits in zip(self._seen, seen, strict=True)]

    def lines(self, name: str) -> list[str]:
        """Return the counts of the mission with this name, and its tree with what never happened."""
        missing = {id(node): self._find_missing(at) for at, node in enumerate(self._nodes)}
        ran = sum(bool(bits) for bits in self._seen)
        possible = sum(len(self._outcomes(at)) for at in range(len(self._nodes)))
        happened = possible - sum(
            sum(not self._seen[at] & 1 << one for one in self._outcomes(at)) for at in range(len(self._nodes))
        )

        def label(node: Node) -> str:
            never = missing[id(node)]
            return f"{self._mission.label(node)}{f'   <- {never}' if never else ''}"

        counts = f"{name}: {ran} of {len(self._nodes)} nodes ran, {happened} of {possible} outcomes happened"
        return [counts, *outline(self._mission.tree, label).splitlines()]

    def _outcomes(self, at: int) -> list[int]:
        """Return the ways in which a node can end that count."""
        ends = self._ends.get(id(self._nodes[at]), endings.SUCCESS | endings.FAILURE)
        return [one for one, bit in _ENDS.items() if ends & bit]

    def _find_missing(self, at: int) -> str:
        seen = self._seen[at]
        if not seen:
            return "never ran"
        never = [_NAMES[one] for one in self._outcomes(at) if not seen & 1 << one]
        return f"never {' or '.join(never)}" if never else ""


def _possible(tree: Tree) -> dict[int, Ends]:
    """Return how each node can end, by its identity."""
    found: dict[int, Ends] = {}
    named: dict[str, Ends] = {}

    def ends(node: Node, children: list[Ends]) -> Ends:
        found[id(node)] = find_ends(node, children, named)
        return found[id(node)]

    for name, root in tree.subtrees:
        named[name] = fold(root, lambda node: node.children, ends)
    fold(tree.root, lambda node: node.children, ends)
    return found


def measure_coverage(tests: Iterable[tuple[MissionTest, Sequence[int]]]) -> dict[str, Coverage]:
    """Return the coverage of each mission by the name of its file; one that stands in a test has the place of the
    test.
    """
    found: dict[str, Coverage] = {}
    for test, seen in tests:
        name = test.place if test.is_inline or test.mission.syntax is None else test.mission.syntax.span.source.name
        if name not in found:
            found[name] = Coverage(test.mission)
        found[name].add(seen)
    return found
