"""Text to words: one pass of one regular expression over the whole text.

A word is kept in lower case; quoted text keeps its case behind a leading `"`; a unit is a word of its own
("2m" is `2`, `m`);
each punctuation mark is a word of its own. Articles leave no word, only a note of where they stood.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Set

from btlang.record import Record
from btlang.text.source import Source, Span

# Same length on both sides, so that offsets stay those of the text that the user sees.
_TYPOGRAPHIC = str.maketrans({"“": '"', "”": '"', "„": '"', "«": '"', "»": '"', "’": "'", "‘": "'", "\ufeff": "\r"})  # noqa: RUF001

# Blanks in front of a word belong to its match, which halves the number of matches.
_PIECE = re.compile(
    r"""[^\S\n]*(?:([^\W\d_]+/[^\W\d_]+(?!\w)|[^\W\d](?:[\w'-]*\w)?)  # word
    |(-?\d+(?:\.\d+)?(?:[eE][+-]?\d+(?!\w))?)                          # number
    |([,:()%°{}])                                                      # mark
    |(\n[ \t\r]*)                                                      # line
    |("[^"\n]*"|(?<!\w)'[^'\n]*'(?!\w))                                # quote
    |([.!?]+|;)                                                        # stop
    |(\#[^\n]*|\Z)                                                     # comment
    |("[^\n]*)                                                         # open
    |(.))                                                              # other""",
    re.VERBOSE,
)
_WORD, _NUMBER, _MARK, _LINE, _QUOTE, _STOP, _COMMENT, _OPEN, _OTHER = range(1, 10)

END_OF_STATEMENT = ";"
END_OF_TEXT = "\n"  # also the word that ends each line


class Line(Record):
    """Words `first` to `last` (exclusive) of one line that is not blank; `indent` counts columns, a tab up to 4."""

    indent: int
    first: int
    last: int


class Words:
    """The words of a source as parallel lists, with a `\\n` word at the end of each line that is not blank."""

    __slots__ = (
        "_distinct",
        "articles",
        "comments",
        "ends",
        "lines",
        "open_quotes",
        "source",
        "starts",
        "unreadable",
        "words",
    )

    def __init__(self, source: Source) -> None:
        self.source = source
        self.words: list[str] = []
        self.starts: list[int] = []
        self.ends: list[int] = []
        self.lines: list[Line] = []
        self.articles: dict[int, tuple[int, int]] = {}
        """Where an article stood: index of the word that follows it -> its characters."""
        self.comments: list[Span] = []
        """From each `#` to the end of its line."""
        self.open_quotes: list[Span] = []
        self.unreadable: list[Span] = []
        self._distinct: frozenset[str] | None = None

    @property
    def distinct(self) -> frozenset[str]:
        """Each word once; for a text that is complete."""
        if self._distinct is None:
            self._distinct = frozenset(self.words)
        return self._distinct

    def span(self, first: int, last: int) -> Span:
        """The characters of words `first` to `last` (exclusive); never empty where there is a word."""
        if first >= last:
            return Span(self.source, self.starts[first], self.ends[first])
        return Span(self.source, self.starts[first], self.ends[last - 1])


def split(source: Source, articles: frozenset[str]) -> Words:
    """The words of a text. Never raises: unterminated quotes and unreadable characters are listed in the result."""
    result = Words(source)
    words, starts, ends = result.words, result.starts, result.ends
    text = source.text.translate(_TYPOGRAPHIC)
    first, indent = 0, _indent(re.match(r"[ \t]*", text).group())  # type: ignore[union-attr]

    def end_line(at: int) -> None:
        nonlocal first
        if len(words) > first:
            result.lines.append(Line(indent, first, len(words)))
            words.append(END_OF_TEXT)
            starts.append(at)
            ends.append(at)
        first = len(words)

    for match in _PIECE.finditer(text):
        kind = match.lastindex or _OTHER
        word = match[kind]
        start, end = match.span(kind)
        if kind == _WORD:
            word = word.lower()
            if word in articles and not (
                text[start - 1 : start] == "{" and text[end : end + 1] == "}"
            ):  # a name is `{a}`
                result.articles[len(words)] = (start, end)
                continue
        elif kind == _LINE:
            end_line(start)
            indent = _indent(word[1:])
            continue
        elif kind == _STOP:
            if len(words) == first or words[-1] == END_OF_STATEMENT:
                continue
            word = END_OF_STATEMENT
        elif kind == _COMMENT:
            if start < end:
                result.comments.append(Span(source, start, end))
            continue
        elif kind == _QUOTE:
            word = '"' + source.text[start + 1 : end - 1]
        elif kind == _OPEN:
            result.open_quotes.append(Span(source, start, end))
            word = '"' + source.text[start + 1 : end].rstrip()
        elif kind == _OTHER:
            bad = result.unreadable
            if bad and bad[-1].end == start:
                bad[-1] = Span(source, bad[-1].start, end)
            else:
                bad.append(Span(source, start, end))
            continue
        words.append(word)
        starts.append(start)
        ends.append(end)
    end_line(len(text))
    words.append(END_OF_TEXT)  # so that looking one word ahead is always possible
    starts.append(len(text))
    ends.append(len(text))
    return result


def _indent(blank: str) -> int:
    return len(blank.replace("\r", "").expandtabs(4))


def statements(text: Words, holding: Set[str]) -> Iterator[tuple[int, int, int]]:
    """(indent, first word, last word) of what stands between line ends, `;` and full stops.

    Only of the lines that hold one of some words.
    """
    for line in text.lines:
        first = line.first
        words = text.words[first : line.last]
        if holding.isdisjoint(words):
            continue
        for at in range(line.first, line.last) if END_OF_STATEMENT in words else ():
            if text.words[at] == END_OF_STATEMENT:
                yield line.indent, first, at
                first = at + 1
        yield line.indent, first, line.last
