"""Words that are no phrase: how far they reach, and what is wrong with them."""

from __future__ import annotations

from collections.abc import Set

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.symbols.definitions import Definitions
from btlang.frontends.mission.symbols.includes import ROLE as INCLUDE
from btlang.frontends.mission.symbols.includes import misplaced
from btlang.frontends.mission.token import BEFORE_CONDITIONS, Token, statement_start
from btlang.frontends.mission.tokens.each_and_any import ENDING
from btlang.frontends.mission.tokens.partial_commands import PartialCommands, may_be_doing
from btlang.frontends.mission.tokens.silent_words import MARKS, begins, begins_item
from btlang.frontends.mission.tokens.word_matches import with_verb
from btlang.text.source import Span
from btlang.text.words import END_OF_STATEMENT, END_OF_TEXT, Words
from btlang.vocabulary.language_tables import CONNECTIVES, NOT_ALONE
from btlang.vocabulary.lexicon import NODE_ROLES, Lexicon
from btlang.vocabulary.match import Match
from btlang.vocabulary.reading_context import ReadingContext
from btlang.vocabulary.trie import longest
from btlang.vocabulary.value_type import OBJECT, PERSON, PLACE, WORLD
from btlang.vocabulary.word_tree import find

_MOST_TOLD = 5
"""So many statements are explained before a text of which nothing is understood is taken for no mission."""
_UNDERSTOOD = frozenset(("command", "condition", "name", "wait", "wait_time", "node"))

_UNABLE = "it isn't clear which command is meant"
_IF_IT_FAILS = "go to the lab. If that fails, wave"


