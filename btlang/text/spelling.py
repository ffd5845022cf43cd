"""The nearest known words to what was written."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

_NEAR = 70  # of 100; below it a suggestion is noise (tried on misspelt missions)

_LONGER = 10  # what a further word that is near counts


def nearest(written: str, known: Iterable[str], limit: int = 3) -> list[str]:
    """Up to `limit` of the known texts that a misspelling could have meant, the likeliest first."""
    from rapidfuzz import fuzz  # only on the way to an error message

    scored = {name: fuzz.ratio(written, name.lower()) + fuzz.partial_ratio(written, name.lower()) / 4 for name in known}
    likely = sorted((-score, name) for name, score in scored.items() if score >= _NEAR)
    return [name for _, name in likely[:limit]]


def nearest_start(written: Sequence[str], known: Mapping[str, Sequence[str]]) -> list[str]:
    """Keys of the phrases whose words are near to as many first words of what was written, the likeliest first.

    Of about equally near phrases the longer one is likelier.
    """
    from rapidfuzz import fuzz

    scored = {}
    for key, words in known.items():
        start = " ".join(written[: len(words)])
        scored[key] = fuzz.ratio(start, " ".join(words), score_cutoff=_NEAR), min(len(words), len(written))
    likely = sorted((-score - _LONGER * words, key) for key, (score, words) in scored.items() if score)
    return [key for _, key in likely]
