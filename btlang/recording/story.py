"""Describes a recorded run in words: what was done, what failed and what had been tried, and who stopped it."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from operator import itemgetter

from btlang.api import Mission
from btlang.engine.engine import Failure
from btlang.engine.status import FAILURE, IDLE, NAMES, RUNNING, SKIPPED, SUCCESS
from btlang.engine.status_trace import is_rule
from btlang.recording.reader import RecordedNodes, open_recording
from btlang.run.events import Chosen, Ended, Event, FaultInjected, InTheWorld, Notice, PartChanged, StatusesChanged
from btlang.run.failure_history import FailureHistory, failure_context, failure_report
from btlang.run.logs import is_asked_wait
from btlang.text.formatting import one_line
from btlang.tree.catalogue import CATALOGUE, ON_FAILURE
from btlang.tree.node import Node, Tree
from btlang.tree.visit import children_first

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

NO_REASON = ("", "it is not true")
"""The reasons of a condition that say no more than that it's false."""
_ENDINGS = {NAMES[FAILURE]: "failed", NAMES[IDLE]: "was halted", NAMES[SKIPPED]: "was skipped"}


class _Triggered:
    """A rule whose condition became true: what was measured, and the commands that it halted."""

    def __init__(self, t: float, index: int, words: str, measured: list[str]) -> None:
        self.t, self.index, self.words, self.measured = t, index, words, measured
        self.halted: list[str] = []

    def line(self) -> tuple[float, str, str]:
        """Return it as a line of a story: when, what, and what else to write."""
        measured = f" ({', '.join(self.measured)})" if self.measured else ""
        named = " and ".join(f"'{words}'" for words in self.halted)
        halted = f", so it halted {named}" if named else ""
        return self.t, f"{self.words}: true", measured + halted


