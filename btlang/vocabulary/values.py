"""Values in slots: numbers in figures and words, units, and names from a list. `reading_context.py` has the others.

A value becomes the text of a port, in the unit whose factor is 1: `half a meter` is "0.5", `two minutes` is "120".
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from marshal import dumps, loads  # a copy of a trie, at a tenth of the time that importing `copy` takes

from btlang.text.source import Source
from btlang.text.words import Orthography, Words, split
from btlang.vocabulary.descriptions import NAME, Modifiers
from btlang.vocabulary.nouns import Description, Features, Noun, noun_phrases
from btlang.vocabulary.references import ALL, COUNT, DENIED, RELATIONS, Choice, Parts, choice_of
from btlang.vocabulary.value_type import PLACE, ValueType, format_number, with_unit
from btlang.vocabulary.verbs import role_words
from btlang.vocabulary.word_tree import END, WordTree, find, insert

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_LARGEST = 1e12  # beyond it no quantity of a robot makes sense, and sums stay exact
_MOST_NUMBER_WORDS = 12
_FARTHEST = 1e6  # metres, as in a world file


class Values:
    """Reads values at a place in a text. `types` by name; `language` holds the word tables of the language.

    Nothing of it changes once the names are added, so all missions of a process share it.
    """

    def __init__(self, types: Mapping[str, ValueType], language: Mapping[str, Any], nouns: Iterable[Noun] = ()) -> None:
        self.types = dict(types)
        self._numbers: Mapping[str, float] = language["numbers"]
        self._multipliers: Mapping[str, float] = language["multipliers"]
        self._joiner = frozenset(language["unit_joiner"])
        self._one_each = frozenset(language["one_each"])
        self._orthography = Orthography(frozenset(language["articles"]))
        # words that an article before them makes no text: `print a then wave`
        self._connectives = frozenset(phrase for phrases in language["roles"].values() for phrase in phrases)
        joining = (phrase for role in ("and", "or", "nor") for phrase in language["roles"].get(role, ()))
        self.joiners = frozenset((",", *(phrase.split()[0] for phrase in joining)))
        """The first words of what stands between the values of a list."""
        self.pronouns: Mapping[str, Sequence[str]] = language["pronouns"]
        """Words that stand for the latest value of a type, each with the types that it may be of."""
        self._fractions: WordTree = {}
        for phrase, value in language["fractions"].items():
            insert(self._fractions, phrase.split(), value)
        self._times: WordTree = {}
        for phrase, value in language["times"].items():
            insert(self._times, phrase.split(), value)
        self._number_starts = frozenset((*self._numbers, *self._multipliers, *self._fractions))
        self._units: WordTree = {}
        self._names: dict[str, WordTree] = {}
        self._listed: dict[str, dict[str, None]] = {}
        for kind in types.values():
            for unit in kind.units:
                for word in unit.words:
                    insert(self._units, word.split(), (kind.name, unit))
            if kind.kind == "names":
                self._names[kind.name] = {}
        self._facing = [phrase.split() for phrase in language["roles"].get("facing", ())]
        self.phrases = noun_phrases(self._names, language, nouns)
        self.modifiers = Modifiers(language)
        self.role_words = role_words(language)
        introducing = {phrase[0] for phrases in self.role_words.introducing.values() for phrase in phrases}
        going_on = introducing | self.role_words.particles | self.role_words.fillers | self.modifiers.starts
        firsts = {phrase.split()[0] for phrases in language["roles"].values() for phrase in phrases}
        self.ends = frozenset((",", ";", ":", ")", "\n", *(firsts - going_on)))
        """Words at which no phrase goes on beyond its own pattern."""
        self._features: Features = {}
        self._spoken: dict[tuple[str, str], str] = {}
        self._exceptions: WordTree = {}
        for phrase in language["roles"].get("except", ()):
            insert(self._exceptions, phrase.split(), True)
        self._openers: dict[str, frozenset[str]] | None = None
        self._choice_starts: frozenset[str] | None = None
        self._group_starts: frozenset[str] | None = None
        self._both = frozenset(language["roles"].get("both", ()))

    def add_name(self, kind: str, words: str, name: str) -> None:
        """Lets the words stand for a name of a type."""
        insert(self._names[kind], words.lower().split(), name)
        self._listed.setdefault(kind, {})[name] = None
        self._spoken.setdefault((kind, name), words)
        self._openers = self._choice_starts = self._group_starts = None

    def with_names(self, names: Mapping[str, Iterable[tuple[str, str]]], features: Features | None = None) -> Values:
        """The same with further names of types, each with its words, and what those of a world are like."""
        made = Values.__new__(Values)  # what `copy` does, which takes long to import
        made.__dict__.update(self.__dict__)
        made._listed = {**self._listed, **{kind: dict(self._listed.get(kind, ())) for kind in names}}
        made._names = {**self._names, **{kind: loads(dumps(self._names[kind])) for kind in names}}
        made._features = self._features if features is None else features
        made._spoken = dict(self._spoken)
        for kind, pairs in names.items():
            for words, name in pairs:
                if not (self.types[kind].names and self._has(kind, words)):
                    made.add_name(kind, words, name)
        return made

    def _has(self, kind: str, words: str) -> bool:
        """Whether words are a name of a type."""
        found = find(self._names[kind], [*words.lower().split(), "\n"], 0)
        return found is not None and found[1] == len(words.split())

    @property
    def openers(self) -> Mapping[str, frozenset[str]]:
        """The words of letters alone, and the marks, that a value of a type may begin with; no others begin one.

        A type that is not in it may begin at any.
        """
        if self._openers is None:
            numbers = self._number_starts
            quantities = numbers | self._joiner | self._units.keys()
            self._openers = {
                kind: frozenset((*tree, *self.pronouns, *self.choice_starts, *self.group_starts))
                for kind, tree in self._names.items()
            }
            if PLACE in self._openers:
                self._openers[PLACE] |= {"("}
            for kind, value_type in self.types.items():
                if value_type.kind in ("number", "quantity"):
                    self._openers[kind] = numbers if value_type.kind == "number" else quantities
                elif value_type.kind == "time":
                    self._openers[kind] = numbers | self._times.keys()
        return self._openers

    def names_tree(self, kind: str) -> WordTree:
        """The words of the names of a type."""
        return self._names[kind]

    def word_trees(self) -> list[WordTree]:
        """The words of numbers and units."""
        return [
            self._units,
            self._fractions,
            self._times,
            *({word: {} for word in table} for table in (self._numbers, self._multipliers)),
        ]

    def is_number(self, words: Sequence[str]) -> bool:
        """Whether the words are a number, and nothing else."""
        text = split(Source(" ".join(words)), Orthography())
        number = self.number(text, 0)
        return number is not None and number[1] == len(text.words) - 2

    def names(self, kind: str) -> list[str]:
        """The names that a slot of the type takes, as they are in a tree."""
        found: dict[str, None] = {}
        stack: list[Any] = [self._names[kind]]
        while stack:
            node = stack.pop()
            for key, child in node.items():
                if key == END:
                    found[child] = None
                else:
                    stack.append(child)
        return sorted(found)

    def listed(self, kind: str) -> tuple[str, ...]:
        """The same names in the order of the files and facts that bring them."""
        return tuple(self._listed.get(kind, ()))

    def noun(self, text: Words, at: int) -> tuple[Description, int] | None:
        """All names that a noun such as `places` or `red cup` is for, and where it ends."""
        return self.phrases.noun(text, at, self.names_tree)

    @property
    def choice_starts(self) -> frozenset[str]:
        """The words at which a noun phrase may begin."""
        if self._choice_starts is None:
            self._choice_starts = self.phrases.starts(self.names_tree)
        return self._choice_starts

    def choice(self, text: Words, at: int) -> tuple[Description, int] | None:
        """Of words such as `every place` and `the red cup` which names they are for, and where they end."""
        return self.phrases.longest(text, at, self.names_tree) if text.words[at] in self.choice_starts else None

    def choices(self, kind: str) -> list[list[str]]:
        """The words that stand for all names of a type, and for those that are chosen, in the first way to say them."""
        likes = [parts for _, parts in self._features.get(kind, ())]
        return (
            [words.split() for words in self.phrases.said(kind, likes, self._spoken)] if self._listed.get(kind) else []
        )

    def spoken(self, kind: str, name: str) -> str:
        """The first words for a name of a type: `boxes` for the kinds "box"."""
        return self._spoken.get((kind, name), name)

    def said_names(self, kind: str) -> list[str]:
        """The same as a mission says them."""
        return sorted({self.spoken(kind, name) for name in self.names(kind)})

    def choice_words(self, choice: Choice) -> str:
        """The words that stand for a choice: `nearest person`."""
        behind = tuple(part for part in choice.parts if part[0] in RELATIONS or part[0] in DENIED)
        parts = dict(part for part in choice.parts if part not in behind)
        count, name, color = parts.pop(COUNT, ""), parts.pop(NAME, ""), ""
        if name:
            color = parts.pop("color", "")
            head = " ".join(filter(None, (color and self.spoken("color", color), self.spoken(choice.type, name))))
        else:
            head = self.phrases.words(Description(choice.type, choice.how, tuple(parts.items())), self._spoken)
        if not head:
            return choice.text
        if count:
            head = f"{count} {head.partition(' ')[2]}"
        return " ".join(filter(None, (head, self.modifiers.said(behind, self.spoken))))

    def meant_by(self, text: str) -> tuple[str, ...]:
        """The name that a port text is, or all that are described as its choice is."""
        choice = choice_of(text)
        return self.described(Description(choice.type, ALL, choice.parts)) if choice and choice.parts else (text,)

    def described(self, meant: Description) -> tuple[str, ...]:
        """The names of a type that have the parts of a description, in the order of the world."""
        if not meant.parts:
            return self.listed(meant.type)
        return tuple(name for name, parts in self._features.get(meant.type, ()) if set(meant.parts) <= set(parts))

    @property
    def group_starts(self) -> frozenset[str]:
        """The words at which a set of several may begin: numbers, `both`, plurals."""
        if self._group_starts is None:
            self._group_starts = self.phrases.plural_starts(self.names_tree) | self._numbers.keys() | self._both
        return self._group_starts

    def groups(self, text: Words, at: int, is_bare: bool = False) -> Iterator[tuple[Description, int]]:
        """The sets that words describe, and where each ends; the shortest first.

        `every cup on the table`, `two red cups`, `the cups except the blue one`; where it `is_bare` also `red cup`.
        """
        found, count = self.choice(text, at), ""
        if found is None or found[0].how != ALL:
            start = at
            if text.words[at] in self._both:
                count, start = "2", at + 1
            elif (number := self.number(text, at)) is not None and number[0] >= 1 and number[0] == int(number[0]):
                count, start = str(int(number[0])), number[1]
            found = self.phrases.plural(text, start, self.names_tree)
            if found is None or not (count or is_bare or text.words[at] in self.group_starts):
                return
        meant, end = found
        parts: Parts = (*meant.parts, *([(COUNT, count)] if count else []))
        ways = [(parts, end)]
        if text.words[end] in self.modifiers.starts:
            ways += [
                ((*parts, *more), last) for more, last in self.modifiers.behind(meant.type, text, end, self.names_tree)
            ]
        for some, last in ways:
            yield meant.replace(how=ALL, parts=tuple(sorted(some))), last
            left_out = self._left_out(meant, text, last)
            if left_out is not None:
                yield meant.replace(how=ALL, parts=tuple(sorted((*some, *left_out[0])))), left_out[1]

    def _left_out(self, meant: Description, text: Words, at: int) -> tuple[Parts, int] | None:
        """What stands behind `except` as what the things are not: `the blue one`, `the red cups`."""
        at = self.exception(text, at)
        if not at:
            return None
        found = self.phrases.plural(text, at, self.names_tree) or self.choice(text, at)
        parts = dict(found[0].parts) if found is not None else {}
        named = find(self._names[meant.type], text.words, at)
        if named is not None and (found is None or named[1] >= found[1]):
            return (("not_kind", named[0]),), named[1]
        if found is None or not parts.keys() <= {"color", "kind"}:
            return None
        if "color" in parts and parts.get("kind") in (None, dict(meant.parts).get("kind")):
            return (("not_color", parts["color"]),), found[1]
        return ((("not_kind", parts["kind"]),), found[1]) if parts.keys() == {"kind"} else None

    def members(self, choice: Choice) -> tuple[str, ...]:
        """The names of a set where what is known of the world decides; () where only the robot can tell."""
        parts = dict(choice.parts)
        denied = {part: parts.pop(part).split("; ") for part in DENIED if part in parts}
        if COUNT in parts or parts.keys() & RELATIONS.keys():
            return ()
        names = self.described(Description(choice.type, ALL, tuple(parts.items())))
        likes = dict(self._features.get(choice.type, ()))
        if denied.get("not_color") and not all("color" in dict(likes.get(name, ())) for name in names):
            return ()

        def is_denied(name: str) -> bool:
            like = dict(likes.get(name, ()))
            of_kind = name in denied.get("not_kind", ()) or like.get("kind") in denied.get("not_kind", ())
            return of_kind or like.get("color") in denied.get("not_color", ())

        return tuple(name for name in names if not is_denied(name))

    def is_listed(self, meant: Description) -> bool:
        """Whether what is known of the world decides which names are meant."""
        parts = dict(meant.parts)
        return not (parts.keys() & {COUNT, *DENIED, *RELATIONS})

    def exception(self, text: Words, at: int) -> int:
        """Where a word such as `except` ends, 0 if there is none."""
        found = find(self._exceptions, text.words, at)
        return found[1] if found is not None else 0

    def takes_word(self, kind: str, word: str) -> bool:
        """Whether the one word is a value of the type."""
        value_type = self.types[kind]
        if value_type.kind == "names":
            return END in self._names[kind].get(word, {})
        if value_type.kind == "time":
            return isinstance(self._times.get(word, {}).get(END), str)
        return value_type.kind == "text" or (value_type.kind == "number" and word in self._numbers)

    def read(self, kind: str, text: Words, at: int) -> tuple[str, int] | None:
        """The port text of a value of the type and where it ends, or None if there is none."""
        value_type = self.types[kind]
        if value_type.kind == "quantity":
            quantity = self.quantity(text, at)
            if quantity is None or quantity[1] != kind or _too_small(quantity[0], value_type):
                return None
            return format_number(quantity[0]), quantity[2]
        if value_type.kind == "number":
            return self._plain_number(value_type, text, at)
        if value_type.kind == "names":
            word = text.words[at]
            if word == "(" and kind == PLACE:
                return self._point_text(text, at)
            found = find(self._names[kind], text.words, at)
            if found is None and word[0] == '"':
                found = self._quoted_name(kind, text, at)
            return found
        if value_type.kind == "time":
            return self.time_of_day(text, at)
        return self._text(text, at)

    def time_of_day(self, text: Words, at: int) -> tuple[str, int] | None:
        """`6 pm`, `7:30 am`, `18:30` or `noon` as a port text of 24 hours (18:30), and where it ends."""
        word = text.words[at]
        named = find(self._times, text.words, at)
        if named is not None and isinstance(named[0], str):
            return named
        if ":" in word and word[0].isdecimal():
            hours, _, minutes = word.partition(":")
            if len(hours) > 2 or len(minutes) != 2 or int(minutes) > 59:
                return None
            number: tuple[float, int] | None = float(hours), at + 1
        else:
            minutes, number = "", self.number(text, at)
        if number is None:
            return None
        hour, end = number
        half = self.half_of_day(text, end)
        if half is not None:
            hour, end = (hour % 12 + half[0] if 1 <= hour <= 12 else -1), half[1]
        if hour not in range(24) or not (minutes or half):
            return None
        return f"{int(hour):02}:{int(minutes or 0):02}", end

    def half_of_day(self, text: Words, at: int) -> tuple[int, int] | None:
        """The hours that a word such as `pm` behind a number adds, and where it ends."""
        found = find(self._times, text.words, at)
        return found if found is not None and isinstance(found[0], int) else None

    @property
    def halves_of_day(self) -> list[str]:
        """The words for which `half_of_day` looks, where they are one word."""
        return [word for word, node in self._times.items() if isinstance(node.get(END), int)]

    def quantity(self, text: Words, at: int) -> tuple[float, str, int] | None:
        """A number with a unit: its value in the base unit, the name of the type, and where it ends."""
        number = self.number(text, at)
        if number is None:
            if at not in text.articles and not (at and text.words[at - 1] in self._one_each):
                return None
            number = 1.0, at  # "a minute", "every hour"
        value, after = number
        if text.words[after] in self._joiner:
            after += 1
        unit = find(self._units, text.words, after)
        if unit is None:
            return None
        (kind, unit_of), end = unit
        half = find(self._fractions, text.words, end)  # "a minute and a half"
        if half is not None and half[1] > end + 1 and not find(self._units, text.words, half[1]):
            value, end = value + half[0], half[1]
        amount = value * unit_of.numerator / unit_of.denominator
        return (amount, kind, end) if abs(amount) <= _LARGEST else None

    def number(self, text: Words, at: int) -> tuple[float, int] | None:
        """A number in figures or words, fractions included, and where it ends."""
        words = text.words
        word = words[at]
        if not (word in self._number_starts or word[0].isdecimal() or "-" in word):
            return None  # as nearly always
        value, start = self._whole_number(words, at)
        fraction = find(self._fractions, words, start)
        if fraction is not None:
            value, start = (value or 0) + fraction[0], fraction[1]
        return None if value is None or abs(value) > _LARGEST else (value, start)

    def _whole_number(self, words: Sequence[str], at: int) -> tuple[float | None, int]:
        word = words[at]
        if word[0].isdecimal() or (word[0] == "-" and word[1:2].isdecimal()):
            if ":" in word:
                return None, at
            value = float(word)
            return (value, at + 1) if abs(value) <= _LARGEST else (None, at)
        total: float | None = None
        last = at + _MOST_NUMBER_WORDS
        while True:
            pieces = words[at].split("-")  # "twenty-five"
            if at == last or not all(p in self._numbers or p in self._multipliers for p in pieces):
                return total, at
            for piece in pieces:
                if piece in self._multipliers:
                    total = (total if total is not None else 1) * self._multipliers[piece]
                else:
                    total = (total or 0) + self._numbers[piece]
            at += 1

    def point(self, text: Words, at: int) -> tuple[float, float, float | None, int] | None:
        """`(x, y)` in metres, with or without a direction in degrees that it faces, and where it ends."""
        numbers: list[float] = []
        for mark in ("(", ","):
            number = self._metres(text, at + 1) if text.words[at] == mark else None
            if number is None or abs(number[0]) > _FARTHEST:
                return None
            numbers.append(number[0])
            at = number[1]
        if text.words[at] != ")":
            return None
        at += 1
        for words in self._facing:
            last = at + len(words)
            angle = self.quantity(text, last) if text.words[at:last] == words else None
            if angle is not None and angle[1] == "angle":
                return numbers[0], numbers[1], angle[0], angle[2]
        return numbers[0], numbers[1], None, at

    def point_text(self, x: str, y: str, facing: str | None) -> str:
        """A point as it is written."""
        where = f"({x}, {y})"
        if facing is None:
            return where
        return f"{where} {' '.join(self._facing[0])} {with_unit(facing, self.types['angle'].units[0].words[0])}"

    def _metres(self, text: Words, at: int) -> tuple[float, int] | None:
        quantity = self.quantity(text, at)
        if quantity is not None:
            return (quantity[0], quantity[2]) if quantity[1] == "length" else None
        return self.number(text, at)

    def _point_text(self, text: Words, at: int) -> tuple[str, int] | None:
        point = self.point(text, at)
        if point is None:
            return None
        x, y, facing, end = point
        angle = None if facing is None else format_number(facing)
        return self.point_text(format_number(x), format_number(y), angle), end

    def _plain_number(self, value_type: ValueType, text: Words, at: int) -> tuple[str, int] | None:
        number = self.number(text, at)
        if number is None or find(self._units, text.words, number[1]):
            return None
        value, end = number
        if (value_type.whole and value != int(value)) or _too_small(value, value_type):
            return None
        return format_number(value), end

    def _text(self, text: Words, at: int) -> tuple[str, int] | None:
        word = text.words[at]
        if word[0] == '"':
            return word[1:], at + 1
        bare = word[0].isalnum() or (word[0] == "-" and len(word) > 1)
        ends_here = not bare or word in self._connectives
        if at in text.articles and ends_here:  # the article is all that there is: `print a`
            start, end = text.articles[at]
            return text.source.text[start:end], at
        return (text.source.text[text.starts[at] : text.ends[at]], at + 1) if bare else None

    def _quoted_name(self, kind: str, text: Words, at: int) -> tuple[str, int] | None:
        word = text.words[at]
        words = [*self._orthography.words(word[1:]), "\n"]
        found = find(self._names[kind], words, 0) if len(words) > 1 else None
        return (found[0], at + 1) if found and found[1] == len(words) - 1 else None


def key_of(words: Iterable[str]) -> str:
    """The key on the blackboard of a name of several words.

    `name` is another one in XML: as the port of a SubTree it would be the name of that node.
    """
    key = re.sub(r"\W", "_", "_".join(words))
    return key if key != "name" else "name_"


def _too_small(value: float, value_type: ValueType) -> bool:
    return value_type.least is not None and value < value_type.least
