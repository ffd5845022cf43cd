"""Documents: everything that an editor shows of a text, namely its messages, its tree and its outline."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from btlang.api import Mission
from btlang.diagnostics.diagnostic import Diagnostic
from btlang.diagnostics.formats import to_data
from btlang.editing.reading import TextReading
from btlang.editing.syntax import Syntax
from btlang.editing.values import abilities, values_of
from btlang.editing.words import RobotWords
from btlang.printer.mission import printer_of
from btlang.printer.phrase import is_written
from btlang.support.gc_pause import gc_paused
from btlang.text.source import Source, Span
from btlang.tree import ast
from btlang.tree.ast import Phrase, Program

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.passes.compilation import Origins

_kept: list[TextReading] = []
"""What was read for its messages last: only the next document may use it, as files that it names may change later."""
_LONGEST = 80  # characters of what has no name


def text_messages(source: Source, words: RobotWords) -> dict[str, Any]:
    """Return `ok`, `sort` and `messages` of a document. That of the same text is faster if it is the next one."""
    with gc_paused:
        _kept[:] = [TextReading(source, words)]
        return _summary(_kept[0])


def _summary(read: TextReading) -> dict[str, Any]:
    ok = read.mission is not None
    return {"ok": ok, "sort": read.sort, "messages": messages(read.problems, read.source)}


def document(source: Source, words: RobotWords) -> dict[str, Any]:
    """Return what is shown of a text, which may be anything. Offsets are characters.

    - `ok`: whether it compiles; `sort`: "english", "xml" or "json"; `messages`: see btlang.editing.document.

    Where it compiles also:

    - `nodes`: those of `Tree.walk` with the number of their parent, -1 for none; `tree` is the name of their subtree.
    One that can be changed (btlang.editing.edits) has the number of its `kind`;
    - `kinds`: of each the `sort`, "command" or "condition", the `edits` that may be done, and the `values`: name, type
    and words of each;
    - `outline`: see btlang.editing.document.
    """
    with gc_paused:
        kept = _kept.pop() if _kept else None
        read = kept if kept is not None and kept.is_of(source, words) else TextReading(source, words)
        mission = read.mission
        if mission is None:
            return _summary(read)
        nodes = _nodes(mission, read.source)
        kinds = [] if mission.syntax is None else _kinds(nodes, mission, mission.syntax, read.origins)
        return {**_summary(read), "nodes": nodes, "kinds": kinds, "outline": outline(mission, read.source)}


def _nodes(mission: Mission, source: Source) -> list[dict[str, Any]]:
    """Yield the nodes in the order of `Tree.walk`, with their parents on the way."""
    labels: dict[object, str] = {}
    found: list[dict[str, Any]] = []
    for name, root in (("", mission.tree.root), *mission.tree.subtrees):
        stack = [(root, -1)]
        while stack:
            node, parent = stack.pop()
            span, ports = node.span, node.ports
            said: object = node.id
            if ports or node.name:
                said = said, ports, node.name, span.text if span is not None and is_written(node) else ""
            if node.children and not node.name:  # its own words in the text, which few others share
                label = mission.words(node)
            else:
                label = labels.get(said) or labels.setdefault(said, mission.words(node))
            start, end = (span.start, span.end) if span is not None and span.source is source else (None, None)
            if node.children:
                number = len(found)
                stack += [(child, number) for child in reversed(node.children)]
            found.append(
                {
                    "parent": parent, "id": node.id, "label": label, "name": node.name, "ports": ports,
                    "start": start, "end": end, "tree": name,
                }
            )  # fmt: skip
    return found


def _kinds(nodes: list[dict[str, Any]], mission: Mission, program: Program, origins: Origins) -> list[dict[str, Any]]:
    """Give each node the number of its kind. Most are alike: so all that is sent of them stands there once."""
    syntax = Syntax(program, mission.vocabulary)
    vocabulary = printer_of(program, mission.vocabulary).vocabulary
    numbers: dict[object, int] = {}  # of phrases, and of what is the same of them and of forms
    kinds: list[dict[str, Any]] = []
    for node, said in zip(nodes, syntax.sources(mission.tree, origins), strict=True):
        if said is None:
            continue
        phrase = (said.entry.id, said.arguments, said is program.body) if type(said) is Phrase else None
        number = numbers.get(phrase)
        if number is None:
            is_condition = syntax.is_condition(said)
            edits, values = abilities(said, is_condition, said is program.body), values_of(said, vocabulary)
            number = numbers.setdefault((is_condition, *edits, *values), len(kinds))
            if number == len(kinds):
                kinds.append({"sort": "condition" if is_condition else "command", "edits": edits, "values": values})
            if phrase is not None:
                numbers[phrase] = number
        node["kind"] = number
    return kinds


def outline(mission: Mission, source: Source) -> list[dict[str, Any]]:
    """Return the parts in the order of the text. Offsets are characters.

    Each has its `name`; `start` and `end` of it, `of` the whole; its `kind`: "definition", "fact", "rule", "command" or
    "include". Of XML and JSON there are only the subtrees.
    """
    named = [
        {"name": name, "start": place.start, "end": place.end, "kind": kind, "of": (whole.start, whole.end)}
        for kind, name, place, whole in _parts(mission)
        if whole.source is source
    ]
    return sorted(named, key=lambda part: part["of"][0])


def _parts(mission: Mission) -> Iterator[tuple[str, str, Span, Span]]:
    """Return the kind, the name, where that is, and the whole."""
    program = mission.syntax
    if program is None:
        for name, root in mission.tree.subtrees:
            if root.span is not None:
                yield "definition", name, root.span, root.span
        return
    for definition in program.definitions:
        yield "definition", definition.name, definition.name_span, definition.span
    for fact in program.facts:
        yield "fact", fact.name, fact.span, fact.span
    for include in program.includes:
        yield "include", include.path, include.span, include.span
    for command in _statements(program.body):
        kind = "rule" if isinstance(command, ast.Whenever) else "command"
        yield kind, _first_line(command.span.text), command.span, command.span


def _statements(body: ast.Ast | None) -> tuple[ast.Ast, ...]:
    """Return the commands that follow one another."""
    if isinstance(body, ast.Chain) and body.operator == "sequence" and not body.bracketed:
        return body.items
    return () if body is None else (body,)


def _first_line(text: str) -> str:
    line = text.partition("\n")[0].rstrip()
    return line if len(line) <= _LONGEST else f"{line[: _LONGEST - 1]}…"


def messages(problems: Iterable[Diagnostic], source: Source) -> list[dict[str, Any]]:
    """Return the messages of `to_data`; each place has its `start` and `end`, None where it is in another text."""
    return [_message(problem, source) for problem in problems]


def offsets(span: Span | None, source: Source) -> dict[str, int | None]:
    """Return the characters of a place in a text."""
    if span is None or span.source is not source:
        return {"start": None, "end": None}
    return {"start": span.start, "end": span.end}


def _message(problem: Diagnostic, source: Source) -> dict[str, Any]:
    data = to_data(problem) | offsets(problem.span, source)
    if problem.fix is not None:
        data["fix"] |= offsets(problem.fix[0], source)
    for name, spans in (("readings", problem.readings), ("notes", problem.notes)):
        data[name] = [each | offsets(place, source) for each, (place, _) in zip(data[name], spans, strict=True)]
    return data
