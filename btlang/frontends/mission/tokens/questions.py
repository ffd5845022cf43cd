"""Questions: `is the battery low?`, `where is the cup?`, `how many people are there?`.

Each becomes the commands that answer it: what is asked is measured, and said.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property

from btlang.diagnostics.diagnostic import diagnostic
from btlang.frontends.mission.token import (
    JOINTS,
    STATEMENT_ENDS,
    Called,
    Listed,
    Remembered,
    Token,
    drives,
    run_start,
)
from btlang.frontends.mission.tokens.addressed_texts import TELL
from btlang.frontends.mission.tokens.counting_questions import ANSWER, NAMED, CountingQuestions
from btlang.frontends.mission.tokens.sentence_reader import is_question
from btlang.frontends.mission.tokens.settling import IMPLIED
from btlang.text.words import END_OF_STATEMENT, END_OF_TEXT
from btlang.tree.sums import COUNTED_NAMES, COUNTING
from btlang.vocabulary.entry import COUNT, RECIPIENT, Entry, Meaning
from btlang.vocabulary.match import Match
from btlang.vocabulary.trie import longest
from btlang.vocabulary.value_type import PERSON, TEXT
from btlang.vocabulary.word_tree import find

_BETWEEN = (*JOINTS, *STATEMENT_ENDS)
_MOST_WORDS = 8  # of the subject of a question
_DEPENDS = "may begin what is told, as 'whether' does, or say when it is told"


class Questions(CountingQuestions):
    """Those of one text."""

    @cached_property
    def _readers(self) -> Mapping[str, Callable[..., int]]:
        """What reads the words behind the words of each role, up to where it returns; 0 if they ask for nothing."""
        return {
            "ask_value": self._asked, "ask_where": self._where, "ask_how_many": self._how_many, "ask_who": self._who,
            "find_who": self._find_who, "find_where": self._find_where,
        }  # fmt: skip

    def _measured(self, at: int) -> Match | None:
        """The quantity that words name."""
        found = [longest(trie, self._text, at, self._context) for trie in self._vocabulary.measured]
        return max((match for match in found if match is not None), key=lambda match: match.last, default=None)

    def _asked(self, at: int, end: int, command: Token | None = None, slot: str = "") -> int:
        """`what is the battery?`, `what the battery is`"""
        measured = self._measured(end)
        if measured is None:
            return self._what(at, end, command, slot)
        behind = self._phrase(measured.last)
        last = behind.last if behind is not None and behind.meaning.role == "there_are" else measured.last
        if command is not None and self._text.words[last] in self._vocabulary.values.texts.inverting:
            last += 1
        last = self._behind_speaker(last)
        if not self._ends(last):
            return 0
        self._say(at, measured, command, slot)
        return last  # `how much battery do you have left?`

    def _behind_speaker(self, at: int) -> int:
        """Where to go on behind words that say that the speaker is told: `report the number to me`."""
        words, roles = self._text.words, self._vocabulary.values.role_words
        is_told = (words[at],) in roles.introducing.get(RECIPIENT, ()) and words[at + 1 : at + 2] != []
        return at + 2 if is_told and words[at + 1] in roles.speaker else at

    def _where(self, at: int, end: int, command: Token | None = None, slot: str = "") -> int:
        """`where is the cup?`, `where the cup is`: looks for it and says where it is."""
        found = self._search(at, end)
        if found is None:
            return 0
        self._say(at, found[0], command, slot)
        return found[1]

    def _search(self, at: int, end: int) -> tuple[Match, int] | None:
        """Looks for what the words behind `where is` name; returns the quantity that is its place, and where they end.

        None where they name nothing, or more than one.
        """
        measured = self._partial.with_front(
            at, end, self._vocabulary.asking["whereabouts"], self._vocabulary.quantities
        )
        if measured is None or any(value.more or value.group for value in measured.values):
            return None
        last, inverting = measured.last, self._vocabulary.values.texts.inverting
        if self._text.words[last] in inverting and self._text.words[end - 1] not in inverting:
            last += 1
        if not self._ends(last):
            return None
        if measured.values:
            search = self._with_front(at, end, "search")
            if search is None or search.last != measured.last:
                return None
            self._partial.append(search, at)
            self._tokens[-1].role = IMPLIED
            self._then(at)
        return measured, last

    def _find_where(self, at: int, end: int, command: Token | None = None, slot: str = "") -> int:
        """`find out where the cup is`: looks for it, so that somebody may be told where it is."""
        found = self._search(at, end) if command is None else None
        if found is None:
            return 0
        self._remember(at, found[0])
        return found[1]

    def _inform(self, at: int) -> int:
        """`if the door is open, tell Bob`: tells him what was asked."""
        text, entry, asking = self._text, self._vocabulary.entry(TELL), self._vocabulary.asking
        person = self._context.read(PERSON, text, at + 1) if text.words[at] in asking["informing"] else None
        if person is None or entry is None or not person[0] or person[0][:1] == "{":
            return 0
        end = self._behind_manner(person[1] + (text.words[person[1]] in asking["informed"]))
        slots = {slot.type: slot.name for slot in entry.slots}
        said = self._asked_of() if self._ends(end) else ""
        told = Called(entry, ((slots[PERSON], person[0]), (slots[TEXT], said)))
        if not said:
            found = self._ends(end) and self._found_whether(at, end, told, slots[TEXT])
            return found or self._found_out(at, end, told, slots[TEXT]) or self._indirect(at, end, told)
        self._tokens.append(Token("command", text.starts[at], text.ends[end - 1], told))
        return end

    def _found_out(self, at: int, end: int, told: Called, slot: str) -> int:
        """`ask Bob what he wants and tell Alice`, `count the cups, come back and tell me`: the answer, or how many."""
        done = (each for each in reversed(self._tokens) if each.kind not in _BETWEEN)
        before = next((each for each in done if not drives(each.value) or _finds_out(each)), None)
        if before is None or not isinstance(before.value, Called | Listed | Remembered) or not self._ends(end):
            return 0
        if isinstance(before.value, Remembered):  # `find out where Bob is and tell Alice`
            command = Token("command", self._text.starts[at], self._text.ends[end - 1], told)
            self._say_text(at, end, f"{{{before.value.key}}}", command, slot)
            return end
        counted = COUNT if before.role != NAMED else COUNTED_NAMES
        found = counted if before.value.entry.id in COUNTING else ANSWER
        entry = self._vocabulary.entry(found) if _finds_out(before) else None
        if entry is None:
            return 0
        command = Token("command", self._text.starts[at], self._text.ends[end - 1], told)
        self._say(at, Match(Meaning("", entry), end), command, slot)
        return end

    def _found_whether(self, at: int, end: int, told: Called, slot: str) -> int:
        """`see if the door is open, come back and tell me`: whether it was open when the robot looked."""
        tokens, text = self._tokens, self._text
        between = run_start(tokens, len(tokens), JOINTS)
        while between and tokens[between - 1].kind == "command" and drives(tokens[between - 1].value):
            between = run_start(tokens, between - 1, JOINTS)
        if [token.kind for token in tokens[max(between - 2, 0) : between]] != ["check", "condition"]:
            return 0
        check, asked = tokens[between - 2 : between]
        written = " ".join(text.source.text[check.start : check.end].lower().split())
        said = [self._condition_said(asked, (), is_denied=is_denied) for is_denied in (False, True)]
        if written not in self._vocabulary.asking["finding_out"] or "" in said or said[0] == said[1]:
            return 0
        rest = tokens[between:]
        before = rest[next((i for i, token in enumerate(rest) if token.kind == "command"), len(rest)) :]
        start, last = text.starts[at], text.ends[end - 1]
        tokens[between - 2 :] = [Token("open", check.start, check.start)]
        self._if(asked, True)
        for words in said:
            command = Token("command", start, last, told)
            self._set_text(command, slot, words)
            tokens += [
                Token("open", start, start),
                *(each.copy() for each in before),
                command,
                Token("close", last, last),
            ]
            tokens += [Token("comma", last, last), Token("otherwise", last, last)] if words is said[0] else []
        tokens.append(Token("close", last, last))
        return end

    def _indirect(self, at: int, first: int, said: Called) -> int:
        """`tell me where the cup is`, `tell Bob whether the door is open`: the answer to what is asked at `first`."""
        text = self._text
        slot = next(slot.name for slot in said.entry.slots if slot.type == TEXT)
        if text.words[first] in self._vocabulary.asking["whether"]:
            return self._say_whether(at, first + 1, said, slot)
        if end := self._tell_when(at, first, said, slot):
            return end
        if text.words[first] in self._vocabulary.roles["if"]:
            end = first + self._length(first) + 1
            self._doubt_if(at, first, said.entry)
            self._tokens.append(Token("unknown", text.starts[at], text.ends[end - 1]))
            return end
        measured = self._measured(first)
        if measured is not None and self._ends(measured.last):  # `tell Bob what she said`
            command = Token("command", text.starts[at], text.ends[measured.last - 1], said)
            self._say(at, measured, command, slot)
            return measured.last
        asked = self._phrase(first)
        role = asked.meaning.role if asked is not None else ""
        read = self._readers.get(role)
        if asked is None or read is None:
            return 0
        return read(at, asked.last, Token("command", text.starts[at], text.ends[asked.last - 1], said), slot)

    def _doubt_if(self, at: int, first: int, entry: Entry) -> None:
        """BT151 for `tell me if the door is open`: whether it is, or only if it is."""
        text, asked = self._text, self._phrase(first + 1)
        if asked is None or asked.meaning.entry is None:
            self._doubt(entry, first, _DEPENDS)
            return
        whole = text.span(at, asked.last)
        condition = text.source.text[text.begin(first + 1) : whole.end]
        told, form = text.span(at, first).text, text.span(first, first + 1).text
        one = f"{told} {self._vocabulary.asking['whether'][0]} {condition}"
        other = f"{form} {condition}, {told[:1].lower()}{told[1:]}"
        self._calls.problems.append(diagnostic("BT151", whole, words=whole.text, one=one, other=other))

    def _tell_when(self, at: int, first: int, said: Called, slot: str) -> int:
        """`let me know when Bob arrives`, `tell Alice as soon as the door is open`: waits until then, and says it."""
        text, when = self._text, self._phrase(first)
        role = when.meaning.role if when is not None else ""
        if when is None or not (role in ("as_soon_as", "once") or text.words[first] in self._vocabulary.asked_once):
            return 0
        begin = when.last if role == "as_soon_as" else first + 1
        asked = self._phrase(begin)
        if asked is None or asked.meaning.role not in ("condition", "negated") or not self._ends(asked.last):
            return 0
        tokens, start, end = self._tokens, text.starts[at], text.ends[asked.last - 1]
        count, denied = len(tokens), asked.meaning.role == "negated"
        condition = self._calls.token(asked, begin)
        condition.kind = "condition"
        form = Token("as_soon_as", text.starts[first], text.ends[begin - 1])
        tokens += [form, *([Token("not", start, start)] if denied else []), condition]
        command = Token("command", start, end, said)
        self._set_text(command, slot, self._asked_of())
        form.kind = "wait_until"
        tokens.insert(count, Token("open", start, start))
        tokens += [Token("then", end, end), command, Token("close", end, end)]
        return asked.last

    def _say_whether(self, at: int, first: int, said: Called, slot: str) -> int:
        """Says yes or no for the condition that begins at `first`."""
        text = self._text
        condition = self._phrase(first)
        is_one = condition is not None and condition.meaning.role in ("condition", "negated")
        if condition is None or not is_one or not self._ends(condition.last):
            return 0
        start, end = text.starts[at], text.ends[condition.last - 1]
        self._tokens.append(Token("open", start, start))
        self._if(self._calls.token(condition, first), condition.meaning.role == "condition")
        self._yes_or_no(end, said, slot)
        self._tokens.append(Token("close", end, end))
        return condition.last

    def _yes_or_no(self, at: int, said: Called, slot: str) -> None:
        """Says yes where the condition before is true, else no."""
        yes, no = (
            said.replace(arguments=tuple((name, answer if name == slot else given) for name, given in said.arguments))
            for answer in self._vocabulary.asking["answers"]
        )
        self._tokens += [
            Token("command", at, at, yes), Token("comma", at, at), Token("otherwise", at, at),
            Token("command", at, at, no),
        ]  # fmt: skip

    def _whether(self, at: int) -> int:
        """`is the battery low?`, `do you see Alice?`: says yes or no."""
        text, word = self._text, self._text.words[at]
        condition: Match | None = None
        if word in self._vocabulary.asking["asking_do"]:
            condition = self._condition([*range(at + 1, at + 2 + self._length(at))])
        elif word in self._vocabulary.asking["asking_be"]:
            length = self._length(at)
            for count in range(1, min(_MOST_WORDS, length)):
                subject = range(at + 1, at + 1 + count)
                condition = self._condition([*subject, at, *range(at + 1 + count, at + 2 + length)])
                if condition is not None:
                    break
        if condition is None or self._saying is None:
            return 0
        end = text.ends[condition.last - 1]
        if text.words[condition.last] == END_OF_STATEMENT:
            joint = self._phrase(condition.last + 1)
            is_then = joint is not None and joint.meaning.role == "then"  # `is the battery low? Then dock`
            reply = (True, joint.last) if joint is not None and is_then else None
            if condition.last + 1 in text.going_on:
                reply = find(self._vocabulary.replies, text.words, condition.last + 1) or reply
                return self._depend(condition, at, reply) if reply is not None else 0
            if reply is not None:
                return self._depend(condition, at, reply)
        asked = self._calls.token(condition, at)
        self._if(asked, condition.meaning.role == "condition")
        self._yes_or_no(end, self._saying_of(""), self._saying.slots[0].name)
        return condition.last

    def _depend(self, condition: Match, at: int, reply: tuple[bool, int]) -> int:
        """`is the battery low? If so, A`: a command that depends on what is asked."""
        asked, is_yes = self._calls.token(condition, at), reply[0]
        self._calls.note(condition)
        self._if(asked, (condition.meaning.role == "condition") == is_yes)
        return reply[1] + (self._text.words[reply[1]] == ",")

    def _length(self, at: int) -> int:
        """How many words of the statement stand behind one."""
        last = at
        while self._text.words[last + 1] not in (END_OF_STATEMENT, END_OF_TEXT):
            last += 1
        return last - at

    def _condition(self, places: list[int]) -> Match | None:
        """The condition that words make in this order, if it takes all of them."""
        match = self._partial.in_order(places)
        if match is None or match.last != places[-1] or match.meaning.role not in ("condition", "negated"):
            return None
        return match


def _finds_out(token: Token) -> bool:
    """Whether a command counts something, or asks somebody."""
    return is_question(token) or (isinstance(token.value, Called | Listed) and token.value.entry.id in COUNTING)
