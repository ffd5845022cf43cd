"""One keyword file (TOML) read and checked. Its form is described in docs/keywords.md."""

from __future__ import annotations

import re
import tomllib
from math import inf, isfinite

from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic
from btlang.support.record import Record
from btlang.text.source import Source, Span
from btlang.text.toml import find_positions, parse_toml
from btlang.tree.catalogue import CATALOGUE, CONSTRAINTS
from btlang.vocabulary.capabilities import resources_of
from btlang.vocabulary.entry import COMPARISONS, MEASURED, POINT, VERB_ROLES, Entry, Role, SlotSpec
from btlang.vocabulary.language_tables import SWITCHES, TABLES, WORD_LISTS, problems
from btlang.vocabulary.nouns import Noun
from btlang.vocabulary.pattern import PatternError, Slot, forms
from btlang.vocabulary.references import PARTS
from btlang.vocabulary.ros_binding import RosBinding
from btlang.vocabulary.ros_table import read_ros, unknown_slots
from btlang.vocabulary.value_type import PLACE, Unit, ValueType

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Any

    from btlang.vocabulary.entry import Verbs

_SAID = frozenset(("phrase", "verb", "roles", "frames"))  # of an id in [phrases]
_OWN = ("shipped", "yields", "replaces", "action", "condition", "quantity", "noun", "type", "phrases")
_TOP = {"language", *_OWN, *WORD_LISTS, *SWITCHES, *TABLES}
_ENTRY = {
    "phrase", "verb", "roles", "frames", "id", "call", "ros", "slots", "outputs", "resources", "needs", "topic", "help",
    "example",
}  # fmt: skip
_FLAGS = ("accompaniment", "first", "instant", "uninterruptible", "thread", "touches")
_MORE = {
    "action": {*_FLAGS, "constrains", "achieves"}, "condition": {"touches", "denied"}, "quantity": {"type", "named"},
}  # fmt: skip
"""The keys that an entry of one sort has beside those of all."""
_TYPE = {"name", "units", "whole", "least", "open", "values"}
_NOUN = {"type", "phrase", "slots", "how"}
_HOW = ("nearest", "seen", "all")


def keys_of(table: str) -> list[str]:
    """List the keys of the tables of a name, "" for the top of a file."""
    keys = {"": _TOP, "type": _TYPE, "noun": _NOUN, **{sort: _ENTRY | more for sort, more in _MORE.items()}}
    return sorted(keys.get(table, ()))


class KeywordFile(Record):
    """What a file declares. `language` holds the tables of a connective file, empty in a pack of phrases.

    `names` are (type, words, name) of the values of enumerated types. Where it is not for the `shipped` words, these
    are not loaded beside it. `nouns` are those for which the robot chooses a name.
    """

    source: Source
    entries: tuple[Entry, ...]
    types: tuple[ValueType, ...]
    names: tuple[tuple[str, str, str], ...]
    language: dict[str, Any]
    shipped: bool = True
    nouns: tuple[Noun, ...] = ()


class _Noun(Record):
    """Words for a value of a type that is described: `person wearing [a] {color} {clothing}`."""

    type: str
    phrase: str
    slots: dict[str, Any]


