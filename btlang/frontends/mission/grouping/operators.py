"""What may follow a command."""

from __future__ import annotations

from collections.abc import Callable

from btlang.frontends.mission.grouping.bodies import (
    begin_otherwise,
    chain_alternatives,
    end_block,
    paced,
    separator,
    set_amount,
    set_pace,
)
from btlang.frontends.mission.grouping.conditions import AMOUNTS, CONDITION_FORMS, STARTS_OPERAND, closes_statement
from btlang.frontends.mission.grouping.constraints import only_constraints
from btlang.frontends.mission.grouping.problems import both_readings, found_words, is_alone, prohibition, side_by_side
from btlang.frontends.mission.grouping.readings import otherwise_of_another, repeated, stopped, twice_more, waits_first
from btlang.frontends.mission.grouping.scan import ENDS, Scan, Unit
from btlang.frontends.mission.grouping.stack import StackEntry
from btlang.frontends.mission.token import Token, constraint_of
from btlang.frontends.mission.tokens.settling import FAILS
from btlang.vocabulary.language_tables import CONNECTIVES

_JOINTS = {"in_parallel": "MEANWHILE", "while_doing": "MEANWHILE", "before": "THEN"}


def connective(scan: Scan, token: Token) -> None:
    if _answers_try(scan, token):
        otherwise(scan, token)
        return
    following = scan.raw[scan.at + 1]
    if following.kind == "comma" and token.kind == "and" and scan.raw[scan.at + 2].kind == "then":
        scan.at += 2  # `A and, once there, B`
        token = scan.raw[scan.at]
    _join(scan, token, _joint(token))
    if token.kind not in ("then", "or", "meanwhile"):
        return
    _skip_comma(scan)
    if token.kind == "or" and scan.raw[scan.at].kind == "or":  # `A or, if that fails, B`
        scan.next(scan.raw[scan.at], True)
        _skip_comma(scan)


def _answers_try(scan: Scan, token: Token) -> bool:
    """`try to A; if that fails, B`: makes these words the `otherwise` of the nearest `try`."""
    owner = scan.stack[-1].else_owner
    if token.value != FAILS or owner is None or owner.opener is None or owner.opener.role != "try":
        return False
    token.kind = "otherwise"
    return True


def _skip_comma(scan: Scan) -> None:
    if scan.raw[scan.at].kind == "comma":
        scan.at += 1


def _join(scan: Scan, token: Token, kind: str) -> None:
    entry = scan.stack[-1]
    if token.value == FAILS:
        entry.settle("AND")  # `go to Bob, pick up the cup, and if that fails, A`: all of them fail
    before = [*entry.joints, *entry.commas]
    entry.begin_chain()
    made = scan.emit(kind, token)
    entry.connective(made)
    entry.joints = [*before, made] if token.kind == "and" else []
    scan.next(token, True)


def _joint(token: Token) -> str:
    """The grouped token that a connective becomes."""
    return _JOINTS.get(token.kind, (token.role or token.kind).upper())


def _widening(scan: Scan, token: Token) -> None:
    """A connective behind a comma or a stop."""
    joint = _joint(token)
    widens = joint in ("AND", "MEANWHILE", "OR") and not token.role
    _join(scan, token, f"WIDE_{joint}" if widens else joint)
    _skip_comma(scan)


def comma(scan: Scan, token: Token) -> None:
    following = scan.raw[scan.at + 1]
    entry = scan.stack[-1]
    _answers_try(scan, following)
    is_end = following.kind in ("for", "until_time")
    owner = entry.count_owner if following.kind == "count" else entry.stop_owner if is_end else None
    if following.kind == "otherwise" or owner is not None:
        scan.at += 1
    elif following.kind == "count" and entry.pace_owner is not None:
        scan.at += 1
        _rounds(scan, entry.pace_owner, following)
    elif following.kind in CONNECTIVES or following.kind == "while_doing":
        scan.at += 1
        _widening(scan, following)
    elif (
        following.kind == "but"
        or (constraint_of(following) is not None and not only_constraints(scan))
        or (following.kind == "apart" and scan.raw[scan.at - 1].kind == "count")
    ):
        scan.at += 1
    elif following.kind == "stop_when" or closes_statement(scan, scan.at + 1):
        scan.take_statement()
        scan.at += 1
    elif following.kind == "if_works":
        scan.at += 1
        if_works(scan, following)
    elif following.kind in ("count", "for", "until_time", "within", "by_time", "if_possible", "provided"):
        fix = (scan.span(token), "") if is_alone(scan) else None
        advice = "Remove it." if fix else both_readings(scan, following)
        scan.fail("BT032", scan.span(token), fix, place=f"before '{scan.words(following)}'", advice=advice)
    else:
        entry.begin_chain()
        entry.connective(scan.emit("COMMA", token))
        scan.next(token, True)


