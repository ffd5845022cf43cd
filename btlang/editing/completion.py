"""What may follow at a place of a text."""

from __future__ import annotations

from btlang.editing.words import Words
from btlang.frontends.mission.completion.completer import completions
from btlang.frontends.table import frontend_of
from btlang.text.source import Source

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_MOST = 200


def complete(source: Source, words: Words, at: int | None = None) -> dict[str, Any]:
    """`completions` at a character, by default the end; see `Completion`. None in XML and JSON.

    Raises MissionError for words that can't be used.
    """
    if frontend_of(source) != "english":
        return {"completions": []}
    found = completions(source.text[:at], words.vocabulary(source))
    return {"completions": [each.as_dict() for each in found[:_MOST]]}
