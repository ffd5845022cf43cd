"""What each form of the language does in time: commands of known length on a driven clock, when they start and end."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest

import btlang
from btlang.engine.clock import Clock
from btlang.engine.status import FAILURE, IDLE, NAMES, SKIPPED, SUCCESS

Log = list[str]


def words(log: Log) -> list[Callable[..., object]]:
    """`work` and `play` take 1 s, `slip` fails after 0.5 s, `late` is true from 2 s on, `early` before."""

    def lasting(name: str, seconds: float, fails: bool = False) -> Callable[[Clock], Iterator[None]]:
        def leaf(clock: Clock) -> Iterator[None]:
            begin = clock.now
            log.append(f"{clock.now:g} {name}")
            try:
                while clock.now - begin < seconds - 1e-9:
                    yield
            except GeneratorExit:
                log.append(f"{clock.now:g} {name} halted")
                raise
            log.append(f"{clock.now:g} {name} ended")
            if fails:
                raise btlang.ActionFailed("slipped")

        return leaf

    @btlang.condition("it is late")
    def late(clock: Clock) -> bool:
        return clock.now >= 2 - 1e-9

    @btlang.condition("it is early")
    def early(clock: Clock) -> bool:
        return clock.now < 2 - 1e-9

    made = [lasting("work", 1), lasting("play", 1), lasting("slip", 0.5, fails=True)]
    named = zip(("work", "play", "slip"), made, strict=True)
    return [btlang.action(name, id=name.title())(leaf) for name, leaf in named] + [late, early]


def run(text: str, limit: float = 20) -> tuple[Log, str, float]:
    """Events, how it ended, and when."""
    log: Log = []
    outcome = btlang.parse_tree(text, keywords=words(log)).run(speed="max", rate=10, time_limit=limit)
    return log, NAMES[outcome.status], round(outcome.seconds, 6)


WORK = ["0 work", "1 work ended"]
ROUNDS = ["0 work", "1 work ended", "1 work", "2 work ended"]


@pytest.mark.parametrize(
    ("text", "log", "status", "seconds"),
    [
        ("work then play", [*WORK, "1 play", "2 play ended"], SUCCESS, 2),
        ("work and play at the same time", ["0 work", "0 play", "1 work ended", "1 play ended"], SUCCESS, 1),
        ("work and slip at the same time", ["0 work", "0 slip", "0.5 slip ended", "0.5 work halted"], FAILURE, 0.5),
        ("slip or work", ["0 slip", "0.5 slip ended", "0.5 work", "1.5 work ended"], SUCCESS, 1.5),
        ("work or play", WORK, SUCCESS, 1),
        ("work after play", ["0 play", "1 play ended", "1 work", "2 work ended"], SUCCESS, 2),
        ("slip then work", ["0 slip", "0.5 slip ended"], FAILURE, 0.5),
        ("slip if possible then work", ["0 slip", "0.5 slip ended", "0.5 work", "1.5 work ended"], SUCCESS, 1.5),
        ("try slip otherwise work", ["0 slip", "0.5 slip ended", "0.5 work", "1.5 work ended"], SUCCESS, 1.5),
        ("retry slip 2 times", ["0 slip", "0.5 slip ended", "0.5 slip", "1 slip ended"], FAILURE, 1),
        ("if it is early, work", WORK, SUCCESS, 1),
        ("if it is late, work", [], SKIPPED, 0),
        ("if it is late, work otherwise play", ["0 play", "1 play ended"], SUCCESS, 1),
        ("unless it is late, work", WORK, SUCCESS, 1),
        ("(if it is late, work) then play", ["0 play", "1 play ended"], SUCCESS, 1),
        ("(work if it is late) or play", ["0 play", "1 play ended"], SUCCESS, 1),
        ("work within 2 s", WORK, SUCCESS, 1),
        ("work within 0.5 s", ["0 work", "0.5 work halted"], FAILURE, 0.5),
        ("work within 0.5 s or play", ["0 work", "0.5 work halted", "0.5 play", "1.5 play ended"], SUCCESS, 1.5),
        ("work for 1.5 s", [*WORK, "1 work", "1.5 work halted"], SUCCESS, 1.5),
        ("slip for 3 s", ["0 slip", "0.5 slip ended"], FAILURE, 0.5),
        ("work twice", ROUNDS, SUCCESS, 2),
        ("work until it is late", [*WORK, "1 work", "2 work halted"], SUCCESS, 2),
        ("while it is early, (work then slip)", [*WORK, "1 slip", "1.5 slip ended"], FAILURE, 1.5),
        ("while it is late, work otherwise play", ["0 play", "1 play ended"], SUCCESS, 1),
        ("work 3 times provided that it is early", [*ROUNDS[:3], "2 work halted"], FAILURE, 2),
        ("after 0.5 s, work", ["0.5 work", "1.5 work ended"], SUCCESS, 1.5),
        ("wait 0.3 s then work", ["0.3 work", "1.3 work ended"], SUCCESS, 1.3),
        ("wait until it is late then work", ["2 work", "3 work ended"], SUCCESS, 3),
        ("wait until it is late within 1 s", [], FAILURE, 1),
        ("check it is late", [], FAILURE, 0),
        ("do nothing or fail", [], SUCCESS, 0),
        ("p is work and play at the same time\np", ["0 work", "0 play", "1 work ended", "1 play ended"], SUCCESS, 1),
        ("repeat 2 times: work if it is late", [], SUCCESS, 0.1),
    ],
)  # fmt: skip
def test_form(text: str, log: Log, status: int, seconds: float) -> None:
    assert run(text) == (log, NAMES[status], pytest.approx(seconds))


@pytest.mark.parametrize(
    ("text", "log"),
    [
        ("every 2 s, work", ["0 work", "1 work ended", "2 work", "3 work ended", "4 work", "4.5 work halted"]),
        ("work forever", ["0 work", "1 work ended", "1 work", "2 work ended", "2 work", "3 work ended", "3 work",
                          "4 work ended", "4 work", "4.5 work halted"]),
        ("repeat slip or (work then fail or work)", ["0 slip", "0.5 slip ended", "0.5 work", "1.5 work ended",
                                                     "1.5 work", "2.5 work ended", "2.5 slip", "3 slip ended",
                                                     "3 work", "4 work ended", "4 work", "4.5 work halted"]),
    ],
)  # fmt: skip
def test_what_never_ends_is_halted_by_the_limit(text: str, log: Log) -> None:
    assert run(text, limit=4.5) == (log, NAMES[IDLE], pytest.approx(4.5))
