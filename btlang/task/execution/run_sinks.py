"""Sinks of the run of a task: what the executor follows, and the recordings, whose folder has a limit."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Callable, Collection, Sequence
from contextlib import suppress

from btlang.api import Mission
from btlang.diagnostics.diagnostic import MissionError
from btlang.engine.status import FAILURE, RUNNING, SUCCESS
from btlang.printer.node_words import words_of_node
from btlang.printer.phrase import is_sentence
from btlang.recording.latest import note_latest
from btlang.recording.recorder import Recorder, recorder_in
from btlang.run.bus import INLINE
from btlang.run.events import Event, PeriodPassed, StatusesChanged
from btlang.tree.catalogue import CATALOGUE
from btlang.vocabulary.shipped import ENGLISH

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.engine.engine import Failure
    from btlang.run.events import Sink
    from btlang.run.robot_state import RobotState
    from btlang.session import Run
    from btlang.task.store.records import Task
    from btlang.vocabulary.lexicon import Lexicon


class RunWatch:
    """A sink that knows which house rules act now (`acting`), whether a command has ended since the last look
    (`take_ended`), and what the robot sensed last. `changed` is called when a rule begins or ends to act.
    """

    policy = INLINE

    def __init__(self, rules: Collection[int], commands: Collection[int], changed: Callable[[], object]) -> None:
        self._rules, self._commands, self._changed = frozenset(rules), frozenset(commands), changed
        self._watched = self._rules | self._commands
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
        for index, status in event.changes.of(self._watched):
            if index in self._commands:
                self._ended |= status in (SUCCESS, FAILURE)
            if index in self._rules:  # what a rule does may be a single command
                before = bool(self.acting)
                if status == RUNNING:
                    self.began |= index not in self.acting
                    self.acting.add(index)
                else:
                    self.acting.discard(index)
                if before != bool(self.acting):
                    self._changed()

    def take_ended(self) -> bool:
        """Return whether a command has ended since the last call."""
        ended, self._ended = self._ended, False
        return ended

    def take_began(self) -> bool:
        """Return whether a rule has begun to act since the last call."""
        began, self.began = self.began, False
        return began


def add_sinks(run: Run, *sinks: Sink) -> None:
    """Add sinks to a run that is about to begin."""
    for sink in sinks:
        run.bus.add(sink)


def indices_of(run: Run, paths: Collection[str]) -> list[int]:
    """Return the numbers of nodes at these paths."""
    wanted = set(paths)
    return [index for index, (path, _) in enumerate(run.nodes.nodes) if path in wanted] if wanted else []


def commands_of(run: Run, mission: Mission) -> list[int]:
    """Return the numbers of the nodes that do something: not those that only ask, or only lead others."""
    found = []
    for index in range(run.nodes.size):
        node = run.nodes.node(index)
        kind = CATALOGUE.get(node.id)
        if mission.is_action(node) if kind is None else kind.kind == "Action":
            found.append(index)
    return found


def reason_of(failure: Failure, vocabulary: Lexicon) -> str:
    """Return why a mission failed, in one line."""
    node, span = failure.node, failure.span
    said = span.text if span is not None and is_sentence(span) else ""
    words = said or node.name or words_of_node(node, vocabulary)
    return f"{words}: {failure.reason}"


MOST_BYTES = 1_000_000_000
"""The limit of all recordings together; the oldest go first."""
_FREE = 100_000_000  # bytes of the disk that recordings leave to others
_EACH = 200_000_000  # bytes of one, which then goes on in another file


class Recordings:
    """A recorder for each task, in `folder`; none if the package mcap isn't installed or the folder can't be written,
    which `trouble` gets once. `keywords` and `language` are the words of the robot, which are kept with each run.
    """

    def __init__(
        self,
        folder: str,
        trouble: Callable[[str], object] = lambda text: None,
        most_bytes: int = MOST_BYTES,
        keywords: Sequence[str] = (),
        language: str = ENGLISH,
    ) -> None:
        self._folder, self._trouble, self._most = folder, trouble, most_bytes
        self._keywords, self._language = tuple(keywords), language
        self.problem = ""
        """The reason why there are no recordings, "" if there are."""
        self._latest: Recorder | None = None

    def recorder(self, mission: Mission, task: Task) -> Recorder | None:
        """Make the recorder for a run of a task that begins now, until `end`. `mission` is that of the task."""
        self.make_room()
        text = task.mission
        about = {
            "task": str(task.id), "mission": text.title, "language": self._language,
            "values": json.dumps(dict(text.values), default=str),
        }  # fmt: skip
        keywords = [*self._keywords, *text.keywords]
        try:
            recorder = recorder_in(self._folder, mission, keywords, about, _EACH, note_latest)
        except MissionError as error:
            if not self.problem:
                self._trouble(str(error))
            self.problem = error.diagnostics[0].message
            return None
        self.problem, self._latest = "", recorder
        return recorder

    def end(self) -> None:
        """Close the file of a run that is over."""
        if self._latest is not None:
            self._latest.close()
            self._latest = None

    def make_room(self) -> None:
        """Remove the oldest recordings while all together are too many, or the disk is nearly full; never the one that
        goes on.
        """
        found: list[tuple[float, int, str]] = []
        with suppress(OSError):
            for entry in os.scandir(self._folder):
                if entry.name.endswith(".mcap") and not self._goes_on(entry.path):
                    status = entry.stat()
                    found.append((status.st_mtime, status.st_size, entry.path))
        total = sum(size for _, size, _ in found)
        for _, size, path in sorted(found):
            if total <= self._most - _EACH and _free(self._folder) >= _FREE:
                break
            with suppress(OSError):
                os.remove(path)
            total -= size

    def _goes_on(self, path: str) -> bool:
        latest = self._latest
        return latest is not None and os.path.abspath(path).startswith(
            os.path.splitext(os.path.abspath(latest.path))[0]
        )


def _free(folder: str) -> int:
    try:
        return shutil.disk_usage(folder).free
    except OSError:
        return _FREE
