"""Forms that say a node with the children below it: `at most 2.0 times a second:`; and what says ports of all nodes:
`unless "x > 1"`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import lru_cache

from btlang.support.record import Record
from btlang.text.source import Source
from btlang.text.words import split
from btlang.vocabulary.lexicon import Lexicon

_OPPOSITE = "!"
_COMPARISON = re.compile(r"(\w+\s*)([=!<>]=|[<>])(\s*(?:-?[\w.]+|'[^']*'))", re.ASCII)
_FLAG = re.compile(r"(!?)([A-Za-z_]\w*)", re.ASCII)
_OPPOSITES = {"==": "!=", "!=": "==", "<": ">=", ">=": "<", ">": "<=", "<=": ">"}
_PORT = re.compile(r"(\s*)\{(\w+)(?:=([^{}]*))?\}")


class NodeDetail(Record):
    """The words that say a port of any node, and its text, None if that follows in quotes.

    What follows the words of an `opposite` is the opposite of the script in the port.
    """

    port: str
    said: str
    words: tuple[str, ...]
    value: str | None = None
    opposite: bool = False


class FormPort(Record):
    """A port of a form. If it has a `value`, that isn't said."""

    name: str
    value: str | None = None


class NodeForm(Record):
    """The words and ports of a form, as it is written, and as `parts` of a text: without articles."""

    id: str
    pattern: str
    parts: tuple[str | FormPort, ...]

    @property
    def ports(self) -> tuple[FormPort, ...]:
        """Return the ports alone."""
        return tuple(part for part in self.parts if isinstance(part, FormPort))

    def say(self, values: Iterable[str]) -> str:
        """Return the form with the values of the ports that are said, as it is written."""
        left = iter(values)
        return _PORT.sub(lambda port: "" if port[3] is not None else port[1] + next(left), self.pattern)


@lru_cache(maxsize=8)
def node_details(vocabulary: Lexicon) -> dict[str, list[NodeDetail]]:
    """What says ports of all nodes, by the first words."""
    found: dict[str, list[NodeDetail]] = {}
    for port, pattern in vocabulary.node_details.items():
        said, _, value = pattern.rstrip("}").partition(" {=")
        words = _words(said, vocabulary)
        detail = NodeDetail(port.lstrip(_OPPOSITE), said, words, value or None, port[:1] == _OPPOSITE)
        found.setdefault(words[0], []).append(detail)
    return found


def opposite_script(script: str) -> str | None:
    """Return the script that is true where a simple one is false, and the other way round: `x != 6` for `x == 6`."""
    compared = _COMPARISON.fullmatch(script)
    if compared is not None:
        return f"{compared[1]}{_OPPOSITES[compared[2]]}{compared[3]}"
    flag = _FLAG.fullmatch(script)
    return (flag[2] if flag[1] else f"!{flag[2]}") if flag is not None else None


def is_negative(script: str) -> bool:
    """Whether a simple script says what isn't: `x != 6`, `!done`."""
    return opposite_script(script) is not None and "!" in script


@lru_cache(maxsize=8)
def node_forms(vocabulary: Lexicon) -> tuple[NodeForm, ...]:
    """All forms; of one node those first that say a value without naming it."""
    return tuple(_form(each, text, vocabulary) for each, texts in vocabulary.node_forms.items() for text in texts)


@lru_cache(maxsize=8)
def node_forms_by_start(vocabulary: Lexicon) -> dict[str, list[NodeForm]]:
    """The forms by their first words."""
    found: dict[str, list[NodeForm]] = {}
    for form in node_forms(vocabulary):
        if form.parts and isinstance(form.parts[0], str):  # else all of them are articles
            found.setdefault(form.parts[0], []).append(form)
    return found


def _form(node_id: str, pattern: str, vocabulary: Lexicon) -> NodeForm:
    parts: list[str | FormPort] = []
    at = 0
    for slot in _PORT.finditer(pattern):
        parts += (*_words(pattern[at : slot.start()], vocabulary), FormPort(slot[2], slot[3]))
        at = slot.end()
    return NodeForm(node_id, pattern, (*parts, *_words(pattern[at:], vocabulary)))


def _words(text: str, vocabulary: Lexicon) -> tuple[str, ...]:
    words = split(Source(text), vocabulary.orthography).words
    return tuple(word for word in words if word.strip())
