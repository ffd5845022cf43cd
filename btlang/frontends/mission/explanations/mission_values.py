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
from btlang.vocabulary.pattern import forms


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


def unknown_value(span: Span, key: str, known: Iterable[str], vocabulary: Lexicon) -> Diagnostic:
    """BT043: a name in braces that no value has, maybe because a quantity has it."""
    name, names = (key.replace("_", " ").strip(), [other.replace("_", " ").strip() for other in known])
    near = nearest(name, names)
    advice = near_names(near, names) if names else "This mission has no named values yet."
    if not near and (measured := _measured(name, vocabulary, whole=bool(names))):
        value = measured.split()[-1] if " " in measured else "level"
        remembered = f"{vocabulary.word('remember')} {measured} {vocabulary.word('remember_as')} {value}"
        advice = f"'{measured}' is measured. Write before it: {remembered}. Then {{{value}}} is its value here."
    braces = re.search(r"\{(\s*" + r"[\W_]+".join(map(re.escape, key.split("_"))) + r"\s*)\}", span.text, re.IGNORECASE)
    fix = None
    if near and braces:
        fix = Span(span.source, span.start + braces.start(1), span.start + braces.end(1)), near[0]
    return diagnostic("BT043", span, fix=fix, name=name, help=advice)


def _measured(name: str, vocabulary: Lexicon, whole: bool) -> str:
    """Return the quantity of this name, or without `whole` the shortest one that has its words; "" for none."""
    wanted = [word for word in name.split() if word not in vocabulary.articles]
    patterns = (way for found in vocabulary.entries.values() for entry in found for way in entry.quantity)
    said = [form for way in patterns for form in forms(way, vocabulary.articles)]
    spoken = [form for form in said if all(isinstance(part, str) for part in form) and set(wanted) <= set(form)]
    fitting = [form for form in spoken if list(form) == wanted] or ([] if whole else spoken)
    return " ".join(map(str, min(fitting, key=lambda form: len(tuple(form)), default=())))
