"""When what is said is meant for the robot: after its wake word, while a button is pushed, or always."""

from __future__ import annotations

import math

from btlang.speech.grammar import spoken
from btlang.speech.recogniser import Expected, Understood

_AWAKE = 8.0  # seconds in which something may follow the wake word


class Attention:
    """`wake` is the wake word, "" without one; `push`, whether there is a button. `now` is in seconds of any clock."""

    def __init__(self, wake: str, push: bool) -> None:
        self._wake, self._push = spoken(wake), push
        self._until = -math.inf

    def expected(self, wanted: Expected, answering: bool, now: float) -> Expected:
        """What to listen for. No wake word is needed for `answering`, when the robot has asked."""
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

    def meant(self, understood: Understood, now: float) -> Understood | None:
        """What was said to the robot, without the wake word; None where that is all. It is awake from then on."""
        if not self._wake or not f"{spoken(understood.text)} ".startswith(f"{self._wake} "):
            return understood
        rest = " ".join(understood.text.split()[len(self._wake.split()) :])
        if rest:
            return understood.replace(text=rest)  # type: ignore[no-any-return]
        if understood.sure:
            self._until = now + _AWAKE
        return None
