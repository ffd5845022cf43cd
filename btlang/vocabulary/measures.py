"""Numbers in figures and words, quantities with their units, times of day and points: what a mission measures with."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence

from btlang.text.source import Source, Span
from btlang.text.words import Orthography, Words, split
from btlang.vocabulary.value_type import Unit, ValueType, format_number, with_unit
from btlang.vocabulary.word_tree import END, find, tree_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_MARK = re.compile("[%°]")
_LARGEST = 1e12  # beyond it no quantity of a robot makes sense, and sums stay exact
_MOST_NUMBER_WORDS = 12
_MOST_TIME_WORDS, _HALF_DAY = 4, 720  # minutes
_MORNING = 7
"""The hour from which on a time such as 7:30 is hardly meant for the afternoon."""
_FARTHEST = 1e6  # metres, as in a world file


def _minutes(time: str) -> int:
    """The minutes of a port text since midnight."""
    return int(time[:2]) * 60 + int(time[3:])


class Measures:
    """Reads numbers at a place in a text, with the units of `types` and the number words of a language."""

    def __init__(self, types: Mapping[str, ValueType], language: Mapping[str, Any]) -> None:
        self.types = dict(types)
        self._numbers: Mapping[str, float] = language["numbers"]
        self._multipliers: Mapping[str, float] = language["multipliers"]
        self._joiner = frozenset(language["unit_joiner"])
        self._one_each, self._every_second = frozenset(language["one_each"]), frozenset(language["every_second"])
        self.further = frozenset(language["further"])
        self.parts_of_day: dict[str, int] = language["parts_of_day"]
        self._past_words = [(language["clock"].get(name, ()), sign) for name, sign in (("past", 1), ("to", -1))]
        self._hour_words = frozenset(language["clock"].get("hour", ()))
        roles = language["roles"]
        before_times = (words.partition(" {")[0].split()[-1] for words in roles.get("between_times", ()))
        self._span_words = frozenset(before_times).difference(roles.get("after", ()))
        """Words before two hours: `from 10 to 12 pm`, in which `10 to 12` is no time."""
        self._span_joints = frozenset(language["asking"].get("between_joint", ()))
        self._joints = frozenset(
            (",", *(word for role in ("and", "or") for word in roles.get(role, ()) if " " not in word))
        )
        self._fractions = tree_of(language["fractions"].items())
        self._times = tree_of(language["times"].items())
        self._halves = frozenset(self._times)
        self._number_starts = frozenset((*self._numbers, *self._multipliers, *self._fractions))
        units: dict[str, dict[str, Unit]] = {}
        for kind in types.values():
            for unit in kind.units:
                for words in unit.words:
                    units.setdefault(_apart(words), {})[kind.name] = unit
        self._units = tree_of(units.items())
        """The words of units. Types may share them (`%`): the slot decides which is meant, or else the first counts."""
        self._facing = [phrase.split() for phrase in roles.get("facing", ())]

    def is_number(self, words: Sequence[str]) -> bool:
        """Whether the words are a number, and nothing else."""
        text = split(Source(" ".join(words)), Orthography())
        number = self.number(text, 0)
        return number is not None and number[1] == len(text.words) - 2

    def time_of_day(self, text: Words, at: int) -> tuple[str, int] | None:
        """`6 pm`, `7:30 am`, `18:30` or `noon` as a port text of 24 hours (18:30), and where it ends."""
        named = find(self._times, text.words, at)
        if named is not None and isinstance(named[0], str):
            return named
        clock = self.clock(text, at)
        if clock is None:
            return None
        hour, minutes, end = clock
        half = self.half_of_day(text, end)
        half = (half[0], half[1] + (text.words[half[1]] in self._hour_words)) if half is not None else None
        part = self.parts_of_day.get(text.words[at - 2]) if half is None and at > 1 else None
        shared = self._shared_half(text, end, hour) if half is None and part is None and minutes is None else None
        if shared is not None:
            hour, half = hour % 12 + shared, (shared, end)
        elif half is not None:
            hour, end = (hour % 12 + half[0] if 1 <= hour <= 12 else -1), half[1]
        elif part is not None and (hour <= 12 or part == 0):  # `every evening at 8`, `every night at 2`
            hour, half = (part + (hour - part) % 12) % 24 if 1 <= hour <= 12 else -1, (part, end)
        is_written = ":" in text.words[at]
        is_told = half or (is_written if hour <= 12 else minutes is not None)  # `half past seven` may be in the evening
        return (f"{int(hour):02}:{minutes or 0:02}", end) if hour in range(24) and is_told else None

    def later_time(self, text: Words, at: int) -> tuple[str, int] | None:
        """A time that doesn't say in which half of the day it is, `9:30` behind `9 pm`: the next such one.

        The last such one before the end of a span: `from 8 to 10 pm`. Where no other one says it, `5:30`
        is as it is written. That it is assumed is written down in the text.
        """
        clock = self.clock(text, at) if text.picked is None else None
        if clock is None or not 1 <= clock[0] <= 12 or text.words[at].startswith("0"):
            return None
        hour, minutes, end = clock
        is_told = self.half_of_day(text, end) is not None or (at > 1 and text.words[at - 2] in self.parts_of_day)
        is_told = is_told or (minutes is None and self._shared_half(text, end, hour) is not None)
        if is_told or self.quantity(text, at) is not None:
            return None
        minute = int(hour % 12) * 60 + (minutes or 0)
        has_halves = not text.distinct.isdisjoint(self._halves)
        behind = self._end_of_span(text, at, end) if has_halves else None
        beside = behind or (self._latest_told(text, at) if has_halves else None)
        if beside is None:
            return self._of_day(text, at, clock)
        told = _minutes(beside[0])
        meant = told + (minute - told) % _HALF_DAY - (_HALF_DAY if behind is not None else 0)
        time = f"{meant // 60 % 24:02}:{meant % 60:02}"
        if ":" in text.words[at] and meant // 60 % 24 == hour:
            return time, end  # as it is written
        text.assumed[at] = time, end, beside[1]
        return time, end

    def _of_day(self, text: Words, at: int, clock: tuple[float, int | None, int]) -> tuple[str, int] | None:
        """`5:30` and `9 o'clock` as they are written, on a clock of 24 hours; None for other times."""
        hour, minutes, end = clock
        is_written = hour < _MORNING if ":" in text.words[at] else hour >= _MORNING and end == at + 2
        if not is_written or hour % 1 or (":" not in text.words[at] and text.words[at + 1] not in self._hour_words):
            return None
        text.assumed[at] = f"{int(hour):02}:{minutes or 0:02}", end, None
        return text.assumed[at][:2]

    def _end_of_span(self, text: Words, at: int, end: int) -> tuple[str, Span] | None:
        """The time behind one that begins a span, `from 8 to 10 pm`, or that is joined to it, `1:30 and 3 pm`."""
        is_span = at > 0 and text.words[at - 1] in self._span_words and text.words[end] in self._span_joints
        if not is_span and not (":" in text.words[at] and text.words[end] in self._joints):
            return None
        time = self.time_of_day(text, end + 1)
        return (time[0], text.span(end + 1, time[1])) if time is not None else None

    def _latest_told(self, text: Words, at: int) -> tuple[str, Span] | None:
        """The last time before a word that says in which half of the day it is, `9 pm` or `noon`, and its place."""
        for half in range(at - 1, -1, -1):
            found = find(self._times, text.words, half)
            if found is None or found[1] > at:
                continue
            for first in range(max(half - _MOST_TIME_WORDS, 0), half + 1):
                time = self.time_of_day(text, first)
                if time is not None and time[1] >= found[1]:
                    return time[0], text.span(first, time[1])
        return None

    def clock(self, text: Words, at: int) -> tuple[float, int | None, int] | None:
        """`7`, `7:30`, `half past 7`, `9 o'clock`: the hour, the minutes if they are said, and where it ends."""
        word = text.words[at]
        if ":" in word and word[0].isdecimal():
            hours, _, minutes = word.partition(":")
            if len(hours) > 2 or len(minutes) != 2 or int(minutes) > 59:
                return None
            return float(hours), int(minutes), at + 1 + (text.words[at + 1] in self._hour_words)
        past, after = self._past(text, at)
        number = self.number(text, after)
        if number is None:
            return None
        end = number[1] + (text.words[number[1]] in self._hour_words)
        return number[0] - (past < 0), past % 60 if past else None, end  # `quarter to nine`

    def _shared_half(self, text: Words, at: int, hour: float) -> int | None:
        """The hours that `pm` behind a later number of a list adds to an earlier one: `at 1, 2 and 3 pm`."""
        while 1 <= hour < 12 and text.words[at] in self._joints:
            at += 1 + (text.words[at + 1] in self._joints)
            number = self.number(text, at)
            if number is None or number[0] <= hour:
                return None  # `9 and 5 pm`
            (hour, at), half = number, self.half_of_day(text, number[1])
            if half is not None:
                return half[0] if hour < 12 else None
        return None

    def _past(self, text: Words, at: int) -> tuple[int, int]:
        """The minutes past an hour, below 0 before it, and where that stands: `half past 7`, `quarter to 8`."""
        number = self.number(text, at)
        if number is None:
            return 0, at
        value, end = number
        minutes = round(value * 60) if value < 1 else int(value)
        is_span = at > 0 and text.words[at - 1] in self._span_words
        for words, sign in self._past_words:
            if text.words[end] in words and 0 < minutes < 60 and not is_span:
                return sign * minutes, end + 1
        return 0, at

    def half_of_day(self, text: Words, at: int) -> tuple[int, int] | None:
        """The hours that a word such as `pm` behind a number adds, and where it ends."""
        found = find(self._times, text.words, at)
        return found if found is not None and isinstance(found[0], int) else None

    @property
    def halves_of_day(self) -> list[str]:
        """The words for which `half_of_day` looks, where they are one word."""
        return [word for word, node in self._times.items() if isinstance(node.get(END), int)]

    def quantity(self, text: Words, at: int, wanted: Iterable[str] = ()) -> tuple[float, str, int] | None:
        """A number with a unit: its value in the base unit, the name of the type, and where it ends.

        Of the types that have the unit it is the first of the `wanted` ones, or else the one that was declared first.
        """
        if text.words[at] in self.further:
            return self.quantity(text, at + 1, wanted)  # `another 2 m`
        number = self.number(text, at)
        if number is None:
            before = text.words[at - 1] if at else ""
            if at not in text.articles and before not in self._one_each and before not in self.further:
                return None
            number = 1.0, at  # "a minute", "every hour"
            if text.words[at] in self._every_second and at not in text.articles:
                number = 2.0, at + 1
        value, after = number
        if text.words[after] in self._joiner:
            after += 1
        unit = find(self._units, text.words, after)
        if unit is None:
            return None
        by_type, end = unit
        kind = next((kind for kind in wanted if kind in by_type), next(iter(by_type)))
        unit_of = by_type[kind]
        half = find(self._fractions, text.words, end)  # "a minute and a half"
        if half is not None and half[1] > end + 1 and not find(self._units, text.words, half[1]):
            value, end = value + half[0], half[1]
        amount = value * unit_of.numerator / unit_of.denominator
        return (amount, kind, end) if abs(amount) <= _LARGEST else None

    def same_quantities(self, text: Words, at: int) -> tuple[str, ...]:
        """The types for which a number with a unit is the same amount, the one of `quantity` first."""
        found = self.quantity(text, at)
        if found is None:
            return ()
        others = (self.quantity(text, at, (kind,)) for kind, one in self.types.items() if one.kind == "quantity")
        same = (other[1] for other in others if other is not None and other[0] == found[0])
        return tuple(dict.fromkeys((found[1], *same)))

    def number(self, text: Words, at: int) -> tuple[float, int] | None:
        """A number in figures or words, fractions included, and where it ends."""
        words = text.words
        word = words[at]
        if not (word in self._number_starts or word[0].isdecimal() or "-" in word):
            return None  # as nearly always
        value, start = self._whole_number(words, at)
        fraction = find(self._fractions, words, start)
        if fraction is not None:
            value, start = (value or 0) + fraction[0], fraction[1]
        return None if value is None or abs(value) > _LARGEST else (value, start)

    def _whole_number(self, words: Sequence[str], at: int) -> tuple[float | None, int]:
        word = words[at]
        if word[0].isdecimal() or (word[0] == "-" and word[1:2].isdecimal()):
            if ":" in word:
                return None, at
            value = float(word)
            return (value, at + 1) if abs(value) <= _LARGEST else (None, at)
        total: float | None = None
        last = at + _MOST_NUMBER_WORDS
        while True:
            pieces = words[at].split("-")  # "twenty-five"
            if at == last or not all(p in self._numbers or p in self._multipliers for p in pieces):
                return total, at
            for piece in pieces:
                if piece in self._multipliers:
                    total = (total if total is not None else 1) * self._multipliers[piece]
                else:
                    total = (total or 0) + self._numbers[piece]
            at += 1

    def point(self, text: Words, at: int) -> tuple[float, float, float | None, int] | None:
        """`(x, y)` in metres, with or without a direction in degrees that it faces, and where it ends."""
        numbers: list[float] = []
        for mark in ("(", ","):
            number = self._metres(text, at + 1) if text.words[at] == mark else None
            if number is None or abs(number[0]) > _FARTHEST:
                return None
            numbers.append(number[0])
            at = number[1]
        if text.words[at] != ")":
            return None
        at += 1
        for words in self._facing:
            last = at + len(words)
            angle = self.quantity(text, last, ("angle",)) if text.words[at:last] == words else None
            if angle is not None and angle[1] == "angle":
                return numbers[0], numbers[1], angle[0], angle[2]
        return numbers[0], numbers[1], None, at

    def point_text(self, x: str, y: str, facing: str | None) -> str:
        """A point as it is written."""
        where = f"({x}, {y})"
        if facing is None:
            return where
        return f"{where} {' '.join(self._facing[0])} {with_unit(facing, self.types['angle'].units[0].words[0])}"

    def _metres(self, text: Words, at: int) -> tuple[float, int] | None:
        quantity = self.quantity(text, at, ("length",))
        if quantity is not None:
            return (quantity[0], quantity[2]) if quantity[1] == "length" else None
        return self.number(text, at)

    def _point_text(self, text: Words, at: int) -> tuple[str, int] | None:
        point = self.point(text, at)
        if point is None:
            return None
        x, y, facing, end = point
        angle = None if facing is None else format_number(facing)
        return self.point_text(format_number(x), format_number(y), angle), end

    def _plain_number(self, value_type: ValueType, text: Words, at: int) -> tuple[str, int] | None:
        number = self.number(text, at)
        if number is None or find(self._units, text.words, number[1]):
            return None
        value, end = number
        if (value_type.whole and value != int(value)) or too_small(value, value_type):
            return None
        return format_number(value), end


def too_small(value: float, value_type: ValueType) -> bool:
    """Whether a number is below the least of its type."""
    return value_type.least is not None and value < value_type.least


def _apart(unit: str) -> str:
    """A unit as a text is split into words: `°C` is two."""
    return _MARK.sub(r" \g<0> ", unit).lower()
