"""Rules behind what is done, with more in their statement: `until 5 pm, A whenever C`, `A whenever C, and B when D`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.token import (
    IN_CONDITIONS,
    JOINTS,
    RULES,
    STATEMENT_ENDS,
    Called,
    Token,
    run_end,
    run_start,
    statement_end,
    statement_of,
)
from btlang.frontends.mission.tokens.settling import WORKS
from btlang.text.source import Source, Span
from btlang.tree.rounds import DAYTIME
from btlang.vocabulary.lexicon import Lexicon

_ENDING = ("until", "until_time")
_EACH_TIME = "it may be how often each time, or in all"
_RULE = "whenever bumped, say ouch 3 times, or: the first time bumped, say ouch"
_PACES = ("every", "every_day", "weekly", "at")
_DONE = ("command", "name")
_PLAIN = frozenset((*_DONE, "wait", "open", "close", "count", *JOINTS))
_TOGETHER = frozenset((*_DONE, "wait", "count", "comma", "and"))
_ASKED = (*RULES, "if")


def with_rules_behind(tokens: list[Token]) -> None:
    """Put the end of such a rule behind it, and make two rules of two that `and` joins."""
    for at in reversed(range(1, len(tokens))):
        if tokens[at].kind in RULES and tokens[at - 1].kind in _DONE:
            _split(tokens, at)
            _end(tokens, at)
        elif tokens[at].kind in RULES and tokens[at - 1].kind == "and":
            _begin(tokens, at)


def with_watches(tokens: list[Token]) -> None:
    """Make `if somebody is near while you are in the lab, A` a rule for both: it may be so at any time."""
    for at in [at for at, token in enumerate(tokens) if token.kind == "if"]:
        if at and tokens[at - 1].kind not in STATEMENT_ENDS:
            continue
        while_ = run_end(tokens, at + 1, IN_CONDITIONS)
        end = run_end(tokens, while_ + 1, IN_CONDITIONS)
        if while_ + 1 < end < len(tokens) and tokens[while_].kind == "while" and tokens[end].kind == "comma":
            tokens[at].kind, tokens[while_].kind = RULES[0], "and"


def find_counted_rules(tokens: Sequence[Token], source: Source) -> Iterator[Diagnostic]:
    """BT150 for `whenever C, A, up to five times`: so often each time, or in all?"""
    for at in range(1, len(tokens)):
        if tokens[at].kind != "count" or tokens[at - 1].kind != "comma":
            continue
        first, end = statement_of(tokens, at)
        if tokens[first].kind == "whenever" and at == end - 1 and _behind(tokens, first) < at - 1:
            span = Span(source, tokens[at].start, tokens[at].end)
            yield diagnostic("BT150", span, words=span.text, reason=_EACH_TIME, example=_RULE)


def find_ended_rounds(tokens: Sequence[Token], vocabulary: Lexicon, source: Source) -> Iterator[Diagnostic]:
    """BT151 for `A every hour until 5 pm and B`, and `A at 8:00 and 9:00 and B`: is B done each time, or once?"""
    for every in [at for at, token in enumerate(tokens[:-1]) if token.kind in ("every", "at") and at > 0]:
        until = tokens[every + 1]
        is_listed = tokens[every].kind == "at" and ";" in str(tokens[every].value)
        if not (is_listed or until.kind in _ENDING) or tokens[every - 1].kind not in _DONE:
            continue
        ended = every + 1 if is_listed else every + 2 if until.kind == "until_time" else _behind(tokens, every + 1)
        joint = run_end(tokens, ended, ("comma",))
        first, last = statement_of(tokens, every)
        if joint + 1 < last and tokens[joint].kind == "and" and tokens[joint + 1].kind in _DONE:
            parts = ((first, every), (every, ended), (joint + 1, last))
            done, pace, further = (source.text[tokens[begin].start : tokens[end - 1].end] for begin, end in parts)
            one = f"{pace}, {done} {vocabulary.word('and')} {further}"
            other = f"{done} {pace}, {vocabulary.word('then')} {further}"
            span = Span(source, tokens[first].start, tokens[last - 1].end)
            yield diagnostic("BT151", span, words=span.text, one=one, other=other)


def with_checks_apart(tokens: list[Token]) -> None:
    """Put `check whether C` in brackets before a form: `check whether C, and if D, A` does A whatever C is."""
    for at in reversed(range(len(tokens) - 1)):
        if (tokens[at].kind, tokens[at + 1].kind) == ("try", "check"):
            end = _behind(tokens, at + 1)
            behind = run_end(tokens, end, JOINTS)
            if behind > end and tokens[behind : behind + 1] and tokens[behind].kind in ("if", "unless"):
                tokens[at:behind] = [*_in_brackets(tokens[at:end]), _joint("then", tokens[behind])]


def with_checks_acted_on(tokens: list[Token], vocabulary: Lexicon, source: Source) -> None:
    """Make `see if the light is on, and switch it off` do so if it is on; `check that it is on and A` needs it on."""
    asking = {*vocabulary.roles["if"], *vocabulary.asking["whether"]}
    for at in reversed([at for at, token in enumerate(tokens) if token.kind == "check"]):
        check, last = tokens[at], _behind(tokens, at)
        done = run_end(tokens, last, ("comma", "and"))
        end = run_start(tokens, run_end(tokens, done, _TOGETHER), ("comma", "and"))
        asks = source.text[check.start : check.end].lower().rsplit(" ", 1)[-1] in asking
        if not asks or end <= done or all(token.kind != "and" for token in tokens[last:done]):
            continue
        behind = tokens[run_end(tokens, end, ("comma", "stop")) :][:1]
        if (at > 0 and tokens[at - 1].kind == "try") or (behind != [] and behind[0].kind == WORKS):
            continue
        said = [Token("if", check.start, check.end), *tokens[at + 1 : last], _joint("comma", tokens[done])]
        said += tokens[done:end]
        tokens[at:end] = said if behind != [] and behind[0].kind == "otherwise" else _in_brackets(said)


def find_two_ifs(tokens: Sequence[Token], vocabulary: Lexicon, source: Source) -> Iterator[Diagnostic]:
    """BT151 for `A if C, B if D, otherwise E`: E if D isn't so, or if neither is."""
    for at in [at for at, token in enumerate(tokens) if token.kind == "otherwise"]:
        first, last = statement_of(tokens, at)
        ifs = [each for each in range(first, at) if tokens[each].kind == "if"]
        if len(ifs) != 2 or ifs[0] == first or any(token.kind == "stop" for token in tokens[first:at]):
            continue
        begin = run_end(tokens, _behind(tokens, ifs[0]), JOINTS)
        if begin >= ifs[1] or not {token.kind for token in tokens[first : ifs[0]]} <= {*_DONE, *JOINTS}:
            continue
        parts = ((first, _behind(tokens, ifs[0])), (begin, _behind(tokens, ifs[1])), (at, last))
        one_if, other_if, otherwise = (source.text[tokens[a].start : tokens[b - 1].end] for a, b in parts)
        span = Span(source, tokens[first].start, tokens[last - 1].end)
        word = source.text[tokens[at].start : tokens[at].end]
        one, other = f"{one_if}. {other_if}, {otherwise}", f"{one_if}, {word} {other_if}, {otherwise}"
        yield diagnostic("BT151", span, words=span.text, one=one, other=other)


