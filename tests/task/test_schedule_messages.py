"""What is said of texts that are no schedules and no times, and that any text is read or refused."""

from __future__ import annotations

from collections.abc import Callable
from datetime import UTC, datetime
from functools import partial
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from btlang.diagnostics.diagnostic import MissionError
from btlang.task.schedule.recurrence import read_moment, read_past_moment, read_rule
from tests.conftest import matches_golden
from tests.profiles import searches

HERE = Path(__file__).parent
BERLIN = "Europe/Berlin"
NOW = datetime(2026, 11, 23, 9, tzinfo=UTC).timestamp()

REFUSED_MOMENTS = (
    "", "9", "25:00", "9.30", "tomorow at 9:00", "tomorrow", "Monday", "Mondays at 9:00", "weekdays at 9:00",
    "tomorrow Monday at 9:00", "9:00 and 10:00", "9:00 10:00", "30 February at 9:00", "2026-13-01 09:00",
    "1969-12-31 09:00", "3000-01-01 09:00", "2026-12-24T09:00", "in 10", "in ten minuts", "in 10 metres",
    "in -5 minutes", "in 9000 hours", "in", "in 1 hour tomorrow", "now please", "every day at 9:00", "soon",
    "9:00 # or later", "\N{SNOWMAN}", "in 999999999999 minutes", "in 400 days", "in 10 dayz", "in 2.5 days",
)  # fmt: skip


def all_are_refused(texts: tuple[str, ...], read: Callable[[str, float, str], object], golden: str) -> None:
    """With the messages of a file."""
    told = []
    for text in texts:
        with pytest.raises(MissionError) as refused:
            read(text, NOW, BERLIN)
        assert {problem.code for problem in refused.value.diagnostics} == {"BT194"}
        told.append(str(refused.value))
    matches_golden("\n\n".join(told) + "\n", HERE / golden)


def test_refused_moments() -> None:
    all_are_refused(REFUSED_MOMENTS, read_moment, "refused_moments.out")


REFUSED_PAST_MOMENTS = (
    "today at 18:00", "tomorrow at 9:00", "2027-01-01 09:00", "in 10 minutes", "ago", "10 ago", "400 days ago",
    "-5 minutes ago", "yesterday", "yestreday at 9:00", "2 hours ago at 9:00",
)  # fmt: skip


def test_refused_past_moments() -> None:
    all_are_refused(REFUSED_PAST_MOMENTS, read_past_moment, "refused_past_moments.out")


REFUSED_RULES = (
    "in 5 minutes", "tomorrow at 9:00", "14:30",
    "", ",", "every", "on", "at 9:00", "between 10 and 18", "every day between 9:00 and 11:00", "every 5",
    "every huor", "evry day at 9:00", "every 2 hours on Mondys", "every Mondai and Fridai at 9:00",
    "on the frist of every month at 9:00", "every day at", "every day at 9:00 and", "every day at 9:00 and 11",
    "every day at 9:00, 11", "every day at 9.30", "every day at 9 : 30", "every day at 25:00", "every day at 13 pm",
    "every day at half past nine", "every other day at 9:00", "every other hour",
    "every second hour", "every second", "every third of an hour", "every 36 hours", "every -5 minutes",
    "every 0 minutes", "every 61.5 seconds", "every 5 metres", "every 1e9 hours", "every day at 9:00 every Monday",
    "every day at 9:00 on weekdays at 10:00", "every hour every 2 hours",
    "every hour between 9 and 11 between 13 and 15", "every day except Sunday at 9:00 except Monday",
    "every day except the first at 9:00", "on the 1st of every month except Sunday at 9:00",
    "every hour on the hour between 10:30 and 12:00", "every 90 minutes on the hour", "every day at 9:00 on the hour",
    "every day at 9:00 between 9:00 and 11:00", "every hour between 10 and 10", "every hour between 12 and 4",
    "every hour between 10",
    "every hour between 10 or 12", "every hour between 22-4", "every hour between 25 and 26",
    "every hour between 9 am and 5", "monthly at 9:00", "monthly on Monday at 9:00", "yearly at 9:00",
    "every week at 9:00", "on the 32nd of every month at 9:00", "on the 0th of every month at 9:00",
    "on the sixth Friday of every month at 9:00", "on the first weekday of every month at 9:00",
    "on 24.12.2026 at 9:00", "on 31 November 2026 at 9:00", "on 29 February 2027 at 9:00", "on 2026-12-32 at 9:00",
    "on 24 December 1066 at 9:00", "twice a day", "0 9 * * *", "every day at 9:00 # morning", '"every day at 9:00"',
    "every day at 9:00 in Berlin",
    "every quarter at 9:00", "every quarter",
    "every Wednesday, Thursday and Friday and on the second Monday at 9:00 and at 10:00 and 11:00",
)  # fmt: skip
"""Others are in tests/samples/bad/BT194.txt."""


