"""What can be asked about a text, with places in the units of browsers and editors: UTF-16."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from btlang.api import Mission, format_mission
from btlang.diagnostics.diagnostic import MissionError
from btlang.editing.changes import Change, apply_changes
from btlang.editing.document import document, messages, text_messages
from btlang.editing.edits import edit
from btlang.editing.help import complete, hover, tokens
from btlang.editing.palette import palette
from btlang.editing.rename import rename
from btlang.editing.words import RobotWords
from btlang.frontends.table import frontend_of
from btlang.support.record import Record
from btlang.text.source import Source, Utf16Units

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


PLACES = frozenset({"at", "to"})
"""The arguments that are places in the text."""


def in_units(answer: dict[str, Any], text: str) -> dict[str, Any]:
    """Return an answer about a text with its places in units: all that is called `start`, `end` or `of`.

    Where it has `changes`, its own `start` and `end` are in the text with them.
    """
    units = Utf16Units(text)
    made: dict[str, Any] = _convert(answer, units) if units.wide else answer
    if "changes" in answer and "start" in answer:
        after = Utf16Units(apply_changes(text, [Change(**change) for change in answer["changes"]]))
        made = {**made, "start": after.unit(answer["start"]), "end": after.unit(answer["end"])}
    return made


def _convert(part: Any, units: Utf16Units) -> Any:
    if isinstance(part, Mapping):
        return {
            key: _place(value, units) if key in ("start", "end", "of") else _convert(value, units)
            for key, value in part.items()
        }
    return [_convert(each, units) for each in part] if isinstance(part, list | tuple) else part


def _place(value: Any, units: Utf16Units) -> Any:
    if isinstance(value, int):
        return units.unit(value)
    return [units.unit(each) for each in value] if value is not None else None


class TextQuery(Record):
    """A query about a text: `help` is a line about it, `do` takes the source, the words, and the arguments that it
    `needs` or only `takes`: `at` and `to`, places in the text, `name`, `tests` and `called`, texts, or `edit`
    (btlang.editing.edits.Edit).
    """

    help: str
    do: Callable[..., dict[str, Any]]
    needs: tuple[str, ...] = ()
    takes: tuple[str, ...] = ()


def of_mission(report: Callable[[Mission], dict[str, Any]]) -> Callable[..., dict[str, Any]]:
    """Return what makes a report about a mission, with its messages, for a TextQuery."""

    def do(source: Source, words: RobotWords) -> dict[str, Any]:
        mission = words.mission(source)
        return {"messages": messages(mission.warnings, source), **report(mission)}

    return do


def _english(source: Source, words: RobotWords) -> dict[str, Any]:
    query = of_mission(lambda mission: {"text": mission.to("english")})
    return {"sort": frontend_of(source), **query(source, words)}


def _format(source: Source, words: RobotWords) -> dict[str, Any]:
    return {"text": format_mission(source, keywords=words.keywords, world=words.world, language=words.language)}


DOES: Mapping[str, TextQuery] = {
    "check": TextQuery("What is wrong with a mission.", of_mission(lambda mission: {"outline": str(mission)})),
    "complete": TextQuery("What may follow at a place, by default the end.", complete, takes=("at",)),
    "document": TextQuery(
        "All that an editor shows of a text: messages, tree and outline.",
        lambda source, words, shown=None: document(source, words),
        takes=("shown",),
    ),
    "edit": TextQuery("A change of a mission by its tree.", edit, needs=("edit",)),
    "english": TextQuery("A mission, which may be a tree in XML or JSON, in English.", _english),
    "explain": TextQuery(
        "How a mission is understood.", of_mission(lambda mission: {"explanation": mission.explain()})
    ),
    "format": TextQuery("A mission in the usual layout.", _format),
    "hover": TextQuery("What was understood at a place, with help.", hover, needs=("at",)),
    "messages": TextQuery("What is wrong with a text, as its document says it.", text_messages),
    "palette": TextQuery("All that can be put into a mission, by topic.", palette),
    "rename": TextQuery("What gives a definition and its uses another name.", rename, needs=("at",), takes=("name",)),
    "tokens": TextQuery("As what the words between two places are read.", tokens, takes=("at", "to")),
    "xml": TextQuery(
        "A mission as a tree of BehaviorTree.CPP.", of_mission(lambda mission: {"xml": str(mission.to("xml"))})
    ),
}


def answer_of(asked: TextQuery, source: Source, words: RobotWords, arguments: Mapping[str, Any] = {}) -> dict[str, Any]:
    """Return what is asked of a text, with what is wrong with it as data; places are characters."""
    try:
        return {"ok": True, "messages": [], **asked.do(source=source, words=words, **arguments)}
    except MissionError as error:
        return {"ok": False, "messages": messages(error.diagnostics, source)}
