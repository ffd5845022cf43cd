"""What the names of a world are like, and which of them a description means as far as that is known."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping

from btlang.vocabulary.nouns import Description, Features
from btlang.vocabulary.references import ALL, COUNT, DENIED, NAMES, RELATIONS, Choice, Parts
from btlang.vocabulary.value_type import OBJECT, PLACE, ZONE


class Likenesses:
    """The features of the names of a world by their types; `listed` gives all names of a type."""

    def __init__(self, features: Features, listed: Callable[[str], tuple[str, ...]]) -> None:
        self.features = features
        self._listed = listed
        self._types: Mapping[str, frozenset[str]] | None = None

    def types_of(self, kind: str) -> frozenset[str]:
        """The types of what there is of a kind; where the world has none, it is a kind of objects."""
        if self._types is None:
            found: dict[str, set[str]] = {}
            for of, named in self.features.items():
                for value in (value for _, parts in named for name, value in parts if name == "kind"):
                    found.setdefault(value, set()).add(of)
            self._types = {value: frozenset(types) for value, types in found.items()}
        return self._types.get(kind, frozenset((OBJECT,)))

    def kind_of(self, type: str, name: str) -> str:
        """The kind of what has a name, "" where it has none."""
        return dict(dict(self.features.get(type, ())).get(name, ())).get("kind", "")

    def fits(self, type: str, parts: Parts) -> bool:
        """Whether names of a type can be judged by the parts, which are of no kind that only another type has."""
        kind = dict(parts).get("kind")
        return (kind is None or type in self.types_of(kind)) and self.may_say(type, (), parts)

    def may_say(self, type: str, parts: Parts, more: Parts) -> bool:
        """Whether names of a type may be described by more parts, which can be judged."""
        return all(self.is_told(type, part, value) and part not in dict(parts) for part, value in more)

    def is_told(self, type: str, part: str, value: str = "") -> bool:
        """Whether what is said of names of a type can be judged: their sizes and states only where the world has some.

        The colors of objects may be seen. The value of a relation says something of another thing, too.
        """
        if part in RELATIONS:
            filters = (each.partition(" ") for each in value.split("; ")[1:])
            return all(any(self.is_told(of, name, more) for of in (OBJECT, PLACE)) for name, _, more in filters)
        part = DENIED.get(part, part)
        if part not in ("size", "state") and (part != "color" or type != PLACE):
            return True
        return self.says(type, part)

    def says(self, type: str, part: str) -> bool:
        """Whether the world says this part of any name of a type."""
        return any(name == part for _, parts in self.features.get(type, ()) for name, _ in parts)

    def is_ever_told(self, part: str) -> bool:
        """Whether the part of a thing of any type can be judged."""
        return any(self.is_told(type, part) for type in (OBJECT, PLACE))

    def described(self, meant: Description) -> tuple[str, ...]:
        """The names of a type that have the parts of a description, in the order of the world."""
        if not meant.parts:
            return self._every(meant.type)
        return tuple(name for name, parts in self.features.get(meant.type, ()) if set(meant.parts) <= set(parts))

    def _every(self, type: str) -> tuple[str, ...]:
        """All names of a type; zones that are places only where one is named aren't among the places."""
        names = self._listed(type)
        if type != PLACE:
            return names
        places, zones = dict(self.features.get(PLACE, ())), self._listed(ZONE)
        return tuple(name for name in names if name in places or name not in zones)

    def so_many(self, sets: Iterable[tuple[Description, int]], count: float) -> Iterator[tuple[Description, int]]:
        """The sets, without a number, of which the world has just so many: `all three shelves`."""
        for meant, end in sets:
            every = meant.uncounted()
            if len(self.described(every)) == count:
                yield every, end

    @staticmethod
    def is_listed(meant: Description) -> bool:
        """Whether what is known of the world decides which names are meant."""
        parts = dict(meant.parts)
        return not (parts.keys() & {COUNT, *DENIED, *RELATIONS})

    def members(self, choice: Choice) -> tuple[str, ...] | None:
        """The names of a set where what is known of the world decides; None where only the robot can tell."""
        parts = dict(choice.parts)
        if NAMES in parts:
            return tuple(parts[NAMES].split(";"))
        denied = {part: parts.pop(part).split("; ") for part in DENIED if part in parts}
        if COUNT in parts or parts.keys() & RELATIONS.keys() or choice.type not in self.features:
            return None
        names = self.described(Description(choice.type, ALL, tuple(parts.items())))
        likes = dict(self.features.get(choice.type, ()))
        needed = {DENIED[part] for part in denied if part != "not_kind"}
        if not names or not all(needed <= {part for part, _ in likes.get(name, ())} for name in names):
            return None

        def is_denied(name: str) -> bool:
            like = likes.get(name, ())
            return name in denied.get("not_kind", ()) or any(
                (DENIED[part], value) in like for part, values in denied.items() for value in values
            )

        return tuple(name for name in names if not is_denied(name))
