"""Words about times of day: `from 7 am to 10 am, A`, `on weekdays at 9, A`, `A at 7 am until 10 am`."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Container
from functools import cached_property

from btlang.diagnostics.diagnostic import diagnostic
from btlang.frontends.mission.explanations.times import assumed_between
from btlang.frontends.mission.token import (
    BEFORE_CONDITIONS,
    IN_CONDITIONS,
    JOINTS,
    KEEP_OUT,
    RULES,
    Called,
    OnDays,
    Token,
    constraint_of,
    keeps_out,
    run_start,
    statement_start,
)
from btlang.frontends.mission.tokens.ended_rules import comes
from btlang.frontends.mission.tokens.sentence_reader import SentenceReader
from btlang.frontends.mission.tokens.settling import STAYS, first_word
from btlang.frontends.mission.tokens.silent_words import BEGINS
from btlang.text.time_of_day import WEEKDAYS
from btlang.tree.rounds import DAYTIME
from btlang.vocabulary.entry import Entry
from btlang.vocabulary.match import Match, SlotValue

_TIME = "time_of_day"
_WEEKDAYS = frozenset(map(str.lower, WEEKDAYS))
_SIMPLE = frozenset(("command", "name", "wait", "nothing", *JOINTS))
_TODAY = "TodayIs"
_DAYS, _LATEST = "days", "12:00"
_BEFORE_HOURS = frozenset(("if", "unless", "while", "whenever", "as_soon_as", "not"))


class ClockWords(SentenceReader):
    """Those of one text."""

    def _weekly(self, match: Match, at: int) -> int:
        """`on weekdays at 9, A`: as every day at that time, but on such days alone; `on Friday at 9, A` is once."""
        entry = self._vocabulary.entry(_TODAY)
        said = {value.name: value for value in match.values}
        if entry is None or len(said) != 2:
            return 0
        days, times = (said[name].texts for name in ("days", "time_of_day"))
        start, end = self._text.starts[at], self._text.ends[match.last - 1]
        asked = tuple(Called(entry, ((entry.slots[0].name, day),)) for day in days)
        is_once = match.meaning.role == "on_days" and self._is_singular(said["days"])
        more, last = self._more_times(match.last)
        times = (*times, *more)
        rounds = len(days) * len(times) if is_once else -1
        self._tokens.append(Token("every_day", start, end, OnDays(";".join(times), asked, rounds)))
        return last

    def times(self, match: Match, at: int) -> int:
        """`at 8 am, at noon and at 6 pm, A`: as `at 8 am, noon and 6 pm, A`. Returns 0 for anything else."""
        text, tokens = self._text, self._tokens
        more, last = self._more_times(match.last)
        if not more:
            return 0
        times = ";".join((*match.values[0].texts, *more))
        tokens.append(Token(match.meaning.role, text.starts[at], text.ends[last - 1], times))
        return last

    def _more_times(self, at: int) -> tuple[list[str], int]:
        """The times that are joined to one, each with `at` before it, and where they end: `, at noon and at 6 pm`.

        None where the last one begins another command: `wave at noon and at 6 pm nod`.
        """
        words, joints, times, last = self._text.words, self._vocabulary.roles["and"], list[str](), at
        while words[last] in (",", *joints):
            behind = last + (words[last] == ",")
            behind += words[behind] in joints
            more = self._phrase(behind)
            if more is None or more.meaning.role != "at":
                break
            times += more.values[0].texts
            last = more.last
        is_front = not self._tokens or self._tokens[-1].kind in BEGINS
        is_whole = self._is_end(last) or (is_front and self._begins_there(last))
        return (times, last) if times and is_whole else ([], at)

    def until_both(self, match: Match, at: int) -> int:
        """`wait until 4 pm and nobody is in the lab`: until it is later than that, and the other is so, too.

        `wait until 4 pm or nobody is in the lab` waits for the next such time.
        """
        text, entry, roles = self._text, self._vocabulary.entry(DAYTIME), self._vocabulary.roles
        is_either = text.words[match.last] in roles["or"]
        joins = (is_either or text.words[match.last] in roles["and"]) and not match.values[0].more
        again = joins and is_either and text.words[match.last + 1] in self._vocabulary.firsts["until"]
        behind = self._phrase(match.last + 1 + again) if joins else None
        if entry is None or behind is None or behind.meaning.role not in ("condition", "negated"):
            return 0
        start, end = text.starts[at], text.ends[match.last - 1]
        kind = "wait_until" if match.meaning.role == "wait_time" else "until"
        time = match.values[0].text
        asked = comes(time, entry) if is_either else Called(entry, (("at_least", time),))
        self._tokens += [Token(kind, start, start), Token("condition", start, end, asked)]
        self._tokens += [Token("or", start, end)] if again else []
        return match.last + 2 if again else match.last

    def _not_then(self, at: int) -> int:
        """`every hour, go to the lab, but not between 10 pm and 7 am`: unless it is then."""
        text, vocabulary = self._text, self._vocabulary
        denied = text.words[at] in vocabulary.roles["but"] and text.words[at + 1] in vocabulary.roles["not"]
        if not denied or not self._tokens or text.words[at + 2] not in vocabulary.asking["hours"]:
            return 0
        match = self._with_front(at, at + 2, "time_is")
        if match is None or match.meaning.role != "condition":
            return 0
        condition = self._calls.token(match, at + 2)
        condition.kind = "condition"
        self._tokens += [Token("unless", text.starts[at], text.ends[at + 1]), condition]
        return match.last

    def _not_on_days(self, at: int) -> int:
        """`at noon, wave, except on Mondays`: unless it is one of these days."""
        text, entry = self._text, self._vocabulary.entry(_TODAY)
        behind = self._context.values.exception(text, at)
        on = self._vocabulary.firsts["on_days"]
        last, asked = behind + 1, list[Token]()
        while behind and entry is not None and self._tokens and text.words[behind] in on:
            days = self._context.read(_DAYS, text, last)
            if days is None:
                break
            start, last = text.starts[last], days[1]
            said = Called(entry, ((entry.slots[0].name, days[0]),))
            asked += [Token("or", start, start)] if asked else []
            asked.append(Token("condition", start, text.ends[last - 1], said))
            last += text.words[last] in self._context.joiners
        if not asked:
            return 0
        self._tokens += [Token("unless", text.starts[at], text.ends[behind]), *asked]
        return bisect_left(text.ends, asked[-1].end) + 1

    def _until_then(self, at: int) -> int:
        """`avoid the hall until 7 am. Wave until then`: until the time that was said last."""
        text, roles = self._text, self._vocabulary.roles
        is_until = any(phrase.split()[0] == text.words[at] for phrase in roles["until_time"])
        if not is_until or text.words[at + 1] not in roles["then"] or not self._is_end(at + 2):
            return 0
        said = self._time_before()
        if not said:
            return 0
        self._tokens.append(Token("until_time", text.starts[at], text.ends[at + 1], said))
        return at + 2

    def _time_before(self) -> str:
        """The time until which something was done or forbidden last, "" for none."""
        return next((str(token.value) for token in reversed(self._tokens) if token.kind == "until_time"), "")

    def _has_waited(self, time: str) -> bool:
        """Whether something was done until a time: what is only forbidden until then takes no time."""
        return any(
            token.kind == "until_time"
            and token.value == time
            and (not at or constraint_of(self._tokens[at - 1]) is None)
            for at, token in enumerate(self._tokens)
        )

    def _by_then(self, at: int) -> int:
        """`if nobody is there by 6 pm, A`: asked at that time, unless the mission has waited until then: `by then`."""
        text, tokens = self._text, self._tokens
        is_by = text.words[at] in self._vocabulary.asking["by_then"] and tokens[-1:] and tokens[-1].kind == "condition"
        form = run_start(tokens, len(tokens), IN_CONDITIONS) - 1 if is_by else -1
        if form < 0 or tokens[form].kind not in ("if", "unless") or (form > 0 and tokens[form - 1].kind not in BEGINS):
            return 0
        is_then = text.words[at + 1] in self._vocabulary.roles["then"]
        time = (self._time_before(), at + 2) if is_then else self._context.read(_TIME, text, at + 1)
        if time is None or not time[0]:
            return 0
        if self._has_waited(time[0]):
            return time[1]
        begin = tokens[form].start
        tokens[form:form] = [Token("at", begin, begin, time[0]), Token("comma", begin, begin)]
        return time[1]

    @cached_property
    def _hour_words(self) -> frozenset[str]:
        """The words with which hours begin, or that leave out days."""
        asking, firsts = self._vocabulary.asking, self._vocabulary.firsts
        said = (*asking["hours"], *asking["by_then"])
        return frozenset(said).union(firsts["but"], firsts["except"], firsts["until_time"])

    def hours(self, at: int) -> int:
        """`never enter the hall after 6 pm`, `... between 10 pm and 6 am`: while it is then."""
        if self._text.words[at] not in self._hour_words:
            return 0  # as nearly always
        tokens, start = self._tokens, self._text.starts[at]
        if end := self._not_then(at) or self._not_on_days(at) or self._until_then(at) or self._by_then(at):
            return end
        if not tokens or self._text.words[at] not in self._vocabulary.asking["hours"]:
            return 0
        joint = self._joint_of_hours()
        match = self._with_front(at, at, "time_is") if joint is not None else None
        if match is None or joint is None or match.meaning.role != "condition":
            return 0
        condition = self._calls.token(match, at)
        condition.kind = "condition"
        if joint == "if":
            self._doubt_hours(at, match.last)
        tokens += [Token("and" if joint == "if" else joint, start, start)] if joint else []
        tokens.append(condition)
        if joint != "while":
            return match.last
        said = dict(condition.value.arguments) if isinstance(condition.value, Called) else {}
        if said.get("below", _LATEST) < _LATEST:  # `don't go into the lab before 7 am`, said in the evening
            words = self._text.span(at, match.last)
            until = f"{self._vocabulary.word('until')} {words.text.split(maxsplit=1)[-1]}"
            self._calls.problems.append(diagnostic("BT138", words, words=words.text, fixed=f"... {until}"))
        return match.last

    def _joint_of_hours(self) -> str | None:
        """How hours go on with what stands before them: as its condition, as one more, or as all of one ("").

        "if" where it isn't clear when they are asked about; None where they say nothing of it.
        """
        tokens = self._tokens
        if constraint_of(tokens[-1]) is not None:
            return "while"
        if tokens[-1].kind in _BEFORE_HOURS:
            return ""
        form = run_start(tokens, len(tokens), IN_CONDITIONS) - 1
        if tokens[-1].kind != "condition" or form < 0 or tokens[form].kind not in (*BEFORE_CONDITIONS, "once"):
            return None
        return "if" if tokens[form].kind in ("if", "unless") else "and"

    def _doubt_hours(self, at: int, end: int) -> None:
        """BT151 for `if the door is open after 6 pm, A`: asked at 6 pm, or at any time behind it."""
        tokens, text, word = self._tokens, self._text, self._vocabulary.word
        form, last = tokens[run_start(tokens, len(tokens), IN_CONDITIONS) - 1], tokens[-1]
        whole = text.span(bisect_left(text.starts, form.start), end)
        asked, condition = (text.source.text[first : last.end] for first in (form.start, last.start))
        is_so = " ".join((*self._vocabulary.asking["time_is"], text.span(at, end).text))
        one = f"{word('at')} {text.span(at + 1, end).text}, {asked}, ..."
        other = f"{word('whenever')} {condition} {word('and')} {is_so}, ..."
        self._calls.problems.append(diagnostic("BT151", whole, words=whole.text, one=one, other=other))

    def _is_singular(self, days: SlotValue) -> bool:
        """Whether days are said by the names that they have, `Friday`: not `Fridays`, `weekdays`."""
        names = {name.lower() for name in days.texts}
        return names.issubset(self._text.words[days.first : days.last]) and names.issubset(_WEEKDAYS)

    def _between(self, match: Match, at: int) -> int:
        """`every 15 minutes between 10 pm and 6 am, A`: each time, if it is then."""
        tokens, words, entry = self._tokens, self._text.words, self._vocabulary.entry(DAYTIME)
        if entry is not None and words[at] in self._vocabulary.roles["after"]:
            return self._after(match, at, entry)
        joins = words[match.last] in self._vocabulary.asking["between_joint"]
        last = self._context.read(_TIME, self._text, match.last + 1) if joins else None
        if last is None or entry is None:
            return 0
        self._calls.problems += assumed_between(self._text, at, last[1])
        start, end = self._text.starts[at], self._text.ends[last[1] - 1]
        asked = Token("condition", start, end, Called(entry, _times(match.values[0].text, last[0])))
        if tokens and tokens[-1].kind == "every":
            return self._in_each_round(asked, last[1])
        if tokens and keeps_out(tokens[-1]):  # `stay out of the lab from 8 pm to 10 pm`
            tokens += [Token("while", start, start), asked]
            return last[1]
        first = statement_start(tokens, len(tokens))
        if len(tokens) > first and tokens[-1].kind not in BEGINS:
            return self._within_hours(match, asked, last) if self._is_end(last[1]) else 0
        is_from = words[at] in self._vocabulary.roles["start_at"]
        holds = self._forbids(last[1]) or (not is_from and self._watches(last[1]))
        if not (holds or self._begins_there(last[1])):
            return 0
        if holds:  # `from 8 pm to 10 pm, stay out of the lab`, `between ..., whenever Bob is near, wave`
            tokens += [Token("while", start, start), asked, Token("comma", end, end)]
            return self._behind_comma(last[1])
        is_kept_up = words[self._behind_comma(last[1])] in self._vocabulary.asking["kept_up"]
        lasts = is_from or is_kept_up or self._is_repeated(last[1])
        if tokens and tokens[-1].kind not in BEGINS:
            return 0
        if not lasts:
            return self._doubt_span(match, at, last[1])
        tokens += [  # `from 7 am to 10 am, A`, `between 7 am and 10 am, A every 5 min`: also begun within that time
            Token("wait_until", start, start), asked, Token("then", end, end), Token("until_time", start, end, last[0]),
            Token("comma", end, end),
        ]  # fmt: skip
        return self._behind_comma(last[1])

    def _doubt_span(self, match: Match, at: int, end: int) -> int:
        """BT151 for `between 1 pm and 2 pm, wave`: once, or again and again."""
        text, start, done = self._text, match.values[0], self._behind_comma(end)
        whole = text.span(at, self._end_of_statement(done))
        rest = text.source.text[text.starts[done] : whole.end]
        first, last = text.span(start.first, start.last).text, text.span(match.last + 1, end).text
        one, other = (self._vocabulary.word(role) for role in ("at", "start_at"))
        joints, roles = self._vocabulary.asking["between_joint"], self._vocabulary.roles
        until = next(joint for joint in joints if joint not in roles["and"])
        one, other = f"{one} {first}, {rest}", f"{other} {first} {until} {last}, {rest}"
        self._calls.problems.append(diagnostic("BT151", whole, words=whole.text, one=one, other=other))
        self._tokens.append(Token("at", text.starts[at], text.ends[end - 1], start.text))
        return done

    def _after(self, match: Match, at: int, entry: Entry) -> int:
        """`after 8 pm, A`: at once if it is later, else then."""
        tokens, start, end = self._tokens, self._text.starts[at], self._text.ends[match.last - 1]
        if (tokens and tokens[-1].kind not in BEGINS) or not self._begins_there(match.last):
            return 0
        asked = Token("condition", start, end, Called(entry, (("above", match.values[0].text),)))
        tokens += [Token("wait_until", start, start), asked, Token("then", end, end)]
        return self._behind_comma(match.last)

    def _begins_there(self, at: int) -> bool:
        """Whether a comma stands at a word, or a command begins there."""
        behind = self._phrase(at)
        is_command = behind is not None and behind.meaning.role in ("command", "name", "wait", "try", "repeat")
        asking, word = self._vocabulary.asking, self._text.words[at]
        stays = word in asking["standing_verbs"] or any(words.split()[0] == word for words in asking["staying"])
        return word == "," or stays or is_command

    def _forbids(self, at: int) -> bool:
        """Whether something is forbidden from a word on, behind a comma."""
        behind = self._phrase(self._behind_comma(at))
        entry = behind.meaning.entry if behind is not None else None
        is_constraint = entry is not None and entry.constrains == KEEP_OUT
        return is_constraint or (behind is not None and behind.meaning.role == "never")

    def _within_hours(self, match: Match, asked: Token, last: tuple[str, int]) -> int:
        """`patrol A and B from 10 pm to 6 am`, `stand at the door from 9 am to 5 pm`: as if it stood in front."""
        tokens, start, end = self._tokens, asked.start, asked.end
        first = statement_start(tokens, len(tokens))
        is_from = self._text.words[match.values[0].first - 1] in self._vocabulary.roles["start_at"]
        is_kept_up = first_word(tokens[first], self._text.source) in self._vocabulary.asking["kept_up"]
        if not (is_from or is_kept_up) or any(token.kind not in _SIMPLE for token in tokens[first:]):
            return 0
        begin = [Token("wait_until", start, start), asked, Token("then", end, end)]
        if tokens[-1].role == STAYS:
            tokens += [Token("then", end, end), Token("wait_time", start, end, last[0])]
        else:
            begin += [Token("until_time", start, end, last[0]), Token("comma", end, end)]
        tokens[first:first] = begin
        return last[1]

    def _in_each_round(self, asked: Token, end: int) -> int:
        """`every 15 minutes between 10 pm and 6 am, A`, `A every 15 minutes between ...`: each round asks first."""
        tokens, start = self._tokens, asked.start
        first = statement_start(tokens, len(tokens))
        form = [Token("comma", start, start), Token("if", start, start), asked]
        if first == len(tokens) - 1 and self._begins_there(end):
            here = self._text.starts[end]
            tokens += form if self._text.words[end] == "," else [*form, Token("comma", here, here)]
            return end
        behind = self._phrase(self._behind_comma(end))
        joins = behind is not None and behind.meaning.role in ("and", "then")
        if any(token.kind not in _SIMPLE for token in tokens[first:-1]) or not (joins or self._is_end(end)):
            return 0
        every = tokens.pop()
        tokens[first:first] = [every, *form, Token("comma", start, start)]
        return self._behind_comma(end)

    def _is_repeated(self, at: int) -> bool:
        """Whether the rest of the statement is done again and again: `wave every 5 minutes`."""
        return self._has_role(at, ("every",))

    def _watches(self, at: int) -> bool:
        """Whether the rest of the statement is a standing rule: `whenever Bob is near, wave`."""
        return self._has_role(at, RULES)

    def _has_role(self, at: int, roles: Container[str]) -> bool:
        found = (self._phrase(i) for i in range(at, self._end_of_statement(at)))
        return any(match is not None and match.meaning.role in roles for match in found)

    def _until(self) -> None:
        """`A at 7 am until 10 am` is until then from the first time on, not from now on."""
        tokens = self._tokens
        is_behind = len(tokens) > 2 and tokens[-3].kind in ("command", "name", "close")
        if is_behind and tokens[-1].kind == "until_time" and tokens[-2].kind in ("at", "every_day"):
            tokens[-2:] = tokens[:-3:-1]


def _times(first: str, last: str) -> tuple[tuple[str, str], ...]:
    return ("at_least", first), ("at_most", last)
