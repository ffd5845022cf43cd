"""Conditions that are not said as their phrases are: `it is at least 80%`, `the battery's low`, `nobody has been near`.

They are read as the words that they stand for would be, in a text put together for that.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

from btlang.frontends.mission.token import HOLDING, RULES, Called, Remembered, Token, statement_start
from btlang.frontends.mission.tokens.partial_commands import LONGEST_VERB, PartialCommands
from btlang.frontends.mission.tokens.word_matches import match_of, relocated, rest_of, words_of
from btlang.text.words import END_OF_STATEMENT, END_OF_TEXT
from btlang.vocabulary.entry import Entry
from btlang.vocabulary.match import Match
from btlang.vocabulary.trie import longest
from btlang.vocabulary.value_type import OBJECT, PERSON, WORLD
from btlang.vocabulary.word_tree import find

_BETWEEN = frozenset(("every", "comma", "and", "then"))
_UNTIL = ("until", "wait_until")
_COUNTS, _MORE = ("PeopleAt", "ObjectsAt"), {"above", "at_least"}
_ASKED = tuple([form, "condition", "comma"] for form in (*RULES, "if"))


class PartialConditions(PartialCommands):
    """Those of one text, and its commands that are not written whole."""

    def add_condition(self, at: int) -> int:
        """A condition that isn't said as its phrases are. Returns where to go on, 0 where there is none."""
        ways = (
            self._add_quantity, self._add_contracted, self._add_lasting, self._add_ended, self._add_denied,
            self._add_elliptic,
        )  # fmt: skip
        return next((end for way in ways if (end := way(at))), 0)

    def _add_quantity(self, at: int) -> int:
        """`charge until it is at least 80%`: the latest quantity is compared, or the only one with that unit."""
        if OBJECT not in self._vocabulary.values.pronouns.get(self._text.words[at], ()):
            return 0
        spoken = (token.value for token in reversed(self._tokens) if isinstance(token.value, Called | Remembered))
        latest = next((entry for value in spoken if (entry := self._measured_by(value.entry)) is not None), None)
        if latest is None and OBJECT in self._context.latest:
            return 0  # `pick up the cup. If it is below 50%, A`
        found: dict[str, tuple[Match, Sequence[int]]] = {}
        for entry in [latest] if latest is not None else self._measuring:
            words = entry.quantity[0].split()
            places = [*[at] * len(words), *rest_of(self._text, at + 1)]
            match = match_of(self._text, places, dict(enumerate(words)), self._tries, self._context)
            if match is not None and match.meaning.entry is not None and match.last > len(words):
                is_about = latest is not None or match.meaning.entry.quantity == entry.quantity
                if match.meaning.role == "condition" and is_about:
                    found[entry.id] = match, places
        if len(found) != 1:
            return 0
        match = relocated(*next(iter(found.values())))
        self.append(match, at)
        return match.last

    def _measured_by(self, entry: Entry) -> Entry | None:
        """The quantity that a command or condition is about: `the battery is low`."""
        if entry.measures:
            return entry
        said = entry.phrases[0].split() if entry.sort == "condition" and entry.phrases else []
        begun = (each for each in self._measuring if (words := each.quantity[0].split()) == said[: len(words)])
        return next(begun, None)

    @cached_property
    def _measuring(self) -> list[Entry]:
        """The quantities with a unit."""
        vocabulary = self._vocabulary
        entries = (entry for same in vocabulary.entries.values() for entry in same if entry.measures)
        return [entry for entry in entries if vocabulary.types[entry.measures].kind == "quantity"]

    def _add_contracted(self, at: int) -> int:
        """`if the battery's low`: a condition with a verb that is only an ending of the word before it."""
        words, ending = self._text.words, self._vocabulary.values.adjectives.ending
        be = self._vocabulary.asking["asking_be"][:1]
        verbs = range(at, min(at + LONGEST_VERB, len(words)) if be and ending else at)
        for place in (place for place in verbs if words[place].endswith(ending)):
            places = [*range(at, place + 1), *rest_of(self._text, place)]
            other = {place - at: words[place].removesuffix(ending), place - at + 1: be[0]}
            match = match_of(self._text, places, other, self._tries, self._context)
            if match is not None and match.meaning.role in ("condition", "negated") and match.last > place - at + 2:
                return self._condition(relocated(match, places), at)
        return 0

    def _add_lasting(self, at: int) -> int:
        """`whenever nobody has been near for 5 min`: a condition that has held for some time."""
        forms = ((form.split(), verb) for form, verb in self._vocabulary.perfect.items())
        for form, verb in forms:
            for place in range(at, min(at + LONGEST_VERB, len(self._text.words))):
                if self._text.words[place : place + len(form)] != form:
                    continue
                places = [*range(at, place + 1), *rest_of(self._text, place + len(form))]
                match = match_of(self._text, places, {place - at: verb}, self._tries, self._context)
                if match is None or match.meaning.role not in ("condition", "negated"):
                    continue
                found = relocated(match, places)
                behind = longest(self._vocabulary.trie, self._text, found.last, self._context)
                if behind is not None and behind.meaning.role in HOLDING:
                    return self._condition(found, at)
        return 0

    def _add_ended(self, at: int) -> int:
        """`if something is in the way, wait until it's gone`: until what the form before asks isn't so any more."""
        tokens, ended = self._tokens, find(self._vocabulary.ended, self._text.words, at)
        first = statement_start(tokens, len(tokens))
        form = [token.kind for token in tokens[first : first + 3]]
        if ended is None or tokens[-1].kind not in _UNTIL or form not in _ASKED:
            return 0
        asked = tokens[first + 1].value
        counts = asked if isinstance(asked, Called) and asked.entry.id in _COUNTS else None
        if ended[0] and (counts is None or not dict(counts.arguments).keys() & _MORE):
            return 0  # `if there are more than 3 people in the lab, wait until there are fewer`
        start, end = self._text.starts[at], self._text.ends[ended[1] - 1]
        tokens += [Token("not", start, start), Token("condition", start, end, asked)]
        return ended[1]

    def _add_denied(self, at: int) -> int:
        """`check that the door is closed, and close it if it isn't`: closes it if it isn't closed."""
        tokens, denied = self._tokens, find(self._vocabulary.denied, self._text.words, at)
        form = len(tokens) - 1
        first = statement_start(tokens, form)
        check = next((i for i in range(first, form) if tokens[i].kind == "check"), form)
        between = tokens[check + 2 : form - 1]
        plain = all(token.kind in _BETWEEN for token in between)
        is_form = tokens[form].kind == "if" and form - check > 2 and tokens[form - 1].kind == "command" and plain
        if denied is None or not is_form or self._text.words[denied[1]] not in (END_OF_STATEMENT, END_OF_TEXT):
            return 0
        asked, command, here = tokens[check + 1], tokens[form - 1], tokens[form].start
        paces = [token for token in between if token.kind == "every"]
        comma = Token("comma", here, here)
        tokens[check:] = [
            *paces, *([comma] if paces else []), tokens[form], Token("not", here, here), asked, comma, command,
        ]  # fmt: skip
        return denied[1]

    def _add_elliptic(self, at: int) -> int:
        """`if Alice isn't in the lab, A, and if Bob isn't, B`: the same is asked of somebody or something else.

        `check that Bob is in the lab. If he isn't, A`: of him.
        """
        text, tokens, be = self._text, self._tokens, self._vocabulary.forms_of_be
        kinds = self._context.pronouns.get(text.words[at], ())
        named = [find(self._vocabulary.values.names_tree(kind), text.words, at) for kind in WORLD]
        verb = max((name[1] for name in named if name is not None), default=at + (PERSON in kinds))
        before = next((token for token in reversed(tokens[:-1]) if token.kind == "condition"), None)
        if verb == at or text.words[verb] not in be or before is None or tokens[-1].kind not in ("if", "unless"):
            return 0
        if text.words[verb + 1] not in (",", END_OF_STATEMENT, END_OF_TEXT):
            return 0
        said = list(words_of(text, before))
        if PERSON in kinds and isinstance(before.value, Called):
            if before.value.entry.given(PERSON, before.value.arguments) != [self._context.latest.get(PERSON)]:
                return 0
            tokens += [Token("not", text.starts[verb], text.ends[verb])] if be[text.words[verb]] else []
            tokens.append(Token("condition", text.starts[at], text.ends[verb], before.value))
            return verb + 1
        asked = next((place for place in said if text.words[place] in be), None)
        if asked is None or said[-1] == asked:
            return 0
        places = [*range(at, verb + 1), *range(asked + 1, said[-1] + 1)]
        other = {verb - at: self._vocabulary.asking["asking_be"][0]}
        match = match_of(text, [*places, places[-1]], other, self._tries, self._context)
        if match is None or match.meaning.role not in ("condition", "negated") or match.last != len(places):
            return 0
        if be[text.words[verb]]:
            tokens.append(Token("not", text.starts[at], text.starts[at]))
        self._condition(relocated(match, places), at)
        tokens[-1].end = text.ends[verb]
        return verb + 1

    def _condition(self, found: Match, at: int) -> int:
        """Add a condition, or its denial. Returns where to go on."""
        if found.meaning.role != "condition":
            self._tokens.append(Token("not", self._text.starts[at], self._text.starts[at]))
        self.append(found, at)
        return found.last
