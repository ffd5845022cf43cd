"""BT050: sentences that two people could read in two ways, where no comma, bracket or block decides.

- `then`, `and` and `or` mixed: `A then B and C`;
- a form behind a chain: `A then B 3 times`;
- an `otherwise` that two forms could have: `if C, if D, A otherwise B`;
- an `if` behind the command of another one: `if C, A, if D, B`;
- `not` before one of two conditions: `not C or D`;
- a list beside `and`: `go to the lobby and the lab and wave`;
- `after` behind two commands: `A then B after C`;
- a number before a pace: `A 3 times every 10 s`; a condition behind one: `every 10 s, A until C`;
- two sentences that could exclude one another: `if C, A. If D, B. Otherwise E`;
- a search for a time: `look for Alice for 5 min`;
- what follows a command that is tried: `try to A, then B`, or a journey behind one with an `if`: `if C, A, then B`;
- a rule about people behind a journey: `go to the door. Whenever somebody comes near, B`: on the way, or there;
- `A, or B if C`: B if A fails, or B instead of A. Brackets can't give the second reading.
"""

from __future__ import annotations

import re
from bisect import bisect
from collections.abc import Iterator, Sequence
from itertools import pairwise

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic, two_readings
from btlang.passes.compilation import Compilation
from btlang.passes.lint.asked_once import ON_THE_WAY
from btlang.passes.lint.asked_too_late import described_places
from btlang.passes.lint.other_form import find_in_form, find_in_pace, find_in_sentences, find_in_time
from btlang.passes.lint.other_readings import (
    Attachment,
    Gaps,
    Readings,
    add_brackets,
    balance_brackets,
    find_in_chain,
    sort_by_place,
)
from btlang.text.formatting import joined
from btlang.text.source import Source, Span
from btlang.tree import ast
from btlang.tree.rounds import meets_somebody
from btlang.tree.sums import COUNTING
from btlang.vocabulary.capabilities import MOVES
from btlang.vocabulary.value_type import PERSON, PLACE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeGuard

    from btlang.printer.printer import Printer
    from btlang.vocabulary.entry import Entry
    from btlang.vocabulary.lexicon import Lexicon


_SENTENCE_END = re.compile(r"[\n;]|[.!?](?=\s)")


def find_two_readings(compilation: Compilation) -> Iterator[Diagnostic]:
    """Report at most one place of each kind for each sentence: the first."""
    mission, reported = compilation.mission, set[tuple[str, int, str]]()
    warned = {warning.span for warning in compilation.warnings if warning.code == "BT050"}
    printer: Printer | None = None
    ends: dict[str, list[int]] = {}
    for root in (*mission.definitions, *([mission.body] if mission.body is not None else [])):
        source = root.span.source
        for found in _attachments(root, compilation):
            if source.name not in ends:
                ends[source.name] = _sentence_ends(source)
            key = source.name, bisect(ends[source.name], found.start), found.kind
            if key in reported:
                continue
            reported.add(key)
            printer = printer or make_printer(compilation)
            readings = found.readings()
            if readings.span not in warned and not printer.say(readings.taken).in_lines:
                yield make_warning(readings, printer)


def _attachments(root: ast.Ast, compilation: Compilation) -> Iterator[Attachment]:
    """Yield places with two readings, outer ones first, in the order of the text."""
    stack = [(root, False)]
    while stack:
        node, is_part = stack.pop()
        if isinstance(node, ast.Chain):
            items = sort_by_place(node.items)
            if (items is not node.items or any(item.parts for item in items)) and not ast.is_list(node):
                yield from find_in_chain(node, items, is_part, compilation.vocabulary)
                yield from find_in_sentences(node, compilation.vocabulary)
                stack += reversed(_parts(items, compilation))
            continue
        if isinstance(node, ast.If | ast.Try):
            yield from find_in_form(node, compilation.vocabulary)
        elif isinstance(node, ast.Every):
            yield from find_in_pace(node, compilation.vocabulary)
        elif isinstance(node, ast.For):
            yield from find_in_time(node, compilation.vocabulary)
        stack += [(part, False) for part in reversed(ast.parts(node)) if part.parts]


def _parts(items: Sequence[ast.Ast], compilation: Compilation) -> list[tuple[ast.Ast, bool]]:
    """Return the parts of a chain that have parts, and whether each has something beside it in its statement."""
    gaps = Gaps(items, compilation.vocabulary)
    return [
        (item, isinstance(item, ast.Chain) and not gaps.is_alone(at)) for at, item in enumerate(items) if item.parts
    ]


def _sentence_ends(source: Source) -> list[int]:
    return [match.start() for match in _SENTENCE_END.finditer(source.text)]


