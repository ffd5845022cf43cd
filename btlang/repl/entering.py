"""Where an entry ends: one line, or a block of lines."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from btlang.text.source import Source
from btlang.text.words import split
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.trie import longest


def needs_more(text: str) -> bool:
    """Whether an entry goes on in the next line: it has opened a block that no empty line has closed."""
    lines = text.split("\n")
    return _opens_block(lines[-1]) or (len(lines) > 1 and bool(lines[-1].strip()))


def entries(lines: Iterable[str], vocabulary: Lexicon) -> Iterator[str]:
    """The entries of a text that nobody types: a block also ends where a line stands at the margin again."""
    text = ""
    for line in lines:
        line = line.rstrip("\r\n")
        if text and line.strip() and (line[0].isspace() or _goes_on(line, vocabulary)):
            text += f"\n{line}"
            continue
        if text:
            yield text
        text = line
        if text.strip() and not _opens_block(text):
            yield text
            text = ""
    if text.strip():
        yield text


def _opens_block(line: str) -> bool:
    return line.split("#")[0].rstrip().endswith(":")


def _goes_on(line: str, vocabulary: Lexicon) -> bool:
    """Whether a line at the margin belongs to the statement above it."""
    match = longest(vocabulary.trie, split(Source(line), vocabulary.articles), 0, vocabulary.context)
    return match is not None and match.meaning.role == "otherwise"
