"""Lint BT068: conditions that are asked only once, when people expect the robot to keep an eye on them.

`When C, A` as a whole statement, and `stop when C`, which can stop nothing: the commands before it have ended. The same
where C is about a journey that is over: `bring the cup to Bob. If he isn't there, ...`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.passes.lint.asked_too_late import asked_by, described_places, leads_through, on_the_way
from btlang.text.source import Span
from btlang.tree import ast
from btlang.tree.answers import ABOUT_ANSWERS
from btlang.tree.round_parts import is_journey
from btlang.vocabulary.antecedents import says_there
from btlang.vocabulary.capabilities import MOVES, TRAVELS
from btlang.vocabulary.descriptions import NAME
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.references import ALL, choice_of
from btlang.vocabulary.value_type import DOOR, OBJECT, PERSON, PLACE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeGuard

_SENTENCE_END = re.compile(r"[.;!?\n]")
_QUOTED_OR_END = re.compile(r'"[^"\n]*"|([.;!?\n])')
_STOPS = ".!?"
"""What also ends a sentence where it stands before the quotes."""
_QUOTES = ('"', "\N{RIGHT DOUBLE QUOTATION MARK}")
_QUOTED_ENDS = ('."', '!"', '?"')
ON_THE_WAY = ("SomeoneInTheWay", "SomethingInTheWay")
_BUMPED = "Bumped"
_WHILE_DRIVING = (_BUMPED, "WallInFront", "ObstacleWithin")
_IN_VIEW = ("SeesSomeone", "SeesPerson", "SeesObject", "SomeoneNear", "PersonNear")
_CLOSED = "DoorClosed"
_DOOR_STATES = ("DoorOpen", _CLOSED)
_FREE, _BATTERY, _LOW = "PathClear", "Battery", "BatteryLow"


def find_asked_once(compilation: Compilation) -> Iterator[Diagnostic]:
    """Search the statements of the mission, of definitions and of blocks."""
    vocabulary = compilation.vocabulary
    for problem in _find(compilation, vocabulary):
        front = problem.span.text.split(maxsplit=1)[0]
        if front.lower() in vocabulary.asking["inverted_if"]:  # its words can't be said behind another word
            advice = f"To do it each time, begin with '{vocabulary.word('whenever')}' in place of '{front.lower()}'."
            yield diagnostic("BT068", problem.span, words=dict(problem.arguments)["words"], advice=advice)
        else:
            yield problem


def _find(compilation: Compilation, vocabulary: Lexicon) -> Iterator[Diagnostic]:
    for body in ast.bodies(compilation.mission):
        before: dict[int, tuple[Sequence[ast.Ast], int]] = {}
        kept: set[int] = set()  # what is done while the robot keeps in somewhere: `stay in the lab, and when C, A`
        for node in compilation.syntax(body):
            if type(node) is ast.Chain and node.operator == "sequence":
                before.update((id(item), (node.items, at)) for at, item in enumerate(node.items))
            if type(node) is ast.Constrained:
                kept.add(id(node.body))
            if type(node) is ast.If:
                yield from _too_early(node, vocabulary)
            items, at = before.get(id(node), ((), 0))
            if type(node) is ast.If and at > 0 and _asks_for_failure(node, items[at - 1]):
                yield _only_if_failed(node, items[at - 1], vocabulary)
            elif type(node) is ast.If and node.otherwise is not None:
                yield from _warn_of_otherwise(node, vocabulary, is_first=at == 0)
            elif type(node) is ast.If and not node.negated:
                sentence = _sentence_before(items, at)
                if sentence and _is_awaited(node, sentence[-1]):
                    continue
                joins_rule = at > 0 and isinstance(items[at - 1], ast.Whenever) and "\n" not in node.span.text
                if joins_rule or _is_statement(node, body, vocabulary):
                    is_first = not sentence and at + 1 < len(items)
                    warnings = list(_warn(node, sentence[-1] if sentence else None, vocabulary, is_first))
                    yield from warnings or _too_late(node, sentence, vocabulary)
                elif (sentence or id(node) in kept) and "\n" not in node.span.text:
                    before_it = (
                        sentence[-1] if sentence and type(node.body) is ast.Fail else None
                    )  # `A, and abort if C`
                    warnings = list(_warn(node, before_it, vocabulary))  # `A, and when C, B`
                    between = node.span.source.text[sentence[-1].span.end : node.span.start] if sentence else ""
                    yield from warnings or ([] if "\n" in between else _too_late(node, sentence, vocabulary))
                elif not sentence and node.body.span.start < node.condition.span.start:
                    yield from _warn(node, None, vocabulary)  # `wave when Bob comes and nod`, `..., but only if C`


def _sentence_before(items: Sequence[ast.Ast], at: int) -> Sequence[ast.Ast]:
    """Return the items before one, as far back as no sentence ends between them; standing rules are no such items."""
    while at > 0 and isinstance(items[at - 1], ast.Whenever):
        at -= 1
    first = max(at - 1, 0)
    while first > 0:
        before = items[first - 1].span
        if _SENTENCE_END.search(before.source.text, before.end, items[first].span.start):
            break
        first -= 1
    return items[first:at]


def _too_late(node: ast.If, before: Sequence[ast.Ast], vocabulary: Lexicon) -> Iterator[Diagnostic]:
    """Report a condition that decides about the journey before it, or watches what happens on it."""
    asked = asked_by(node)
    is_front = node.body.span.start > node.condition.span.start
    timed = before[-1] if before and is_front else None
    while isinstance(timed, ast.UntilTime | ast.For) and isinstance(timed.body, ast.Every):
        timed = timed.body
    words = node.span.source.text[node.span.start : node.condition.span.end]
    if isinstance(timed, ast.Every):  # `every 10 s until noon, A. If C, B`
        whole = Span(node.span.source, before[0].span.start, node.span.end)
        rounds, rest = Span(whole.source, whole.start, before[-1].span.end).text, node.span.text
        each = f"{rounds}, {vocabulary.word('then')} {rest[:1].lower()}{rest[1:]}"
        if timed.body.span.end < timed.span.end < before[-1].span.end:  # `A every 10 s until noon`, then B
            text, done = whole.source.text, timed.body.span.text
            ends, pace = text[timed.span.end : before[-1].span.end], text[timed.body.span.end : timed.span.end]
            front = f"{ends.strip(' ,')}, {pace.strip(' ,')}, {done[:1].lower()}{done[1:]}"
            each = f"{front}, {vocabulary.word('then')} {rest[:1].lower()}{rest[1:]}"
        advice = f"All rounds are over by then. To do it in each round, write: {each}"
        yield _with_reading(node, words, advice, whole, each)
        return
    is_block = timed is not None and "\n" in timed.span.text  # its indentation shows what is done in each round
    if isinstance(timed, ast.Repeat | ast.Apart) and timed.rounds != "-1" and _visits(timed.body) and not is_block:
        yield _after_rounds(node, timed, words, vocabulary)
        return
    if isinstance(timed, ast.WaitTime) and not _SENTENCE_END.search(
        node.span.source.text, timed.span.end, node.span.start
    ):
        return  # `at 6 pm, if C, A`
    is_timed = isinstance(timed, ast.UntilTime | ast.For | ast.WaitTime)
    phrases = [each for item in before for each in ast.parents_first(item) if isinstance(each, ast.Phrase)]
    entries = [each.entry for each in phrases]  # `turn left until bumped` has asked
    journeys = [] if is_timed else [each for each in phrases if _drives(each)]
    if not (is_timed or journeys):
        return
    last = before[-1].span.text
    is_driving = isinstance(asked, ast.Phrase) and (
        _is_about_driving(asked, node, journeys)
        or (is_front and asked.entry.id == _BUMPED and asked.entry not in entries)
    )
    is_tour = any(isinstance(item, ast.ForEach) for item in before) or _is_tour(journeys)
    is_seen = isinstance(asked, ast.Phrase) and asked.entry.id in _IN_VIEW and is_tour
    is_seen = is_seen and not _is_at_goal(asked, journeys[-1])
    if is_timed or is_driving or (is_seen and is_front):
        rest = node.span.text[len(words.split(maxsplit=1)[0]) :].lstrip()
        body = node.body.span.text
        rest = rest if is_front else f"{node.condition.span.text}, {body[:1].lower()}{body[1:]}"
        each = f"{vocabulary.word('whenever')} {rest}"
        place, each = _as_sentence(node, each, vocabulary)
        when = "meanwhile" if is_timed else "on the way"
        advice = f"'{last}' is over by then. To do it {when}, and all through the mission, write: {each}"
        yield _with_reading(node, words, advice, place, each)
    elif not is_timed and leads_through(node, phrases):
        yield on_the_way(node, before, vocabulary)
    elif (
        isinstance(asked, ast.Phrase)
        and isinstance(node.condition, ast.Not)
        and any(_find_things(journey) & _find_things(asked) for journey in journeys)
    ):
        advice = f"'{last}' comes first, and fails if it can't be done. What decides about it stands before it."
        yield diagnostic("BT068", node.span, words=words, advice=advice)


def _visits(body: ast.Ast) -> bool:
    """Whether rounds lead somewhere, where something may have changed each time."""
    return any(map(is_journey, ast.parents_first(body)))


def _after_rounds(node: ast.If, rounds: ast.Repeat | ast.Apart, words: str, vocabulary: Lexicon) -> Diagnostic:
    """Report `go to the lab three times, and if nobody is there, wave`: it is asked once, at the end."""
    text, done, rest = node.span.source.text, rounds.body.span, node.span.text
    often = text[done.end : rounds.span.end].strip(" ,")
    advice = "All rounds are over by then."
    if isinstance(rounds, ast.Apart) or not often or "\n" in text[rounds.span.start : node.span.end]:
        return diagnostic("BT068", node.span, words=words, advice=advice)
    each = f"{often}, {done.text}, {vocabulary.word('then')} {rest[:1].lower()}{rest[1:]}"
    whole = Span(node.span.source, rounds.span.start, node.span.end)
    return _with_reading(node, words, f"{advice} To do it in each round, write: {each}", whole, each)


def _warn_of_otherwise(node: ast.If, vocabulary: Lexicon, *, is_first: bool) -> Iterator[Diagnostic]:
    """Report `when the battery is low, A. Otherwise B`: it isn't asked again while B is done.

    The same for `if the battery drops below 20%, A. Otherwise B`, where nothing has been done before.
    """
    word, body, otherwise = node.span.text.split(maxsplit=1)[0], node.body.span, node.otherwise
    is_front = node.condition.span.end <= body.start and otherwise is not None and body.end <= otherwise.span.start
    is_watched = word.lower() in vocabulary.asked_once or (is_first and _is_event(node.condition, vocabulary))
    if otherwise is None or not is_front or not is_watched or _is_answered(node):
        return
    condition, rest = node.condition.span.text, otherwise.span.text
    each = f"{vocabulary.word('whenever')} {condition}, {body.text}. {rest[:1].upper()}{rest[1:]}"
    yield _with_reading(node, f"{word} {condition}", f"To do it each time, write: {each}", node.span, each)


def _as_sentence(node: ast.If, rule: str, vocabulary: Lexicon) -> tuple[Span, str]:
    """Return the place and the words of what is said before in its sentence and a rule, which begins a sentence."""
    source, place = node.span.source, node.span
    ends = [found.end() for found in _SENTENCE_END.finditer(source.text, 0, place.start)]
    first = max(ends, default=0)
    first += source.text[first : first + 1] in _QUOTES  # behind `say "Tea?"`
    done = source.text[first : place.start].rstrip(" ,").split()
    while done and done[-1].lower().strip(",") in vocabulary.joining:
        done.pop()
    if not done:
        return place, rule
    place = Span(source, place.start - len(source.text[first : place.start].lstrip()), place.end)
    return place, f"{' '.join(done).rstrip(',')}. {rule[:1].upper()}{rule[1:]}"


def _is_awaited(node: ast.If, before: ast.Ast) -> bool:
    """Return whether what stands before waits for the condition, by the same words: `wait 5 min. As soon as C, A`."""
    return any(each.span == node.condition.span for each in ast.parents_first(before))


def _is_tour(journeys: Sequence[ast.Phrase]) -> bool:
    """Return whether a journey leads to several places, at the last of which it is too late to look."""
    goals = [text for each in journeys for text in each.entry.given(PLACE, each.arguments)]
    choices = [choice_of(goal) for goal in goals]
    is_set = any(choice is not None and choice.how == ALL for choice in choices)
    return is_set or (len(goals) > 1 and len({each.entry.id for each in journeys}) == 1)


def _asks_for_failure(node: ast.If, before: ast.Ast) -> bool:
    """Return whether a condition is so only if a command has failed: `open the door. If it is closed, wave`."""
    asked, tried = node.condition, before.body if isinstance(before, ast.Retry) else before
    if not isinstance(asked, ast.Phrase) or not isinstance(tried, ast.Phrase) or not tried.entry.achieves:
        return False
    doors = {*asked.entry.given(DOOR, asked.arguments)}
    is_same = doors != set() and doors == {*tried.entry.given(DOOR, tried.arguments)}
    return is_same and asked.entry.id in _DOOR_STATES and asked.entry.id not in tried.entry.achieves


def _only_if_failed(node: ast.If, before: ast.Ast, vocabulary: Lexicon) -> Diagnostic:
    words = node.span.source.text[node.span.start : node.condition.span.end]
    tried, failing = before.span.text, vocabulary.word("if_fails")
    ends = f"write: {tried}. {failing.capitalize()}, {node.body.span.text}"
    advice = f"'{tried}' comes first, and fails if it can't be done. For what is done then, {ends}"
    return diagnostic("BT068", node.span, words=words, advice=advice)


def _is_at_goal(asked: ast.Ast, journey: ast.Phrase) -> bool:
    """Return whether a condition is about somebody or something where a journey ends: `anyone in the hall`."""
    goals = [*journey.entry.given(PLACE, journey.arguments)]
    return isinstance(asked, ast.Phrase) and not {*goals[-1:]}.isdisjoint(described_places(asked))


def _is_about_driving(asked: ast.Phrase, node: ast.If, journeys: Sequence[ast.Phrase]) -> bool:
    """Return whether a condition is about what happens on journeys, and not at their end."""
    is_watched = asked.entry.id in _WHILE_DRIVING or (asked is not node.condition and asked.entry.id == _FREE)
    is_watched = is_watched or (_is_low(asked) and any(map(_drives, ast.parents_first(node.body))))
    is_driving = is_watched and any(TRAVELS in each.entry.needs for each in journeys)
    return is_driving or asked.entry.id in ON_THE_WAY


def _drives(node: ast.Ast) -> TypeGuard[ast.Phrase]:
    """Whether a node is a command that moves the robot about."""
    return isinstance(node, ast.Phrase) and MOVES in node.entry.resources


def _is_low(condition: ast.Phrase) -> bool:
    """Whether a condition says that the battery is low."""
    return condition.entry.id == _LOW or (condition.entry.id == _BATTERY and "below" in dict(condition.arguments))


def _too_early(node: ast.If, vocabulary: Lexicon) -> Iterator[Diagnostic]:
    """Report `go to the lab if Alice is there`: a condition behind a journey that is about its end, or what it
    chooses.
    """
    asked = asked_by(node)
    if not isinstance(asked, ast.Phrase) or asked.span.start < node.body.span.start:
        return
    phrases = [each for each in ast.parents_first(node.body) if isinstance(each, ast.Phrase)]
    chosen = {text for each in phrases for text in _find_things(each) if text[:1] == "{"}
    is_there = says_there(asked.span.text, vocabulary.values.pronouns)
    if (is_there and any(MOVES in each.entry.resources for each in phrases)) or chosen & _find_things(asked):
        body, condition = node.body.span.text, asked.span.text
        advice = (
            f"It is asked before '{body}', where the robot is then. Name what and where, as in: Alice is in the lab"
        )
        yield diagnostic("BT068", asked.span, words=condition, advice=advice)


def _is_event(condition: ast.Ast, vocabulary: Lexicon) -> bool:
    """Whether a condition says that something happens: `somebody comes`. An answer has been given by then."""
    is_phrase = isinstance(condition, ast.Phrase) and condition.entry.id not in ABOUT_ANSWERS
    return is_phrase and vocabulary.says_event(condition.span.text)


def _find_things(phrase: ast.Phrase) -> set[str]:
    """Return the names that a phrase is about, and the values that they are chosen into."""
    types = {slot.name: slot.type for slot in phrase.entry.slots}
    found: set[str] = set()
    for name, text in phrase.arguments:
        choice = choice_of(text)
        if choice is not None:
            found |= {f"{{{choice.key}}}", dict(choice.parts).get(NAME, "")}
        elif types.get(name) in (PERSON, OBJECT):
            found.add(text)
    return found - {""}


def _is_statement(node: ast.If, body: ast.Ast, vocabulary: Lexicon) -> bool:
    """Whether nothing stands beside it in its statement, and no block below it; behind `stop when C` more may stand.

    Words that say nothing may stand behind it, too: `before you carry on`.
    """
    text, span = node.span.source.text, node.span
    before, behind = text[: span.start].rstrip(" \t"), text[span.end :].lstrip(" \t")
    starts = not before or before[-1] in "\n;.!?" or before[-2:] in _QUOTED_ENDS
    halts = node.body.span.start < node.condition.span.start and node.body.span.text.lower() in vocabulary.halting
    ends = not behind or behind[0] in "\r\n;.!?#" or span.text[-2:] in _QUOTED_ENDS
    if not starts or "\n" in span.text:
        return False
    return halts or ends or not _has_more(span, body)


def _rest_of_sentence(span: Span, vocabulary: Lexicon) -> Span | None:
    """Return the rest of a sentence behind a place, if that begins with `and`: `stop if bumped, and say "ouch"`."""
    text = span.source.text
    parts = (found for found in _QUOTED_OR_END.finditer(text, span.end) if found[1] or found[0][-2] in _STOPS)
    end = next((found.end() - bool(found[1]) for found in parts), len(text))
    behind = Span(span.source, span.end, end)
    start = span.end + len(behind.text) - len(behind.text.lstrip(" \t,"))
    rest = Span(span.source, start, behind.end)
    return rest if rest.text.lower().split(maxsplit=1)[:1] in ([each] for each in vocabulary.roles["and"]) else None


def _has_more(span: Span, body: ast.Ast) -> bool:
    """Whether something of a body begins behind a place in the same sentence."""
    text = span.source.text
    end = _SENTENCE_END.search(text, span.end)
    sentence = range(span.end, end.start() if end else len(text))
    return any(each.span.start in sentence for each in ast.parents_first(body))


def _warn(node: ast.If, before: ast.Ast | None, vocabulary: Lexicon, is_first: bool = False) -> Iterator[Diagnostic]:
    """Report a condition that is asked once, behind a command or, if it `is_first`, before all others."""
    source, condition = node.span.source, node.condition.span
    if node.body.span.start < condition.start:
        further = _rest_of_sentence(node.span, vocabulary)
        if further is not None and node.body.span.text.lower() in vocabulary.halting:
            each = f"{vocabulary.word('whenever')} {condition.text}, {node.body.span.text.lower()} {further.text}"
            advice = f"What stands behind it is done in any case. To do it then, write: {each}"
            yield _with_reading(node, node.span.text, advice, Span(source, node.span.start, further.end), each)
        elif before is not None and node.body.span.text.lower() in vocabulary.halting and "\n" not in before.span.text:
            fixed = f"{before.span.text} {vocabulary.word('stop_when')} {condition.text}"
            advice = f"To stop what comes before, write: {fixed}"
            yield _with_reading(node, node.span.text, advice, Span(source, before.span.start, node.span.end), fixed)
        elif before is not None and (type(node.body) is ast.Fail or _is_event(node.condition, vocabulary)):
            each = f"{vocabulary.word('whenever')} {condition.text}, {node.body.span.text}"
            advice = f"'{before.span.text}' is over by then. To do it meanwhile, write: {each}"
            yield _with_reading(node, node.span.text, advice, node.span, each)
        elif is_first and node.body.span.text.lower() in vocabulary.halting:  # `stop when C. A`
            each = f"{vocabulary.word('whenever')} {condition.text}, {node.body.span.text.lower()}"
            advice = f"To do it whenever it is true, write: {each}"
            yield _with_reading(node, node.span.text, advice, node.span, each)
        elif node.body.span.text.lower() not in vocabulary.halting and not _is_answered(node):
            word = next(iter(source.text[node.body.span.end : condition.start].lower().split()), "")
            if word in vocabulary.asked_once or _is_event(node.condition, vocabulary):  # `wave when Bob is near`
                asked_words = source.text[node.body.span.end : condition.end].lstrip()
                form = f"{node.body.span.text} {{}} {asked_words[len(word) :].lstrip()}"
                yield _asked_once(node, asked_words, form, vocabulary)
        return
    if _is_answered(node):
        return
    word = next(iter(source.text[node.span.start : condition.start].split(maxsplit=1)), "")  # none before a question
    asked = node.condition
    is_watched = before is None and isinstance(asked, ast.Phrase) and asked.entry.id in ON_THE_WAY
    if word.lower() in vocabulary.asked_once or is_watched or _is_event(asked, vocabulary):
        rest = source.text[node.span.start + len(word) : node.span.end].lstrip()
        words = source.text[node.span.start : condition.end] if word else condition.text
        yield _asked_once(node, words, f"{{}} {rest}", vocabulary)


def _with_reading(node: ast.If, words: str, advice: str, place: Span, fixed: str) -> Diagnostic:
    """Make BT068 with words of a condition, and what to write at a place instead."""
    problem = diagnostic("BT068", node.span, words=words, advice=advice)
    return problem.replace(readings=((place, fixed),))  # type: ignore[no-any-return]


def _asked_once(node: ast.If, words: str, other: str, vocabulary: Lexicon, before: ast.Ast | None = None) -> Diagnostic:
    """Make BT068 with the words that ask, and the same with others in front that wait for it, or watch for it."""
    once, each = (other.replace("{}", vocabulary.word(role)) for role in ("as_soon_as", "whenever"))
    place, each = _as_sentence(node, each, vocabulary)
    advice, help = f"To wait until it is true, write: {once}", f"To do it each time, write: {each}"
    problem = diagnostic("BT068", node.span, words=words, advice=advice, help=help)
    return problem.replace(readings=((node.span, once), (place, each)))  # type: ignore[no-any-return]


def _is_answered(node: ast.If) -> bool:
    """Whether a condition is about an answer: `when she has answered`. The question is over by then."""
    asked = asked_by(node)
    return isinstance(asked, ast.Phrase) and asked.entry.id in ABOUT_ANSWERS
