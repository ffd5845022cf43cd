"""Spelling: the known words that are nearest to a written one."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from itertools import groupby

_NEAR = 70  # of 100; below it a suggestion is noise (tried on misspelt missions)

_LONGER = 10  # what a further word that is near counts

_SHORT, _LONG = 5, 8  # letters of a word in which two, and three, may be wrong


def nearest(written: str, known: Iterable[str], limit: int = 3) -> list[str]:
    """Return up to `limit` of the known texts that a misspelling could have meant, the likeliest first."""
    from rapidfuzz import fuzz  # only on the way to an error message

    scored = {name: fuzz.ratio(written, name.lower()) + fuzz.partial_ratio(written, name.lower()) / 4 for name in known}
    likely = sorted((-score, name) for name, score in scored.items() if score >= _NEAR)
    return [name for _, name in likely[:limit]]


def nearest_start(written: Sequence[str], known: Mapping[str, Sequence[str]]) -> list[str]:
    """Return keys of the phrases whose words are near to as many first words of what was written, the likeliest
    first.

    Of about equally near phrases the longer one is likelier.
    """
    from rapidfuzz import fuzz, process

    by_length: dict[int, dict[str, str]] = {}
    for key, words in known.items():
        by_length.setdefault(len(words), {})[key] = " ".join(words)
    scored = []
    for length, phrases in by_length.items():
        start = " ".join(written[:length])
        near = process.extract(start, phrases, scorer=fuzz.ratio, score_cutoff=_NEAR, limit=None)
        scored += [(-score - _LONGER * min(length, len(written)), key) for _, score, key in near]
    return [key for _, key in sorted(scored)]


def _most_slips(written: str) -> int:
    """Return how many slips of a letter a word of that length may have."""
    return 1 if len(written) < _SHORT else 2 if len(written) < _LONG else 3


def distance(written: str, meant: str) -> int:
    """Count two for each letter that was left out, added or mistaken for another, or that changed places with the next
    one.

    One less where all letters are there, or one of them only is doubled or isn't: these are the likeliest slips.
    """
    from rapidfuzz.distance import OSA

    is_likely = sorted(written) == sorted(meant) or _once(written) == _once(meant)
    return 2 * OSA.distance(written, meant) - (is_likely and written != meant)


def _once(word: str) -> str:
    """Return a word with each double letter once."""
    return "".join(letter for letter, _ in groupby(word))


def is_misspelling(written: str, meant: str, others: Iterable[str]) -> bool:
    """Whether few slips make of one word the other, and none of the others is as near."""
    from rapidfuzz.distance import OSA

    is_near = OSA.distance(written, meant) <= _most_slips(written)
    return is_near and not any(distance(written, other) <= distance(written, meant) for other in others)


def misspelt(written: str, known: Iterable[str]) -> list[str]:
    """Return up to three of the known words of which few slips make what was written, the likeliest first."""
    most = _most_slips(written)
    names = [name for name in known if abs(len(name) - len(written)) <= most]
    return [name for name in nearest(written.lower(), names) if is_misspelling(written, name, ())]


def fewest_slips(written: str, known: frozenset[str]) -> int:
    """Return how many slips away the nearest of the known words is; as many as a word may have if none is nearer."""
    from rapidfuzz import process
    from rapidfuzz.distance import OSA

    nearer = _most_slips(written) - 1
    letters, by_length = set(written), _by_length(known)
    lengths = range(len(written) - nearer, len(written) + nearer + 1)
    words = (word for length in lengths for word in by_length.get(length, ()))
    likely = [word for word in words if len(letters.difference(word)) <= nearer]  # a slip changes one letter at most
    found = process.extractOne(written, likely, scorer=OSA.distance, score_cutoff=nearer) if nearer else None
    return nearer + 1 if found is None else int(found[1])


@lru_cache(maxsize=2)  # there is one list of words for each language
def _by_length(known: frozenset[str]) -> dict[int, list[str]]:
    return {length: list(words) for length, words in groupby(sorted(known, key=len), len)}


def respellings(written: str, known: Iterable[str], limit: int = 8) -> list[str]:
    """Return known words that a slip of a few letters turns into what was written, the likeliest first; then two run
    together.

    Of equally small slips two letters that changed places are likeliest, then one that is not at the start or end.
    """
    from rapidfuzz import process
    from rapidfuzz.distance import OSA

    known = known if isinstance(known, frozenset) else frozenset(known)
    near = process.extract(written, known, scorer=OSA.distance, score_cutoff=_most_slips(written), limit=None)
    scored = sorted(
        (distance, sorted(word) != sorted(written), word[0] != written[0], word[-1] != written[-1], word)
        for word, distance, _ in near
        if distance
    )
    halves = ((written[:at], written[at:]) for at in range(2, len(written) - 1))
    apart = [" ".join(pair) for pair in halves if known.issuperset(pair)]
    return ([word for *_, word in scored][:limit] + apart)[:limit]
