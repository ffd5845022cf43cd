"""What is done again at another time, elsewhere, or only if something is so: `A. Do it again at 6 pm`, `A. Do the same
in the kitchen`.

The statement stays as it is, and its commands stand once more behind it. A time before them isn't theirs: `at 9 am, A.
Do that every hour` waits for 9 am once.
"""

from __future__ import annotations

from collections.abc import Container, Iterator, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.token import (
    IN_CONDITIONS,
    JOINTS,
    RULES,
    STATEMENT_ENDS,
    Called,
    Listed,
    Token,
    arguments_of,
    in_brackets,
    run_end,
    run_start,
    statement_end,
    statement_of,
    statement_start,
)
from btlang.frontends.mission.tokens.sentence_reader import is_question
from btlang.frontends.mission.tokens.settling import FAILS, MEASURES
from btlang.text.source import Source, Span
from btlang.tree.answers import ABOUT_ANSWERS, ASK
from btlang.tree.rounds import DAYTIME
from btlang.tree.sums import COMPARED
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.value_type import PLACE

AGAIN = ("do_that", "repeat_that", "again")
"""Raw kinds of words for the statement before."""
ELSEWHERE = "elsewhere"
"""The role of a journey that says where something is done again."""
_TIMES, _CONDITIONAL = ("at", "delay"), ("if", "unless")
_ENDLESS = ("every", "every_day", "weekly")
_BOUNDS = frozenset(("until", "until_time", "for", "up_to", "count", "colon", "while", *RULES))
_DAILY = ("at", "every_day")
_LATER = (*_TIMES, *_CONDITIONAL)
_ROUNDS = frozenset(("every", "every_day"))
_DONE = ("command", "name", "close")
_AMOUNTS = ("every", "until_time", "for")
_UNTIL = ["until", "condition"]
_ELSEWHERE = "go to the lab and wave. Do the same in the kitchen"
_DENYING = ("not", "open")
_HOW_OFTEN = MEASURES | {"every"}
_PLAIN = frozenset(("command", "name", "wait", "open", "close", *JOINTS, *MEASURES))


def with_repeats_apart(tokens: list[Token], source: Source) -> Iterator[Diagnostic]:
    """Put the commands of a statement where they are done again.

    BT150 where they are to be done elsewhere, and were done in no one place.
    """
    for at in reversed([at for at, token in enumerate(tokens) if token.kind in AGAIN and at > 0]):
        if tokens[at - 1].kind == "and" and tokens[at + 1 : at + 2] and tokens[at + 1].kind == "at":
            _at_both(tokens, at)
            continue
        at = _joined(tokens, at)
        if tokens[at - 1].kind != "stop":
            continue
        kinds = [token.kind for token in tokens[at : at + 3]]
        behind = at + 1 + (kinds[:2] == ["do_that", "again"])
        is_again, how = kinds[0] != "do_that" or behind > at + 1, "".join(kinds[behind - at :][:1])
        first = statement_start(tokens, at - 1)
        waits = tokens[first].kind == "at"
        commands = tokens[first + waits + (waits and tokens[first + 1].kind == "comma") : at - 1]
        if not commands or any(token.kind not in _PLAIN for token in commands):
            continue
        end = Token("semi", tokens[at].start, tokens[at].start)
        if how == "command" and tokens[behind].role == ELSEWHERE:
            span = Span(source, tokens[at].start, tokens[behind].end)
            moved = _elsewhere(commands, tokens[behind])
            if not moved:
                reason = "what is said before it isn't done in one place"
                yield diagnostic("BT150", span, words=span.text, reason=reason, example=_ELSEWHERE)
            tokens[at - 1 : behind + 1] = [end, *(moved or [Token("nothing", tokens[at].start, span.end)])]
        elif is_again and how in _LATER:
            tokens[at - 1 : behind] = [end, *_bracketed(commands, tokens[at])]
        elif waits and how in _AMOUNTS:
            start = commands[0].start
            tokens[first + 1 : behind] = [Token("comma", start, start), *in_brackets(commands)]


