"""Rules that a vocabulary adds to the grammar: its phrases, the words of its roles, its values."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from itertools import chain, takewhile

from btlang.backends.grammar.forms import FORMS
from btlang.backends.grammar.rules import (
    NOTHING,
    Chars,
    Part,
    RuleName,
    Rules,
    Text,
    choice,
    joined,
    parse_rule,
    prune,
    repeat,
)
from btlang.tree.catalogue import SUBTREE
from btlang.vocabulary.correct_words import correct_words
from btlang.vocabulary.entry import Entry, SlotSpec
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.node_words import said_id
from btlang.vocabulary.pattern import Form, Slot, forms, variants
from btlang.vocabulary.value_type import PLACE, TEXT, ZONE, Unit, ValueType, with_unit

_FIGURE = '([1-9] [0-9]? | "0." [1-9])'
_WHOLE = "[1-9] [0-9]?"
_TEXT = '"`" [A-Za-z] [A-Za-z0-9 ,.!?]* "`"'
_CLOCK = '(("1" [0-9] | "2" [0-3]) ":" [0-5] [0-9])'
_REGIONS = (PLACE, ZONE)
_SMALL = 0.01  # of the unit of ports
_GIVEN = "{%s}"  # a value of the mission in the place of one that is written out


def grammar_of(vocabulary: Lexicon) -> Rules:
    """Return the grammar of missions with the words of a vocabulary; its first rule is "root"."""
    return _VocabularyRules(vocabulary).made()


class _Leaf:
    """A phrase of an entry: the rule of its name makes every way to say it."""

    def __init__(self, name: str, entry: Entry, said: tuple[Form, ...], kinds: Mapping[str, str]) -> None:
        self.name, self.entry, self.forms, self.kinds = name, entry, said, kinds

    @property
    def is_steady(self) -> bool:
        """Whether it takes time, and may be stopped half-way."""
        return not (self.entry.instant or self.entry.uninterruptible)


class _VocabularyRules:
    def __init__(self, vocabulary: Lexicon) -> None:
        self._vocabulary = vocabulary
        self._rules: Rules = {}
        leaves = list(self._leaves())
        self._actions = [leaf for leaf in leaves if leaf.entry.sort == "action"]
        self._conditions = [leaf for leaf in leaves if leaf.entry.sort == "condition"]
        self._condition_forms = {form for leaf in self._conditions for form in leaf.forms}

    def made(self) -> Rules:
        rules = {name: parse_rule(written, self._words) for name, written in FORMS.items()}
        rules["action"] = choice(RuleName(leaf.name) for leaf in self._actions)
        rules["steady"] = choice(RuleName(leaf.name) for leaf in self._actions if leaf.is_steady)
        rules["phrase"] = choice(RuleName(leaf.name) for leaf in self._conditions)
        rules["denied"] = choice(self._say(form, leaf) for leaf in self._conditions for form in self._deny(leaf))
        rules["quantity"] = self._quantities()
        for name, leaves in (("exact-action", self._actions), ("exact-condition", self._conditions)):
            ids = dict.fromkeys(leaf.entry.id for leaf in leaves if not leaf.entry.slots)
            rules[name] = choice(Text(f'"{node_id}"') for node_id in ids)
        rules["further"] = choice(self._further(leaf) for leaf in self._actions)
        rules["exact-ports"] = choice(self._exact(leaf) for leaf in self._actions)
        for leaf in (*self._actions, *self._conditions):
            rules[leaf.name] = choice(self._say(form, leaf) for form in leaf.forms)
        for kind in self._vocabulary.types.values():
            rules[_rule_of(kind.name)] = self._value(kind)
        return prune({"root": rules.pop("mission"), **rules, **self._rules})

    def _leaves(self) -> Iterator[_Leaf]:
        articles, roles = self._vocabulary.articles, self._vocabulary.roles
        defining = {*roles["define"], *roles["define_strong"]}
        for entries in self._vocabulary.entries.values():
            phrases = ((entry, phrase) for entry in entries for phrase in entry.phrases)
            for number, (entry, phrase) in enumerate(phrases, 1):
                kinds = {slot.name: slot.type for slot in entry.slots}
                said = forms(phrase, articles)
                if entry.sort == "action":  # `the stairs is closed` is a command only at the start of a line
                    said = tuple(form for form in said if not defining.intersection(map(str, form)))
                if said:
                    yield _Leaf(f"{_kebab(entry.id)}-{number}", entry, said, kinds)

    def _say(self, form: Form, leaf: _Leaf, given: Mapping[str, Part] = {}) -> Part:
        """Return a way to say a phrase, with the values of its slots; `given` ones replace others."""
        return self._row(form, lambda slot: given.get(slot, RuleName(_rule_of(leaf.kinds.get(slot, slot)))))

    def _row(self, form: Form, value: Callable[[str], Part]) -> Part:
        parts: list[Part] = []
        for part in form:
            parts += [Text(" "), value(part.name) if isinstance(part, Slot) else Text(part)]
        return joined(parts[1:])

    def _deny(self, leaf: _Leaf) -> Iterator[Form]:
        """Deny a condition, in the verb or the subject."""
        tables = self._vocabulary.negations, self._vocabulary.negative_subjects
        for form in leaf.forms:
            denied = (way for way, role in variants(form, *tables, {}) if role == "negated")
            yield from (way for way in denied if way not in self._condition_forms)

    def _quantities(self) -> Part:
        found: list[Part] = []
        for entry in chain.from_iterable(self._vocabulary.entries.values()):
            kinds = {slot.name: slot.type for slot in entry.slots}
            said = (form for pattern in entry.quantity for form in forms(pattern, self._vocabulary.articles))
            found += [self._say(form, _Leaf("", entry, (), kinds)) for form in said]
        return choice(found)

    def _words(self, wanted: str) -> Part:
        """Return what a name in angle brackets stands for."""
        head, _, rest = wanted.partition(" ")
        special = {
            "together": self._together, "compare": self._compare, "say": self._say_value, "each-type": self._by_type,
            "keyed": self._add_key, "is-keyed": self._is_keyed,
        }  # fmt: skip
        if head in special:
            return special[head](rest)
        if wanted == "doing":
            return self._share(wanted, self._gerunds(self._actions))
        if wanted == "steady doing":
            return self._share("steady-doing", self._gerunds(leaf for leaf in self._actions if leaf.is_steady))
        if wanted == "forever":
            return choice(Text(word) for word, rounds in self._vocabulary.counts.items() if rounds < 0)
        if head == "subtree":
            words = self._vocabulary.nodes.get(SUBTREE)
            return Text(f'{words} "{rest}"') if words else NOTHING
        if wanted == "at-fact w1":
            return self._with_value("place", Text("w1"))
        return self._share(f"word-{_kebab(wanted)}", self._role(head, rest))

    def _share(self, name: str, part: Part) -> Part:
        """Make the part a rule that others use."""
        self._rules[name] = part
        return RuleName(name)

    def _role(self, role: str, value: str) -> Part:
        """Return every way to say a role; a `value` is in its slot."""
        vocabulary = self._vocabulary

        def in_slot(slot: str) -> Part:
            return Text(value) if value else RuleName(_rule_of(slot))

        unsure = {*vocabulary.meanings, *vocabulary.asking["making_sure"]}  # what these say depends on what follows
        phrases = [phrase for phrase in vocabulary.roles.get(role, ()) if phrase not in unsure]
        ways = [self._row(form, in_slot) for phrase in phrases for form in forms(phrase, vocabulary.articles)]
        if role == "count":
            ways += [Text(word) for word, rounds in vocabulary.counts.items() if rounds > 0]
        return choice(ways)

    def _together(self, joint: str) -> Part:
        """Return two commands side by side. No grammar counts the parts of a robot, so they are sorted by those they
        need.
        """
        by_parts: dict[frozenset[str], list[_Leaf]] = {}
        for leaf in self._actions:
            by_parts.setdefault(frozenset(leaf.entry.resources), []).append(leaf)
        found = []
        for parts, leaves in by_parts.items():
            number = list(by_parts).index(parts) + 1
            others = [leaf for leaf in self._actions if parts.isdisjoint(leaf.entry.resources)]
            name = f"needs-{'-and-'.join(sorted(map(_kebab, parts))) or 'nothing'}"
            first = self._share(name, choice(RuleName(leaf.name) for leaf in leaves))
            if joint == "while doing":
                second = self._share(f"beside-{number}-doing", self._gerunds(others))
            else:
                second = self._share(f"beside-{number}", choice(RuleName(leaf.name) for leaf in others))
            found.append(joined((first, self._joint(joint), second)))
        return choice(found)

    def _joint(self, joint: str) -> Part:
        if joint == "while doing":
            return parse_rule('" " <while> " "', self._words)
        if joint.startswith(". "):
            return parse_rule(f'". " <{joint[2:]}> ", "', self._words)
        return parse_rule(f'" " <{joint}> " "', self._words)

    def _compare(self, kind: str) -> Part:
        return choice(
            self._row(form, lambda slot: RuleName(_rule_of(kind))) for form in self._vocabulary.comparing_forms(kind)
        )

    def _say_value(self, name: str) -> Part:
        return self._with_value("text", Text(f'"{_GIVEN % name}"'))

    def _add_key(self, name: str) -> Part:
        return self._share(f"keyed-{name}", self._with_key(name, self._actions))

    def _is_keyed(self, name: str) -> Part:
        return self._share(f"is-keyed-{name}", self._with_key(name, self._conditions))

    def _with_key(self, name: str, leaves: Sequence[_Leaf]) -> Part:
        """Return a phrase with this value in a slot of any type."""
        key = _GIVEN % name
        patterns = chain.from_iterable(self._vocabulary.roles.values())
        roles = [form for pattern in patterns for form in forms(pattern, self._vocabulary.articles)]
        joining = {_head(form) for form in roles if _slots_of(form)}  # `in {n1}` may be a time
        return choice(
            self._say(form, leaf, {slot: Text(f'"{key}"' if leaf.kinds.get(slot) == TEXT else key)})
            for leaf in leaves
            for form in leaf.forms
            if _head(form) not in joining
            for slot in _slots_of(form)
        )

    def _further(self, leaf: _Leaf) -> Part:
        """Return the shortest way to say a command, with the ports that it leaves out."""
        form = min(leaf.forms, key=len)
        known = (other for beside in self._actions if beside.entry is leaf.entry for other in beside.forms)
        behind = {other[len(form)] for other in known if other[: len(form)] == form != other}
        if not behind.isdisjoint(self._vocabulary.roles["with"]):  # `greet Bob with "hello"`
            return NOTHING
        said = set(_slots_of(form))
        if not {leaf.kinds.get(slot) for slot in said}.isdisjoint(_REGIONS):  # one name may be both
            said |= {slot.name for slot in leaf.entry.slots if slot.type in _REGIONS}
        return self._with_ports(self._say(form, leaf), leaf, said)

    def _exact(self, leaf: _Leaf) -> Part:
        """Return the id of a command with the ports of one way to say it."""
        node_id, slots = leaf.entry.id, set(_slots_of(min(leaf.forms, key=len)))
        words = said_id(node_id, "do", self._vocabulary)
        head = choice((Text(f'"{node_id}"'), *([Text(words)] if words else [])))
        return self._with_ports(head, leaf, {slot.name for slot in leaf.entry.slots} - slots)

    def _with_ports(self, head: Part, leaf: _Leaf, others: Collection[str]) -> Part:
        """Return a node with its ports but for the `others`; NOTHING if there are none."""
        ports = [slot for slot in leaf.entry.slots if slot.name not in others]
        if not ports:
            return NOTHING
        outputs = [slot.name for slot in ports if slot.name in leaf.entry.outputs]
        inputs = [self._port(slot) for slot in ports if slot.name not in outputs]
        parts = [head]
        if inputs:
            parts += [parse_rule('" " <with> " "', self._words), inputs[0]]
            parts += chain.from_iterable((Text(", "), port) for port in inputs[1:])
        for name in outputs:
            parts += [parse_rule('" " <giving> " "', self._words), Text(_GIVEN % name)]
        return joined(parts)

    def _port(self, slot: SlotSpec) -> Part:
        """Return the name of a port and its text."""
        kind = self._vocabulary.types[slot.type]
        if kind.kind == "names":
            value = choice(Text(f'"{name}"') for name in self._vocabulary.values.names(kind.name))
        elif kind.kind in ("text", "time"):
            value = self._value(kind) if kind.kind == "text" else NOTHING
        else:
            value = parse_rule(_WHOLE if kind.whole else _FIGURE, self._words)
        return joined((Text(f'"{slot.name}" '), value))

    def _with_value(self, kind: str, value: Part) -> Part:
        """Return a command with this value in a slot of the type."""
        return choice(
            self._say(form, leaf, {slot: value})
            for leaf in self._actions
            for form in leaf.forms
            for slot in _slots_of(form)
            if leaf.kinds.get(slot) == kind
        )

    def _by_type(self, statement: str) -> Part:
        """Return statements with the names of each type: `set`, `for each`, `go to every place`."""
        types = [kind for kind in self._vocabulary.types.values() if kind.kind == "names"]
        return choice(self._with_name(kind.name, f"v{number}", statement) for number, kind in enumerate(types, 1))

    def _with_name(self, kind: str, name: str, statement: str) -> Part:
        if statement == "chosen":
            return self._with_value(
                kind, choice(Text(" ".join(words)) for words in self._vocabulary.values.choices(kind))
            )
        if statement == "parameter":
            name = kind  # a parameter with the name of a type has that type
        used = self._with_value(kind, Text(_GIVEN % name))
        value = _rule_of(kind)
        if statement == "set":
            head = parse_rule(f'<set> " {name} " <set_to> " " {value} "; "', self._words)
        elif statement == "parameter":
            head = parse_rule(f'"r2 {{{name}}} " <define_strong> " "', self._words)
            return joined((head, used, parse_rule(f'"\\nr2 " {value}', self._words)))
        else:
            head = parse_rule(f'<each> " {name} " <each_in> " " {value} (", " {value})* ": "', self._words)
        return joined((head, used))

    def _gerunds(self, leaves: Iterable[_Leaf]) -> Part:
        """Return the leaves with the form of their verb that the table `doing` makes and the list of correct words
        has.
        """
        known = correct_words(self._vocabulary.word_list)
        known -= {str(form[0]) for leaf in self._conditions for form in leaf.forms}  # `if charging`
        found = []
        for leaf in leaves:
            for form in () if leaf.entry.constrains else leaf.forms:  # `while avoiding the lab` constrains
                verb, *rest = form
                if isinstance(verb, str):
                    ways = {
                        verb.removesuffix(bare) + ending
                        for ending, endings in self._vocabulary.doing.items()
                        for bare in endings
                        if verb.endswith(bare)
                    }
                    found += [self._say((way, *rest), leaf) for way in sorted(ways & known)]
        return choice(found)

    def _value(self, kind: ValueType) -> Part:
        """Return what a slot of the type takes."""
        if kind.kind == "names":
            return choice(map(Text, self._vocabulary.values.said_names(kind.name)))
        if kind.kind == "quantity":
            return choice(
                joined((self._figure(unit, kind), choice(Text(with_unit("", word)) for word in unit.words)))
                for unit in kind.units
            )
        if kind.kind == "time":
            return choice((parse_rule(_CLOCK, self._words), *self._times()))
        if kind.kind == "text":
            return parse_rule(_TEXT, self._words)
        return parse_rule(_WHOLE if kind.whole else _FIGURE, self._words)

    def _figure(self, unit: Unit, kind: ValueType) -> Part:
        """Return a number that with the unit isn't below the least of its type, or too small to matter."""
        factor = unit.numerator / unit.denominator
        is_small = factor < _SMALL or 0.1 * factor < (kind.least or 0)
        return self._share("whole" if is_small else "figure", parse_rule(_WHOLE if is_small else _FIGURE, self._words))

    def _times(self) -> Iterator[Part]:
        values = self._vocabulary.values
        for word in sorted(values.openers.get("time_of_day", ())):
            if values.takes_word("time_of_day", word):
                yield Text(word)
        for half in values.halves_of_day:
            yield joined(
                (Chars("[1-9]"), repeat(joined((Text(":"), Chars("[0-5]"), Chars("[0-9]"))), "?"), Text(f" {half}"))
            )


def _slots_of(form: Form) -> tuple[str, ...]:
    return tuple(part.name for part in form if isinstance(part, Slot))


def _head(form: Form) -> tuple[str, ...]:
    """Return the words before the first slot."""
    return tuple(map(str, takewhile(lambda part: isinstance(part, str), form)))


def _rule_of(kind: str) -> str:
    """Return the rule of the values of a type."""
    return f"value-{_kebab(kind)}"


def _kebab(name: str) -> str:
    """Return a name as rules have them: `MoveForward` is `move-forward`."""
    apart = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "-", name).lower()
    return re.sub(r"[^a-z0-9]+", "-", apart).strip("-")
