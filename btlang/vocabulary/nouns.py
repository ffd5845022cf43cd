"""Noun phrases in the place of a name: `nearest person`, `someone`, `red cup`, `every place`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Set
from itertools import chain

from btlang.support.record import Record
from btlang.text.words import Words
from btlang.vocabulary.adjectives import UNSLOTTED, Adjectives
from btlang.vocabulary.pattern import Form, Slot, forms
from btlang.vocabulary.references import ALL, CHOICES, COUNT, DENIED, PLACED, SEEN, SIZED, SPEAKING, Parts, ordinal
from btlang.vocabulary.value_type import OBJECT, PERSON, PLACE, WORLD
from btlang.vocabulary.word_tree import END, SLOTS, WordTree, find, insert

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeAlias

    Fits: TypeAlias = Callable[[str, Parts], bool]

Features = Mapping[str, tuple[tuple[str, Parts], ...]]
"""What the names of a world are like, by their types."""
_HEADS = frozenset(("kind", "kinds", "color"))
"""The slots before which adjectives stand."""
_PLURALS = {"kind": "kinds"}
"""The slots that are also said in the plural where all are meant: `all red cups`."""


_FORMS = frozenset((*_PLURALS.values(), *DENIED))
"""Types whose names are other forms of those of a type: nobody says `every kinds`."""


class Noun(Record):
    """A noun phrase as a keyword file declares it: `[{color}] {kind}`. Chosen is one by `how`, or "all"."""

    type: str
    how: str
    phrase: str
    slots: Mapping[str, str]


class Description(Record):
    """Which names of a type are meant: `how` is a way to choose one, or "all"; `parts` are what they have in common."""

    type: str
    how: str
    parts: Parts = ()

    def uncounted(self) -> Description:
        """The same without a number: all of them."""
        every: Description = self.replace(parts=tuple(part for part in self.parts if part[0] != COUNT))
        return every


class Nouns:
    """The noun phrases of a language. `names` gives the word tree of the names that a slot of a type takes."""

    def __init__(self, adjectives: Adjectives, heads: frozenset[str]) -> None:
        self.adjectives, self._heads = adjectives, heads
        self.tree: WordTree = {}
        """Their words."""
        self.plurals: WordTree = {}
        """Those in the plural: `red cups`."""
        self.sorts_of_people: dict[str, str] = {}
        """What people may be, in the singular and the plural, each with the singular: `patients`."""
        self._types: WordTree = {}
        self._said: dict[tuple[str, str, tuple[str, ...]], Form] = {}

    def add_plural(self, form: Form, slots: Mapping[str, str], kind: str) -> None:
        """Adds one way to say several: `red cups`."""
        self._add(self.plurals, form, slots, kind, ALL)

    def add(self, form: Form, slots: Mapping[str, str], kind: str, how: str) -> None:
        """Adds one way to say it; what is known already keeps its meaning."""
        self._add(self.tree, form, slots, kind, how)
        names = tuple(sorted(part.name for part in form if isinstance(part, Slot)))
        self._said.setdefault((kind, how, names), form)

    def _add(self, node: WordTree, form: Form, slots: Mapping[str, str], kind: str, how: str) -> None:
        for part in form:
            if isinstance(part, str):
                node = node.setdefault(part, {})
                continue
            edges = node.setdefault(SLOTS, [])
            of = slots[part.name]
            known = next((child for name, other, child in edges if (name, other) == (part.name, of)), None)
            node = {} if known is None else known
            if known is None:
                edges.append((part.name, of, node))
        ways = node.setdefault(END, [])
        if kind not in [known for known, _ in ways]:
            ways.append((kind, how))

    def longest(
        self, text: Words, at: int, names: Callable[[str], WordTree], fits: Fits, before: Set[str]
    ) -> dict[str, tuple[Description, int]]:
        """The longest noun phrase at a word whose type and parts fit, and where it ends, by its type ("" for any).

        Of equally long ones it is the one that says most. Adjectives begin at the words `before`.
        """
        return self._longest(self.tree, text, at, names, fits, before)

    def plural(
        self, text: Words, at: int, names: Callable[[str], WordTree], fits: Fits, before: Set[str]
    ) -> dict[str, tuple[Description, int]]:
        """The same in the plural."""
        return self._longest(self.plurals, text, at, names, fits, before)

    def _longest(
        self,
        tree: WordTree,
        text: Words,
        at: int,
        names: Callable[[str], WordTree],
        fits: Fits,
        before: Set[str],
    ) -> dict[str, tuple[Description, int]]:
        best: dict[str, tuple[Description, int]] = {}
        says: dict[str, tuple[int, bool, int]] = {}
        paths: list[tuple[WordTree, int, Parts, bool]] = [(tree, at, (), False)]
        while paths:
            node, i, parts, is_open = paths.pop()
            word = text.words[i]
            if not is_open and END in node:
                own = (i, *_says(parts))
                for kind, how in (way for way in node[END] if fits(way[0], parts)):
                    for each in ("", kind):
                        if each not in says or own > says[each]:
                            says[each], best[each] = own, (Description(kind, how, tuple(sorted(parts))), i)
            for name, of, child in node.get(SLOTS, ()):
                value = find(names(of), text.words, i) if not is_open or name in _HEADS else None
                if value is not None and all(name != known for known, _ in parts):
                    paths.append((child, value[1], (*parts, (name, value[0])), False))
            if word in node and (not is_open or word in self._heads):
                paths.append((node[word], i + 1, parts, False))
            if word in before and not is_open:
                paths += [
                    (node, end, (*parts, *more), True)
                    for more, end in self.adjectives.chains(text, i, names, determined=tree is self.tree)
                    if not {name for name, _ in more} & {name for name, _ in parts}
                ]
        return best

    def add_type(self, words: str, kind: str) -> None:
        """Adds a word for a type: `places`."""
        insert(self._types, words.split(), kind)

    def type_at(self, text: Words, at: int) -> tuple[str, int] | None:
        """The type for which a word begins that stands for all of it, and where that ends: `places`."""
        return find(self._types, text.words, at)

    def is_type(self, kind: str, text: Words, at: int) -> bool:
        """Whether a word for a type begins at a word."""
        found = self.type_at(text, at)
        return found is not None and found[0] == kind

    def starts(self, names: Callable[[str], WordTree]) -> frozenset[str]:
        """The words at which a noun phrase may begin."""
        return self._starts(self.tree, names)

    def is_head(self, word: str) -> bool:
        """Whether a word is a noun of the language for what has names: `people`."""
        return word in self._heads

    def plural_starts(self, names: Callable[[str], WordTree]) -> frozenset[str]:
        """The words at which one in the plural may begin."""
        return self._starts(self.plurals, names)

    @staticmethod
    def _starts(tree: WordTree, names: Callable[[str], WordTree]) -> frozenset[str]:
        slots = (word for _, kind, _ in tree.get(SLOTS, ()) for word in names(kind))
        return frozenset((*tree, *slots)) - {END, SLOTS}

    def words(self, meant: Description, spoken: Mapping[tuple[str, str], str], before: str = "") -> str:
        """The first way to say what has these parts, "" if there is none. `spoken` are the words of their names, and
        the adjectives `before` stand at the head.
        """
        parts = dict(meant.parts)
        form = self._said.get((meant.type, meant.how, tuple(sorted(parts))), ())
        pieces = [(part, "") if isinstance(part, str) else (part.name, parts[part.name]) for part in form]
        words = [spoken.get(piece, piece[1] or piece[0]) for piece in pieces]
        if before:
            heads = _HEADS | self._heads
            at = next((at for at, piece in enumerate(pieces) if piece[0] in heads), None)
            if at is None:
                return ""
            words.insert(at, before)
        return " ".join(words)

    def said(self, kind: str, likes: Iterable[Parts], spoken: Mapping[tuple[str, str], str]) -> list[str]:
        """What can be said of a type whose names have these parts."""
        likes = list(likes)
        found: dict[str, None] = {}
        for own, how, names in self._said:
            if own != kind:
                continue
            for parts in likes if names else [()]:
                some = tuple(part for part in parts if part[0] in names)
                if tuple(name for name, _ in some) == names:
                    found[self.words(Description(kind, how, some), spoken)] = None
        return list(found)


def _says(parts: Parts) -> tuple[bool, int]:
    """How much parts say: `big` is a size where it can be one, and else means the biggest."""
    return bool(parts), sum(name in UNSLOTTED for name, _ in parts)


def with_plurals(
    names: Mapping[str, list[tuple[str, str]]], endings: Mapping[str, str]
) -> dict[str, list[tuple[str, str]]]:
    """Names of types, each with its words, and those in the plural for types that have one."""
    kinds = [(kind, many) for kind, many in _PLURALS.items() if kind in names]
    plurals = {many: [(plural(words, endings), name) for words, name in names[kind]] for kind, many in kinds}
    return {**names, **{many: plurals[many] + names[kind] for kind, many in kinds}}


def plural(words: str, endings: Mapping[str, str]) -> str:
    """By the endings of the language, the longest that fits: `box` as `boxes`."""
    for at in range(len(words) + 1):
        if words[at:] in endings:
            return words[:at] + endings[words[at:]]
    return words


def noun_phrases(
    kinds: Iterable[str], language: Mapping[str, Any], declared: Iterable[Noun], adjectives: Adjectives
) -> Nouns:
    """Those of a language for types with names, and those that files declare."""
    found = Nouns(adjectives, frozenset((*chain(*language["nouns"].values()), *language["ones"])))
    roles: Mapping[str, list[str]] = language["roles"]
    every = [(tuple(words.split()), ALL) for words in roles.get("all_names", ())]
    several = [tuple(words.split()) for words in roles.get("all_of", ())]  # before conditions, which have no plural
    chosen = [(tuple(words.split()), how) for how in CHOICES for words in roles.get(how, ())]
    chosen += [(tuple(words.split()), str(number)) for words, number in language["ordinals"].items()]
    for kind in (kind for kind in kinds if kind not in _FORMS):
        ways = every + [way for way in chosen if _may_choose(kind, way[1])]
        nouns = language["nouns"].get(kind, ())
        single = [words for words in nouns if plural(words, language["plural_endings"]) in nouns]
        for words in nouns or (kind,):
            found.add_type(words, kind)
            for before, how in (way for way in ways if not (words in single and way[0] in several)):
                found.add((*before, *words.split()), {}, kind, how)
        for words in nouns if single else ():
            if words not in single:  # `people`
                found.add_plural(tuple(words.split()), {}, kind)
        for words in language["everyone"].get(kind, ()):
            found.add(tuple(words.split()), {}, kind, ALL)
        for noun in declared:
            if noun.type == kind:
                for form in forms(noun.phrase, frozenset(language["articles"])):
                    takes_more = isinstance(form[0], Slot) or form[0] in (
                        *language["nouns"].get(kind, (kind,)),
                        *language["ones"],
                    )
                    _add_declared(found, noun, form, ways if takes_more else ())
        for words in language["asking"].get("sorts_of_people", ()) if kind == PERSON else ():
            many = plural(words, language["plural_endings"])
            found.sorts_of_people |= {words: words, many: words}
            found.add((words,), {}, kind, SEEN)
            found.add_plural((many,), {}, kind)
            for before, how in every:
                found.add((*before, many), {}, kind, how)
    return found


def _may_choose(kind: str, how: str) -> bool:
    """Whether names of a type can be chosen so: objects alone have a size, and not every type has a point to see."""
    if how in SIZED:
        return kind == OBJECT
    if how == SPEAKING:
        return kind == PERSON
    return kind in (WORLD if not (how in PLACED or ordinal(how)) else (OBJECT, PLACE, PERSON))


def _add_declared(nouns: Nouns, noun: Noun, form: Form, ways: Iterable[tuple[Form, str]]) -> None:
    if noun.how == ALL:
        nouns.add_plural(form, noun.slots, noun.type)
        for before, how in ways:
            if how == ALL:
                nouns.add((*before, *form), noun.slots, noun.type, how)
        return
    nouns.add(form, noun.slots, noun.type, noun.how)
    if _PLURALS.keys() & noun.slots.keys():
        nouns.add_plural(form, {**noun.slots, **_PLURALS}, noun.type)
    for before, how in ways if any(isinstance(part, Slot) for part in form) else ():
        nouns.add((*before, *form), noun.slots, noun.type, how)
        if how == ALL and _PLURALS.keys() & noun.slots.keys():
            nouns.add((*before, *form), {**noun.slots, **_PLURALS}, noun.type, how)
