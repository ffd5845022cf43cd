"""The one gate for corrections: a change is proposed for a problem only if it passes here, wherever it was made.

The whole sentence then reads without an error, what was understood before it is understood the same way, its words
differ by spelling alone (`spelling_rule.py`), and no other change that is as small does that with another meaning. If
no proposal passes, other spellings of the words of the statement are tried.

The statement with the problem is tried, with the statements beside it and those that give names. All tries
together read a limited number of words, so that a text full of mistakes takes hardly longer than before. What could
not be tried is not proposed.
"""

from __future__ import annotations

import re
from bisect import bisect_left, bisect_right
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from itertools import islice, product

from btlang.diagnostics.diagnostic import Diagnostic
from btlang.frontends.mission.explanations.spelling_rule import is_respelling, words_of
from btlang.frontends.mission.explanations.suggestions import nearest_known
from btlang.frontends.mission.grouping.grouping import Grouped, group
from btlang.frontends.mission.symbols.prefixes import find_prefixes
from btlang.frontends.mission.token import Called, Header, Listed, NodeCall, Token
from btlang.frontends.mission.tokens.lexer import Lexer
from btlang.support.record import Record
from btlang.text.source import Source, Span
from btlang.text.spelling import distance, respellings
from btlang.text.words import END_OF_STATEMENT, Words
from btlang.vocabulary.correct_words import correct_words

_MOST_WORDS = 10_000  # that all tries for a text read
_LEAST_COST = 50  # what a try costs at least, in words
_LONG_STATEMENT = 100  # words from which on each takes longer to read
_MOST_TRIES = 40  # for one problem
_MOST_SPELLINGS = 16  # that are tried for a word
_LONGEST = 40  # letters of a word that is respelt
_MOST_SUSPECTS = 40  # words that may be misspelt, for one problem
_MOST_BESIDE, _MOST_EACH = 3, 5  # problems of a sentence that are mended together, and changes that are tried for each
_NEAR_WORDS = 12  # of a problem, that a name may have been meant to have
_MARKS_FAR = 8  # what marks around words count: farther than any other spelling of one
_UNKNOWN, _MEANING = frozenset(("BT010", "BT013")), frozenset(("command", "condition"))

Change = tuple[int, int, str]
Compile = Callable[[Lexer, Grouped], Iterable[Diagnostic]]
"""What is wrong with a text that can be read."""


class _Statement(Record):
    """Characters of a statement at the margin with its block, and its words `first` to `last` (exclusive)."""

    start: int
    end: int
    first: int
    last: int


class _Trial(Record):
    """Statements to read with a change; without, how much is wrong, and what is understood before the first fault."""

    own: _Statement
    statements: tuple[_Statement, ...]
    faults: int
    cost: int
    ids: frozenset[str]
    understood: tuple[object, ...]


def corrected(lexer: Lexer, problems: list[Diagnostic], compile: Compile | None) -> list[Diagnostic]:
    """The problems of a text, each with the one correction that may be proposed for it, or without a fix.

    Without `compile` nothing is tried, so nothing is proposed.
    """
    if compile is None or not lexer.text.lines:
        return [problem.replace(fix=None) for problem in problems]
    return _Corrections(lexer, problems, compile).corrected()


