"""The rule for the words of a correction: they differ from those that were written by spelling, not by meaning."""

from __future__ import annotations

import re
from functools import lru_cache

from btlang.text.spelling import distance, fewest_slips, is_misspelling
from btlang.vocabulary.correct_words import correct_words
from btlang.vocabulary.lexicon import NODE_ROLES, Lexicon

_LEAST_LETTERS = 4  # of a word that may have run into another one and that nothing here knows: not `ha all` for `haall`
_PIECE = re.compile(r"[^\W\d_]+(?:['\N{RIGHT SINGLE QUOTATION MARK}][^\W\d_]+)?|\d+(?:\.\d+)?")


def is_respelling(written: str, meant: str, vocabulary: Lexicon, before: str = "") -> bool:
    """Whether two texts say the same but for slips in words that are no words; `before` is the word before them.

    They also do where only marks or blanks differ, where words are added to none, or to a number, or where the word of
    a node by its id is taken away, alone or with its article (`do the wave`). A word of correct English is never
    changed, nor one that might as well be a negation or a word for how many.
    """
    was, now = _PIECE.findall(written.lower()), _PIECE.findall(meant.lower())
    if was == now and not vocabulary.quantifiers.isdisjoint(was):
        return False  # quotes round `hello never wave` would change what it means
    if was == now or not any(piece[0].isalpha() for piece in was):
        return [piece for piece in now if piece[0].isdigit()] == [piece for piece in was if piece[0].isdigit()]
    if any(was[0] in vocabulary.roles[role] for role in NODE_ROLES) and now[:1] != was[:1]:
        was, now = ([piece for piece in said if piece not in vocabulary.articles] for said in (was[1:], now))
        if was == now:
            return bool(now)
    if len(was) != len(now):
        if min(len(was), len(now)) > 1 or not _are_slips(was, vocabulary, before):
            return False
        return _is_slip("".join(was), "".join(now), vocabulary)
    changed = [at for at in range(len(was)) if was[at] != now[at]]
    return all(
        _are_slips([was[at]], vocabulary, was[at - 1] if at else before) and _is_slip(was[at], now[at], vocabulary)
        for at in changed
    )


def _are_slips(words: list[str], vocabulary: Lexicon, before: str) -> bool:
    """Whether none of the words is one that somebody may have meant."""
    right, known = correct_words(vocabulary.word_list), words_of(vocabulary)
    if before.lower() in vocabulary.halting or not all(word.isalpha() for word in words):
        return False
    return not any(word in right or word in known or word in vocabulary.quantifiers for word in words)


def _is_slip(written: str, meant: str, vocabulary: Lexicon) -> bool:
    if distance(written, meant) > 2 * _fewest_slips(written, vocabulary.word_list):
        return False  # another word of English is nearer
    return is_misspelling(written, meant, _turned(written, vocabulary))


@lru_cache(maxsize=1024)  # mistakes repeat
def _fewest_slips(written: str, word_list: str) -> int:
    return fewest_slips(written, correct_words(word_list))


def _turned(written: str, vocabulary: Lexicon) -> frozenset[str]:
    """What would turn the meaning round, if it was meant: negations, and those with a word that they run into."""
    right, known, quantifiers = correct_words(vocabulary.word_list), words_of(vocabulary), vocabulary.quantifiers
    apart = ((written[:at], written[at:]) for at in range(1, len(written)))  # `nowave`
    found = (
        pair
        for pair in apart
        if not quantifiers.isdisjoint(pair)
        and all(p in quantifiers or p in known or (p in right and len(p) >= _LEAST_LETTERS) for p in pair)
    )
    return (quantifiers - known).union(map(" ".join, found))  # those that can be read are tried like any word


@lru_cache(maxsize=4)
def words_of(vocabulary: Lexicon) -> frozenset[str]:
    """Every word that the vocabulary knows, also those in names and values."""
    return vocabulary.words()
