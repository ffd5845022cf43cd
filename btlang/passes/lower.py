"""Lowering: what each form of the language means in nodes of BehaviorTree.CPP."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.passes.lower_time import TIMED
from btlang.passes.scope import Lowered, LoweringScope, new_node, new_round
from btlang.passes.scripts import compile_assignment, compile_comparison, make_choice, prepare_ports, run_before, seek
from btlang.text.source import Span
from btlang.tree import ast
from btlang.tree.catalogue import CONSTRAINTS, SUBTREE, never_ends
from btlang.tree.node import Node, NodeModel, PortModel, Tree
from btlang.tree.visit import fold
from btlang.vocabulary.entry import FOUND, MEASURED
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.references import ALL, choice_of, names_key

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_CHAINS = {"sequence": "Sequence", "all": "Sequence", "fallback": "Fallback", "any": "Fallback", "parallel": "Parallel"}


def lower_names(compilation: Compilation) -> Iterator[Diagnostic]:
    """Make the tree of a mission: each definition, then its commands. BT005 if a command is missing but needed."""
    mission, ordered = compilation.mission, compilation.ordered
    names = (definition.name for definition in ordered)
    scope = LoweringScope(names, compilation.vocabulary.types, compilation.origins)
    for definition in ordered:
        lowered = lower(definition.body, scope)
        scope.bodies.append((definition.name, lowered.node))
        scope.define(definition, lowered.can_skip, lowered.endless)
    if mission.body is None and compilation.needs_command:
        last = mission.definitions[-1] if mission.definitions else None
        example = "move forward 1 m" if last is None else f'do subtree "{last.name}"' if last.is_quoted else last.name
        yield diagnostic("BT005", mission.span, example=example)
        return
    root = Node("AlwaysSuccess") if mission.body is None else lower(mission.body, scope).node
    said = [node for body in ast.bodies(mission) for node in compilation.syntax(body)]
    models = _models(
        [node for node in said if isinstance(node, ast.Exact)],
        [node for node in said if isinstance(node, ast.Phrase) and node.outputs],
        compilation.vocabulary,
    )
    compilation.tree = Tree(root, tuple(scope.bodies), mission.name, models, mission.span.source)


def _models(exact: Sequence[ast.Exact], phrases: Sequence[ast.Phrase], vocabulary: Lexicon) -> tuple[NodeModel, ...]:
    """Return what a mission says about leaves: what those by their ids are, and the ports that they give values to."""
    known = {node.id for node in exact if node.items} | vocabulary.nodes.keys()
    outputs: dict[str, dict[str, None]] = {}
    for node in exact:
        if node.is_condition or (node.id not in known and vocabulary.entry(node.id) is None):
            outputs.setdefault(node.id, {}).update(dict.fromkeys(node.outputs))
    conditions = {node.id for node in exact if node.is_condition}
    for phrase in phrases:
        outputs.setdefault(phrase.entry.id, {}).update(dict.fromkeys(phrase.outputs))
        conditions.update([phrase.entry.id] if phrase.entry.sort == "condition" else ())
    return tuple(
        NodeModel(
            "Condition" if node_id in conditions else "Action", node_id, tuple(PortModel(p, "output") for p in ports)
        )
        for node_id, ports in outputs.items()
    )


def lower(root: ast.Ast, scope: LoweringScope) -> Lowered:
    """Make the tree of a command or condition."""
    one = lower_one if scope.origins is None else _note
    return fold(root, ast.parts, lambda item, done: one(item, done, scope))


def lower_one(item: ast.Ast, done: list[Lowered], scope: LoweringScope) -> Lowered:
    """Make a node of one piece of syntax and its lowered parts."""
    return _LOWER[type(item)](item, done, scope)


def _note(item: ast.Ast, done: list[Lowered], scope: LoweringScope) -> Lowered:
    """Lower as `lower_one` does, and note what the node was made of."""
    assert scope.origins is not None
    lowered = lower_one(item, done, scope)
    node = lowered.node
    scope.origins[id(node)] = node, item
    for rule in ast.parts(item) if isinstance(item, ast.Chain) else ():
        if isinstance(rule, ast.Whenever):  # one inside the other, round the other commands
            scope.origins[id(node)] = node, rule
            node = node.children[2]
            scope.origins.setdefault(id(node), (node, item))
    return lowered


def _negated(negated: bool, condition: Node) -> Node:
    return Node("Inverter", (condition,), span=condition.span) if negated else condition


def _phrase(item: ast.Phrase, _done: list[Lowered], scope: LoweringScope) -> Lowered:
    """Make a leaf. A value that is the slot's default isn't written."""
    if not item.arguments:
        return Lowered(Node(item.entry.id, (), item.ports, item.name, item.span))
    defaults = {slot.name: slot.default for slot in item.entry.slots}
    spoken = [port for port in item.arguments if defaults.get(port[0]) != port[1]]
    if len(spoken) > 1:
        order = list(defaults)
        spoken.sort(key=lambda port: order.index(port[0]))
    scripts, ports = prepare_ports(spoken, scope)
    if FOUND in item.entry.outputs:
        scripts, ports = seek(scripts, ports)
    return Lowered(run_before(scripts, Node(item.entry.id, (), ports + item.ports, item.name, item.span)))


def _name(item: ast.Name, _done: list[Lowered], scope: LoweringScope) -> Lowered:
    """Make a subtree, which gets its arguments, and what it needs of the mission's values."""
    scripts, ports = prepare_ports(item.arguments, scope, scope.parameters.get(item.name, {}))
    shared = tuple((key, f"{{{key}}}") for key in scope.free.get(item.name, ()))
    node = Node(SUBTREE, (), (("ID", item.name), *ports, *shared), span=item.span)
    return Lowered(run_before(scripts, node), item.name in scope.skipping and not scripts, item.name in scope.endless)


