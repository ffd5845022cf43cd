"""Schedules in English: what they mean, and when they are due."""

from __future__ import annotations

import re
import time
from collections.abc import Iterator
from datetime import date, datetime, timedelta
from itertools import islice
from pathlib import Path
from zoneinfo import ZoneInfo

import pytest
from hypothesis import given
from hypothesis import strategies as st

from btlang.diagnostics.diagnostic import MissionError
from btlang.task.schedule.calendar import Days, Rule
from btlang.task.schedule.recurrence import Recurrence, read_moment, read_past_moment, read_rule
from tests.profiles import searches
from tests.task.wall_clock import CHANGES, DAY, RULES, clock, is_on

PAGE = Path(__file__).parents[2] / "docs" / "schedules.md"
BERLIN = "Europe/Berlin"
NOW = datetime(2026, 11, 23, 10, tzinfo=ZoneInfo(BERLIN)).timestamp()
"""A Monday."""


def shown(moment: float | None, zone: str = BERLIN) -> str:
    if moment is None:
        return "never"
    return datetime.fromtimestamp(moment, ZoneInfo(zone)).strftime("%a %Y-%m-%d %H:%M")


def moment(wall: str, zone: str = BERLIN) -> float:
    return datetime.fromisoformat(wall).replace(tzinfo=ZoneInfo(zone)).timestamp()


