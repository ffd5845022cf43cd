"""The state of grouping: what comes in, what goes out, what is open, and what is wrong."""

from __future__ import annotations

from collections.abc import Callable

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.grouping.stack import StackEntry
from btlang.frontends.mission.token import RULES, Header, Token, begins_condition
from btlang.support.record import Record
from btlang.text.source import Source, Span

ENDS = frozenset(("newline", "semi", "close", "dedent", "end", "stop"))
STARTS_STATEMENT = frozenset(("newline", "semi", "indent", "dedent", "open", "define"))
_CLOSES_LINE = frozenset(("newline", "indent", "dedent", "end"))


class Unit(Record):
    """The grouped tokens of the mission's commands (`header` is None) or of one definition."""

    header: Header | None
    tokens: tuple[Token, ...]


class Scan:
    """One pass over raw tokens: `at` is the next of them, `out` what was made, `stack` what is open.

    `operand_due` says that an operand must come. One problem a statement is reported; `failed_at` has the raw token
    (the end is one too) at which each showed. `main` are `out` and `stack` outside of definitions, `header` is that of
    the definition that is being read.
    """

    def __init__(self, source: Source, raw: list[Token], conditions: set[str], word: Callable[[str], str]) -> None:
        self.source = source
        self.raw = [*raw, Token("end", len(source.text), len(source.text))]
        self.conditions = conditions
        self.word = word
        self.at = 0
        self.operand_due = True
        self.last_end = 0
        self.out: list[Token] = []
        self.stack = [StackEntry("top")]
        self.main = self.out, self.stack
        self.header: Header | None = None
        self.units: list[Unit] = []
        self.problems: list[Diagnostic] = []
        self.failed_at: list[int] = []

    def emit(self, kind: str, token: Token, role: str = "") -> Token:
        """One that covers the same words and has the same value."""
        made = Token(kind, token.start, token.end, token.value, role)
        self.out.append(made)
        return made

    def emit_end(self) -> None:
        self.out.append(Token("END", self.last_end, self.last_end))

    def next(self, token: Token, operand_due: bool) -> None:
        """The token is dealt with."""
        self.at += 1
        self.last_end = token.end
        self.operand_due = operand_due

    def span(self, first: Token, last: Token | None = None) -> Span:
        return Span(self.source, first.start, (last or first).end)

    def words(self, token: Token) -> str:
        """Its words; of one that was put in, the word for a rule, or what is before it; of a block, what begins it."""
        said = self.span(token).text
        if said or token.kind in RULES:
            return said or self.word(token.kind)
        written = [each for each in self.raw if each.start < each.end]
        behind = (each for each in written if each.start >= token.end)
        before = (each for each in reversed(written) if each.end <= token.start)
        return next((self.span(each).text for each in (behind if token.kind == "indent" else before)), "")

    def begin_statement(self, token: Token) -> None:
        """Statements of a group are joined when the second one begins, so that trailing ends count for nothing."""
        entry = self.stack[-1]
        if entry.is_group:
            if entry.statement == "ended":
                self.out.append(Token(entry.separator, token.start, token.start))
            if entry.statement != "open":
                entry.statement, entry.begins = "open", len(self.out)
                if entry.commands is None:
                    entry.commands = entry.begins
        entry.operand = len(self.out)

    def close_forms(self, down_to: StackEntry | None = None) -> None:
        """Closes the open forms of this bracket, down to one of them (which stays open)."""
        while not self.stack[-1].is_group and self.stack[-1] is not down_to:
            entry = self.stack.pop()
            entry.close_chain()
            self.wrap_constraints(entry)
            self.emit_end()

    def wrap_constraints(self, entry: StackEntry) -> None:
        """What constrains the statement that ends holds over all of it."""
        for constraint in entry.constraints if entry.begins < len(self.out) else ():
            start = self.out[entry.begins].start
            self.out.insert(entry.begins, Token("LOOP", start, start, constraint, constraint.kind))
            self.emit_end()
        entry.constraints.clear()

    def around_statement(self) -> tuple[StackEntry, bool]:
        """What holds the statement so far: the innermost group, or the body of a rule in it (True)."""
        group = max(at for at, entry in enumerate(self.stack) if entry.is_group)
        inner = self.stack[group + 1 :][:1]
        of_rule = inner and inner[0].kind == "body" and inner[0].opener is not None and inner[0].opener.role in RULES
        return (inner[0], True) if of_rule else (self.stack[group], False)

    def take_statement(self) -> None:
        """What comes is about the whole statement so far, of a rule about what it does: puts that in brackets."""
        entry, _ = self.around_statement()
        self.close_forms(entry)
        entry.close_chain()
        self.enclose(entry.begins)

    def enclose(self, first: int) -> None:
        """Brackets round all that was made since a place; of a broken statement nothing was."""
        if first >= len(self.out):
            return
        start = self.out[first].start
        self.out.insert(first, Token("OPEN", start, start))
        self.out.append(Token("CLOSE", self.last_end, self.last_end))

    def open_operand(self, kind: str, role: str) -> None:
        """Opens a form before the command that stands right before this place."""
        entry = self.stack[-1]
        first = self.out[min(entry.operand, len(self.out) - 1)]
        self.out.insert(entry.operand, Token(kind, first.start, first.start, None, role))

    def open_block(self, separator: str = "SEMI") -> None:
        """At an indent: the lines below are statements of a new group, with a token between them."""
        following = self.raw[self.at + 1]
        self.out.append(Token("OPEN", following.start, following.start))
        block = StackEntry("block", self.raw[self.at - 1])
        block.separator = separator
        self.stack.append(block)
        self.at += 1
        self.operand_due = True

    def condition_at(self, at: int) -> bool:
        return begins_condition(self.raw, at)

    def at_otherwise(self) -> bool:
        token = self.raw[self.at]
        if token.kind in ("comma", "stop"):
            token = self.raw[self.at + 1]
        return token.kind == "otherwise"

    def fail(self, code: str, span: Span, fix: tuple[Span, str] | None = None, **arguments: str) -> None:
        self.problems.append(diagnostic(code, span, (), fix, **arguments))
        self.failed_at.append(self.at)
        self.skip_statement()

    def skip_statement(self) -> None:
        """One message a statement: goes on after it, so that all broken statements are reported at once."""
        depth = sum(entry.kind in ("bracket", "condition bracket") for entry in self.stack)
        while not self.stack[-1].is_group or self.stack[-1].kind == "bracket":
            self.stack.pop()
        while True:
            kind = self.raw[self.at].kind
            depth += (kind == "open") - (kind == "close")
            if kind in _CLOSES_LINE or (kind == "semi" and depth <= 0):
                break
            self.at += 1
        self.stack[-1].close_chain()
        self.operand_due = False
        if self.raw[self.at].kind == "indent":
            self.open_block()
