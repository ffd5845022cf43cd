"""Questions and values in speech: `is the battery low?`, `say the battery`, `tell me the answer`."""

from __future__ import annotations

import re
from collections.abc import Mapping

from btlang.diagnostics.diagnostic import diagnostic
from btlang.frontends.mission.token import Called, Listed, Token, arguments_of, texts_of
from btlang.frontends.mission.tokens.addressed_texts import TELL
from btlang.frontends.mission.tokens.ended_rules import THERE
from btlang.frontends.mission.tokens.hearers import person_of
from btlang.frontends.mission.tokens.questions import Questions
from btlang.text.source import Span
from btlang.tree.answers import ASK
from btlang.vocabulary.antecedents import pronouns_for, says_there
from btlang.vocabulary.entry import SAY, Entry
from btlang.vocabulary.match import Match
from btlang.vocabulary.references import choice_of
from btlang.vocabulary.value_type import DOOR, OBJECT, PERSON, TEXT
from btlang.vocabulary.word_tree import find

_EXAMPLE = "hello"
_HOW, _STANDS = "says how, but not what", "stands for what isn't said"
_SEES = "perception"
_OPTIONAL = re.compile(r"\[.*?\]")
_BETWEEN = frozenset(("semi", "newline", "comma", "then", "and", "stop"))
_OF_CONDITIONS = frozenset(("condition", "not", "and", "or", "either", "neither", "nor", "both"))


