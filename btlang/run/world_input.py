"""What people do to the world while a run goes on: they type answers, and make visitors come."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping

from btlang.run.bus import INLINE
from btlang.run.events import Asked, Ended, Event, PeriodPassed
from btlang.text.formatting import one_line

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_ANY = "*"
_MOST = 100  # of what waits for the run: who sends more is not heard


class WorldInput:
    """A sink in the thread of the run. `type` and `invite` may be called from any thread.

    `answers` are by words of the question, "*" for any other: the first to the first such question, and so on; the last
    one is given again and again.
    """

    policy = INLINE

    def __init__(self, answers: Mapping[str, list[str]] | None = None) -> None:
        self._answers = {words.lower(): list(texts) for words, texts in (answers or {}).items()}
        self._calls: deque[Callable[[Any], object]] = deque(maxlen=_MOST)
        self._unasked = [words for words in self._answers if words != _ANY]
        self._missed = False
        self.question = ""
        """The open question, "" while there is none."""
        self.on_question: Callable[[str], object] = lambda question: None
        """A function that gets each question that has no answer yet, in the thread of the run."""

    def __call__(self, event: Event) -> None:
        """Take in an event of the run."""
        if isinstance(event, Asked):
            self.question = event.text or "..."
            if (answer := self._take_answer(event.text.lower())) is not None:
                self.type(answer)
            else:
                self.on_question(self.question)
        elif isinstance(event, PeriodPassed) and (self.question or self._calls):
            while self._calls:
                self._calls.popleft()(event.robot)
            if not getattr(getattr(event.robot, "ears", None), "asking", ""):
                self.question = ""
        elif isinstance(event, Ended):
            self.question = ""

    def type(self, text: str) -> None:
        """Answer for somebody who types."""
        self._calls.append(lambda robot: robot.hear(text))

    def invite(self) -> None:
        """Let a visitor come, where the world is simulated."""
        self._calls.append(lambda robot: robot.invite() if hasattr(robot, "invite") else None)

    def _take_answer(self, question: str) -> str | None:
        found = next((words for words in self._answers if words in question), _ANY)
        texts = self._answers.get(found)
        if found in self._unasked:
            self._unasked.remove(found)
        if not texts:
            self._missed = True
            return None
        return texts.pop(0) if len(texts) > 1 else texts[0]

    def unused_answers(self) -> str:
        """Say which answers no question had, where a question had none; "" otherwise."""
        if not (self._missed and self._unasked):
            return ""
        words = ", ".join(f'"{one_line(each)}"' for each in self._unasked)
        return f'No question had the words {words}. Answers stand under words of their question: "tea" = "yes".'