class _Reader:
    """Reads one file and collects everything that is wrong with it."""

    def __init__(self, source: Source) -> None:
        self.source = source
        self.problems: list[Diagnostic] = []
        self.start = 0
        """Of the table that is being read."""
        self.nouns: list[_Noun] = []
        self.described: list[Noun] = []

    def wrong(self, reason: str, near: str = "", code: str = "BT060") -> None:
        self.problems.append(diagnostic(code, self.span(near), reason=reason))

    def wrong_ros(self, code: str, phrase: str, near: str, **texts: str) -> None:
        """At the text after the phrase, where the table stands; else at the phrase."""
        text, after = self.source.text, self.span(phrase).end
        start = max(text.find(f'"{near}"', after) + 1, 0) or text.find(near, after)
        place = self.span(phrase) if start < 0 else Span(self.source, start, start + len(near))
        self.problems.append(diagnostic(code, place, (), None, phrase=phrase, **texts))

    def span(self, near: str) -> Span:
        """Where the table first has the text in quotes, else has it at all."""
        text = self.source.text
        start = text.find(f'"{near}"', self.start) + 1 if near else 0
        start = start or max(self.start, text.find(near, self.start))
        return Span(self.source, start, start + len(near))

    def entry(self, sort: str, table: dict[str, Any]) -> Entry | None:
        phrases = table.get("phrase", [])
        phrases = [phrases] if isinstance(phrases, str) else phrases
        name = table.get("id", "")
        verbs = self.verbs(table, sort)
        if not _strings(phrases) or not ("phrase" in table or verbs) or not (phrases or verbs or table.get("slots")):
            self.wrong(f'[[{sort}]] needs phrase = "...", or a list of them', str(name) or f"[[{sort}]]")
            return None
        near = phrases[0] if phrases else verbs[0][0][0] if verbs else str(name)
        if not isinstance(name, str) or not re.fullmatch(r"[A-Za-z]\w*", name):
            self.wrong(f"the {sort} '{near}' needs id = \"...\", one word that starts with a letter", near)
            return None
        keys = _ENTRY | _MORE[sort]
        for key in [key for key in table if key not in keys]:
            self.wrong(f"'{key}' is not a key of [[{sort}]]; the keys are {', '.join(sorted(keys))}", near)
        if name in CATALOGUE:
            self.wrong(f"'{name}' is a node of the tree itself; the {sort} '{near}' needs another id", near)
        call, resources = table.get("call", ""), table.get("resources", [])
        if not isinstance(call, str) or (call and not re.fullmatch(r"[\w.]+:[\w.]+", call)):
            self.wrong(f"call of '{near}' must be \"module:name\"", near)
        if not _strings(resources):
            self.wrong(f"resources of '{near}' must be a list of names", near)
            resources = []
        needs = table.get("needs", [])
        if not _strings(needs):
            self.wrong(f"needs of '{near}' must be a list of names such as [\"navigation\"]", near)
            needs = []
        achieves = table.get("achieves", [])
        if not isinstance(achieves, list) or not _strings(achieves):
            self.wrong(f"achieves of '{near}' must be a list of ids of conditions", near)
            achieves = []
        if sort == "action":
            resources = list(dict.fromkeys((*resources, *resources_of(needs))))
        for key in [key for key in _FLAGS if not isinstance(table.get(key, False), bool)]:
            self.wrong(f"{key} of '{near}' must be true or false", near)
        flags: dict[str, Any] = {key: table.get(key) is True for key in _FLAGS}
        constrains = table.get("constrains", "")
        if constrains not in ("", *CONSTRAINTS):
            self.wrong(f'constrains of \'{near}\' is "keep out" or "keep in"', near)
        if flags["instant"] and flags["thread"]:
            self.wrong(f"'{near}' can't be instant: work in a thread ends in a later tick", near)
        topic, help, example = (str(table.get(key, "")) for key in ("topic", "help", "example"))
        given = table.get("slots", {})
        if self.nouns and isinstance(given, dict):
            phrases, given = self.with_nouns(phrases, given)
        outputs = table.get("outputs", [])
        slots = self.slots(phrases, given, near, [role for _, roles in verbs for role in roles], outputs)
        made = Entry(
            sort, name, tuple(phrases), str(call), slots, tuple(resources), topic, help, example, span=self.span(near),
            constrains=str(constrains), **flags,
            ros=self.ros(table["ros"], sort, slots, near) if "ros" in table else None,
            denied=tuple(self.denied(table.get("denied", []), slots, near)),
            outputs=self.outputs(outputs, slots, near), verbs=verbs, needs=tuple(needs),
            achieves=tuple(achieves),
        )  # fmt: skip
        return self.quantity(made, table, near) if sort == "quantity" else made

    def denied(self, phrases: object, slots: Sequence[SlotSpec], near: str) -> list[str]:
        """The phrases that say that a condition isn't so; they have the slots of the others."""
        names = {slot.name for slot in slots}
        phrases = [phrases] if isinstance(phrases, str) else phrases
        if not isinstance(phrases, list) or not _strings(phrases):
            self.wrong(f"denied of '{near}' must be a phrase, or a list of phrases", near)
            return []
        for phrase in phrases:
            if not names.issuperset(_slot_names(phrase)):
                self.wrong(f"the phrase '{phrase}' has a slot that '{near}' hasn't", near)
        return phrases

    def noun(self, table: dict[str, Any]) -> None:
        given, kind, slots = table.get("phrase"), table.get("type"), table.get("slots", {})
        phrases, how = [given] if isinstance(given, str) else given, table.get("how", "")
        if (
            not (_strings(phrases) and phrases and isinstance(kind, str) and isinstance(slots, dict))
            or table.keys() - _NOUN
        ):
            self.wrong('[[noun]] needs type = "person" and phrase = "...", and takes slots and how', "[[noun]]")
            return
        if how not in ("", *_HOW):
            self.wrong('how of [[noun]] is "nearest", "seen" or "all"', "how")
        for phrase in phrases:
            names = _slot_names(phrase)
            if how:
                self.described_noun(Noun(kind, str(how), phrase, {name: name for name in names}))
            elif not names or slots.keys() - set(names):
                self.wrong(f"the noun '{phrase}' needs slots such as {{color}}, and those of its table in it", phrase)
            else:
                self.nouns.append(_Noun(kind, phrase, slots))

    def described_noun(self, noun: Noun) -> None:
        """A noun for which the robot chooses a name."""
        if noun.slots.keys() - set(PARTS):
            self.wrong(f"the noun '{noun.phrase}' with how takes the slots {', '.join(PARTS)}", noun.phrase)
            return
        try:
            forms(noun.phrase)
        except PatternError as error:
            self.wrong(str(error), noun.phrase, "BT061")
            return
        self.described.append(noun)

    def with_nouns(self, phrases: list[str], slots: dict[str, Any]) -> tuple[list[str], dict[str, Any]]:
        """The phrases, and those that have a noun in the place of a slot of its type; their slots become ports too."""
        more, known = list(phrases), dict(slots)
        for noun in self.nouns:
            parts = _slot_names(noun.phrase)
            for phrase in phrases:
                names = _slot_names(phrase)
                typed = [name for name in names if self.slot(name, slots.get(name, {}), phrase).type == noun.type]
                for name in typed if set(parts).isdisjoint(names) else ():
                    more.append(phrase.replace(f"{{{name}}}", noun.phrase, 1))
                    known = {**noun.slots, **known}
        return more, known

    def phrases(self, table: object) -> list[Entry]:
        """The entries that give known ids phrases or verbs: `GoTo = "ve a {place}"`, `{ verb = "ve", roles = ... }`."""
        if not isinstance(table, dict):
            self.wrong("phrases is a table: [phrases]", "phrases")
            return []
        found = []
        for name, value in table.items():
            self.start = max(self.source.text.find(f"\n{name}"), 0)
            given = value if isinstance(value, dict) else {"phrase": value}
            verbs, phrases = self.verbs(given, "action"), given.get("phrase", [])
            phrases = [phrases] if isinstance(phrases, str) else phrases
            if not _strings(phrases) or not (phrases or verbs) or not given.keys() <= _SAID:
                self.wrong(f"{name} in [phrases] is a phrase, a list of them, or a table with verb and roles", name)
                continue
            near = phrases[0] if phrases else verbs[0][0][0]
            found.append(Entry("", name, tuple(phrases), span=self.span(near), verbs=verbs))
        return found

    def replacing(self, ids: object, entries: list[Entry]) -> list[Entry]:
        """The entries, where those with these ids replace what is known."""
        if not isinstance(ids, list) or not _strings(ids):
            self.wrong('replaces is a list of ids, such as replaces = ["GoTo"]', "replaces")
            return entries
        for name in [name for name in ids if not any(entry.id == name and entry.call for entry in entries)]:
            self.wrong(f"no entry of this file has the id '{name}' and a call to replace the known one", name)
        return [entry.replace(replaces=entry.id in ids) for entry in entries]

    def ros(self, table: object, sort: str, slots: tuple[SlotSpec, ...], near: str) -> RosBinding | None:
        binding, wrong = read_ros(table, sort)
        for reason, text in wrong:
            self.wrong_ros("BT102", near, text, reason=reason)
        names = [slot.name for slot in slots]
        for name in unknown_slots(binding, names) if binding is not None else ():
            known = f"It has {', '.join(f'{{{slot}}}' for slot in names)}." if names else "It has no slots."
            self.wrong_ros("BT103", near, f"{{{name}", slot=name, help=known)
        return binding

    def quantity(self, entry: Entry, table: dict[str, Any], near: str) -> Entry:
        """A condition whose phrases are made when the words for comparing are known."""
        measures = table.get("type")
        if not isinstance(measures, str):
            self.wrong(f"the quantity '{near}' needs type = \"length\", or another type with values to compare", near)
        for slot in entry.slots:
            if slot.name in COMPARISONS or slot.name == MEASURED:
                self.wrong(f"every quantity has a port {slot.name}; the slot of '{near}' needs another name", near)
        named = table.get("named", [])
        if not _strings(named):
            self.wrong(f"named of '{near}' must be a list of words for its value", near)
            named = []
        made: Entry = entry.replace(
            sort="condition",
            phrases=(),
            quantity=entry.phrases,
            named=tuple(named),
            measures=str(measures),
            resources=(),
        )
        return made

    def verbs(self, table: dict[str, Any], sort: str) -> Verbs:
        """The verbs of an entry with their roles: of the entry itself, and of each of its frames."""
        frames = table.get("frames", [])
        if not isinstance(frames, list) or not all(isinstance(frame, dict) for frame in frames):
            self.wrong("frames is a list of tables with verb and roles", "frames")
            return ()
        found = []
        for frame in ([table] if "verb" in table else []) + frames:
            verbs, roles = frame.get("verb", []), frame.get("roles", {})
            verbs = [verbs] if isinstance(verbs, str) else verbs
            if not _strings(verbs) or not verbs or not all(verb.split() for verb in verbs):
                self.wrong('a verb is a word, or a list of them: verb = ["bring", "take"]', "verb")
            elif sort != "action":
                self.wrong(f"only an action has a verb; a {sort} has phrases", verbs[0])
            elif not isinstance(roles, dict):
                self.wrong('roles is a table: roles = { theme = "object", goal = "place" }', verbs[0])
            else:
                made = [self.role(name, value, verbs[0]) for name, value in roles.items()]
                found.append((tuple(verb.lower() for verb in verbs), tuple(role for role in made if role is not None)))
        return tuple(found)

    def role(self, name: str, value: Any, near: str) -> Role | None:
        """A role: the type of its slot, with `?` where it may be left out and `/me` where it may be the speaker."""
        if name not in VERB_ROLES:
            self.wrong(f"the verb '{near}' has no role '{name}'; the roles are {', '.join(VERB_ROLES)}", near)
            return None
        given = {"type": value} if isinstance(value, str) else value
        known = {"type": str, "slot": str, "words": list}
        if not isinstance(given, dict) or any(not isinstance(given[key], known.get(key, bytes)) for key in given):
            self.wrong(f"the role {name} of '{near}' is a type, or a table with type, slot and words", near)
            return None
        said, _, speaker = str(given.get("type", "")).partition("/")
        kind, is_needed = said.removesuffix("?"), not said.endswith("?")
        words = given.get("words", [])
        if not kind.isidentifier() or speaker not in ("", "me") or not _strings(words):
            self.wrong(f'the role {name} of \'{near}\' needs a type such as "place", "place?" or "person/me"', near)
            return None
        phrases = tuple(tuple(phrase.lower().split()) for phrase in words if phrase.split())
        return Role(name, str(given.get("slot", kind)), kind, phrases, is_needed, speaker == "me")

    def slots(
        self, phrases: list[str], table: Any, near: str, roles: Sequence[Role] = (), outputs: Any = ()
    ) -> tuple[SlotSpec, ...]:
        if not isinstance(table, dict):
            self.wrong(f"slots of '{near}' must be a table such as {{ distance = {{ type = \"length\" }} }}", near)
            return ()
        found: dict[str, SlotSpec] = {}
        for role in roles:
            known = {"type": role.type, **(table.get(role.slot, {}) if isinstance(table.get(role.slot), dict) else {})}
            found.setdefault(role.slot, self.slot(role.slot, known, near))
        for phrase in phrases:
            try:
                parts = [part for form in forms(phrase) for part in form]
            except PatternError as error:
                self.wrong(str(error), phrase, "BT061")
                continue
            for part in parts:
                if isinstance(part, Slot) and part.name not in found:
                    found[part.name] = self.slot(part.name, table.get(part.name, {}), near)
        if any(slot.type == PLACE for slot in found.values()):
            found |= {name: self.slot(name, table[name], near) for name in POINT if name in table and name not in found}
        for name, given in table.items():
            unsaid = isinstance(given, dict) and "default" in given  # the function gets that each time
            unsaid = unsaid or (isinstance(outputs, list) and name in outputs)  # or writes it
            if not (phrases or roles) or (unsaid and name not in found):  # or it is only said by its id
                found[name] = self.slot(name, given, near)
        for name in [name for name in table if name not in found]:
            self.wrong(f"no phrase of '{near}' has a slot {{{name}}}", near)
        return tuple(found.values())

    def outputs(self, names: object, slots: tuple[SlotSpec, ...], near: str) -> tuple[str, ...]:
        if isinstance(names, list) and set(names) <= {slot.name for slot in slots}:
            return tuple(names)
        self.wrong(f"outputs of '{near}' must be a list of its slots", near)
        return ()

    def slot(self, name: str, table: Any, near: str) -> SlotSpec:
        table = {"type": table} if isinstance(table, str) else table
        if not isinstance(table, dict) or table.keys() - {"type", "default"}:
            self.wrong(f"the slot {{{name}}} of '{near}' takes type and default", near)
            table = {}
        default = table.get("default")
        return SlotSpec(name, str(table.get("type", name)), None if default is None else str(default))

    def type(self, table: dict[str, Any]) -> tuple[ValueType, list[tuple[str, str, str]]] | None:
        name = table.get("name")
        if not isinstance(name, str) or not name.isidentifier():
            self.wrong('[[type]] needs name = "...", one word', "[[type]]")
            return None
        for key in [key for key in table if key not in _TYPE]:
            self.wrong(f"'{key}' is not a key of [[type]]; the keys are {', '.join(sorted(_TYPE))}", name)
        listed = {key: table.get(key, []) for key in ("units", "values")}
        if not all(isinstance(value, list) for value in listed.values()):
            self.wrong(f"units and values of {name} must be lists", name)
            return None
        units = []
        for unit in listed["units"]:
            try:
                over, _, under = unit["factor"].partition("/")
                made = Unit(tuple(map(str, unit["words"])), float(over), float(under or 1))
            except (TypeError, KeyError, ValueError, AttributeError):
                made = None
            if (
                made is None
                or not made.words
                or isinstance(unit["words"], str)
                or not all(0 < abs(part) < inf for part in (made.numerator, made.denominator))
                or made.numerator / made.denominator <= 0
            ):
                self.wrong(f'a unit of {name} must be {{ words = ["m", "meter"], factor = "1" }}', name)
            else:
                units.append(made)
        values = [{"name": v} if isinstance(v, str) else v for v in listed["values"]]
        if not all(
            isinstance(v, dict) and isinstance(v.get("name"), str) and _strings(v.get("words", [])) for v in values
        ):
            self.wrong(f'the values of {name} must be names, or {{ name = "left", words = ["left", "port"] }}', name)
            values = []
        names = [(name, str(word), str(v["name"])) for v in values for word in v.get("words", [v["name"]])]
        least = table.get("least")
        if least is not None and (isinstance(least, bool) or not isinstance(least, int | float) or not isfinite(least)):
            self.wrong(f"least of {name} must be a number", name)
            least = None
        whole = bool(table.get("whole", False))
        kind = _kind(name, bool(units), bool(values) or bool(table.get("open")))
        given = tuple(str(v["name"]) for v in values)
        lowest = None if least is None else float(least)
        return ValueType(name, kind, tuple(units), whole, lowest, given, self.span(name)), names