def _joined(tokens: list[Token], at: int) -> int:
    """Make a sentence of its own of `..., and do that ten times` and `Then do the same in the hall`; return its place.

    `A, then do that ten times` may be once more.
    """
    joint = run_start(tokens, at, JOINTS)
    begin = joint - (tokens[joint - 1].kind == "semi")
    elsewhere = tokens[at + 1 : at + 2] != [] and tokens[at + 1].role == ELSEWHERE
    says_then = any(token.kind == "then" for token in tokens[joint:at])
    before = tokens[statement_start(tokens, begin) : begin]
    is_plain = bool(before) and all(token.kind in (*_PLAIN, "at") for token in before)
    if tokens[at].kind != "do_that" or joint == at or not is_plain or (says_then and not elsewhere):
        return at
    tokens[begin:at] = [Token("stop", tokens[at].start, tokens[at].start)]
    return begin + 1


def with_rounds_beside(tokens: list[Token]) -> None:
    """Put rounds in brackets that go on beside others: `every hour, A. Meanwhile, every day at 5 pm, B`."""
    for at in reversed([at for at, token in enumerate(tokens[1:-1]) if token.kind == "meanwhile"]):
        if tokens[at].kind != "stop":
            continue
        first, other = statement_start(tokens, at), at + 2 + (tokens[at + 2].kind == "comma")
        if other < len(tokens) and {tokens[first].kind, tokens[other].kind} <= _ROUNDS:
            opening, closing = tokens[first], tokens[at]
            closing.kind = "close"
            tokens.insert(first, Token("open", opening.start, opening.start))


def with_questions_once(tokens: list[Token], source: Source) -> Iterator[Diagnostic]:
    """Make `ask Bob "Q". Ask him again until he says yes` ask once before the answer is looked at.

    What is done as soon as somebody answers so is done if the answer before it is so; BT151 for that in rounds.
    """
    for at in reversed(range(len(tokens) - 2)):
        if not _asks(tokens[at]) or tokens[at + 1].kind not in STATEMENT_ENDS:
            continue
        until = next((i for i in range(at + 3, len(tokens)) if tokens[i].kind not in _AMOUNTS), at)
        if tokens[at + 2].value == tokens[at].value and [each.kind for each in tokens[until : until + 2]] == _UNTIL:
            del tokens[at : at + 2]
    for at, form in enumerate(tokens[:-1]):
        asked = tokens[at + 1].value
        if form.kind != "as_soon_as" or not isinstance(asked, Called) or asked.entry.id not in ABOUT_ANSWERS:
            continue
        first, end = statement_start(tokens, at), statement_end(tokens, at)
        question = next((token for token in reversed(tokens[:at]) if _asks(token)), None)
        if question is None:
            continue
        form.kind = "if"
        if any(token.kind == "every" for token in tokens[first:at]):
            span = Span(source, tokens[first].start, tokens[end - 1].end)
            said = source.text[question.start : question.end]
            answer = source.text[tokens[at + 1].start : tokens[at + 1].end]
            one, other = f"{said} ... until {answer}, then ...", f"... {said}, and if {answer}, ..."
            yield diagnostic("BT151", span, words=span.text, one=one, other=other)


def with_questions_each_time(tokens: list[Token]) -> None:
    """Make `every hour, ask Bob "Q" until he says yes` into `ask Bob "Q" every hour until he says yes`.

    One that was asked before is asked again only then: `ask Bob "Q". If he says no, every hour ask him again until C`.
    """
    for at in reversed([at for at, token in enumerate(tokens) if token.kind == "every"]):
        asked = run_end(tokens, at + 1, ("comma",))
        if [token.kind for token in tokens[asked : asked + 3]] != ["command", *_UNTIL] or not _asks(tokens[asked]):
            continue
        answer = tokens[asked + 2].value
        if not isinstance(answer, Called) or answer.entry.id not in ABOUT_ANSWERS:
            continue
        every, question = tokens[at], tokens[asked]
        before = next((token for token in reversed(tokens[:at]) if _asks(token)), None)
        is_again = before is not None and before.value == question.value
        pause = [Token("wait", every.start, every.end, every.value), Token("then", every.end, every.end)]
        first = at - 2 if is_again and at > 1 and tokens[at - 2] is before else at
        tokens[first : asked + 1] = [*(pause if is_again and first == at else ()), question, every]


def _asks(token: Token) -> bool:
    return token.kind == "command" and isinstance(token.value, Called) and token.value.entry.id == ASK


