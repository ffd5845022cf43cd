"""All that can be said as items to list: commands, conditions, connectives, and what may stand in braces."""

from __future__ import annotations

import re
from collections.abc import Iterator

from btlang.support.record import Record
from btlang.vocabulary.entry import COMPARISONS, POINT, Entry, Role
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.pattern import Slot, forms
from btlang.vocabulary.value_type import PLACE, ValueType, with_unit

# Commands come first; what packs bring follows, then the words of the language.
_FIRST = ("motion", "navigation", "manipulation", "gestures", "speech", "sensing", "power")
VALUES, WORLD = "values", "the world"
"""Topics of what may stand in braces: numbers with units and lists of names, and the names of the world."""


_SLOT = re.compile(r"\{.*?\}")


class Item(Record):
    """One thing to list. `sort` is "command", "condition", "word" (a connective or form) or "value".

    `ways` are all patterns that stand for it; `names` are further words that ask for it; `details` are lines about
    its slots, its resources and its node. A command that is a `verb` with `roles` is listed with others of its verb.
    """

    topic: str
    sort: str
    ways: tuple[str, ...]
    help: str = ""
    example: str = ""
    names: tuple[str, ...] = ()
    details: tuple[str, ...] = ()
    verb: str = ""
    roles: tuple[Role, ...] = ()

    def words(self) -> frozenset[str]:
        """All words of its patterns and names, in lower case, choices apart."""
        return _words(*self.ways, *self.names)

    def said_words(self) -> frozenset[str]:
        """The same without the slots of words of the language: `{count} times` is nothing about counting."""
        return _words(*(_SLOT.sub("", way) for way in self.ways), *self.names) if self.sort == "word" else self.words()

    def all_words(self) -> frozenset[str]:
        """With those that explain it."""
        return _words(*self.ways, *self.names, self.topic, self.help, *self.details)


def _words(*texts: str) -> frozenset[str]:
    return frozenset(re.findall(r"[^\W_]+(?:'\w+)?", " ".join(texts).lower()))


def items(vocabulary: Lexicon) -> list[Item]:
    """Everything that can be said, by topic and in the order to show it."""
    entries = [entry for entries in vocabulary.entries.values() for entry in entries if entry.phrases]
    commands = [_command(entry, vocabulary) for entry in entries]
    words = [item for role in vocabulary.about if (item := _word(role, vocabulary)) is not None]
    values = [_value(kind, vocabulary) for kind in vocabulary.types.values()]
    found = [*commands, *words, *values]
    first = [topic for topic in _FIRST if any(item.topic == topic for item in commands)]
    last = dict.fromkeys(item.topic for item in (*words, *values))
    packs = [item.topic for item in commands if item.topic not in last]
    order = list(dict.fromkeys((*first, *packs, *last)))
    order.sort(key=(VALUES, WORLD).count)
    return sorted(found, key=lambda item: order.index(item.topic))


def _command(entry: Entry, vocabulary: Lexicon) -> Item:
    sort = "command" if entry.sort == "action" else "condition"
    details = list(_slots(entry, vocabulary))
    ways = entry.phrases
    if entry.measures:
        ways = (f"{entry.quantity[0]} {vocabulary.comparisons['below'][0]}", *entry.quantity[1:])
        said = (_SLOT.sub("", patterns[0]).rstrip() for patterns in vocabulary.comparisons.values())
        details.append(f"compared: {', '.join(said)} {{{entry.measures}}}")
        name = f"{entry.quantity[0]} {vocabulary.word('remember_as')} ..."
        details.append(f"as a value: {vocabulary.word('remember')} {name}, then {{...}} in a text")
    if entry.resources:
        details.append("needs: " + ", ".join(entry.resources))
    details.append(f"node: {entry.id}")
    verbs, roles = entry.verbs[0] if entry.verbs else (("",), ())
    return Item(
        entry.topic or "other", sort, ways, " ".join(entry.help.split()), entry.example, (entry.id,),
        tuple(details), verbs[0], roles,
    )  # fmt: skip


def _slots(entry: Entry, vocabulary: Lexicon) -> Iterator[str]:
    always = [{part.name for part in form if isinstance(part, Slot)} for text in entry.phrases for form in forms(text)]
    for slot in entry.slots[: -len(COMPARISONS)] if entry.measures else entry.slots:
        if slot.name in entry.point_ports:
            continue  # they are said in the slot of the place
        kind = vocabulary.types[slot.type]
        line = f"{{{slot.name}}}: {_described(kind, vocabulary)}"
        if kind.name == PLACE and entry.point_ports:
            facing = "90" if POINT[2] in entry.point_ports else None
            line += f"; or a point: {vocabulary.values.point_text('2', '3', facing)}"
        if slot.default is not None:
            line += f"; {_default(slot.default, kind)} if left out"
        elif not all(slot.name in names for names in always):
            line += "; optional"
        yield line


def _word(role: str, vocabulary: Lexicon) -> Item | None:
    about = vocabulary.about[role]
    counts = tuple(vocabulary.counts) if role == "count" else ()
    ways = (*counts, *vocabulary.roles.get(role, ()))
    if role == "compare":
        return Item(about.topic, "word", _comparisons(vocabulary), about.help, about.example, (role,))
    if not ways:
        return None
    slots = dict.fromkeys(part.name for text in ways for form in forms(text) for part in form if isinstance(part, Slot))
    details = tuple(f"{{{name}}}: {_described(vocabulary.types[name], vocabulary)}" for name in slots)
    if role == "do":
        details += (f"nodes without quotes: {', '.join(vocabulary.nodes.values())}",)
    return Item(about.topic or "other words", "word", ways, about.help, about.example, (role,), details)


def _comparisons(vocabulary: Lexicon) -> tuple[str, ...]:
    return tuple(pattern for patterns in vocabulary.comparisons.values() for pattern in patterns)


def _value(kind: ValueType, vocabulary: Lexicon) -> Item:
    names = tuple(vocabulary.values.said_names(kind.name)) if kind.kind == "names" else ()
    topic = WORLD if kind.kind == "names" and not kind.names else VALUES
    return Item(topic, "value", (f"{{{kind.name}}}",), _described(kind, vocabulary), "", names)


def _described(kind: ValueType, vocabulary: Lexicon) -> str:
    """What a slot of a type takes."""
    if kind.kind == "quantity":
        return f"a number and one of {', '.join(unit.words[0] for unit in kind.units)}"
    if kind.kind == "names":
        return ", ".join(vocabulary.values.said_names(kind.name)) or "nothing in this world"
    if kind.kind == "text":
        return "one word, or more in quotes"
    if kind.kind == "time":
        return f"a time such as {kind.example} or 18:30"
    least = "" if kind.least is None else f" from {kind.least:g} on"
    return ("a whole number" if kind.whole else "a number") + least


def _default(text: str, kind: ValueType) -> str:
    """A port text as a mission would say it: `0.5 m`, `100%`."""
    return with_unit(text, kind.units[0].words[0]) if kind.kind == "quantity" else text
