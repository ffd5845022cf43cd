"""Conditions: where they end, and what follows their end."""

from __future__ import annotations

from btlang.frontends.mission.grouping.bodies import begin_otherwise, separator
from btlang.frontends.mission.grouping.lists import after_item
from btlang.frontends.mission.grouping.problems import not_known_yet, waits_for_how_long
from btlang.frontends.mission.grouping.scan import ENDS, Scan
from btlang.frontends.mission.grouping.stack import StackEntry
from btlang.frontends.mission.token import CORRELATIVES, HOLDING, QUANTIFIERS, Token

STARTS_OPERAND = frozenset((
    "command", "condition", "unknown", "wait", "wait_time", "wait_forever", "nothing", "fail", "not", "open", "repeat",
    "try", "retry",
    "check", "wait_until", "wait_for", "wait_up_to", "whenever", "first_time", "in_parallel", "in_order", "each",
    "node", "one_of", *QUANTIFIERS, *CORRELATIVES,
))  # fmt: skip
"""What can only be the start of a command or condition."""
CONDITION_FORMS = frozenset(("if", "unless", "while", "until", "provided", "as_soon_as", "stop_when"))
AMOUNTS = frozenset((
    "count", "for", "up_to", "apart", "within", "by_time", "every", "delay", "at", "every_day", "until_time",
    "if_possible",
))  # fmt: skip
"""What may stand behind a command, with a condition or without."""

_IN_CONDITION = frozenset(("condition", "not", "nor", "open", "close", "again", *QUANTIFIERS, *CORRELATIVES))
_LASTING = frozenset(("wait_until", "whenever", "first_time", "as_soon_as"))  # forms that wait for a condition
_CHOOSING = frozenset(("if", "unless", "while", "until"))  # forms that may have an `otherwise`


def after_condition(scan: Scan, token: Token) -> None:
    entry = scan.stack[-1]
    joined = connective_of(scan, token)
    if token.kind == "again" or (token.kind == "then" and scan.raw[scan.at + 1].kind == "comma"):
        scan.next(token, False)  # `if the battery is low after that, charge`
    elif entry.kind == "condition list":
        after_item(scan, entry, token)
    elif joined:
        entry.connective(scan.emit(joined, token))
        scan.next(token, True)
        if joined.startswith("WIDE"):
            scan.at += 1
    elif entry.kind == "condition bracket":
        if token.kind != "close":
            opener = entry.opener or token
            scan.fail("BT023", scan.span(opener))
            return
        entry.close_chain()
        scan.stack.pop()
        scan.emit("COND_CLOSE", token)
        scan.next(token, False)
    else:
        entry.close_chain()
        scan.stack.pop()
        end_condition(scan, entry, token)


def connective_of(scan: Scan, token: Token) -> str:
    """The kind of a connective that another condition follows, else ""."""
    at = scan.at
    if token.kind == "comma":
        following = scan.raw[at + 1].kind
        if following in ("and", "or"):
            return "WIDE_" + following.upper() if scan.condition_at(at + 2) else ""
        return "COMMA" if scan.condition_at(at + 1) else ""
    return token.kind.upper() if token.kind in ("and", "or") and scan.condition_at(at + 1) else ""


def closes_statement(scan: Scan, at: int) -> bool:
    """Whether from here to the end of the statement or bracket there is nothing but forms behind a command.

    These are amounts, and at the end one form with its condition.
    """
    first = at
    while scan.raw[at].kind in AMOUNTS:
        at += 1
    if scan.raw[at].kind not in CONDITION_FORMS:
        return at > first and scan.raw[at].kind in ENDS
    at += 1
    depth, start = 0, at
    while True:
        kind = scan.raw[at].kind
        if kind in ("and", "or", "comma"):
            after = at + 2 if kind == "comma" and scan.raw[at + 1].kind in ("and", "or") else at + 1
            if not scan.condition_at(after):
                return at > start and scan.raw[after].kind == "otherwise"
            at = after
            continue
        if (kind == "close" and depth == 0) or kind in ENDS - {"close"}:
            return at > start
        if kind not in _IN_CONDITION:
            return False
        depth += (kind == "open") - (kind == "close")
        at += 1


def end_condition(scan: Scan, entry: StackEntry, token: Token) -> None:
    if token.kind in HOLDING and entry.opener is not None:
        if entry.opener.role == "wait_for" and token.kind == "for":
            waits_for_how_long(scan, entry.opener, token)
            return
        if entry.opener.role in _LASTING:
            scan.emit("COND_HELD", token)
            scan.next(token, False)
            token = scan.raw[scan.at]
        elif entry.after == "body" or token.kind == "held":
            not_known_yet(scan, entry.opener, token)
            return
    if entry.after == "body":
        scan.emit("DO", token)
        body = StackEntry("body", entry.opener, scan.stack[-1])
        body.begins = len(scan.out)
        body.else_owner = body if entry.opener is not None and entry.opener.role in _CHOOSING else None
        scan.stack.append(body)
        scan.operand_due = True
        if token.kind in ("and", "or"):
            following = scan.raw[scan.at + 1]
            if following.kind in STARTS_OPERAND:
                place = f"after '{scan.words(token)}'"
                scan.fail("BT029", scan.span(following), words=scan.words(following), place=place)
                return
        separator(scan)
    elif entry.after == "postfix" and scan.at_otherwise() and entry.opener and entry.opener.role in ("if", "unless"):
        begin_otherwise(scan)
    elif entry.after != "definition":
        scan.emit_end()


def is_refused(scan: Scan, token: Token) -> bool:
    if scan.stack[-1].is_condition:
        scan.fail("BT029", scan.span(token), words=scan.words(token), place="here")
        return True
    return False
