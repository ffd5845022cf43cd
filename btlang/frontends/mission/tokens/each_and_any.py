"""Words about each or any of several things, in the words that are read: `if any door is open`, `close A and B if they
are open`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from btlang.text.words import END_OF_STATEMENT, END_OF_TEXT, Words
from btlang.vocabulary.antecedents import pronouns_for
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.pattern import forms
from btlang.vocabulary.reading_context import ReadingContext
from btlang.vocabulary.trie import longest
from btlang.vocabulary.value_type import DOOR, OBJECT, PERSON, PLACE, WORLD
from btlang.vocabulary.word_tree import find

_MOST_ADJECTIVES, _MOST_BEFORE_TEXT = 3, 5
_GOING_ON = frozenset(("otherwise", "if_works", "if_fails", "if_one_fails", "in_any_case"))
STOPS = (END_OF_STATEMENT, END_OF_TEXT)
ENDING = frozenset((*STOPS, ",", ";", ")"))


def say_each(text: Words, vocabulary: Lexicon) -> None:
    """Change such words of a text; only the first in a language without words for `any of them`."""
    _say_for_each(text, vocabulary)
    if not vocabulary.asking["any_of_them"]:
        return
    _say_each_if_so(text, vocabulary)
    _say_every_if_so(text, vocabulary)
    _say_if_so(text, vocabulary)
    _say_kind(text, vocabulary)
    _say_there_is(text, vocabulary)
    _list_any(text, vocabulary)


def _say_for_each(text: Words, vocabulary: Lexicon) -> None:
    """Say that a list in front is gone through: `for the lab and the hall: wave` as `for each place among ...`."""
    words, fronts, each = text.words, vocabulary.firsts["each"], vocabulary.word("each").split()
    if ":" not in text.distinct or text.distinct.isdisjoint(fronts):
        return  # as nearly always
    for at in reversed([at for at, word in enumerate(words) if word in fronts and text.earlier(at)[1] == at]):
        last = next(i for i in range(at, len(words)) if words[i] in STOPS or words[i] == ":")
        begin, names = listed_before(text, vocabulary, last, at + 1)
        kind = next((kind for kind in WORLD if set(names) <= set(vocabulary.values.listed(kind))), "")
        if words[last] == ":" and begin == at + 1 and len(names) > 1 and kind:
            text.replace(at, [*each, kind, vocabulary.roles["each_in"][-1]])


def _say_each_if_so(text: Words, vocabulary: Lexicon) -> None:
    """Ask of each name: `close A and B if they are open`, `Check that A and B are shut. Close any that aren't`."""
    words, asking, values = text.words, vocabulary.asking, vocabulary.values
    be, them = vocabulary.forms_of_be, asking["those"]
    fronts = {*vocabulary.relatives, vocabulary.word("if")}
    if text.distinct.isdisjoint(fronts) or text.distinct.isdisjoint(be):
        return  # as nearly always
    for at in reversed([at for at in range(1, len(words) - 2) if words[at] in fronts]):
        verb = at + 1 + (words[at + 1] in values.plural_pronouns)
        behind = verb + 1 + (words[verb + 1] in asking["still"])
        last, (_, first, _) = end_of_condition(text, vocabulary, verb), text.earlier(at)
        is_relative = words[at] in vocabulary.relatives  # but `tell Alice and Bob that they are late`
        if words[verb] not in be or is_relative == (verb > at + 1) or last > behind + 1:
            continue
        begin, names = listed_before(text, vocabulary, at, first)
        state, is_pronoun = words[behind] if last > behind else "", words[at - 1] in them and first > 0
        if is_pronoun:
            _, before, _ = text.earlier(first - 1)
            begin, names = at - 1, max(_named(text, vocabulary, before, first).values(), key=len, default=[])
            states = [words[i + 1] for i in range(before, first - 1) if words[i] in be]
            state = state or "".join(states[-1:])
        start = next((i + 1 for i in reversed(range(first, begin)) if words[i] in (",", *vocabulary.joining)), first)
        if not state or start == begin or len(names) < 2 - is_pronoun:
            continue
        is_so = vocabulary.negations[asking["asking_be"][0]][0].split() if be[words[verb]] else asking["asking_be"][:1]
        split = [name.lower().split() for name in names]
        _put_each(
            text, vocabulary, [[*name, *is_so, state, ",", *words[start:begin], *name] for name in split], start, last
        )


def _put_each(text: Words, vocabulary: Lexicon, rows: Iterable[Sequence[str]], start: int, last: int) -> None:
    """Put conditions with what is done in the place of some words: as statements where they are all of one."""
    words, joints = text.words, vocabulary.joining.difference(vocabulary.roles["or"])
    if speaks_freely(words[start:last], vocabulary):
        return
    is_whole = text.earlier(start)[1] == start and (words[last] in joints or words[last] in STOPS)
    said: list[str] = []
    for row in rows:
        one = [vocabulary.word("if"), *row]
        said += [END_OF_STATEMENT, *one] if is_whole else [vocabulary.word("then"), "(", *one, ")"]
    goes_on = is_whole and words[last] in joints
    text.drop(start, last - 1 + goes_on)
    text.replace(start, [*said[1:], *([END_OF_STATEMENT] if goes_on else ())])


def speaks_freely(words: Sequence[str], vocabulary: Lexicon) -> bool:
    """Whether words say something without quotes, which can't stand in several places: `tell Bob that tea is ready`."""
    speech = vocabulary.opening_words("TellPerson", "Ask", "Say")
    for at in [at for at, word in enumerate(words) if word in speech or word in vocabulary.asking["informing"]]:
        behind = words[at + 1 : at + 1 + _MOST_BEFORE_TEXT]
        end = next((i for i, word in enumerate(behind) if word in ENDING or word in vocabulary.joining), len(behind))
        informs = end < len(behind) or len(behind) < _MOST_BEFORE_TEXT
        is_named = end > 0 and find(vocabulary.values.names_tree(PERSON), [*behind[:end], END_OF_TEXT], 0) is not None
        if not (any(word[0] == '"' for word in behind) or (informs and is_named)):
            return True
    return False


