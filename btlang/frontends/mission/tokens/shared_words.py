"""Words that a condition shares with the one before it: `the battery is below 20% or above 90%`."""

from __future__ import annotations

from btlang.diagnostics.diagnostic import Diagnostic
from btlang.frontends.mission.tokens.word_matches import match_of, relocated, rest_of
from btlang.text.words import Words
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.match import Match
from btlang.vocabulary.reading_context import ReadingContext
from btlang.vocabulary.trie import TrieNode, longest, resumed
from btlang.vocabulary.word_tree import find


def continued(
    first: int, origin: Match, root: TrieNode, text: Words, at: int, vocabulary: Lexicon, context: ReadingContext
) -> tuple[Match, Diagnostic | None] | None:
    """The words at a place with those of a condition, up to its verb, in front; None where these are no condition.

    The condition begins at the word `first`; `root` is the trie that it was found in. BT151 where it is negated, and
    the words at the place have no `not` of their own.
    """
    ways = [(verb, way) for verb, negations in vocabulary.negations.items() for way in (verb, *negations)]
    verbs = {way.split()[0]: verb for verb, way in ways}
    within = {word for value in origin.values for word in range(value.first, value.last)}
    place = next((i for i in range(first, origin.last) if text.words[i] in verbs and i not in within), None)
    if place is None:
        subject = find(context.values.pronoun_words, text.words, first)
        return _with_subject(first, subject[1], origin, text, at, vocabulary, context) if subject is not None else None
    verb = verbs[text.words[place]]
    before = tuple(value for value in origin.values if value.first < place)
    node = (resumed(root, text, first, place, before) or {}).get(verb)
    match = longest(node, text, at, context, lists=False, found=before) if node is not None else None
    other = _with_subject(first, place, origin, text, at, vocabulary, context)
    if match is None or match.last == at or (other is not None and other[0].last > match.last):
        return other
    own = {way.split()[-1] for verb, way in ways if way.startswith(f"{verb} ")}
    has_own = text.words[at] in own
    if origin.meaning.role != "negated" or (has_own and match.meaning.role == "negated"):
        return match, None
    from btlang.frontends.mission.explanations.negations import shared_negation  # hardly ever

    return match, shared_negation(text, (first, place), verb, (at + has_own, match.last), vocabulary)


def _with_subject(
    first: int, verb: int, origin: Match, text: Words, at: int, vocabulary: Lexicon, context: ReadingContext
) -> tuple[Match, None] | None:
    """`she says no or doesn't reply`: the words at a place with the subject alone in front, if they have a verb."""
    if verb == first or origin.meaning.role not in ("condition", "negated"):
        return None
    places = [*range(first, verb), *rest_of(text, at)]
    match = match_of(text, places, {}, (vocabulary.trie,), context)
    if match is None or match.meaning.role not in ("condition", "negated") or match.last <= verb - first + 1:
        return None
    return relocated(match, places), None
