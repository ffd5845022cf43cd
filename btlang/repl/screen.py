"""The REPL on a terminal: the line being typed, what is wrong with it, what may follow, and its tree, drawn live.

prompt_toolkit reads the line, which it colours, and offers what may follow; what else is seen is drawn by rich.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from itertools import islice

from prompt_toolkit.application import Application
from prompt_toolkit.buffer import Buffer
from prompt_toolkit.document import Document
from prompt_toolkit.filters import Condition, has_completions
from prompt_toolkit.formatted_text import ANSI, StyleAndTextTuples
from prompt_toolkit.history import FileHistory, History, InMemoryHistory
from prompt_toolkit.input import Input
from prompt_toolkit.input.typeahead import store_typeahead
from prompt_toolkit.input.vt100_parser import Vt100Parser
from prompt_toolkit.key_binding.key_processor import KeyPress
from prompt_toolkit.layout import HSplit, Layout, Window
from prompt_toolkit.layout.containers import ConditionalContainer, ScrollOffsets
from prompt_toolkit.layout.controls import BufferControl, FormattedTextControl
from prompt_toolkit.layout.dimension import Dimension
from prompt_toolkit.layout.menus import CompletionsMenuControl
from prompt_toolkit.lexers import Lexer
from prompt_toolkit.output import Output
from prompt_toolkit.styles import Style
from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.styled import Styled
from rich.text import Text

from btlang.repl.commands import command_of, is_begun, near_command, robot_line
from btlang.repl.draft import MissionDraft
from btlang.repl.keys import key_bindings
from btlang.repl.preview import Offers, Preview, continuations, preview
from btlang.repl.store import DraftStore
from btlang.text.output import draw_lines, has_colour

PROMPT, CONTINUED = "> ", "  "
_MENU_ROWS = 8
_MOST_PROBLEMS = 3  # the first ones: the others often follow from them

_UNFINISHED = "bright_black"

_STYLE = Style.from_dict({
    "prompt": "bold",
    "connective": "ansicyan",
    "name": "ansigreen",
    "error": "ansired underline",
    "completion-menu": "noinherit",
    "completion-menu.completion.current": "reverse",
    "completion-menu.meta": "noinherit ansibrightblack",
    "completion-menu.meta.completion.current": "noinherit ansibrightblack",
})  # fmt: skip


class ReplScreen:
    """The screen of the REPL, which asks for entries.

    `ask` returns a text that compiles, or a line for the REPL itself.

    `input` and `output` are those of the terminal where none are given.
    """

    def __init__(
        self, draft: MissionDraft, store: DraftStore, input: Input | None = None, output: Output | None = None
    ) -> None:
        self.draft = draft
        self._store = store
        self._seen: tuple[str, Preview] = ("", Preview())
        self.note = ""
        """A line at the bottom, until the text changes."""
        self.leaving = self.asks = False
        """Whether the user has asked once to leave."""
        self._refused = self._asked = ""
        history: History = InMemoryHistory() if store.problem else FileHistory(str(store.history))
        self.buffer = Buffer(
            completer=Offers(draft),
            complete_while_typing=True,
            history=history,
            multiline=True,
            on_text_changed=self._change,
        )
        self.application: Application[str] = Application(
            layout=self._layout(),
            key_bindings=key_bindings(self),
            style=_STYLE,
            erase_when_done=True,
            input=input,
            output=output,
        )

    def ask(self, text: str = "") -> str:
        """Let the user type, from a text to begin with. Raises EOFError when the user wants to leave."""
        self.buffer.reset(Document(text))
        self._refused, self._asked, self.note, self.leaving, self.asks = "", "", "", False, False
        self._keep()
        return self.application.run()

    def preview(self) -> Preview:
        """Return the preview of the text as it is now."""
        text = self.buffer.text
        if self._seen[0] != text or not text:
            seen = preview(self.draft, text)
            may_be_own = seen.errors and is_begun(text) and self._refused != text
            is_own = command_of(text, self.draft) is not None or may_be_own
            self._seen = text, Preview() if is_own else seen
        return self._seen[1]

    def refuse(self, is_whole: bool = False) -> None:
        """Show what is wrong with the entry although more might come: the user wants to run it.

        If `is_whole`, nothing of it was understood, and it is selected.
        """
        self._refused = self.buffer.text
        self._seen = "", Preview()
        near, fix = near_command(self.buffer.text), self.fix()
        self.note = "Not run: correct the mistake, or clear the line with Ctrl-C."
        if is_whole:
            self.note = "Not run. Type something else, or press an arrow key to correct this."
        if fix is not None:
            self.note = f"Not run: there's a mistake. Ctrl-F writes: {fix[2]}"
        elif near:
            self.note = f"Not run. Did you mean: {near}"

    def readings(self) -> list[tuple[int, int, str]]:
        """Return the changes between which the first warning with two readings leaves a choice."""
        text = self.buffer.text
        for problem in self.preview().problems:
            if len(problem.readings) == 2 and all(span.end <= len(text) for span, _ in problem.readings):
                return [(span.start, span.end, words) for span, words in problem.readings]
        return []

    def ask_which(self) -> bool:
        """Return whether the entry has two readings, and nobody was asked yet which of them is meant."""
        readings = self.readings()
        if not readings or self._asked == self.buffer.text:
            return False
        self._asked, self.asks = self.buffer.text, True
        first, second = (words for _, _, words in readings)
        self.note = (
            f"Two readings. 1 writes: {first} \N{MIDDLE DOT} 2 writes: {second} \N{MIDDLE DOT} Enter runs it as it is"
        )
        return True

    def clear(self) -> None:
        """Clear the terminal."""
        output = self.application.output
        output.erase_screen()
        output.cursor_goto(0, 0)
        output.flush()

    def type_ahead(self, keys: str) -> None:
        """Keep what was typed while a mission ran: the next line gets it as if it were typed then."""
        presses: list[KeyPress] = []
        Vt100Parser(presses.append).feed_and_flush(keys.replace("\n", "\r"))
        store_typeahead(self.application.input, presses)

    def _is_unfinished(self) -> bool:
        return self.preview().unfinished and self._refused != self.buffer.text

    def _change(self, _: Buffer) -> None:
        self.note, self.leaving, self.asks = "", False, False
        self._keep()

    def _keep(self) -> None:
        self._store.save([entry.text for entry in self.draft.entries], self.buffer.text, self.draft.world)

    # -- what is drawn

    def _layout(self) -> Layout:
        line = Window(
            BufferControl(self.buffer, lexer=_Marks(self.preview)),
            get_line_prefix=lambda number, wraps: [("class:prompt", PROMPT if number == wraps == 0 else CONTINUED)],
            wrap_lines=True,
            dont_extend_height=True,
        )
        menu = Window(  # in the flow of the rows, and not floating above them: nothing hides what is wrong
            CompletionsMenuControl(),
            height=Dimension(min=1, max=_MENU_ROWS),
            scroll_offsets=ScrollOffsets(top=1, bottom=1),
            dont_extend_height=True,
            dont_extend_width=True,
            style="class:completion-menu",
        )
        problems = FormattedTextControl(lambda: self._ansi(self._problems()))
        tree = FormattedTextControl(lambda: ANSI("\n".join(self._tree_lines())))
        bottom = FormattedTextControl(lambda: self._ansi(self._bottom_line(), fold=False))
        rows = [
            line,
            ConditionalContainer(
                Window(problems, dont_extend_height=True),
                filter=Condition(lambda: bool(self._problems().renderables)),
            ),
            ConditionalContainer(menu, filter=has_completions),
            ConditionalContainer(
                Window(tree, dont_extend_height=True, height=Dimension(min=1)),
                filter=Condition(lambda: bool(self.preview().tree)),
            ),
            Window(bottom, height=1),
            Window(),  # takes the rows that are no longer needed: what is drawn never gets fewer
        ]
        return Layout(HSplit(rows), focused_element=line)

    def _problems(self) -> Group:
        """Return carets under the words, if the entry fits on one line, and what is wrong."""
        seen, unfinished = self.preview(), self._is_unfinished()
        parts: list[RenderableType] = []
        for problem in seen.problems[:_MOST_PROBLEMS] if not (unfinished and seen.midword) else ():
            if unfinished:
                parts.append(_indent(problem.message, _UNFINISHED))
                break
            style = {"error": "red", "warning": "yellow"}.get(problem.kind.severity, "cyan")
            start, end = problem.span.start, min(problem.span.end, len(self.buffer.text))
            if "\n" not in self.buffer.text and len(PROMPT) + len(self.buffer.text) < self._columns():
                parts.append(Text(" " * (len(PROMPT) + start) + "^" * max(1, end - start), style))
            parts += [_indent(line, style) for line in (problem.message, *problem.hint.splitlines())]
        return Group(*parts)

    def _tree_lines(self) -> Iterator[str]:
        seen = self.preview()
        if seen.tree is None:
            return
        menu = _MENU_ROWS if self.buffer.complete_state else 0
        room = max(3, self._rows() - self.buffer.text.count("\n") - 4 - menu)
        more = seen.tree.height - room
        tree = Styled(seen.tree, _UNFINISHED if seen.errors else "")
        drawn = draw_lines(tree, self._columns() - len(CONTINUED), has_colour(sys.stdout), fold=False)
        for line in islice(drawn, room - (more > 0)):
            yield CONTINUED + line
        if more > 0:
            yield f"{CONTINUED}... {more + 1} more lines"

    def _bottom_line(self) -> Text:
        text = self.note
        if not text:
            fix = self.fix()
            keys = "Tab takes the suggestion" if self.buffer.complete_state else "'help' explains more"
            if fix is not None:
                keys = f"Ctrl-F writes: {fix[2]}"
            text = f"{keys} \N{MIDDLE DOT} {robot_line(self.draft)}"
        return Text(CONTINUED + text, _UNFINISHED)

    def _ansi(self, drawing: RenderableType, fold: bool = True) -> ANSI:
        return ANSI("\n".join(draw_lines(drawing, self._columns(), has_colour(sys.stdout), fold)))

    def fix(self) -> tuple[int, int, str] | None:
        """Return the first correction that is proposed: characters from and to, and what to write there."""
        for problem in self.preview().errors if not self._is_unfinished() else ():
            if problem.fix is not None:
                span, words = problem.fix
                if span.end <= len(self.buffer.text):
                    return span.start, span.end, words
        return None

    def offers(self) -> bool:
        """Return whether anything may follow at the cursor."""
        return bool(continuations(self.draft, self.buffer.document.text_before_cursor))

    def _rows(self) -> int:
        return self.application.output.get_size().rows

    def _columns(self) -> int:
        return self.application.output.get_size().columns


class _Marks(Lexer):
    """The colours of the entry, from its preview."""

    def __init__(self, seen: Callable[[], Preview]) -> None:
        self._preview = seen

    def invalidation_hash(self) -> object:
        """Return a new value each time: the same text may be coloured otherwise later, when more names are defined."""
        return self._preview().marks

    def lex_document(self, document: Document) -> Callable[[int], StyleAndTextTuples]:
        styles = [""] * len(document.text)
        for start, end, name in self._preview().marks:
            styles[start:end] = [f"class:{name}"] * (min(end, len(styles)) - start)
        starts = [0]
        for line in document.lines:
            starts.append(starts[-1] + len(line) + 1)

        def line_of(number: int) -> StyleAndTextTuples:
            text = document.lines[number]
            return list(zip(styles[starts[number] : starts[number] + len(text)], text, strict=False))

        return line_of


def _indent(text: str, style: str) -> Padding:
    return Padding(Text(text, style), (0, 0, 0, len(CONTINUED)))
