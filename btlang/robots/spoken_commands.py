"""What people may say to a mission: the answers that it asks about, and commands in its words."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

from btlang.backends.engine import bind_leaf
from btlang.diagnostics.diagnostic import MissionError
from btlang.frontends.table import read_text
from btlang.passes import errors_of, run_passes
from btlang.passes.compilation import Compilation
from btlang.robots.robot import RobotError
from btlang.speech.recogniser import Expected
from btlang.text.source import Source
from btlang.tree.node import Tree

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.robots.bodies.body import Body
    from btlang.vocabulary.entry import Entry
    from btlang.vocabulary.lexicon import Lexicon

_ASKS = "btlang.actions.conversation:answer_is"
_SHIPPED = "btlang.actions."
_NAMES = ("place", "object", "person")
_MOVES = ("base",)
_OPTION = re.compile(r"\[[^]]*\]")
_SLOT = re.compile(r"\{(\w+)\}")


def choices(tree: Tree, vocabulary: Lexicon) -> tuple[str, ...]:
    """Return the texts that answers are compared with, each once; not those that are only known during the run."""
    found: dict[str, None] = {}
    for node in tree.walk():
        if any(entry.call == _ASKS for entry in vocabulary.entries.get(node.id, ())):
            found.update((value, None) for name, value in node.ports if name == "text" and "{" not in value)
    return tuple(found)


class SpokenCommands:
    """The commands of a mission's words that may be spoken.

    These are the shipped ones that drive and need at most names. None of them opens a zone or a door, or uses an arm.
    """

    def __init__(self, vocabulary: Lexicon, body: Body) -> None:
        self._vocabulary, self._body = vocabulary, body

    def expected(self, robot: Any) -> Expected:
        """Return all that may be said, with the names that the robot knows now."""
        people, things = (tuple(robot.described(kind, {})) for kind in ("person", "object"))
        names = {"place": tuple(robot.place_names()), "object": things, "person": people}
        entries = (entry for each in self._vocabulary.entries.values() for entry in each if self._allows(entry))
        phrases = dict.fromkeys(phrase for entry in entries for phrase in _phrases(entry))
        return Expected(tuple(phrases), names)

    def read(self, text: str) -> Callable[..., Any]:
        """Return a function of a robot that does the command. Raises RobotError for a text that isn't one command."""
        source = Source(text, "what was said")
        try:
            read = read_text(source, vocabulary=self._vocabulary, parser="shunting-yard", errors_of=errors_of)
            if isinstance(read, Tree):
                raise RobotError("it isn't a command")
            tree = run_passes(Compilation(self._vocabulary, read.mission, warnings=read.warnings)).tree
        except MissionError as error:
            raise RobotError(error.diagnostics[0].message) from None
        nodes = list(tree.walk())
        entry = next(filter(self._allows, self._vocabulary.entries.get(nodes[0].id, ())), None)
        binding = bind_leaf(nodes[0].id, self._vocabulary) if entry is not None and len(nodes) == 1 else None
        if binding is None:
            raise RobotError("it isn't a command that may be spoken")
        texts = {**binding.defaults, **dict(nodes[0].ports)}
        values = {name: binding.converters[name](value) for name, value in texts.items()}
        return lambda robot: binding.call(robot, **values)

    def _allows(self, entry: Entry) -> bool:
        return (
            entry.sort == "action"
            and isinstance(entry.call, str)
            and entry.call.startswith(_SHIPPED)
            and entry.resources == _MOVES
            and all(map(self._body.has, entry.needs))
        )


def _phrases(entry: Entry) -> Iterator[str]:
    """Return phrases without the options that have values, and with articles, which the language leaves out."""
    types = {slot.name: slot.type for slot in entry.slots}
    for phrase in entry.phrases:
        plain = _OPTION.sub(lambda match: "" if "{" in match[0] else match[0], phrase)
        if "(" not in plain and all(types.get(name) in _NAMES for name in _SLOT.findall(plain)):
            yield _SLOT.sub(lambda match: f"[the] {{{types[match[1]]}}}", plain)
