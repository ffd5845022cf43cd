"""Inverse rules: for each id of a node the forms of the language that may say it, the most natural first; see
lift.py.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from decimal import Decimal

from btlang.backends.english.candidate import REFERENCE, Candidate, Checked
from btlang.text.source import NOWHERE
from btlang.tree import ast
from btlang.tree.catalogue import CONSTRAINTS, zone_names
from btlang.tree.endless import is_wait
from btlang.tree.node import Node
from btlang.vocabulary.references import ALL, Choice, names_key
from btlang.vocabulary.value_type import WORLD

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    Form: TypeAlias = Callable[[Node, tuple[Candidate, ...], Checked], Iterator[ast.Ast]]

_WHOLE = re.compile(r"\d{1,15}")
_TIME = re.compile(r"([01]\d|2[0-3]):[0-5]\d", re.ASCII)
_ROUNDS = re.compile(r"-1|[1-9]\d{0,9}")
_ENDLESS = "-1"


def _chain(operator: str) -> Form:
    def forms(_node: Node, children: tuple[Candidate, ...], checked: Checked) -> Iterator[ast.Ast]:
        if len(children) < 2:
            return
        rounds = operator == "parallel"
        items = [_round(child, checked, _line) if rounds else child.command for child in children]
        if all(item is not None for item in items):
            yield ast.Chain(operator, tuple(item for item in items if item is not None), True, NOWHERE)

    return forms


def _sequence(node: Node, children: tuple[Candidate, ...], checked: Checked) -> Iterator[ast.Ast]:
    """Propose `A 3 times 10 s apart`, or a chain."""
    last = children[1] if len(children) == 2 else None
    if last is not None and last.node.id == "LoopString" and children[0].node.id == "ChooseAll":
        found, loop = dict(children[0].node.ports), last.node
        key, kind, names = loop.port("value")[1:-1], found.pop("type", ""), found.pop("output", "")
        if names == loop.port("queue") == f"{{{names_key(key)}}}" and kind in WORLD:
            text = Choice(ALL, kind, key, tuple(sorted(found.items()))).text
            yield ast.ForEach(key, kind, (text,), last.children[0].part, NOWHERE)
    if last is not None and last.node.id == "Repeat" and [part.node.id for part in last.children] == ["Delay"]:
        delay, rounds = last.children[0].node, last.node.port("num_cycles")
        body = _round(children[0], checked) if delay.children == (children[0].node,) else None
        if body is not None and _ROUNDS.fullmatch(rounds):
            number = rounds if rounds == _ENDLESS else str(int(rounds) + 1)
            times = _seconds(delay.port("delay_msec"), checked)
            yield from (ast.Apart(seconds, body, number, NOWHERE) for seconds in times)
    yield from _chain("sequence")(node, children, checked)


def _block(raised: Candidate) -> ast.Ast:
    return raised.part


def _line(raised: Candidate) -> ast.Ast:
    return raised.command


def _round(child: Candidate, checked: Checked, said: Callable[[Candidate], ast.Ast] = _block) -> ast.Ast | None:
    """Return the body of a form that counts a skipped round as a round; None if it isn't as it stands."""
    if child.node.id == "Sequence" and len(child.children) == 2 and not child.node.ports and not child.node.name:
        body, rest = child.children
        if checked.can_skip(said(body)) and _is_plain(rest.node, "AlwaysSuccess"):
            return said(body)
    return said(child) if not checked.can_skip(said(child)) else None


def _is_plain(node: Node, node_id: str) -> bool:
    return node.id == node_id and not node.ports and not node.name and not node.children


def _otherwise(last: Candidate, *ports: tuple[str, str]) -> ast.Ast | None:
    """Return the branch behind `otherwise`; None if there is none to be said."""
    node = last.node
    return None if node.id == "AlwaysSuccess" and node.ports == ports and not node.name else last.part


