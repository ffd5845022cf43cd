"""What may be said of a node behind its words: its name and its ports; behind `do`, the subtrees in quotes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence

from btlang.frontends.mission.symbols.definitions import Definitions
from btlang.frontends.mission.token import Called, NodeCall, Token
from btlang.text.words import Words
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.node_words import BEHIND_ID


def node_options(
    text: Words,
    last: int,
    start: str,
    vocabulary: Lexicon,
    definitions: Definitions,
    tokens: Sequence[Token],
    tokens_of: Callable[[str], Sequence[Token]],
) -> Iterator[tuple[str, str]]:
    """(words, kind) that may follow the words before `last`; the next word begins with `start`.

    `tokens` are those of the text, `tokens_of` reads another one.
    """

    def before(word: int, tokens: Sequence[Token] = tokens) -> Called | NodeCall | None:
        """The node whose words end before a word."""
        end = text.ends[word - 1] if word > 0 else 0
        values = (token.value for token in reversed(tokens) if token.end == end)
        return next((value for value in values if isinstance(value, (Called, NodeCall))), None)

    if _ends_in(text, last, vocabulary.roles["do"]):
        names = [header.name for header in definitions.headers.values() if header.is_quoted]
        yield from ((f'"{name}"', "name") for name in names if not start)
        return
    for role in ("with", "giving"):
        length = _ends_in(text, last, vocabulary.roles[role])
        node = before(last - length) if length else None
        if length and node is None:  # `do pick object with`: an error as it stands
            node = before(last - length, tokens_of(text.source.text[: text.starts[last - length]]))
        if node is not None:
            yield from _ports(node, vocabulary, start, gives=role == "giving")
            return
    if text.words[last - 1] == ",":
        node = before(last - 1)
        details = node.details if isinstance(node, Called) else node
        if node is not None and details is not None and details.ports:
            yield from _ports(node, vocabulary, start, gives=bool(details.outputs))
        return
    node = before(last)
    details = node.details if isinstance(node, Called) else node
    for role in BEHIND_ID if node is not None else ():
        begins = vocabulary.word(role)
        if begins.startswith(start) and not (role == "called" and details and (details.name or details.ports)):
            yield f"{begins} ", "connective"


def _ports(node: Called | NodeCall, vocabulary: Lexicon, start: str, *, gives: bool) -> Iterator[tuple[str, str]]:
    """The ports of a node that nothing was said of."""
    entry = node.entry if isinstance(node, Called) else vocabulary.entry(node.id)
    details = node.details if isinstance(node, Called) else node
    said = {name for name, _ in node.arguments} if isinstance(node, Called) else set[str]()
    said |= dict(details.ports).keys() if details else set()
    for slot in entry.slots if entry is not None else ():
        if slot.name not in said and entry is not None and (slot.name in entry.outputs) == gives:
            words = slot.name.replace("_", " ")
            written = f"{{{slot.name}}}" if gives else f"{words} "
            if words.startswith(start) and not (gives and start):
                yield written, "value"


def _ends_in(text: Words, last: int, phrases: Iterable[str]) -> int:
    """How many words one of the phrases has that ends before a word; 0 where none does."""
    for phrase in phrases:
        words = phrase.split()
        if text.words[max(last - len(words), 0) : last] == words:
            return len(words)
    return 0
