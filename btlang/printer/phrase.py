"""Phrases of leaves, in the first words that a keyword entry offers and that are read back as the same leaf."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from btlang.text.source import PythonSource, Source, Span
from btlang.text.words import split
from btlang.tree.catalogue import SUBTREE
from btlang.tree.dump import describe_node
from btlang.tree.node import Node
from btlang.vocabulary.entry import FOUND, MEASURED, POINT, Entry
from btlang.vocabulary.lexicon import DEFINING, Lexicon
from btlang.vocabulary.pattern import Form, Slot, forms, name_form
from btlang.vocabulary.reading_context import Known
from btlang.vocabulary.references import choice_by, choice_of, keys_in
from btlang.vocabulary.trie import TrieNode, longest
from btlang.vocabulary.value_type import PLACE, ValueType, with_unit

MARKUP = ("<", '"')  # what XML and JSON begin with, and no sentence


def phrase_of(node: Node, vocabulary: Lexicon) -> str:
    """Return the English of a node: `move forward 2 m`, `wait 5 s`, the name of a subtree; else `Id port=value`.

    What works with values of the mission is shown as it was written.
    """
    if node.id == SUBTREE:
        return _fill_name(node)
    if node.span is not None and is_written(node) and is_sentence(node.span):
        return node.span.text
    if node.id in ("Choose", "ChooseAll"):
        return vocabulary.values.choice_words(choice_by(dict(node.ports)))
    if node.id == "Sleep":
        return f"{vocabulary.word('wait')} {seconds(node.port('msec'))}"
    if node.id == "WaitForTime":
        return f"{vocabulary.word('wait_time')} {node.port('time')}"
    if node.id in ("AlwaysSuccess", "AlwaysFailure"):
        return vocabulary.word("nothing" if node.id == "AlwaysSuccess" else "fail")
    return leaf_words(node.id, dict(node.ports), vocabulary) or describe_node(node)


def is_sentence(span: Span) -> bool:
    """Whether the text of a node is English: not XML, JSON or Python."""
    return span.text[:1] not in MARKUP and not isinstance(span.source, PythonSource)


def is_written(node: Node) -> bool:
    """Whether its words are those of the text that it came from: its ports don't say them."""
    computed = node.id in ("Script", "ScriptCondition") or any(text.startswith("{_") for _, text in node.ports)
    return computed or bool(node.port(MEASURED))


def _fill_name(node: Node) -> str:
    """Return the name of a subtree with its arguments in place of its parameters."""
    ports = dict(node.ports)
    parts = name_form(node.port("ID"))
    return " ".join(ports.get(part.name, f"{{{part.name}}}") if isinstance(part, Slot) else part for part in parts)


def seconds(msec: str) -> str:
    """Return milliseconds of a port as seconds."""
    return f"{int(msec) / 1000:g} s" if msec.isdigit() else msec


def leaf_words(
    node_id: str,
    ports: Mapping[str, str],
    vocabulary: Lexicon,
    names: TrieNode | None = None,
    *,
    exactly: bool = False,
) -> str:
    """Return the phrase of a leaf with these ports, "" if no phrase of it has just these slots.

    Preferred is one that is read back as the leaf where `names` are defined; with `exactly` no other will do. A port
    may hold its default.
    """
    first = ""
    for entry in vocabulary.entries.get(node_id, ()):
        spoken = {name: text for name, text in ports.items() if _default(entry, name) != text}
        if not exactly and FOUND in entry.outputs:
            spoken.pop(FOUND, None)  # the thing is said already
        spoken = _with_point(entry, spoken, vocabulary)
        types = {slot.name: vocabulary.types[slot.type] for slot in entry.slots}
        if not spoken.keys() <= types.keys():
            continue
        keys = {name: keys[0] for name, text in spoken.items() if text[:1] == "{" and (keys := list(keys_in(text)))}
        if keys and vocabulary.context.known is None:  # each value is of the type of its slot
            typed = {key: Known(key, tuple(key.split("_")), (types[name].name,)) for name, key in keys.items()}
            vocabulary = vocabulary.with_known(typed)
        said = {name: _read_back_value(text, types[name], vocabulary) for name, text in spoken.items()}
        if exactly and not all(said.values()):
            continue  # nor is it read back in any phrase
        for form, values in _find_forms(entry, spoken):
            for name, text in values.items():
                said[name] = said.get(name) or value_of(text, types[name], vocabulary)
            words = " ".join(said[part.name] if isinstance(part, Slot) else part for part in form)
            if _reads_back(words, entry, spoken, vocabulary, names):
                return words
            first = first or words
    return first if not exactly else ""


