"""How often something is tried: `pick up the cup, at most 3 attempts`, `if that fails, wait 5 s and try again`."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

from btlang.diagnostics.diagnostic import diagnostic
from btlang.frontends.mission.token import (
    FORMS,
    JOINTS,
    RULES,
    STATEMENT_ENDS,
    Token,
    run_start,
    statement_start,
)
from btlang.frontends.mission.tokens.rules_inside import ON_WAY, asks_if_blocked
from btlang.frontends.mission.tokens.sentence_reader import (
    SentenceReader,
    is_answer,
    is_question,
    latest_question,
    may_fail,
)
from btlang.frontends.mission.tokens.settling import FAILS
from btlang.frontends.mission.tokens.silent_words import begins
from btlang.text.source import Span
from btlang.text.words import END_OF_STATEMENT, END_OF_TEXT
from btlang.tree.answers import asking_verbs
from btlang.vocabulary.match import Match

LIMIT = "limit"
"""The role of a number that says how often at most."""
_JOINTS = JOINTS | {"stop"}
_STATEMENT_ENDS = (END_OF_STATEMENT, END_OF_TEXT)
_OPERANDS = frozenset(("command", "name", "close", "wait", "nothing", "fail", "node"))
_IN_ALL = frozenset(("count", "at_most", "up_to_times", "tries"))
_ASKED = frozenset(("condition", "not"))
_TWICE = "2"
_ENDLESS = "-1"
_UNCLEAR = "it isn't clear what is tried again"
_EXAMPLE = "go to the lab. If that fails, wait 5 s and try again"
_ENDING = ("for", "until", "until_time")
_ANEW = "that would be done anew once it has worked"
_TRIED_FOR = "Write for example: try again every minute for up to 10 minutes."
_REPAIRS = _OPERANDS | JOINTS | {"open"}


class Tries(SentenceReader):
    """Those of one text."""

    def number(self, match: Match, at: int) -> int:
        """`pick up the cup, at most 3 attempts`: again if it fails, so many times in all.

        Behind a comma it is about all commands of the statement. `wave at most 3 times` leaves open how often.
        """
        tokens = self._tokens
        last = len(tokens) - (2 if tokens and tokens[-1].kind == "comma" else 1)
        first = statement_start(tokens, last + 1)
        is_closed = any(token.kind in ("try", "retry", "repeat") for token in tokens[first:])
        is_check = last > 0 and tokens[last].kind == "condition" and tokens[last - 1].kind == "check"
        if last < 0 or not (tokens[last].kind in _OPERANDS or is_closed or is_check):
            return 0
        if any(token.kind == "until" for token in tokens[first:]):
            self._doubt_number(match, at)
        fails = True
        if not is_closed:
            whole = last < len(tokens) - 1
            first = _first_of_form(tokens, first, last) if whole else _first_of_operand(tokens, last)
            fails = match.meaning.role == "tries" or is_check or any(map(may_fail, tokens[first : last + 1]))
            if fails:
                tokens.insert(first, Token("retry", tokens[first].start, tokens[first].start))
            elif match.meaning.role == "at_most":
                span = self._text.span(at, match.last)
                fixed = self._text.source.text[tokens[first].start : tokens[last].end]
                number = self._calls.token(match, at).value
                fixed += f" {number} {self._vocabulary.word('count').split()[-1]}"
                self._calls.problems.append(diagnostic("BT167", span, words=span.text, fixed=fixed))
        if fails and tokens[-1].kind == "comma":
            tokens.pop()
        count = self._calls.token(match, at)
        count.kind, count.role = "count", LIMIT
        tokens.append(count)
        return match.last

    def _doubt_number(self, match: Match, at: int) -> None:
        """BT151 for `keep asking Bob "Ready?" until he says yes, at most 4 times`, which would ask on and on."""
        word, number = self._vocabulary.word, self._calls.token(match, at).value
        words = self._text.span(at, match.last)
        one, other = f"... {number} times", f"... {word('until')} ..."
        self._calls.problems.append(diagnostic("BT151", words, words=words.text, one=one, other=other))

    def paused(self) -> None:
        """`try to open it up to 3 times with 5 s between attempts`: the pause that the last token says."""
        tokens = self._tokens
        if tokens[-2].kind == "comma" and len(tokens) > 2 and tokens[-3].kind == "count":
            del tokens[-2]
        if tokens[-2].kind != "count":
            return
        depth, first = 0, statement_start(tokens, len(tokens))
        for token in reversed(tokens[first:]):  # those in brackets have their own number
            depth += (token.kind == "close") - (token.kind == "open")
            if depth == 0 and token.kind in ("try", "retry"):
                tokens[-1].kind = "every"

    def again(self, match: Match, at: int) -> int:
        """`A. If that fails, wait 5 s and try again, at most 3 times`: A again, with pauses; without a number once.

        `at most 3 times` is in all, `twice` are those that follow the first.
        """
        tokens, end = self._tokens, len(self._tokens)
        end = self._behind(end)
        rule = tokens[statement_start(tokens, end) : end][:1]
        if rule and (rule[0].kind in RULES or rule[0].role == ON_WAY) and self._is_end(match.last):
            del tokens[end:]  # it goes on with the rest by itself
            return match.last
        pause = tokens[end - 1] if end and tokens[end - 1].kind == "wait" else None
        end = self._behind(end - 1) if pause is not None else end
        form = self._condition(end)
        last = self._before_form(form)
        asks = self._text.words[at] in self._asking_verbs or self._text.words[at] in self._vocabulary.asking["letting"]
        tried = tokens[last - 1] if form and last else None
        if tried is None or tried.kind not in _OPERANDS or (asks and not is_question(tried)):
            if end := self._while_so(match, at, asks):
                return end
            if asks:
                return self._ask_again(match, at)
            return self._after_repair(match, at) or self._try_that(match, at) or self._doubt_what(match, at)
        begin = statement_start(tokens, last)
        first = _first_of_operand(tokens, last - 1) if asks else _first_of_form(tokens, begin, last)
        number, end, pace = self._attempts(match)
        if not number or (pause is not None and pace is not None):
            return 0
        if not asks:
            self._doubt_ending(at, end)
        delay = self._phrase(match.last)
        if delay is not None and delay.meaning.role == "delay":
            return 0  # `try again after 5 minutes`
        del tokens[last:]
        if tokens[first].kind in ("try", "retry"):
            del tokens[first]
        tokens.insert(first, Token("retry", tokens[first].start, tokens[first].start))
        tokens.append(Token("count", self._text.starts[at], self._text.ends[end - 1], number))
        pause = pause or pace
        if pause is not None:
            tokens.append(Token("every", pause.start, pause.end, pause.value))
        self._doubt(end)
        return end

    def retry(self, match: Match, at: int) -> int:
        """`A. If that fails, B and retry up to 3 times`: with nothing else behind it `retry` is `try again`."""
        behind = self._behind_comma(match.last)
        amount = self._phrase(behind)
        counts = amount is not None and amount.meaning.role in (*_IN_ALL, "once", "more")
        last = amount.last if amount is not None and counts else match.last
        if begins(self._tokens) or self._text.words[last] == ":" or not (counts or self._is_end(last)):
            return 0
        return self.again(match, at)

    def _attempts(self, match: Match) -> tuple[str, int, Token | None]:
        """How many attempts `try again every minute, up to 5 times` makes in all, where that ends, and how often.

        The number is "" where it isn't said as one.
        """
        behind = self._behind_comma(match.last)
        behind += self._text.words[behind] in self._vocabulary.roles["but"]
        amount, pace, last = self._phrase(behind), None, match.last
        if amount is not None and amount.meaning.role == "every":
            pace, last = self._calls.token(amount, behind), amount.last
            behind = self._behind_comma(last)
            amount = self._phrase(behind)
        role = amount.meaning.role if amount is not None else ""
        if amount is None or role not in (*_IN_ALL, "once", "more"):
            return _TWICE if pace is None and role != "up_to" else _ENDLESS, last, pace
        if role == "once":
            return _TWICE, amount.last, pace
        number = str(self._calls.token(amount, behind).value)
        retries = self._text.words[match.last - 1] in self._vocabulary.roles["retry"]  # `retry up to 3 times`
        further = ("count", "more", *(("at_most", "up_to_times") if retries else ()))
        if role in further and number != _ENDLESS:  # `try again twice` is three times in all
            number = str(int(number) + 1) if number.isdecimal() else ""
        return number, amount.last, pace

    def _doubt_ending(self, at: int, last: int) -> None:
        """BT152 for `try again for 10 minutes`: what has worked would be done anew until then."""
        ending = self._phrase(last)
        if ending is not None and ending.meaning.role in _ENDING:
            words = self._text.span(at, self._end_of_statement(last))
            problem = diagnostic("BT152", words, words=words.text, reason=_ANEW, advice=_TRIED_FOR)
            self._calls.problems.append(problem)

    def _after_repair(self, match: Match, at: int) -> int:
        """`A. If that fails, open the door and try again`: A behind what is done in between, so often in all."""
        tokens = self._tokens
        end = self._behind(len(tokens))
        start = statement_start(tokens, end)
        form = next(
            (i for i in reversed(range(start, end)) if tokens[i].value == FAILS or asks_if_blocked(tokens, i)), 0
        )
        last = self._before_form(form)
        if last and tokens[form].value != FAILS:
            here, count = tokens[form].start, len(tokens)
            tokens[last : form + 2] = [Token("stop", here, here), Token("or", here, here, FAILS)]
            form, end = last + 1, end - (count - len(tokens))
        if not form or not last or any(token.kind not in _REPAIRS for token in tokens[form + 1 : end]):
            return 0
        number, behind, pace = self._attempts(match)
        first = _first_of_form(tokens, statement_start(tokens, last), last)
        until = last
        while first < until and tokens[first].kind in ("try", "retry"):  # `pick it up up to 3 times` is tried once more
            first, until = first + 1, run_start(tokens, until, ("count", "every"))
        tried = [Token(each.kind, each.start, each.end, each.value, each.role) for each in tokens[first:until]]
        start, stop = self._text.starts[at], self._text.ends[behind - 1]
        is_once = pace is not None and number == _TWICE
        if not number or is_once or any(token.kind in FORMS for token in tried):
            return 0
        self._doubt_ending(at, behind)
        tokens[end:] = [Token("then", start, start), Token("open", start, start), *tried, Token("close", stop, stop)]
        if number != _TWICE:
            repair = form + 1 + (tokens[form + 1].kind == "comma")
            tokens[repair:repair] = [Token("retry", start, start), Token("open", start, start)]
            left = str(int(number) - 1) if number.isdecimal() else number
            tokens += [Token("close", stop, stop), Token("count", start, stop, left), *([] if pace is None else [pace])]
        return behind

    def _while_so(self, match: Match, at: int, asks: bool) -> int:
        """`if it is shut, wait 5 s and check again, up to 3 times`: while it is so, and it is asked so often in all.

        0 where it isn't said how often, or what is done on the later answers.
        """
        tokens, text = self._tokens, self._text
        first, end = statement_start(tokens, len(tokens)), self._behind(len(tokens))
        comma = next((i for i in range(first, end) if tokens[i].kind == "comma"), end)
        condition, body = tokens[first + 1 : comma], tokens[comma + 1 : end]
        if not condition or tokens[first].kind != "if" or any(token.kind not in _ASKED for token in condition):
            return 0
        asked = latest_question(tokens) if asks else None
        if first and text.words[at] in self._trying:
            return 0  # `go to the lab. If bumped, wait 5 s and try again`
        is_new = asks and (asked is None or any(map(is_answer, tokens[tokens.index(asked) : first])))
        if is_new or not (body or asks) or any(token.kind not in _REPAIRS for token in body):
            return 0
        delay = self._phrase(match.last)
        delay = delay if delay is not None and delay.meaning.role == "delay" else None
        number, last, pace = self._attempts(match.replace(last=delay.last) if delay is not None else match)
        follows = self._phrase(last + 1) if text.words[last] in (END_OF_STATEMENT, ",") else None
        is_limited = last > (delay or match).last and number.isdecimal() and int(number) > 1
        if not is_limited or pace is not None or (follows is not None and follows.meaning.role in ("otherwise", FAILS)):
            return 0
        here, start, stop = tokens[first].start, text.starts[at], text.ends[last - 1]
        then = Token("then", start, start)
        if delay is not None:
            body += [then, Token("wait", start, stop, self._calls.token(delay, match.last).value)]
        if asked is not None:
            body += [then, Token("command", start, text.ends[match.last - 1], asked.value)]
        body = body[body[0] is then :]
        tokens[first:] = [
            Token("repeat", here, here), Token("open", here, here), tokens[first], *condition,
            Token("comma", body[0].start, body[0].start), *body, Token("close", stop, stop),
            Token("count", start, stop, str(int(number) - 1)),
        ]  # fmt: skip
        return last

    @cached_property
    def _trying(self) -> frozenset[str]:
        """The verbs for what is to work, not for what is to be asked: `try again`, not `check again`."""
        return self._vocabulary.firsts["try"] | self._vocabulary.firsts["retry"]

    def _doubt_what(self, match: Match, at: int) -> int:
        """BT150 for `go to the lab. If bumped, wait 5 s and try again`: what is tried again isn't clear."""
        form = self._tokens[statement_start(self._tokens, len(self._tokens)) :][:1]
        if self._text.words[at] not in self._trying or not form or form[0].kind != "if":
            return 0
        end = self._attempts(match)[1]
        words = self._text.span(at, end)
        self._calls.problems.append(diagnostic("BT150", words, words=words.text, reason=_UNCLEAR, example=_EXAMPLE))
        self._tokens.append(Token("nothing", words.start, words.end))
        return end

    def _ask_again(self, match: Match, at: int) -> int:
        """`ask Bob "Tea?". If he says no, ask again`: what was asked before."""
        asked = latest_question(self._tokens)
        behind = self._behind_comma(match.last)
        behind += self._text.words[behind] in self._vocabulary.roles["but"]
        amount = self._phrase(behind)
        if asked is None:
            return 0
        if amount is not None and amount.meaning.role in _IN_ALL:
            self._doubt_questions(asked, self._text.span(at, amount.last), self._text.span(behind, amount.last).text)
            self._tokens.append(Token("command", self._text.starts[at], self._text.ends[amount.last - 1], asked.value))
            return amount.last
        earlier = self._tokens[self._tokens.index(asked) : statement_start(self._tokens, len(self._tokens))]
        if any(map(is_answer, earlier)):  # `if he says yes, A. If he doesn't answer, ask again`
            words = self._text.span(at, match.last)
            reason = "what is done on the later answer isn't said"
            advice = "Define the question with what is done on each answer, and do that again."
            self._calls.problems.append(diagnostic("BT152", words, words=words.text, reason=reason, advice=advice))
        start, said = self._text.starts[at], self._tokens[statement_start(self._tokens, len(self._tokens)) :]
        if said and said[0].kind == "if" and amount is not None and amount.meaning.role == "every":
            pause = self._calls.token(amount, behind)  # the first answer has just been given
            self._tokens += [Token("wait", start, start, pause.value), Token("then", start, start)]
        self._tokens.append(Token("command", start, self._text.ends[match.last - 1], asked.value))
        last = amount.last if amount is not None and amount.meaning.role == "once" else match.last
        self._doubt(last)
        return last

    def _doubt_questions(self, asked: Token, words: Span, number: str) -> None:
        """BT151 for `if he says no, ask again, at most 3 times`: what is done on the later answers isn't said."""
        word, text = self._vocabulary.word, self._text.source.text
        question, again = text[asked.start : asked.end], words.text.removesuffix(number).rstrip(" ,")
        answer = next(filter(is_answer, reversed(self._tokens)), None)
        if answer is not None:
            said, (yes, no) = text[answer.start : answer.end], self._vocabulary.asking["answers"]
            is_otherwise = any(token.kind == "otherwise" for token in self._tokens[self._tokens.index(answer) :])
            said = said if is_otherwise else said.removesuffix(no) + yes if said.endswith(f" {no}") else ""
            question += f" {word('and')} {word('check')} {said}" if said else ""
        one = f"{question}, {number}. {word(FAILS).capitalize()}, ..."
        self._calls.problems.append(diagnostic("BT151", words, words=words.text, one=one, other=again))

    @cached_property
    def _asking_verbs(self) -> frozenset[str]:
        return asking_verbs(self._vocabulary)

    def _try_that(self, match: Match, at: int) -> int:
        """`pick up the cup. Try it 3 times`: tries what the statement before does, so many times in all."""
        tokens = self._tokens
        last = run_start(tokens, len(tokens), STATEMENT_ENDS)
        first = statement_start(tokens, last)
        kinds = {token.kind for token in tokens[first:last]}
        amount = self._phrase(match.last)
        if amount is None or amount.meaning.role not in _IN_ALL or not last or last == len(tokens):
            return 0
        if not kinds <= {*_OPERANDS, *_JOINTS, "open"} or kinds.isdisjoint(_OPERANDS):
            return 0
        start, end = tokens[first].start, tokens[last - 1].end
        count = Token("count", self._text.starts[at], self._text.ends[amount.last - 1])
        count.value = self._calls.token(amount, match.last).value
        tokens[first:] = [
            Token("retry", start, start), Token("open", start, start), *tokens[first:last],
            Token("close", end, end), count,
        ]  # fmt: skip
        return amount.last

    def _doubt(self, at: int) -> None:
        """`..., try again, at most 3 times. Then B`: B in any case, or only if all tries fail (BT151)."""
        text = self._text
        at += text.words[at] == END_OF_STATEMENT
        is_joined = text.words[at - 1] != END_OF_STATEMENT
        at += text.words[at] == ","
        joint = self._phrase(at)
        if joint is None or joint.meaning.role not in (("then", "and") if is_joined else ("then",)):
            return
        end = next(i for i in range(joint.last, len(text.words)) if text.words[i] in _STATEMENT_ENDS)
        span, rest = text.span(at, end), text.span(joint.last, end).text
        one = f"... {self._vocabulary.word('otherwise')} {rest}"
        self._calls.problems.append(diagnostic("BT151", span, words=span.text, one=one, other=rest))

    def _behind(self, end: int) -> int:
        """Where the tokens before a place end without what joins them."""
        return run_start(self._tokens, end, _JOINTS)

    def _before_form(self, form: int) -> int:
        """The same before a form, which may begin a statement."""
        return run_start(self._tokens, form, _JOINTS | STATEMENT_ENDS)

    def _condition(self, end: int) -> int:
        """Where `if that fails` begins that ends at a place, or `if the way is blocked` behind a journey; else 0."""
        tokens = self._tokens
        if end and tokens[end - 1].kind == "or" and tokens[end - 1].value == FAILS:
            return end - 1
        return end - 2 if end > 2 and asks_if_blocked(tokens, end - 2) else 0


def _first_of_form(tokens: Sequence[Token], first: int, last: int) -> int:
    """Where the commands of a statement begin: behind `if bumped,`, `at 6 pm,`."""
    if tokens[first].kind in ("at", "every_day"):
        first += 1 + (tokens[first + 1].kind == "comma")
    begins = (i + 1 for i in range(first + 1, last) if tokens[i].kind == "comma" and tokens[i - 1].kind == "condition")
    return next(begins, first)


def _first_of_operand(tokens: Sequence[Token], last: int) -> int:
    """Where the command, name or bracket begins that ends at a token."""
    depth = 0
    for at in range(last, -1, -1):
        depth += (tokens[at].kind == "close") - (tokens[at].kind == "open")
        if not depth:
            return at
    return last