def _condition(raised: Candidate) -> tuple[bool, ast.Ast] | None:
    """Return a condition, and whether it stands behind `unless` or `until`."""
    if raised.condition is None:
        return None
    if isinstance(raised.condition, ast.Not):
        return True, raised.condition.condition
    return False, raised.condition


def _if_then_else(_node: Node, children: tuple[Candidate, ...], _checked: Checked) -> Iterator[ast.Ast]:
    found = _condition(children[0]) if len(children) == 3 else None
    if found is not None and isinstance(children[0].command, ast.Remember):
        found = None  # it measures to decide
    if found is not None:
        otherwise = _otherwise(children[2], ("_skipIf", "true"))
        negated, condition = found if otherwise is None else (False, children[0].condition)
        assert condition is not None
        yield ast.If(negated, condition, children[1].part, otherwise, NOWHERE)
    elif len(children) == 3 and not any(child.in_lines for child in children):
        tried, body, last = children
        yield ast.IfWorks(tried.command, body.command, _otherwise(last, ("_skipIf", "true")), NOWHERE)


def _while_do_else(_node: Node, children: tuple[Candidate, ...], checked: Checked) -> Iterator[ast.Ast]:
    found = _condition(children[0]) if len(children) == 3 else None
    again = children[1] if len(children) == 3 else None
    if found is None or again is None or again.node.id != "Repeat" or len(again.children) != 1:
        yield from _stop_when(children)
        return
    body = _round(again.children[0], checked)
    if body is not None:
        yield ast.While(*found, body, _otherwise(children[2]), NOWHERE)


def _stop_when(children: tuple[Candidate, ...]) -> Iterator[ast.Ast]:
    condition = children[0].condition if len(children) == 3 else None
    if isinstance(condition, ast.Not) and not children[1].in_lines and _otherwise(children[2]) is None:
        yield ast.StopWhen(condition.condition, children[1].command, NOWHERE)


def _provided(_node: Node, children: tuple[Candidate, ...], _checked: Checked) -> Iterator[ast.Ast]:
    guards = [child.condition for child in children[:-1]]
    guarded: ast.Ast = children[-1].part if children else ast.Nothing(NOWHERE)
    for condition in reversed(guards):
        if condition is None:
            return
        guarded = ast.Provided(condition, guarded, NOWHERE)
    if guards:
        yield guarded


def propose_held(node: Node, children: tuple[Candidate, ...], checked: Checked) -> Iterator[ast.Ast]:
    """Propose a condition that has to hold for some time."""
    if node.id == "ReactiveSequence" and len(children) == 2:
        condition, timer = children
        if condition.condition is not None and timer.node.id == "Sleep":
            for seconds in _seconds(timer.node.port("msec"), checked):
                yield ast.Held(condition.condition, seconds, NOWHERE)


def _whenever(node: Node, children: tuple[Candidate, ...], _checked: Checked) -> Iterator[ast.Ast]:
    """Propose the rule, with what it stands over as further lines of its block."""
    condition = children[0].awaited if len(children) == 3 else None
    if condition is None:
        return
    _, reaction, rest = children
    rule = ast.Whenever(condition, reaction.part, node.port("once") == "true", NOWHERE)
    if rest.node.id == "KeepRunningUntilFailure":
        items: tuple[ast.Ast, ...] = ()
    elif isinstance(rest.body, ast.Chain) and rest.body.operator == "sequence":
        items = rest.body.items
    else:
        items = (rest.command,)
    yield ast.Chain("sequence", (rule, *items), True, NOWHERE)


def _repeat(node: Node, children: tuple[Candidate, ...], checked: Checked) -> Iterator[ast.Ast]:
    if len(children) != 1:
        return
    rounds = node.port("num_cycles")
    number = _rounds(rounds, checked)
    if number is not None and children[0].node.id == "Parallel" and len(children[0].children) == 2:
        body, timer = children[0].children
        every, paced = _round(body, checked), "" if rounds == _ENDLESS else number
        if every is not None and timer.node.id == "Sleep":
            times = _seconds(timer.node.port("msec"), checked)
            yield from (ast.Every(seconds, every, paced, NOWHERE) for seconds in times)
    part = _round(children[0], checked)
    if part is not None and number is not None:
        yield ast.Repeat(number, part, NOWHERE)