def but(scan: Scan, token: Token) -> None:
    """`A but avoid Z`; `A, but first B`: B before it."""
    following = scan.raw[scan.at + 1]
    if constraint_of(following) is not None:
        scan.at += 1
    elif token.value and following.kind == "command":
        scan.raw[scan.at] = Token("after", token.start, token.end)
        scan.stack[-1].settle()
        connective(scan, scan.raw[scan.at])
    elif following.kind == "never":
        prohibition(scan, following)
    else:
        words = scan.words(token)
        scan.fail("BT020", scan.span(token), wanted="command", word=words, found=found_words(scan, following))


def stop(scan: Scan, token: Token) -> None:
    """A full stop or line end before a word that goes on: a comma that closes no form."""
    for entry in reversed(scan.stack):
        entry.stop(token)
        if entry.is_group:
            break
    scan.at += 1
    following = scan.raw[scan.at]
    _answers_try(scan, following)
    if following.kind == "otherwise" and scan.stack[-1].else_owner is None:
        otherwise_of_another(scan, following)
    if following.kind in _GOING_ON:
        _GOING_ON[following.kind](scan, following)


def if_works(scan: Scan, token: Token) -> None:
    """`A. If that works, B`."""
    scan.stack[-1].close_chain()
    body = StackEntry("body", scan.emit("IF_WORKS", token, "if_works"), scan.stack[-1])
    body.else_owner = body
    scan.stack.append(body)
    scan.next(token, True)
    separator(scan)


def in_any_case(scan: Scan, token: Token) -> None:
    """`A. In any case, B`: what A does to the statement behind it is ignored."""
    scan.take_statement()
    scan.emit("POSTFIX", token, "if_possible")
    entry = scan.stack[-1]
    entry.connective(scan.emit("SEMI" if entry.is_group and entry.separator == "SEMI" else "THEN", token))
    scan.next(token, True)
    separator(scan)


def about_statement(scan: Scan, token: Token) -> None:
    """`A. Do that 3 times`, `A. Again`, `A. Repeat that twice`: what follows is about the statement before."""
    following = scan.raw[scan.at + 1]
    if token.kind == "repeat_that" and following.kind == "count" and str(following.value) not in ("1", "-1"):
        twice_more(scan, token, following)
    elif token.kind != "repeat_that":
        repeated(scan, token)
    scan.take_statement()
    scan.next(token, False)
    amount = scan.raw[scan.at]
    if token.kind == "do_that" and amount.kind not in ("again", "more"):
        if amount.kind not in AMOUNTS | CONDITION_FORMS:
            scan.fail("BT030", scan.span(token), words=scan.words(token))
        return
    rounds = "1"
    if amount.kind in ("count", "more") and isinstance(amount.value, str):
        rounds = amount.value
        scan.next(amount, False)
    elif amount.kind == "again":
        scan.next(amount, False)
    if not rounds.isdigit():
        scan.fail("BT030", scan.span(token, amount), words=scan.words(token))
        return
    scan.emit("POSTFIX", token, "count").value = str(int(rounds) + 1)


def says_nothing(scan: Scan, token: Token) -> None:
    """`A again`."""
    scan.next(token, False)


def otherwise(scan: Scan, token: Token) -> None:
    if scan.stack[-1].else_owner is not None:
        scan.close_forms(scan.stack[-1].else_owner)
        chain_alternatives(scan)
        scan.stack.pop().close_chain()
        begin_otherwise(scan)
        return
    opener = scan.emit("OR_ELSE", token)
    scan.stack[-1].connective(opener)
    scan.next(token, True)
    separator(scan)


def amount_of_form(scan: Scan, token: Token) -> None:
    """A count, `for 5 s` or `until 6 pm`: closes the form that waits for one, else belongs to the command before it."""
    entry = scan.stack[-1]
    owner = entry.count_owner if token.kind == "count" else entry.stop_owner
    if owner is None or owner.opener is None:
        postfix(scan, token)
        return
    set_amount(scan, owner.opener, token)
    close_loop(scan, owner, token)


