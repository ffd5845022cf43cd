"""Words about times of day: `from 7 am to 10 am, A`, `on weekdays at 9, A`, `A at 7 am until 10 am`."""

from __future__ import annotations

from btlang.frontends.mission.token import Called, OnDays, Token
from btlang.frontends.mission.tokens.sentence_reader import SentenceReader
from btlang.frontends.mission.tokens.silent_words import BEGINS
from btlang.vocabulary.match import Match

_TIME = "time_of_day"
_TODAY, _DAYTIME = "TodayIs", "TimeOfDay"


class ClockWords(SentenceReader):
    """Those of one text."""

    def _weekly(self, match: Match, at: int) -> int:
        """`on weekdays at 9, A`: as every day at that time, but on such days alone."""
        entry = self._vocabulary.entry(_TODAY)
        said = {value.name: value for value in match.values}
        if entry is None or len(said) != 2:
            return 0
        days, time = said["days"], said["time_of_day"]
        start, end = self._text.starts[at], self._text.ends[match.last - 1]
        named = ";".join((days.text, *days.more))
        asked = Called(entry, ((entry.slots[0].name, named),))
        self._tokens.append(Token("every_day", start, end, OnDays(time.text, asked)))
        return match.last

    def _between(self, match: Match, at: int) -> int:
        """`every 15 minutes between 10 pm and 6 am, A`: each time, if it is then."""
        tokens, words, entry = self._tokens, self._text.words, self._vocabulary.entry(_DAYTIME)
        joins = words[match.last] in self._vocabulary.asking["between_joint"]
        last = self._context.read(_TIME, self._text, match.last + 1) if joins else None
        if last is None or entry is None or words[last[1]] != ",":
            return 0
        start, end = self._text.starts[at], self._text.ends[last[1] - 1]
        asked = Token("condition", start, end, Called(entry, _times(match.values[0].text, last[0])))
        if tokens and tokens[-1].kind == "every":
            tokens += [Token("comma", start, start), Token("if", start, start), asked]
            return last[1]
        if words[at] not in self._vocabulary.roles["start_at"] or (tokens and tokens[-1].kind not in BEGINS):
            return 0
        tokens += [  # `from 7 am to 10 am, A`: also where it begins within that time
            Token("wait_until", start, start), asked, Token("then", end, end), Token("until_time", start, end, last[0]),
        ]  # fmt: skip
        return last[1]

    def _until(self) -> None:
        """`A at 7 am until 10 am` is until then from the first time on, not from now on."""
        tokens = self._tokens
        is_behind = len(tokens) > 2 and tokens[-3].kind in ("command", "name", "close")
        if is_behind and tokens[-1].kind == "until_time" and tokens[-2].kind in ("at", "every_day"):
            tokens[-2:] = tokens[:-3:-1]


def _times(first: str, last: str) -> tuple[tuple[str, str], ...]:
    return ("at_least", first), ("at_most", last)
