"""Words before several conditions or commands: `neither C nor D`, `at least two of C, D and E`, `one of A, B`."""

from __future__ import annotations

from btlang.frontends.mission.grouping.problems import word_before
from btlang.frontends.mission.grouping.scan import ENDS, Scan
from btlang.frontends.mission.grouping.stack import StackEntry
from btlang.frontends.mission.token import Listed, Token
from btlang.text.source import Span

_WANTED = {"neither": "nor", "not_both": "and", "either": "or", "both": "and"}
"""The word that must stand between the parts."""
_COMMANDS = frozenset(("command", "wait", "wait_forever", "nothing", "fail", "open", "unknown"))
_PLAIN = frozenset((
    *_COMMANDS, "condition", "not", "close", "comma", "again",
    "count", "for", "up_to", "apart", "within", "by_time", "every", "delay", "if_possible",
))  # fmt: skip
"""What may stand between `either` or `both` and the word that joins."""


def quantifier(scan: Scan, token: Token) -> None:
    """Opens a list of conditions."""
    if not scan.stack[-1].is_condition:
        if not scan.condition_at(scan.at + 1):
            words = f"{scan.word('check')} {scan.words(token)} ..."
            example = f"{scan.word('one_of')} {_rest(scan, token)}" if token.kind == "any_of" else words
            _misfit(scan, token, "conditions must follow", example)
            return
        needs_check(scan, token)
        return
    scan.stack.append(StackEntry("condition list", scan.emit("COND_OF", token, token.kind)))
    scan.stack[-1].begins = scan.at
    scan.next(token, True)


def needs_check(scan: Scan, token: Token) -> None:
    """BT028 for a condition in the place of a command that begins with `not` or words for a list."""
    last = scan.raw[scan.at + 1]
    span = scan.span(token, last if last.kind == "condition" else token)
    scan.fail("BT028", span, word_before(scan, token, "check"), words=span.text, advice=check_advice(scan, span.text))


def check_advice(scan: Scan, words: str) -> str:
    """What to write for a condition that is to be a step."""
    return f"To make it a step that fails when it isn't true, write: {scan.word('check')} {words}"


def after_item(scan: Scan, entry: StackEntry, token: Token) -> None:
    """Another condition of a list, or its end: behind a list of values, or where nothing joins that may."""
    opener = entry.opener
    assert opener is not None
    wanted, value = _WANTED.get(opener.role, ""), scan.raw[scan.at - 1].value
    entry.items += 1
    is_whole = entry.begins == scan.at - 2 - _is_in_verb(scan.raw[scan.at - 2])
    if isinstance(value, Listed) and is_whole and (opener.role != "not_both" or value.joiner == wanted):
        entry.items = len(value.arguments)
    elif _goes_on(scan, entry, wanted):
        return
    elif wanted and (entry.last is None or entry.last.role != wanted):
        _not_joined(scan, entry.begins, wanted)
        return
    elif entry.items < 2:
        _misfit(
            scan, opener, "two conditions or more must follow", f"{scan.words(opener)} ..., ... {scan.word('and')} ..."
        )
        return
    number = opener.value if opener.role == "at_least_of" and isinstance(opener.value, str) else "1"
    if not number.isdigit() or int(number) > entry.items:
        reason = f"{entry.items} conditions follow" if number.isdigit() else "the number must be known"
        example = f"{scan.word('all_of')} {scan.source.text[opener.end : scan.last_end].strip()}"
        _misfit(scan, opener, reason, example)
        return
    scan.stack.pop()
    scan.out.append(Token("COND_CLOSE", scan.last_end, scan.last_end))


def _goes_on(scan: Scan, entry: StackEntry, wanted: str) -> bool:
    """Whether another condition of the list follows, which is then begun."""
    joint, following = _joint(scan)
    if not joint or not scan.condition_at(following):
        return False
    if wanted:
        is_first = entry.last is None or entry.last.role == "comma"
        if not (joint == "nor" == wanted or (is_first and joint in (wanted, "comma"))):
            return False
    elif joint == "nor":
        return False
    entry.last = scan.emit("COND_OR", scan.raw[scan.at], joint)
    _begin(scan, following)
    return True


def _joint(scan: Scan) -> tuple[str, int]:
    """What stands between two parts here, "" where nothing does, and where the next part begins."""
    at = scan.at
    has_comma = scan.raw[at].kind == "comma"
    at += has_comma
    kind = scan.raw[at].kind
    if kind in ("and", "or", "nor"):
        return kind, at + 1
    return ("comma" if has_comma else ""), at


def _begin(scan: Scan, following: int) -> None:
    scan.at, scan.operand_due = following, True
    scan.last_end = scan.raw[following - 1].end


def choice(scan: Scan, token: Token) -> None:
    """Opens `one of A, B, C`."""
    following = scan.raw[scan.at + 1]
    if scan.stack[-1].is_condition or scan.condition_at(scan.at + 1):
        word = scan.word("any_of")
        _misfit(scan, token, f"between conditions it is '{word}'", f"{word} {_rest(scan, token)}")
        return
    if following.kind not in _COMMANDS:
        _misfit(scan, token, "a list of commands must follow", f"{scan.words(token)} wave, nod")
        return
    scan.begin_statement(token)
    scan.stack.append(StackEntry("choice", scan.emit("OPEN", token), scan.stack[-1]))
    scan.stack[-1].begins = scan.at
    scan.next(token, True)


