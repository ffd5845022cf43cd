"""Verbs with roles: `bring` with a theme (what), a recipient (to whom) and a manner, said in any order.

A keyword entry declares a verb and its roles; the words that introduce a role, and verbs that mean the same, are data
of the language. A `Frame` is one verb of one entry with its roles. `fill` reads them from the words behind the verb.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from btlang.support.record import Record
from btlang.text.words import END_OF_STATEMENT, END_OF_TEXT, Words
from btlang.vocabulary.entry import GOAL, MANNER, PATH, RECIPIENT, THEME, UNMARKED, Entry, Meaning, Role
from btlang.vocabulary.match import Match, SlotValue
from btlang.vocabulary.references import choice_of
from btlang.vocabulary.role_words import RoleWords
from btlang.vocabulary.value_type import ZONE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from btlang.vocabulary.reading_context import ReadingContext

    ListOf = Callable[[SlotValue], "SlotValue | None"]


_PLACED = frozenset(("on", "inside", "at"))  # where a thing lies that is described so, or goes


class Beginnings(Record):
    """The roles whose values may begin at once, and those that words introduce, by the first of these words."""

    direct: tuple[Role, ...]
    introduced: Mapping[str, Sequence[tuple[Role, tuple[str, ...]]]]


class Frame(Record, uncompared=("beginnings",)):
    """One verb of an entry. A `particle` belongs to the verb, and stands behind it or behind the theme."""

    entry: Entry
    roles: tuple[Role, ...]
    beginnings: Beginnings  # of the roles
    particle: str = ""

    @property
    def is_about_zone(self) -> bool:
        """Whether one of the roles takes a zone."""
        return any(role.type == ZONE for role in self.roles)

    def role(self, name: str) -> Role | None:
        """The role of this name, if the verb has it."""
        return next((role for role in self.roles if role.name == name), None)


def beginnings_of(roles: Sequence[Role]) -> Beginnings:
    """How the values of roles may begin."""
    introduced: dict[str, list[tuple[Role, tuple[str, ...]]]] = {}
    for role in roles:
        for phrase in role.words:
            introduced.setdefault(phrase[0], []).append((role, phrase))
    return Beginnings(tuple(role for role in roles if role.is_direct), introduced)


def canonical(verb: str, roles: Sequence[Role]) -> str:
    """The pattern of a verb with its roles in their order: `bring {object} to {person} [{manner}]`."""
    parts = [verb]
    for role in roles:
        slot = f"{{{role.slot}}}"
        said = slot if role.name in UNMARKED or not role.words else f"{' '.join(role.words[0])} {slot}"
        parts.append(said if role.is_needed else f"[{said}]")
    return " ".join(parts)


def phrases_of(verbs: Sequence[str], roles: Sequence[Role], particles: frozenset[str]) -> list[str]:
    """The patterns that say a frame in its order: the first verb, then the others; particles behind the theme, too."""
    others = [verb for verb in verbs[1:] if " " not in verb]
    found = [canonical(verbs[0], roles)]
    if others:
        found.append(canonical("/".join(others), roles))
    found += [canonical(verb, roles) for verb in verbs[1:] if " " in verb]
    theme = roles[0] if roles and roles[0].name == THEME else None
    split = [parts_of(verb, particles) for verb in verbs] if theme is not None else []
    for words, particle in split:
        if theme is not None and particle:
            found.append(canonical(f"{' '.join(words)} {{{theme.slot}}} {particle}", roles[1:]))
    return found


def parts_of(verb: str, particles: frozenset[str]) -> tuple[tuple[str, ...], str]:
    """The words of a verb, and its particle: `pick up` as `pick` and `up`."""
    words = tuple(verb.split())
    if len(words) == 2 and words[1] in particles:
        return words[:1], words[1]
    return words, ""


def fill(
    frames: Iterable[Frame],
    text: Words,
    at: int,
    context: ReadingContext,
    words: RoleWords,
    list_of: ListOf,
    before: SlotValue | None = None,
) -> Match | None:
    """The frame that takes most of the words behind its verb, which ends at a word; `before` is the manner before it.

    Of frames that take as many one about anything but a zone, as one goes to a place that is a zone, too; then the one
    with fewer empty roles, then the first.
    """
    best: Match | None = None
    empty = False, 0
    for frame in frames:
        taken = _Filling(frame, text, context, words, list_of).taken(at, before)
        if taken is None:
            continue
        last, values, number = taken
        left = frame.is_about_zone, number
        if best is None or last > best.last or (last == best.last and left < empty):
            best, empty = Match(Meaning("command", frame.entry), last, values), left
    return best


def is_no_way(context: ReadingContext, text: Words, at: int, value: tuple[str, int] | None) -> bool:
    """Whether a value that begins at a word leaves open what the way leads through: `that room`, any of several.

    `any room but the hall`, `the room that isn't red` only say what it avoids.
    """
    choice = choice_of(value[0]) if value is not None else None
    if choice is None or value is None:
        return False
    values, behind = context.values, value[1]
    if values.exception(text, behind) or values.modifiers.denies(text, behind):
        return True
    is_mere_kind = [part for part, _ in choice.parts] == ["kind"] and not values.modifiers.is_picked(
        choice.how, text, at
    )
    return is_mere_kind and len(values.likenesses.members(choice) or ()) != 1


class _Filling:
    """Fills the roles of one frame from the words of one text."""

    def __init__(self, frame: Frame, text: Words, context: ReadingContext, words: RoleWords, list_of: ListOf) -> None:
        self._frame, self._text, self._context, self._words, self._list_of = frame, text, context, words, list_of
        self._best: tuple[int, tuple[SlotValue, ...], int] | None = None

    def taken(self, at: int, before: SlotValue | None) -> tuple[int, tuple[SlotValue, ...], int] | None:
        """Where the longest way to fill the roles ends, its values, and how many roles stay empty."""
        filled: dict[str, SlotValue | None] = {}
        if before is not None:
            role = self._frame.role(MANNER)
            if role is None:
                return None
            filled[MANNER] = before.replace(name=role.slot)
        self._go_on(at, filled, not self._frame.particle)
        return self._best

    def _go_on(self, at: int, filled: Mapping[str, SlotValue | None], has_particle: bool) -> None:
        frame, word = self._frame, self._text.words[at]
        if has_particle and all(role.name in filled or not role.is_needed for role in frame.roles):
            if (self._best is None or at > self._best[0]) and not self._has_own_goal(filled):
                values = sorted((value for value in filled.values() if value is not None), key=lambda v: v.first)
                self._best = at, tuple(values), len(frame.roles) - len(filled)
        if not has_particle and word == frame.particle:
            self._go_on(at + 1, filled, True)
        if word in self._words.fillers and word != frame.particle:
            for role, after in self._introduced(at + 1, filled):
                self._take(role, after, filled, has_particle)
        if word == ",":  # `go to the lab, travelling through the hall`, `go to the lab, slowly`
            for role, after in self._introduced(at + 1, filled):
                if (role.name == PATH and after > at + 2) or (role.name == MANNER and self._ends_with(role, after)):
                    self._take(role, after, filled, has_particle)
        for role, after in self._introduced(at, filled):
            self._take(role, after, filled, has_particle)
        for name, value in filled.items():
            fewer = self._context.without(value.group, self._text, at) if value is not None and value.group else None
            if value is not None and fewer is not None and value.last < at:
                one = value.replace(text=fewer[0], group=fewer[0])
                self._go_on(fewer[1], {**filled, name: one}, has_particle)

    def _has_own_goal(self, filled: Mapping[str, SlotValue | None]) -> bool:
        """Whether an item of a list says where it goes: `put the cup in the box and the book on the table`."""
        theme = filled.get(THEME)
        if theme is None or not theme.more or theme.group or filled.get(GOAL) is None:
            return False
        choices = map(choice_of, (theme.text, *theme.more[:-1]))
        return any(choice is not None and not _PLACED.isdisjoint(dict(choice.parts)) for choice in choices)

    def _is_container(self, role: Role) -> bool:
        """Whether a thing goes into another one: into one alone, so a list behind it is about something else."""
        theme = self._frame.role(THEME)
        return role.name == GOAL and theme is not None and theme.type == role.type

    def _introduced(self, at: int, filled: Mapping[str, SlotValue | None]) -> Iterator[tuple[Role, int]]:
        """The empty roles whose value may begin here, and where: behind the words that introduce them, or at once."""
        words = self._text.words
        beginnings = self._frame.beginnings
        for role in beginnings.direct:
            if role.name not in filled and not (role.name == RECIPIENT and THEME in filled):
                yield role, at
        if words[at] in self._words.directions:
            for role in self._frame.roles:
                if role.name == GOAL and role.name not in filled:
                    yield role, at
        for role, phrase in beginnings.introduced.get(words[at], ()):
            if role.name not in filled and (len(phrase) == 1 or tuple(words[at : at + len(phrase)]) == phrase):
                yield role, at + len(phrase)

    def _ends_with(self, role: Role, at: int) -> bool:
        """Whether a value of a role ends the statement."""
        value = self._context.read(role.type, self._text, at)
        return value is not None and self._text.words[value[1]] in (END_OF_STATEMENT, END_OF_TEXT, ")")

    def _take(self, role: Role, at: int, filled: Mapping[str, SlotValue | None], has_particle: bool) -> None:
        text, context = self._text, self._context
        if role.for_speaker and text.words[at] in self._words.speaker:
            self._go_on(at + 1, {**filled, role.name: None}, has_particle)
            return
        if text.words[at].isalpha() and text.words[at] not in context.openers.get(role.type, text.words[at : at + 1]):
            return  # as mostly, without reading
        for group, _, last in context.sets(role.type, text, at):
            one = SlotValue(role.slot, role.type, group, at, last, group=group)
            self._go_on(last, {**filled, role.name: one}, has_particle)
        for value in context.ways(role.type, text, at):
            if role.name == PATH and is_no_way(context, text, at, value):
                continue
            one = SlotValue(role.slot, role.type, value[0], at, value[1])
            self._go_on(one.last, {**filled, role.name: one}, has_particle)
            if context.may_list_on(text, one.last):
                listed = self._list_of(one)
                if listed is not None and not self._is_container(role) and not (role.name == PATH and listed.more):
                    for every in (listed, *context.wider_list(text, listed)):
                        self._go_on(every.last, {**filled, role.name: every}, has_particle)
