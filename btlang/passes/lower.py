"""AST to tree: what each form of the language means in nodes of BehaviorTree.CPP."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.passes.scope import Scope
from btlang.passes.scripts import assignment, behind, comparison, prepared, script
from btlang.record import Record
from btlang.text.source import Span
from btlang.tree import ast
from btlang.tree.catalogue import SUBTREE
from btlang.tree.model import NodeModel
from btlang.tree.node import Node, Tree
from btlang.tree.visit import fold
from btlang.vocabulary.entry import MEASURED
from btlang.vocabulary.references import keys_in

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_CHAINS = {"sequence": "Sequence", "all": "Sequence", "fallback": "Fallback", "any": "Fallback", "parallel": "Parallel"}


class Lowered(Record):
    """A node, and whether it can end SKIPPED."""

    node: Node
    can_skip: bool = False


def lower_names(compilation: Compilation) -> Iterator[Diagnostic]:
    """The tree of a mission: each definition, then its commands. BT005 where there is no command but must be one."""
    mission, ordered = compilation.mission, compilation.ordered
    scope = Scope((definition.name for definition in ordered), compilation.vocabulary.types)
    for definition in ordered:
        lowered = lower(definition.body, scope)
        scope.bodies.append((definition.name, lowered.node))
        scope.define(definition, lowered.can_skip)
    if mission.body is None and compilation.needs_command:
        last = mission.definitions[-1] if mission.definitions else None
        example = "move forward 1 m" if last is None else f'do subtree "{last.name}"' if last.is_quoted else last.name
        yield diagnostic("BT005", mission.span, example=example)
        return
    root = Node("AlwaysSuccess") if mission.body is None else lower(mission.body, scope).node
    exact = (node for body in ast.bodies(mission) for node in compilation.syntax(body) if isinstance(node, ast.Exact))
    conditions = dict.fromkeys(node.id for node in exact if node.is_condition)
    models = tuple(NodeModel("Condition", id) for id in conditions)
    compilation.tree = Tree(root, tuple(scope.bodies), mission.name, models)


def lower(root: ast.Ast, scope: Scope) -> Lowered:
    """The tree of a command or condition."""
    return fold(root, ast.parts, lambda item, done: _LOWER[type(item)](item, done, scope))


def lower_one(item: ast.Ast, done: list[Lowered], scope: Scope) -> Lowered:
    """What one piece of syntax makes of its lowered parts."""
    return _LOWER[type(item)](item, done, scope)


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


def _phrase(item: ast.Phrase, _done: list[Lowered], scope: Scope) -> Lowered:
    """A value that is the slot's default says nothing."""
    if not item.arguments:
        return Lowered(Node(item.entry.id, (), (), "", item.span))
    defaults = {slot.name: slot.default for slot in item.entry.slots}
    spoken = [port for port in item.arguments if defaults.get(port[0]) != port[1]]
    if len(spoken) > 1:
        order = list(defaults)
        spoken.sort(key=lambda port: order.index(port[0]))
    scripts, ports = prepared(spoken, scope)
    return Lowered(behind(scripts, Node(item.entry.id, (), ports, span=item.span)))


def _name(item: ast.Name, _done: list[Lowered], scope: Scope) -> Lowered:
    """A subtree sees its arguments, and what it needs of the mission's values."""
    scripts, ports = prepared(item.arguments, scope, scope.parameters.get(item.name, {}))
    shared = tuple((key, f"{{{key}}}") for key in scope.free.get(item.name, ()))
    node = Node(SUBTREE, (), (("ID", item.name), *ports, *shared), span=item.span)
    return Lowered(behind(scripts, node), item.name in scope.skipping and not scripts)


def _compared(item: ast.Compared, _done: list[Lowered], scope: Scope) -> Lowered:
    scripts, code = comparison(item.key, item.arguments, item.kind, scope)
    return Lowered(behind(scripts, Node("ScriptCondition", (), (("code", code),), span=item.span)))