def _with_point(entry: Entry, spoken: dict[str, str], vocabulary: Lexicon) -> dict[str, str]:
    """Return the ports of a point as one value in the slot of a place."""
    place = next((slot.name for slot in entry.slots if slot.type == PLACE), None)
    if place is None or not entry.point_ports or not spoken.keys() >= {"x", "y"} or place in spoken:
        return spoken
    rest = {name: text for name, text in spoken.items() if name not in POINT}
    return rest | {place: vocabulary.values.point_text(spoken["x"], spoken["y"], spoken.get("facing"))}


def _default(entry: Entry, slot: str) -> str | None:
    return next((known.default for known in entry.slots if known.name == slot), None)


def _find_forms(entry: Entry, spoken: Mapping[str, str]) -> Iterator[tuple[Form, Mapping[str, str]]]:
    """Yield the forms that say the values, the shortest of each phrase first; those that say a default too come
    last.
    """
    defaults = {slot.name: slot.default for slot in entry.slots if slot.default is not None}
    wordy: list[tuple[Form, Mapping[str, str]]] = []
    for phrase in entry.phrases:
        for form in reversed(forms(phrase)):
            slots = {part.name for part in form if isinstance(part, Slot)}
            if slots == spoken.keys():
                yield form, spoken
            elif spoken.keys() < slots <= spoken.keys() | defaults.keys():
                wordy.append((form, {**defaults, **spoken}))
    yield from wordy


def _reads_back(
    words: str, entry: Entry, spoken: Mapping[str, str], vocabulary: Lexicon, names: TrieNode | None
) -> bool:
    text = split(Source(words), vocabulary.orthography)
    match = longest(vocabulary.trie, text, 0, vocabulary.context)
    if match is None or match.meaning.entry is None or match.meaning.role == "negated":
        return False
    if match.last != len(text.words) - 2 or match.meaning.entry.id != entry.id:
        return False
    if {value.name: value.text for value in match.values if _default(entry, value.name) != value.text} != spoken:
        return False
    named = longest(names, text, 0, vocabulary.context) if names else None
    return named is None or named.last < match.last


def value_of(text: str, kind: ValueType, vocabulary: Lexicon) -> str:
    """Return a port text as a user would say it: `2 m`, `20%`, `hello`, `"two words"`.

    A text that could be taken for something else is quoted.
    """
    return _read_back_value(text, kind, vocabulary) or _ways(text, kind, vocabulary)[0]


def _read_back_value(text: str, kind: ValueType, vocabulary: Lexicon) -> str:
    """Return the first way to say a text that is read back as it, "" if there is none."""
    ways = _ways(text, kind, vocabulary)
    if len(ways) == 1:
        return ways[0]
    if kind.kind == "names" and text[:1] != "(" and text not in vocabulary.values.listed(kind.name):
        return ""  # no words of a vocabulary mean it
    return next((way for way in ways if vocabulary.value(kind.name, way) == text), "")


def _ways(text: str, kind: ValueType, vocabulary: Lexicon) -> list[str]:
    """List the ways to say a text, the most natural first."""
    choice = choice_of(text) if text.startswith("{") else None
    if choice is not None:
        return [vocabulary.values.choice_words(choice)]
    if text.startswith("{") and kind.kind != "text":
        return [text]
    if kind.kind == "quantity":
        return [with_unit(text, kind.units[0].words[0])]
    if kind.kind in ("number", "time"):
        return [text]
    ways = [f'"{text}"', f"'{text}'"]
    if kind.kind == "names":
        return [vocabulary.values.spoken(kind.name, text), text, *ways]
    return ways if _says_more(text, vocabulary) else [text, *ways]


def _says_more(text: str, vocabulary: Lexicon) -> bool:
    """Whether a bare word would be more than a text: an article, a judgment, or the begin of a phrase or definition."""
    word = text.lower()
    defines = any(word in vocabulary.roles[role] for role in DEFINING)
    is_more = word in vocabulary.articles or word in vocabulary.asking["judged"] or word in vocabulary.trie
    return not text.isalnum() or defines or is_more


def holds_definer(words: str, vocabulary: Lexicon) -> bool:
    """Whether a phrase or name holds a word that would define at the start of a line, and is no condition."""
    text = split(Source(words), vocabulary.orthography)
    choices = {word for role in DEFINING for word in vocabulary.roles[role]}
    definers = {at for at, word in enumerate(text.words) if word in choices}
    if not definers:
        return False
    match = longest(vocabulary.trie, text, 0, vocabulary.context)
    if match is not None and definers <= match.nouns:
        return False
    return match is None or match.meaning.role != "condition" or match.last < len(text.words) - 2
