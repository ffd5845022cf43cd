"""AST to tree: what each form of the language means in nodes of BehaviorTree.CPP."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from btlang.record import Record
from btlang.text.source import Span
from btlang.tree import ast
from btlang.tree.node import Node
from btlang.tree.visit import fold

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_CHAINS = {"sequence": "Sequence", "all": "Sequence", "fallback": "Fallback", "any": "Fallback", "parallel": "Parallel"}


class Lowered(Record):
    """A node, and whether it can end SKIPPED."""

    node: Node
    can_skip: bool = False


def lower(root: ast.Ast, skipping: set[str]) -> Lowered:
    """The tree of a command or condition. `skipping` are the defined names whose trees can end SKIPPED."""

    def combine(item: ast.Ast, done: list[Lowered]) -> Lowered:
        if isinstance(item, ast.Name):
            return Lowered(Node("SubTree", (), (("ID", item.name),), span=item.span), item.name in skipping)
        return _LOWER[type(item)](item, done)

    return fold(root, ast.parts, combine)


def _node(node_id: str, children: Sequence[Node], span: Span, **ports: str) -> Node:
    return Node(node_id, tuple(children), tuple(ports.items()), span=span)


def _round(body: Lowered) -> Node:
    """A skipped round counts as a round."""
    if not body.can_skip:
        return body.node
    span = body.node.span
    assert span is not None
    return _node("Sequence", (body.node, _node("AlwaysSuccess", (), span)), span)


def _negated(negated: bool, condition: Node) -> Node:
    return Node("Inverter", (condition,), span=condition.span) if negated else condition


def _phrase(item: ast.Phrase, _done: list[Lowered]) -> Lowered:
    """A value that is the slot's default says nothing."""
    defaults = {slot.name: slot.default for slot in item.entry.slots}
    order = list(defaults)
    spoken = [(name, text) for name, text in item.arguments if defaults.get(name) != text]
    ports = tuple(sorted(spoken, key=lambda port: order.index(port[0])))
    return Lowered(Node(item.entry.id, (), ports, span=item.span))


def _chain(item: ast.Chain, done: list[Lowered]) -> Lowered:
    if item.operator == "sequence" and any(isinstance(part, ast.Whenever) for part in item.items):
        return _ruled(item, done)
    if item.operator == "parallel":
        return Lowered(_node("Parallel", [_round(part) for part in done], item.span))
    children = [part.node for part in done]
    return Lowered(_node(_CHAINS[item.operator], children, item.span), all(part.can_skip for part in done))


def _ruled(item: ast.Chain, done: list[Lowered]) -> Lowered:
    """Standing rules round the other commands; the first one is the outermost, so that it wins."""
    rules = [part for part, own in zip(done, item.items, strict=True) if isinstance(own, ast.Whenever)]
    others = [part for part, own in zip(done, item.items, strict=True) if not isinstance(own, ast.Whenever)]
    if not others:
        work = Lowered(_node("AlwaysSuccess", (), item.span))
    elif len(others) == 1:
        work = others[0]
    else:
        work = Lowered(_node("Sequence", [part.node for part in others], item.span), all(p.can_skip for p in others))
    for rule in reversed(rules):
        condition, reaction, _ = rule.node.children
        span = rule.node.span or item.span
        work = Lowered(_node("Whenever", (condition, reaction, work.node), span), work.can_skip)
    return work


def _whenever(item: ast.Whenever, done: list[Lowered]) -> Lowered:
    """A rule alone has nothing to interrupt."""
    nothing = _node("AlwaysSuccess", (), item.span)
    return Lowered(_node("Whenever", (done[0].node, done[1].node, nothing), item.span))


def _not(item: ast.Not, done: list[Lowered]) -> Lowered:
    return Lowered(_node("Inverter", [done[0].node], item.span))


def _if(item: ast.If, done: list[Lowered]) -> Lowered:
    condition = _negated(item.negated, done[0].node)
    if item.otherwise is None:
        skipped = _node("AlwaysSuccess", (), item.span, _skipIf="true")
        return Lowered(_node("IfThenElse", (condition, done[1].node, skipped), item.span), True)
    branches = done[1], done[2]
    children = (condition, *(branch.node for branch in branches))
    return Lowered(_node("IfThenElse", children, item.span), any(branch.can_skip for branch in branches))


