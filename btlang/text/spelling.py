"""The nearest known words to what was written."""

from __future__ import annotations

from collections.abc import Iterable


def nearest(written: str, known: Iterable[str], limit: int = 3) -> list[str]:
    """Up to `limit` of the known texts that a misspelling could have meant, the likeliest first."""
    from rapidfuzz import fuzz, process  # only on the way to an error message

    scored = process.extract(written, list(dict.fromkeys(known)), scorer=fuzz.WRatio, limit=limit * 4, score_cutoff=60)
    # WRatio favours short texts inside long ones; the plain ratio puts the closest spelling first
    ranked = sorted(scored, key=lambda hit: (-round(fuzz.ratio(written, hit[0]) + hit[1] / 2), hit[0]))
    return [hit[0] for hit in ranked[:limit]]
