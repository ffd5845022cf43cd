"""How names, places and values of a mission are said; `sentence.py` has the other forms.

Most of it is marks, in which no phrase of the vocabulary is looked for.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from btlang.english.exact import quoted
from btlang.english.phrase import value_of
from btlang.english.pieces import CLOSE, COLON, COMMA, OPEN, Piece, mark
from btlang.english.speaker import THEN, WHOLE, Said, Speaker
from btlang.tree import ast
from btlang.vocabulary.pattern import Form, Slot, forms
from btlang.vocabulary.values import format_number
from btlang.vocabulary.vocabulary import Vocabulary


def compared(node: ast.Compared, _parts: list[Said], speaker: Speaker) -> Said:
    """The name is in braces: a bare one could be the start of a phrase."""
    ports = {port: speaker.value(text, node.kind) for port, text in node.arguments}
    form = next(
        form
        for form in speaker.vocabulary.comparing_forms(node.kind)
        if {part.name for part in form if isinstance(part, Slot)} == ports.keys()
    )
    return _unread(" ".join((f"{{{node.key}}}", *filled(form, ports))))


def assign(node: ast.Assign, _parts: list[Said], speaker: Speaker) -> Said:
    word, joint = speaker.vocabulary.word(node.operation), "set_to" if node.operation == "set" else "by"
    value = speaker.plain_value(node.text, node.kind)
    return _unread(f"{word} {spelt(node.key, speaker.vocabulary)} {speaker.vocabulary.word(joint)} {value}")


def remember(node: ast.Remember, _parts: list[Said], speaker: Speaker) -> Said:
    types = {slot.name: slot.type for slot in node.entry.slots}
    ports = {name: speaker.value(text, types[name]) for name, text in node.arguments}
    ways = (form for pattern in node.entry.quantity for form in reversed(forms(pattern)))
    form = next(f for f in ways if {part.name for part in f if isinstance(part, Slot)} == ports.keys())
    quantity = " ".join(filled(form, ports))
    joint = speaker.vocabulary.word("remember_as")
    return _unread(f"{speaker.vocabulary.word('remember')} {quantity} {joint} {spelt(node.key, speaker.vocabulary)}")


def for_each(node: ast.ForEach, parts: list[Said], speaker: Speaker) -> Said:
    return speaker.before((*each_head(node, speaker), mark(COLON)), parts[0])


def each_head(node: ast.ForEach, speaker: Speaker) -> Iterator[Piece]:
    """`for each place in lab, dock`: marks, as no phrase is looked for in it."""
    word = speaker.vocabulary.word
    values = ", ".join(speaker.plain_value(text, node.kind) for text in node.values)
    yield mark(f"{word('each')} {spelt(node.key, speaker.vocabulary)} {word('each_in')} {values}")


def filled(form: Form, values: Mapping[str, str]) -> Iterator[str]:
    """The words of a form with values in its slots."""
    return (values[part.name] if isinstance(part, Slot) else part for part in form)


def spelt(key: str, vocabulary: Vocabulary) -> str:
    """The key of a value as words; as one word where it holds one that would end the name."""
    ends = {
        phrase.split()[0] for role in ("set_to", "by", "remember_as", "each_in") for phrase in vocabulary.roles[role]
    }
    return key if ends.intersection(key.split("_")) else key.replace("_", " ").strip()


def definition(node: ast.Definition, parts: list[Said], speaker: Speaker) -> Said:
    """In the strong word, which no other word of the line can overrule."""
    return Said((*definition_head(node, speaker), parts[0].pieces), THEN)


def definition_head(node: ast.Definition, speaker: Speaker) -> tuple[Piece, Piece]:
    """The name and the word that defines."""
    name = quoted(node.name, speaker.vocabulary) if node.is_quoted else node.name
    return mark(name), mark(speaker.word("define_strong").text)


def fact(node: ast.Fact, _parts: list[Said], speaker: Speaker) -> Said:
    x, y = (mark(format_number(metres)) for metres in (node.x, node.y))
    place = (mark(node.name), mark(speaker.word("fact").text), mark(OPEN), x, mark(COMMA), y, mark(CLOSE))
    if node.facing is None:
        return Said(place, THEN)
    angle = value_of(format_number(node.facing), speaker.vocabulary.types["angle"], speaker.vocabulary)
    return Said((*place, mark(speaker.word("facing").text), mark(angle)), THEN)


def include(node: ast.Include, _parts: list[Said], speaker: Speaker) -> Said:
    return Said((mark(speaker.vocabulary.word("include")), mark(f'"{node.path}"')), THEN)


def _unread(text: str) -> Said:
    """What no phrase of the vocabulary is looked for in."""
    return Said((mark(text),), WHOLE)
