"""What pronouns stand for behind a phrase: the values that it has, and what it is about."""

from __future__ import annotations

from collections.abc import Sequence

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.token import Token
from btlang.frontends.mission.tokens.counted_things import COUNTED
from btlang.frontends.mission.tokens.settling import HOLDS
from btlang.text.source import Source
from btlang.text.words import END_OF_TEXT, Words, split
from btlang.tree.answers import ANSWERED, ASK, SOMEBODY_SAYS
from btlang.vocabulary.adjectives import OWNER
from btlang.vocabulary.antecedents import pronouns_for
from btlang.vocabulary.capabilities import HOLDING, MOVES
from btlang.vocabulary.descriptions import NAME
from btlang.vocabulary.entry import Entry
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.match import Match, SlotValue
from btlang.vocabulary.reading_context import ReadingContext
from btlang.vocabulary.references import ALL, NAMES, SELF, SPEAKING, Choice, choice_of, free_key
from btlang.vocabulary.value_type import DOOR, KINDS, OBJECT, PERSON, PLACE, TEXT, WORLD, ZONE
from btlang.vocabulary.word_tree import find

_SEVERAL = {"PeopleAt": PERSON, "ObjectsAt": OBJECT}  # conditions about so many of them
_MEETS = "SomeoneNear"  # the condition that holds once a command for nobody in particular is done
_HOLDS_ANY = "HoldingSomething"  # the condition that a hand holds anything
_UNKNOWN = "{"
ODD = ("", "{", "(")
"""How texts begin that are no plain values: of unknown names, references, choices and points."""

_WHERE = {PLACE: "at", DOOR: "near"}
"""How somebody is described who is met there."""


