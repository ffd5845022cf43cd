"""Renaming of a definition and all its uses, if the mission means the same then."""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Container, Iterable
from functools import partial

from btlang.api import Mission
from btlang.diagnostics.diagnostic import MissionError, diagnostic
from btlang.editing.changes import Change, apply_changes
from btlang.editing.references import uses_of
from btlang.editing.words import RobotWords
from btlang.frontends.mission.reader import lexed
from btlang.frontends.mission.tokens.lexer import Lexer
from btlang.printer.exact import is_one_piece, quote
from btlang.text.source import Source, Span
from btlang.tree import ast
from btlang.tree.catalogue import SUBTREE
from btlang.tree.node import Node, Tree
from btlang.tree.visit import fold
from btlang.vocabulary.pattern import Slot, name_form
from btlang.vocabulary.reading_context import ReadingContext
from btlang.vocabulary.trie import longest

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

_LONGEST = 200  # characters of a name
_WORD, _WORD_END = re.compile(r"\w*"), re.compile(r"\w*\Z")


def rename(source: Source, at: int, words: RobotWords, name: str | None = None) -> dict[str, Any]:
    """Return what gives the definition that is named at a character another name: `changes`, from the front of the
    text.

    Each has `start` and `end`, characters of the text, and the `text` that takes their place. Without a name it is what
    would be renamed: its `words`, and their `start` and `end` there. Parameters stay the same, and are given in braces:
    `greet {someone}`. Raises MissionError: that of the text, if it doesn't compile; else BT210.
    """
    mission = words.mission(source)
    found = _find_name(mission, source, at)
    if found is None:
        start = at - len(_WORD_END.search(source.text, max(0, at - _LONGEST), at)[0])  # type: ignore[index]
        end = _WORD.match(source.text, start).end()  # type: ignore[union-attr]
        raise _refuse(source, start, end, source.text[start:end], "it isn't a name that this file defines")
    definition, place = found
    if name is None:
        return {"words": definition.name, "start": place.start, "end": place.end}
    refuse = partial(_refuse, source, place.start, place.end, definition.name)
    changes = _changes(mission, source, definition, _check(name, definition, mission.vocabulary.articles, refuse))
    _verify(mission, source, definition, changes, words, refuse)
    return {"changes": [change.as_dict() for change in changes]}


def _refuse(source: Source, start: int, end: int, words: str, reason: str) -> MissionError:
    return MissionError([diagnostic("BT210", Span(source, start, end), words=words, reason=reason)])


def _find_name(mission: Mission, source: Source, at: int) -> tuple[ast.Definition, Span] | None:
    """Return a definition of this file, and the characters that name it at a place."""
    program = mission.syntax
    for definition in program.definitions if program is not None else ():
        for place in (definition.name_span, *(use.span for use in uses_of(mission, definition.name))):
            if place.source is source and place.start <= at <= place.end:
                return definition, place
    return None


def _check(name: str, definition: ast.Definition, articles: Container[str], refuse: partial[MissionError]) -> str:
    """Return a new name without blanks around it, and without an article, which the old one may have before it."""
    first, _, rest = name.strip().partition(" ")
    name = rest.strip() if first.lower() in articles and not definition.is_quoted else name.strip()
    if not name or not name.isprintable() or len(name) > _LONGEST:
        raise refuse(f"a name has up to {_LONGEST} characters, on one line")
    if definition.is_quoted:
        if not is_one_piece(name):
            raise refuse("its name must not have quotes")
        return name
    slots = sorted(part.name for part in name_form(definition.name) if isinstance(part, Slot))
    if sorted(part.name for part in name_form(name) if isinstance(part, Slot)) != slots:
        values = " and ".join(f"{{{slot}}}" for slot in slots)
        raise refuse(f"the new name needs {values}, each once" if slots else "the new name must not have braces")
    return name


