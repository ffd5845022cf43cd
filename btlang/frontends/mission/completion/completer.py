"""What may follow at the end of a text: phrases, values, names and connectives.

Phrases come from the trie, read ahead. Whether a phrase may stand at its place is asked of the grouping itself,
so that what is offered here and what is accepted there cannot differ.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from itertools import chain

from btlang.frontends.mission.completion.node_completion import node_options
from btlang.frontends.mission.completion.value_completion import value_options
from btlang.frontends.mission.grouping.grouping import group
from btlang.frontends.mission.reader import lexed
from btlang.frontends.mission.symbols.includes import ROLE
from btlang.frontends.mission.symbols.prefixes import SEPARATORS
from btlang.frontends.mission.token import CORRELATIVES, Token, go_on
from btlang.support.record import Record
from btlang.text.source import Source
from btlang.text.spelling import nearest
from btlang.vocabulary.continuations import Begun, begun, meanings, values_on, ways_on
from btlang.vocabulary.correct_words import correct_words
from btlang.vocabulary.entry import Meaning
from btlang.vocabulary.language_tables import GOES_ON, NO_PHRASES
from btlang.vocabulary.lexicon import DEFINING, Lexicon
from btlang.vocabulary.pattern import Slot, forms
from btlang.vocabulary.trie import TrieNode
from btlang.vocabulary.word_tree import END, SLOTS

_MOST_TOKENS_BACK = 6  # a phrase that is being written may look like that many shorter ones
_MOST_STATEMENTS_BACK = 12  # what may follow doesn't depend on more, and each try groups them again
_LONG_ENOUGH = 3  # letters; a shorter word is no misspelling yet
_MOST_CORRECTIONS = 3
_ALIKE = {
    **dict.fromkeys(("wait", "wait_time", "wait_forever", "nothing", "fail"), "command"), "negated": "condition",
    "unless": "if", "until": "while",
    "if_possible": "within", "if_it_works": "within", "once": "within", "as_soon_as": "if",
    "first_time": "whenever",  "retry": "try", "one_of": "try", "wait_until": "check",
    **dict.fromkeys(("delay", "at", "every_day"), "every"), "in_order": "in_parallel",
    **dict.fromkeys(("set", "increase", "decrease", "add", "subtract", "remember", "include"), "command"),
    "each": "every",
}  # fmt: skip
"""Roles that stand where others stand: the grouping stage is asked for one of them."""
_LOOK_AHEAD = frozenset(("and", "or", "nor"))  # whether these are in their place depends on what follows
_MAY_FOLLOW = ((), ("command",), ("condition",), ("close",), ("colon",), ("count",))
_LINE_STARTS = frozenset(("newline", "semi", "indent", "dedent"))


class Completion(Record):
    """A way to go on: `text` takes the place of the characters from `start` on.

    `kind` is "command", "condition", "name", "value" or "connective"; `help` is a line about it. `spelling` says that
    it corrects the word being written and does not go on from it.
    """

    text: str
    start: int
    kind: str
    help: str = ""
    spelling: bool = False


@lru_cache(maxsize=4)  # an editor asks more than once while the text stands as it is
def completions(text: str, vocabulary: Lexicon) -> tuple[Completion, ...]:
    """All that may follow the text, what goes on a phrase first; none inside quotes or behind an error."""
    return tuple(Completer(text, vocabulary).found())


class Completer:
    """Finds what may follow one text."""

    def __init__(self, text: str, vocabulary: Lexicon) -> None:
        self._vocabulary = vocabulary
        self._text = text
        self._partial = _last_word(text)
        self._start = len(text) - len(self._partial)
        self._source = Source(text[: self._start] + "(")  # the bracket stands for what is to come
        self._lexer = lexed(self._source, vocabulary)
        self._context = self._lexer.context
        self._words = self._lexer.text
        self._last = len(self._words.words) - 3  # the bracket; line end and text end follow
        bracket = max((i for i, token in enumerate(self._lexer.tokens) if token.kind == "open"), default=0)
        self._tokens = self._lexer.tokens[:bracket]
        self._begins = list(_begins(self._tokens))
        self._accepted: dict[tuple[int, str], bool] = {}

    def found(self) -> list[Completion]:
        """Sorted: phrases under way, then what may begin here; each once."""
        if self._words.open_quotes or self._last < 0 or self._words.starts[self._last] != self._start:
            return []  # in quotes, or in a comment
        start = self._partial.lower()
        options = list(self._options(start)) or list(self._defining(start))
        if not options and len(self._partial) >= _LONG_ENOUGH and self._is_unknown():
            options = self._corrections()
        unique = {option.text: option for option in reversed(options) if option.text != self._partial}
        return list(reversed(unique.values()))

    def _options(self, start: str) -> Iterator[Completion]:
        for words, kind in value_options(self._words, self._last, start, self._vocabulary, self._context):
            yield Completion(words, self._start, kind, "named in this mission" if kind == "value" else "")
        names, tokens = self._lexer.names.definitions, self._tokens
        of_node = list(node_options(self._words, self._last, start, self._vocabulary, names, tokens, self._tokens_of))
        yield from (Completion(said, self._start, kind) for said, kind in of_node if kind != "connective")
        joining: list[Completion] = []
        for at in range(max(0, len(tokens) - _MOST_TOKENS_BACK), len(tokens) + 1):
            if at < len(tokens) and tokens[at].kind in _LINE_STARTS:
                continue
            for option in self._from(at, start):
                if option.kind == "connective" and at < len(tokens):  # `wave and` more probably goes on with a command
                    joining.append(option)
                else:
                    yield option
        yield from joining
        yield from (Completion(said, self._start, kind) for said, kind in of_node if kind == "connective")
        line, given = self._text.rpartition("\n")[2].lstrip().lower(), self._vocabulary.word("given")
        if len(line) >= _LONG_ENOUGH and given.startswith(line):
            yield Completion(given[len(line) - len(start) :] + " {", self._start, "connective")
        if not start and not self._is_broken(len(tokens)) and self._may_stand(len(tokens), "close"):
            yield Completion(")", self._start, "connective", "ends the group")

    def _tokens_of(self, text: str) -> list[Token]:
        return self._lexer.again(Source(text)).tokens

    def _is_unknown(self) -> bool:
        """Whether the word being written belongs to nothing that is known."""
        lexer = lexed(Source(self._text), self._vocabulary)
        return bool(lexer.tokens) and any(t.kind == "unknown" and t.end > self._start for t in lexer.tokens)

    def _corrections(self) -> list[Completion]:
        options = {option.text: option for option in self._options("")}
        firsts = {text: text.split()[0].lower() for text in options}
        written = self._partial.lower()
        is_right = written in correct_words(self._vocabulary.word_list)  # no slip, whatever else is like it
        likely = [] if is_right else nearest(written, dict.fromkeys(firsts.values()))
        found = [options[text].replace(spelling=True) for word in likely for text in options if firsts[text] == word]
        return found[:_MOST_CORRECTIONS]

    def _from(self, at: int, start: str) -> Iterator[Completion]:
        """Ways to go on where the token at a place is the beginning of a phrase; at the end, where one begins."""
        tokens, words = self._tokens, self._words
        if self._is_broken(at):
            return
        first = self._last if at == len(tokens) else bisect_left(words.starts, tokens[at].start)  # a stop has none
        roles = _roles_in_trie(self._vocabulary)
        under_way = begun(self._vocabulary.trie, words, first, self._last, self._context)
        names = begun(self._lexer.names.definitions.trie, words, first, self._last, self._context)
        yield from self._named(names, first, at, start)
        for node in under_way.nodes:
            if node is self._vocabulary.trie and not start:
                yield from self._openers(at)
                continue
            for way, child in sorted(ways_on(node, start), key=_shortest_first):
                yield from self._phrase(" ".join(way), child, at)
            slots = ((kind, self._last, child) for _, kind, child in node.get(SLOTS, ()))
            yield from self._slots(slots, at, start, roles)
        yield from self._slots(under_way.slots, at, start, roles)

    def _openers(self, at: int) -> Iterator[Completion]:
        """The first way to say each thing: nothing is written yet, and all synonyms would be too many."""
        for opening, node in _openings(self._vocabulary):
            yield from self._phrase(opening, node, at)

    def _phrase(self, words: str, node: TrieNode, at: int) -> Iterator[Completion]:
        ends = [node[END]] if END in node else []
        slotted = (meaning for _, _, child in node.get(SLOTS, ()) for meaning in meanings(child))
        for meaning in chain(ends, slotted):
            is_explained = meaning.entry is not None or meaning.role in self._vocabulary.about
            if is_explained and self._may_stand(at, meaning.role):
                more = "" if ends and meaning is ends[0] and meaning.role not in (*SEPARATORS, ROLE) else " "
                kind, about = self._about(meaning)
                yield Completion(words + more, self._start, kind, about)
                return

    def _slots(
        self, slots: Iterable[tuple[str, int, TrieNode]], at: int, start: str, roles: dict[int, Sequence[str]]
    ) -> Iterator[Completion]:
        """Values that a slot may have; `roles` are the roles behind nodes of the same trie."""
        for kind, first, child in slots:
            if any(self._may_stand(at, role) for role in _roles_behind(child, roles)):
                written = self._words.words[first : self._last]
                for known in (self._context.known or {}).values() if not written and not start else ():
                    if not known.words:  # of any type
                        yield Completion(f"{{{known.key}}}", self._start, "value", "given to this mission")
                for value in values_on(kind, self._context.values, written, start):
                    yield Completion(value, self._start, "value", kind)

    def _named(self, names: Begun, first: int, at: int, start: str) -> Iterator[Completion]:
        for node in names.nodes:
            for way, child in ways_on(node, start):
                if any(self._may_stand(at, self._kind_of_name(meaning)) for meaning in meanings(child)):
                    more = "" if END in child else " "
                    yield Completion(" ".join(way) + more, self._start, "name", "defined in this mission")
        yield from self._slots(names.slots, at, start, {})

    def _kind_of_name(self, meaning: Meaning) -> str:
        if meaning.role != "name" or meaning.entry is None:
            return meaning.role
        return "condition" if meaning.entry.id in self._lexer.conditions else "command"

    def _defining(self, start: str) -> Iterator[Completion]:
        """`is` after the unknown words of a line: they may become a name."""
        tokens = self._tokens
        if not tokens or '"' in self._text[tokens[-1].start : tokens[-1].end]:
            return  # `do "Id" with` is no name
        if tokens[-1].kind == "unknown" and (len(tokens) == 1 or tokens[-2].kind == "newline"):
            for role in reversed(DEFINING):
                for word in self._vocabulary.roles[role]:
                    if word.startswith(start):
                        yield Completion(word + " ", self._start, "connective", "defines a name")

    def _is_broken(self, at: int) -> bool:
        """Whether there are unknown words in the statement before a place."""
        return any(token.kind == "unknown" for token in self._tokens[self._statement(at) : at])

    def _statement(self, at: int) -> int:
        """The first token of the statement that a place is in."""
        while at and self._tokens[at - 1].kind not in _LINE_STARTS:
            at -= 1
        return at

    def _may_stand(self, at: int, role: str) -> bool:
        """Whether a token of the role is accepted behind the first `at` tokens, and can be gone on from."""
        if role in CORRELATIVES:
            return self._may_stand(at, "try") or self._may_stand(at, "not")
        kind = _ALIKE.get(role, role)
        key = at, kind
        if key not in self._accepted:
            self._accepted[key] = kind != "politeness" and self._is_accepted(at, kind)
        return self._accepted[key]

    def _is_accepted(self, at: int, kind: str) -> bool:
        """The grouping stage looks ahead, so what it says of a token depends on what follows."""
        first = self._statement(at)
        for after in _MAY_FOLLOW:
            failed = [place for place in self._failures(at, kind, *after) if place >= first]
            if not failed or failed[0] > at + 1:
                return True
            if failed[0] <= at and kind not in _LOOK_AHEAD:
                return False
        return False

    def _failures(self, at: int, *kinds: str) -> list[int]:
        end = self._tokens[at].start if at < len(self._tokens) else self._start
        begins = self._begins[: bisect_right(self._begins, at)]
        before = self._tokens[begins[-_MOST_STATEMENTS_BACK] if len(begins) > _MOST_STATEMENTS_BACK else 0 : at]
        if kinds[0] in GOES_ON:
            go_on(before)
        tokens = [*before, *(Token(kind, end, end, "1") for kind in kinds)]
        failed = group(self._source, tokens, self._lexer.conditions).failed_at
        return [place + at - len(before) for place in failed]

    def _about(self, meaning: Meaning) -> tuple[str, str]:
        if meaning.entry is not None:
            return ("condition" if meaning.entry.sort == "condition" else "command"), meaning.entry.help
        return "connective", self._vocabulary.about[meaning.role].help


@lru_cache(maxsize=4)
def _roles_in_trie(_vocabulary: Lexicon) -> dict[int, Sequence[str]]:
    """What `_roles_behind` has found for the nodes of the trie of a vocabulary, by their identity."""
    return {}


def _roles_behind(node: TrieNode, known: dict[int, Sequence[str]]) -> Sequence[str]:
    """The roles of the phrases through a node, each once: thousands have the same few."""
    found = known.get(id(node))
    if found is None:
        found = known[id(node)] = tuple(dict.fromkeys(meaning.role for meaning in meanings(node)))
    return found


def _begins(tokens: Iterable[Token]) -> Iterator[int]:
    """The tokens at which lines begin outside of blocks and brackets."""
    depth = 0
    for number, token in enumerate(tokens):
        depth += (token.kind in ("indent", "open")) - (token.kind in ("dedent", "close"))
        if token.kind == "newline" and depth == 0:
            yield number + 1


def _last_word(text: str) -> str:
    at = len(text)
    while at and (text[at - 1].isalnum() or text[at - 1] in "'-_"):
        at -= 1
    return text[at:]


def _shortest_first(way: tuple[tuple[str, ...], TrieNode]) -> tuple[int, tuple[str, ...]]:
    return len(way[0]), way[0]


@lru_cache(maxsize=4)
def _openings(vocabulary: Lexicon) -> list[tuple[str, TrieNode]]:
    """The words, up to the first slot, of the first phrase of each role and entry, and where they lead in the trie."""
    found: dict[str, TrieNode] = {}
    entries = [entry.phrases[0] for entries in vocabulary.entries.values() for entry in entries if entry.phrases]
    roles = [
        phrases[0] for role, phrases in vocabulary.roles.items() if role not in (*NO_PHRASES, "politeness", "never")
    ]
    for pattern in (*entries, *roles, *vocabulary.counts):
        node, words = vocabulary.trie, []
        for part in forms(pattern, vocabulary.articles)[-1]:
            if isinstance(part, Slot):
                break
            words.append(part)
            node = node[part]
        if words:
            found[" ".join(words)] = node
    return list(found.items())
