"""Makes the TextMate grammar of missions for VS Code from the words of English.

It only knows words, so it colours what phrases begin with. `btc lsp` then says how the text is read.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator
from typing import Any

from btlang.robots.mission_vocabulary import world_vocabulary
from btlang.vocabulary.items import items
from btlang.vocabulary.lexicon import Lexicon
from btlang.vocabulary.pattern import Slot, forms

_MOST_WORDS = {"word": 4, "command": 2, "condition": 3}
"""Words of a phrase that are coloured, which keeps the grammar small: the verb and its preposition are enough."""
_GAP = r"\s+"
_END = ""  # the key of a branch where a phrase may end
_SCOPES = {"word": "keyword.control", "command": "support.function", "condition": "variable.language"}


def grammar() -> str:
    """The text of the grammar."""
    vocabulary = world_vocabulary()
    phrases = {sort: list(_phrases(vocabulary, sort)) for sort in _SCOPES}
    known = {sort: _pattern(found) for sort, found in phrases.items()}
    kinds = [kind for kind in vocabulary.types.values() if kind.kind == "quantity"]
    unit = _pattern((word,) for kind in kinds for unit in kind.units for word in unit.words)
    first = _pattern(phrase[:1] for sort in ("word", "command") for phrase in phrases[sort])
    define = _pattern(tuple(way.split()) for way in vocabulary.roles["define"])
    text = {"name": "variable.parameter.btlang", "match": r"\{[^{}]*\}"}
    patterns = [
        {"name": "comment.line.number-sign.btlang", "match": "#.*$"},
        {"name": "string.quoted.double.btlang", "begin": '"', "end": '"|$', "patterns": [text]},
        {"name": "string.quoted.single.btlang", "begin": r"(?<!\w)'", "end": r"'(?!\w)|$", "patterns": [text]},
        {"match": rf"(?i)^\s*(\w+|(?!{first}(?!\w))\w[^\"#:,.;]*?)\s+({define})(?!\w)",
         "captures": {"1": {"name": "entity.name.function.btlang"}, "2": {"name": "keyword.control.btlang"}}},
        {"name": "constant.numeric.btlang", "match": rf"(?i)\b\d+(?:[.:,]\d+)*(?:\s*{unit}(?!\w))?"},
        text,
        *({"name": f"{scope}.btlang", "match": rf"(?i)(?<!\w){known[sort]}(?!\w)"} for sort, scope in _SCOPES.items()),
    ]  # fmt: skip
    order = [*patterns[:-3], patterns[-2], patterns[-1], patterns[-3]]  # `go to` before `to`
    made = {
        "name": "btlang",
        "information_for_contributors": "Made by `python -m tests.generate`.",
        "scopeName": "source.btlang",
        "patterns": order,
    }
    return json.dumps(made, indent=1) + "\n"


def _phrases(vocabulary: Lexicon, sort: str) -> Iterator[tuple[str, ...]]:
    """Yield the first words of each phrase of a sort that stand together."""
    for item in items(vocabulary):
        for way in item.ways if item.sort == sort else ():
            for form in forms(way, vocabulary.articles):
                start = next(at for at, part in enumerate(form) if isinstance(part, str))
                end = next((at for at in range(start, len(form)) if isinstance(form[at], Slot)), len(form))
                words = tuple(part for part in form[start:end] if isinstance(part, str))
                if start == 0 or len(words) > 1:  # one word between slots says little: `{person} at {place}`
                    yield words[: _MOST_WORDS[sort]]


def _pattern(phrases: Iterable[tuple[str, ...]]) -> str:
    """The regular expression of some phrases, the longest first, in which each beginning stands once."""
    tree: dict[str, Any] = {}
    for phrase in phrases:
        node = tree
        for word in phrase:
            node = node.setdefault(word, {})
        node[_END] = {}
    return _branches(tree)


def _branches(tree: dict[str, Any]) -> str:
    words = sorted((word for word in tree if word != _END), key=lambda word: (-len(word), word))
    found = [re.escape(word) + _rest(tree[word]) for word in words]
    return found[0] if len(found) == 1 else f"(?:{'|'.join(found)})"


def _rest(tree: dict[str, Any]) -> str:
    if set(tree) == {_END}:
        return ""
    rest = _GAP + _branches(tree)
    return f"(?:{rest})?" if _END in tree else rest
