"""What is known while a mission is read: the values that it names itself, and what pronouns stand for."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set

from btlang.support.record import Record
from btlang.text.words import END_OF_TEXT, Words
from btlang.vocabulary.descriptions import NAME
from btlang.vocabulary.entry import MANNER
from btlang.vocabulary.match import SlotValue
from btlang.vocabulary.nouns import Description
from btlang.vocabulary.references import ALL, LATEST, NAMES, SELF, Choice, Parts, choice_of, is_one, is_related, key_of
from btlang.vocabulary.value_type import DOOR, OBJECT, PERSON, PLACE, WORLD, ZONE, format_number
from btlang.vocabulary.values import Values
from btlang.vocabulary.word_tree import find


def _description(written: str) -> tuple[str, Parts] | None:
    """Return how a value is chosen and by what, of a name too; None for a reference or a point."""
    choice = choice_of(written)
    if choice is not None:
        return choice.how, choice.parts
    return None if written[:1] in ("", "{", "(") else ("nearest", ((NAME, written),))


_OTHER_SORT = {PLACE: ZONE, ZONE: PLACE}
"""What a region is, too."""


class Known(Record):
    """A value that the mission names itself: its key on the blackboard, and the types that it can be used as.

    Without types it can be used as any: they aren't known yet. One `is_chosen` by the robot gives way to others.
    """

    key: str
    words: tuple[str, ...]
    kinds: tuple[str, ...] = ()
    is_chosen: bool = False


class ReadingContext:
    """Reads values at a place in a text, those too that only the mission knows.

    `known` are the values that it names, by key; None where any name in braces is one. `latest` are the values that
    pronouns stand for, by type; each reader of a text sets them, on its own context. `lacked` says that a pronoun
    stood for nothing: behind other values it might stand for one. `keys` are those for what is chosen, by type, where
    they aren't the names of the types; `met` are those that have been chosen by now, each with whether that is a set.
    """

    __slots__ = (
        "_most_words", "before", "deniable", "denials", "joiners", "keys", "known", "lacked", "latest", "listed",
        "manners", "met", "modifiers", "of_kind", "openers", "pronouns", "reached", "same", "set_starts", "starts",
        "types", "untyped", "values",
    )  # fmt: skip

    def __init__(self, values: Values, known: Mapping[str, Known] | None = None) -> None:
        self.values = values
        self.types, self.joiners, self.pronouns = values.types, values.joiners, values.pronouns
        self.starts = values.choice_starts
        self.modifiers = values.modifiers.starts | {word for word, of in self.pronouns.items() if tuple(of) == (PLACE,)}
        self.set_starts = values.choice_starts | values.group_starts
        """The words of letters alone at which a set of names may begin."""
        self.denials, self.deniable = frozenset(values.adjectives.denials), values.deniable
        """Words before an adjective that deny it, and the first words of those adjectives."""
        self.before = values.adjective_starts | values.names_tree("color").keys()
        self.manners = values.names_tree(MANNER) if MANNER in values.types else {}
        self.latest: dict[str, str] = {}
        self.reached: list[tuple[int, str, str]] = []
        """The names to which journeys led, each with the word at which it stands and its type."""
        self.same: dict[int, int] = {}
        """Where what is read is the latest of its type once more, with the words that it ends at."""
        self.listed: dict[str, str] = {}
        """Where the latest values of a type are a list, the set of them; "" where no word stands for it."""
        self.of_kind: dict[str, str] = {}
        """The latest thing or person of each kind, as the latest values are."""
        self.lacked = False
        self.met: dict[str, bool] = {}
        self.keys: Mapping[str, str] = {}
        self.known: Mapping[str, Known] | None = {}
        self.untyped: Set[str] = frozenset()
        """Where any name in braces is a value, the keys of those that are of any type."""
        self.openers: Mapping[str, frozenset[str]] = {}
        """As those of the values; where the mission names values itself without braces, any may begin at any word."""
        self._most_words = 0
        self.set_known(known or {})

    def set_known(self, known: Mapping[str, Known]) -> None:
        """The values that the mission names where reading goes on."""
        self.known = known
        self.openers = {} if known else self.values.openers
        self._most_words = max((len(value.words) for value in known.values()), default=0)

    def with_references(self) -> ReadingContext:
        """The same, where any name in braces is a value of any type, and with pronouns of its own."""
        made = ReadingContext(self.values)
        made.known = None
        return made

    def read(self, kind: str, text: Words, at: int) -> tuple[str, int] | None:
        """The port text of a value of the type and where it ends, or None if there is none."""
        if at in self.same and kind in self.latest:
            return self.latest[kind], self.same[at]
        if self.known != {}:
            known = self._known(kind, text, at)
            if known is not None:
                return known
        found = self.values.read(kind, text, at)
        if found is None and text.words[at] in self.values.pronoun_words and self.types[kind].kind == "names":
            found = self._referred(kind, text, at)
        chosen = self._chosen(kind, text, at) if text.words[at] in self.starts else None
        if chosen is not None and at not in text.articles:
            chosen = self.values.antecedents.by_name(kind, text, at, chosen, self.latest.get(PERSON, ""))
        elif chosen is not None and self.of_kind:
            chosen = self.values.antecedents.of_its_kind(self, kind, text, at, chosen)
        if kind in WORLD and not self.joiners.isdisjoint(text.words[max(at - 1, 0) : at + 4]):
            shared = self.values.shared_heads.read(kind, text, at)
            found = shared if shared is not None and (found is None or shared[1] > found[1]) else found
        if found is None and kind in WORLD:
            named = self._named_after(kind, text, at) if text.words[at] in self.before else None
            if named is None and not text.distinct.isdisjoint(self.values.ones):
                named = self.values.antecedents.named(kind, text, at)
            named = named or self.values.shared_heads.behind_last(kind, text, at) or self._said_again(kind, text, at)
            latest = self.latest.get(kind, "") if kind == PLACE and named is None and chosen is not None else ""
            is_set = kind in self.listed or self.met.get(latest[1:-1], False)
            if (is_set or latest[:1] not in ("", "{")) and self.values.antecedents.is_same(text, at, latest):
                return None if is_set else (latest, at + 1)  # `go to A and B. If nobody is in the room`
            return named if named is not None and (chosen is None or named[1] > chosen[1]) else chosen
        return chosen if found is None or (chosen is not None and chosen[1] > found[1]) else found

    def ways(self, kind: str, text: Words, at: int) -> Iterator[tuple[str, int]]:
        """Every value of a type that begins at a word and where it ends: the plain one, then with what describes it."""
        value = self.read(kind, text, at)
        yield from () if value is None else (value, *self.wider(kind, text, at, value))

    def sets(self, kind: str, text: Words, at: int) -> Iterator[tuple[str, Description, int]]:
        """The sets of names of a type that begin at a word: the choice of all, what is meant, and where it ends.

        Without a choice where what is known of the world leaves none.
        """
        for meant, end in self.values.groups(text, at, kind) if kind in WORLD else ():
            spoken = self._spoken_of(meant, text, at) if meant.type == kind else None
            if spoken is not None:
                parts = spoken or self._settled(kind, meant.parts)
                choice = self._spoken_of_before(Choice(ALL, kind, self.keys.get(kind, kind), parts), text, at)
                there = self._place_behind(kind, text, end) if "inside" not in dict(parts) else ""
                if not there or kind != PERSON:
                    yield "" if self.values.likenesses.members(choice) == () else choice.text, meant, end
                if there:  # `everyone there`
                    placed = meant.replace(parts=tuple(sorted((*parts, ("inside", there)))))
                    yield choice.replace(parts=placed.parts).text, placed, end + 1

    def _spoken_of_before(self, every: Choice, text: Words, at: int) -> Choice:
        """`if more than 3 people are in the lab, tell the people "Hi"`: those of a set that was spoken of there."""
        said = choice_of(self.listed.get(every.type, "")) if every.type == PERSON else None
        article = text.source.text[slice(*text.articles[at])].lower() if at in text.articles else ""
        if said is None or article != self.values.definite or not {"at", "inside"} & {name for name, _ in said.parts}:
            return every
        rest = tuple(part for part in said.parts if part[0] not in ("at", "inside"))
        return said if rest == every.parts else every

    def _place_behind(self, kind: str, text: Words, at: int) -> str:
        """The place for which `there` stands behind a set: one, or that of each round; "" for none."""
        if PLACE not in self.pronouns.get(text.words[at], ()) or text.words[at + 1] in self.values.texts.inverting:
            return ""  # `all there is tea`
        self.lacked |= PLACE not in self.latest
        latest, each = self.latest.get(PLACE, ""), choice_of(self.listed.get(PLACE, ""))
        if PLACE in self.listed:  # `go to the lab and the hall and greet everybody there`
            return f"{{{each.key}}}" if each is not None and kind == PERSON else ""
        is_known = latest[:1] != "{" or latest[1:-1] in {*self.met, *(self.known or ())}
        return latest if is_known and kind in (PERSON, OBJECT) else ""

    def _spoken_of(self, meant: Description, text: Words, at: int) -> Parts | None:
        """`in each room`, `in both rooms` behind journeys: the names to which the statement or the one before led.

        () where all are meant, None for `both` of more or fewer than two.
        """
        here, place = (text, at) if text.picked is None else (text.picked[0], text.picked[1][at])
        is_both = text.words[at] in self.values.both
        if not is_both and (text.words[at] not in self.values.each or here.words[place - 1] not in self.values.located):
            return ()
        self.lacked = True
        names = self.values.likenesses.described(meant.uncounted())
        spoken = self._led_to(meant.type, names, here, place)
        if len(spoken) == 2 or (not is_both and len(spoken) > 2):
            return ((NAMES, ";".join(spoken)),)
        return None if is_both and len(names) != 2 else ()

    def _led_to(self, kind: str, names: Sequence[str], text: Words, at: int) -> tuple[str, ...]:
        """To which names of a type the statement at a word led, or the one before."""
        first = text.earlier(at)[1]
        first = text.earlier(first - 1)[1] if first else 0
        led = [name for where, of, name in self.reached if where >= first and of == kind and name in names]
        return tuple(dict.fromkeys(led))

    def stops(self, text: Words, at: int) -> str:
        """The set of the places to which the statement at a word led, or the one before; "" for fewer than two."""
        led = self._led_to(PLACE, self.values.listed(PLACE), text, at)
        parts = ((NAMES, ";".join(led)),)
        return Choice(ALL, PLACE, self.keys.get(PLACE, PLACE), parts).text if len(led) > 1 else ""

    def without(self, group: str, text: Words, at: int) -> tuple[str, int] | None:
        """The choice of a set without what is left out at a word, `except the red one`, and where that ends."""
        choice = choice_of(group) if self.values.exception(text, at) else None
        if choice is None:
            return None
        left_out = self.values.left_out(Description(choice.type, ALL, choice.parts), text, at)
        if left_out is None or not {part for part, _ in left_out[0]}.isdisjoint(dict(choice.parts)):
            return None
        fewer = choice.replace(parts=tuple(sorted((*choice.parts, *left_out[0]))))
        return "" if self.values.likenesses.members(fewer) == () else fewer.text, left_out[1]

    def wider(self, kind: str, text: Words, at: int, value: tuple[str, int] | None) -> Iterator[tuple[str, int]]:
        """What a value is with what describes it (`the cup` as `the cup on the table`), the shortest first."""
        if value is None or kind not in WORLD or text.words[value[1]] not in self.modifiers:
            return  # as nearly always
        end = value[1]
        described, of = _description(value[0]), self.values.modifiers.relation(kind, text, end)
        if of is not None and of[0] == "off" and self.pronouns.get(text.words[of[1]]) == [PERSON]:
            whom = (("off", self.latest.get(PERSON, "")),)  # `take the cup from him`
            if described is None or whom[0][1]:
                yield self.described(kind, described[0], (*described[1], *whom)) if described else value[0], of[1] + 1
        if described is None:
            return
        how, parts = described
        is_there = kind in (PLACE, OBJECT) and PLACE in self.pronouns.get(text.words[end], ())
        there = self.latest.get(PLACE, "") if is_there else ""
        if there and (kind == OBJECT or there[:1] != "{"):  # `on the table there`
            placed = self.inside(kind, value[0], there)
            if placed:
                yield placed, end + 1
        for more, last in self.values.modifiers.behind(kind, text, end, self.values.names_tree):
            if text.words[at] in self.values.pronoun_words and any(part != "off" for part, _ in more):
                continue  # `put it on the table` isn't about what is on the table
            if self.values.likenesses.may_say(kind, parts, more):
                yield self.described(kind, how, (*parts, *more)), last

    def inside(self, kind: str, written: str, place: str) -> str:
        """What a value is in a place, which may be a reference; "" where it can't be described so."""
        how, parts = _description(written) or ("", ())
        more = (("inside", place),)
        return (
            self.described(kind, how, (*parts, *more))
            if how and self.values.likenesses.may_say(kind, parts, more)
            else ""
        )

    def may_list_on(self, text: Words, at: int) -> bool:
        """Whether a list may go on at a word: with a comma, a joiner, or, in a spoken list, an article."""
        return text.words[at] in self.joiners or at in text.articles

    def wider_list(self, text: Words, listed: SlotValue) -> Iterator[SlotValue]:
        """The lists that what stands behind one makes of all its values: `the cup and the bottle from the lab`.

        None where a value has such words of its own: the last one has them alone then.
        """
        kind, end = listed.type, listed.last
        if kind not in WORLD or text.words[end] not in self.modifiers or any(map(is_related, listed.texts)):
            return
        ways = [{last: said for said, last in self.wider(kind, text, end - 1, (each, end))} for each in listed.texts]
        for last, said in ways[0].items():
            if all(last in way for way in ways):
                yield listed.replace(text=said, more=tuple(way[last] for way in ways[1:]), last=last)

    def _named_after(self, kind: str, text: Words, at: int) -> tuple[str, int] | None:
        """A name with what may stand before it: `the red ball 2`, `my phone`, `any door`."""
        names, best = self.values.names_tree, None
        for parts, start in self.values.modifiers.before(text, at, names):
            named = find(names(kind), text.words, start)
            if named is not None and self.values.likenesses.may_say(kind, (), parts):
                best = self.described(kind, "nearest", (*parts, (NAME, named[0]))) if parts else named[0], named[1]
        return best

    def described(self, kind: str, how: str, parts: Parts) -> str:
        """The choice of a name that has these parts."""
        return Choice(how, kind, self.keys.get(kind, kind), self._settled(kind, tuple(sorted(parts)))).text

    def _settled(self, kind: str, parts: Parts) -> Parts:
        """With the latest value of a type in the place of `another`; a place is another one than where the robot is."""
        if all(value != LATEST for _, value in parts):
            return parts  # as nearly always
        latest = self.latest.get(kind, "")
        known = latest if latest and choice_of(latest) is None else SELF if kind == PLACE else ""
        return tuple((name, known if value == LATEST else value) for name, value in parts if known or value != LATEST)

    def any(self, text: Words, at: int) -> tuple[tuple[str, ...], str, int] | None:
        """A value of any type: the types that it can be, its port text, and where it ends."""
        reference = self.reference(text, at)
        if reference is not None and self.known and reference[0] in self.known:
            return self.known[reference[0]].kinds, f"{{{reference[0]}}}", reference[1]
        chosen = self.choice(text, at)
        if chosen is not None:
            kind, end = chosen[0].type, chosen[1]
            return (kind,), (self._chosen(kind, text, at) or ("", end))[0], end
        quantity = self.values.quantity(text, at)
        if quantity is not None:
            return self.values.same_quantities(text, at), format_number(quantity[0]), quantity[2]
        sorts = ("number", "names", "time", "text")
        kinds = [name for sort in sorts for name, kind in self.types.items() if kind.kind == sort]
        read = [(kind, self.read(kind, text, at)) for kind in kinds]
        found = [(kind, value) for kind, value in read if value is not None]
        if not found:
            return None
        if len(found) > 1 and self.types[found[0][0]].kind == "number":
            found.pop()  # figures are a text only where one is wanted
        best, end = max((value for _, value in found), key=lambda value: value[1])
        return tuple(kind for kind, (other, last) in found if last == end and other.lower() == best.lower()), best, end

    def forget(self) -> None:
        """Pronouns stand for nothing any more."""
        self.latest.clear()
        self.listed.clear()
        self.of_kind.clear()
        self.reached.clear()

    def choice(self, text: Words, at: int, kind: str = "") -> tuple[Description, int] | None:
        """See `Values.choice`."""
        return self.values.choice(text, at, kind)

    def named(self, text: Words, at: int) -> tuple[Known | None, int] | None:
        """The value that the mission names at a place, None for an unknown one in braces, and where its name ends."""
        reference = self.reference(text, at)
        if reference is not None:
            known = self.known.get(reference[0]) if self.known else None
            return known, reference[1] if known is not None else at + 1
        return self._bare(text.words, at)

    def _known(self, kind: str, text: Words, at: int) -> tuple[str, int] | None:
        """A value that the mission names: in braces, or bare where no text is wanted and no name is longer."""
        reference = self.reference(text, at)
        if reference is not None:
            key, end = reference
            if self.known is None or (key in self.known and self._fits(kind, self.known[key])):
                return f"{{{key}}}", end
        elif self.known and self.types[kind].kind != "text":
            found = self._bare(text.words, at)
            if found is not None and self._fits(kind, found[0]):
                named = self._listed(kind, text, at)
                if found[0].is_chosen and found[0].key not in self.met and self._chosen(kind, text, at) is not None:
                    return None  # `a person`, who is chosen here
                if named is None or named[1] <= found[1]:
                    return f"{{{found[0].key}}}", found[1]
        return None

    def _bare(self, words: Sequence[str], at: int) -> tuple[Known, int] | None:
        """The value with the longest name that stands at a place without braces, and where it ends."""
        for end in range(at + self._most_words if self.known else at, at, -1):
            named = tuple(words[at:end])
            known = self.known.get(key_of(named)) if self.known else None
            if known is not None and known.words == named:
                return known, end
        return None

    def _fits(self, kind: str, known: Known) -> bool:
        """Whether a slot of the type takes the value; one of text takes any, and a number may be a count."""
        if not known.kinds or kind in known.kinds or kind == "text":
            return True
        return self.types[kind].kind == self.types[known.kinds[0]].kind == "number"

    def _listed(self, kind: str, text: Words, at: int) -> tuple[str, int] | None:
        """A name from the list of a type, unquoted."""
        return find(self.values.names_tree(kind), text.words, at) if self.types[kind].kind == "names" else None

    @staticmethod
    def reference(text: Words, at: int) -> tuple[str, int] | None:
        """The key of a name in braces at a place, and where it ends; None for anything else."""
        words = text.words
        if words[at] != "{":
            return None
        end = at + 1
        while words[end][0].isalnum() or words[end][0] == "_":
            end += 1
        return (key_of(words[at + 1 : end]), end + 1) if end > at + 1 and words[end] == "}" else None

    def is_untyped(self, text: Words, at: int) -> bool:
        """Whether a name in braces stands at a place that any slot takes."""
        found = self.reference(text, at) if self.known != {} else None
        if found is None or self.known is None:
            return found is not None and found[0] in self.untyped
        return found[0] in self.known and not self.known[found[0]].kinds

    def _chosen(self, kind: str, text: Words, at: int) -> tuple[str, int] | None:
        """What is chosen of the type, to be put into a key; without a text where there is no name."""
        chosen = self.choice(text, at, kind)
        if chosen is None or not is_one(chosen[0].how):
            return None
        choice = self.described(kind, chosen[0].how, chosen[0].parts)
        return choice if self.values.listed(kind) or self.known is None else "", chosen[1]

    def _said_again(self, kind: str, text: Words, at: int) -> tuple[str, int] | None:
        """`the door` for the door that was said before, by the last word of its name, or for that of the room."""
        if kind != DOOR or at not in text.articles:
            return None
        latest, room = self.latest.get(kind, ""), self.latest.get(PLACE, "{").lower().split()
        if latest.lower().endswith(f" {text.words[at]}"):
            return latest, at + 1
        named = find(self.values.names_tree(kind), [*room, text.words[at], END_OF_TEXT], 0)
        return (named[0], at + 1) if named is not None and named[1] == len(room) + 1 else None

    def _are_things(self, types: Sequence[str]) -> bool:
        """Whether a word in the plural stands for a set of things, and somebody who is spoken of is one alone."""
        things = self.latest.get(OBJECT, "")
        is_set = OBJECT in types and things[:1] == "{" and self.met.get(things[1:-1], False)
        return is_set and PERSON not in self.listed and self.latest.get(PERSON, "{")[:1] != "{"

    def _stands_for_several(self, kind: str) -> bool:
        """Whether a word in the plural can't be the latest value alone: `the cup. Put them down`."""
        latest = self.latest.get(kind, "")
        return kind in self.listed or (kind == OBJECT and latest[:1] not in ("", "{") and not latest.endswith("s"))

    def _referred(self, kind: str, text: Words, at: int) -> tuple[str, int] | None:
        """What a pronoun stands for."""
        word, end = find(self.values.pronoun_words, text.words, at) or ("", at)
        types = self.pronouns.get(word, ())
        is_one = kind in types
        if not is_one and _OTHER_SORT.get(kind) in types:  # `avoid the lab while Bob is in it`, `don't go in there`
            is_one = self.latest.get(ZONE, "") == self.latest.get(PLACE, "")
        if is_one and word in self.values.ones:
            return self.values.antecedents.another(self, kind, text, end, self.values.modifiers)
        if kind == PERSON and word in self.values.plural_pronouns and self._are_things(types):
            return None  # `if Alice is near, take the cups to the lab, otherwise take them to the hall`
        if is_one and word in self.values.plural_pronouns and self._stands_for_several(kind):
            self.lacked |= not self.listed.get(kind)
            return (self.listed[kind], end) if self.listed.get(kind) else None
        if is_one and word in self.values.distributive and self.latest.get(kind, "")[:1] != "{":
            self.lacked = True
            return None  # `go to Alice. Go to Bob. Wave at each`
        self.lacked |= is_one and kind not in self.latest
        return (self.latest[kind], end) if is_one and kind in self.latest else None
