"""What may begin where an operand must come."""

from __future__ import annotations

from btlang.frontends.mission.grouping import constraints
from btlang.frontends.mission.grouping.bodies import block_follows, separator, set_amount, set_pace
from btlang.frontends.mission.grouping.conditions import AMOUNTS, CONDITION_FORMS, is_refused
from btlang.frontends.mission.grouping.lists import check_advice, lacks_neither, needs_check, stray
from btlang.frontends.mission.grouping.problems import found_words, no_operand, word_before
from btlang.frontends.mission.grouping.readings import started_over
from btlang.frontends.mission.grouping.scan import ENDS, Scan
from btlang.frontends.mission.grouping.stack import StackEntry
from btlang.frontends.mission.token import Called, Header, Listed, NodeCall, Token

SEPARATORS = {"in_parallel": "BLOCK_AND", "in_order": "BLOCK_OR", "node": "BLOCK_CHILD", "following": "SEMI"}
"""What begins a block, each with the token between its lines."""


_WHERE_IT_IS = ("AtPlace", "InZone")
_PREPOSITION_AND_ARTICLE = 2  # words
COMMANDS = frozenset(("command", "wait", "wait_until", "wait_for", "wait_up_to"))
"""What may stand in the head of `before waving, A`."""


def operand(scan: Scan, token: Token) -> None:
    if token.value.__class__ is Listed and lacks_neither(scan, token):
        stray(scan, token)
        return
    entry = scan.stack[-1]
    if entry.is_condition:
        if token.kind != "condition":
            before = scan.raw[scan.at - 1]
            place = f"after '{scan.words(before)}'" if before.end > before.start else "here"
            scan.fail("BT029", scan.span(token), words=scan.words(token), place=place)
            return
        scan.emit("CONDITION", token)
    else:
        if token.kind == "condition":
            _misplaced_condition(scan, token)
            return
        if constraints.taken(scan, token):
            return
        scan.begin_statement(token)
        scan.emit("COMMAND", token, token.kind if token.kind != "command" else "")
    scan.next(token, False)


def unknown(scan: Scan, token: Token) -> None:
    scan.begin_statement(token)
    scan.skip_statement()


def negation(scan: Scan, token: Token) -> None:
    if not scan.stack[-1].is_condition:
        if scan.condition_at(scan.at + 1):
            needs_check(scan, token)
            return
        scan.stack.append(StackEntry("condition"))  # for the message: what follows `not` is no condition
    scan.emit("NOT", token)
    scan.next(token, True)


def open_bracket(scan: Scan, token: Token) -> None:
    entry = scan.stack[-1]
    if entry.is_condition:
        scan.stack.append(StackEntry("condition bracket", scan.emit("COND_OPEN", token)))
    else:
        scan.begin_statement(token)
        scan.stack.append(StackEntry("bracket", scan.emit("OPEN", token)))
    scan.next(token, True)


def form(scan: Scan, token: Token) -> None:
    if is_refused(scan, token):
        return
    scan.begin_statement(token)
    opener = scan.emit("FORM", token, token.kind)
    scan.stack.append(StackEntry("condition", opener, scan.stack[-1], after="body"))
    scan.next(token, True)


def rule(scan: Scan, token: Token) -> None:
    """A standing rule begins a statement of the text or of a block that is a sequence."""
    entry = scan.stack[-1]
    if entry.kind not in ("top", "block") or entry.statement == "open" or entry.separator != "SEMI" or entry.last:
        scan.fail("BT037", scan.span(token), words=scan.words(token))
        return
    entry.mixed |= entry.commands is not None
    form(scan, token)
    entry.commands = None


def test(scan: Scan, token: Token) -> None:
    if is_refused(scan, token):
        return
    scan.begin_statement(token)
    scan.stack.append(StackEntry("condition", scan.emit("TEST", token, token.kind), after="end"))
    scan.next(token, True)