def test_refused_rules() -> None:
    told = []
    for text in REFUSED_RULES:
        with pytest.raises(MissionError) as refused:
            read_rule(text, BERLIN)
        assert {problem.code for problem in refused.value.diagnostics} == {"BT194"}
        told.append(str(refused.value))
    matches_golden("\n\n".join(told) + "\n", HERE / "refused_rules.out")


def test_half_of_day_with_dots() -> None:
    assert read_rule("every day at 9 a.m.", BERLIN) == read_rule("every day at 9 am", BERLIN)


@pytest.mark.parametrize(
    ("text", "fixed"),
    [
        ("every mondey at 9:00", "every Monday at 9:00"),
        ("every Mondai and Friday at 9:00", "every Monday and Friday at 9:00"),
        ("evry day at 9:00", "every day at 9:00"),
        ("every 2 huors", "every 2 hours"),
        ("every two hous betwen 10 and 18", "every two hours betwen 10 and 18"),
        ("every 2 hours betwen 10 and 18", "every 2 hours between 10 and 18"),
        ("on the frist of every month at 9:00", "on the first of every month at 9:00"),
        ("on 24 Decemebr 2026 at 9:00", "on 24 December 2026 at 9:00"),
        ("every day at nooon", "every day at noon"),
        ("every day at 9.30", "every day at 9:30"),
        ("every day excpet Sunday at 9:00", "every day except Sunday at 9:00"),
    ],
)
def test_corrections_mend_the_text(text: str, fixed: str) -> None:
    with pytest.raises(MissionError) as refused:
        read_rule(text)
    [problem] = refused.value.diagnostics
    assert problem.fix is not None
    span, words = problem.fix
    assert text[: span.start] + words + text[span.end :] == fixed


def advice(read: Callable[[], object]) -> str:
    """What the message about a text says to write."""
    with pytest.raises(MissionError) as refused:
        read()
    [problem] = refused.value.diagnostics
    return problem.hint.partition("Write for example: ")[2]


@pytest.mark.parametrize(
    ("length", "rule"),
    [
        ("5 minutes", "every 5 minutes"),
        ("2 hours", "every 2 hours"),
        ("half an hour", "every half an hour"),
        ("1 h 30 min", "every 90 minutes"),
        ("an hour and 10 minutes", "every 70 minutes"),
        ("1 day", "every day at 9:00"),
        ("2 weeks", "every Tuesday, or on the second Tuesday of every month"),
    ],
)
def test_a_length_of_time_shows_how_to_say_it(length: str, rule: str) -> None:
    moment = advice(lambda: read_moment(length, NOW, BERLIN))
    assert moment == f"in {length}"
    assert read_moment(moment, NOW, BERLIN) > NOW
    past = advice(lambda: read_past_moment(length, NOW, BERLIN))
    assert past == f"{length} ago"
    assert read_past_moment(past, NOW, BERLIN) < NOW
    assert advice(lambda: read_rule(length, BERLIN)) == rule
    read_rule(f"{rule.partition(', or ')[0]}{' at 9:00' * (length == '2 weeks')}", BERLIN)


