"""Nodes that are said by their ids: `do "OpenGripper" called "first" with width 0.05`, `do recovery node:`.

What is in quotes is kept as it stands; several quoted texts, `newline` and `character 9` behind each other make one.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import takewhile

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.token import NodeCall
from btlang.text.source import Span
from btlang.text.spelling import respellings
from btlang.text.words import END_OF_STATEMENT, END_OF_TEXT, Words, statements
from btlang.tree.catalogue import SUBTREE
from btlang.vocabulary.entry import Meaning
from btlang.vocabulary.lexicon import Lexicon

_MOST_WORDS = 12  # of the name of a port
_IDENTIFIER = re.compile(r"(?=\w*_|\w+[A-Z])[A-Za-z_]\w*", re.ASCII)  # `maxSpeed`, `_skipIf`: no word of English
_BEHIND_ID = (END_OF_TEXT, END_OF_STATEMENT, ":", ",", "(", ")")


class Unreadable(Exception):
    """The words at which it cannot go on, and what should stand there."""

    def __init__(self, at: int, wanted: str) -> None:
        super().__init__(wanted)
        self.at = at
        self.wanted = wanted


def read_node(text: Words, at: int, meaning: Meaning, vocabulary: Lexicon) -> tuple[NodeCall, int] | None:
    """The node whose head (`do`, or `do` and the words of a node) ends before a word, and where it ends.

    None where no id follows the head, so that these are words like any other. Raises Unreadable.
    """
    reader = _Reader(text, vocabulary)
    node_id = meaning.node
    ports: list[tuple[str, str]] = []
    if not node_id:
        found = reader.quoted(at)
        if found is None:
            return None
        node_id, at = found
    elif node_id == SUBTREE:
        found = reader.quoted(at)
        if found is None:
            raise Unreadable(at, "the name of the subtree in quotes")
        name, at = found
        ports.append(("ID", name))
    name = ""
    called = reader.word("called", at)
    if called:
        name, at = reader.text(called)
    while following := reader.word("with", at):
        key, value_at = reader.key(following)
        if any(key == known for known, _ in ports):
            raise Unreadable(following, f"another port than {key}")
        value, at = reader.text(value_at)
        ports.append((key, value))
    return NodeCall(node_id, tuple(ports), name), at


def find_main_names(text: Words, vocabulary: Lexicon) -> Iterator[tuple[str, int, int]]:
    """The names that a text gives to its tree, each with the words `first` to `last` (exclusive) of its statement."""
    phrases = [
        [word for word in phrase.split() if word not in vocabulary.articles] for phrase in vocabulary.roles["main_name"]
    ]
    holding = {phrase[-1] for phrase in phrases}
    if holding.isdisjoint(text.distinct):
        return
    reader = _Reader(text, vocabulary)
    for _, first, last in statements(text, holding):
        for phrase in phrases:
            at = first + len(phrase)
            found = reader.quoted(at) if text.words[first:at] == phrase else None
            if found is not None and found[1] == last:
                yield found[0], first, last
                break


def unreadable(text: Words, at: int, problem: Unreadable) -> Diagnostic:
    """BT141 for a node that starts at a word."""
    words = text.span(at, max(problem.at, at + 1))
    last = text.words[problem.at]
    place = words if last in ("\n", ";") else Span(text.source, words.start, text.ends[problem.at])
    return diagnostic("BT141", place, words=words.text, wanted=problem.wanted)


def misread_node(text: Words, at: int, vocabulary: Lexicon) -> tuple[Span, list[str]] | None:
    """For a `do` or `test` without a node: the words that look like one, and how it may have been meant.

    None where they look like words of a command: `do the dishes`.
    """
    words, reader = text.words, _Reader(text, vocabulary)
    last = at + 1
    while words[last] not in _BEHIND_ID and not reader.word("called", last) and not reader.word("with", last):
        last += 1
    head = text.span(at, at + 1)
    with_articles = text.source.text[head.end : text.starts[last]].rstrip()
    written = with_articles.lstrip()
    slips = [f"{head.text} {name}" for name in respellings(written.lower(), vocabulary.nodes.values())]
    has_port = reader.word("with", last) and any(word[0] in '"{-' or word[0].isdigit() for word in _rest(words, last))
    is_meant = slips or words[last] == ":" or reader.word("called", last) or has_port or written != written.lower()
    if not written or '"' in written or not is_meant:
        return None
    return Span(text.source, head.start, head.end + len(with_articles)), [*slips, f'{head.text} "{written}"']


def _rest(words: Sequence[str], at: int) -> Iterator[str]:
    """Up to the end of the statement."""
    return takewhile(lambda word: word not in _BEHIND_ID, words[at:])


class _Reader:
    def __init__(self, text: Words, vocabulary: Lexicon) -> None:
        self._text = text
        self._vocabulary = vocabulary

    def word(self, role: str, at: int) -> int:
        """Where the words of a role end that begin at a word; 0 where there are none."""
        for phrase in self._vocabulary.roles[role]:
            words = phrase.split()
            if self._text.words[at : at + len(words)] == words:
                return at + len(words)
        return 0

    def key(self, at: int) -> tuple[str, int]:
        """The name of a port, in quotes or as words: `number of retries`; and where its text begins."""
        words = self._text.words
        if words[at][0] == '"' and len(words[at]) > 1:
            return words[at][1:], at + 1
        written = self._written(at, at + 1)
        if _IDENTIFIER.fullmatch(written):
            return written, at + 1
        last = at
        while last < at + _MOST_WORDS and words[last][0].isalpha() and (last == at or not self._is_text(last)):
            last += 1
        if last == at:
            raise Unreadable(at, "the name of a port, in words or in quotes,")
        return "_".join(words[at:last]), last

    def text(self, at: int) -> tuple[str, int]:
        """A text in quotes, a number or `{key}`."""
        words = self._text.words
        found = self.quoted(at)
        if found is not None:
            return found
        if words[at][0].isdigit() or words[at][0] == "-":
            return self._written(at, at + 1), at + 1
        if words[at] == "{" and words[at + 2] == "}":
            return self._written(at, at + 3), at + 3
        raise Unreadable(at, "a text in quotes, a number or {name}")

    def quoted(self, at: int) -> tuple[str, int] | None:
        """Pieces in quotes, new lines and characters; None where there is none."""
        parts: list[str] = []
        while (found := self._piece(at)) is not None:
            parts.append(found[0])
            at = found[1]
        return ("".join(parts), at) if parts else None

    def _piece(self, at: int) -> tuple[str, int] | None:
        words = self._text.words
        if words[at][0] == '"':
            return words[at][1:], at + 1
        end = self.word("newline", at)
        if end:
            return "\n", end
        end = self.word("character", at)
        if end and words[end].isdigit() and int(words[end]) < 0x110000:
            return chr(int(words[end])), end + 1
        return None

    def _is_text(self, at: int) -> bool:
        return self._piece(at) is not None

    def _written(self, first: int, last: int) -> str:
        return self._text.source.text[self._text.starts[first] : self._text.ends[last - 1]]
