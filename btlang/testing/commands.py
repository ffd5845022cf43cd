"""Finds the commands and conditions of a mission that a test names in quotes: `"go to the lab"`, `"grasp"`."""

from __future__ import annotations

from btlang.api import Mission
from btlang.support.record import Record
from btlang.text.source import Source
from btlang.text.words import split
from btlang.tree.catalogue import SUBTREE
from btlang.tree.node import Node
from btlang.vocabulary.pattern import Slot, forms
from btlang.vocabulary.trie import longest


class Command(Record):
    """Nodes of a mission: those with one of these ids and, where the words say them, these values of ports.

    With `is_denied` the words say the opposite of a condition: `nobody is near`.
    """

    ids: frozenset[str]
    ports: tuple[tuple[str, str], ...] = ()
    is_denied: bool = False

    def matches(self, node: Node) -> bool:
        """Whether a node, with its values filled in, is meant."""
        return node.id in self.ids and all(node.port(name) == text for name, text in self.ports)


def find_command(text: str, mission: Mission) -> Command | None:
    """What the words name: a definition of the mission, a whole command, or the first words of commands.

    None where the mission has no such command.
    """
    vocabulary = mission.vocabulary.with_places(tuple(fact.name for fact in mission.facts))
    words = split(Source(text), vocabulary.orthography)
    wanted = words.words[:-2]
    if not wanted:
        return None
    name = " ".join(wanted)
    for known, _ in mission.tree.subtrees:
        if known.lower() == name:
            return Command(frozenset((SUBTREE,)), (("ID", known),))
    match = longest(vocabulary.trie, words, 0, vocabulary.context)
    if match is not None and match.last == len(wanted) and match.meaning.entry is not None:
        ports = tuple((value.name, value.text) for value in match.values)
        is_denied = match.meaning.role == "negated"
        return _if_there(Command(frozenset((match.meaning.entry.id,)), ports, is_denied), mission)
    entries = [entry for same in vocabulary.entries.values() for entry in same]
    ids = {entry.id for entry in entries if _begins(entry.phrases, wanted, vocabulary.articles)}
    ids |= {id for id in vocabulary.entries if id.lower() == "".join(wanted)}
    return _if_there(Command(frozenset(ids)), mission)


def _begins(phrases: tuple[str, ...], wanted: list[str], articles: frozenset[str]) -> bool:
    """Whether a way to say one of the phrases begins with these words."""
    for phrase in phrases:
        for form in forms(phrase, articles):
            first = form[: len(wanted)]
            if len(first) == len(wanted) and not any(isinstance(part, Slot) for part in first) and [*first] == wanted:
                return True
    return False


def _if_there(command: Command, mission: Mission) -> Command | None:
    """The values that the mission takes from its blackboard are only known while it runs."""
    for node in mission.tree.walk():
        ports = tuple((name, text) for name, text in command.ports if not node.port(name).startswith("{"))
        if node.id in command.ids and command.replace(ports=ports).matches(node):
            return command
    return None