def with_exceptions(tokens: list[Token], vocabulary: Lexicon, source: Source) -> Iterator[Diagnostic]:
    """Make `A every hour, but not if C` ask each time, and `whenever C, A, but not while D` a rule for both together:
    where D ends and C still holds, A is done then. `A, but not while D` alone can be read in two ways (BT151).
    """
    leaving_out = vocabulary.firsts["but"] | vocabulary.firsts["except"]
    while_words = {word for phrase in vocabulary.roles["while"] for word in phrase.split()}
    for at in reversed([at for at, token in enumerate(tokens) if token.kind == "unless" and at > 0]):
        said = source.text[tokens[at].start : tokens[at].end].lower().split()
        if said[:1] == [] or said[0] not in leaving_out:
            continue
        first, last = _statement_around(tokens, at)
        end, comma = min(_behind(tokens, at), last), run_start(tokens, at, ("comma",))
        lasts, unless = not while_words.isdisjoint(said), tokens[at:end]
        if comma <= first or len(unless) < 2:
            continue  # nothing is done before it, or nothing is asked
        every = next((each for each in range(first, comma) if tokens[each].kind in _PACES), -1)
        rule = _behind(tokens, first) if tokens[first].kind in RULES else last
        is_plain = not lasts and all(token.kind in _PLAIN for token in tokens[first:comma])
        if lasts and rule < comma and end == last:
            both = [*_one(tokens[first + 1 : rule]), _joint("and", unless[0]), _joint("not", unless[0])]
            tokens[first + 1 : end] = [*both, *_one(unless[1:]), *tokens[rule:comma]]
        elif every == comma - 1 >= first:
            tokens[every:end] = [*unless, tokens[every]]
        elif (
            every < first
            and not lasts
            and _is_too_early(unless)
            and all(each.kind in _PLAIN for each in tokens[first:comma])
        ):
            body = _in_brackets(tokens[first:comma])  # `go to the lab, but not before 2 pm`: it waits until then
            wait, deny, then = (_joint(kind, body[0]) for kind in ("wait_until", "not", "then"))
            tokens[first:end] = [wait, deny, unless[1], then, *body]
        elif every == first or is_plain:
            begin = run_end(tokens, first + (every == first), ("comma", "colon"))
            body = _in_brackets(tokens[begin:comma])
            tokens[begin:end] = [*body, *unless]
            if every == first and begin == first + 1:
                tokens[begin:begin] = [_joint("comma", body[0])]
        elif lasts:
            span = Span(source, tokens[first].start, tokens[end - 1].end)
            done, asked = (source.text[part[0].start : part[-1].end] for part in (tokens[first:comma], unless[1:]))
            one = f"{vocabulary.word('unless')} {asked}, {done}"
            other = f"{done} {vocabulary.word('while')} {vocabulary.word('not')} {asked}"
            yield diagnostic("BT151", span, words=span.text, one=one, other=other)


