"""Lints on definitions: unused names and values (BT051), names of rules alone (BT173), commands behind them (BT055).

A definition, parameter or value may be unused. A name whose body is only rules watches for ever, and commands beside it
don't run meanwhile. A command behind a definition on one line, as in `dance is: wave; nod`, isn't part of it.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Iterator

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.passes.lint.other_readings import sort_by_place
from btlang.passes.scope import find_names
from btlang.text.source import Span
from btlang.tree import ast
from btlang.tree.ast import Assign, Ast, Definition, Exact, ForEach, Remember, all_definitions, bodies, keys_of, parts
from btlang.tree.catalogue import SUBTREE
from btlang.tree.comments import KEPT
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.value_type import DOOR, OBJECT, PERSON, PLACE

_NAMED = (PLACE, PERSON, OBJECT, DOOR)


def find_unused(compilation: Compilation) -> Iterator[Diagnostic]:
    """Report unused names, but not of a text that only defines names or grows, nor those of another file.

    Nor of the trees of an XML file in English, which other files may use; BT236 is about them.
    """
    mission = compilation.mission
    if mission.body is None or compilation.grows:
        return
    yield from _values(compilation)
    if not mission.definitions or f"\n{KEPT} " in mission.span.source.text:
        return
    own = {definition.name: definition.body for definition in mission.definitions}
    reached: set[str] = set()
    waiting = find_names(compilation.syntax(mission.body))
    while waiting:
        name = waiting.pop()
        if name not in reached and name in own:
            reached.add(name)
            waiting += find_names(compilation.syntax(own[name]))
    for definition in mission.definitions:
        if definition.name not in reached and definition.span.source is mission.span.source:
            yield diagnostic("BT051", definition.name_span, name=definition.name)


def _values(compilation: Compilation) -> Iterator[Diagnostic]:
    """Yield values that are given and never asked for, and parameters that their body doesn't use."""
    mission = compilation.mission
    given: dict[str, Span] = {}
    for body in bodies(mission):
        for node in compilation.syntax(body):
            if isinstance(node, (Assign, Remember)):
                given.setdefault(node.key, node.span)
            elif isinstance(node, ForEach) and node.kind in _NAMED:
                yield from _idle_loop(node, compilation.vocabulary)
    definitions = all_definitions(mission)
    if not given and not any(definition.parameters for definition in definitions):
        return
    asked: set[str] = set() if mission.body is None else _find_asked_keys(compilation.syntax(mission.body))
    for definition in definitions:
        own = _find_asked_keys(compilation.syntax(definition.body))
        asked |= own
        for key, _ in definition.parameters:
            if key not in own and definition.span.source is mission.span.source:
                yield diagnostic("BT051", definition.name_span, name=f"{{{key}}}")
    for key, span in given.items():
        if key not in asked and span.source is mission.span.source:
            yield diagnostic("BT051", span, name=key.replace("_", " ").strip())


def _idle_loop(loop: ForEach, vocabulary: Lexicon) -> Iterator[Diagnostic]:
    """Yield `for each room: wave`, which never goes to a room."""
    if loop.key in _find_asked_keys(ast.parents_first(loop.body)):
        return
    name, said, source = loop.key.replace("_", " "), loop.body.span, loop.span.source
    head = Span(source, loop.span.start, said.start)
    advice = ""
    if loop.kind in (PLACE, PERSON) and head.text.strip() and "\n" not in loop.span.text:
        journey = " ".join((*vocabulary.asking["journey"], name))
        advice = f"To go to each first, write: {head.text.strip()} {journey} {vocabulary.word('then')} {said.text}"
    yield diagnostic("BT051", loop.span, name=name, help=advice)


def _find_asked_keys(nodes: Iterable[Ast]) -> set[str]:
    """Return the keys of values that nodes ask for, as do subtrees called by their ids: values set inside leave
    them.
    """
    asked: set[str] = set()
    for node in nodes:
        own = node.key if isinstance(node, (Assign, Remember)) else ""
        asked.update(key for key in keys_of(node) if key != own)
        if isinstance(node, Exact) and node.id == SUBTREE:
            asked.update(port for port, _ in node.ports)
    return asked


def find_rules_only(compilation: Compilation) -> Iterator[Diagnostic]:
    """Report names of rules alone in sequences: beside the parts of a Parallel such a name ends with them."""
    names = {each.name for each in ast.all_definitions(compilation.mission) if _is_only_rules(each.body)}
    if not names:
        return
    for body in ast.bodies(compilation.mission):
        for node in compilation.syntax(body):
            if type(node) is ast.Chain and node.operator == "sequence":
                items = sort_by_place(node.items)
                for at, item in enumerate(items):
                    if type(item) is ast.Name and item.name in names:
                        beside = items[at + 1] if at + 1 < len(items) else items[at - 1]
                        yield _warn(item, beside, compilation.vocabulary)


def _is_only_rules(body: ast.Ast) -> bool:
    items = body.items if type(body) is ast.Chain and body.operator == "sequence" else (body,)
    return all(type(item) is ast.Whenever for item in items)


def _warn(rules: ast.Name, beside: ast.Ast, vocabulary: Lexicon) -> Diagnostic:
    words, other = rules.span.text, beside.span.text
    is_block = "\n" in other
    fixed = f"{'...' if is_block else other}, {vocabulary.word('meanwhile')} {words}"
    problem = diagnostic("BT173", rules.span, words=words, fixed=fixed)
    if is_block:
        return problem
    start, end = min(rules.span.start, beside.span.start), max(rules.span.end, beside.span.end)
    return problem.replace(readings=((Span(rules.span.source, start, end), fixed),))  # type: ignore[no-any-return]


def find_line_ends(compilation: Compilation) -> Iterator[Diagnostic]:
    """Report commands behind a definition only if a colon promises that more than one belongs to the name."""
    mission = compilation.mission
    if mission.body is None:
        return
    source = mission.span.source
    short = [one for one in mission.definitions if one.span.source is source and _has_colon(one)]
    if not short:
        return
    starts = _starts(mission.body)
    order = sorted(starts)
    for definition in short:
        span = definition.span
        at = bisect_left(order, span.end)
        if at < len(order) and "\n" not in source.text[span.end : order[at]]:
            head = source.text[span.start : definition.body.span.start].partition(":")[0] + ":"
            word = compilation.vocabulary.word("then")
            place = starts[order[at]].span
            yield diagnostic("BT055", place, ((span, "the definition"),), name=definition.name, head=head, then=word)


def _has_colon(definition: Definition) -> bool:
    """Whether a `:` is between the name and a body on the same line."""
    head = definition.span.source.text[definition.name_span.end : definition.body.span.start]
    return ":" in head and "\n" not in head


def _starts(body: Ast) -> dict[int, Ast]:
    """Return the commands of a mission by their first character."""
    items = parts(body) if body.parts == ("items",) else [body]
    return {item.span.start: item for item in items}
