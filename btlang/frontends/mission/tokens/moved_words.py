"""Words that are read in another place of their sentence: `check every 5 min if C` as `every 5 min, check if C`."""

from __future__ import annotations

from collections.abc import Iterator

from btlang.frontends.mission.tokens.each_and_any import ENDING
from btlang.frontends.mission.tokens.word_matches import doing, forms_of, match_of, with_verb
from btlang.text.words import Words
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.pattern import ways
from btlang.vocabulary.trie import longest
from btlang.vocabulary.word_tree import find

_LONGEST_PACE = 6  # words


def say_opinion_first(text: Words, vocabulary: Lexicon) -> None:
    """Put `I think` before what it is said of: `bring it to Bob, he's in the lab I think` asks for one thing.

    So does `It should be in the lab`.
    """
    words, opinions, asking = text.words, vocabulary.opinions, vocabulary.asking
    if text.distinct.isdisjoint((*asking["supposing"], *opinions)):
        return  # as nearly always
    supposing, opinion = asking["supposing"], next(iter(asking["opinions"]), "").split()
    robot = {*asking["hearing"], *asking["subject"][:1], *vocabulary.joining}
    robot |= vocabulary.subjects if not text.distinct.isdisjoint(asking["subject"][:1]) else set()
    for at in reversed(range(1, len(words) - 2)):
        first = text.earlier(at)[1]
        subject = words[first:at]
        is_placed = words[at] in supposing and words[at + 1] in asking["being"] and words[at + 2] in asking["located"]
        if is_placed and subject and robot.isdisjoint(subject):
            text.drop(at + 1, at + 2)
            text.replace(at, asking["asking_be"][:1])
            text.replace(first, [*opinion, words[first]])
    for at in reversed(range(2, len(words) - 2)):
        said = find(opinions, words, at)
        if said is None or words[said[1]][0] not in ENDING:
            continue
        at_end = at - (words[at - 1] == ",")
        first = next((i + 1 for i in range(at_end - 1, text.earlier(at)[1] - 1, -1) if words[i] == ","), at_end)
        if first < at_end:
            opinion = words[at : said[1]]
            text.drop(at_end, said[1])
            text.replace(first, [*opinion, words[first]])


def say_subject_first(text: Words, vocabulary: Lexicon) -> None:
    """Say `if` for a condition that begins with its verb: `should the door be open, wave` as `if the door is open`."""
    words, inverted = text.words, vocabulary.asking["inverted_if"]
    if text.distinct.isdisjoint(inverted):
        return  # as nearly always
    for at in reversed([at for at in range(len(words) - 3) if words[at] in inverted]):
        end = next(i for i in range(at, len(words)) if words[i] in ENDING or words[i] == ",")
        begins = at == text.earlier(at)[1] or words[at - 1] in (*vocabulary.joining, ",")
        if not begins or words[end] != "," or words[at + 1] in vocabulary.trie.get(words[at], ()):
            continue  # `should I go?`, `should one be missing, A`
        found = [each for verb in range(at + 2, end) for each in _straight(text, at, verb, end, vocabulary)]
        _, verb, rest, said = max(found, key=lambda each: each[0], default=(0, at, at, []))
        if said:
            text.drop(verb + 1, rest)
            text.replace(verb, said)
            text.replace(at, [vocabulary.word("if")])


def _straight(
    text: Words, at: int, verb: int, end: int, vocabulary: Lexicon
) -> Iterator[tuple[int, int, int, list[str]]]:
    """Yield how a verb of `should the door be open` is said behind its subject: `is` in the place of `be`.

    With it come the end of the condition that this makes, where its verb is, and what follows.
    """
    words, asking, tries = text.words, vocabulary.asking, (vocabulary.trie,)
    denial = words[verb : verb + 1] if words[verb] in vocabulary.roles["not"] else []
    base, rest = words[verb + len(denial)], verb + 1
    if base == asking["being"][0]:
        forms, rest = asking["asking_be"], rest + len(denial)
    elif denial:
        forms = [*asking["doing_theirs"], *asking["doing_ours"]]
    else:
        forms = [*forms_of(base, vocabulary.third_person), base]
    for form in forms:
        said = [form, *denial]
        places = [*range(at, verb), *[verb] * len(said), *range(rest, end)]
        other = {0: vocabulary.word("if"), **dict(enumerate(said, verb - at))}
        whole = match_of(text, places, other, tries, vocabulary.context)
        alone = match_of(
            text, places[1:], {place - 1: word for place, word in other.items() if place}, tries, vocabulary.context
        )
        last = max(whole.last if whole else 0, alone.last + 1 if alone and alone.meaning.role == "condition" else 0)
        if last > verb - at or base == asking["being"][0]:
            yield last, verb, rest, said


