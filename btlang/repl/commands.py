"""The words of the REPL itself: what is done with a mission, and not by the robot."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from shutil import get_terminal_size

from btlang.diagnostics.diagnostic import MissionError
from btlang.diagnostics.files import read_source, unwritable
from btlang.frontends.mission.symbols.definitions import find_definitions
from btlang.frontends.mission.symbols.phrases import Phrases
from btlang.repl.draft import DraftEntry, MissionDraft
from btlang.repl.store import DraftStore
from btlang.robots.robot import Robot, RobotError
from btlang.robots.worlds.name_listing import list_words
from btlang.robots.worlds.world import said
from btlang.support.record import Record
from btlang.text.formatting import TextTable
from btlang.text.output import can_draw, listing_width
from btlang.text.source import Source
from btlang.text.words import split
from btlang.vocabulary.listing import help_on, overview
from btlang.vocabulary.trie import longest

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_MARK = ":"  # before a word of the REPL that a mission knows too

_FIRST = """\
A line of the mission runs at once, and is kept: move forward 1 m
A definition is only kept: patrol is go to the lobby then go to the lab
A line that ends in ':' opens a block, and an empty line closes it.
"""
_MORE = f"""
'words' lists what you can say by topic, 'help wave' explains a phrase or word.
'help files' or 'help save' explains these, 'help keys' keys such as Ctrl-D.
If your mission uses one of these words too, add a colon for this one: {_MARK}show"""
_KEYS = (
    ("Tab", "takes the suggestion"),
    ("Ctrl-F", "corrects the mistake"),
    ("Up", "earlier lines"),
    ("Ctrl-C", "stops the robot, or clears the line"),
    ("Ctrl-D", "twice: leaves"),
    ("Space", "pauses the mission that runs, and resumes it; while it is paused, s takes a single step"),
    ("Ctrl-\\", "emergency stop"),
)


class Leave(Exception):
    """The user wants to leave the REPL."""


class ReplCommand(Record):
    """One word of the REPL; `topic`, `arguments` and `help` are for people, `aliases` mean the same."""

    topic: str
    name: str
    arguments: str
    help: str
    aliases: tuple[str, ...] = ()


COMMANDS = (
    ReplCommand("mission", "show", "[NAME|tree]", "shows the mission, one definition, or the tree of all"),
    ReplCommand("mission", "names", "", "lists what is defined"),
    ReplCommand("mission", "run", "", "runs the whole mission from where the robot is; `reset` first for a new world"),
    ReplCommand("mission", "undo", "", "takes back the last line"),
    ReplCommand("mission", "redo", "", "takes back an undo"),
    ReplCommand("mission", "new", "", "starts an empty mission; `undo` brings the current one back"),
    ReplCommand("files", "save", "[over] FILE", "writes the mission to a file; `over` replaces another file"),
    ReplCommand("files", "load", "FILE", "continues with the mission in a file; `undo` brings the current one back"),
    ReplCommand("files", "restore", "", "brings back the last session"),
    ReplCommand("robot", "world", "[FILE]", "shows the world and the robot in it, or changes the world"),
    ReplCommand("robot", "reset", "", "resets the world"),
    ReplCommand("robot", "speed", "[real|max|FACTOR]", "how fast time passes when the robot moves"),
    ReplCommand("prompt", "help", "[PHRASE]", "explains a phrase or word, or the prompt itself"),
    ReplCommand("prompt", "words", "[TOPIC|WORD|--all]", "lists what you can say: the topics, one topic, or a word"),
    ReplCommand("prompt", "clear", "", "clears the screen; the mission stays"),
    ReplCommand("prompt", "quit", "", "leaves, like Ctrl-D twice", ("exit", "bye")),
)
_NAMES = {name: command for command in COMMANDS for name in (command.name, *command.aliases)}
_TOPICS = tuple(dict.fromkeys(command.topic for command in COMMANDS))


def command_of(text: str, draft: MissionDraft) -> tuple[str, str] | None:
    """Return the word of the REPL that a line begins with, and the rest; None where the line belongs to the mission.

    A word that the mission knows, as a phrase or as a name that is defined or being defined, is the mission's; but
    `show tree` shows the tree, although the robot could print it.
    """
    line = text.strip()
    name, _, rest = line.partition(" ")
    if name.startswith(_MARK):
        return _own(name[1:]), rest.strip()
    if "\n" in line or name.lower() not in _NAMES:
        return None
    if name.lower() == "show" and (rest in ("", "tree") or rest.lower() in draft.definitions):
        return "show", rest
    source = Source(f"{draft.context()}{line}")
    words = split(source, draft.vocabulary.orthography)
    definitions = find_definitions(Phrases(words, draft.vocabulary))
    at = words.lines[-1].first
    known = (longest(trie, words, at, draft.vocabulary.context) for trie in (draft.vocabulary.trie, definitions.trie))
    return None if any(known) else (_own(name), rest.strip())


def _own(word: str) -> str:
    """Return the command that a word means; the word itself if there's none."""
    name = word.lower()
    return _NAMES[name].name if name in _NAMES else name


