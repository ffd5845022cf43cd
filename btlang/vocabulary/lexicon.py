"""All words that a mission may use, from the keyword files that were loaded."""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import chain

from btlang.diagnostics.diagnostic import Diagnostic, MissionError, diagnostic
from btlang.text.source import Source, Span
from btlang.text.spelling import nearest
from btlang.text.words import Orthography, split
from btlang.vocabulary.antecedents import pronouns_for
from btlang.vocabulary.cache import recent
from btlang.vocabulary.entry import COMPARISONS, About, Entry, Meaning, Role, SlotSpec
from btlang.vocabulary.language_tables import (
    ASKING,
    GOES_ON,
    NO_PHRASES,
    NOT_ALONE,
    ROLES,
    about_roles,
    comparing_phrases,
    merged,
)
from btlang.vocabulary.later import packed, unpacked
from btlang.vocabulary.nouns import Features, with_plurals
from btlang.vocabulary.pattern import Form, PatternError, Slot, forms, replaced, variants, ways
from btlang.vocabulary.reading_context import Known, ReadingContext
from btlang.vocabulary.references import HOME
from btlang.vocabulary.trie import TrieNode, add, collisions, copied, unshare
from btlang.vocabulary.value_type import PERSON, PLACE, WORLD, ZONE, ValueType
from btlang.vocabulary.values import Values
from btlang.vocabulary.verbs import Beginnings, Frame, beginnings_of, parts_of, phrases_of
from btlang.vocabulary.word_tree import NO_WORDS, VERBS, WordTree, tree_of, words_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from btlang.vocabulary.entry import Verbs
    from btlang.vocabulary.keyword_file import KeywordFile

DEFINING = ("define_strong", "define")
"""Roles whose words define a name where they are found first in a line; elsewhere they are words like any other."""

NODE_ROLES = ("do", "test")
"""Roles whose words begin a node that is said by its id, a command or a condition."""

_CONDITIONAL = ("if", "unless", "whenever", "as_soon_as", "once", "while", "until", "check", "provided")
"""Roles of words behind which a condition stands."""
_JOINING = ("and", "then", "or", "but")

_SHARED = (Entry, Role, SlotSpec, Frame, Beginnings, Span, Source)
"""Classes of what phrases refer to in many places."""
_NUMBERED, _TIMES = ("at_most", "up_to_times", "count"), "{count} time(s)"
_AT_END = " ."  # behind an idiom that is one only at the end of a clause
_REPLIES = (("if_yes", True), ("if_no", False))


