"""A recogniser in a thread of its own: how much sound waits for it is never miscounted."""

from __future__ import annotations

import time
from collections.abc import Sequence
from threading import Event

from btlang.speech.listener import Listener
from btlang.speech.recogniser import RATE, Expected, RecognisedSpeech

LONGEST = 5 * RATE * 2  # bytes
PIECES = 3_000
LIMIT = 60.0  # seconds


class Counting:
    """Counts bytes; with `goes_on` cleared it hangs."""

    def __init__(self) -> None:
        self.heard = 0
        self.goes_on = Event()
        self.goes_on.set()

    def expect(self, expected: Expected) -> None:
        self.goes_on.wait(LIMIT)

    def hear(self, samples: bytes) -> Sequence[RecognisedSpeech]:
        self.heard += len(samples)
        return ()

    def end(self) -> Sequence[RecognisedSpeech]:
        return ()

    def forget(self) -> None:
        return


class Piece(bytes):
    """Other threads go on while it's asked for its length."""

    def __len__(self) -> int:
        time.sleep(0.0)
        return super().__len__()


def test_sound_that_waits_is_counted_to_the_byte() -> None:
    recogniser = Counting()
    listener = Listener(recogniser)
    for _ in range(PIECES):
        listener.hear(Piece(2))
    until = time.monotonic() + LIMIT
    while recogniser.heard < 2 * PIECES and time.monotonic() < until:
        time.sleep(0.01)
    assert recogniser.heard == 2 * PIECES
    recogniser.goes_on.clear()
    listener.expect(Expected())
    listener.hear(bytes(LONGEST))
    assert listener.problem == ""
    listener.hear(b"\0")
    assert "five seconds of sound wait" in listener.problem
    recogniser.goes_on.set()
    listener.close()