def _assign(item: ast.Assign, _done: list[Lowered], scope: Scope) -> Lowered:
    scripts, code = assignment(item.key, item.operation, item.text, item.kind, scope)
    return Lowered(behind(scripts, Node("Script", (), (("code", code),), span=item.span)))


def _remember(item: ast.Remember, _done: list[Lowered], scope: Scope) -> Lowered:
    scripts, ports = prepared(item.arguments, scope)
    node = Node(item.entry.id, (), (*ports, (MEASURED, f"{{{item.key}}}")), span=item.span)
    return Lowered(behind(scripts, node))


def _for_each(item: ast.ForEach, done: list[Lowered], scope: Scope) -> Lowered:
    """One instance of the body for each value."""
    name = scope.new_name(item.key)
    scope.bodies.append((name, done[0].node))
    shared = tuple((key, f"{{{key}}}") for key in scope.needs(item.body, [item.key]))
    rounds = []
    for text in item.values:
        scripts, ports = prepared([(item.key, text)], scope, {item.key: item.kind})
        rounds.append(behind(scripts, Node(SUBTREE, (), (("ID", name), *ports, *shared), span=item.span)))
    node = rounds[0] if len(rounds) == 1 else _node("Sequence", rounds, item.span)
    return Lowered(node, done[0].can_skip)


def _chain(item: ast.Chain, done: list[Lowered], scope: Scope) -> Lowered:
    if item.operator == "sequence" and any(isinstance(part, ast.Whenever) for part in item.items):
        return _ruled(item, done, scope)
    if item.operator == "parallel":
        return Lowered(_node("Parallel", [_round(part) for part in done], item.span))
    children = [part.node for part in done]
    return Lowered(_node(_CHAINS[item.operator], children, item.span), all(part.can_skip for part in done))


def _ruled(item: ast.Chain, done: list[Lowered], _scope: Scope) -> Lowered:
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


def _whenever(item: ast.Whenever, done: list[Lowered], _scope: Scope) -> Lowered:
    """A rule alone has nothing to interrupt."""
    nothing = _node("AlwaysSuccess", (), item.span)
    return Lowered(_node("Whenever", (done[0].node, done[1].node, nothing), item.span))


def _not(item: ast.Not, done: list[Lowered], _scope: Scope) -> Lowered:
    return Lowered(_node("Inverter", [done[0].node], item.span))


def _if(item: ast.If, done: list[Lowered], _scope: Scope) -> Lowered:
    condition = _negated(item.negated, done[0].node)
    if item.otherwise is None:
        skipped = _node("AlwaysSuccess", (), item.span, _skipIf="true")
        return Lowered(_node("IfThenElse", (condition, done[1].node, skipped), item.span), True)
    branches = done[1], done[2]
    children = (condition, *(branch.node for branch in branches))
    return Lowered(_node("IfThenElse", children, item.span), any(branch.can_skip for branch in branches))


def _while(item: ast.While, done: list[Lowered], _scope: Scope) -> Lowered:
    condition = _negated(item.negated, done[0].node)
    again = _node("Repeat", [_round(done[1])], item.span, num_cycles="-1")
    otherwise = done[2] if item.otherwise is not None else Lowered(_node("AlwaysSuccess", (), item.span))
    return Lowered(_node("WhileDoElse", (condition, again, otherwise.node), item.span), otherwise.can_skip)


def _provided(item: ast.Provided, done: list[Lowered], _scope: Scope) -> Lowered:
    return Lowered(_node("ReactiveSequence", [part.node for part in done], item.span))


def _repeat(item: ast.Repeat, done: list[Lowered], _scope: Scope) -> Lowered:
    return Lowered(_node("Repeat", [_round(done[0])], item.span, num_cycles=item.rounds))


def _retry(item: ast.Retry, done: list[Lowered], _scope: Scope) -> Lowered:
    return Lowered(_node("RetryUntilSuccessful", [_round(done[0])], item.span, num_attempts=item.attempts))


