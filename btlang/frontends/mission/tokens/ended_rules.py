"""Constraints that depend on a condition: `avoid the hall until Bob arrives`, `avoid the hall while Bob is there`.

A zone is closed until then, whatever comes behind: the first time that the condition holds, it is opened. With `while`,
`if` or `unless` two standing rules close it whenever the condition begins to hold and open it whenever that ends. Who
stays somewhere waits there until then, or so long: `stay in the kitchen until Bob arrives`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.token import (
    JOINTS,
    KEEP_OUT,
    LINES,
    STATEMENT_ENDS,
    WAITING,
    Called,
    Listed,
    Token,
    arguments_of,
    begins_condition,
    constraint_of,
    drives,
    keeps_out,
    run_end,
    run_start,
    statement_end,
    statement_start,
    texts_of,
)
from btlang.text.source import Span
from btlang.text.time_of_day import seconds_of, shown
from btlang.tree.answers import PERSON_SAYS, SOMEBODY_SAYS
from btlang.tree.rounds import DAYTIME
from btlang.tree.sums import COUNTING
from btlang.vocabulary.antecedents import says_there
from btlang.vocabulary.entry import Entry
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.value_type import PLACE

_MOMENT = 600.0  # seconds in which a rule notices that it has become a time
_EXAMPLE = "6 pm"
_MOMENT_ONLY = "it is so for a moment only"
_HEADS = frozenset(("every", "every_day", "at", "delay"))
_OPEN, GO = "OpenZone", "GoTo"
_NOT_DONE = "a definition is done once, and this holds all the time"
_IN_THE_MISSION = "Write it as a sentence of the mission."
_ENDS = frozenset(("newline", "semi", "stop", "dedent", "close"))
_IN_CONDITIONS = frozenset(("condition", "not", "open", "either", "neither", "both"))
_ENDING = frozenset((*WAITING, "up_to"))
THERE = {"SeesPerson": "PersonIsAt", "SeesSomeone": "SomeoneIsAt", "SeesObject": "ObjectIsAt"}
"""What asks where somebody or something is, by what asks whether the robot sees it."""
_WHILE = frozenset(("while", "if", "unless"))
"""Raw kinds behind which a condition says how long a zone stays closed."""


def with_ends(tokens: list[Token], vocabulary: Lexicon, span: Callable[[int, int], Span]) -> list[Diagnostic]:
    """Make two statements of each constraint to keep out that depends on a condition: the second opens its zones.

    Returns what is wrong with constraints that a duration ends (BT161), or that stand in a statement with others before
    a condition (BT151); `span` gives the place of some characters.
    """
    opening, clock = vocabulary.entry(_OPEN), vocabulary.entry(DAYTIME)
    problems: list[Diagnostic] = []
    _end_whole_rules(tokens, vocabulary, span)
    if opening is not None:
        _front(tokens)
        problems += _never_opened(tokens, opening, vocabulary, span)
    at = 0
    while at + 1 < len(tokens):
        until = tokens[at + 1]
        begins = _begins(tokens, at)
        is_next = until.kind in WAITING and _is_next(tokens, at)
        constraint = constraint_of(tokens[at]) if (begins or is_next) and until.kind in _ENDING else None
        is_timed = constraint is not None and constraint.kind == KEEP_OUT and until.kind == "until_time"
        if is_timed and opening is not None and _waits_behind(tokens, at, at + 2, opening):
            pass  # `avoid the hall until 6 pm, then go to the hall`
        elif constraint is not None and constraint.kind == "keep in" and until.kind in WAITING:
            _wait(tokens, at, vocabulary)
        elif is_timed and opening is not None and clock is not None and (begins or _is_headed(tokens, at)):
            then = Token("condition", until.start, until.end, comes(str(until.value), clock))
            tokens[at + 1 : at + 2] = [Token("until", until.start, until.start), then]
            _open_again(tokens, at, opening)
        elif constraint is not None and until.kind != "until":
            forbidden, whole = span(tokens[at].start, tokens[at].end).text, span(tokens[at].start, until.end)
            example = f"{forbidden} {vocabulary.word('until')} {_EXAMPLE}"
            problems.append(diagnostic("BT161", whole, words=whole.text, example=example))
        elif constraint is not None and opening is not None and begins_condition(tokens, at + 2):
            _open_again(tokens, at, opening)
        elif until.kind in _WHILE and begins_condition(tokens, at + 2) and keeps_out(tokens[at]):
            if at > 0 and tokens[at - 1].kind == "define":
                whole = span(tokens[at].start, tokens[_condition_end(tokens, at + 2)[0] - 1].end)
                problems.append(diagnostic("BT152", whole, words=whole.text, reason=_NOT_DONE, advice=_IN_THE_MISSION))
            elif _is_momentary(tokens, at + 2):
                problems.append(_only_then(tokens, at, vocabulary, span))
            elif (further := _otherwise_behind(tokens, at)) is not None:
                problems.append(_what_then(further, tokens, at, vocabulary, span))
            elif begins and opening is not None:
                _say_where(tokens, at, vocabulary, span)
                _close_while(tokens, at, opening)
            elif not begins:
                problems.append(_two_readings(tokens, at, vocabulary, span))
        at += 1
    return problems


def comes(time: str, clock: Entry) -> Called:
    """The condition that it has just become a time of day: `after 6 am` would hold in the evening before."""
    over = shown(seconds_of(time) + _MOMENT)
    return Called(clock, (("at_least", time), ("at_most", over)))


def _end_whole_rules(tokens: list[Token], vocabulary: Lexicon, span: Callable[[int, int], Span]) -> None:
    """Make `never enter the hall, and if C, A` two statements: what is always forbidden isn't so for A alone.

    The same for `avoid the hall while C, and if D, A`.
    """
    for at, token in enumerate(tokens):
        if not _begins(tokens, at) or not keeps_out(token):
            continue
        is_while = tokens[at + 1 : at + 2] and tokens[at + 1].kind in _WHILE and begins_condition(tokens, at + 2)
        last, behind = _condition_end(tokens, at + 2) if is_while else (at + 1, run_end(tokens, at + 1, JOINTS))
        if behind > last and tokens[behind : behind + 1] and tokens[behind].kind in ("if", "unless"):
            said = span(tokens[at - 1].end if at else 0, token.end).text.lower().split()
            if is_while or not set(vocabulary.asking["whole"]).isdisjoint(said):
                tokens[last:behind] = [Token("semi", tokens[last - 1].end, tokens[behind].start)]


def _front(tokens: list[Token]) -> None:
    """Put what is forbidden in front: `while Bob is in the hall, avoid it`, `until 6 pm, avoid the hall`."""
    for at, token in enumerate(tokens):
        is_time = token.kind == "until_time"
        asks = token.kind in ("while", "until") and begins_condition(tokens, at + 1)
        if (is_time or asks) and _begins(tokens, at):
            last, behind = _condition_end(tokens, at + 1) if asks else (at + 1, run_end(tokens, at + 1, JOINTS))
            if behind > last and _is_alone(tokens, behind):
                tokens[at : behind + 1] = [tokens[behind], *tokens[at:last]]


def _begins(tokens: list[Token], at: int) -> bool:
    return at == 0 or tokens[at - 1].kind in LINES


def _is_alone(tokens: list[Token], at: int) -> bool:
    """Whether a constraint to keep out ends its statement."""
    return keeps_out(tokens[at]) and (at + 1 == len(tokens) or tokens[at + 1].kind in _ENDS)


def _never_opened(
    tokens: list[Token], opening: Entry, vocabulary: Lexicon, span: Callable[[int, int], Span]
) -> list[Diagnostic]:
    """Return warnings for `whenever C, avoid the hall`, `if C, avoid the hall`: nothing opens it again."""
    if any(isinstance(token.value, Called | Listed) and token.value.entry.id == opening.id for token in tokens):
        return []
    problems = []
    for at, token in enumerate(tokens):
        if token.kind not in ("whenever", "if") or not _begins(tokens, at):
            continue
        last, behind = _condition_end(tokens, at + 1)
        if behind > last and _is_alone(tokens, behind):
            whole = span(token.start, tokens[behind].end)
            forbidden = span(tokens[behind].start, tokens[behind].end).text
            condition = span(tokens[at + 1].start, tokens[last - 1].end).text
            other = f"{vocabulary.word('while')} {condition}, {forbidden}"
            taken = f"{whole.text}, and it stays so"
            problems.append(diagnostic("BT050", whole, taken=taken, fixed=whole.text, other=other))
    return problems


def _close_while(tokens: list[Token], at: int, opening: Entry) -> None:
    """Put two rules for `avoid the hall while C`: one that closes it when C begins to hold, and one that opens it."""
    closing, begin = tokens[at], tokens[at + 1]
    last, behind = _condition_end(tokens, at + 2)
    condition, end = tokens[at + 2 : last], tokens[last - 1].end
    comma, semi = Token("comma", end, end), Token("semi", end, end)
    held, over = condition, _denied(condition, begin.start, end)
    if begin.kind == "unless":
        held, over = over, held
    command = Token("command", end, end, _opened(closing, opening))
    first, second = (Token("whenever", begin.start, begin.end) for _ in range(2))
    rules = [first, *held, comma, closing, semi, second, *over, comma, command]
    tokens[at:behind] = [*rules, semi] if behind > last else rules


def _denied(condition: list[Token], start: int, end: int) -> list[Token]:
    """Return the tokens of a condition that holds where another one doesn't, which is at some characters."""
    denial = Token("not", start, start)
    if len(condition) == 1:
        return [denial, *condition]
    if len(condition) == 2 and condition[0].kind == "not":
        return condition[1:]
    return [denial, Token("open", start, start), *condition, Token("close", end, end)]