class UnknownWords:
    """Those of one text, while its `tokens` are read. `verb_forms` are the words that may be forms of verbs."""

    def __init__(
        self,
        text: Words,
        vocabulary: Lexicon,
        context: ReadingContext,
        definitions: Definitions,
        partial: PartialCommands,
        tokens: list[Token],
        problems: list[Diagnostic],
        verb_forms: Set[str],
    ) -> None:
        self._text, self._vocabulary, self._context, self._definitions = text, vocabulary, context, definitions
        self._partial, self._tokens, self._problems, self._verb_forms = partial, tokens, problems, verb_forms
        self._told, self._untold = 0, list[tuple[int, int, Match | None]]()
        self.before_doing = {phrase.split()[0] for phrase in vocabulary.roles["without_entering"]}
        """The words before the forms of verbs that a constraint forbids."""

    def report(self, at: int, end: int, match: Match | None) -> None:
        """Adds why words aren't understood to the problems, unless these tell it already.

        Of a text of which nothing is understood so far only the first ones are told.
        """
        if self._told >= _MOST_TOLD and self._is_all_unknown():
            self._untold.append((at, end, match))
            return
        self._told += 1
        self._tell_rest()
        self._tell(at, end, match)

    def finish(self) -> None:
        """Tell the rest at the end of a text, or one problem alone where nothing of it is understood."""
        if self._untold and self._is_all_unknown():
            del self._problems[1:]
        else:
            self._tell_rest()

    def _is_all_unknown(self) -> bool:
        """Whether nothing has been understood but words that join others."""
        return not any(token.kind in _UNDERSTOOD for token in self._tokens)

    def _tell_rest(self) -> None:
        for at, end, match in self._untold:
            self._tell(at, end, match)
        self._untold.clear()

    def _tell(self, at: int, end: int, match: Match | None) -> None:
        start, stop = self._text.starts[at], self._text.ends[end - 1]
        latest = self._problems[-1].span if self._problems else None
        if latest is not None and latest.source is self._text.source and latest.start <= start and stop <= latest.end:
            return
        why = self.why(at, end, match)
        if why.code == "BT038" and any(problem.code == "BT013" for problem in self._problems):
            return  # `it` stands for the unknown thing
        if why.fix is not None or not self._tokens or self._tokens[-1].kind != "never":  # which is told as a whole
            self._problems.append(why)

    def lack_name(self, at: int, last: int) -> bool:
        """Whether a phrase begins that only lacks a name: `without entering the kitchen`, where that is no zone.

        The words up to `last` (exclusive) are a phrase of their own.
        """
        from btlang.frontends.mission.explanations.misfits import misfits_of  # most missions have nothing to explain

        text, first = self._as_constraint(at)
        misfits = [each for each in misfits_of(text, first, (self._vocabulary.trie,), self._context) if each.at > last]
        named = (kind for kind in WORLD if kind in self._context.types)
        return bool(misfits) and all(self._context.read(kind, text, misfits[0].at) is None for kind in named)

    def _as_constraint(self, at: int) -> tuple[Words, int]:
        """The text with the word that constraints begin with in place of others that forbid, and where that is."""
        never = self._vocabulary.word("never")
        match = longest(self._vocabulary.trie, self._text, at, self._context)
        if match is None or match.meaning.role != "never" or self._text.words[at] == never:
            return self._text, at
        return self._text.with_word(match.last - 1, never), match.last - 1

    def is_doubtful(self, match: Match, role: str, at: int) -> bool:
        """Whether words that are polite or forbid something could say something else where they stand."""
        is_asked = bool(self._tokens) and self._tokens[-1].kind in BEFORE_CONDITIONS
        if role == "politeness":  # `wave if now bumped`, `so that nobody trips`
            return is_asked or find(self._vocabulary.reasons, self._text.words, at) is not None
        if is_asked and self._partial.forbidden(at, match.last) is None:
            return True  # `if you can't lift it`
        forbids = role == "never" and match.last <= at + 2  # `don't`, `do not`
        return (forbids or self._text.words[at] in self.before_doing) and self.lack_name(at, match.last)

    def why(self, at: int, end: int, match: Match | None) -> Diagnostic:
        """What is wrong with words that are no phrase, or one that stands where it cannot."""
        # Most missions have nothing to explain.
        from btlang.frontends.mission.explanations import fragments, unknown
        from btlang.frontends.mission.explanations.mission_values import misread_head

        role = match.meaning.role if match is not None else ""
        if match is not None and role in ("arrival", "arrival_at"):
            span = self._text.span(at, match.last)
            drives = f"goes to {match.values[0].text}" if match.values else "drives"
            return diagnostic("BT156", span, words=span.text, drives=drives)
        if self._tokens and self._tokens[-1].kind == "if" and find(self._vocabulary.unable, self._text.words, at):
            words = self._text.words
            span = self._text.span(at, next(i for i in range(end, len(words)) if words[i][0] in ENDING))
            return diagnostic("BT150", span, words=span.text, reason=_UNABLE, example=_IF_IT_FAILS)
        if match is None or role in NOT_ALONE:
            text, at = self._as_constraint(at)
            if text.words[at] in self._vocabulary.roles["define"] and begins(self._tokens):
                return diagnostic("BT016", text.span(at, at + 1), word=text.words[at])
            if role == "ordinal" and len(self._tokens) > 2 and self._tokens[-1].kind == "command":
                return self._which_first(at, end)
            if text.words[at] in self._vocabulary.journey_verbs and find(self._context.manners, text.words, at + 1):
                return self._where_to(at)
            doing = self._partial.doing(at) if text.words[at - 1] in self._vocabulary.halting else None
            if doing is not None:
                return fragments.stopped(text.span(at - 1, doing.last), self._vocabulary)
            if text.words[at] in self._verb_forms and may_be_doing(self._tokens):
                text = with_verb(text, at, self._vocabulary.doing, self._vocabulary.trie)
            return unknown.explain_unknown(
                text, at, end, self._vocabulary, self._context, self._definitions, self._tokens
            )
        if role == INCLUDE:
            return misplaced(self._text.span(at, end), self._vocabulary)
        return misread_head(self._text, at, role, self._vocabulary)

    def _which_first(self, at: int, end: int) -> Diagnostic:
        """BT151 for `A, B first`, for `A. B first`, and for `if C, A. Otherwise B first`."""
        text, tokens, then = self._text, self._tokens, self._vocabulary.word("then")
        first, last, begin = statement_start(tokens, len(tokens)), len(tokens) - 2, len(tokens) - 1
        if tokens[last].kind == "otherwise":
            begin = last
        elif all(token.kind != "command" for token in tokens[first:begin]):
            first, last, begin = statement_start(tokens, first - 1), first - 1, first
        before = text.source.text[tokens[first].start : tokens[last].start].strip(" ,.;\n")
        done = text.source.text[tokens[begin].start : tokens[-1].end]
        span = Span(text.source, tokens[begin].start, text.ends[end - 1])
        if begin == last:
            one, other = f"{done}, {then} ...", done
        elif tokens[begin].kind == "command":
            one, other = f"{done}, {then} {_inside(before)}", f"{before}, {then} {_inside(done)}"
        else:
            one, other = f"{done}. {then.capitalize()} {_inside(before)}", f"{before}. {done}"
        return diagnostic("BT151", span, words=span.text, one=one, other=other)

    def _where_to(self, at: int) -> Diagnostic:
        """BT012 for `drive slowly` behind journeys: it lacks a place."""
        text, places = self._text, self._vocabulary.values.said_names(PLACE)
        verb, manner = text.span(at, at + 1), text.span(at + 1, at + 2).text
        to = " ".join(self._vocabulary.asking["journey"][1:])
        example = f"{verb.text} {to} {places[0] if places else PLACE} {manner}"
        return diagnostic("BT012", verb, words=verb.text, wanted="a place", example=example)

    def told(self, at: int, last: int) -> tuple[int, Diagnostic] | None:
        """Where a sentence or clause ends that only tells something, or why, and what to say about it."""
        text, vocabulary = self._text, self._vocabulary
        end = next((i for i in range(at, last) if text.words[i] in MARKS), last)
        why = find(vocabulary.reasons, text.words, at)
        if why is None and not self._tells(at, end):
            return None
        for kind in (OBJECT, PERSON):  # `I have mislaid my book. Please look for it`
            tree = self._vocabulary.values.names_tree(kind)
            named = next((found[0] for i in range(at, end) if (found := find(tree, text.words, i))), None)
            if named is not None:
                self._context.latest[kind] = named
        span = Span(text.source, text.begin(at), text.ends[end - 1])
        is_behind = why is None and self._tokens[-1:] != [] and self._tokens[-1].kind == "comma"
        is_behind = is_behind or find(vocabulary.opinions, text.words, at) is not None
        if (why is not None or is_behind) and self._is_idle(at if why is None else why[1], end):
            return end, diagnostic("BT158", span, words=span.text)
        if why is not None:
            return end, diagnostic("BT165", span, words=span.text)
        return end, diagnostic("BT164", span, words=span.text, advice=self._advise(at, end))

    def _advise(self, at: int, end: int) -> str:
        """What to write in the place of a statement: `I am in the lab` says where to come."""
        tree, words = self._vocabulary.values.names_tree(PLACE), self._text.words
        named = next((first for first in range(at, end) if (found := find(tree, words, first)) and found[1] == end), 0)
        if named and words[at].partition("'")[0] in self._vocabulary.asking["speaking"]:
            where = self._text.span(named - 1, end).text
            return f"Say it in the command, for example: come to me {where}, or: bring the cup to me {where}"
        return "Leave it out, or put it on a line of its own that starts with #."

    def _is_idle(self, at: int, end: int) -> bool:
        """Whether a reason asks for nothing and goes on with no command: `because Alice is working there`."""
        words, vocabulary = self._text.words, self._vocabulary
        if words[end] not in (END_OF_STATEMENT, END_OF_TEXT) and not (words[end] == "," and begins(self._tokens)):
            return False
        if not vocabulary.quantifiers.isdisjoint(words[at:end]):
            return False
        command = longest(vocabulary.trie, self._text, at, self._context)
        joins = not vocabulary.joining.isdisjoint(words[at:end])
        if joins or (command is not None and command.meaning.role == "command"):
            return False
        return all(find(vocabulary.obliging, words, i) is None for i in range(at, end))

    def _tells(self, at: int, end: int) -> bool:
        """Whether words speak of somebody or something, and say nothing that must be or must not."""
        words, vocabulary = self._text.words, self._vocabulary
        persons = vocabulary.values.names_tree(PERSON)
        is_told = words[at] in vocabulary.asking["told_of"] or find(persons, words, at) is not None
        is_described = at in self._text.articles and begins(self._tokens)
        if at in self._text.articles and self._tokens[-1:] != [] and self._tokens[-1].kind == "comma":
            is_described = not vocabulary.values.texts.inverting.isdisjoint(words[at + 1 : end])  # `the floor is wet`
        if not (is_described or (is_told and begins_item(self._tokens))):
            return False
        value = self._context.any(self._text, at)
        if value is not None and value[2] == end:
            return False  # `the kitchen` alone
        if not vocabulary.quantifiers.isdisjoint(words[at:end]):
            return False
        return all(find(vocabulary.duties, words, i) is None for i in range(at, end))

    def end(self, at: int, last: int) -> int:
        """Unknown words reach to the next mark or connective, or to a phrase that is more than one word.

        A value that nothing has the name of, and a pronoun, are read as values there: they may be another mistake.
        """
        text, context = self._text, self._context.with_references()
        context.latest = dict.fromkeys(context.types, "")
        is_asked = bool(self._tokens) and self._tokens[-1].kind in BEFORE_CONDITIONS  # up to its command
        while True:
            at += 1
            if at < last and text.words[at] == "(" and context.values.number(text, at + 1):
                return text.words.index(")", at) + 1 if ")" in text.words[at:last] else at  # meant as a point
            if at >= last or text.words[at] in MARKS:
                return at
            match = longest(self._vocabulary.trie, text, at, context)
            if match is not None and match.meaning.role in (*NODE_ROLES, *NOT_ALONE):
                continue
            if match is None:
                continue
            ends = match.meaning.role in CONNECTIVES
            if is_asked and match.last > at + 1:  # `if you can't find it just let me know`
                ends |= match.meaning.role == "command" and text.words[match.last] in MARKS
            elif not is_asked:
                ends = match.meaning.entry is None or match.last > at + 1
            if ends:
                return at


def _inside(words: str) -> str:
    """A sentence as it is written behind other words."""
    return words[:1].lower() + words[1:]
