"""Questions that are counted for, and saying what was measured: `how many people are there?`, `who is in the lab?`."""

from __future__ import annotations

from btlang.diagnostics.diagnostic import diagnostic
from btlang.frontends.mission.token import Called, Listed, Remembered, Token, arguments_of, statement_start
from btlang.frontends.mission.tokens.answers import Answers
from btlang.frontends.mission.tokens.counted_answers import COUNTED
from btlang.frontends.mission.tokens.sentence_reader import latest_question
from btlang.tree.answers import EXAMPLE
from btlang.tree.sums import COUNTED_NAMES, COUNTING
from btlang.vocabulary.entry import COUNT, SAY, Entry, Meaning
from btlang.vocabulary.match import Match
from btlang.vocabulary.references import choice_of, free_key, key_of
from btlang.vocabulary.value_type import KINDS, OBJECT, PLACE

ANSWER = "Answer"
"""The id of the quantity that is the latest answer."""
NAMED = "named"
"""The role of a command that counts for the sake of names: `find out who is in the lab and tell Bob`."""
_OF_SEVERAL = "could be that of any of those who were asked"
_MOST_BEFORE_REPLY = 3  # `how many people said yes`


class CountingQuestions(Answers):
    """Those of one text."""

    @property
    def _saying(self) -> Entry | None:
        return self._vocabulary.entry(SAY)

    def _how_many(self, at: int, end: int, command: Token | None = None, slot: str = "") -> int:
        """`how many people are there?`"""
        if answered := self._how_many_said(at, end, command, slot):
            return answered
        counted, count = self._counted(end), self._vocabulary.entry(COUNT)
        if counted is None:
            return self._say_last_count(at, end, command, slot)
        is_over = not set(self._vocabulary.asking["counted"]).isdisjoint(self._text.words[end : counted.last])
        is_over = (is_over and self._has_counted()) or self._has_counted(counted)
        if is_over and count is not None and self._ends(counted.last):  # `say how many people you saw`
            self._say(at, Match(Meaning("quantity", count), counted.last), command, slot)
            return counted.last
        if count is None or not self._ends(counted.last):
            return 0
        return self._say_counted(at, counted, count, command, slot)

    def _how_many_said(self, at: int, end: int, command: Token | None, slot: str) -> int:
        """`ask everyone "Tea?", then tell Bob how many said yes`: the answers that are counted."""
        text, asking = self._text, self._vocabulary.asking
        places = range(end, min(end + _MOST_BEFORE_REPLY, self._end_of_statement(end)))
        verb = next((place for place in places if text.words[place] in asking["replying"]), 0)
        answer = text.words[verb + 1].removeprefix('"') if verb else ""
        if not verb or not self._ends(verb + 2) or latest_question(self._tokens) is None:
            return 0
        key = free_key(key_of([*answer.split(), asking["replying"][0]]), self._context.known or ())
        said = self._say_text(at, verb + 2, f"{{{key}}}", command, slot)
        said.role = f"{COUNTED}|{answer}|{key}"
        return verb + 2

    def _say_last_count(self, at: int, end: int, command: Token | None, slot: str) -> int:
        """`count the boxes, then tell me how many there are`, `then say how many`: what was counted."""
        behind, count = self._phrase(end), self._vocabulary.entry(COUNT)
        is_there = behind is not None and behind.meaning.role == "there_are"
        last = behind.last if behind is not None and is_there else end
        if count is None or not self._ends(last) or not (is_there or self._has_counted()):
            return 0
        self._say(at, Match(Meaning("quantity", count), last), command, slot)
        return last

    def _has_counted(self, things: Match | None = None) -> bool:
        """Whether something has been counted before; `things` that are counted nowhere else, last of all."""
        said = [token.value for token in self._tokens]
        counts = [value for value in said if isinstance(value, Called | Listed) and value.entry.id in COUNTING]
        if things is None or not counts or any(value.type == PLACE for value in things.values):
            return things is None and bool(counts)
        kinds = {value.text for value in things.values if value.type == KINDS}
        last, given = counts[-1].entry, arguments_of(counts[-1])[-1]
        return last is things.meaning.entry and kinds == {*last.given(KINDS, given)}

    def _counted(self, at: int) -> Match | None:
        """The command that counts what words name, with the words that may stand behind that."""
        counted = self._with_front(at - 1, at, "counting")
        if counted is None:
            return None
        behind = self._phrase(counted.last)
        if behind is None or behind.meaning.role != "there_are":
            return counted
        counting, left_out = self._vocabulary.asking["counting"], range(counted.last, behind.last)
        wider = self._partial.with_front(at - 1, at, counting, left_out=left_out)
        if wider is not None and wider.last > behind.last:
            return wider  # `how many people are there in the lab`
        made: Match = counted.replace(last=behind.last)
        return made

    def _say_counted(self, at: int, counted: Match, entry: Entry, command: Token | None, slot: str) -> int:
        """Count, and say a quantity of what was counted."""
        self._tokens.append(self._calls.token(counted, at))
        self._tokens.append(Token("and", self._text.starts[at], self._text.starts[at]))  # `in each room, say how many`
        self._say(at, counted.replace(meaning=counted.meaning.replace(entry=entry), values=()), command, slot)
        return counted.last

    def _who(self, at: int, end: int, command: Token | None = None, slot: str = "") -> int:
        """`who is in the lab?`, `tell Bob who is there`: counts the people, and says who they are."""
        return self._say_names(at, end, "counting_people", command, slot)

    def _what(self, at: int, end: int, command: Token | None = None, slot: str = "") -> int:
        """`what is on the desk?`, `tell Bob what is there`: counts the things, and says what they are."""
        begin = end + (self._text.words[end] in self._vocabulary.forms_of_be)
        if not self._is_what(begin - 2) or self._text.words[begin - 1] not in self._vocabulary.forms_of_be:
            return 0
        named = self._say_names(at, begin, "counting_things", command, slot)
        return named or self._say_chosen(at, begin, command, slot)

    def _say_chosen(self, at: int, begin: int, command: Token | None, slot: str) -> int:
        """`what is the largest object on the table?`: looks there, chooses one, and says its name."""
        thing = self._context.read(OBJECT, self._text, begin)
        choice = choice_of(thing[0] or "") if thing is not None else None
        counted = self._counted_there(thing[1], "counting_things") if thing is not None else None
        if choice is None or counted is None:
            return 0
        there = next(value.text for value in counted.values if value.type == PLACE)
        chosen = choice.replace(parts=(*choice.parts, ("at", there))).text
        self._tokens.append(self._calls.token(counted, at))
        self._then(at)
        self._say_text(at, counted.last, chosen, command, slot)
        return counted.last

    def _is_what(self, at: int) -> bool:
        """Whether a word asks for things."""
        return self._text.words[at] in self._vocabulary.asking["what"]

    def _find_who(self, at: int, end: int, command: Token | None = None, slot: str = "") -> int:
        """`find out who is in the lab`: counts the people there, so that somebody may be told."""
        counted = self._counted_there(end, "counting_things" if self._is_what(end - 2) else "counting_people")
        if counted is None or command is not None:
            return 0
        self._tokens.append(self._calls.token(counted, at))
        self._tokens[-1].role = NAMED
        return counted.last

    def _say_names(self, at: int, end: int, counting: str, command: Token | None, slot: str) -> int:
        counted, names = self._counted_there(end, counting), self._vocabulary.entry(COUNTED_NAMES)
        if counted is None or names is None:
            return 0
        return self._say_counted(at, counted, names, command, slot)

    def _counted_there(self, at: int, counting: str) -> Match | None:
        """The command that counts what is at a place, which the words behind `who is` say."""
        asking = self._vocabulary.asking
        counted = self._with_front(at - 1, at, counting)
        if counted is None or not counted.values:  # `who is there`
            counted = self._partial.with_front(at - 1, at, (*asking[counting], *asking["located"][:1]))
        return counted if counted is not None and counted.values and self._ends(counted.last) else None

    def _saying_of(self, words: str) -> Called:
        assert self._saying is not None
        return Called(self._saying, ((self._saying.slots[0].name, words),))

    def _then(self, at: int) -> None:
        self._tokens.append(Token("then", self._text.starts[at], self._text.starts[at]))

    def _say(self, at: int, measured: Match, command: Token | None = None, slot: str = "", adds: bool = False) -> None:
        """Remembers what is measured and says it, with a command or the one that says."""
        key = self._remember(at, measured)
        self._then(at)
        self._say_text(at, measured.last, f"{{{key}}}", command, slot, adds)

    def _remember(self, at: int, measured: Match) -> str:
        """Remembers what is measured, under the key that this returns."""
        entry, text = measured.meaning.entry, self._text
        assert entry is not None
        if entry.id == ANSWER and self._asks_several():
            words = text.span(at, measured.last)
            problem = diagnostic("BT144", words, words=words.text, problem=_OF_SEVERAL, example=EXAMPLE)
            self._calls.problems.append(problem)
        key = self._key(entry)
        remembered = Remembered(key, entry, self._calls.arguments(entry, measured.values))
        self._tokens.append(Token("command", text.starts[at], text.ends[measured.last - 1], remembered))
        return key

    def _say_text(self, at: int, last: int, words: str, command: Token | None, slot: str, adds: bool = False) -> Token:
        """Says a text up to a word, with a command or the one that says; returns that."""
        end = self._text.ends[last - 1]
        if command is None:
            command = Token("command", self._text.starts[at], end, self._saying_of(words))
        else:
            self._set_text(command, slot, words, adds)
            command.end = end
        self._tokens.append(command)
        return command

    def _asks_several(self) -> bool:
        """Whether the latest question went to several people: `ask each of them "Tea?", then say what they said`."""
        asked = latest_question(self._tokens)
        if asked is None or isinstance(asked.value, Listed):
            return asked is not None
        said = {text for _, text in asked.value.arguments} if isinstance(asked.value, Called) else set()
        before = self._tokens[: self._tokens.index(asked)]
        if statement_start(self._tokens, len(self._tokens)) <= len(before):
            return False  # in the round
        return any(self._calls.is_round(token, text) for token in before for text in said if text[:1] == "{")

    def _key(self, entry: Entry) -> str:
        """A free key for what a quantity measures, by its words."""
        words = entry.quantity[0].split()
        slot = next((at for at, word in enumerate(words) if "{" in word), len(words) + 1)
        return free_key(key_of(words[: slot - 1]), self._context.known or ())
