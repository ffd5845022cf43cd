"""What had been tried before a mission failed, gathered from its events, and the text about it for people."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import cached_property
from itertools import zip_longest

from btlang.diagnostics.diagnostic import underline
from btlang.engine.changes import reports_each_round
from btlang.engine.engine import Failure
from btlang.engine.leaves.leaf import find_raising_line
from btlang.engine.nodes.decorators import WAS_TRUE
from btlang.engine.status import FAILURE, IDLE, RUNNING, SKIPPED, SUCCESS
from btlang.run.bus import INLINE
from btlang.run.events import StatusesChanged
from btlang.run.snapshot import Shape
from btlang.support.record import Record
from btlang.text.formatting import printable
from btlang.tree.catalogue import CATALOGUE, ON_FAILURE, SUBTREE, NodeKind
from btlang.tree.node import Node

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.engine.changes import Block
    from btlang.engine.engine import Engine
    from btlang.run.events import Event

    Reason = Callable[[int, Any], str]


MOST = 10
"""The number of different failures that are kept for a node, the latest ones."""


class Attempt(Record):
    """An attempt of a node, in vain: its index, why it failed, when first, when the last two times, and how many times.

    `stopped` are the leaves that its latest failure halted, with the seconds that they had run. A recovery that was
    done and did not help has no reason.
    """

    index: int
    reason: str
    first: float
    before: float
    last: float
    times: int = 1
    stopped: tuple[tuple[int, float], ...] = ()


class Attempts(Record):
    """The attempts by the time of their latest failure; equal ones are one. `dropped` older ones are not kept."""

    kept: tuple[Attempt, ...] = ()
    dropped: int = 0


_NONE = Attempts()


def combine_attempts(parts: Iterable[Attempts]) -> Attempts:
    """Return all attempts, as far as they are kept."""
    parts = [part for part in parts if part.kept]
    if len(parts) == 1:
        return parts[0]
    if len(parts) == 2 and len(parts[0].kept) == len(parts[1].kept) == 1:  # as nearly always: the same once more
        [one], [other] = parts[0].kept, parts[1].kept
        if (one.index, one.reason) == (other.index, other.reason):
            return Attempts((_one(one, other),), parts[0].dropped + parts[1].dropped)
    found: dict[tuple[int, str], Attempt] = {}
    dropped = 0
    for part in parts:
        dropped += part.dropped
        for new in part.kept:
            old = found.pop((new.index, new.reason), None)
            found[new.index, new.reason] = new if old is None else _one(old, new)
    kept = sorted(found.values(), key=lambda attempt: attempt.last)
    dropped += sum(attempt.times for attempt in kept[:-MOST])
    return Attempts(tuple(kept[-MOST:]), dropped)


def _one(old: Attempt, new: Attempt) -> Attempt:
    """Return both attempts as one; their times may lie between each other where nodes run side by side."""
    latest, other = (new, old) if new.last >= old.last else (old, new)
    before = other.last if latest.times == 1 else max(latest.before, other.last)
    first, times = min(old.first, new.first), old.times + new.times
    return Attempt(latest.index, latest.reason, first, before, latest.last, times, latest.stopped)


class FailureHistory:
    """A sink that keeps, for the nodes of an engine, what failed below them in their present run.

    What is kept does not grow with the length of a mission: it is forgotten when a node succeeds, and handed to the
    node above when it fails or is halted.
    """

    policy = INLINE

    def __init__(self, engine: Engine) -> None:
        self.engine = engine
        self.ended = 0.0
        """The time when the mission failed."""
        self._tried: dict[int, Attempts] = {}  # below a node in its present run
        self._failed: dict[int, dict[int, Attempts]] = {}  # by node: the children whose status is FAILURE, latest last
        self._kept: set[int] = set()  # the nodes of which something is in these two
        self._since: dict[int, float] = {}  # when a running leaf began
        self._stopped: list[tuple[int, float]] = []  # leaves that were halted at one time, maybe by a failure to come
        self._stopped_at = 0.0

    @property
    def tried(self) -> Attempts:
        """Return what led to the failure of the mission, the failure itself included; nothing where it has not
        failed.
        """
        return self._failed.get(-1, {}).get(0, _NONE)

    def __call__(self, event: Event) -> None:
        if not isinstance(event, StatusesChanged):
            return
        changes, reason, t = event.changes, event.nodes.reason, event.t
        for position, (entry, following) in enumerate(zip_longest(changes.entries, changes.entries[1:])):
            if isinstance(entry, int):
                index, before, status = entry >> 6, entry >> 3 & 7, entry & 7
                self._take_change(index, status, t, reason, changes.faults.get(position))
                if status != RUNNING and self._ends_run(index, before):
                    self._forget_below(index)
            elif entry.has_running or (self._stopped and self._stopped_at == t):  # which the next failure stopped
                for index, status, _, fault in entry:
                    self._take_change(index, status, t, reason, fault)
            elif not self._is_forgotten(entry, following):
                kept, helpers, nodes = self._kept, self._helpers, entry.nodes
                if FAILURE in entry.statuses or not kept.isdisjoint(nodes) or not helpers.isdisjoint(nodes):
                    for index, status, _, fault in entry:
                        if status == FAILURE or index in kept or index in helpers:  # which grows meanwhile
                            self._take_change(index, status, t, reason, fault)

    def _is_forgotten(self, block: Block, following: int | Block | None) -> bool:
        """Return whether the next change ends the run around nodes that completed at once, and not with a failure."""
        if not isinstance(following, int):
            return False
        index, before, status = following >> 6, following >> 3 & 7, following & 7
        return status in (SUCCESS, SKIPPED) and block.is_below(index) and self._ends_run(index, before)

    def _ends_run(self, index: int, before: int) -> bool:
        """Return whether the completion of a node lets the statuses below it be forgotten."""
        return before == RUNNING or (index > 0 and reports_each_round(self.engine.node(self.engine.parent(index))))

    def _forget_below(self, index: int) -> None:
        first, end = index + 1, self._shape.ends[index]
        if end - first < len(self._kept):
            below = self._kept.intersection(range(first, end))
        else:
            below = {each for each in self._kept if first <= each < end}
        for each in below:
            self._forget(each)

    @cached_property
    def _shape(self) -> Shape:
        return Shape([self.engine.parent(index) for index in range(self.engine.size)])

    @cached_property
    def _helpers(self) -> frozenset[int]:
        """The nodes that are run to help another child of their parent."""
        indices = range(1, self.engine.size)
        return frozenset(
            index for index in indices if self._recovers(above := self.engine.parent(index)) and index != above + 1
        )

    def _forget(self, index: int) -> Attempts:
        """Forget what is kept of the earlier run of a node; return it."""
        self._kept.discard(index)
        self._failed.get(self.engine.parent(index), {}).pop(index, None)
        return self._tried.pop(index, _NONE)

    def _take_change(self, index: int, status: int, t: float, reason: Reason, fault: Any) -> None:
        above = self.engine.parent(index)
        if status == RUNNING:
            self._failed.get(above, {}).pop(index, None)
            node = self.engine.node(index)
            if not node.children and node.id != SUBTREE:
                self._since[index] = t
            return
        began, tried = self._since.pop(index, None), self._forget(index)
        if status == FAILURE:
            self._fail(index, t, reason(index, fault), tried)
        elif status == IDLE:
            if began is not None:
                if t != self._stopped_at:
                    self._stopped, self._stopped_at = [], t
                self._stopped.append((index, t - began))
            self._add(above, tried)
        elif status == SUCCESS and index in self._helpers:
            self._add(above, Attempts((Attempt(index, "", t, t, t),)))

    def _fail(self, index: int, t: float, reason: str, tried: Attempts) -> None:
        above = self.engine.parent(index)
        failed = self._failed.get(index)
        kind = self._kind(index)
        if not failed:
            attempts = combine_attempts((tried, Attempts((Attempt(index, reason, t, t, t),))))
        elif kind is not None and kind.again == ON_FAILURE:
            attempts = tried
        else:
            needs_all = kind is not None and (kind.goes_on == ON_FAILURE or kind.at_once)
            attempts = combine_attempts(failed.values()) if needs_all else next(reversed(failed.values()))
        now = self._stopped if t == self._stopped_at else []
        halted = tuple(leaf for leaf in now if leaf[0] > index)  # what is below comes later
        if halted and attempts.kept:
            *others, latest = attempts.kept
            attempts = attempts.replace(kept=(*others, latest.replace(stopped=latest.stopped + halted)))
        self._stopped.clear()
        self._failed.setdefault(above, {})[index] = attempts
        self._kept.add(index)
        parent = self._kind(above)
        if index != above + 1 or parent is None or not parent.asks_first:
            self._add(above, attempts)
        if above < 0:
            self.ended = t

    def _add(self, index: int, tried: Attempts) -> None:
        if tried.kept and index >= 0:
            self._kept.add(index)
            self._tried[index] = combine_attempts((self._tried.get(index, _NONE), tried))

    def _recovers(self, index: int) -> bool:
        """Return whether what a node does beside its first child is to help that one."""
        kind = self._kind(index)
        return kind is not None and kind.again == ON_FAILURE and kind.most > 1

    def _kind(self, index: int) -> NodeKind | None:
        return CATALOGUE.get(self.engine.node(index).id) if index >= 0 else None


_LONGEST = 60  # of the words of a sentence beside a reason


def failure_report(failure: Failure, story: FailureHistory, label: Callable[[Node], str], colour: str = "") -> str:
    """Return which sentence failed, its words underlined in a colour, at which leaf, why, and what had been tried
    before.

    `label` gives the words for a node.
    """
    return "\n".join(_one_line(line) for line in _Report(failure, story, label).lines(colour))


def failure_context(failure: Failure, story: FailureHistory, label: Callable[[Node], str]) -> list[str]:
    """Return what `failure_report` says beside the sentence and the reason: what it was part of, and had been tried."""
    return [_one_line(line) for line in _Report(failure, story, label).context()]


class _Report:
    def __init__(self, failure: Failure, story: FailureHistory, label: Callable[[Node], str]) -> None:
        self._failure = failure
        self._story = story
        self._label = label

    def lines(self, colour: str) -> Iterator[str]:
        failure, story = self._failure, self._story
        named = self._name(failure.index)
        yield f"The mission failed after {story.ended:.1f} s."
        yield f"{failure.path if failure.span is None else failure.span.place}: {self._words(failure.index)}"
        if failure.span is not None:
            yield from underline(failure.span, colour)
        denied, reason = story.engine.node(named), failure.reason
        if reason == WAS_TRUE and not denied.children:
            reason = f"'{self._words(named)}' was true"
        yield f"  {denied.id}: {reason}"
        if place := find_raising_line(failure.exception):
            yield f"  raised in {place}"
        yield from self.context()

    def context(self) -> Iterator[str]:
        last, before = self._apart(self._story.tried)
        for index, seconds in last.stopped if last is not None else ():
            yield f"  It stopped '{self._words(index)}' after {seconds:.1f} s."
        around = list(self._around())
        if around:
            yield "It was part of:"
            yield from around
        if before.kept:
            yield "What had been tried before:"
            if before.dropped:
                yield f"{'...':>9}  and {before.dropped} more before"
            yield from map(self._attempt, sorted(before.kept, key=lambda attempt: attempt.first))

    def _around(self) -> Iterator[str]:
        """Yield the nodes around the failure that add something to it, and the names that it is part of, innermost
        first.
        """
        reasons = {around.index: f": {around.reason}" for around in self._failure.around}
        engine = self._story.engine
        index = engine.parent(self._failure.index)
        while index >= 0:
            if index in reasons or (engine.node(index).id == SUBTREE and engine.node(index).span is not None):
                yield f"  {self._sentence(index)}{reasons.get(index, '')}"
            index = engine.parent(index)

    def _apart(self, tried: Attempts) -> tuple[Attempt | None, Attempts]:
        """Return the failure itself, and what came before it."""
        own = [attempt for attempt in tried.kept if attempt.index == self._failure.index]
        if not own:
            return None, tried
        last = own[-1]
        kept = [attempt for attempt in tried.kept if attempt is not last]
        if last.times > 1:
            kept.append(last.replace(times=last.times - 1, last=last.before))
        return last, Attempts(tuple(kept), tried.dropped)

    def _attempt(self, attempt: Attempt) -> str:
        reason = attempt.reason or "done, but it didn't help"
        times = f" ({attempt.times} times, last at {attempt.last:.1f} s)" if attempt.times > 1 else ""
        return f"{attempt.first:7.1f} s  {self._sentence(self._name(attempt.index))}: {reason}{times}"

    def _name(self, index: int) -> int:
        """Return the node that a reason is about: that of a `not` is about what it denies, its child."""
        kind = CATALOGUE.get(self._story.engine.node(index).id)
        return index + 1 if kind is not None and len(kind.turns) == 2 else index

    def _sentence(self, index: int) -> str:
        """Return the words of a node, cut where they are many, with their line where that is not the one of the
        failure.
        """
        words = self._words(index)
        if len(words) > _LONGEST:
            words = f"{words[: _LONGEST - 3]}..."
        span, own = self._story.engine.span(index), self._failure.span
        if span is None or own is None:
            return words
        line, _ = span.source.position(span.start)
        if span.source is not own.source:
            return f"{words} ({span.source.name}:{line})"
        return words if line == own.source.position(own.start)[0] else f"{words} (line {line})"

    def _words(self, index: int) -> str:
        """Return a command or condition in the words of the vocabulary, and as it was written what is made of
        several.
        """
        engine = self._story.engine
        node, span = engine.filled(index), engine.span(index)
        if span is None or (node.span is not None and not node.children and node.id != SUBTREE):
            return self._label(node)
        return span.text.splitlines()[0]


def _one_line(line: str) -> str:
    return printable(line).replace("\n", "\\n")
