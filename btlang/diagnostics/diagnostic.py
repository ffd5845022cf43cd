"""Diagnostics: messages about an input as data, their text for people, their fixes, and the exception of them all."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence

from btlang.diagnostics.codes import CODES, Code
from btlang.support.record import Record
from btlang.text.formatting import CYAN, PLAIN, RED, YELLOW, one_line
from btlang.text.source import NOWHERE, Source, Span

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    Change: TypeAlias = tuple[Span, str]

_LONGEST = 160  # characters of an argument in a message
# Not by rich: `btc check` would start later by its import, more than all that it does takes.
_COLOURS = {"error": RED, "warning": YELLOW, "note": CYAN}
_WIDEST = 120
_ROUNDS = 20  # a correction may show the next mistake, but no text has that many behind each other


class Diagnostic(Record):
    """A message about a place. `arguments` fill the braces of the code's texts; `notes` are further places, each with a
    line.

    `fix` is a change that probably mends it: characters and what to write in their place. An editor may offer it.
    `readings` are such changes too, each of which leaves one of several readings: a choice that only people can make.
    """

    code: str
    span: Span
    arguments: tuple[tuple[str, str], ...] = ()
    notes: tuple[tuple[Span, str], ...] = ()
    fix: tuple[Span, str] | None = None
    readings: tuple[tuple[Span, str], ...] = ()

    def __repr__(self) -> str:
        return f"<Diagnostic {self.code} at {self.span.place}: {self.message}>"

    @property
    def kind(self) -> Code:
        """The entry in the table of codes."""
        return CODES[self.code]

    @property
    def is_error(self) -> bool:
        """Whether the mission can't run because of it."""
        return self.kind.severity == "error"

    @property
    def message(self) -> str:
        """The text that says what is wrong, in one line."""
        return self.kind.message.format(**dict(self.arguments))

    @property
    def hint(self) -> str:
        """The text that says what to write instead, "" if nothing more can be said."""
        arguments = dict(self.arguments)
        lines = (self.kind.hint.format(**arguments), arguments.get("help", ""))
        return "\n".join(line for line in lines if line)

    def advising(self, advice: str) -> Diagnostic:
        """Return the same with a further hint, of one or more lines."""
        helps = (text for name, text in (*self.arguments, ("help", advice)) if name == "help" and text)
        others = (pair for pair in self.arguments if pair[0] != "help")
        advised: Diagnostic = self.replace(arguments=(*others, ("help", "\n".join(helps))))
        return advised


def diagnostic(
    code: str,
    span: Span,
    notes: tuple[tuple[Span, str], ...] = (),
    fix: tuple[Span, str] | None = None,
    **arguments: str,
) -> Diagnostic:
    """Make a diagnostic with its arguments given by name. Texts that can't be shown in a line are escaped.

    A fix that would change nothing but case, or that would grow together with a word beside it, is left out.
    """
    if fix is not None and (fix[0].text.lower() == fix[1].lower() or _grows_together(*fix)):
        fix = None
    said = CODES[code].message
    shown = ((name, _shorten(text) if f"{{{name}}}" in said else one_line(text)) for name, text in arguments.items())
    return Diagnostic(code, span, tuple(shown), notes, fix)


def _grows_together(span: Span, words: str) -> bool:
    text = span.source.text
    before, after = text[max(0, span.start - 1) : span.start] + words[:1], words[-1:] + text[span.end : span.end + 1]
    return any(len(pair) == 2 and pair.isalnum() for pair in (before, after))