class Story:
    """A story of a run: it follows the events, and `lines` describes it; `label` gives the words for a node."""

    def __init__(
        self,
        mission: Mission,
        nodes: RecordedNodes,
        about: Mapping[str, str],
        label: Callable[[Node], str] | None = None,
    ) -> None:
        self._mission, self._nodes, self._about = mission, nodes, about
        self._label = label or mission.label
        self._history = FailureHistory(nodes)  # type: ignore[arg-type]  # which asks for nodes and parents only
        self._began: dict[int, tuple[float, Node]] = {}
        self.notes: list[tuple[float, int, str, str, str]] = []
        """The things that were done: when each began, the number of the node (-1: none), and the words; of a node how
        it ended, and why."""
        # conditions that were false, and choices that found nothing: when, what, and why
        self._answers: list[tuple[float, str, str]] = []
        self._rules: list[_Triggered] = []
        self._measured: dict[int, tuple[float, str]] = {}  # by condition of a rule: when it became true, and how much
        self._ended: Ended | None = None
        self._latest = 0.0

    def take(self, events: Iterable[Event]) -> Story:
        """Take in all that happened."""
        for event in events:
            self._latest = max(self._latest, event.t)
            self._history(event)
            if isinstance(event, StatusesChanged):
                for change in event:
                    self._follow_rules(change.index, change.status, change.t, change.reason)
                    node = event.valued.get(change.index, change.node)
                    if self._is_said(node) or is_asked_wait(change.node):
                        self._take_change(change.index, change.status, change.t, node, change.reason)
                    elif change.status == FAILURE and self._is_question(node) and not self._is_watched(change.index):
                        reason = "" if change.reason in NO_REASON else f" ({change.reason})"
                        answer = "false" if self._mission.is_question(node) else "failed"
                        self._answers.append((change.t, f"{self._label(node)}: {answer}", reason))
            elif isinstance(event, Chosen):
                self._note(event.t, -1, f"It chooses {event.name}, the {event.how} {event.type}.")
            elif isinstance(event, FaultInjected | Notice | PartChanged) and event.text:
                self._note(event.t, -1, f"{event.tag}: {event.text}")
            elif isinstance(event, InTheWorld):
                self._note(event.t, -1, event.words)
            elif isinstance(event, Ended):
                self._ended = event
        return self

    def lines(self) -> Iterator[str]:
        """Yield the story, from the beginning."""
        about = self._about
        when = time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(float(about.get("wall", 0))))
        name = about.get("mission") or (f"Task {about['task']}" if "task" in about else "A mission")
        robot = about.get("robot", "simulated")
        on = (
            "" if "task" in about else ", on the simulated robot" if robot == "simulated" else f", on the robot {robot}"
        )
        yield one_line(f"{name}, {when}{on}:")
        done = ((t, text, "") for t, text in self._noted())
        yield from fold_lines(
            [*self._answers, *(rule.line() for rule in self._rules), *done]
        )  # an answer comes before what it begins
        yield from self.ending()

    def body(self) -> Iterator[str]:
        """Yield what was done, without the first line, each time that it was done."""
        yield from (format_line(t, text) for t, text in sorted(self._noted(), key=itemgetter(0)))
        yield from self.ending()

    def _noted(self) -> list[tuple[float, str]]:
        unfinished = [
            (began, f"{self._label(node)}: still under way as the recording ends")
            for began, node in self._began.values()
        ]
        done = [
            (t, words + (f": {_ENDINGS[ending]}" if ending in _ENDINGS else "") + (f" ({reason})" if reason else ""))
            for t, _, words, ending, reason in self.notes
        ]
        return done + unfinished  # a command is noted when it ends

    def ending(self) -> Iterator[str]:
        """Yield how it ended, and why."""
        ended = self._ended
        if ended is None:
            yield f"The recording ends after {self._latest:.1f} s. The mission goes on, or was cut off there."
            return
        who = {"interrupted": "It was interrupted", "emergency stop": "An emergency stop ended it"}
        if ended.stopped:
            yield f"{who.get(ended.stopped, f'It was stopped ({ended.stopped})')} after {ended.seconds:.1f} s."
        elif ended.outcome == NAMES[FAILURE]:
            yield failure_report(self._failure(ended), self._history, self._label)
        else:
            skipped = ended.outcome == NAMES[SKIPPED]
            yield f"{'There was nothing to do' if skipped else 'The mission succeeded'} after {ended.seconds:.1f} s."
        if ended.still is not True and ended.motion:
            yield one_line(f"{ended.motion}.")

    def ending_data(self) -> dict[str, Any]:
        """Return the same for a page, which has words of its own for it.

        `outcome` ("" where the recording ends before the mission did), who `stopped` it, `seconds`, and `motion` where
        the robot isn't known to stand still; of a failure the `words`, the `reason`, and the `context`, in lines.
        """
        ended = self._ended
        data: dict[str, Any] = {"outcome": "", "stopped": "", "seconds": round(self._latest, 1), "motion": ""}
        data |= {"words": "", "reason": "", "context": []}
        if ended is None:
            return data
        data |= {"outcome": ended.outcome, "stopped": ended.stopped, "seconds": round(ended.seconds, 1)}
        data["motion"] = one_line(ended.motion) if ended.still is not True else ""
        if self.failed >= 0:
            failure = self._failure(ended)
            context = failure_context(failure, self._history, self._label)
            words = self._label(self._nodes.node(failure.index))
            data |= {"words": one_line(words), "reason": one_line(failure.reason), "context": context}
        return data

    @property
    def failed(self) -> int:
        """The number of the node whose failure ended it, -1 where none did."""
        ended = self._ended
        failed = ended is not None and not ended.stopped and ended.outcome == NAMES[FAILURE]
        return self._failure(ended).index if ended is not None and failed else -1

    def _failure(self, ended: Ended) -> Failure:
        index = next(at for at in range(self._nodes.size) if self._nodes.path(at) == ended.path)
        return Failure(index, self._nodes.node(index), ended.path, ended.reason, None, self._nodes.span(index))

    def _follow_rules(self, index: int, status: int, t: float, reason: str) -> None:
        """Note the conditions of rules that become true, and the commands that are halted for their reactions."""
        if status == SUCCESS:
            if reason:
                self._measured[index] = t, reason
            above = self._nodes.parent(index)
            if index == above + 1 and above >= 0 and is_rule(self._nodes.node(above)):
                node, span = self._nodes.node(index), self._nodes.span(index)
                words = self._label(node) if not node.children or span is None else span.text.splitlines()[0]
                below = range(index, index + sum(1 for _ in Tree(node).walk()))
                told = [text for at, (when, text) in self._measured.items() if when == t and at in below]
                self._rules.append(_Triggered(t, above, words, told))
        elif status == IDLE and index in self._began and self._rules:
            rule, node = self._rules[-1], self._nodes.node(index)
            if rule.t == t and self._is_said(node) and self._is_below(index, rule.index):
                rule.halted.append(self._label(self._began[index][1]))

    def _is_below(self, index: int, above: int) -> bool:
        while index > above:
            index = self._nodes.parent(index)
        return index == above

    def _is_said(self, node: Node) -> bool:
        """Return whether it is a command that somebody has said."""
        entry = self._mission.vocabulary.entry(node.id)
        return entry is not None and entry.sort == "action" and bool(entry.phrases)

    def _take_change(self, index: int, status: int, t: float, node: Node, reason: str) -> None:
        if status == RUNNING:
            self._began[index] = t, node
            return
        self._note(self._began.pop(index, (t, node))[0], index, self._label(node), NAMES[status], reason)

    def _note(self, t: float, index: int, text: str, ending: str = "", reason: str = "") -> None:
        self.notes.append((t, index, one_line(text), ending, one_line(reason)))

    def _is_question(self, node: Node) -> bool:
        """Return whether it is a condition, or chooses what a command is about."""
        entry = self._mission.vocabulary.entry(node.id)
        is_choice = entry is not None and entry.sort == "action" and not entry.phrases
        return not node.children and (is_choice or self._mission.is_question(node))

    def _is_watched(self, index: int) -> bool:
        """Return whether something waits until the node succeeds, so that its failure says nothing."""
        while (above := self._nodes.parent(index)) >= 0:
            kind = CATALOGUE.get(self._nodes.node(above).id)
            if kind is not None and index == above + 1:
                if kind.reactive and kind.asks_first:
                    return True
                if kind.again == ON_FAILURE and kind.is_endless(self._nodes.node(above).ports):
                    below = children_first(self._nodes.node(above))
                    return all(leaf.children or self._is_question(leaf) for leaf in below)
            index = above
        return False