@pytest.mark.parametrize(
    ("text", "canonical", "first", "second"),
    [
        ("every day at 9:00", "every day at 09:00", "Tue 2026-11-24 09:00", "Wed 2026-11-25 09:00"),
        ("daily at 9 am", "every day at 09:00", "Tue 2026-11-24 09:00", "Wed 2026-11-25 09:00"),
        ("everyday at 9:00 am", "every day at 09:00", "Tue 2026-11-24 09:00", "Wed 2026-11-25 09:00"),
        ("  EVERY day,\n at 9:00. ", "every day at 09:00", "Tue 2026-11-24 09:00", "Wed 2026-11-25 09:00"),
        (
            "every day at 9:00, 11:00 and 14:30", "every day at 09:00, 11:00 and 14:30",
            "Mon 2026-11-23 11:00", "Mon 2026-11-23 14:30",
        ),
        (
            "each day at 2 pm and at 9:00", "every day at 09:00 and 14:00",
            "Mon 2026-11-23 14:00", "Tue 2026-11-24 09:00",
        ),
        (
            "every day at 10:00, 9:00, 10 am", "every day at 09:00 and 10:00",
            "Tue 2026-11-24 09:00", "Tue 2026-11-24 10:00",
        ),
        ("on weekdays at 14:30", "on weekdays at 14:30", "Mon 2026-11-23 14:30", "Tue 2026-11-24 14:30"),
        ("at noon on weekends", "on weekends at 12:00", "Sat 2026-11-28 12:00", "Sun 2026-11-29 12:00"),
        ("every weekend at midnight", "on weekends at 00:00", "Sat 2026-11-28 00:00", "Sun 2026-11-29 00:00"),
        (
            "every Monday and Friday at 8:00", "on Mondays and Fridays at 08:00",
            "Fri 2026-11-27 08:00", "Mon 2026-11-30 08:00",
        ),
        ("on Mondays at 8 pm", "on Mondays at 20:00", "Mon 2026-11-23 20:00", "Mon 2026-11-30 20:00"),
        ("weekly on Monday at 8 pm", "on Mondays at 20:00", "Mon 2026-11-23 20:00", "Mon 2026-11-30 20:00"),
        ("on Monday at 8 pm every week", "on Mondays at 20:00", "Mon 2026-11-23 20:00", "Mon 2026-11-30 20:00"),
        (
            "on Tue, Thu, and Saturdays, at 9:00", "on Tuesdays, Thursdays and Saturdays at 09:00",
            "Tue 2026-11-24 09:00", "Thu 2026-11-26 09:00",
        ),
        ("Monday to Friday 9:00", "on weekdays at 09:00", "Tue 2026-11-24 09:00", "Wed 2026-11-25 09:00"),
        ("from Monday to Friday at 9:00", "on weekdays at 09:00", "Tue 2026-11-24 09:00", "Wed 2026-11-25 09:00"),
        ("mon-fri at 9:00", "on weekdays at 09:00", "Tue 2026-11-24 09:00", "Wed 2026-11-25 09:00"),
        (
            "Friday through Sunday at 9:00", "on Fridays, Saturdays and Sundays at 09:00",
            "Fri 2026-11-27 09:00", "Sat 2026-11-28 09:00",
        ),
        (
            "Saturday to Monday at 9:00", "on Mondays, Saturdays and Sundays at 09:00",
            "Sat 2026-11-28 09:00", "Sun 2026-11-29 09:00",
        ),
        (
            "on weekdays and Saturdays at 7:00", "every day except on Sundays at 07:00",
            "Tue 2026-11-24 07:00", "Wed 2026-11-25 07:00",
        ),
        (
            "every day except Sunday at 10:00", "every day except on Sundays at 10:00",
            "Tue 2026-11-24 10:00", "Wed 2026-11-25 10:00",
        ),
        (
            "every day at 10:00 but not on weekends", "on weekdays at 10:00",
            "Tue 2026-11-24 10:00", "Wed 2026-11-25 10:00",
        ),
        (
            "on weekdays except Tuesday at 7:00", "on Mondays, Wednesdays, Thursdays and Fridays at 07:00",
            "Wed 2026-11-25 07:00", "Thu 2026-11-26 07:00",
        ),
        ("every 15 minutes", "every 15 minutes", "Mon 2026-11-23 10:15", "Mon 2026-11-23 10:30"),
        ("every hour", "every hour", "Mon 2026-11-23 11:00", "Mon 2026-11-23 12:00"),
        ("hourly", "every hour", "Mon 2026-11-23 11:00", "Mon 2026-11-23 12:00"),
        ("every hour on the hour", "every hour", "Mon 2026-11-23 11:00", "Mon 2026-11-23 12:00"),
        ("every half hour", "every 30 minutes", "Mon 2026-11-23 10:30", "Mon 2026-11-23 11:00"),
        ("every hour and a half", "every 90 minutes", "Mon 2026-11-23 10:30", "Mon 2026-11-23 12:00"),
        ("every two hours", "every 2 hours", "Mon 2026-11-23 12:00", "Mon 2026-11-23 14:00"),
        ("every 7 hours", "every 7 hours", "Mon 2026-11-23 14:00", "Mon 2026-11-23 21:00"),
        ("every 24 hours", "every 24 hours", "Tue 2026-11-24 00:00", "Wed 2026-11-25 00:00"),
        (
            "every 2 hours between 10 and 18", "every 2 hours between 10:00 and 18:00",
            "Mon 2026-11-23 12:00", "Mon 2026-11-23 14:00",
        ),
        (
            "every 7 hours between 10 and 24", "every 7 hours between 10:00 and 00:00",
            "Mon 2026-11-23 17:00", "Tue 2026-11-24 00:00",
        ),
        (
            "every hour between nine and 11", "every hour between 09:00 and 11:00",
            "Mon 2026-11-23 11:00", "Tue 2026-11-24 09:00",
        ),
        (
            "from 9 am to 5 pm every 4 hours", "every 4 hours between 09:00 and 17:00",
            "Mon 2026-11-23 13:00", "Mon 2026-11-23 17:00",
        ),
        (
            "every 2 hours between 10:00 and 18:00 on weekends", "every 2 hours between 10:00 and 18:00 on weekends",
            "Sat 2026-11-28 10:00", "Sat 2026-11-28 12:00",
        ),
        (
            "every 2 hours except on Mondays", "every 2 hours except on Mondays",
            "Tue 2026-11-24 00:00", "Tue 2026-11-24 02:00",
        ),
        (
            "every 3 hours between 22 and 4 on Fridays", "every 3 hours between 22:00 and 04:00 on Fridays",
            "Fri 2026-11-27 22:00", "Sat 2026-11-28 01:00",
        ),
        (
            "on the first of every month at 8:00", "on the 1st of every month at 08:00",
            "Tue 2026-12-01 08:00", "Fri 2027-01-01 08:00",
        ),
        (
            "on the 1st and 15th of each month at 8:00", "on the 1st and 15th of every month at 08:00",
            "Tue 2026-12-01 08:00", "Tue 2026-12-15 08:00",
        ),
        (
            "monthly on the thirty-first at 8:00", "on the 31st of every month at 08:00",
            "Thu 2026-12-31 08:00", "Sun 2027-01-31 08:00",
        ),
        (
            "on the last day of the month at 8:00", "on the last day of every month at 08:00",
            "Mon 2026-11-30 08:00", "Thu 2026-12-31 08:00",
        ),
        (
            "on the first Monday of every month at 8:00", "on the 1st Monday of every month at 08:00",
            "Mon 2026-12-07 08:00", "Mon 2027-01-04 08:00",
        ),
        (
            "on the last Monday of every month at 2 pm", "on the last Monday of every month at 14:00",
            "Mon 2026-11-30 14:00", "Mon 2026-12-28 14:00",
        ),
        (
            "every second and last Friday of the month at 8:00", "on the 2nd and last Friday of every month at 08:00",
            "Fri 2026-11-27 08:00", "Fri 2026-12-11 08:00",
        ),
        ("on 24 December 2026 at 10:00", "on 24 December 2026 at 10:00", "Thu 2026-12-24 10:00", "never"),
        ("on December 24th, 2026 at 10 am", "on 24 December 2026 at 10:00", "Thu 2026-12-24 10:00", "never"),
        ("on 2026-12-24 at 10:00", "on 24 December 2026 at 10:00", "Thu 2026-12-24 10:00", "never"),
        ("on 2020-12-24 at 10:00", "on 24 December 2020 at 10:00", "never", "never"),
        (
            "every year on the 24th of December at 10:00", "on 24 December of every year at 10:00",
            "Thu 2026-12-24 10:00", "Fri 2027-12-24 10:00",
        ),
        (
            "on 29 February of every year at 10:00", "on 29 February of every year at 10:00",
            "Tue 2028-02-29 10:00", "Sun 2032-02-29 10:00",
        ),
    ],
)  # fmt: skip
def test_rules(text: str, canonical: str, first: str, second: str) -> None:
    rule = read_rule(text, BERLIN)
    found = [shown(each) for each in islice(rule.between(NOW, float("inf")), 2)]
    assert [str(rule), *found, "never", "never"][:3] == [canonical, first, second]
    assert read_rule(canonical, BERLIN) == rule
    assert rule != read_rule(text, "UTC")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("14:30", "Mon 2026-11-23 14:30"),
        ("at 9 am", "Tue 2026-11-24 09:00"),
        ("10:00", "Tue 2026-11-24 10:00"),
        ("noon", "Mon 2026-11-23 12:00"),
        ("midnight", "Tue 2026-11-24 00:00"),
        ("today at 9:00", "Mon 2026-11-23 09:00"),
        ("tomorrow at 9:00", "Tue 2026-11-24 09:00"),
        ("9:00 tomorrow", "Tue 2026-11-24 09:00"),
        ("Monday at 14:30", "Mon 2026-11-23 14:30"),
        ("on Monday at 9:00", "Mon 2026-11-30 09:00"),
        ("2026-11-24 09:00", "Tue 2026-11-24 09:00"),
        ("2026-11-20 09:00", "Fri 2026-11-20 09:00"),
        ("24 December at 10:00", "Thu 2026-12-24 10:00"),
        ("24 October, at 10:00", "Sun 2027-10-24 10:00"),
        ("29 February at 10:00", "Tue 2028-02-29 10:00"),
        ("December 24, 2027 at 9 pm", "Fri 2027-12-24 21:00"),
        ("in 10 minutes", "Mon 2026-11-23 10:10"),
        ("in 10 days", "Thu 2026-12-03 10:00"),
        ("in a week and 2 h", "Mon 2026-11-30 12:00"),
        ("in 2 h", "Mon 2026-11-23 12:00"),
        ("in half an hour", "Mon 2026-11-23 10:30"),
        ("in 1 hour and 20 minutes", "Mon 2026-11-23 11:20"),
        ("in 1 h 20 min", "Mon 2026-11-23 11:20"),
        ("Now", "Mon 2026-11-23 10:00"),
    ],
)
def test_moments(text: str, expected: str) -> None:
    assert shown(read_moment(text, NOW, BERLIN)) == expected


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("9:00", "Mon 2026-11-23 09:00"),
        ("10:00", "Mon 2026-11-23 10:00"),
        ("11:00", "Sun 2026-11-22 11:00"),
        ("today at 9:00", "Mon 2026-11-23 09:00"),
        ("yesterday at 9:00", "Sun 2026-11-22 09:00"),
        ("9 am, yesterday", "Sun 2026-11-22 09:00"),
        ("Monday at 9:00", "Mon 2026-11-23 09:00"),
        ("last Friday at noon", "Fri 2026-11-20 12:00"),
        ("24 December at 10:00", "Wed 2025-12-24 10:00"),
        ("29 February at 10:00", "Thu 2024-02-29 10:00"),
        ("2026-10-01 09:00", "Thu 2026-10-01 09:00"),
        ("2 hours ago", "Mon 2026-11-23 08:00"),
        ("half an hour ago", "Mon 2026-11-23 09:30"),
        ("1 hour and 10 minutes ago", "Mon 2026-11-23 08:50"),
        ("30 days ago", "Sat 2026-10-24 10:00"),
        ("a week ago", "Mon 2026-11-16 10:00"),
        ("now", "Mon 2026-11-23 10:00"),
    ],
)
def test_past_moments(text: str, expected: str) -> None:
    assert shown(read_past_moment(text, NOW, BERLIN)) == expected


