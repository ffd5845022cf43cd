"""Commands in whose place others are done: `A, but if C, B`, `A. If C, B instead`; `A, but if C, B first` does both."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.token import (
    IN_CONDITIONS,
    JOINTS,
    STATEMENT_ENDS,
    Called,
    Listed,
    Token,
    drives,
    run_end,
    run_start,
    statement_of,
    statement_start,
    texts_of,
)
from btlang.frontends.mission.tokens.ended_rules import say_there
from btlang.frontends.mission.tokens.rules_inside import asks_if_blocked
from btlang.frontends.mission.tokens.settling import FAILS
from btlang.text.source import Source, Span
from btlang.tree.answers import ABOUT_ANSWERS
from btlang.tree.sums import COMPARED
from btlang.vocabulary.descriptions import NAME
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.references import choice_of
from btlang.vocabulary.value_type import DOOR, OBJECT, PERSON, PLACE, ZONE

INSTEAD = "instead"
"""The role of a command that is done in the place of one before it."""
FIRST = "first"
"""The value of a `but` behind which something is done before the rest."""
_HEADS = ("every", "every_day", "weekly", "on_days", "at")
_STATES = frozenset((PLACE, ZONE, DOOR, "days", "time_of_day"))
"""The types of values of conditions that last."""
_PLAIN = frozenset(("command", "wait", "for", "count", *JOINTS))


def with_replacements(tokens: list[Token], vocabulary: Lexicon, source: Source) -> Iterator[Diagnostic]:
    """Make such statements `unless C, A, otherwise B`, and `if C, B, then A`; C is asked before either.

    BT166 for `A. If C, B instead` where it isn't clear what B replaces.
    """
    for at in reversed([at for at, token in enumerate(tokens) if token.kind == "before"]):
        _prepare(tokens, at)
    for at in reversed(range(1, len(tokens))):
        if tokens[at].kind == "but" and tokens[at + 1 : at + 2] and _follows(tokens, at + 1):
            yield from _turn(tokens, at, vocabulary, source)
    yield from _find_moved_again(tokens, vocabulary, source)
    for at in reversed(range(1, len(tokens))):
        if tokens[at].role == INSTEAD and not _replace(tokens, at, vocabulary, source):
            begin, last = tokens[at].end, tokens[at + 1].start if at + 1 < len(tokens) else len(source.text)
            said = source.text[begin:last].strip(" ,")
            begin = source.text.index(said, begin)
            span = Span(source, begin, begin + len(said))
            yield diagnostic("BT166", span, words=span.text, otherwise=vocabulary.word("otherwise"))


def _prepare(tokens: list[Token], at: int) -> None:
    """`if the battery is low, charge before you go to the lab`: only the first of both depends on the condition."""
    first, end = statement_of(tokens, at)
    here = tokens[at].start
    is_form = tokens[first].kind in ("if", "unless") and _form(tokens[first:at]) is not None
    if is_form and all(token.kind in _PLAIN for token in tokens[at + 1 : end]):
        tokens[at : at + 1] = [Token("close", here, here), Token("then", tokens[at].start, tokens[at].end)]
        tokens.insert(first, Token("open", tokens[first].start, tokens[first].start))


def _find_moved_again(tokens: Sequence[Token], vocabulary: Lexicon, source: Source) -> Iterator[Diagnostic]:
    """BT151 for `bring the cup to Alice. If C, put it on the table`: then, or in its place."""
    for at in range(2, len(tokens)):
        if tokens[at].kind != "if" or tokens[at - 1].kind != "semi" or tokens[at - 2].kind != "command":
            continue
        end = statement_of(tokens, at)[1]
        form = _form(tokens[at:end])
        replaces = form is not None and any(token.role == INSTEAD for token in form[1])
        if form is None or replaces or not _is_state(form[0], vocabulary, source):
            continue
        moved = _moved(tokens[at - 2])
        if not any(moved & _moved(token) for token in form[1]):
            continue
        if _asks_for_receiver(tokens[at - 2], form[0]):
            form[1][0].role = INSTEAD  # `bring the cup to Bob. If he isn't in the lab, take it to the hall`
        else:
            whole, first = Span(source, tokens[at].start, form[1][-1].end), form[1][0].start
            asked, said = source.text[tokens[at].start : first], source.text[first : whole.end]
            then, instead = vocabulary.word("then"), vocabulary.word("instead")
            other = f"{then} {asked[:1].lower()}{asked[1:]}{said}"
            yield diagnostic("BT151", whole, words=whole.text, one=f"{whole.text} {instead}", other=f"..., {other}")


def _asks_for_receiver(command: Token, condition: Sequence[Token]) -> bool:
    """Whether a condition says that somebody to whom a command brings something isn't at a place."""
    kinds, value, asked = [token.kind for token in condition], command.value, condition[-1].value
    if kinds != ["not", "condition"] or not isinstance(value, Called) or not isinstance(asked, Called):
        return False
    persons = value.entry.given(PERSON, value.arguments)
    return bool(persons) and persons == asked.entry.given(PERSON, asked.arguments)


