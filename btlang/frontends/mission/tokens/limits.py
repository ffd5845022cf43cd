"""How long may pass until a command is asked about: `wait at the door. If nobody comes within 5 min, A`."""

from __future__ import annotations

from collections.abc import Callable

from btlang.diagnostics.diagnostic import diagnostic
from btlang.frontends.mission.explanations.times import lasting
from btlang.frontends.mission.token import (
    FORMS,
    IN_CONDITIONS,
    JOINTS,
    STATEMENT_ENDS,
    Called,
    Listed,
    Token,
    drives,
    go_on,
    run_start,
    statement_start,
    texts_of,
    with_text,
)
from btlang.frontends.mission.tokens.going_on import GoingOn
from btlang.frontends.mission.tokens.journey_words import SEES
from btlang.frontends.mission.tokens.sentence_reader import hears, searches
from btlang.frontends.mission.tokens.settling import (
    FAILS,
    HOLDS,
    MEASURES,
    STAYS,
    TURNED,
    WAITS,
    WORKS,
    achieves,
    asked_about,
    is_presence,
    misses,
    named_by,
)
from btlang.frontends.mission.tokens.silent_words import BEGINS
from btlang.text.source import Span
from btlang.vocabulary.antecedents import says_there
from btlang.vocabulary.entry import Entry
from btlang.vocabulary.match import Match
from btlang.vocabulary.references import choice_of
from btlang.vocabulary.value_type import OBJECT, PERSON, PLACE

_TIME = "duration"
_LIMITS = ("within", "delay", "for", "held", "by_time")
"""What may say how long a command may take, behind words that ask how it went."""

_MEETING = ["open", "command", "and", "command", "close"]
"""The kinds of tokens of a wait for somebody, with the journey to where that is."""


