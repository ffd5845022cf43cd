"""Commands that constrain the others of their statement: `go to the lab without entering the kitchen`, `avoid Z and A`.

Wherever such a command stands in a statement (or bracket), it holds over the whole of it: what joins it to the others
is left out, and the statement is put into a loop of one round when it ends. Where it stands alone, among others of its
kind, or behind `then`, it is a command like any other and holds from there on.
"""

from __future__ import annotations

from btlang.frontends.mission.grouping.scan import ENDS, Scan
from btlang.frontends.mission.token import CONSTRAINT_JOINTS, Called, Listed, Token, constraint_of, only_constrains
from btlang.vocabulary.capabilities import MOVES

_FRONTED = frozenset(("and", "comma", "while_doing", "meanwhile"))
"""What may stand between a constraint in front and the commands that it is about."""
_UNTIL = frozenset(("until", "before"))
"""The same where the command ends what is forbidden: `avoid the kitchen until going to the lab`."""
_PLAIN = frozenset(("and", "comma"))
_BEFORE_COMMANDS = frozenset(("DO", "ELSE", "LOOP", "STOP", "THEN"))
"""Behind these nothing has been said that a constraint could hold over."""
_GOES_ON = frozenset(("then", "otherwise"))


def taken(scan: Scan, token: Token) -> bool:
    """Takes a constraint where an operand must come; False for any other token, and where it is a command itself."""
    constraint = constraint_of(token)
    if constraint is None:
        return False
    entry, _ = scan.around_statement()
    has_more = (entry.statement == "open" or not entry.is_group) and len(scan.out) > entry.begins
    follows_others = has_more and only_constraints(scan)
    if has_more and not follows_others:
        if scan.out[-1].kind in ("OR", "OR_ELSE", "WIDE_OR"):
            words = scan.words(token)
            scan.fail(
                "BT155", scan.span(token), words=words, advice=f"Write for example: {words} {scan.word('and')} ..."
            )
            return True
        if scan.out[-1].kind not in CONSTRAINT_JOINTS:
            return False
        _unjoin(scan)
        entry.constraints.append(constraint)
        scan.next(token, False)
        return True
    behind = 0 if follows_others else _behind_joint(scan, constraint.kind == "keep in")
    if not behind and constraint.kind == "keep in" and len(constraint.zones) > 1:
        words, reason = scan.words(token), "alone it takes one zone"
        advice = f"Say what is done there: {words} {scan.word('and')} ..."
        scan.fail("BT152", scan.span(token), words=words, reason=reason, advice=advice)
        return True
    if not behind:
        return False
    if scan.raw[behind - 1].kind in _UNTIL and scan.raw[behind + 1].kind not in ENDS:
        _enclose(scan, behind)  # `avoid the hall until going to the lab, then go to the hall`
        return True
    entry.constraints.append(constraint)
    scan.at = behind
    return True


def fronted(scan: Scan, token: Token) -> bool:
    """`while remaining in the hall, A`: takes the constraint with the word before it."""
    constraint = constraint_of(scan.raw[scan.at + 1]) if token.kind == "while_doing" else None
    following = scan.raw[scan.at + 2] if constraint is not None else token
    if constraint is None or following.kind not in ("comma", "and", "then"):
        return False
    scan.around_statement()[0].constraints.append(constraint)
    scan.at += 3
    return True


def behind(scan: Scan, token: Token) -> bool:
    """Takes a constraint that stands right behind a command: `go to the lab avoiding the kitchen`."""
    constraint = constraint_of(token)
    if constraint is None or scan.stack[-1].is_condition:
        return False
    if only_constraints(scan):  # `never enter the hall never enter the lab`
        scan.stack[-1].begin_chain()
        scan.stack[-1].connective(scan.emit("COMMA", Token("comma", token.start, token.start)))
        scan.operand_due = True
        return True
    scan.around_statement()[0].constraints.append(constraint)
    scan.next(token, False)
    return True


def only_constraints(scan: Scan) -> bool:
    """Whether nothing but constraints is said in the statement (or bracket), before and behind: they are commands.

    So also in the body of a form, and behind `then`.
    """
    said = scan.out[scan.around_statement()[0].begins :]
    first = next((at + 1 for at in reversed(range(len(said))) if said[at].kind in _BEFORE_COMMANDS), 0)
    return only_constrains(said[first:]) and _ends_in_constraints(scan, scan.at, bool(first))


def _ends_in_constraints(scan: Scan, at: int, may_go_on: bool = False) -> bool:
    """Whether nothing but constraints stands from a place on to the end of the statement, or what goes on with it."""
    while scan.raw[at].kind in _PLAIN or constraint_of(scan.raw[at]) is not None:
        at += 1
    ends = scan.raw[at].kind in ENDS
    return ends or (may_go_on and (scan.raw[at].kind in _GOES_ON or scan.raw[at - 1].kind in _PLAIN))


def _unjoin(scan: Scan) -> None:
    """Leaves out the connective before the constraint."""
    joint, entry = scan.out.pop(), scan.stack[-1]
    entry.commas = [comma for comma in entry.commas if comma is not joint]
    entry.joints = [other for other in entry.joints if other is not joint]
    entry.last = entry.commas[-1] if entry.commas else entry.joints[-1] if entry.joints else None


def _enclose(scan: Scan, command: int) -> None:
    """Puts the constraint that comes and the command that ends it into brackets."""
    joint, last, start = scan.raw[command - 1], scan.raw[command].end, scan.raw[scan.at].start
    scan.raw[command + 1 : command + 1] = [Token("close", last, last)]
    scan.raw[scan.at + 1 : command] = [Token("and", joint.start, joint.end)]
    scan.raw[scan.at : scan.at] = [Token("open", start, start)]


def _behind_joint(scan: Scan, stays: bool) -> int:
    """The place of the first command that a constraint in front is about; 0 where there is none.

    What is avoided is so on a journey; who `stays` somewhere does so whatever is done.
    """
    at, raw = scan.at + 1, scan.raw
    if raw[scan.at].role == "fronted" and raw[at].kind == "command":
        return at if _has_journey(scan, at) else 0  # `without entering the kitchen go to the lab`
    if raw[at].kind == "comma" and raw[at + 1].kind in ("and", *_UNTIL):
        at += 1
    ends = raw[at].kind in _UNTIL
    if not (ends or raw[at].kind in _FRONTED):
        return 0
    at += 1
    if _ends_in_constraints(scan, at):
        return 0  # `stay in the lab and avoid the kitchen`
    if stays and raw[at].kind in ("wait", "wait_time", "wait_until"):
        return at  # `stay in the kitchen and wait until Bob comes`
    while constraint_of(raw[at]) is not None and raw[at + 1].kind in _FRONTED:
        return at if _has_journey(scan, at) else 0  # `avoid A and avoid B and go to C`
    if raw[at].kind != "command" and (ends or raw[at].kind not in ("open", "repeat", "try", "retry", "if", "unless")):
        return 0
    return at if stays or _has_journey(scan, at) else 0


def _has_journey(scan: Scan, at: int) -> bool:
    """Whether something in the rest of the statement moves the robot."""
    while scan.raw[at].kind not in ENDS or scan.raw[at].kind == "close":
        token = scan.raw[at]
        if token.kind == "command" and type(token.value) in (Called, Listed) and constraint_of(token) is None:
            entry = token.value.entry  # type: ignore[union-attr]
            if entry.sort == "name" or MOVES in entry.resources:
                return True
        at += 1
    return False
