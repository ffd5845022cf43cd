"""The nearest known words to what was written."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

_NEAR = 70  # of 100; below it a suggestion is noise (tried on misspelt missions)


def nearest(written: str, known: Iterable[str], limit: int = 3) -> list[str]:
    """Up to `limit` of the known texts that a misspelling could have meant, the likeliest first."""
    from rapidfuzz import fuzz  # only on the way to an error message

    scored = {name: fuzz.ratio(written, name.lower()) + fuzz.partial_ratio(written, name.lower()) / 4 for name in known}
    likely = sorted((-score, name) for name, score in scored.items() if score >= _NEAR)
    return [name for _, name in likely[:limit]]


def nearest_start(written: Sequence[str], known: Mapping[str, Sequence[str]], limit: int = 3) -> list[str]:
    """Keys of the phrases whose words are nearest to as many first words of what was written, the likeliest first.

    Of equally near phrases the longer one is likelier.
    """
    from rapidfuzz import fuzz

    scored = {}
    for key, words in known.items():
        start = " ".join(written[: len(words)])
        scored[key] = fuzz.ratio(start, " ".join(words)) + len(words)
    likely = sorted((-score, key) for key, score in scored.items() if score >= _NEAR)
    return [key for _, key in likely[:limit]]