def _otherwise_behind(tokens: list[Token], at: int) -> Token | None:
    """The `otherwise` right behind a rule that closes a zone while a condition holds, which is no `if`."""
    behind = run_end(tokens, _condition_end(tokens, at + 2)[0], JOINTS | STATEMENT_ENDS)
    is_so = behind < len(tokens) and tokens[behind].kind == "otherwise" and tokens[behind].value is None
    return tokens[behind] if is_so else None


def _is_momentary(tokens: list[Token], at: int) -> bool:
    """Whether a condition at a place is so for a moment alone: somebody says something."""
    asked = (token.value for token in tokens[at : _condition_end(tokens, at)[0]])
    return any(isinstance(value, Called) and value.entry.id in (PERSON_SAYS, SOMEBODY_SAYS) for value in asked)


def _only_then(tokens: list[Token], at: int, vocabulary: Lexicon, span: Callable[[int, int], Span]) -> Diagnostic:
    """Return the error for `never enter the hall unless Bob says "come in"`: it would be closed again at once."""
    last, word = tokens[_condition_end(tokens, at + 2)[0] - 1].end, vocabulary.word
    forbidden, condition = span(tokens[at].start, tokens[at].end).text, span(tokens[at + 2].start, last).text
    whole = span(tokens[at + 1].start, last)
    is_end = tokens[at + 1].kind == "unless"
    one = f"{forbidden} {word('until')} {condition}" if is_end else f"{word('as_soon_as')} {condition}, {forbidden}"
    return diagnostic("BT152", whole, words=whole.text, reason=_MOMENT_ONLY, advice=f"Write for example: {one}")