def near_command(text: str) -> str:
    """Return the word of the REPL that a line may have misspelt, "" if there's none."""
    from btlang.text.spelling import respellings

    return next((word for word in respellings(text.strip().lower(), _NAMES) if word in _NAMES), "")


def is_begun(text: str) -> bool:
    """Return whether the text may become a word of the REPL."""
    return any(name.startswith(text.lower()) for name in _NAMES)


class ReplCommands:
    """The commands of the REPL. `write` gets what `show` takes, `run` runs the whole mission."""

    def __init__(
        self,
        draft: MissionDraft,
        write: Callable[[Any], object],
        run: Callable[[], object],
        store: DraftStore | None = None,
    ) -> None:
        self._draft = draft
        self._write = write
        self._run_all = run
        self._store = store
        self.speed: float | str = "real"
        self.saved = draft.text
        """The mission as some file has it."""
        self.draft = ""
        """The text that the next line begins with."""
        self.clear_screen: Callable[[], object] = lambda: None

    @property
    def is_saved(self) -> bool:
        """Return whether nothing would be lost."""
        return self._draft.text in ("", self.saved)

    def do(self, name: str, rest: str) -> None:
        """Raise MissionError where a file or text is wrong, Leave where the user wants to leave."""
        command = getattr(self, f"_{name}", None) if name in _NAMES else None
        if command is None:
            self._write(f"There's no '{name}' here; 'help' lists what there is.")
        elif rest and not _NAMES[name].arguments:
            self._write(f"'{name}' takes no words after it.")
        else:
            command(rest)

    def _help(self, rest: str) -> None:
        if not rest:
            self._write(_FIRST)
            rows = ((topic, ", ".join(c.name for c in COMMANDS if c.topic == topic)) for topic in _TOPICS)
            self._write(TextTable(tuple(rows), indent=2))
            self._write(_MORE)
        elif rest == "keys":
            self._write(TextTable(_KEYS, indent=2))
        elif rest in _TOPICS:
            self._write(TextTable(tuple((_usage(c), c.help) for c in COMMANDS if c.topic == rest), indent=2))
        elif rest in _NAMES:
            self._write(f"{_usage(_NAMES[rest])}: {_NAMES[rest].help}")
        else:
            self._write("\n".join(help_on(self._draft.vocabulary, rest, listing_width())))

    def _words(self, rest: str) -> None:
        vocabulary, width = self._draft.vocabulary, listing_width()
        if rest:
            self._write("\n".join(list_words(vocabulary, rest.removeprefix("--all"), width, "words")))
        else:
            self._write("\n".join(overview(vocabulary, width, "words")))

    def _show(self, rest: str) -> None:
        draft = self._draft
        if not draft.entries:
            self._write("There is nothing yet: type a command, such as: move forward 1 m")
        elif rest == "tree":
            self._write(draft.compile_all())
        elif rest:
            name = " ".join(rest.lower().split())
            if name not in draft.definitions:
                known = ", ".join(draft.definitions) or "none yet"
                self._write(f"There's no definition '{rest}'; there are: {known}.")
                return
            definition = draft.definitions[name]
            self._write(definition)
            self._write(draft.compile(definition).outline())
        else:
            self._write(draft.text.rstrip("\n"))

    def _names(self, rest: str) -> None:
        self._write(
            "\n".join(self._draft.definitions.values())
            or "Nothing is defined yet. For example: patrol is go to the lobby"
        )

    def _run(self, rest: str) -> None:
        self._run_all()

    def _undo(self, rest: str) -> None:
        before = self._draft.entries
        if not self._draft.undo():
            self._write("There's nothing to undo.")
            return
        self._write_change(before, "The robot stays where it is.")

    def _redo(self, rest: str) -> None:
        before = self._draft.entries
        if not self._draft.redo():
            self._write("There's nothing to redo.")
            return
        self._write_change(before, "")

    def _write_change(self, before: tuple[DraftEntry, ...], note: str) -> None:
        now = self._draft.entries
        gone = [entry.text for entry in before if entry not in now]
        come = [entry.text for entry in now if entry not in before]
        lines = [f"- {line}" for text in gone for line in text.splitlines()]
        lines += [f"+ {line}" for text in come for line in text.splitlines()]
        self._write("\n".join([*lines, note] if note else lines))

    def _save(self, rest: str) -> None:
        draft = self._draft
        over = rest.startswith("over ")
        path = rest.removeprefix("over ").strip() or draft.file
        if not path:
            self._write("Save to which file? save mission.txt")
            return
        if os.path.exists(path) and path != draft.file and not over:
            self._write(f"{path} exists already. To replace it: save over {path}")
            return
        try:
            with open(path, "w", encoding="utf-8", errors="surrogateescape") as file:
                file.write(draft.text)
        except OSError as error:
            raise MissionError([unwritable(path, error)]) from None
        draft.file, self.saved = path, draft.text
        self._write(f"Saved {_lines(draft.text)} to {path}.")

    def _load(self, rest: str) -> None:
        if not rest:
            self._write("Load which file? load mission.txt")
            return
        source = read_source(rest)
        self._draft.load(source)
        self._draft.file, self.saved = rest, self._draft.text
        self._write(f"Loaded {_lines(source.text)} from {rest}. 'run' runs the mission, 'show' shows it.")

    def _new(self, rest: str) -> None:
        self._draft.change(())
        self._draft.file = None
        self._write("A new mission. 'undo' brings the last one back.")

    def _restore(self, rest: str) -> None:
        left = self._store.left() if self._store is not None else None
        if left is None or self._store is None:
            self._write("There's no earlier session.")
            return
        if left.world is not None and left.world != self._draft.world:
            self._world(left.world)
        entries = self._draft.entries_of("\n".join(left.entries)) if left.entries else []
        self._draft.change((*self._draft.entries, *entries))
        self.draft = left.draft
        self._store.done_with(left)
        self._write(f"Back: {_lines(self._draft.text)}. 'run' runs the mission, 'show' shows it.")

    def _world(self, rest: str) -> None:
        draft = self._draft
        rest = rest.strip('"')  # as a mission names its world
        if rest:
            before = draft.world, draft.vocabulary, draft.session
            draft.use_world(rest)
            try:
                draft.entries_of(draft.text, draft.file or "<session>") if draft.entries else None
            except MissionError:
                draft.close()
                draft.world, draft.vocabulary, draft.session = before
                raise
            before[2].close()
        self.show_map()
        names = draft.session.world.names
        kinds = (("places", names.places), ("people", names.people), ("objects", names.objects))
        known = ((kind, ", ".join(those)) for kind, those in kinds if those)
        self._write(TextTable((("world", draft.world or "the one that ships"), *known), widths=(7,), gap=1))
        self._write(robot_line(draft))

    def show_map(self) -> None:
        """Draw the world and the robot in it, if the output is a terminal with room for it."""
        if not can_draw(sys.stdout):
            return
        from btlang.repl.welcome import world_map

        size = get_terminal_size()
        drawn = world_map(self._draft, size.columns, size.lines)
        if drawn is not None:
            self._write(drawn)

    def _reset(self, rest: str) -> None:
        self._draft.reset()
        self._write(robot_line(self._draft))

    def _speed(self, rest: str) -> None:
        from btlang.run.limits import SLOWEST

        if not self._draft.is_simulated:
            self._write("This robot runs in real time.")
            return
        if rest in ("real", "max"):
            self.speed = rest
        elif rest:
            try:
                factor = float(rest)
            except ValueError:
                factor = 0.0
            if not SLOWEST <= factor <= 1e6:
                self._write("The speed is real, max, or a factor such as 5.")
                return
            self.speed = factor
        self._write(f"The speed is {self.speed if isinstance(self.speed, str) else f'{self.speed:g} times real time'}.")

    def _clear(self, rest: str) -> None:
        self.clear_screen()

    def _quit(self, rest: str) -> None:
        raise Leave


def robot_line(draft: MissionDraft) -> str:
    """Return where the robot is and how it is."""
    try:
        return _robot_line(draft.session.robot)
    except RobotError as problem:  # a robot over ROS 2 that is silent
        return f"where the robot is isn't known: {problem}"


def _robot_line(robot: Robot) -> str:
    held = [said(name) for hand in ("left", "right") if (name := robot.holding(hand))]
    parts = [
        f"robot at ({robot.pose.x:.1f}, {robot.pose.y:.1f}) facing {robot.pose.heading:.0f}\N{DEGREE SIGN}",
        f"battery {robot.battery:.0f}%",
        *(["docked"] if robot.docked else []),
        *([f"holds {' and '.join(held)}"] if held else []),
    ]
    return ", ".join(parts)


def _usage(command: ReplCommand) -> str:
    return f"{', '.join((command.name, *command.aliases))} {command.arguments}".rstrip()


def _lines(text: str) -> str:
    count = len(text.splitlines())
    return f"{count} line{'' if count == 1 else 's'}"
