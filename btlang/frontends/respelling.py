"""Better corrections of what could not be read: other spellings of a word are tried, the first that helps is proposed.

Tried is the statement in which a problem is, with the statements beside it and those that give names. All tries
together read a limited number of words, so that a text full of mistakes takes hardly longer than before.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections import Counter
from collections.abc import Iterable, Iterator
from functools import lru_cache
from itertools import chain, islice

from btlang.diagnostics.diagnostic import Diagnostic
from btlang.frontends.heads import find_heads
from btlang.frontends.lexer import Lexer
from btlang.frontends.matching import Matcher
from btlang.frontends.unknown import nearest_known
from btlang.record import Record
from btlang.text.source import Source, Span
from btlang.text.spelling import respellings
from btlang.vocabulary.trie import SLOTS, TrieNode
from btlang.vocabulary.values import END
from btlang.vocabulary.vocabulary import NO_PHRASES, Vocabulary

_MOST_WORDS = 10_000  # that all tries for a text read
_LEAST_COST = 50  # what a try costs at least, in words
_LONG_STATEMENT = 100  # words from which on each takes longer to read
_MOST_TRIES = 40  # for one problem
_LONGEST = 40  # letters of a word that is respelt
_MOST_SUSPECTS = 40  # words that may be misspelt, for one problem
_NEAR_WORDS = 12  # of a problem, that a name may have been meant to have
_MAY_BE_A_WORD = frozenset(f"BT0{number}" for number in (10, 11, 12, 13, 19, 21, 26, 28, 29, 39))
_UNKNOWN = frozenset(("BT010", "BT013"))

Change = tuple[int, int, str]


class _Statement(Record):
    """Characters of a statement at the margin with its block, and its words `first` to `last` (exclusive)."""

    start: int
    end: int
    first: int
    last: int


class _Trial(Record):
    """Statements to read with a change in one of them, `own` is that of the problem; what is wrong there without."""

    own: _Statement
    statements: tuple[_Statement, ...]
    faults: tuple[int, ...]
    cost: int


def with_respellings(lexer: Lexer, problems: list[Diagnostic]) -> list[Diagnostic]:
    """The problems of a text, with a better fix where another spelling of one word makes its statement sound."""
    if not lexer.text.lines:
        return problems
    return _Respelling(lexer, problems).improved()


class _Respelling:
    def __init__(self, lexer: Lexer, problems: list[Diagnostic]) -> None:
        self._lexer, self._text, self._source = lexer, lexer.text, lexer.text.source
        self._vocabulary = lexer.vocabulary
        self._problems = problems
        self._budget = _MOST_WORDS
        self._respelt: dict[str, list[str]] = {}
        self._trials: dict[int, _Trial] = {}
        self._statements = list(self._split())
        self._starts = [statement.start for statement in self._statements]
        known, names = _words_of(self._vocabulary), list(self._names(lexer))
        self._naming = {self._at(self._text.starts[words[0]]) for words in names}
        self._strange = [word for words in names for word in words if self._text.words[word] not in known]
        self._known = known | {self._text.words[word] for words in names for word in words}
        self._written = Counter(self._text.words) if self._strange else Counter()

    def improved(self) -> list[Diagnostic]:
        """Each problem once, in the order given."""
        found = []
        for problem in self._problems:
            change = self._cure(problem) if problem.is_error and self._budget > 0 else None
            found.append(problem if change is None else _with_fix(problem, change))
        return found

    # -- statements

    def _split(self) -> Iterator[_Statement]:
        lines = self._text.lines
        margin = lines[0].indent
        first = 0
        for number in range(1, len(lines) + 1):
            if number == len(lines) or lines[number].indent <= margin:
                end = len(self._source.text) if number == len(lines) else self._line_start(lines[number].first)
                yield _Statement(self._line_start(lines[first].first), end, lines[first].first, lines[number - 1].last)
                first = number

    def _line_start(self, word: int) -> int:
        return self._source.text.rfind("\n", 0, self._text.starts[word]) + 1

    def _at(self, character: int) -> int:
        """The number of the statement in which a character is."""
        return max(bisect_right(self._starts, character) - 1, 0)

    def _names(self, lexer: Lexer) -> Iterator[list[int]]:
        """The words of each place at which the text gives a name."""
        words = self._text.words
        named: list[tuple[int, int, tuple[str, ...] | None]]
        named = [(at, header.body - 1, None) for at, header in lexer.names.definitions.headers.items()]
        heads = find_heads(self._text, self._vocabulary).items()
        named += [(at, head.last, head.words) for at, head in heads if head.role not in ("increase", "decrease")]
        for fact in lexer.names.facts:
            first = bisect_left(self._text.starts, fact.span.start)
            named.append((first, bisect_left(self._text.starts, fact.span.end), tuple(fact.name.split())))
        for first, last, own in named:
            found = [at for at in range(first, last) if words[at][0].isalpha() and (own is None or words[at] in own)]
            if found:
                yield found

    # -- tries

    def _cure(self, problem: Diagnostic) -> Change | None:
        """The first change that leaves less wrong in the statement, where it is better than the fix that there is."""
        fix = problem.fix
        self._budget -= _LEAST_COST
        trial = self._trial(problem) if fix is None or _changes_words(*fix) else None
        if trial is None:
            return None
        suspects = self._suspects(problem, trial.own)
        before = [] if fix is None else [(fix[0].start, fix[0].end, fix[1])]
        strangers = (w for w in suspects if self._text.words[w] not in self._known and len(self._text.words[w]) > 1)
        others = (w for w in suspects if problem.code in _MAY_BE_A_WORD and self._is_doubtful(w, problem.span))
        changes = chain(
            self._changes_of_names(suspects),
            self._changes(strangers),
            before,
            self._changes(others, _without_meaning(self._vocabulary)),
        )
        for change in islice(changes, _MOST_TRIES):
            if trial.cost > self._budget:
                return None
            self._budget -= trial.cost
            if self._helps(change, trial, problem.span):
                is_same = before and self._with(change).lower() == self._with(before[0]).lower()
                return None if is_same else change
        return None

    def _with(self, change: Change) -> str:
        start, end, words = change
        return self._source.text[:start] + words + self._source.text[end:]

    def _trial(self, problem: Diagnostic) -> _Trial | None:
        """None where the text is too long."""
        number = self._at(problem.span.start)
        if number in self._trials:
            return self._trials[number]
        around = sorted({*self._naming, number - 1, number, number + 1} & set(range(len(self._statements))))
        statements = tuple(self._statements[n] for n in around)
        lengths = [statement.last - statement.first for statement in statements]
        cost = max(sum(lengths) * (1 + max(lengths) // _LONG_STATEMENT), _LEAST_COST)
        if 2 * cost > self._budget:
            self._budget -= max(len(around), _LEAST_COST)
            return None
        self._budget -= cost
        trial = _Trial(self._statements[number], statements, (), cost)
        self._trials[number] = _Trial(trial.own, statements, self._faults(trial, None), cost)
        return self._trials[number]

    def _suspects(self, problem: Diagnostic, statement: _Statement) -> list[int]:
        """The words of the line of a problem, the nearest to its words first, then those of the statement."""
        text = self._text
        first, last = problem.span.start, problem.span.end
        line = self._source.position(first)[0]

        def far(word: int) -> tuple[bool, int, int]:
            start, end = text.starts[word], text.ends[word]
            return self._source.position(start)[0] != line, max(first - end, start - last, 0), word

        return sorted((w for w in range(statement.first, statement.last) if text.words[w][0].isalpha()), key=far)[
            :_MOST_SUSPECTS
        ]

    def _is_doubtful(self, word: int, problem: Span) -> bool:
        """Whether a word that is known may be a slip all the same: `ten` for `then`."""
        beside = self._text.starts[word] - 1 <= problem.end and problem.start <= self._text.ends[word] + 1
        return beside and len(self._text.words[word]) > 2 and self._text.words[word] in self._known

    def _changes_of_names(self, suspects: list[int]) -> Iterator[Change]:
        """Words of names that nothing else explains, as the problem has them where that is how they mostly stand."""
        articles = self._vocabulary.articles
        near = articles.union(self._text.words[word] for word in suspects[:_NEAR_WORDS])
        for word in self._strange:
            written = self._text.words[word]
            for other in respellings(written, near) if len(written) <= _LONGEST else ():
                if other in articles or self._written[other] > self._written[written]:
                    yield self._text.starts[word], self._text.ends[word], other

    def _changes(self, words: Iterable[int], never: frozenset[str] = frozenset()) -> Iterator[Change]:
        for word in words:
            for other in self._near(self._text.words[word]):
                if other not in never:
                    yield self._text.starts[word], self._text.ends[word], other

    def _near(self, written: str) -> list[str]:
        if written not in self._respelt:
            self._budget -= _LEAST_COST
            can_be = self._budget > 0 and len(written) <= _LONGEST
            self._respelt[written] = respellings(written, self._known) if can_be else []
        return self._respelt[written]

    def _helps(self, change: Change, trial: _Trial, problem: Span) -> bool:
        """Whether less is wrong at the problem, and not more in the rest of the statement."""
        start, end, words = change
        changed = self._faults(trial, change)
        if len(changed) >= len(trial.faults):
            return False
        longer = len(words) - (end - start) if start >= trial.own.start else 0
        first, last = problem.start - trial.own.start, problem.end - trial.own.start
        last = max(last, first + 1)
        there = sum(first <= place < last for place in trial.faults)
        moved, grown = longer * (start < problem.start), longer * (start < problem.end)
        still = sum(first + moved <= place < last + grown for place in changed)
        return still < there or not (there or changed)

    def _faults(self, trial: _Trial, change: Change | None) -> tuple[int, ...]:
        """The characters of the statement at which something is wrong after the change."""
        first = last = 0
        text = ""
        for statement in trial.statements:
            piece = self._source.text[statement.start : statement.end]
            if change is not None and statement.start <= change[0] <= change[1] <= statement.end:
                piece = piece[: change[0] - statement.start] + change[2] + piece[change[1] - statement.start :]
            if statement is trial.own:
                first, last = len(text), len(text) + len(piece)
            text += piece
        source = Source(text)
        lexer = self._lexer.again(source)
        matcher = Matcher(source, lexer.tokens, lexer.conditions, self._vocabulary.word)
        unknown = [token.start for token in lexer.tokens if token.kind == "unknown"]
        places = (p.span.start for p in (*lexer.problems, *matcher.problems) if p.is_error)
        return tuple(place - first for place in (*unknown, *places) if first <= place <= last)


def _changes_words(span: Span, words: str) -> bool:
    """Not where a fix adds or takes away a mark."""
    return any(character.isalnum() for character in span.text + words)


def _with_fix(problem: Diagnostic, change: Change) -> Diagnostic:
    """The problem with the change as its fix, and as the nearest that is known where it tells of that."""
    start, end, words = change
    arguments = dict(problem.arguments)
    told = arguments.get("help", "")
    if problem.code in _UNKNOWN and words not in told and '"' not in told:
        arguments["help"] = nearest_known([words])
    fix = Span(problem.span.source, start, end), words
    return Diagnostic(problem.code, problem.span, tuple(arguments.items()), problem.notes, fix)


@lru_cache(maxsize=4)
def _without_meaning(vocabulary: Vocabulary) -> frozenset[str]:
    """Words that would hide a word that is known, for they change nothing."""
    polite = (word for phrase in vocabulary.roles["politeness"] for word in phrase.split())
    return vocabulary.articles | frozenset(polite)


@lru_cache(maxsize=4)
def _words_of(vocabulary: Vocabulary) -> frozenset[str]:
    """Every word that the vocabulary knows, also those in names and values."""
    words: set[str] = set(vocabulary.articles)
    pending: list[TrieNode] = [vocabulary.trie, vocabulary.quantities]
    pending += [vocabulary.values.names_tree(name) for name, kind in vocabulary.types.items() if kind.kind == "names"]
    pending += vocabulary.values.word_trees()
    while pending:
        node = pending.pop()
        for key, child in node.items():
            if key == SLOTS:
                pending += [below for _, _, below in child]
            elif key != END:
                words.add(key)
                pending.append(child)
    for role in NO_PHRASES:
        words.update(word for phrase in vocabulary.roles[role] for word in phrase.split())
    return frozenset(word for word in words if word.isalpha() and len(word) > 1)
