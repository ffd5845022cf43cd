"""Nodes that no phrase says, in words: where the words of an id end, and which words could be a port behind a comma."""

from __future__ import annotations

import re
from collections.abc import Collection
from functools import lru_cache
from itertools import takewhile

from btlang.text.source import Source
from btlang.text.spelling import respellings
from btlang.text.words import Words, split
from btlang.vocabulary.cache import recent
from btlang.vocabulary.language_tables import CHANGING, NOT_ALONE
from btlang.vocabulary.lexicon import DEFINING, NODE_ROLES, Lexicon
from btlang.vocabulary.match import Match
from btlang.vocabulary.node_forms import node_details
from btlang.vocabulary.pattern import Slot, forms
from btlang.vocabulary.reading_context import ReadingContext
from btlang.vocabulary.trie import TrieNode, longest

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import TypeAlias

    _Phrases: TypeAlias = tuple[frozenset[str], frozenset[str], frozenset[str]]

_BARE_ID = re.compile(r"(?=\w*_|\w+[A-Z])(?=.*[a-z])[A-Za-z]\w*", re.ASCII)  # `change_mode`, `BackUp`
_ID = re.compile(r"(?:[A-Z][a-z0-9]*)+")
_PART = re.compile(r"[A-Z]{2,}[0-9]*(?![a-z])|[A-Z][a-z0-9]*")
_WORD = re.compile(r"[a-z][a-z0-9]*")
_SNAKE_CASE = re.compile(r"[a-z0-9]+(?:_[a-z0-9]+)+")
_ACRONYM = re.compile(r"[A-Z]{2,}[0-9]*")
BEHIND_ID = ("called", "with", "giving")
"""The roles of what is said of a node behind its id."""
_MOST_WORDS = 6
"""Of an id that is said in words."""
_LEAST = 3  # letters of what can be a misspelling


@lru_cache(maxsize=4096)  # a file has few ids and ports, each many times
def said_id(node_id: str, role: str, vocabulary: Lexicon) -> str:
    """`OpenGripper` as `open gripper`, `PlanMTCTask` as `plan MTC task`; "" where these words behind `do` or `test` are
    read as anything else.

    So they are where a command goes on behind them with a value, and where a line would define or change something.
    """
    parts = _PART.findall(node_id) if _ID.fullmatch(node_id) else []
    said = " ".join(part if _ACRONYM.fullmatch(part) else part.lower() for part in parts)
    claiming = (*DEFINING, *CHANGING) if role == "do" else CHANGING
    if any(word in vocabulary.roles[claim] for claim in claiming for word in said.lower().split()):
        return ""
    if role == "test" and said.split()[:1] == vocabulary.word("check").split()[:1]:
        return ""  # `check test check lid` would say it twice
    text = split(Source(f"{vocabulary.word(role)} {said}"), vocabulary.orthography)
    head = longest(vocabulary.trie, text, 0, vocabulary.context)
    if not said or said.lower() in _phrases(vocabulary)[1] or not vocabulary.articles.isdisjoint(said.lower().split()):
        return ""
    if head is None or head.meaning.role != role or head.meaning.node:
        return ""
    return said if read_id(text, head.last, vocabulary) == (node_id, len(text.words) - 2) else ""


def bare_id(text: Words, at: int) -> str:
    """Return the id that one word is as it stands, such as `BackUp` or `change_mode`; "" for a word of English."""
    written = text.source.text[text.starts[at] : text.ends[at]]
    return written if _BARE_ID.fullmatch(written) else ""


@lru_cache(maxsize=4096)
def is_said_bare(node_id: str, role: str, vocabulary: Lexicon) -> bool:
    """Return whether an id needs no quotes behind `do` or `test`."""
    text = split(Source(f"{vocabulary.word(role)} {node_id}"), vocabulary.orthography)
    head = longest(vocabulary.trie, text, 0, vocabulary.context)
    if head is None or head.meaning.role != role or head.last != len(text.words) - 3:
        return False
    return bare_id(text, head.last) == node_id


@lru_cache(maxsize=4096)  # each use of a tree asks for those of all trees
def id_of_name(name: str) -> str:
    """The id that the words of a name make: `Approach shelf` as `ApproachShelf`."""
    return "".join(map(_capital, name.split()))


def subtree_named(written: str, subtrees: Collection[str], *, in_words: bool) -> str:
    """The subtree that an id means, as it stands or by its words; "" where that is none, or more than one."""
    if not in_words:
        return written if written in subtrees else ""
    found = [name for name in subtrees if written == id_of_name(name)]
    return found[0] if len(found) == 1 else ""


def is_tree_name(name: str, vocabulary: Lexicon) -> bool:
    """Return whether a name in quotes is that of a tree of another file: no tag of XML has blanks, and no node that is
    a class of C++ is called like `move_to_dock`.
    """
    return " " in name or (_SNAKE_CASE.fullmatch(name) is not None and name not in vocabulary.entries)


