"""What a phrase says: its token, of one with values its entry with arguments, one for each port."""

from __future__ import annotations

from collections.abc import Iterable

from btlang.diagnostics.diagnostic import diagnostic
from btlang.frontends.mission.explanations.times import assumed_times
from btlang.frontends.mission.symbols.nodes import GivenTwice, read_detail, read_details, unreadable
from btlang.frontends.mission.token import Called, Listed, Token, arguments_of
from btlang.frontends.mission.tokens.mentions import ODD, Mentions
from btlang.frontends.mission.tokens.two_goals import two_goals
from btlang.text.source import Span
from btlang.text.words import END_OF_STATEMENT, END_OF_TEXT
from btlang.vocabulary.entry import MANNER, Entry
from btlang.vocabulary.match import Match, SlotValue
from btlang.vocabulary.references import ALL, COUNT, NAMES, Choice, choice_of, key_of, keys_in, point_ports, renamed
from btlang.vocabulary.trie import TrieNode, longest
from btlang.vocabulary.value_type import PLACE

NEGATED = frozenset(("negated", "negated_twice"))
"""The roles of conditions that say `not` themselves."""
_ENDS = (END_OF_STATEMENT, END_OF_TEXT, ";", ")")


def _leaves_none(value: SlotValue) -> bool:
    """Whether words leave out by name every name that there is: `everyone except Alice`."""
    choice = choice_of(value.group)
    return not value.text and choice is not None and [name for name, _ in choice.parts] == ["not_kind"]


def _alone(value: SlotValue) -> SlotValue:
    """The nearest one for a set of one: `one cup`."""
    choice = choice_of(value.group)
    if choice is None or (COUNT, "1") not in choice.parts:
        return value
    parts = tuple(part for part in choice.parts if part != (COUNT, "1"))
    alone: SlotValue = value.replace(text=choice.replace(how="nearest", parts=parts).text, more=(), group="")
    return alone


def _keys(text: str) -> Iterable[str]:
    """The keys that a port text refers to, or into which it chooses."""
    choice = choice_of(text)
    return keys_in(text) if choice is None else (choice.key,)


def _sets_of(token: Token) -> list[Choice]:
    """The sets of all things of a kind that a command has."""
    texts = [text for _, text in token.value.arguments] if isinstance(token.value, Called) else []
    return [of for of in map(choice_of, texts) if of is not None and of.how == ALL]


