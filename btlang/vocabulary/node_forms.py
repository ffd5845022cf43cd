"""Forms that say a node with the children below it: `at most 2.0 times a second:`; and what says ports of all nodes:
`unless "x > 1"`.
"""

from __future__ import annotations

import re
from functools import lru_cache

from btlang.support.record import Record
from btlang.text.source import Source
from btlang.text.words import split
from btlang.vocabulary.lexicon import Lexicon

_PORT = re.compile(r"\s*\{(\w+)(?:=([^{}]*))?\}")


class NodeDetail(Record):
    """The words that say a port of any node, and its text, None if that follows in quotes."""

    port: str
    said: str
    words: tuple[str, ...]
    value: str | None = None


class NodeForm(Record):
    """The words around a port, as they are written and as a text has them: without articles.

    `port` is "" if the node is said without one. If it has a `value`, that isn't said.
    """

    id: str
    pattern: str
    before: tuple[str, ...]
    port: str = ""
    value: str | None = None
    after: tuple[str, ...] = ()

    def say(self, value: str) -> str:
        """Return the form with this value of its port, as it is written."""
        text = self.pattern if self.value is None else _PORT.sub("", self.pattern)
        return text.replace(f"{{{self.port}}}", value)


@lru_cache(maxsize=8)
def node_details(vocabulary: Lexicon) -> dict[str, list[NodeDetail]]:
    """What says ports of all nodes, by the first words."""
    found: dict[str, list[NodeDetail]] = {}
    for port, pattern in vocabulary.node_details.items():
        said, _, value = pattern.rstrip("}").partition(" {=")
        words = _words(said, vocabulary)
        found.setdefault(words[0], []).append(NodeDetail(port, said, words, value or None))
    return found


@lru_cache(maxsize=8)
def node_forms(vocabulary: Lexicon) -> tuple[NodeForm, ...]:
    """All forms; of one node those first that say a value without naming it."""
    return tuple(_form(each, text, vocabulary) for each, texts in vocabulary.node_forms.items() for text in texts)


@lru_cache(maxsize=8)
def node_forms_by_start(vocabulary: Lexicon) -> dict[str, list[NodeForm]]:
    """The forms by their first words."""
    found: dict[str, list[NodeForm]] = {}
    for form in node_forms(vocabulary):
        if not form.before:  # all of them are articles
            continue
        found.setdefault(form.before[0], []).append(form)
    return found


def _form(node_id: str, pattern: str, vocabulary: Lexicon) -> NodeForm:
    slot = _PORT.search(pattern)
    if slot is None:
        return NodeForm(node_id, pattern, _words(pattern, vocabulary))
    before, after = _words(pattern[: slot.start()], vocabulary), _words(pattern[slot.end() :], vocabulary)
    return NodeForm(node_id, pattern, before, slot[1], slot[2], after)


def _words(text: str, vocabulary: Lexicon) -> tuple[str, ...]:
    words = split(Source(text), vocabulary.orthography).words
    return tuple(word for word in words if word.strip())
