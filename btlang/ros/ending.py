"""The signals that end a node, kept until it has ended by itself."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from btlang.run.terminal import ENDING_SIGNALS


class EndingSignals:
    """The signals that have come; each calls `on_arrival`."""

    def __init__(self) -> None:
        self.numbers: list[int] = []
        self.on_arrival: Callable[[], object] = int

    def __call__(self, number: int, frame: object) -> None:
        self.numbers.append(number)
        self.on_arrival()


@contextmanager
def keep_ending_signals() -> Iterator[EndingSignals]:
    """Keep Ctrl-C and other ending signals, instead of ending the process at once. Ignored ones stay ignored."""
    came = EndingSignals()
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, *ENDING_SIGNALS)}
    taken = [number for number, handler in before.items() if handler != signal.SIG_IGN]
    for number in taken:
        signal.signal(number, came)
    try:
        yield came
    finally:
        for number in taken:
            signal.signal(number, before[number])