class Requests(Questions):
    """Those of one text."""

    def question(self, match: Match | None, role: str, at: int) -> int:
        """A question at the start of a statement."""
        if self._saying is None:
            return 0
        read = self._readers.get(role)
        return read(at, match.last) if match is not None and read is not None else self._whether(at)

    def value_in(self, match: Match, at: int, command: Token) -> int:
        """`say the battery`, `say how many people there are`: an article or a question word asks for a value."""
        entry = match.meaning.entry
        value = next((value for value in match.values if value.type == TEXT), None)
        if value is None or entry is None or entry.sort != "action":
            return 0
        if self._text.words[value.first][0] == '"':
            return self._value_behind(value.last, value.name, at, command) if value.last == match.last else 0
        values, word = self._vocabulary.values, self._text.words[value.first]
        owners = {*values.adjectives.own, *values.adjectives.other_owners}
        owned = self._measured(value.first) if word in owners else None
        if owned is not None and self._ends(owned.last) and entry.id in (SAY, TELL):
            self._say(at, owned, command, value.name)  # `tell Bob her answer`
            return owned.last
        is_pronoun = word not in values.ones and find(values.pronoun_words, self._text.words, value.first) is not None
        is_so = word in self._vocabulary.asking["so"] and self._ends(value.first + 1)
        if is_so and entry.id in (SAY, TELL) and (said := self._asked_of()):  # `if you can't find it, say so`
            self._set_text(command, value.name, said)
            return 0
        goes_on = entry.id == TELL and value.last == match.last and self._goes_on(value.last)  # `tell her it is late`
        if (is_pronoun or is_so) and value.last == value.first + 1 and not goes_on and entry.id in (SAY, TELL):
            self._doubt(entry, value.first)  # `say it again`
            return 0
        if value.last == value.first + 1 and not goes_on and entry.id in (SAY, TELL):
            asking, is_how = self._vocabulary.asking, word in self._context.manners
            reason = _HOW if is_how or word in asking["of_voice"] else _STANDS if word in asking["unsaid"] else ""
            if reason and self._doubt(entry, value.first, reason):
                return 0
        again = self._phrase(value.first)
        if again is not None and again.meaning.role == "again":
            self._repeat(entry, value, command)
            return 0
        if entry.id in (ASK, TELL) and (end := self._say_too(entry, value, command)):
            return end
        likewise = find(self._vocabulary.likewise, self._text.words, value.first)
        if entry.id == TELL and likewise is not None and self._ends(likewise[1]):
            self._doubt(entry, value.first)  # `tell Bob too` behind nothing that was told
            return 0
        if entry.id == TELL and self._behind_manner(value.first) > value.first:  # `tell Bob right away`
            return self._inform(at) or self._miss_text(at, value.first, command)
        if entry.id == ASK:
            return self._ask(entry, value, command)
        if self._is_clause(value):
            end = self._end_before_command(value.first, value.last, is_told=True)
            end = end or self._note_form(command, value.first, value.last)
            last = end or value.last
            heard = self._to_hearer(command, value.first, last, is_asked=False)
            self._doubt_words(entry, command, value.first, last, heard)
            if end or heard is not self._text:
                return self._say_clause(value, last, command, heard)
            at_end = self._measure_in(value.first, last)
            self._doubt(entry, at_end or self._addressee(value.first + 1, last) * (entry.id == SAY))
        if not (entry.accompaniment or "voice" in entry.needs):
            return 0  # a text that nobody says is its words: `listen for the bell`
        text, first = self._text, value.first
        asked = self._phrase(first)
        if asked is not None and asked.meaning.role in ("ask_how_many", "ask_who"):
            if end := self._readers[asked.meaning.role](at, asked.last, command, value.name):
                return end
        is_timed = asked is not None and asked.meaning.role == "as_soon_as"
        if entry.id == TELL and (is_timed or text.words[first] in self._vocabulary.roles["and"]):
            return self._inform(at)  # `tell Bob and wave`, `tell Bob as soon as the door is open`
        asking = self._vocabulary.asking
        if entry.id == TELL and text.words[first - 1] in (*asking["pleading"], *asking["asking_for"]):
            return self._plead(entry, value, at, command)
        if text.words[at] in self._vocabulary.asking["wishing"] and first in text.articles and not self._is_end(first):
            return self._wish(value, command)
        if end := self._miss_values(value.first, command):
            return end
        named = self._measured(first) if first in text.articles else None
        is_value = named is not None and self._ends(named.last)  # `tell Bob the last count`
        if entry.id == TELL and value.last == match.last and self._goes_on(match.last) and not is_value:
            return self._miss_clause(value.first, at, command) or self._tell(entry, value, command)
        if first not in text.articles or value.last != first + 1:
            return 0
        is_last = value.last == match.last
        known = self._context.named(text, first)
        measured = self._measured(first)
        if known is not None and known[0] is not None and (measured is None or known[1] >= measured.last):
            self._set_text(command, value.name, f"{{{known[0].key}}}")
            self._tokens.append(command)
            return known[1] if is_last else match.last
        if measured is None or not (is_last or measured.last == value.last):
            span = text.span(first, value.last)
            quoted = f'{text.span(at, first).text} "{span.text}"'
            self._calls.problems.append(
                diagnostic("BT157", span, words=span.text, values=self._values(), quoted=quoted)
            )
            return 0
        self._say(at, measured, command, value.name)
        return measured.last if is_last else match.last

    def _miss_values(self, at: int, command: Token) -> int:
        """BT157 for `tell Bob both numbers`: there is only the last one. Returns where to go on, 0 for other words."""
        text, values = self._text, self._vocabulary.values
        several, end = {*values.both, *self._vocabulary.roles["all_names"]}, at
        while text.words[end] in several or values.is_number([text.words[end]]):
            end += 1
        one = text.words[end].removesuffix("s")
        is_value = end > at and one != text.words[end] and any(one in tree for tree in self._vocabulary.measured)
        if not (is_value and self._ends(end + 1)):
            return 0
        span = text.span(at, end + 1)
        problem = diagnostic("BT157", span, words=span.text, values=self._values(), quoted=f'... "{span.text}"')
        self._calls.problems.append(problem)
        self._tokens.append(command)
        return end + 1

    def _miss_clause(self, first: int, at: int, command: Token) -> int:
        """BT157 for `tell Bob the exact time`, which is no sentence. Returns where to go on, 0 for one that may be."""
        text, texts = self._text, self._vocabulary.values.texts
        end = texts.end_of_clause(text, first)
        if first not in text.articles or not end or texts.has_verb(text.words[first:end]):
            return 0
        span = text.span(first, end)
        quoted = f'{text.span(at, first).text} "{span.text}"'
        self._calls.problems.append(diagnostic("BT157", span, words=span.text, values=self._values(), quoted=quoted))
        self._tokens.append(command)
        return end

    def _value_behind(self, at: int, slot: str, first: int, command: Token) -> int:
        """`say "it is" and the time`: the text, then the value."""
        text = self._text
        if text.words[at] not in self._vocabulary.roles["and"] or at + 1 not in text.articles:
            return 0
        known, measured = self._context.named(text, at + 1), self._measured(at + 1)
        if known is not None and known[0] is not None and (measured is None or known[1] >= measured.last):
            self._set_text(command, slot, f"{{{known[0].key}}}", adds=True)
            self._tokens.append(command)
            return known[1]
        if measured is None or not self._ends(measured.last):
            return 0
        self._say(first, measured, command, slot, adds=True)
        return measured.last

    def begged(self, at: int) -> int:
        """`the cup, please`: brings it."""
        text, begging = self._text, self._vocabulary.asking["begging"]
        if text.distinct.isdisjoint(begging) or text.words[at + self._length(at)] not in begging:
            return 0
        wanted = self._with_front(at, at, "fetching")
        if wanted is None:
            return 0
        end = self._behind_comma(wanted.last)
        if text.words[end] not in begging or not self._is_end(end + 1):
            return 0
        self._partial.append(wanted, at)
        return end + 1

    def benefit(self, at: int) -> int:
        """`open the door for Bob`: BT158 notes that it doesn't matter for whom something is done with a thing."""
        words, done = self._text.words, self._tokens[-1].value if self._tokens else None
        benefiting = self._vocabulary.values.role_words.introducing.get("beneficiary", ())
        if (words[at],) not in benefiting or not isinstance(done, Called) or done.entry.first:
            return 0
        given = {kind: done.entry.given(kind, done.arguments) for kind in (PERSON, OBJECT, DOOR)}
        if given[PERSON] or not (given[OBJECT] or given[DOOR]):
            return 0  # `look around for Bob`
        named = find(self._vocabulary.values.names_tree(PERSON), words, at + 1)
        end = named[1] if named is not None else at + 2
        if (named is None and not person_of(words[at + 1], self._vocabulary)) or not self._ends(end):
            return 0
        self._calls.problems.append(diagnostic("BT158", (span := self._text.span(at, end)), words=span.text))
        return end

    def _values(self) -> str:
        """What can be said so, for a message."""
        known = sorted(" ".join(value.words) for value in (self._context.known or {}).values() if not value.is_chosen)
        quantities = [entries[0] for entries in self._vocabulary.entries.values() if entries[0].measures]
        return ", ".join([*known, *(each.quantity[0] for each in quantities if "{" not in each.quantity[0])])

    def tell(self, at: int) -> int:
        """`tell me "hello"`: says it; `if the door is open, tell me`: says what was asked."""
        told, text = find(self._vocabulary.telling, self._text.words, at), self._text
        if told is None or self._saying is None:
            return self._inform(at)
        if end := self._indirect(at, told[1], self._saying_of("")):
            return end
        if text.words[told[1]][0] == '"':
            said, end = text.words[told[1]][1:], told[1] + 1
        elif self._opens_clause(told[1]):
            said, end = self._clause(self._saying, at, told[1])
        else:
            said, end = self._asked_of() if self._ends(told[1]) else "", told[1]
        if not said and not self._ends(end):
            return 0
        command = Token("command", text.starts[at], text.ends[end - 1], self._saying_of(said))
        if not said:
            slot = next(slot.name for slot in self._saying.slots if slot.type == TEXT)
            if last := self._found_whether(at, end, self._saying_of(""), slot):
                return last
            return self._found_out(at, end, self._saying_of(""), slot) or self._miss_text(at, end, command)
        self._tokens.append(command)
        return end

    def _miss_text(self, at: int, end: int, command: Token) -> int:
        """BT012 for a command that doesn't say what to tell; return where to go on."""
        words = self._text.span(at, end)
        example = f'{words.text} "{_EXAMPLE}"'
        self._calls.problems.append(diagnostic("BT012", words, words=words.text, wanted="a text", example=example))
        self._tokens.append(command)
        return self._behind_manner(end)

    def said(self, token: Token, at: int) -> None:
        """See Answers; BT151 for `make sure the door is closed`, which could also mean to close it."""
        super().said(token, at)
        asked, check = token.value, self._tokens[-1] if self._tokens else None
        if check is None or check.kind != "check" or not isinstance(asked, Called | Listed) or self._goes_on_if(at):
            return
        source = self._text.source
        if " ".join(source.text[check.start : check.end].lower().split()) not in self._vocabulary.asking["making_sure"]:
            return
        bringing = (
            entries[0] for entries in self._vocabulary.entries.values() if asked.entry.id in entries[0].achieves
        )
        things = dict(arguments_of(asked)[0])
        if isinstance(asked, Listed) or any(choice_of(text) is not None for text in things.values()):
            values = self._vocabulary.values
            them = {slot.name: pronouns_for(values.pronouns, slot.type) for slot in asked.entry.slots}
            plural = values.plural_pronouns.intersection
            things = {name: next(iter(plural(them[name])), text) for name, text in things.items()}
        does = next((said for entry in bringing if (said := _said_with(entry, things))), "")
        if does:
            words, span = source.text[token.start : token.end], Span(source, check.start, token.end)
            one, unless = (self._vocabulary.word(role) for role in ("check", "unless"))
            other = f"{unless} {words}, {does}"
            goes_on = source.text[token.end :].lstrip(" ")[:1] not in ("", *".;!?)\r\n")
            other = f"({other})" if goes_on else other  # else what follows would depend on it, too
            self._calls.problems.append(diagnostic("BT151", span, words=span.text, one=f"{one} {words}", other=other))

    def _goes_on_if(self, at: int) -> bool:
        """Whether more is said about a condition in its statement: `make sure that A, if not do B`."""
        words = self._text.words[at : at + self._length(at) + 1]
        return not {self._vocabulary.word("if"), self._vocabulary.word("otherwise")}.isdisjoint(words)

    def finding_out(self, end: int) -> None:
        """`check whether A. If B, C`: what is checked decides nothing by itself, behind the `if` that ends at a word.

        `check that A. If B, C` is the same where both are about one thing.
        """
        tokens, at = self._tokens, len(self._tokens) - 2
        while (at >= 0 and tokens[at].kind in _BETWEEN) or tokens[at].kind == "at":  # `check C at 9 pm. If not, A`
            at -= 1
        while at >= 0 and tokens[at].kind in _OF_CONDITIONS:
            at -= 1
        if at >= 0 and tokens[at].kind == "check":
            written = self._text.source.text[tokens[at].start : tokens[at].end].lower()
            following = self._phrase(end)
            asked = {value.text for value in following.values} if following is not None else set()
            said = [token.value for token in tokens[at:] if isinstance(token.value, Called | Listed)]
            same = any(asked.intersection(texts_of(value)) for value in said)
            if following is not None and following.meaning.entry is not None and not same:
                seen = THERE.get(following.meaning.entry.id, "")
                is_there = says_there(self._text.span(end, following.last).text, self._vocabulary.values.pronouns)
                same = is_there and any(value.entry.id == seen for value in said)
            elif following is None and PERSON in self._context.pronouns.get(self._text.words[end], ()):
                same = self._text.words[end + 1] in self._vocabulary.forms_of_be  # `if he isn't`
            if " ".join(written.split()) in self._vocabulary.asking["finding_out"] or same:
                tokens.insert(at, Token("try", tokens[at].start, tokens[at].start))

    def otherwise(self) -> None:
        """`check that A, if not do B`: the `if not` at the end is for a command."""
        tokens = self._tokens
        if len(tokens) > 2 and tokens[-2].kind == "if" and tokens[-3].kind in ("comma", "condition", "command"):
            tokens[-2:] = [Token("otherwise", tokens[-2].start, tokens[-1].end)]


def _said_with(entry: Entry, values: Mapping[str, str]) -> str:
    """How an entry is said with these values alone; "" where it needs others."""
    said = next(iter(entry.phrases), "") if _SEES not in entry.needs else ""  # to look for somebody brings nobody
    for name, value in values.items():
        said = said.replace(f"[{{{name}}}]", value).replace(f"{{{name}}}", value)
    said = " ".join(_OPTIONAL.sub("", said).split())
    return "" if "{" in said else said
