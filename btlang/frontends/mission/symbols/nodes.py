"""Nodes that are said by their ids: `do open gripper called "first" with width 0.05, speed 2`, `do recovery node:`.

What is in quotes is kept as it stands; several quoted texts, `newline` and `character 9` behind each other make one.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import takewhile

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.token import NodeCall
from btlang.text.source import Span
from btlang.text.spelling import respellings
from btlang.text.words import END_OF_STATEMENT, END_OF_TEXT, Words, statements
from btlang.tree.catalogue import SEQUENCE, SUBTREE, only_port
from btlang.vocabulary.entry import Meaning
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.node_forms import NodeForm, node_details, node_forms, node_forms_by_start, opposite_script
from btlang.vocabulary.node_words import bare_id, ends_id, is_port, is_tree_name, read_id, role_end, subtree_named
from btlang.vocabulary.trie import TrieNode

_MOST_WORDS = 12  # of the name of a port
_IDENTIFIER = re.compile(r"(?=\w*_|\w+[A-Z])[A-Za-z_]\w*", re.ASCII)  # `maxSpeed`, `_skipIf`: no word of English
_NUMBER = re.compile(r"\{\w+\}|\d+(?:\.\d+)?")
_BEHIND_ID = (END_OF_TEXT, END_OF_STATEMENT, ":", ",", "(", ")")


class Unreadable(Exception):
    """The words at which it cannot go on, and what should stand there."""

    def __init__(self, at: int, wanted: str) -> None:
        super().__init__(wanted)
        self.at = at
        self.wanted = wanted


class GivenTwice(Unreadable):
    """A port that has a value already."""


def read_node(
    text: Words,
    at: int,
    meaning: Meaning,
    vocabulary: Lexicon,
    subtrees: Collection[str] = (),
    names: TrieNode | None = None,
    *,
    in_words: bool = True,
) -> tuple[NodeCall, int] | None:
    """The node whose head (`do`, or `do` and the words of a node) ends before a word, and where it ends.

    `subtrees` are those with a name in quotes, `names` the others. None where no id follows the head, so that these
    are words like any other; so they are without `in_words` where the id is not in quotes. Raises Unreadable.
    """
    reader = _Reader(text, vocabulary, names)
    node_id, ports, is_named = meaning.node, dict[str, str](), False
    if not node_id:
        found = reader.id(at)
        if found is None or (found[2] == "words" and not in_words):
            return None
        node_id, at, way = found
        is_named = meaning.role == "do" and way != "node"
        if is_named and not way and is_tree_name(node_id, vocabulary) and node_id not in subtrees:
            call, end = _details(reader, at, SUBTREE, {"ID": node_id})
            return (call, end) if text.words[end] != ":" else _details(reader, at, node_id, ports)
        subtree = subtree_named(node_id, subtrees, in_words=way == "words") if is_named else ""
        if subtree:
            node_id, ports["ID"] = SUBTREE, subtree
    elif port := only_port(node_id):
        quoted = reader.quoted(at)
        if quoted is None and node_id == SUBTREE:
            raise Unreadable(at, "the name of the subtree in quotes")
        if quoted is not None:
            ports[port], at = quoted
    return _details(reader, at, node_id, ports)


def read_form(text: Words, at: int, vocabulary: Lexicon, names: TrieNode | None = None) -> tuple[NodeCall, int] | None:
    """A node that is said with the children below it, and where it ends: by a form such as `at most 2 times a second:`,
    with a name before it, or, if it is a sequence, by its name alone: `"say hello":`. None for other words.
    """
    reader, words, name = _Reader(text, vocabulary, names), text.words, ""
    if words[at][0] == '"':
        name, at = reader.text(at)
        if words[at] == ":" and words[at + 1] in (END_OF_STATEMENT, END_OF_TEXT):
            return NodeCall(SEQUENCE, (), name), at
        if words[at] != ",":
            return None
        at += 1
    for form in node_forms_by_start(vocabulary).get(words[at], ()):
        try:
            found = reader.form(at, form)
            call, end = _details(reader, found[1], form.id, found[0]) if found is not None else (None, at)
        except Unreadable:
            continue
        if call is not None and words[end] == ":" and not (name and call.name):
            return call.replace(name=name or call.name), end
    return None


def read_label(text: Words, at: int, vocabulary: Lexicon) -> tuple[str, int] | None:
    """The name in quotes that stands before a node: `"first try": go to the lab`; and where the node begins.

    A comma is behind it only before a block, `"first try", retry twice:`, as `"hello", then wave` lacks a command.
    """
    name, end = _Reader(text, vocabulary).text(at)
    last = next(place for place in range(end, len(text.words)) if text.words[place] in (END_OF_STATEMENT, END_OF_TEXT))
    is_block = text.words[end] == "," and text.words[last - 1] == ":"
    is_label = is_block or (text.words[end] == ":" and last > end + 1)
    return (name, end + 1) if is_label else None


def _details(reader: _Reader, at: int, node_id: str, ports: dict[str, str]) -> tuple[NodeCall, int]:
    """The node with what `called`, `with` and `giving` say of it."""
    name = ""
    called = reader.word("called", at)
    if called:
        name, at = reader.text(called)
    outputs, at = reader.ports(at, ports)
    return NodeCall(node_id, tuple(ports.items()), name, tuple(outputs)), at


def read_details(
    text: Words, at: int, taken: Mapping[str, str], vocabulary: Lexicon, names: TrieNode | None = None
) -> tuple[NodeCall, int] | None:
    """What is said behind a phrase that has the ports `taken`: `called "first" with speed 2`, and where it ends.

    It has no id. None where nothing of that kind follows, or it can't be read. Raises GivenTwice.
    """
    first = at
    try:
        call, at = _details(_Reader(text, vocabulary, names), at, "", dict(taken))
    except GivenTwice:
        raise
    except Unreadable:
        return None
    own = tuple((port, value) for port, value in call.ports if port not in taken)
    return (call.replace(ports=own), at) if at > first else None


def read_detail(text: Words, at: int, vocabulary: Lexicon) -> tuple[str, str, int] | None:
    """A port that all nodes may have and its text, in words of its own, `unless "x > 1"`, and where these end."""
    return _Reader(text, vocabulary).detail(at)


def outputs_at(text: Words, at: int, vocabulary: Lexicon) -> list[str]:
    """The keys to which the ports at a word give values: `giving {path}`."""
    ports: dict[str, str] = {}
    try:
        outputs, _ = _Reader(text, vocabulary).ports(at, ports)
    except Unreadable:
        return []
    return [ports[port][1:-1] for port in outputs if ports[port][:1] == "{"]


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


def misread_form(text: Words, at: int, vocabulary: Lexicon) -> tuple[Span, list[str]] | None:
    """For words behind which a `:` ends the line: the words that are like a form, and what may have been meant."""
    words, last = text.words, at
    while words[last] not in (END_OF_STATEMENT, END_OF_TEXT, ":"):
        last += 1
    if words[last] != ":" or last == at:
        return None
    span = text.span(at, last)
    values = _NUMBER.findall(span.text)
    forms = node_forms(vocabulary)
    said = [each.say(values) for each in forms if sum(port.value is None for port in each.ports) == len(values)]
    near = respellings(span.text.lower(), said)
    return (span, near) if near else None


def _rest(words: Sequence[str], at: int) -> Iterator[str]:
    """Up to the end of the statement."""
    return takewhile(lambda word: word not in _BEHIND_ID, words[at:])


class _Reader:
    def __init__(self, text: Words, vocabulary: Lexicon, names: TrieNode | None = None) -> None:
        self._text = text
        self._vocabulary = vocabulary
        self._names = names

    def word(self, role: str, at: int) -> int:
        """Where the words of a role end that begin at a word; 0 where there are none."""
        return role_end(self._text, at, (role,), self._vocabulary)

    def id(self, at: int) -> tuple[str, int, str] | None:
        """An id, where it ends, and whether it stands in "words", in quotes, "bare", or behind the word "node"."""
        behind = self.word("node", at)
        for way, found in (("", self.quoted(at)), ("node", self.quoted(behind) if behind else None)):
            if found is not None:
                return *found, way
        words = read_id(self._text, at, self._vocabulary)
        if words is not None:
            return *words, "words"
        bare = bare_id(self._text, at)
        return (bare, at + 1, "bare") if bare else None

    def form(self, at: int, form: NodeForm) -> tuple[dict[str, str], int] | None:
        """The ports that a form says, and where it ends; None for other words. Raises Unreadable."""
        ports: dict[str, str] = {}
        for part in form.parts:
            if isinstance(part, str):
                if self._text.words[at] != part:
                    return None
                at += 1
            elif part.value is not None:
                ports[part.name] = part.value
            else:
                ports[part.name], at = self.text(at)
        return ports, at

    def ports(self, at: int, ports: dict[str, str]) -> tuple[list[str], int]:
        """Reads `with width 0.05, speed 2 giving {path} unless "x > 1"` into `ports`; those behind `giving`, and where
        it ends.
        """
        outputs: list[str] = []
        begins = gives = False
        while True:
            detail = self.detail(at)
            if detail is not None:
                key, value, end = detail
                if key in ports:
                    raise GivenTwice(at, f"another port than {key}")
                ports[key], at, begins = value, end, False
                continue
            with_at, giving_at = self.word("with", at), self.word("giving", at)
            following = with_at or giving_at
            if not following:
                another = self._another(at) if begins else None
                if another is None:
                    return outputs, at
                following, key, value, at = another
            else:
                key, _, value, at = self.port(following)
            begins, gives = True, bool(giving_at) or (gives and not with_at)
            if key in ports:
                raise GivenTwice(following, f"another port than {key}")
            ports[key] = value
            outputs += [key] if gives else []

    def detail(self, at: int) -> tuple[str, str, int] | None:
        """A port that all nodes may have and its text, said in words of their own, and where that ends."""
        for detail in node_details(self._vocabulary).get(self._text.words[at], ()):
            end = at + len(detail.words)
            if tuple(self._text.words[at:end]) == detail.words:
                found = (detail.value, end) if detail.value is not None else self.quoted(end)
                text = opposite_script(found[0]) if found is not None and detail.opposite else found and found[0]
                if found is not None and text is not None:
                    return detail.port, text, found[1]
        return None

    def _another(self, at: int) -> tuple[int, str, str, int] | None:
        """Where a port begins behind a comma, its name and text, and where it ends; None where something else does."""
        if self._text.words[at] != ",":
            return None
        behind = self.word("with", at + 1)
        following = behind or at + 1
        try:
            key, value_at, value, end = self.port(following)
        except Unreadable:
            return None
        if value_at == following:  # `{limit} is more than 3` is a condition
            is_one = self._text.words[end] in _BEHIND_ID or ends_id(self._text, end, self._vocabulary)
        else:
            is_one = is_port(self._text, following, value_at, self._vocabulary, self._names)
        return (following, key, value, end) if behind or is_one else None

    def port(self, at: int) -> tuple[str, int, str, int]:
        """The name of a port, where its text begins, the text and where it ends; `{path}` is the port of that name."""
        if self._text.words[at] == "{":
            value, end = self.text(at)
            return value[1:-1].strip(), at, value, end
        key, value_at = self.key(at)
        return key, value_at, *self.text(value_at)

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
        """Pieces in quotes, new lines and characters; None if there is none."""
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