def _what_then(
    further: Token, tokens: list[Token], at: int, vocabulary: Lexicon, span: Callable[[int, int], Span]
) -> Diagnostic:
    """Return the error for `avoid the hall while C. Otherwise A`: A once, or each time that C ends."""
    words, word = span(further.start, further.end), vocabulary.word
    condition = span(tokens[at + 2].start, tokens[_condition_end(tokens, at + 2)[0] - 1].end).text
    one = f"{word('unless')} {condition}, ..."
    other = f"{word('as_soon_as')} {word('not')} {condition}, ..."
    return diagnostic("BT151", words, words=words.text, one=one, other=other)


def _say_where(tokens: list[Token], at: int, vocabulary: Lexicon, span: Callable[[int, int], Span]) -> None:
    """Make `avoid the hall while Bob is there` ask whether he is in the hall, where the robot isn't.

    The next statement may ask whether he isn't there any more: `Once he's gone, A`.
    """
    said = tokens[at].value
    zones = texts_of(said) if isinstance(said, Called | Listed) else ()
    if len(zones) != 1 or zones[0] not in vocabulary.values.listed(PLACE):
        return
    for token in tokens[at + 2 : _condition_end(tokens, at + 2)[0]]:
        value = token.value
        words = span(token.start, token.end).text
        if not isinstance(value, Called | Listed) or not says_there(words, vocabulary.values.pronouns):
            continue
        place = vocabulary.entry(THERE.get(value.entry.id, ""))
        if place is not None:
            where = (_slot_of(place), zones[0])
            arguments = tuple((*each, where) for each in arguments_of(value))
            there_now = value.replace(entry=place, arguments=arguments[0] if isinstance(value, Called) else arguments)
            behind = run_end(tokens, statement_end(tokens, at), STATEMENT_ENDS)
            for denial, asked in pairwise(tokens[behind : statement_end(tokens, behind)]):
                if denial.kind == "not" and asked.value == value:
                    asked.value = there_now
            token.value = there_now


