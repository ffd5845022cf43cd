"""What a mission may have meant by the id of a node that is none: a word, a node that is known, or a subtree."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from btlang.backends.wording import id_words
from btlang.frontends.mission.explanations.spelling_rule import is_respelling
from btlang.support.record import Record
from btlang.text.source import Source, Span
from btlang.text.words import split
from btlang.tree.node import Node
from btlang.vocabulary.correct_words import correct_words
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.node_words import id_of_name, said_id

TYPE_CHECKING = False
if TYPE_CHECKING:
    Fix = tuple[Span, str]


class SaidId(Record):
    """Where a mission says the id of a node, in quotes or in words, and whether more is said of the node.

    It `may_be_subtree` behind a bare `do`, and is a `sentence` where these are words of the language alone: `do
    anything`.
    """

    span: Span
    id: str
    in_quotes: bool
    is_last: bool
    may_be_subtree: bool
    is_sentence: bool = False


def said_at(node: Node, node_id: str, vocabulary: Lexicon) -> SaidId | None:
    """Where the words of a node say an id; None where they don't, as in XML."""
    if node.span is None or node.span.text[:1] == "<":
        return None
    text = split(Source(node.span.text), vocabulary.orthography)
    parts = id_words(node_id)
    for at in range(1, len(text.words)):
        in_quotes = text.words[at] == f'"{node_id}'
        last = at + 1 if in_quotes else at + len(parts)
        if in_quotes or (at == 1 and text.words[at:last] == parts):
            start = node.span.start
            span = Span(node.span.source, start + text.starts[at], start + text.ends[last - 1])
            may_be_subtree = " ".join(text.words[:at]) in vocabulary.roles["do"]
            is_last, words = span.end == node.span.end, text.words[at:last]
            is_sentence = not in_quotes and is_last and span.text.islower() and _are_correct(words, vocabulary)
            return SaidId(span, node_id, in_quotes, is_last, may_be_subtree, is_sentence)
    return None


def _are_correct(words: Iterable[str], vocabulary: Lexicon) -> bool:
    return correct_words(vocabulary.word_list).issuperset(words)


def respelt_leaf(said: SaidId, ids: Iterable[str], vocabulary: Lexicon, fits: Callable[[str], bool]) -> Fix | None:
    """The change to the one known id that only a slip keeps apart; None if there is none, or it does not fit."""
    near = _near(said.id, ids, vocabulary)
    if len(near) != 1 or not fits(near[0]):
        return None
    words = "" if said.in_quotes else said_id(near[0], "do", vocabulary)
    return said.span, words or f'"{near[0]}"'


def respelt_subtree(said: SaidId, names: Iterable[str], vocabulary: Lexicon) -> Fix | None:
    """The change to the one subtree that only a slip keeps apart; None if there is none."""
    near = _near(said.id, names, vocabulary)
    if len(near) != 1:
        return None
    [name] = near
    quoted = f'"{name}"'
    if not said.may_be_subtree:  # `do subtree "Tuor"`
        return said.span, quoted
    words = said_id(id_of_name(name), "do", vocabulary)
    if name == name.lower():  # may be a phrase: `do` takes that in words alone
        return (said.span, words) if words and said.is_last else None
    return said.span, quoted if said.in_quotes else words or quoted


def _near(written: str, known: Iterable[str], vocabulary: Lexicon) -> list[str]:
    words = " ".join(id_words(written))
    return [name for name in known if is_respelling(words, " ".join(id_words(name)), vocabulary)]
