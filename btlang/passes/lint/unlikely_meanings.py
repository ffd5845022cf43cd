"""Lints on commands that mean something else than most people expect (BT050, BT139, BT146, BT148, BT149, BT163, BT169,
BT170, BT175).

- `turn around three times` are half turns, as most people mean whole turns;
- `turn around and drive back 1 m`: backwards, or the way back that the robot faces then;
- `A until 5 pm. At 5 pm, B`, and `... At 4 pm, B`, wait for the next day;
- `go to the lab until someone is near` starts again, though the command comes to an end by itself;
- `every 10 min, go to the lab` ends when a round fails;
- `if there are more than 3 people, A` where nothing is counted;
- `wait until he says yes` where nothing asks again;
- `fetch the cup` only picks it up;
- `ask Bob "Tea?"` asks from where the robot is.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.passes.lint.known_people import LIES, drives_robot, with_journey_first
from btlang.passes.lint.other_readings import Readings
from btlang.passes.lint.two_readings import make_printer, make_warning
from btlang.text.formatting import joined
from btlang.text.source import Span
from btlang.text.time_of_day import seconds_of
from btlang.tree import ast
from btlang.tree.answers import ASK, KEEP_ASKING, asking_verbs, asks
from btlang.tree.round_parts import PICK_UP
from btlang.tree.rounds import DAYTIME
from btlang.tree.sums import COMPARED, COUNTING, asks_for_number
from btlang.vocabulary.capabilities import MOVES
from btlang.vocabulary.descriptions import NAME
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.references import choice_of
from btlang.vocabulary.value_type import OBJECT, PERSON

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_COUNTED_AGAIN = "every 10 min, count the people. As soon as there are more than 3, wave"
_SIGHTS = ("SeesPerson", "SeesObject")
_COUNTED = "count the people. If there are more than 3, wave"
_ENDLESS = "-1"
_PACES = ("every", "every_day", "weekly", "on_days", "at", "until_time")
"""The roles of the words that say when the rounds of a loop begin."""
_HALF_DAY = 12 * 3600
_HALF, _WHOLE = "TurnAround", "TurnOnceAround"
_BACKWARD, _FORWARD = "MoveBackward", "MoveForward"
_ENDS = frozenset(("place", "object", "person", "door", "length", "angle", "text"))
"""The types of the values with which people say when a command has ended."""


def find_half_turns(compilation: Compilation) -> Iterator[Diagnostic]:
    """Search the loops of the mission and of its definitions."""
    whole = compilation.vocabulary.entry(_WHOLE)
    example = whole.example if whole is not None else ""
    for body in ast.bodies(compilation.mission) if example else ():
        for node in compilation.syntax(body):
            if (
                type(node) is ast.Repeat
                and isinstance(node.body, ast.Phrase)
                and node.body.entry.id == _HALF
                and node.rounds != _ENDLESS
            ):
                said = node.span.text
                fixed = said.replace(node.body.span.text, example, 1)
                note = diagnostic("BT163", node.span, words=said, fixed=fixed)
                yield note.replace(readings=((node.span, fixed),))
            elif type(node) is ast.Chain and node.operator == "sequence":
                yield from _ways_back(node, compilation)


def _ways_back(chain: ast.Chain, compilation: Compilation) -> Iterator[Diagnostic]:
    """Find where a robot that has turned around drives back, and not in as many words backwards."""
    vocabulary = compilation.vocabulary
    forward, particles = vocabulary.entry(_FORWARD), vocabulary.values.role_words.particles
    for turn, drive in pairwise(chain.items):
        if forward is None or not isinstance(turn, ast.Phrase) or not isinstance(drive, ast.Phrase):
            continue
        said = drive.span.text.lower().split()
        if (turn.entry.id, drive.entry.id) == (_HALF, _BACKWARD) and not particles.isdisjoint(said):
            printer = make_printer(compilation)
            fix = drive.span, printer.statement(drive)
            yield make_warning(Readings(drive, drive.replace(entry=forward), drive.span, fix), printer)


def find_next_day(compilation: Compilation) -> Iterator[Diagnostic]:
    """Search commands one after the other, in the mission and in definitions."""
    for body in ast.bodies(compilation.mission):
        nodes = compilation.syntax(body)
        if not any(isinstance(node, ast.WaitTime) for node in nodes):
            continue
        waits, ends = _first_inside(nodes, ast.WaitTime), _first_inside(nodes, ast.UntilTime | ast.WaitTime)
        for node in nodes:
            if type(node) is not ast.Chain or node.operator != "sequence":
                continue
            ended = begun = ""
            for item in node.items:
                wait = waits.get(id(item))
                if wait is not None and ended:
                    is_first = item is wait or (isinstance(item, ast.Chain) and item.items[0] is wait)
                    yield from _next_day(wait, ended, is_first, compilation.vocabulary)
                elif wait is not None and begun:
                    yield from _morning(wait, begun)
                begun = begun if wait is None else wait.time
                if isinstance(item, ast.Whenever):
                    continue
                end = ends.get(id(item))
                ended = "" if end is None else end.time


def _next_day(wait: ast.WaitTime, ended: str, is_first: bool, vocabulary: Lexicon) -> Iterator[Diagnostic]:
    """Report a wait for a time that is over when what comes before has ended; `every day at noon` may wait."""
    times = wait.time.split(";")
    earlier = (time for time in times if is_first and _is_over(time, ended))
    over = ended if ended in times else next(earlier, "")
    words = vocabulary.word("whenever"), *vocabulary.asking["time_is"], *vocabulary.asking["hours"][:1], over
    advice = "Leave it out." if over == ended else f"To do it meanwhile, write: {' '.join(words)}, ..."
    if over:
        end = f"ends at {'that time' if over == ended else ended}"
        yield diagnostic("BT169", wait.span, words=wait.span.text, ended=end, advice=advice)


def _morning(wait: ast.WaitTime, begun: str) -> Iterator[Diagnostic]:
    """Report `at 14:00, A, then B at 2:10`: a time before noon, behind one in the afternoon that it may go on from."""
    try:
        first, then = seconds_of(begun), seconds_of(wait.time)
    except ValueError:  # a value of the mission, or several times
        return
    hour, _, minute = wait.time.partition(":")
    words = wait.span.text
    is_bare = words.lower().split()[-1] == f"{int(hour)}:{minute}" and not words.split()[-1].startswith("0")
    if is_bare and then < first < then + _HALF_DAY:
        later = f"{int(hour) + 12}:{minute}"
        advice = f"If it is meant in the afternoon, write: {later}"
        yield diagnostic("BT169", wait.span, words=words, ended=f"is done at {begun}", advice=advice)


def _is_over(time: str, ended: str) -> bool:
    """Return whether a time of day is at most half a day before another one, or that time."""
    try:
        return 0 <= seconds_of(ended) - seconds_of(time) < _HALF_DAY
    except ValueError:  # a value of the mission
        return time == ended


def _first_inside(nodes: Sequence[ast.Ast], kinds: Any) -> dict[int, Any]:
    """Return, by the id of each node of a tree (parents first), the first one of these kinds in it, if there is one."""
    found: dict[int, Any] = {}
    for node in reversed(nodes):
        parts = (found[id(part)] for part in ast.parts(node) if id(part) in found)
        first = node if isinstance(node, kinds) else next(parts, None)
        if first is not None:
            found[id(node)] = first
    return found


def find_restarts(compilation: Compilation) -> Iterator[Diagnostic]:
    """Report a command, unless `repeat`, `keep` or a form before it says that it is repeated."""
    for body in ast.bodies(compilation.mission):
        for node in compilation.syntax(body):
            if type(node) is ast.While and node.otherwise is None and _has_an_end(node.body):
                yield from _starts_again_warning(node, compilation.vocabulary)


def _has_an_end(command: ast.Ast) -> bool:
    if type(command) is not ast.Phrase:
        return False
    said = {slot for slot, _ in command.arguments}
    return any(slot.name in said and slot.type in _ENDS for slot in command.entry.slots)


def _starts_again_warning(node: ast.While, vocabulary: Lexicon) -> Iterator[Diagnostic]:
    text, command = node.span.source.text, node.body.span
    between = text[command.end : node.condition.span.start]
    words = vocabulary.orthography.words(between.strip(" \t,("))
    role = "until" if node.negated else "while"
    if command.start != node.span.start or " ".join(words) not in vocabulary.roles[role]:
        return
    behind = text[command.end : node.span.end].strip(" \t,")
    condition = behind.split(maxsplit=len(words))[-1]
    said = command.text[0].lower() + command.text[1:]
    again = f"{vocabulary.word('repeat')} {said} {behind}"
    once = f"{command.text} {vocabulary.word('stop_when' if node.negated else 'provided')} {condition}"
    problem = diagnostic("BT170", node.span, words=command.text, again=again, once=once)
    yield problem.replace(readings=((node.span, again), (node.span, once)))


def find_ended_rounds(compilation: Compilation) -> Iterator[Diagnostic]:
    """Report the first endless loop at a pace, or at times of day, that a failure of a round would end."""
    for body in ast.bodies(compilation.mission):
        for node in compilation.syntax(body):
            if isinstance(node, ast.Every | ast.Repeat | ast.UntilTime) and goes_on(node) and _may_fail(node.body):
                yield _note_end(node, compilation.vocabulary)
                return


def _asked_from_here(node: ast.Ast) -> list[str]:
    """Return the people by name whom a list of questions, or a round for each, asks from where the robot is."""
    phrases = _phrases(ast.parents_first(node))
    questions = [each for each in phrases if each.entry.id == ASK]
    if not isinstance(node, ast.ForEach) or not questions:
        return [_person_of(each) for each in questions]
    drives = any(drives_robot(each.entry) for each in phrases[: phrases.index(questions[0])])
    return [] if drives or node.kind != PERSON else [name for name in node.values if name in node.span.text]


def find_distant_questions(compilation: Compilation) -> Iterator[Diagnostic]:
    """Report a question to somebody by name, or at a place, before which nothing moves the robot or asks about them.

    The same for `if you see Alice in the lab` and `wave to Alice in the lab`: that is done from where the robot is.
    That it drives to a thing to take it brings it to nobody.
    """
    body, vocabulary = compilation.mission.body, compilation.vocabulary
    nodes = compilation.syntax(body) if body is not None else []
    phrases = _phrases(nodes)
    if all(each.entry.id != ASK and "|" not in "".join(text for _, text in each.arguments) for each in phrases):
        return  # as nearly always: nobody is asked, and nothing is chosen by what it is like
    for node in (node for node in nodes if isinstance(node, ast.ForEach) or ast.is_list(node)):
        asked = _asked_from_here(node)
        if len({*asked} - {""}) > 1:  # from beside one of them, the others are asked from afar
            all_of = joined(asked, joint := vocabulary.word("and"))
            fixed = f"{' '.join(vocabulary.asking['journey'])} {all_of} {joint} ask each of them ..."
            yield diagnostic("BT149", node.span, words=node.span.text, person=all_of, fixed=fixed)
            return
    sights = {id(node.condition) for node in nodes if isinstance(node, ast.If)}
    in_rules = {id(each) for node in nodes if isinstance(node, ast.Whenever)
                for part in (node.condition, node.body) for each in ast.parents_first(part)}  # fmt: skip
    met, led, failed = "", set[int](), _failed_before(nodes)
    for phrase in sorted(phrases, key=lambda each: each.span.start):
        if id(phrase) in in_rules or phrase.entry.constrains:
            continue  # what a rule does is done at some time
        named = phrase.entry.given(PERSON, phrase.arguments)
        seen = phrase.entry.given(OBJECT, phrase.arguments) if phrase.entry.id in _SIGHTS else ()
        choice = next(map(choice_of, (*named, *seen)), None)
        parts = dict(choice.parts) if choice is not None else {}
        there = next((parts[relation] for relation in LIES if relation in parts), "")
        goal = there or (named[0] if named and named[0] in vocabulary.values.listed(PERSON) else "")
        drives = drives_robot(phrase.entry)
        stays = phrase.entry.sort == "action" and not drives
        is_far = there != "" and (stays or (phrase.entry.id in _SIGHTS and id(phrase) in sights))
        if (phrase.entry.id == ASK or is_far) and not led <= failed.get(id(phrase), set()):
            return
        if (phrase.entry.id == ASK or is_far) and goal and goal[:1] != "{" and goal != met:
            words = phrase.span.text
            is_verb = words.split()[0].lower() in asking_verbs(vocabulary)  # but not `keep asking Bob`
            fixed = with_journey_first(goal, words if is_verb else "...", vocabulary)
            yield diagnostic("BT149", phrase.span, words=words, person=goal, fixed=fixed)
            return
        is_at_thing = {phrase.entry.slot(name).type for name, _ in phrase.arguments} == {OBJECT}
        leads = MOVES in phrase.entry.resources and not (is_at_thing or phrase.entry.first)
        leads = leads and phrase.entry.id not in COUNTING
        if drives and len(named) == 1 and goal:
            met = goal  # `bring the cup to Bob and ask Alice "Tea?"` goes to Bob
        elif named or leads or phrase.entry.sort == "name":
            led.add(id(phrase))


def _failed_before(nodes: Sequence[ast.Ast]) -> dict[int, set[int]]:
    """Return for each part that is done where others have failed which these are, by their ids."""
    failed: dict[int, set[int]] = {}
    for node in nodes:
        parts: Sequence[ast.Ast] = ()
        if isinstance(node, ast.Chain) and node.operator == "fallback":
            parts = node.items
        elif isinstance(node, ast.IfWorks) and node.otherwise is not None:
            parts = (node.tried, node.otherwise)
        tried = set[int]()
        for part in parts:
            within = {id(each) for each in ast.parents_first(part)}
            for each in within:
                failed[each] = failed.get(each, set()) | tried
            tried |= within
    return failed


def _person_of(phrase: ast.Phrase) -> str:
    """Return the name of the person in a phrase, "" for none and for one who is chosen."""
    return next((text for text in phrase.entry.given(PERSON, phrase.arguments) if text[:1] != "{"), "")


def find_uncounted(compilation: Compilation) -> Iterator[Diagnostic]:
    """Report the first use of what was counted in a mission that counts nothing."""
    mission = compilation.mission
    nodes = [node for body in ast.bodies(mission) for node in compilation.syntax(body)]
    asked = next(filter(asks_for_number, nodes), None)
    if asked is None:
        return  # as nearly always
    if not any(each.entry.id in COUNTING for each in _phrases(nodes)):
        yield diagnostic("BT146", asked.span, words=asked.span.text, example=_COUNTED)


def find_vain_waits(compilation: Compilation) -> Iterator[Diagnostic]:
    """Report a wait for another number or answer that nothing beside it changes, so that it ends at once or never."""
    for body in ast.bodies(compilation.mission):
        waits = [node for node in compilation.syntax(body) if isinstance(node, ast.WaitUntil)]
        for wait in waits:
            if asks(wait.condition, (COMPARED,)):
                yield diagnostic(
                    "BT139", wait.span, words=wait.span.text, result="number", act="counts", example=_COUNTED_AGAIN
                )
            elif asks(wait.condition) and not any(asks(rule, (ASK,)) for rule in _beside(body)):
                yield diagnostic(
                    "BT139", wait.span, words=wait.span.text, result="answer", act="asks", example=KEEP_ASKING
                )


def _beside(body: ast.Ast) -> Iterator[ast.Ast]:
    """Yield what is done while other commands are."""
    for node in ast.parents_first(body):
        if isinstance(node, ast.Whenever) or (isinstance(node, ast.Chain) and node.operator == "parallel"):
            yield node


def _phrases(nodes: Iterable[ast.Ast]) -> list[ast.Phrase]:
    return [each for each in nodes if isinstance(each, ast.Phrase)]


def _names_in(text: str) -> set[str]:
    """Return the value itself, and of what is chosen the key and the name."""
    choice = choice_of(text)
    return {text} if choice is None else {text, f"{{{choice.key}}}", dict(choice.parts).get(NAME, text)}


def find_picked_up_only(compilation: Compilation) -> Iterator[Diagnostic]:
    """Report `fetch the cup` where no command behind it does anything with the cup."""
    vocabulary = compilation.vocabulary
    verbs = vocabulary.asking["getting"]
    for body in ast.bodies(compilation.mission):
        phrases = _phrases(compilation.syntax(body))
        by_place = {each.span.start: each for each in reversed(phrases) if each.entry.id == PICK_UP}  # of a list, one
        for phrase in sorted(by_place.values(), key=lambda each: each.span.start):
            verb, _, rest = phrase.span.text.partition(" ")
            if verb.lower() not in verbs or "\n" in rest:
                continue
            names = _names_in(phrase.arguments[0][1])
            later = (each for each in phrases if each.span.start > phrase.span.start)
            if not any(names & _names_in(value) for each in later for _, value in each.arguments):
                fixed = f"{' '.join(vocabulary.asking['bringing'])} {rest}"
                yield diagnostic("BT148", phrase.span, words=phrase.span.text, fixed=fixed)


def _note_end(node: ast.Every | ast.Repeat | ast.UntilTime, vocabulary: Lexicon) -> Diagnostic:
    """Make BT175 with the same words, and those for a try before the commands of each round."""
    word = next((words for words in vocabulary.roles["try"] if " " in words), vocabulary.word("try"))
    body = node.body
    while isinstance(body, ast.If) and isinstance(body.condition, ast.Phrase) and body.condition.entry.id == DAYTIME:
        body = body.body  # `every 30 min from 9 am to 6 pm, A`
    items = body.items if isinstance(body, ast.Chain) else (body,)
    done = [item for item in items if not _waits(item)]
    phrases = (each for item in done for each in ast.parents_first(item) if isinstance(each, ast.Phrase))
    acts = (each.span.start for each in phrases if each.entry.sort == "action")
    first = body.span.start if body.span.start > node.span.start else min(acts)
    inner, text = Span(node.span.source, first, body.span.end), node.span.source.text
    pace = text[node.span.start : inner.start] + text[inner.end : node.span.end]
    paces = {words.split()[0] for role in _PACES for words in vocabulary.roles[role]}
    front = text[node.span.start : inner.start].lower().split()[:1]
    is_split = bool(front) and paces.isdisjoint(front)  # `keep waving until 6 pm`
    is_split |= any(each.span.start < first for each in ast.parents_first(body) if isinstance(each, ast.Phrase))
    if "\n" in node.span.text or is_split or paces.isdisjoint(pace.lower().split()):  # `every 10 min, A until 6 pm`
        return diagnostic("BT175", node.span, word=word, fixed=f"{word} ...")
    said = f"{inner.text[:1].lower()}{inner.text[1:]}"
    if len(done) > 1 or isinstance(done[0], ast.Chain):
        said = f"({said})"
    fixed = f"{pace.strip(' ,:')}, {word} {said}"
    note = diagnostic("BT175", node.span, word=word, fixed=fixed)
    return note.replace(readings=((node.span, fixed),))  # type: ignore[no-any-return]


def goes_on(node: ast.Every | ast.Repeat | ast.UntilTime) -> bool:
    """Whether a loop goes on for long, or at several times of day: `every 10 min, A`, `at 9 am and at 8 pm, A`."""
    if isinstance(node, ast.UntilTime):
        return isinstance(node.body, ast.Chain)
    if isinstance(node, ast.Every):
        return node.rounds in ("", _ENDLESS)
    return _waits(node.body.items[0] if isinstance(node.body, ast.Chain) else node.body)


def _waits(node: ast.Ast) -> bool:
    """Whether a command waits for a time of day, on some days alone or on any."""
    if isinstance(node, ast.Retry) and isinstance(node.body, ast.Chain):
        return isinstance(node.body.items[0], ast.WaitTime)
    return isinstance(node, ast.WaitTime)


def _may_fail(node: ast.Ast) -> bool:
    """Whether a command has a task that may fail, without anything that is done then."""
    if isinstance(node, ast.Phrase):
        return node.entry.sort == "action" and not node.entry.accompaniment
    if isinstance(node, ast.Try):
        return node.otherwise is not None and _may_fail(node.otherwise)
    if isinstance(node, ast.Chain) and node.operator == "fallback":
        return _may_fail(node.items[-1])
    if isinstance(node, ast.Retry) and node.attempts == _ENDLESS:
        return False
    parts = ast.parts(node)
    return any(map(_may_fail, parts[1:] if isinstance(node, ast.IfWorks) else parts))
