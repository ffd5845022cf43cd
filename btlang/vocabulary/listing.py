"""The words of a vocabulary as lines to read."""

from __future__ import annotations

from btlang.vocabulary.entry import Entry
from btlang.vocabulary.vocabulary import Vocabulary


def listing(vocabulary: Vocabulary, search: str = "") -> list[str]:
    """Phrases by topic, each with what it does and an example; with `search` only those that hold all of its words."""
    topics: dict[str, list[Entry]] = {}
    for entries in vocabulary.entries.values():
        for entry in entries:
            topics.setdefault(entry.topic or "other", []).append(entry)
    wanted = search.lower().split()
    lines: list[str] = []
    for topic, entries in sorted(topics.items()):
        shown = [entry for entry in entries if all(word in _searched(entry, topic) for word in wanted)]
        if not shown:
            continue
        lines += ["", f"{topic}:"] if lines else [f"{topic}:"]
        for entry in shown:
            mark = "" if entry.sort == "action" else "  (condition)"
            lines.append(f"  {entry.phrases[0]}{mark}")
            example = f" For example: {entry.example}" if entry.example and entry.example != entry.phrases[0] else ""
            lines.append(f"      {entry.help}{example}".rstrip())
    return lines or [f"No phrase has the words: {search}"]


def _searched(entry: Entry, topic: str) -> str:
    return " ".join((*entry.phrases, entry.help, entry.id, topic)).lower()