def _compared(item: ast.Compared, _done: list[Lowered], scope: LoweringScope) -> Lowered:
    scripts, code = compile_comparison(item.key, item.arguments, item.kind, scope)
    return Lowered(run_before(scripts, Node("ScriptCondition", (), (("code", code),), span=item.span)))


def _assign(item: ast.Assign, _done: list[Lowered], scope: LoweringScope) -> Lowered:
    choice = choice_of(item.text)
    if choice is not None:
        return Lowered(make_choice(choice, item.key).replace(span=item.span))
    scripts, code = compile_assignment(item.key, item.operation, item.text, item.kind, scope)
    return Lowered(run_before(scripts, Node("Script", (), (("code", code),), span=item.span)))


def _remember(item: ast.Remember, _done: list[Lowered], scope: LoweringScope) -> Lowered:
    scripts, ports = prepare_ports(item.arguments, scope)
    node = Node(item.entry.id, (), (*ports, (MEASURED, f"{{{item.key}}}")), span=item.span)
    return Lowered(run_before(scripts, node))


def _for_each(item: ast.ForEach, done: list[Lowered], scope: LoweringScope) -> Lowered:
    """Make one instance of the body for each value; of a set the body in a loop over the names that the robot finds."""
    choice = choice_of(item.values[0])
    if choice is not None and choice.how == ALL:
        names, key = f"{{{names_key(item.key)}}}", f"{{{item.key}}}"
        ports = (("type", choice.type), ("output", names), *choice.parts)
        found = Node("ChooseAll", (), ports)
        loop = new_node("LoopString", [done[0].node], item.span, queue=names, value=key)
        return Lowered(Node("Sequence", (found, loop), span=item.span), False, done[0].endless)
    name = scope.new_name(item.key)
    scope.bodies.append((name, done[0].node))
    shared = tuple((key, f"{{{key}}}") for key in scope.needs(item.body, [item.key]))
    rounds = []
    for text in item.values:
        scripts, ports = prepare_ports([(item.key, text)], scope, {item.key: item.kind})
        rounds.append(run_before(scripts, Node(SUBTREE, (), (("ID", name), *ports, *shared), span=item.span)))
    node = rounds[0] if len(rounds) == 1 else new_node("Sequence", rounds, item.span)
    return Lowered(node, done[0].can_skip, done[0].endless)


