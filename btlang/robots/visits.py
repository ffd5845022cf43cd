"""When somebody comes who comes again and again: on some days, between two times, for a while."""

from __future__ import annotations

from random import Random

from btlang.support.record import Record
from btlang.text.time_of_day import DAY

_LEAST, _MOST = 0.5, 1.5  # of the time that a visit usually takes
_WEEK = 7


class Visits(Record):
    """Once on each of these days (0 is Monday), not before `start` and gone by `end` (seconds since midnight), for
    about `stays` seconds: half of it to one and a half.
    """

    start: float
    end: float
    stays: float
    days: tuple[int, ...] = tuple(range(_WEEK))

    def next(self, now: float, weekday: int, seed: str) -> tuple[float, float]:
        """When the next visit begins and ends, in seconds since the midnight before day 0, which is that `weekday`.

        It follows from the day and the seed alone. One that would have begun before `now` isn't made up for.
        """
        day = int(now // DAY)
        while True:
            if (weekday + day) % _WEEK in self.days:
                random = Random(f"{seed} {day}")
                stays = min(self.stays * random.uniform(_LEAST, _MOST), self.end - self.start)
                comes = day * DAY + random.uniform(self.start, self.end - stays)
                if comes >= now:
                    return comes, comes + stays
            day += 1
