"""What is said of several sets or places at once, said of each in the words that are read: `pick up every cup and every
book and take them to the hall`, `go to the lab and the hall. If nobody is there, wave`.
"""

from __future__ import annotations

from collections.abc import Container

from btlang.frontends.mission.tokens.each_and_any import (
    STOPS,
    end_of_condition,
    is_otherwise,
    listed_before,
    speaks_freely,
)
from btlang.text.words import END_OF_STATEMENT, END_OF_TEXT, Words
from btlang.vocabulary.antecedents import pronouns_for
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.value_type import OBJECT, PERSON, PLACE
from btlang.vocabulary.word_tree import find


def part_each(text: Words, vocabulary: Lexicon) -> None:
    """Change such words of a text; none in a language without words for `any of them`."""
    if not vocabulary.asking["any_of_them"]:
        return
    _part_sets(text, vocabulary)
    _part_stops(text, vocabulary)
    _join_replies(text, vocabulary)


def _part_sets(text: Words, vocabulary: Lexicon) -> None:
    """Say of each of several sets what is said of all: `pick up every cup and every book and take them to the hall`."""
    words, values, joints = text.words, vocabulary.values, {",", *vocabulary.roles["and"]}
    if text.distinct.isdisjoint(values.plural_pronouns):
        return  # as nearly always
    names = values.names_tree(OBJECT)
    starts = values.choice_starts | values.group_starts | names.keys() | values.names_tree(PERSON).keys()
    it = pronouns_for(values.pronouns, OBJECT)[0]
    at = -1
    while at < len(words) - 1:
        at += 1
        _, first, _ = text.earlier(at)
        found = _sets_at(text, vocabulary, at, joints) if words[at] in starts else None
        if found is None:
            continue
        sets, behind = found
        stop = next(i for i in range(behind, len(words)) if words[i] in STOPS)
        spoken = [i for i in range(behind, stop) if words[i] in values.plural_pronouns]
        start = next((i + 1 for i in reversed(range(first, at)) if words[i] in (",", *vocabulary.joining)), first)
        if not spoken or start == at:
            continue
        last = end_of_condition(text, vocabulary, spoken[-1])
        if speaks_freely(words[start:last], vocabulary):
            continue
        rest = words[behind:last]
        said_of = {True: [it if word in values.plural_pronouns else word for word in rest], False: rest}
        rows = [[*words[start:at], *each, *said_of[find(names, [*each, END_OF_TEXT], 0) is not None]] for each in sets]
        is_whole = start == first and last == stop
        begin, end, joint = ("", "", END_OF_STATEMENT) if is_whole else ("(", ")", vocabulary.word("then"))
        said = [word for row in rows for word in (joint, begin, *row, end) if word][1:]
        text.drop(start, last - 1)
        text.replace(start, said)
        at = start + len(said) - 1


def _sets_at(text: Words, vocabulary: Lexicon, at: int, joints: Container[str]) -> tuple[list[list[str]], int] | None:
    """The words of each of several sets that are listed at a word, and where the list ends.

    Behind `every cup and book in the lab` both are in the lab.
    """
    words, values = text.words, vocabulary.values
    for kind in (OBJECT, PERSON):
        tree, sets, shared, begin, behind, has_set = (
            values.names_tree(kind),
            list[list[str]](),
            list[str](),
            at,
            at,
            False,
        )
        while True:
            own = [end for _, end in values.groups(text, begin, kind)]
            is_bare = bool(sets) and has_set and not own and begin not in text.articles
            bare = [*values.groups(text, begin, kind, is_bare=True)] if is_bare else []
            named = find(tree, words, begin) if not (own or bare) else None
            ends = own or [end for _, end in bare] or ([named[1]] if named is not None else [])
            if not ends:
                break
            sets.append([*(words[at : at + 1] if bare else ()), *words[begin : ends[0]]])
            shared, behind, has_set = words[ends[0] : ends[-1]] if bare else [], ends[-1], has_set or bool(own)
            if words[behind] not in joints:
                break
            begin = behind + 1 + (words[behind] == "," and words[behind + 1] in joints)
        if len(sets) > 1 and has_set:
            return [[*each, *shared] for each in sets], behind
    return None