class Lexicon:
    """Phrases, types and connectives of a language and its packs; frozen once it is made.

    `about` says what each role means to people; it holds every role. `folder` is that of the language. Another language
    than English takes all but the words from the `english` lexicon: what its entries do, and what their slots take.
    Raises MissionError (BT060 to BT062) where the files do not fit together.
    """

    def __init__(
        self,
        files: Iterable[KeywordFile],
        entries: Iterable[Entry] = (),
        english: Lexicon | None = None,
        folder: str = "",
    ) -> None:
        self.language = os.path.basename(folder)
        """What its language is called in options: "en", "es"."""
        self._problems: list[Diagnostic] = []
        self._redeclared: dict[str, Span] = {}  # types that exist already, each where it is declared last
        self._added: TrieNode | None = None
        """What `extended` adds."""
        self._own_nodes: set[int] = set()
        self.trie: TrieNode = {}
        self.entries: dict[str, list[Entry]] = {}
        """By id. Entries of an id that has no words in this language have no phrases."""
        files = list(files)
        tables = [file.language for file in files]
        language = merged(tables)
        if english is not None:
            language["roles"] = {**english.roles, **language["roles"]}  # a role without words keeps the English ones
            language["comparisons"] = {**english.comparisons, **language["comparisons"]}
            for node_id, known in english.entries.items():
                self.entries[node_id] = [
                    entry.replace(phrases=(), quantity=(), verbs=(), example="") for entry in known
                ]
        titles = frozenset(language["titles"])
        contractions = {word: tuple(read.split()) for word, read in language["contractions"].items()}
        spellings = {word: read[0] for word, read in contractions.items() if len(read) == 1}
        expanded = {word: read for word, read in contractions.items() if len(read) > 1}
        self.orthography = Orthography(
            titles.union(language["articles"]), language["decimal_comma"], spellings, expanded=expanded, titles=titles
        )
        self.asking: Mapping[str, Sequence[str]] = {
            **dict.fromkeys(ASKING, ()), **{name: tuple(ways(said)) for name, said in language["asking"].items()}
        }  # fmt: skip
        """Words that questions and shortened journeys leave out, and those that begin questions, by what they are."""
        said = chain(*language["roles"].values(), *language["negations"].values(), *self.asking.values())
        said = chain(said, language["politeness"], language["relatives"], language["relative_denials"])
        contracted = {
            word for phrase in said for word in re.split(r"[ /]", phrase) if re.fullmatch(r"[a-z]+'[a-z]+", word)
        }
        bare = {word.replace("'", ""): word for word in (*contracted, *expanded)}
        for word in bare.keys() - set(language["like_contractions"]):  # `dont`, `theres`
            (expanded if bare[word] in expanded else spellings)[word] = expanded.get(bare[word], bare[word])
        self.orthography = self.orthography.with_contractions({*contracted, *expanded})
        self._with_names: dict[tuple[object, ...], Lexicon] = {}
        self.values = Values(self._types_of(files, english), language, [noun for file in files for noun in file.nouns])
        for file in files:
            for kind, words, name in file.names:
                if self.types[kind].kind == "names":
                    self.values.add_name(kind, self.orthography.bare(words), name)
        nouns = chain(*(language["nouns"].get(kind, (kind,)) for kind in (PLACE, ZONE)))
        self._heads = sorted({*self.values.ones, *nouns})
        self._shapes: list[str] = language["shapes"]
        own = {kind: [(name, name) for name in self.values.listed(kind)] for kind in WORLD if kind in self.types}
        for kind, pairs in self._colors(own).items():
            for color, name in pairs:
                self.values.add_name(kind, color, name)
        self.context = ReadingContext(self.values)
        """What is known without a mission; each reader of one has its own context."""
        self.roles: dict[str, list[str]] = {**language["roles"], "politeness": language["politeness"]}
        name = language["language"]
        self.word_list = os.path.join(folder, f"{name}.words") if folder and name.isalpha() else ""
        """The file of the correct words of the language, which need not be there."""
        self.quantifiers, self.halting = frozenset(language["quantifiers"]), frozenset(language["halting"])
        """Negations and words for how many, and words like `stop`: corrections are careful about them."""
        self.asked_once = frozenset(language["asked_once"])
        self.subjects = frozenset(language["subjects"])
        """Words that say nothing behind `until` and `before`: `until you go to the lab`."""
        self.last_ones = frozenset(words for words, number in language["ordinals"].items() if number == -1)
        """Words for the last of several: `last`."""
        self.remarks: tuple[WordTree, ...] = tuple(
            tree_of((phrase, True) for phrase in self.asking[name]) for name in ("feeling", "there", "states")
        )
        """The words of remarks: how somebody feels, that there is something, and what may be felt."""
        self.been = tree_of((words, True) for words in self.asking["been"])
        """The words of a journey that is behind somebody: `have been in`."""
        self.yet = tree_of((words, True) for words in self.asking["yet"])
        """The words at the end of a condition that say nothing: `yet`."""
        self.contents = tree_of((words, True) for words in self.asking["contents"])
        """What may be in a thing: `water`."""
        self.content_words = frozenset(language["qualities"].get("content", ())[:1])
        self.staying = tree_of((words, True) for words in self.asking["staying"])
        """What does nothing where it stands alone: `stay here`."""
        self.numbers = tree_of((words, True) for words in self.asking["numbers"])
        self.in_all = tree_of((words, True) for words in self.asking["in_all"])
        self.opinions = tree_of((words, True) for words in self.asking["opinions"])
        self.left_there = tree_of((words, True) for words in self.asking["left_there"])
        self.forbidding = tree_of((words, True) for words in ways(self.roles.get("never", ()), self.articles))
        self.throughout = tree_of((words, True) for words in self.asking["throughout"])
        self.in_turn = tree_of((words, True) for words in self.asking["in_turn"])
        """The words beside a list that say nothing: `in that order`."""
        self.ended = tree_of((words, role == "fewer") for role in ("ended", "fewer") for words in self.asking[role])
        """The words for what isn't so any more, and whether they are about a count: `it's gone`, `there are fewer`."""
        self.denied = tree_of((words, True) for words in self.asking["denied"])
        """The words that deny what was checked: `it isn't`."""
        self.relatives = tree_of((words, True) for words in language["relatives"])
        """The words that begin what is said of a thing: `that is`."""
        denied = (form for verb in self.asking["asking_be"] for form in language["negations"].get(verb, ()))
        self.forms_of_be = {**dict.fromkeys(self.asking["asking_be"], False)}
        """The forms of `be` with which something is said of a thing, and whether they deny it: `is`, `aren't`."""
        self.forms_of_be.update((form, True) for form in denied if " " not in form)
        self.telling_to = tree_of((words, True) for words in self.asking["telling_to"])
        """The words before what somebody tells the robot to do: `tells you to`."""
        self.try_again = tree_of((words, True) for words in ways(self.roles["try_again"], self.articles))
        """The words that begin to try something anew: `try again`."""
        self.any_day = tree_of((words, True) for words in self.asking["any_day"])
        """The words for all days, from which some may be left out: `every day`."""
        self.entering = tree_of((words, True) for words in self.asking["entering"])
        """The words behind which a place is left out: `go in`."""
        self.at_once = tree_of((words, True) for words in self.asking["at_once"])
        """The words for soon behind whom somebody tells something: `right away`."""
        self.outside = tree_of((words, True) for words in self.asking["outside"])
        """The words before a room at whose door something is done."""
        self.some_time = tree_of((words, True) for words in ways(self.asking["some_time"], self.articles))
        """The words for a time of which nobody knows how long it is: `a moment`."""
        self.until_none = tree_of((words, True) for words in self.asking["until_none"])
        """The words that say nothing behind all things of a kind: `until none are left`."""
        self.and_back = tree_of((words, True) for words in self.asking["and_back"])
        """The words for a journey back: `to the lab and back`."""
        self.going = tree_of((words, True) for words in self.asking["going"])
        """The words that say nothing before another command: `go and`."""
        self.asides: tuple[WordTree, ...] = tuple(
            tree_of((words, True) for words in self.asking[name]) for name in ("interrupting", "resuming")
        )
        """What says in a standing rule that the rest waits, and that it goes on."""
        self.telling = tree_of((words, True) for words in self.asking["telling"])
        """The words before a text in quotes that is to be said: `tell me`."""
        self.duties, self.obliging, self.reasons, self.able, self.unable, self.reaching, self.finishing = (
            tree_of((words, True) for words in self.asking[name])
            for name in ("duties", "obliging", "reasons", "able", "unable", "reaching", "finishing")
        )
        """What no sentence has that only tells something, and what begins a reason, and what couldn't be done."""
        self.likewise = tree_of((phrase, True) for phrase in self.asking["likewise"])
        self.answering = tree_of((phrase, True) for phrase in self.asking["answering"])
        self.replies = tree_of((words, is_yes) for name, is_yes in _REPLIES for words in self.asking[name])
        """Words behind a question, each with whether it is for a yes: `if so`."""
        verb = "".join(self.asking["journey"][:1])
        self.journey_verbs = frozenset((verb, *self.values.role_words.synonyms.get(verb, ())))
        """The verbs of a journey: `go from the lab to the hall`."""
        self.purpose = tree_of((phrase, True) for phrase in language["purpose"])
        """Words between a command and what it is for: `go through the hall to get to the lab`."""
        self.before_conditions, self.joining = self._first_words(_CONDITIONAL), self._first_words(_JOINING)
        """The first words of what stands before a condition, and of what joins commands."""
        self.firsts = {
            role: frozenset(words.split()[0] for words in ways(phrases, self.articles))
            for role, phrases in self.roles.items()
        }
        """The first words of what says each role."""
        self.continuing = frozenset(
            str(form[0]) for role in GOES_ON for phrase in self.roles.get(role, ()) for form in self._forms(phrase)
        )
        """The words with which a statement may begin that goes on with the one before it."""
        self.counts: dict[str, int] = language["counts"]
        self.doing: dict[str, list[str]] = language["doing"]
        """The endings of the form that a verb has behind `while` or `before`, each with those of the verb itself."""
        self.third_person: dict[str, list[str]] = language["third_person"]
        """The same for the form behind a subject: `the robot waves`."""
        self.of_robot: dict[str, str] = language["of_robot"]
        """What a mission calls the robot, and what the robot calls itself: `you are`, `I am`."""
        self.affirmed: dict[str, str] = language["affirmed"]
        """The words of what is asked, and of what turns out to be so: `anybody`, `somebody`."""
        self.happened: dict[str, str] = language["happened"]
        """The verbs of what is so, and of what was so: `is`, `was`."""
        idioms = [(way, said) for words, said in language["idioms"].items() for way in ways([words])]
        self.idioms = tree_of((way, said) for way, said in idioms if not way.endswith(_AT_END))
        self.last_idioms = tree_of((way.removesuffix(_AT_END), said) for way, said in idioms if way.endswith(_AT_END))
        """Those that are read only at the end of a clause."""
        """Words that are read as others: `whoever says` as `everyone who says`."""
        self.persons: dict[str, list[str]] = language["persons"]
        """The other words for the person for whom a word stands: of `he`, `him` and `his`."""
        self.pronouns_for_people = frozenset(pronouns_for(self.values.pronouns, PERSON, alone=True))
        """The pronouns that stand for nothing else: `her`."""
        self.of_hearer: dict[str, str] = language["of_hearer"]
        """The verbs of what is said of somebody, and to them: `is`, `are`."""
        self._openings: dict[tuple[tuple[str, ...], ...], frozenset[str]] = {}
        """The first words of the phrases of entries, once somebody has asked for them."""
        self._said: dict[str, str] = {}
        """The words of roles, once somebody has asked for them."""
        self.perfect: dict[str, str] = language["perfect"]
        """How a condition says that it has held for some time, and what it says: `has been`, `is`."""
        self.nodes: dict[str, str] = language["nodes"]
        """The words of nodes that have some, by their ids."""
        self.node_details: dict[str, str] = language["node_details"]
        """What says ports of all nodes: `unless`, with a text in quotes behind it, or `with all values {=true}`."""
        self.node_forms: dict[str, list[str]] = language["node_forms"]
        """What says a node with the children below it, by its id: `at most {hz} times a second`, `once {times=1}`."""
        self.meanings: dict[str, str] = language["meanings"]
        """Connectives that have another role between commands: `and` may mean `then`."""
        self.about: dict[str, About] = about_roles(tables, english.about if english is not None else {})
        self.quantities: TrieNode = {}
        """The phrases of quantities alone: before `is` they compare and define nothing."""
        self.measured: tuple[TrieNode, TrieNode] = (self.quantities, {})
        """The phrases of quantities, and the further words for their values alone."""
        self.comparisons: dict[str, list[str]] = language["comparisons"]
        self.negations: dict[str, list[str]] = language["negations"]
        self.negative_subjects: dict[str, list[str]] = language["negative_subjects"]
        self._plurals: dict[str, list[str]] = language["plurals"]
        self._endings: dict[str, str] = language["plural_endings"]
        self._other_names = [{name, *others} for name, others in language["other_names"].items()]
        self._add_roles()
        for entry in (*(e for f in files for e in f.entries), *entries):
            self._add_entry(entry)
        for entry in () if self._problems else chain(*self.entries.values()):
            self._add_variants(entry)
        self._find_collisions()
        if self._problems:
            raise MissionError(self._problems)
        self._phrase_words = frozenset(words_of(self.trie, *self.measured))
        self._before_accents = self.orthography
        self.orthography = self.orthography.with_words((*self.words(), *self.values.pronouns))
        self._is_made = True

    def __setattr__(self, name: str, value: object) -> None:
        if "_is_made" in self.__dict__:
            raise AttributeError(f"a Lexicon is frozen: cannot set {name}")
        super().__setattr__(name, value)

    def __getstate__(self) -> dict[str, object]:
        return {**self.__dict__, "trie": packed(self.trie, _SHARED)}

    def __setstate__(self, state: dict[str, Any]) -> None:
        children, shared = state["trie"]
        self.__dict__.update(state, trie=unpacked(children, shared, NO_WORDS))

    @property
    def articles(self) -> frozenset[str]:
        """Words that say nothing: articles, and titles but for those that tell names apart."""
        return self.orthography.articles

    @property
    def types(self) -> Mapping[str, ValueType]:
        """Slot types by name."""
        return self.values.types

    def entry(self, node_id: str) -> Entry | None:
        """The (first) entry of a node id."""
        found = self.entries.get(node_id)
        return found[0] if found else None

    def opening_words(self, *ids: str) -> frozenset[str]:
        """The first words of the phrases of the (first) entries of nodes."""
        entries = [entry for node_id in ids if (entry := self.entry(node_id)) is not None]
        phrases = tuple(entry.phrases for entry in entries)
        if phrases not in self._openings:
            self._openings[phrases] = frozenset(phrase.split()[0] for phrase in chain(*phrases))
        return self._openings[phrases]

    def extended(self, entries: Sequence[Entry]) -> Lexicon | None:
        """These words and those of further entries, made in a tenth of the time, as both share what doesn't change.

        None where these change what is known, or collide with it: then a lexicon must be made of all files.
        """
        trie, added = copied(self.trie), TrieNode()
        made = self.replaced(
            trie=trie, entries={**self.entries}, orthography=self._before_accents, _problems=[], _added=added,
            _own_nodes={id(trie)},
        )  # fmt: skip
        own: list[Entry] = []
        for entry in entries:
            known = made.entries.get(entry.id, [])
            changes = entry.replaces or entry.quantity or entry.denied or (known and known[0].measures)
            if changes or not (known or entry.sort) or (entry.call and any(other.yields for other in known)):
                return None
            made.entries[entry.id] = [*known]
            made._add_entry(entry)
            if made._problems:
                return None
            own.append(made.entries[entry.id][-1])
        for entry in own:
            made._add_variants(entry)
        made._find_collisions()
        words = words_of(added)
        accents = self.orthography.spellings.keys() - self._before_accents.spellings.keys()
        if made._problems or not words.isdisjoint(accents) or not all(word.isascii() for word in words):
            return None
        own_words = self._phrase_words | words
        return made.replaced(orthography=self.orthography, _added=None, _own_nodes=set(), _phrase_words=own_words)

    def with_names(self, names: Mapping[str, Sequence[str]], features: Features | None = None) -> Lexicon:
        """The same words, whose slots take further names by their types: the places, people and objects of a world.

        `features` are what those are like, by type and name. The same object for the same names and features.
        """

        def made() -> Lexicon:
            orthography = self.orthography
            for listed in names.values():
                orthography = orthography.told_apart(listed)
            pairs = {kind: [(orthography.bare(name), name) for name in listed] for kind, listed in names.items()}
            for kind, listed in names.items() if orthography.articles != self.articles else ():
                untitled = Counter(map(self.orthography.bare, listed))  # `Weber` is still Dr Weber where nobody else is
                pairs[kind] += [(short, name) for name in listed if untitled[short := self.orthography.bare(name)] == 1]
            home = next((name for name, parts in (features or {}).get(PLACE, ()) if HOME in parts), "")
            if home:
                pairs[PLACE] = [*pairs[PLACE], *((words, home) for words in self.asking["home"])]
            colors, others = self._colors(pairs), self._others(pairs)
            further = {kind: [*own, *colors.get(kind, ()), *others[kind]] for kind, own in pairs.items()}
            pairs = with_plurals(further, self._endings)
            values = self.values.with_names(pairs, features, orthography.articles)
            words = (word for pair in chain(*pairs.values()) for word in pair[0].lower().split())
            written = orthography.with_words(word for word in words if not word.isascii())
            return self.replaced(values=values, context=ReadingContext(values), orthography=written)

        known = (*((kind, tuple(listed)) for kind, listed in names.items()), *(features or {}).items())
        return recent(self._with_names, known, made)

    def _colors(self, named: dict[str, list[tuple[str, str]]]) -> dict[str, list[tuple[str, str]]]:
        """`the green`, `the green one`, `the green square` for the green room, where no other name has that color."""
        names = {name.lower() for pairs in named.values() for _, name in pairs}
        made = {}
        for kind in (PLACE, ZONE):
            firsts = [(words.lower().partition(" ")[0], name) for words, name in named.get(kind, ()) if " " in words]
            colors = [(color, name) for color, name in firsts if self.values.takes_word("color", color)]
            own = [pair for pair in colors if sum(f"{name} ".startswith(f"{pair[0]} ") for name in names) == 1]
            made[kind] = own + [
                (f"{color} {one}", name) for color, name in own for one in (*self._heads, *self._shapes)
            ]
            rests = ((f"{color} {{}}{name[len(color) :]}", name) for color, name in own)  # `the green square room`
            made[kind] += [(words.format(shape), name) for words, name in rests for shape in self._shapes]
        return made

    def _others(self, named: dict[str, list[tuple[str, str]]]) -> dict[str, list[tuple[str, str]]]:
        """Other words for the same, `the hallway` for the hall, where nothing else has that name, or one of these."""
        taken = {words.lower() for pairs in named.values() for words, _ in pairs}
        return {
            kind: [
                (other, name)
                for words, name in pairs
                for group in self._other_names
                if group & taken == {words.lower()}
                for other in sorted(group - taken)
            ]
            for kind, pairs in named.items()
        }

    def with_places(self, names: tuple[str, ...]) -> Lexicon:
        """The same words with further places, as a mission names them."""
        return self.with_names({"place": names})

    def with_references(self) -> Lexicon:
        """The same words, where any name in braces is read as a value."""
        return self.replaced(context=self.context.with_references())

    def with_known(self, known: Mapping[str, Known]) -> Lexicon:
        """The same words, where these values are known by their keys."""
        return self.replaced(context=ReadingContext(self.values, known))

    def replaced(self, **changed: object) -> Lexicon:
        """The same words, with other values of attributes."""
        made = Lexicon.__new__(Lexicon)  # what `copy` does, which takes long to import
        made.__dict__.update(self.__dict__, _with_names={}, **changed)
        return made

    def value(self, kind: str, written: str) -> str | None:
        """The port text of a text that as a whole is a value of the type (`half an hour`), None where it is none."""
        text = split(Source(written), self.orthography)
        found = self.context.read(kind, text, 0)
        return found[0] if found and found[1] >= len(text.words) - 2 else None

    def says_event(self, words: str) -> bool:
        """Whether the words of a condition say that something happens: `somebody comes`."""
        return not set(self.asking["events"]).isdisjoint(words.lower().split())

    def first(self, role: str) -> str:
        """The pattern of a role that messages and canonical English use: the first in its list that means it."""
        return next((phrase for phrase in self.roles[role] if phrase not in self.meanings), self.roles[role][0])

    def word(self, role: str) -> str:
        """The words of that pattern."""
        if role not in self._said:
            words = forms(self.first(role))[-1]
            self._said[role] = " ".join(word for word in words if isinstance(word, str))
        return self._said[role]

    def words(self) -> frozenset[str]:
        """Every word that can be read, also those in names and values."""
        trees: list[TrieNode] = [*self.values.word_trees(), self.values.phrases.tree]
        trees += [self.values.names_tree(name) for name, kind in self.types.items() if kind.kind == "names"]
        words = words_of(*trees) | self._phrase_words | self.articles
        said = self.values.role_words
        words.update(said.particles, said.fillers, said.speaker, *chain(*said.introducing.values()))
        words.update(self.values.modifiers.words())
        for role in NO_PHRASES:
            words.update(word for phrase in self.roles.get(role, ()) for word in phrase.split())
        return frozenset(word for word in words if word.isalpha())

    def _first_words(self, roles: Iterable[str]) -> frozenset[str]:
        return frozenset(phrase.split()[0] for role in roles for phrase in self.roles.get(role, ()))

    def _types_of(self, files: Iterable[KeywordFile], english: Lexicon | None) -> dict[str, ValueType]:
        """The types by name; a file may redeclare one, but not with another kind. Its least number stays."""
        types: dict[str, ValueType] = dict(english.types) if english is not None else {}
        for file in files:
            for kind in file.types:
                known, span = types.get(kind.name, kind), kind.span or Span(file.source, 0, 0)
                if known is not kind:
                    self._redeclared[kind.name] = span
                if known.kind == kind.kind:
                    types[kind.name] = kind.replace(least=known.least) if kind.least is None else kind
                    continue
                reason = f"the type {kind.name} already exists with another kind"
                self._problems.append(diagnostic("BT060", span, reason=reason))
        return types

    def _add_roles(self) -> None:
        for role, phrases in self.roles.items():
            if not phrases and role in ROLES:
                near = Span(Source(role, "words"), 0, len(role))
                self._problems.append(diagnostic("BT060", near, reason=f"no word is left of the role '{role}'"))
            for phrase in phrases if role not in NO_PHRASES else ():
                self._add_words(phrase, Meaning(role, between=self.meanings.get(phrase, "")))
        for words, rounds in self.counts.items():
            self._add_words(words, Meaning("count", value=rounds))
            numbers = ((role, phrase) for role in _NUMBERED for phrase in self.roles.get(role, ()) if rounds > 0)
            for role, phrase in numbers:  # `at most twice`, `exactly twice`
                if _TIMES in phrase:
                    self._add_words(phrase.replace(_TIMES, words), Meaning(role, value=rounds))
        for node_id, words in self.nodes.items():
            for role in NODE_ROLES:
                for head in self.roles[role]:
                    self._add_words(f"{head} {words}", Meaning(role, node=node_id))

    def _add_words(self, phrase: str, meaning: Meaning) -> None:
        try:
            self._add_phrase(phrase, meaning, {})
        except PatternError as error:  # all of its words are articles of another file
            self._problems.append(diagnostic("BT060", Span(Source(phrase, "words"), 0, len(phrase)), reason=str(error)))

    def _phrases_of(self, entry: Entry) -> Entry | None:
        """The entry that an entry of phrases alone stands for, without what it does; None for an unknown id (BT061)."""
        known = self.entries.get(entry.id)
        if not known:
            near = nearest(entry.id, self.entries)
            self._wrong(entry, f"no entry has the id '{entry.id}'" + (f"; similar: {', '.join(near)}" if near else ""))
            return None
        slots = {slot.name for slot in known[0].slots}
        verbs, said_so = self._with_roles(entry)
        phrases = (*entry.phrases, *(phrase for phrase in said_so if phrase not in entry.phrases))
        try:
            parts = {part for text in phrases for form in forms(text) for part in form}
        except PatternError as error:
            self._wrong(entry, str(error))
            return None
        used = {part.name for part in parts if isinstance(part, Slot)}
        for name in sorted(used - slots):
            self._wrong(entry, f"{entry.id} has no slot {{{name}}}")
        said = {"quantity" if known[0].measures else "phrases": phrases}
        made: Entry = known[0].replace(
            **{"phrases": (), **said},
            call="",
            ros=None,
            replaces=False,
            span=entry.span,
            verbs=verbs,
            yields=entry.yields,
        )
        made = self._with_comparisons(made) if made.measures else made
        return made if used <= slots else None

    def _declared(self, entry: Entry) -> Entry | None:
        """An entry with what the words of the language make of it; None where the type of a slot is unknown (BT061)."""
        if entry.replaces and not entry.id:
            entry = entry.replace(id=self._replaced_id(entry))
        if entry.measures:
            entry = self._with_comparisons(entry)
        slots = (
            SlotSpec(slot.name, slot.otherwise, slot.default)
            if slot.otherwise and slot.type not in self.types
            else slot
            for slot in entry.slots
        )
        entry = entry.replace(slots=tuple(slots))
        unknown = [slot for slot in entry.slots if slot.type not in self.types]
        for slot in {slot.type: slot for slot in reversed(unknown)}.values():  # a quantity has five of one type
            known = f"known are {', '.join(sorted(self.types))}"
            if slot.type == entry.measures:
                self._wrong(entry, f"what it measures has no type '{slot.type}'; [[type]] declares one, {known}")
                continue
            how = "annotate it with int, float, str or btlang.Length ..." if callable(entry.call) else known
            self._wrong(entry, f"the slot {{{slot.name}}} has no type '{slot.type}'; {how}")
        if unknown:
            return None
        verbs, said = self._with_roles(entry)
        made: Entry = entry.replace(
            slots=tuple(self._with_port_default(entry, slot) for slot in entry.slots),
            verbs=verbs,
            phrases=(*said, *(phrase for phrase in entry.phrases if phrase not in said)),
        )
        return made

    def _with_roles(self, entry: Entry) -> tuple[Verbs, list[str]]:
        """The verbs of an entry with the words that introduce their roles, and the patterns that say them."""
        verbs = tuple((verbs, tuple(map(self._introduced, roles))) for verbs, roles in entry.verbs)
        particles = self.values.role_words.particles
        return verbs, [phrase for own, roles in verbs for phrase in phrases_of(own, roles, particles)]

    def _introduced(self, role: Role) -> Role:
        """The role with the words of the language that introduce it, unless its entry narrows them."""
        words = role.words or self.values.role_words.introducing.get(role.name, ())
        return role.replace(words=words)  # type: ignore[no-any-return]

    def _add_verbs(self, entry: Entry) -> None:
        """Lets each verb of an entry, and those that mean the same, be said with its roles in any order."""
        known = self.values.role_words
        for verbs, roles in entry.verbs:
            beginnings = beginnings_of(roles)
            for verb in dict.fromkeys((*verbs, *chain(*(known.synonyms.get(verb, ()) for verb in verbs)))):
                words, particle = parts_of(verb, known.particles)
                node = self.trie
                if self._added is not None:
                    unshare(
                        node, tuple(self.orthography.spellings.get(word, word) for word in words), {}, self._own_nodes
                    )
                for word in words:
                    node = node.setdefault(self.orthography.spellings.get(word, word), {})
                frames = node.setdefault(VERBS, [])
                made = Frame(entry, roles, beginnings, particle)
                if made not in frames:
                    frames.append(made)

    def _add_entry(self, given: Entry) -> None:
        entry = self._declared(given) if given.sort else self._phrases_of(given)
        if entry is None:
            return
        types = {slot.name: slot.type for slot in entry.slots}
        same = self.entries.setdefault(entry.id, [])
        if same and same[0].sort != entry.sort:
            self._wrong(entry, f"the id {entry.id} is already that of the {same[0].sort} in {same[0].file}")
        self._check_call(entry, same)
        same.append(entry)
        self._add_verbs(entry)
        for phrase in entry.phrases:
            try:
                self._add_phrase(phrase, Meaning("command" if entry.sort == "action" else "condition", entry), types)
            except PatternError as error:
                self._wrong(entry, str(error))
        for phrase in entry.denied:
            self._add_phrase(phrase, Meaning("negated", entry), types)

    def _replaced_id(self, entry: Entry) -> str:
        """The id of the known word that has its phrase."""
        own = self._forms_of(entry)
        for node_id, known in self.entries.items():
            if any(not own.isdisjoint(self._forms_of(other)) for other in known):
                return node_id
        self._wrong(entry, "no known word has this phrase, so there is nothing to replace; give the id of the word")
        return ""

    def _forms_of(self, entry: Entry) -> set[Form]:
        phrases = (*entry.phrases, *entry.quantity) if not entry.measures else entry.quantity
        return {form for phrase in phrases for form in forms(phrase, self.articles)}

    def _check_call(self, entry: Entry, same: Sequence[Entry]) -> None:
        """BT064 where an id has two functions and nothing says which one is meant."""
        other = next((one for one in same if one.call and entry.call and one.call != entry.call), None)
        if other is None or entry.replaces:
            return
        span = entry.span or Span(Source(entry.id, "Python"), 0, len(entry.id))
        fix = f'replaces = ["{entry.id}"]' if isinstance(entry.call, str) else "replace=True"
        self._problems.append(diagnostic("BT064", span, id=entry.id, file=other.file, fixed=fix))

    def _with_comparisons(self, entry: Entry) -> Entry:
        """`battery` becomes `battery is below {below}` and so on, for each way to compare."""
        for pattern in entry.quantity:
            try:
                for form in self._forms(pattern):
                    add(self.quantities, form, {s.name: s.type for s in entry.slots}, Meaning("quantity", entry))
                for name in entry.named:
                    for form in self._forms(name):
                        add(self.measured[1], form, {}, Meaning("quantity", entry))
            except PatternError:
                return entry  # reading the keyword file has reported it
        ways = [way for name, patterns in self.comparisons.items() for way in comparing_phrases(name, patterns)]
        phrases = tuple(f"{quantity} {way}" for way in ways for quantity in entry.quantity)
        compared = tuple(SlotSpec(name, entry.measures) for name in COMPARISONS)
        own = (slot for slot in entry.slots if slot.name not in COMPARISONS)
        made: Entry = entry.replace(phrases=phrases, slots=(*own, *compared))
        return made

    def _with_port_default(self, entry: Entry, slot: SlotSpec) -> SlotSpec:
        """Defaults are written with units; ports hold them in the base unit."""
        kind = self.types[slot.type]
        if slot.default is None or kind.kind in ("text", "names"):
            return slot
        value = self.value(slot.type, slot.default)
        again = self._redeclared.get(kind.name)
        if value is None and again is not None and again.source.name != entry.file:
            reason = (
                f"the type {kind.name} exists already, and here '{slot.default}', which {entry.id} needs, isn't one "
                "of its values; give this type another name or all its units"
            )
            if not any(problem.span is again for problem in self._problems):
                self._problems.append(diagnostic("BT060", again, reason=reason))
            return slot
        if value is None:
            reason = (
                f"the default '{slot.default}' of {{{slot.name}}} isn't a valid {slot.type}, such as {kind.example}"
            )
            self._wrong(entry, reason)
            return slot
        return SlotSpec(slot.name, slot.type, value)

    def _forms(self, pattern: str) -> Iterator[Form]:
        """Every way to say a pattern, in words as they are read."""
        read, expanded = self.orthography.spellings, self.orthography.expanded
        for form in forms(pattern, self.articles):
            if expanded and any(part in expanded for part in form):
                parts = (expanded.get(part, (part,)) if isinstance(part, str) else (part,) for part in form)
                form = tuple(chain.from_iterable(parts))
            yield tuple(read.get(part, part) if isinstance(part, str) else part for part in form)

    def _add_phrase(self, phrase: str, meaning: Meaning, types: dict[str, str]) -> None:
        for form in self._forms(phrase):
            before = self._add_form(form, meaning, types)
            if before is not None:
                self._collide(before, meaning)

    def _add_form(self, form: Form, meaning: Meaning, types: dict[str, str]) -> Meaning | None:
        own = {part.name: types.get(part.name, part.name) for part in form if isinstance(part, Slot)}
        if self._added is not None:
            unshare(self.trie, form, own, self._own_nodes)
            add(self._added, form, own, meaning)
        return add(self.trie, form, own, meaning)

    def _add_variants(self, entry: Entry) -> None:
        """Further ways to say a condition, or that it is not so; a phrase of the same words keeps them."""
        types = {slot.name: slot.type for slot in entry.slots}
        phrases = entry.phrases if entry.sort == "condition" else ()
        for form in chain.from_iterable(map(self._forms, phrases)):
            for variant, role in variants(form, self.negations, self.negative_subjects, self._plurals):
                before = self._add_form(variant, Meaning(role, entry), types)
                if before is not None and before.role in ("negated", "negated_twice"):
                    self._collide(before, Meaning(role, entry))
                elif before is not None:
                    self._add_form(variant, before, types)

    def negated(self, form: Form) -> Iterator[Form]:
        """`battery is low` is also said `battery is not low`."""
        yield from replaced(form, self.negations)

    def comparing_forms(self, kind: str) -> Iterator[Form]:
        """Ways to go on behind a quantity or name in order to compare it; names and texts can only be equal."""
        ordered = self.types[kind].kind in ("quantity", "number")
        for name, patterns in self.comparisons.items():
            if ordered or name == "equal":
                yield from (form for way in comparing_phrases(name, patterns) for form in self._forms(way))

    def _find_collisions(self) -> None:
        for one, other in collisions(self.trie, self.values, self._added):
            if one.role not in NOT_ALONE and other.role not in NOT_ALONE:
                self._collide(one, other)

    def _collide(self, one: Meaning, other: Meaning) -> None:
        """Told at the entry that was loaded later; connectives come first."""
        ids = [(meaning.entry.id if meaning.entry else "", meaning.role) for meaning in (one, other)]
        order = list(self.entries)
        one, other = sorted((one, other), key=lambda m: order.index(m.entry.id) if m.entry else -1)
        if ids[0] == ids[1] or (one.entry and other.entry and one.entry.yields != other.entry.yields):
            return
        first, second = self._described(other), self._described(one)
        span = other.entry.span if other.entry and other.entry.span else Span(Source(second[0], second[2]), 0, 0)
        self._problems.append(
            diagnostic(
                "BT062", span,
                first=first[0], first_id=first[1], first_file=first[2],
                second=second[0], second_id=second[1], second_file=second[2],
            )
        )  # fmt: skip

    def _described(self, meaning: Meaning) -> tuple[str, str, str]:
        if meaning.entry is None:
            return self.roles.get(meaning.role, [meaning.role])[0], f"role {meaning.role}", "connective file"
        return meaning.entry.phrases[0], meaning.entry.id, meaning.entry.file

    def _wrong(self, entry: Entry, reason: str) -> None:
        span = entry.span or Span(Source(entry.phrases[0], "Python"), 0, len(entry.phrases[0]))
        self._problems.append(diagnostic("BT061", span, reason=reason))
