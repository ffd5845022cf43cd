"""Lints on answers that decide about nothing, that nobody can judge, or that come too early (BT147, BT152).

- `ask Bob "Tea?". If he says no, ask again` does nothing with the second answer;
- `if the answer is right`, which the robot doesn't know;
- `if she says yes, wave. Ask Alice "Tea?"`, where nobody has been asked.
"""

from __future__ import annotations

from collections.abc import Iterator

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.tree import ast
from btlang.tree.answers import ABOUT_ANSWERS, ANSWERED, ASK, KEEP_ASKING, asks
from btlang.vocabulary.capabilities import HEARS

_LOOPS = (ast.Repeat, ast.Retry, ast.Every, ast.While)
_THE_ANSWER = 'if the answer is "blue", wave'


def find_unused_answers(compilation: Compilation) -> Iterator[Diagnostic]:
    """Report a question that is asked again behind an answer to it, where nothing depends on the second answer."""
    for body in ast.bodies(compilation.mission):
        nodes = compilation.syntax(body)
        phrases = [each for each in nodes if isinstance(each, ast.Phrase)]
        asked = [each for each in phrases if each.entry.id == ASK]
        if len(asked) < 2:
            continue  # as nearly always
        repeated = {id(each) for node in nodes if isinstance(node, _LOOPS) for each in ast.parents_first(node)}
        used = max((each.span.start for each in phrases if each.entry.id in ABOUT_ANSWERS), default=-1)
        last = {id(each) for each in asked if each.span.start > used}
        if not last:
            continue
        for node in nodes:
            if not isinstance(node, ast.If) or not asks(node.condition) or id(node) in repeated:
                continue
            for again in (each for each in ast.parents_first(node) if id(each) in last):
                before = (each.arguments for each in asked if each.span.start < again.span.start)
                if isinstance(again, ast.Phrase) and again.arguments in before:
                    yield diagnostic("BT147", again.span, words=again.span.text, example=KEEP_ASKING)


def find_judged_answers(compilation: Compilation) -> Iterator[Diagnostic]:
    """Report (BT152) `if the answer is right` behind a question that doesn't offer that word."""
    vocabulary = compilation.vocabulary
    judged = vocabulary.asking["judged"]
    nodes = [each for body in ast.bodies(compilation.mission) for each in compilation.syntax(body)]
    phrases = [each for each in nodes if isinstance(each, ast.Phrase)]
    offered = " ".join(text.lower() for each in phrases if each.entry.id == ASK for _, text in each.arguments)
    for each in phrases:
        said = each.arguments[0][1].lower() if each.entry.id == ANSWERED and '"' not in each.span.text else ""
        words = each.span.text.lower().split()
        if said in judged and said not in offered and not vocabulary.forms_of_be.keys().isdisjoint(words):
            reason, advice = f"the robot doesn't know which answer is {said}", f"Say the answer: {_THE_ANSWER}"
            yield diagnostic("BT152", each.span, words=each.span.text, reason=reason, advice=advice)


def find_early_answers(compilation: Compilation) -> Iterator[Diagnostic]:
    """Report (BT152) an answer that decides about something before the mission asks anybody."""
    body = compilation.mission.body
    bodies = [compilation.syntax(each) for each in ast.bodies(compilation.mission)]
    if body is None or not any(isinstance(each, ast.Phrase) and _may_ask(each) for nodes in bodies for each in nodes):
        return  # the answer may be one from before the mission
    for each in compilation.syntax(body):
        if isinstance(each, ast.If) and asks(each.condition):
            words = each.condition.span
            advice = "Ask before it. A definition of several sentences stands on indented lines behind 'is:'."
            reason = "nobody has been asked before it"
            yield diagnostic("BT152", words, words=words.text, reason=reason, advice=advice)
        elif isinstance(each, (ast.Name, ast.Exact, ast.Whenever, *_LOOPS)) or (
            isinstance(each, ast.Phrase) and _may_ask(each)
        ):
            return  # a round may ask before it comes to the answer again


def _may_ask(phrase: ast.Phrase) -> bool:
    return phrase.entry.sort == "action" and (phrase.entry.id == ASK or HEARS in phrase.entry.needs)
