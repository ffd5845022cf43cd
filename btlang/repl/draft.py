"""A mission that is written line by line: what was entered, the names defined, and the world it runs in."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from textwrap import indent

from btlang.api import Mission
from btlang.diagnostics.diagnostic import Diagnostic, MissionError
from btlang.engine.blackboard import Blackboard
from btlang.frontends.mission.reader import DEFAULT_PARSER, lexed, read_mission
from btlang.frontends.mission.tokens.lexer import Lexer
from btlang.passes import compile_mission, errors_of, run_passes
from btlang.passes.compilation import Compilation
from btlang.robots.mission_vocabulary import mission_vocabulary
from btlang.robots.registry import runs_on
from btlang.session import Session
from btlang.support.record import Record
from btlang.text.source import Source
from btlang.tree.ast import Ast, Chain, Definition, Fact, Include, Program, all_facts, parts
from btlang.tree.dump import Outline
from btlang.tree.node import Tree
from btlang.tree.visit import used_subtrees
from btlang.vocabulary.reading_context import Known
from btlang.vocabulary.shipped import ENGLISH

ENTRY = "prompt"
"""The name of the source of an entry in messages."""


class DraftEntry(Record):
    """One statement as it was typed, maybe of several lines, and the texts of the definitions in it by name."""

    text: str
    definitions: tuple[tuple[str, str], ...] = ()
    has_command: bool = False


class Compiled(Record):
    """An entry, and its mission with the subtrees that it defines and uses; without a command its tree does nothing."""

    entry: DraftEntry
    mission: Mission

    def outline(self) -> Outline:
        """Return the tree as `btc tree` shows it; of definitions alone only their subtrees."""
        whole = self.mission.__rich__()
        return whole if self.entry.has_command else whole.replace(trees=whole.trees[1:])


class MissionDraft:
    """A draft of a mission: entries, with undo and redo; the words; the robot and the values, which go on from entry to
    entry.
    """

    def __init__(
        self,
        keywords: Sequence[str] = (),
        world: str | None = None,
        parser: str = DEFAULT_PARSER,
        include_root: str | None = None,
        robot: str = "simulated",
        over: str | None = None,
        language: str = ENGLISH,
    ) -> None:
        """Raise MissionError where a keyword file, the world or the robot cannot be used."""
        self._robot, self._over = robot, over
        self.is_simulated = runs_on(robot, over)[1] == "simulated"
        self._keywords = keywords
        self.file: str | None = None
        """The file that the mission was loaded from or saved to last."""
        self.language = language
        self._include_root = include_root
        self._parser = parser
        self._undone: list[tuple[DraftEntry, ...]] = []
        self._before: list[tuple[DraftEntry, ...]] = []
        self.entries: tuple[DraftEntry, ...] = ()
        self._known_of: tuple[str, Mapping[str, Known]] = "", {}
        self._blackboard = Blackboard()
        self.use_world(world)

    def use_world(self, world: str | None) -> None:
        """Put the robot into a world of its own file, None for the one that ships. Raises MissionError."""
        vocabulary, world = mission_vocabulary(self._source(self.text), self._keywords, world, self.language)
        self.session = Session(self._robot, world=world, over=self._over)
        self.vocabulary = vocabulary
        self.world = world

    def load(self, source: Source) -> None:
        """Change to another mission, in its own world and with its own words if it names them. Raises MissionError.

        A world that the user has chosen stays.
        """
        before = self.vocabulary, self.world
        self.vocabulary, self.world = mission_vocabulary(source, self._keywords, self.world, self.language)
        try:
            entries = self.entries_of(source.text, source.name)
            if self.world != before[1]:
                session = Session(self._robot, world=self.world, over=self._over)
                self.session.close()
                self.session = session
        except MissionError:
            self.vocabulary, self.world = before
            raise
        self.change(entries)

    def reset(self) -> None:
        """Forget the values, and set the simulated world as it was at the start; another robot stays where it is."""
        if self.is_simulated:
            self.session = Session(self._robot, world=self.world, over=self._over)
        self._blackboard = Blackboard()

    def close(self) -> None:
        """Let go of the robot."""
        self.session.close()

    def _source(self, text: str, name: str = ENTRY) -> Source:
        folder = os.path.dirname(self.file or "")
        roots = (folder,) if self._include_root is None else (folder, self._include_root)
        return Source(text, name, folder, roots, may_load=True)

    @property
    def definitions(self) -> dict[str, str]:
        """The names defined so far, each with the text of its definition."""
        return dict(definition for entry in self.entries for definition in entry.definitions)

    @property
    def text(self) -> str:
        """The mission, as it is saved."""
        return "".join(f"{entry.text}\n" for entry in self.entries)

    def context(self, text: str = "") -> str:
        """Return the definitions that a new entry sees: those whose names it doesn't redefine."""
        known = self.definitions
        if not known:
            return ""
        names = Lexer(Source(text), self.vocabulary, explain=False).names
        redefined = {header.name for header in names.definitions.headers.values()} | {fact.name for fact in names.facts}
        return "".join(f"{definition}\n" for name, definition in known.items() if name not in redefined)

    def compile(self, text: str, suggest: bool = True) -> Compiled:
        """Read an entry together with the definitions above. Raises MissionError.

        With `suggest` False no corrections of what is wrong are tried, which takes time. `Do that again` is the latest
        command once more.
        """
        rounds = self._rounds_more(text)
        latest = next((entry.text for entry in reversed(self.entries) if entry.has_command), "") if rounds else ""
        if latest:
            head = f"{self.vocabulary.word('repeat')} {rounds} {self.vocabulary.word('count')}:"
            text = latest if rounds == 1 else f"{head}\n{indent(latest, '  ')}"
        margin = text[: len(text) - len(text.lstrip())].rpartition("\n")[2]
        above = indent(self.context(text), margin)
        whole = f"{text}\n{above}"  # the entry first, so that places in it are those that were typed
        source = self._source(whole)
        trial = errors_of if suggest else None
        reading = read_mission(source, self.vocabulary, self._parser, self._known(), trial)
        mission = reading.mission
        named: list[Definition | Fact | Include] = [*mission.includes, *mission.definitions, *mission.facts]
        own = [d for d in named if d.span.start < len(text)]
        compilation = Compilation(self.vocabulary, mission, needs_command=False, grows=True, warnings=reading.warnings)
        tree = run_passes(compilation).tree
        entry = DraftEntry(text, tuple((d.name, d.span.text) for d in own), reading.mission.body is not None)
        shown = Tree(tree.root, used_subtrees(tree, [name for name, _ in entry.definitions]))
        own_warnings = [warning for warning in compilation.warnings if warning.span.start < len(text)]
        return Compiled(entry, self._mission(shown, mission, own_warnings))

    def _rounds_more(self, text: str) -> int:
        """Return how often an entry such as `Again` or `Repeat that twice` repeats the command before it, else 0."""
        first = re.match(r"\s*(\w+)", text)
        if first is None or first[1].lower() not in self.vocabulary.continuing:
            return 0  # as nearly always, at each key
        lexer = Lexer(Source(text), self.vocabulary, explain=False)
        kinds = [token.kind for token in lexer.tokens if token.kind not in ("newline", "semi", "stop")]
        if " ".join(kinds) not in ("again", "repeat_that", "repeat_that count", "do_that again", "do_that more"):
            return 0
        count = str(lexer.tokens[-1].value) if kinds[-1] in ("count", "more") else "1"
        return int(count) if count.isdigit() else 0

    def values(self) -> Blackboard:
        """Return what entries before have set, without what was computed on the way or belongs to another mission."""
        known = self._known()
        for key in [key for key in self._blackboard.keys() if key not in known]:  # noqa: SIM118 - it is no dict
            self._blackboard.unset(key)
        return self._blackboard

    def _known(self) -> Mapping[str, Known]:
        """Return the values that entries before have set."""
        if self._known_of[0] != self.text:
            self._known_of = self.text, lexed(self._source(self.text), self.vocabulary).names.known
        return self._known_of[1]

    def compile_all(self) -> Mission:
        """Return the whole mission. Raises MissionError, also where it holds no command."""
        source = self._source(self.text, self.file or "<session>")
        reading = read_mission(source, self.vocabulary, self._parser, errors_of=errors_of)
        tree = compile_mission(reading.mission, self.vocabulary)
        return self._mission(tree, reading.mission, reading.warnings)

    def add(self, entry: DraftEntry) -> None:
        """Add an entry. A definition takes the place of an older one of the same name."""
        names = {name for name, _ in entry.definitions}
        kept = [old for old in self.entries if old.has_command or not {name for name, _ in old.definitions} <= names]
        self.change((*(kept if names else self.entries), entry))

    def change(self, entries: Sequence[DraftEntry]) -> None:
        """Set other entries; `undo` brings the present ones back."""
        self._before.append(self.entries)
        self._undone.clear()
        self.entries = tuple(entries)

    def undo(self) -> bool:
        """Take back the latest change; False if there is none."""
        return self._swap(self._before, self._undone)

    def redo(self) -> bool:
        """Take back the latest undo; False if there is none."""
        return self._swap(self._undone, self._before)

    def _swap(self, source: list[tuple[DraftEntry, ...]], target: list[tuple[DraftEntry, ...]]) -> bool:
        if not source:
            return False
        target.append(self.entries)
        self.entries = source.pop()
        return True

    def entries_of(self, text: str, name: str = ENTRY) -> list[DraftEntry]:
        """Return the statements of a whole mission, each with the comments above it. Raises MissionError."""
        source = Source(text, name)
        mission = read_mission(source, self.vocabulary, self._parser, errors_of=errors_of).mission
        compile_mission(mission, self.vocabulary, needs_command=False)
        body = mission.body
        commands = [] if body is None else [body]
        if isinstance(body, Chain) and body.operator == "sequence":
            commands = parts(body)
        groups: list[list[Ast]] = []  # those that share a line, or a head with the block below it
        margins = [len(line) - len(line.lstrip()) for line in text.split("\n")]
        first = last = 0
        for statement in sorted(
            (*commands, *mission.includes, *mission.definitions, *mission.facts), key=lambda part: part.span.start
        ):
            line = source.position(statement.span.start)[0]
            if line > last and not (groups and margins[line - 1] > margins[first - 1]):
                groups.append([])
                first = line
            groups[-1].append(statement)
            last = source.position(statement.span.end)[0]
        entries = []
        begin = 0
        for group in groups:
            below = source.position(group[-1].span.end)[0] + 1
            end = source.offset(below) if group is not groups[-1] else len(text)
            own = tuple((d.name, d.span.text) for d in group if isinstance(d, Definition | Fact | Include))
            entries.append(DraftEntry(text[begin:end].strip("\n"), own, len(own) < len(group)))
            begin = end
        return entries

    def _mission(self, tree: Tree, program: Program, warnings: Sequence[Diagnostic]) -> Mission:
        facts = tuple(all_facts(program))
        return Mission(tree, self.vocabulary, self.world, tuple(warnings), program, facts)
