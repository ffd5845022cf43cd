"""Words that are put in the place of others before a text is read: `rooms 1 to 3` becomes `rooms 1, 2 and 3`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence, Set

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.tokens.condition_words import is_denied_by_verb
from btlang.frontends.mission.tokens.counted_things import COUNTED
from btlang.frontends.mission.tokens.days import list_days, say_hour_first
from btlang.frontends.mission.tokens.each_and_any import ENDING, STOPS, end_of_condition, say_each
from btlang.frontends.mission.tokens.moved_words import (
    drop_where_it_is,
    say_done_in_each,
    say_opinion_first,
    say_pace_first,
    say_quantifier_first,
    say_subject_first,
    say_time_before_event,
)
from btlang.frontends.mission.tokens.parted import part_each
from btlang.text.source import Span
from btlang.text.words import END_OF_STATEMENT, Words
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.pattern import ways
from btlang.vocabulary.trie import longest
from btlang.vocabulary.value_type import DOOR, OBJECT, PERSON, PLACE, TEXT, WORLD, ZONE
from btlang.vocabulary.word_tree import find

_MOST_ADJECTIVES = 3
_LONGEST_TRY = 6  # words


def reworded(text: Words, vocabulary: Lexicon) -> list[Diagnostic]:
    """Change the words of a text to those that are read. Returns notes about what is left out."""
    _say_plainly(text, vocabulary)
    _say_at_door(text, vocabulary)
    _drop_words_of_turns(text, vocabulary)
    _drop_still(text, vocabulary)
    _join_but(text, vocabulary)
    say_subject_first(text, vocabulary)
    say_opinion_first(text, vocabulary)
    _say_last_of_all(text, vocabulary)
    _drop_left(text, vocabulary)
    _say_there(text, vocabulary)
    say_done_in_each(text, vocabulary)
    say_each(text, vocabulary)
    part_each(text, vocabulary)
    list_days(text, vocabulary)
    say_hour_first(text, vocabulary)
    say_time_before_event(text, vocabulary)
    say_pace_first(text, vocabulary)
    drop_where_it_is(text, vocabulary)
    say_quantifier_first(text, vocabulary)
    _say_as_soon_as(text, vocabulary)
    _drop_again(text, vocabulary)
    _drop_back(text, vocabulary)
    _say_words(text, vocabulary)
    _say_again(text, vocabulary)
    _say_numbers(text, vocabulary)
    _count_again(text, vocabulary)
    _tell_again(text, vocabulary)
    _tell_at_once(text, vocabulary)
    _tell_each(text, vocabulary)
    _say_so(text, vocabulary)
    _wait_to_try(text, vocabulary)
    _wait_once(text, vocabulary)
    _drop_commas(text, vocabulary)
    _list_ranges(text, vocabulary)
    problems = [*_drop_untold_sizes(text, vocabulary), *_drop_untold_contents(text, vocabulary)]
    return [*problems, *_refuse_some_time(text, vocabulary)]


def _say_plainly(text: Words, vocabulary: Lexicon) -> None:
    """Put plain words in the place of idioms: `it is past 10 am` as `it is after 10 am`."""
    if text.distinct.isdisjoint(vocabulary.idioms) and text.distinct.isdisjoint(vocabulary.last_idioms):
        return
    said = list[tuple[int, int, str]]()
    for at, word in enumerate(text.words):
        found = find(vocabulary.idioms, text.words, at) if word in vocabulary.idioms else None
        last = find(vocabulary.last_idioms, text.words, at) if word in vocabulary.last_idioms else None
        if last is not None and text.words[last[1]] in ENDING:
            found = last
        if found is not None and (not said or at >= said[-1][1]):
            said.append((at, found[1], found[0]))
    for at, end, plain in reversed(said):
        text.drop(at + 1, end)
        text.replace(at, plain.split())


def _join_but(text: Words, vocabulary: Lexicon) -> None:
    """Join what begins with `but` to the sentence before it: `Go to the lab. But if C, wave`."""
    but = vocabulary.roles["but"]
    if text.distinct.isdisjoint(but):
        return  # as nearly always
    for at in [at for at, word in enumerate(text.words) if word in but]:
        if at > 1 and text.words[at - 1] == END_OF_STATEMENT and text.source.text[text.starts[at - 1]] in ".!":
            text.replace(at - 1, [","])


def _say_at_door(text: Words, vocabulary: Lexicon) -> None:
    """Say the one door that is called like a room: `wait outside the lab` as `wait at the lab door`."""
    words, rooms = text.words, vocabulary.values.names_tree(PLACE)
    if text.distinct.isdisjoint(vocabulary.outside):
        return  # as nearly always
    stays, moves = vocabulary.opening_words("StayInZone", "AvoidZone"), vocabulary.opening_words("Take", "PutDown")
    for at in reversed([at for at, word in enumerate(words) if word in vocabulary.outside]):
        found = find(vocabulary.outside, words, at)
        room = find(rooms, words, found[1]) if found is not None else None
        is_verb = at > 0 and (words[at - 1] in stays or words[at - 1] in vocabulary.forms_of_be)
        is_verb = is_verb or _is_of_thing(text, at, vocabulary) or _is_forbidden(text, at - 1, vocabulary)
        if found is None or room is None or is_verb or not moves.isdisjoint(words[text.earlier(at)[1] : at]):
            continue  # `stay outside the lab`, `never drive outside the lab`, `put the sign outside the lab`
        said = set(words[found[1] : room[1]])
        doors = [vocabulary.orthography.words(name) for name in vocabulary.values.listed(DOOR)]
        doors = [door for door in doors if said.issubset(door) and len(door) == len(said) + 1]
        if len(doors) == 1:
            named = find(vocabulary.values.names_tree(DOOR), words, found[1])
            text.drop(at + 1, max(room[1], named[1] if named is not None else 0))  # `in front of the lab door`
            text.replace(at, [vocabulary.asking["located"][-1], *doors[0]])


def _is_forbidden(text: Words, at: int, vocabulary: Lexicon) -> bool:
    """Whether words that forbid something end before a word: `without driving`."""
    said = (find(vocabulary.forbidding, text.words, i) for i in range(text.earlier(at)[1], at))
    return any(found is not None and found[1] == at for found in said)


def _is_of_thing(text: Words, at: int, vocabulary: Lexicon) -> bool:
    """Whether words before a place say where a thing is: `the cup is standing in front of the lab`."""
    things, words = vocabulary.values.names_tree(OBJECT), text.words
    be = (i for i in range(text.earlier(at)[1], at) if words[i] in vocabulary.forms_of_be)
    named = ((i, find(things, words, first)) for i in be for first in range(max(i - _MOST_ADJECTIVES, 0), i))
    return any(thing is not None and thing[1] == i for i, thing in named)


def _drop_words_of_turns(text: Words, vocabulary: Lexicon) -> None:
    """Take out what says nothing beside a list, with its commas: `the lab and the dock, in that order`.

    `either` says nothing at an end: `avoid the lab. Don't go into the hall either`.
    """
    words, either = text.words, vocabulary.roles["either"]
    last = [] if text.distinct.isdisjoint(either) else [at for at in range(1, len(words) - 1) if words[at] in either]
    for at in (at for at in reversed(last) if words[at + 1][0] in ENDING):
        text.drop(at, at + 1)
    if text.distinct.isdisjoint(vocabulary.in_turn):
        return  # as nearly always
    for at in reversed([at for at, word in enumerate(words) if word in vocabulary.in_turn]):
        found = find(vocabulary.in_turn, words, at)
        begins = at == 0 or words[at - 1] in (*STOPS, ":")
        if found is not None and (not begins or words[found[1]] == ","):
            first = at - (words[at - 1] == "," and not begins)
            is_inserted = words[found[1]] == "," and words[found[1] + 1] not in vocabulary.joining
            text.drop(first, found[1] + (is_inserted and (begins or first < at)))


def _drop_still(text: Words, vocabulary: Lexicon) -> None:
    """Take out `still` and `already` before what a condition says: `if he still says no`; but not `if he is still`.

    `yet` stands at its end: `if he isn't there yet`.
    """
    words, still, motionless = text.words, vocabulary.asking["still"], vocabulary.asking["motionless"]
    yet = vocabulary.yet
    for at in reversed(range(1, len(words))) if not text.distinct.isdisjoint((*still, *yet)) else ():
        is_still = words[at] in still and words[at - 1] not in motionless and words[at + 1][0].isalpha()
        said = find(yet, words, at)
        end = at + 1 if is_still else said[1] if said is not None and not words[said[1]][0].isalpha() else 0
        if end:
            _, first, _ = text.earlier(at)
            first = max((i + 1 for i in range(first, at) if words[i] == ","), default=first)
            if any(word in vocabulary.before_conditions for word in words[first:at]):
                text.drop(at, end)


def _say_numbers(text: Words, vocabulary: Lexicon) -> None:
    """Ask how many there are for `tell Bob the number of cups`, and leave out `in total` behind that."""
    words = text.words
    if text.distinct.isdisjoint((*vocabulary.numbers, *vocabulary.in_all)):
        return  # as nearly always
    tells = vocabulary.opening_words("Say", "TellPerson") | vocabulary.telling.keys()
    how_many = vocabulary.roles["ask_how_many"][0].split()
    for at in reversed([at for at, word in enumerate(words) if word in vocabulary.numbers]):
        found = find(vocabulary.numbers, words, at) if find(vocabulary.numbers, words, at - 1) is None else None
        told = next((i for i in range(at - 1, text.earlier(at)[1] - 1, -1) if words[i] in tells), at)
        named = (find(tree, words, at) for tree in vocabulary.measured) if found is not None else ()
        is_value = any(value[1] > found[1] + 1 for value in named if value and found)  # `number of people near you`
        if found is not None and told < at and not is_value and vocabulary.before_conditions.isdisjoint(words[told:at]):
            text.drop(at + 1, found[1])
            text.replace(at, how_many)
    for at in reversed([at for at, word in enumerate(words) if word in vocabulary.in_all]):
        found = find(vocabulary.in_all, words, at)
        before = words[text.earlier(at)[1] : at]
        if found is not None and words[found[1]][0] in ENDING and how_many[0] in before:
            text.drop(at, found[1])


def _say_last_of_all(text: Words, vocabulary: Lexicon) -> None:
    """Say that all have left for `the last guest has left`, which names no one."""
    if text.distinct.isdisjoint(vocabulary.last_ones):
        return  # as nearly always
    for at in reversed([at for at, word in enumerate(text.words) if word in vocabulary.last_ones]):
        match = longest(vocabulary.trie, text, at, vocabulary.context)
        if match is not None and is_denied_by_verb(text, match, at, vocabulary):
            if match.values and match.values[0].first == at and match.values[0].type == PERSON:
                text.replace(at, vocabulary.word("all_names").split())


def _drop_left(text: Words, vocabulary: Lexicon) -> None:
    """Take out `left` in a condition: `if nobody is left in the lab`, `if there are no cups left`; not `turn left`.

    So are `waiting` and the like of people who are counted: `if there are more than 3 people waiting`.
    """
    words, remaining, values = text.words, vocabulary.asking["remaining"], vocabulary.values
    postures = vocabulary.asking["postures"]
    if text.distinct.isdisjoint((*remaining[:1], *postures)):
        return  # as nearly always
    prepositions = values.role_words.prepositions
    be, things = vocabulary.asking["asking_be"], (OBJECT, "kind", "kinds")
    for at in reversed([at for at in range(1, len(words) - 1) if words[at] in (*remaining[:1], *postures)]):
        ends, before = not words[at + 1][0].isalpha(), words[at - 1]
        asking = vocabulary.before_conditions | vocabulary.firsts["ask_how_many"]
        asks = (i for i in reversed(range(text.earlier(at)[1], at)) if words[i] in asking)
        first = next(asks, at)
        is_noun = any(values.takes_word(kind, before) for kind in things) or values.phrases.is_head(before)
        is_thing = is_noun or before in vocabulary.quantifiers or values.is_number([before])
        is_left = words[at] not in postures and (is_thing or before in be)
        if before in be and ends and first < at and words[at] not in postures:
            text.replace(at, [remaining[1]])
        elif (is_left or is_noun) and any(word in be for word in words[first:at]):
            if ends or words[at + 1] in (*prepositions, remaining[-1]):
                text.drop(at, at + 1)


def _say_there(text: Words, vocabulary: Lexicon) -> None:
    """Put `there` behind `go in` where it is left out: `At 11, go in and wave`."""
    if text.distinct.isdisjoint(vocabulary.entering):
        return  # as nearly always
    words, there = text.words, vocabulary.asking["remaining"][-1:]
    for at in reversed([at for at in range(len(words) - 1) if words[at] in vocabulary.entering]):
        found = find(vocabulary.entering, words, at)
        if found is not None and (words[found[1]][0] in ENDING or words[found[1]] in vocabulary.joining):
            text.replace(found[1] - 1, [words[found[1] - 1], *there])


def _say_as_soon_as(text: Words, vocabulary: Lexicon) -> None:
    """Say `as soon as` for a `once` whose condition would make it another word: `once more than 2 guests are here`."""
    words, again = text.words, vocabulary.roles["again"]
    if text.distinct.isdisjoint(vocabulary.firsts["again"]):
        return  # as nearly always
    once = {phrase for phrase in vocabulary.roles["once"] if any(way.startswith(f"{phrase} ") for way in again)}
    for at in reversed([at for at, word in enumerate(words) if word in once]):
        whole, behind = (longest(vocabulary.trie, text, i, vocabulary.context) for i in (at, at + 1))
        is_again = whole is not None and whole.meaning.role == "again"
        if is_again and behind is not None and behind.meaning.role == "condition":
            text.replace(at, vocabulary.word("as_soon_as").split())


def _drop_again(text: Words, vocabulary: Lexicon) -> None:
    """Take out `again` between times before what is done: `at 9 am and again at 3 pm, wave`."""
    if text.distinct.isdisjoint(vocabulary.firsts["again"]):
        return  # as nearly always
    words, again, joints = text.words, {*vocabulary.roles["again"]}, {",", *vocabulary.roles["and"]}
    times = {phrase.split()[0] for phrase in vocabulary.roles["at"]}
    fronts = {*times, *(phrase.split()[0] for phrase in (*vocabulary.roles["on_days"], *vocabulary.roles["every_day"]))}
    for at in reversed([at for at in range(2, len(words) - 2) if words[at] in again]):
        _, first, _ = text.earlier(at)
        is_time = words[at + 2][0].isdigit() or vocabulary.values.takes_word("time_of_day", words[at + 2])
        is_between = words[at - 1] in joints and words[at + 1] in times and not times.isdisjoint(words[first : at - 1])
        if is_time and is_between and words[first] in fronts:
            text.drop(at, at + 1)


def _drop_back(text: Words, vocabulary: Lexicon) -> None:
    """Leave out `back` before from whom something is taken: `take the book back from Bob`."""
    words, values = text.words, vocabulary.values
    if text.distinct.isdisjoint(vocabulary.and_back):
        return  # as nearly always
    sources = {phrase[0] for phrase in values.role_words.introducing.get("source", ())}
    for at in reversed([at for at in range(1, len(words) - 2) if words[at] in vocabulary.and_back]):
        person = find(values.names_tree(PERSON), words, at + 2)
        is_person = person is not None or PERSON in values.pronouns.get(words[at + 2], ())
        if words[at + 1] in sources and is_person and words[at - 1] not in vocabulary.journey_verbs:
            text.drop(at, at + 1)


def _say_words(text: Words, vocabulary: Lexicon) -> None:
    """Put what is said in quotes: `until Bob tells you to stop` as `until Bob says "stop"`."""
    words, says = text.words, vocabulary.asking["says"]
    if text.distinct.isdisjoint(vocabulary.telling_to) or not says:
        return  # as nearly always
    for at in reversed([at for at in range(1, len(words) - 3) if words[at] in vocabulary.telling_to]):
        found = find(vocabulary.telling_to, words, at)
        _, first, _ = text.earlier(at)
        asks = any(word in vocabulary.before_conditions for word in words[first:at])
        if found is not None and asks:
            last = end_of_condition(text, vocabulary, found[1])
            said = " ".join(words[found[1] : last]).strip('"')
            if said:
                is_speaker = words[at - 1] in vocabulary.asking["speaking"]
                text.drop(at + 1, last)
                text.replace(at, [says[-1] if is_speaker else says[0], f'"{said}'])


def _say_again(text: Words, vocabulary: Lexicon) -> None:
    """Put what was said in quotes for `it` behind `say`: `Say "hi". Go to the lab and say it again`."""
    words, it = text.words, vocabulary.asking["said_before"]
    if text.distinct.isdisjoint(it):
        return  # as often
    verbs = vocabulary.opening_words("Say")
    again = (phrase.split()[0] for phrase in (*vocabulary.roles["again"], *vocabulary.counts))
    to = (phrase[0] for phrase in vocabulary.values.role_words.introducing.get("recipient", ()))
    behind = {*ENDING, *vocabulary.joining, *again, *to}
    for at in [at for at in range(1, len(words) - 1) if words[at] in it and words[at - 1] in verbs]:
        said = next((word for word in reversed(words[:at]) if word[0] == '"'), "")
        is_often = vocabulary.values.is_number(words[at + 1 : at + 2])
        if said and not said.endswith("?") and (words[at + 1] in behind or is_often):
            text.replace(at, [said])


def _count_again(text: Words, vocabulary: Lexicon) -> None:
    """Leave out what is counted again: `count them again`."""
    words, again = text.words, vocabulary.firsts["again"]
    if text.distinct.isdisjoint(again):
        return  # as nearly always
    verbs = vocabulary.opening_words(*COUNTED)
    for at in reversed([at for at in range(1, len(words) - 1) if words[at - 1] in verbs and words[at + 1] in again]):
        if words[at] in vocabulary.values.pronoun_words:
            text.drop(at, at + 1)


def _tell_again(text: Words, vocabulary: Lexicon) -> None:
    """Say `tell` for `remind` where that is done again: `remind her again at 4 pm`."""
    words, asking = text.words, vocabulary.asking
    if text.distinct.isdisjoint(asking["reminding"]):
        return  # as nearly always
    again = vocabulary.firsts["again"]
    for at in (at for at in range(len(words) - 2) if words[at] in asking["reminding"]):
        person = find(vocabulary.values.names_tree(PERSON), words, at + 1)
        if words[at + 2 if person is None else person[1]] in again:
            text.replace(at, asking["informing"][:1])


def _tell_at_once(text: Words, vocabulary: Lexicon) -> None:
    """Leave out what says nothing before what somebody is told: `tell Bob right away that tea is ready`."""
    words, people = text.words, vocabulary.values.names_tree(PERSON)
    if text.distinct.isdisjoint(vocabulary.at_once):
        return  # as nearly always
    telling = vocabulary.opening_words("TellPerson", "Ask")
    for at in reversed([at for at in range(2, len(words) - 1) if words[at] in vocabulary.at_once]):
        first, found = text.earlier(at)[1], find(vocabulary.at_once, words, at)
        told = (find(people, words, i + 1) for i in range(first, at) if words[i] in telling)
        if found is None or not any(who is not None and who[1] == at for who in told):
            continue
        after = words[found[1]]
        if after[0] not in ENDING and after not in vocabulary.joining:
            text.drop(at, found[1])


def _tell_each(text: Words, vocabulary: Lexicon) -> None:
    """Repeat the verb of what several are told: `tell Bob that A, Alice that B`, `ask Bob to A and Alice to B`."""
    words, people = text.words, vocabulary.values.names_tree(PERSON)
    telling = vocabulary.opening_words("TellPerson", "Ask")
    if text.distinct.isdisjoint(telling) or text.distinct.isdisjoint(people):
        return  # as nearly always
    said = (verb for verb in range(len(words)) if words[verb] in telling)
    for verb in reversed([verb for verb in said if find(people, words, verb + 1) is not None]):
        _, first = find(people, words, verb + 1) or ("", verb)
        end = next(i for i in range(verb, len(words)) if words[i] in STOPS)
        joints = (i for i in range(first + 1, end) if words[i] in (",", *vocabulary.roles["and"]))
        for at in reversed([i for i in joints if words[i + 1] in people]):
            other = find(people, words, at + 1)
            opens = words[first] == words[other[1]] if other is not None else False
            is_quoted = other is not None and words[first][0] == words[other[1]][0] == '"'
            if is_quoted or (opens and words[first][0].isalpha()):
                begin = at - (words[at - 1] == ",")
                text.drop(begin + 1, at + 1)
                text.replace(begin, [vocabulary.word("then"), words[verb]])


def _say_so(text: Words, vocabulary: Lexicon) -> None:
    """Leave out the pronoun for what is reported: `if C, report it to Alice` is `if C, tell Alice`."""
    words, asking, people = text.words, vocabulary.asking, vocabulary.values.names_tree(PERSON)
    if text.distinct.isdisjoint(asking["told_pronouns"]):
        return
    for at in reversed([at for at in range(1, len(words) - 1) if words[at] in asking["told_pronouns"]]):
        named = find(people, words, at + 2) if words[at + 1] in vocabulary.purpose else None
        end = named[1] if named is not None else at + 1
        is_last = words[end][0] in ENDING or words[end] in vocabulary.joining
        if is_last and words[at - 1] in asking["reporting"]:
            whom = words[at + 2 : end] if named is not None else sorted(vocabulary.values.role_words.speaker)[:1]
            text.drop(at + 1, end)
            text.replace(at, whom)
            text.replace(at - 1, asking["informing"][:1])
            continue
        told = next((i for i in range(text.earlier(at)[1], at) if words[i] in asking["informing"]), at)
        person = find(people, words, told + 1)
        if is_last and words[at] != asking["told_pronouns"][0] and person is not None and person[1] == at:
            text.replace(at, asking["so"][:1])  # `tell Bob this`


def _wait_to_try(text: Words, vocabulary: Lexicon) -> None:
    """Say the pause first: `try again after 5 minutes` as `wait 5 minutes and try again`."""
    words, wait, pause = text.words, vocabulary.word("wait"), {*vocabulary.asking["pausing"]}
    if text.distinct.isdisjoint(pause):
        return  # as nearly always
    for at in reversed([at for at in range(2, len(words) - 2) if words[at] in pause]):
        fronts = (first for first in range(max(at - _LONGEST_TRY, 0), at))
        first = next((i for i in fronts if (found := find(vocabulary.try_again, words, i)) and found[1] == at), None)
        lasts = vocabulary.values.read("duration", text, at + 1)
        if first is not None and lasts is not None and words[lasts[1]][0] in ENDING:
            said = words[at + 1 : lasts[1]]
            text.drop(at, lasts[1])
            text.replace(first, [wait, *said, vocabulary.word("and"), words[first]])


def _wait_once(text: Words, vocabulary: Lexicon) -> None:
    """Leave out what is said again: `wait until 10 am and until Bob is here` as `wait until 10 am and Bob is here`."""
    words, joints = text.words, vocabulary.joining
    if text.distinct.isdisjoint(vocabulary.firsts["until"]):
        return  # as often
    untils = [phrase.split() for phrase in ways(vocabulary.roles["until"])]
    waits = [phrase.split() for phrase in ways(vocabulary.roles["wait_until"])]
    for at in reversed([at for at in range(2, len(words) - 1) if words[at - 1] in joints]):
        again = max((len(phrase) for phrase in untils if words[at : at + len(phrase)] == phrase), default=0)
        ends = range(at - 1, text.earlier(at)[1], -1) if again else ()
        begin = next((end for end in ends if any(words[max(end - len(wait), 0) : end] == wait for wait in waits)), 0)
        if begin and joints.isdisjoint(words[begin : at - 1]):
            text.drop(at, at + again)


def _drop_commas(text: Words, vocabulary: Lexicon) -> None:
    """Take out the comma between a word that joins and one before a condition: `wave and, if bumped, nod`.

    So is that in `wait in the lab, at most 10 min`, where nothing else ends the time.
    """
    words, joints = text.words, vocabulary.joining.difference(vocabulary.roles["or"])
    waits = vocabulary.firsts["wait_up_to"]
    for at in reversed([at for at in range(1, len(words) - 1) if words[at] == ","]):
        joins = words[at - 1] in joints and words[at + 1] in vocabulary.before_conditions
        if joins or (not waits.isdisjoint(text.distinct) and _is_time_waited(text, at, waits, vocabulary)):
            text.drop(at, at + 1)


def _is_time_waited(text: Words, at: int, waits: Set[str], vocabulary: Lexicon) -> bool:
    """Whether what stands behind a comma is how long a robot waits where it is, or somewhere else."""
    words = text.words
    first = next((i + 1 for i in reversed(range(at)) if words[i] in (",", *STOPS, *vocabulary.joining)), 0)
    match = longest(vocabulary.trie, text, at + 1, vocabulary.context)
    is_time = match is not None and match.meaning.role in ("up_to", "for") and words[match.last][0] in ENDING
    return words[first] in waits and is_time and vocabulary.firsts["until"].isdisjoint(words[first:at])


def _list_ranges(text: Words, vocabulary: Lexicon) -> None:
    """Put all names of a range in the place of the last one: `rooms 1 to 3` as `rooms 1, 2 and 3`."""
    words, heads = text.words, vocabulary.values.shared_heads
    joints = set(vocabulary.asking["between_joint"]).difference(vocabulary.roles["and"])
    if joints.isdisjoint(text.distinct):
        return  # as often
    sources = {phrase[0] for phrase in vocabulary.values.role_words.introducing.get("source", ())}
    for at in reversed(range(len(words) - 3)):
        if words[at + 2] not in joints or not words[at + 1].isdecimal():
            continue
        is_twice = words[at + 3] == words[at] and words[at + 4].isdecimal()  # `aisle 1 to aisle 4`
        last = words[at + 3 + is_twice]
        numbers = next((found for kind in WORLD if (found := heads.between(kind, words, at, last))), [])
        is_from = at > 0 and words[at - 1] in sources
        if is_from and is_twice and not _says_each(words, at, vocabulary):
            continue  # `go from room 1 to room 4` is a journey
        if numbers:
            text.drop(at + 3, at + 3 + is_twice)
            if is_from and is_twice:  # `go from room 1 to room 4 and wave in each room`
                text.replace(at - 1, vocabulary.asking["journey"][-1:])
            listed = [word for number in numbers for word in (",", number)]
            text.replace(at + 3, [*listed[1:-2], vocabulary.word("and"), numbers[-1]] if len(numbers) > 1 else numbers)
            text.replace(at + 2, [","] if len(numbers) > 1 else [vocabulary.word("and")])


def _says_each(words: Sequence[str], at: int, vocabulary: Lexicon) -> bool:
    """Whether each of several is spoken of behind the first one in its statement: `and at each room, ...`."""
    end = next(i for i in range(at, len(words)) if words[i] in STOPS)
    return any(words[i] in vocabulary.quantifiers and words[i + 1] == words[at] for i in range(at + 1, end))


def _drop_untold_sizes(text: Words, vocabulary: Lexicon) -> Iterator[Diagnostic]:
    """Take out a size before the name of a place where nothing is known of sizes: `the large red room` is that room."""
    sizes, places = vocabulary.values.names_tree("size"), vocabulary.values.names_tree(PLACE)
    if text.distinct.isdisjoint(sizes) or vocabulary.values.likenesses.is_told(PLACE, "size"):
        return
    found = [(at, find(sizes, text.words, at)) for at in range(len(text.words)) if text.words[at] in sizes]
    ends = [(at, size[1]) for at, size in found if size is not None and find(places, text.words, at) is None]
    named = {text.words[end] for at, end in ends if text.earlier(at)[1] == at}  # `the large kitchen is at (3, 4)`
    before = vocabulary.values.role_words.prepositions
    entries = [entry for same in vocabulary.entries.values() for entry in same]
    types = [(entry, {slot.type for slot in entry.slots}) for entry in entries]
    goes = [entry for entry, own in types if own & {PLACE, ZONE} and TEXT not in own]
    verbs = tuple(phrase.split()[0] for entry in goes for phrase in entry.phrases)
    for at, end in reversed(ends):
        if (
            find(places, text.words, end)
            and text.words[end] not in named
            and (text.words[at - 1] in before or text.words[at - 1].startswith(verbs))
        ):
            span = text.span(at, end)
            text.drop(at, end)
            yield diagnostic("BT158", span, words=span.text)


def _drop_untold_contents(text: Words, vocabulary: Lexicon) -> Iterator[Diagnostic]:
    """Take out what is in a thing where nothing is known of that: `a cup of tea` is the cup."""
    words, values = text.words, vocabulary.values
    contents, joints = vocabulary.contents, vocabulary.content_words
    if text.distinct.isdisjoint(contents) or text.distinct.isdisjoint(joints):
        return
    if any(part == "content" for _, parts in values.likenesses.features.get(OBJECT, ()) for part, _ in parts):
        return
    names = (values.names_tree(OBJECT), values.names_tree("kind"))
    entries = [entry for same in vocabulary.entries.values() for entry in same]
    says = {
        phrase.split()[0]
        for entry in entries
        if any(slot.type == TEXT for slot in entry.slots)
        for phrase in (*entry.phrases, *(verb for verbs, _ in entry.verbs for verb in verbs))
    }
    for at in reversed([at for at in range(1, len(words)) if words[at] in joints]):
        inside = find(contents, words, at + 1)
        begins = range(max(at - 3, 0), at)
        is_thing = any((found := find(tree, words, first)) and found[1] == at for tree in names for first in begins)
        is_name = any((found := find(names[0], words, first)) and found[1] > at for first in begins)
        is_said = inside is not None and not says.isdisjoint(words[text.earlier(at)[1] : at])
        if inside is not None and is_thing and not (is_name or is_said):
            span = text.span(at, inside[1])
            text.drop(at, inside[1])
            yield diagnostic("BT158", span, words=span.text)


def _refuse_some_time(text: Words, vocabulary: Lexicon) -> Iterator[Diagnostic]:
    """BT011 for `wait a moment` and `stay there for a while`, which are read with a time in its place."""
    words, wait = text.words, vocabulary.word("wait")
    if text.distinct.isdisjoint(vocabulary.some_time):
        return  # as nearly always
    fronts = {wait, *vocabulary.firsts["for"], *vocabulary.asking["waiting"]}
    for at in reversed([at for at in range(1, len(words)) if words[at] in vocabulary.some_time]):
        found = find(vocabulary.some_time, words, at)
        if found is None or words[at - 1] not in fronts:
            continue
        behind = words[found[1]]
        if behind[0] in ENDING or behind in vocabulary.joining:
            example, front = vocabulary.types["duration"].example, text.span(at - 1, at).text
            start, _ = text.articles.get(at, (text.starts[at], 0))
            span = Span(text.source, start, text.ends[found[1] - 1])
            text.drop(at + 1, found[1])
            text.replace(at, example.split())
            wanted = "it doesn't say how long"
            yield diagnostic("BT011", span, words=span.text, wanted=wanted, example=f"{front} {example}")
