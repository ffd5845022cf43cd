"""Pages about codes: what a message means, an example that causes it, and the same example corrected.

A page is `pages/BTnnn.md`; its first line is `# BTnnn: title`. tests/diagnostics/test_pages.py says how examples are
written, and runs them.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable

from btlang.diagnostics.codes import CODES, NAMES, PLAIN
from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic
from btlang.text.formatting import TextTable, joined
from btlang.text.source import Source, Span

PAGES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "pages")
_CODE = re.compile(r"(?:bt)?(\d+)", re.IGNORECASE | re.ASCII)


def is_code(text: str) -> bool:
    """Whether a text looks like a code, known or not: digits, after BT or not; or is the name of a warning."""
    return _CODE.fullmatch(text) is not None or _plain(text) in NAMES


def explain_code(code: str) -> str:
    """Return the page of a code without its last line end. `13` is BT013, too, and a warning has a name: `two
    readings`.

    Raises MissionError (BT090).
    """
    code = NAMES.get(_plain(code), code)
    match = _CODE.fullmatch(code)
    known = f"BT{match[1].lstrip('0'):0>3}" if match else code
    if known not in CODES:
        raise MissionError([_unknown(code)])
    return _page(known)


def pointer(codes: Iterable[str]) -> str:
    """Return which command says more about messages with these codes, "" if none does."""
    known = sorted({code for code in codes if code not in PLAIN})
    if len(known) < 2:
        return "".join(f"For more, run: btc explain {code}" for code in known)
    return f"For more, run: btc explain CODE, where CODE is {joined(known, 'or')}"


def all_codes() -> TextTable:
    """List each code with the title of its page."""
    return TextTable(tuple((code, title_of(code)) for code in sorted(CODES)))


def title_of(code: str) -> str:
    """Return the title of the page of a code."""
    return _page(code).partition("\n")[0].partition(": ")[2]


def _plain(name: str) -> str:
    return " ".join(name.lower().split())


def _page(code: str) -> str:
    with open(os.path.join(PAGES, f"{code}.md"), encoding="utf-8") as file:
        return f"{file.read().rstrip()}\n\nSince btlang {CODES[code].since}, {CODES[code].status}."


def _unknown(written: str) -> Diagnostic:
    match = _CODE.fullmatch(written)
    if match is None:
        advice = "A code is BT and three digits, such as BT013."
    else:
        number = int(match[1][:9])  # int() refuses thousands of digits
        near = sorted(CODES, key=lambda code: (abs(int(code[2:]) - number), code))[:2]
        advice = f"Similar: {', '.join(near)}"
    return diagnostic("BT090", Span(Source("", written), 0, 0), name=written, help=advice)
