"""What is wrong with the syntax (BT020 to BT037), in words, and how it may be mended."""

from __future__ import annotations

from btlang.frontends.mission.grouping.scan import ENDS, STARTS_STATEMENT, Scan
from btlang.frontends.mission.token import RULES, Token
from btlang.text.source import Span
from btlang.vocabulary.language_tables import CONNECTIVES, GOES_ON

_COMMANDS = frozenset(("command", "wait", "wait_time", "wait_forever", "nothing", "fail", "open"))
_FORBIDS = frozenset(("if", "until", "while", "as_soon_as", "provided"))
_FOUND = {
    "newline": "the line ends",
    "stop": "the sentence ends",
    "semi": "the sentence ends",
    "close": "the bracket closes",
}


def no_operand(scan: Scan, token: Token) -> None:
    """Something stands where a command or condition must."""
    entry = scan.stack[-1]
    before = scan.raw[scan.at - 1] if scan.at else None
    wanted = "condition" if entry.is_condition else "command"
    starts = before is None or before.kind in STARTS_STATEMENT
    if starts and token.kind in GOES_ON - {"in_parallel"}:
        scan.fail("BT067", scan.span(token), words=scan.words(token))
    elif starts and token.kind in ENDS:
        nothing_there(scan, token, before)
    elif token.kind == "colon":
        scan.fail("BT026", scan.span(token))
    elif starts and token.kind == "comma":
        scan.fail("BT032", scan.span(token), (with_blanks(scan, token), ""), place="at the start", advice="Remove it.")
    elif token.kind in ("do_that", "repeat_that", "again"):
        scan.fail("BT067", scan.span(token), words=scan.words(token))
    elif starts or token.kind not in ENDS | {*CONNECTIVES, "otherwise", "comma"}:
        scan.fail("BT022", scan.span(token), word=scan.words(token))
    elif before is not None and before.kind == "comma" and token.kind in ENDS:
        advice = "Remove it, or add what follows."
        scan.fail("BT032", scan.span(before), (scan.span(before), ""), place="at the end", advice=advice)
    elif before is not None:
        scan.fail("BT020", scan.span(before), wanted=wanted, word=scan.words(before), found=found_words(scan, token))


def nothing_there(scan: Scan, token: Token, before: Token | None) -> None:
    entry = scan.stack[-1]
    if token.kind == "close" and before is not None and before.kind == "open":
        scan.fail("BT025", scan.span(before, token))
    elif token.kind == "close" and entry.kind == "bracket" and not entry.statement and entry.opener is not None:
        scan.fail("BT025", scan.span(entry.opener, token))  # `( ; )`
    elif before is not None and before.kind == "define":
        words = scan.words(before)
        scan.fail("BT020", scan.span(before), wanted="command", word=words, found="nothing does")
    else:
        scan.operand_due = False  # an empty line or sentence


def side_by_side(scan: Scan, token: Token) -> None:
    if token.kind == "unknown":
        scan.skip_statement()
        return
    before = scan.raw[scan.at - 1]
    if token.kind in RULES:
        scan.fail("BT037", scan.span(token), words=scan.words(token))
        return
    scan.fail("BT021", scan.span(before, token), word_before(scan, token, "then"), word=scan.words(token))


def not_a_condition(scan: Scan, token: Token) -> None:
    """`wave for more than 10 s`."""
    seconds = scan.words(token).split()
    at = next((at for at, word in enumerate(seconds) if word[:1].isdigit()), 1)
    example = f"... {scan.word('for')} {' '.join(seconds[at:])}"
    scan.fail(
        "BT150", scan.span(token), words=scan.words(token), reason="only a condition holds so long", example=example
    )


def not_known_yet(scan: Scan, opener: Token, amount: Token) -> None:
    """`if nobody is near for 5 min, A`: nobody has watched."""
    condition = scan.source.text[opener.end : scan.last_end].strip()
    example = f"{scan.word('whenever')} {condition} {scan.words(amount)}, ..."
    reason = "how long it has been so isn't known here"
    scan.fail("BT150", scan.span(amount), words=scan.words(amount), reason=reason, example=example)


def waits_for_how_long(scan: Scan, opener: Token, amount: Token) -> None:
    """`wait for C for 10 s`."""
    text, span = scan.source.text, scan.span(opener, amount)
    until = f"{scan.word('wait_until')} {text[opener.end : scan.last_end].strip()}"
    seconds = text[amount.start : amount.end].split(maxsplit=1)[-1]
    at_most = f"{scan.word('up_to')} {seconds}"
    scan.fail("BT058", span, words=span.text, until=until, amount=scan.words(amount), at_most=at_most)


