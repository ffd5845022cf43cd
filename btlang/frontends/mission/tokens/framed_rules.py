"""Rules within a time or while something is so: `until 5 pm, whenever C, A`, `while D, A whenever C`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.token import (
    IN_CONDITIONS,
    JOINTS,
    RULES,
    STATEMENT_ENDS,
    WAITING,
    Called,
    Listed,
    Token,
    run_end,
    run_start,
    statement_of,
)
from btlang.frontends.mission.tokens.sentence_reader import is_answer, is_question
from btlang.text.source import Source, Span
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.value_type import DOOR, OBJECT, PERSON, PLACE, ZONE

_MET = frozenset((DOOR, OBJECT, PERSON, PLACE, ZONE))
_BLOCK = ("following", "colon", "indent")
_CLEAR_BEHIND = frozenset(("then", "dedent", *RULES))


def with_framed_rules(tokens: list[Token], vocabulary: Lexicon, source: Source) -> Iterator[Diagnostic]:
    """Make what stands in front of such a rule a part of its condition, or the end of a block in which it holds.

    BT151 where more follows: `until 5 pm, whenever C, A. B` may do B at once, or then.
    """
    _put_into_time(tokens, vocabulary)
    for at in reversed(range(1, len(tokens))):
        if tokens[at].kind not in RULES:
            continue
        first, last = statement_of(tokens, at)
        last = _with_replies(tokens, at, last)
        framed = _framed(tokens[first:at], tokens[at:last])
        behind = run_end(tokens, last, STATEMENT_ENDS)
        waits = any(token.kind == "following" for token in framed)
        if waits and tokens[behind : behind + 1] and tokens[behind].kind not in _CLEAR_BEHIND:
            whole, more = Span(source, tokens[first].start, tokens[last - 1].end), statement_of(tokens, behind)[1]
            said = source.text[tokens[behind].start : tokens[more - 1].end]
            rule = source.text[tokens[at].start : tokens[last - 1].end]
            one, other = f"... {vocabulary.word('then')} {said[:1].lower()}{said[1:]}", f"{rule}. {said}"
            yield diagnostic("BT151", whole, words=whole.text, one=one, other=other)
        tokens[first:last] = framed


def _with_replies(tokens: Sequence[Token], rule: int, last: int) -> int:
    """Where a rule ends that asks something, with what is done for the answers: `whenever C, ask "Tea?". If so, A`."""
    asks = any(map(is_question, tokens[rule:last]))
    while asks and len(tokens) > last + 2 and tokens[last].kind == "semi" and tokens[last + 1].kind in ("if", "unless"):
        if not is_answer(tokens[last + 2 + (tokens[last + 2].kind == "not")]):
            break
        last = statement_of(tokens, last + 1)[1]
    return last


def _put_into_time(tokens: list[Token], vocabulary: Lexicon) -> None:
    """`from 10 am to 4 pm, stay at the door. Whenever somebody is near, A`: in that time, where the robot is then.

    What is about the robot itself holds for the whole mission: `whenever the battery is low`.
    """
    for ending in reversed([at for at, token in enumerate(tokens) if token.kind == "until_time"]):
        first, end = statement_of(tokens, ending)
        if ending >= first + len(_frame(tokens[first:end])) or any(each.kind in RULES for each in tokens[first:end]):
            continue
        at, rules = end, list[Token]()
        while tokens[at : at + 1] and tokens[at].kind == "semi" and _meets_others(tokens[at + 1 :], vocabulary):
            last = statement_of(tokens, at + 1)[1]
            tokens[at + 1].kind = "first_time" if tokens[at + 1].kind == "as_soon_as" else tokens[at + 1].kind
            rules += [*tokens[at + 1 : last], Token("newline", tokens[at].start, tokens[at].start)]
            at = last
        if rules:
            here = tokens[first].start
            opening, dedent = [Token(kind, here, here) for kind in _BLOCK], Token("dedent", here, here)
            tokens[first:at] = [*tokens[first:ending], *opening, *rules, *tokens[ending:end], dedent]


def _meets_others(statement: Sequence[Token], vocabulary: Lexicon) -> bool:
    """Whether a statement is a rule about somebody or something that the robot meets."""
    if not statement or statement[0].kind not in (*RULES, "as_soon_as"):
        return False
    asked = [token.value for token in statement[1 : _behind(statement)]]
    entries = [value.entry for value in asked if isinstance(value, Called | Listed)]
    somebody = vocabulary.negative_subjects.keys()
    return any(
        not _MET.isdisjoint(slot.type for slot in entry.slots)
        or not somebody.isdisjoint(word for phrase in entry.phrases[:1] for word in phrase.split())
        for entry in entries
    )


def _framed(before: Sequence[Token], rule: Sequence[Token]) -> list[Token]:
    """The tokens of a rule and of what stands in front of it.

    A rule behind what is done until some time is left there: that ends what is done, too.
    """
    frame, end = _frame(before), _behind(rule)
    done = before[len(frame) :]
    ending = next((at for at, token in enumerate(frame) if token.kind in WAITING), -1)
    is_front = not done and end < len(rule)
    is_behind = bool(done) and end == len(rule) and all(each.kind == "command" for each in done)
    if not frame or end < 2 or not (is_front or (is_behind and ending < 0)):
        return [*before, *rule]
    if ending >= 0:
        return [*frame[:ending], *_until(frame[ending:], rule)]
    asked, here = frame[1 : _behind(frame)], rule[0].start

    def mark(kind: str) -> Token:
        return Token(kind, here, here)

    so = [*([mark("not")] if frame[0].kind == "unless" else []), mark("open"), *asked, mark("close")]
    both = [mark("open"), *rule[1:end], mark("close"), mark("and"), *so]
    return [rule[0], *both, *(rule[end:] if is_front else (mark("comma"), *done))]


def _frame(said: Sequence[Token]) -> Sequence[Token]:
    """The tokens of a time, or of a condition, in front of what is done, with what joins them."""
    if not said or said[0].kind not in ("while", "unless", "wait_until", *WAITING):
        return []
    end = _behind(said)
    if said[0].kind == "wait_until":  # `after 5 pm, A`, `from 9 am to 5 pm, A`
        end = run_end(said, end, ("then",))
        end = run_end(said, end, ("until_time",))
    last = run_end(said, end, ("comma",))
    return said[:last] if said[last - 1].kind in JOINTS else []


def _until(ending: Sequence[Token], rule: Sequence[Token]) -> list[Token]:
    """The block in which a rule holds until something is so, or for some time."""
    here = rule[0].start
    opening = [Token(kind, here, here) for kind in _BLOCK]
    newline, dedent = (Token(kind, here, here) for kind in ("newline", "dedent"))
    first = ending[0]
    waits = [Token(WAITING[first.kind], first.start, first.end, first.value), *ending[1 : _behind(ending)]]
    return [*opening, *rule, newline, *waits, dedent]


def _behind(form: Sequence[Token]) -> int:
    """Where the condition of a form ends; what joins a command behind it is no part of it."""
    return max(1, run_start(form, run_end(form, 1, IN_CONDITIONS), JOINTS))