def _retry(node: Node, children: tuple[Candidate, ...], checked: Checked) -> Iterator[ast.Ast]:
    if len(children) != 1:
        return
    attempts = node.port("num_attempts")
    child = children[0]
    if attempts == _ENDLESS and child.is_condition and child.condition is not None:
        yield ast.WaitUntil(child.condition, NOWHERE)
    elif attempts == _ENDLESS and child.held is not None:
        yield ast.WaitUntil(child.held, NOWHERE)
    number = _rounds(attempts, checked)
    if number is None:
        return
    if child.node.id == "Fallback" and len(child.children) == 2 and _is_pause(child.children[1].node):
        part = _round(child.children[0], checked)
        times = _seconds(child.children[1].node.children[0].port("msec"), checked)
        if part is not None:
            yield from (ast.Retry(number, part, seconds, NOWHERE) for seconds in times)
    part = _round(child, checked)
    if part is not None:
        yield ast.Retry(number, part, "", NOWHERE)


def _is_pause(node: Node) -> bool:
    return node.id == "Sequence" and [part.id for part in node.children] == ["Sleep", "AlwaysFailure"]


def _ignoring_failure(_node: Node, children: tuple[Candidate, ...], _checked: Checked) -> Iterator[ast.Ast]:
    if len(children) == 1:
        yield ast.Try(children[0].part, None, NOWHERE)


def _parallel(node: Node, children: tuple[Candidate, ...], checked: Checked) -> Iterator[ast.Ast]:
    if node.port("success_count") == "1" and all(child.node.id == "WaitForTime" for child in children):
        yield from _next_time(children, checked)
    timer = children[0].node if len(children) == 2 else node
    if timer.id in ("Sleep", "WaitForTime") and children[1].node.id == "Repeat":
        again = children[1].children
        body = _round(again[0], checked) if len(again) == 1 else None
        if body is not None:
            yield from (ast.For(seconds, body, NOWHERE) for seconds in _seconds(timer.port("msec"), checked))
            yield from (ast.UntilTime(time, body, NOWHERE) for time in _times(timer.port("time"), checked))
    if timer.id == "WaitForTime" and not children[1].in_lines:
        wait = _round(children[1], checked)
        if wait is not None and is_wait(wait):
            yield from (ast.UntilTime(time, wait, NOWHERE) for time in _times(timer.port("time"), checked))
    if [part.id for part in timer.children] == ["WaitForTime", "AlwaysFailure"] and not children[1].in_lines:
        body = _round(children[1], checked) if timer.id == "Sequence" else None
        if body is not None:
            yield from (ast.ByTime(time, body, NOWHERE) for time in _times(timer.children[0].port("time"), checked))
    if timer.id == "Sleep" and not children[1].in_lines:
        body = _round(children[1], checked)
        if body is not None:
            yield from (ast.UpTo(seconds, body, NOWHERE) for seconds in _seconds(timer.port("msec"), checked))
    yield from _chain("parallel")(node, children, checked)


def _next_time(children: Sequence[Candidate], checked: Checked) -> Iterator[ast.Ast]:
    """Propose the next of several times of day."""
    times = [time for child in children for time in _times(child.node.port("time"), checked)]
    if len(times) == len(children):
        yield ast.WaitTime(";".join(times), NOWHERE)


def _fallback(node: Node, children: tuple[Candidate, ...], checked: Checked) -> Iterator[ast.Ast]:
    """Propose a chain. Two children are said as blocks if one of them is a sequence that needs its own lines."""
    if len(children) == 2 and any(child.part is not child.command for child in children):
        yield ast.Try(children[0].part, children[1].part, NOWHERE)
    yield from _chain("fallback")(node, children, checked)


