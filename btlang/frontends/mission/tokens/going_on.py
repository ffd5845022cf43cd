"""Words that go on with the statement before them: `if that fails`, `otherwise`, `if you don't find it`."""

from __future__ import annotations

from btlang.diagnostics.diagnostic import diagnostic
from btlang.frontends.mission.token import (
    FORMS,
    JOINTS,
    LINES,
    RULES,
    STATEMENT_ENDS,
    WAITING,
    Called,
    Listed,
    Token,
    closed_until,
    drives,
    go_on,
    run_start,
    statement_start,
)
from btlang.frontends.mission.tokens.rules_inside import ON_WAY
from btlang.frontends.mission.tokens.sentence_reader import (
    SentenceReader,
    asks_for_things,
    hears,
    question_in,
    searches,
)
from btlang.frontends.mission.tokens.settling import (
    FAILS,
    MEASURES,
    WORKS,
    asked_about,
    is_about,
    settle,
    takes,
)
from btlang.text.source import Span
from btlang.text.words import END_OF_STATEMENT, END_OF_TEXT
from btlang.tree.answers import ASK, EXAMPLE
from btlang.vocabulary.match import Match
from btlang.vocabulary.value_type import PLACE
from btlang.vocabulary.word_tree import find

_JOINTS = JOINTS | STATEMENT_ENDS
_UNANSWERED, _STOP = "if_unanswered", "Stop"
_DONE, _ASKED = ("command", "name"), ("condition", "not")
_ENDS = (END_OF_STATEMENT, END_OF_TEXT, ";", ")")
_CHOICES = frozenset(("if", "unless", "otherwise", WORKS))
_MEANWHILE = frozenset((*RULES, "while", "until", "meanwhile", "in_parallel"))
_ENDLESS = frozenset(("every", "every_day", "weekly", "repeat"))
_BOUNDS = FORMS | {"until_time", "for", "indent", FAILS}  # behind a branch it is `with_rest_of_rounds` that goes on
BRANCHES = FORMS | {"every_day"}
"""Raw kinds with which it is open whether a command of the statement has run."""


