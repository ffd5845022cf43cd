"""The grouping stage: one scan with a stack, like the matching of brackets, over raw tokens.

It decides all that needs look-ahead: where conditions end and which connectives join them, what each bare comma means,
which count, `for`, `until` or `while` closes an open `repeat` or `try`, who owns each `otherwise`, and which comma
widens. It also is the one judge of syntax: what it lets through, both parsers accept.

The scan alternates between two states: an operand must come, or something that follows an operand.
"""

from __future__ import annotations

from collections.abc import Callable

from btlang.frontends.mission.grouping.conditions import STARTS_OPERAND, ConditionScan
from btlang.frontends.mission.grouping.scan import ENDS
from btlang.frontends.mission.grouping.stack import Frame
from btlang.frontends.mission.symbols.definitions import Header
from btlang.frontends.mission.token import Token
from btlang.record import Record
from btlang.text.source import Source

CONDITION_FORMS = frozenset(("if", "unless", "while", "until", "provided"))


_JOINTS = {"in_parallel": "BLOCK_AND", "in_order": "BLOCK_OR", "node": "BLOCK_CHILD"}


class Unit(Record):
    """The grouped tokens of the mission's commands (`header` is None) or of one definition."""

    header: Header | None
    tokens: tuple[Token, ...]


class Matcher(ConditionScan):
    """Groups the raw tokens of a source; `units` and `problems` are complete after construction.

    `conditions` are the defined names that stand for conditions; `word` gives the word of a role, for corrections.
    """

    def __init__(
        self, source: Source, raw: list[Token], conditions: set[str], word: Callable[[str], str] = str
    ) -> None:
        super().__init__(source, raw, word)
        self.units: list[Unit] = []
        self._conditions = conditions
        self._main = self._out, self._frames
        self._header: Header | None = None
        while self._at < len(self._raw):
            token = self._raw[self._at]
            if self._operand_due:
                _OPERAND.get(token.kind, Matcher._no_operand)(self, token)
            elif self._frames[-1].is_condition:
                self._after_condition(token)
            else:
                _OPERATOR.get(token.kind, Matcher._side_by_side)(self, token)
        self.units.append(Unit(None, tuple(self._out)))

    # -- operands

    def _operand(self, token: Token) -> None:
        frame = self._frames[-1]
        if token.kind == "unknown":
            self._begin_statement(token)
            self._skip_statement()
            return
        if frame.is_condition:
            if token.kind != "condition":
                before = self._raw[self._at - 1]
                place = f"after '{self._words(before)}'" if before.end > before.start else "here"
                self._fail("BT029", self._span(token), words=self._words(token), place=place)
                return
            self._emit("CONDITION", token, token.value)
        else:
            if token.kind == "condition":
                self._fail("BT028", self._span(token), self._before(token, "check"), words=self._words(token))
                return
            self._begin_statement(token)
            value = token.value if token.kind == "command" else (token.kind, token.value)
            self._emit("COMMAND", token, value)
        self._next(token, False)

    def _begin_statement(self, token: Token) -> None:
        """Statements of a group are joined when the second one begins, so that trailing ends count for nothing."""
        frame = self._frames[-1]
        if frame.is_group:
            if frame.statement == "ended":
                self._out.append(Token(frame.joint, None, token.start, token.start))
            frame.statement = "open"

    def _not(self, token: Token) -> None:
        if not self._frames[-1].is_condition:
            if self._condition_at(self._at + 1):
                last = self._raw[self._at + 1]
                span = self._span(token, last if last.kind == "condition" else token)
                self._fail("BT028", span, self._before(token, "check"), words=span.text)
                return
            self._frames.append(Frame("condition"))  # for the message: what follows `not` is no condition
        self._emit("NOT", token)
        self._next(token, True)

    def _open(self, token: Token) -> None:
        frame = self._frames[-1]
        if frame.is_condition:
            self._frames.append(Frame("condition bracket", self._emit("COND_OPEN", token)))
        else:
            self._begin_statement(token)
            self._frames.append(Frame("bracket", self._emit("OPEN", token)))
        self._next(token, True)

    def _form(self, token: Token) -> None:
        if self._refuse_in_condition(token):
            return
        self._begin_statement(token)
        opener = self._emit("FORM", token, token.kind)
        self._frames.append(Frame("condition", opener, self._frames[-1], after="body"))
        self._next(token, True)

    def _whenever(self, token: Token) -> None:
        """A standing rule begins a statement of the text or of a block that is a sequence."""
        frame = self._frames[-1]
        if frame.kind not in ("top", "block") or frame.statement == "open" or frame.joint != "SEMI" or frame.last:
            self._fail("BT037", self._span(token), words=self._words(token))
            return
        self._form(token)

    def _test(self, token: Token) -> None:
        if self._refuse_in_condition(token):
            return
        self._begin_statement(token)
        self._frames.append(Frame("condition", self._emit("TEST", token, token.kind), after="end"))
        self._next(token, True)

    def _loop(self, token: Token) -> None:
        """repeat, try, retry, every 5 s, after 5 s."""
        if self._refuse_in_condition(token):
            return
        following = self._raw[self._at + 1]
        if token.kind == "repeat" and following.kind in ("until", "while"):
            following.start = token.start  # `repeat until` is a word of `until`
            self._at += 1
            return
        self._begin_statement(token)
        opener = self._emit("LOOP", token, (token.kind, token.value))
        body = Frame("body", opener, self._frames[-1])
        self._next(token, True)
        if token.kind in ("repeat", "try", "retry"):
            if following.kind == "count" or (following.kind == "for" and token.kind == "repeat"):
                self._set_amount(opener, following)
                self._next(following, True)
            elif not self._block_follows():
                body.count_owner = body
                body.stop_owner = body if token.kind == "repeat" else body.stop_owner
            if token.kind != "repeat":
                body.else_owner = body
        self._frames.append(body)
        self._separator()

    def _joined_block(self, token: Token) -> None:
        """`in parallel:`, `the first that works:` or a node that is said by its id, and the lines below."""
        if self._refuse_in_condition(token):
            return
        self._begin_statement(token)
        if token.kind == "node":
            opener = self._emit("LOOP", token, ("node", token.value))
            self._frames.append(Frame("body", opener, self._frames[-1]))
        colon = self._raw[self._at + 1]
        body = self._raw[self._at + 2] if colon.kind == "colon" else colon
        on_this_line = "\n" not in self.source.text[colon.end : body.start]
        if colon.kind != "colon" or (on_this_line and body.kind not in ("indent", "dedent", "end")):
            self._fail("BT035", self._span(token), words=self._words(token))
            return
        self._next(token, True)
        self._next(colon, True)
        if self._raw[self._at].kind == "indent":
            self._open_block(_JOINTS[token.kind])
        else:
            self._skip_statement()  # the lexer has told that the block is missing

    def _set_amount(self, opener: Token, amount: Token) -> None:
        """A count or duration of a repeat or try, before or after its body."""
        kind = opener.value[0]
        if amount.kind == "count":
            kind = "repeat" if kind == "repeat" else "retry"
        else:
            kind = "for"
        opener.value = (kind, amount.value)

    def _leading_then(self, token: Token) -> None:
        """`After that, go home` at the start of a statement joins it as the line end does already."""
        frame = self._frames[-1]
        if not frame.is_group or frame.last is not None or frame.statement == "open":
            self._no_operand(token)
            return
        self._next(token, True)
        if self._raw[self._at].kind == "comma":
            self._at += 1

    def _define(self, token: Token) -> None:
        self._header = token.value
        self._out, self._frames = [], [Frame("top")]
        if token.value.name in self._conditions:
            self._frames.append(Frame("condition", after="definition"))
        self._next(token, True)
        self._separator()

    def _close_definition(self) -> None:
        self.units.append(Unit(self._header, tuple(self._out)))
        self._header = None
        self._out, self._frames = self._main

    def _block_follows(self) -> bool:
        return self._raw[self._at].kind == "colon" and self._raw[self._at + 1].kind == "indent"

    # -- after a command

    def _connective(self, token: Token) -> None:
        self._frames[-1].connective(self._emit((token.value or token.kind).upper(), token))
        self._next(token, True)
        if token.kind == "then" and self._raw[self._at].kind == "comma":
            self._at += 1

    def _comma(self, token: Token) -> None:
        following = self._raw[self._at + 1]
        if following.kind in ("and", "or") and not following.value:
            self._frames[-1].connective(self._emit("WIDE_" + following.kind.upper(), following))
            self._next(token, True)
            self._next(following, True)
        elif following.kind in ("then", "otherwise", "after", "and", "or"):
            self._at += 1
        elif following.kind in CONDITION_FORMS and self._closes_statement(self._at + 2):
            self._close_forms()
            self._frames[-1].close_chain()
            opener = self._emit("WIDE_FORM", following, following.kind)
            self._frames.append(Frame("condition", opener, after="end"))
            self._next(token, True)
            self._next(following, True)
        elif following.kind in ("count", "for", "within", "if_possible", "provided"):
            fix = (self._span(token), "") if self._is_alone() else None
            advice = "Take it away." if fix else self._both_readings(following)
            self._fail("BT032", self._span(token), fix, place=f"before '{self._words(following)}'", advice=advice)
        else:
            self._frames[-1].connective(self._emit("COMMA", token))
            self._next(token, True)

    def _otherwise(self, token: Token) -> None:
        if self._frames[-1].else_owner is not None:
            self._close_forms(self._frames[-1].else_owner)
            self._frames.pop().close_chain()
            self._else()
            return
        opener = self._emit("OR_ELSE", token)
        self._frames[-1].connective(opener)
        self._next(token, True)
        self._separator()

    def _amount(self, token: Token) -> None:
        """A count or `for 5 s`: closes the form that waits for one, else belongs to the command before it."""
        frame = self._frames[-1]
        owner = frame.count_owner if token.kind == "count" else frame.stop_owner
        if owner is None or owner.opener is None:
            self._postfix(token)
            return
        self._set_amount(owner.opener, token)
        self._close_loop(owner, token)

    def _close_loop(self, owner: Frame, token: Token) -> None:
        """The amount closes the form; an `otherwise` right behind belongs to a try."""
        self._close_forms(owner)
        owner.close_chain()
        self._frames.pop()
        self._next(token, False)
        if owner.else_owner is owner and self._at_otherwise():
            self._else()
        else:
            self._emit_end()

    def _postfix(self, token: Token) -> None:
        self._emit("POSTFIX", token, (token.kind, token.value))
        self._next(token, False)

    def _form_after(self, token: Token) -> None:
        owner = self._frames[-1].stop_owner if token.kind in ("until", "while") else None
        if owner is not None:
            self._close_forms(owner)
            owner.close_chain()
            self._frames.pop()
            self._frames.append(
                Frame("condition", self._emit("STOP", token, token.kind), self._frames[-1], after="end")
            )
        else:
            opener = self._emit("AFTER_FORM", token, token.kind)
            self._frames.append(Frame("condition", opener, self._frames[-1], after="postfix"))
        self._next(token, True)

    def _repeat_after(self, token: Token) -> None:
        """`go home repeat until C`: the word belongs to `until`."""
        following = self._raw[self._at + 1]
        if following.kind in ("until", "while"):
            self._at += 1
        else:
            self._side_by_side(token)

    def _side_by_side(self, token: Token) -> None:
        if token.kind == "unknown":
            self._skip_statement()
            return
        before = self._raw[self._at - 1]
        self._fail("BT021", self._span(before, token), self._before(token, "then"), word=self._words(token))

    def _colon(self, token: Token) -> None:
        self._fail("BT026", self._span(token))

    def _close(self, token: Token) -> None:
        groups_nothing = self._is_alone() or self._raw[self._at + 1].kind in ENDS
        self._close_forms()
        frame = self._frames[-1]
        if frame.kind != "bracket":
            self._fail("BT024", self._span(token), (self._span(token), "") if groups_nothing else None)
            return
        frame.close_chain()
        self._frames.pop()
        self._emit("CLOSE", token)
        self._next(token, False)

    # -- ends

    def _close_forms(self, down_to: Frame | None = None) -> None:
        """Closes the open forms of this bracket, down to one of them (which stays open)."""
        while not self._frames[-1].is_group and self._frames[-1] is not down_to:
            self._frames.pop().close_chain()
            self._emit_end()

    def _end_statement(self, token: Token) -> None:
        if token.kind == "newline" and self._at_otherwise():
            self._at += 1
            return
        self._close_forms()
        frame = self._frames[-1]
        frame.close_chain()
        if frame.kind == "bracket" and token.kind != "semi":
            self._fail("BT023", self._span(frame.opener or token))
            return
        if frame.statement == "open":
            frame.statement = "ended"
        if frame.kind == "top" and self._header is not None:
            self._close_definition()
        if token.kind == "dedent":
            self._end_block()
        else:
            self._at += 1
            self._operand_due = True