def _chain(item: ast.Chain, done: list[Lowered], scope: LoweringScope) -> Lowered:
    if item.operator == "sequence" and any(isinstance(part, ast.Whenever) for part in item.items):
        return _rule(item, done, scope)
    if item.operator == "parallel":
        return _parallel(item, done)
    children, endless = [part.node for part in done], [part.endless for part in done]
    node = new_node(_CHAINS[item.operator], children, item.span)
    never_ends = any(endless) if item.operator == "sequence" else all(endless)
    return Lowered(node, all(part.can_skip for part in done), never_ends)


def _parallel(item: ast.Chain, done: list[Lowered]) -> Lowered:
    """Make a parallel. Parts that never end last as long as the others."""
    ending = sum(not part.endless for part in done)
    ports = {"success_count": str(ending), "failure_count": "1"} if 0 < ending < len(done) else {}
    return Lowered(new_node("Parallel", [new_round(part) for part in done], item.span, **ports), False, ending == 0)


def _at_least(item: ast.AtLeast, done: list[Lowered], _scope: LoweringScope) -> Lowered:
    ports = {"success_count": str(item.number), "failure_count": str(len(done) - item.number + 1)}
    return Lowered(new_node("Parallel", [part.node for part in done], item.span, **ports))


def _rule(item: ast.Chain, done: list[Lowered], scope: LoweringScope) -> Lowered:
    """Put standing rules round the other commands; the first one is the outermost, so that it wins."""
    rules = [part for part, own in zip(done, item.items, strict=True) if isinstance(own, ast.Whenever)]
    others = [part for part, own in zip(done, item.items, strict=True) if not isinstance(own, ast.Whenever)]
    if not others:
        work = Lowered(_for_ever(item.span), False, True)
    elif len(others) == 1:
        work = others[0]
    else:
        work = _chain(item.replace(items=()), others, scope)
    for rule in reversed(rules):
        condition, reaction, _ = rule.node.children
        work = work.replace(node=rule.node.replace(children=(condition, reaction, work.node)))
    return work


def _whenever(item: ast.Whenever, done: list[Lowered], _scope: LoweringScope) -> Lowered:
    """Make a rule. Alone it watches for ever."""
    ports = {"once": "true"} if item.once else {}
    children = done[0].node, done[1].node, _for_ever(item.span)
    return Lowered(new_node("Whenever", children, item.span, **ports), False, True)


def _for_ever(span: Span) -> Node:
    return new_node("KeepRunningUntilFailure", (new_node("AlwaysSuccess", (), span),), span)


def _not(item: ast.Not, done: list[Lowered], _scope: LoweringScope) -> Lowered:
    return Lowered(new_node("Inverter", [done[0].node], item.span))


def _if(item: ast.If, done: list[Lowered], _scope: LoweringScope) -> Lowered:
    condition = _negated(item.negated, done[0].node)
    if item.otherwise is None:
        skipped = new_node("AlwaysSuccess", (), item.span, _skipIf="true")
        return Lowered(new_node("IfThenElse", (condition, done[1].node, skipped), item.span), True)
    branches = done[1], done[2]
    children = (condition, *(branch.node for branch in branches))
    return Lowered(new_node("IfThenElse", children, item.span), any(branch.can_skip for branch in branches))


def _while(item: ast.While, done: list[Lowered], _scope: LoweringScope) -> Lowered:
    condition = _negated(item.negated, done[0].node)
    again = new_node("Repeat", [new_round(done[1])], item.span, num_cycles="-1")
    otherwise = done[2] if item.otherwise is not None else Lowered(new_node("AlwaysSuccess", (), item.span))
    return Lowered(new_node("WhileDoElse", (condition, again, otherwise.node), item.span), otherwise.can_skip)


def _if_works(item: ast.IfWorks, done: list[Lowered], _scope: LoweringScope) -> Lowered:
    skipped = new_node("AlwaysSuccess", (), item.span, _skipIf="true")
    branches = done[1], done[2] if item.otherwise is not None else Lowered(skipped, True)
    parts = done[0], *branches
    return Lowered(
        new_node("IfThenElse", [part.node for part in parts], item.span), any(part.can_skip for part in parts)
    )


