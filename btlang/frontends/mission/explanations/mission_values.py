"""What is said of values that a mission names itself: one that isn't known, and a statement that isn't put together."""

from __future__ import annotations

import re
from collections.abc import Iterable

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.explanations.nameless import near_names
from btlang.frontends.mission.symbols.prefixes import span_of
from btlang.text.source import Span
from btlang.text.spelling import nearest
from btlang.text.words import Words
from btlang.vocabulary.lexicon import Lexicon


def misread_head(text: Words, at: int, role: str, vocabulary: Lexicon) -> Diagnostic:
    """BT039 for a statement about a value of the mission that is not put together as one."""
    word, places = vocabulary.word, vocabulary.values.names("place")
    measured = (entry.quantity[0] for entries in vocabulary.entries.values() for entry in entries if entry.quantity)
    examples = {
        "set": f"{word('set')} counter {word('set_to')} 3",
        "increase": f"{word('increase')} counter {word('by')} 1",
        "decrease": f"{word('decrease')} counter {word('by')} 1",
        "add": f"{word('add')} 1 {word('add_to')} counter",
        "subtract": f"{word('subtract')} 1 {word('subtract_from')} counter",
        "remember": f"{word('remember')} {next(measured, 3)} {word('remember_as')} level",
        "each": f"{word('each')} place {word('each_in')} {', '.join(places[:2]) or 'a, b'}: ...",
    }
    span = span_of(text, at)
    return diagnostic("BT039", span, words=span.text, example=examples[role])


def unknown_value(span: Span, key: str, known: Iterable[str]) -> Diagnostic:
    """BT043: a name in braces that no value has."""
    name, names = (key.replace("_", " ").strip(), [other.replace("_", " ").strip() for other in known])
    near = nearest(name, names)
    advice = near_names(near, names) if names else "This mission has no named values yet."
    braces = re.search(r"\{(\s*" + r"[\W_]+".join(map(re.escape, key.split("_"))) + r"\s*)\}", span.text, re.IGNORECASE)
    fix = None
    if near and braces:
        fix = Span(span.source, span.start + braces.start(1), span.start + braces.end(1)), near[0]
    return diagnostic("BT043", span, fix=fix, name=name, help=advice)
