"""Words to raw tokens: phrases, connectives, names, brackets, lines and blocks. Collects what is unknown."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.symbols.names import Load, Names
from btlang.frontends.mission.token import Token
from btlang.frontends.mission.tokens.condition_names import condition_names, settle
from btlang.frontends.mission.tokens.counted_things import with_counted_things
from btlang.frontends.mission.tokens.ended_rules import with_ends
from btlang.frontends.mission.tokens.left_out import find_unplaced
from btlang.frontends.mission.tokens.other_things import with_goals_there, with_other_things, with_things_there
from btlang.frontends.mission.tokens.repeated_statements import (
    with_questions_each_time,
    with_questions_once,
    with_repeats_apart,
    with_times_first,
)
from btlang.frontends.mission.tokens.rules_behind import (
    find_counted_rules,
    find_ended_rounds,
    find_two_ifs,
    with_checks_apart,
    with_exceptions,
    with_rules_behind,
)
from btlang.frontends.mission.tokens.rules_inside import with_rules_inside
from btlang.frontends.mission.tokens.settling import (
    find_brief_stays,
    find_unclear_people,
    find_unclear_things,
    turn_branches,
    with_either_end,
    with_rounds,
    with_stays,
    with_watched_waits,
)
from btlang.frontends.mission.tokens.visitors import with_meetings, with_sightings
from btlang.frontends.mission.tokens.word_reader import WordReader
from btlang.text.source import Source, Span
from btlang.text.words import END_OF_STATEMENT, END_OF_TEXT, Words, split
from btlang.vocabulary.antecedents import pronouns_for
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.pattern import forms
from btlang.vocabulary.reading_context import Known, ReadingContext
from btlang.vocabulary.value_type import DOOR, OBJECT, PLACE, TEXT, WORLD, ZONE
from btlang.vocabulary.word_tree import find

_MOST_ADJECTIVES = 3
_ENDING = frozenset((END_OF_STATEMENT, END_OF_TEXT, ",", ";", ")"))


class Lexer:
    """Reads one source. `tokens` are raw tokens, `problems` what was unknown; both are complete after construction.

    With `explain` False nothing is said about unknown words, which takes time. `load` reads the missions that this one
    includes; without it their names are unknown. `known` are values that it may use though it does not set them.
    """

    def __init__(
        self,
        source: Source,
        vocabulary: Lexicon,
        explain: bool = True,
        load: Load | None = None,
        known: Mapping[str, Known] | None = None,
    ) -> None:
        self._given, self._shared = vocabulary, known
        self.text: Words = split(source, vocabulary.orthography)
        self.problems: list[Diagnostic] = [
            diagnostic("BT004", span, fix=(Span(source, span.end, span.end), '"')) for span in self.text.open_quotes
        ]
        self.problems += [diagnostic("BT003", span, characters=span.text[:20]) for span in self.text.unreadable]
        _drop_words_of_turns(self.text, vocabulary)
        _drop_still(self.text, vocabulary)
        _drop_left(self.text, vocabulary)
        _say_there(self.text, vocabulary)
        _say_if_so(self.text, vocabulary)
        _say_kind(self.text, vocabulary)
        _drop_commas(self.text, vocabulary)
        _list_ranges(self.text, vocabulary)
        self.problems += _drop_untold_sizes(self.text, vocabulary)
        self.problems += _drop_untold_contents(self.text, vocabulary)
        self.names = Names(self.text, vocabulary, load, known)
        self.problems += self.names.problems
        self.vocabulary = self.names.vocabulary
        self.context = ReadingContext(self.vocabulary.values)
        self.context.keys = self.names.chosen
        self.tokens: list[Token] = []
        self._words = WordReader(self.text, self.names, self.context, self.tokens, self.problems, explain)
        self._lines()
        self.problems += with_repeats_apart(self.tokens, source)
        with_times_first(self.tokens)
        self.problems += with_questions_once(self.tokens, source)
        with_questions_each_time(self.tokens)
        turn_branches(self.tokens)
        with_rounds(self.tokens)
        with_either_end(self.tokens)
        with_watched_waits(self.tokens)
        with_stays(self.tokens, source, vocabulary.asking["standing_verbs"])
        self.problems += find_brief_stays(self.tokens, vocabulary, source) if explain else ()
        self.problems += find_unclear_things(self.tokens, vocabulary, self.text) if explain else ()
        self.problems += find_unclear_people(self.tokens, vocabulary, self.text) if explain else ()
        self.problems += find_unplaced(self.tokens, vocabulary, source) if explain else ()
        with_meetings(self.tokens, vocabulary)
        with_sightings(self.tokens, vocabulary, source)
        self.problems += with_counted_things(self.tokens, self.vocabulary, source)
        with_things_there(self.tokens)
        with_goals_there(self.tokens, vocabulary, source)
        self.problems += with_other_things(self.tokens, vocabulary, self.text)
        with_rules_behind(self.tokens)
        self.problems += find_counted_rules(self.tokens, source)
        with_checks_apart(self.tokens)
        self.problems += find_two_ifs(self.tokens, self.vocabulary, source)
        self.problems += find_ended_rounds(self.tokens, self.vocabulary, source)
        self.problems += with_exceptions(self.tokens, self.vocabulary, source)
        with_rules_inside(self.tokens)
        self.problems += with_ends(self.tokens, self.vocabulary, partial(Span, source))
        self.conditions = condition_names(self.tokens, self.names.included_conditions())
        """The defined names that stand for conditions."""
        settle(self.tokens, self.conditions)

    def again(self, source: Source) -> Lexer:
        """Another text in the place of this one; it may include what this one does, and nothing is said about it."""
        included = self.names.included
        return Lexer(source, self._given, explain=False, load=lambda path, _: included.get(path), known=self._shared)

    def _lines(self) -> None:
        """Line ends, indents and dedents around the tokens of each line, as in Python."""
        lines = self.text.lines
        indents = [lines[0].indent] if lines else [0]
        opens_block = False
        for number, line in enumerate(lines):
            if line.indent > indents[-1]:
                if opens_block:
                    indents.append(line.indent)
                    self._mark("indent", line.first)
                else:
                    self.problems.append(diagnostic("BT006", self.text.span(line.first, line.first)))
            else:
                if opens_block:
                    self.problems.append(diagnostic("BT027", self._last_span()))
                while line.indent < indents[-1] and len(indents) > 1:
                    indents.pop()
                    self._mark("dedent", line.first)
                if line.indent != indents[-1]:
                    self.problems.append(diagnostic("BT007", self.text.span(line.first, line.first)))
            if number and not opens_block:
                self._mark("newline", line.first)
            if line.indent <= indents[0] and line.first not in self.text.going_on:
                self._words.end_statement()
            self._words.read(line.first, line.last)
            opens_block = bool(self.tokens) and self.tokens[-1].kind == "colon"  # politeness may stand behind it
        if opens_block:
            self.problems.append(diagnostic("BT027", self._last_span()))
        for _ in indents[1:]:
            self._mark("dedent", len(self.text.words) - 1)

    def _mark(self, kind: str, at: int) -> None:
        start = self.text.starts[at] if at < len(self.text.starts) else len(self.text.source.text)
        self.tokens.append(Token(kind, start, start))

    def _last_span(self) -> Span:
        last = self.tokens[-1]
        return Span(self.text.source, last.start, last.end)


def _drop_words_of_turns(text: Words, vocabulary: Lexicon) -> None:
    """Take out what says nothing beside a list, with its commas: `the lab and the dock, in that order`.

    `either` says nothing at an end: `avoid the lab. Don't go into the hall either`.
    """
    words, either = text.words, vocabulary.roles["either"]
    last = [] if text.distinct.isdisjoint(either) else [at for at in range(1, len(words) - 1) if words[at] in either]
    for at in (at for at in reversed(last) if words[at + 1][0] in _ENDING):
        text.drop(at, at + 1)
    if text.distinct.isdisjoint(vocabulary.in_turn):
        return  # as nearly always
    for at in reversed([at for at, word in enumerate(words) if word in vocabulary.in_turn]):
        found = find(vocabulary.in_turn, words, at)
        begins = at == 0 or words[at - 1] in (END_OF_STATEMENT, END_OF_TEXT, ":")
        if found is not None and (not begins or words[found[1]] == ","):
            first = at - (words[at - 1] == "," and not begins)
            is_inserted = words[found[1]] == "," and words[found[1] + 1] not in vocabulary.joining
            text.drop(first, found[1] + (is_inserted and (begins or first < at)))


def _drop_still(text: Words, vocabulary: Lexicon) -> None:
    """Take out `still` and `already` before what a condition says: `if he still says no`; but not `if he is still`.

    `yet` stands at its end: `if he isn't there yet`.
    """
    words, still, motionless = text.words, vocabulary.asking["still"], vocabulary.asking["motionless"]
    yet = vocabulary.yet
    for at in reversed(range(1, len(words))) if not text.distinct.isdisjoint((*still, *yet)) else ():
        is_still = words[at] in still and words[at - 1] not in motionless and words[at + 1][0].isalpha()
        said = find(yet, words, at)
        end = at + 1 if is_still else said[1] if said is not None and not words[said[1]][0].isalpha() else 0
        if end:
            _, first, _ = text.earlier(at)
            first = max((i + 1 for i in range(first, at) if words[i] == ","), default=first)
            if any(word in vocabulary.before_conditions for word in words[first:at]):
                text.drop(at, end)


def _drop_left(text: Words, vocabulary: Lexicon) -> None:
    """Take out `left` in a condition: `if nobody is left in the lab`, `if there are no cups left`; not `turn left`."""
    words, remaining, values = text.words, vocabulary.asking["remaining"], vocabulary.values
    if not remaining or remaining[0] not in text.distinct:
        return  # as nearly always
    prepositions = {phrase[0] for phrases in values.role_words.introducing.values() for phrase in phrases}
    be, things = vocabulary.asking["asking_be"], (OBJECT, "kind", "kinds")
    for at in reversed([at for at in range(1, len(words) - 1) if words[at] == remaining[0]]):
        ends, before = not words[at + 1][0].isalpha(), words[at - 1]
        asks = (i for i in reversed(range(text.earlier(at)[1], at)) if words[i] in vocabulary.before_conditions)
        first = next(asks, at)
        is_thing = before in vocabulary.quantifiers or any(values.takes_word(kind, before) for kind in things)
        is_thing = is_thing or values.is_number([before])
        if before in be and ends and first < at:
            text.replace(at, [remaining[1]])
        elif (before in be or is_thing) and any(word in be for word in words[first:at]):
            if ends or words[at + 1] in prepositions:
                text.drop(at, at + 1)


def _say_there(text: Words, vocabulary: Lexicon) -> None:
    """Put `there` behind `go in` where it is left out: `At 11, go in and wave`."""
    if text.distinct.isdisjoint(vocabulary.entering):
        return  # as nearly always
    words, there = text.words, vocabulary.asking["remaining"][-1:]
    for at in reversed([at for at in range(len(words) - 1) if words[at] in vocabulary.entering]):
        found = find(vocabulary.entering, words, at)
        if found is not None and (words[found[1]][0] in _ENDING or words[found[1]] in vocabulary.joining):
            text.replace(found[1] - 1, [words[found[1] - 1], *there])


def _say_if_so(text: Words, vocabulary: Lexicon) -> None:
    """Put `if it is` for `that is` behind doors, which are as the robot finds them: `close every door that is open`."""
    words, values, asking = text.words, vocabulary.values, vocabulary.asking
    if text.distinct.isdisjoint(vocabulary.relatives):
        return  # as nearly always
    it = next(iter(pronouns_for(values.pronouns, DOOR)), "")
    entries = (vocabulary.entry(id) for id in ("DoorOpen", "DoorClosed"))
    states = {form[-1] for entry in entries if entry is not None for each in entry.phrases for form in forms(each)}
    for at in reversed([at for at in range(1, len(words) - 1) if words[at] in vocabulary.relatives]):
        found = find(vocabulary.relatives, words, at)
        if found is None or not values.phrases.is_type(DOOR, text, at - 1):
            continue
        state = found[1] + (words[found[1]] in asking["still"])
        if words[state] in states and (words[state + 1][0] in _ENDING or words[state + 1] in vocabulary.joining):
            text.drop(at + 1, state)
            text.replace(at, [vocabulary.word("if"), it, asking["asking_be"][0]])


def _say_kind(text: Words, vocabulary: Lexicon) -> None:
    """Put the kind behind `all` that what is left out has: `all but the blue cups` as `all cups but the blue cups`."""
    words, values, every = text.words, vocabulary.values, frozenset(vocabulary.roles["all_names"])
    for at in reversed([at for at, word in enumerate(words) if word in every]):
        end = values.exception(text, at + 1)
        nouns = (word for word in words[end : end + _MOST_ADJECTIVES] if end and values.takes_word("kinds", word))
        noun = next(nouns, "")
        if noun:
            text.replace(at, [words[at], noun])


def _drop_commas(text: Words, vocabulary: Lexicon) -> None:
    """Take out the comma between a word that joins and one before a condition: `wave and, if bumped, nod`."""
    words, joints = text.words, vocabulary.joining.difference(vocabulary.roles["or"])
    for at in reversed([at for at in range(1, len(words) - 1) if words[at] == ","]):
        if words[at - 1] in joints and words[at + 1] in vocabulary.before_conditions:
            text.drop(at, at + 1)


def _list_ranges(text: Words, vocabulary: Lexicon) -> None:
    """Put all names of a range in the place of the last one: `rooms 1 to 3` as `rooms 1, 2 and 3`."""
    words, heads = text.words, vocabulary.values.shared_heads
    joints = set(vocabulary.asking["between_joint"]).difference(vocabulary.roles["and"])
    if joints.isdisjoint(text.distinct):
        return  # as often
    for at in reversed(range(len(words) - 3)):
        if words[at + 2] not in joints or not words[at + 1].isdecimal():
            continue
        numbers = next((found for kind in WORLD if (found := heads.between(kind, words, at, words[at + 3]))), [])
        if numbers:
            listed = [word for number in numbers for word in (",", number)]
            text.replace(at + 3, [*listed[1:-2], vocabulary.word("and"), numbers[-1]] if len(numbers) > 1 else numbers)
            text.replace(at + 2, [","] if len(numbers) > 1 else [vocabulary.word("and")])


def _drop_untold_sizes(text: Words, vocabulary: Lexicon) -> Iterator[Diagnostic]:
    """Take out a size before the name of a place where nothing is known of sizes: `the large red room` is that room."""
    sizes, places = vocabulary.values.names_tree("size"), vocabulary.values.names_tree(PLACE)
    if text.distinct.isdisjoint(sizes) or vocabulary.values.likenesses.is_told(PLACE, "size"):
        return
    found = [(at, find(sizes, text.words, at)) for at in range(len(text.words)) if text.words[at] in sizes]
    ends = [(at, size[1]) for at, size in found if size is not None and find(places, text.words, at) is None]
    named = {text.words[end] for at, end in ends if text.earlier(at)[1] == at}  # `the large kitchen is at (3, 4)`
    before = {phrase[0] for phrases in vocabulary.values.role_words.introducing.values() for phrase in phrases}
    entries = [entry for same in vocabulary.entries.values() for entry in same]
    types = [(entry, {slot.type for slot in entry.slots}) for entry in entries]
    goes = [entry for entry, own in types if own & {PLACE, ZONE} and TEXT not in own]
    verbs = tuple(phrase.split()[0] for entry in goes for phrase in entry.phrases)
    for at, end in reversed(ends):
        if (
            find(places, text.words, end)
            and text.words[end] not in named
            and (text.words[at - 1] in before or text.words[at - 1].startswith(verbs))
        ):
            span = text.span(at, end)
            text.drop(at, end)
            yield diagnostic("BT158", span, words=span.text)


def _drop_untold_contents(text: Words, vocabulary: Lexicon) -> Iterator[Diagnostic]:
    """Take out what is in a thing where nothing is known of that: `a cup of tea` is the cup."""
    words, values = text.words, vocabulary.values
    contents, joints = vocabulary.contents, vocabulary.content_words
    if text.distinct.isdisjoint(contents) or text.distinct.isdisjoint(joints):
        return
    if any(part == "content" for _, parts in values.likenesses.features.get(OBJECT, ()) for part, _ in parts):
        return
    names = (values.names_tree(OBJECT), values.names_tree("kind"))
    entries = [entry for same in vocabulary.entries.values() for entry in same]
    says = {
        phrase.split()[0]
        for entry in entries
        if any(slot.type == TEXT for slot in entry.slots)
        for phrase in (*entry.phrases, *(verb for verbs, _ in entry.verbs for verb in verbs))
    }
    for at in reversed([at for at in range(1, len(words)) if words[at] in joints]):
        inside = find(contents, words, at + 1)
        begins = range(max(at - 3, 0), at)
        is_thing = any((found := find(tree, words, first)) and found[1] == at for tree in names for first in begins)
        is_name = any((found := find(names[0], words, first)) and found[1] > at for first in begins)
        is_said = inside is not None and not says.isdisjoint(words[text.earlier(at)[1] : at])
        if inside is not None and is_thing and not (is_name or is_said):
            span = text.span(at, inside[1])
            text.drop(at, inside[1])
            yield diagnostic("BT158", span, words=span.text)
