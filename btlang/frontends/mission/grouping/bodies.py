"""Bodies of forms: what separates them from their heads, blocks, and what stands behind `otherwise`."""

from __future__ import annotations

from btlang.diagnostics.diagnostic import diagnostic
from btlang.frontends.mission.grouping.scan import Scan
from btlang.frontends.mission.grouping.stack import StackEntry
from btlang.frontends.mission.token import RULES, Paced, Token


def separator(scan: Scan) -> None:
    """What may stand between the head of a form and its body."""
    token = scan.raw[scan.at]
    if token.kind in ("comma", "then", "colon"):
        scan.next(token, True)
        if token.kind == "colon":
            block = scan.raw[scan.at]
            if block.kind == "indent":
                scan.open_block()
            elif block.kind in ("newline", "dedent", "end"):
                scan.skip_statement()  # the lexer has reported that the block is missing
        elif token.kind == "comma" and scan.raw[scan.at].kind == "then":
            scan.next(scan.raw[scan.at], True)


def begin_otherwise(scan: Scan) -> None:
    if scan.raw[scan.at].kind != "otherwise":
        scan.at += 1  # a comma or a stop before it
    token = scan.raw[scan.at]
    opener = scan.emit("ELSE", token)
    opener.start = scan.last_end
    scan.stack.append(StackEntry("body", opener, scan.stack[-1]))
    scan.next(token, True)
    separator(scan)


def chain_alternatives(scan: Scan) -> None:
    """`if A, X, if B, Y, otherwise Z`: the word behind a chain of commas makes each condition the `else` before it."""
    commas: list[Token] = []
    for outer, inner in zip(scan.stack[-2::-1], scan.stack[:0:-1], strict=True):
        comma = _comma_before(scan, inner) if _is_if(inner) and _is_if(outer) else None
        if comma is None:
            break
        outer.commas.remove(comma)
        outer.close_chain()
        comma.kind = "ELSE"
        commas.insert(0, comma)
    first = len(scan.stack) - 1 - len(commas)
    for at, comma in enumerate(commas, first):
        scan.stack[at] = StackEntry("body", comma, scan.stack[at - 1])


def _comma_before(scan: Scan, entry: StackEntry) -> Token | None:
    """The comma right before a form."""
    at = next(at for at in range(len(scan.out) - 1, -1, -1) if scan.out[at] is entry.opener)
    before = scan.out[at - 1]
    return before if before.kind == "COMMA" else None


def _is_if(entry: StackEntry) -> bool:
    return (
        entry.kind == "body" and entry.opener is not None and entry.opener.kind == "FORM" and entry.opener.role == "if"
    )


def end_block(scan: Scan) -> None:
    scan.at += 1
    scan.operand_due = False
    if scan.stack[-1].kind != "block":
        return
    block = scan.stack.pop()
    if not block.statement and block.opener is not None:  # there is nothing but politeness in it
        scan.problems.append(diagnostic("BT027", scan.span(block.opener)))
    scan.out.append(Token("CLOSE", scan.last_end, scan.last_end))
    body = scan.stack[-1]
    is_rule = body.opener is not None and body.opener.role in RULES
    if body.kind == "body" and body.else_owner is not body and not (is_rule and scan.raw[scan.at].kind == "stop"):
        scan.stack.pop()  # what goes on behind a rule is about what the rule does
        scan.emit_end()


def block_follows(scan: Scan) -> bool:
    return scan.raw[scan.at].kind == "colon" and scan.raw[scan.at + 1].kind == "indent"


def set_pace(opener: Token, count: Token, pace: Token) -> bool:
    """Whether a time behind the count of a repeat or try belongs to it, which it is then given."""
    if pace.kind != "every" and not (pace.kind == "apart" and opener.role == "repeat"):
        return False
    opener.value = paced(count, pace)
    opener.role = "retry" if opener.role == "retry" else pace.kind
    return True


def paced(count: Token, pace: Token) -> Paced:
    """`3 times every 10 s`."""
    assert isinstance(count.value, str)
    assert isinstance(pace.value, str)
    return Paced(count.value, pace.value)


def set_amount(scan: Scan, opener: Token, amount: Token) -> None:
    """A count, duration or end of a repeat or try, before or after its body."""
    if amount.kind == "count":
        opener.role = "repeat" if opener.role == "repeat" else "retry"
    else:
        opener.role = amount.kind
    opener.value = amount.value