def _moved(command: Token) -> set[str]:
    """The things that a command brings to a place or a person, who speaks where none is named."""
    value = command.value
    if not isinstance(value, Called):
        return set()
    named = [(text, choice_of(text)) for text in value.entry.given(OBJECT, value.arguments)]
    things = {text if choice is None else f"{{{choice.key}}}" for text, choice in named}
    things |= {dict(choice.parts).get(NAME, "") for _, choice in named if choice is not None} - {""}
    is_for_somebody = any(slot.type == PERSON for slot in value.entry.slots)
    has_goal = is_for_somebody or any(value.entry.given(PLACE, value.arguments))
    return things if has_goal and drives(value) else set()


def _follows(tokens: Sequence[Token], at: int) -> bool:
    return tokens[at].kind in ("if", "unless") or tokens[at].value == FAILS


def _turn(tokens: list[Token], but: int, vocabulary: Lexicon, source: Source) -> Iterator[Diagnostic]:
    """`A, but if C, B`: B in the place of A; `A, but if that fails, B` says nothing with its `but`.

    BT151 where C may become so while A is done: `go to the lab, but if you see Bob, wave`.
    """
    first, end = statement_of(tokens, but)
    if tokens[but + 1].value == FAILS:
        del tokens[but]
        return
    form = _form(tokens[but + 1 : end])
    tokens[but].kind = "and"
    if form is not None and (asks_if_blocked(tokens, but + 1) or _asks_of_outcome(form[0])):
        return
    tokens[but].kind = "but"
    first = run_end(tokens, first, _HEADS)
    first = run_end(tokens, first, ("comma",))
    before = tokens[first : run_start(tokens, but, ("comma",))]
    if form is None or not before or any(token.kind not in _PLAIN for token in before):
        return
    condition, done = form
    if tokens[but].value == FIRST:
        here = tokens[but].start
        comma, close = Token("comma", here, here), Token("close", here, here)
        front = [Token("open", here, here), tokens[but + 1], *condition, comma, *done, close, Token("then", here, here)]
        tokens[first:end] = [*front, *before]
        return
    tokens[first:end] = _either(before, tokens[but + 1], condition, done, vocabulary, source)
    if not _is_state(condition, vocabulary, source):
        whole = Span(source, before[0].start, done[-1].end)
        parts = ((before[0], before[-1]), (condition[0], condition[-1]), (done[0], done[-1]))
        usual, asked, other = (source.text[start.start : last.end] for start, last in parts)
        word = vocabulary.word
        one = f"{word('unless')} {asked}, {usual}. {word('otherwise').capitalize()} {other}"
        yield diagnostic(
            "BT151", whole, words=whole.text, one=one, other=f"{word('whenever')} {asked}, {other}; {usual}"
        )


