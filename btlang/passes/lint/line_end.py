"""BT055: commands behind a definition on one line, such as the second one of `dance is: wave; nod`."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.tree.ast import Ast, Definition, parts


def line_ends(compilation: Compilation) -> Iterator[Diagnostic]:
    """Only where a colon promises that more than one command belongs to the name."""
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
    """Whether a `:` stands between the name and a body on the same line."""
    head = definition.span.source.text[definition.name_span.end : definition.body.span.start]
    return ":" in head and "\n" not in head


def _starts(body: Ast) -> dict[int, Ast]:
    """The commands of a mission by their first character."""
    items = parts(body) if body.parts == ("items",) else [body]
    return {item.span.start: item for item in items}
