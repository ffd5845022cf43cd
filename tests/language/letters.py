"""A vocabulary of letters: u to z are commands, p to s are conditions; and an AST as one readable line."""

from __future__ import annotations

from functools import cache
from typing import Any

from btlang.frontends.mission.reader import read_mission
from btlang.text.source import Source
from btlang.tree import ast
from btlang.vocabulary.entry import Entry, SlotSpec
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.load import load_vocabulary

COMMANDS = "uvwxyz"
CONDITIONS = "pqrs"


ENTRIES = (
    *(Entry("action", letter.upper(), (letter,), accompaniment=True) for letter in COMMANDS),
    *(Entry("condition", letter.upper(), (letter,)) for letter in CONDITIONS),
    Entry("action", "Murmur", ("murmur {text}",), slots=(SlotSpec("text", "text"),)),
)


MIXED: dict[str, dict[str, Any]] = {
    "w": {"resources": ("voice",)},
    "x": {"accompaniment": False},
    "y": {"resources": ("base",)},
}
"""What is otherwise where `and` depends on the commands: w speaks, x is a task, y moves the robot."""


@cache
def letters(is_mixed: bool = False) -> Lexicon:
    changes = MIXED if is_mixed else {}
    return load_vocabulary([entry.replace(**changes.get(entry.phrases[0], {})) for entry in ENTRIES])


def read(text: str, parser: str = "shunting-yard", is_mixed: bool = False) -> ast.Program:
    return read_mission(Source(text), letters(is_mixed), parser).mission


def shown(node: ast.Ast | None) -> str:
    """`S(U, P(V, W))`, a bracketed chain with a `~`; S, F, P as in the language's contract, & and | for conditions."""
    match node:
        case None:
            return "-"
        case ast.Program():
            definitions = [f"{d.name} = {shown(d.body)}; " for d in node.definitions]
            return "".join(definitions) + shown(node.body)
        case ast.Phrase():
            return " ".join([node.entry.id, *(f"{name}={text}" for name, text in node.arguments)])
        case ast.Name():
            return f"<{' '.join([node.name, *(f'{name}={text}' for name, text in node.arguments)])}>"
        case ast.Compared() | ast.Remember():
            what = [node.key, *([node.entry.id] if isinstance(node, ast.Remember) else [])]
            return f"{type(node).__name__}({' '.join([*what, *(f'{name}={text}' for name, text in node.arguments)])})"
        case ast.Chain():
            kinds = {"sequence": "S", "fallback": "F", "parallel": "P", "all": "All", "any": "Any"}
            inner = ", ".join(map(shown, node.items))
            return f"{kinds[node.operator]}{'~' if node.bracketed else ''}({inner})"
        case ast.If() | ast.While():
            word = type(node).__name__ if not node.negated else {"If": "Unless", "While": "Until"}[type(node).__name__]
            otherwise = f", {shown(node.otherwise)}" if node.otherwise is not None else ""
            return f"{word}({shown(node.condition)}, {shown(node.body)}{otherwise})"
        case ast.Try(otherwise=None):
            return f"Try({shown(node.body)})"
    optional = () if isinstance(node, ast.Exact) else (False, "")
    plain = [
        str(value)
        for f in node.fields
        if f not in (*node.parts, "span") and (value := getattr(node, f)) not in optional
    ]
    return f"{type(node).__name__}({', '.join(plain + [shown(part) for part in ast.parts(node)])})"
