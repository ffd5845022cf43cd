"""What is shown while an entry is being typed: its words, problems, tree, and the menu of what may follow."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from prompt_toolkit.completion import CompleteEvent, Completer, PathCompleter
from prompt_toolkit.completion import Completion as MenuItem
from prompt_toolkit.document import Document

from btlang.diagnostics.diagnostic import Diagnostic, MissionError
from btlang.frontends.mission.completion.completer import Completion, completions
from btlang.frontends.mission.token import Token
from btlang.frontends.mission.tokens.lexer import Lexer
from btlang.repl.commands import COMMANDS
from btlang.repl.draft import MissionDraft
from btlang.support.record import Record
from btlang.text.source import Source
from btlang.tree.dump import Outline
from btlang.vocabulary.language_tables import CONNECTIVES
from btlang.vocabulary.lexicon import Lexicon

_UNFINISHED = frozenset(("BT004", "BT023", "BT027"))  # an open quote, bracket or block
_UNKNOWN = frozenset(("BT010", "BT013"))
_ENDS_NOTHING = frozenset((
    *CONNECTIVES, "unknown", "otherwise", "comma", "semi", "colon", "open", "define", "not", "if",
    "unless", "while", "until", "provided", "repeat", "try", "retry", "check", "wait_until",
    "whenever", "in_parallel", "in_order",
))  # fmt: skip
"""The tokens that no sentence ends with."""
_MOST_TRIES = 3
_OPERANDS = frozenset(("command", "condition", "unknown", "define"))


class Preview(Record):
    """A text as the user may see it.

    `unfinished` means that maybe only more words are missing, `midword` that maybe only the rest of a word is.
    `tree` is that of the part that can be read if not all can, None if there is none;
    `marks` are characters of the text with "connective", "name" or "error".
    """

    problems: tuple[Diagnostic, ...] = ()
    unfinished: bool = False
    midword: bool = False
    tree: Outline | None = None
    marks: tuple[tuple[int, int, str], ...] = ()

    @property
    def errors(self) -> tuple[Diagnostic, ...]:
        """The problems that keep the entry from running."""
        return tuple(problem for problem in self.problems if problem.is_error)


def preview(draft: MissionDraft, text: str) -> Preview:
    """Compile the entry. Raises nothing."""
    if not text.strip():
        return Preview()
    tokens = Lexer(Source(text), draft.vocabulary, explain=False).tokens
    marks = _marks(tokens)
    try:
        compiled = draft.compile(text, suggest=False)
    except MissionError as error:
        own = _own(error, text)
        unfinished = _is_unfinished(own, text, draft.vocabulary) and _goes_on(draft, text)
        if not unfinished:
            own = _with_corrections(draft, text)
        spans = () if unfinished else tuple((p.span.start, p.span.end, "error") for p in own if p.is_error)
        midword = unfinished and text[-1:].isalnum() and own[0].code in _UNKNOWN
        return Preview(own, unfinished, midword, _tree_so_far(draft, text, tokens), (*marks, *spans))
    return Preview(compiled.mission.warnings, False, False, compiled.outline(), marks)


def continuations(draft: MissionDraft, text: str) -> list[Completion]:
    """Return what may follow the text that stands before the cursor."""
    context = draft.context()
    found = completions(context + text, draft.vocabulary)
    return [option.replace(start=option.start - len(context)) for option in found]


def _own(error: MissionError, text: str) -> tuple[Diagnostic, ...]:
    return tuple(p for p in error.diagnostics if p.span.start <= len(text)) or tuple(error.diagnostics)


def _with_corrections(draft: MissionDraft, text: str) -> tuple[Diagnostic, ...]:
    """Return what is wrong with an entry that cannot be read."""
    try:
        draft.compile(text)
    except MissionError as error:
        return _own(error, text)
    return ()


def _is_unfinished(problems: tuple[Diagnostic, ...], text: str, vocabulary: Lexicon) -> bool:
    """Return whether all that is wrong is at the end, or waits for it."""
    errors = [problem for problem in problems if problem.is_error]
    rests = (text[p.span.end :].lower().split() for p in errors if p.code not in _UNFINISHED)
    return all(vocabulary.articles.issuperset(rest) for rest in rests)


def _goes_on(draft: MissionDraft, text: str) -> bool:
    """Return whether anything but another spelling may follow."""
    if text.count('"') % 2:
        return True
    return any(not option.spelling for option in continuations(draft, text))


def _tree_so_far(draft: MissionDraft, text: str, tokens: list[Token]) -> Outline | None:
    """Return the tree of the text without its last words, as few as possible."""
    tokens = [token for token in tokens if token.end > token.start]
    for _ in range(_MOST_TRIES):
        if tokens:
            tokens.pop()
        while tokens and tokens[-1].kind in _ENDS_NOTHING:
            tokens.pop()
        if not tokens:
            break
        try:
            return draft.compile(text[: tokens[-1].end], suggest=False).outline()
        except MissionError:
            continue
    return None


def _marks(tokens: list[Token]) -> tuple[tuple[int, int, str], ...]:
    marks = []
    for token in tokens:
        if token.kind == "define":
            marks.append((token.start, token.end, "name"))
        elif token.kind not in _OPERANDS and token.end > token.start:
            marks.append((token.start, token.end, "connective"))
    return tuple(marks)


_TAKE_FILES = frozenset(("load", "save", "world"))
_SPEEDS = ("real", "max", "5")


class Offers(Completer):
    """The completer of the entry. At the start of a line it offers nothing until the user asks."""

    def __init__(self, draft: MissionDraft) -> None:
        self._draft = draft
        self._paths = PathCompleter(expanduser=False)

    def get_completions(self, document: Document, complete_event: CompleteEvent) -> Iterable[MenuItem]:
        """Return what may follow the text before the cursor."""
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
            yield from (MenuItem(word, -len(rest)) for word in words if word.startswith(rest))
            if name == "speed":
                return
        own = list(_own_words(text)) if not space and "\n" not in text else []
        for option in continuations(self._draft, text):
            if option.spelling and own:
                break
            mark = "(spelling) " if option.spelling else ""
            yield MenuItem(option.text, option.start - len(text), display_meta=mark + option.help)
        yield from own


def _own_words(start: str) -> Iterator[MenuItem]:
    for command in COMMANDS:
        if command.name.startswith(start.lower()) and command.name != start:
            yield MenuItem(command.name, -len(start), display_meta=command.help)