def say_there(asked: Token, tokens: Sequence[Token], vocabulary: Lexicon, words: str, place: str = "") -> None:
    """Make `someone is there` about a place where the robot isn't yet.

    By default that of the condition before it, unless the robot has gone somewhere since.
    """
    value = asked.value
    entry = vocabulary.entry(THERE.get(value.entry.id, "")) if isinstance(value, Called) else None
    if entry is None or not isinstance(value, Called) or not says_there(words, vocabulary.values.pronouns):
        return  # as nearly always
    slot = _slot_of(entry)
    place = place or _place_asked(tokens, slot)
    if place[:1] not in ("", "{"):
        asked.value = Called(entry, (*value.arguments, (slot, place)))


def _place_asked(tokens: Sequence[Token], slot: str) -> str:
    """The place of the last condition, or count, of some tokens, "" for none or where the robot has left since."""
    for token in reversed(tokens):
        before = token.value
        if isinstance(before, Called) and before.entry.id in COUNTING:
            return next(iter(before.entry.given(PLACE, before.arguments)), "")  # it has looked all round there
        if drives(before) or isinstance(before, Listed):
            return ""
        if token.kind == "condition" and isinstance(before, Called) and before.entry.id in THERE.values():
            return dict(before.arguments).get(slot, "")
    return ""


def journey_to(place: str, goes: Entry) -> Called:
    """The journey to one place, with the entry that goes there."""
    return Called(goes, ((_slot_of(goes), place),))


def _slot_of(entry: Entry) -> str:
    return next(slot.name for slot in entry.slots if slot.type == PLACE)


def _two_readings(tokens: list[Token], at: int, vocabulary: Lexicon, span: Callable[[int, int], Span]) -> Diagnostic:
    """Return the error for `go to the lab and avoid the hall while C`: what depends on the condition isn't clear."""
    first = statement_start(tokens, at)
    last, _ = _condition_end(tokens, at + 2)
    before = span(tokens[first].start, tokens[run_start(tokens, at, JOINTS | {"but"}) - 1].end).text
    whole = span(tokens[first].start, tokens[last - 1].end)
    condition = span(tokens[at + 1].start, tokens[last - 1].end).text
    forbidden = span(tokens[at].start, tokens[at].end).text
    commands = span(tokens[first].start, tokens[at].end).text
    one, other = f"{forbidden} {condition}. {before}", f"{condition}, {commands}"
    return diagnostic("BT151", whole, words=whole.text, one=one, other=other)


def _opened(closing: Token, opening: Entry) -> Called | Listed:
    """Return the command that opens the zones which another closes."""
    said = closing.value
    assert isinstance(said, Called | Listed)
    values = tuple(((opening.slots[0].name, text),) for text in texts_of(said))
    return Called(opening, values[0]) if len(values) == 1 else Listed(opening, values, "and")


