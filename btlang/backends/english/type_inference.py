"""Type inference for the values of a tree, from where the values stand, and from what is given to them.

A value is a key and its owner: "" for the whole mission, else the subtree whose parameter it is.
"""

from __future__ import annotations

from collections.abc import Container, Mapping, Set

from btlang.backends.english.code import Computed, Loop, read_comparison, read_computed, read_given
from btlang.frontends.mission.symbols.given import untyped
from btlang.frontends.mission.symbols.prefixes import find_prefixes
from btlang.printer.phrase import value_of
from btlang.printer.sentence import spell_key
from btlang.support.record import Record
from btlang.text.source import Source
from btlang.text.words import split
from btlang.tree.catalogue import CATALOGUE, SUBTREE
from btlang.tree.node import Node
from btlang.vocabulary.entry import MEASURED
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.pattern import Slot, name_form
from btlang.vocabulary.reading_context import Known, ReadingContext
from btlang.vocabulary.references import Reference, choice_of, free_key, pieces
from btlang.vocabulary.value_type import TEXT, WORLD, number_type

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    Value: TypeAlias = tuple[str, str]


_TYPES = {"rounds": "count", "time of day": "time_of_day"}
"""Those of values in ports with such units."""


class KnownTypes(Record):
    """The facts that are known at a place: the types of values by key, with a vocabulary that knows them, too.

    `owners` are those of the keys that are not of the whole mission, `outside` the keys that nothing sets that is said.
    """

    owners: Mapping[str, str]
    kinds: Mapping[str, str]
    vocabulary: Lexicon
    outside: Set[str] = frozenset()


def parameters(name: str) -> tuple[str, ...]:
    """Return the parameters of the name of a subtree."""
    return tuple(part.name for part in name_form(name) if isinstance(part, Slot))