def make_printer(compilation: Compilation) -> Printer:
    """Make the printer that says the readings of a mission."""
    from btlang.printer.mission import printer_of  # most missions have nothing to report

    return printer_of(compilation.mission, compilation.vocabulary, "all")


def make_warning(found: Readings, printer: Printer) -> Diagnostic:
    """Make BT050 with both readings."""
    taken, other = printer.statement(found.taken), printer.statement(found.other)
    fix = None if found.fix is None or "\n" in found.fix[0].text else found.fix
    fixed = taken if fix is None or "\n" in found.span.text else _change_text(found.span, *fix)
    readings = () if "\n" in found.span.text else ((found.span, fixed), (found.span, other))
    problem = diagnostic("BT050", found.span, (), fix, taken=taken, other=other, fixed=fixed)
    return problem.replace(readings=readings)  # type: ignore[no-any-return]


def _change_text(span: Span, part: Span, words: str) -> str:
    text = span.source.text
    return " ".join((text[span.start : part.start] + words + text[part.end : span.end]).split())


def find_conditional_alternatives(compilation: Compilation) -> Iterator[Diagnostic]:
    """Search the alternatives of the mission and of its definitions."""
    vocabulary = compilation.vocabulary
    for body in ast.bodies(compilation.mission):
        for node in compilation.syntax(body):
            if isinstance(node, ast.If) and _is_alternative(node.body) and is_behind(node):
                yield make_warning(_listed_readings(node, node.body), make_printer(compilation))
            if not isinstance(node, ast.Chain) or node.operator != "fallback":
                continue
            last = node.items[-1]
            if not isinstance(last, ast.If) or last.otherwise is not None:
                continue
            gap = Gaps(node.items, vocabulary).text(len(node.items) - 2)
            if "," in gap and gap.strip(" ,").lower() in vocabulary.roles["or"]:
                yield make_warning(_alternative_readings(node, last), make_printer(compilation))


def _is_alternative(node: ast.Ast) -> TypeGuard[ast.Chain]:
    """Return whether a command is a list of alternatives without brackets, but no search of several places."""
    if not isinstance(node, ast.Chain) or node.operator != "fallback":
        return False
    if any(isinstance(item, ast.Phrase) and item.entry.first for item in node.items):
        return False
    return not node.span.source.text[: node.span.start + 1].rstrip().endswith("(")


def is_behind(node: ast.If) -> bool:
    """Return whether the condition is behind the command, without an `otherwise`."""
    return node.otherwise is None and node.body.span.end <= node.condition.span.start


def _listed_readings(node: ast.If, listed: ast.Chain) -> Readings:
    """Read `go to the lab, or the hall if C` as: if C, go to the hall, otherwise go to the lab."""
    other = _alternative_readings(listed, node.replace(body=listed.items[-1])).other
    return Readings(node, other, balance_brackets(node.span), None)


def _alternative_readings(chain: ast.Chain, last: ast.If) -> Readings:
    """Read `A, or B if C` as: if C, B, otherwise A."""
    items = chain.items[:-1]
    before = items[0] if len(items) == 1 else chain.replace(items=items, bracketed=True)
    body, otherwise = (before, last.body) if last.negated else (last.body, before)
    other = last.replace(negated=False, body=body, otherwise=otherwise)
    fix = add_brackets(last.span) if last.body.span.start == last.span.start else None
    return Readings(chain, other, balance_brackets(chain.span), fix)


def find_rules_at_goals(compilation: Compilation) -> Iterator[Diagnostic]:
    """Report `go to the door. Whenever somebody comes near, wave`: the rule ends at the door, or the robot stays.

    The same for `go to the door and wave whenever somebody comes near`.
    """
    body = compilation.mission.body
    for node in compilation.syntax(body) if body is not None else ():
        if isinstance(node, ast.Chain):
            yield from _rules_at_goal(sort_by_place(node.items), compilation.vocabulary)


def _rules_at_goal(items: Sequence[ast.Ast], vocabulary: Lexicon) -> Iterator[Diagnostic]:
    rule = next((item for item in reversed(items) if isinstance(item, ast.Whenever)), None)
    journey = next((item for item in reversed(items) if not isinstance(item, ast.Whenever | ast.If)), None)
    if rule is None or not isinstance(journey, ast.Phrase) or rule.span.start < journey.span.start:
        return
    asked = rule.condition
    if MOVES not in journey.entry.resources or not isinstance(asked, ast.Phrase):
        return
    is_about_goal = not _places_of(asked).isdisjoint(_places_of(journey))
    if not (is_about_goal or _is_about_people(asked.entry, vocabulary)):
        return
    doing, condition, said = rule.body.span, asked.span, rule.span.text
    is_behind = doing.start < condition.start
    whole = Span(journey.span.source, journey.span.start, condition.end if is_behind else rule.span.end)
    between = whole.source.text[journey.span.end : rule.span.start]
    if "\n" in whole.text or (_SENTENCE_END.search(between) is None and not is_behind):
        return
    if is_behind:
        said = f"{vocabulary.word('whenever')} {condition.text}, {doing.text}"
    taken = f"{said}. {journey.span.text}"
    other = f"{journey.span.text}, {vocabulary.word('then')} {vocabulary.word('wait_forever')}. {said}"
    yield two_readings(whole, taken, other)


