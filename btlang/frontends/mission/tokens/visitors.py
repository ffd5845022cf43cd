"""Rules that are said of people: `wave at everyone who comes near`, `greet everybody you meet`."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

from btlang.diagnostics.diagnostic import diagnostic
from btlang.frontends.mission.token import (
    JOINTS,
    STATEMENT_ENDS,
    Called,
    Listed,
    Token,
    arguments_of,
    drives,
    run_end,
    run_start,
    statement_start,
    texts_of,
    with_arguments,
)
from btlang.frontends.mission.tokens.addressed_texts import TELL
from btlang.frontends.mission.tokens.ended_rules import GO, journey_to
from btlang.frontends.mission.tokens.journey_words import ANYBODY_COMES, COMES
from btlang.frontends.mission.tokens.rules_inside import ON_WAY, TIMES
from btlang.frontends.mission.tokens.sentence_reader import SentenceReader, is_question
from btlang.frontends.mission.tokens.settling import STAYS
from btlang.frontends.mission.tokens.word_matches import match_of, relocated, rest_of, words_of
from btlang.text.source import Source, Span
from btlang.tree.answers import ANSWERED, ASK, SOMEBODY_SAYS
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.match import Match
from btlang.vocabulary.references import ALL, NAMES, SPEAKING, Choice, choice_of, ordinal
from btlang.vocabulary.value_type import PERSON, PLACE, TEXT

_SEEN, _COMMANDS = "SeesSomeone", ("command", "name")
_PACES = ("every_day", "at", "every")
_MOST_IN_NAME = 4  # words of those who are told something
_SIMPLE = frozenset(("command", "name", "wait", "wait_time", "for", "until_time", "count", *JOINTS))


class Visitors(SentenceReader):
    """Those of one text."""

    _met = 0
    """Where the event begins that stands inside the phrase being read; 0 for none."""

    @cached_property
    def _hearing(self) -> frozenset[str]:
        """The verbs behind which a person is told or asked something; none in a text without words for an event."""
        asking = self._vocabulary.asking
        if self._text.distinct.isdisjoint({*asking["who"], *self._vocabulary.subjects}):
            return frozenset()
        return self._vocabulary.opening_words(TELL, ASK)

    @cached_property
    def _somebody(self) -> str:
        """The word for anybody, for whom an event without a kind waits; empty in a language without one."""
        return next(iter(self._vocabulary.asking["somebody"]), "")

    def with_event(self, match: Match | None, at: int) -> Match | None:
        """The phrase at a word; `ask everyone you meet "Tea?"` is `ask everyone "Tea?"` and an event."""
        text = self._text
        if text.words[at] not in self._hearing:
            return match  # as nearly always
        for behind in range(at + 2, min(at + 2 + _MOST_IN_NAME, self._end_of_statement(at))):
            event = self._event(behind, self._somebody)
            is_quoted = event is not None and text.words[event.last][0] == '"'
            opens = event is not None and self._opens(text.words[event.last])
            if event is None or not (is_quoted or opens):
                continue
            places = [*range(at, behind), *rest_of(text, event.last)]
            found = match_of(text, places, {}, (self._vocabulary.trie,), self._context)
            ends = found is not None and (found.last == behind - at + 1 or not is_quoted)
            if found is not None and found.meaning.entry is not None and ends:
                self._met = behind
                return relocated(found, places)
        return match

    def _opens(self, word: str) -> bool:
        """Whether a word begins what somebody is told or asked without quotes: `that lunch is ready`, `to wait`."""
        asking = self._vocabulary.asking
        return self._vocabulary.values.texts.opens(word) or word in (*asking["pleading"], *asking["asking_for"])

    def read_met(self, last: int) -> int:
        """Make a rule of the command that is read up to a word, if an event was in it. Return where to go on."""
        met, self._met = self._met, 0
        end = self._rule(met, last) if met else 0
        if met and not end:
            event = self._event(met, self._somebody)
            words = self._text.span(met, event.last if event is not None else last)
            reason, example = "it isn't clear who is meant", f"{self._vocabulary.word('whenever')} ..., ask them ..."
            self._calls.problems.append(diagnostic("BT150", words, words=words.text, reason=reason, example=example))
        return end

    def read(self, at: int) -> int:
        """`say hi to anyone who comes near`: whenever somebody comes near, say hi to them.

        Behind other commands it is a rule for the time of these.
        """
        return self._rule(at, 0) if self._tokens else 0

    def _rule(self, at: int, last: int) -> int:
        tokens = self._tokens
        said = tokens[-1].value
        if not isinstance(said, Called):
            return 0
        kind, is_first = _kind_of(said)
        event = self._event(at, kind or self._somebody)
        if event is None:
            return 0
        last = last or event.last
        if not self._is_end(last):  # `greet everyone who comes in with "Hello"`
            whole = self._partial.in_order([*words_of(self._text, tokens[-1]), *rest_of(self._text, last)])
            if whole is None or whole.meaning.entry is not said.entry or whole.last <= last:
                return 0
            said, last = self._calls.token(whole, at).value, whole.last
        if not isinstance(said, Called) or not self._is_end(last):
            return 0
        everyone = next(iter(said.entry.given(PERSON, said.arguments)), "")
        choice = choice_of(everyone)
        first = statement_start(tokens, len(tokens))
        joint = run_start(tokens, len(tokens) - 1, JOINTS)
        timed = first + (tokens[first].kind in TIMES and joint > first + 1)  # `at noon, go there and greet everyone`
        is_plain = all(token.kind in _SIMPLE or (is_first and token.kind in _PACES) for token in tokens[timed:])
        if choice is None or (choice.parts and not kind) or (ordinal(choice.how) and not is_first) or not is_plain:
            return 0
        if is_first and event.meaning.entry is not None and event.meaning.entry.id == SOMEBODY_SAYS:
            return 0  # `the first person who says yes` is somebody known by then
        if self._of_those_asked(event, said, everyone, joint):
            return last
        spoke = event.meaning.entry is not None and event.meaning.entry.id == SOMEBODY_SAYS
        self._calls.note(event) if kind else self._calls.note_somebody(how=SPEAKING if spoke else "nearest")
        nearest = self._context.latest[PERSON]
        start, end = tokens[-1].start, self._text.ends[last - 1]
        condition = self._calls.token(event, at)
        condition.kind = "condition"
        arguments = tuple((name, nearest if text == everyone else text) for name, text in said.arguments)
        command = Token("command", start, end, said.replace(arguments=arguments))
        if is_first:  # `say hi to the first guest who comes in`
            then = [Token("then", start, start)]
            waits = [*(then if joint > first else ()), Token("wait_until", start, start), condition, *then]
            tokens[max(joint, first) :] = [*waits, command]
            return last
        before = run_start(tokens, first, STATEMENT_ENDS)
        if joint <= first and 0 < before < first and tokens[before - 1].kind == "command":
            tokens[before - 1].role = STAYS  # `go to the door. Say hi to everyone who comes in`
        rule = Token("whenever", start, start)
        if joint > first:  # a rule for the time of what is done before it
            tokens[-1:] = [command, rule, condition]
        else:
            tokens[first:] = [rule, condition, Token("comma", end, end), command]
        return last

    def in_each(self) -> None:
        """`go to the lab and the hall and greet everybody there`: in each of them."""
        if PLACE not in self._context.listed:
            return  # as nearly always
        said, several = self._tokens[-1], choice_of(self._context.listed[PLACE])
        choices = map(choice_of, texts_of(said.value)) if several is not None and isinstance(said.value, Called) else ()
        if several is None or all(one is None or ("inside", f"{{{several.key}}}") not in one.parts for one in choices):
            return
        journey = self._journey(self._tokens[:-1])
        if journey is None or self._tokens[-2].kind != "and" or not self._calls.make_round(journey, several.text):
            words, joint = Span(self._text.source, said.start, said.end), self._vocabulary.word("each_in")
            reason, example = "the places may be meant together", f"... and {joint} each, ..."
            self._calls.problems.append(diagnostic("BT150", words, words=words.text, reason=reason, example=example))

    def _of_those_asked(self, event: Match, said: Called, everyone: str, joint: int) -> bool:
        """`ask everyone "Tea?" and bring a cup to everyone who says yes`: to each of those asked, who says so."""
        tokens, entry = self._tokens, event.meaning.entry
        end = run_start(tokens, joint, JOINTS | STATEMENT_ENDS)
        asked, answered = tokens[end - 1] if end else None, self._vocabulary.entry(ANSWERED)
        if entry is None or entry.id != SOMEBODY_SAYS or answered is None:
            return False
        if asked is None or not is_question(asked) or not isinstance(asked.value, Called | Listed):
            return False
        question = question_to_set(asked.value, self._context.keys.get(PERSON, PERSON))
        people = choice_of(next(iter(question.entry.given(PERSON, question.arguments)), ""))
        reply = next((value.text for value in event.values if value.type == TEXT), "")
        who = next(iter(question.entry.given(PERSON, question.arguments)), "")
        in_round = people is None and self._context.met.get(who[1:-1], False)  # `and ask each of them "Tea?"`
        if not reply or not (in_round or (people is not None and people.how == ALL)):
            return False
        asked.value = question
        here, one = tokens[-1].start, who if people is None else f"{{{people.key}}}"
        arguments = tuple((name, one if text == everyone else text) for name, text in said.arguments)
        condition = Token("condition", here, here, Called(answered, ((answered.slots[0].name, reply),)))
        form = [Token(kind, here, here) for kind in ("comma", "and", "if")]
        command = Token("command", here, tokens[-1].end, said.replace(arguments=arguments))
        tokens[end:] = [*form, condition, Token("comma", here, here), command]
        self._context.latest[PERSON] = one
        return True

    def _event(self, at: int, somebody: str) -> Match | None:
        """What somebody does who is spoken of: `who comes near`, `you meet`."""
        text, asking = self._text, self._vocabulary.asking
        if text.words[at] in asking["who"] and text.words[at + 1] in asking["events"]:
            places, other = [at, *rest_of(text, at + 1)], {0: somebody}
        elif text.words[at] in self._vocabulary.subjects and text.words[at + 1] in asking["events"]:
            places, other = [at, at + 1, at + 1], {2: somebody}
        else:
            return None
        found = match_of(text, places, other, (self._vocabulary.trie,), self._context)
        if found is None and other.keys() == {0}:  # `people who come near`
            found = match_of(
                text, places, {**other, 1: f"{text.words[at + 1]}s"}, (self._vocabulary.trie,), self._context
            )
        is_event = found is not None and found.meaning.role == "condition"
        return relocated(found, places) if found is not None and is_event else None


def question_to_set(asked: Called | Listed, key: str) -> Called:
    """A question to several people as one to a set of them."""
    rows = arguments_of(asked)
    names = [name for row in rows for name in asked.entry.given(PERSON, row)]
    people = Choice(ALL, PERSON, key, ((NAMES, ";".join(names)),)).text if len(rows) > 1 else names[0] if names else ""
    types = {slot.name: slot.type for slot in asked.entry.slots}
    return Called(asked.entry, tuple((name, people if types[name] == PERSON else text) for name, text in rows[0]))


def _kind_of(said: Called) -> tuple[str, bool]:
    """The kind of everybody with whom something is done, "" for others, and whether it is only the first of them."""
    choices = map(choice_of, said.entry.given(PERSON, said.arguments))
    choice = next((each for each in choices if each is not None and (each.how == ALL or ordinal(each.how) == 1)), None)
    parts = dict(choice.parts) if choice is not None else {}
    is_first = choice is not None and choice.how != ALL
    return parts.get("kind", "") if len(parts) == 1 else "", is_first


def with_meetings(tokens: list[Token], vocabulary: Lexicon) -> None:
    """Make `wait for Alice in the lab for 5 min` go to the lab first: she needn't be there yet.

    Until some time it waits there, as `wait for Alice at the lab until 6 pm` does.
    """
    goes = vocabulary.entry(GO)
    for at in reversed(range(len(tokens)) if goes is not None else ()):
        said, start, end = tokens[at].value, tokens[at].start, tokens[at].end
        if goes is None or not isinstance(said, Called) or said.entry.id not in (COMES, ANYBODY_COMES):
            continue  # as nearly always
        if [token.kind for token in tokens[at + 1 : at + 3]] == ["close", "until_time"]:
            until = tokens.pop(at + 2)
            if at and tokens[at - 1].kind == "and":
                tokens[at - 1].kind = "then"
            tokens[at : at + 1] = [Token("open", start, start), tokens[at], until, Token("close", end, end)]
            continue
        if said.entry.id == ANYBODY_COMES:
            continue
        who = choice_of(said.arguments[0][1])
        parts = dict(who.parts) if who is not None else {}
        if parts.keys() == {"inside", "named"}:
            journey = Token("command", start, start, journey_to(parts["inside"], goes))
            tokens[at].value = said.replace(arguments=((said.arguments[0][0], parts["named"]), *said.arguments[1:]))
            _name_behind(tokens[at + 1 :], who.key if who is not None else "", parts["named"])
            tokens[at : at + 1] = [
                Token("open", start, start), journey, Token("then", start, start), tokens[at], Token("close", end, end),
            ]  # fmt: skip


def _name_behind(tokens: Sequence[Token], key: str, name: str) -> None:
    """Write a name for the reference to what is chosen no more, up to where another one is chosen for it."""
    for token in tokens:
        value = token.value
        if not isinstance(value, Called | Listed):
            continue
        if any(choice is not None and choice.key == key for choice in map(choice_of, texts_of(value))):
            return
        named = {f"{{{key}}}": name}
        rows = [tuple((slot, named.get(text, text)) for slot, text in row) for row in arguments_of(value)]
        token.value = with_arguments(value, rows)


def with_sightings(tokens: list[Token], vocabulary: Lexicon, source: Source) -> None:
    """Make `go to the lab and wave at anyone you see` a rule for the journey, which holds on the way and at its end.

    Elsewhere, and at one place with `there`, it is done if somebody is in view then. `wave at the first person you see`
    waits for somebody.
    """
    seen = vocabulary.entry(_SEEN)
    for at in reversed(range(len(tokens)) if seen is not None else ()):
        if seen is not None and _is_whoever(tokens[at], "1"):
            token, start, end = tokens[at], tokens[at].start, tokens[at].end
            awaited = [Token("wait_until", start, start), Token("condition", start, start, Called(seen, ()))]
            opening, then, closing = Token("open", start, start), Token("then", start, start), Token("close", end, end)
            tokens[at : at + 1] = [opening, *awaited, then, token, closing]
            continue
        if seen is None or not _is_whoever(tokens[at], "seen", ALL):
            continue  # as nearly always
        end = tokens[at + 1].start if at + 1 < len(tokens) else len(source.text)
        said = source.text[tokens[at].start : end].lower().replace(",", " ").replace(".", " ").split()
        if vocabulary.subjects.isdisjoint(said):
            continue
        token, start = tokens[at], tokens[at].start
        condition, comma = Token("condition", start, start, Called(seen, ())), Token("comma", start, start)
        is_there = any(PLACE in vocabulary.values.pronouns.get(word, ()) for word in said)
        joint = run_start(tokens, at, JOINTS)
        behind = run_end(tokens, at + 1, JOINTS)
        is_one = is_there and not any(map(_goes_to_several, tokens[statement_start(tokens, at) : joint]))
        if not is_one and _is_behind_journey(tokens, joint, at, behind):
            if behind > at + 1:
                tokens[at + 1 : behind] = [Token("semi", token.end, token.end)]
            tokens[joint:at] = [Token("whenever", start, start, role=ON_WAY), condition, comma]
        else:
            opening, closing = Token("open", start, start), Token("close", token.end, token.end)
            tokens[at : at + 1] = [opening, Token("if", start, start), condition, comma, token, closing]


def _goes_to_several(journey: Token) -> bool:
    """Whether a command has a list of things, or a set."""
    value = journey.value
    choices = map(choice_of, texts_of(value)) if isinstance(value, Called) else ()
    return isinstance(value, Listed) or any(choice is not None and choice.how == ALL for choice in choices)


def _is_behind_journey(tokens: Sequence[Token], joint: int, at: int, behind: int) -> bool:
    """Whether a command goes on with a journey with `and`, and ends the statement but for what is done then."""
    first = statement_start(tokens, at)
    if not first < joint < at or any(token.kind == "then" for token in tokens[joint:at]):
        return False
    is_last = behind == len(tokens) or tokens[behind].kind in (*STATEMENT_ENDS, "dedent")
    goes_on = any(token.kind == "then" for token in tokens[at + 1 : behind])
    before = tokens[first:joint]
    is_plain = all(token.kind in (*_COMMANDS, *JOINTS) for token in before)
    return (is_last or goes_on) and is_plain and any(drives(token.value) for token in before)


def _is_whoever(token: Token, *ways: str) -> bool:
    """Whether a command is about whoever the robot sees, in one of some ways: anyone, everyone, or the first."""
    value = token.value
    if token.kind != "command" or not isinstance(value, Called) or not value.arguments:
        return False
    people = value.entry.given(PERSON, value.arguments)
    choice = choice_of(people[0]) if people else None
    return choice is not None and dict(choice.parts) == {"seen_by": "robot"} and choice.how in ways
