"""How names, places and values of a mission are said; `sentence.py` has the other forms.

Most of it is marks, in which no phrase of the vocabulary is looked for.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from btlang.printer.exact import quoted
from btlang.printer.phrase import value_of
from btlang.printer.pieces import CLOSE, COLON, COMMA, OPEN, Piece, mark
from btlang.printer.printer import THEN, WHOLE, Doc, Printer
from btlang.tree import ast
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.pattern import Form, Slot, forms
from btlang.vocabulary.value_type import PLACE, WORLD, format_number


def compared(node: ast.Compared, _parts: list[Doc], printer: Printer) -> Doc:
    """The name is in braces: a bare one could be the start of a phrase."""
    ports = {port: printer.value(text, node.kind) for port, text in node.arguments}
    form = next(
        form
        for form in printer.vocabulary.comparing_forms(node.kind)
        if {part.name for part in form if isinstance(part, Slot)} == ports.keys()
    )
    return _unread(" ".join((f"{{{node.key}}}", *filled(form, ports))))


def assign(node: ast.Assign, _parts: list[Doc], printer: Printer) -> Doc:
    word, joint = printer.vocabulary.word(node.operation), "set_to" if node.operation == "set" else "by"
    value = printer.plain_value(node.text, node.kind)
    return _unread(f"{word} {spelt(node.key, printer.vocabulary)} {printer.vocabulary.word(joint)} {value}")


def remember(node: ast.Remember, _parts: list[Doc], printer: Printer) -> Doc:
    types = {slot.name: slot.type for slot in node.entry.slots}
    ports = {name: printer.value(text, types[name]) for name, text in node.arguments}
    ways = (form for pattern in node.entry.quantity for form in reversed(forms(pattern)))
    form = next(f for f in ways if {part.name for part in f if isinstance(part, Slot)} == ports.keys())
    quantity = " ".join(filled(form, ports))
    joint = printer.vocabulary.word("remember_as")
    return _unread(f"{printer.vocabulary.word('remember')} {quantity} {joint} {spelt(node.key, printer.vocabulary)}")


def for_each(node: ast.ForEach, parts: list[Doc], printer: Printer) -> Doc:
    return printer.before((*each_head(node, printer), mark(COLON)), parts[0])


def each_head(node: ast.ForEach, printer: Printer) -> Iterator[Piece]:
    """`for each place in lab, dock`: marks, as no phrase is looked for in it."""
    word = printer.vocabulary.word
    values = ", ".join(printer.plain_value(text, node.kind) for text in node.values)
    yield mark(f"{word('each')} {spelt(node.key, printer.vocabulary)} {_each_in(node, printer.vocabulary)} {values}")


def _each_in(node: ast.ForEach, vocabulary: Lexicon) -> str:
    """The words before the values; before one thing none that describe it, as `for each cup in kitchen` would."""
    if len(node.values) > 1 or node.kind == PLACE or node.kind not in WORLD:
        return vocabulary.word("each_in")
    describing = vocabulary.values.modifiers.starts
    ways = (words for words in vocabulary.roles["each_in"] if words.split()[0] not in describing)
    return next(ways, vocabulary.word("each_in"))


def filled(form: Form, values: Mapping[str, str]) -> Iterator[str]:
    """The words of a form with values in its slots."""
    return (values[part.name] if isinstance(part, Slot) else part for part in form)


def spelt(key: str, vocabulary: Lexicon) -> str:
    """The key of a value as words; as one word where it holds one that would end the name."""
    ends = {
        phrase.split()[0] for role in ("set_to", "by", "remember_as", "each_in") for phrase in vocabulary.roles[role]
    }
    return key if ends.intersection(key.split("_")) else key.replace("_", " ").strip()


def definition(node: ast.Definition, parts: list[Doc], printer: Printer) -> Doc:
    """In the strong word, which no other word of the line can overrule."""
    return Doc((*definition_head(node, printer), parts[0].pieces), THEN)


def definition_head(node: ast.Definition, printer: Printer) -> tuple[Piece, Piece]:
    """The name and the word that defines."""
    name = quoted(node.name, printer.vocabulary) if node.is_quoted else node.name
    return mark(name), mark(printer.word("define_strong").text)


def fact(node: ast.Fact, _parts: list[Doc], printer: Printer) -> Doc:
    x, y = (mark(format_number(metres)) for metres in (node.x, node.y))
    place = (mark(node.name), mark(printer.word("fact").text), mark(OPEN), x, mark(COMMA), y, mark(CLOSE))
    if node.facing is None:
        return Doc(place, THEN)
    angle = value_of(format_number(node.facing), printer.vocabulary.types["angle"], printer.vocabulary)
    return Doc((*place, mark(printer.word("facing").text), mark(angle)), THEN)


def include(node: ast.Include, _parts: list[Doc], printer: Printer) -> Doc:
    return Doc((mark(printer.vocabulary.word("include")), mark(f'"{node.path}"')), THEN)


def _unread(text: str) -> Doc:
    """What no phrase of the vocabulary is looked for in."""
    return Doc((mark(text),), WHOLE)