def end_of_condition(text: Words, vocabulary: Lexicon, at: int) -> int:
    """Where a condition ends that goes on at a word."""
    words = text.words
    return next(i for i in range(at, len(words)) if words[i] in ENDING or words[i] in vocabulary.joining)


def _say_every_if_so(text: Words, vocabulary: Lexicon) -> None:
    """Ask of each of a set: `close the doors if they are open`, `close any door that is open`."""
    words, asking, values = text.words, vocabulary.asking, vocabulary.values
    one, be = asking["asking_be"][0], {*asking["asking_be"]}
    form = vocabulary.word("if")
    asked = [at for at in range(2, len(words) - 2) if words[at - 1] == form and words[at] in values.plural_pronouns]
    for at in reversed([at for at in asked if words[at + 1] in be]):
        ends = {end for i in range(text.earlier(at)[1], at - 1) for _, end in values.groups(text, i, DOOR)}
        if at - 1 in ends:
            text.replace(at + 1, [one])
            text.replace(at, pronouns_for(values.pronouns, DOOR)[:1])
    for at in reversed([at for at in range(1, len(words) - 3) if words[at] in asking["whichever"]]):
        noun, verb = at + 1, at + 2
        verb += words[verb] in vocabulary.relatives
        is_any = words[at] in asking["any_of_them"]
        if values.phrases.is_type(DOOR, text, noun) and words[verb] in be and is_any == (verb > noun + 1):
            if verb == noun + 1:
                text.replace(verb, [next(iter(vocabulary.relatives)), words[verb]])
            text.replace(at, values.choices(DOOR)[0][:1])


def listed_before(text: Words, vocabulary: Lexicon, at: int, first: int) -> tuple[int, list[str]]:
    """The names joined by `and` that end at a word, and where they begin."""
    words, joints = text.words, {",", *vocabulary.roles["and"]}
    for begin in range(first, at):
        names, i = list[str](), begin
        while i < at:
            end, name, _ = max(_names_at(text, vocabulary, i), key=lambda way: way[0], default=(i, "", ""))
            if end == i:
                break
            names.append(name)
            i = end
            while i < at and words[i] in joints:
                i += 1
        if i == at and names and words[at - 1] not in joints:
            return begin, names
    return at, []