def _part_stops(text: Words, vocabulary: Lexicon) -> None:
    """Ask in each place of a journey: `go to the lab and the hall. If nobody is there, wave, otherwise nod`."""
    words, values, form = text.words, vocabulary.values, vocabulary.word("if")
    if form not in text.distinct:
        return  # as often
    checking = (phrase.split()[0] for phrase in vocabulary.roles["check"])
    verbs = vocabulary.journey_verbs.union(vocabulary.opening_words("Patrol"), checking)
    if text.distinct.isdisjoint(verbs):
        return  # as often
    prepositions = {word for phrases in values.role_words.introducing.values() for phrase in phrases for word in phrase}
    joints, tree = {END_OF_STATEMENT, ",", *vocabulary.roles["and"]}, values.names_tree(PLACE)
    for at in reversed([at for at in range(1, len(words)) if words[at] == form and words[at - 1] in joints]):
        behind = end_of_condition(text, vocabulary, at + 1)
        places = _places_again(text, vocabulary, at + 1, behind)
        last = at if places else 0
        while last > 0 and words[last - 1] in joints:
            last -= 1
        _, first, _ = text.earlier(last)
        if not places or words[first] not in verbs:
            continue
        begin, names = listed_before(text, vocabulary, last, first)
        if not set(words[first + 1 : begin]) <= prepositions:
            continue  # `look for the cup in the lab and the hall`
        are_places = len(names) > 1 and all(find(tree, [*name.lower().split(), END_OF_TEXT], 0) for name in names)
        stop = next(i for i in range(behind, len(words) - 1) if words[i] in STOPS)
        if words[stop + 1] not in STOPS and is_otherwise(text, vocabulary, stop + 1):
            stop = next(i for i in range(stop + 1, len(words) - 1) if words[i] in STOPS)
        if not are_places or speaks_freely(words[at:stop], vocabulary):
            continue
        then = next((i for i in range(behind, stop) if words[i] in vocabulary.roles["then"]), stop)
        asked = words[at : then - (words[then - 1] == ",")]
        for i in (i for i in places if words[i] in vocabulary.asking["located"]):
            asked[i - at : i - at + 2] = vocabulary.asking["remaining"][-1:]
        rows = [
            [END_OF_STATEMENT, *words[first:begin], *name.lower().split(), END_OF_STATEMENT, *asked] for name in names
        ]
        ends = then < stop
        text.drop(first, then - 1 + ends)
        text.replace(first, [*[word for row in rows for word in row][1:], *([END_OF_STATEMENT] if ends else ())])


def _places_again(text: Words, vocabulary: Lexicon, first: int, last: int) -> list[int]:
    """Where a condition says again where it is so: `there`, `in the room`; but not in `if there is a cup`."""
    words, values, asking = text.words, vocabulary.values, vocabulary.asking
    found = []
    for at in range(first, last):
        behind = words[at + 1]
        is_there = PLACE in values.pronouns.get(words[at], ()) and behind not in vocabulary.forms_of_be
        is_room = words[at] in asking["located"] and at + 1 in text.articles
        if is_there or (is_room and (values.phrases.is_type(PLACE, text, at + 1) or behind in asking["stops"])):
            found.append(at)
    return found


def _join_replies(text: Words, vocabulary: Lexicon) -> None:
    """Ask each for the answer: `ask every guest "Tea?". If any of them says no, tell them to wait`."""
    words, asking = text.words, vocabulary.asking
    if text.distinct.isdisjoint(asking["any_of_them"]):
        return  # as nearly always
    for at in reversed([at for at in range(2, len(words) - 3) if words[at] in asking["any_of_them"]]):
        end = at + 2 + (words[at + 1] in asking["of_them"])
        is_of_them = end == at + 3 and PERSON in vocabulary.values.pronouns.get(words[at + 2], ())
        _, first, _ = text.earlier(at - 2)
        groups = (each for i in range(first, at - 1) for each in vocabulary.values.groups(text, i, PERSON))
        asks = words[at - 3][0] == '"' and words[at - 2] == END_OF_STATEMENT and words[at - 1] == vocabulary.word("if")
        if asks and is_of_them and words[end] not in vocabulary.forms_of_be and next(groups, None) is not None:
            text.drop(at, end)
            text.replace(at - 2, [vocabulary.word("and")])
            text.replace(
                at - 1, [vocabulary.word("if"), pronouns_for(vocabulary.values.pronouns, PERSON, alone=True)[0]]
            )
