"""BT051: definitions that no command reaches."""

from __future__ import annotations

from collections.abc import Iterator

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.lint.subject import Subject
from btlang.passes.names import names_in


def unused_names(subject: Subject) -> Iterator[Diagnostic]:
    """Nothing of a text that only defines names, nor of the names of another file: those are for others to use."""
    mission = subject.mission
    if mission.body is None or not mission.definitions:
        return
    bodies = {definition.name: definition.body for definition in mission.definitions}
    reached: set[str] = set()
    waiting = names_in(mission.body)
    while waiting:
        name = waiting.pop()
        if name not in reached and name in bodies:
            reached.add(name)
            waiting += names_in(bodies[name])
    for definition in mission.definitions:
        if definition.name not in reached and definition.span.source is mission.span.source:
            yield diagnostic("BT051", definition.name_span, name=definition.name)
