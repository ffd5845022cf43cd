"""XML text to a flat list of elements with their places, by Python's expat. Nothing is known of trees here.

Entities and what a DOCTYPE may declare or fetch are refused, and so is nesting beyond MOST_DEEP.
"""

from __future__ import annotations

import re
from xml.parsers import expat

from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic
from btlang.frontends.btcpp.repair import Repaired, is_odd, repaired
from btlang.support.record import Record
from btlang.text.source import Source, Span

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    Element: TypeAlias = tuple[str, list[str], int, int]
    """Tag; names and values of attributes in turn; where it starts; how many elements ended before."""

_WORD = re.compile(r"[^\s=>]*")
MOST_DEEP = 10_000  # levels of nodes; <root> and <BehaviorTree> stand around them
_AROUND = 2
_ERRORS = expat.errors.codes
_REASONS = {
    "XML_ERROR_TAG_MISMATCH": "this end tag doesn't match the open tag",
    "XML_ERROR_INVALID_TOKEN": "unexpected character",
    "XML_ERROR_SYNTAX": "expected a tag",
    "XML_ERROR_NO_ELEMENTS": "it ends too early",
    "XML_ERROR_UNCLOSED_TOKEN": "this tag or comment is not closed",
    "XML_ERROR_UNCLOSED_CDATA_SECTION": "this CDATA section is not closed",
    "XML_ERROR_DUPLICATE_ATTRIBUTE": "this attribute is given twice in one tag",
    "XML_ERROR_JUNK_AFTER_DOC_ELEMENT": "something follows the end of the outermost tag",
    "XML_ERROR_UNDEFINED_ENTITY": "unknown entity",
    "XML_ERROR_BAD_CHAR_REF": "there is no character with this number",
    "XML_ERROR_XML_DECL": "the XML declaration can't be read",
    "XML_ERROR_MISPLACED_XML_PI": "the XML declaration must come first",
}
_BY_NUMBER = {_ERRORS[getattr(expat.errors, name)]: reason for name, reason in _REASONS.items()}
_MISMATCH = _ERRORS[expat.errors.XML_ERROR_TAG_MISMATCH]
_INVALID = _ERRORS[expat.errors.XML_ERROR_INVALID_TOKEN]
_TWICE = _ERRORS[expat.errors.XML_ERROR_DUPLICATE_ATTRIBUTE]
_NO_MORE = _ERRORS[expat.errors.XML_ERROR_NO_ELEMENTS]


class Note(Record):
    """A comment or processing instruction as it is written, or a text; between which elements it stands.

    `before` is the number of elements that started before it, `ended` of those that ended; it begins at `start`.
    """

    text: str
    before: int
    ended: int
    start: int
    is_text: bool = False


class Document:
    """An XML file: its elements, each before those inside it.

    `text` has the length of the source's text, and holds no `>` in values.
    """

    def __init__(self, source: Source, readable: Repaired) -> None:
        self.source = source
        self.text = readable.text
        self.restored = readable.restored
        self.is_repaired = readable.text is not source.text
        self.gaps = readable.gaps
        """Places of attributes without a blank before them."""
        self.elements: list[Element] = []
        self.depths: list[int] = []
        """How many elements each element stands in."""
        self.notes: list[Note] = []
        self.declaration = ""
        self.doctype = ""

    def span(self, index: int) -> Span:
        """The start tag of an element."""
        start = self.elements[index][2]
        return Span(self.source, start, self.text.find(">", start) + 1)

    def attributes(self, index: int) -> dict[str, str]:
        """The attributes of an element in their order."""
        flat = self.elements[index][1]
        return dict(zip(flat[::2], flat[1::2], strict=True))

    def end(self, index: int) -> int:
        """The number of the first element that is not inside an element."""
        depth, after = self.depths[index], index + 1
        depths = self.depths
        while after < len(depths) and depths[after] > depth:
            after += 1
        return after

    def parts(self) -> list[int]:
        """The elements right below the outermost one."""
        found: list[int] = []
        for _ in range(self.depths.count(1)):
            found.append(self.depths.index(1, found[-1] + 1 if found else 1))
        return found