def find_early_rules(compilation: Compilation) -> Iterator[Diagnostic]:
    """Report `at 10 pm, check the lab. Whenever somebody is there, wave`: the rule holds until 10 pm, too."""
    body, vocabulary = compilation.mission.body, compilation.vocabulary
    items = sort_by_place(body.items) if isinstance(body, ast.Chain) else ()
    for wait, rule in pairwise(item for item in items if isinstance(item, ast.WaitTime | ast.Whenever)):
        if not isinstance(wait, ast.WaitTime) or not isinstance(rule, ast.Whenever):
            continue
        asked, said = rule.condition, Span(wait.span.source, wait.span.start, rule.span.start).text.rstrip(" .;,")
        is_about_people = isinstance(asked, ast.Phrase) and _is_about_people(asked.entry, vocabulary)
        if not is_about_people or "\n" in said or rule.body.span.start < asked.span.start:
            continue
        whole, behind = Span(wait.span.source, wait.span.start, rule.span.end), rule.span.text
        taken = f"{behind}. {said}"
        other = f"{said}, {vocabulary.word('and')} {behind[:1].lower()}{behind[1:]}"
        yield two_readings(whole, taken, other)


def find_counts_behind_lists(compilation: Compilation) -> Iterator[Diagnostic]:
    """Report `go through the lab and the hall and count the people`: in each, or only in the last.

    So also `and remind the guest to drink`: whoever is in each, or in the last.
    """
    word, joints = compilation.vocabulary.word, compilation.vocabulary.roles["and"]
    for body in ast.bodies(compilation.mission):
        for node in compilation.syntax(body):
            for left, right in pairwise(ast.parts(node)) if isinstance(node, ast.Chain) else ():
                if not isinstance(right, ast.Phrase) or _places_of(right):
                    continue
                counts = right.entry.id in COUNTING
                if not counts and (not meets_somebody(right) or described_places(right)):
                    continue
                goals = [sorted(_places_of(each)) for each in ast.parts(left) if isinstance(each, ast.Phrase)]
                if not (ast.is_list(left) and all(goals)):
                    continue
                if left.span.source.text[left.span.end : right.span.start].strip(" ,").lower() not in joints:
                    continue
                whole = Span(left.span.source, left.span.start, right.span.end)
                taken = f"{left.span.text}, {word('then')} {right.span.text}"
                other = f"{right.span.text} in {joined([goal for goal, *_ in goals], word('and'))}"
                if not counts:
                    other = f"{left.span.text}, {word('and')} in each of them {right.span.text}"
                yield two_readings(whole, taken, other)


def _places_of(phrase: ast.Phrase) -> set[str]:
    """Return the names of places that a command or condition has."""
    return {*phrase.entry.given(PLACE, phrase.arguments)}


def find_lasting_reactions(compilation: Compilation) -> Iterator[Diagnostic]:
    """Report `whenever somebody is near, say hi until noon`: over and over then, or each time until noon."""
    for body in ast.bodies(compilation.mission):
        for node in compilation.syntax(body):
            timed = node.body if isinstance(node, ast.Whenever) else None
            if not isinstance(timed, ast.UntilTime) or not isinstance(timed.body, ast.Phrase):
                continue
            if not timed.body.entry.accompaniment or "\n" in node.span.text:
                continue
            until = node.span.source.text[timed.body.span.end : node.span.end].strip(" ,")
            word = compilation.vocabulary.word
            rule, done = node.span.text.removesuffix(until).rstrip(" ,"), timed.body.span.text
            front = rule.removesuffix(done)
            if front.rstrip().endswith(word("repeat")):
                continue
            taken = f"{front}{word('repeat')} {done} {until}"
            other = f"{word('wait')} {until}. {rule[:1].upper()}{rule[1:]}"
            yield two_readings(node.span, taken, other)


def _is_about_people(entry: Entry, vocabulary: Lexicon) -> bool:
    """Whether a condition asks about somebody, but not whether somebody is in the way."""
    words = {word for phrase in entry.phrases[:1] for word in phrase.split()}
    somebody = bool(entry.phrases) and not words.isdisjoint(vocabulary.negative_subjects)
    return (somebody or any(slot.type == PERSON for slot in entry.slots)) and entry.id not in ON_THE_WAY
