"""What is a time of day, and what is none."""

from __future__ import annotations

import pytest

from btlang.text.source import Source
from btlang.text.words import split
from btlang.vocabulary.load import load_vocabulary

TIMES = {
    "6 pm": "18:00", "6pm": "18:00", "6 PM": "18:00", "12 am": "00:00", "12 pm": "12:00", "six am": "06:00",
    "7:30 am": "07:30", "7:30pm": "19:30", "12:05 am": "00:05", "18:30": "18:30", "7:30": "07:30", "0:00": "00:00",
    "23:59": "23:59", "noon": "12:00", "midday": "12:00", "midnight": "00:00",
}  # fmt: skip


@pytest.mark.parametrize(("written", "text"), TIMES.items())
def test_times(written: str, text: str) -> None:
    assert load_vocabulary().value("time_of_day", written) == text


@pytest.mark.parametrize(
    "written",
    ["6", "am", "13 pm", "0 am", "13:00 pm", "24:00", "25:00", "18:60", "18:5", "100:00", "6 :30", "6: 30", "-6 pm",
     "half pm", "6.5 pm", "9" * 5000 + ":00", "18:30:15", "x"],
)  # fmt: skip
def test_no_times(written: str) -> None:
    assert load_vocabulary().value("time_of_day", written) is None


def test_a_colon_without_blanks_is_part_of_a_word() -> None:
    words = split(Source("at 18:30: wave; repeat 3: nod; if x is 3:\n 7:5"), load_vocabulary().orthography).words
    assert words[:12] == ["at", "18:30", ":", "wave", ";", "repeat", "3", ":", "nod", ";", "if", "x"]
    assert words[12:] == ["is", "3", ":", "\n", "7:5", "\n", "\n"]


@pytest.mark.parametrize("number", ["18:30", "1:2"])
def test_a_time_is_no_number(number: str) -> None:
    vocabulary = load_vocabulary()
    assert [vocabulary.value(kind, number) for kind in ("number", "count", "duration")] == [None] * 3