_OPERAND: dict[str, Callable[[Matcher, Token], None]] = {
    **dict.fromkeys(("command", "condition", "unknown", "wait", "nothing", "fail"), Matcher._operand),
    **dict.fromkeys(("if", "unless", "while", "until"), Matcher._form),
    **dict.fromkeys(("check", "wait_until"), Matcher._test),
    **dict.fromkeys(_JOINTS, Matcher._joined_block),
    **dict.fromkeys(("repeat", "try", "retry", "every", "delay", "each"), Matcher._loop),
    "whenever": Matcher._whenever,
    "not": Matcher._not,
    "open": Matcher._open,
    "then": Matcher._leading_then,
    "define": Matcher._define,
}

_OPERATOR: dict[str, Callable[[Matcher, Token], None]] = {
    **dict.fromkeys(("then", "and", "or", "after"), Matcher._connective),
    **dict.fromkeys(("within", "if_possible", "every", "delay"), Matcher._postfix),
    **dict.fromkeys(("if", "unless", "while", "until", "provided"), Matcher._form_after),
    **dict.fromkeys(STARTS_OPERAND, Matcher._side_by_side),
    **dict.fromkeys(("newline", "semi", "dedent", "end"), Matcher._end_statement),
    "repeat": Matcher._repeat_after,
    "comma": Matcher._comma,
    "otherwise": Matcher._otherwise,
    "count": Matcher._amount,
    "for": Matcher._amount,
    "close": Matcher._close,
    "colon": Matcher._colon,
}
