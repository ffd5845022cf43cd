"""Finds the definitions of a text before any line is parsed, so that a name may be used before it is defined."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Container, Iterable, Mapping
from functools import lru_cache
from itertools import takewhile

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.frontends.mission.symbols.nodes import Unreadable, read_node
from btlang.frontends.mission.symbols.phrases import Phrases
from btlang.frontends.mission.token import Header
from btlang.text.source import Span
from btlang.text.spelling import nearest
from btlang.text.words import END_OF_STATEMENT, Words, statements
from btlang.tree.ast import Definition
from btlang.vocabulary.entry import Entry, Meaning, SlotSpec
from btlang.vocabulary.language_tables import CONNECTIVES, QUESTIONS
from btlang.vocabulary.lexicon import DEFINING, NODE_ROLES, Lexicon
from btlang.vocabulary.match import Match
from btlang.vocabulary.pattern import Part, Slot, name_form
from btlang.vocabulary.references import key_of
from btlang.vocabulary.trie import TrieNode, add, longest
from btlang.vocabulary.value_type import PERSON, TEXT
from btlang.vocabulary.word_tree import END, SLOTS, find

# A line that starts with one of these compares; it defines nothing.
_STARTS_NO_NAME = frozenset((
    "if", "unless", "while", "until", "whenever", "first_time", "as_soon_as", "otherwise", "then", "check",
    "wait_until", "at", "every_day", "until_time", "once", "if_fails", "if_one_fails", "if_unanswered", "if_works",
))  # fmt: skip
_WEAK = DEFINING[-1]
_NOT_IN_A_NAME = frozenset((*CONNECTIVES, "if", "unless", "while", "until", "otherwise", "provided"))
_NO_BODY = frozenset(("", "here", "ordinal", "again", "not", "there_are", "start_at"))
"""The roles of words that begin no command."""


class Definitions:
    """The definitions of a text: `headers` by the word at which they start, `trie` of their names.

    A name with parameters comes into the trie when their types are known (see variables.py).
    """

    def __init__(self) -> None:
        self.headers: dict[int, Header] = {}
        self.trie: TrieNode = {}
        self.types: dict[int, tuple[tuple[str, str], ...]] = {}
        """The parameters with their types of those in the trie, by the first word of the body."""
        self.subtrees: set[str] = set()
        """The names in quotes, those of included missions too."""
        self.problems: list[Diagnostic] = []


def find_definitions(
    phrases: Phrases,
    ends: Container[int] = (),
    variables: Container[tuple[str, ...]] = (),
    included: Iterable[Definition] = (),
) -> Definitions:
    """Every definition of the text. A name defined twice is listed twice; the later one counts.

    `ends` are the words at which statements start that define no command; `variables` are words that are compared.
    The `included` ones are known, too.
    """
    found = Definitions()
    text, vocabulary = phrases.text, phrases.vocabulary
    included, quoted = list(included), found.subtrees
    quoted.update(definition.name for definition in included if definition.is_quoted)
    for definition in included:
        if not definition.is_quoted:
            _add(found.trie, definition.name, dict(definition.parameters))
    defining = {word for role in DEFINING for word in vocabulary.roles[role]} | set(vocabulary.asking["naming"])
    if defining.isdisjoint(text.distinct):
        return found
    margin = text.lines[0].indent if text.lines else 0
    for indent, first, last in statements(text, defining):
        if first in ends or defining.isdisjoint(text.words[first:last]):
            continue
        header = _fronted(phrases, first, last) or _header(phrases, first, last, variables, found.problems)
        if header is None:
            continue
        if indent > margin:
            found.problems.append(diagnostic("BT033", header.span))
        found.headers[first] = header
        if header.is_quoted:
            found.types[header.body] = ()
            if header.name in quoted:
                found.problems.append(diagnostic("BT017", header.span, name=header.name))
            quoted.add(header.name)
        elif header.name and not header.parameters:
            add_name(header, found, vocabulary, {})
    return found


def add_name(header: Header, found: Definitions, vocabulary: Lexicon, types: Mapping[str, str]) -> None:
    """Makes a name known, with the types of its parameters (BT017, BT018)."""
    words = name_form(header.name)
    found.types[header.body] = tuple(types.items())
    if _add(found.trie, header.name, types) is not None:
        found.problems.append(diagnostic("BT017", header.span, name=header.name))
        return
    nodes = [vocabulary.trie]
    for part in words:
        nodes = [child for node in nodes for child in _below(node, part)]
    known = [node[END].entry for node in nodes if END in node]
    if any(entry is None or not entry.yields for entry in known):
        found.problems.append(diagnostic("BT018", header.span, name=header.name))


def _below(node: TrieNode, part: Part) -> list[TrieNode]:
    if isinstance(part, Slot):
        return [child for _, _, child in node.get(SLOTS, ())]
    return [node[part]] if part in node else []


def _add(trie: TrieNode, name: str, types: Mapping[str, str]) -> Meaning | None:
    """What had the name before."""
    slots = tuple(SlotSpec(key, kind) for key, kind in types.items())
    return add(trie, name_form(name), types, Meaning("name", Entry("name", name, (name,), slots=slots)))


def reach(text: Words, at: int) -> int:
    """The word behind the statement in which a word stands, with the block below it; a bracket ends one too."""
    number = bisect_right(text.lines, at, key=lambda line: line.first) - 1
    depth, margin = 0, text.lines[number].indent
    while True:
        line = text.lines[number]
        while at < line.last:
            depth += (text.words[at] == "(") - (text.words[at] == ")")
            stops = text.words[at] == END_OF_STATEMENT and depth == 0 and at + 1 not in text.going_on
            if depth < 0 or (stops and at + 1 < line.last):
                return at
            at += 1
        number += 1
        if text.words[line.last - 1] == ":":
            number += sum(1 for _ in takewhile(lambda other: other.indent > margin, text.lines[number:]))
            at = text.lines[number - 1].last
        if number == len(text.lines) or text.lines[number].first not in text.going_on:
            return at
        at = text.lines[number].first


def _begins_question(phrases: Phrases, at: int, defining: int) -> bool:
    """Whether the words at a place ask; `tell me is ...` defines "tell me".

    `defining` is the place of the word that would define.
    """
    match = phrases.at(at)
    return match is not None and match.meaning.role in QUESTIONS and match.last != defining


def _fronted(phrases: Phrases, first: int, last: int) -> Header | None:
    """`define tour as: A`, `let tour be: A`, with a block or a command behind the name."""
    text, asking = phrases.text, phrases.vocabulary.asking
    if text.words[first] not in asking["naming"]:
        return None
    at = next((i for i in range(first + 2, last) if text.words[i] in asking["named_as"]), None)
    body = phrases.at(at + 1) if at is not None else None
    if at is None or _joining_word(phrases, first + 1, at) is not None:
        return None
    if text.words[at + 1] != ":" and (body is None or body.meaning.role != "command"):
        return None
    parts, parameters = _pattern(text.words[first + 1 : at])
    name = " ".join(parts)
    return Header(name, text.span(first + 1, at), at + 1, reach(text, at), parameters) if parts else None


def _header(
    phrases: Phrases,
    first: int,
    last: int,
    variables: Container[tuple[str, ...]],
    problems: list[Diagnostic],
) -> Header | None:
    text = phrases.text
    at = _defining_word(phrases, first, last)
    if at is None:
        return None
    start = first
    while start < at:
        polite = phrases.at(start)
        if polite is None or polite.meaning.role != "politeness" or polite.last > at:
            break
        start = polite.last + (text.words[polite.last] == ",")
    if start + 1 == at and text.words[start][0] == '"':
        return Header(text.words[start][1:], text.span(start, at), at + 1, reach(text, at), is_quoted=True)
    asking = phrases.vocabulary.asking
    is_weak = text.words[at] not in phrases.vocabulary.roles["define_strong"]
    if is_weak and at > start and phrases.vocabulary.values.texts.asks(text.words[at - 1]):
        return None  # `see who is in the lab`
    if (is_weak and _begins_question(phrases, start, at)) or (
        start == at and text.words[at] in asking["asking_be"] and (start == first or text.words[start - 1] == ",")
    ):
        return None
    telling = {phrase.split()[0] for phrase in asking["telling"]}
    said = text.words[start : max(at - 2, start)]
    if is_weak and "{" not in said and not telling.isdisjoint(said):
        return None  # `tell Bob dinner is ready`
    if " ".join(text.words[start : at + 1]) in (*asking["there"], *asking["feeling"]):
        return None  # a remark
    values = phrases.vocabulary.values
    if text.words[at + 1] in values.modifiers.starts:
        for kind in ("object", "person"):
            named = find(values.names_tree(kind), text.words, start)
            if named is not None and named[1] == at:
                return None  # `the cup is near the lab`
    if is_weak and _tells(phrases, start, at):
        return None
    if start == at:
        problems.append(diagnostic("BT016", text.span(at, at + 1), word=text.words[at]))
        return Header("", text.span(at, at + 1), at + 1, at + 1)
    if any(tuple(text.words[i:at]) in variables for i in range(start, at)):
        return None
    compares = any(tuple(text.words[i : at - 1]) in variables for i in range(start, at - 1))
    if text.words[at - 1] == "}" and compares and text.words[at + 1] != ":":
        body = phrases.at(at + 1)
        if body is None or body.meaning.role != "command":
            return None
    joined = _joining_word(phrases, start, at)
    if joined is not None and joined.text[0].isalpha() and text.words[at - 1] == "}":
        return None  # `wave until {counter} is 3` compares
    if joined is not None and _starts_with_a_phrase(phrases, start, joined):
        return None  # `charge until the battery is green` is a command that says something unknown
    if joined is not None:
        problems.append(diagnostic("BT015", joined, word=joined.text))
        name = " ".join(word for word in text.words[start:at] if word[0].isalnum())
        return Header(name, text.span(start, at), at + 1, reach(text, at))
    parts, parameters = _pattern(text.words[start:at])
    if len(parts) == len(parameters):
        problems.append(diagnostic("BT016", text.span(start, at), word=text.words[at]))
        return Header("", text.span(start, at), at + 1, reach(text, at))
    return Header(" ".join(parts), text.span(start, at), at + 1, reach(text, at), parameters)


def _tells(phrases: Phrases, start: int, at: int) -> bool:
    """Whether a sentence says something about somebody, and defines nothing: `Carol is coming for tea`.

    No command stands behind its `is`, and before it what is no name of a command.
    """
    text, values = phrases.text, phrases.vocabulary.values
    body = phrases.at(at + 1)
    if text.words[at + 1][0] in ':"' or (body is not None and not _begins_no_command(body)):
        return False
    said = text.words[at + 1]
    if said in phrases.first_words:
        return False  # another name: `patrol is tour`
    command = phrases.at(start)
    if command is not None and command.meaning.role == "command" and command.last < at:
        return True  # `go to the lab because the cup is full of tea`
    speaks_of = (values.names_tree(PERSON), values.pronoun_words)
    if _joining_word(phrases, start, at) is not None or text.words[start] in values.texts.of_persons:
        return True
    if any(find(tree, text.words, start) for tree in speaks_of):
        return True
    is_short = not text.words[at + 2][0].isalnum()  # `the floor is wet`
    return start in text.articles and (is_short or not _may_begin(said, phrases.vocabulary))


@lru_cache(maxsize=256)  # mistakes repeat
def _may_begin(word: str, vocabulary: Lexicon) -> bool:
    """Whether a word could be a misspelt one with which a phrase begins."""
    return bool(nearest(word, [*vocabulary.trie]))


def _begins_no_command(match: Match) -> bool:
    entry = match.meaning.entry
    return entry.sort == "condition" if entry is not None else match.meaning.role in _NO_BODY


def _pattern(words: list[str]) -> tuple[list[str], tuple[tuple[str, tuple[str, ...]], ...]]:
    """The words of a name with its parameters in braces, and these."""
    parts: list[str] = []
    parameters: list[tuple[str, tuple[str, ...]]] = []
    at = 0
    while at < len(words):
        if words[at] == "{":
            end = words.index("}", at)
            own = tuple(words[at + 1 : end])
            parameters.append((key_of(own), own))
            parts.append(f"{{{key_of(own)}}}")
            at = end
        else:
            parts.append(words[at])
        at += 1
    return parts, tuple(parameters)


def _slot_end(words: list[str], at: int, last: int) -> int | None:
    """The word behind a parameter in braces that starts at a word."""
    end = at + 1
    while end < last and words[end][0].isalpha():
        end += 1
    return end + 1 if words[at] == "{" and end > at + 1 and end < last and words[end] == "}" else None


def _defining_word(phrases: Phrases, first: int, last: int) -> int | None:
    """The first `means`, else the first `is`, unless a condition phrase holds it or the line starts with a form."""
    text, vocabulary = phrases.text, phrases.vocabulary
    for role in DEFINING:
        choices = vocabulary.roles[role]
        at = first
        while at < last:
            if text.words[at] in choices:
                return None if _is_compared(text, first, at, vocabulary) else at
            match = phrases.at(at)
            if match is None:
                at += 1
                continue
            if match.meaning.role in _STARTS_NO_NAME and at == first:
                return None
            if role == _WEAK and at == first and match.meaning.role == "command" and _says(match, text, at, choices):
                return None  # `tell me what is on the desk`
            if match.meaning.role in NODE_ROLES:
                at = _behind_node(text, match, last, vocabulary, in_words=at > first and match.meaning.role == "test")
                continue
            # a command phrase inside a name is no reason against it: `go home is ...`
            at = match.last if match.meaning.role != "command" else max(at + 1, _stop(text, at, match, choices))
    return None


def _says(match: Match, text: Words, first: int, choices: list[str]) -> bool:
    """Whether a phrase holds one of some words itself or in a clause, not in another value."""
    values = {word for value in match.values if value.type != TEXT for word in range(value.first, value.last)}
    return any(text.words[at] in choices for at in range(first, match.last) if at not in values)


def _behind_node(text: Words, head: Match, last: int, vocabulary: Lexicon, *, in_words: bool) -> int:
    """Where a node ends that is said by its id: what defines is a word in it like any other."""
    try:
        read = read_node(text, head.last, head.meaning, vocabulary, in_words=in_words)
    except Unreadable as problem:
        return min(problem.at + 1, last)
    return read[1] if read is not None else head.last


def _is_compared(text: Words, first: int, at: int, vocabulary: Lexicon) -> bool:
    """Whether a quantity ends right before a word: what follows compares it."""
    if not vocabulary.quantities:
        return False
    matches = (longest(vocabulary.quantities, text, start, vocabulary.context) for start in range(first, at))
    return any(match is not None and match.last == at for match in matches)


def _stop(text: Words, at: int, match: Match, choices: list[str]) -> int:
    """The first of some words in a command, but not in a noun: `the person who is waving`."""
    nouns = match.nouns
    return next((i for i in range(at, match.last) if text.words[i] in choices and i not in nouns), match.last)


def _starts_with_a_phrase(phrases: Phrases, start: int, joined: Span) -> bool:
    match = phrases.at(start)
    return match is not None and match.meaning.entry is not None and phrases.text.starts[match.last] >= joined.start


def _joining_word(phrases: Phrases, start: int, last: int) -> Span | None:
    text, at = phrases.text, start
    while at < last:
        slot_end = _slot_end(text.words, at, last)
        if slot_end is not None:
            at = slot_end
            continue
        match = phrases.at(at)
        role = match.meaning.role if match else ""
        if not text.words[at][0].isalnum() or role in _NOT_IN_A_NAME:
            return text.span(at, match.last if match else at + 1)
        at = max(match.last, at + 1) if match and match.meaning.entry is None else at + 1
    return None
