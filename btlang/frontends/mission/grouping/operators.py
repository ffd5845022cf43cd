"""What may follow a command."""

from __future__ import annotations

from btlang.frontends.mission.grouping.bodies import begin_otherwise, end_block, separator, set_amount
from btlang.frontends.mission.grouping.conditions import closes_statement
from btlang.frontends.mission.grouping.problems import both_readings, is_alone, side_by_side
from btlang.frontends.mission.grouping.scan import ENDS, Scan, Unit
from btlang.frontends.mission.grouping.stack import StackEntry
from btlang.frontends.mission.token import Token
from btlang.vocabulary.language_tables import CONNECTIVES

_CONDITION_FORMS = frozenset(("if", "unless", "while", "until", "provided"))


def connective(scan: Scan, token: Token) -> None:
    scan.stack[-1].connective(scan.emit((token.role or token.kind).upper(), token))
    scan.next(token, True)
    if token.kind == "then" and scan.raw[scan.at].kind == "comma":
        scan.at += 1


def comma(scan: Scan, token: Token) -> None:
    following = scan.raw[scan.at + 1]
    if following.kind in ("and", "or") and not following.role:
        scan.stack[-1].connective(scan.emit("WIDE_" + following.kind.upper(), following))
        scan.next(token, True)
        scan.next(following, True)
    elif following.kind == "otherwise" or following.kind in CONNECTIVES:
        scan.at += 1
    elif following.kind in _CONDITION_FORMS and closes_statement(scan, scan.at + 2):
        scan.close_forms()
        scan.stack[-1].close_chain()
        opener = scan.emit("WIDE_FORM", following, following.kind)
        scan.stack.append(StackEntry("condition", opener, after="end"))
        scan.next(token, True)
        scan.next(following, True)
    elif following.kind in ("count", "for", "within", "if_possible", "provided"):
        fix = (scan.span(token), "") if is_alone(scan) else None
        advice = "Remove it." if fix else both_readings(scan, following)
        scan.fail("BT032", scan.span(token), fix, place=f"before '{scan.words(following)}'", advice=advice)
    else:
        scan.stack[-1].connective(scan.emit("COMMA", token))
        scan.next(token, True)


def otherwise(scan: Scan, token: Token) -> None:
    if scan.stack[-1].else_owner is not None:
        scan.close_forms(scan.stack[-1].else_owner)
        scan.stack.pop().close_chain()
        begin_otherwise(scan)
        return
    opener = scan.emit("OR_ELSE", token)
    scan.stack[-1].connective(opener)
    scan.next(token, True)
    separator(scan)


def amount_of_form(scan: Scan, token: Token) -> None:
    """A count or `for 5 s`: closes the form that waits for one, else belongs to the command before it."""
    entry = scan.stack[-1]
    owner = entry.count_owner if token.kind == "count" else entry.stop_owner
    if owner is None or owner.opener is None:
        postfix(scan, token)
        return
    set_amount(scan, owner.opener, token)
    close_loop(scan, owner, token)


def close_loop(scan: Scan, owner: StackEntry, token: Token) -> None:
    """The amount closes the form; an `otherwise` right behind belongs to a try."""
    scan.close_forms(owner)
    owner.close_chain()
    scan.stack.pop()
    scan.next(token, False)
    if owner.else_owner is owner and scan.at_otherwise():
        begin_otherwise(scan)
    else:
        scan.emit_end()


def postfix(scan: Scan, token: Token) -> None:
    scan.emit("POSTFIX", token, token.kind)
    scan.next(token, False)


def form_after(scan: Scan, token: Token) -> None:
    owner = scan.stack[-1].stop_owner if token.kind in ("until", "while") else None
    if owner is not None:
        scan.close_forms(owner)
        owner.close_chain()
        scan.stack.pop()
        scan.stack.append(StackEntry("condition", scan.emit("STOP", token, token.kind), scan.stack[-1], after="end"))
    else:
        opener = scan.emit("AFTER_FORM", token, token.kind)
        scan.stack.append(StackEntry("condition", opener, scan.stack[-1], after="postfix"))
    scan.next(token, True)


def repeat_after(scan: Scan, token: Token) -> None:
    """`go home repeat until C`: the word belongs to `until`."""
    following = scan.raw[scan.at + 1]
    if following.kind in ("until", "while"):
        scan.at += 1
    else:
        side_by_side(scan, token)


def colon(scan: Scan, token: Token) -> None:
    scan.fail("BT026", scan.span(token))


def close_bracket(scan: Scan, token: Token) -> None:
    groups_nothing = is_alone(scan) or scan.raw[scan.at + 1].kind in ENDS
    scan.close_forms()
    entry = scan.stack[-1]
    if entry.kind != "bracket":
        scan.fail("BT024", scan.span(token), (scan.span(token), "") if groups_nothing else None)
        return
    entry.close_chain()
    scan.stack.pop()
    scan.emit("CLOSE", token)
    scan.next(token, False)


def end_statement(scan: Scan, token: Token) -> None:
    if token.kind == "newline" and scan.at_otherwise():
        scan.at += 1
        return
    scan.close_forms()
    entry = scan.stack[-1]
    entry.close_chain()
    if entry.kind == "bracket" and token.kind != "semi":
        scan.fail("BT023", scan.span(entry.opener or token))
        return
    if entry.statement == "open":
        entry.statement = "ended"
    if entry.kind == "top" and scan.header is not None:
        close_definition(scan)
    if token.kind == "dedent":
        end_block(scan)
    else:
        scan.at += 1
        scan.operand_due = True


def close_definition(scan: Scan) -> None:
    scan.units.append(Unit(scan.header, tuple(scan.out)))
    scan.header = None
    scan.out, scan.stack = scan.main
