"""The lines of a test, by the words that they begin with."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic
from btlang.support.record import Record
from btlang.text.source import Span
from btlang.text.words import END_OF_STATEMENT, Line, Words
from btlang.vocabulary.lexicon import Lexicon

OPENERS = {
    "in": 'in the world "museum.toml" with the battery at 25%',
    "on": 'on the robot "guide.toml"',
    "under": 'under the rules "house_rules.txt"',
    "with": "with the battery at 25%",
    "run": 'run "patrol.txt" for 2 minutes',
    "then": "then within 10 s the robot is charging",
    "after": "after 30 s the battery drops to 15%",
    "when": "when it has reached the lab, the scanner falls silent",
    "within": "within 2 minutes the robot is charging",
    "for": "for 10 s it stands still",
    "before": 'before the robot is charging, it has said "I am tired"',
    "always": "always the battery is above 10%",
    "never": "never it has bumped",
    "finally": "finally the mission succeeds",
}
"""The words that a line may begin with, and an example of each."""
_QUOTE = '"'
_FILES = {("in", "world"), ("on", "robot"), ("under", "rules")}


class ScriptStatement(Record):
    """A line without the words that say what it is. Words are given by their numbers: `first` to `last` (exclusive).

    `seconds` are those of `within`, `for` and `after`, and the time of `run`, the longest one if `at_most`; `file` of
    `world`, `robot`, `rules` and `run` is the path in quotes, `block` the mission below `run:`. The words from `head`
    on to the comma before `first` are a condition.
    """

    kind: str
    span: Span
    first: int
    last: int
    seconds: float | None = None
    file: Span | None = None
    block: Span | None = None
    head: int = -1
    at_most: bool = False


def statements_of(
    text: Words, lines: Sequence[Line], vocabulary: Lexicon, problems: list[Diagnostic]
) -> Iterator[ScriptStatement]:
    """Yield the statements of the lines of a test; what is none is added to the problems."""
    waiting = list(reversed(lines))
    while waiting:
        line = waiting.pop()
        first = line.first
        for end in [*(at for at in range(line.first, line.last) if text.words[at] == END_OF_STATEMENT), line.last]:
            try:
                if end > first:
                    yield from _read(text, first, end, vocabulary)
            except MissionError as error:
                problems += error.diagnostics
            first = end + 1
        if text.words[line.first : line.last] == ["run", ":"]:
            block = []
            while waiting and waiting[-1].indent > line.indent:
                block.append(waiting.pop())
            span = text.span(line.first, line.last)
            inner = text.span(block[0].first, block[-1].last) if block else None
            yield ScriptStatement("run", span, line.last, line.last, block=inner)


def _read(text: Words, first: int, last: int, vocabulary: Lexicon) -> Iterator[ScriptStatement]:
    words, begin = text.words, first
    while words[first] in ("then", "and", ",") and first + 1 < last:
        first += 1
    word, span = words[first], text.span(begin, last)
    named = words[first + 1] if (word, words[first + 1]) in _FILES and words[first + 2][0] == _QUOTE else ""
    if named:
        yield ScriptStatement(named, span, first + 3, first + 3, file=text.span(first + 2, first + 3))
        at = first + 3 + (words[first + 3] == ",")
        if at < last:
            yield from _read(text, at, last, vocabulary)
        return
    if word == "run":
        if words[first + 1] == ":":
            return  # its block follows
        yield _run(text, first, last, vocabulary)
        return
    if word in ("within", "for", "after"):
        found = vocabulary.values.quantity(text, first + 1, ("duration",))
        if found is None or found[1] != "duration" or found[2] >= last:
            raise _unread(span, word)
        at = found[2] + (words[found[2]] == ",")
        yield ScriptStatement(word, span, at, last, found[0])
        return
    if word in ("when", "once", "before"):
        comma = next((at for at in range(first + 1, last) if words[at] == ","), -1)
        if comma < 0:
            raise _unread(span, word if word in OPENERS else "when")
        yield ScriptStatement("before" if word == "before" else "when", span, comma + 1, last, head=first + 1)
        return
    if word in ("with", "always", "never", "finally"):
        first += 1 + (words[first + 1] == ",")
        if first >= last:
            raise _unread(span, word)
        yield ScriptStatement(word, span, first, last)
        return
    yield ScriptStatement("fake" if word[0] == _QUOTE else "now", span, first, last)


def _run(text: Words, first: int, last: int, vocabulary: Lexicon) -> ScriptStatement:
    """Read `run "patrol.txt"`, `for 2 minutes` or `for at most 2 minutes`."""
    words, span = text.words, text.span(first, last)
    seconds, at = None, first + 2
    at_most = words[at : at + 3] == ["for", "at", "most"]
    if at < last and words[at] == "for":
        found = vocabulary.values.quantity(text, at + 1 + 2 * at_most, ("duration",))
        if found is not None and found[1] == "duration":
            seconds, at = found[0], found[2]
    if words[first + 1][0] != _QUOTE or at != last:
        raise _unread(span, "run")
    return ScriptStatement("run", span, last, last, seconds, text.span(first + 1, first + 2), at_most=at_most)


def _unread(span: Span, opener: str) -> MissionError:
    return MissionError([diagnostic("BT180", span, words=span.text, wanted=OPENERS[opener])])
