"""What `btc words` answers: the names of the world that are searched for, and what can be said."""

from __future__ import annotations

import textwrap

from btlang.text.source import Source
from btlang.text.words import split
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.listing import listing
from btlang.vocabulary.value_type import WORLD

_WIDTH = 80  # columns, of a text that is for no terminal


def list_words(vocabulary: Lexicon, search: str, width: int = _WIDTH, command: str = "btc words") -> list[str]:
    """Return the lines for a search; `command` is what lists words.

    `rooms`, `people` or `red things` are the names of those in the world. What can be said follows, unless the search
    is such a word alone: `place` and `cup` are also parts of phrases.
    """
    type, names = _find_names(vocabulary, search)
    if not names:
        return listing(vocabulary, search, width)
    found = f"The names for '{' '.join(search.split())}' in this world: {', '.join(names)}."
    lines = textwrap.wrap(found, width, subsequent_indent="  ", break_on_hyphens=False)
    text = split(Source(search), vocabulary.orthography)
    if search.strip().lower() == type or vocabulary.values.choice(text, 0) is not None:
        return [*lines, "", *listing(vocabulary, search, width)]
    return [*lines, f"{command} {type} lists what can be said about {'it' if len(names) == 1 else 'them'}."]


def _find_names(vocabulary: Lexicon, search: str) -> tuple[str, tuple[str, ...]]:
    """Return the type and the names of a set of places, people and so on; ("", ()) if the words describe none."""
    text = split(Source(f"{vocabulary.word('all_names')} {search}"), vocabulary.orthography)
    last = len(split(Source(search), vocabulary.orthography).words)
    for meant, end in vocabulary.values.groups(text, 0) if search.strip() else ():
        if meant.type in WORLD and len(text.words) - end == last - len(search.split()):
            described = vocabulary.values.likenesses.described(meant)
            return meant.type, described if meant.parts else vocabulary.values.listed(meant.type)
    return "", ()
