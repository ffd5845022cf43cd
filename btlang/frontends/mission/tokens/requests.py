"""Questions and values in speech: `is the battery low?`, `where is the cup?`, `say the battery`, `tell me the answer`.

Each becomes the commands that answer it: what is asked is measured, and said.
"""

from __future__ import annotations

from btlang.diagnostics.diagnostic import diagnostic
from btlang.frontends.mission.token import Called, Listed, Remembered, Token, texts_of
from btlang.frontends.mission.tokens.addressed_texts import TELL
from btlang.frontends.mission.tokens.answers import Answers
from btlang.text.words import END_OF_STATEMENT, END_OF_TEXT
from btlang.tree.asked import ASK
from btlang.vocabulary.entry import COUNT, SAY, Entry
from btlang.vocabulary.match import Match
from btlang.vocabulary.references import free_key
from btlang.vocabulary.trie import longest
from btlang.vocabulary.value_type import TEXT
from btlang.vocabulary.values import key_of
from btlang.vocabulary.word_tree import find

_MOST_WORDS = 8  # of the subject of a question
_EXAMPLE = "hello"
_BEHIND = ("politeness", "then", "and")
_BETWEEN = frozenset(("semi", "newline", "comma", "then", "and", "stop"))
_OF_CONDITIONS = frozenset(("condition", "not", "and", "or", "either", "neither", "nor", "both"))


