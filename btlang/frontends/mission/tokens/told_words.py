"""What somebody is told who is to be told what was asked: `if the door is open, tell Bob`."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import dropwhile

from btlang.frontends.mission.token import (
    FORMS,
    JOINTS,
    STATEMENT_ENDS,
    Called,
    Listed,
    Token,
    arguments_of,
    run_start,
    statement_start,
)
from btlang.frontends.mission.tokens.sentence_reader import SentenceReader, is_question, searches
from btlang.frontends.mission.tokens.settling import FAILS, MEASURES, WORKS, is_about
from btlang.frontends.mission.tokens.word_matches import words_of
from btlang.tree.answers import ABOUT_ANSWERS, ANSWERED
from btlang.vocabulary.match import Match
from btlang.vocabulary.reading_context import ReadingContext
from btlang.vocabulary.trie import longest
from btlang.vocabulary.value_type import DOOR, OBJECT, PERSON, PLACE, TEXT, WORLD
from btlang.vocabulary.word_tree import find

_COMES = "WaitForPerson"
_AWAITING = frozenset(("within", "wait_up_to", "condition", "not", "and"))
_TRYING = ("try", "retry")
_ASKED_BY = frozenset(("if", "whenever", "first_time", "as_soon_as", WORKS))
_IN_CONDITIONS = frozenset(("condition", "not", "either", "neither", "or"))
_LINE_ENDS = frozenset(("semi", "newline", "otherwise"))
_DONE = ("command", "at", "wait", "wait_until", "wait_forever")
_FORMS = ("unless", "if", "once", "as_soon_as", "whenever")
_BEHIND = ("politeness", "then", "and", "unless")


class ToldWords(SentenceReader):
    """Those of one text."""

    def _ends(self, at: int) -> bool:
        """Whether a question, or what is said, may end before a word."""
        if self._is_end(at) or self._text.words[at] == ",":
            return True
        match = self._phrase(at)
        return match is not None and match.meaning.role in _BEHIND

    def _behind_manner(self, at: int) -> int:
        """Where to go on behind words that say nothing, which may end what is said: `right away`."""
        silent = self._phrase(at)
        is_manner = silent is not None and silent.meaning.role == "politeness" and self._ends(silent.last)
        return silent.last if silent is not None and is_manner else at

    def _goes_on(self, at: int) -> bool:
        """Whether words follow that are neither a mark nor begin anything."""
        is_mark = self._is_end(at) or self._text.words[at] in (",", ":")
        return not is_mark and ((phrase := self._phrase(at)) is None or phrase.meaning.role == "there_are")

    def _end_before_command(self, first: int, last: int, is_told: bool) -> int:
        """Where a clause ends before a reply, or before `and` and a command whose verb can't go on with it; else 0.

        What is told has its verb by then: `tell Bob that tea is ready and wave`.
        """
        text, joints, context = self._text, self._vocabulary.roles["and"], self._context.with_references()
        texts, replies = self._vocabulary.values.texts, self._vocabulary.replies
        if at := next((at for at in range(first + 1, last) if find(replies, text.words, at)), 0):
            return 0 if is_told else at - (text.words[at - 1] == ",")
        context.latest = dict.fromkeys(context.types, "")  # `and bring him the cup`: who is asked isn't known yet
        for at in range(first + 1, last - 1):
            if text.words[at] == "," and self._leaves_out_days(at + 1):
                return at
            if not is_told and text.words[at] in (",", *joints) and self._asks_for_answer(at, context):
                return at
            if text.words[at] in ((*joints, ",") if is_told else joints) and self._begins_command(at + 1, context):
                if self._is_done_to(first, at + 1):
                    return at
                goes_on = not texts.is_whole(text, first, at) if is_told else texts.may_be_joined(text, first, at)
                return 0 if goes_on else at - (text.words[at - 1] == ",")
        return 0

    def _end_before_form(self, first: int, last: int) -> int:
        """Where a comma stands before what something depends on that is no part of a clause; 0 for none.

        `tell Bob that tea is ready, unless Alice is near`, `ask Bob to wait, and if the door is open, A`.
        """
        words, context = self._text.words, self._context.with_references()
        context.latest = dict.fromkeys(context.types, "")
        for at in (at for at in range(first + 1, last) if words[at] == ","):
            form = self._phrase(at + 1 + (words[at + 1] in self._vocabulary.roles["and"]))
            if form is not None and form.meaning.role in _FORMS:
                asked = longest(self._vocabulary.trie, self._text, form.last, context)
                if asked is not None and asked.meaning.role in ("condition", "negated"):
                    return at
        return 0

    def _end_before_answer(self, first: int, last: int) -> int:
        """Where a question ends that is asked until an answer comes: `ask Bob if he is ready until he says yes`."""
        words, context = self._text.words, self._context.with_references()
        context.latest = dict.fromkeys(context.types, "")
        for at in (at for at in range(first + 1, last) if words[at] in self._vocabulary.firsts["until"]):
            until = longest(self._vocabulary.trie, self._text, at + 1, context)
            if until is not None and until.meaning.entry is not None and until.meaning.entry.id in ABOUT_ANSWERS:
                paces = ((before, self._phrase(before)) for before in range(first + 1, at))
                return next((before for before, pace in paces if pace is not None and _is_pace(pace, at)), at)
        return 0

    def _asks_for_answer(self, at: int, context: ReadingContext) -> bool:
        """Whether a joint stands before what depends on the answer: `ask Bob if he is cold, and if he says yes, A`."""
        words, form = self._text.words, at + 1
        form += words[form] in self._vocabulary.roles["and"]
        if words[form] not in self._vocabulary.firsts["if"]:
            return False
        asked = longest(self._vocabulary.trie, self._text, form + 1, context)
        entry = asked.meaning.entry if asked is not None else None
        return entry is not None and entry.id in ABOUT_ANSWERS

    def _is_done_to(self, first: int, at: int) -> bool:
        """Whether a command is for the one of whom a clause is: `ask if he would like tea and take him to the lab`."""
        words, pronouns, owners = self._text.words, self._context.pronouns, self._vocabulary.values.texts
        is_person = PERSON in pronouns.get(words[first], ()) and PERSON in pronouns.get(words[at + 1], ())
        behind, prepositions = words[at + 2], self._vocabulary.values.role_words.prepositions
        owns = owners.is_owned(self._text, at + 1) and behind[0].isalpha() and behind not in prepositions
        return is_person and not owns

    def _leaves_out_days(self, at: int) -> bool:
        """Whether words leave out days: `except on Sundays`."""
        words, values = self._text.words, self._vocabulary.values
        end = values.exception(self._text, at)
        end += bool(end) and words[end] in self._vocabulary.firsts["on_days"]
        return bool(end) and find(values.names_tree("days"), words, end) is not None

    def _begins_command(self, at: int, context: ReadingContext) -> bool:
        """Whether a command begins at a word, or a time at which it is done."""
        behind = longest(self._vocabulary.trie, self._text, at, context)
        role = behind.meaning.role if behind is not None else ""
        return at not in self._text.articles and (role in _DONE or self._informs(at) > 0)

    def _informs(self, at: int) -> int:
        """Where words end that tell a person what was asked, or found out: `and tell Bob`; 0 for others."""
        asking, words = self._vocabulary.asking, self._text.words
        if words[at] not in asking["informing"]:
            return 0
        person = find(self._vocabulary.values.names_tree(PERSON), words, at + 1)
        end = person[1] if person is not None else at + 2
        is_person = person is not None or words[at + 1] in {*self._vocabulary.values.role_words.speaker}
        end += words[end] in asking["informed"]
        is_clause = self._vocabulary.values.texts.opens(words[end])  # `and tell Bob what she says`
        return end if is_person and (is_clause or self._ends(end)) else 0

    def _asked_of(self) -> str:
        """The words of the one condition that the command being read depends on, with names for pronouns; else ""."""
        tokens = self._tokens
        failed = next((at for at in reversed(range(len(tokens))) if tokens[at].kind in (*_LINE_ENDS, "or")), 0)
        is_plain = failed > 0 and (tokens[failed - 1].kind, tokens[failed].kind) == ("stop", "otherwise")
        first = statement_start(tokens, failed)
        if is_plain and [token.kind for token in tokens[first:failed]] == ["check", "condition", "stop"]:
            return self._condition_said(tokens[first + 1], tokens[failed:], is_denied=True)
        is_plain = is_plain and all(each.kind not in FORMS for each in tokens[first:failed])
        if tokens and (tokens[failed].value == FAILS or is_plain):  # `pick up the cup. Otherwise tell Bob`
            works = (at for at in reversed(range(failed)) if tokens[at].kind == WORKS)
            is_other = tokens[failed].kind == "otherwise" and not is_plain
            return self._failed(next(works, 0) if is_other else failed) or self._own_words(failed)
        form = next((at for at in reversed(range(len(tokens))) if tokens[at].kind in _ASKED_BY), 0)
        is_other = any(token.kind in _LINE_ENDS for token in tokens[form:])
        if tokens and tokens[form].kind == WORKS:
            tried = run_start(tokens, form, JOINTS | STATEMENT_ENDS)
            return self._failed(form) if is_other else self._found(tried) or self._worked(tried)
        if tokens and tokens[form].start == tokens[form].end:
            return "" if is_other else self._replied(form)
        asked = [token for token in tokens[form:] if token.kind in _IN_CONDITIONS]
        if len(asked) > 1 and asked[0].kind == "not" and asked[0].start == asked[0].end:
            del asked[0]  # of `isn't`, which the words of the condition have
        if not tokens or tokens[form].kind not in _ASKED_BY or not asked or is_other:
            return ""
        if [token.kind for token in asked] == ["condition", "or", "condition"]:
            either = [self._condition_said(asked[at], tokens[form:]) for at in (0, 2)]  # `if she says no or is away`
            joint = self._vocabulary.word("or")
            return f"{either[0]} {joint} {either[1][:1].lower()}{either[1][1:]}" if all(either) else ""
        if len(asked) != 1 or not isinstance(asked[0].value, Called):
            return ""
        if asked[0].value.entry.id in ABOUT_ANSWERS and self._context.latest.get(PERSON, "{")[:1] == "{":
            return self._replied(form)
        return self._condition_said(asked[0], tokens[form:])

    def _condition_said(self, asked: Token, rest: Sequence[Token], is_denied: bool = False) -> str:
        """What a condition says, with names for pronouns; what was so where the rest of its statement ends that."""
        if not isinstance(asked.value, Called):
            return ""
        text, pronouns, vocabulary = self._text, self._vocabulary.values.pronoun_words, self._vocabulary
        types = {slot.name: slot.type for slot in asked.value.entry.slots}
        named = [(types[name], value) for name, value in asked.value.arguments if types[name] in WORLD]
        if asked.value.entry.id in ABOUT_ANSWERS:  # `if she says yes, tell Bob`: of who was asked
            named = [(PERSON, self._context.latest[PERSON])]
        words: list[str] = []
        things = [value for kind, value in named if kind in (OBJECT, DOOR)]
        done = (token for token in rest if token.kind == "command")
        is_over = any(is_about(token, {thing}) for token in done for thing in things)
        happened = self._vocabulary.happened if is_over else {}
        places = words_of(text, asked)
        is_somebody = not vocabulary.negative_subjects.keys().isdisjoint(text.words[at] for at in places)
        negated = vocabulary.negative_subjects if is_somebody else vocabulary.negations
        denied = negated if is_denied else {}
        for at in places:
            pronoun = find(pronouns, text.words, at)
            kinds = self._context.pronouns[pronoun[0]] if pronoun is not None else ()
            meant = [value for kind, value in named if kind in kinds] or [value for _, value in named[:1] if kinds]
            if pronoun is not None and not named and pronoun[0] in vocabulary.values.ones:
                pronoun = None  # `there are more than one`
            if pronoun is not None and PLACE not in kinds and (len(meant) != 1 or meant[0][:1] == "{"):
                return ""
            is_there = PLACE in kinds  # `if she isn't there, tell me`
            word = next((form for form in denied.get(text.words[at], ()) if " " not in form), text.words[at])
            turned = happened.get(word) or ("" if is_denied else vocabulary.affirmed.get(word))
            word = turned or (self._written(at) if word == text.words[at] else word)
            words.append(meant[0] if meant and not is_there else word)
        said, of_robot = " ".join(words), self._vocabulary.of_robot
        if of_robot:
            pattern = "|".join(map(re.escape, sorted(of_robot, key=len, reverse=True)))
            said = re.sub(rf"\b(?:{pattern})\b", lambda match: of_robot[match[0].lower()], said, flags=re.IGNORECASE)
        return _sentence(said)

    def _failed(self, form: int) -> str:
        """`pick up the cup. If you can't find it, tell Bob`: that the command before some token has failed.

        Of a question and of a wait what the token says: `wait for Bob. If he hasn't come, tell Alice`.
        """
        tokens, text = self._tokens, self._text
        at = run_start(tokens, form, JOINTS | STATEMENT_ENDS) - 1
        while at > 0 and (tokens[at].kind in _AWAITING or tokens[at].kind in MEASURES):
            at -= 1
        tried = tokens[at] if at >= 0 else None
        begin = at - (at > 0 and tokens[at - 1].kind in _TRYING)
        is_first = begin == statement_start(tokens, max(at, 0)) or tokens[begin - 1].kind == "comma"
        if tried is None or tried.kind != "command" or not is_first or not isinstance(tried.value, Called | Listed):
            return ""
        front, words = self._vocabulary.asking["failing"][0], list(words_of(text, tried))
        if is_question(tried) or tried.value.entry.id == _COMES:
            front, words = "", self._asked_words(form)
        words = [at for at in words if text.words[at][0] not in '",']
        if searches(tried):
            before = tokens[statement_start(tokens, at) : at]
            words = self._sought(words, is_alone=any(map(searches, before)) or not self._says_all(tried.value, words))
        said = self._with_names(words, _names_in(tried.value))
        if not said:
            return ""
        said = f"{self._vocabulary.asking['search'][0]} {said}" if searches(tried) and front else said
        return _sentence(said, front)

    def _says_all(self, said: Called | Listed, words: Sequence[int]) -> bool:
        """Whether words name all in which the values of a list differ: none for `in the lab, then in the hall`."""
        first, *others = arguments_of(said)
        named = " ".join(self._text.words[at] for at in words)
        return all(text.lower() in named for row in others for text in dict({*row} - {*first}).values())

    def _own_words(self, form: int) -> str:
        """`wait until Bob comes, then A. If he hasn't come, tell Alice`: what isn't so, as it is said."""
        person = self._context.latest.get(PERSON, "")
        return _sentence(self._with_names(self._asked_words(form), [(PERSON, person)] if person else []))

    def _asked_words(self, form: int) -> list[int]:
        """The words of a form behind `if`, where they are about somebody: `he hasn't come`."""
        text, roles = self._text, self._vocabulary.roles
        joining = {word for phrase in (*roles["if"], *roles["and"]) for word in phrase.split()}
        words = list(dropwhile(lambda at: text.words[at] in joining, words_of(text, self._tokens[form])))
        return words if words and PERSON in self._context.pronouns.get(text.words[words[0]], ()) else []

    def _with_names(self, words: Sequence[int], named: Sequence[tuple[str, str]]) -> str:
        """Words with names in the place of pronouns, "" where one may stand for others."""
        said = list[str]()
        for at in words:
            pronoun = find(self._vocabulary.values.pronoun_words, self._text.words, at)
            kinds = self._context.pronouns[pronoun[0]] if pronoun is not None else ()
            meant = [value for kind, value in named if kind in kinds]
            is_person = self._text.words[at] in self._vocabulary.values.texts.of_persons
            if PLACE not in kinds and (kinds or is_person) and (len(meant) != 1 or meant[0][:1] == "{"):
                return ""
            said.append(meant[0] if meant and PLACE not in kinds else self._written(at))
        return " ".join(said)

    def _worked(self, end: int) -> str:
        """`close the door. If that works, tell Bob`: that the command before some token has worked."""
        done = self._tokens[end - 1] if end else None
        if done is None or done.kind != "command" or not isinstance(done.value, Called | Listed):
            return ""
        front, words = self._vocabulary.asking["working"][0], list(words_of(self._text, done))
        said = self._with_names([at for at in words if self._text.words[at][0] not in '",'], _names_in(done.value))
        return _sentence(said, front)

    def _found(self, end: int) -> str:
        """`look for the cup. If you find it, tell Bob`: that what the command before some token looks for was found."""
        search = self._tokens[end - 1] if end else None
        if search is None or search.kind != "command" or not searches(search):
            return ""
        words = [at for at in words_of(self._text, search) if self._text.words[at][0] != '"']
        if any(self._text.words[at] in self._context.pronouns for at in words):
            return ""
        front = self._vocabulary.asking["found"][0]
        sought = " ".join(map(self._written, self._sought(words)))
        return _sentence(f"{front} {sought}").replace(" ,", ",")

    def _sought(self, words: Sequence[int], is_alone: bool = False) -> list[int]:
        """The words for what a search is for, and for where unless those `is_alone`: it has looked elsewhere too."""
        reads = ((at, self._context.read(kind, self._text, at)) for at in words for kind in (OBJECT, PERSON))
        first, last = next(((at, read[1]) for at, read in reads if read is not None), (words[0], words[-1] + 1))
        return [at for at in words if at >= first and not (is_alone and at >= last)]

    def _replied(self, form: int) -> str:
        """`ask Bob "Tea?". If so, tell Alice`: what somebody says by name to a question, which a form depends on."""
        tokens, condition = self._tokens, self._tokens[form + 1].value
        questions = (token.value for token in reversed(tokens[:form]) if is_question(token))
        asked = next(questions, None)
        if not isinstance(asked, Called) or not isinstance(condition, Called) or condition.entry.id != ANSWERED:
            return ""
        types = {slot.name: slot.type for slot in asked.entry.slots}
        said = {types[name]: text for name, text in asked.arguments}
        person = said.get(PERSON) or self._vocabulary.asking["somebody"][0].capitalize()
        if person[:1] == "{":
            return ""
        words = self._vocabulary.asking["replied"][0]
        return words.format(person=person, answer=condition.arguments[0][1], question=said[TEXT])

    def _written(self, at: int) -> str:
        """A word as it is written, with its article."""
        text = self._text
        whole = text.source.text[text.begin(at) : text.ends[at]]
        return whole if whole.lower().endswith(text.words[at]) else text.words[at]


def _is_pace(match: Match, last: int) -> bool:
    return match.meaning.role == "every" and match.last == last


def _sentence(said: str, front: str = "") -> str:
    """Words as a sentence, behind those in front of them; "" for none."""
    whole = f"{front} {said[:1].lower()}{said[1:]}" if front and said else said
    return f"{whole[:1].upper()}{whole[1:]}"


def _names_in(said: Called | Listed) -> list[tuple[str, str]]:
    """The values of a command, each with its type; of a list those that all of it have."""
    types, rows = {slot.name: slot.type for slot in said.entry.slots}, arguments_of(said)
    return [(types[name], value) for name, value in rows[0] if all((name, value) in row for row in rows)]
