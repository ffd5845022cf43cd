"""The part of the grouping stage that deals with conditions: where they end, and what follows their end."""

from __future__ import annotations

from btlang.diagnostics.diagnostic import diagnostic
from btlang.frontends.mission.grouping.scan import ENDS, Scan
from btlang.frontends.mission.grouping.stack import Frame
from btlang.frontends.mission.token import Token

STARTS_OPERAND = frozenset((
    "command", "condition", "unknown", "wait", "nothing", "fail", "not", "open", "repeat", "try", "retry", "check",
    "wait_until", "whenever", "in_parallel", "in_order", "each", "node",
))  # fmt: skip
"""What can only be the start of a command or condition."""


class ConditionScan(Scan):
    """Joins conditions, and takes up what their form needs next."""

    def _after_condition(self, token: Token) -> None:
        frame = self._frames[-1]
        joined = self._condition_connective(token)
        if joined:
            frame.connective(self._emit(joined, token))
            self._next(token, True)
            if joined.startswith("WIDE"):
                self._at += 1
        elif frame.kind == "condition bracket":
            if token.kind != "close":
                opener = frame.opener or token
                self._fail("BT023", self._span(opener))
                return
            frame.close_chain()
            self._frames.pop()
            self._emit("COND_CLOSE", token)
            self._next(token, False)
        else:
            frame.close_chain()
            self._frames.pop()
            self._end_condition(frame, token)

    def _condition_connective(self, token: Token) -> str:
        """The kind of a connective that another condition follows, else ""."""
        at = self._at
        if token.kind == "comma":
            following = self._raw[at + 1].kind
            if following in ("and", "or"):
                return "WIDE_" + following.upper() if self._condition_at(at + 2) else ""
            return "COMMA" if self._condition_at(at + 1) else ""
        return token.kind.upper() if token.kind in ("and", "or") and self._condition_at(at + 1) else ""

    def _condition_at(self, at: int) -> bool:
        while self._raw[at].kind == "open":
            at += 1
        return self._raw[at].kind in ("condition", "not")

    def _closes_statement(self, at: int) -> bool:
        """Whether from here to the end of the statement or bracket there is nothing but a condition."""
        first, depth = at, 0
        while True:
            kind = self._raw[at].kind
            if kind in ("and", "or", "comma"):
                after = at + 2 if kind == "comma" and self._raw[at + 1].kind in ("and", "or") else at + 1
                if not self._condition_at(after):
                    return False
                at = after
                continue
            if (kind == "close" and depth == 0) or kind in ENDS - {"close"}:
                otherwise = kind == "newline" and self._raw[at + 1].kind == "otherwise"
                return at > first and not otherwise
            if kind not in ("condition", "not", "open", "close"):
                return False
            depth += (kind == "open") - (kind == "close")
            at += 1

    def _end_condition(self, frame: Frame, token: Token) -> None:
        if frame.after == "body":
            self._emit("DO", token)
            body = Frame("body", frame.opener, self._frames[-1])
            body.else_owner = body if frame.opener is not None and frame.opener.value != "whenever" else None
            self._frames.append(body)
            self._operand_due = True
            if token.kind in ("and", "or"):
                following = self._raw[self._at + 1]
                if following.kind in STARTS_OPERAND:
                    place = f"after '{self._words(token)}'"
                    self._fail("BT029", self._span(following), words=self._words(following), place=place)
                    return
            self._separator()
        elif (
            frame.after == "postfix"
            and self._at_otherwise()
            and frame.opener
            and frame.opener.value in ("if", "unless")
        ):
            self._else()
        elif frame.after != "definition":
            self._emit_end()

    def _refuse_in_condition(self, token: Token) -> bool:
        if self._frames[-1].is_condition:
            self._fail("BT029", self._span(token), words=self._words(token), place="here")
            return True
        return False

    def _separator(self) -> None:
        """What may stand between the head of a form and its body."""
        token = self._raw[self._at]
        if token.kind in ("comma", "then", "colon"):
            self._next(token, True)
            if token.kind == "colon":
                block = self._raw[self._at]
                if block.kind == "indent":
                    self._open_block()
                elif block.kind in ("newline", "dedent", "end"):
                    self._skip_statement()  # the lexer has told that the block is missing
            elif token.kind == "comma" and self._raw[self._at].kind == "then":
                self._next(self._raw[self._at], True)

    def _else(self) -> None:
        if self._raw[self._at].kind != "otherwise":
            self._at += 1  # a comma or the end of the line before it
        token = self._raw[self._at]
        opener = self._emit("ELSE", token, self._last_end)
        self._frames.append(Frame("body", opener, self._frames[-1]))
        self._next(token, True)
        self._separator()

    def _end_block(self) -> None:
        self._at += 1
        self._operand_due = False
        if self._frames[-1].kind != "block":
            return
        block = self._frames.pop()
        if not block.statement and block.opener is not None:  # there is nothing but politeness in it
            self.problems.append(diagnostic("BT027", self._span(block.opener)))
        self._out.append(Token("CLOSE", None, self._last_end, self._last_end))
        body = self._frames[-1]
        is_rule = body.opener is not None and body.opener.value == "whenever"
        if body.kind == "body" and body.else_owner is not body and not (is_rule and self._at_otherwise()):
            self._frames.pop()  # an `otherwise` behind a rule is about what the rule does
            self._emit_end()

    def _at_otherwise(self) -> bool:
        token = self._raw[self._at]
        if token.kind == "comma" or (token.kind == "newline" and all(f.kind != "bracket" for f in self._frames)):
            token = self._raw[self._at + 1]
        return token.kind == "otherwise"