class Requests(Answers):
    """Those of one text."""

    @property
    def _saying(self) -> Entry | None:
        return self._vocabulary.entry(SAY)

    def question(self, match: Match | None, role: str, at: int) -> int:
        """A question at the start of a statement."""
        if self._saying is None:
            return 0
        read = {"ask_value": self._asked, "ask_where": self._where, "ask_how_many": self._how_many}.get(role)
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
        is_pronoun = word not in values.ones and find(values.pronoun_words, self._text.words, value.first) is not None
        if is_pronoun and value.last == value.first + 1 and entry.id in (SAY, TELL):
            self._doubt(entry, value.first)  # `say it again`
            return 0
        again = longest(self._vocabulary.trie, self._text, value.first, self._context)
        if again is not None and again.meaning.role == "again":
            self._repeat(entry, value, command)
            return 0
        if entry.id == ASK:
            self._ask(entry, value, command)
            return 0
        if self._is_clause(value):
            self._doubt(entry, self._vocabulary.values.texts.doubt(self._text, value.first, value.last))
        if not (entry.accompaniment or "voice" in entry.needs):
            return 0  # a text that nobody says is its words: `listen for the bell`
        text, first = self._text, value.first
        asked = longest(self._vocabulary.trie, text, first, self._context)
        if asked is not None and asked.meaning.role == "ask_how_many":
            counted = self._counted(asked.last)
            return self._say_count(at, counted, command, value.name) if counted is not None else 0
        if entry.id == TELL and text.words[first] in self._vocabulary.roles["and"]:
            return self._inform(at, self._ends)  # `tell Bob and wave`
        if entry.id == TELL and text.words[first - 1] in self._vocabulary.asking["pleading"]:
            return self._plead(entry, value, at, command)
        if entry.id == TELL and value.last == match.last and self._goes_on(match.last):
            return self._tell(entry, value, command)
        if text.words[at] in self._vocabulary.asking["wishing"] and first in text.articles and value.last > first + 1:
            have = self._vocabulary.asking["wished"][0].capitalize()
            wish = text.source.text[text.begin(first) : text.ends[value.last - 1]]
            self._set_text(command, value.name, f"{have} {wish}")
            return 0
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
        end = wanted.last + (text.words[wanted.last] == ",")
        if text.words[end] not in begging or not self._is_end(end + 1):
            return 0
        self._partial.append(wanted, at)
        return end + 1

    def _values(self) -> str:
        """What can be said so, for a message."""
        known = sorted(" ".join(value.words) for value in (self._context.known or {}).values() if not value.is_chosen)
        quantities = [entries[0] for entries in self._vocabulary.entries.values() if entries[0].measures]
        return ", ".join([*known, *(each.quantity[0] for each in quantities if "{" not in each.quantity[0])])

    def _measured(self, at: int) -> Match | None:
        """The quantity that words name."""
        found = [longest(trie, self._text, at, self._context) for trie in self._vocabulary.measured]
        return max((match for match in found if match is not None), key=lambda match: match.last, default=None)

    def _asked(self, at: int, end: int) -> int:
        """`what is the battery?`"""
        measured = self._measured(end)
        if measured is None:
            return 0
        behind = longest(self._vocabulary.trie, self._text, measured.last, self._context)
        last = behind.last if behind is not None and behind.meaning.role == "there_are" else measured.last
        if not self._ends(last):
            return 0
        self._say(at, measured)
        return last  # `how much battery do you have left?`

    def _where(self, at: int, end: int) -> int:
        """`where is the cup?`: looks for it and says where it is."""
        search = self._with_front(at, end, "search")
        if search is None or not self._ends(search.last) or any(value.more or value.group for value in search.values):
            return 0
        measured = self._partial.with_front(
            at, end, self._vocabulary.asking["whereabouts"], self._vocabulary.quantities
        )
        if measured is None or measured.last != search.last:
            return 0
        self._partial.append(search, at)
        self._then(at)
        self._say(at, measured)
        return search.last

    def _how_many(self, at: int, end: int) -> int:
        """`how many people are there?`"""
        counted = self._counted(end)
        if counted is None:
            return self._say_last_count(at, end)
        return self._say_count(at, counted) if self._ends(counted.last) else 0

    def _say_last_count(self, at: int, end: int) -> int:
        """`count the boxes, then tell me how many there are`: what was counted."""
        behind, count = longest(self._vocabulary.trie, self._text, end, self._context), self._vocabulary.entry(COUNT)
        if behind is None or behind.meaning.role != "there_are" or count is None or not self._ends(behind.last):
            return 0
        measured = Match(behind.meaning.replace(role="quantity", entry=count), behind.last)
        self._say(at, measured)
        return behind.last

    def _counted(self, at: int) -> Match | None:
        """The command that counts what words name, with the words that may stand behind that."""
        counted = self._with_front(at - 1, at, "counting")
        if counted is None:
            return None
        behind = longest(self._vocabulary.trie, self._text, counted.last, self._context)
        if behind is None or behind.meaning.role != "there_are":
            return counted
        counting, left_out = self._vocabulary.asking["counting"], range(counted.last, behind.last)
        wider = self._partial.with_front(at - 1, at, counting, left_out=left_out)
        if wider is not None and wider.last > behind.last:
            return wider  # `how many people are there in the lab`
        made: Match = counted.replace(last=behind.last)
        return made

    def _say_count(self, at: int, counted: Match, command: Token | None = None, slot: str = "") -> int:
        count = self._vocabulary.entry(COUNT)
        if count is None:
            return 0
        self._tokens.append(self._calls.token(counted, at))
        self._then(at)
        self._say(at, counted.replace(meaning=counted.meaning.replace(entry=count), values=()), command, slot)
        return counted.last

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
            joint = longest(self._vocabulary.trie, text, condition.last + 1, self._context)
            is_then = joint is not None and joint.meaning.role == "then"  # `is the battery low? Then dock`
            reply = (True, joint.last) if joint is not None and is_then else None
            if condition.last + 1 in text.going_on:
                reply = find(self._vocabulary.replies, text.words, condition.last + 1) or reply
                return self._depend(condition, at, reply) if reply is not None else 0
            if reply is not None:
                return self._depend(condition, at, reply)
        asked = self._calls.token(condition, at)
        yes, no = (self._saying_of(answer) for answer in self._vocabulary.asking["answers"])
        self._if(asked, condition.meaning.role == "condition")
        self._tokens += [
            Token("command", end, end, yes), Token("comma", end, end), Token("otherwise", end, end),
            Token("command", end, end, no),
        ]  # fmt: skip
        return condition.last

    def _depend(self, condition: Match, at: int, reply: tuple[bool, int]) -> int:
        """`is the battery low? If so, A`: a command that depends on what is asked."""
        asked, is_yes = self._calls.token(condition, at), reply[0]
        self._calls.note(condition)
        self._if(asked, (condition.meaning.role == "condition") == is_yes)
        return reply[1] + (self._text.words[reply[1]] == ",")

    def tell(self, at: int) -> int:
        """`tell me "hello"`: says it; `if the door is open, tell me`: says what was asked."""
        told, text = find(self._vocabulary.telling, self._text.words, at), self._text
        if told is None or self._saying is None:
            return self._inform(at, self._ends)
        if text.words[told[1]][0] == '"':
            said, end = text.words[told[1]][1:], told[1] + 1
        elif self._opens_clause(told[1]):
            said, end = self._clause(self._saying, at, told[1])
        else:
            said, end = self._asked_of() if self._ends(told[1]) else "", told[1]
        if not said and not self._ends(end):
            return 0
        if not said:
            words = text.span(at, end)
            example = f'{words.text} "{_EXAMPLE}"'
            self._calls.problems.append(diagnostic("BT012", words, words=words.text, wanted="a text", example=example))
        self._tokens.append(Token("command", text.starts[at], text.ends[end - 1], self._saying_of(said)))
        return end

    def finding_out(self, end: int) -> None:
        """`check whether A. If B, C`: what is checked decides nothing by itself, behind the `if` that ends at a word.

        `check that A. If B, C` is the same where both are about one thing.
        """
        tokens, at = self._tokens, len(self._tokens) - 2
        while at >= 0 and tokens[at].kind in _BETWEEN:
            at -= 1
        while at >= 0 and tokens[at].kind in _OF_CONDITIONS:
            at -= 1
        if at >= 0 and tokens[at].kind == "check":
            written = self._text.source.text[tokens[at].start : tokens[at].end].lower()
            following = longest(self._vocabulary.trie, self._text, end, self._context)
            asked = {value.text for value in following.values} if following is not None else set()
            said = (token.value for token in tokens[at:] if isinstance(token.value, Called | Listed))
            same = any(asked.intersection(texts_of(value)) for value in said)
            if " ".join(written.split()) in self._vocabulary.asking["finding_out"] or same:
                tokens.insert(at, Token("try", tokens[at].start, tokens[at].start))

    def otherwise(self) -> None:
        """`check that A, if not do B`: the `if not` at the end is for a command."""
        tokens = self._tokens
        if len(tokens) > 2 and tokens[-2].kind == "if" and tokens[-3].kind in ("comma", "condition", "command"):
            tokens[-2:] = [Token("otherwise", tokens[-2].start, tokens[-1].end)]

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

    def _saying_of(self, words: str) -> Called:
        assert self._saying is not None
        return Called(self._saying, ((self._saying.slots[0].name, words),))

    def _ends(self, at: int) -> bool:
        """Whether a question may end before a word."""
        if self._is_end(at) or self._text.words[at] == ",":
            return True
        match = longest(self._vocabulary.trie, self._text, at, self._context)
        return match is not None and match.meaning.role in _BEHIND

    def _then(self, at: int) -> None:
        self._tokens.append(Token("then", self._text.starts[at], self._text.starts[at]))

    def _say(self, at: int, measured: Match, command: Token | None = None, slot: str = "", adds: bool = False) -> None:
        """Remembers what is measured and says it, with a command or the one that says."""
        entry, text = measured.meaning.entry, self._text
        assert entry is not None
        key = self._key(entry)
        start, end = text.starts[at], text.ends[measured.last - 1]
        remembered = Remembered(key, entry, self._calls.arguments(entry, measured.values))
        self._tokens.append(Token("command", start, end, remembered))
        self._then(at)
        if command is None:
            command = Token("command", start, end, self._saying_of(f"{{{key}}}"))
        else:
            self._set_text(command, slot, f"{{{key}}}", adds)
        self._tokens.append(command)

    def _key(self, entry: Entry) -> str:
        """A free key for what a quantity measures, by its words."""
        words = entry.quantity[0].split()
        slot = next((at for at, word in enumerate(words) if "{" in word), len(words) + 1)
        return free_key(key_of(words[: slot - 1]), self._context.known or ())