def _within(node: Node, children: tuple[Candidate, ...], checked: Checked) -> Iterator[ast.Ast]:
    part = _round(children[0], checked) if len(children) == 1 else None
    if part is not None:
        yield from (ast.Within(seconds, part, NOWHERE) for seconds in _seconds(node.port("msec"), checked))


def _constrained(kind: str) -> Form:
    def forms(node: Node, children: tuple[Candidate, ...], checked: Checked) -> Iterator[ast.Ast]:
        zones = tuple(zone_names(node.port("zones")))
        if len(children) == 1 and not children[0].in_lines and zones:
            yield ast.Constrained(kind, zones, children[0].part, NOWHERE)

    return forms


def _delay(node: Node, children: tuple[Candidate, ...], checked: Checked) -> Iterator[ast.Ast]:
    if len(children) == 1:
        times = _seconds(node.port("delay_msec"), checked)
        yield from (ast.Delay(seconds, children[0].part, NOWHERE) for seconds in times)


def _wait(node: Node, _children: tuple[Candidate, ...], checked: Checked) -> Iterator[ast.Ast]:
    yield from (ast.Wait(seconds, NOWHERE) for seconds in _seconds(node.port("msec"), checked))


def _wait_time(node: Node, _children: tuple[Candidate, ...], checked: Checked) -> Iterator[ast.Ast]:
    yield from (ast.WaitTime(time, NOWHERE) for time in _times(node.port("time"), checked))


def _times(port: str, checked: Checked) -> Iterator[str]:
    """Yield a time of day that can be said."""
    text = checked.text(port) if port[:1] == "{" else port if _TIME.fullmatch(port) else None
    if text is not None:
        yield text


def _seconds(msec: str, checked: Checked) -> Iterator[str]:
    """Yield milliseconds of a port as seconds, as precise; computed ones as the value that they come from."""
    if _WHOLE.fullmatch(msec):
        yield f"{(Decimal(msec) / 1000).normalize():f}"
    elif msec[:1] == "{":
        text = checked.text(msec)
        if text is not None and REFERENCE.fullmatch(text):
            yield text


def _rounds(port: str, checked: Checked) -> str | None:
    """Return a number of rounds that can be said."""
    return checked.text(port) if port[:1] == "{" or _ROUNDS.fullmatch(port) else None


def _nothing(_node: Node, _children: tuple[Candidate, ...], _checked: Checked) -> Iterator[ast.Ast]:
    yield ast.Nothing(NOWHERE)


def _wait_forever(node: Node, _children: tuple[Candidate, ...], _checked: Checked) -> Iterator[ast.Ast]:
    if [(child.id, child.ports) for child in node.children] == [("AlwaysSuccess", ())]:
        yield ast.WaitForever(NOWHERE)


def _fail(_node: Node, _children: tuple[Candidate, ...], _checked: Checked) -> Iterator[ast.Ast]:
    yield ast.Fail(NOWHERE)


INVERSE_RULES: dict[str, Form] = {
    "Sequence": _sequence,
    "Fallback": _fallback,
    "Parallel": _parallel,
    "IfThenElse": _if_then_else,
    "WhileDoElse": _while_do_else,
    "ReactiveSequence": _provided,
    "Whenever": _whenever,
    "KeepRunningUntilFailure": _wait_forever,
    "Repeat": _repeat,
    "RetryUntilSuccessful": _retry,
    "ForceSuccess": _ignoring_failure,
    **{node_id: _constrained(kind) for kind, node_id in CONSTRAINTS.items()},
    "Timeout": _within,
    "Delay": _delay,
    "Sleep": _wait,
    "WaitForTime": _wait_time,
    "AlwaysSuccess": _nothing,
    "AlwaysFailure": _fail,
}
