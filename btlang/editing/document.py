"""All that an editor shows of a text: its messages, its tree and its outline."""

from __future__ import annotations

from btlang.api import Mission
from btlang.diagnostics.diagnostic import Diagnostic, MissionError
from btlang.editing.messages import messages
from btlang.editing.outline import outline
from btlang.editing.syntax import Syntax
from btlang.editing.values import abilities, values_of
from btlang.editing.words import Words
from btlang.frontends.table import frontend_of
from btlang.printer.mission import printer_of
from btlang.printer.phrase import is_written
from btlang.support.gc_pause import gc_paused
from btlang.text.source import Source
from btlang.tree.ast import Phrase, Program

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Any

    from btlang.passes.compilation import Origins


class _Read:
    """A text that was read: its mission, None for one that doesn't compile, and what is wrong with it."""

    def __init__(self, source: Source, words: Words) -> None:
        self.key, self.source, self.sort = _cache_key(source, words), source, frontend_of(source)
        self.origins: Origins = {}
        self.mission: Mission | None = None
        self.problems: Sequence[Diagnostic] = ()
        try:
            self.mission = words.mission(source, self.origins)
        except MissionError as error:
            self.problems = error.diagnostics
        else:
            self.problems = (*self.mission.warnings, *_misnamed(self.mission))

    def summary(self) -> dict[str, Any]:
        ok = self.mission is not None
        return {"ok": ok, "sort": self.sort, "messages": messages(self.problems, self.source)}


_kept: list[_Read] = []
"""What was read for its messages last: only the next document may use it, as files that it names may change later."""


def text_messages(source: Source, words: Words) -> dict[str, Any]:
    """Return `ok`, `sort` and `messages` of a document. That of the same text is faster if it is the next one."""
    with gc_paused:
        _kept[:] = [_Read(source, words)]
        return _kept[0].summary()


def document(source: Source, words: Words) -> dict[str, Any]:
    """Return what is shown of a text, which may be anything. Offsets are characters.

    - `ok`: whether it compiles; `sort`: "english", "xml" or "json"; `messages`: see btlang.editing.messages.

    Where it compiles also:

    - `nodes`: those of `Tree.walk` with the number of their parent, -1 for none; `tree` is the name of their subtree.
    One that can be changed (btlang.editing.edits) has the number of its `kind`;
    - `kinds`: of each the `sort`, "command" or "condition", the `edits` that may be done, and the `values`: name, type
    and words of each;
    - `outline`: see btlang.editing.outline.
    """
    with gc_paused:
        kept = _kept.pop() if _kept else None
        read = kept if kept is not None and kept.key == _cache_key(source, words) else _Read(source, words)
        mission = read.mission
        if mission is None:
            return read.summary()
        nodes = _nodes(mission, read.source)
        kinds = [] if mission.syntax is None else _kinds(nodes, mission, mission.syntax, read.origins)
        return {**read.summary(), "nodes": nodes, "kinds": kinds, "outline": outline(mission, read.source)}


def _cache_key(source: Source, words: Words) -> tuple[object, ...]:
    """Return what decides how a text is read, but for the files that it names."""
    world = words.world.text if isinstance(words.world, Source) else words.world
    return source.text, source.name, tuple(words.keywords), world, words.language


def _misnamed(mission: Mission) -> tuple[Diagnostic, ...]:
    """Return what would keep a tree from running that names its nodes by their ids."""
    try:
        mission.check()
    except MissionError as error:
        return tuple(error.diagnostics)
    return ()


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