def loop(scan: Scan, token: Token) -> None:
    """repeat, try, if possible, retry, every 5 s, after 5 s, at 6 pm, every day at 6 pm, until 6 pm."""
    if is_refused(scan, token):
        return
    following = scan.raw[scan.at + 1]
    if token.kind == "repeat" and following.kind in ("until", "while"):
        scan.at += 1  # `repeat until` is a word of `until`
        scan.raw[scan.at] = Token(following.kind, token.start, following.end, following.value, following.role)
        return
    scan.begin_statement(token)
    opener = scan.emit("LOOP", token, "try" if token.kind == "if_possible" else token.kind)
    body = StackEntry("body", opener, scan.stack[-1])
    scan.next(token, True)
    if token.kind == "if_possible":
        body.else_owner = body
    elif token.kind == "every":
        body.pace_owner = body
    elif token.kind in ("repeat", "try", "retry"):
        if following.kind == "count" or (following.kind in ("for", "until_time") and token.kind == "repeat"):
            set_amount(scan, opener, following)
            scan.next(following, True)
            pace = scan.raw[scan.at]
            heads_block = pace.kind in ("every", "apart") and scan.raw[scan.at + 1].kind == "colon"
            if heads_block and following.kind == "count" and set_pace(opener, following, pace):
                scan.next(pace, True)
        elif not block_follows(scan):
            body.count_owner = body
            body.stop_owner = body if token.kind == "repeat" else body.stop_owner
        if token.kind != "repeat":
            body.else_owner = body
    scan.stack.append(body)
    separator(scan)


def label(scan: Scan, token: Token) -> None:
    """The name of a command before it: `"first try": go to the lab`."""
    at = scan.at + 1 + (scan.raw[scan.at + 1].kind == "check")
    said = scan.raw[at].value
    details = said.details if isinstance(said, Called) else said
    if isinstance(details, NodeCall) and details.name and scan.raw[at + 1].kind in ENDS:
        scan.fail("BT141", scan.span(token), words=scan.words(token), wanted="a node without another name")
        return
    loop(scan, token)


def front_amount(scan: Scan, token: Token) -> None:
    """`for 10 min, A`: as behind the command. A limit needs a `:`: `within 10 s, A, then B` has two readings."""
    marks = ("colon",) if token.kind in ("within", "by_time") else ("comma", "colon")
    (loop if scan.raw[scan.at + 1].kind in marks else no_operand)(scan, token)


def fronted(scan: Scan, token: Token) -> None:
    """`before going home, A`, `after you wave, A`, `while singing, A`, `if grasping the cup fails, A`."""
    if is_refused(scan, token):
        return
    if constraints.fronted(scan, token):
        return
    following = scan.raw[scan.at + 1]
    if following.kind == "unknown":
        scan.begin_statement(token)
        scan.skip_statement()
        return
    if following.kind not in COMMANDS:
        no_operand(scan, token)
        return
    scan.begin_statement(token)
    scan.stack.append(StackEntry("head", scan.emit("LOOP", token, token.kind), after=following.role))
    scan.next(token, True)


def after_head(scan: Scan, token: Token) -> bool:
    """Behind a command of the head of such a form: ends the head, unless what comes belongs to it."""
    entry = scan.stack[-1]
    assert entry.opener is not None
    if token.kind in AMOUNTS | CONDITION_FORMS:
        return False
    if token.kind in ("comma", "and", "or", "then") and entry.opener.role != "if_doing":
        joined = token.kind == "comma" and scan.raw[scan.at + 1].kind in ("and", "or", "then")
        following = scan.raw[scan.at + 1 + joined]
        if following.kind in COMMANDS and following.role == entry.after and (following.role or token.kind != "comma"):
            return False
    if token.kind in ENDS or token.kind in ("otherwise", "and", "or"):
        words = scan.span(entry.opener, scan.raw[scan.at - 1]).text
        scan.fail("BT020", scan.span(entry.opener), wanted="command", word=words, found=found_words(scan, token))
        return True
    entry.close_chain()
    scan.stack.pop()
    scan.emit("DO", token)
    body = StackEntry("body", entry.opener, scan.stack[-1])
    body.begins = len(scan.out)
    scan.stack.append(body)
    scan.operand_due = True
    separator(scan)
    return True