def _changes(mission: Mission, source: Source, definition: ast.Definition, name: str) -> list[Change]:
    vocabulary = mission.vocabulary
    lexer = lexed(source, vocabulary)
    own = definition.name_span
    text = quote(name, vocabulary) if definition.is_quoted else _like(own.text, name)
    changes = {own.start: Change(own.start, own.end, text)}
    for use in uses_of(mission, definition.name):
        if use.span.source is not source or use.span.start in changes:
            continue
        if use.is_exact:
            place = _quote(use.span, definition.name, lexer)
            text = quote(name if definition.is_quoted else " ".join(vocabulary.orthography.words(name)), vocabulary)
        else:
            place, text = use.span, _like(use.span.text, _fill(use.span, definition.name, name, lexer))
        if place is not None:
            changes[place.start] = Change(place.start, place.end, text)
    return [changes[start] for start in sorted(changes)]


def _like(written: str, name: str) -> str:
    """Return a name with a capital where the old one was written with one."""
    return name[0].upper() + name[1:] if written[0].isupper() and not written.isupper() else name


def _quote(place: Span, name: str, lexer: Lexer) -> Span | None:
    """Return the quoted name of a subtree in a node that is said by its id."""
    text = lexer.text
    for word in range(bisect_left(text.starts, place.start), bisect_left(text.starts, place.end)):
        if text.words[word] == f'"{name}':
            return text.span(word, word + 1)
    return None


def _fill(place: Span, old: str, new: str, lexer: Lexer) -> str:
    """Return a new name with the values of a use as they were written."""
    if "{" not in new:
        return new
    text, word = lexer.text, bisect_left(lexer.text.starts, place.start)
    context = ReadingContext(lexer.vocabulary.values)
    context.set_known(lexer.names.known_at(word))
    context.latest = dict.fromkeys(context.types, "it")  # whatever a pronoun stands for, its words stay
    match = longest(lexer.names.definitions.trie, text, word, context)
    if match is None or match.meaning.entry is None or match.meaning.entry.id != old:
        return new  # which the comparison of the trees refuses
    values = {value.name: _write(value.first, value.last, lexer) for value in match.values}
    return " ".join(values.get(part.name, "") if isinstance(part, Slot) else part for part in name_form(new))


def _write(first: int, last: int, lexer: Lexer) -> str:
    """Return words with the article before them."""
    text = lexer.text
    start, end = text.articles.get(first, (text.starts[first], 0))
    return text.source.text[start : text.ends[last - 1] if first < last else end]


def _verify(
    mission: Mission, source: Source, definition: ast.Definition, changes: Iterable[Change], words: RobotWords,
    refuse: partial[MissionError],
) -> None:  # fmt: skip
    """Return the new text has to compile to the same tree, but for the name."""
    text = apply_changes(source.text, changes)
    try:
        renamed = words.mission(source.with_text(text))
    except MissionError as error:
        mistake = next(each for each in error.diagnostics if each.is_error).message.rstrip(".")
        raise refuse(f"with this name, the mission would be wrong: {mistake}") from None
    at = next(number for number, each in enumerate(_own(mission)) if each is definition)
    names = [each.name for each in _own(renamed)]
    is_same = len(names) == len(_own(mission)) and _with_name(renamed.tree, names[at], names[at]) == _with_name(
        mission.tree, definition.name, names[at]
    )
    if not is_same:
        raise refuse("with this name, the mission would mean something else")


def _own(mission: Mission) -> tuple[ast.Definition, ...]:
    return mission.syntax.definitions if mission.syntax is not None else ()


def _with_name(tree: Tree, old: str, new: str) -> Tree:
    """Return a tree with another name of a subtree, and the ports of subtrees in an order that their names don't
    change.
    """

    def renamed(node: Node, children: list[Node]) -> Node:
        ports = node.ports
        if node.id == SUBTREE:
            ports = tuple(sorted((key, new if (key, text) == ("ID", old) else text) for key, text in ports))
        made: Node = node.replace(children=tuple(children), ports=ports)
        return made

    def whole(root: Node) -> Node:
        return fold(root, lambda node: node.children, renamed)

    subtrees = tuple((new if name == old else name, whole(root)) for name, root in tree.subtrees)
    made: Tree = tree.replace(root=whole(tree.root), subtrees=subtrees)
    return made