class TypeInference:
    """The types of all values in some trees, each with the owners of its local keys.

    `names` are the subtrees whose parameters have a value of their own, `refused` keys of the whole mission that are
    not to be said, `unset` those that nothing sets though a node does; None for all.
    """

    def __init__(
        self,
        vocabulary: Lexicon,
        names: Container[str],
        loops: Mapping[int, Loop],
        refused: Container[str],
        unset: Container[str] | None = (),
    ) -> None:
        self._vocabulary, self._names, self._loops, self._refused = vocabulary, names, loops, refused
        self._unset = unset
        self._set: set[str] = set()  # keys that are given values
        self._chosen: set[str] = set()  # keys of names that the robot chooses for a command
        self._groups: dict[Value, list[Value]] = {}  # those of one type, by each of them that was joined to no other
        self._joined: dict[Value, Value] = {}
        self._given: list[tuple[Value, Value]] = []  # what is given another value
        self._needs: dict[Value, set[str]] = {}
        self._sorts: dict[Value, set[bool]] = {}  # whether scripts work with it as a number
        self._texts: dict[Value, list[str]] = {}
        self._kinds: dict[Value, str | None] = {}
        self._around: dict[tuple[tuple[str, str], ...], KnownTypes] = {}

    def around(self, owners: Mapping[str, str]) -> KnownTypes:
        """Return what is known where these keys have owners; after all trees were read."""
        place = tuple(owners.items())
        if place not in self._around:
            values = {key: ("", key) for owner, key in self._groups if not owner and key not in self._refused}
            outside = frozenset(key for key in values if key not in owners and self._is_outside(key))
            values |= {key: (owner, key) for key, owner in owners.items()}
            inside = [(key, value) for key, value in values.items() if key not in outside]
            kinds = {key: kind for key, value in inside if (kind := self.kind(value)) is not None}
            known = {key: Known(key, tuple(key.split("_")), (kind,)) for key, kind in kinds.items()}
            known |= {key: untyped(key) for key in outside}
            number = number_type(self._vocabulary.types)
            kinds |= {key: number if self._sorts.get(("", key)) == {True} else TEXT for key in outside}
            vocabulary = self._vocabulary.with_known(known)
            taken = self._set | {key for owner, key in self._groups if owner}
            vocabulary.context.keys = {kind: free_key(kind, taken) for kind in WORLD}
            self._around[place] = KnownTypes(owners, kinds, vocabulary, outside)
        return self._around[place]

    def kind(self, value: Value) -> str | None:
        """Return the type of a value, None if it can have none, or its name can't be said."""
        if not self._kinds:
            for one, other in self._given:
                self._join(self._first(one), self._first(other))
            for one, first in [(one, self._first(one)) for one in self._groups]:
                self._kinds[one] = self._common(self._groups[first]) if self._is_name(one[1]) else None
        return self._kinds.get(value, "text")

    # -- reading

    def read(self, root: Node, owners: Mapping[str, str]) -> None:
        """Note what a tree shows about values."""
        stack = [(root, owners)]
        while stack:
            node, own = stack.pop()
            loop = self._loops.get(id(node))
            if loop is not None:
                for one in loop.rounds:
                    self._give((loop.name, loop.key), dict(one.node.ports)[loop.key], own, one.texts)
                self._type_by_name((loop.name, loop.key))
                stack.append((loop.body, {**own, loop.key: loop.name}))
                continue
            made = read_computed(node)
            if made is not None:
                self._leaf(made, own)
                stack += [(child, own) for child in made.node.children]
            else:
                self._leaf(Computed(node, {}), own)
                stack += [(child, own) for child in node.children]
        for key, owner in owners.items():
            self._type_by_name((owner, key))

    def _leaf(self, made: Computed, own: Mapping[str, str]) -> None:
        node, texts = made.node, made.texts
        kind = CATALOGUE.get(node.id)
        for text in texts.values():
            self._mention(text, own)
            choice = choice_of(text)
            self._chosen.update([choice.key] if choice is not None else ())
        for key in made.times:
            self._need(texts[key], "duration", own)
        if node.id == "Script" and (given := read_given(node.port("code"), texts)) is not None:
            value = self._value(given.key, own)
            self._set.add(given.key)
            self._sort(value, given.is_number)
            self._give(value, given.text, own, {}, given.is_number)
            if given.operation == "time":
                self._need(given.text, "duration", own)
        elif node.id == "ScriptCondition" and (found := read_comparison(node.port("code"), texts)) is not None:
            value = self._value(found.key, own)
            self._sort(value, found.is_number)
            for _, text in found.arguments:
                self._give(value, text, own, {}, found.is_number)
        elif node.id == SUBTREE and node.port("ID") in self._names:
            for key in parameters(node.port("ID")):
                self._give((node.port("ID"), key), node.port(key), own, texts)
        elif node.id == "LoopString":
            self._chosen.add(node.port("value")[1:-1])
        elif node.id == "Choose":
            self._need(node.port("output"), node.port("type"), own)
            self._set.add(node.port("output")[1:-1])
        elif kind is not None:
            for name, port in kind.ports.items():
                if port.unit in _TYPES:
                    self._need(node.port(name), _TYPES[port.unit], own)
        self._set.add(node.port(MEASURED)[1:-1])
        for entry in self._vocabulary.entries.get(node.id, ()):
            types = {slot.name: slot.type for slot in entry.slots} | (
                {MEASURED: entry.measures} if entry.measures else {}
            )
            for name, text in node.ports:
                if name in types:
                    self._need(text, types[name], own)

    def _sort(self, value: Value, is_number: bool | None) -> None:
        if is_number is not None:
            self._sorts.setdefault(value, set()).add(is_number)

    def _value(self, key: str, own: Mapping[str, str]) -> Value:
        value = own.get(key, ""), key
        self._groups.setdefault(value, [value])
        return value

    def _give(
        self,
        value: Value,
        text: str,
        own: Mapping[str, str],
        texts: Mapping[str, str],
        is_number: bool | None = False,
    ) -> None:
        self._groups.setdefault(value, [value])
        key = text[1:-1] if text[:1] == "{" else ""
        text = texts.get(key, text)
        other = _reference(text)
        if other and other[0] != "_" and key not in texts:
            self._given.append((value, self._value(other, own)))
        elif not is_number:
            self._mention(text, own)
            self._texts.setdefault(value, []).append(text)

    def _mention(self, text: str, own: Mapping[str, str]) -> None:
        for piece in pieces(text) if choice_of(text) is None else ():
            if isinstance(piece, Reference) and piece.key[0] != "_":
                self._value(piece.key, own)

    def _need(self, text: str, kind: str, own: Mapping[str, str]) -> None:
        key = _reference(text)
        if key and key[0] != "_":
            self._needs.setdefault(self._value(key, own), set()).add(kind)

    def _type_by_name(self, value: Value) -> None:
        """Give a local value that has the name of a type that type."""
        self._groups.setdefault(value, [value])
        if value[1] in self._vocabulary.types:
            self._needs.setdefault(value, set()).add(value[1])

    # -- deciding

    def _first(self, value: Value) -> Value:
        """Return the value that stands for all of its group."""
        while value in self._joined:
            value = self._joined[value]
        return value

    def _join(self, one: Value, other: Value) -> None:
        """Join two values that can be of one type, which a text that is made of a number is not."""
        both = [*self._groups[one], *self._groups[other]]
        kind = self._common(both) if one != other else None
        texts = [text for value in both for text in self._texts.get(value, ())]
        if kind is not None and all(readable(text, kind, self._vocabulary) for text in texts):
            self._groups[other] = both
            self._joined[one] = other

    def _common(self, group: list[Value]) -> str | None:
        types = self._vocabulary.types
        needs = {kind for value in group for kind in self._needs.get(value, ()) if types[kind].kind != "text"}
        sorts = {sort for value in group for sort in self._sorts.get(value, ())}
        texts = [text for value in group for text in self._texts.get(value, ())]
        plain_numbers = sorted(kind for kind in needs if types[kind].kind == "number")
        if len(plain_numbers) > 1:
            needs -= set(plain_numbers[:-1])  # one number does for the other
        if len(needs) > 1 or len(sorts) > 1:
            return None
        number = number_type(types)
        if needs:
            [kind] = needs
            is_number = types[kind].kind in ("quantity", "number")
            return kind if sorts <= {is_number} else None
        if sorts == {True}:
            return number
        names = [kind for kind, one in types.items() if one.kind == "names"]
        for kind in [*([] if sorts else [number]), *names] if texts else ():
            if all(self._is_said(text, kind) and readable(text, kind, self._vocabulary) for text in texts):
                return kind
        return "text"

    def _is_said(self, text: str, kind: str) -> bool:
        """Whether it looks as it does in the tree: not "hi", which as a language is said "Hindi"."""
        return value_of(text, self._vocabulary.types[kind], self._vocabulary).lower() == text.lower()

    def is_doubtful(self, value: Value) -> bool:
        """Whether only its first use gives the type, and another use could give another one."""
        group = self._groups.get(self._first(value), [])
        texts = [text for one in group for text in self._texts.get(one, ())]
        others = [kind for kind, one in self._vocabulary.types.items() if one.kind in ("number", "names")]
        is_open = self.kind(value) == "text"
        return is_open and any(readable(text, kind, self._vocabulary) for text in texts for kind in others)

    def _is_outside(self, key: str) -> bool:
        """Whether nothing that is said sets a key that can be said in braces."""
        is_said = self._unset is not None and key not in self._unset
        is_set = key in self._chosen or (key in self._set and is_said)
        text = split(Source(f"{{{key}}}"), self._vocabulary.orthography)
        is_name = key[:1] != "_" and ReadingContext.reference(text, 0) == (key, len(text.words) - 2)
        return is_name and not is_set

    def _is_name(self, key: str) -> bool:
        """Whether the words of a key are read back as this key."""
        if key[:1] == "_" or key != key.lower():
            return False
        vocabulary = self._vocabulary
        said = f"{vocabulary.word('set')} {spell_key(key, vocabulary)} {vocabulary.word('set_to')} 0"
        prefixes = find_prefixes(split(Source(said), vocabulary.orthography), vocabulary)
        return [prefix.key for prefix in prefixes.values()] == [key]


def readable(text: str, kind: str, vocabulary: Lexicon) -> bool:
    """Whether a port text can be said as a value of a type."""
    return vocabulary.value(kind, value_of(text, vocabulary.types[kind], vocabulary)) == text


def _reference(text: str) -> str:
    """Return the key that a text is, "" for any other text."""
    found = pieces(text)
    return found[0].key if len(found) == 1 and isinstance(found[0], Reference) else ""