def _is_too_early(unless: Sequence[Token]) -> bool:
    """Whether `but not before 2 pm` says from when on something may be done."""
    asked = unless[1].value if len(unless) == 2 else None
    is_daytime = isinstance(asked, Called) and asked.entry.id == DAYTIME
    return is_daytime and isinstance(asked, Called) and [name for name, _ in asked.arguments] == ["below"]


def _statement_around(tokens: Sequence[Token], at: int) -> tuple[int, int]:
    """Where the statement begins and ends in which a token stands; within the brackets around it, if there are any."""
    first, last = statement_of(tokens, at)
    begin = _unmatched(tokens, reversed(range(first, at)), "open", "close")
    end = _unmatched(tokens, range(at, last), "close", "open")
    return (first, last) if begin is None else (begin + 1, last if end is None else end)


def _unmatched(tokens: Sequence[Token], places: Iterable[int], wanted: str, other: str) -> int | None:
    """The first bracket of a kind that closes none before it on the way."""
    depth = 0
    for at in places:
        depth += (tokens[at].kind == other) - (tokens[at].kind == wanted)
        if depth < 0:
            return at
    return None


def _one(condition: list[Token]) -> list[Token]:
    """A condition in brackets, unless it is a single one."""
    return condition if len(condition) == 1 else _in_brackets(condition)


def _in_brackets(said: list[Token]) -> list[Token]:
    return [_joint("open", said[0]), *said, _joint("close", said[-1])]


def _joint(kind: str, beside: Token) -> Token:
    return Token(kind, beside.start, beside.start)


def _split(tokens: list[Token], rule: int) -> None:
    """`A whenever C, and B when D`: `when` is a rule there, too."""
    last = _behind(tokens, rule)
    second = run_end(tokens, last, ("comma", "and"))
    form = second + (tokens[second : second + 1] != [] and tokens[second].kind in _DONE)
    if second == last or form >= len(tokens) or tokens[form].kind not in (_ASKED if form > second else RULES):
        return
    if form == second or _behind(tokens, form) == statement_end(tokens, form):
        tokens[form].kind = "whenever" if tokens[form].kind == "if" else tokens[form].kind
        tokens[last:second] = [Token("semi", tokens[last].start, tokens[last].start)]


def _begin(tokens: list[Token], rule: int) -> None:
    """`whenever C, A, and whenever D, B`: the second rule is one of its own."""
    first, joint = statement_of(tokens, rule)[0], run_start(tokens, rule, ("comma", "and"))
    if joint > first and tokens[first].kind in RULES and not any(each.kind == "open" for each in tokens[first:joint]):
        tokens[joint:rule] = [Token("semi", tokens[joint].start, tokens[joint].start)]


def _end(tokens: list[Token], rule: int) -> None:
    """`A whenever C, until 5 pm`, `until 5 pm, A whenever C`, `from 9 am to 5 pm, A whenever C`."""
    (first, end), last = statement_of(tokens, rule), _behind(tokens, rule)
    if tokens[last : last + 1] and tokens[last].kind == "comma" and _is_end(tokens[last + 1 : end]):
        del tokens[last]
    front = next((at for at in range(first, rule) if tokens[at].kind in _ENDING), rule)
    ending = tokens[front : rule - 2]
    if last == end and tokens[rule - 2].kind == "comma" and _is_end(ending):
        tokens[front:last] = [*tokens[rule - 1 : last], *ending]
        if front > first:
            joint = tokens[front - 1]
            tokens[front - 1] = Token("semi", joint.start, joint.end)


def _is_end(said: Sequence[Token]) -> bool:
    """Whether tokens say until when, and nothing else."""
    return bool(said) and said[0].kind in _ENDING and all(token.kind in IN_CONDITIONS for token in said[1:])


def _behind(tokens: Sequence[Token], rule: int) -> int:
    """Where the condition of a rule ends; what joins a command behind it is no part of it."""
    end = run_end(tokens, rule + 1, IN_CONDITIONS)
    return run_start(tokens, end, JOINTS)