def joined_block(scan: Scan, token: Token) -> None:
    """`in parallel:`, `the first that works:` or a node that is said by its id, and the lines below."""
    if is_refused(scan, token):
        return
    scan.begin_statement(token)
    if token.kind == "node":
        opener = scan.emit("LOOP", token, "node")
        scan.stack.append(StackEntry("body", opener, scan.stack[-1]))
    colon = scan.raw[scan.at + 1]
    body = scan.raw[scan.at + 2] if colon.kind == "colon" else colon
    on_this_line = "\n" not in scan.source.text[colon.end : body.start]
    if colon.kind != "colon" or (on_this_line and body.kind not in ("indent", "dedent", "end")):
        scan.fail("BT035", scan.span(token), words=scan.words(token))
        return
    scan.next(token, True)
    scan.next(colon, True)
    if scan.raw[scan.at].kind == "indent":
        scan.open_block(SEPARATORS[token.kind])
    else:
        scan.skip_statement()  # the lexer has reported that the block is missing


def do_block(scan: Scan, token: Token) -> None:
    """`do this 3 times:` opens a block, as `repeat 3 times:` does; `do the following:` opens a plain one."""
    at = scan.at + 1
    if token.kind == "following" and scan.raw[at].kind not in AMOUNTS | CONDITION_FORMS:
        joined_block(scan, token)
        return
    while scan.raw[at].kind not in ENDS and scan.raw[at].kind != "colon":
        at += 1
    if scan.raw[at].kind == "colon":
        scan.raw[scan.at] = Token("repeat", token.start, token.end)
        loop(scan, scan.raw[scan.at])
    else:
        no_operand(scan, token)


def whole_block(scan: Scan, token: Token) -> None:
    """`start over`, `repeat everything 3 times`: all commands of the block before it, which it ends."""
    entry = scan.stack[-1]
    if entry.kind not in ("top", "block") or entry.statement != "ended" or entry.separator != "SEMI":
        scan.fail("BT067", scan.span(token), words=scan.words(token))
        return
    if entry.commands is None or entry.mixed:
        scan.fail("BT059", scan.span(token), words=scan.words(token))
        return
    if token.kind == "start_over":
        started_over(scan, token, entry)
    scan.enclose(entry.commands)
    entry.statement = "open"
    scan.next(token, False)
    following = scan.raw[scan.at]
    if following.kind in ("again", "comma"):
        scan.at += 1
    if scan.raw[scan.at].kind not in AMOUNTS | CONDITION_FORMS:
        scan.emit("POSTFIX", token, "count").value = "-1"


def leading_then(scan: Scan, token: Token) -> None:
    """`After that, go home`, `And wave` at the start of a statement join it as the line end does already."""
    entry = scan.stack[-1]
    is_first = token.kind == "and" and not scan.out
    if is_first or not entry.is_group or entry.last is not None or entry.statement == "open":
        no_operand(scan, token)
        return
    scan.next(token, True)
    if scan.raw[scan.at].kind == "comma":
        scan.at += 1


def definition(scan: Scan, token: Token) -> None:
    assert isinstance(token.value, Header)
    scan.header = token.value
    scan.out, scan.stack = [], [StackEntry("top")]
    if token.value.name in scan.conditions:
        scan.stack.append(StackEntry("condition", after="definition"))
    scan.next(token, True)
    separator(scan)


def _misplaced_condition(scan: Scan, token: Token) -> None:
    """BT028. Behind a preposition alone more often stands where something is done than where the robot is."""
    words, value = scan.words(token), token.value
    place = value.arguments[-1][1] if isinstance(value, Called) and value.entry.id in _WHERE_IT_IS else ""
    if place and len(words.split()) - len(place.split()) <= _PREPOSITION_AND_ARTICLE:
        journey = f", or how to get to {place}" if place[0].isalnum() else ""
        scan.fail("BT028", scan.span(token), words=words, advice=f"Say what is done there{journey}.")
        return
    if scan.at and scan.raw[scan.at - 1].kind in ("before", "after"):  # a check would be a step of its own
        scan.fail("BT028", scan.span(token), words=words, advice="A command must stand there.")
        return
    fix, advice = word_before(scan, token, "check"), check_advice(scan, words)
    scan.fail("BT028", scan.span(token), fix, words=words, advice=advice)
