"""Finds values that no statement sets: `this mission is given {goal}, {path}`, and what nodes by their ids give."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.symbols.nodes import Unreadable, outputs_at, read_node
from btlang.frontends.mission.token import Header
from btlang.text.words import Words, statements
from btlang.tree.catalogue import SUBTREE
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.pattern import forms
from btlang.vocabulary.reading_context import Known, ReadingContext
from btlang.vocabulary.references import keys_in, keys_set_in
from btlang.vocabulary.trie import longest


class Given:
    """The `keys` that a mission is given; `ends` are the words behind these lines, by their first.

    A line that is meant as one but can't be read has a problem and an end.
    """

    def __init__(self) -> None:
        self.keys: dict[str, None] = {}
        self.ends: dict[int, int] = {}
        self.problems: list[Diagnostic] = []


def untyped(key: str) -> Known:
    """A value of any type, which is only said in braces: a bare word could be anything else."""
    return Known(key, ())


def find_given(text: Words, vocabulary: Lexicon) -> Given:
    """Every line that says which values a mission is given (BT143)."""
    given = Given()
    phrases = [
        [word for word in phrase.split() if word not in vocabulary.articles] for phrase in vocabulary.roles["given"]
    ]
    holding = {phrase[-1] for phrase in phrases}
    if holding.isdisjoint(text.distinct):
        return given
    for _, first, last in statements(text, holding):
        for phrase in phrases:
            at = first + len(phrase)
            if text.words[first:at] == phrase:
                keys = _listed(text, at, last, vocabulary)
                if not keys:
                    span = text.span(first, last)
                    example = f"{vocabulary.word('given')} {{goal}}"
                    given.problems.append(diagnostic("BT143", span, words=span.text, example=example))
                given.keys |= dict.fromkeys(keys)
                given.ends[first] = last
                break
    return given


def _listed(text: Words, at: int, last: int, vocabulary: Lexicon) -> list[str]:
    """The keys of names in braces, with commas or `and` between them; none where anything else stands there."""
    keys: list[str] = []
    while (found := ReadingContext.reference(text, at)) is not None:
        keys.append(found[0])
        at = found[1]
        if at == last:
            return keys
        at += text.words[at] == ","
        joined = longest(vocabulary.trie, text, at, vocabulary.context)
        at = joined.last if joined is not None and joined.meaning.role == "and" else at
        if at == found[1]:
            break
    return []


def find_outputs(text: Words, vocabulary: Lexicon) -> set[str]:
    """The keys of the values that nodes give: `giving {path}`, those that their scripts set, and those in slots of
    phrases that are outputs.
    """
    found = {key for word in text.distinct if word[0] == '"' for key in keys_set_in(word)}
    found.update(_in_phrases(text, vocabulary) if "{" in text.source.text else ())
    firsts = {phrase.split()[0] for phrase in vocabulary.roles["giving"]}
    for at, word in enumerate(text.words) if not firsts.isdisjoint(text.distinct) else ():
        found.update(outputs_at(text, at, vocabulary) if word in firsts else ())
    return found


def _in_phrases(text: Words, vocabulary: Lexicon) -> Iterator[str]:
    writing = [entry for known in vocabulary.entries.values() for entry in known if entry.outputs]
    firsts = {form[0] for entry in writing for phrase in entry.phrases for form in forms(phrase)}
    context = vocabulary.context.with_references()
    for at, word in enumerate(text.words) if not firsts.isdisjoint(text.distinct) else ():
        match = longest(vocabulary.trie, text, at, context) if word in firsts else None
        if match is not None and match.meaning.entry is not None:
            written = [value.text for value in match.values if value.name in match.meaning.entry.outputs]
            yield from (key for text in written for key in keys_in(text) if text == f"{{{key}}}")


def find_arguments(
    text: Words, vocabulary: Lexicon, headers: Collection[Header], subtrees: Collection[str]
) -> Iterator[tuple[int, int, Known]]:
    """What subtrees in quotes get by `do "Talk" with what "hello"`, with the words of the body in which it is known."""
    firsts = {phrase.split()[0] for phrase in vocabulary.roles["do"]}
    quoted = {header.name: header for header in headers if header.is_quoted}
    if not quoted or "{" not in text.source.text or firsts.isdisjoint(text.distinct):
        return
    found: Mapping[str, set[str]] = {name: set() for name in quoted}
    for at, word in enumerate(text.words):
        match = longest(vocabulary.trie, text, at, vocabulary.context) if word in firsts else None
        if match is None or match.meaning.role != "do" or match.meaning.node not in ("", SUBTREE):
            continue
        try:
            read = read_node(text, match.last, match.meaning, vocabulary, subtrees)
        except Unreadable:
            continue
        if read is not None and read[0].id == SUBTREE:
            ports = dict(read[0].ports)
            found.get(ports.pop("ID"), set()).update(ports)
    yield from ((quoted[name].body, quoted[name].last, untyped(key)) for name in found for key in sorted(found[name]))