def read_id(text: Words, at: int, vocabulary: Lexicon) -> tuple[str, int] | None:
    """The id that the words from a place on make, and where they end: at a mark, a number or a connective.

    An acronym in capitals stays as it is beside other words. None for what is a command, a condition or a misspelt one.
    """
    words = text.words
    if not _WORD.fullmatch(words[at]) or role_end(text, at, BEHIND_ID, vocabulary):
        return None
    last = at + 1
    while _WORD.fullmatch(words[last]) and not ends_id(text, last, vocabulary):
        last += 1
    written = [text.source.text[text.starts[place] : text.ends[place]] for place in range(at, last)]
    match = _phrase(text, at, vocabulary)
    is_phrase = match is not None and match.last >= last
    is_node = _is_near(" ".join(words[at:last]), _phrases(vocabulary)[2])
    in_capitals = [word for word in written if not word.islower()]
    spoken = {*vocabulary.subjects, *vocabulary.values.role_words.speaker, *vocabulary.values.pronouns}
    if last - at > _MOST_WORDS or not spoken.isdisjoint(words[at:last]):
        return None  # a sentence, and no name
    is_odd = len(in_capitals) == len(written) or not all(map(_ACRONYM.fullmatch, in_capitals))
    if is_phrase or is_node or is_odd or _is_misspelt(words[at:last], _phrases(vocabulary)[0], vocabulary):
        return None
    return "".join(map(_capital, written)), last


def near_commands(words: list[str], vocabulary: Lexicon) -> list[str]:
    """What can be said without a value and was probably meant by words that are no command."""
    return respellings(" ".join(words), _phrases(vocabulary)[0])


def is_port(text: Words, at: int, last: int, vocabulary: Lexicon, names: TrieNode | None) -> bool:
    """Whether the words up to `last` (exclusive) can name a port behind a comma: no command begins with them."""
    match = _phrase(text, at, vocabulary)
    if match is not None and match.meaning.role not in NOT_ALONE:
        return False
    if names and longest(names, text, at, _context(vocabulary)) is not None:
        return False
    return not _is_misspelt(text.words[at:last], _phrases(vocabulary)[1], vocabulary)


def _capital(word: str) -> str:
    return word[0].upper() + word[1:]


def role_end(text: Words, at: int, roles: tuple[str, ...], vocabulary: Lexicon) -> int:
    """Where the words of one of some roles end that begin at a word; 0 where there are none."""
    for words in _words_by_start(roles, vocabulary).get(text.words[at], ()):
        if text.words[at : at + len(words)] == words:
            return at + len(words)
    return 0


@lru_cache(maxsize=32)
def _words_by_start(roles: tuple[str, ...], vocabulary: Lexicon) -> dict[str, list[list[str]]]:
    found: dict[str, list[list[str]]] = {}
    for words in (phrase.split() for role in roles for phrase in vocabulary.roles[role]):
        found.setdefault(words[0], []).append(words)
    return found


@lru_cache(maxsize=4)
def _context(vocabulary: Lexicon) -> ReadingContext:
    """Any name in braces is a value, whatever values the mission has."""
    return vocabulary.context.with_references()


def _phrase(text: Words, at: int, vocabulary: Lexicon) -> Match | None:
    """The longest phrase that begins at a word, whatever values the mission has."""
    return longest(vocabulary.trie, text, at, _context(vocabulary))


def ends_id(text: Words, at: int, vocabulary: Lexicon) -> bool:
    """Whether what ends an id begins at a word: a connective, or what is said of the node."""
    match = _phrase(text, at, vocabulary)
    joins = match is not None and match.meaning.entry is None and match.meaning.role not in (*NODE_ROLES, *NOT_ALONE)
    return joins or role_end(text, at, BEHIND_ID, vocabulary) > 0 or text.words[at] in node_details(vocabulary)


_made: dict[int, tuple[TrieNode, _Phrases]] = {}  # the tries stay, so that no id is used again


def _phrases(vocabulary: Lexicon) -> _Phrases:
    """What can be said without a value, the words up to the first value of all else, and the words of nodes.

    Made once for all vocabularies with the same words: each mission has one with names of its own.
    """
    trie = vocabulary.trie
    return recent(_made, id(trie), lambda: (trie, _made_of(vocabulary)))[1]


def _made_of(vocabulary: Lexicon) -> _Phrases:
    whole, heads = set(vocabulary.nodes.values()), set[str]()
    said = [phrase for entries in vocabulary.entries.values() for entry in entries for phrase in entry.phrases]
    for phrase in [*said, *(phrase for phrases in vocabulary.roles.values() for phrase in phrases)]:
        for form in forms(phrase, vocabulary.articles):
            head = " ".join(str(part) for part in takewhile(lambda part: not isinstance(part, Slot), form))
            (heads if any(isinstance(part, Slot) for part in form) else whole).add(head)
    return _one(frozenset(whole)), _one(frozenset(heads)), _one(frozenset(vocabulary.nodes.values()))


@lru_cache(maxsize=16)
def _one(known: frozenset[str]) -> frozenset[str]:
    """The same object for equal sets: else a cache would compare all their words at each look-up."""
    return known


@lru_cache(maxsize=4096)
def _is_near(written: str, known: frozenset[str]) -> bool:
    return bool(respellings(written, known))


def _is_misspelt(words: list[str], known: frozenset[str], vocabulary: Lexicon) -> bool:
    written = " ".join(words)
    if len(written) < _LEAST or not _is_near(written, known):
        return False
    from btlang.vocabulary.correct_words import correct_words  # hardly ever

    return not correct_words(vocabulary.word_list).issuperset(words)