def _kind(name: str, has_units: bool, has_names: bool) -> str:
    if has_units:
        return "quantity"
    if has_names:
        return "names"
    return {"text": "text", "time_of_day": "time"}.get(name, "number")


def _slot_names(phrase: str) -> list[str]:
    return list(dict.fromkeys(re.findall(r"\{(\w+)\}", phrase)))


def _strings(value: object) -> bool:
    return isinstance(value, list) and all(isinstance(item, str) for item in value)


def read_keyword_file(source: Source) -> KeywordFile:
    """Raises MissionError with everything that is wrong with the file (BT060, BT061)."""
    reader = _Reader(source)
    try:
        document = parse_toml(source.text)
    except tomllib.TOMLDecodeError as error:
        place = re.search(r" \(at (?:line (\d+), column (\d+)|end of document)\)$", str(error))
        start = len(source.text)
        if place and place[1]:
            start = source.offset(int(place[1]), int(place[2]))
        reason = "it is not TOML: " + str(error)[: place.start() if place else None]
        raise MissionError([diagnostic("BT060", Span(source, start, start + 1), reason=reason)]) from None
    for key in [key for key in document if key not in _TOP]:
        reader.wrong(f"'{key}' is not a key of keyword files; the keys are {', '.join(sorted(_TOP))}", key)
    entries, types, names = [], [], []
    places = find_positions(source.text)
    for table in _tables(document, "noun", reader):
        reader.noun(table)
    for sort in ("action", "condition", "quantity"):
        for index, table in enumerate(_tables(document, sort, reader)):
            reader.start = places.get((sort, index), 0)
            entry = reader.entry(sort, table)
            if entry is not None:
                entries.append(entry)
    for index, table in enumerate(_tables(document, "type", reader)):
        reader.start = places.get(("type", index), 0)
        declared = reader.type(table)
        if declared is not None:
            types.append(declared[0])
            names += declared[1]
    entries += reader.phrases(document.get("phrases", {}))
    reader.start = 0
    entries = reader.replacing(document.get("replaces", []), entries)
    is_shipped, yields = document.get("shipped", True), document.get("yields", False)
    for key, value in (("shipped", is_shipped), ("yields", yields)):
        if not isinstance(value, bool):
            reader.wrong(f"{key} is true or false", key)
    entries = [entry.replace(yields=yields) for entry in entries] if yields is True else entries
    language = {k: v for k, v in document.items() if k not in _OWN}
    for key, value in language.items():
        if key in _TOP:
            for reason, near in problems(key, value):
                reader.wrong(reason, near)
    if reader.problems:
        raise MissionError(reader.problems)
    return KeywordFile(
        source, tuple(entries), tuple(types), tuple(names), language, is_shipped, tuple(reader.described)
    )


def _tables(document: dict[str, Any], key: str, reader: _Reader) -> list[dict[str, Any]]:
    value = document.get(key, [])
    if isinstance(value, list) and all(isinstance(item, dict) for item in value):
        return value
    reader.wrong(f"{key} must be written [[{key}]]", key)
    return []
