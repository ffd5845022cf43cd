"""Words of a text, found in one pass of one regular expression.

A word is kept in lower case; quoted text keeps its case behind a leading `"`; a unit is a word of its own
("2m" is `2`, `m`), and so is each punctuation mark but the colon of a time of day (`18:30`). Articles leave no word,
only a note of where they stood, and the mark of a list item (`- `, `1. `) leaves nothing. A line that ends in a comma
goes on in the next one with words where that is indented more. `Orthography` holds what languages differ in.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set

from btlang.support.record import Record
from btlang.text.source import Source, Span

# Same length on both sides, so that offsets stay those of the text that the user sees.
_TYPOGRAPHIC = str.maketrans({
    "“": '"', "”": '"', "„": '"', "«": '"', "»": '"', "’": "'", "‘": "'", "\ufeff": "\r", "¿": "\r", "¡": "\r",  # noqa: RUF001
})  # fmt: skip
_DECIMAL_COMMA = r"(?<![\d,.])(\d+),(\d+)(?!\d|,\d)"  # but `1,2,3` is a list; compiled where a language needs it
_MARKS_ABOVE = "\u0300-\u036f"  # accents as characters of their own, which some keyboards send

_ITEM = r"(?:(?:[-*\u2022\u2013\u2014]|\d{1,3}[.)])(?=[ \t]))?"  # the mark of a list item: `- `, `* `, `1. `, `1) `

_MARGIN = re.compile(rf"[ \t\r]*{_ITEM}")
# Blanks in front of a word belong to its match, which halves the number of matches.
_PIECE = re.compile(
    rf"""[^\S\n]*(?:([apAP]\.[ ]?[mM]\b(?:\.(?![ \t]*(?:[A-Z\n]|\Z)))?)  # `8 p.m.`, at whose end may be a stop
                    |([a-zA-Z]++(?![\w/'{_MARKS_ABOVE}-])  # as below, in half the time
                    |(?<=[ \t])'[a-z]{{1,2}}(?![\w'-]|[^'\n]*')     # `you 've`
                    |[^\W\d_]+/[^\W\d_]+(?!\w)|[^\W\d](?:[\w{_MARKS_ABOVE}'-]*[\w{_MARKS_ABOVE}])?)  # word
    |(\d+:\d+|-?\d+(?:\.\d+)?(?:[eE][+-]?\d+(?!\w))?)                  # number
    |([,:()%°{{}}])                                                    # mark
    |(\n[ \t\r]*{_ITEM})                                               # line
    |("[^"\n]*"|(?<!\w)'[^'\n]*'(?!\w))                                # quote
    |((?:[.!?]+|;)(?:[ \t]+\d{{1,3}}[.)](?=[ \t]))?)                     # stop, with the mark of the next item: `. 2. `
    |(\#[^\n]*|\Z)                                                     # comment
    |("[^\n]*)                                                         # open
    |(.))                                                              # other""",
    re.VERBOSE,
)
_HALF, _WORD, _NUMBER, _MARK, _LINE, _QUOTE, _STOP, _COMMENT, _OPEN, _OTHER = range(1, 11)

END_OF_STATEMENT = ";"
END_OF_TEXT = "\n"  # also the word that ends each line


class Orthography(Record):
    """The way a language is written: its articles, and whether `1,5` is a number.

    `spellings` are words that are read as another one: contractions (Spanish `al` as `a`), and words that are written
    without their accents, where no other word is written so. `contracted` are words with an apostrophe that may be
    written as two (`don t`, `do n't`, `you 've`), by the second and the first of these. `expanded` are words that are
    read as two: `it's` as `it` and `is`. A full stop may belong to `titles`, as in `Mr. Miller`; they are articles too,
    but for those in which names differ.
    """

    articles: frozenset[str] = frozenset()
    decimal_comma: bool = False
    spellings: Mapping[str, str] = {}
    contracted: Mapping[str, Mapping[str, str]] = {}
    expanded: Mapping[str, tuple[str, str]] = {}
    titles: frozenset[str] = frozenset()

    def with_words(self, words: Iterable[str]) -> Orthography:
        """Return the same orthography, in which these words may be written without their accents."""
        known = {*self.articles, *words}
        plain = {without_accents(word): word for word in known if not word.isascii()}
        new = {bare: word for bare, word in plain.items() if bare not in known}
        return self.replace(spellings={**self.spellings, **new}) if new else self

    def with_contractions(self, words: Iterable[str]) -> Orthography:
        """Return the same orthography, in which these words with an apostrophe may be written as two."""
        made: dict[str, dict[str, str]] = {}
        for word in words:
            front, _, tail = word.partition("'")
            for written in (tail, f"'{tail}"):
                made.setdefault(written, {})[front] = word
            if word.endswith("n't"):
                made.setdefault("n't", {})[word.removesuffix("n't")] = word
        return self.replace(contracted=made)  # type: ignore[no-any-return]

    def word(self, written: str) -> str:
        """Return a word in lower case, with its accents as they are known."""
        word = written.lower()
        if not word.isascii():
            from unicodedata import normalize

            word = normalize("NFC", word)
        return self.spellings.get(word, word)

    def words(self, text: str) -> list[str]:
        """Return the words of a name, without articles."""
        return [
            word
            for at, written in enumerate(text.split())
            if (word := self.word(written)) not in self.articles or (at > 0 and is_letter(written))
        ]

    def bare(self, name: str) -> str:
        """Return a name as it is written, without articles, which do not matter; the `A` of `shelf A` is none."""
        said = enumerate(name.split())
        return " ".join(word for at, word in said if word.lower() not in self.articles or (at and is_letter(word)))

    def told_apart(self, names: Iterable[str]) -> Orthography:
        """Return the same orthography, in which titles that tell names apart are words: `Mr Li` and `Mrs Li`."""
        alike: dict[tuple[str, ...], set[tuple[str, ...]]] = {}
        for name in names:
            words = tuple(self.word(word.rstrip(".")) for word in name.split())
            alike.setdefault(tuple(word for word in words if word not in self.titles), set()).add(words)
        apart = {word for said in alike.values() if len(said) > 1 for words in said for word in words} & self.titles
        return self.replace(articles=self.articles - apart) if apart else self


def without_accents(word: str) -> str:
    """Return `rapido` for `rápido`."""
    from unicodedata import combining, normalize

    return "".join(character for character in normalize("NFD", word) if not combining(character))


class Line(Record):
    """A line that isn't blank: words `first` to `last` (exclusive). `indent` counts columns, a tab up to 4.

    `is_item`: the mark of a list item stands before them.
    """

    indent: int
    first: int
    last: int
    is_item: bool = False


class Words:
    """The words of a source as parallel lists, with a `\\n` word at the end of each line that isn't blank."""

    __slots__ = (
        "_distinct",
        "articles",
        "assumed",
        "comments",
        "ends",
        "going_on",
        "has_shared_places",
        "lines",
        "memo",
        "open_quotes",
        "picked",
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
        self.going_on: set[int] = set()
        """The words at which statements begin that go on with those before them, once somebody has looked for them."""
        self.comments: list[Span] = []
        """From each `#` to the end of its line."""
        self.open_quotes: list[Span] = []
        self.unreadable: list[Span] = []
        self.picked: tuple[Words, Sequence[int]] | None = None
        """Where these are words of another text, side by side: that text, and the place of each in it."""
        self.assumed: dict[int, tuple[str, int, Span | None]] = {}
        """Times of day without am or pm, by their first words: time, end, and the other time that says it, if any."""
        self.memo: dict[object, dict[tuple[int, str], object]] = {}
        """What readers found at its words, each for itself: the same words are read again and again."""
        self.has_shared_places = False
        """Whether several words were put in the place of one, where they stand."""
        self._distinct: frozenset[str] | None = None

    @property
    def distinct(self) -> frozenset[str]:
        """Each word once; for a text that is complete."""
        if self._distinct is None:
            self._distinct = frozenset(self.words)
        return self._distinct

    def with_word(self, at: int, word: str) -> Words:
        """Return the same text with another word in one place."""
        made = Words(self.source)
        made.words = [*self.words[:at], word, *self.words[at + 1 :]]
        made.starts, made.ends, made.lines, made.articles = self.starts, self.ends, self.lines, self.articles
        made.going_on, made.assumed = self.going_on, self.assumed
        return made

    def earlier(self, at: int) -> tuple[Words, int, int]:
        """Return where what stands before a word in its statement is: its text, its first word, the word behind it."""
        if self.picked is not None and at < len(self.picked[1]):
            text, places = self.picked
            return text.earlier(places[at])
        first = at
        while first and self.words[first - 1] not in (END_OF_STATEMENT, END_OF_TEXT):
            first -= 1
        return self, first, at

    def drop(self, first: int, last: int) -> None:
        """Take words `first` to `last` (exclusive) of a line out; only before anybody has looked for anything."""
        del self.words[first:last], self.starts[first:last], self.ends[first:last]
        number = last - first
        self.lines = [
            line
            if line.last <= first
            else line.replace(first=line.first - number * (line.first > first), last=line.last - number)
            for line in self.lines
        ]
        self.articles = {
            at - number * (at >= last): place for at, place in self.articles.items() if not first <= at < last
        }
        self._changed()

    def replace(self, at: int, words: Sequence[str]) -> None:
        """Put words in the place of one, where it stands; only before anybody has looked for anything."""
        more, count = len(words) - 1, len(words)
        self.has_shared_places |= count > 1
        self.words[at : at + 1] = words
        self.starts[at : at + 1], self.ends[at : at + 1] = [self.starts[at]] * count, [self.ends[at]] * count
        self.lines = [
            line.replace(first=line.first + more * (line.first > at), last=line.last + more * (line.last > at))
            for line in self.lines
        ]
        self.articles = {place + more * (place > at): where for place, where in self.articles.items()}
        self._changed()

    def _changed(self) -> None:
        self._distinct = None
        self.memo.clear()

    def begin(self, at: int) -> int:
        """Return the character at which a word begins, or the article before it."""
        return self.articles[at][0] if at in self.articles else self.starts[at]

    def ends_line(self, at: int) -> bool:
        """Return whether a word is the last one of its line in the source."""
        return any(line.last == at + 1 for line in self.lines)

    def span(self, first: int, last: int) -> Span:
        """Return the characters of words `first` to `last` (exclusive); never empty if there is a word."""
        if first >= last:
            return Span(self.source, self.starts[first], self.ends[first])
        return Span(self.source, self.starts[first], self.ends[last - 1])


_ENDS_PHRASE = re.compile(r"[ \t]*(?:[,.;:!?)\n]|$)")


def _is_article(word: str, text: str, start: int, end: int, is_inside: bool) -> bool:
    """Whether a word that is one of the articles is one, and no name `{a}`, or letter inside a sentence: `shelf A`."""
    if text[start - 1 : start] == "{" and text[end : end + 1] == "}":
        return False
    return not (is_inside and (is_letter(word) or (len(word) == 1 and _ENDS_PHRASE.match(text, end))))


def is_letter(word: str) -> bool:
    """Whether a word inside a sentence is a letter, and no article: the `A` of `shelf A`."""
    return len(word) == 1 and word.isupper()


def split(source: Source, orthography: Orthography) -> Words:
    """Split a text into words. Never raises: unterminated quotes and unreadable characters are listed in the result."""
    result = Words(source)
    words, starts, ends = result.words, result.starts, result.ends
    text = source.text.translate(_TYPOGRAPHIC)
    if orthography.decimal_comma:
        text = re.sub(_DECIMAL_COMMA, r"\1.\2", text)
    articles, spellings = orthography.articles, orthography.spellings
    contracted, expanded, titles = orthography.contracted, orthography.expanded, orthography.titles
    titled = -1  # where a title ended
    first = 0
    margin = _MARGIN.match(text).group()  # type: ignore[union-attr]
    indent, is_item = below = _indent(margin)
    held = -1  # where a line ended in a comma, until the next words come

    def end_line(at: int) -> None:
        nonlocal first
        if len(words) > first:
            result.lines.append(Line(indent, first, len(words), is_item))
            words.append(END_OF_TEXT)
            starts.append(at)
            ends.append(at)
        first = len(words)

    for match in _PIECE.finditer(text, len(margin)):
        kind = match.lastindex or _OTHER
        word = match[kind]
        start, end = match.span(kind)
        if held >= 0 and kind not in (_LINE, _COMMENT):
            if below[0] <= indent or below[1]:
                end_line(held)
                indent, is_item = below
            held = -1
        if kind == _WORD:
            if len(words) > first and words[-1][0] == '"' and words[-1][-1] in ".!?" and word[0].isupper():
                words.append(END_OF_STATEMENT)  # `ask "Tea?" If so, wave`
                starts.append(ends[-1])
                ends.append(ends[-1])
            word = word.lower() if word.isascii() and not spellings else orthography.word(word)
            if word in contracted and len(words) > first and words[-1] in contracted[word]:
                word, start, end = contracted[word][words.pop()], starts.pop(), max(end, ends.pop())
            if word in expanded:
                middle = start + len(expanded[word][0])
                words.append(expanded[word][0])
                starts.append(start)
                ends.append(middle)
                word, start = expanded[word][1], middle
            titled = end if word in titles else titled
            if word in articles and _is_article(
                match[kind], text, start, end, len(words) > first and words[-1] != END_OF_STATEMENT
            ):
                result.articles[len(words)] = (start, end)
                continue
        elif kind == _LINE:
            below = _indent(word[1:])
            if len(words) > first and words[-1] == ",":
                held = start if held < 0 else held
            else:
                end_line(start)
                indent, is_item = below
            continue
        elif kind == _STOP:
            if len(words) == first or words[-1] == END_OF_STATEMENT or (start == titled and word == "."):
                continue
            word = END_OF_STATEMENT
        elif kind == _COMMENT:
            if start < end:
                result.comments.append(Span(source, start, end))
            continue
        elif kind == _HALF:
            word = word[0].lower() + word.rstrip(".")[-1].lower()
        elif kind == _QUOTE:
            word = '"' + source.text[start + 1 : end - 1]
        elif kind == _OPEN:
            result.open_quotes.append(Span(source, start, end))
            word = '"' + source.text[start + 1 : end].rstrip()
        elif kind == _OTHER:
            if word == "'" and words and text[start - 1] == "s":
                continue  # `the nurses' station`
            bad = result.unreadable
            if bad and bad[-1].end == start:
                bad[-1] = Span(source, bad[-1].start, end)
            else:
                bad.append(Span(source, start, end))
            continue
        words.append(word)
        starts.append(start)
        ends.append(end)
    end_line(len(text) if held < 0 else held)
    words.append(END_OF_TEXT)  # so that looking one word ahead is always possible
    starts.append(len(text))
    ends.append(len(text))
    if any(line.is_item for line in result.lines):
        result.lines = list(_indent_items(words, result.lines))
    return result


def _indent(margin: str) -> tuple[int, bool]:
    """Return the columns of the blanks at the start of a line, and whether the mark of a list item follows them."""
    if not margin:
        return 0, False
    blank = margin.rstrip("-*\u2022\u2013\u2014.)0123456789")
    return len(blank.replace("\r", "").expandtabs(4)), len(blank) < len(margin)


def _indent_items(words: Sequence[str], lines: Iterable[Line]) -> Iterator[Line]:
    """Yield lines in which the items of a list behind a line with a colon are a block, even if they aren't indented."""
    before: Line | None = None
    margin: int | None = None  # of a list that is not indented
    for line in lines:
        if margin is not None and (line.indent < margin or (line.indent == margin and not line.is_item)):
            margin = None
        opens = before is not None and not before.is_item and words[before.last - 1] == ":"
        if margin is None and line.is_item and before is not None and opens and line.indent == before.indent:
            margin = line.indent
        before = line
        yield line if margin is None else line.replace(indent=line.indent + 1)


def statements(text: Words, holding: Set[str]) -> Iterator[tuple[int, int, int]]:
    """Yield (indent, first word, last word) of what is between line ends, `;` and full stops.

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
