"""Runs a recogniser in its own thread, and decides when what is said is meant for the robot."""

from __future__ import annotations

import math
import threading
from collections import deque
from collections.abc import Callable
from queue import SimpleQueue

from btlang.speech.recogniser import RATE, Expected, RecognisedSpeech, spoken

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.speech.recogniser import Recogniser


_AWAKE = 8.0  # seconds in which something may follow the wake word
_LONGEST = 5 * RATE * 2  # bytes of sound that wait for a slow recogniser
_PIECE = RATE // 5  # bytes that are decoded at once: the tick never waits longer for the interpreter


class Attention:
    """The attention to speech. `wake` is the wake word, "" for none; `push` is whether there is a button.

    `now` is in seconds of any clock.
    """

    def __init__(self, wake: str, push: bool) -> None:
        self._wake, self._push = spoken(wake), push
        self._until = -math.inf

    def expected(self, wanted: Expected, answering: bool, now: float) -> Expected:
        """Return what to listen for. No wake word is needed for `answering`, when the robot has asked."""
        if self._push:
            return wanted.replace(mode="pushed")  # type: ignore[no-any-return]
        if not self._wake or not wanted:
            return wanted
        if answering or now < self._until:
            return wanted.replace(mode="addressed")  # type: ignore[no-any-return]
        phrases, others = (
            tuple(f"{self._wake} {phrase}" for phrase in each) for each in (wanted.phrases, wanted.others)
        )
        return Expected((self._wake, *phrases), wanted.names, mode="wake", others=others)

    def meant(self, understood: RecognisedSpeech, now: float) -> RecognisedSpeech | None:
        """Return what was said to the robot, without the wake word; None if that is all. It is awake from then on."""
        if not self._wake or not f"{spoken(understood.text)} ".startswith(f"{self._wake} "):
            return understood
        rest = " ".join(understood.text.split()[len(self._wake.split()) :])
        if rest:
            return understood.replace(text=rest)  # type: ignore[no-any-return]
        if understood.sure:
            self._until = now + _AWAKE
        return None


class Listener:
    """A recogniser in a thread, from its creation to `close`. All methods are for any thread, and return at once."""

    def __init__(self, recogniser: Recogniser) -> None:
        self._recogniser = recogniser
        self._calls: SimpleQueue[Callable[[], object] | None] = SimpleQueue()
        self._found: deque[RecognisedSpeech] = deque(maxlen=100)
        self._waiting, self._lock = 0, threading.Lock()  # bytes, which two threads count
        self._broken = ""
        self._is_late = False
        self._thread = threading.Thread(target=self._work, name="btlang ears", daemon=True)
        self._thread.start()

    @property
    def problem(self) -> str:
        """Why it doesn't hear; "" while it does."""
        return self._broken or ("five seconds of sound wait for it: it is too slow, or hangs" if self._is_late else "")

    def expect(self, expected: Expected) -> None:
        """Set what is listened for from now on."""
        self._put(lambda: self._recogniser.expect(expected))

    def hear(self, samples: bytes) -> None:
        """Take the next samples; they are lost if five seconds of sound wait already."""
        with self._lock:
            self._is_late = self._waiting + len(samples) > _LONGEST
            if self._is_late:
                return
            self._waiting += len(samples)
        self._put(lambda: self._hear(samples))

    def end(self) -> None:
        """End a sentence: the speaker has released the button."""
        self._put(lambda: self._found.extend(self._recogniser.end()))

    def forget(self) -> None:
        """Drop what was heard so far."""
        self._put(self._recogniser.forget)

    def understood(self) -> RecognisedSpeech | None:
        """Return the next sentence, each once; None if there is none."""
        return self._found.popleft() if self._found else None

    def close(self) -> None:
        """End the thread. May be called twice."""
        self._calls.put(None)
        self._thread.join(2.0)

    def _put(self, call: Callable[[], object]) -> None:
        if not self._broken:
            self._calls.put(call)

    def _hear(self, samples: bytes) -> None:
        with self._lock:
            self._waiting -= len(samples)
        for at in range(0, len(samples), _PIECE):
            self._found.extend(self._recogniser.hear(samples[at : at + _PIECE]))

    def _work(self) -> None:
        while (call := self._calls.get()) is not None:
            try:
                call()
            except BaseException as problem:  # of a recogniser by somebody else, too
                self._broken = f"{type(problem).__name__}: {problem}"
                return
