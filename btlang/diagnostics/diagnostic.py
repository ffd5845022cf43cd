"""A message about an input as data: a code, a place and the values that its text needs."""

from __future__ import annotations

from btlang.diagnostics.codes import CODES, Code
from btlang.support.record import Record
from btlang.text.escaping import one_line
from btlang.text.source import Span

_LONGEST = 160  # characters of an argument in a message


class Diagnostic(Record):
    """`arguments` fill the braces of the code's texts; `notes` are further places, each with a line about it.

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
        """The entry of the table of codes."""
        return CODES[self.code]

    @property
    def is_error(self) -> bool:
        """Whether the mission cannot run because of it."""
        return self.kind.severity == "error"

    @property
    def message(self) -> str:
        """What is wrong, in one line."""
        return self.kind.message.format(**dict(self.arguments))

    @property
    def hint(self) -> str:
        """What to write instead, "" where nothing more can be said."""
        arguments = dict(self.arguments)
        lines = (self.kind.hint.format(**arguments), arguments.get("help", ""))
        return "\n".join(line for line in lines if line)


def diagnostic(
    code: str,
    span: Span,
    notes: tuple[tuple[Span, str], ...] = (),
    fix: tuple[Span, str] | None = None,
    **arguments: str,
) -> Diagnostic:
    """A diagnostic with its arguments given by name; what cannot be shown in a line of text is made so.

    A fix that would change nothing but case, or that would grow together with a word beside it, is left out.
    """
    if fix is not None and (fix[0].text.lower() == fix[1].lower() or _grows_together(*fix)):
        fix = None
    said = CODES[code].message
    shown = ((name, _shown(text) if f"{{{name}}}" in said else one_line(text)) for name, text in arguments.items())
    return Diagnostic(code, span, tuple(shown), notes, fix)


def _grows_together(span: Span, words: str) -> bool:
    text = span.source.text
    before, after = text[max(0, span.start - 1) : span.start] + words[:1], words[-1:] + text[span.end : span.end + 1]
    return any(len(pair) == 2 and pair.isalnum() for pair in (before, after))


def _shown(text: str) -> str:
    short = text if len(text) <= _LONGEST else text[: _LONGEST // 2] + " ... " + text[-_LONGEST // 2 :]
    return one_line(short)
