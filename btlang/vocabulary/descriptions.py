"""What a noun phrase says around its head: adjectives, one prepositional phrase, and what the thing is not.

    the red cup on the table near the sink        a soda that isn't a coke        the person behind Alice

The result is a `Choice` whose parts are filters. The value of a relation is the thing that it leads to: a name
(`table`), or a description of one; each further filter of it stands behind a semicolon (`table; near sink`,
`kind table; color red`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from btlang.text.words import Words
from btlang.vocabulary.adjectives import Adjectives
from btlang.vocabulary.pattern import ways
from btlang.vocabulary.references import ADJECTIVES, ALL, DENIED, LATEST, QUALITIES, RELATIONS, SECOND, SELF, Parts
from btlang.vocabulary.value_type import PERSON, PLACE
from btlang.vocabulary.word_tree import WordTree, find, tree_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any, TypeAlias

    Names: TypeAlias = Callable[[str], WordTree]

NAME = "named"
"""The part that is a name of the world; `name` is that of a node."""
_HEADS = ("object", "place", "person", "door", "zone")
"""The types of what a relation may lead to."""
_OTHER = "other_than"
_PLACED = frozenset(("inside", "at", "off"))
_MOST_DEEP = 3
_LONGEST_CLAUSE = 8  # words


class Modifiers:
    """The words of a language around the head of a noun phrase."""

    def __init__(self, language: Mapping[str, Any]) -> None:
        self._words: Mapping[str, list[str]] = language["relations"]
        self._relations = tree_of((phrase, name) for name, phrases in self._words.items() for phrase in phrases)
        self._qualities: Mapping[str, list[str]] = language["qualities"]
        of = ((phrase, name) for name, phrases in self._qualities.items() for phrase in phrases)
        self._quality_words = [(name, phrase.split()) for phrase, name in of]
        articles = frozenset(language["articles"])
        self._to_self = {
            name: sorted(ways(phrases, articles), key=len) for name, phrases in language["relations_to_self"].items()
        }
        self._self_relations = tree_of((phrase, name) for name, phrases in self._to_self.items() for phrase in phrases)
        self._relatives: list[str] = language["relatives"]
        self._denials = list(ways(language["relative_denials"]))
        self.adjectives = Adjectives(language)
        clauses = (*((phrase, True) for phrase in self._relatives), *((phrase, False) for phrase in self._denials))
        self._clauses = tree_of(clauses)
        self._either = frozenset(language["roles"].get("or", ()))
        self._nearest = frozenset(language["roles"].get("nearest", ()))
        self._both: list[str] = language["roles"].get("and", [])
        self._joints = frozenset((",", *self._both))
        firsts = (words[0] for _, words in self._quality_words)
        self.starts = frozenset((*self._relations, *self._clauses, *self._self_relations, *firsts))
        """The words with which something behind a head may begin."""

    @property
    def relative(self) -> str:
        """The words that begin a relative clause: `that is`."""
        return next(iter(self._relatives), "")

    def is_picked(self, how: str, text: Words, at: int) -> bool:
        """Whether words at a place mean one thing that depends on where the robot is: `the nearest cup`."""
        return how not in (ALL, "nearest", "seen") or text.words[at] in self._nearest

    def relates(self, text: Words, at: int) -> bool:
        """Whether words that say how things stand to each other begin at a word."""
        return find(self._relations, text.words, at) is not None

    def words(self) -> Iterator[str]:
        """Every word of it."""
        said = (*self._words.values(), *self._qualities.values(), *self._to_self.values())
        for phrases in (*said, self._relatives, self._denials):
            for phrase in phrases:
                yield from phrase.split()

    def ends_clause(self, text: Words, at: int) -> bool:
        """Whether `that is`, `that isn't` or the like ends before a word."""
        found = (find(self._clauses, text.words, start) for start in range(max(at - _LONGEST_CLAUSE, 0), at))
        return any(clause is not None and clause[1] == at for clause in found)

    def denies(self, text: Words, at: int) -> bool:
        """Whether `that is not` or the like begins at a word."""
        clause = find(self._clauses, text.words, at)
        return clause is not None and not clause[0]

    def behind_all(self, kind: str, text: Words, at: int, names: Names) -> Iterator[tuple[Parts, int]]:
        """The same behind a set, which may come from several places: `all cups from the kitchen and the lab`."""
        for parts, end in self.behind(kind, text, at, names):
            yield parts, end
            (relation, value), *others = parts
            if relation in _PLACED and not others:
                yield from self._listed(relation, value, text, end, names)

    def _listed(self, relation: str, value: str, text: Words, end: int, names: Names) -> Iterator[tuple[Parts, int]]:
        while text.words[end] in self._joints:
            first = end + 1 + (text.words[end + 1] in self._joints)
            more = find(names(PLACE), text.words, first)
            if more is None or not (first in text.articles or more[1] > first + 1):
                return  # `all cups from the lab and dock` goes to the dock
            value, end = f"{value}{SECOND}{more[0]}", more[1]
            if text.words[first - 1] in self._both:
                yield ((relation, value),), end
                return

    def behind(self, kind: str, text: Words, at: int, names: Names) -> Iterator[tuple[Parts, int]]:
        """The filters that may stand behind a head of a type, and where each ends; the shortest first."""
        clause = find(self._clauses, text.words, at)
        if clause is None:
            yield from self._qualified(kind, text, at, names)
            yield from self._related(kind, text, at, names, 1)
        elif clause[0]:
            for part in ADJECTIVES:
                said = find(names(part), text.words, clause[1])
                if said is not None:
                    yield ((part, said[0]),), said[1]
            yield from self._qualified(kind, text, clause[1], names)
            yield from self._related(kind, text, clause[1], names, 1)
        else:
            yield from self._denied(kind, text, clause[1], names)

    def before(self, text: Words, at: int, names: Names) -> Iterator[tuple[Parts, int]]:
        """What may stand before a name at a word, and where it ends; the shortest first."""
        for parts, end in ((), at), *self.adjectives.chains(text, at, names):
            color = find(names("color"), text.words, end)
            if end > at:
                yield parts, end
            if color is not None and "not_color" not in dict(parts):
                yield (*parts, ("color", color[0])), color[1]

    def said_before(self, parts: Parts, spoken: Callable[[str, str], str]) -> str:
        """The words of an owner and of adjectives, "" where there are none."""
        known = dict(parts)
        owner = [self.adjectives.said_owner(known["owner"])] if "owner" in known else []
        return " ".join((*owner, *(spoken(part, known[part]) for part in ADJECTIVES if part in known)))

    def said(self, parts: Parts, spoken: Callable[[str, str], str]) -> str:
        """The words of the filters that stand behind a head, "" where there are none."""
        words: list[str] = []
        for name, value in parts:
            if name in RELATIONS and value == SELF:
                words.append(self._to_self[name][0])
            elif name in RELATIONS:
                things = (self._said_thing(each, spoken) for each in value.split(SECOND))
                words.append(f"{self._words[name][0]} {f' {self._both[0]} '.join(things)}")
            elif name in QUALITIES:
                words.append(f"{self._qualities[name][0]} {spoken(name, value)}")
            elif name in DENIED:
                kind = DENIED[name]
                word = f" {self._first_or} ".join(spoken(kind, each) for each in value.split("; "))
                words.append(f"{self._denials[0]} {word}")
        return " ".join(words)

    @property
    def _first_or(self) -> str:
        return next(iter(sorted(self._either, key=len)), "or")

    def _said_thing(self, value: str, spoken: Callable[[str, str], str]) -> str:
        """A thing with its adjectives before it and what it is near behind it, which may have the same."""
        head, *filters = value.split("; ")
        said = spoken("kind", head.removeprefix("kind ")) if head.startswith("kind ") else head
        likes: list[tuple[str, str]] = []
        before: list[str] = []
        for each in filters:
            name, _, of = each.partition(" ")
            if name in RELATIONS:
                rest = value.partition(f"; {name} ")[2]
                return " ".join((*before, self.said_before(tuple(likes), spoken), said, self._words[name][0],
                                 self._said_thing(rest, spoken))).strip()  # fmt: skip
            if name in DENIED:
                before.append(next(self.adjectives.denied(spoken(DENIED[name], of))))
            else:
                likes.append((name, of))
        return " ".join((*before, self.said_before(tuple(likes), spoken), said)).strip()

    def _qualified(self, kind: str, text: Words, at: int, names: Names) -> Iterator[tuple[Parts, int]]:
        """`of water`, `with a red lid`, and one relation behind it."""
        for name, words in self._quality_words:
            start = at + len(words)
            said = find(names(name), text.words, start) if text.words[at:start] == words else None
            if said is not None:
                yield ((name, said[0]),), said[1]
                for more, end in self._related(kind, text, said[1], names, 1):
                    yield ((name, said[0]), *more), end

    def relation(self, kind: str, text: Words, at: int) -> tuple[str, int] | None:
        """The relation of a thing of a type to what follows that begins at a word, and where its words end."""
        found = find(self._relations, text.words, at)
        return found if found is not None and kind in RELATIONS[found[0]] else None

    def _related(self, kind: str, text: Words, at: int, names: Names, depth: int) -> Iterator[tuple[Parts, int]]:
        to_self = find(self._self_relations, text.words, at)
        if to_self is not None and kind in RELATIONS[to_self[0]] and depth == 1:
            yield ((to_self[0], SELF),), to_self[1]
        found = find(self._relations, text.words, at)
        place = find(names(PLACE), text.words, found[1]) if found is not None and kind == PERSON else None
        if found is not None and found[0] == "on" and place is not None:
            yield (("at", place[0]),), place[1]  # `the nurse on ward 3`
        if found is not None and kind in RELATIONS[found[0]]:
            for value, end in self._thing(text, found[1], names, depth):
                if found[0] != "between":
                    yield ((found[0], value),), end
                    yield from self._others(text, value, end, names, depth) if found[0] == _OTHER else ()
                elif depth == 1 and text.words[end] in self._both:
                    for second, last in self._thing(text, end + 1, names, depth):
                        yield ((found[0], f"{value}{SECOND}{second}"),), last

    def _others(self, text: Words, value: str, at: int, names: Names, depth: int) -> Iterator[tuple[Parts, int]]:
        """Further things behind one: `different from the red cup and the blue cup`."""
        for second, last in self._thing(text, at + 1, names, depth) if text.words[at] in self._both else ():
            both = f"{value}{SECOND}{second}"
            yield ((_OTHER, both),), last
            yield from self._others(text, both, last, names, depth)

    def _thing(self, text: Words, at: int, names: Names, depth: int) -> Iterator[tuple[str, int]]:
        """What a relation leads to: a name, or a kind with its adjectives; the shortest first."""
        head = self._head(text, at, names) or _in_braces(text, at)
        if head is None:
            return
        kind, value, end = head
        yield value, end
        if depth < _MOST_DEEP and text.words[end] in self.starts:
            for parts, last in self._related(kind, text, end, names, depth + 1):
                yield "; ".join((value, *(f"{name} {of}" for name, of in parts))), last

    def _head(self, text: Words, at: int, names: Names) -> tuple[str, str, int] | None:
        """The longest name, or kind where no name is as long; both may have adjectives before them."""
        best: tuple[str, str, int] | None = None
        for parts, start in ((), at), *self.before(text, at, names):
            if (_OTHER, LATEST) in parts:
                continue  # than which one depends on what is described
            heads = [(kind, "", find(names(kind), text.words, start)) for kind in _HEADS]
            for kind, of, found in (*heads, ("object", "kind ", find(names("kind"), text.words, start))):
                if found is not None and (best is None or found[1] > best[2]):
                    filters = (f"{part} {value}" for part, value in parts)
                    best = kind, "; ".join((f"{of}{found[0]}", *filters)), found[1]
        return best

    def _denied(self, kind: str, text: Words, at: int, names: Names) -> Iterator[tuple[Parts, int]]:
        """`that is not red`, `that isn't a coke or a water`."""
        for part, of in DENIED.items():
            if part == "not_kind" and kind != "object":
                continue
            values: list[str] = []
            end = at
            while True:
                found = find(names(of), text.words, end) or (
                    find(names(kind), text.words, end) if part == "not_kind" else None
                )
                if found is None:
                    break
                values.append(found[0])
                yield ((part, "; ".join(values)),), found[1]
                end = found[1]
                if text.words[end] not in self._either:
                    break
                end += 1


def _in_braces(text: Words, at: int) -> tuple[str, str, int] | None:
    """A value of the mission in the place of a name: `different from {object}`."""
    end = at + 1
    if text.words[at] != "{" or "}" not in text.words[end : end + _LONGEST_CLAUSE]:
        return None
    while text.words[end] != "}":
        end += 1
    return "", f"{{{'_'.join(text.words[at + 1 : end])}}}", end + 1
