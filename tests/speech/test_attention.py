"""When what is said is meant for the robot."""

from __future__ import annotations

from btlang.speech.listener import Attention
from btlang.speech.recogniser import Expected, Grammar, RecognisedSpeech

WANTED = Expected(("go to [the] {place}", "stop"), {"place": ("lobby",)})


def test_all_the_time() -> None:
    attention = Attention("", False)
    assert attention.expected(WANTED, False, 0.0) == WANTED
    assert attention.meant(RecognisedSpeech("stop"), 0.0) == RecognisedSpeech("stop")


def test_a_button() -> None:
    assert Attention("", True).expected(WANTED, False, 0.0).mode == "pushed"


def test_behind_the_wake_word() -> None:
    attention = Attention("Hello, robot!", False)
    asleep = attention.expected(WANTED, False, 0.0)
    assert asleep.mode == "wake"
    grammar = Grammar(asleep)
    assert [grammar.holds(text) for text in ("hello robot", "hello robot go to the lobby", "stop")] == [
        True,
        True,
        False,
    ]
    assert attention.meant(RecognisedSpeech("Hello robot, stop."), 0.0) == RecognisedSpeech("stop.")
    assert attention.expected(WANTED, False, 0.1).mode == "wake"


def test_the_wake_word_alone_is_good_for_a_while() -> None:
    attention = Attention("hello robot", False)
    assert attention.meant(RecognisedSpeech("hello robot", sure=False), 10.0) is None
    assert attention.expected(WANTED, False, 10.1).mode == "wake"
    assert attention.meant(RecognisedSpeech("hello robot"), 10.0) is None
    assert attention.expected(WANTED, False, 17.0).mode == "addressed"
    assert attention.expected(WANTED, False, 19.0).mode == "wake"


def test_who_is_asked_needs_no_wake_word() -> None:
    assert Attention("hello robot", False).expected(WANTED, True, 0.0).mode == "addressed"


def test_nothing_wakes_a_robot_that_listens_for_nothing() -> None:
    assert not Attention("hello robot", False).expected(Expected(), False, 0.0)
