"""Values in slots: names, described things and text. `measures.py` has numbers, `reading_context.py` the others.

A value becomes the text of a port, in the unit whose factor is 1: `half a meter` is "0.5", `two minutes` is "120".
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from marshal import dumps, loads  # a copy of a trie, at a tenth of the time that importing `copy` takes

from btlang.text.source import Source
from btlang.text.words import Orthography, Words, split
from btlang.vocabulary.adjectives import OF, OWNER, UNSLOTTED
from btlang.vocabulary.antecedents import Antecedents
from btlang.vocabulary.descriptions import NAME, Modifiers
from btlang.vocabulary.entry import MANNER, SIDE
from btlang.vocabulary.likenesses import Likenesses
from btlang.vocabulary.measures import Measures, too_small
from btlang.vocabulary.noun_reader import NounReader
from btlang.vocabulary.nouns import Description, Features, Noun, noun_phrases, plural
from btlang.vocabulary.references import ALL, COUNT, DENIED, QUALITIES, RELATIONS, Choice, Parts, choice_of
from btlang.vocabulary.role_words import role_words
from btlang.vocabulary.shared_heads import SharedHeads
from btlang.vocabulary.texts import Texts
from btlang.vocabulary.value_type import DOOR, PLACE, ValueType, format_number
from btlang.vocabulary.word_tree import END, WordTree, find, insert, tree_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class Values(Measures):
    """Reads values at a place in a text. `types` by name; `language` holds the word tables of the language.

    Nothing of it changes once the names are added, so all missions of a process share it.
    """

    def __init__(self, types: Mapping[str, ValueType], language: Mapping[str, Any], nouns: Iterable[Noun] = ()) -> None:
        super().__init__(types, language)
        titles = frozenset(language["titles"])
        self._orthography = Orthography(titles.union(language["articles"]), titles=titles)
        joining = (phrase for role in ("and", "or", "nor") for phrase in language["roles"].get(role, ()))
        self.joiners = frozenset((",", *(phrase.split()[0] for phrase in joining)))
        """The first words of what stands between the values of a list."""
        self.pronouns: Mapping[str, Sequence[str]] = language["pronouns"]
        """Words that stand for the latest value of a type, each with the types that it may be of."""
        self.plural_pronouns = frozenset(language["plural_pronouns"])  # also for a list
        self.pronoun_words = tree_of((words, words) for words in self.pronouns)
        self._names: dict[str, WordTree] = {kind.name: {} for kind in types.values() if kind.kind == "names"}
        self._listed: dict[str, dict[str, None]] = {}
        self.modifiers = Modifiers(language)
        self.adjectives = self.modifiers.adjectives
        self.phrases = noun_phrases(self._names, language, nouns, self.adjectives)
        self.role_words = role_words(language, self.modifiers.starts)
        self.ones, self.definite = frozenset(language["ones"]), "".join(language["articles"][:1])
        """Words in the place of a noun that was said before: `the blue one`."""
        self.likenesses = Likenesses({}, self.listed)
        self.texts = Texts(language)
        self._plural_endings, self._belonging = language["plural_endings"], frozenset(language["belonging"])
        nouns_of = [*language.get("nouns", {}).values()]
        self._singular = {noun for words in nouns_of for noun in words if plural(noun, self._plural_endings) in words}
        self._spoken: dict[tuple[str, str], str] = {}
        self._exceptions = tree_of((phrase, True) for phrase in language["roles"].get("except", ()))
        self._without = {phrase.split()[0] for phrase in language["roles"].get("without_entering", ())}
        self._openers: dict[str, frozenset[str]] | None
        self._choice_starts: frozenset[str] | None
        self._group_starts: frozenset[str] | None
        self._forget()
        roles, asking = language["roles"], language.get("asking", {})
        self.both, self._every, joined = (frozenset(roles.get(role, ())) for role in ("both", "all_names", "and"))
        self._joining = joined | frozenset(roles.get("or", ()))
        self.distributive = {words for words in self.plural_pronouns if words.split()[0] in self.both | self._every}
        self.each, self.located = (frozenset(asking.get(name, ())) for name in ("apiece", "located"))

    def add_name(self, kind: str, words: str, name: str) -> None:
        """Lets the words stand for a name of a type."""
        for said in self.adjectives.ways(kind, words):
            insert(self._names[kind], self._as_read(said), name)
            for denied in self.adjectives.denied(said) if OF.get(kind) in self._names else ():
                insert(self._names[OF[kind]], self._as_read(denied), name)
        self._listed.setdefault(kind, {})[name] = None
        self._spoken.setdefault((kind, name), words)
        self._forget()

    def _forget(self) -> None:
        """Lets what was learnt from the names be learnt again: there are others now."""
        self._openers = self._choice_starts = self._group_starts = None
        self.shared_heads = SharedHeads(self.names_tree, self.joiners, self._plural_endings, self._belonging)
        self._described = NounReader(self.phrases, self.names_tree, self.likenesses)
        said_again = self.ones, self.role_words.prepositions, self.definite
        self.antecedents = Antecedents(*said_again, self.names_tree, self.likenesses, self.adjectives)

    def with_names(
        self, names: Mapping[str, Iterable[tuple[str, str]]], features: Features | None, articles: frozenset[str]
    ) -> Values:
        """The same with further names of types, each with its words, and what those of a world are like.

        `articles` are the words that say nothing in names.
        """
        made = Values.__new__(Values)  # what `copy` does, which takes long to import
        made.__dict__.update(self.__dict__)
        made._orthography = self._orthography.replace(articles=articles)
        made._listed = {**self._listed, **{kind: dict(self._listed.get(kind, ())) for kind in names}}
        changed = {*names, *(OF[kind] for kind in names if kind in OF)} & self._names.keys()
        made._names = {**self._names, **{kind: loads(dumps(self._names[kind])) for kind in changed}}
        made.likenesses = Likenesses(self.likenesses.features if features is None else features, made.listed)
        made._forget()
        made._spoken = dict(self._spoken)
        for kind, pairs in names.items():
            for words, name in pairs:
                if not (self.types[kind].names and self._has(kind, words)):
                    made.add_name(kind, words, name)
        if OWNER in names:
            people, owners = (dict(names.get(kind, ())) for kind in ("person", OWNER))
            made._names[OWNER] = self.adjectives.owners(people, owners)
        return made

    def _has(self, kind: str, words: str) -> bool:
        """Whether words are a name of a type."""
        read = self._as_read(words)
        found = find(self._names[kind], [*read, "\n"], 0)
        return found is not None and found[1] == len(read)

    def _as_read(self, words: str) -> list[str]:
        """The words of a name as they are read in a text, with its marks: `nurses' station`, `class 3b`."""
        if words.replace(" ", "").isalpha():
            return words.lower().split()  # as nearly always
        return split(Source(words), self._orthography).words[:-2] or words.lower().split()

    @property
    def openers(self) -> Mapping[str, frozenset[str]]:
        """The words of letters alone, and the marks, that a value of a type may begin with; no others begin one.

        A type that is not in it may begin at any.
        """
        if self._openers is None:
            numbers, firsts = self._number_starts, self.shared_heads.plural_firsts
            quantities = numbers | self._joiner | self._units.keys() | self._every_second | self.further
            self._openers = {
                kind: frozenset((*tree, *self.pronoun_words, *self.choice_starts, *self.group_starts, *firsts(kind)))
                for kind, tree in self._names.items()
            }
            if PLACE in self._openers:
                self._openers[PLACE] |= {"("}
            if DOOR in self._openers:  # `the kitchen door`, then `the door`
                self._openers[DOOR] |= {name.lower().rpartition(" ")[2] for name in self.listed(DOOR) if " " in name}
            for kind, value_type in self.types.items():
                if value_type.kind in ("number", "quantity"):
                    self._openers[kind] = numbers if value_type.kind == "number" else quantities
                elif value_type.kind == "time":
                    self._openers[kind] = numbers | self._times.keys()
        return self._openers

    def names_tree(self, kind: str) -> WordTree:
        """The words of the names of a type, none where the language has no such type."""
        return self._names.get(kind, {})

    def word_trees(self) -> list[WordTree]:
        """The words of numbers and units."""
        return [
            self._units,
            self._fractions,
            self._times,
            *({word: {} for word in table} for table in (self._numbers, self._multipliers)),
        ]

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
        return self._described.all(text, at)

    @property
    def choice_starts(self) -> frozenset[str]:
        """The words at which a noun phrase may begin."""
        if self._choice_starts is None:
            self._choice_starts = self.phrases.starts(self.names_tree) | self.adjective_starts
        return self._choice_starts

    @property
    def deniable(self) -> frozenset[str]:
        """The words with which an adjective begins that can be denied before a head: `non-red`."""
        return frozenset(word for part in OF if part != "kind" for word in self.names_tree(part))

    @property
    def adjective_starts(self) -> frozenset[str]:
        """The words at which what stands before a head may begin: `my`, `big`."""
        return self._described.adjective_starts

    def choice(self, text: Words, at: int, kind: str = "") -> tuple[Description, int] | None:
        """Of words such as `every place` and `the red cup` which names they are for, and where they end."""
        if text.words[at] not in self.choice_starts:
            return None
        memo: dict[tuple[int, str], Any] = text.memo.setdefault(self, {})
        if (at, kind) not in memo:
            memo[at, kind] = self._resolved(self._described.one(text, at, kind), text, at)
        return memo[at, kind]  # type: ignore[no-any-return]

    def _resolved(self, found: tuple[Description, int] | None, text: Words, at: int) -> tuple[Description, int] | None:
        """What is described, None where a bare noun such as `object` describes nothing."""
        if found is None:
            return None
        meant, end = found
        if end == at + 1 and not meant.parts and self.phrases.is_type(meant.type, text, at):
            return found if at in text.articles else None  # `an object`
        return self.antecedents.resolved(found, text, at)

    def begins_noun(self, kind: str, text: Words, at: int) -> bool:
        """Whether a name or a noun of a type begins at a word."""
        if find(self.names_tree(kind), text.words, at) is not None or self.phrases.is_type(kind, text, at):
            return True
        of = find(self.names_tree("kinds"), text.words, at) or find(self.names_tree("kind"), text.words, at)
        return of is not None and kind in self.likenesses.types_of(of[0])

    def choices(self, kind: str) -> list[list[str]]:
        """The words that stand for all names of a type, and for those that are chosen, in the first way to say them."""
        if kind in (MANNER, SIDE) or "_" in kind or not self._listed.get(kind):
            return []  # nobody says `every spoken_language`
        likes = [parts for _, parts in self.likenesses.features.get(kind, ())]
        return [words.split() for words in self.phrases.said(kind, likes, self._spoken)]

    def spoken(self, kind: str, name: str) -> str:
        """The first words for a name of a type: `boxes` for the kinds "box"."""
        return self._spoken.get((kind, name), name)

    def said_names(self, kind: str) -> list[str]:
        """The same as a mission says them."""
        return sorted({self.spoken(kind, name) for name in self.names(kind)})

    def choice_words(self, choice: Choice) -> str:
        """The words that stand for a choice: `nearest person`."""
        behind = tuple(part for part in choice.parts if part[0] in (*RELATIONS, *DENIED, *QUALITIES))
        parts = dict(part for part in choice.parts if part not in behind)
        count, name = parts.pop(COUNT, ""), parts.pop(NAME, "")
        if name:
            before = self.modifiers.said_before(tuple(parts.items()), self.spoken)
            head = " ".join(filter(None, (before, self.spoken(choice.type, name))))
        else:
            adjectives = tuple((part, parts.pop(part)) for part in UNSLOTTED if part in parts)
            before = self.modifiers.said_before(adjectives, self.spoken)
            head = self.phrases.words(Description(choice.type, choice.how, tuple(parts.items())), self._spoken, before)
        if not head:
            return choice.text
        if count:
            head = f"{count} {plural(head.partition(' ')[2], self._plural_endings)}"
        return " ".join(filter(None, (head, self.modifiers.said(behind, self.spoken))))

    def meant_by(self, text: str) -> tuple[str, ...]:
        """The name that a port text is, or all that are described as its choice is."""
        choice = choice_of(text)
        return (
            self.likenesses.described(Description(choice.type, ALL, choice.parts))
            if choice and choice.parts
            else (text,)
        )

    @property
    def group_starts(self) -> frozenset[str]:
        """The words at which a set of several may begin: numbers, `both`, plurals."""
        if self._group_starts is None:
            self._group_starts = (
                self.phrases.plural_starts(self.names_tree) | self.adjective_starts | self._numbers.keys() | self.both
            )
        return self._group_starts

    def groups(self, text: Words, at: int, kind: str = "", is_bare: bool = False) -> Iterator[tuple[Description, int]]:
        """The sets that words describe, and where each ends; the shortest first.

        `every cup on the table`, `two red cups`, `the cups except the blue one`; where it `is_bare` also `red cup`.
        """
        if text.words[at] in self._every and (number := self.number(text, at + 1)) is not None:
            yield from self.likenesses.so_many(self.groups(text, at + 1, kind), number[0])  # `all three shelves`
            return
        found = one = self.choice(text, at, kind)
        count = ""
        if found is None or found[0].how != ALL:
            start = at
            if text.words[at] in self.both:
                count, start = "2", at + 1
            elif (number := self.number(text, at)) is not None and number[0] >= 1 and number[0] == int(number[0]):
                count, start = str(int(number[0])), number[1]
                if text.words[start] not in self.group_starts:
                    return  # `2 m`
            elif not is_bare and text.words[at] not in self.group_starts:
                return  # as nearly always
            found = self._described.several(text, start, kind)
            if not (count and found is not None and not found[0].parts):  # `two people`
                found = self._resolved(found, text, start)
            is_plural = text.words[at] in self.group_starts and (one is None or found is None or one[1] < found[1])
            is_plural = is_plural and not (found is not None and text.words[found[1] - 1] in self._singular)
            if found is None or not (count or is_bare or is_plural):
                return  # `cup` and `sheep` are no plurals
        meant, end = found
        parts: Parts = (*meant.parts, *([(COUNT, count)] if count else []))
        ways = [(parts, end)]
        if text.words[end] in self.modifiers.starts:
            ways += [
                ((*parts, *more), last)
                for more, last in self.modifiers.behind_all(meant.type, text, end, self.names_tree)
                if self.likenesses.may_say(meant.type, parts, more)
            ]
        for some, last in ways:
            yield meant.replace(how=ALL, parts=tuple(sorted(some))), last
            left_out = self.left_out(meant, text, last)
            if left_out is not None:
                yield meant.replace(how=ALL, parts=tuple(sorted((*some, *left_out[0])))), left_out[1]

    def left_out(self, meant: Description, text: Words, at: int) -> tuple[Parts, int] | None:
        """What stands behind `except` as what the things are not: `the blue one`, `Alice and Bob`."""
        found: dict[str, list[str]] = {}
        last = at = self.exception(text, at)
        while at:
            one = self._left_out_one(meant, text, at)
            if one is None:
                break
            part, value, last = one
            found.setdefault(part, []).append(value)
            at = last + (text.words[last] == ",")
            at += text.words[at] in self._joining
            at = at if at > last else 0
        parts = tuple((part, "; ".join(values)) for part, values in found.items())
        return (parts, last) if found else None

    def _left_out_one(self, meant: Description, text: Words, at: int) -> tuple[str, str, int] | None:
        kind = meant.type
        found = self._described.several(text, at, kind) or self.choice(text, at, kind)
        found = self._resolved(found, text, at)
        if found is not None and self.modifiers.is_picked(found[0].how, text, at):
            return None
        parts = dict(found[0].parts) if found is not None else {}
        named = find(self._names[kind], text.words, at)
        if named is not None and (found is None or named[1] >= found[1]):
            return "not_kind", named[0], named[1]
        if found is None:
            color = find(self.names_tree("color"), text.words, at)
            return ("not_color", *color) if color is not None else None  # `each cup except the red`
        if parts.keys() == {"kind"}:
            return "not_kind", parts["kind"], found[1]
        if parts.pop("kind", None) not in (None, dict(meant.parts).get("kind")):
            return None
        [(part, value), *others] = parts.items() or [("", "")]
        return (OF[part], value, found[1]) if part in OF and not others else None

    def exception(self, text: Words, at: int) -> int:
        """Where a word such as `except` ends, 0 if there is none."""
        found = find(self._exceptions, text.words, at)
        return 0 if found is None or text.words[found[1]] in self._without else found[1]

    def takes_word(self, kind: str, word: str) -> bool:
        """Whether the one word is a value of the type."""
        value_type = self.types[kind]
        if value_type.kind == "names":
            return END in self._names[kind].get(word, {})
        if value_type.kind == "time":
            return isinstance(self._times.get(word, {}).get(END), str)
        if value_type.kind == "text":
            return not self.texts.opens(word)
        return value_type.kind == "number" and word in self._numbers

    def read(self, kind: str, text: Words, at: int) -> tuple[str, int] | None:
        """The port text of a value of the type and where it ends, or None if there is none."""
        value_type = self.types[kind]
        if value_type.kind == "quantity":
            quantity = self.quantity(text, at, (kind,))
            if quantity is None or quantity[1] != kind or too_small(quantity[0], value_type):
                return None
            return format_number(quantity[0]), quantity[2]
        if value_type.kind == "number":
            return self._plain_number(value_type, text, at)
        if value_type.kind == "names":
            word = text.words[at]
            if word == "(" and kind == PLACE:
                return self._point_text(text, at)
            found = find(self._names[kind], text.words, at)
            return self._quoted_name(kind, text, at) if found is None and word[0] == '"' else found
        if value_type.kind == "time":
            return self.later_time(text, at) or self.time_of_day(text, at)
        return self.texts.read(text, at)

    def _quoted_name(self, kind: str, text: Words, at: int) -> tuple[str, int] | None:
        word = text.words[at]
        words = [*self._orthography.words(word[1:]), "\n"]
        found = find(self._names[kind], words, 0) if len(words) > 1 else None
        return (found[0], at + 1) if found and found[1] == len(words) - 1 else None
