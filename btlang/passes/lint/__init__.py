"""Lints: warnings about missions that compile. Each module finds one of them; `LINTS` lists them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, in_order
from btlang.passes.lint.allow import heard
from btlang.passes.lint.busy import busy_loops
from btlang.passes.lint.cut_off import cut_off
from btlang.passes.lint.line_end import line_ends
from btlang.passes.lint.subject import Subject
from btlang.passes.lint.two_readings import two_readings
from btlang.passes.lint.unreachable import never_runs
from btlang.passes.lint.unused import unused_names
from btlang.tree.ast import Mission
from btlang.tree.node import Tree
from btlang.vocabulary.vocabulary import Vocabulary

LINTS: tuple[Callable[[Subject], Iterable[Diagnostic]], ...] = (
    two_readings,
    unused_names,
    never_runs,
    busy_loops,
    cut_off,
    line_ends,
)


def lint(
    mission: Mission,
    tree: Tree,
    vocabulary: Vocabulary,
    warnings: Sequence[Diagnostic] = (),
    *,
    grows: bool = False,
) -> tuple[Diagnostic, ...]:
    """All warnings about a mission that compiled, also those of reading it, without the ones that it silences.

    `tree` is what `mission` was compiled to. Nothing is said of unused names where the mission `grows`.
    """
    subject = Subject(mission, tree, vocabulary)
    lints = [find for find in LINTS if not (grows and find is unused_names)]
    found = [*warnings, *(warning for find in lints for warning in find(subject))]
    return tuple(in_order(heard(found, mission.span.source, vocabulary)))
