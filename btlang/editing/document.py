"""All that an editor shows of a text: its messages, its tree and its outline."""

from __future__ import annotations

from btlang.api import Mission
from btlang.diagnostics.diagnostic import Diagnostic
from btlang.diagnostics.errors import MissionError
from btlang.editing.messages import messages
from btlang.editing.outline import outline
from btlang.editing.syntax import Syntax
from btlang.editing.values import abilities, values_of
from btlang.editing.words import Words
from btlang.frontends.table import frontend_of
from btlang.gc_pause import gc_paused
from btlang.printer.mission import printer_of
from btlang.printer.phrase import is_written
from btlang.text.source import Source
from btlang.tree.ast import Phrase, Program

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.passes.compilation import Origins


def document(source: Source, words: Words) -> dict[str, Any]:
    """What is shown of a text, which may be anything. Offsets are characters.

    - `ok`: whether it compiles; `sort`: "english", "xml" or "json"; `messages`: see btlang.editing.messages.

    Where it compiles also:

    - `nodes`: those of `Tree.walk` with the number of their parent, -1 for none; `tree` is the name of their subtree.
      One that can be changed (btlang.editing.edits) has the number of its `kind`;
    - `kinds`: of each the `sort`, "command" or "condition", the `edits` that may be done, and the `values`: name, type
      and words of each;
    - `outline`: see btlang.editing.outline.
    """
    sort = frontend_of(source)
    with gc_paused:
        origins: Origins = {}
        try:
            mission = words.mission(source, origins)
        except MissionError as error:
            return {"ok": False, "sort": sort, "messages": messages(error.diagnostics, source)}
        problems = [*mission.warnings, *_misnamed(mission)]
        nodes = _nodes(mission, source)
        kinds = [] if mission.syntax is None else _kinds(nodes, mission, mission.syntax, origins)
        return {
            "ok": True, "sort": sort, "messages": messages(problems, source), "nodes": nodes, "kinds": kinds,
            "outline": outline(mission, source),
        }  # fmt: skip


def _misnamed(mission: Mission) -> tuple[Diagnostic, ...]:
    """What would keep a tree from running that names its nodes by their ids."""
    try:
        mission.check()
    except MissionError as error:
        return tuple(error.diagnostics)
    return ()


def _nodes(mission: Mission, source: Source) -> list[dict[str, Any]]:
    """In the order of `Tree.walk`, with their parents on the way."""
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
            if said not in labels:
                labels[said] = mission.label(node)
            start, end = (span.start, span.end) if span is not None and span.source is source else (None, None)
            if node.children:
                number = len(found)
                stack += [(child, number) for child in reversed(node.children)]
            found.append(
                {
                    "parent": parent, "id": node.id, "label": labels[said], "name": node.name, "ports": ports,
                    "start": start, "end": end, "tree": name,
                }
            )  # fmt: skip
    return found


def _kinds(nodes: list[dict[str, Any]], mission: Mission, program: Program, origins: Origins) -> list[dict[str, Any]]:
    """Gives each node the number of its kind. Most are alike: so all that is sent of them stands there once."""
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
