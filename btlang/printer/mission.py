"""English for whole missions, and for parts of them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from btlang.printer.blocks import lines_of
from btlang.printer.exact import quoted
from btlang.printer.printer import Printer
from btlang.printer.sentence import PRINTERS, statements
from btlang.tree import ast
from btlang.vocabulary.lexicon import Lexicon


def english(
    node: ast.Ast, vocabulary: Lexicon, *, brackets: str = "needed", names: Iterable[str | ast.Definition] = ()
) -> str:
    """Canonical English of any AST; a Mission is its facts, its definitions and then its commands.

    Each is on a line, or in a block where a line cannot say it.
    `brackets` is "needed", "clear" or "all" (see Printer); `names` are those that are defined where a part of a
    mission stands.
    """
    if not isinstance(node, ast.Program):
        return "\n".join(lines_of(node, Printer(PRINTERS, vocabulary, names, brackets)))
    printer = printer_of(node, vocabulary, brackets)
    return "\n".join(mission_lines(node, printer))


def mission_lines(mission: ast.Program, printer: Printer, width: float = math.inf) -> Iterator[str]:
    """The lines of a mission; see `lines_of`."""
    for role, path in mission.needs:
        yield f"{printer.word(role).text} {quoted(path, printer.vocabulary)}"
    if mission.name:
        yield f"{printer.word('main_name').text} {quoted(mission.name, printer.vocabulary)}"
    yield from given_lines(mission.given, printer.word("given").text, width)
    named = (*mission.includes, *mission.facts, *mission.definitions)
    for part, joined in [*((part, "") for part in named), *statements(mission.body)]:
        yield from lines_of(part, printer, width, joined)


def given_lines(keys: Iterable[str], word: str, width: float) -> Iterator[str]:
    """`this mission is given {goal}, {path}`, in lines of at most so many columns where a name fits."""
    line = ""
    for key in keys:
        if line and len(line) + len(key) + 4 > width:
            yield line
            line = ""
        line = f"{line}, {{{key}}}" if line else f"{word} {{{key}}}"
    if line:
        yield line


def printer_of(mission: ast.Program, vocabulary: Lexicon, brackets: str = "needed") -> Printer:
    """Says the parts of a mission, where its names and places are known."""
    facts = ast.all_facts(mission)
    if facts:
        vocabulary = vocabulary.with_places(tuple(fact.name for fact in facts))
    return Printer(PRINTERS, vocabulary, ast.all_definitions(mission), brackets, frozenset(mission.given))