def _say_if_so(text: Words, vocabulary: Lexicon) -> None:
    """Put `if it is` for `that is` behind doors, which are as the robot finds them: `close every door that is open`."""
    words, values, asking = text.words, vocabulary.values, vocabulary.asking
    if text.distinct.isdisjoint(vocabulary.relatives):
        return  # as nearly always
    it = next(iter(pronouns_for(values.pronouns, DOOR)), "")
    entries = (vocabulary.entry(id) for id in ("DoorOpen", "DoorClosed"))
    states = {form[-1] for entry in entries if entry is not None for each in entry.phrases for form in forms(each)}
    for at in reversed([at for at in range(1, len(words) - 1) if words[at] in vocabulary.relatives]):
        found = find(vocabulary.relatives, words, at)
        if found is None or not values.phrases.is_type(DOOR, text, at - 1):
            continue
        state = found[1] + (words[found[1]] in asking["still"])
        if words[state] in states and (words[state + 1][0] in ENDING or words[state + 1] in vocabulary.joining):
            text.drop(at + 1, state)
            text.replace(at, [vocabulary.word("if"), it, asking["asking_be"][0]])


def _say_kind(text: Words, vocabulary: Lexicon) -> None:
    """Put the kind behind `all` that what is left out has: `all but the blue cups` as `all cups but the blue cups`."""
    words, values, every = text.words, vocabulary.values, frozenset(vocabulary.roles["all_names"])
    for at in reversed([at for at, word in enumerate(words) if word in every]):
        end = values.exception(text, at + 1)
        nouns = (word for word in words[end : end + _MOST_ADJECTIVES] if end and values.takes_word("kinds", word))
        noun = next(nouns, "")
        if noun:
            text.replace(at, [words[at], noun])


def _say_there_is(text: Words, vocabulary: Lexicon) -> None:
    """Say that there is something that isn't named: `if a cup is on the table` as `if there is a cup on the table`."""
    words, values, asking = text.words, vocabulary.values, vocabulary.asking
    if text.distinct.isdisjoint(vocabulary.before_conditions):
        return
    there, places = asking["remaining"][-1], values.role_words.introducing["location"]
    for at in reversed([at for at in range(1, len(words)) if words[at - 1] in vocabulary.before_conditions]):
        article = text.source.text[slice(*text.articles[at])].lower() if at in text.articles else ""
        is_some, is_none = words[at] in asking["any_place"], words[at] in asking["no_thing"]
        is_indefinite = is_some or is_none or article in asking["indefinite"]
        found = values.choice(text, at + (is_some or is_none), OBJECT) if is_indefinite else None
        if found is None:
            continue
        end = found[1]
        if words[end] in asking["asking_be"] and any(
            words[end + 1 : end + 1 + len(each)] == [*each] for each in places
        ):
            be = words[end]
            text.drop(end, end + 1)
            text.replace(at, [there, be, *([] if is_some else [words[at]])])