def _at_both(tokens: list[Token], at: int) -> None:
    """`A at 6 pm and again at 9 pm`: at both times, with what is joined behind: `..., and B`."""
    first, end = statement_of(tokens, at)
    commands, further = tokens[first : at - 2], tokens[at + 2 : end]
    if tokens[at - 2].kind != "at" or not commands or any(token.kind not in _PLAIN for token in (*commands, *further)):
        return
    if further and further[0].kind not in JOINTS:
        return
    begin, here = commands[0].start, tokens[at].start
    times = tokens[at - 2], tokens[at + 1]
    said = [*commands, *further]
    tokens[first:end] = [
        times[0], Token("comma", begin, begin), *in_brackets(said), Token("semi", here, here), times[1],
        Token("comma", here, here), *_bracketed(said, tokens[at]),
    ]  # fmt: skip


def with_times_first(tokens: list[Token]) -> None:
    """Make `A at 6 pm if C` ask at that time, as `A if C at 6 pm` does."""
    for at in reversed(range(1, len(tokens) - 1)):
        is_time = tokens[at].kind in _TIMES and tokens[at - 1].kind in _DONE
        if is_time and tokens[at + 1].kind in _CONDITIONAL:
            end = run_end(tokens, at + 2, IN_CONDITIONS)
            tokens[at:end] = [*tokens[at + 1 : end], tokens[at]]


def with_waits_each_time(tokens: list[Token], again: Container[str], source: Source) -> None:
    """Make `wait 5 min and ask her again until she says yes` wait before each question."""
    for at in reversed([at for at, token in enumerate(tokens[:-1]) if tokens[at + 1].kind == "until"]):
        asked, wait = tokens[at], run_start(tokens, at, JOINTS) - 1
        if not 0 <= wait < at - 1 or tokens[wait].kind != "wait" or not is_question(asked):
            continue
        if source.text[asked.start : asked.end].lower().rsplit(" ", 1)[-1] in again:
            tokens[wait : at + 1] = in_brackets(tokens[wait : at + 1])


def with_tries_apart(tokens: list[Token]) -> None:
    """Let `go to the lab and try to open it up to 3 times. If it still fails, A` do A for the tries alone."""
    for at in reversed([at for at, token in enumerate(tokens) if token.value == FAILS and at > 2]):
        last = at - 1
        done = run_start(tokens, last, _HOW_OFTEN) - 1
        if tokens[last].kind != "stop" or done == last - 1 or tokens[done - 1].kind != "try":
            continue
        joint, first = run_start(tokens, done - 1, JOINTS), statement_start(tokens, done)
        is_defined = first > 0 and tokens[first - 1].kind == "define"
        if first < joint < done - 1 and not is_defined and all(token.kind in _PLAIN for token in tokens[first:joint]):
            tokens[joint : done - 1] = [Token("semi", tokens[joint].start, tokens[joint].start)]


def with_rest_of_rounds(tokens: list[Token], vocabulary: Lexicon, source: Source) -> None:
    """Make `every hour, go to the door. If somebody is there, A. Then B` do all of it each hour: it never ends.

    Not so behind an event, which may be at any time: `every hour, wave. If somebody comes, A`.
    """
    end = -1
    while end + 1 < len(tokens):
        first, end = end + 1, statement_end(tokens, end + 1)
        if tokens[first].kind not in _ENDLESS or not _BOUNDS.isdisjoint(token.kind for token in tokens[first:end]):
            continue
        if any(isinstance(each.value, Called) and each.value.entry.id == DAYTIME for each in tokens[first:end]):
            continue  # `every hour between 8 am and 6 pm, A`
        last, goes_on = end, False
        while last + 2 < len(tokens) and tokens[last].kind == "semi":
            kind, asked = tokens[last + 1].kind, tokens[min(run_end(tokens, last + 2, _DENYING), len(tokens) - 1)]
            is_done, is_event = _is_about_done(asked), vocabulary.says_event(source.text[asked.start : asked.end])
            is_asked = kind in _CONDITIONAL and (is_done or not is_event)
            if not (is_asked or kind in ("delay", "then") or (last > end and kind in (*_DONE, "wait"))):
                break
            goes_on = goes_on or not (is_asked and is_done)
            last = statement_end(tokens, last + 1)
        if goes_on:
            last = run_start(tokens, last, STATEMENT_ENDS)
            begin = first + 1 + (tokens[first + 1].kind == "comma")
            opening = Token("open", tokens[begin].start, tokens[begin].start)
            closing = Token("close", tokens[last - 1].end, tokens[last - 1].end)
            tokens[begin:last] = [opening, *tokens[begin:last], closing]
            end = statement_end(tokens, last + 2)