_MOST_FOLDED = 8  # lines that are one round
_LEAST_ROUNDS = 3


def fold_lines(noted: Iterable[tuple[float, str, str]]) -> Iterator[str]:
    """Yield lines by their time: when, what, and what else to write.

    Rounds of the same lines, whatever else they say, are written once, with how often they came.
    """
    noted = sorted(noted, key=itemgetter(0))
    texts = [text for _, text, _ in noted]
    at = 0
    while at < len(noted):
        counted = ((length, _count_rounds(texts, at, length)) for length in range(1, _MOST_FOLDED + 1))
        folded = [(length, rounds) for length, rounds in counted if rounds >= _LEAST_ROUNDS]
        length, rounds = max(folded, key=lambda found: (found[0] * found[1], -found[0]), default=(1, 1))
        yield from (format_line(t, text + more) for t, text, more in noted[at : at + length])
        at += length * rounds
        if rounds > 1:
            what = "this" if length == 1 else f"these {length} lines"
            yield f"{'...':>10}  {what} {rounds} times, last at {noted[at - length][0]:.1f} s"


def _count_rounds(texts: Sequence[str], at: int, length: int) -> int:
    """Return how many times in a row the lines from one on come."""
    block, rounds = texts[at : at + length], 1
    while texts[at + rounds * length : at + (rounds + 1) * length] == block:
        rounds += 1
    return rounds


def format_line(t: float, text: str) -> str:
    """Return a line of a story."""
    return one_line(f"{t:8.1f} s  {text}")


def explain_recording(path: str) -> str:
    """Return what happened in a recorded run, in lines. Raises MissionError if the file isn't a recording."""
    with open_recording(path) as (recording, mission, nodes):
        return "\n".join(Story(mission, nodes, recording.about).take(recording.events(nodes)).lines())
