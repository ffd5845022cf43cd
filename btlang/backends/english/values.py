"""What sets, compares and measures values of the mission, as proposals; see raised.py."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from btlang.backends.english.candidate import Checked
from btlang.backends.english.code import compared_by, given_by
from btlang.backends.english.type_inference import readable
from btlang.text.source import NOWHERE
from btlang.tree import ast
from btlang.tree.node import Node
from btlang.vocabulary.entry import MEASURED, Entry
from btlang.vocabulary.pattern import Form, Slot, forms
from btlang.vocabulary.references import choice_by, keys_in
from btlang.vocabulary.value_type import WORLD


def assigned(node: Node, checked: Checked) -> Iterator[ast.Ast]:
    """A Script as `set`, `increase` and `decrease`."""
    given = given_by(node.port("code"), checked.texts)
    is_set = given is not None and given.operation == "set" and given.key not in checked.around.outside
    if given is not None and (is_set or given.operation in ("increase", "decrease")):
        kind = checked.around.kinds.get(given.key)
        if kind is not None and can_say(given.text, kind, checked):
            yield ast.Assign(given.key, given.operation, kind, given.text, NOWHERE)


def chosen(node: Node, checked: Checked) -> Iterator[ast.Ast]:
    """A name that is chosen for a key of the mission's own."""
    key, kind = node.port("output")[1:-1], node.port("type")
    if key in checked.around.kinds and key not in checked.around.outside and kind in WORLD:
        choice = choice_by(dict(node.ports)).replace(key=checked.around.vocabulary.context.keys[kind])
        yield ast.Assign(key, "set", kind, choice.text, NOWHERE)


def compared(node: Node, checked: Checked) -> Iterator[ast.Ast]:
    """A ScriptCondition."""
    found = compared_by(node.port("code"), checked.texts)
    kind = checked.around.kinds.get(found.key) if found is not None else None
    if found is None or kind is None or not all(can_say(text, kind, checked) for _, text in found.arguments):
        return
    ways = checked.around.vocabulary.comparing_forms(kind)
    if _first(ways, found.arguments) == [way for way, _ in found.arguments]:
        yield ast.Compared(found.key, kind, found.arguments, NOWHERE)


def remembered(node: Node, entries: Iterable[Entry], checked: Checked) -> Iterator[ast.Ast]:
    """A quantity that is measured for a key."""
    key = node.port(MEASURED)[1:-1]
    if key not in checked.around.kinds or key in checked.around.outside or node.port(MEASURED) != f"{{{key}}}":
        return
    arguments = texts_of([port for port in node.ports if port[0] != MEASURED], checked)
    for entry in entries:
        ways = (form for pattern in entry.quantity for form in reversed(forms(pattern)))
        types = {slot.name: slot.type for slot in entry.slots}
        if arguments is not None and entry.measures and _first(ways, arguments) is not None:
            if all(can_say(text, types[name], checked) for name, text in arguments):
                yield ast.Remember(key, entry, arguments, NOWHERE)


def texts_of(ports: Iterable[tuple[str, str]], checked: Checked) -> tuple[tuple[str, str], ...] | None:
    """Ports as arguments of syntax, None where one cannot be said."""
    found = [(name, checked.text(text)) for name, text in ports]
    said = tuple((name, text) for name, text in found if text is not None)
    return said if len(said) == len(found) else None


def can_say(text: str, kind: str, checked: Checked) -> bool:
    """Whether a port text is read back as a value of a type."""
    around = checked.around
    return all(key in around.kinds for key in keys_in(text)) and readable(text, kind, around.vocabulary)


def _first(ways: Iterable[Form], arguments: tuple[tuple[str, str], ...]) -> list[str] | None:
    """The slots of the first form that has just these."""
    names = {name for name, _ in arguments}
    for form in ways:
        slots = [part.name for part in form if isinstance(part, Slot)]
        if set(slots) == names:
            return slots
    return None