class Limits(GoingOn):
    """Those of one text."""

    def _doubt_so(self, end: int, at: int) -> None:
        """BT151 for `go to the lab unless C. If so, A`: if C, or if that worked."""
        tokens, text = self._tokens, self._text
        last = run_start(tokens, len(tokens) - 1, JOINTS | STATEMENT_ENDS)
        first = statement_start(tokens, last)
        form = next((i for i in range(first, last) if tokens[i].kind in ("if", "unless")), last)
        asked = next((token for token in tokens[form:last] if token.kind == "condition"), None)
        if asked is None or tokens[form].start == tokens[form].end:
            return  # none, or an answer that has been asked about
        words, condition = text.span(at, end), Span(text.source, asked.start, asked.end).text
        one = f"{self._vocabulary.word('if')} {condition}, ..."
        other = f"{self._vocabulary.word('if_works')}, ..."
        self._calls.problems.append(diagnostic("BT151", words, words=words.text.rstrip(" ,"), one=one, other=other))

    def turns(self, otherwise: Token) -> None:
        """`A. If that fails, B. Otherwise C`: C is done if A works; see `turn_branches`. Not so in a bracket of B."""
        kinds = self._statement(len(self._tokens) - 1)[1]
        if FAILS not in kinds or WORKS in kinds or not kinds.isdisjoint(FORMS):
            return
        form = next(at for at in reversed(range(len(self._tokens))) if self._tokens[at].value == FAILS)
        brackets = [token.kind for token in self._tokens[form:] if token.kind in ("open", "close")]
        if brackets.count("open") == brackets.count("close"):
            otherwise.role = TURNED

    def _limit_before(self, end: int, role: str) -> int:
        """`if you find him within 60 s, A`, `if that doesn't work after two attempts, A`: of the command before."""
        tokens, form = self._tokens, len(self._tokens) - 1
        at = asked_about(tokens, form, lambda _: True)
        if at is None or any(token.kind not in (*JOINTS, "stop") for token in tokens[at + 1 : form]):
            return end
        if role == FAILS and (last := self._tries_of(at, end)):
            return last
        return self._limit(tokens[at], end) if role == FAILS or searches(tokens[at]) else end

    def _tries_of(self, at: int, end: int) -> int:
        """Make the command at a place so many tries as the words at `end` say. Returns where they end, 0 for others."""
        tokens, tries = self._tokens, self._phrase(end)
        if tries is None or tries.meaning.role != "tries":
            return 0
        count = self._calls.token(tries, end)
        tokens.insert(at + 1, Token("count", count.start, count.end, count.value))
        tokens.insert(at, Token("retry", tokens[at].start, tokens[at].start))
        return tries.last

    def _pick_first(self, at: int, entry: Entry) -> int:
        """`bring the cup to Bob. If you can't pick it up, A`: picks it up before that. Returns how many tokens came."""
        command, value = self._tokens[at], self._tokens[at].value
        things = value.entry.given(OBJECT, value.arguments) if isinstance(value, Called) else []
        if not isinstance(value, Called) or not things or HOLDS not in entry.achieves or HOLDS in value.entry.achieves:
            return 0
        slot, choice = next(slot.name for slot in entry.slots if slot.type == OBJECT), choice_of(things[0])
        picked = Called(entry, ((slot, things[0]),))
        if choice is not None:  # once it is held, it isn't where it was
            held = with_text(value.arguments, choice.text, f"{{{choice.key}}}")
            command.value = value.replace(arguments=held)
        start = command.start
        self._tokens[at:at] = [Token("command", start, start, picked), Token("then", start, start)]
        return 2

    def _is_tried(self, at: int) -> bool:
        tries = self._phrase(at)
        return tries is not None and tries.meaning.role == "tries"

    def _settled_before(self, at: int, asked: Token) -> int | None:
        """The place of a command that settles a condition before another one at a place does: it fails first.

        That is one that takes the same thing, or goes to the same person, with no journey elsewhere between both.
        """
        tokens = self._tokens
        if tokens[at].kind != "command":
            return None
        is_same = misses if misses(tokens[at], asked) else achieves
        before = asked_about(tokens, at, lambda token: token.kind == "command" and is_same(token, asked))
        if before is None or (is_same is achieves and any(drives(token.value) for token in tokens[before + 1 : at])):
            return None
        return before

    def _ask_later(self) -> None:
        """`if nobody is near five minutes later, A`: it waits, and asks then."""
        tokens = self._tokens
        form = run_start(tokens, len(tokens) - 1, IN_CONDITIONS) - 1
        is_first = form == 0 or (form > 0 and tokens[form - 1].kind in (*BEGINS, *JOINTS))
        if is_first and tokens[form].kind in ("if", "unless"):
            delay = tokens.pop()
            tokens[form:form] = [delay, Token("comma", delay.end, delay.end)]

    def _limit_wait(self) -> None:
        """`wait at the door until C, but no longer than 5 min`: it waits so long, the way there left out.

        The same with `or until 5 min have passed`.
        """
        tokens, limit = self._tokens, self._tokens[-1]
        is_end = limit.kind == "for" and tokens[-2:-1] != [] and tokens[-2].kind == "or"
        behind = len(tokens) - 2 if is_end else run_start(tokens, len(tokens) - 1, JOINTS)
        begin = run_start(tokens, behind, IN_CONDITIONS) - 1
        if not 0 <= begin < behind - 1 or (limit.kind == "for" and not is_end):
            return
        if tokens[begin].kind == "wait_until":
            tokens[begin].kind, tokens[begin].value = "wait_up_to", limit.value
            del tokens[behind:]
        elif tokens[begin].kind == "until" and is_end:
            limit.kind = "up_to"
            del tokens[behind]

    def _limit_sought(self, is_last: bool) -> None:
        """`look for Bob for up to 5 min` fails then without him; `wait for Bob, but no longer than 5 min` is over."""
        tokens, limit = self._tokens, self._tokens[-1]
        behind = run_start(tokens, len(tokens) - 1, ("comma",)) if limit.kind == "up_to" else 0
        if behind and searches(tokens[behind - 1]):
            limit.kind = "within"
        elif behind and (self._awaits(tokens[behind - 1]) or self._is_meeting(behind)):
            pass  # it may be over without anybody, unless that is asked about
        elif is_last or not behind or self._words_of(limit)[0] not in self._vocabulary.roles["but"]:
            return
        del tokens[behind:-1]  # `charge, but no longer than 5 min, then wave`

    def _is_meeting(self, end: int) -> bool:
        """Whether a wait for somebody with the journey to where that is ends at a place."""
        meeting = self._tokens[max(end - len(_MEETING), 0) : end]
        return [token.kind for token in meeting] == _MEETING and self._awaits(meeting[-2])

    def _words_of(self, token: Token) -> list[str]:
        return self._text.source.text[token.start : token.end].lower().split()

    def _awaits(self, token: Token) -> bool:
        """Whether a command waits for somebody."""
        value = token.value
        if token.kind != "command" or not isinstance(value, Called | Listed) or not value.entry.achieves:
            return False
        return self._words_of(token)[:1] == [*self._vocabulary.asking["waiting"]][:1]

    def _free_wait(self, form: int) -> int:
        """Take `wait 5 min for Bob at the door` out of its brackets, as its statement; return how many tokens went."""
        tokens, last = self._tokens, run_start(self._tokens, form, STATEMENT_ENDS) - 1
        first = last - len(_MEETING) + 1
        if not self._is_meeting(last + 1) or statement_start(tokens, form - 1) != first:
            return 0
        goes, wait, here = tokens[first + 1], tokens[last - 1], tokens[last].end
        tokens[first : last + 1] = [goes, Token("then", here, here), wait]
        return 2

    def _make_fail(self, at: int) -> None:
        """Let a wait for the condition at a place fail when its time is over; alone it works in any case."""
        tokens = self._tokens
        wait = tokens[at - 1]
        if tokens[at].kind == "condition" and wait.kind == "wait_up_to":
            tokens.insert(at + 1, Token("within", wait.start, wait.end, wait.value))
            wait.kind, wait.value = "wait_until", None
        elif at + 1 < len(tokens) and tokens[at + 1].kind in ("for", "up_to") and self._waits(tokens[at]):
            tokens[at + 1].kind = "within"

    def _waits(self, token: Token) -> bool:
        """Whether a token is what is waited for, or a command that waits for somebody."""
        return token.kind == "condition" or self._awaits(token)

    def _waited(self, form: int, is_settled: Callable[[Token], bool]) -> int | None:
        """The place of what the two statements before a form wait for, if the form asks what that settles.

        No more of them: a look through all would take the longer for each line, the longer the text is.
        """
        tokens, first = self._tokens, form
        for _ in range(2):
            first = statement_start(tokens, run_start(tokens, first, STATEMENT_ENDS))
        near = tokens[first:form]
        at = asked_about(near, len(near), lambda token: self._waits(token) and is_settled(token))
        return None if at is None else first + at

    def _may_ask_again(self, at: int, form: int, end: int) -> bool:
        """Whether a condition behind `wait up to 5 min until C` asks what is so then."""
        tokens = self._tokens
        last = run_start(tokens, form, STATEMENT_ENDS)
        limits = [token.kind for token in (tokens[at - 1], *tokens[at + 1 : last])]
        waits = tokens[at].kind == "condition" and (limits == ["wait_up_to"] or limits[1:] in (["for"], ["up_to"]))
        return waits and self._time_behind(end) is None and not self._is_event(tokens[-1])

    def _is_event(self, asked: Token) -> bool:
        """Whether a condition says that something happens: `somebody comes`."""
        return self._vocabulary.says_event(self._text.source.text[asked.start : asked.end])

    def _wait_before(self, form: int, asked: Token, end: int) -> int | None:
        """`wait at the door. If nobody comes within 5 min, A`, `wait 5 min. If nobody comes, A`: it waits for that.

        The place of what is waited for then, None where no command before the form waits.
        """
        tokens = self._tokens
        last = run_start(tokens, form, STATEMENT_ENDS) - 1
        if tokens[last].kind == "close" and tokens[last - 1].kind == "wait":  # `wait 5 min at the door`
            begin = next((at for at in reversed(range(last)) if tokens[at].kind in ("open", "close")), 0)
            if tokens[begin].kind != "open":
                return None
            del tokens[last], tokens[begin]
            last -= 2
        wait, here = tokens[last], tokens[last].end
        if wait.kind == "wait":
            wait.kind = "wait_up_to"
        elif wait.role != STAYS:
            return None
        elif self._time_behind(end) is None:
            self._calls.problems.append(lasting(Span(self._text.source, wait.start, wait.end), self._vocabulary))
            return None
        else:
            goes = [] if wait.kind == "nothing" else [wait, Token("then", here, here)]  # `wait there`
            tokens[last : last + 1] = [*goes, Token("wait_until", here, here)]
            last += len(goes)
        tokens.insert(last + 1, Token("condition", here, here, asked.value))
        return last + 1

    def _deny_before(self, form: int) -> None:
        """`wait for Bob until 6 pm. If he comes, A, and if he doesn't come, B`: the second is `otherwise`."""
        tokens = self._tokens
        first = statement_start(tokens, form)
        asked = [token.value for token in tokens[first:form] if token.kind == "condition"]
        if tokens[form + 1].kind == "not" and tokens[first].kind == "if" and asked == [tokens[-1].value]:
            start, end = tokens[form].start, tokens[-1].end
            del tokens[run_start(tokens, form, JOINTS | {"semi"}) :]
            tokens.append(Token("otherwise", start, end))

    def _go_on_then(self, form: int, end: int) -> int:
        """`wait until Bob arrives. When he arrives, A`: A then. `wait for up to 5 min. If he arrives, A` asks that."""
        tokens, asked = self._tokens, self._tokens[-1]
        last = run_start(tokens, form, JOINTS | STATEMENT_ENDS) - 1
        waits = last > 0 and tokens[last].kind == "condition" and tokens[last - 1].kind in WAITS
        word = self._text.source.text[tokens[form].start : tokens[form].end].lower()
        if not waits or not self._is_settled(tokens[last], asked):
            return end
        start = tokens[form].start
        if word not in self._vocabulary.asked_once:
            if tokens[last - 1].kind != "wait_up_to" or not self._is_event(asked):
                return end
            stop, awaited = asked.end, tokens[last]
            del tokens[form:]
            go_on(tokens)
            self._make_fail(last)
            self._settle_command(tokens.index(awaited))
            tokens.append(Token(WORKS, start, stop))
            return self._behind_comma(end)
        del tokens[form:]
        go_on(tokens)
        del tokens[last + 1 :]
        tokens.append(Token("then", start, asked.end))
        return self._behind_comma(end)

    def _is_settled(self, token: Token, asked: Token) -> bool:
        """Whether a command, or what is waited for, is what a condition asks."""
        if token.kind == "command":
            return achieves(token, asked) or (misses(token, asked) and not self._is_event(asked))
        somebody, awaited = self._vocabulary.negative_subjects, token.value
        is_kind = isinstance(awaited, Called) and awaited.entry.id == SEES and self._is_event(asked)
        is_anybody = is_presence(asked.value, somebody) and (is_kind or is_presence(awaited, somebody))
        said = {*texts_of(asked.value)} if isinstance(asked.value, Called) else {""}
        is_same = is_kind and isinstance(awaited, Called) and said <= named_by(awaited)
        return awaited == asked.value or is_anybody or is_same  # `wait for a guest. If nobody comes, A`

    def _turn(self, wait: int, then: int, form: int, end: int) -> int:
        """`wait for Bob for 10 min. When he comes, A, and if he doesn't come, B`: B is done if the wait fails.

        BT152 where it waits until he does.
        """
        tokens, text = self._tokens, self._text
        said = tokens[wait].value
        has_time = isinstance(said, Called) and said.entry.given(_TIME, said.arguments) != []
        if has_time or tokens[wait + 1].kind in MEASURES:
            start, stop = tokens[form].start, tokens[-1].end
            del tokens[run_start(tokens, form, JOINTS) :]
            tokens.append(Token("otherwise", start, stop))
            tokens[then] = Token(WORKS, tokens[then].start, tokens[then].end)
            self._make_fail(wait)
            return end
        words = Span(text.source, tokens[form].start, tokens[-1].end)
        waits = text.source.text[tokens[wait].start : tokens[wait].end]
        reason, advice = f"'{waits}' only ends when it is so", f"Say how long it waits, for example: {waits} for 10 min"
        self._calls.problems.append(diagnostic("BT152", words, words=words.text, reason=reason, advice=advice))
        return end

    def _time_behind(self, end: int) -> Match | None:
        """The time that stands at a word: `within 5 min`; the `in` of `comes in five minutes` may be one of it."""
        for at in (end, end - 1):
            limit = self._phrase(at)
            if limit is not None and limit.meaning.role in _LIMITS and limit.last > end:
                return limit
        return None

    def _doubt_tried(self, end: int) -> int:
        """BT152 for `if you can't find it after looking in every room`: that is said of the search."""
        after = self._phrase(end)
        done = self._partial.doing(after.last) if after is not None and after.meaning.role == "after" else None
        if done is None:
            return end
        words, advice = self._text.span(end, done.last), "Say before it all that is to be tried."
        reason = "it would be done after that has failed"
        self._calls.problems.append(diagnostic("BT152", words, words=words.text, reason=reason, advice=advice))
        return done.last

    def _doubt_place(self, at: int, form: int) -> None:
        """BT151 for `take the cup to the lab and give it to Bob. If he isn't there, A`: in the lab, or anywhere."""
        tokens, source, word = self._tokens, self._text.source, self._vocabulary.word
        words, given = Span(source, tokens[form].start, tokens[-1].end), tokens[at].value
        if not isinstance(given, Called) or not says_there(words.text, self._vocabulary.values.pronouns):
            return
        led = [token.value for token in tokens[statement_start(tokens, at) : at] if isinstance(token.value, Called)]
        places = [text for said in led for text in said.entry.given(PLACE, said.arguments)]
        person = next(iter(given.entry.given(PERSON, given.arguments)), "{")
        if not places or "{" in (person[0], places[-1][0]) or not drives(given):
            return
        done = source.text[tokens[at].start : tokens[at].end]
        one = f"... {word('if')} {person} is in {places[-1]}, {done}, {word('otherwise')} ..."
        other = f"... {done}. {word(FAILS).capitalize()}, ..."
        self._calls.problems.append(diagnostic("BT151", words, words=words.text, one=one, other=other))

    def _limit(self, command: Token, end: int) -> int:
        """`if he doesn't come within 5 min`: how long a command may take is said behind the words that ask about it."""
        limit = self._time_behind(end)
        if limit is None:
            return self._doubt_tried(end)
        at = self._tokens.index(command) + 1
        if self._tokens[at].kind in MEASURES:
            return end
        said = self._calls.token(limit, end)
        kind = "by_time" if said.kind == "by_time" else "within"
        self._tokens.insert(at, Token(kind, said.start, said.end, said.value))
        return limit.last

    def unanswered(self, end: int) -> int:
        """`if she doesn't answer within 20 s`: how long the question waits."""
        asked = (token for token in reversed(self._tokens) if token.kind == "command" and hears(token))
        question = next(asked, None)
        return self._limit(question, end) if question is not None else end
