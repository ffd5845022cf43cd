"""Text from outside in Markdown: it stays text, and can't become HTML, a link, a heading or a cell of a table."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence

from btlang.text.escaping import one_line, printable

_MARKS = re.compile(r"[\\`*_\[\]<>|~#&!$^{}]")
_BREAK = "\N{WORD JOINER}"  # between what GitHub would make a link of, though nobody wrote one
_LINKS = re.compile(r"(?i)(?<=:)(?=//)|(?<=mailto)(?=:)|(?<=xmpp)(?=:)|(?<=www)(?=\.)|(?=@)")
_BLOCKS = re.compile(r"^(?:[-+=]|\d+(?=[.)]))")


def escaped(text: str) -> str:
    """A text on one line that is shown as it is."""
    line = _LINKS.sub(_BREAK, one_line(" ".join(text.split())))
    line = _MARKS.sub(r"\\\g<0>", line)
    block = _BLOCKS.match(line)
    if block is None:
        return line
    return f"\\{line}" if not block[0].isdigit() else f"{block[0]}\\{line[block.end() :]}"


def code(text: str) -> str:
    """A text on one line as code, also in a table."""
    line = one_line(" ".join(text.split())) or " "
    marks = "`" * (max(map(len, re.findall("`+", line)), default=0) + 1)
    room = " " if "`" in (line[0], line[-1]) else ""
    return f"{marks}{room}{line}{room}{marks}".replace("|", "\\|")


def block(text: str) -> Iterator[str]:
    """Lines as they are."""
    marks = "`" * max(3, *(len(run) + 1 for run in re.findall("`+", text) or [""]))
    yield from (f"{marks}text", *printable(text).rstrip("\n").split("\n"), marks)


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> Iterator[str]:
    """A table of cells that are Markdown; no lines where it has no rows."""
    rows = list(rows)
    if rows:
        yield from (_row(heads), _row(["---"] * len(heads)), *map(_row, rows))


def _row(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def file_name(text: str) -> str:
    """A text as a part of the names of files and places in pages: letters and digits of ASCII, `.`, `_` and `-`."""
    return re.sub(r"[^A-Za-z0-9._-]+", "-", text).strip("-.") or "tree"
