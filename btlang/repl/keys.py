"""The keys of the REPL, and where an entry ends."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from prompt_toolkit.buffer import Buffer
from prompt_toolkit.filters import Condition, completion_is_selected
from prompt_toolkit.key_binding import KeyBindings, KeyPressEvent

from btlang.repl.commands import command_of
from btlang.repl.preview import preview
from btlang.text.source import Source
from btlang.text.words import split
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.trie import longest

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Protocol

    from btlang.repl.draft import MissionDraft

    class LineEditor(Protocol):
        """The editor that the keys act on; see screen.py."""

        buffer: Buffer
        draft: MissionDraft
        note: str
        leaving: bool

        def fix(self) -> tuple[int, int, str] | None: ...

        def offers(self) -> bool: ...

        def refuse(self, is_whole: bool = False) -> None: ...

        def readings(self) -> list[tuple[int, int, str]]: ...

        def ask_which(self) -> bool: ...

        @property
        def asks(self) -> bool: ...


def needs_more(text: str) -> bool:
    """Return whether an entry goes on in the next line: it has opened a block that no empty line has closed."""
    lines = text.split("\n")
    return _opens_block(lines[-1]) or (len(lines) > 1 and bool(lines[-1].strip()))


def entries(lines: Iterable[str], vocabulary: Lexicon) -> Iterator[str]:
    """Yield the entries of a text that nobody types: a block also ends where a line stands at the margin again."""
    text = ""
    for line in lines:
        line = line.rstrip("\r\n")
        if text and line.strip() and (line[0].isspace() or _goes_on(line, vocabulary)):
            text += f"\n{line}"
            continue
        if text:
            yield text
        text = line
        if text.strip() and not _opens_block(text):
            yield text
            text = ""
    if text.strip():
        yield text


def _opens_block(line: str) -> bool:
    return line.split("#")[0].rstrip().endswith(":")


def _goes_on(line: str, vocabulary: Lexicon) -> bool:
    """Return whether a line at the margin belongs to the statement above it."""
    match = longest(vocabulary.trie, split(Source(line), vocabulary.orthography), 0, vocabulary.context)
    return match is not None and match.meaning.role == "otherwise"


_INDENT = "  "


def key_bindings(screen: LineEditor) -> KeyBindings:
    """Bind Enter, Tab, Ctrl-F, 1 and 2 where there is a choice, Ctrl-C, Ctrl-D and Backspace."""
    keys = KeyBindings()
    buffer = screen.buffer

    @keys.add("enter", filter=completion_is_selected)
    def take(event: KeyPressEvent) -> None:
        buffer.complete_state = None  # what is selected stands in the line already

    @keys.add("enter", filter=~completion_is_selected)
    def enter(event: KeyPressEvent) -> None:
        text = buffer.text
        if not text.strip():
            return
        if command_of(text, screen.draft) is None:
            if needs_more(text):
                _new_line(event)
                return
            errors = preview(screen.draft, text).errors
            if errors:
                span = errors[0].span
                buffer.cursor_position = min(span.end, len(text))
                is_whole = not (text[: span.start] + text[span.end :]).strip()
                if is_whole:
                    _select(buffer)
                screen.refuse(is_whole)
                return
            if screen.ask_which():
                return
        buffer.append_to_history()
        event.app.exit(result=text.rstrip())

    @keys.add("escape", "enter")
    def new_line(event: KeyPressEvent) -> None:
        _new_line(event)

    @keys.add("tab")
    def complete(event: KeyPressEvent) -> None:
        state = buffer.complete_state
        if state and len(state.completions) == 1:
            buffer.apply_completion(state.completions[0])
        elif state:
            buffer.complete_next()
        elif screen.fix() is not None and not screen.offers():
            mend(event)
        else:
            buffer.start_completion(insert_common_part=True)

    @keys.add("c-f", filter=Condition(lambda: screen.fix() is not None))
    def mend(event: KeyPressEvent) -> None:
        fix = screen.fix()
        if fix is not None:
            change(*fix)

    @keys.add("1", filter=Condition(lambda: screen.asks))
    @keys.add("2", filter=Condition(lambda: screen.asks))
    def choose(event: KeyPressEvent) -> None:
        change(*screen.readings()[int(event.data) - 1])

    def change(start: int, end: int, words: str) -> None:
        after = len(buffer.text) - buffer.cursor_position
        buffer.text = buffer.text[:start] + words + buffer.text[end:]
        buffer.cursor_position = max(start + len(words), len(buffer.text) - after)

    @keys.add("backspace", filter=Condition(lambda: bool(buffer.document.current_line_before_cursor)
                                            and buffer.document.current_line_before_cursor.isspace()))  # fmt: skip
    def unindent(event: KeyPressEvent) -> None:
        buffer.delete_before_cursor(min(len(_INDENT), len(buffer.document.current_line_before_cursor)))

    @keys.add("c-c")
    def clear(event: KeyPressEvent) -> None:
        if buffer.text:
            buffer.append_to_history()  # so that nothing is lost: Up brings it back
            buffer.reset()
        else:
            screen.note = "Ctrl-D twice leaves."

    @keys.add("c-d", filter=Condition(lambda: not buffer.text))
    def leave(event: KeyPressEvent) -> None:
        if screen.leaving:
            event.app.exit(exception=EOFError)
        else:
            screen.leaving = True
            screen.note = "Press Ctrl-D again to leave."

    return keys


def _select(buffer: Buffer) -> None:
    """Select the whole entry, so that what is typed next takes its place; an arrow key keeps it."""
    buffer.append_to_history()
    buffer.cursor_position = 0
    buffer.start_selection()
    if buffer.selection_state is not None:
        buffer.selection_state.enter_shift_mode()
    buffer.cursor_position = len(buffer.text)


def _new_line(event: KeyPressEvent) -> None:
    """Begin the next line where this one does, or further in where this one opens a block."""
    line = event.current_buffer.document.current_line
    indent = line[: len(line) - len(line.lstrip())]
    event.current_buffer.insert_text("\n" + indent + (_INDENT if line.rstrip().endswith(":") else ""))