class _Corrections:
    def __init__(self, lexer: Lexer, problems: list[Diagnostic], compile: Compile) -> None:
        self._lexer, self._text, self._source = lexer, lexer.text, lexer.text.source
        self._vocabulary, self._compile = lexer.vocabulary, compile
        self._problems = problems
        self._budget = _MOST_WORDS
        self._respelt: dict[str, list[str]] = {}
        self._trials: dict[int, _Trial] = {}
        self._statements = list(self._split())
        self._starts = [statement.start for statement in self._statements]
        known, names = words_of(self._vocabulary), list(self._names(lexer))
        self._naming = {self._at(self._text.starts[words[0]]) for words in names}
        self._strange = [word for words in names for word in words if self._text.words[word] not in known]
        self._known = known | {self._text.words[word] for words in names for word in words}
        self._meant = self._known - self._vocabulary.orthography.titles  # these would say nothing: `the dr ball`
        self._written = Counter(self._text.words) if self._strange else Counter()
        self._sentences = _Sentences(self._text)
        self._beside: dict[tuple[int, int], list[Diagnostic]] = {}
        for problem in problems:
            if problem.is_error:
                self._beside.setdefault(self._sentences.around(problem.span.start), []).append(problem)
        for beside in self._beside.values():
            beside.sort(key=lambda problem: problem.span.start)

    def corrected(self) -> list[Diagnostic]:
        """Each problem once, in the order given."""
        return [self._improved(problem) if problem.is_error else problem for problem in self._problems]

    def _improved(self, problem: Diagnostic) -> Diagnostic:
        change = self._cure(problem) if self._budget > 0 else None
        if change is None:
            return problem.replace(fix=None)  # type: ignore[no-any-return]
        proposed = _proposed(problem)
        if proposed is not None and self._with(change).lower() == self._with(proposed).lower():
            return problem
        return _with_fix(problem, change)

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
        prefixes = find_prefixes(self._text, self._vocabulary).items()
        named += [
            (at, prefix.last, prefix.words) for at, prefix in prefixes if prefix.role not in ("increase", "decrease")
        ]
        for fact in lexer.names.facts:
            first = bisect_left(self._text.starts, fact.span.start)
            named.append((first, bisect_left(self._text.starts, fact.span.end), tuple(fact.name.split())))
        for first, last, own in named:
            found = [at for at in range(first, last) if words[at][0].isalpha() and (own is None or words[at] in own)]
            if found:
                yield found

    # -- tries

    def _cure(self, problem: Diagnostic) -> Change | None:
        """The smallest change that passes the gate, None if there is none or another one is as small."""
        self._budget -= _LEAST_COST
        trial = self._trial(problem)
        if trial is None:
            return None
        best: tuple[int, Change, object] | None = None
        for far, change in islice(self._candidates(problem, trial), _MOST_TRIES):
            if best is not None and far > best[0]:
                break
            if trial.cost > self._budget:
                return None
            self._budget -= trial.cost
            meaning = self._meaning(change, trial, problem.span.start)
            if meaning is None:
                continue
            if best is not None and meaning != best[2]:
                return None
            best = best or (far, change, meaning)
        return best[1] if best is not None else None

    def _candidates(self, problem: Diagnostic, trial: _Trial) -> list[tuple[int, Change]]:
        """Changes by spelling alone, the smallest first, each with how far it is.

        For the first problem of a sentence also those that mend several problems, as one change.
        """
        beside = self._beside[self._sentences.around(problem.span.start)]
        found = self._changes_for(problem, trial)
        if len(beside) > 1 and problem is beside[0] and len(beside) <= _MOST_BESIDE:
            each = [self._changes_for(other, trial)[:_MOST_EACH] for other in beside]
            together = ((sum(far for far, _ in pairs), self._joined([c for _, c in pairs])) for pairs in product(*each))
            found += [(far, change) for far, change in together if change is not None and (far, change) not in found]
        return sorted(found, key=lambda pair: pair[0])

    def _joined(self, changes: list[Change]) -> Change | None:
        """Several changes as one, None where they overlap."""
        changes = sorted(set(changes))
        start, end, words = changes[0]
        for first, last, more in changes[1:]:
            if first < end:
                return None
            words += self._source.text[end:first] + more
            end = last
        return start, end, words

    def _changes_for(self, problem: Diagnostic, trial: _Trial) -> list[tuple[int, Change]]:
        suspects = self._suspects(problem, trial.own)
        proposed = self._before_article(_proposed(problem))
        strangers = [word for word in suspects if self._text.words[word] not in self._known or self._is_used_once(word)]
        changes = [*self._changes_of_names(suspects), *self._changes(strangers), *([proposed] if proposed else ())]
        allowed = [change for change in dict.fromkeys(changes) if self._is_respelling(change)]
        return sorted(((self._far(change), change) for change in allowed), key=lambda pair: pair[0])

    def _is_used_once(self, word: int) -> bool:
        """Whether a word is one of a name that nothing uses, so that it may be none: `whree is the book?`."""
        return word in self._strange and self._written[self._text.words[word]] == 1

    def _before_article(self, change: Change | None) -> Change | None:
        """Words that are put before a word are put before its article."""
        if change is None or change[0] < change[1]:
            return change
        start, _ = self._text.articles.get(bisect_left(self._text.starts, change[0]), change[:2])
        return start, start, change[2]

    def _is_respelling(self, change: Change) -> bool:
        start, end, words = change
        word = bisect_left(self._text.starts, start) - 1
        before = self._text.words[word] if word >= 0 else ""
        return is_respelling(self._source.text[start:end], words, self._vocabulary, before)

    def _far(self, change: Change) -> int:
        start, end, words = change
        written = self._source.text[start:end]
        if not any(character.isalpha() for character in written):
            return 2
        return _MARKS_FAR if _letters(written) == _letters(words) else distance(written.lower(), words.lower())

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
        lexer, _, faults = read_again(self._lexer, "".join(self._piece(statement, None) for statement in statements))
        read = len(faults), cost, _ids(lexer), tuple(_understood(lexer, faults))
        return self._trials.setdefault(number, _Trial(self._statements[number], statements, *read))

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

    def _changes_of_names(self, suspects: list[int]) -> Iterator[Change]:
        """Words of names that nothing else explains, as the problem has them where that is how they mostly stand."""
        articles, right = self._vocabulary.articles, correct_words(self._vocabulary.word_list)
        near = articles.union(self._text.words[word] for word in suspects[:_NEAR_WORDS])
        for word in self._strange:
            written = self._text.words[word]
            for other in respellings(written, near) if len(written) <= _LONGEST else ():
                if other in articles or other in right or self._written[other] > self._written[written]:
                    yield self._text.starts[word], self._text.ends[word], other

    def _changes(self, words: Iterable[int]) -> Iterator[Change]:
        for word in words:
            for other in self._near(self._text.words[word]):
                yield self._text.starts[word], self._text.ends[word], other

    def _near(self, written: str) -> list[str]:
        if written not in self._respelt:
            self._budget -= _LEAST_COST
            can_be = self._budget > 0 and len(written) <= _LONGEST
            self._respelt[written] = respellings(written, self._meant, _MOST_SPELLINGS) if can_be else []
        return self._respelt[written]

    def _meaning(self, change: Change, trial: _Trial, problem: int) -> object:
        """What the statements say with a change; None where it leaves an error in its sentence or the problem's."""
        pieces = [self._piece(statement, change) for statement in trial.statements]
        ends = [sum(map(len, pieces[:number])) for number in range(len(pieces) + 1)]
        places = []
        for place in (problem, change[0]):
            number = trial.statements.index(self._statements[self._at(place)])
            grown = len(change[2]) - (change[1] - change[0]) if change[1] <= place else 0
            places.append(ends[number] + place - trial.statements[number].start + grown)
        lexer, grouped, faults = read_again(self._lexer, "".join(pieces))
        sentences = [*map(_Sentences(lexer.text).around, places)]
        if len(faults) >= trial.faults or any(first <= fault <= last for fault in faults for first, last in sentences):
            return None
        known = self._vocabulary
        are_known = all(id in trial.ids or id in known.entries or id in known.nodes for id in _ids(lexer))
        if not are_known and '"' not in change[2]:
            return None  # words that mean nothing became the id of a node that nobody knows: `do on gripper`
        meaning: list[object] = [(token.kind, _said(token)) for token in lexer.tokens]
        rest = iter(meaning)
        if change[0] >= self._sentences.around(problem)[0] and not all(said in rest for said in trial.understood):
            return None
        broken = {bisect_right(ends, fault) - 1 for fault in faults}
        if broken:  # what else is wrong keeps the text from being compiled
            pieces = ["" if number in broken else piece for number, piece in enumerate(pieces)]
            lexer, grouped, faults = read_again(self._lexer, "".join(pieces))
        return None if not faults and any(p.is_error for p in self._compile(lexer, grouped)) else meaning

    def _piece(self, statement: _Statement, change: Change | None) -> str:
        piece = self._source.text[statement.start : statement.end]
        if change is None or not statement.start <= change[0] <= change[1] <= statement.end:
            return piece
        return piece[: change[0] - statement.start] + change[2] + piece[change[1] - statement.start :]