def say_done_in_each(text: Words, vocabulary: Lexicon) -> None:
    """Join what is done in each place: `go to the lab and the hall, waving in each` as `... and wave in each`."""
    words, each = text.words, {phrase.split()[0] for phrase in vocabulary.roles["all_names"]}
    if text.distinct.isdisjoint(each):
        return  # as nearly always
    places = {word for phrase in vocabulary.values.role_words.introducing["location"] for word in phrase}
    for at in reversed([at for at in range(1, len(words) - 3) if words[at - 1] == ","]):
        match = doing(text, at, vocabulary.doing, (vocabulary.trie,), vocabulary.context)
        if match is not None and words[match.last] in places and words[match.last + 1] in each:
            text.replace(at, [with_verb(text, at, vocabulary.doing, vocabulary.trie).words[at]])
            text.replace(at - 1, vocabulary.roles["and"][:1])


def say_time_before_event(text: Words, vocabulary: Lexicon) -> None:
    """Put the time in front of two ends: `dance until Bob comes or until 5 pm` as `until 5 pm or until Bob comes`."""
    words, values = text.words, vocabulary.values
    until, alternatives = vocabulary.word("until"), vocabulary.roles["or"]
    if until not in text.distinct or text.distinct.isdisjoint(alternatives):
        return  # as often
    for at in reversed([at for at in range(2, len(words) - 2) if words[at] in alternatives and words[at + 1] == until]):
        first = next((i for i in range(at - 1, text.earlier(at)[1] - 1, -1) if words[i] == until), 0)
        time = values.time_of_day(text, at + 2)
        if first and time is not None and values.time_of_day(text, first + 1) is None:
            ends = [until, *words[at + 2 : time[1]], words[at], until]
            text.drop(at, time[1])
            text.replace(first, ends)


def say_pace_first(text: Words, vocabulary: Lexicon) -> None:
    """Put how often something is checked in front: `check every 5 min if C` as `every 5 min, check if C`."""
    words, every = text.words, vocabulary.firsts["every"]
    if text.distinct.isdisjoint(every):
        return  # as nearly always
    checks = {*ways(vocabulary.roles["check"])}
    whether = {way.split()[-1] for way in checks}
    for at in reversed([at for at in range(1, len(words) - 3) if words[at] in every]):
        verb = text.earlier(at)[1]
        end = next((i for i in range(at + 2, min(at + _LONGEST_PACE, len(words))) if words[i] in whether), 0)
        if end and verb == at - 1 and f"{words[verb]} {words[end]}" in checks:
            pace = words[at:end]
            text.drop(at, end)
            text.replace(verb, [*pace, ",", words[verb]])


def drop_where_it_is(text: Words, vocabulary: Lexicon) -> None:
    """Take out `where it is` behind what is left out of a set: `take all cups, but leave the red one where it is`."""
    words, left = text.words, vocabulary.left_there
    if text.distinct.isdisjoint(left):
        return  # as nearly always
    forms = {*vocabulary.before_conditions, *(word for phrase in vocabulary.roles["after"] for word in phrase.split())}
    for at in reversed([at for at, word in enumerate(words) if word in left]):
        said = find(left, words, at)
        first = max(text.earlier(at)[1], *(i for i in range(at) if words[i] == ","), 0)  # in the same clause
        excepted = next(filter(None, (vocabulary.values.exception(text, i) for i in range(first, at - 2))), 0)
        leaves = excepted and words[excepted] not in forms  # but not `except if`, `but only after`
        if said is not None and words[said[1]][0] in ENDING and leaves:
            text.drop(at, said[1])


def say_quantifier_first(text: Words, vocabulary: Lexicon) -> None:
    """Put `both` and `all` in front: `if the doors are all closed` as `if all doors are closed`.

    `if A and B aren't both near` says `if not both A and B are near`; behind `they` both words say nothing more.
    """
    words, both = text.words, vocabulary.roles["both"]
    floating = {*both, *(phrase for phrase in vocabulary.roles["all_names"] if " " not in phrase)}
    if text.distinct.isdisjoint(floating) or text.distinct.isdisjoint(vocabulary.before_conditions):
        return  # as nearly always
    for at in reversed([at for at in range(2, len(words) - 1) if words[at] in floating]):
        is_apart = words[at - 1] in vocabulary.roles["not"]
        be = at - 1 - is_apart
        denied = vocabulary.forms_of_be.get(words[be])
        forms = [i for i in range(text.earlier(at)[1], be) if words[i] in vocabulary.before_conditions]
        form = longest(vocabulary.trie, text, forms[-1], vocabulary.context) if forms else None
        if denied is None or form is None or not forms[-1] < form.last < be:
            continue
        says = [i for i in range(form.last, be) if words[i] in vocabulary.forms_of_be]  # `if A is near and B are all`
        joint = (i + 1 for i in range(max(says, default=be), be) if words[i] in vocabulary.joining)
        first, quantifier = next(joint, form.last), words[at]
        subject = words[first:be]
        is_list = not vocabulary.values.joiners.isdisjoint(subject)
        if len(subject) == 1 and subject[0] in vocabulary.values.plural_pronouns:
            text.drop(at, at + 1)
        elif denied or is_apart:
            verb = next((verb for verb, forms in vocabulary.negations.items() if words[be] in forms), words[be])
            text.drop(be + 1, at + 1)
            text.replace(be, [verb])
            text.replace(first, [*vocabulary.roles["not"][:1], quantifier, words[first]])
        else:
            text.drop(at, at + 1)
            if not is_list:
                text.replace(first, [quantifier, words[first]])
