"""The passes between reading and running; `PASSES` lists them in their order.

Names are ordered, forms are lowered, the tree is checked, and lints warn about what is probably not meant.
"""

from __future__ import annotations

from collections.abc import Iterable

from btlang.diagnostics.diagnostic import Diagnostic, MissionError, sort_diagnostics
from btlang.passes.checks import check_goals, check_resources, check_size, check_types
from btlang.passes.compilation import Compilation, Pass
from btlang.passes.lint.allow import apply_allow, apply_allow_in_xml
from btlang.passes.lint.answers import find_early_answers, find_judged_answers, find_unused_answers
from btlang.passes.lint.asked_once import find_asked_once
from btlang.passes.lint.asked_too_late import find_asked_too_late
from btlang.passes.lint.chosen_in_a_branch import find_chosen_in_a_branch
from btlang.passes.lint.definitions import find_line_ends, find_rules_only, find_unused
from btlang.passes.lint.known_people import find_known_only
from btlang.passes.lint.reactions import (
    find_commands_behind_conditions,
    find_conditions_behind_rules,
    find_late_stops,
    find_short_stops,
)
from btlang.passes.lint.tree_lints import (
    find_busy_loops,
    find_cut_off,
    find_empty_loops,
    find_undeclared,
    find_unreachable,
)
from btlang.passes.lint.two_readings import (
    find_conditional_alternatives,
    find_counts_behind_lists,
    find_early_rules,
    find_lasting_reactions,
    find_rules_at_goals,
    find_two_readings,
)
from btlang.passes.lint.unanswered import find_unanswered
from btlang.passes.lint.unchosen import find_unchosen
from btlang.passes.lint.unlikely_meanings import (
    find_distant_questions,
    find_ended_rounds,
    find_half_turns,
    find_next_day,
    find_picked_up_only,
    find_restarts,
    find_uncounted,
    find_vain_waits,
)
from btlang.passes.lower import lower_names
from btlang.passes.scope import order_names
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
    Pass("two readings", find_two_readings, needs_text=True),
    Pass("conditional alternative", find_conditional_alternatives, needs_text=True),
    Pass("rules at goals", find_rules_at_goals, needs_text=True),
    Pass("early rules", find_early_rules, needs_text=True),
    Pass("counts behind lists", find_counts_behind_lists, needs_text=True),
    Pass("lasting reactions", find_lasting_reactions, needs_text=True),
    Pass("goes on at once", find_short_stops, needs_text=True),
    Pass("conditions behind rules", find_conditions_behind_rules, needs_text=True),
    Pass("commands behind conditions", find_commands_behind_conditions, needs_text=True),
    Pass("late stops", find_late_stops, needs_text=True),
    Pass("asked once", find_asked_once, needs_text=True),
    Pass("asked too late", find_asked_too_late, needs_text=True),
    Pass("half turns", find_half_turns, needs_text=True),
    Pass("next day", find_next_day, needs_text=True),
    Pass("starts again", find_restarts, needs_text=True),
    Pass("rounds end", find_ended_rounds, needs_text=True),
    Pass("asks from afar", find_distant_questions, needs_text=True),
    Pass("picked up only", find_picked_up_only, needs_text=True),
    Pass("nothing counted", find_uncounted, needs_text=True),
    Pass("nothing changes", find_vain_waits, needs_text=True),
    Pass("unused answers", find_unused_answers, needs_text=True),
    Pass("early answers", find_early_answers, needs_text=True),
    Pass("judged answers", find_judged_answers, needs_text=True),
    Pass("nobody answers", find_unanswered, needs_text=True),
    Pass("only rules", find_rules_only, needs_text=True),
    Pass("unused", find_unused, needs_text=True),
    Pass("never runs", find_unreachable),
    Pass("no rounds", find_empty_loops),
    Pass("busy loop", find_busy_loops),
    Pass("known only", find_known_only, needs_text=True),
    Pass("chosen in a branch", find_chosen_in_a_branch),
    Pass("unchosen", find_unchosen, needs_text=True),
    Pass("cut off", find_cut_off),
    Pass("undeclared nodes", find_undeclared, needs_text=True),
    Pass("line end", find_line_ends, needs_text=True),
    Pass("allow", apply_allow, needs_text=True),
    Pass("allow in XML", apply_allow_in_xml),
)


def run_passes(compilation: Compilation, passes: Iterable[Pass] = PASSES) -> Compilation:
    """Run passes on a compilation and return it. Raises MissionError with everything that is wrong."""
    errors: list[Diagnostic] = []
    for one in passes:
        if errors and not one.goes_on:
            break
        if compilation.is_text or not one.needs_text:
            for problem in one.run(compilation):
                (errors if problem.is_error else compilation.warnings).append(problem)
    if errors:
        raise MissionError(errors)
    compilation.warnings = sort_diagnostics(compilation.warnings)
    return compilation


def compile_mission(mission: Program, vocabulary: Lexicon, *, needs_command: bool = True) -> Tree:
    """Compile a mission to a checked tree, without lints. Subtrees that are used come before their users.

    Raises MissionError (BT005, BT014, BT040 to BT042).
    """
    return run_passes(Compilation(vocabulary, mission, needs_command=needs_command), CHECKS).tree


def lower_mission(mission: Program, vocabulary: Lexicon) -> Tree:
    """Compile a mission as `compile_mission` does, without the checks of the tree."""
    return run_passes(Compilation(vocabulary, mission), LOWERING).tree


def errors_of(mission: Program, vocabulary: Lexicon) -> Iterable[Diagnostic]:
    """Return what is wrong with a mission that could be read, for corrections of one that couldn't."""
    try:
        compile_mission(mission, vocabulary, needs_command=False)
    except MissionError as error:
        return error.diagnostics
    return ()