def read_again(like: Lexer, text: str) -> tuple[Lexer, Grouped, list[int]]:
    """A text as the lexer of another one reads it, and the characters at which something is wrong."""
    source = Source(text)
    lexer = like.again(source)
    grouped = group(source, lexer.tokens, lexer.conditions, lexer.vocabulary.word)
    unknown = [token.start for token in lexer.tokens if token.kind == "unknown"]
    return lexer, grouped, unknown + [p.span.start for p in (*lexer.problems, *grouped.problems) if p.is_error]


def _ids(lexer: Lexer) -> frozenset[str]:
    return frozenset(token.value.id for token in lexer.tokens if isinstance(token.value, NodeCall))


class _Sentences:
    """The sentences of a text; the stops of a line are looked for once, since each problem asks where it is."""

    def __init__(self, text: Words) -> None:
        self._text = text
        self._stops: dict[int, list[int]] = {}  # by the first word of a line

    def around(self, at: int) -> tuple[int, int]:
        """The characters of the one at a place: a line, or a part of one between stops in no brackets."""
        text = self._text
        if not text.lines:
            return 0, at
        line = text.lines[max(bisect_right(text.lines, at, key=lambda line: text.starts[line.first]) - 1, 0)]
        if line.first not in self._stops:
            self._stops[line.first] = list(self._found(line.first, line.last))
        stops = self._stops[line.first]
        number = bisect_left(stops, at, key=lambda word: text.starts[word])
        first = stops[number - 1] + 1 if number else line.first
        return text.starts[first], text.starts[stops[number] if number < len(stops) else line.last]

    def _found(self, first: int, last: int) -> Iterator[int]:
        text, depth = self._text, 0
        for word in range(first, last):
            depth += (text.words[word] == "(") - (text.words[word] == ")")
            end = text.ends[word]
            if depth <= 0 and text.words[word] == END_OF_STATEMENT and not text.source.text[end : end + 1].strip():
                yield word