class GoingOn(SentenceReader):
    """Those of one text, behind the tokens that it has so far."""

    _looked: tuple[int, Token | None, int, frozenset[str]] = 0, None, 0, frozenset()
    """How many tokens have been looked at, the last of them, where its statement begins, and the kinds in that."""

    def _statement(self, end: int) -> tuple[int, frozenset[str]]:
        """Where the statement begins in which the tokens before one stand, and their kinds.

        A statement that goes on and on is looked at from where it was looked at last.
        """
        tokens, (done, latest, start, kinds) = self._tokens, self._looked
        is_known = 0 < done <= end and tokens[done - 1] is latest
        at, found = end, set[str]()
        while at > (done if is_known else 0) and tokens[at - 1].kind not in LINES:
            at -= 1
            found |= {tokens[at].kind, *((FAILS,) if tokens[at].value == FAILS else ())}
        if is_known and at == done:
            at, found = start, found | kinds
        self._looked = end, tokens[end - 1] if end else None, at, frozenset(found)
        return at, self._looked[3]

    def _before(self, form: int) -> int | None:
        """The command right before a form, with measures of it between them; None where it may not have run."""
        tokens, command = self._tokens, form - 1
        while command >= 0 and tokens[command].kind in _JOINTS:
            command -= 1
        is_new = any(token.kind in STATEMENT_ENDS for token in tokens[command + 1 : form])
        while command > 0 and tokens[command].kind in MEASURES:
            command -= 1
        if command < 0 or tokens[command].kind != "command":
            return None
        if is_new and not BRANCHES.isdisjoint(self._statement(command)[1]):
            return None  # `If bumped, look for the cup. If it isn't there, A`
        return command

    def _join(self, command: int, form: int, end: int, denied: bool) -> None:
        """Makes a form that ends at a character the word between the command and what comes behind."""
        tokens, behind = self._tokens, command + 1
        while tokens[behind].kind in MEASURES:
            behind += 1
        is_new = any(token.kind in STATEMENT_ENDS for token in tokens[behind:form])
        meaning = self._meaning(tokens[form], denied, is_new)
        if meaning is None:
            return
        meaning.end = end
        if denied and not is_new and WORKS in self._statement(form)[1]:
            if self._denies_what_worked(Span(self._text.source, meaning.start, end)):
                meaning = Token("otherwise", meaning.start, end)  # `if he is there, A, and if he isn't there, B`
        del tokens[form:]
        if is_new:
            go_on(tokens)
            role = meaning.kind if meaning.value is None else str(meaning.value)
            if role != (role := self.going_on(role, Span(self._text.source, meaning.start, end))):
                meaning = Token(role, meaning.start, end)
        else:
            del tokens[behind:]
        tokens.append(meaning)

    def _join_otherwise(self, form: int) -> None:
        """`look for the cup. If it is there, A. If it isn't there, B`: the second is `otherwise`."""
        tokens = self._tokens
        before = run_start(tokens, form, STATEMENT_ENDS)
        start, end = tokens[form].start, tokens[-1].end
        if before < form and WORKS in self._statement(before)[1]:
            if self._denies_what_worked(Span(self._text.source, start, end)):
                del tokens[form:]
                go_on(tokens)
                tokens.append(Token("otherwise", start, end))

    def _meaning(self, form: Token, denied: bool, is_new: bool) -> Token | None:
        """What a form says that asks what the command has settled: that it failed, or worked, or `then`."""
        word, at = self._text.source.text[form.start : form.end].lower(), form.start
        if denied:
            return Token("or", at, at, FAILS) if form.kind == "if" else None
        if form.kind != "if" or word in self._vocabulary.asked_once:
            return Token("then", at, at)
        return Token(WORKS, at, at) if is_new else None

    def _ask_after_all(self) -> None:
        """`look for the cup. When you find it, A. Otherwise B`: `when` asks whether it is found."""
        tokens = self._tokens
        first = statement_start(tokens, run_start(tokens, len(tokens), STATEMENT_ENDS))
        if 0 < first < len(tokens) and tokens[first].kind == "then":
            said = _words(self._text.source.text[tokens[first].start : tokens[first].end])
            if not set(said).isdisjoint(self._vocabulary.asking["finding"]):
                tokens[first - 1].kind, tokens[first].kind = "stop", WORKS

    @property
    def _searching(self) -> set[str]:
        """The words that ask whether something was found."""
        return {*self._vocabulary.asking["finding"], *self._vocabulary.asking["missed"]}

    def going_on(self, role: str, words: Span) -> str:
        """The role of words that go on with the statement before: `if you don't find it` denies `if you find it`.

        BT168 for what goes on with a failure where something stands between: `if C, A. If that fails, B. Otherwise D`.
        BT145 for silence behind what is no question: `ask "Tea?". If she says no, A. If she says nothing, B`.
        """
        if role == _UNANSWERED and self._has_answered():
            return "otherwise"
        if role == _UNANSWERED:
            return self._about_question(words)
        if role in ("in_parallel", "meanwhile") and FAILS in self._statement(len(self._tokens))[1]:
            self._unclear(words)  # `A. If that fails, B. In parallel, C`
        if role not in ("otherwise", FAILS, WORKS):
            return role
        if role != "otherwise" and not self._searching.isdisjoint(_words(words.text)):
            role = self._about_search(role, words)
        if role == "otherwise":
            self._ask_after_all()
        kinds = self._statement(len(self._tokens))[1]
        if role == FAILS and self._denies_before(words, len(self._tokens)):
            return "otherwise"
        if WORKS in kinds if role == FAILS else FAILS in kinds and WORKS not in kinds:
            if role != "otherwise" or not kinds.isdisjoint(FORMS):
                self._unclear(words)
        return role

    def _ask_alone(self) -> None:
        """`go to the door and check if it is open. If so, A`: about what is checked, not about the journey."""
        tokens = self._tokens
        last = run_start(tokens, len(tokens) - 1, JOINTS | STATEMENT_ENDS)
        first = statement_start(tokens, last)
        check = next((at for at in reversed(range(first, last)) if tokens[at].kind == "check"), first)
        joint = run_start(tokens, check, JOINTS)
        is_plain = all(token.kind in (*_DONE, *JOINTS) for token in tokens[first:joint])
        if first < joint < check and is_plain and all(each.kind in _ASKED for each in tokens[check + 1 : last]):
            tokens[joint:check] = [Token("semi", tokens[check].start, tokens[check].start)]

    def asks_anew(self, match: Match, at: int) -> bool:
        """Whether `if you find anybody` is about what is there: nothing before it is looked for."""
        before = next((token for token in reversed(self._tokens) if token.kind in ("command", "name")), None)
        asks = not set(self._vocabulary.asking["finding"]).isdisjoint(self._text.words[at : match.last])
        if not asks or before is None or not drives(before.value) or searches(before) or takes(before):
            return False
        asked = self._phrase(at + 1 + (self._text.words[at] in self._vocabulary.roles["and"]))
        return asked is not None and asked.meaning.role == "condition"

    def _doubt_silence(self, words: Span) -> None:
        """BT144 for `ask Alice and Bob "Tea?". If they don't answer, A`: whoever is silent, or both."""
        asked = next((token for token in reversed(self._tokens) if token.kind == "command" and hears(token)), None)
        if asked is not None and isinstance(asked.value, Listed):
            said, problem = words.text.rstrip(" ,"), "could be about one of them or about all"
            self._calls.problems.append(diagnostic("BT144", words, words=said, problem=problem, example=EXAMPLE))

    def _in_round(self) -> bool:
        """Make one round for each thing of the list or set in the statement before; False without such a one."""
        tokens, listed = self._tokens, self._context.listed
        last = run_start(tokens, len(tokens) - 1, JOINTS | STATEMENT_ENDS)
        said = [token for token in tokens[statement_start(tokens, last) : last] if token.kind == "command"]
        entries = {token.value.entry.id for token in said if isinstance(token.value, Called | Listed)}
        if any(self._calls.is_set(token) for token in said) or (len(said) > 1 and len(entries) == 1):
            return True
        return any(self._calls.is_round(token, goal) for token in said for goal in listed.values() if goal)

    def check_asked(self, match: Match, at: int) -> None:
        """BT145 for `wave or, if he doesn't answer, nod`."""
        self._check_asked(self._text.span(at, match.last))

    def _check_asked(self, words: Span) -> None:
        said = next((token for token in reversed(self._tokens) if token.kind == "command"), None)
        if said is not None and hears(said):
            return
        word, verb = self._vocabulary.word, self._vocabulary.entry(ASK)
        begin = verb.phrases[0].split()[0] if verb is not None else ""
        question = f'{begin} "{question_in(said)}"'
        example = f"{question}. {word(WORKS).capitalize()}, wave. {word('otherwise').capitalize()} nod"
        self._calls.problems.append(diagnostic("BT145", words, words=words.text.rstrip(","), example=example))

    def _unclear(self, words: Span) -> None:
        """BT168: about which command the words are."""
        word = self._vocabulary.word
        example = f"dock. {word(WORKS)}, wave. {word('otherwise')} nod"
        self._calls.problems.append(diagnostic("BT168", words, words=words.text, example=example))

    def _about_search(self, role: str, words: Span) -> str:
        """The role of words that ask whether something was found, which are about the search alone."""
        start, kinds = self._statement(len(self._tokens))
        at = asked_about(self._tokens, len(self._tokens), searches)
        at = at if at is not None else self._first_about(start, words)
        if at is None or not FORMS.isdisjoint(kinds):
            if at is not None and at < start and role == FAILS:
                self._unclear(words)  # `look for the book. If bumped, wave. If you can't find it, nod`
            return role
        end = run_start(self._tokens, len(self._tokens), STATEMENT_ENDS)
        if role == WORKS and any(token.kind not in MEASURES for token in self._tokens[at + 1 : end]):
            return role
        made = self._settle_command(at)
        if not made:
            self._unclear(words)
        return made if made == "otherwise" else role

    def _about_question(self, words: Span) -> str:
        """The role of words about silence, which are about the question alone: what stands before it has failed."""
        self._check_asked(words)
        kinds = self._statement(len(self._tokens))[1]
        at = asked_about(self._tokens, len(self._tokens), hears) if BRANCHES.isdisjoint(kinds) else None
        made = self._settle_command(at) if at is not None else ""
        if made == "otherwise":
            return made
        self.try_question(len(self._tokens))
        return _UNANSWERED

    def try_question(self, end: int) -> None:
        """Make the question right before a token what is tried: `go to Bob, ask him "Tea?" and if he is silent, A`."""
        tokens = self._tokens
        at = run_start(tokens, end, _JOINTS | MEASURES) - 1
        if at > self._statement(end)[0] and tokens[at].kind == "command" and hears(tokens[at]):
            if tokens[at - 1].kind in JOINTS:
                tokens.insert(at, Token("try", tokens[at].start, tokens[at].start))
                self._looked = 0, None, 0, frozenset()

    def _settle_command(self, at: int, with_branches: bool = False) -> str:
        """See `settle`; the tokens that it makes have to be looked at anew."""
        self._looked = 0, None, 0, frozenset()
        return settle(self._tokens, at, with_branches)

    def _first_about(self, start: int, words: Span) -> int | None:
        """The first command of a statement about the thing that a pronoun among some words stands for."""
        types = {kind for word in _words(words.text) for kind in self._vocabulary.values.pronouns.get(word, ())}
        meant = {self._context.latest[kind] for kind in types if kind in self._context.latest}
        tokens = self._tokens
        found = (i for i in range(start, len(tokens)) if any(is_about(tokens[i], {each}) for each in meant))
        return next(found, None)

    def _denies_before(self, words: Span, end: int) -> bool:
        """Whether the words deny what the statement before a token has asked: what worked, or `if you find the cup`."""
        first, kinds = self._statement(end)
        if WORKS in kinds:
            return self._denies_what_worked(words)
        is_about = not self._searching.isdisjoint(_words(words.text))
        return is_about and asks_for_things(self._tokens[first:end], self._text.source, self._searching)

    def _denies_what_worked(self, words: Span) -> bool:
        """Whether the words deny the latest ones by which the statement asked whether its command worked."""
        at = next(at for at in reversed(range(len(self._tokens))) if self._tokens[at].kind == WORKS)
        worked, pronouns = self._tokens[at], self._vocabulary.values.pronouns
        asked, said = _words(self._text.source.text[worked.start : worked.end]), _words(words.text)
        if not self._searching.isdisjoint(asked) and not self._searching.isdisjoint(said):
            return True  # `if you find it, A; if it is nowhere, B`
        has_left = any(drives(token.value) for token in self._tokens[at:])
        if has_left and any(PLACE in pronouns.get(word, ()) for word in said):
            return False  # `if he is there, go to the lab. If he isn't there, A`: it may be about the lab
        cannot = {phrase.split()[-1] for phrase in self._vocabulary.asking["unable"]}
        denied = (
            (asked[:at], [*way.split(), *asked[at + 1 :]])
            for at, verb in enumerate(asked)
            for way in (*self._vocabulary.negations.get(verb, ()), *(f"{word} {verb}" for word in cannot))
        )
        for subject, rest in denied:
            before = said[: -len(rest)]
            is_same = before[-len(subject) :] == subject or (before != [] and before[-1] in pronouns)
            if said[-len(rest) :] == rest and is_same:
                return True
        return False

    def _has_answered(self) -> bool:
        """Whether the statement does something where somebody answers: `ask "Tea?". If he answers, wave`."""
        if WORKS not in self._statement(len(self._tokens))[1]:
            return False
        at = next(at for at in reversed(range(len(self._tokens))) if self._tokens[at].kind == WORKS)
        return hears(self._tokens[run_start(self._tokens, at, _JOINTS | MEASURES) - 1])

    def give_up(self, end: int) -> None:
        """`A. If that fails, say "no" and stop`: the command that ends at a word ends the mission, which has failed.

        BT151 for `if bumped, stop. Then dock`.
        """
        tokens, stop = self._tokens, self._tokens[-1]
        if not isinstance(stop.value, Called) or stop.value.entry.id != _STOP or not self._is_end(end):
            return
        kinds = self._statement(len(tokens))[1]
        if FAILS in kinds:
            tokens[-1] = Token("fail", stop.start, stop.end)
        elif not kinds.isdisjoint(_CHOICES) and kinds.isdisjoint(_MEANWHILE) and self._goes_on(end):
            words, word = Span(self._text.source, stop.start, stop.end), self._vocabulary.word
            one, other = f"{word('fail')}, which ends the mission", f"{word('nothing')}, and the mission goes on"
            self._calls.problems.append(diagnostic("BT151", words, words=words.text, one=one, other=other))

    def end_mission(self, at: int) -> int:
        """`if that fails, end the mission`; at the end of a text it says nothing. Returns where to go on."""
        found = find(self._vocabulary.finishing, self._text.words, at)
        if found is None or not self._is_end(found[1]):
            return 0
        tokens, kinds = self._tokens, self._statement(len(self._tokens))[1]
        if kinds.isdisjoint(BRANCHES) and FAILS not in kinds and tokens and not self._goes_on(found[1]):
            del tokens[run_start(tokens, len(tokens), JOINTS) :]
        else:
            tokens.append(Token("fail", self._text.starts[at], self._text.ends[found[1] - 1]))
            if self._text.words[at] in self._vocabulary.asking["ending_well"]:
                said = self._text.span(at, found[1])
                self._calls.problems.append(diagnostic("BT257", said, words=said.text))
        return found[1]

    def _goes_on(self, end: int) -> bool:
        """Whether anything but `otherwise` is said behind the end of a statement."""
        words = self._text.words
        at = next((at for at in range(end, len(words)) if words[at] not in _ENDS), None)
        behind = self._phrase(at) if at is not None else None
        return at is not None and (behind is None or behind.meaning.role not in ("otherwise", FAILS))

    def goes_on_endlessly(self) -> bool:
        """`every day at 8, A. Then B`: whether A never ends, so that B is a part of each round, and goes on with it."""
        tokens = self._tokens
        end = run_start(tokens, len(tokens), STATEMENT_ENDS)
        first, kinds = self._statement(end)
        if not 0 < end < len(tokens) or not kinds.isdisjoint(_BOUNDS) or tokens[first].kind not in _ENDLESS:
            return False
        if tokens[first + 1].value != "-1" if tokens[first].kind == "repeat" else "count" in kinds:
            return False
        del tokens[end:]
        return True

    def doubt_rule(self, role: str, at: int, last: int) -> None:
        """BT151 for what may be a part of the rule before it, or wait for it: `whenever bumped, wave. Then dock`."""
        end, text = run_start(self._tokens, len(self._tokens), STATEMENT_ENDS), self._text
        words, (first, kinds) = text.span(at, last), self._statement(end)
        until = closed_until(self._tokens[first:end])
        is_new_line = "\n" in text.source.text[self._tokens[end - 1].end : words.start] if end else True
        frame = next((each.kind for each in self._tokens[first:end] if each.kind in (*WAITING, *RULES)), "")
        if not end or (role == "then" and not until and (is_new_line or frame in WAITING)):
            return
        is_on_way = any(token.role == ON_WAY or token.kind == "while_doing" for token in self._tokens[first:end])
        if (not until and (kinds.isdisjoint(RULES) or is_on_way)) or (role == "otherwise" and "if" in kinds):
            return
        rest = self._end_of_statement(last := last + (text.words[last] == ","))
        said = text.span(last, rest).text if rest > last else "..."
        joint = self._vocabulary.word(FAILS if role == "otherwise" else "at" if until else role)
        one = f"{joint} {until}, {said}" if until else f"{joint}, {said}" if role != "then" else f"... {joint} {said}"
        self._calls.problems.append(diagnostic("BT151", words, words=words.text, one=one, other=said))


def _words(text: str) -> list[str]:
    return text.lower().rstrip(",").split()
