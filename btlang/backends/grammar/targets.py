"""The forms in which the grammar of missions can be written."""

from __future__ import annotations

from collections.abc import Callable

from btlang.backends.grammar.ebnf import to_ebnf
from btlang.backends.grammar.gbnf import to_gbnf
from btlang.backends.grammar.schema import to_schema
from btlang.backends.grammar.vocabulary_rules import grammar_of
from btlang.vocabulary.lexicon import Lexicon

GRAMMARS: dict[str, Callable[[Lexicon], str]] = {
    "gbnf": lambda vocabulary: to_gbnf(grammar_of(vocabulary)),
    "ebnf": lambda vocabulary: to_ebnf(grammar_of(vocabulary)),
    "json-schema": to_schema,
}
"""Each makes the text for a vocabulary: missions for llama.cpp, missions in the EBNF of the W3C, trees as JSON."""