def _while(item: ast.While, done: list[Lowered]) -> Lowered:
    condition = _negated(item.negated, done[0].node)
    again = _node("Repeat", [_round(done[1])], item.span, num_cycles="-1")
    otherwise = done[2] if item.otherwise is not None else Lowered(_node("AlwaysSuccess", (), item.span))
    return Lowered(_node("WhileDoElse", (condition, again, otherwise.node), item.span), otherwise.can_skip)


def _provided(item: ast.Provided, done: list[Lowered]) -> Lowered:
    return Lowered(_node("ReactiveSequence", [part.node for part in done], item.span))


def _repeat(item: ast.Repeat, done: list[Lowered]) -> Lowered:
    return Lowered(_node("Repeat", [_round(done[0])], item.span, num_cycles=str(item.rounds)))


def _retry(item: ast.Retry, done: list[Lowered]) -> Lowered:
    return Lowered(_node("RetryUntilSuccessful", [_round(done[0])], item.span, num_attempts=str(item.attempts)))


def _try(item: ast.Try, done: list[Lowered]) -> Lowered:
    if item.otherwise is None:
        return Lowered(_node("ForceSuccess", [done[0].node], item.span), done[0].can_skip)
    tried, otherwise = done[0].node, [done[1].node]
    if isinstance(item.otherwise, ast.Chain) and item.otherwise.operator == "fallback" and not item.otherwise.bracketed:
        otherwise = list(done[1].node.children)  # equal nodes without brackets are one
    return Lowered(_node("Fallback", [tried, *otherwise], item.span), all(part.can_skip for part in done))


def msec(seconds: str) -> str:
    """Seconds as the whole milliseconds of a port."""
    return str(round(float(seconds) * 1000))


def _timer(seconds: str) -> Node:
    """The Sleep inside `for` and `every`: no sentence of its own, so that no log tells of it as a command."""
    return Node("Sleep", (), (("msec", msec(seconds)),))


def _within(item: ast.Within, done: list[Lowered]) -> Lowered:
    return Lowered(_node("Timeout", [_round(done[0])], item.span, msec=msec(item.seconds)))


def _for(item: ast.For, done: list[Lowered]) -> Lowered:
    sleep = _timer(item.seconds)
    again = _node("Repeat", [_round(done[0])], item.span, num_cycles="-1")
    return Lowered(_node("Parallel", (sleep, again), item.span, success_count="1", failure_count="1"))


def _every(item: ast.Every, done: list[Lowered]) -> Lowered:
    sleep = _timer(item.seconds)
    together = _node("Parallel", (_round(done[0]), sleep), item.span)
    return Lowered(_node("Repeat", [together], item.span, num_cycles="-1"))


def _delay(item: ast.Delay, done: list[Lowered]) -> Lowered:
    return Lowered(_node("Delay", [done[0].node], item.span, delay_msec=msec(item.seconds)), done[0].can_skip)


def _wait(item: ast.Wait, _done: list[Lowered]) -> Lowered:
    return Lowered(_node("Sleep", (), item.span, msec=msec(item.seconds)))


def _wait_until(item: ast.WaitUntil, done: list[Lowered]) -> Lowered:
    return Lowered(_node("RetryUntilSuccessful", [done[0].node], item.span, num_attempts="-1"))


def _check(_item: ast.Check, done: list[Lowered]) -> Lowered:
    return done[0]


def _nothing(item: ast.Nothing, _done: list[Lowered]) -> Lowered:
    return Lowered(_node("AlwaysSuccess", (), item.span))


def _fail(item: ast.Fail, _done: list[Lowered]) -> Lowered:
    return Lowered(_node("AlwaysFailure", (), item.span))


_LOWER: dict[type[ast.Ast], Callable[[Any, list[Lowered]], Lowered]] = {
    ast.Phrase: _phrase,
    ast.Chain: _chain,
    ast.Not: _not,
    ast.If: _if,
    ast.While: _while,
    ast.Whenever: _whenever,
    ast.Provided: _provided,
    ast.Repeat: _repeat,
    ast.Retry: _retry,
    ast.Try: _try,
    ast.Within: _within,
    ast.For: _for,
    ast.Every: _every,
    ast.Delay: _delay,
    ast.Wait: _wait,
    ast.WaitUntil: _wait_until,
    ast.Check: _check,
    ast.Nothing: _nothing,
    ast.Fail: _fail,
}
