"""The REPL: asks for an entry, runs or does what it says, and keeps it."""

from __future__ import annotations

import signal
import sys
from collections.abc import Iterable, Iterator, Sequence
from contextlib import closing, contextmanager, nullcontext
from textwrap import dedent

from btlang.api import Mission
from btlang.diagnostics.diagnostic import MissionError, render
from btlang.frontends.mission.reader import DEFAULT_PARSER
from btlang.repl.commands import Leave, ReplCommands, command_of
from btlang.repl.draft import MissionDraft
from btlang.repl.keys import entries
from btlang.repl.store import DraftStore, SavedDraft, state_folder
from btlang.repl.welcome import welcome
from btlang.run.terminal import ENDING_SIGNALS, run_mission
from btlang.text.output import can_draw, has_colour, show
from btlang.vocabulary.shipped import ENGLISH

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import NoReturn

    from btlang.engine.blackboard import Blackboard


def run_repl(
    *,
    keywords: Sequence[str] = (),
    world: str | None = None,
    parser: str = DEFAULT_PARSER,
    include_root: str | None = None,
    speed: float | str = "real",
    robot: str = "simulated",
    over: str | None = None,
    language: str = ENGLISH,
) -> int:
    """Run until the user leaves or the input ends; return the exit code. Raises MissionError for wrong files."""
    with closing(MissionDraft(keywords, world, parser, include_root, robot, over, language)) as draft:
        return _talk_or_read(draft, speed)


def _talk_or_read(draft: MissionDraft, speed: float | str) -> int:
    if not can_draw(sys.stdout) or sys.stdin is None or not sys.stdin.isatty():
        return Repl(draft, DraftStore(None), speed).read(sys.stdin or ())
    store = DraftStore(state_folder())
    before = [signal.signal(number, _terminate) for number in ENDING_SIGNALS]
    try:
        Repl(draft, store, speed).talk()
    finally:
        for number, handler in zip(ENDING_SIGNALS, before, strict=True):
            signal.signal(number, handler)
    return 0


class Repl:
    """One draft, at the keyboard (`talk`) or from a file of lines (`read`)."""

    def __init__(self, draft: MissionDraft, store: DraftStore, speed: float | str) -> None:
        self._draft = draft
        self._store = store
        self._commands = ReplCommands(draft, show, self._run_all, store)
        self._commands.speed = speed
        self._ahead: list[str] = []  # keys that were typed while a mission ran

    def talk(self) -> None:
        """Talk with the user at the keyboard, until they leave."""
        from btlang.repl.screen import CONTINUED, PROMPT, ReplScreen

        screen = ReplScreen(self._draft, self._store)
        self._commands.clear_screen = screen.clear
        show("btlang: type what the robot should do.")
        self._commands.show_map()
        show(welcome(self._draft))
        if self._store.problem:
            show(f"What you type isn't saved: {self._store.problem}")
        left = self._store.left()
        if left is not None:
            show(f"The last session had {_count(left)}: 'restore' brings it back.")
        while True:
            try:
                text = screen.ask(self._commands.draft)
                self._commands.draft = ""
                show(PROMPT + text.replace("\n", f"\n{CONTINUED}"))
                try:
                    self._do(text)
                finally:
                    screen.type_ahead("".join(self._ahead))
                    self._ahead.clear()
                self._keep()
            except (EOFError, Leave):
                break
            except KeyboardInterrupt:
                show()
        if self._commands.is_saved:
            self._store.forget()
        else:
            self._keep()  # without the word that left
            show("This session is saved: after the next start, 'restore' brings it back.")

    def read(self, lines: Iterable[str]) -> int:
        """Read from lines; return 0, or 1 where a command failed, or 2 where an entry was wrong."""
        worst = 0
        for text in entries(lines, self._draft.vocabulary):
            try:
                worst = max(worst, self._do(text))
            except Leave:
                break
        return worst

    def _do(self, text: str) -> int:
        """Return the exit code that `btc run` would have. Raises Leave."""
        try:
            own = command_of(text, self._draft)
            if own is not None:
                self._commands.do(*own)
                return 0
            compiled = self._draft.compile(dedent(text))  # as it is saved, at the left margin
            if not compiled.entry.has_command and not compiled.entry.definitions:
                return 0  # a comment, or politeness
            self._draft.add(compiled.entry)
            self._keep()  # before it runs: a crash on the way loses nothing
            for warning in compiled.mission.warnings:
                show(render(warning, has_colour(sys.stdout)))
            if compiled.entry.has_command:
                return self._run(compiled.mission, self._draft.values())
            show("Defined: " + ", ".join(name for name, _ in compiled.entry.definitions))
        except MissionError as error:
            show(
                "\n\n".join(render(problem, has_colour(sys.stderr)) for problem in error.diagnostics), stream=sys.stderr
            )
            return 2
        return 0

    def _run_all(self) -> None:
        self._run(self._draft.compile_all())

    def _run(self, mission: Mission, values: Blackboard | None = None) -> int:
        speed = self._commands.speed
        with _type_ahead():
            return run_mission(
                mission, lambda: nullcontext(self._draft.session), speed=speed, rate=20.0, time_limit=None, log=None,
                quiet=False, type_ahead=self._ahead, tree_stays=False, values=values,
            )  # fmt: skip

    def _keep(self) -> None:
        self._store.save([entry.text for entry in self._draft.entries], "", self._draft.world)


@contextmanager
def _type_ahead() -> Iterator[None]:
    """Hide what is typed while the robot moves, and put it in the next line, also where there is no live view."""
    try:
        import termios

        before = termios.tcgetattr(0)
    except (ImportError, OSError, termios.error):
        yield
        return
    silent = list(before)
    silent[3] &= ~(termios.ECHO | termios.ICANON)
    termios.tcsetattr(0, termios.TCSANOW, silent)
    try:
        yield
    finally:
        termios.tcsetattr(0, termios.TCSANOW, before)


def _count(left: SavedDraft) -> str:
    lines = sum(len(text.splitlines()) for text in left.entries) + bool(left.draft.strip())
    return f"{lines} line{'' if lines == 1 else 's'}"


def _terminate(number: int, _: object) -> NoReturn:
    raise SystemExit(128 + number)
