"""Standing rules in time: what they interrupt goes on where it was."""

from __future__ import annotations

from tests.scenarios.test_forms import run


def test_a_rule_interrupts_once_and_the_rounds_go_on() -> None:
    log, status, seconds = run("whenever it is late, play\nwork 4 times")
    assert (status, seconds) == ("SUCCESS", 6)
    assert log == [
        "0 work", "1 work ended", "1 work", "2 work halted", "2 play", "3 play ended",
        "3 work", "4 work ended", "4 work", "5 work ended", "5 work", "6 work ended",
    ]  # fmt: skip


def test_the_interrupted_command_starts_anew() -> None:
    log, _, seconds = run("whenever it is late, play\nwait 1.5 s; work; work")
    assert log == [
        "1.5 work", "2 work halted", "2 play", "3 play ended", "3 work", "4 work ended", "4 work", "5 work ended",
    ]  # fmt: skip
    assert seconds == 5


def test_the_first_rule_wins() -> None:
    log, _, _ = run("work\nwhenever it is early, play\nwhenever it is early, say second", limit=3)
    assert log[:3] == ["0 play", "1 play ended", "1.8 work"]  # the second rule speaks until 1.8 s


def test_a_failed_reaction_fails_the_block() -> None:
    log, status, _ = run("try:\n  whenever it is late, slip\n  work 9 times\notherwise play")
    assert status == "SUCCESS"
    assert log[-4:] == ["2 slip", "2.5 slip ended", "2.5 play", "3.5 play ended"]
    assert run("whenever it is late, slip\nwork 9 times")[1] == "FAILURE"


def test_a_rule_of_a_block_ends_with_it() -> None:
    log, _, _ = run("repeat 1 times:\n  whenever it is late, play\n  work\nwork; work")
    assert not any("play" in line for line in log)


def test_a_time_limit_stands_still_while_a_rule_runs() -> None:
    log, status, seconds = run("(wait 1.5 s then work then work) within 4.5 s\nwhenever it is late, play")
    assert (status, seconds) == ("SUCCESS", 5)
    assert log[-1] == "5 work ended"
