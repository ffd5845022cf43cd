"""Rules for the time of one command: `while going to the lab, whenever somebody is near, say hi`, `if bumped while
going to the lab, wave`, `go to the lab, and if bumped on the way, wave`. They become a block with the command.
"""

from __future__ import annotations

from collections.abc import Sequence

from btlang.frontends.mission.token import (
    JOINTS,
    RULES,
    STATEMENT_ENDS,
    Called,
    Listed,
    Token,
    constraint_of,
    drives,
    run_start,
    statement_end,
    statement_start,
)
from btlang.frontends.mission.tokens.settling import STAYS
from btlang.vocabulary.value_type import PERSON, PLACE

ON_WAY = "on_way"
"""The role of a rule that holds on the journey before it."""
_OBSTACLES = ("SomethingInTheWay", "SomeoneInTheWay")
_BLOCKED = ("WallInFront", *_OBSTACLES)
_DOING = "while_doing"
TIMES = frozenset(("at", "every_day", "every"))
_LATER = frozenset(("wait_until", "wait_time", "at", "every_day"))
"""Raw kinds at the start of a statement whose commands are done later: a rule in front would hold until then, too."""
_IN_CONDITIONS = frozenset(("condition", "not", "and", "or", "either", "both", "neither", "nor"))


def with_rules_inside(tokens: list[Token]) -> None:
    """Puts such statements into blocks."""
    at = 0
    while at < len(tokens):
        if asks_if_blocked(tokens, at) and _is_event(tokens, at):
            tokens[at].kind, tokens[at].role = "whenever", ON_WAY
        if tokens[at].kind == "whenever" and tokens[at].role != ON_WAY:
            _front(tokens, at)
        is_rule = tokens[at].role == ON_WAY
        if is_rule or tokens[at].kind == _DOING:
            first = statement_start(tokens, at)
            last = statement_end(tokens, at)
            if is_rule and first == at:  # of the statement before
                first = statement_start(tokens, run_start(tokens, first, STATEMENT_ENDS))
            statement = tokens[first:last]
            block = _on_way(statement, at - first) if is_rule else _block(statement, at - first)
            if block:
                tokens[first:last] = block
                at = first + len(block)
        at += 1


def asks_if_blocked(tokens: Sequence[Token], form: int) -> bool:
    """Whether a form asks if the way of the journey before it is blocked, which is so while it drives."""
    asked = tokens[form + 1].value if tokens[form].kind == "if" and form + 1 < len(tokens) else None
    if not isinstance(asked, Called) or asked.entry.id not in _BLOCKED:
        return False
    return _journey_before(tokens, form) is not None


def _front(tokens: list[Token], rule: int) -> None:
    """Put a rule for the time of the commands before it in front: `stay at the door until noon and wave whenever C`."""
    first, end = statement_start(tokens, rule), statement_end(tokens, rule)
    joint = run_start(tokens, rule - 1, JOINTS)
    first = _last_then(tokens, first, joint)
    if tokens[first].kind in TIMES:  # `at noon, go to the lab and wave whenever C`
        first += 1 + (tokens[first + 1].kind == "comma")
    condition = tokens[rule + 1 : run_start(tokens, end, STATEMENT_ENDS)]
    lasts = tokens[first].kind == "wait_time" and joint == first + 1  # `stay there until noon and wave whenever C`
    is_later = tokens[first].kind in _LATER and not lasts
    is_command = rule > 0 and tokens[rule - 1].kind in ("command", "wait") and not is_later
    if not is_command or not first < joint < rule - 1 or any(each.kind not in _IN_CONDITIONS for each in condition):
        return
    if not any_lasts(tokens[first:joint]):  # `wave and nod whenever C` may mean both each time
        return
    done, here = tokens[rule - 1], tokens[rule].start
    made = [tokens[rule], *condition, Token("comma", here, here), done]
    command = tokens[first:joint]
    constraint = constraint_of(command[0])
    keeps_in = constraint is not None and constraint.kind == "keep in" and len(command) == 1
    if keeps_in or command[-1].role == STAYS:  # `stand at the door and wave whenever C`
        command += [Token("semi" if keeps_in else "then", here, here), Token("wait_forever", here, here)]
    tokens[first:end] = _made(tokens[first:end], command, made)