def _list_any(text: Words, vocabulary: Lexicon) -> None:
    """Say all names with `or` for any of them in a condition: `if any door is open`, `if one of them is open`.

    What depends on it and speaks of it is done for each: `if any door is open, close it`.
    """
    words, asking = text.words, vocabulary.asking
    if text.distinct.isdisjoint((*asking["any_of_them"], *asking["no_thing"])):
        return  # as nearly always
    be, none, values = vocabulary.forms_of_be, {*asking["no_thing"]}, vocabulary.values
    starts = values.choice_starts | values.group_starts | {*asking["of_them"]}
    some = [at for at in range(1, len(words) - 1) if words[at] in asking["any_of_them"] or words[at] in none]
    for at in reversed(some):
        is_other = words[at] in none and words[at + 1] not in starts
        if is_other and not any(values.phrases.is_type(kind, text, at + 1) for kind in (DOOR, PLACE)):
            continue  # `no longer than 5 min`
        _, first, _ = text.earlier(at)
        form = next((i for i in reversed(range(first, at)) if words[i] in vocabulary.before_conditions), -1)
        if form < 0 or "," in words[form:at]:
            continue
        found = _names_meant(text, vocabulary, at, first)
        if found is None:
            continue
        idiom = longest(vocabulary.trie, text, form, ReadingContext(vocabulary.values), lists=False)
        if idiom is not None and idiom.meaning.entry is None and idiom.last > at:
            continue  # `if one of them is missing, A`
        kind, names, end = found
        last, is_subject = end_of_condition(text, vocabulary, end), words[end] in be
        stop = next(i for i in range(last, len(words) - 1) if words[i] in STOPS)
        if not is_subject and words[at - 1] not in asking["located"]:
            continue
        split, pronouns = [name.lower().split() for name in names], pronouns_for(vocabulary.values.pronouns, kind)
        if words[at] in none and (not is_subject or be[words[end]] or len(names) < 2):
            continue
        if words[at] not in none and not set(pronouns).isdisjoint(words[last:stop]):
            is_else = any(is_otherwise(text, vocabulary, i) for i in range(last, stop + 2) if i < len(words) - 1)
            is_pronoun = [i for i in range(last, stop) if words[i] in pronouns]
            is_owner = any(vocabulary.values.texts.is_owned(text, i) for i in is_pronoun)
            if (
                kind != PLACE
                and is_subject
                and form == at - 1
                and words[form] == vocabulary.word("if")
                and not (is_else or is_owner)
            ):
                rows = []
                for name in split:
                    done = (part for word in words[last:stop] for part in (name if word in pronouns else [word]))
                    rows.append([*name, *words[end:last], *done])
                _put_each(text, vocabulary, rows, form, stop)
            continue
        said = [[*name, *(words[end:last] if is_subject else ())] for name in split]
        joint = vocabulary.word("nor" if words[at] in none else "or")
        listed = [word for each in said for word in (*each, joint)][:-1]
        listed = [vocabulary.word("neither"), *listed] if words[at] in none else listed
        text.drop(at, (last if is_subject else end) - 1)
        text.replace(at, listed)


def is_otherwise(text: Words, vocabulary: Lexicon, at: int) -> bool:
    """Whether words begin what is done else, or depend on how it went."""
    match = longest(vocabulary.trie, text, at, ReadingContext(vocabulary.values), lists=False)
    return match is not None and match.meaning.role in _GOING_ON


def _names_meant(text: Words, vocabulary: Lexicon, at: int, first: int) -> tuple[str, list[str], int] | None:
    """The type and names of `any of them`, `one of the doors` or `any room` at a word, and where these words end."""
    words, values, of = text.words, vocabulary.values, vocabulary.asking["of_them"]
    noun = at + 1 + (words[at + 1] in of)
    named = _named(text, vocabulary, text.earlier(first - 1)[1] if first else first, at) if noun > at + 1 else {}
    if noun > at + 1 and PERSON in values.pronouns.get(words[noun], ()):
        several = ((kind, names) for kind, names in named.items() if len(names) > 1)
        kind, names = next(several, ("", []))
        return (kind, names, noun + 1) if kind else None
    if noun == at + 1 and words[at] not in (*vocabulary.asking["any_place"], *vocabulary.asking["no_thing"]):
        return None
    for kind in (DOOR, PLACE):
        if values.phrases.is_type(kind, text, noun):
            return kind, named[kind] if len(named.get(kind, ())) > 1 else [*values.listed(kind)], noun + 1
        for meant, end in values.groups(text, noun, kind, is_bare=True):
            names = list(values.likenesses.described(meant.uncounted()))
            spoken_of = [name for name in named.get(kind, ()) if name in names]
            if meant.type == kind and names:  # `go to the lab and the hall. If one of the rooms is empty`: these two
                return kind, spoken_of if len(spoken_of) > 1 else names, end
    return None


def _named(text: Words, vocabulary: Lexicon, first: int, last: int) -> dict[str, list[str]]:
    """The names between two words, by type; one that is of several types is under each of them."""
    found: dict[str, list[str]] = {}
    while first < last:
        ways = [*_names_at(text, vocabulary, first)]
        end = max((way[0] for way in ways), default=first + 1)
        for last_word, name, kind in ways:
            if last_word == end and name not in found.setdefault(kind, []):
                found[kind].append(name)
        first = end
    return found


def _names_at(text: Words, vocabulary: Lexicon, at: int) -> Iterator[tuple[int, str, str]]:
    """Where the longest name of each type ends that begins at a word, the name, and the type."""
    for kind in WORLD:
        found = find(vocabulary.values.names_tree(kind), text.words, at)
        if found is not None:
            yield found[1], found[0], kind
