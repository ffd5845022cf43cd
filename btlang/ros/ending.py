"""Signals that end a node: kept until it has come to an end by itself."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from btlang.run.terminal import ENDING_SIGNALS


class EndingSignals:
    """Those that have come; `on_arrival` is called by each."""

    def __init__(self) -> None:
        self.numbers: list[int] = []
        self.on_arrival: Callable[[], object] = int

    def __call__(self, number: int, frame: object) -> None:
        self.numbers.append(number)
        self.on_arrival()


@contextmanager
def ending_signals() -> Iterator[EndingSignals]:
    """Ctrl-C and signals to end are kept instead of ending the process at once. One that is ignored stays so."""
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