@pytest.mark.parametrize(
    ("text", "zone", "after", "expected"),
    [
        ("every day at 2:30", BERLIN, "2026-03-28 03:00", "Sun 2026-03-29 03:30, Mon 2026-03-30 02:30"),
        ("every day at 2:30 and 3:00", BERLIN, "2026-03-28 03:00", "Sun 2026-03-29 03:00, Sun 2026-03-29 03:30"),
        ("every day at 2:30 and 3:30", BERLIN, "2026-03-28 04:00", "Sun 2026-03-29 03:30, Mon 2026-03-30 02:30"),
        ("every day at 2:30", BERLIN, "2026-10-24 03:00", "Sun 2026-10-25 02:30, Mon 2026-10-26 02:30"),
        ("every day at 2:15", "Australia/Lord_Howe", "2026-10-03 12:00", "Sun 2026-10-04 02:45, Mon 2026-10-05 02:15"),
        ("every day at midnight", "America/Havana", "2026-03-07 12:00", "Sun 2026-03-08 01:00, Mon 2026-03-09 00:00"),
        ("every day at 9:00", "Pacific/Apia", "2011-12-29 08:00", "Thu 2011-12-29 09:00, Sat 2011-12-31 09:00"),
        ("on 30 December 2011 at 9:00", "Pacific/Apia", "2011-12-01", "Sat 2011-12-31 09:00"),
        (
            "every 3 hours between 22 and 4",
            "Pacific/Apia",
            "2011-12-31 02:00",
            "Sat 2011-12-31 04:00, Sat 2011-12-31 22:00",
        ),
        # elapsed time since midnight: an hour is missing, or there is one more
        ("every 2 hours", BERLIN, "2026-03-29 00:30", "Sun 2026-03-29 03:00, Sun 2026-03-29 05:00"),
        ("every 2 hours", BERLIN, "2026-10-25 00:30", "Sun 2026-10-25 02:00, Sun 2026-10-25 03:00"),
        ("every 2 hours", BERLIN, "2026-10-25 21:30", "Sun 2026-10-25 23:00, Mon 2026-10-26 00:00"),
        ("every hour between 1:30 and 4", BERLIN, "2026-03-29 01:40", "Sun 2026-03-29 03:30, Mon 2026-03-30 01:30"),
        # of this window the gap leaves nothing but its start
        (
            "every 10 minutes between 2:30 and 2:50",
            BERLIN,
            "2026-03-28 12:00",
            "Sun 2026-03-29 03:30, Sun 2026-03-29 03:40",
        ),
        (
            "every 10 minutes between 2:50 and 3:10",
            BERLIN,
            "2026-03-28 12:00",
            "Sun 2026-03-29 03:50, Mon 2026-03-30 02:50",
        ),
    ],
)
def test_where_clocks_change(text: str, zone: str, after: str, expected: str) -> None:
    found = islice(read_rule(text, zone).between(moment(after, zone), float("inf")), 2)
    assert ", ".join(shown(each, zone) for each in found) == expected