def _understood(lexer: Lexer, faults: Iterable[int]) -> Iterator[object]:
    """What the sentences say before the first in which something is wrong; others may depend on that one."""
    wrong = _Sentences(lexer.text).around(min(faults, default=0))[0]
    return ((token.kind, _said(token)) for token in lexer.tokens if token.end <= wrong and token.kind in _MEANING)


def _said(token: Token) -> object:
    """The value of a token without the places at which its words are."""
    value = token.value
    if isinstance(value, Header):
        return value.name
    if isinstance(value, Listed):
        return value.entry.id, value.arguments, value.joiner
    if isinstance(value, Called):
        return value.entry.id, value.arguments
    return value or token.role


def _letters(text: str) -> str:
    return "".join(filter(str.isalnum, text.lower()))


def _proposed(problem: Diagnostic) -> Change | None:
    return None if problem.fix is None else (problem.fix[0].start, problem.fix[0].end, problem.fix[1])


def _with_fix(problem: Diagnostic, change: Change) -> Diagnostic:
    """The problem with the change as its fix; the help on unknown words names the change too."""
    start, end, words = change
    arguments = dict(problem.arguments)
    hint = arguments.get("help", "")
    is_within = problem.span.start <= start <= end <= problem.span.end
    if problem.code in _UNKNOWN and is_within and not re.search(rf"\b{re.escape(words)}\b", hint) and '"' not in hint:
        arguments["help"] = nearest_known([words])
    fix = Span(problem.span.source, start, end), words
    return Diagnostic(problem.code, problem.span, tuple(arguments.items()), problem.notes, fix)
