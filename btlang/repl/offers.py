"""What the menu offers: what may follow in the mission, and the words of the REPL with what they take."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from prompt_toolkit.completion import CompleteEvent, Completer, Completion, PathCompleter
from prompt_toolkit.document import Document

from btlang.repl.commands import COMMANDS
from btlang.repl.draft import MissionDraft
from btlang.repl.preview import continuations

_TAKE_FILES = frozenset(("load", "save", "world"))
_SPEEDS = ("real", "max", "5")


class Offers(Completer):
    """The completer of the entry. At the start of a line it offers nothing until the user asks."""

    def __init__(self, draft: MissionDraft) -> None:
        self._draft = draft
        self._paths = PathCompleter(expanduser=False)

    def get_completions(self, document: Document, complete_event: CompleteEvent) -> Iterable[Completion]:
        """Of the text before the cursor."""
        text = document.text_before_cursor
        if not document.current_line_before_cursor.strip() and not complete_event.completion_requested:
            return
        name, space, rest = text.partition(" ")
        if space and name in _TAKE_FILES:
            rest = rest.removeprefix("over ") if name == "save" else rest
            yield from self._paths.get_completions(Document(rest), complete_event)
            return
        if space and name in ("show", "speed"):
            words = [*self._draft.definitions, "tree"] if name == "show" else _SPEEDS
            yield from (Completion(word, -len(rest)) for word in words if word.startswith(rest))
            if name == "speed":
                return
        own = list(_own_words(text)) if not space and "\n" not in text else []
        for option in continuations(self._draft, text):
            if option.spelling and own:
                break
            mark = "(spelling) " if option.spelling else ""
            yield Completion(option.text, option.start - len(text), display_meta=mark + option.help)
        yield from own


def _own_words(start: str) -> Iterator[Completion]:
    for command in COMMANDS:
        if command.name.startswith(start.lower()) and command.name != start:
            yield Completion(command.name, -len(start), display_meta=command.help)