def test_a_moment_where_clocks_change() -> None:
    now = moment("2026-03-28 12:00")
    for text in ("2:30", "tomorrow at 2:30", "Sunday at 2:30", "2026-03-29 2:30", "29 March at 2:30"):
        assert shown(read_moment(text, now, BERLIN)) == "Sun 2026-03-29 03:30"
    assert read_moment("in 24 hours", now, BERLIN) == moment("2026-03-29 13:00")
    assert read_moment("in a day", now, BERLIN) == moment("2026-03-29 12:00")


def test_both_ends() -> None:
    rule = read_rule("every hour between 10 and 12", BERLIN)
    times = list(rule.between(NOW - 1, NOW + 7200))
    assert times == [NOW, NOW + 3600, NOW + 7200]
    assert list(rule.between(NOW, NOW + 7199)) == [NOW + 3600]
    assert list(rule.between(NOW, NOW)) == list(rule.between(NOW, NOW - 1)) == []
    assert rule.next(NOW) == NOW + 3600
    assert rule.next(NOW - 0.001) == NOW


@pytest.mark.parametrize("after", [-1e10, 0.0, 3.26e10])
def test_the_calendar_has_ends(after: float) -> None:
    """A schedule is due from 1970 to 2999."""
    found = read_rule("every day at 9:00", "UTC").next(after)
    assert found == (None if after > 3e10 else 9 * 3600)


