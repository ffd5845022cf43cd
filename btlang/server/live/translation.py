"""The words of nodes in messages of robots, in another language than that of the missions."""

from __future__ import annotations

from btlang.printer.node_words import words_in
from btlang.tree.node import Node
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.load import load_vocabulary
from btlang.vocabulary.shipped import ENGLISH, languages

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def translate(message: dict[str, Any], language: str) -> dict[str, Any]:
    """Return a message with the words of its nodes in a language, the same message if it has none to translate.

    A language without a vocabulary and words without a translation change nothing, nor does a broken message.
    """
    if language not in languages() or message.get("language", ENGLISH) == language:
        return message
    vocabulary = load_vocabulary((), None, language)
    try:
        if message["type"] == "run":
            return {**message, "nodes": _nodes(message["nodes"], set(message["named"]), vocabulary)}
        if message.get("words"):
            return {**message, "words": [_worded(each, vocabulary) for each in message["words"]]}
    except (AttributeError, IndexError, KeyError, TypeError, ValueError):  # a robot elsewhere may send anything
        pass
    return message


def _nodes(listed: list[Any], named: set[int], vocabulary: Lexicon) -> list[Any]:
    """Translate the nodes of a run, from the last one, as what a node says may depend on those below it."""
    made: dict[str, list[Node]] = {}
    found = []
    for index in range(len(listed) - 1, -1, -1):
        path, node_id, words, ports = listed[index]
        node = Node(node_id, tuple(reversed(made.pop(path, ()))), tuple(ports.items()))
        made.setdefault(path.rpartition("/")[0] or "/", []).append(node)
        said = "" if index in named else words_in(node, vocabulary)
        found.append([path, node_id, said or words, ports])
    return found[::-1]


def _worded(valued: list[Any], vocabulary: Lexicon) -> list[Any]:
    index, words, node_id, ports = valued
    return [index, words_in(Node(node_id, (), tuple(ports.items())), vocabulary) or words, node_id, ports]
