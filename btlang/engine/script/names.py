"""Which names a script reads, and which it sets."""

from __future__ import annotations

import re

from btlang.engine.script.tokens import ASSIGNMENTS, BOOLEANS, ScriptError, Tokens

READS, SETS = "reads", "sets"
_WORD = re.compile(r"[^\W\d]\w*")


def uses_of_names(code: str) -> dict[str, set[str]]:
    """READS, SETS or both by name, enums too, in the order of the code; of what is no script each word is read."""
    try:
        return uses_in_script(code)
    except ScriptError:
        return {word: {READS} for word in _WORD.findall(code)}


def uses_in_script(code: str) -> dict[str, set[str]]:
    """READS, SETS or both by name, enums too, in the order of the code. May raise ScriptError if it is no script."""
    found: dict[str, set[str]] = {}
    tokens = Tokens(code)
    while tokens.kind != "end":
        name = tokens.text if tokens.kind == "name" and tokens.text not in BOOLEANS else ""
        tokens.advance()
        if name:
            found.setdefault(name, set()).update(_uses(tokens.sign))
    return found


def _uses(sign: str) -> tuple[str, ...]:
    if sign not in ASSIGNMENTS:
        return (READS,)
    return (SETS,) if sign in (":=", "=") else (READS, SETS)