class Calls(Mentions):
    """Makes tokens of the phrases of one text; what is wrong with their values becomes `problems`."""

    def token(self, match: Match, at: int) -> Token:
        """The token of a phrase."""
        text, meaning = self._text, match.meaning
        match = self._with_held(match) if self._held else match
        values = match.values
        for value in values if self._sorts else ():
            self._note_sort(value)
        for value in values if self._owners else ():
            self._note_owners(value)
        self.problems += assumed_times(text, values) if text.assumed else ()
        if any(value.group and value.type == PLACE for value in values):
            from btlang.frontends.mission.explanations.kinds import find_unclear_rooms  # most missions have no such set

            self.problems += find_unclear_rooms(text, values, self._vocabulary)
        twice = two_goals(match, at, text, self._vocabulary) if len(values) > 1 else None
        if twice is not None:
            self.problems.append(twice)
        start, end = text.starts[at], text.ends[match.last - 1]
        if values and values[-1].first == match.last:  # the article was the value: `print a`
            end = text.articles[match.last][1]
        if meaning.entry is not None:
            kind = "condition" if meaning.role in NEGATED else meaning.role
            match = self._with_lists(match) if self._context.listed else match
            for value in values if self._alternatives else ():
                self._write_down(value.text)
                for key in keys_in(value.text):
                    self._write_down(f"{{{key}}}")
            made = Token(kind, start, end, self._called(meaning.entry, match, at))
            if text.has_shared_places and match.last > at:
                made.words = range(at, match.last)
            if isinstance(made.value, Listed) and made.value.joiner in ("and", "") and kind == "command":
                listed = next(value for value in match.values if value.more)
                is_odd = any(text[:1] in ODD for text in listed.texts)  # no round: where each one is would be lost
                self._lists = {} if is_odd else {listed.type: (made, listed)}
            elif isinstance(made.value, Listed) and made.value.joiner == "or" and kind == "command":
                listed = next(value for value in match.values if value.more)
                self._alternatives[self._reference(listed.type)] = made, listed
            return made
        if values:
            return Token(meaning.role, start, end, ";".join(values[0].texts))
        return Token(meaning.role, start, end, str(meaning.value) if meaning.value else None, meaning.between)

    def with_details(self, token: Token, at: int, names: TrieNode) -> int:
        """Adds what `called` and `with` say of the phrase before a word to its token. Returns where to go on."""
        said = token.value
        if not isinstance(said, Called) or said.entry.sort not in ("action", "condition"):
            return at
        is_own = read_detail(self._text, at, self._vocabulary) is not None
        if not is_own and longest(self._vocabulary.trie, self._text, at, self._context) is not None:
            return at  # `with 5 s in between`
        try:
            read = read_details(self._text, at, dict(said.arguments), self._vocabulary, names)
        except GivenTwice as problem:
            self.problems.append(unreadable(self._text, at, problem))
            return next(end for end in range(problem.at, len(self._text.words)) if self._text.words[end] in _ENDS)
        if read is None:
            return at
        token.value, token.end = said.replace(details=read[0]), self._text.ends[read[1] - 1]
        return read[1]

    def end_statement(self) -> None:
        """A round doesn't reach beyond its statement: there `them` is another one of the same things."""
        self._lists.clear()
        self.end_otherwise()

    @staticmethod
    def is_set(token: Token) -> bool:
        """Whether a command is done once for each thing of a set."""
        return bool(_sets_of(token))

    def is_round(self, token: Token, goal: str) -> bool:
        """Whether a command is done once for each thing of a set, or of a list that is made one: `goal`."""
        choice = choice_of(goal)
        if choice is not None and choice.type in self._lists and self._lists[choice.type][0] is token:
            self._make_round(choice, token, self._lists.pop(choice.type)[1].name)
            return True
        return any(f"{{{of.key}}}" == goal for of in _sets_of(token))

    def make_round(self, token: Token, goal: str) -> bool:
        """Makes a command that is done with a list, or a set, one round for each; False where these are others."""
        choice, said = choice_of(goal), token.value
        if choice is None or choice.how != ALL:
            return False
        if isinstance(said, Listed) and said.joiner in ("and", ""):
            names = dict(choice.parts).get(NAMES, "").split(";")
            slots = [
                name for name, text in said.arguments[0] if any(dict(each)[name] != text for each in said.arguments)
            ]
            if len(slots) != 1 or [dict(each)[slots[0]] for each in said.arguments] != names:
                return False
            self._make_round(choice, token, slots[0])
            return True
        return self.has_set(token, choice)

    def has_set(self, token: Token, choice: Choice) -> bool:
        """Whether a command is done with a set of the same things."""
        members = self._vocabulary.values.likenesses.members
        return any(of.text == choice.text or (members(of) or ()) == members(choice) for of in _sets_of(token))

    def _make_round(self, choice: Choice, token: Token, slot: str) -> None:
        """Makes a set of the list that a command has, whose thing is from there on that of the round."""
        assert isinstance(token.value, Listed)
        arguments = dict(token.value.arguments[0]) | {slot: choice.text}
        token.value = Called(token.value.entry, tuple(arguments.items()))
        self._context.latest[choice.type] = f"{{{choice.key}}}"
        self._context.listed.pop(choice.type, None)

    def _with_lists(self, match: Match) -> Match:
        """The same, with the thing of each round in the place of a pronoun for a list, or of `each room` for it."""
        values, listed = [], self._context.listed.values()
        for value in match.values:
            before = self._lists[value.type][0].value if value.group in listed and value.type in self._lists else None
            if isinstance(before, Listed) and before.entry != match.meaning.entry:
                value = value.replace(text=value.group, more=(), joiner="", group="")
            if value.text and value.text in listed:
                choice, made = choice_of(value.text), self._lists.pop(value.type, None)
                assert choice is not None
                if made is not None and isinstance(made[0].value, Listed):
                    self._make_round(choice, made[0], made[1].name)
                    value = value.replace(text=f"{{{choice.key}}}")
                else:
                    value = value.replace(group=value.text)
            values.append(value)
        changed: Match = match.replace(values=tuple(values))
        return changed

    def is_alternative(self, token: Token, reference: str) -> bool:
        """Whether a value is the one of a command's alternatives that succeeds."""
        return reference in self._alternatives and self._alternatives[reference][0] is token

    def search_on(self, search: Token, further: Match) -> bool | None:
        """`look for the cup in the kitchen, then in the lab`: one search, which ends where it succeeds.

        Returns whether it is one, None where it isn't clear.
        """
        said, entry = search.value, further.meaning.entry
        if not isinstance(said, Called | Listed) or entry is not said.entry or not entry.first:
            return False
        places = [value for value in further.values if value.type == PLACE]
        before = [dict(each) for each in arguments_of(said)]
        names = {value.name for value in places}
        added = dict(self.arguments(entry, [value.replace(more=()) for value in further.values]))
        if len({tuple((name, each[name]) for name in each if name not in names) for each in before}) > 1:
            return None  # `look for Bob and Alice in the kitchen, then in the lab`
        if any(added[name] != each.get(name) for each in before for name in added.keys() - names):
            return False if all(text[:1] not in ODD for text in added.values()) else None
        name = places[0].name if len(places) == 1 else ""
        if not name or any(each.get(name, "")[:1] in ODD for each in (*before, added)):
            return None
        more = (tuple({**added, name: text}.items()) for text in places[0].texts)
        reference = self._reference(PLACE)
        search.value = Listed(entry, (*arguments_of(said), *more), "or")
        self._alternatives[reference], self._context.latest[PLACE] = (search, places[0]), reference
        return True

    def _write_down(self, reference: str) -> None:
        """A pronoun stands for the alternative that succeeds, which is written down."""
        made = self._alternatives.get(reference)
        if made is not None and isinstance(made[0].value, Listed):
            made[0].value = made[0].value.replace(writes=(reference[1:-1], made[1].type, made[1].name))

    def _called(self, entry: Entry, match: Match, at: int) -> Called | Listed:
        """The entry with its arguments, or with several of them where one slot holds a list."""
        if entry.sort == "value" and not (self._context.known and entry.id in self._context.known):
            self._unknown_value(self._text.span(at, match.last), entry.id)
        arguments = []
        if self.manner and any(slot.name == MANNER for slot in entry.slots):
            if all(value.name != MANNER for value in match.values):
                given = SlotValue(MANNER, MANNER, self.manner, match.last, match.last)
                match = match.replace(values=(*match.values, given))
        if entry.first:
            match = match.replace(values=tuple(map(self._anywhere, match.values)))
        sets = [value for value in match.values if value.group and not _leaves_none(value)]
        if len(sets) > 1:
            match = match.replace(values=tuple(map(_alone, match.values)))  # `bring one cup to each guest`
            sets = [value for value in match.values if value.group and not _leaves_none(value)]
        if len(sets) > 1 and all(value.first >= at for value in sets):
            words = self._text.span(at, match.last)
            self.problems.append(diagnostic("BT034", words, words=words.text))
        if sets and entry.sort in ("action", "name"):
            values = [value.replace(text=value.group, more=()) if value in sets else value for value in match.values]
            match = match.replace(values=tuple(values))
        for value in match.values:
            text = value.text
            if value.more or text[:1] in ODD or "{" in text:
                break
            arguments.append((value.name, text))
        else:
            return Called(entry, tuple(arguments))  # as nearly always
        self._check_choices(entry, match, at)
        lists = [place for place, value in enumerate(match.values) if value.more]
        if not lists:
            return Called(entry, self.arguments(entry, match.values))
        if len(lists) > 1:
            self.problems.append(
                diagnostic("BT034", self._text.span(at, match.last), words=self._text.span(at, match.last).text)
            )
        value = match.values[lists[0]]
        each = [value.replace(text=text, more=()) for text in value.texts]
        before, behind = match.values[: lists[0]], match.values[lists[0] + 1 :]
        joiner = "or" if entry.first and value.type == PLACE else value.joiner
        if entry.constrains == "keep out" and joiner == "or":
            joiner = "and"  # `never enter the hall or the lab`: neither
        return Listed(entry, tuple(self.arguments(entry, (*before, one, *behind)) for one in each), joiner)

    def _anywhere(self, value: SlotValue) -> SlotValue:
        """`look for the book in any room`: in all of them, until it is found."""
        choice = choice_of(value.text) if value.type == PLACE and not value.more else None
        if choice is None or self._text.words[value.first] not in self._vocabulary.asking["any_place"]:
            return value
        made: SlotValue = value.replace(group=choice.replace(how=ALL).text)
        return made

    def _check_choices(self, entry: Entry, match: Match, at: int) -> None:
        """BT152 where what is chosen would replace another value of the phrase, or is to be compared with."""
        lists = [{text for text in value.texts if text[:1] == "{"} for value in match.values]
        choices = [choice for texts in lists for text in texts if (choice := choice_of(text)) is not None]
        keys = [key for texts in lists for key in {key for text in texts for key in _keys(text)}]
        double = next((choice for choice in choices if keys.count(choice.key) > 1 or entry.sort == "value"), None)
        if double is None:
            return
        words = self._vocabulary.values.choice_words(double)
        set_to = f"{self._vocabulary.word('set')} first {self._vocabulary.word('set_to')} {words}"
        reason = f"it needs a {double.type} that is chosen before"
        span = self._text.span(at, match.last)
        self.problems.append(
            diagnostic(
                "BT152", span, words=span.text, reason=reason, advice=f"Write it in two lines, the first: {set_to}"
            )
        )

    def arguments(self, entry: Entry, values: Iterable[SlotValue]) -> tuple[tuple[str, str], ...]:
        """The values as ports; a point has ports of its own."""
        found: list[tuple[str, str]] = []
        for value in values:
            ports = point_ports(value.text) if value.type == PLACE else ()
            if ports and entry.point_ports.issuperset(name for name, _ in ports):
                found += ports
            else:
                found.append((value.name, self.port_text(value)))
        return tuple(found)

    def port_text(self, value: SlotValue) -> str:
        """The text of a value; the names in braces in it become keys (BT043 where nothing has such a name)."""
        text = value.text
        if self._context.types[value.type].kind == "names" and text[:1] in ("", "("):
            from btlang.frontends.mission.explanations import nameless  # most values have names

            self.problems.append(nameless.explained(self._text, value, self._vocabulary, self._context))
        if "{" not in text or self._context.types[value.type].kind != "text":
            return text
        text = renamed(text, lambda name: key_of(self._vocabulary.orthography.words(name)))
        known = self._context.known or {}
        for key in keys_in(text):
            if key not in known:
                self._unknown_value(self._text.span(value.first, value.last), key)
        return text

    def _unknown_value(self, span: Span, key: str) -> None:
        from btlang.frontends.mission.explanations.mission_values import unknown_value

        self.problems.append(unknown_value(span, key, self._context.known or (), self._vocabulary))