def prohibition(scan: Scan, token: Token) -> None:
    """`don't A if C`, `if C, don't A`: offers what does A only where C is not so."""
    rest = scan.raw[scan.at + 1 :]
    end = next(at for at, each in enumerate(rest) if each.kind in ENDS)
    form = next((at for at, each in enumerate(rest[:end]) if each.kind in _FORBIDS), end)
    opener = scan.stack[-1].opener
    condition = _between(scan, rest[form:end])
    if not condition and scan.stack[-1].kind == "body" and opener is not None and opener.role == "if":
        condition = scan.source.text[opener.end : token.start].strip(" ,")
    is_known = all(each.kind != "unknown" for each in rest[:form])
    what = _between(scan, [token, *rest[:form]]) or "wave"
    advice = "It does only what it is told, so leave this out, or say what to do in its place."
    if form < end:
        advice = "It does only what it is told. Say what to do in its place, and when."
    if form < end and rest[form].kind == "until":
        advice = f"Write for example: {scan.word('wait_until')} {condition}"
    elif condition and is_known:  # nothing is offered that can't be read
        failing = f"{scan.word('whenever')} {condition}, {scan.word('fail')}"
        advice = f"Write for example: {scan.word('unless')} {condition}, {what}"
        advice += f". Or: {what} {scan.word('stop_when')} {condition}. Or: {failing}"
    span = scan.span(token, rest[end - 1] if end else token)
    scan.fail("BT155", span, words=scan.words(token), advice=advice)


def without(scan: Scan, token: Token) -> None:
    """`A without D-ing`: offers to end A early; `A without it` says nothing that the robot would do."""
    entry = scan.stack[-1]
    start = scan.out[entry.operand].start if entry.operand < len(scan.out) else token.start
    end = next(at for at in range(scan.at, len(scan.raw)) if scan.raw[at].kind in ENDS)
    advice = "It does only what it is told, so leave this out."
    if scan.raw[scan.at + 1].kind in ("command", "name"):
        advice = f"Write for example: {scan.source.text[start : scan.last_end]} {scan.word('stop_when')} ..."
    scan.fail("BT155", scan.span(token, scan.raw[end - 1]), words=scan.words(token), advice=advice)


def _between(scan: Scan, tokens: list[Token]) -> str:
    """The text behind the first of some tokens, to the end of the last."""
    return scan.source.text[tokens[0].end : tokens[-1].end].strip(" ,") if tokens else ""


def is_alone(scan: Scan) -> bool:
    """Whether one command stands before this place in its bracket: what comes can be about nothing else."""
    entry = scan.stack[-1]
    return entry.is_group and entry.last is None


def both_readings(scan: Scan, form: Token) -> str:
    """What a form behind a comma may be about, as two texts: the command before it, or all in this bracket."""
    first = last = scan.at
    depth = 0
    while first and (depth or scan.raw[first - 1].kind not in STARTS_STATEMENT):
        first -= 1
        depth += (scan.raw[first].kind == "close") - (scan.raw[first].kind == "open")
        if not depth and last == scan.at and scan.raw[first].kind in _COMMANDS:
            last = first
    end = form.end
    if form.kind == "provided":
        end = next(token.start for token in scan.raw[scan.at :] if token.kind in ENDS)
    text, start, command = scan.source.text, scan.raw[first].start, scan.raw[last].start
    before, form_words = text[start : scan.raw[scan.at].start], text[form.start : end].strip()
    one = f"{before[: command - start]}({before[command - start :]} {form_words})"
    return f"Write what you mean: {one}, or: ({before}) {form_words}"


def word_before(scan: Scan, token: Token, role: str) -> tuple[Span, str]:
    """A fix: the word of a role put before a token."""
    return Span(scan.source, token.start, token.start), f"{scan.word(role)} "


def with_blanks(scan: Scan, token: Token) -> Span:
    text = scan.source.text
    return Span(scan.source, token.start, len(text) - len(text[token.end :].lstrip(" \t")))


def found_words(scan: Scan, token: Token) -> str:
    if token.kind in _FOUND:
        return _FOUND[token.kind]
    if token.kind in ENDS:
        return "the mission ends"
    return f"'{scan.words(token)}' comes next" if scan.words(token) else "the sentence ends"