def _rounds(scan: Scan, owner: StackEntry, count: Token) -> None:
    """`every 5 s, A, 3 times`: the rounds in all. Without the comma it is A that is done three times in each."""
    pace = scan.raw[scan.at + 1]
    if pace.kind in ("every", "apart"):  # `every 5 s, A, 3 times every minute`
        scan.fail("BT057", scan.span(pace), words=scan.words(pace))
        return
    if owner.opener is not None:
        owner.opener.value = paced(count, owner.opener)
    close_loop(scan, owner, count)


def close_loop(scan: Scan, owner: StackEntry, token: Token) -> None:
    """The amount closes the form, with a pace behind it; an `otherwise` right behind belongs to a try."""
    scan.close_forms(owner)
    owner.close_chain()
    scan.stack.pop()
    scan.next(token, False)
    pace = scan.raw[scan.at]
    if token.kind == "count" and owner.opener is not None and set_pace(owner.opener, token, pace):
        scan.next(pace, False)
    if owner.else_owner is owner and scan.at_otherwise():
        begin_otherwise(scan)
    else:
        scan.emit_end()


def postfix(scan: Scan, token: Token) -> None:
    scan.next(token, False)
    if token.kind == "if_possible" and scan.at_otherwise():
        scan.open_operand("LOOP", "try")
        begin_otherwise(scan)
        return
    before = scan.out[-1] if scan.out else token  # of a broken statement nothing was made
    if before.kind == "POSTFIX" and isinstance(before.value, str) and {before.role, token.kind} in _PACES:
        count, pace = (before, token) if before.role == "count" else (token, before)
        before.role = pace.role or pace.kind
        before.value, before.end = paced(count, pace), token.end
    elif token.kind == "apart":
        scan.fail("BT057", scan.span(token), words=scan.words(token))
    else:
        scan.emit("POSTFIX", token, token.kind)


_PACES = ({"count", "every"}, {"count", "apart"})


def at_the_same_time(scan: Scan, token: Token) -> None:
    """`A at the same time B` joins; behind `A and B` it makes a bracket of them, a P whatever they are."""
    entry = scan.stack[-1]
    if scan.raw[scan.at + 1].kind in STARTS_OPERAND | CONDITION_FORMS:
        connective(scan, token)
    elif entry.joints:
        for joint in entry.joints:
            joint.kind = "MEANWHILE"
        scan.next(token, False)
        entry.joints = []
        entry.operand = entry.chain
        scan.enclose(entry.chain)
    else:
        scan.fail("BT031", scan.span(token), words=scan.words(token))


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


def rule_after(scan: Scan, token: Token) -> None:
    """`stop whenever C`: a standing rule whose one command stands before its condition."""
    entry = scan.stack[-1]
    is_statement = entry.kind in ("top", "block") and entry.separator == "SEMI" and entry.statement == "open"
    end = next(at for at in range(scan.at, len(scan.raw)) if scan.raw[at].kind in ENDS)
    is_condition = all(each.kind not in ("then", "comma", "command", "otherwise") for each in scan.raw[scan.at : end])
    is_one = len(scan.out) == entry.begins + 1 and scan.out[-1].kind == "COMMAND"
    if not (is_statement and is_condition and is_one):
        side_by_side(scan, token)
        return
    is_first = entry.commands == entry.begins
    entry.mixed |= not is_first
    form_after(scan, token)
    if is_first:
        entry.commands = None


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
    scan.wrap_constraints(entry)
    scan.stack.pop()
    scan.emit("CLOSE", token)
    scan.next(token, False)


def end_statement(scan: Scan, token: Token) -> None:
    scan.close_forms()
    entry = scan.stack[-1]
    entry.close_chain()
    if entry.kind == "bracket" and token.kind != "semi":
        scan.fail("BT023", scan.span(entry.opener or token))
        return
    if entry.statement == "open":
        scan.wrap_constraints(entry)
        entry.statement = "ended"
        if entry.latest == entry.commands:  # the second one
            waits_first(scan, entry)
        entry.latest = entry.begins
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


_GOING_ON: dict[str, Callable[[Scan, Token], None]] = {
    **dict.fromkeys(("or", "meanwhile"), _widening),
    **dict.fromkeys(("do_that", "repeat_that", "again"), about_statement),
    "if_works": if_works,
    "in_any_case": in_any_case,
    "otherwise": otherwise,
    "stop_when": stopped,
}
"""What a word does behind a stop."""