def _is_next(tokens: list[Token], at: int) -> bool:
    """Whether who stays somewhere does so after the command before: `go to the hall and stay in it for 5 min`.

    Or behind the head of a form: `every hour, stay in the hall for 5 min`.
    """
    if _is_headed(tokens, at):
        return True
    joint = run_start(tokens, at, JOINTS)
    before = tokens[joint - 1] if 0 < joint < at else None
    if before is None or before.kind != "command" or constraint_of(tokens[at]) is None:
        return False
    return any(token.kind == "then" for token in tokens[joint:at]) or _leads_there(before, tokens[at])


def _is_headed(tokens: list[Token], at: int) -> bool:
    """Whether a command stands behind the head of a form: `every hour, avoid the hall`, `at 10 pm avoid the hall`."""
    joint = run_start(tokens, at, JOINTS)
    return joint > 0 and tokens[joint - 1].kind in _HEADS


def _leads_there(journey: Token, stay: Token) -> bool:
    """Whether a command drives to the zone in which the robot is to stay."""
    value, zones = journey.value, stay.value
    if not isinstance(value, Called | Listed) or value.entry.id != GO or not isinstance(zones, Called | Listed):
        return False
    return set(texts_of(zones)) <= set(texts_of(value))


def _wait(tokens: list[Token], at: int, vocabulary: Lexicon) -> None:
    """Puts `stay in the hall until C` into brackets: what comes behind isn't confined. It goes there first."""
    until, start = tokens[at + 1], tokens[at].start
    last, _ = _condition_end(tokens, at + 2) if until.kind == "until" else (at + 2, at + 2)
    end = tokens[last - 1].end
    tokens[last:last] = [Token("close", end, end)]
    waiting = Token(WAITING[until.kind], until.start, until.end, until.value)
    stay, goes = tokens[at], vocabulary.entry(GO)
    tokens[at : at + 2] = [Token("open", start, start), stay, Token("and", until.start, until.start), waiting]
    before = run_start(tokens, at, JOINTS | STATEMENT_ENDS)
    if before and _leads_there(tokens[before - 1], stay):
        if before < at and tokens[at - 1].kind in JOINTS:
            tokens[before:at] = [Token("then", start, start)]
    elif goes is not None and isinstance(stay.value, Called):
        zone = stay.value.arguments[0][1]
        if zone in vocabulary.values.listed(PLACE):
            tokens[at:at] = [Token("command", start, start, journey_to(zone, goes)), Token("then", start, start)]


def _condition_end(tokens: list[Token], at: int) -> tuple[int, int]:
    """Where a condition ends, and where the command begins that may stand behind it, after words that join them."""
    while at < len(tokens) and tokens[at].kind not in _ENDS:
        behind = run_end(tokens, at, JOINTS)
        if behind > at and tokens[behind : behind + 1] and tokens[behind].kind not in _IN_CONDITIONS:
            return at, behind
        at = max(behind, at + 1)
    return at, at


def _waits_behind(tokens: list[Token], at: int, last: int, opening: Entry) -> bool:
    """Open what is closed before a `then` behind `last`, where the robot waits until then; False without one."""
    until, command = tokens[at + 1], _opened(tokens[at], opening)
    further = run_end(tokens, last, STATEMENT_ENDS | JOINTS)
    if all(token.kind != "then" for token in tokens[last:further]):
        return False
    here = tokens[last].start
    waiting = Token(WAITING[until.kind], until.start, until.end, until.value)
    opens = [Token("then", here, here), Token("command", here, here, command), Token("then", here, here)]
    tokens[at + 1 : further] = [Token("then", until.start, until.start), waiting, *tokens[at + 2 : last], *opens]
    return True


def _open_again(tokens: list[Token], at: int, opening: Entry) -> None:
    until, command = tokens[at + 1], _opened(tokens[at], opening)
    rule = "whenever" if _is_headed(tokens, at) else "first_time"  # its condition may hold before the zone is closed
    last, behind = _condition_end(tokens, at + 2)
    if _waits_behind(tokens, at, last, opening):
        return
    if behind > last:  # `avoid the hall until bumped, wave`
        tokens[last:behind] = [Token("semi", tokens[last].start, tokens[last].end)]
    end = tokens[last - 1].end
    tokens[last:last] = [Token("comma", end, end), Token("command", end, end, command)]
    tokens[at + 1 : at + 2] = [Token("semi", until.start, until.start), Token(rule, until.start, until.end)]
