"""Statements about values of the mission: set, increase, decrease, remember, and the prefix of `for each`."""

from __future__ import annotations

from btlang.frontends.mission.symbols.prefixes import BEFORE_BODY, Prefix
from btlang.frontends.mission.token import Assigned, Each, Remembered, Token
from btlang.frontends.mission.tokens.calls import Calls
from btlang.text.words import Words
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.match import SlotValue
from btlang.vocabulary.reading_context import Known, ReadingContext
from btlang.vocabulary.references import ALL, Choice
from btlang.vocabulary.trie import all_names, longest, reaches_beyond
from btlang.vocabulary.value_type import number_type


def read_statement(
    prefix: Prefix,
    text: Words,
    at: int,
    vocabulary: Lexicon,
    context: ReadingContext,
    calls: Calls,
) -> tuple[Token, int] | None:
    """The token of a statement that starts at a word, and where it ends; None where its value cannot be read."""
    if prefix.role == "each":
        return _each(prefix, text, at, vocabulary, context, calls)
    known = context.known.get(prefix.key) if context.known else None
    if known is None:
        return None
    start = text.starts[at]
    if prefix.role in ("set", "remember"):  # `set level to the battery` remembers, too
        quantity = longest(vocabulary.quantities, text, prefix.value, context)
        entry = quantity.meaning.entry if quantity is not None else None
        if quantity is not None and entry is not None and quantity.last >= prefix.value_end:
            made = Remembered(prefix.key, entry, calls.arguments(entry, quantity.values))
            end = max(prefix.last, quantity.last)
            return Token("command", start, text.ends[end - 1], made), end
    found = _value(prefix, known, text, vocabulary, context)
    if found is None or prefix.value_end not in (-1, found.last):
        return None
    operation = "set" if prefix.role == "remember" else prefix.role
    end = max(prefix.last, found.last)
    made_of = Assigned(prefix.key, operation, found.type, calls.port_text(found))
    return Token("command", start, text.ends[end - 1], made_of), end


def _value(prefix: Prefix, known: Known, text: Words, vocabulary: Lexicon, context: ReadingContext) -> SlotValue | None:
    numbers = prefix.role in ("increase", "decrease")
    named, number = context.named(text, prefix.value) if prefix.value >= 0 else None, number_type(vocabulary.types)
    if named is not None and named[0] is not None:
        kind = _shared(named[0].kinds, known.kinds, number if numbers else _any_type(vocabulary)[0])
        return SlotValue("value", kind, f"{{{named[0].key}}}", prefix.value, named[1]) if kind is not None else None
    for kind in known.kinds or ((number,) if numbers else ()):
        is_number = vocabulary.types[kind].kind in ("quantity", "number")
        if numbers and prefix.value < 0 and vocabulary.types[kind].kind == "number":
            return SlotValue("value", kind, "1", prefix.last, prefix.last)
        value = context.read(kind, text, prefix.value) if prefix.value >= 0 and (is_number or not numbers) else None
        if value is not None:
            return SlotValue("value", kind, value[0], prefix.value, value[1])
    other = (
        context.any(text, prefix.value) if prefix.value >= 0 and not numbers else None
    )  # that it does not fit is reported
    if other is None or (prefix.role == "remember" and other[0] == ("text",) and text.words[prefix.value][0] != '"'):
        return None
    return SlotValue("value", other[0][0], other[1], prefix.value, other[2])


def _shared(kinds: tuple[str, ...], others: tuple[str, ...], either: str) -> str | None:
    """A type that is one of both, where a value without types is of any; `either` where both have none."""
    if kinds and others:
        return next((kind for kind in kinds if kind in others), None)
    return next(iter(kinds or others), either)


def _any_type(vocabulary: Lexicon) -> list[str]:
    """All types, those of names first: a value of any type is said as one of these, without quotes."""
    return sorted(vocabulary.types, key=lambda kind: vocabulary.types[kind].kind != "names")


def _each(
    prefix: Prefix,
    text: Words,
    at: int,
    vocabulary: Lexicon,
    context: ReadingContext,
    calls: Calls,
) -> tuple[Token, int] | None:
    others = {key: known for key, known in (context.known or {}).items() if key != prefix.key}
    inner = ReadingContext(vocabulary.values, others)
    inner.keys = context.keys
    first = inner.any(text, prefix.value)
    kinds = (
        (prefix.key,)
        if prefix.key in vocabulary.types
        else (first[0] or _any_type(vocabulary))
        if first is not None
        else ()
    )
    chosen = (prefix.noun, prefix.last) if prefix.noun is not None else inner.choice(text, prefix.value)
    sets = [chosen] if prefix.noun is not None else [*context.values.groups(text, prefix.value)]
    wide = [way for way in sets if way is not None and text.words[way[1]] in BEFORE_BODY]
    if wide and wide[-1][0].how == ALL and not context.values.likenesses.is_listed(wide[-1][0]):
        meant, last = wide[-1]
        kind = meant.type
        some = Choice(ALL, kind, prefix.key, meant.parts)
        values: tuple[str, ...] = context.values.likenesses.members(some) or (some.text,)
    elif chosen is not None and chosen[0].how == ALL:
        kind = chosen[0].type
        every = all_names(vocabulary.trie, chosen[0], text, prefix.value, chosen[1], inner)
        values = calls.port_text(every), *every.more
        last = every.last
    else:
        lists = [(kind, _listed(kind, text, prefix.value, vocabulary, inner)) for kind in kinds]
        if not lists or not any(found for _, found in lists):
            return None
        kind, found = max(lists, key=lambda one: len(one[1]))
        values = tuple(calls.port_text(value) for value in found)
        last = found[-1].last
    made = Each(prefix.key, kind, values)
    context.latest[kind] = f"{{{prefix.key}}}"
    return Token("each", text.starts[at], text.ends[last - 1], made), last


def _listed(kind: str, text: Words, at: int, vocabulary: Lexicon, context: ReadingContext) -> list[SlotValue]:
    """A list goes on only while a value follows that starts no longer phrase."""
    found: list[SlotValue] = []
    while True:
        value = context.read(kind, text, at)
        bare = kind == "text" and text.words[at][0] != '"' and text.words[at] != "{"
        if value is None or bare or (found and reaches_beyond(vocabulary.trie, text, at, value[1], context)):
            return found
        found.append(SlotValue("value", kind, value[0], at, value[1]))
        at = value[1]
        if text.words[at] == ",":
            at += 1
        joined = longest(vocabulary.trie, text, at, context) if text.words[at] in context.joiners else None
        if joined is not None and joined.meaning.role == "and":
            at = joined.last
        if at == value[1]:
            return found
