"""The passes between reading and running: `PASSES` lists them in their order.

Names are ordered, forms are lowered, the tree is checked, and lints warn about what is probably not meant.
"""

from __future__ import annotations

from collections.abc import Iterable

from btlang.diagnostics.diagnostic import Diagnostic
from btlang.diagnostics.errors import MissionError, in_order
from btlang.passes.closed_goals import check_goals
from btlang.passes.compilation import Compilation, Pass
from btlang.passes.lint.allow import silence, silence_in_xml
from btlang.passes.lint.asked_once import asked_once
from btlang.passes.lint.busy import busy_loops
from btlang.passes.lint.conditional_alternative import conditional_alternative
from btlang.passes.lint.cut_off import cut_off
from btlang.passes.lint.half_turns import half_turns
from btlang.passes.lint.line_end import line_ends
from btlang.passes.lint.next_day import next_day
from btlang.passes.lint.no_rounds import no_rounds
from btlang.passes.lint.only_rules import only_rules
from btlang.passes.lint.starts_again import starts_again
from btlang.passes.lint.two_readings import two_readings
from btlang.passes.lint.unreachable import never_runs
from btlang.passes.lint.unused import unused_names
from btlang.passes.lower import lower_names
from btlang.passes.names import order_names
from btlang.passes.resources import check_resources
from btlang.passes.size import check_size
from btlang.passes.types import check_types
from btlang.tree.ast import Program
from btlang.tree.node import Tree
from btlang.vocabulary.lexicon import Lexicon

LOWERING = (Pass("names", order_names, needs_text=True), Pass("lowering", lower_names, needs_text=True))
CHECKS = (
    *LOWERING,
    Pass("types", check_types),
    Pass("size", check_size, goes_on=True),
    Pass("resources", check_resources, goes_on=True),
    Pass("goals", check_goals, goes_on=True),
)
PASSES = (
    *CHECKS,
    Pass("two readings", two_readings, needs_text=True),
    Pass("conditional alternative", conditional_alternative, needs_text=True),
    Pass("asked once", asked_once, needs_text=True),
    Pass("half turns", half_turns, needs_text=True),
    Pass("next day", next_day, needs_text=True),
    Pass("starts again", starts_again, needs_text=True),
    Pass("only rules", only_rules, needs_text=True),
    Pass("unused", unused_names, needs_text=True),
    Pass("never runs", never_runs),
    Pass("no rounds", no_rounds),
    Pass("busy loop", busy_loops),
    Pass("cut off", cut_off),
    Pass("line end", line_ends, needs_text=True),
    Pass("allow", silence, needs_text=True),
    Pass("allow in XML", silence_in_xml),
)


def run_passes(compilation: Compilation, passes: Iterable[Pass] = PASSES) -> Compilation:
    """The same compilation. Raises MissionError with everything that is wrong."""
    errors: list[Diagnostic] = []
    for one in passes:
        if errors and not one.goes_on:
            break
        if compilation.is_text or not one.needs_text:
            for problem in one.run(compilation):
                (errors if problem.is_error else compilation.warnings).append(problem)
    if errors:
        raise MissionError(errors)
    compilation.warnings = in_order(compilation.warnings)
    return compilation


def compile_mission(mission: Program, vocabulary: Lexicon, *, needs_command: bool = True) -> Tree:
    """The checked tree of a mission, without lints. Subtrees that are used come before their users.

    Raises MissionError (BT005, BT014, BT040 to BT042).
    """
    return run_passes(Compilation(vocabulary, mission, needs_command=needs_command), CHECKS).tree


def lower_mission(mission: Program, vocabulary: Lexicon) -> Tree:
    """As `compile_mission`, without the checks of the tree."""
    return run_passes(Compilation(vocabulary, mission), LOWERING).tree


def errors_of(mission: Program, vocabulary: Lexicon) -> Iterable[Diagnostic]:
    """What is wrong with a mission that could be read, for corrections of one that could not."""
    try:
        compile_mission(mission, vocabulary, needs_command=False)
    except MissionError as error:
        return error.diagnostics
    return ()