def any_lasts(commands: Sequence[Token]) -> bool:
    """Whether some of these commands last, so that a rule may hold meanwhile."""
    return not all(map(_accompanies, commands))


def _accompanies(token: Token) -> bool:
    """Whether a token joins commands, or is a command that may go along with others: it doesn't last."""
    return token.kind in JOINTS or (isinstance(token.value, Called | Listed) and token.value.entry.accompaniment)


def _last_then(tokens: Sequence[Token], first: int, last: int) -> int:
    """Where the commands begin behind the last `then` out of brackets: `wave, then stay there and wave whenever C`."""
    depth = 0
    for at in reversed(range(first, last)):
        depth += (tokens[at].kind == "close") - (tokens[at].kind == "open")
        if tokens[at].kind == "then" and not depth and tokens[at - 1].role != STAYS:
            return at + 1
    return first


def _journey_before(tokens: Sequence[Token], form: int) -> Called | Listed | None:
    """The command right before a form, if it drives."""
    last = run_start(tokens, form, JOINTS | STATEMENT_ENDS)
    value = tokens[last - 1].value if last else None
    return value if drives(value) else None


def _is_event(tokens: Sequence[Token], form: int) -> bool:
    """Whether `if somebody is in the way` is about the journey; `if there is a wall` may ask at its end."""
    asked, journey = tokens[form + 1].value, _journey_before(tokens, form)
    end = statement_end(tokens, form)
    if journey is None or any(token.kind == "otherwise" for token in tokens[form:end]):
        return False
    is_joined = tokens[form - 1].kind not in STATEMENT_ENDS
    leads = any(slot.type in (PLACE, PERSON) for slot in journey.entry.slots)
    return leads and isinstance(asked, Called) and (is_joined or asked.entry.id in _OBSTACLES)


def _on_way(statement: Sequence[Token], rule: int) -> list[Token]:
    """The block of a rule that begins at a place and the commands before it."""
    last = run_start(statement, rule, JOINTS | STATEMENT_ENDS)
    kinds = [token.kind for token in statement[:2]]
    begin = 1 + (kinds[1:] == ["comma"]) if kinds[0] in TIMES else kinds[0] == "then"
    journey = list(statement[begin:last])
    if not journey or any(token.kind not in ("command", "name", "wait_time", *JOINTS) for token in journey):
        return []
    if journey[-1].role == STAYS:
        here = journey[-1].end
        journey += [Token("then", here, here), Token("wait_forever", here, here)]
    return [*statement[:begin], *_made(statement[begin:], journey, statement[rule:])]


def _block(statement: Sequence[Token], doing: int) -> list[Token]:
    """The block that a statement stands for whose command for the time begins at a place; empty for none."""
    comma = next((i for i in range(doing, len(statement)) if statement[i].kind == "comma"), 0)
    rule = _rule(statement, doing, comma) if comma else []
    if not rule or any(token.kind == "otherwise" for token in statement):
        return []
    return _made(statement, statement[doing + 1 : comma], rule)


def _made(statement: Sequence[Token], command: Sequence[Token], rule: Sequence[Token]) -> list[Token]:
    start, end = statement[0].start, statement[-1].end
    opening = [Token(kind, start, start) for kind in ("following", "colon", "indent")]
    return [*opening, *rule, Token("newline", end, end), *command, Token("dedent", end, end)]


def _rule(statement: Sequence[Token], doing: int, comma: int) -> list[Token]:
    """The rule in front of the command for whose time it is, behind it, or behind what is done then."""
    first, rest = statement[0], statement[comma + 1 :]
    if doing > 0:
        watches = first.kind in (*RULES, "if") and all(each.kind in _IN_CONDITIONS for each in statement[1:doing])
        kind = "whenever" if first.kind == "if" else first.kind
        return [Token(kind, first.start, first.end), *statement[1:doing], statement[comma], *rest] if watches else []
    at = next((i for i, token in enumerate(rest) if token.kind in RULES), -1)
    if at <= 0:
        return list(rest) if at == 0 else []
    condition = rest[at + 1 :]
    if any(token.kind not in _IN_CONDITIONS for token in condition):
        return []
    return [rest[at], *condition, Token("comma", rest[0].start, rest[0].start), *rest[:at]]
