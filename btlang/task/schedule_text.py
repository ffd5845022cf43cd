"""Reads a whole text about times; what is wrong with it becomes a message, with a correction where one is near."""

from __future__ import annotations

import re
from collections.abc import Callable

from btlang.diagnostics.diagnostic import diagnostic
from btlang.diagnostics.errors import MissionError
from btlang.task.days import MONTHS
from btlang.task.schedule_words import ScheduleWords, Unread
from btlang.text.source import Source
from btlang.text.spelling import respellings
from btlang.text.time_of_day import WEEKDAYS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeVar

    T = TypeVar("T")

_CAPITAL = {name.lower(): name for name in (*WEEKDAYS, *(f"{name}s" for name in WEEKDAYS), *MONTHS)}
_CLEAR = 4  # letters of a word that may be a correction even if the text still can't be read
_LONGEST_WORD = 40  # letters; nobody mistypes a longer one


def read_text(text: str, name: str, example: str, read: Callable[[ScheduleWords], T]) -> T:
    """What a function makes of the words of a text. `name` is what messages call the text; Unread becomes MissionError
    (BT194), with a correction of the spelling where one helps, or else an example.
    """
    source = Source(re.sub(r"[\r\n]", " ", text), name)
    try:
        return read(ScheduleWords(source))
    except Unread as unread:
        similar = _correction(unread, read)
        fix = (unread.span, similar) if similar else unread.fix
        advice = f"Similar: {similar}" if similar else f"Write for example: {unread.example or example}"
        raise MissionError([
            diagnostic("BT194", unread.span, fix=fix, what=unread.what, problem=unread.problem, advice=advice)
        ]) from None  # fmt: skip


def _correction(unread: Unread, read: Callable[[ScheduleWords], object]) -> str:
    """The word with which the text can be read, or else read on; "" where none is near."""
    span, farther = unread.span, ""
    if not span.text.isalpha() or len(span.text) > _LONGEST_WORD:
        return ""
    for word in respellings(span.text.lower(), unread.expected):
        shown = _CAPITAL.get(word, word)
        try:
            read(ScheduleWords(Source(span.source.text[: span.start] + shown + span.source.text[span.end :])))
        except Unread as other:
            farther = farther or (shown if other.reached > unread.reached and len(word) >= _CLEAR else "")
            continue
        return shown
    return farther
