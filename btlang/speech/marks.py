"""Marks in what is said: `Welcome <wave> to the museum` is a text, and a gesture whose stroke meets the word "to"."""

from __future__ import annotations

import re

from btlang.support.record import Record

_MARK = re.compile(r"\\<|<(?![\s\d])([^<>]+)>")
_SENTENCE_ENDS = re.compile(r"[.!?…]+[\"'”»)\]]*\s+")
_HUGS = ",.;:!?…)]}”»%"


class GestureMark(Record):
    """The words in a mark, and the index in the plain text where the search for the word that it meets begins."""

    words: str
    index: int


def read_marks(text: str) -> tuple[str, tuple[GestureMark, ...]]:
    r"""Return the text without its marks, and the marks.

    `\<` is a plain `<`, as is one before a blank or digit or one that isn't closed.
    """
    plain, marks, at = "", list[GestureMark](), 0
    for match in _MARK.finditer(text):
        plain += text[at : match.start()]
        at = match.end()
        words = " ".join((match[1] or "").split())
        if not words:
            plain += "<" if match[1] is None else match[0]
            continue
        if text[at : at + 1] in _HUGS:
            plain = plain.rstrip()
        elif not plain or plain[-1].isspace():
            at += len(text[at:]) - len(text[at:].lstrip())
        marks.append(GestureMark(words, len(plain)))
    return plain + text[at:], tuple(marks)


def without_marks(text: str) -> str:
    """Return the text without its marks."""
    return read_marks(text)[0]


def sentence_start(text: str, index: int) -> int:
    """Return where the sentence at an index of the text begins."""
    return max((match.end() for match in _SENTENCE_ENDS.finditer(text) if match.end() <= index), default=0)
