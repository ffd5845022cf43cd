"""Commands that depend on what somebody answers: `ask Alice "Tea?". If so, A`, `wait until she says stop`."""

from __future__ import annotations

from functools import cached_property

from btlang.diagnostics.diagnostic import diagnostic
from btlang.frontends.mission.token import (
    BEFORE_CONDITIONS,
    JOINTS,
    Called,
    Listed,
    Token,
    go_on,
    run_start,
    statement_start,
)
from btlang.frontends.mission.tokens.addressed_texts import AddressedTexts
from btlang.frontends.mission.tokens.replies import REPLIES, any_words, missing_words, person_in, told_since
from btlang.frontends.mission.tokens.sentence_reader import is_answer, is_question, latest_question
from btlang.frontends.mission.tokens.silent_words import begins
from btlang.frontends.mission.tokens.word_matches import match_of, relocated, rest_of
from btlang.text.source import Span
from btlang.tree.answers import (
    ABOUT_ANSWERS,
    ANSWERED,
    ASK,
    EXAMPLE,
    OF_WHICH,
    PERSON_SAYS,
    SOMEBODY_SAYS,
    UNANSWERED,
    asking_verbs,
)
from btlang.vocabulary.antecedents import pronouns_for
from btlang.vocabulary.match import Match
from btlang.vocabulary.references import NEAREST, SPEAKING, choice_of
from btlang.vocabulary.value_type import PERSON, TEXT
from btlang.vocabulary.word_tree import find

_LIMITS = frozenset(("within", "up_to"))
_BEFORE_NAME = 3  # words: `and if Bob`
_BEFORE_REPLY = BEFORE_CONDITIONS | {"semi", "newline", "stop", "comma", "and", "then", "or"}
_OF_REPLY = frozenset(("if", "unless", "until", "not", "condition", "or", "and", "comma", "then"))
_STOPS = frozenset(("semi", "newline"))
_WHILE = ["while", "condition"]