def _is_about_done(asked: Token) -> bool:
    """Whether a condition is about an answer or what was counted, which belongs to the round by itself."""
    value = asked.value
    return isinstance(value, Called | Listed) and value.entry.id in (*ABOUT_ANSWERS, COMPARED)


def with_days_then(tokens: list[Token]) -> None:
    """Make `unless it is Saturday, at 7 am A` ask for the day at that time, and not when the mission begins."""
    for form in reversed([at for at, token in enumerate(tokens) if token.kind in _CONDITIONAL]):
        time = run_end(tokens, form + 1, IN_CONDITIONS) + 1
        if tokens[time : time + 1] == [] or tokens[time].kind not in _DAILY:
            continue
        asked = [token for token in tokens[form:time] if token.kind == "condition"]
        if any(token.kind == "otherwise" for token in tokens[time : statement_end(tokens, time)]):
            continue  # `if it is Sunday, at 7 am A, otherwise B`: B may be done at once
        if asked and tokens[time - 1].kind == "comma" and all(_is_of_day(token) for token in asked):
            here = tokens[form].start
            behind = time + 1 + (tokens[time + 1 : time + 2] != [] and tokens[time + 1].kind == "comma")
            tokens[form:behind] = [tokens[time], Token("comma", here, here), *tokens[form:time]]


def _is_of_day(condition: Token) -> bool:
    """Whether a condition is about the day."""
    value = condition.value
    return isinstance(value, Called | Listed) and any(slot.type == "days" for slot in value.entry.slots)


def with_conditions_then(tokens: list[Token]) -> None:
    """Make `at 6 pm, A, but only if C` ask at that time."""
    for at in reversed(range(2, len(tokens) - 1)):
        if tokens[at].kind in _CONDITIONAL and tokens[at - 1].kind == "comma":
            _ask_at_time(tokens, at)


def _ask_at_time(tokens: list[Token], form: int) -> None:
    first, last = statement_of(tokens, form)
    end = run_end(tokens, form + 1, IN_CONDITIONS)
    begin = first + 1 + (tokens[first + 1].kind == "comma")
    body = tokens[begin : form - 1]
    if (
        tokens[first].kind in (*_TIMES, "every_day")
        and end == last
        and body
        and all(token.kind in _PLAIN for token in body)
    ):
        comma = Token("comma", tokens[form].start, tokens[form].start)
        tokens[first + 1 : end] = [comma, *tokens[form:end], comma, *body]


def _elsewhere(commands: Sequence[Token], journey: Token) -> list[Token]:
    """The same commands in other places; nothing where they have no one place."""
    said = [token.value for token in commands if isinstance(token.value, Called | Listed)]
    there = {text for value in said for text in _places(value)}
    if len(there) != 1 or "{" in next(iter(there)) or any(isinstance(value, Listed) for value in said):
        return []
    made: list[Token] = []
    for place in _places(journey.value) if isinstance(journey.value, Called | Listed) else ():
        made += [Token("then", journey.start, journey.start)] if made else []
        made += _bracketed([_moved(token, place) for token in commands], journey)
    return made


def _places(said: Called | Listed) -> list[str]:
    return [text for arguments in arguments_of(said) for text in said.entry.given(PLACE, arguments)]


def _moved(token: Token, place: str) -> Token:
    """A command in another place."""
    said = token.value
    if not isinstance(said, Called):
        return token
    moved = tuple((name, place if said.entry.slot(name).type == PLACE else text) for name, text in said.arguments)
    return Token(token.kind, token.start, token.end, said.replace(arguments=moved), token.role)


def _bracketed(commands: Sequence[Token], said: Token) -> list[Token]:
    """The same commands in brackets, where a word stands that means them."""
    return in_brackets([Token(token.kind, said.start, said.end, token.value, token.role) for token in commands])
