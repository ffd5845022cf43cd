"""What may follow in statements about values of the mission, and in braces: names, the word between name and value."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from btlang.frontends.mission.symbols.prefixes import SEPARATORS
from btlang.text.words import END_OF_STATEMENT, END_OF_TEXT, Words
from btlang.vocabulary.continuations import begun, ways_on
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.reading_context import Known, ReadingContext
from btlang.vocabulary.trie import longest
from btlang.vocabulary.word_tree import END


def value_options(
    text: Words, last: int, start: str, vocabulary: Lexicon, context: ReadingContext
) -> Iterator[tuple[str, str]]:
    """(words, kind) that may follow the words before `last`; the next word begins with `start`."""
    known: Mapping[str, Known] = context.known or {}
    names = [" ".join(value.words) for value in known.values() if value.words]
    if text.words[last - 1] == "{":
        untyped = [value.key for value in known.values() if not value.words]
        yield from ((f"{name}}}", "value") for name in (*names, *untyped) if name.startswith(start))
        return
    at = last - 1
    while at >= 0 and text.words[at] not in (END_OF_STATEMENT, END_OF_TEXT):
        match = longest(vocabulary.trie, text, at, context)
        if match is not None and match.meaning.role in SEPARATORS and match.last <= last:
            yield from _inside(match.meaning.role, text, match.last, last, start, vocabulary, names)
            return
        at -= 1


def _inside(
    role: str, text: Words, first: int, last: int, start: str, vocabulary: Lexicon, names: list[str]
) -> Iterator[tuple[str, str]]:
    """What may follow `set`, `remember`, ... and the words behind it, which are written from `first` on."""
    separators = vocabulary.roles[SEPARATORS[role]]
    written = text.words[first:last]
    if any(joint.split()[0] in written for joint in separators):
        return
    if role == "remember":
        for node in begun(vocabulary.quantities, text, first, last, vocabulary.context).nodes:
            for words, child in ways_on(node, start):
                yield " ".join(words) + (" " if END not in child else ""), "value"
    elif not written:
        yield from ((name, "value") for name in names if name.startswith(start))
    if written:
        yield from ((f"{joint} ", "connective") for joint in separators if joint.startswith(start))
