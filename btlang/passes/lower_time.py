"""Lowering of forms of time: waiting, limits, delays, and timed rounds."""

from __future__ import annotations

from collections.abc import Callable

from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.passes.scope import Lowered, LoweringScope, new_node, new_round
from btlang.passes.scripts import make_script, run_before
from btlang.tree import ast
from btlang.tree.catalogue import MOST_NODES
from btlang.tree.endless import is_wait
from btlang.tree.node import Node
from btlang.vocabulary.references import keys_in

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_LARGE = MOST_NODES // 10  # nodes


def _retry(item: ast.Retry, done: list[Lowered], scope: LoweringScope) -> Lowered:
    body = new_round(done[0])
    scripts: list[Node] = []
    if item.pause:
        scripts, time = _timed(item.pause, scope)
        pause = new_node("Sequence", (_timer(time), new_node("AlwaysFailure", (), item.span)), item.span)
        body = new_node("Fallback", (body, pause), item.span)
    node = new_node("RetryUntilSuccessful", [body], item.span, num_attempts=item.attempts)
    return Lowered(run_before(scripts, node))


def _timed(seconds: str, scope: LoweringScope) -> tuple[list[Node], str]:
    """Return a time as whole milliseconds of a port; one that is only known when it runs is computed before."""
    [key] = list(keys_in(seconds)) or [""]
    if not key:
        return [], str(round(float(seconds) * 1000))
    made = scope.new_key()
    return [make_script(f"{made} := {key} * 1000")], f"{{{made}}}"


def _timer(milliseconds: str) -> Node:
    """Make the Sleep inside `for` and `every`: without a sentence, so that no log reports it as a command."""
    return Node("Sleep", (), (("msec", milliseconds),))


def _clock(time: str) -> Node:
    """Make the same with a time of day."""
    return Node("WaitForTime", (), (("time", time),))


def _within(item: ast.Within, done: list[Lowered], scope: LoweringScope) -> Lowered:
    scripts, limit = _timed(item.seconds, scope)
    return Lowered(run_before(scripts, new_node("Timeout", [new_round(done[0])], item.span, msec=limit)))


def _for(item: ast.For, done: list[Lowered], scope: LoweringScope) -> Lowered:
    scripts, time = _timed(item.seconds, scope)
    return Lowered(run_before(scripts, _again_beside(_timer(time), item, done[0])))


def _until_time(item: ast.UntilTime, done: list[Lowered], _scope: LoweringScope) -> Lowered:
    if is_wait(item.body):
        children = _clock(item.time), new_round(done[0])
        return Lowered(new_node("Parallel", children, item.span, success_count="1", failure_count="1"))
    return Lowered(_again_beside(_clock(item.time), item, done[0]))


def _by_time(item: ast.ByTime, done: list[Lowered], _scope: LoweringScope) -> Lowered:
    late = new_node("Sequence", (_clock(item.time), Node("AlwaysFailure")), item.span)
    children = late, new_round(done[0])
    return Lowered(new_node("Parallel", children, item.span, success_count="1", failure_count="1"))


def _again_beside(timer: Node, item: ast.Ast, body: Lowered) -> Node:
    """Repeat the body until the timer succeeds."""
    again = new_node("Repeat", [new_round(body)], item.span, num_cycles="-1")
    return new_node("Parallel", (timer, again), item.span, success_count="1", failure_count="1")


def _up_to(item: ast.UpTo, done: list[Lowered], scope: LoweringScope) -> Lowered:
    scripts, time = _timed(item.seconds, scope)
    children = _timer(time), new_round(done[0])
    return Lowered(run_before(scripts, new_node("Parallel", children, item.span, success_count="1", failure_count="1")))


def _every(item: ast.Every, done: list[Lowered], scope: LoweringScope) -> Lowered:
    scripts, time = _timed(item.seconds, scope)
    together = new_node("Parallel", (new_round(done[0]), _timer(time)), item.span)
    node = new_node("Repeat", [together], item.span, num_cycles=item.rounds or "-1")
    return Lowered(run_before(scripts, node), False, item.rounds in ("", "-1"))


def _apart(item: ast.Apart, done: list[Lowered], scope: LoweringScope) -> Lowered:
    """Make the first round, then the others with a delay before each. BT042 if what is said twice is too large."""
    body = new_round(done[0])
    if item.rounds == "1":
        return Lowered(body, False, done[0].endless)
    if _is_large(body):
        raise MissionError([diagnostic("BT042", item.span, limit=f"{MOST_NODES:,}")])
    scripts, time = _timed(item.seconds, scope)
    if item.rounds[:1] == "{":
        rest = scope.new_key()
        scripts.append(make_script(f"{rest} := {item.rounds[1:-1]} - 1"))
        rounds = f"{{{rest}}}"
    else:
        rounds = item.rounds if item.rounds == "-1" else str(int(item.rounds) - 1)
    others = new_node("Repeat", [new_node("Delay", [body], item.span, delay_msec=time)], item.span, num_cycles=rounds)
    node = new_node("Sequence", (body, others), item.span)
    return Lowered(run_before(scripts, node), False, rounds == "-1" or done[0].endless)


def _is_large(root: Node) -> bool:
    """Whether a node and all below it are too many to be said twice."""
    found, stack = 0, [root]
    while stack and found < _LARGE:
        node = stack.pop()
        found += 1
        stack += node.children
    return found >= _LARGE


def _delay(item: ast.Delay, done: list[Lowered], scope: LoweringScope) -> Lowered:
    scripts, time = _timed(item.seconds, scope)
    node = new_node("Delay", [done[0].node], item.span, delay_msec=time)
    return Lowered(run_before(scripts, node), done[0].can_skip and not scripts, done[0].endless)


def _wait(item: ast.Wait, _done: list[Lowered], scope: LoweringScope) -> Lowered:
    scripts, time = _timed(item.seconds, scope)
    return Lowered(run_before(scripts, new_node("Sleep", (), item.span, msec=time)))


def _held(item: ast.Held, done: list[Lowered], scope: LoweringScope) -> Lowered:
    scripts, time = _timed(item.seconds, scope)
    return Lowered(run_before(scripts, new_node("ReactiveSequence", (done[0].node, _timer(time)), item.span)))


def _wait_until(item: ast.WaitUntil, done: list[Lowered], _scope: LoweringScope) -> Lowered:
    return Lowered(new_node("RetryUntilSuccessful", [done[0].node], item.span, num_attempts="-1"))


def _wait_time(item: ast.WaitTime, _done: list[Lowered], _scope: LoweringScope) -> Lowered:
    """Wait for the first of several times, with a node for each beside one another."""
    times = item.time.split(";")
    if len(times) == 1:
        return Lowered(new_node("WaitForTime", (), item.span, time=item.time))
    clocks = list(map(_clock, times))
    return Lowered(new_node("Parallel", clocks, item.span, success_count="1", failure_count="1"))


TIMED: dict[type[ast.Ast], Callable[[Any, list[Lowered], LoweringScope], Lowered]] = {
    ast.Retry: _retry,
    ast.Within: _within,
    ast.For: _for,
    ast.UpTo: _up_to,
    ast.Every: _every,
    ast.Apart: _apart,
    ast.Delay: _delay,
    ast.Wait: _wait,
    ast.Held: _held,
    ast.WaitUntil: _wait_until,
    ast.WaitTime: _wait_time,
    ast.UntilTime: _until_time,
    ast.ByTime: _by_time,
}
