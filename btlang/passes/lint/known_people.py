"""The lint on people who are said to be somewhere, where a mission says what to do if they aren't (BT254).

`bring the cup to Tom in the lab. If he isn't there, A`: as everything that is chosen by what it is like, Tom is chosen
from what the robot knows when the command starts. It drives to the lab only if it knows that he is there.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from btlang.diagnostics.diagnostic import Diagnostic, diagnostic
from btlang.passes.compilation import Compilation
from btlang.passes.lint.asked_too_late import WHERE
from btlang.tree import ast
from btlang.vocabulary.capabilities import MOVES, TRAVELS
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.references import choice_of
from btlang.vocabulary.value_type import PERSON


def find_known_only(compilation: Compilation) -> Iterator[Diagnostic]:
    """Report the first such command, unless a journey to the place is right before it."""
    vocabulary = compilation.vocabulary
    for body in ast.bodies(compilation.mission):
        for node in compilation.syntax(body):
            tried = node.tried if type(node) is ast.IfWorks and node.otherwise is not None else None
            if type(node) is ast.Chain and node.operator == "fallback":
                tried = node.items[0]
            found = _first_known(ast.parents_first(tried), vocabulary) if tried is not None else None
            if found is not None:
                yield found
                return


def _first_known(nodes: Iterable[ast.Ast], vocabulary: Lexicon) -> Diagnostic | None:
    phrases = sorted((node for node in nodes if type(node) is ast.Phrase), key=lambda each: each.span.start)
    been = set[str]()
    for phrase in phrases:
        moves = MOVES in phrase.entry.resources or TRAVELS in phrase.entry.needs
        named = phrase.entry.given(PERSON, phrase.arguments)
        choice = choice_of(named[0]) if named and moves else None
        parts = dict(choice.parts) if choice is not None else {}
        place = next((parts[relation] for relation in WHERE if relation in parts), "")
        if place and place not in been:
            words = phrase.span.text
            journey = " ".join((*vocabulary.asking["journey"], place, vocabulary.word("then")))
            fixed = f"{journey} {words[:1].lower()}{words[1:]}"
            return diagnostic("BT254", phrase.span, words=words, place=place, fixed=fixed)
        been.update(text for _, text in phrase.arguments)
    return None
