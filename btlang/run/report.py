"""Why a mission failed, as text for people."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from btlang.diagnostics.render import underlined
from btlang.engine.engine import Failure
from btlang.engine.leaves.leaf import raised_in
from btlang.engine.nodes.decorators import WAS_TRUE
from btlang.run.failure_history import Attempt, Attempts, FailureHistory
from btlang.text.escaping import printable
from btlang.tree.catalogue import CATALOGUE, SUBTREE
from btlang.tree.node import Node

_LONGEST = 60  # of the words of a sentence beside a reason


def failure_report(failure: Failure, story: FailureHistory, label: Callable[[Node], str], colour: str = "") -> str:
    """Which sentence failed, its words underlined in a colour, at which leaf, why, and what had been tried before.

    `label` gives the words for a node.
    """
    return "\n".join(_one_line(line) for line in _Report(failure, story, label).lines(colour))


class _Report:
    def __init__(self, failure: Failure, story: FailureHistory, label: Callable[[Node], str]) -> None:
        self._failure = failure
        self._story = story
        self._label = label

    def lines(self, colour: str) -> Iterator[str]:
        failure, story = self._failure, self._story
        named = self._named(failure.index)
        last, before = self._apart(story.tried)
        yield f"The mission failed after {story.ended:.1f} s."
        yield f"{failure.path if failure.span is None else failure.span.place}: {self._words(failure.index)}"
        if failure.span is not None:
            yield from underlined(failure.span, colour)
        denied, reason = story.engine.node(named), failure.reason
        if reason == WAS_TRUE and not denied.children:
            reason = f"'{self._words(named)}' was true"
        yield f"  {denied.id}: {reason}"
        if place := raised_in(failure.exception):
            yield f"  raised in {place}"
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
        """The nodes around the failure that add something to it, and the names that it is part of, innermost first."""
        reasons = {around.index: f": {around.reason}" for around in self._failure.around}
        engine = self._story.engine
        index = engine.parent(self._failure.index)
        while index >= 0:
            if index in reasons or (engine.node(index).id == SUBTREE and engine.node(index).span is not None):
                yield f"  {self._sentence(index)}{reasons.get(index, '')}"
            index = engine.parent(index)

    def _apart(self, tried: Attempts) -> tuple[Attempt | None, Attempts]:
        """The failure itself, and what came before it."""
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
        return f"{attempt.first:7.1f} s  {self._sentence(self._named(attempt.index))}: {reason}{times}"

    def _named(self, index: int) -> int:
        """The node that a reason is about: that of a `not` is about what it denies, its child."""
        kind = CATALOGUE.get(self._story.engine.node(index).id)
        return index + 1 if kind is not None and len(kind.turns) == 2 else index

    def _sentence(self, index: int) -> str:
        """The words of a node, cut where they are many, with their line where that is not the one of the failure."""
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
        """A command or condition in the words of the vocabulary, and as it was written what is made of several."""
        engine = self._story.engine
        node, span = engine.filled(index), engine.span(index)
        if span is None or (node.span is not None and not node.children and node.id != SUBTREE):
            return self._label(node)
        return span.text.splitlines()[0]


def _one_line(line: str) -> str:
    return printable(line).replace("\n", "\\n")