def _replace(tokens: list[Token], at: int, vocabulary: Lexicon, source: Source) -> bool:
    """`A. If C, B instead`: B in the place of A, the last command before it."""
    first, end = statement_of(tokens, at)
    last = run_start(tokens, first, STATEMENT_ENDS)
    form = _form(tokens[first:end]) if tokens[first].kind in ("if", "unless") else None
    begin = statement_start(tokens, last)
    if form is None or last <= 0 or any(token.kind not in _PLAIN for token in tokens[begin:last]):
        return False
    command, done = tokens[last - 1], last - 1
    _say_where([command], form[0], vocabulary, source)
    if not _is_state(form[0], vocabulary, source):
        return False
    moved = _moved(command)
    is_other = not any(moved & _moved(token) for token in form[1])
    is_joined = begin < done and tokens[done - 1].kind == "and" and is_other
    if command.kind != "command" or is_joined or not _are_alike(command, form[1][0]):
        return False
    tokens[done:end] = [
        Token("open", command.start, command.start),
        *_either([command], tokens[first], *form, vocabulary, source),
        Token("close", tokens[end - 1].end, tokens[end - 1].end),
    ]
    return True


def _form(said: Sequence[Token]) -> tuple[list[Token], list[Token]] | None:
    """The condition of a form, and what is done; None for others."""
    comma = run_end(said, 1, IN_CONDITIONS)
    done = list(said[comma + 1 :])
    is_form = comma > 1 and said[comma : comma + 1] and said[comma].kind == "comma" and done
    return (list(said[1:comma]), done) if is_form and all(token.kind in _PLAIN for token in done) else None


def _either(
    before: Sequence[Token],
    form: Token,
    condition: Sequence[Token],
    done: Sequence[Token],
    vocabulary: Lexicon,
    source: Source,
) -> list[Token]:
    """The tokens that do what stands before a form if its condition isn't so, else what is done there."""
    here = before[0].start
    kind = "unless" if form.kind == "if" else "if"
    if [token.kind for token in condition] == ["not", "condition"]:
        kind, condition = form.kind, condition[1:]  # not `unless not`
    _say_where(before, condition, vocabulary, source)
    for token in done:
        token.role = "" if token.role == INSTEAD else token.role
    comma, otherwise = Token("comma", here, here), Token("otherwise", form.start, form.end)
    return [Token(kind, here, here), *condition, comma, *before, Token("stop", here, here), otherwise, *done]


def _say_where(before: Sequence[Token], condition: Sequence[Token], vocabulary: Lexicon, source: Source) -> None:
    """`take the cup to the lab, but if Bob isn't there, B` asks whether he is in the lab before the robot goes."""
    goals = {
        text
        for token in before
        if isinstance(token.value, Called)
        for text in token.value.entry.given(PLACE, token.value.arguments)
    }
    for token in condition:
        if token.kind == "condition" and len(goals) == 1:
            say_there(token, [], vocabulary, source.text[token.start : token.end], next(iter(goals)))


def _asks_of_outcome(condition: Sequence[Token]) -> bool:
    """Whether a condition is about an answer, or what was counted: `ask Bob "Tea?", but if he says no, A`."""
    said = [token.value for token in condition if isinstance(token.value, Called | Listed)]
    return any(value.entry.id in ABOUT_ANSWERS or value.entry.id == COMPARED for value in said)


def _is_state(condition: Sequence[Token], vocabulary: Lexicon, source: Source) -> bool:
    """Whether a condition is about a place, a door or a time, and not about what the robot meets on its way."""
    if any(vocabulary.says_event(source.text[token.start : token.end]) for token in condition):
        return False
    said = [token.value for token in condition if isinstance(token.value, Called | Listed)]
    return all(not _STATES.isdisjoint(slot.type for slot in value.entry.slots) for value in said)


def _are_alike(command: Token, other: Token) -> bool:
    """Whether two commands drive, or are about the same thing, or neither drives."""
    value, instead = command.value, other.value
    if not isinstance(value, Called | Listed) or not isinstance(instead, Called | Listed):
        return False
    return drives(value) == drives(instead) or not set(texts_of(value)).isdisjoint(texts_of(instead))