def _shorten(text: str) -> str:
    short = text if len(text) <= _LONGEST else text[: _LONGEST // 2] + " ... " + text[-_LONGEST // 2 :]
    return one_line(short)


def render(diagnostic: Diagnostic, colour: bool = False) -> str:
    """Format several lines without a last line end; colour changes nothing but the colour.

    mission.txt:1:7: error BT013: There's no place called 'labb'.
      go to labb then wave
            ^^^^
      Similar: lab
      Did you mean: go to lab then wave
    """
    severity = diagnostic.kind.severity
    own, noted = (_COLOURS[severity], CYAN) if colour else ("", "")
    place = one_line(diagnostic.span.place)
    if diagnostic.span.source is NOWHERE.source:
        place = "btc"
    if diagnostic.span.source.hidden:
        return f"{place}: {_paint(f'{severity} {diagnostic.code}', own)} (its text isn't shown here)"
    label = _paint(f"{severity} {diagnostic.code}:", own)
    lines = [f"{place}: {label} {diagnostic.message}", *underline(diagnostic.span, own)]
    lines += [f"  {line}" for line in diagnostic.hint.splitlines()]
    line = fix_line(diagnostic)
    if line:
        number = diagnostic.span.source.position(diagnostic.fix[0].start)[0] if diagnostic.fix is not None else 0
        elsewhere = number != diagnostic.span.source.position(diagnostic.span.start)[0]
        lines.append(f"  Did you mean{f', in line {number}' if elsewhere else ''}: {line}")
    for span, text in diagnostic.notes:
        lines += [f"  {one_line(span.place)}: {text}", *underline(span, noted)]
    return "\n".join(lines)


def fix_line(diagnostic: Diagnostic) -> str:
    """Return the line with the fix of this diagnostic alone; "" if the hint shows it already, or the line is long."""
    if diagnostic.fix is None or any(name == "fixed" for name, _ in diagnostic.arguments):
        return ""
    span, words = diagnostic.fix
    number, column = span.source.position(span.start)
    line = span.source.line(number)
    first, last = column - 1, column - 1 + span.end - span.start
    if last > len(line) or "\n" in words:
        return ""
    before, after = line[:first], line[last:]
    mended = _blank(f"{before}{words}{after}".strip())
    shown = mended  # a hint that has the words together with the one before them says enough
    if before.strip():
        shown = words if span.start < diagnostic.span.start else f"{before.split()[-1]} {words}"
    is_in_hint = re.search(rf"{re.escape(shown)}(?! \.\.\.| \{{)", diagnostic.hint)  # `go to ...` doesn't show `go to`
    return "" if len(mended) > _WIDEST or is_in_hint else mended


def underline(span: Span, colour: str = "") -> list[str]:
    """Return the first line of the span with `^` under its characters; a long line is cut around them."""
    if not span.source.text or span.source.hidden:
        return []
    number, column = span.source.position(span.start)
    line = span.source.line(number)
    first = column - 1
    last = min(max(first + span.end - span.start, first + 1), max(len(line), first + 1))
    if len(line) > _WIDEST:
        cut = max(0, first - _WIDEST // 2)
        before, after = ("..." if cut else ""), ("..." if cut + _WIDEST < len(line) else "")
        line = before + line[cut : cut + _WIDEST] + after
        first, last = first - cut + len(before), min(last - cut + len(before), len(line))
    marks = "^" * max(1, last - first)
    return [f"  {_blank(line)}".rstrip(), "  " + " " * first + _paint(marks, colour)]


def _paint(text: str, colour: str) -> str:
    return f"{colour}{text}{PLAIN}" if colour else text


def _blank(line: str) -> str:
    """Return one character for each, so that what is underlined stays above its marks."""
    return "".join(c if c.isprintable() else " " for c in line)


class MissionError(Exception):
    """The one exception that compiling raises: everything that is wrong with an input.

    `diagnostics` are sorted by place; at least one of them is an error.
    """

    def __init__(self, diagnostics: list[Diagnostic]) -> None:
        self.diagnostics = sort_diagnostics(diagnostics)
        super().__init__(self.diagnostics)

    def __repr__(self) -> str:
        return f"<MissionError {', '.join(d.code for d in self.diagnostics)}>"

    def __str__(self) -> str:
        return "\n\n".join(render(d) for d in self.diagnostics)

    def advising(self, advice: str) -> MissionError:
        """Return the same error with a further hint below each diagnostic."""
        return MissionError([each.advising(advice) for each in self.diagnostics])


def two_readings(span: Span, taken: str, other: str) -> Diagnostic:
    """Make BT050 for words that have two readings. Each reading is a text to write in their place."""
    problem = diagnostic("BT050", span, taken=taken, other=other, fixed=taken)
    return problem.replace(readings=((span, taken), (span, other)))  # type: ignore[no-any-return]


def sort_diagnostics(diagnostics: list[Diagnostic]) -> list[Diagnostic]:
    """Sort diagnostics by file, place, code and text, each once."""
    unique = {(d.span.source.name, d): d for d in diagnostics}  # spans of two files may be equal
    return sorted(unique.values(), key=lambda d: (d.span.source.name, d.span.start, d.code, d.span.end, d.arguments))


def _find_certain(problems: Iterable[Diagnostic]) -> list[Change]:
    """Return the corrections that leave no choice."""
    return [problem.fix for problem in problems if problem.fix is not None and not problem.readings]


def apply_fixes(source: Source, problems_of: Callable[[Source], Iterable[Diagnostic]]) -> tuple[Source, int]:
    """Return the source with all such changes, and their number. Included texts stay as they are."""
    count = 0
    for _ in range(_ROUNDS):
        source, made = _apply(source, _find_certain(problems_of(source)))
        if not made:
            break
        count += made
    return source, count


def apply_fixes_together(
    sources: Sequence[Source], problems_of: Callable[[Sequence[Source]], Iterable[Diagnostic]]
) -> list[tuple[Source, int]]:
    """Return sources that are read together, with all corrections that leave no choice, and the number of each."""
    counts = [0] * len(sources)
    for _ in range(_ROUNDS):
        changes = _find_certain(problems_of(sources))
        done = [_apply(source, changes) for source in sources]
        if not any(made for _, made in done):
            break
        sources = [source for source, _ in done]
        counts = [count + made for count, (_, made) in zip(counts, done, strict=True)]
    return list(zip(sources, counts, strict=True))


def _apply(source: Source, changes: Iterable[Change]) -> tuple[Source, int]:
    """Return the source with the changes that are its own, and their number."""
    made, text, before = 0, source.text, len(source.text) + 1
    own = [change for change in changes if change[0].source.name == source.name]
    for span, words in sorted(own, key=lambda change: (change[0].start, change[0].end), reverse=True):
        if span.end <= before and text[span.start : span.end] != words:
            text, before, made = text[: span.start] + words + text[span.end :], span.start, made + 1
    return (source.with_text(text), made) if made else (source, 0)
