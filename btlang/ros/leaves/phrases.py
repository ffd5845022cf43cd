"""An action that `btc serve-actions` serves as a leaf: its phrase and its values go to that server."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from btlang.engine.script.values import as_text
from btlang.ros.clients import Clients
from btlang.ros.leaves.actions import goal_leaf
from btlang.ros.serving.names import RUN_PHRASE, SILENCE
from btlang.ros.word import Word
from btlang.vocabulary.value_type import format_number

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def phrase_leaf(word: Word, clients: Clients) -> Callable[..., Any]:
    """A generator leaf. Values are sent in the units whose factor is 1; the server has defaults for what is missing."""
    cls = word.interface(RUN_PHRASE)

    def make(values: Mapping[str, Any]) -> Any:
        return cls.Goal(phrase=word.ros.interface, names=list(values), values=[_text(v) for v in values.values()])

    return goal_leaf(word, clients, cls, make, SILENCE)


def _text(value: Any) -> str:
    return format_number(value) if isinstance(value, float) else as_text(value)
