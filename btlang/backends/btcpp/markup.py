"""Markup: tags, attributes and parts of XML files as text.

Strings are put together by hand: the writer of ElementTree is slower, and drops the comments around the outermost tag.
"""

from __future__ import annotations

import re

from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic
from btlang.frontends.btcpp.fragments import IN_TEXTS
from btlang.frontends.btcpp.models import why_no_port
from btlang.frontends.btcpp.origin import Element, Markup
from btlang.frontends.btcpp.spelling import is_xml_name
from btlang.text.source import NOWHERE, Span

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.frontends.btcpp.spelling import Pairs

INDENT = "  "
_DEEPEST = 60  # levels; what is deeper is not indented further, or a deep tree would be a text of spaces
_IN_VALUES = str.maketrans({
    "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;", "\n": "&#10;", "\t": "&#9;", "\r": "&#13;"
})  # fmt: skip
_NO_XML = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")


def sound_comment(text: str) -> str:
    """Return a text as a comment may hold it: XML forbids two hyphens in it."""
    return text.replace("--", "- -").removesuffix("-")


def margin(depth: int) -> str:
    """Return the spaces before a line."""
    return INDENT * min(depth, _DEEPEST)


class Markers:
    """A writer of attributes. `problems` are names and texts that no XML file can hold, each reported once."""

    def __init__(self) -> None:
        self.problems: list[Diagnostic] = []
        self._sound: set[str] = set()
        self._texts: dict[str, str] = {}

    def attributes(self, pairs: Pairs, span: Span | None = None) -> str:
        """Return attributes as they stand in a tag, each after a space; `span` is where to report problems."""
        written = ""
        for key, text in pairs:
            if key not in self._sound:
                self._check_name(key, span)
            value = self._texts.get(text)
            if value is None:
                value = self._value(text, span)
            written += f' {key}="{value}"'
        return written

    def _value(self, text: str, span: Span | None) -> str:
        if _NO_XML.search(text) is not None:
            self.wrong(text, "XML can't hold one of its characters", span)
        value = self._texts[text] = text.translate(_IN_VALUES)
        return value

    def _check_name(self, name: str, span: Span | None) -> None:
        self._sound.add(name)
        if not is_xml_name(name.replace(":", "")):
            self.wrong_port(name, span)

    def wrong_port(self, name: str, span: Span | None) -> None:
        """Report a port whose name no attribute can have (BT129)."""
        self.wrong(name, why_no_port(name), span, "Give this slot or parameter another name.")

    def wrong(self, words: str, reason: str, span: Span | None, help: str = "") -> None:
        """Report words that no XML file can hold (BT129)."""
        self.problems.append(diagnostic("BT129", span or NOWHERE, words=words, reason=reason, help=help))

    def finish(self) -> None:
        """Raise MissionError if something was wrong."""
        if self.problems:
            raise MissionError(self.problems)

    def part(self, root: Element, depth: int) -> list[str]:
        """Return the lines of a part of a file that is no tree."""
        lines: list[str] = []
        stack: list[tuple[Element | Markup | str, int]] = [(root, depth)]
        while stack:
            item, level = stack.pop()
            if isinstance(item, str):
                lines.append(margin(level) + item)  # an end tag
            elif isinstance(item, Markup):
                lines.append(margin(level) + item.text)
            else:
                head = f"{margin(level)}<{item.tag}{self.attributes(item.attributes)}"
                if not item.items:
                    lines.append(f"{head}/>")
                elif all(isinstance(inner, str) for inner in item.items):
                    text = "".join(inner for inner in item.items if isinstance(inner, str))
                    lines.append(f"{head}>{text.translate(IN_TEXTS)}</{item.tag}>")
                else:
                    lines.append(f"{head}>")
                    stack.append((f"</{item.tag}>", level))
                    stack += [(_escape(inner), level + 1) for inner in reversed(item.items)]
        return lines


def _escape(item: Element | Markup | str) -> Element | Markup | str:
    return item.strip().translate(IN_TEXTS) if isinstance(item, str) else item