def _try(item: ast.Try, done: list[Lowered], _scope: Scope) -> Lowered:
    if item.otherwise is None:
        return Lowered(_node("ForceSuccess", [done[0].node], item.span), done[0].can_skip)
    tried, otherwise = done[0].node, [done[1].node]
    if isinstance(item.otherwise, ast.Chain) and item.otherwise.operator == "fallback" and not item.otherwise.bracketed:
        otherwise = list(done[1].node.children)  # equal nodes without brackets are one
    return Lowered(_node("Fallback", [tried, *otherwise], item.span), all(part.can_skip for part in done))


def _timed(seconds: str, scope: Scope) -> tuple[list[Node], str]:
    """A time as whole milliseconds of a port; one that is only known when it runs is computed before."""
    [key] = list(keys_in(seconds)) or [""]
    if not key:
        return [], str(round(float(seconds) * 1000))
    made = scope.new_key()
    return [script(f"{made} := {key} * 1000")], f"{{{made}}}"


def _timer(milliseconds: str) -> Node:
    """The Sleep inside `for` and `every`: no sentence of its own, so that no log tells of it as a command."""
    return Node("Sleep", (), (("msec", milliseconds),))


def _within(item: ast.Within, done: list[Lowered], scope: Scope) -> Lowered:
    scripts, limit = _timed(item.seconds, scope)
    return Lowered(behind(scripts, _node("Timeout", [_round(done[0])], item.span, msec=limit)))


def _for(item: ast.For, done: list[Lowered], scope: Scope) -> Lowered:
    scripts, time = _timed(item.seconds, scope)
    again = _node("Repeat", [_round(done[0])], item.span, num_cycles="-1")
    together = _node("Parallel", (_timer(time), again), item.span, success_count="1", failure_count="1")
    return Lowered(behind(scripts, together))


def _every(item: ast.Every, done: list[Lowered], scope: Scope) -> Lowered:
    scripts, time = _timed(item.seconds, scope)
    together = _node("Parallel", (_round(done[0]), _timer(time)), item.span)
    return Lowered(behind(scripts, _node("Repeat", [together], item.span, num_cycles="-1")))


def _delay(item: ast.Delay, done: list[Lowered], scope: Scope) -> Lowered:
    scripts, time = _timed(item.seconds, scope)
    node = _node("Delay", [done[0].node], item.span, delay_msec=time)
    return Lowered(behind(scripts, node), done[0].can_skip and not scripts)


def _wait(item: ast.Wait, _done: list[Lowered], scope: Scope) -> Lowered:
    scripts, time = _timed(item.seconds, scope)
    return Lowered(behind(scripts, _node("Sleep", (), item.span, msec=time)))


def _wait_until(item: ast.WaitUntil, done: list[Lowered], _scope: Scope) -> Lowered:
    return Lowered(_node("RetryUntilSuccessful", [done[0].node], item.span, num_attempts="-1"))


def _check(_item: ast.Check, done: list[Lowered], _scope: Scope) -> Lowered:
    return done[0]


def _exact(item: ast.Exact, done: list[Lowered], _scope: Scope) -> Lowered:
    """Nothing is added to it, not even where it can be skipped."""
    return Lowered(Node(item.id, tuple(part.node for part in done), item.ports, item.name, item.span))


def _nothing(item: ast.Nothing, _done: list[Lowered], _scope: Scope) -> Lowered:
    return Lowered(_node("AlwaysSuccess", (), item.span))


def _fail(item: ast.Fail, _done: list[Lowered], _scope: Scope) -> Lowered:
    return Lowered(_node("AlwaysFailure", (), item.span))


_LOWER: dict[type[ast.Ast], Callable[[Any, list[Lowered], Scope], Lowered]] = {
    ast.Phrase: _phrase,
    ast.Name: _name,
    ast.Compared: _compared,
    ast.Assign: _assign,
    ast.Remember: _remember,
    ast.ForEach: _for_each,
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
    ast.Exact: _exact,
}
