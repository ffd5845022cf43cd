"""What is said of words that are a part of a phrase: `turn 90 degrees` (BT012), `the kitchen`, `to the kitchen`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from functools import cache, lru_cache

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.support.record import Record
from btlang.text.formatting import joined
from btlang.text.source import Span
from btlang.text.words import Words
from btlang.vocabulary.entry import Entry
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.pattern import Form, Part, forms
from btlang.vocabulary.reading_context import ReadingContext
from btlang.vocabulary.value_type import TEXT

_ValueAt = Callable[[str, int], "tuple[str, int] | None"]  # what ReadingContext.read finds in the text
_MOST_MISSING, _LONGEST, _MOST_OFFERED = 3, 8, 3


class _Gap(Record):
    """A phrase whose words `missing` were left out: what is before them, and what is behind."""

    before: Form
    missing: tuple[str, ...]
    behind: Form
    entry: Entry

    @property
    def said(self) -> Form:
        """What is left of the phrase."""
        return (*self.before, *self.behind)


def explain_fragment(
    text: Words, at: int, end: int, is_condition: bool, vocabulary: Lexicon, context: ReadingContext
) -> Diagnostic | None:
    """A diagnostic for words `at` to `end` that a phrase has beside others, None where there is no such phrase."""
    sort = "condition" if is_condition else "action"
    all_found = _found(text, at, end, vocabulary, context)
    found = [each for each in all_found if each[0].entry.sort == sort and not each[0].entry.constrains]
    if not found:
        return None
    span, whole = text.span(at, end), _with_article(text, at, end)
    inside = [each for each in found if each[0].before and _is_telling(each[0])]
    if inside:
        place = max(place for _, place in inside)
        fewest = min(len(gap.missing) for gap, other in inside if other == place)
        same = [gap for gap, other in inside if other == place and len(gap.missing) == fewest]
        by_id = {gap.entry.id: " ".join(gap.missing) for gap in reversed(same)}  # the first of each
        wanted = list(dict.fromkeys(reversed(by_id.values())))[:_MOST_OFFERED]
        head, rest = text.span(at, place).text, text.source.text[text.ends[place - 1] : span.end].strip()
        listed = joined([f"'{words}'" for words in wanted], "or")
        examples = (f"{head} {words} {rest}".strip() for words in wanted)
        return diagnostic("BT012", text.span(at, place), words=head, wanted=listed, example=", or: ".join(examples))
    found = [each for each in found if not each[0].before]
    if not found:
        return None
    ways = Counter(gap.entry.id for gap, _ in found)  # what can be said in most ways is what people say most
    gaps = [gap for gap, _ in found]
    of_entry = {each: [gap.missing for gap in gaps if gap.entry.id == each] for each in ways}
    shortest = {each: min(words, key=len) for each, words in of_entry.items()}
    offered = sorted(shortest, key=lambda node_id: -ways[node_id])[:_MOST_OFFERED]
    example = ", or: ".join(f"{' '.join(shortest[node_id])} {whole.text}" for node_id in offered)
    is_value = all(not isinstance(part, str) for part in found[0][0].said)
    return diagnostic("BT019" if is_value else "BT154", span, words=span.text, example=example)


def _is_telling(gap: _Gap) -> bool:
    """Whether what is left of a phrase hardly belongs to another one: `pick the cup`, but not `back` of `back up`."""
    words = sum(isinstance(part, str) for part in gap.said)
    return 0 < words < len(gap.said) or words > len(gap.missing)


def stopped(span: Span, vocabulary: Lexicon) -> Diagnostic:
    """BT152 for `stop waving`."""
    reason = "when it is reached, the command before it has ended"
    advice = f"To end a command early, say so behind it: ... {vocabulary.word('stop_when')} ..."
    return diagnostic("BT152", span, words=span.text, reason=reason, advice=advice)


def _with_article(text: Words, at: int, end: int) -> Span:
    return Span(text.source, text.begin(at), text.ends[end - 1])


def _found(text: Words, at: int, end: int, vocabulary: Lexicon, context: ReadingContext) -> Iterator[tuple[_Gap, int]]:
    """The phrases that have the words, each with the word before which others were left out."""
    kinds = (name for name, kind in vocabulary.types.items() if kind.kind != "text")  # any word is a text
    value_at = cache(lambda kind, place: context.read(kind, text, place))  # many phrases ask for the same
    values = (f"{{{kind}}}" for kind in kinds if value_at(kind, at) is not None)
    for start in (text.words[at], *values):
        for gap in _gaps(vocabulary, start):
            place = _read(gap.before, gap.entry, text, at, value_at)
            if place is not None and _read(gap.behind, gap.entry, text, place, value_at) == end:
                yield gap, place


def _read(parts: Form, entry: Entry, text: Words, at: int, value_at: _ValueAt) -> int | None:
    """The word behind these parts of a phrase, None where they aren't there."""
    for part in parts:
        if isinstance(part, str):
            if text.words[at] != part:
                return None
            at += 1
        else:
            kind = entry.slot(part.name).type
            value = value_at(kind, at)
            if value is None or (kind == TEXT and text.words[at][0] != '"'):
                return None  # any word is a text
            at = value[1]
    return at


@lru_cache(maxsize=256)  # a text full of unknown words asks for some again and again
def _gaps(vocabulary: Lexicon, start: str) -> list[_Gap]:
    """The phrases without some of their words that begin with a word then, or with a slot of a type."""
    return [
        gap
        for entries in vocabulary.entries.values()
        for entry in entries
        for form in _forms(entry, start, vocabulary)
        for gap in _without_words(entry, form, start)
    ]


def _without_words(entry: Entry, form: Form, start: str) -> Iterator[_Gap]:
    """A phrase without some of its words side by side, where it begins with a word or slot then."""
    for first in range(len(form) if _is(form[0], start, entry) else 1):
        for last in range(first + 1, min(first + _MOST_MISSING, len(form)) + 1):
            missing = [part for part in form[first:last] if isinstance(part, str)]
            if len(missing) < last - first or last - first == len(form):
                break
            if first or _is(form[last], start, entry):
                yield _Gap(form[:first], tuple(missing), form[last:], entry)


def _is(part: Part, start: str, entry: Entry) -> bool:
    """Whether a part of a phrase is that word, or a slot of that type."""
    return start == (part if isinstance(part, str) else f"{{{entry.slot(part.name).type}}}")


def _forms(entry: Entry, start: str, vocabulary: Lexicon) -> Iterator[Form]:
    """The ways to say the phrases of an entry that may have the start: only these are worth to be expanded."""
    is_slot = start[0] == "{"
    if is_slot and all(slot.type != start[1:-1] for slot in entry.slots):
        return
    for phrase in entry.phrases:
        if is_slot or start in phrase:
            yield from (form for form in forms(phrase, vocabulary.articles) if len(form) <= _LONGEST)