def _stop_when(item: ast.StopWhen, done: list[Lowered], _scope: LoweringScope) -> Lowered:
    stopped = new_node("AlwaysSuccess", (), item.span)
    children = (_negated(True, done[0].node), done[1].node, stopped)
    return Lowered(new_node("WhileDoElse", children, item.span), done[1].can_skip)


def _provided(item: ast.Provided, done: list[Lowered], _scope: LoweringScope) -> Lowered:
    """Make a node with all guards of a command: `provided that A, provided that B: wave`."""
    guarded = done[1].node
    children = guarded.children if isinstance(item.body, ast.Provided) else (guarded,)
    return Lowered(new_node("ReactiveSequence", [done[0].node, *children], item.span), False, done[1].endless)


def _named(item: ast.Named, done: list[Lowered], _scope: LoweringScope) -> Lowered:
    made: Lowered = done[0].replace(node=done[0].node.replace(name=item.name))
    return made


def _repeat(item: ast.Repeat, done: list[Lowered], _scope: LoweringScope) -> Lowered:
    endless = item.rounds == "-1" or done[0].endless
    return Lowered(new_node("Repeat", [new_round(done[0])], item.span, num_cycles=item.rounds), False, endless)


def _try(item: ast.Try, done: list[Lowered], _scope: LoweringScope) -> Lowered:
    if item.otherwise is None:
        return Lowered(new_node("ForceSuccess", [done[0].node], item.span), done[0].can_skip)
    tried, otherwise = done[0].node, [done[1].node]
    if isinstance(item.otherwise, ast.Chain) and item.otherwise.operator == "fallback" and not item.otherwise.bracketed:
        otherwise = list(done[1].node.children)  # equal nodes without brackets are one
    return Lowered(new_node("Fallback", [tried, *otherwise], item.span), all(part.can_skip for part in done))


def _constrained(item: ast.Constrained, done: list[Lowered], scope: LoweringScope) -> Lowered:
    scripts, ports = prepare_ports([("zones", "; ".join(item.zones))], scope)
    node = Node(CONSTRAINTS[item.kind], (done[0].node,), ports, span=item.span)
    return Lowered(run_before(scripts, node), done[0].can_skip and not scripts, done[0].endless)


def _check(_item: ast.Check, done: list[Lowered], _scope: LoweringScope) -> Lowered:
    return done[0]


def _exact(item: ast.Exact, done: list[Lowered], scope: LoweringScope) -> Lowered:
    """Make the node as it is said. Nothing is added to it, not even if it can be skipped."""
    node = Node(item.id, tuple(part.node for part in done), item.ports, item.name, item.span)
    names_endless = node.id == SUBTREE and node.port("ID") in scope.endless
    return Lowered(node, False, names_endless or never_ends(node.id, node.ports, [part.endless for part in done]))


def _always(node_id: str) -> Callable[[ast.Ast, list[Lowered], LoweringScope], Lowered]:
    return lambda item, _done, _scope: Lowered(new_node(node_id, (), item.span))


_LOWER: dict[type[ast.Ast], Callable[[Any, list[Lowered], LoweringScope], Lowered]] = {
    ast.Phrase: _phrase,
    ast.Name: _name,
    ast.Compared: _compared,
    ast.Assign: _assign,
    ast.Remember: _remember,
    ast.ForEach: _for_each,
    ast.Chain: _chain,
    ast.AtLeast: _at_least,
    ast.Not: _not,
    ast.If: _if,
    ast.While: _while,
    ast.Whenever: _whenever,
    ast.Provided: _provided,
    ast.Named: _named,
    ast.IfWorks: _if_works,
    ast.StopWhen: _stop_when,
    ast.Repeat: _repeat,
    ast.Try: _try,
    **TIMED,
    ast.Constrained: _constrained,
    ast.Check: _check,
    ast.WaitForever: lambda item, _done, _scope: Lowered(_for_ever(item.span), False, True),
    ast.Nothing: _always("AlwaysSuccess"),
    ast.Fail: _always("AlwaysFailure"),
    ast.Exact: _exact,
}