class Answers(AddressedTexts):
    """Those of one text."""

    _met = ""
    """Of whom pronouns spoke when somebody was asked."""

    def _if(self, condition: Token, is_so: bool) -> None:
        """Begins a command that is done if a condition is so, or isn't."""
        start, end = condition.start, condition.end
        self._tokens.append(Token("if", start, start))
        self._end_reply(condition, is_denied=not is_so)
        if not is_so:
            self._tokens.append(Token("not", start, start))
        self._tokens += [condition, Token("comma", end, end)]

    def with_name(self, match: Match | None, at: int) -> Match | None:
        """The phrase at a word; `if Bob says no` behind `ask Bob "Tea?"` is `if he says no`."""
        if not self._may_ask or not self._tokens or self._tokens[-1].kind not in _BEFORE_REPLY:
            return match
        text, context = self._text, self._context
        names = self._vocabulary.values.names_tree(PERSON)
        where = (i for i in range(at, at + _BEFORE_NAME) if text.words[i] in names)
        named = next(((i, read) for i in where if (read := context.read(PERSON, text, i)) is not None), None)
        if named is None:
            return match
        place, (name, end) = named
        if name != self._asked_person():
            return match
        places = [*range(at, place + 1), *rest_of(text, end)]
        found = match_of(text, places, {place - at: self._pronoun}, (self._vocabulary.trie,), context)
        if found is None or found.last <= place - at:
            return match
        entry = found.meaning.entry
        if entry is None and found.meaning.role == "if_unanswered":
            text.going_on.add(at)
            return relocated(found, places)
        return relocated(found, places) if entry is not None and entry.id in ABOUT_ANSWERS else match

    def reply(self, at: int, role: str) -> int:
        """`ask Alice "Tea?". If so, A`: a command that depends on the answer, not on whether there was one."""
        found = find(self._vocabulary.replies, self._text.words, at) if self._may_ask else None
        entry = self._vocabulary.entry(ANSWERED) if found is not None else None
        if found is None or entry is None:
            return 0
        behind, is_first = run_start(self._tokens, len(self._tokens), ("comma",)), begins(self._tokens)
        if self._question(behind, right_before=role == "otherwise") is None:
            return 0
        start, end = self._text.starts[at], self._text.ends[found[1] - 1]
        if not found[0] and self._replied_else(behind):  # `if he says red, A, if not B`
            if is_first:
                go_on(self._tokens)
            else:
                del self._tokens[behind:]
            self._tokens.append(Token("otherwise", start, end))
            return found[1] + (self._text.words[found[1]] == ",")
        if not is_first:
            is_listed = self._tokens[-1].kind == "comma" and self._replies_before(behind)
            if self._text.words[at] not in self._vocabulary.joining and not is_listed:
                return 0
            del self._tokens[behind:]
            self._tokens.append(Token("and", start, self._text.ends[at]))
        yes = Called(entry, ((entry.slots[0].name, self._vocabulary.asking["answers"][0]),))
        self.note_answerer()
        self._if(Token("condition", start, end, yes), found[0])
        return found[1] + (self._text.words[found[1]] == ",")

    def _replied_else(self, end: int) -> bool:
        """Whether the statement that ends there depends on another answer than yes."""
        end = run_start(self._tokens, end, _STOPS)
        said = self._tokens[statement_start(self._tokens, end) : end]
        asked = said[1].value if len(said) > 1 and said[0].kind == "if" and is_answer(said[1]) else None
        is_one = sum(token.kind in ("if", "otherwise") for token in said) == 1
        yes = self._vocabulary.asking["answers"][0]
        return isinstance(asked, Called) and is_one and asked.arguments[0][1] != yes

    def _replies_before(self, end: int) -> bool:
        """Whether the statement that ends there depends on a reply: `if they do, A, if they don't, B`."""
        said = self._tokens[statement_start(self._tokens, end) : end]
        return len(said) > 1 and said[0].kind == "if" and is_answer(said[1 + (said[1].kind == "not")])

    def silence(self, match: Match, at: int) -> int:
        """`..., if she says nothing, A` behind other replies, or with more conditions: as a condition of its own.

        Right behind the question it is what is done if that fails.
        """
        text, last, entry = self._text, match.last, self._vocabulary.entry(UNANSWERED)
        if self._asks_again():
            words = text.span(at, last - (text.words[last - 1] == ","))
            problem = diagnostic("BT144", words, words=words.text, problem=OF_WHICH, example=EXAMPLE)
            self._calls.problems.append(problem)
        limit = self._phrase(last)
        behind = limit.last if limit is not None and limit.meaning.role in _LIMITS else last
        is_joined = any(text.words[behind] in self._vocabulary.roles[role] for role in ("or", "and"))
        behind = run_start(self._tokens, len(self._tokens), ("comma",))
        is_reply = is_joined if self._question(behind, right_before=True) else self._is_asked(right_before=False)
        if entry is None or not is_reply:
            return 0
        has_comma = text.words[last - 1] == ","
        start, end = text.starts[at], text.ends[last - 1 - has_comma]
        asked = Token("condition", start, end, Called(entry, ()))
        if text.words[at] in self._vocabulary.roles["and"]:
            self._tokens.append(Token("and", start, text.ends[at]))
        self._tokens.append(Token("if", start, start))
        self._end_reply(asked)
        self.note_answerer(NEAREST)
        self._tokens.append(asked)
        if has_comma:
            self._tokens.append(Token("comma", text.starts[last - 1], text.ends[last - 1]))
        return last

    def _asks_again(self) -> bool:
        """Whether the statement before asks the same person again for one answer: `if he says no, ask him again`."""
        tokens = self._tokens
        last = run_start(tokens, len(tokens), _STOPS)
        first = statement_start(tokens, last)
        if not 0 < first < last < len(tokens):
            return False
        if tokens[first + 2 * (tokens[first].kind == "repeat")].kind != "if":  # in the bracket of a loop
            return False
        values = [token.value for token in tokens[first:last] if isinstance(token.value, Called | Listed)]
        if not values or values[0].entry.id not in ABOUT_ANSWERS or values[-1].entry.id != ASK:
            return False
        asked = self._question(first, right_before=False)
        return asked is not None and asked.arguments[:-1] == values[-1].arguments[:-1]

    def said(self, token: Token, at: int) -> None:
        """What a condition is about that was read at a word."""
        self._hear(token, at)
        self._calls.problems += missing_words(token, self._text.source, self._vocabulary)
        self._end_reply(token)
        if isinstance(token.value, Called) and token.value.entry.id in ABOUT_ANSWERS:
            self.note_answerer(NEAREST if token.value.entry.id == UNANSWERED else SPEAKING)

    def whole_answer(self, token: Token, match: Match) -> int:
        """`if he says picture book, A`: all words of an answer without quotes. Returns where the condition ends."""
        said, words, end = token.value, self._text.words, match.last
        value = match.values[-1] if match.values else None
        if value is None or value.type != TEXT or not isinstance(said, Called) or said.entry.id not in REPLIES:
            return end
        first, number, asking = value.first, self._context.values.is_number, self._vocabulary.asking
        known = (*asking["answers"], *asking["silence"], *asking["any_answer"])
        if value.last != end or words[first][0] == '"' or words[first] in known or self._phrase(end) is not None:
            return end
        while words[end][0].isalpha() and words[end] not in self._vocabulary.joining:
            end += 1
        odd = any(word[0] == '"' or word in self._vocabulary.values.texts.of_persons for word in words[first:end])
        if end == match.last or odd or any(number([word]) for word in words[first:end]):
            return match.last
        self._set_text(token, value.name, " ".join(words[first:end]))
        token.end = self._text.ends[end - 1]
        return end

    def note_question(self, command: Token) -> None:
        """Remember of whom pronouns behind the answers to a question to nobody by name speak."""
        if is_question(command):
            self._met = self._context.latest.get(PERSON, "")
            if not self._met and self._calls.speaks_of_people:
                self._calls.note_somebody(how=SPEAKING)  # `ask the visitor "Tea?" and wave at them`

    def note_answerer(self, how: str = SPEAKING) -> None:
        """Make pronouns stand for who answers, whatever is done for another answer: the one asked, else who spoke.

        Where nobody did, that is the nearest person.
        `ask Bob "Tea?". If he says yes, go to Alice. If he says no, wave at him`
        """
        if not self._calls.speaks_of_people:
            return  # and a text without people isn't looked through for each of its conditions
        question = latest_question(self._tokens)
        if question is None:
            return
        met = self._met if self._question_before() is not None else person_in(question.value)
        asked = self._asked_person() or met
        choice = choice_of(asked) if asked == person_in(question.value) else None  # else it is chosen where it is named
        if asked:
            self._context.latest[PERSON] = asked if choice is None else f"{{{choice.key}}}"
        else:
            self._calls.note_somebody(how=how)

    def _end_reply(self, token: Token, is_denied: bool = False) -> None:
        """`if he says yes, A, and if he says no, B`: the second answer ends what is done for the first."""
        tokens = self._tokens
        last = run_start(tokens, len(tokens) - 1, ("and", "comma"))
        first = statement_start(tokens, last)
        kinds = [each.kind for each in tokens[first:last]]
        begin = first + kinds.index("if") if "if" in kinds else last
        if begin > first and self._question(run_start(tokens, begin, JOINTS), right_before=True) is None:
            return
        asked = [each.value for each in (*tokens[begin : begin + 2], token) if isinstance(each.value, Called)]
        if last == len(tokens) - 1 or tokens[-1].kind != "if" or len(asked) != 2:
            return
        are_replies = all(value.entry.id in ABOUT_ANSWERS for value in asked) and (is_denied or asked[0] != asked[1])
        start, here = tokens[begin].start, tokens[last].start
        if not are_replies or kinds.count("if") != 1:
            return
        if kinds.count("open") == kinds.count("close"):
            tokens[last:-1] = [Token("semi", here, here)]
        elif "open" not in kinds[begin - first :] and "close" not in kinds[begin - first :]:
            tokens.insert(last, Token("close", here, here))
            tokens.insert(begin, Token("open", start, start))

    def _hear(self, token: Token, at: int) -> None:
        """`wait until she says stop` where nobody is asked is what is heard; `she says nothing` is silence."""
        value = token.value
        if not isinstance(value, Called) or value.entry.id not in REPLIES:
            return  # as nearly always
        is_asked = self._may_ask and latest_question(self._tokens) is not None  # `ask Bob for the cup` is no question
        may_ask = is_asked and not (self._is_done_until() or self._speaks_of_another())
        if isinstance(value, Called) and value.entry.id in (PERSON_SAYS, SOMEBODY_SAYS) and may_ask:
            value = token.value = self._answer_of_asked(value)
        elif isinstance(value, Called):
            value = token.value = any_words(value, self._text.source.text[token.start : token.end], self._vocabulary)
        if not isinstance(value, Called) or value.entry.id != ANSWERED:
            return
        if may_ask:
            self._end_asking(value)
            self._silent(token, value.arguments[0][1])
            return
        if find(self._vocabulary.values.pronoun_words, self._text.words, at) is None:
            return
        words, person = value.arguments[0][1], self._context.latest.get(PERSON, "")
        said = Span(self._text.source, token.start, token.end)
        if set(self._vocabulary.asking["replying"]).isdisjoint(said.text.lower().split()):
            self._calls.problems.append(diagnostic("BT145", said, words=said.text, example=EXAMPLE))
            return  # `if he wants tea`: nobody says so unasked
        heard = self._vocabulary.entry(PERSON_SAYS if person else SOMEBODY_SAYS)
        if heard is not None:
            by_type = {PERSON: person, TEXT: words}
            token.value = Called(heard, tuple((slot.name, by_type[slot.type]) for slot in heard.slots))

    def _speaks_of_another(self) -> bool:
        """Whether someone else was told something since: `ask Bob "Tea?", then tell Alice "Hi". If she says no, A`."""
        question, others = latest_question(self._tokens), told_since(self._tokens)
        asked = person_in(question.value) if question is not None else ""
        return asked[:1] not in ("", "{") and self._context.latest.get(PERSON, "") in others - {"", asked}

    def _is_done_until(self) -> bool:
        """Whether something else than a question is done until what is said then: `follow Bob until he says stop`."""
        until = self._tokens[-2:]
        return [token.kind for token in until] == ["command", "until"] and not is_question(until[0])

    def _end_asking(self, answered: Called) -> None:
        """`as long as he says no, ask him again, and when he says yes, A`: A when no question is asked any more."""
        tokens, first = self._tokens, statement_start(self._tokens, len(self._tokens))
        form = run_start(tokens, len(tokens) - 1, JOINTS)
        asks = tokens[first + 1].value if [token.kind for token in tokens[first : first + 2]] == _WHILE else None
        if first < form < len(tokens) - 1 and tokens[-1].kind == "if" and isinstance(asks, Called):
            if asks.entry.id == ANSWERED and asks != answered:
                tokens[form:-1] = [Token("semi", tokens[form].start, tokens[-2].end)]

    def _answer_of_asked(self, heard: Called) -> Called:
        """`if Bob says yes` behind a question to Bob is about his answer; `if I say yes` where no one is named."""
        entry = self._vocabulary.entry(ANSWERED)
        values = {slot.type: text for slot, (_, text) in zip(heard.entry.slots, heard.arguments, strict=True)}
        who = values.get(PERSON, "")
        if entry is None or who != self._asked_person() or not (who or self._question_before() is not None):
            return heard
        return Called(entry, ((entry.slots[0].name, values[TEXT]),))

    def answered(self, at: int) -> int:
        """`ask Bob "Ready?" until he answers`: whatever he says. Returns where to go on, 0 for other words."""
        text, entry = self._text, self._vocabulary.entry(UNANSWERED)
        who = self._context.read(PERSON, text, at) if self._may_ask and entry is not None else None
        subjects = {*self._vocabulary.values.role_words.speaker, *self._vocabulary.negative_subjects}
        behind = who[1] if who is not None else at + 1 if text.words[at] in subjects else 0
        found = find(self._vocabulary.answering, text.words, behind) if behind else None
        if found is None or entry is None or not (self._is_end(found[1]) or text.words[found[1]] == ","):
            return 0
        start, end = text.starts[at], text.ends[found[1] - 1]
        self._tokens.append(Token("not", start, start))
        asked = Token("condition", start, end, Called(entry, ()))
        self.said(asked, at)
        self._tokens.append(asked)
        return found[1]

    def replied(self, at: int) -> int:
        """`if he doesn't answer or says no`: he says that, too. Returns where to go on, 0 for other words."""
        before = self._tokens[-2].value if len(self._tokens) > 1 and self._tokens[-1].kind in ("or", "and") else None
        if not isinstance(before, Called) or before.entry.id != UNANSWERED:
            return 0
        places = [at, *rest_of(self._text, at)]
        found = match_of(self._text, places, {0: self._pronoun}, (self._vocabulary.trie,), self._context)
        if found is None or found.meaning.role != "condition" or found.meaning.entry is None:
            return 0
        match = relocated(found, places)
        token = self._calls.token(match, at)
        self.said(token, at)
        self._tokens.append(token)
        return match.last

    @cached_property
    def _pronoun(self) -> str:
        """A pronoun that stands for people alone: `he`."""
        return next(iter(pronouns_for(self._vocabulary.values.pronouns, PERSON, alone=True)), "")

    def _silent(self, token: Token, words: str) -> None:
        """Makes `she says nothing` and `she doesn't say anything` silence, and `she wants nothing` a no."""
        entry, asking = self._vocabulary.entry(UNANSWERED), self._vocabulary.asking
        said, value = self._text.source.text[token.start : token.end].lower(), token.value
        if entry is None or said[-1] == '"' or words.lower() not in (*asking["silence"], *asking["any_answer"]):
            return
        token.value = Called(entry, ())
        if isinstance(value, Called) and set(asking["replying"]).isdisjoint(said.split()):
            token.value = Called(value.entry, tuple((name, asking["answers"][1]) for name, _ in value.arguments))
        if words.lower() in asking["silence"]:
            return
        if self._tokens and self._tokens[-1].kind == "not":
            self._tokens.pop()
        else:
            self._tokens.append(Token("not", token.start, token.start))

    @cached_property
    def _may_ask(self) -> bool:
        """Whether anybody may be asked in the text."""
        verbs = tuple(asking_verbs(self._vocabulary))
        return any(word.startswith(verbs) for word in self._text.distinct)

    def _asked_person(self) -> str:
        """Who is asked by the question that a condition may be about whose form has begun; "" if nobody alone is."""
        return person_in(self._question_before())

    def _question_before(self) -> Called | Listed | None:
        """The question that a condition may be about whose form has begun."""
        return self._question(run_start(self._tokens, len(self._tokens), _OF_REPLY), right_before=False)

    def _is_asked(self, right_before: bool) -> bool:
        """Whether the statement before asks, or depends on the answer."""
        return self._question(len(self._tokens), right_before) is not None

    def _question(self, last: int, right_before: bool) -> Called | Listed | None:
        """What the statement asks that ends before a token, or the one whose answer it depends on.

        `ask "Tea?". If so, A. If he wants none, B`
        """
        tokens = self._tokens
        while last:
            if tokens[last - 1].kind in _STOPS:
                last -= 1
                continue
            first = last
            while first and tokens[first - 1].kind not in _STOPS:
                first -= 1
            values = [token.value for token in tokens[first:last] if isinstance(token.value, Called | Listed)]
            last = run_start(tokens, last, _LIMITS)
            asks_anew = tokens[first].kind == "repeat" and tokens[last - 1].kind == "count"
            if (tokens[last - 1].kind == "command" or asks_anew) and values and values[-1].entry.id == ASK:
                return values[-1]
            begin = next((i for i in range(first, last) if tokens[i].kind == "if"), last)
            asked = [each.value for each in tokens[begin:last] if isinstance(each.value, Called)][:1]
            if right_before or not asked or asked[0].entry.id not in ABOUT_ANSWERS:
                return None
            last = run_start(tokens, begin, JOINTS) if begin > first else first
        return None
