"""Lints on how far rules and conditions reach, and on stops: some take no time (BT256), others come late."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic, two_readings
from btlang.passes.compilation import Compilation
from btlang.passes.lint.two_readings import is_behind
from btlang.text.source import Span
from btlang.tree import ast
from btlang.vocabulary.capabilities import HEARS
from btlang.vocabulary.lexicon import Lexicon

_STOP = "Stop"


def _sequences(compilation: Compilation) -> Iterator[ast.Chain]:
    """Yield what is done one after the other."""
    nodes = (node for body in ast.bodies(compilation.mission) for node in compilation.syntax(body))
    yield from (node for node in nodes if isinstance(node, ast.Chain) and node.operator == "sequence")


def find_short_stops(compilation: Compilation) -> Iterator[Diagnostic]:
    """Report the rules beside other commands whose reaction ends with a stop, which takes no time."""
    for chain in _sequences(compilation):
        rules = [item for item in chain.items if isinstance(item, ast.Whenever)]
        if len(rules) < len(chain.items):
            stops = ((rule, _last(rule.body)) for rule in rules)
            yield from (_goes_on(rule, stop.span, compilation.vocabulary) for rule, stop in stops if _stops(stop))


def _last(reaction: ast.Ast) -> ast.Ast:
    while isinstance(reaction, ast.Chain) and reaction.operator == "sequence":
        reaction = reaction.items[-1]
    return reaction


def _stops(done: ast.Ast) -> bool:
    return isinstance(done, ast.Nothing) or (isinstance(done, ast.Phrase) and done.entry.id == _STOP)


def _goes_on(rule: ast.Whenever, stop: Span, vocabulary: Lexicon) -> Diagnostic:
    condition, asked = rule.condition.span, rule.condition
    is_heard = isinstance(asked, ast.Phrase) and HEARS in asked.entry.needs  # what was said isn't so for long
    ended = "" if is_heard else _denied(condition.text, vocabulary)
    whenever, joint, wait = (vocabulary.word(role) for role in ("whenever", "and", "wait_until"))
    fixed = f"{whenever} {condition.text}, {rule.body.span.text} {joint} {wait} {ended or '...'}"
    advice = f"To stand still {'as long as it is so' if ended else 'until something else is so'}, write: {fixed}"
    problem = diagnostic("BT256", rule.span, words=stop.text, condition=condition.text, advice=advice)
    return problem.replace(readings=((rule.span, fixed),)) if ended else problem


def _denied(condition: str, vocabulary: Lexicon) -> str:
    """Return a condition's words for when it is no longer true, "" where they can't be made of its own."""
    first, _, rest = condition.partition(" ")
    nobody = vocabulary.negative_subjects.get(first.lower(), ())
    if nobody:
        return f"{nobody[0]} {rest}"
    words = condition.split()
    at = next((at for at, word in enumerate(words) if word.lower() in vocabulary.negations), 0)
    return " ".join((*words[:at], vocabulary.negations[words[at].lower()][0], *words[at + 1 :])) if at else ""


def find_conditions_behind_rules(compilation: Compilation) -> Iterator[Diagnostic]:
    """Report `whenever C, A. If D, B` in one line: B may be done at the start, or each time that A was done."""
    for rule, form in (pair for chain in _sequences(compilation) for pair in pairwise(chain.items)):
        if isinstance(rule, ast.Whenever) and isinstance(form, ast.If) and _may_belong(rule, form):
            whole = Span(rule.span.source, rule.span.start, form.span.end)
            done, then = form.span.text, compilation.vocabulary.word("then")
            other = f"{rule.span.text}, {then} {done[:1].lower()}{done[1:]}"
            yield two_readings(whole, f"{rule.span.text}.\n{done}", other)


def _may_belong(rule: ast.Whenever, form: ast.If) -> bool:
    """Whether a condition stands right behind a rule, in a sentence of its own."""
    between = rule.span.source.text[rule.span.end : form.span.start]
    is_front = rule.condition.span.start < rule.body.span.start and form.condition.span.start < form.body.span.start
    return is_front and between.strip() == "." and "\n" not in between


def find_commands_behind_conditions(compilation: Compilation) -> Iterator[Diagnostic]:
    """Report `A if C and B` without a comma: B may be done in any case, or only if C."""
    joint = compilation.vocabulary.word("and")
    nodes = (node for body in ast.bodies(compilation.mission) for node in compilation.syntax(body))
    chains = (node for node in nodes if isinstance(node, ast.Chain))
    for form, behind in (pair for chain in chains for pair in pairwise(chain.items)):
        if not isinstance(form, ast.If) or not is_behind(form):
            continue
        source, asked, done = form.span.source, form.condition.span, behind.span.text
        if source.text[form.span.end : behind.span.start].strip() == joint:
            opener = source.text[form.body.span.end : asked.start].strip()
            whole = Span(source, form.span.start, behind.span.end)
            other = f"{opener} {asked.text}, {form.body.span.text} {joint} {done}"
            yield two_readings(whole, f"{form.span.text}, {joint} {done}", other)


def find_late_stops(compilation: Compilation) -> Iterator[Diagnostic]:
    """Report `A. Stop at noon`: once A is done the robot waits until noon, or A is to end then."""
    word = compilation.vocabulary.word
    for items in (chain.items for chain in _sequences(compilation)):
        for before, wait, stop in zip(items, items[1:], items[2:], strict=False):
            if isinstance(wait, ast.WaitTime) and _stops(stop) and stop.span.start < wait.span.start:
                done, time = before.span.text, wait.time
                whole = Span(before.span.source, before.span.start, max(stop.span.end, wait.span.end))
                late = f"{word('wait_until')} {time}, {word('then')} {stop.span.text.lower()}"
                yield two_readings(whole, f"{done}, {word('then')} {late}", f"{done} {word('until')} {time}")
