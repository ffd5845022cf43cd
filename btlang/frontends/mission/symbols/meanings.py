"""Finds the lines that give a joining word another meaning in this text: `here "and" means then`."""

from __future__ import annotations

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.text.words import Words, statements
from btlang.vocabulary.lexicon import Lexicon

_JOINING = ("then", "and", "or")
_MEANT = {**dict(zip(_JOINING, _JOINING, strict=True)), "meanwhile": "meanwhile", "in_parallel": "meanwhile"}
"""The role that a joining word has, where it means the phrases of a role."""


class Meanings:
    """The role that each word has here, and the words behind each such line, by its first."""

    def __init__(self) -> None:
        self.found: dict[str, str] = {}
        self.ends: dict[int, int] = {}
        self.problems: list[Diagnostic] = []


def find_meanings(text: Words, vocabulary: Lexicon) -> Meanings:
    """Every such line at the left margin. BT066 for two that disagree."""
    meanings = Meanings()
    heres = set(vocabulary.roles["here"])
    if heres.isdisjoint(text.distinct):
        return meanings
    roles = {
        " ".join(word for word in phrase.split() if word not in vocabulary.articles): meant
        for role, meant in _MEANT.items()
        for phrase in vocabulary.roles[role]
    }
    for indent, first, last in statements(text, heres):
        word = text.words[first + 1]
        is_line = indent == text.lines[0].indent and last - first > 3 and text.words[first] in heres
        if not (is_line and word[0] == '"' and text.words[first + 2] in vocabulary.roles["define_strong"]):
            continue
        joining, other = word[1:].lower(), " ".join(text.words[first + 3 : last])
        if roles.get(joining) not in _JOINING or other not in roles:
            continue
        meanings.ends[first] = last
        if meanings.found.setdefault(joining, roles[other]) != roles[other]:
            meanings.problems.append(diagnostic("BT066", text.span(first, last), word=joining))
    return meanings
