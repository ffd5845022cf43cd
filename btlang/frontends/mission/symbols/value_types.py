"""The types of the values that a mission names: they follow from what is given to them, and from where they stand."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from btlang.frontends.mission.symbols.definitions import Definitions, add_name
from btlang.frontends.mission.symbols.prefixes import Prefix
from btlang.frontends.mission.symbols.scopes import Scopes
from btlang.frontends.mission.token import Header
from btlang.text.words import Words
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.match import Match
from btlang.vocabulary.pattern import Slot, name_form
from btlang.vocabulary.reading_context import Known, ReadingContext
from btlang.vocabulary.trie import TrieNode, longest


class ValueTypes:
    """Finds `types`, by the word of the prefix or body of a value and its key; a value may be of several.

    Types follow from each other, so each is looked for until nothing new is found. Names with parameters come into the
    trie of `definitions` when all their types are known.
    """

    def __init__(
        self,
        text: Words,
        vocabulary: Lexicon,
        prefixes: Mapping[int, Prefix],
        definitions: Definitions,
        shared: Mapping[str, Known],
        inside: Sequence[tuple[int, int, Known]] = (),
    ) -> None:
        self._text, self._vocabulary, self._definitions = text, vocabulary, definitions
        self._context = ReadingContext(vocabulary.values)
        self._prefixes, self._shared, self._inside = prefixes, shared, inside
        self._headers = [header for header in definitions.headers.values() if header.parameters]
        self._places: dict[str, list[int]] = {}
        for at, word in enumerate(text.words):
            self._places.setdefault(word, []).append(at)
        self.types: dict[tuple[int, str], tuple[str, ...]] = {}
        for header in self._headers:
            named = [key for key, _ in header.parameters if key in vocabulary.types]
            self.types |= {(header.body, key): (key,) for key in named}
        for find in (self._follow, self._ask_uses, self._follow):
            find()
        self._default()

    def scopes(self) -> Scopes:
        """Where the values are known, with the types found so far."""
        return Scopes(self._text, self._prefixes, self._headers, self._shared, self.types, self._inside)

    def _follow(self) -> None:
        before = -1
        while len(self.types) > before:
            before, scopes = len(self.types), self.scopes()
            for at, prefix in self._prefixes.items():
                if (at, prefix.key) not in self.types and prefix.role in ("set", "remember", "each"):
                    is_type = prefix.role == "each" and prefix.key in self._vocabulary.types
                    kind = prefix.noun.type if prefix.noun is not None else (prefix.key if is_type else "")
                    kinds = (kind,) if kind else self._given(at, prefix, scopes)
                    if kinds:
                        self.types[at, prefix.key] = kinds
                        if prefix.role != "each":
                            scopes.give(prefix, kinds)
            scopes = self.scopes()
            for header in self._headers:  # after `for each`: they may be used with its values
                self._from_body(header, scopes)
                if all((header.body, key) in self.types for key, _ in header.parameters):
                    self._add(header)

    def _default(self) -> None:
        """A value whose type nothing shows is a text, but one that is given a value of any type is of any."""
        scopes = self.scopes()
        for header in self._headers:
            for key, _ in header.parameters:
                self.types.setdefault((header.body, key), ("text",))
            self._add(header)
        for at, prefix in self._prefixes.items():
            if prefix.role in ("set", "each"):
                self._context.set_known(scopes.at(at))
                named = self._context.named(self._text, prefix.value) if prefix.value >= 0 else None
                is_untyped = named is not None and named[0] is not None and not named[0].kinds
                self.types.setdefault((at, prefix.key), () if is_untyped else ("text",))

    def _add(self, header: Header) -> None:
        if header.body not in self._definitions.types:
            kinds = {key: self.types[header.body, key][0] for key, _ in header.parameters}
            add_name(header, self._definitions, self._vocabulary, kinds)

    # -- parameters

    def _from_body(self, header: Header, scopes: Scopes) -> None:
        """A parameter is of the first type that fits all slots in which it stands, other than those of text; of several
        the one of its first use.
        """
        open_keys = [key for key, _ in header.parameters if (header.body, key) not in self.types]
        if not open_keys:
            return
        known = scopes.at(header.body)
        found: dict[str, tuple[str, ...]] = {}
        steps = {prefix.value - 1 for prefix in self._prefixes.values() if prefix.role in ("increase", "decrease")}
        at = header.body
        while at < header.last:
            match = self._longest(at, known) if at not in steps else None  # `by {step}` is no time here
            for key in [key for key in open_keys if match is not None and _holds(match, key)]:
                kinds = tuple(self._fitting(at, match, key, known))
                found[key] = tuple(kind for kind in found.get(key, kinds) if kind in kinds) or found[key]
            at = max(match.last, at + 1) if match is not None else at + 1
        for at, prefix in self._prefixes.items():
            if header.body <= at < header.last and prefix.role in ("increase", "decrease") and prefix.value >= 0:
                named = self._context.named(self._text, prefix.value)
                if named is not None and named[0] is not None and named[0].key in open_keys and prefix.key in known:
                    found.setdefault(named[0].key, known[prefix.key].kinds)
        use = self._first_use(header, scopes) if any(len(kinds) > 1 for kinds in found.values()) else {}
        for key, kinds in found.items():
            meant = [kind for kind in kinds if kind in use.get(key, ())] or kinds  # `go to {guest}`: who or where
            if kinds:
                self.types[header.body, key] = (meant[0],)
                scopes.find(header.body, key, (meant[0],))

    def _longest(self, at: int, known: Mapping[str, Known]) -> Match | None:
        self._context.set_known(known)
        matches = (longest(trie, self._text, at, self._context) for trie in self._tries())
        return max((match for match in matches if match is not None), key=lambda match: match.last, default=None)

    def _tries(self) -> Iterator[TrieNode]:
        yield self._vocabulary.trie
        if self._definitions.trie:
            yield self._definitions.trie

    def _fitting(self, at: int, match: Match | None, key: str, known: Mapping[str, Known]) -> Iterator[str]:
        """The types with which a phrase is read as far as without a type."""
        for kind in self._vocabulary.types:
            if kind != "text":
                other = self._longest(at, {**known, key: known[key].replace(kinds=(kind,))})
                if other is not None and match is not None and other.last == match.last and _holds(other, key):
                    yield kind

    def _ask_uses(self) -> None:
        """If the body of a definition doesn't show the type of a parameter, its first use does."""
        scopes = self.scopes()
        for header in self._headers:
            open_keys = [key for key, _ in header.parameters if (header.body, key) not in self.types]
            use = self._first_use(header, scopes) if open_keys else {}
            for key in open_keys:
                if use.get(key):
                    self.types[header.body, key] = use[key]
                    scopes.find(header.body, key, use[key])

    def _first_use(self, header: Header, scopes: Scopes) -> dict[str, tuple[str, ...]]:
        """The types of the values with which a name is first used; none where it never is."""
        form, own = name_form(header.name), header.span
        first = form[0]
        for at in range(len(self._text.words)) if isinstance(first, Slot) else self._places.get(first, ()):
            if not own.start <= self._text.starts[at] < own.end:
                if (use := self._use(form, at, scopes)) is not None:
                    return use
        return {}

    def _use(self, form: Sequence[str | Slot], at: int, scopes: Scopes) -> dict[str, tuple[str, ...]] | None:
        """The types of the values with which a name is used at a word, None where it is not."""
        found: dict[str, tuple[str, ...]] = {}
        start = at
        for part in form:
            if isinstance(part, Slot):
                self._context.set_known(scopes.at(start))
                value = self._context.any(self._text, at)
                if value is None:
                    return None
                found[part.name], at = value[0], value[2]
            elif self._text.words[at] == part:
                at += 1
            else:
                return None
        return found

    # -- values that are given

    def _given(self, at: int, prefix: Prefix, scopes: Scopes) -> tuple[str, ...]:
        """The types that the value of a prefix can have, () where that is not known yet."""
        if prefix.value < 0:
            return ()
        if prefix.role in ("set", "remember"):
            quantity = longest(self._vocabulary.quantities, self._text, prefix.value, self._context)
            if quantity is not None and quantity.meaning.entry is not None:
                return (quantity.meaning.entry.measures,)
        self._context.set_known(scopes.at(at))
        named = self._context.named(self._text, prefix.value)
        if named is not None:
            return named[0].kinds if named[0] is not None else ()
        value = self._context.any(self._text, prefix.value)
        if value is None or (value[0] == ("text",) and self._is_open(prefix)):
            return ()
        return value[0]

    def _is_open(self, prefix: Prefix) -> bool:
        """Whether a bare word is no text: where something is remembered, and where a name without a value stands."""
        word = self._text.words[prefix.value]
        names = (other.words[0] for other in self._prefixes.values() if other.role != "each")
        return word[0] != '"' and (prefix.role == "remember" or word in names)


def _holds(match: Match, key: str) -> bool:
    return any(f"{{{key}}}" in value.texts and value.type != "text" for value in match.values)
