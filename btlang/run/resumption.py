"""What a run has chosen, and a robot has to know again where another run goes on with it."""

from __future__ import annotations

from btlang.run.bus import INLINE
from btlang.run.events import Chosen, LanguageChosen

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any

    from btlang.run.events import Event


class RunChoices:
    """Counts the random choices of a run, and keeps the language in which it has the robot speak."""

    policy = INLINE

    def __init__(self) -> None:
        self._made, self._language = 0, ""

    def __call__(self, event: Event) -> None:
        if isinstance(event, Chosen) and event.how == "random":
            self._made += 1
        elif isinstance(event, LanguageChosen):
            self._language = event.name

    def save(self) -> dict[str, Any]:
        """As JSON."""
        return {"choices": self._made, "language": self._language}

    def restore(self, saved: Mapping[str, Any], robot: Any, seed: int) -> None:
        """Raises KeyError, TypeError or ValueError where `save` never gave that, ActionFailed where the robot can't."""
        self._made = int(saved["choices"])
        if self._made:
            robot.seed_choices(seed, self._made)
        if language := str(saved.get("language", "")):
            robot.speak_in(language)
