"""What a text names, found before its lines are read: included missions, places, definitions and values."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.symbols.continuations import find_continuations, named_at
from btlang.frontends.mission.symbols.definitions import find_definitions
from btlang.frontends.mission.symbols.facts import find_facts
from btlang.frontends.mission.symbols.given import find_arguments, find_given, find_outputs, untyped
from btlang.frontends.mission.symbols.includes import Included, find_includes
from btlang.frontends.mission.symbols.meanings import find_meanings
from btlang.frontends.mission.symbols.needs import find_needs
from btlang.frontends.mission.symbols.nodes import find_main_names
from btlang.frontends.mission.symbols.permissions import Permissions
from btlang.frontends.mission.symbols.phrases import Phrases
from btlang.frontends.mission.symbols.prefixes import find_prefixes
from btlang.text.source import Span
from btlang.text.words import Words
from btlang.tree.ast import Include, all_definitions, all_facts
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.reading_context import Known
from btlang.vocabulary.references import free_key, is_one
from btlang.vocabulary.word_tree import find

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    Load: TypeAlias = Callable[[str, Span], Included | None]
else:
    Load = None
_LONGEST_NAME = 4  # words


class Names:
    """The names of one text. `load` reads what it includes, `shared` are values that are named elsewhere and hold here.

    `vocabulary` has the places of its facts; `phrases` are those that were looked up on the way; `known` are the
    values that hold in the whole text, by key; `others` are the words where something other than a phrase begins:
    `prefixes`, headers of `definitions`, and statements that end at `ends`. `bounds` are the words at which other
    values begin to be known.
    """

    def __init__(self, text: Words, vocabulary: Lexicon, load: Load | None, shared: Mapping[str, Known] | None) -> None:
        includes = find_includes(text, vocabulary)
        loaded = [(path, span, load(path, span)) for path, span in includes.found] if load is not None else []
        self.includes = [Include(path, part.mission, span) for path, span, part in loaded if part is not None]
        self.included = {path: part for path, _, part in loaded if part is not None}
        """What was included, by its path as it is written."""
        parts = self.included.values()
        facts = find_facts(text, vocabulary)
        self.facts = facts.found
        meanings = find_meanings(text, vocabulary)
        self.meanings = meanings.found
        """Joining words that have another role here, each with that."""
        needs = find_needs(text, vocabulary)
        self.needs = tuple((need.role, need.path) for need in needs.found)
        """What the mission needs, each with the role of the words in front of the path."""
        given = find_given(text, vocabulary)
        self.given = tuple(given.keys)
        """The keys of the values that the mission is given."""
        self.permissions = Permissions(text, vocabulary)
        self.ends = includes.ends | facts.ends | needs.ends | meanings.ends | given.ends | self.permissions.ends
        self.main_name = ""
        main_span: Span | None = None
        for name, first, last in find_main_names(text, vocabulary):
            self.main_name, main_span = name, text.span(first, last)
            self.ends[first] = last
        places = [*(fact for part in parts for fact in all_facts(part.mission)), *self.facts]
        if places:
            vocabulary = vocabulary.with_places(tuple(dict.fromkeys(fact.name for fact in places)))
        self.vocabulary = vocabulary
        self.prefixes = find_prefixes(text, vocabulary)
        compared = {prefix.words for prefix in self.prefixes.values()}
        elsewhere = [definition for part in parts for definition in all_definitions(part.mission)]
        self.phrases = Phrases(text, vocabulary)
        text.going_on = find_continuations(self.phrases)
        self.definitions = find_definitions(self.phrases, self.ends, compared, elsewhere)
        text.going_on -= named_at(self.definitions.trie, self.phrases, text.going_on)
        self.problems: list[Diagnostic] = [*needs.problems, *facts.problems, *meanings.problems, *given.problems]
        self.problems += self.permissions.problems
        self.problems += self.definitions.problems
        if main_span is not None:
            defined = [header.name for header in self.definitions.headers.values()]
            if self.main_name in (*defined, *(definition.name for definition in elsewhere)):
                self.problems.append(diagnostic("BT127", main_span, name=self.main_name))
        self.others = {*self.prefixes, *self.ends, *self.definitions.headers}
        self.bounds: list[int] = []
        self.known = {key: one for named in (shared or {}, *(p.known for p in parts)) for key, one in named.items()}
        set_here = {prefix.key for prefix in self.prefixes.values() if prefix.role in ("set", "remember")}
        outside = {*self.given, *find_outputs(text, vocabulary)} - set_here
        self.known |= {key: untyped(key) for key in sorted(outside)}
        self._inside = list(
            find_arguments(text, vocabulary, self.definitions.headers.values(), self.definitions.subtrees)
        )
        self.chosen: dict[str, str] = {}
        """The keys for what the robot chooses, by type."""
        chosen = self._chosen_types(text)
        if self.known or chosen:
            self._name_choices(chosen)
        if (
            self.known
            or self._inside
            or self.prefixes
            or any(header.parameters for header in self.definitions.headers.values())
        ):
            self._name_values(text)

    def _chosen_types(self, text: Words) -> list[str]:
        """The types for which the robot chooses a name; `someone is near` is a phrase that only begins so."""
        values, starts = self.vocabulary.values, self.vocabulary.values.choice_starts
        if text.distinct.isdisjoint(starts):
            return []
        found: dict[str, None] = {}
        ends = {prefix.value: prefix.last for prefix in self.prefixes.values() if prefix.noun is not None}
        last = 0
        for at in [at for at, word in enumerate(text.words) if word in starts]:
            choice = values.choice(text, at) if at >= last and at not in ends else None
            last = choice[1] if choice is not None else max(last, ends.get(at, 0))
            if choice is not None and is_one(choice[0].how) and choice[0].type not in found:
                kind, named = choice[0].type, find(values.names_tree(choice[0].type), text.words, at)
                if (named is None or named[1] < last) and not self._is_in_name(kind, text, at):
                    match = self.phrases.at(at)
                    if match is None or (match.values and match.values[0].first == at):
                        found[kind] = None
        return list(found)

    def _is_in_name(self, kind: str, text: Words, at: int) -> bool:
        """Whether a word is a further one of a name: the second one of `living room`."""
        names = self.vocabulary.values.names_tree(kind)
        before = (find(names, text.words, first) for first in range(max(at - _LONGEST_NAME, 0), at))
        return any(named is not None and named[1] > at for named in before)

    def _name_choices(self, kinds: Iterable[str]) -> None:
        """A free key for each type: its name, or another one. What an included mission chooses gives way, too."""
        taken = {key for header in self.definitions.headers.values() for key, _ in header.parameters}
        taken |= {prefix.key for prefix in self.prefixes.values()}
        self.known = {key: one for key, one in self.known.items() if not (one.is_chosen and key in taken)}
        taken |= {key for key, one in self.known.items() if not one.is_chosen}
        self.chosen = {kind: free_key(kind, taken) for kind in kinds}
        self.known |= {key: Known(key, tuple(key.split("_")), (kind,), True) for kind, key in self.chosen.items()}

    def _name_values(self, text: Words) -> None:
        from btlang.frontends.mission.symbols.variables import Variables  # most missions have none

        before = len(self.definitions.problems)
        self._variables = Variables(text, self.vocabulary, self.prefixes, self.definitions, self.known, self._inside)
        self.known, self.bounds = self._variables.everywhere, self._variables.bounds
        self.problems += self.definitions.problems[before:] + self._variables.problems

    def known_at(self, word: int) -> dict[str, Known]:
        """The values that are known at a word, by key."""
        return self._variables.at(word) if self.bounds else self.known

    def included_conditions(self) -> set[str]:
        """The names of included missions that stand for conditions."""
        return {name for part in self.included.values() for name in part.conditions}