class Mentions:
    """Those of one text; what is wrong with them becomes `problems`."""

    def __init__(self, text: Words, vocabulary: Lexicon, context: ReadingContext, problems: list[Diagnostic]) -> None:
        self._text, self._vocabulary, self._context, self.problems = text, vocabulary, context, problems
        self.manner = ""
        """How all journeys are made whose command says nothing else: `drive slowly`."""
        self._themes: tuple[str, list[str]] = "", []
        """The id of the command that was read last, and the things that it and those before it with that id had."""
        self._held, self._passed = "", ""
        """What the robot has taken up, and the thing to which it only went, or at which it looked, since then."""
        self._named_at = 0
        """Where somebody was named last by a command."""
        self._denied: Match | None = None
        """The latest condition, where it says that something is not so."""
        self._lists: dict[str, tuple[Token, SlotValue]] = {}
        self._alternatives: dict[str, tuple[Token, SlotValue]] = {}  # by the reference to the one that succeeds
        self._otherwise: set[str] = set()  # the types whose latest values are those of `otherwise`, and only in it
        # in most missions nobody is spoken of by a pronoun
        self.speaks_of_people = not text.distinct.isdisjoint(pronouns_for(vocabulary.values.pronouns, PERSON))
        sorts = vocabulary.values.phrases.sorts_of_people if vocabulary.values.listed(PERSON) else {}
        self._sorts = {} if text.distinct.isdisjoint(sorts) else sorts
        self._owners = not text.distinct.isdisjoint(vocabulary.values.names_tree(OWNER))

    def _reference(self, kind: str) -> str:
        """To the value that stands for the one of several alternatives that succeeds."""
        return f"{{{free_key(kind, self._context.known or {})}}}"

    def says_who(self, match: Match) -> bool:
        """Whether pronouns may stand for something else behind a phrase: its values, people, or what is held."""
        entry = match.meaning.entry
        return bool(match.values) or self.speaks_of_people or (entry is not None and entry.id == _HOLDS_ANY)

    def note(self, match: Match, joint: str = "") -> None:
        """What pronouns stand for from here on: of alternatives only the run knows which one it was.

        `joint` is the kind of the token before: what follows `otherwise` is known until `end_otherwise`.
        """
        before = dict(self._context.latest) if joint in ("or", "otherwise") else {}
        entry, role = match.meaning.entry, match.meaning.role
        if self.speaks_of_people and entry is not None and role != "negated":
            self._note_somebody(entry, match)
        elif role == "otherwise" and self._denied is not None and self._denied.meaning.entry is not None:
            self._note_somebody(
                self._denied.meaning.entry, self._denied
            )  # `if nobody is near, A, otherwise wave at them`
        if role in ("condition", "negated"):
            self._denied = match if role == "negated" else None
        self._note_values(match)
        if entry is not None and role in ("command", "condition"):
            self._note_counted(entry, match)
            self._note_held(entry, match)
        for kind, value in before.items():
            if self._context.latest.get(kind, value) == value:
                continue
            if joint == "otherwise":
                self._otherwise.add(kind)
            else:
                del self._context.latest[kind]

    def end_otherwise(self) -> None:
        """Let pronouns stand for nothing that was spoken of last in what is done otherwise."""
        for kind in self._otherwise:
            self._context.latest.pop(kind, None)
        self._otherwise.clear()

    def _note_somebody(self, entry: Entry, match: Match) -> None:
        """`wait until someone comes, then greet them`, `if someone is in the lab, greet them`: the nearest one."""
        somebody = self._vocabulary.negative_subjects.keys()
        names_none = all(slot.type != PERSON for slot in entry.slots)
        is_somebody = entry.phrases and not somebody.isdisjoint(entry.phrases[0].split())
        if names_none and (is_somebody or _MEETS in entry.achieves):
            exception = self._vocabulary.word("unless") in self._text.words[self._named_at : match.last]
            if exception and self._named_at and PERSON in self._context.latest:
                return  # `bring Alice the cup, unless somebody is near. Tell her "Hi"`
            places = [value for value in match.values if value.type in _WHERE and not value.more]
            parts = tuple((_WHERE[value.type], value.text) for value in places if value.text[:1] not in ODD)
            self.note_somebody(parts, SPEAKING if entry.id == SOMEBODY_SAYS else "nearest")

    def note_somebody(self, parts: tuple[tuple[str, str], ...] = (), how: str = "nearest") -> None:
        """Make pronouns stand for the nearest person of whom these parts are true, or for who spoke last."""
        key = self._context.keys.get(PERSON, PERSON)
        self._context.latest[PERSON] = Choice(how, PERSON, key, parts).text
        self._context.listed.pop(PERSON, None)

    def _note_counted(self, entry: Entry, match: Match) -> None:
        """`count the people in the lab, then greet them`: all of those that are there, or in view."""
        kind = COUNTED.get(entry.id) or _SEVERAL.get(entry.id, "")
        place = next((value.text for value in match.values if value.type == PLACE and not value.more), "")
        if not kind or place[:1] in ODD[1:]:
            return
        kinds = tuple(("kind", value.text) for value in match.values if value.type == KINDS)
        kind = PERSON if any(PERSON in self._vocabulary.values.likenesses.types_of(of) for _, of in kinds) else kind
        relation = "at" if kind == PERSON else "inside"
        where = ((relation, place),) if place else (("seen_by", SELF),)
        key = self._context.keys.get(kind, kind)
        self._lists.pop(kind, None)
        self._context.listed[kind] = Choice(ALL, kind, key, tuple(sorted((*kinds, *where)))).text

    def _note_held(self, entry: Entry, match: Match) -> None:
        """Keep what the robot holds apart from a thing that it only goes to, or looks at."""
        things = [value for value in match.values if value.type == OBJECT]
        if entry.id == _HOLDS_ANY and match.meaning.role == "condition":  # `if you are holding something, put it down`
            key = self._context.keys.get(OBJECT, OBJECT)
            self._context.latest[OBJECT] = Choice("nearest", OBJECT, key, (("held_by", SELF),)).text
            self._context.listed.pop(OBJECT, None)
        latest = self._context.latest.get(OBJECT, "")
        if HOLDS in entry.achieves:
            self._held, self._passed = latest if things else "", ""
        elif HOLDING in entry.needs:
            self._held, self._passed = "", ""
        elif things:
            is_passed = match.meaning.role == "command" and not entry.first
            self._passed = latest if is_passed else ""  # what was looked for, or asked about, may be meant
            if latest == self._held:
                self._held = _UNKNOWN  # another choice in its place

    def _with_held(self, match: Match) -> Match:
        """`pick up the cup, go to the book and put it down`: the cup. BT150 where it isn't clear."""
        entry = match.meaning.entry
        if entry is None or not self._passed or HOLDING not in entry.needs or HOLDS in entry.achieves:
            return match
        pronouns, values = self._vocabulary.values.pronoun_words, list[SlotValue]()
        for value in match.values:
            is_passed = value.type == OBJECT and value.text == self._passed and not (value.more or value.group)
            if is_passed and find(pronouns, self._text.words, value.first) is not None:
                if self._held == _UNKNOWN:
                    it, reason = self._text.span(value.first, value.last), "it may be what the robot holds"
                    problem = diagnostic("BT150", it, words=it.text, reason=reason, example=entry.example)
                    self.problems.append(problem)
                else:
                    value = value.replace(text=self._held)
            values.append(value)
        changed: Match = match.replace(values=tuple(values))
        return changed

    def _note_values(self, match: Match) -> None:
        for value in sorted(match.values, key=lambda value: value.name == value.type):  # a theme last: `it` prefers it
            entry = match.meaning.entry
            names = tuple(map(_name, value.texts)) if value.more else ()
            if entry is not None and MOVES in entry.resources and value.type in WORLD:
                plain = (text for text in value.texts if text[:1] not in ODD)
                self._context.reached += [(value.first, value.type, text) for text in plain]
            is_odd = any(text[:1] in ODD for text in names)
            if value.more and (value.joiner == "or" or (entry is not None and entry.first and value.type == PLACE)):
                self._context.latest.pop(value.type, None)
                self._context.listed.pop(value.type, None)
                if match.meaning.role == "command" and not is_odd:
                    self._context.latest[value.type] = self._reference(value.type)
                continue
            self._context.listed.pop(value.type, None)
            names = names or self._same_themes(match, value)
            if len(names) > 1 and not value.group:
                key = self._context.keys.get(value.type, value.type)
                group = Choice(ALL, value.type, key, ((NAMES, ";".join(names)),)).text
                self._context.listed[value.type] = "" if is_odd else group
            latest = value.group or (value.more[-1] if value.more else value.text)
            choice = choice_of(latest) if latest[:1] == "{" else None
            if choice is not None:
                where = next((text for name, text in choice.parts if name in ("at", "inside")), "{")
                if where in self._vocabulary.values.listed(PLACE) and all(v.type != PLACE for v in match.values):
                    self._context.latest[PLACE] = where  # `tell everyone in the lab "Hi" and count the people there`
                self._context.met[choice.key] = choice.how == ALL
                if choice.how == ALL and match.meaning.role != "command":  # `if all doors are open, close them`
                    self._context.listed[value.type] = latest
            self._context.latest[value.type] = f"{{{choice.key}}}" if choice is not None else latest
            if value.type in (OBJECT, PERSON):
                self._note_kind(value.type, latest, choice, is_one=not (value.more or value.group))
            if value.type == PERSON:
                is_named = latest[:1] != "{" or (choice is not None and NAME in dict(choice.parts))
                self._named_at = value.last if match.meaning.role == "command" and is_named else 0
            asks = "" if entry is None or value.type != TEXT else entry.id
            if asks == ANSWERED or (asks == ASK and OBJECT not in self._context.latest):  # `if he wants the cup`
                self.note_asked(split(Source(latest), self._vocabulary.orthography).words)
            if value.type in (PLACE, ZONE) and latest in self._vocabulary.values.listed(DOOR):
                self._context.latest[DOOR] = latest  # `if somebody is at the front door, open it`
            if value.type == PLACE and latest in self._vocabulary.values.listed(ZONE):
                self._context.latest[ZONE] = latest  # `go to the lab, then leave it`
            if value.type == ZONE and latest in self._vocabulary.values.listed(PLACE):
                self._context.latest[PLACE] = latest  # `never enter the lab while Bob is in it`

    def _note_kind(self, type: str, latest: str, choice: Choice | None, *, is_one: bool) -> None:
        """Keep the thing or person as the latest of its kind: `pick up the red cup. Put the cup on the table`."""
        parts, of_kind = dict(choice.parts) if choice is not None else {}, self._context.of_kind
        kind = parts.get("kind", "") or self._vocabulary.values.likenesses.kind_of(type, parts.get(NAME, latest))
        if choice is not None:
            latest = f"{{{choice.key}}}"
            for other in [other for other, text in of_kind.items() if text == latest]:
                del of_kind[other]  # what was chosen for it is another one now
        if kind:
            of_kind[kind] = latest if is_one else ""

    def note_asked(self, words: Sequence[str]) -> None:
        """`ask Bob "Do you need the book?". If not, bring it to me`: the one thing that a question names, or its kind.

        `words` end with one that is no word of a name.
        """
        values, asking = self._vocabulary.values, self._vocabulary.asking
        is_verb = len(words) > 1 and words[1].lower() in (*asking["speaking"], *asking["hearing"])  # `Can I help you?`
        things, at = list[tuple[int, int, str]](), int(is_verb)
        while at < len(words):
            found = [find(values.names_tree(kind), words, at) for kind in ("kind", KINDS, OBJECT)]
            ways = [(way[1], sort, way[0]) for sort, way in enumerate(found) if way is not None]
            things += [max(ways)] if ways else []
            at = max(ways)[0] if ways else at + 1
        if len(things) != 1 or not set(words).isdisjoint(self._vocabulary.roles["or"]):
            if things:
                self._context.latest.pop(OBJECT, None)  # `the cup or the book`, also where one is a kind or unknown
            return
        _, sort, name = things[0]
        if sort == 2:
            self._context.latest[OBJECT] = name
        elif OBJECT in values.likenesses.types_of(name):
            key = self._context.keys.get(OBJECT, OBJECT)
            self._context.latest[OBJECT] = Choice("nearest", OBJECT, key, (("kind", name),)).text

    def _same_themes(self, match: Match, value: SlotValue) -> tuple[str, ...]:
        """`fetch the cup from the lab and the book from the hall, and bring them`: the things of commands in a row."""
        entry = match.meaning.entry
        if entry is None or match.meaning.role != "command" or value.type != OBJECT:
            return ()
        name = _name(value.text)
        is_plain = not value.group and name[:1] not in ODD
        before = self._themes[1] if self._themes[0] == entry.id and is_plain else []
        self._themes = entry.id, [*before, name] if is_plain else []
        return tuple(dict.fromkeys(self._themes[1]))

    def _note_sort(self, value: SlotValue) -> None:
        """BT255 for `the patient` where the world has people, but doesn't say which are patients: anybody is meant.

        BT178 for `the patients`, who aren't all the people that the robot knows.
        """
        words, choice = self._text.words[value.first : value.last], choice_of(value.group or value.text)
        sort = next((self._sorts[word] for word in words if word in self._sorts), "")
        if value.type != PERSON or not sort or choice is None or dict(choice.parts).keys() & {NAME, "kind"}:
            return
        span = self._text.span(value.first, value.last)
        is_met = self._text.words[value.last] in self._vocabulary.asking["who"]  # `greet each visitor who comes in`
        if value.group and not choice.parts and not is_met:
            kind = f'kind = "{sort}"'
            unknown = diagnostic("BT178", span, words=span.text, part="kind", type=PERSON, line=kind)
            names = self._vocabulary.values.said_names(PERSON)
            self.problems.append(unknown.advising(f"Or name them, for example: {names[0]}"))
        else:
            self.problems.append(diagnostic("BT255", span, words=span.text, sort=sort))

    def _note_owners(self, value: SlotValue) -> None:
        """BT177 for each owner of whom it isn't known what they own: `my cup`, but not the cup called "my cup".

        BT178 for a place that is chosen by its owner: `Alice's room`.
        """
        known = self._vocabulary.values
        named = choice_of(value.group or value.text)
        names = [*value.texts, *(text for _, text in (named.parts if named is not None else ()))]
        said = {word for name in names for word in name.lower().split()}
        if value.type not in WORLD:
            return
        listed = known.listed(PLACE)
        for first, last in known.adjectives.nobody_known(self._text, value.first, value.last, known.names_tree):
            if self._text.words[first] not in said and not any(word.endswith(known.adjectives.ending) for word in said):
                name = self._text.words[first].removesuffix(known.adjectives.ending)
                owner = find(known.names_tree(PERSON), [name, END_OF_TEXT], 0)
                if value.type == PLACE and value.text not in listed and not known.likenesses.says(PLACE, OWNER):
                    span = self._text.span(first, value.last)
                    whose = f'{OWNER} = "{"me" if owner is None else owner[0]}"'
                    unknown = diagnostic("BT178", span, words=span.text, part=OWNER, type=PLACE, line=whose)
                    problem = unknown.advising(f"Or name the place, for example: {known.said_names(PLACE)[0]}")
                else:
                    span = self._text.span(first, last)
                    problem = diagnostic("BT177", span, words=span.text)
                self.problems.append(problem)
                if owner is not None:  # `find Bob's book and bring it to him`
                    self._context.latest[PERSON] = owner[0]


def _name(text: str) -> str:
    """The name of a value: also of what is chosen by it, `the red cup from the kitchen`."""
    chosen = choice_of(text)
    return text if chosen is None else dict(chosen.parts).get(NAME, text)