@pytest.fixture
def computer_zone(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """That of this computer is another one during a test."""
    if not hasattr(time, "tzset"):
        pytest.skip("this system can't change its time zone in a process")
    with monkeypatch.context() as patch:
        patch.setenv("TZ", request.param)
        time.tzset()
        yield request.param
    time.tzset()


@pytest.mark.parametrize("computer_zone", ["XXX0YYY,J100/23:30,J300"], indirect=True)
def test_a_gap_around_midnight(computer_zone: str) -> None:
    """On 10 April the clock goes from 23:30 to 0:30, so that 23:45 comes after 0:40 of the next day."""
    start = datetime(2026, 4, 10, 12).timestamp()
    found = read_rule("every day at 23:45 and 0:40").between(start, start + 86_400)
    assert [datetime.fromtimestamp(each).strftime("%d %H:%M") for each in found] == ["11 00:40", "11 00:45"]


@pytest.mark.parametrize("computer_zone", ["America/New_York"], indirect=True)
@pytest.mark.parametrize("text", ["every day at 2:30", "every 50 minutes", "every 20 minutes between 23 and 3"])
def test_the_zone_of_the_computer(text: str, computer_zone: str) -> None:
    for zone, day in CHANGES:
        if zone == computer_zone:
            start = moment(day.isoformat(), zone) - 86_400
            found = list(read_rule(text).between(start, start + 3 * 86_400))
            assert found == list(read_rule(text, zone).between(start, start + 3 * 86_400))
            assert read_moment("1:30", start) == read_moment("1:30", start, zone)


@searches(60, 2000)
@pytest.mark.parametrize(("zone", "day"), CHANGES, ids=[f"{zone} {day}" for zone, day in CHANGES])
@given(rule=RULES)
def test_times_are_those_of_a_clock_on_the_wall(zone: str, day: date, rule: Rule) -> None:
    shows = clock(zone, day)
    days = [day + timedelta(days=by) for by in range(-3, 4)]
    due = sorted({each for one in days if is_on(rule.days, one) for each in shows.due(rule, one)})
    start, end = (shows.moment(datetime.combine(day + by * DAY, datetime.min.time())) for by in (-1, 2))
    recurrence = Recurrence(rule, zone)
    assert list(recurrence.between(start, end)) == [each for each in due if start < each <= end]


@searches(60, 3000)
@given(rule=RULES, start=st.integers(1_767_225_600, 1_830_297_600), days=st.integers(0, 60))
def test_between_is_next_again_and_again(rule: Rule, start: int, days: int) -> None:
    for zone in ("", "Australia/Lord_Howe"):
        recurrence = Recurrence(rule, zone)
        found = list(islice(recurrence.between(start, start + days * 86_400), 20))
        after: float | None = start
        for each in found:
            assert after is not None
            after = recurrence.next(after)
            assert after == each
        assert found == sorted(set(found))


@searches(100, 5000)
@given(rule=RULES)
def test_english_reads_back(rule: Rule) -> None:
    assert read_rule(str(rule), BERLIN) == Recurrence(rule, BERLIN)
    assert hash(read_rule(str(rule))) == hash(Recurrence(rule))


def test_days_alone() -> None:
    """A rule is data: it can be made without English."""
    rule = Recurrence(Rule(Days((0,)), (9 * 3600,)), "UTC")
    assert rule == read_rule("on Mondays at 9:00", "UTC")
    assert repr(rule).startswith("Recurrence(")


def test_the_page_is_true() -> None:
    """Each rule and time of its tables is read, and the last table has those that aren't."""
    rules, _, times, refused = re.split(r"^## .*", PAGE.read_text(encoding="utf-8"), flags=re.MULTILINE)
    columns = [re.findall(r"^\| (`.*?) \|", part, re.MULTILINE) for part in (rules, times, refused)]
    shown_rules, shown_times, shown_refused = (re.findall(r"`(.+?)`", "\n".join(column)) for column in columns)
    assert min(map(len, (shown_rules, shown_times, shown_refused))) > 5
    for text in shown_rules:
        assert read_rule(text, BERLIN).next(NOW)
    for text in shown_times:
        assert read_moment(text, NOW, BERLIN) >= NOW - 3600
    orders = re.findall(r"`([^`]*\d[^`]*)`", rules.partition("in any order, with")[2].replace("\n", " "))
    instead = [cell for line in refused.partition("These sound")[2].splitlines() for cell in line.split("|")[2:3]]
    for text in (*orders, *re.findall(r"`(.+?)`", "\n".join(instead))):
        assert read_rule(text, BERLIN).next(NOW)
    for text in shown_refused:
        with pytest.raises(MissionError):
            read_rule(text, BERLIN)