def after_choice(scan: Scan, token: Token) -> None:
    """Another command of `one of`, or its end."""
    if token.kind == "again":
        scan.next(token, False)
        return
    entry, made = scan.stack[-1], scan.out[-1]
    opener = entry.opener
    assert opener is not None
    entry.items += 1
    if isinstance(made.value, Listed) and made.kind == "COMMAND":
        made.value = made.value.replace(joiner="or")
        entry.items += entry.begins == scan.at - 2
    joint, following = _joint(scan)
    if joint in ("comma", "and", "or") and scan.raw[following].kind in _COMMANDS:
        scan.emit("BLOCK_OR", token)
        _begin(scan, following)
    elif entry.items < 2:
        _misfit(scan, opener, "two commands or more must follow", f"{scan.words(opener)} wave, nod")
    else:
        scan.stack.pop()
        scan.out.append(Token("CLOSE", scan.last_end, scan.last_end))


def correlative(scan: Scan, token: Token) -> None:
    """`either A or B`, `both A and B`: the words say nothing, but nothing looser may stand before what joins."""
    wanted, entry = _WANTED[token.kind], scan.stack[-1]
    if scan.out and scan.out[-1].kind == "NOT":
        words = ("neither", "nor") if token.kind == "either" else ("not_both", "and")
        example = " ... ".join([*map(scan.word, words), ""]).strip()
        _misfit(scan, token, f"'{scan.words(scan.raw[scan.at - 1])}' stands before it", example)
        return
    if not entry.is_condition and scan.condition_at(scan.at + 1):
        needs_check(scan, token)
        return
    at, depth, commas = scan.at + 1, 0, 0
    while True:
        part = scan.raw[at]
        if not depth and (part.kind == wanted or (isinstance(part.value, Listed) and part.value.joiner == wanted)):
            break
        is_loose = not depth and part.kind not in _PLAIN and not (part.kind == "and" and wanted == "or")
        if is_loose or (part.kind in ENDS and not (depth and part.kind in ("close", "semi"))):
            _not_joined(scan, scan.at, wanted)
            return
        depth += (part.kind == "open") - (part.kind == "close")
        commas += not depth and part.kind == "comma"
        at += 1
    if commas == 1 and scan.raw[at - 1].kind == "comma" and entry.last is not None:
        joint = scan.raw[at]  # the comma would widen it over what stands before
        before = scan.source.text[token.start : scan.raw[at - 1].start].strip()
        reason = f"there is a comma before '{scan.words(joint)}'"
        _misfit(scan, token, reason, f"{before} {scan.words(joint)} {_rest(scan, joint)}")
        return
    entry.settle()
    scan.next(token, True)


def stray(scan: Scan, token: Token) -> None:
    """`nor` without `neither`, also in a list of values."""
    word, words = scan.word("neither"), scan.words(token)
    example = f"{word} ... {words} ..." if token.kind == "nor" else f"{word} {words}"
    _misfit(scan, token, f"'{word}' must stand before it", example)


def lacks_neither(scan: Scan, token: Token) -> bool:
    """Whether an operand is a list with `nor` that no `neither` stands before."""
    if not isinstance(token.value, Listed) or token.value.joiner != "nor":
        return False
    return scan.raw[scan.at - 1 - _is_in_verb(scan.raw[scan.at - 1])].kind != "neither"


def _is_in_verb(token: Token) -> bool:
    """Whether it is the `not` of the verb behind it."""
    return token.kind == "not" and token.start == token.end


def _not_joined(scan: Scan, at: int, wanted: str) -> None:
    """No word joins the parts where it must: offers brackets round what stands before it, or it for another one."""
    opener, text, joint = scan.raw[at], scan.source.text, scan.word(wanted)
    depth, joints = 0, dict[str, Token]()
    end = at + 1
    while scan.raw[end].kind not in ENDS or (scan.raw[end].kind in ("close", "semi") and depth):
        token = scan.raw[end]
        if not depth:
            joints.setdefault(token.kind, token)
        depth += (token.kind == "open") - (token.kind == "close")
        end += 1
    words, fix = scan.words(opener), None
    found = joints.get(wanted) or joints.get("and") or joints.get("or")
    if found is None:
        example = f"{words} ... {joint} ..."
    else:
        before, behind = text[opener.end : found.start].strip(" ,"), text[found.end : scan.raw[end].start].strip()
        if found.kind == wanted:
            example = f"{words} ({before}) {joint} {behind}"
        else:
            example = f"{words} {before} {joint} {behind}"
            fix = (scan.span(found), joint) if wanted == "nor" else None  # of `either A and B` either word may be wrong
    _misfit(scan, opener, f"'{joint}' must join what follows", example, fix)


def _rest(scan: Scan, token: Token) -> str:
    """The words behind a token, to the end of the statement or bracket."""
    end = next(other.start for other in scan.raw[scan.at :] if other.kind in ENDS and other.start >= token.end)
    return scan.source.text[token.end : end].strip()


def _misfit(scan: Scan, token: Token, reason: str, example: str, fix: tuple[Span, str] | None = None) -> None:
    scan.fail("BT150", scan.span(token), fix, words=scan.words(token), reason=reason, example=example)