@pytest.mark.parametrize(
    ("name", "advice"),
    [
        ("Europe/Berln", "Similar: Europe/Berlin"),
        ("europe/berlin", "Similar: Europe/Berlin"),
        ("Berlin", "Similar: Europe/Berlin"),
        ("Factory", ""),
        ("posixrules", ""),
        ("localtime", ""),
        ("right/Europe/Berlin", "Similar: Europe/Berlin"),
        ("Europe", "Similar: Europe/"),
        ("../../etc/passwd", "Write for example: "),
        ("/etc/localtime", ""),
        ("\0", "Write for example: "),
        ("\N{SNOWMAN}", "Write for example: "),
        (" ", "Write for example: "),
        ("x" * 5000, "Write for example: "),
    ],
)
def test_unknown_zones(name: str, advice: str) -> None:
    for read in (lambda: read_rule("every day at 9:00", name), lambda: read_moment("14:30", NOW, name)):
        with pytest.raises(MissionError) as refused:
            read()
        [problem] = refused.value.diagnostics
        assert problem.code == "BT194"
        assert problem.message.endswith("isn't a time zone.")
        assert problem.hint.startswith(advice)


def test_a_computer_without_zones(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("btlang.task.schedule.calendar.available_timezones", set)
    with pytest.raises(MissionError, match="pip install tzdata"):
        read_rule("every day at 9:00", "Europe/Nowhere")


WORDS = sorted({word for text in (*REFUSED_RULES, *REFUSED_MOMENTS, *REFUSED_PAST_MOMENTS) for word in text.split()})
_TEXTS = st.one_of(
    st.text(max_size=40),
    st.lists(st.sampled_from((*WORDS, ",", "\n", "and", "every", "on", "at", "9:00")), max_size=10).map(" ".join),
    st.lists(st.sampled_from(WORDS), max_size=4).map("".join),
)


def codes(read: Callable[[], object]) -> list[str]:
    """Of what is wrong with a text."""
    try:
        read()
    except MissionError as error:
        return [problem.code for problem in error.diagnostics if str(error)]
    return []


@searches(80, 20_000)
@given(text=_TEXTS, zone=st.sampled_from(("", BERLIN)))
def test_any_text_is_read_or_refused(text: str, zone: str) -> None:
    assert codes(lambda: read_rule(text, zone)) in ([], ["BT194"])
    for read in (read_moment, read_past_moment):
        assert codes(partial(read, text, NOW, zone)) in ([], ["BT194"])
    if not codes(lambda: read_past_moment(text, NOW, zone)):
        assert read_past_moment(text, NOW, zone) <= NOW
    if not codes(lambda: read_rule(text, zone)):
        rule = read_rule(text, zone)
        assert read_rule(str(rule), zone) == rule
        assert (rule.next(NOW) or NOW + 1) > NOW
    if not codes(lambda: read_moment(text, NOW, zone)):
        assert datetime.fromtimestamp(read_moment(text, NOW, zone), UTC).year in range(1969, 3001)


@pytest.mark.parametrize("text", ["every " * 20_000, "x" * 100_000, "9:00, " * 5000, "daily at " + "9:00 and " * 5000])
def test_long_texts(text: str) -> None:
    with pytest.raises(MissionError) as refused:
        read_rule(text)
    assert len(str(refused.value)) < 2000


@pytest.mark.parametrize(
    ("text", "rule"),
    [("every morning at 7", "every day at 07:00"), ("each evening at 8", "every day at 20:00")],
)
def test_parts_of_the_day_say_which_half_an_hour_is_in(text: str, rule: str) -> None:
    assert str(read_rule(text, "UTC")) == rule
