"""The state of the grouping stage: what comes in, what goes out, what is open, and what is wrong."""

from __future__ import annotations

from collections.abc import Callable

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.grouping.stack import Frame
from btlang.frontends.mission.token import Token
from btlang.text.source import Source, Span

ENDS = frozenset(("newline", "semi", "close", "dedent", "end"))
_CLOSES_LINE = frozenset(("newline", "indent", "dedent", "end"))
_STARTS_STATEMENT = frozenset(("newline", "semi", "indent", "dedent", "open", "define"))
_COMMANDS = frozenset(("command", "wait", "nothing", "fail", "open"))
_FOUND = {"newline": "the line ends", "semi": "the sentence ends", "close": "the bracket closes"}


class Scan:
    """One pass over raw tokens. Every syntax error (BT020 to BT032) is made here, one for each statement."""

    def __init__(self, source: Source, raw: list[Token], word: Callable[[str], str]) -> None:
        self.source = source
        self.problems: list[Diagnostic] = []
        self.failed_at: list[int] = []
        """Index of the raw token (the end is one too) at which each problem showed."""
        self._raw = [*_without_idle_stops(raw), Token("end", None, len(source.text), len(source.text))]
        self._word = word
        self._at = 0
        self._operand_due = True
        self._last_end = 0
        self._out: list[Token] = []
        self._frames = [Frame("top")]

    # -- output

    def _emit(self, kind: str, token: Token, value: object = None) -> Token:
        made = Token(kind, value, token.start, token.end)
        self._out.append(made)
        return made

    def _emit_end(self) -> None:
        self._out.append(Token("END", None, self._last_end, self._last_end))

    def _next(self, token: Token, operand_due: bool) -> None:
        """The token is dealt with."""
        self._at += 1
        self._last_end = token.end
        self._operand_due = operand_due

    def _span(self, first: Token, last: Token | None = None) -> Span:
        return Span(self.source, first.start, (last or first).end)

    def _words(self, token: Token) -> str:
        return self._span(token).text

    # -- what is wrong

    def _before(self, token: Token, role: str) -> tuple[Span, str]:
        """A fix: the word of a role put before a token."""
        return Span(self.source, token.start, token.start), f"{self._word(role)} "

    def _is_alone(self) -> bool:
        """Whether one command stands before this place in its bracket: what comes can be about nothing else."""
        frame = self._frames[-1]
        return frame.is_group and frame.last is None

    def _both_readings(self, form: Token) -> str:
        """What a form behind a comma may be about, as two texts: the command before it, or all in this bracket."""
        first = last = self._at
        depth = 0
        while first and (depth or self._raw[first - 1].kind not in _STARTS_STATEMENT):
            first -= 1
            depth += (self._raw[first].kind == "close") - (self._raw[first].kind == "open")
            if not depth and last == self._at and self._raw[first].kind in _COMMANDS:
                last = first
        end = form.end
        if form.kind == "provided":
            end = next(token.start for token in self._raw[self._at :] if token.kind in ENDS)
        text, start, command = self.source.text, self._raw[first].start, self._raw[last].start
        before, form_words = text[start : self._raw[self._at].start], text[form.start : end].strip()
        one = f"{before[: command - start]}({before[command - start :]} {form_words})"
        return f"Write which you mean: {one}, or: ({before}) {form_words}"

    def _fail(self, code: str, span: Span, fix: tuple[Span, str] | None = None, **arguments: str) -> None:
        self.problems.append(diagnostic(code, span, (), fix, **arguments))
        self.failed_at.append(self._at)
        self._skip_statement()

    def _skip_statement(self) -> None:
        """One message a statement: goes on after it, so that all broken statements of a file are told at once."""
        depth = sum(frame.kind in ("bracket", "condition bracket") for frame in self._frames)
        while not self._frames[-1].is_group or self._frames[-1].kind == "bracket":
            self._frames.pop()
        while True:
            kind = self._raw[self._at].kind
            depth += (kind == "open") - (kind == "close")
            if kind in _CLOSES_LINE or (kind == "semi" and depth <= 0):
                break
            self._at += 1
        self._frames[-1].close_chain()
        self._operand_due = False
        if self._raw[self._at].kind == "indent":
            self._open_block()

    def _no_operand(self, token: Token) -> None:
        """Something stands where a command or condition must."""
        frame = self._frames[-1]
        before = self._raw[self._at - 1] if self._at else None
        wanted = "condition" if frame.is_condition else "command"
        starts = before is None or before.kind in _STARTS_STATEMENT
        if starts and token.kind in ENDS:
            self._empty(token, before)
        elif token.kind == "colon":
            self._fail("BT026", self._span(token))
        elif starts and token.kind == "comma":
            self._fail(
                "BT032", self._span(token), (self._with_blanks(token), ""), place="at the start", advice="Take it away."
            )
        elif starts or token.kind not in ENDS | {"then", "and", "or", "after", "otherwise", "comma"}:
            self._fail("BT022", self._span(token), word=self._words(token), example="wave")
        elif before is not None and before.kind == "comma" and token.kind in ENDS:
            advice = "Take it away, or say what follows."
            self._fail("BT032", self._span(before), (self._span(before), ""), place="at the end", advice=advice)
        elif before is not None:
            self._fail("BT020", self._span(before), wanted=wanted, word=self._words(before), found=self._found(token))

    def _with_blanks(self, token: Token) -> Span:
        text = self.source.text
        return Span(self.source, token.start, len(text) - len(text[token.end :].lstrip(" \t")))

    def _found(self, token: Token) -> str:
        if token.kind in _FOUND:
            return _FOUND[token.kind]
        return "the mission ends" if token.kind in ENDS else f"'{self._words(token)}' stands there"

    def _empty(self, token: Token, before: Token | None) -> None:
        if token.kind == "close" and before is not None and before.kind == "open":
            self._fail("BT025", self._span(before, token))
        elif before is not None and before.kind == "define":
            words = self._words(before)
            self._fail("BT020", self._span(before), wanted="command", word=words, found="nothing does")
        else:
            self._operand_due = False  # an empty line or sentence

    def _open_block(self, joint: str = "SEMI") -> None:
        """At an indent: the lines below are statements of a new group, with a token between them."""
        following = self._raw[self._at + 1]
        self._out.append(Token("OPEN", None, following.start, following.start))
        block = Frame("block", self._raw[self._at - 1])
        block.joint = joint
        self._frames.append(block)
        self._at += 1
        self._operand_due = True


def _without_idle_stops(raw: list[Token]) -> list[Token]:
    """A stop at the end of a line ends nothing where the next line goes on with `otherwise`."""
    kept: list[Token] = []
    for at, token in enumerate(raw):
        if token.kind == "otherwise" and at and raw[at - 1].kind == "newline":
            newline = kept.pop()
            while kept and kept[-1].kind == "semi":
                kept.pop()
            kept.append(newline)
        kept.append(token)
    return kept
