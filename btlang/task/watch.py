"""Sinks that follow the run of a task for the executor."""

from __future__ import annotations

from collections.abc import Callable, Collection

from btlang.engine.status import FAILURE, RUNNING, SUCCESS
from btlang.run.bus import INLINE
from btlang.run.events import Event, PeriodPassed, StatusesChanged
from btlang.tree.catalogue import CATALOGUE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.api import Mission
    from btlang.run.events import Sink
    from btlang.run.outcome import Outcome
    from btlang.run.robot_state import RobotState
    from btlang.session import Run


class RunWatch:
    """A sink that knows which house rules act now (`acting`), whether a command has ended since the last look
    (`take_ended`), and what the robot sensed last. `changed` is called when a rule begins or ends to act.
    """

    policy = INLINE

    def __init__(self, rules: Collection[int], commands: Collection[int], changed: Callable[[], object]) -> None:
        self._rules, self._commands, self._changed = frozenset(rules), frozenset(commands), changed
        self.acting: set[int] = set()
        self.began = False
        """Whether a rule has begun to act since the last look."""
        self._ended = False
        self.robot: RobotState | None = None

    def __call__(self, event: Event) -> None:
        if isinstance(event, PeriodPassed):
            self.robot = event.state
            return
        if not isinstance(event, StatusesChanged):
            return
        for index, status, _, _ in event.changes:
            if index in self._commands:
                self._ended |= status in (SUCCESS, FAILURE)
            elif index in self._rules:
                before = bool(self.acting)
                if status == RUNNING:
                    self.began |= index not in self.acting
                    self.acting.add(index)
                else:
                    self.acting.discard(index)
                if before != bool(self.acting):
                    self._changed()

    def take_ended(self) -> bool:
        """Whether a command has ended since the last call."""
        ended, self._ended = self._ended, False
        return ended

    def take_began(self) -> bool:
        """Whether a rule has begun to act since the last call."""
        began, self.began = self.began, False
        return began


def add_sinks(run: Run, *sinks: Sink) -> None:
    """They hear of a run that is about to begin."""
    for sink in sinks:
        run.bus.add(sink)


def indices_of(run: Run, paths: Collection[str]) -> list[int]:
    """The numbers of nodes at these paths."""
    wanted = set(paths)
    return [index for index, (path, _) in enumerate(run.nodes.nodes) if path in wanted] if wanted else []


def commands_of(run: Run, mission: Mission) -> list[int]:
    """The numbers of the nodes that do something: not those that only ask, or only lead others."""
    found = []
    for index in range(run.nodes.size):
        node = run.nodes.node(index)
        kind = CATALOGUE.get(node.id)
        if mission.is_action(node) if kind is None else kind.kind == "Action":
            found.append(index)
    return found


def reason_of(outcome: Outcome) -> str:
    """Why a mission failed, in one line."""
    failure = outcome.failure
    assert failure is not None
    words = failure.span.text if failure.span is not None else failure.node.id
    return f"{words}: {failure.reason}"