def scanned(source: Source) -> Document:
    """Raises MissionError (BT120, BT121)."""
    readable = repaired(source.text) if is_odd(source.text) else Repaired(source.text)
    try:
        return _document(source, readable)
    except MissionError as error:
        if readable.text is not source.text or error.diagnostics[0].code != "BT120":
            raise
    return _document(source, repaired(source.text))


def _document(source: Source, readable: Repaired) -> Document:
    """Most files hold no texts but the space between tags, and asking for the place of each takes time."""
    quick = _Scanner(source, readable)
    document = quick.scan()
    return _Scanner(source, readable).scan(texts=True) if quick.has_texts else document


class _Refused(Exception):
    pass


class _Scanner:
    def __init__(self, source: Source, readable: Repaired) -> None:
        self._document = Document(source, readable)
        self._readable = readable
        self._ends: list[str] = []
        self._texts: list[str] = []
        self._parser = expat.ParserCreate()
        self._refused: tuple[str, str] = ("", "")

    @property
    def has_texts(self) -> bool:
        """Whether there is more than space between tags."""
        return any(map(str.strip, self._texts))

    def scan(self, texts: bool = False) -> Document:
        """The document, with its texts among the notes where they are asked for."""
        document, parser = self._document, self._parser
        parser.ordered_attributes = True
        parser.buffer_text = True
        elements, ends = document.elements, self._ends

        def start(tag: str, attributes: list[str]) -> None:
            elements.append((tag, attributes, parser.CurrentByteIndex, len(ends)))

        def text(data: str) -> None:
            if not data.isspace():
                self._note(document.restored(data), True)

        parser.StartElementHandler = start
        parser.EndElementHandler = ends.append  # only their number matters, and Python need not be entered for it
        parser.CharacterDataHandler = text if texts else self._texts.append
        parser.CommentHandler = lambda data: self._note(f"<!--{document.restored(data)}-->")
        parser.ProcessingInstructionHandler = lambda target, data: self._note(f"<?{f'{target} {data}'.rstrip()}?>")
        parser.XmlDeclHandler = self._declared
        parser.StartDoctypeDeclHandler = self._doctype
        try:
            document.text = self._readable.spaced
            parser.Parse(document.text, True)
        except expat.ExpatError as error:
            raise MissionError([self._broken(error.code)]) from None
        except UnicodeEncodeError as error:
            place = self._span(error.start, error.start + 1)
            raise MissionError([diagnostic("BT120", place, reason="unexpected character")]) from None
        except _Refused:
            what, advice = self._refused
            raise MissionError([diagnostic("BT121", self._here(), what=what, advice=advice)]) from None
        document.depths = [at - element[3] for at, element in enumerate(elements)]
        if max(document.depths) >= MOST_DEEP + _AROUND:
            raise MissionError([self._too_deep()])
        if document.gaps or not document.text.isascii():
            self._count_characters()
        else:
            document.text = self._readable.text
        if document.is_repaired:
            document.elements = [
                (tag, [document.restored(text) for text in flat], start, ended)
                for tag, flat, start, ended in document.elements
            ]
        return document

    def _too_deep(self) -> Diagnostic:
        document = self._document
        self._count_characters()
        place = document.span(document.depths.index(MOST_DEEP + _AROUND))
        what = f"more than {MOST_DEEP:,} levels of nodes"
        return diagnostic("BT121", place, what=what, advice="Move the inner ones into named trees.")

    def _note(self, text: str, is_text: bool = False) -> None:
        at = self._parser.CurrentByteIndex
        self._document.notes.append(Note(text, len(self._document.elements), len(self._ends), at, is_text))

    def _declared(self, version: str, encoding: str | None, standalone: int) -> None:
        encoded = f' encoding="{encoding}"' if encoding is not None else ""
        alone = {1: ' standalone="yes"', 0: ' standalone="no"'}.get(standalone, "")
        self._document.declaration = f'<?xml version="{version}"{encoded}{alone}?>'

    def _doctype(self, name: str, system: str | None, public: str | None, has_inner: int) -> None:
        if system is not None or public is not None:
            self._refuse("a DOCTYPE that names another file", "Remove it.")
        if has_inner:  # billion laughs are declared there
            self._refuse("a DOCTYPE that declares something", "Write the texts themselves instead of entities.")
        self._document.doctype = f"<!DOCTYPE {name}>"

    def _refuse(self, what: str, advice: str) -> None:
        self._refused = what, advice
        raise _Refused

    def _here(self) -> Span:
        """The tag where the parser is, as far as it stands on the line."""
        text = self._document.text
        index = max(self._parser.CurrentByteIndex, 0)
        inside = len(text.encode()[:index].decode(errors="ignore"))
        start = max(text.rfind("<", 0, inside + 1), 0)
        ends = (text.find(">", inside) + 1, text.find("\n", inside))
        return self._span(start, min((end for end in ends if end > inside), default=len(text)))

    def _span(self, start: int, end: int) -> Span:
        """Of places in the text that the parser got."""
        return Span(self._document.source, self._readable.place(start), self._readable.place(end))

    def _broken(self, code: int) -> Diagnostic:
        document = self._document
        start = len(document.text.encode()[: max(self._parser.ErrorByteIndex, 0)].decode(errors="ignore"))
        length = len(_WORD.match(document.text, start)[0]) if code == _TWICE else 1  # type: ignore[index]
        place = self._span(start, min(start + length, len(document.text)))
        reason = _BY_NUMBER.get(code, expat.ErrorString(code))
        if code == _INVALID:
            reason = _why_invalid(document.text, start) or reason
        opened = self._innermost()
        if opened is not None and code in (_MISMATCH, _NO_MORE):
            tag = document.elements[opened][0]
            if code == _NO_MORE:
                return diagnostic("BT120", self._opening(opened), reason=f"<{tag}> is not closed")
            place = self._here()
            reason = f"{place.text} cannot end <{tag}>"
            return diagnostic("BT120", place, ((self._opening(opened), f"<{tag}> starts here"),), reason=reason)
        return diagnostic("BT120", place, reason=reason)

    def _innermost(self) -> int | None:
        """The element that is still open."""
        elements = self._document.elements
        depth = len(elements) - len(self._ends) - 1
        return next((i for i in range(len(elements) - 1, -1, -1) if i - elements[i][3] == depth), None)

    def _opening(self, index: int) -> Span:
        self._count_characters()
        return self._document.span(index)

    def _count_characters(self) -> None:
        """Places from bytes of UTF-8 to characters, without the blanks that the parser got, in one pass."""
        document, place = self._document, self._readable.place
        data = document.text.encode()
        places = sorted([element[2] for element in document.elements] + [note.start for note in document.notes])
        bytes_done = characters = 0
        counted: dict[int, int] = {}
        for start in places:
            characters += len(data[bytes_done:start].decode())
            bytes_done = start
            counted[start] = place(characters)
        document.elements = [(tag, flat, counted[start], ended) for tag, flat, start, ended in document.elements]
        document.notes = [note.replace(start=counted[note.start]) for note in document.notes]
        document.text = self._readable.text


def _why_invalid(text: str, start: int) -> str:
    """What is wrong with a character inside a tag, "" if that isn't known."""
    before = text[max(start - 100, 0) : start].rstrip()
    if text[start : start + 1] < " ":
        return f"the character U+{ord(text[start]):04X} isn't allowed in XML" if text[start : start + 1] else ""
    if before.endswith("="):
        return "the value of an attribute must be in quotes"
    if text[start] in "/>" and before[-1:].isalnum():
        return "an attribute needs a value"
    return ""
