"""Lines that were read before: what the next text of an editor shares with the last one isn't read again.

How a line is read depends on its words, on what the whole text names, on what the lines before it left behind, and on
the words and tokens beside it at which its readers looked. These are noted while it is read (`looked_at.py`), not
declared: an attribute that a reader gets is part of what lines leave behind, and a line whose reading depends on what
can't be compared is read anew each time.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator
from contextlib import contextmanager

from btlang.diagnostics.diagnostic import Diagnostic
from btlang.frontends.mission.symbols.names import Names
from btlang.frontends.mission.token import Header, Token
from btlang.frontends.mission.tokens.lines_in_use import in_use
from btlang.frontends.mission.tokens.looked_at import LookedAt, LookedUp, WordsLookedUp
from btlang.frontends.mission.tokens.reader_state import (
    NotComparableError,
    WatchedCalls,
    content_of,
    copied,
    is_constant,
    moved,
    parts_of,
    size_of,
    state_fields,
)
from btlang.frontends.mission.tokens.word_reader import WordReader
from btlang.support.record import Record
from btlang.text.words import Words
from btlang.vocabulary.match import Match
from btlang.vocabulary.reading_context import ReadingContext
from btlang.vocabulary.trie import longest

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    Key: TypeAlias = tuple[object, ...]
    Copy: TypeAlias = tuple[str, int, int, Any, str, range | None]

_MOST_WORDS, _MOST_TOKENS = 200, 40  # beside a line
_MOST_WORLDS = 3  # sets of names with which lines are kept
_FIRST = 8  # words and tokens of a text whose readers may ask how many there are before them
_MOST_STATES = 10_000
_MOST_ALIKE = 4  # lines with the same words in the same state, beside others


class LineMemo:
    """The lines of the latest texts, with which others are read in a `with memo.used():`."""

    def __init__(self) -> None:
        self._worlds: list[_World] = []
        self._tries: list[dict[Any, Any]] = []
        self.warnings: tuple[object, list[Diagnostic]] | None = None
        """Those of the latest text without the sentences in which something is wrong, with what they depend on."""

    @contextmanager
    def used(self) -> Iterator[None]:
        """Read texts with these lines, and keep theirs."""
        outer, in_use.memo = in_use.memo, self
        try:
            yield
        finally:
            in_use.memo = outer

    def world(self, given: object, kept: object, distinct: WordsLookedUp, count: int) -> _World:
        """Return the lines that were read with the same names, where the same words were missing in the text.

        It keeps about twice as many as the `count` of the text, those that were read last.
        """
        found = (each for each in self._worlds if each.given == given and distinct.agrees(each.asked))
        world = next(found, None) or _World(given, kept)
        self._worlds = [world, *(each for each in self._worlds if each is not world)][:_MOST_WORLDS]
        if len(world.lines) > count:
            world.before, world.lines = world.lines, {}
        if len(world.states) > _MOST_STATES:
            world.forget()
        return world

    def trie(self, trie: dict[Any, Any]) -> dict[Any, Any]:
        """Return the first one of equal tries of names, so that these are identical."""
        known = next((kept for kept in self._tries if _is_equal(kept, trie)), trie)
        self._tries = [known, *(kept for kept in self._tries if kept is not known)][:_MOST_WORLDS]
        return known


def _is_equal(trie: object, other: object) -> bool:
    try:
        return trie == other
    except RecursionError:  # names of a thousand words
        return False


class _World:
    """The lines that were read with the same names; `before` are those that weren't read for the longest time.

    `kept` is alive as long as identities in `given` count.
    """

    def __init__(self, given: object, kept: object) -> None:
        self.given, self.kept = given, kept
        self.asked: dict[frozenset[str], bool] = {}
        self.lines: dict[Key, list[_Line]] = {}
        self.before: dict[Key, list[_Line]] = {}
        self.states: list[tuple[Any, ...]] = []
        self._numbers: dict[object, int] = {}

    def found(self, key: Key) -> list[_Line]:
        """Return the lines with the same words, behind the same state."""
        lines = self.lines.get(key)
        if lines is None and key in self.before:
            lines = self.lines[key] = self.before[key]
        return lines or []

    def number(self, content: object, values: tuple[Any, ...]) -> int:
        """Return the number of a state, which is kept for `states`."""
        number = self._numbers.get(content)
        if number is None:
            number = self._numbers[content] = len(self.states)
            self.states.append(values)
        return number

    def forget(self) -> None:
        """Keep nothing of all this."""
        self.lines, self.before, self.states, self._numbers = {}, {}, [], {}


class _Line(Record):
    """A line that was read: what was looked at for it, the tokens that it made, and the state behind it.

    Places of words count from its first one, characters from where that begins. `words` are those from `low` to `high`
    (exclusive) and their characters, if any beside it were looked at; `before` are tokens before it. The last `cut` of
    these became others. `named` and `denied` are what the calls note with places, in a tuple; () for no change.
    """

    low: int
    high: int
    words: tuple[object, ...]
    before: list[tuple[str, int, int, Any, str]]
    cut: int
    tokens: list[Copy]
    state: int
    named: tuple[int, ...]
    denied: tuple[Match | None, ...]


def watch(text: Words, names: Names, memo: LineMemo) -> None:
    """Note from here on at what of a text readers look."""
    text.words = LookedAt(text.words)
    text._distinct = made = WordsLookedUp(text.distinct)
    made.asked = {}
    names.definitions.trie = memo.trie(names.definitions.trie)


def _signature(names: Names) -> object:
    """Return what decides how the names of a text are read; identities are those of what a memo keeps."""
    found = names.definitions
    return names.vocabulary, id(found.trie), found.subtrees, names.included, names.known


class LineReader:
    """Reads the lines of one text as a `reader` does, those that are known by what they made before."""

    def __init__(self, reader: WordReader, text: Words, names: Names, memo: LineMemo) -> None:
        self._reader, self._text, self._names, self._own = reader, text, names, vars(reader)
        own = self._own
        self._words: LookedAt = text.words  # type: ignore[assignment]
        self._plain = self._words.plain()
        self._tokens: LookedAt = own["_tokens"]
        self._problems: LookedAt = own["_problems"]
        self._distinct: WordsLookedUp = text.distinct  # type: ignore[assignment]
        self._calls: WatchedCalls = own["_calls"]
        self._calls.__class__ = WatchedCalls
        self._calls.begin()
        self._context, self._sharing = own["_context"], own["_partial"].sharing
        self._alternatives, self._said, self._same = LookedUp(), LookedUp(), LookedUp()
        vars(self._calls)["_alternatives"] = self._alternatives
        vars(own["_partial"])["_said"], self._context.same = self._said, self._same
        self._fixed = names.phrases.fixed if own["_found"] is names.phrases.fixed else {}
        parts = parts_of(reader, self._context)
        self._looking = [part for part in parts if hasattr(part, "_looked")]
        self._fields = state_fields(parts)
        self._initial = [getattr(part, name) for part, name in self._fields]
        self._sizes = [size_of(value) for value in self._initial]
        kinds = [(type(part), name) for part, name in self._fields]
        named = _signature(names), names.meanings, names.chosen, text.has_shared_places, own["_explain"]
        given = named, kinds, [content_of(value) for value in self._initial]
        self._world = memo.world(given, (names, self._initial), self._distinct, len(text.lines))
        self._distinct.asked = self._world.asked
        self._others = sorted(names.others)
        self._headers = {id(header): at for at, header in names.definitions.headers.items()}
        self._before = 0  # the first word of the line before
        self._is_real = True  # whether the readers are in the state
        self._state = self._number()

    def read_line(self, first: int, last: int, is_statement: bool, is_followed: bool) -> None:
        """Read a line; `is_statement` and `is_followed` say whether a statement begins with it, and behind it."""
        if first >= self._own["_bounds"][0]:
            self._make_real()
            self._reader.pass_bounds(first)
            self._state = self._number()
        if is_statement:
            vars(self._calls)["_lists"] = {}
        key = self._key(first, last, is_statement, is_followed)
        line = next((each for each in self._world.found(key) if self._fits(each, first)), None) if key else None
        if line is not None:
            self._replay(line, first)
        else:
            self._make_real()
            made = self._read(first, last, is_statement, is_followed)
        self._before = first
        if line is None:
            self._state = self._number()
            if made is not None and self._state is not None and key is not None:
                alike = self._world.lines.get(key, [])[: _MOST_ALIKE - 1]
                self._world.lines[key] = [made.replace(state=self._state), *alike]

    def finish(self) -> None:
        """Say what is left to say at the end of the text, whose words nobody watches any more."""
        self._make_real()
        self._text.words = self._plain
        self._text._distinct = frozenset(frozenset.__iter__(self._distinct))
        self._reader.finish()

    # -- what decides how a line is read

    def _key(self, first: int, last: int, is_statement: bool, is_followed: bool) -> Key | None:
        """Return what a line is looked up by, None where it is read anew."""
        words, text, starts = self._plain, self._text, self._text.starts
        is_near_end = first < _FIRST or len(self._tokens) < _FIRST or last + 2 >= len(words)
        if self._state is None or is_near_end or self._own["_bounds"][0] < last:
            return None
        others = self._others_in(first, last)
        if others is None:
            return None
        near = (
            tuple([at - first for at in range(first, last) if at in self._fixed]),
            tuple([at - first for at in range(first, last + 2) if at in text.going_on]) if text.going_on else (),
            tuple(sorted(at - first for at in self._sharing if at >= first)) if self._sharing else (),
            tuple(sorted(at - first for at in dict.__iter__(self._same) if at >= first)) if self._same else (),
            tuple(sorted(dict.__iter__(self._alternatives))) if self._alternatives else (),
        )
        base = starts[first]
        return (
            self._state, is_statement, is_followed, tuple(words[first - 1 : last + 2]),
            text.source.text[starts[first - 1] : starts[last] + 1], tuple([at - base for at in starts[first:last]]),
            others, near,
        )  # fmt: skip

    def _others_in(self, first: int, last: int) -> Key | None:
        """Return what begins in a line that is no phrase, None for statements about values."""
        found: Key = ()
        at, headers, ends = bisect_left(self._others, first), self._names.definitions.headers, self._names.ends
        while at < len(self._others) and (place := self._others[at]) < last:
            if place in self._names.prefixes:
                return None
            header = headers.get(place) if place not in ends else None
            end = ends[place] if header is None else header.body
            of = () if header is None else (header.name, header.parameters, header.is_quoted)
            found += ((place - first, end - first, *of),)
            at += 1
        return found

    def _beside(self, low: int, high: int) -> tuple[object, ...]:
        return (*self._plain[low:high], self._text.source.text[self._text.starts[low] : self._text.starts[high]])

    def _fits(self, line: _Line, first: int) -> bool:
        """Whether what was looked at for a line is the same at another place."""
        base, begin = self._text.starts[first], len(self._tokens) - len(line.before)
        if begin < 1 or (line.cut and (self._calls.has_lists or self._alternatives or self._said)):
            return False
        tokens = list.__getitem__(self._tokens, slice(begin, None))
        for token, (kind, start, end, value, role) in zip(tokens, line.before, strict=True):
            if token.kind != kind or token.role != role or token.start - base != start or token.end - base != end:
                return False
            if (token.value is not value and token.value != value) or dict.__contains__(self._said, token.start):
                return False
        low, high = first + line.low, first + line.high
        return not line.words or (low > 0 and high < len(self._plain) and self._beside(low, high) == line.words)

    # -- lines that are known

    def _replay(self, line: _Line, first: int) -> None:
        tokens, base, headers = self._tokens, self._text.starts[first], self._names.definitions.headers
        if line.cut:
            list.__delitem__(tokens, slice(len(tokens) - line.cut, None))
        for kind, start, end, value, role, words in line.tokens:
            made = Token(kind, base + start, base + end, headers[first + value] if type(value) is int else value, role)
            if words is not None:
                made.words = range(words.start + first, words.stop + first)
            tokens.append(made)
        own = vars(self._calls)
        if line.named:
            own["_named_at"] = line.named[0] and first + line.named[0]
        if line.denied:
            own["_denied"] = moved(line.denied[0], first)
        self._state, self._is_real = line.state, False

    def _make_real(self) -> None:
        """Bring the readers into the state that the lines so far have left behind."""
        if self._is_real or self._state is None:
            return
        self._is_real = True
        *values, reached = self._world.states[self._state]
        for (part, name), value, initial in zip(self._fields, values, self._initial, strict=True):
            if value is not None:
                setattr(part, name, copied(value[0]))
            elif getattr(part, name) is not initial:
                setattr(part, name, initial)
        self._context.set_known(self._context.known or {})
        self._context.reached = [(at + self._before, kind, name) for at, kind, name in reached]

    def _number(self) -> int | None:
        """Return the number of the state that the readers are in, None if it can't be compared."""
        values = [
            None if (value := getattr(part, name)) is initial and is_constant(value, size) else (value,)
            for (part, name), initial, size in zip(self._fields, self._initial, self._sizes, strict=True)
        ]
        try:
            contents = tuple([each and content_of(each) for each in values])
        except NotComparableError:
            return None
        reached = tuple([(at - self._before, *of) for at, *of in self._context.reached if at >= self._before])
        return self._world.number((contents, reached), (*map(copied, values), reached))

    # -- lines that are not

    def _read(self, first: int, last: int, is_statement: bool, is_followed: bool) -> _Line | None:
        """Read a line. Return it if it may be kept."""
        text, tokens, problems, own = self._text, self._tokens, self._problems, vars(self._calls)
        text.memo.clear()
        for part in self._looking:
            vars(part).pop("_looked", None)
        count, told, assumed, base = len(tokens), len(problems), len(text.assumed), text.starts[first]
        saved = [
            (token, (token.kind, token.start - base, token.end - base, token.value, token.role))
            for token in list.__getitem__(tokens, slice(max(count - _MOST_TOKENS, 0), None))
        ]
        going_on, sharing = set(text.going_on), set(self._sharing)
        watched = self._alternatives, self._said, self._same
        for each in (self._words, tokens, problems, self._calls):
            each.begin()
        for used in watched:
            used.is_used = False
        self._distinct.is_read = False
        for at in range(first, last):
            if at in self._fixed:  # what was looked at for it
                longest(self._names.vocabulary.trie, text, at, ReadingContext(self._names.vocabulary.values))
        self._reader.read_line(first, last, is_statement, is_followed)
        is_used = self._calls.is_used or any(used.is_used for used in watched) or self._distinct.is_read
        if is_followed:
            own["_lists"] = {}
        cut = count - min(tokens.cut, count)
        back = count - min(tokens.low, tokens.cut, count)
        if is_used or own["_lists"]:
            return None
        if len(problems) != told or problems.high >= 0 or len(text.assumed) != assumed:
            return None
        if text.going_on != going_on or self._sharing != sharing or back > len(saved) or count - back < 1:
            return None
        before = saved[len(saved) - back :]
        for token, (kind, start, end, value, role) in before[: back - cut]:
            now = token.kind, token.start - base, token.end - base, token.role
            if now != (kind, start, end, role) or token.value is not value:
                return None
        low, high = min(self._words.low, first - 1), max(self._words.high + 1, last + 2)
        if low < 1 or high >= len(self._plain) or high - low > last - first + _MOST_WORDS:
            return None
        is_beside = low < first - 1 or high > last + 2
        made = [self._copy(token, base, first) for token in list.__getitem__(tokens, slice(count - cut, None))]
        named = (own["_named_at"] and own["_named_at"] - first,) if self._calls.has_named else ()
        denied = (moved(own["_denied"], -first),) if self._calls.has_denied else ()
        return _Line(
            low - first, high - first, self._beside(low, high) if is_beside else (), [of for _, of in before], cut,
            made, 0, named, denied,
        )  # fmt: skip

    def _copy(self, token: Token, base: int, first: int) -> Copy:
        words = token.words
        value = self._headers[id(token.value)] - first if isinstance(token.value, Header) else token.value
        places = None if words is None else range(words.start - first, words.stop - first)
        return token.kind, token.start - base, token.end - base, value, token.role, places
