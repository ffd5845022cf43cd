"""Words about things that nothing is known of: a size that the world doesn't tell, a pronoun that refers to nothing."""

from __future__ import annotations

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.text.words import Words
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.reading_context import ReadingContext
from btlang.vocabulary.references import DENIED
from btlang.vocabulary.trie import longest
from btlang.vocabulary.value_type import OBJECT, PLACE, WORLD, ValueType
from btlang.vocabulary.word_tree import find


def untold(text: Words, at: int, end: int, vocabulary: Lexicon) -> Diagnostic | None:
    """BT178 for a size, a state or a color of which nothing is known, before a noun or behind `that is`."""
    values = vocabulary.values
    is_told = values.likenesses.is_told
    for i in range(at, end):
        if any(find(values.names_tree(kind), text.words, i) is not None for kind in WORLD):
            continue  # `the cold room`, where one is called so
        is_clause = values.modifiers.ends_clause(text, i)
        for parts, last in values.adjectives.chains(text, i, values.names_tree):
            nouns = [kind for kind in (OBJECT, PLACE) if values.begins_noun(kind, text, last)]
            before_noun = nouns and (i > at or i in text.articles) and last not in text.articles
            kinds = [kind for kind in nouns or (OBJECT, PLACE) if not all(is_told(kind, part) for part, _ in parts)]
            if kinds and len(kinds) == len(nouns or (OBJECT, PLACE)) and (before_noun or is_clause):
                said, value = next((part, value) for part, value in parts if not is_told(kinds[0], part))
                part, span = DENIED.get(said, said), text.span(i, last)
                line = f'{part} = ["{value}"]' if part == "state" else f'{part} = "{value}"'
                unknown = diagnostic("BT178", span, words=span.text, part=part, type=kinds[0], line=line)
                return unknown.advising(f"Or leave out '{span.text}'")
    return None


def not_two(text: Words, at: int, end: int, vocabulary: Lexicon) -> Diagnostic | None:
    """BT152 for `both rooms` where it is open which two are meant, up to the word that ends what isn't known."""
    values = vocabulary.values
    for i in (i for i in range(at, end + 1) if text.words[i] in values.both):
        for meant, last in values.groups(text, i):
            every = meant.uncounted()
            names, span = values.likenesses.described(every), text.span(i, last)
            if names and len(names) != 2:
                reason = f"this world has {len(names)} of them" if len(names) > 1 else f"there is only '{names[0]}'"
                named = f" {vocabulary.word('and')} ".join(names[:2])
                return diagnostic(
                    "BT152", span, words=span.text, reason=reason, advice=f"Name them, for example: {named}"
                )
    return None


def unreferred(text: Words, at: int, vocabulary: Lexicon, context: ReadingContext) -> Diagnostic | None:
    """BT038 for a phrase whose subject is a pronoun that stands for nothing: `if she is near`."""
    pronoun = find(vocabulary.values.pronoun_words, text.words, at)
    if pronoun is None:
        return None
    kinds = [kind for kind in vocabulary.values.pronouns[pronoun[0]] if kind not in context.latest]
    referred = context.with_references()
    for kind in kinds:
        referred.latest = {kind: vocabulary.types[kind].example}
        match = longest(vocabulary.trie, text, at, referred, lists=False)
        if match is not None and match.meaning.entry is not None and match.values and match.values[0].first == at:
            example = value_example(vocabulary.types[kind], vocabulary)
            return diagnostic("BT038", text.span(at, pronoun[1]), words=pronoun[0], type=kind, example=example)
    return None


def value_example(kind: ValueType, vocabulary: Lexicon) -> str:
    names = vocabulary.values.said_names(kind.name) if kind.kind == "names" else []
    return names[0] if names else kind.example
